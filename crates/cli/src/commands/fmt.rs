//! `flank fmt`

use std::path::Path;

use flank::{Layout, lay_out, shown_path};

use crate::arguments::Fmt;
use crate::document::{LaidOutFile, LaidOutFiles};
use crate::failure::Failure;
use crate::spec::{self, is_stdin};
use crate::{Ending, document, print};

pub(crate) fn run(arguments: &Fmt) -> Ending {
    let mut ending = Ending::Done;
    let mut told = Vec::new();
    for path in &arguments.files {
        let to_stdout = is_stdin(path) && !arguments.check;
        let done = laid_out(path, arguments.check);
        if arguments.json {
            told.push(laid_out_file(path, to_stdout, &done));
        }
        match done {
            Ok(done) => {
                if arguments.check && done.is_changed {
                    ending = Ending::Wrong;
                }
                if !arguments.json {
                    print(&shown_change(path, to_stdout, &done));
                }
            }
            Err(failure) => ending = failure.tell(false),
        }
    }
    if arguments.json {
        print(&document::text(&LaidOutFiles { files: told }));
    }
    ending
}

/// Lays out a file, and writes it if that changes it and it may be written.
fn laid_out(path: &Path, check: bool) -> Result<Layout, Failure> {
    let project = spec::project(path)?;
    let done = lay_out(&project)?;
    if done.is_changed && !check && !is_stdin(path) {
        #[cfg(unix)]
        tell_other_names(path);
        done.write(&project).map_err(flank::Failure::from)?;
    }
    Ok(done)
}

fn shown_change(path: &Path, to_stdout: bool, done: &Layout) -> String {
    match (to_stdout, done.is_changed) {
        (true, _) => done.text.clone(),
        (false, true) => format!("{}\n", shown_path(path)),
        (false, false) => String::new(),
    }
}

fn laid_out_file(path: &Path, to_stdout: bool, done: &Result<Layout, Failure>) -> LaidOutFile {
    let failure = done.as_ref().err();
    let done = done.as_ref().ok();
    LaidOutFile {
        file: shown_path(path),
        changed: done.map(|done| done.is_changed),
        text: done.filter(|_| to_stdout).map(|done| done.text.clone()),
        message: failure.map(|failure| failure.message().to_string()),
        findings: failure.map_or(Vec::new(), |failure| failure.findings().to_vec()),
    }
}

/// What is written gets its name when it is whole, so that other names of the same file keep what it was.
#[cfg(unix)]
fn tell_other_names(path: &Path) {
    use std::os::unix::fs::MetadataExt;
    let others = std::fs::metadata(path).map_or(0, |found| found.nlink().saturating_sub(1));
    if others > 0 {
        let names = if others == 1 { "another name".to_string() } else { format!("{others} other names") };
        crate::eprint(&format!(
            "note: {} has {names} (hard links), where the text stays as it was\n",
            shown_path(path)
        ));
    }
}

//! `flank fmt`

use std::path::Path;

use flank_chain_dsl::{Disk, FileId, Sources, format, read_file};
use flank_export::write_atomically;
use serde_json::{Value, json};

use crate::arguments::Fmt;
use crate::failure::Failure;
use crate::spec::{is_stdin, shown, stdin};
use crate::{Ending, print};

pub(crate) fn run(arguments: &Fmt) -> Ending {
    let mut ending = Ending::Done;
    let mut told = Vec::new();
    for path in &arguments.files {
        let to_stdout = is_stdin(path) && !arguments.check;
        let done = if is_stdin(path) { stream() } else { in_place(path, arguments.check) };
        if arguments.json {
            told.push(as_json(path, to_stdout, &done));
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
        print(&format!("{:#}\n", json!({ "schema": "flank.fmt/1", "files": told })));
    }
    ending
}

/// A text as it is laid out.
struct LaidOut {
    text: String,
    is_changed: bool,
}

fn shown_change(path: &Path, to_stdout: bool, done: &LaidOut) -> String {
    match (to_stdout, done.is_changed) {
        (true, _) => done.text.clone(),
        (false, true) => format!("{}\n", shown(path)),
        (false, false) => String::new(),
    }
}

fn as_json(path: &Path, to_stdout: bool, done: &Result<LaidOut, Failure>) -> Value {
    let failure = done.as_ref().err();
    let done = done.as_ref().ok();
    json!({
        "file": shown(path),
        "changed": done.map(|done| done.is_changed),
        "text": done.filter(|_| to_stdout).map(|done| &done.text),
        "message": failure.map(Failure::message),
        "findings": failure.map_or(&[][..], Failure::findings),
    })
}

/// Lays out a file, and writes it if that changes it and it may be written.
fn in_place(path: &Path, check: bool) -> Result<LaidOut, Failure> {
    let mut sources = Sources::default();
    let file = read_file(&Disk, &mut sources, path).map_err(|finding| Failure::of_spec(&[finding], &sources))?;
    let done = laid_out(&sources, file)?;
    if done.is_changed && !check {
        #[cfg(unix)]
        tell_other_names(path);
        write_atomically(path, |out| Ok(out.write_all(done.text.as_bytes())?)).map_err(|error| error.to_string())?;
    }
    Ok(done)
}

/// What is written gets its name when it is whole, so that other names of the same file keep what it was.
#[cfg(unix)]
fn tell_other_names(path: &Path) {
    use std::os::unix::fs::MetadataExt;
    let others = std::fs::metadata(path).map_or(0, |found| found.nlink().saturating_sub(1));
    if others > 0 {
        let names = if others == 1 { "another name".to_string() } else { format!("{others} other names") };
        crate::eprint(&format!("note: {} has {names} (hard links), where the text stays as it was\n", shown(path)));
    }
}

/// Lays out what comes from stdin.
fn stream() -> Result<LaidOut, Failure> {
    let mut sources = Sources::default();
    let file = sources.add("-", stdin()?);
    laid_out(&sources, file)
}

fn laid_out(sources: &Sources, file: FileId) -> Result<LaidOut, Failure> {
    let before = &sources.file(file).text;
    let text = format(before, file).map_err(|findings| Failure::of_spec(&findings, sources))?;
    Ok(LaidOut { is_changed: text != *before, text })
}

//! `flank fmt`

use std::io::Read;
use std::path::Path;

use flank_chain_dsl::limits::FILE_BYTES;
use flank_chain_dsl::{Diagnostic, Sources, format, read_file};
use flank_export::write_atomically;

use crate::arguments::Fmt;
use crate::spec::{shown, tell};
use crate::{Ending, print};

pub(crate) fn run(arguments: &Fmt) -> Ending {
    let mut ending = Ending::Done;
    for file in &arguments.files {
        let done = if file.as_os_str() == "-" { stream(arguments.check) } else { in_place(file, arguments.check) };
        if done == Ending::Wrong {
            ending = done;
        }
    }
    ending
}

/// Lays out a file and says so if that changes it.
fn in_place(path: &Path, check: bool) -> Ending {
    let mut sources = Sources::default();
    let laid_out = read_file(&mut sources, path)
        .map_err(|finding| vec![finding])
        .and_then(|file| Ok((file, format(&sources.file(file).text, file)?)));
    let (file, laid_out) = match laid_out {
        Ok(laid_out) => laid_out,
        Err(findings) => return refuse(&findings, &sources),
    };
    if laid_out == sources.file(file).text {
        return Ending::Done;
    }
    if !check && let Err(error) = write_atomically(path, |out| Ok(out.write_all(laid_out.as_bytes())?)) {
        anstream::eprintln!("error: {error}");
        return Ending::Wrong;
    }
    print(&format!("{}\n", shown(path)));
    if check { Ending::Wrong } else { Ending::Done }
}

/// Lays out what comes from stdin.
fn stream(check: bool) -> Ending {
    let mut sources = Sources::default();
    let mut text = String::new();
    // one byte more than a file may have, so that a longer text is refused and not cut
    if let Err(error) = std::io::stdin().take(FILE_BYTES.most as u64 + 1).read_to_string(&mut text) {
        anstream::eprintln!("error: cannot read the standard input: {error}");
        return Ending::Wrong;
    }
    let file = sources.add("-", text);
    match format(&sources.file(file).text, file) {
        Err(findings) => refuse(&findings, &sources),
        Ok(laid_out) if !check => {
            print(&laid_out);
            Ending::Done
        }
        Ok(laid_out) if laid_out == sources.file(file).text => Ending::Done,
        Ok(_) => {
            print("-\n");
            Ending::Wrong
        }
    }
}

fn refuse(findings: &[Diagnostic], sources: &Sources) -> Ending {
    tell(findings, sources);
    Ending::Wrong
}

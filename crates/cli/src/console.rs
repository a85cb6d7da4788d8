//! What goes to stdout and stderr.

use std::io::{ErrorKind, Write};

use flank_export::WriteError;

use crate::Ending;

/// Writes to stdout. A reader that has gone away is not an error; whatever else stands in the way ends the program, for who
/// keeps what it prints would have half of it.
pub(crate) fn print(text: &str) {
    let mut out = anstream::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprint(&format!("error: cannot write to stdout: {}\n", WriteError::from(error)));
            std::process::exit(Ending::Wrong.code().into());
        }
        Ok(()) | Err(_) => {}
    }
}

/// Writes to stderr; where that cannot be, there is nobody to tell.
pub(crate) fn eprint(text: &str) {
    let mut out = anstream::stderr();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

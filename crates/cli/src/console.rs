//! What goes to stdout and stderr.

use std::io::{ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

use flank_export::WriteError;

use crate::Ending;

/// Whether a reader of stdout has gone away.
static UNREAD: AtomicBool = AtomicBool::new(false);

/// Writes to stdout. A reader that has gone away is not an error: files are still written, and the exit code says it. Whatever else
/// stands in the way ends the program, for who keeps what it prints would have half of it.
pub(crate) fn print(text: &str) {
    if is_unread() || text.is_empty() {
        return;
    }
    if closed::is_stdout() {
        fail("it is closed");
    }
    let mut out = anstream::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => UNREAD.store(true, Ordering::Relaxed),
        Err(error) => fail(&WriteError::from(error).to_string()),
    }
}

/// Whether something that was printed has found no reader.
pub(crate) fn is_unread() -> bool {
    UNREAD.load(Ordering::Relaxed)
}

fn fail(why: &str) -> ! {
    eprint(&format!("error: cannot write to stdout: {why}\n"));
    std::process::exit(Ending::Wrong.code().into());
}

/// Writes to stderr; where that cannot be, there is nobody to tell.
pub(crate) fn eprint(text: &str) {
    let mut out = anstream::stderr();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Whether the program was started without a stdout. Before `main` the standard library opens `/dev/null` in its place, which
/// cannot be distinguished from one that the caller wants; what it does has therefore to be looked at earlier.
#[cfg(target_os = "linux")]
mod closed {
    use std::sync::atomic::{AtomicBool, Ordering};

    static IS_STDOUT: AtomicBool = AtomicBool::new(false);

    pub(super) fn is_stdout() -> bool {
        IS_STDOUT.load(Ordering::Relaxed)
    }

    /// Called by the system's loader; asks the kernel one thing and stores one bit.
    extern "C" fn look() {
        let is_open = rustix::io::fcntl_getfd(rustix::stdio::stdout()).is_ok();
        IS_STDOUT.store(!is_open, Ordering::Relaxed);
    }

    #[used]
    #[expect(unsafe_code, reason = "a function pointer in the section of those that are called before `main`")]
    #[unsafe(link_section = ".init_array")]
    static LOOK: extern "C" fn() = look;
}

#[cfg(not(target_os = "linux"))]
mod closed {
    pub(super) fn is_stdout() -> bool {
        false
    }
}

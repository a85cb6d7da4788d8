//! What takes long says on stderr what it is, how far, and since when, if somebody looks at a terminal.

use std::io::{IsTerminal, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use flank::{Findings, Monitor, Remark, Work};

use crate::eprint;
use crate::failure::findings_in_full;
use crate::spelling::with_flags;

/// What takes no longer says nothing.
const QUIET: Duration = Duration::from_secs(1);
/// After that it says something as often as this.
const EVERY: Duration = Duration::from_millis(250);
/// Letters that fit on a line of every terminal.
const WIDTH: usize = 78;

/// Work that is being done. Its line is taken away when it ends.
struct Working(Option<Ticker>);

struct Ticker {
    state: Arc<(Mutex<State>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

struct State {
    what: String,
    reached: String,
    is_over: bool,
}

impl Working {
    /// `what` in a few words, such as `solving concave`.
    fn on(what: String) -> Working {
        let is_seen = std::io::stderr().is_terminal();
        Working(is_seen.then(|| Ticker::start(what, Box::new(std::io::stderr()), [QUIET, EVERY])))
    }
}

impl Work for Working {
    fn reached(&self, how_far: &dyn Fn() -> String) {
        if let Some(ticker) = &self.0 {
            ticker.state().reached = how_far();
        }
    }
}

/// Who looks at a terminal follows an operation.
pub(crate) struct Terminal;

impl Monitor for Terminal {
    fn begin(&self, what: String) -> Box<dyn Work> {
        Box::new(Working::on(what))
    }

    fn remark(&self, remark: &Remark) {
        noted(remark);
    }

    fn spelled(&self, message: &str) -> String {
        with_flags(message)
    }

    fn warn(&self, findings: &Findings) {
        eprint(&findings_in_full(findings));
    }
}

/// Shows a remark on stderr.
pub(crate) fn noted(remark: &Remark) {
    eprint(&with_flags(&format!("note: {remark}\n")));
}

impl Ticker {
    fn start(what: String, out: Box<dyn Write + Send>, times: [Duration; 2]) -> Ticker {
        let state = State { what, reached: String::new(), is_over: false };
        let state = Arc::new((Mutex::new(state), Condvar::new()));
        let shared = Arc::clone(&state);
        let thread = std::thread::Builder::new().spawn(move || tick(&shared, out, times)).ok();
        Ticker { state, thread }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        self.state().is_over = true;
        self.state.1.notify_all();
        // a thread that is gone has nothing to take away
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Writes the line until the work is over. What cannot be written is dropped.
fn tick(shared: &(Mutex<State>, Condvar), mut out: Box<dyn Write + Send>, [quiet, every]: [Duration; 2]) {
    let (state, changed) = shared;
    let start = Instant::now();
    let (mut state, mut wait, mut shown) = (state.lock().unwrap_or_else(PoisonError::into_inner), quiet, 0);
    loop {
        state = changed
            .wait_timeout_while(state, wait, |state| !state.is_over)
            .map_or_else(|poisoned| poisoned.into_inner().0, |(state, _)| state);
        let line = if state.is_over { String::new() } else { line(&state, start.elapsed()) };
        let width = line.chars().count();
        if shown + width > 0 {
            // blanks over what stood there
            let _ = write!(out, "\r{line}{:1$}\r", "", usize::saturating_sub(shown, width));
            let _ = out.flush();
        }
        if state.is_over {
            return;
        }
        (wait, shown) = (every, width);
    }
}

fn line(state: &State, since: Duration) -> String {
    let comma = if state.reached.is_empty() { "" } else { ", " };
    let time = format!("{comma}{} s", since.as_secs());
    let room = WIDTH.saturating_sub(time.chars().count() + state.reached.chars().count() + 2);
    let what: String =
        state.what.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).take(room).collect();
    format!("{what}: {}{time}", state.reached)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps what is written.
    #[derive(Clone, Default)]
    struct Paper(Arc<Mutex<Vec<u8>>>);

    impl Write for Paper {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().expect("paper").extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    impl Paper {
        fn text(&self) -> String {
            String::from_utf8(self.0.lock().expect("paper").clone()).expect("text")
        }
    }

    #[test]
    fn short_work_says_nothing() {
        let paper = Paper::default();
        drop(Ticker::start("solving".to_string(), Box::new(paper.clone()), [Duration::from_secs(3600); 2]));
        assert_eq!(paper.text(), "");
    }

    #[test]
    fn long_work_says_how_far_it_is_and_clears_its_line() {
        let paper = Paper::default();
        let working = Working(Some(Ticker::start(
            "solving".to_string(),
            Box::new(paper.clone()),
            [Duration::ZERO, Duration::from_millis(1)],
        )));
        working.reached(&|| "20 of 80 rows".to_string());
        let start = Instant::now();
        while !paper.text().contains("solving: 20 of 80 rows, 0 s") && start.elapsed() < Duration::from_secs(60) {
            std::thread::yield_now();
        }
        drop(working);
        let text = paper.text();
        assert!(text.contains("\rsolving: 20 of 80 rows, 0 s"), "{text:?}");
        let last = text.trim_end_matches('\r').rsplit('\r').next().expect("a line");
        assert!(last.chars().all(|letter| letter == ' ') && last.chars().count() >= "solving: 0 s".len(), "{text:?}");
    }

    #[test]
    fn a_line_fits() {
        let state = State { what: "solving a\nb".repeat(50), reached: "1 of 2 rows".to_string(), is_over: false };
        let line = line(&state, Duration::from_secs(90));
        assert!(
            line.chars().count() <= WIDTH && line.ends_with(": 1 of 2 rows, 90 s") && !line.contains('\n'),
            "{line}"
        );
    }
}

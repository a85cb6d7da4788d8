//! Work that the editor shows while it goes on, and that it may stop.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use flank::{Monitor, Work};
use serde_json::{Value, json};

use super::Event;

/// Work that ends before is not shown.
const UNSHOWN: Duration = Duration::from_millis(500);
/// How far work is, is told so often at the most.
const BETWEEN: Duration = Duration::from_millis(200);

/// What goes on, by the token that the editor knows it by.
#[derive(Default)]
pub(crate) struct Running {
    of: BTreeMap<String, Piece>,
    begun: usize,
}

struct Piece {
    title: String,
    since: Instant,
    is_shown: bool,
    is_stopped: Arc<AtomicBool>,
}

impl Running {
    /// Work begins; whoever does it is followed by what comes back.
    pub(crate) fn begin(&mut self, title: String, events: &SyncSender<Event>) -> Followed {
        self.begun += 1;
        let token = format!("flank-work-{}", self.begun);
        let is_stopped = Arc::new(AtomicBool::new(false));
        let piece = Piece { title, since: Instant::now(), is_shown: false, is_stopped: Arc::clone(&is_stopped) };
        self.of.insert(token.clone(), piece);
        let told = Teller { token, events: events.clone(), told_at: Mutex::new(Instant::now()) };
        Followed { teller: Arc::new(told), is_stopped }
    }

    /// When the next piece of work is to be shown.
    pub(crate) fn shows_at(&self) -> Option<Instant> {
        self.of.values().filter(|piece| !piece.is_shown).map(|piece| piece.since + UNSHOWN).min()
    }

    /// Tokens and what is told first, of work that goes on for so long that it is to be shown now.
    pub(crate) fn shown_from(&mut self, now: Instant) -> Vec<(String, Value)> {
        let due = |piece: &&mut Piece| !piece.is_shown && piece.since + UNSHOWN <= now;
        let mut shown = Vec::new();
        for (token, piece) in &mut self.of {
            if let Some(piece) = Some(piece).filter(due) {
                piece.is_shown = true;
                shown.push((token.clone(), json!({ "kind": "begin", "title": piece.title, "cancellable": true })));
            }
        }
        shown
    }

    pub(crate) fn is_shown(&self, token: &str) -> bool {
        self.of.get(token).is_some_and(|piece| piece.is_shown)
    }

    /// Work is over; whether it was shown.
    pub(crate) fn end(&mut self, token: &str) -> bool {
        self.of.remove(token).is_some_and(|piece| piece.is_shown)
    }

    /// The editor wants no more of it.
    pub(crate) fn stop(&self, token: &str) {
        if let Some(piece) = self.of.get(token) {
            piece.is_stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// Tells how far work is, until it is dropped.
struct Teller {
    token: String,
    events: SyncSender<Event>,
    told_at: Mutex<Instant>,
}

impl Teller {
    fn tell(&self, message: impl FnOnce() -> String) {
        let mut told_at = self.told_at.lock().unwrap_or_else(PoisonError::into_inner);
        if told_at.elapsed() >= BETWEEN {
            *told_at = Instant::now();
            let _ = self.events.send(Event::Reached { token: self.token.clone(), message: message() });
        }
    }
}

impl Drop for Teller {
    fn drop(&mut self) {
        let _ = self.events.send(Event::Over { token: std::mem::take(&mut self.token) });
    }
}

/// Follows one piece of work.
pub(crate) struct Followed {
    teller: Arc<Teller>,
    is_stopped: Arc<AtomicBool>,
}

impl Monitor for Followed {
    fn begin(&self, what: String) -> Box<dyn Work> {
        self.teller.tell(|| what.clone());
        Box::new(Part { what, teller: Arc::clone(&self.teller) })
    }

    fn is_cancelled(&self) -> bool {
        self.is_stopped.load(Ordering::Relaxed)
    }
}

struct Part {
    what: String,
    teller: Arc<Teller>,
}

impl Work for Part {
    fn reached(&self, how_far: &dyn Fn() -> String) {
        self.teller.tell(|| format!("{}: {}", self.what, how_far()));
    }
}

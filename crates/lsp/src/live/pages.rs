//! The pages that are shown, and the thread that makes them.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use flank::{EvaluatorOptions, Failure, JobSelection, Monitor, page_texts};
use serde::Serialize;

use crate::Spelling;

/// A spec that is to be shown.
#[derive(Clone, Debug)]
pub(super) struct Wish {
    pub(super) selection: JobSelection,
    /// The job in front; the first otherwise.
    pub(super) job: Option<String>,
}

/// What the page in the browser is told.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub(super) struct Told {
    /// Counts what is told.
    pub(super) number: u64,
    /// Counts pictures: another number is another picture.
    pub(super) picture: u64,
    /// The file of the spec.
    pub(super) spec: String,
    /// The jobs that have a page.
    pub(super) jobs: Vec<String>,
    /// The one in front.
    pub(super) job: Option<String>,
    /// The first error, where the picture is older than the text.
    pub(super) error: Option<String>,
}

#[derive(Debug, Default)]
struct State {
    wish: Option<Wish>,
    told: Told,
    texts: BTreeMap<String, Arc<String>>,
}

/// Pages by job, and what is to become of them.
#[derive(Debug)]
pub(super) struct Pages {
    state: Mutex<State>,
    changed: Condvar,
    evaluator: EvaluatorOptions,
    spelled: Spelling,
}

impl Pages {
    /// Starts the thread that makes pages.
    ///
    /// # Errors
    /// If the system lets none start.
    pub(super) fn start(evaluator: EvaluatorOptions, spelled: Spelling) -> io::Result<Arc<Pages>> {
        let pages = Arc::new(Pages { state: Mutex::default(), changed: Condvar::new(), evaluator, spelled });
        let own = Arc::clone(&pages);
        std::thread::Builder::new().name("live solver".to_string()).spawn(move || own.work())?;
        Ok(pages)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn wish(&self, wish: Wish) {
        self.state().wish = Some(wish);
        self.changed.notify_all();
    }

    /// The page of a job.
    pub(super) fn text(&self, job: &str) -> Option<Arc<String>> {
        self.state().texts.get(job).cloned()
    }

    /// What is told after a number, once there is something, or nothing for a while.
    pub(super) fn after(&self, number: u64, patience: Duration) -> Option<Told> {
        let waits = |state: &mut State| state.told.number <= number;
        let (state, _) =
            self.changed.wait_timeout_while(self.state(), patience, waits).unwrap_or_else(PoisonError::into_inner);
        (state.told.number > number).then(|| state.told.clone())
    }

    fn work(&self) {
        loop {
            let wish = {
                let state = self.changed.wait_while(self.state(), |state| state.wish.is_none());
                let mut state = state.unwrap_or_else(PoisonError::into_inner);
                state.wish.take()
            };
            if let Some(wish) = wish {
                self.make(&wish);
            }
        }
    }

    fn make(&self, wish: &Wish) {
        let mut texts = BTreeMap::new();
        let mut jobs = Vec::new();
        let mut unshown = Vec::new();
        let made = page_texts(
            &wish.selection,
            self.evaluator,
            &Newer(self),
            &mut |job, text| {
                texts.insert(job.to_string(), Arc::new(text));
                jobs.push(job.to_string());
            },
            &mut |result| unshown.extend(result.not_done.iter().map(|missing| missing.to_string())),
        );
        let error = match made {
            Err(Failure::Cancelled) => return,
            Err(failure) => Some(in_words(&failure)),
            Ok(()) if texts.is_empty() => unshown.into_iter().next(),
            Ok(()) => None,
        };
        let mut state = self.state();
        state.told.number += 1;
        state.told.spec = flank::shown_path(wish.selection.file());
        state.told.error = error.map(|error| (self.spelled)(&error));
        if !texts.is_empty() {
            let asked = wish.job.clone().filter(|job| jobs.contains(job));
            state.told.picture += 1;
            state.told.job = asked.or_else(|| jobs.first().cloned());
            state.told.jobs = jobs;
            state.texts = texts;
        }
        drop(state);
        self.changed.notify_all();
    }
}

/// Gives up what is older than another wish.
struct Newer<'p>(&'p Pages);

impl Monitor for Newer<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.state().wish.is_some()
    }
}

/// The first error, with its place.
fn in_words(failure: &Failure) -> String {
    let Failure::Findings(findings) = failure else { return failure.to_string() };
    let list = findings.list();
    let first = list.iter().find(|finding| finding.severity == flank::Severity::Error).or(list.first());
    first.map_or(String::new(), |first| {
        format!("{}:{}:{}: {}: {}", first.place.file, first.place.line, first.place.column, first.code, first.message)
    })
}

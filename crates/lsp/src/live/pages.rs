//! The pages that are shown, and the thread that makes them.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use flank::{EvaluatorOptions, Failure, JobSelection, Monitor, PageParts, Remark, RemarkKind, ViewResult, page_parts};
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
    /// The one in front: the one that is asked for, else the first.
    pub(super) job: Option<String>,
    /// The one that is asked for, if one is.
    pub(super) asked: Option<String>,
    /// The jobs that have none, and why.
    pub(super) unshown: BTreeMap<String, String>,
    /// The first error, where the picture is older than the text.
    pub(super) error: Option<String>,
}

#[derive(Debug, Default)]
struct State {
    wish: Option<Wish>,
    told: Told,
    parts: BTreeMap<String, Arc<PageParts>>,
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

    /// What the page of a job has of it alone.
    pub(super) fn parts(&self, job: &str) -> Option<Arc<PageParts>> {
        self.state().parts.get(job).cloned()
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
        let mut parts = BTreeMap::new();
        let mut jobs = Vec::new();
        let newer = Newer { pages: self, idle: Mutex::default() };
        let mut without = Vec::new();
        let made = page_parts(
            &wish.selection,
            self.evaluator,
            &newer,
            &mut |job, of| {
                parts.insert(job.to_string(), Arc::new(of));
                jobs.push(job.to_string());
            },
            &mut |result| without.extend(result.bytes.is_none().then(|| (result.job.clone(), reasons(&result)))),
        );
        let mut unshown = newer.idle.into_inner().unwrap_or_else(PoisonError::into_inner);
        unshown.extend(without);
        if made.is_ok() {
            unshown.extend(wish.missing(&jobs, &unshown));
        }
        let unshown: BTreeMap<String, String> =
            unshown.into_iter().map(|(job, reason)| (job, (self.spelled)(&reason))).collect();
        let error = match made {
            Err(Failure::Cancelled) => return,
            Err(failure) => Some(in_words(&failure)),
            Ok(()) if parts.is_empty() => unshown.values().next().cloned(),
            Ok(()) => None,
        };
        let mut state = self.state();
        state.told.number += 1;
        state.told.spec = flank::shown_path(wish.selection.file());
        state.told.error = error.map(|error| (self.spelled)(&error));
        if !parts.is_empty() {
            state.told.picture += 1;
            state.told.asked = wish.job.clone();
            state.told.job = wish.job.clone().or_else(|| jobs.first().cloned());
            state.told.jobs = jobs;
            state.told.unshown = unshown;
            state.parts = parts;
        }
        drop(state);
        self.changed.notify_all();
    }
}

impl Wish {
    /// The job that is asked for, where the spec has none of that name, and what there is.
    fn missing(&self, shown: &[String], unshown: &BTreeMap<String, String>) -> Option<(String, String)> {
        let job = self.job.as_ref().filter(|job| !shown.contains(job) && !unshown.contains_key(*job))?;
        let failure = self.selection.project.job(job, &self.selection.set).err()?;
        Some((job.clone(), in_words(&failure)))
    }
}

/// Why a job has no page.
fn reasons(result: &ViewResult) -> String {
    result.not_done.iter().map(ToString::to_string).collect::<Vec<String>>().join("\n")
}

/// Gives up what is older than another wish, and hears which jobs ask for nothing.
struct Newer<'p> {
    pages: &'p Pages,
    idle: Mutex<BTreeMap<String, String>>,
}

impl Monitor for Newer<'_> {
    fn is_cancelled(&self) -> bool {
        self.pages.state().wish.is_some()
    }

    fn remark(&self, remark: &Remark) {
        if let (RemarkKind::NoSample, Some(job)) = (remark.kind, &remark.of) {
            let mut idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
            idle.insert(job.clone(), remark.message.clone());
        }
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

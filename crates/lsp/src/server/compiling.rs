//! What is compiled when: whoever types or asks comes first.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{COMPILING, Event, Server};
use crate::diagnostics::Found;

/// What is typed in is compiled once nothing has changed for so long: when the silence is over, its findings are there.
const HEAD_START: Duration = Duration::from_millis(40);
/// What else reads a changed text is compiled once the editor has been quiet for so long: on few processors it would be in the way of answers. Nor does it wait longer
/// than this.
const CALM: Duration = Duration::from_millis(100);
const PATIENCE: Duration = Duration::from_secs(2);

impl<W: Write> Server<W> {
    /// A text has changed: what it is part of is compiled anew after a while.
    pub(super) fn changed(&mut self, file: Option<&Path>, after: Duration) {
        self.analyses.forget(file, self.documents.generation);
        self.ahead = None;
        self.ahead_at = None;
        match file {
            Some(file) => {
                self.ahead_at = (after > HEAD_START).then(|| Instant::now() + HEAD_START);
                let open = |spec: &PathBuf| self.documents.get(spec).is_some();
                self.due.extend(self.findings.readers(file).into_iter().filter(open));
                self.due.insert(file.to_path_buf());
                self.edited = Some(file.to_path_buf());
            }
            None => self.due.extend(self.documents.paths().cloned()),
        }
        self.due_at = Some(Instant::now() + after);
    }

    pub(super) fn wake(&mut self, now: Instant) {
        if self.ahead_at.take_if(|at| *at <= now).is_some()
            && self.compiling == 0
            && let Some(spec) = self.edited.clone()
        {
            self.begin(&spec);
            self.ahead = Some(spec);
        }
        if self.due_at.is_some_and(|at| at <= now) {
            self.due_at = None;
            if self.ready.is_empty() {
                self.waits_since = now;
            }
            self.ready.append(&mut self.due);
            self.compile(now);
        }
        if self.calm_at().is_some_and(|at| at <= now) {
            self.compile(now);
        }
        if let Some((_, path)) = self.picture_at.take_if(|(at, _)| *at <= now) {
            self.show_picture(&path);
        }
    }

    /// When specs that nobody types in may be compiled, if some wait and none is being compiled.
    pub(super) fn calm_at(&self) -> Option<Instant> {
        let waits = !self.ready.is_empty() && self.compiling == 0;
        waits.then(|| (self.heard_at + CALM).min(self.waits_since + PATIENCE))
    }

    /// Compiles what is ready: whoever types does not wait for all that uses a text, nor whoever asks.
    fn compile(&mut self, now: Instant) {
        loop {
            let is_ready = |spec: &Option<PathBuf>| spec.clone().filter(|spec| self.ready.contains(spec));
            let edited = is_ready(&self.edited).filter(|_| self.compiling < COMPILING);
            let is_calm = self.calm_at().is_some_and(|at| at <= now);
            let rest = || is_ready(&self.focused).or_else(|| self.ready.first().cloned()).filter(|_| is_calm);
            let Some(spec) = edited.clone().or_else(rest) else { return };
            if edited.is_none() {
                self.waits_since = now;
            }
            self.ready.remove(&spec);
            if self.ahead.as_ref() != Some(&spec) {
                self.begin(&spec);
            }
        }
    }

    /// Compiles a spec as it is now on a thread of its own.
    fn begin(&mut self, spec: &Path) {
        let Some(version) = self.documents.get(spec).map(|document| document.version) else { return };
        let (spec, snapshot, events) = (spec.to_path_buf(), self.snapshot(), self.events.clone());
        self.compiling += 1;
        self.compilers.spawn(move || {
            let found = || Found::of(&spec, &snapshot.analysis(&spec), &snapshot);
            let found = std::panic::catch_unwind(std::panic::AssertUnwindSafe(found)).ok();
            let _ = events.send(Event::Analysed { spec, version, found });
        });
    }

    /// What a compiled spec amounts to: others wait for it to be over.
    pub(super) fn compiled(&mut self, spec: &Path, version: i32, found: Option<Found>) -> io::Result<()> {
        self.compiling -= 1;
        // one of an older text has no more to do with what is compiled ahead now
        let is_now = self.documents.get(spec).is_some_and(|document| document.version == version);
        self.ahead.take_if(|ahead| is_now && ahead == spec);
        let is_told = is_now && !self.due.contains(spec) && !self.ready.contains(spec);
        let told = match found.filter(|_| is_told) {
            Some(found) => self.analysed(spec, found),
            // of an older text, or of one that is being compiled again, nothing is told
            None => Ok(()),
        };
        self.compile(Instant::now());
        told
    }

    fn analysed(&mut self, spec: &Path, found: Found) -> io::Result<()> {
        let (has_jobs, generation, texts) = (found.has_jobs, found.generation, found.texts);
        for told in self.findings.put(spec, found, &self.documents) {
            self.tell("textDocument/publishDiagnostics", told)?;
        }
        if self.awaited.take_if(|awaited| awaited == spec).is_some() && has_jobs {
            self.tasks.focus(spec, &self.documents);
        }
        // a lens of an older text has a result that says nothing of this one
        let known = self.texts.insert(spec.to_path_buf(), (generation, texts));
        let is_other = known.is_some_and(|(_, known)| known != texts);
        if is_other && self.editor.refreshes_lenses && self.solves.is_known_of(spec) {
            self.ask("workspace/codeLens/refresh", Value::Null)?;
        }
        Ok(())
    }

    /// What the editor shows: the page shows it, too, where it has a job.
    pub(super) fn focus(&mut self, spec: PathBuf) {
        let has_jobs = self.findings.has_jobs(&spec);
        if has_jobs == Some(true) {
            self.tasks.focus(&spec, &self.documents);
        }
        self.awaited = has_jobs.is_none().then(|| spec.clone());
        self.focused = Some(spec);
    }

    pub(super) fn show_picture(&mut self, path: &Path) {
        let readers = self.findings.readers(path);
        self.tasks.follow(path, &readers, &self.documents);
        // one that had no job when it came into focus may have one now
        if self.focused.as_deref() == Some(path) && self.findings.has_jobs(path) == Some(true) {
            self.tasks.focus(path, &self.documents);
        }
    }
}

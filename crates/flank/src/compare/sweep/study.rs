//! A study that is open: its job is compiled, and any number of its chunks are computed.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime};

use flank_chain_dsl::compile_request;
use flank_expr::Graph;

use super::chunks::{Tally, Work};
use super::plan::Plan;
use super::request::StudyChunks;
use super::result::SweepResult;
use super::row::Cases;
use crate::project::answer::{Timed, Timing};
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::Remark;
use crate::project::requests::JobSelection;
use crate::project::session::{EvaluatorOptions, Session};
use crate::project::spec::Origin;
use crate::project::units;

/// A study whose job is compiled. Who computes its chunks one by one opens it once.
pub struct OpenStudy {
    folder: PathBuf,
    plan: Plan,
    cases: Cases,
    evaluator: EvaluatorOptions,
    /// Of its plan and its texts.
    stamps: Vec<(PathBuf, Option<Stamp>)>,
}

/// Size of a file, and when it was written.
type Stamp = (u64, SystemTime);

fn stamp(path: &Path) -> Option<Stamp> {
    let known = std::fs::metadata(path).ok()?;
    Some((known.len(), known.modified().ok()?))
}

impl OpenStudy {
    /// Opens the study in a folder.
    ///
    /// # Errors
    /// If there is no study, its texts are not those of its plan, or the work is cancelled.
    pub fn open(folder: &Path, evaluator: EvaluatorOptions, monitor: &dyn Monitor) -> Result<OpenStudy, Failure> {
        let of_plan = folder.join("plan.json");
        let before = stamp(&of_plan);
        let plan = Plan::read_own(folder)?;
        plan.make_folders(folder)?;
        let which = plan.selection(folder);
        let texts = checked_texts(&plan, &which, folder)?;
        let what = (&plan.collect[..], plan.keep_points.then(|| plan.header()));
        let cases = Cases::new(which, plan.inputs.clone(), what, Session::new(evaluator, monitor))?;
        let stamps = [(of_plan, before)].into_iter().chain(texts).collect();
        Ok(OpenStudy { folder: folder.to_path_buf(), plan, cases, evaluator, stamps })
    }

    /// Why each case is computed from its text, if so.
    pub(super) fn needs_texts(&self) -> Option<Remark> {
        self.cases.needs_texts(&self.plan.job)
    }

    /// Whether its plan and its texts are still those that it was opened with, as far as sizes and times of the files tell.
    pub fn is_current(&self) -> bool {
        self.stamps.iter().all(|(path, known)| known.is_some() && stamp(path) == *known)
    }

    /// Computes those of some chunks that are not there; cases with a verdict in `again` are computed anew. The result is that of these
    /// chunks.
    ///
    /// # Errors
    /// If there are no such chunks, something cannot be written, or the work is cancelled.
    pub fn run(&self, chunks: StudyChunks, again: &[String], monitor: &dyn Monitor) -> Result<SweepResult, Failure> {
        let start = Instant::now();
        let known = ["crashed", "limit"];
        if let Some(other) = again.iter().find(|word| !known.contains(&word.as_str())) {
            return Err(Failure::Request(format!("option `again {other}`: write {}", known.join(" or "))));
        }
        let (plan, all) = (&self.plan, self.plan.chunks());
        let chunks = chunks.numbers(all)?;
        let work = Work { folder: &self.folder, plan, cases: &self.cases, evaluator: self.evaluator, monitor };
        let session = Session::new(self.evaluator, monitor);
        let working = session.begin(format!("computing {}", units::counted(plan.cases.count() as usize, "case")))?;
        let mut tally = Tally::default();
        for chunk in chunks.clone() {
            working.reached(&|| format!("{chunk} of {all} chunks"));
            work.chunk(chunk, again, &mut tally)?;
        }
        let points = chunks.map(|chunk| plan.numbers(chunk).count()).sum();
        let timing = Timing { points, what: Timed::Cases, elapsed: start.elapsed() };
        Ok(SweepResult { timing: Some(timing), ..SweepResult::of(&self.folder, plan, tally) })
    }
}

impl StudyChunks {
    /// Of a study of so many chunks.
    ///
    /// # Errors
    /// If there are no such.
    fn numbers(self, all: usize) -> Result<Range<usize>, Failure> {
        match self {
            StudyChunks::All => Ok(0..all),
            StudyChunks::Between(first, last) if first <= last && last < all => Ok(first..last + 1),
            StudyChunks::Between(first, last) => {
                let message = format!("option `chunks {first}..{last}`: the study has chunks 0 to {}", all - 1);
                Err(Failure::Request(message))
            }
            StudyChunks::Part(part, parts) if part < parts => {
                let begin = |part: usize| (part as u128 * all as u128 / parts as u128) as usize;
                Ok(begin(part)..begin(part + 1))
            }
            StudyChunks::Part(part, parts) => {
                let message = format!("option `part {part}/{parts}`: parts are counted from 0, below their number");
                Err(Failure::Request(message))
            }
        }
    }
}

/// The texts of a study with their stamps.
///
/// # Errors
/// If they are not those of its plan.
fn checked_texts(plan: &Plan, which: &JobSelection, study: &Path) -> Result<Vec<(PathBuf, Option<Stamp>)>, Failure> {
    let graph = Graph::new();
    let compilation = compile_request(&graph, which.file(), &which.request());
    if Origin::of_compilation(&compilation).hash == plan.hash {
        let files = compilation.sources.files().filter_map(|(_, source)| source.file.clone());
        return Ok(files.map(|file| (file.clone(), stamp(&file))).collect());
    }
    Err(Failure::Input(format!(
        "the texts in {} are not those that the study was planned with: bring them back, or plan another study",
        study.join("spec").display()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_hold_each_chunk_once() {
        for (all, parts) in [(95, 10), (100, 10), (3, 10), (1, 1), (7, 7)] {
            let chunks = (0..parts).map(|part| StudyChunks::Part(part, parts).numbers(all).expect("a part"));
            let found: Vec<usize> = chunks.clone().flatten().collect();
            assert_eq!(found, (0..all).collect::<Vec<usize>>(), "{all} in {parts}");
            let sizes: Vec<usize> = chunks.map(|chunks| chunks.len()).collect();
            let ends = (sizes.iter().min().copied(), sizes.iter().max().copied());
            assert!(ends.0.zip(ends.1).is_some_and(|(low, high)| high - low <= 1), "{all} in {parts}: {sizes:?}");
        }
        assert!(StudyChunks::Part(10, 10).numbers(95).is_err());
        assert!(StudyChunks::Between(90, 99).numbers(95).is_err());
    }
}

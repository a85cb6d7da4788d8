//! What is known of a study.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::chunks::Tally;
use super::plan::{Plan, VERSION};
use crate::project::answer::{Answer, Timing};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::{shown_path, units};

/// Damaged files that a message lists.
const LISTED: usize = 5;

/// How far a study is, of `flank sweep`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.sweep/1")]
pub struct SweepResult {
    /// The folder.
    pub study: String,
    /// The version of flank that made it, and whose rows it holds.
    pub version: String,
    /// The job.
    pub job: String,
    /// Heads of the columns that differ from case to case, with units.
    pub inputs: Vec<String>,
    /// Heads of the columns that are collected, with units.
    pub collected: Vec<String>,
    /// Cases of the study.
    pub cases: u64,
    /// Chunks of the study.
    pub chunks: usize,
    /// Chunks that are there; of a run over some chunks, those of them.
    pub done: usize,
    /// Files of chunks that do not hold the rows of the plan, cut off or edited: none of them counts, and a run computes them anew.
    pub damaged: Vec<String>,
    /// Rows that are there by their verdict: `done`, `not all solved`, `spec wrong`, `limit`, `crashed`.
    pub verdicts: BTreeMap<String, u64>,
    /// Numbers of cases whose verdict is not `done`, the first hundred of them.
    pub failed: Vec<u64>,
    /// Files written.
    pub files: Vec<String>,
    /// What was asked for and not done, as stderr has it; the exit code is 3 unless it is empty.
    pub not_done: Vec<NotDone>,
    #[serde(skip)]
    pub(super) timing: Option<Timing>,
}

impl SweepResult {
    /// Of chunks that were looked at.
    pub(super) fn of(study: &Path, plan: &Plan, tally: Tally) -> SweepResult {
        let damaged: Vec<String> = tally.damaged.iter().map(|file| shown_path(file)).collect();
        SweepResult {
            study: shown_path(study),
            version: plan.version.clone(),
            job: plan.job.clone(),
            inputs: plan.inputs.iter().map(|input| input.head()).collect(),
            collected: plan.heads.clone(),
            cases: plan.cases.count(),
            chunks: plan.chunks(),
            done: tally.done,
            not_done: told(&damaged, study, plan).into_iter().chain(none_done(&tally, plan)).collect(),
            damaged,
            verdicts: tally.verdicts,
            failed: tally.failed,
            files: Vec::new(),
            timing: None,
        }
    }
}

/// What is said where there are rows and none is of a case that is done.
fn none_done(tally: &Tally, plan: &Plan) -> Option<NotDone> {
    let rows: u64 = tally.verdicts.values().sum();
    let each = tally.verdicts.iter().map(|(verdict, count)| {
        let why = tally.whys.get(verdict).filter(|why| !why.is_empty());
        format!("{count} {verdict}{}", why.map_or(String::new(), |why| format!(", the first by {why}")))
    });
    let message = format!("none of {} is done", units::counted(rows as usize, "case"));
    let is_none = rows > 0 && !tally.verdicts.contains_key("done");
    is_none.then(|| NotDone::new(NotDoneKind::NotSolved, &plan.job, message).with(each.collect()))
}

/// What is said of damaged chunks.
fn told(damaged: &[String], study: &Path, plan: &Plan) -> Option<NotDone> {
    let message = format!(
        "not counted: {} of {} of {}, where rows of the plan are missing or damaged; a run computes them anew",
        damaged.len(),
        units::counted(plan.chunks(), "chunk"),
        shown_path(study)
    );
    let more = damaged.len().saturating_sub(LISTED);
    let files = damaged.iter().take(LISTED).cloned();
    let details = files.chain((more > 0).then(|| format!("and {more} more"))).collect();
    (!damaged.is_empty()).then(|| NotDone::new(NotDoneKind::NotSolved, &plan.job, message).with(details))
}

impl Answer for SweepResult {
    fn not_done(&self) -> &[NotDone] {
        &self.not_done
    }

    fn timing(&self) -> Option<Timing> {
        self.timing
    }
}

impl fmt::Display for SweepResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "study {} of job {}: {} in {}, {} there\n",
            self.study,
            self.job,
            units::counted(self.cases as usize, "case"),
            units::counted(self.chunks, "chunk"),
            self.done
        )?;
        if self.version != VERSION {
            writeln!(f, "  made by flank {}, this is flank {VERSION}: its rows stay, none is added\n", self.version)?;
        }
        for (verdict, count) in &self.verdicts {
            writeln!(f, "  {count:>8}  {verdict}")?;
        }
        if !self.files.is_empty() {
            writeln!(f, "\nwrote {}", self.files.join(", "))?;
        }
        Ok(())
    }
}

//! Work on the chunks of a study. A chunk is a file that is there whole or not at all: who is killed begins it again.

use std::collections::{BTreeMap, HashSet};
use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use flank_export::{CellKind, WriteError};
use rayon::prelude::*;

use super::journal::Journal;
use super::plan::{CHUNKS, OPEN, POINTS, Plan, write_text};
use super::row::{Cases, Found};
use super::stored::{StoredChunk, StoredRows};
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::session::{EvaluatorOptions, Session};

/// Cases between two looks at whether the work is cancelled.
const TOGETHER: usize = 64;
/// A chunk that was begun so often and never ended is gone through case by case.
const CAREFUL: u32 = 2;
/// A case that was worked on so often when the program ended, and nobody ended it, is not tried again. What ends programs at random hits one
/// case so often only by a chance of one in thousands: each run goes on with the case at which the last one ended, and keeps what it has
/// computed.
const DEADLY: u32 = 5;
/// The file of a study in which times stand: rows have none, so that equal chunks are equal bytes.
pub(super) const LOG: &str = "log";
/// Numbers of failed cases that are listed.
const LISTED: usize = 100;

/// What is known of the chunks that were looked at.
#[derive(Default)]
pub(super) struct Tally {
    /// Chunks that are there.
    pub(super) done: usize,
    /// Files of chunks that do not hold the rows of the plan.
    pub(super) damaged: Vec<PathBuf>,
    /// Rows by their verdict.
    pub(super) verdicts: BTreeMap<String, u64>,
    /// Why the first row of each verdict has it, where that is said.
    pub(super) whys: BTreeMap<String, String>,
    /// Numbers of the first cases whose verdict is not `done`.
    pub(super) failed: Vec<u64>,
}

impl Tally {
    /// One more chunk with its rows, in the order of chunks.
    pub(super) fn add<'r>(&mut self, plan: &Plan, chunk: usize, rows: impl Iterator<Item = &'r str>) {
        self.done += 1;
        for (number, row) in plan.numbers(chunk).zip(rows) {
            let verdict = plan.verdict_of(row);
            match self.verdicts.get_mut(verdict) {
                Some(count) => *count += 1,
                None => {
                    self.verdicts.insert(verdict.to_string(), 1);
                    self.whys.insert(verdict.to_string(), plan.why_of(row).to_string());
                }
            }
            if verdict != "done" && self.failed.len() < LISTED {
                self.failed.push(number);
            }
        }
    }
}

/// A study that is worked on.
pub(super) struct Work<'w> {
    pub(super) folder: &'w Path,
    pub(super) plan: &'w Plan,
    pub(super) cases: &'w Cases,
    pub(super) evaluator: EvaluatorOptions,
    pub(super) monitor: &'w dyn Monitor,
}

impl Plan {
    /// Where the points of a case stand, if they are kept.
    fn points_file(&self, folder: &Path, values: &[f64]) -> PathBuf {
        folder.join(POINTS).join(format!("{}.csv", self.hash_of_case(values)))
    }

    /// The first line of each chunk.
    pub(super) fn head(&self) -> String {
        let quoted = |head: String| if head.contains(',') { format!("\"{head}\"") } else { head };
        let all: Vec<String> = self.columns().into_iter().map(|(head, _)| quoted(head)).collect();
        all.join(",")
    }

    /// The heads of the columns with what their cells are.
    pub(super) fn columns(&self) -> Vec<(String, CellKind)> {
        let text = |head: &str| (head.to_string(), CellKind::Text);
        let number = |head: String| (head, CellKind::Number);
        [text("case"), ("number".to_string(), CellKind::Count)]
            .into_iter()
            .chain(self.inputs.iter().map(|input| number(input.head())))
            .chain(["verdict", "why", "branch"].map(text))
            .chain(self.heads.iter().cloned().map(number))
            .collect()
    }

    /// Hands over the texts of the chunks that are whole, one by one in their order, and counts their rows.
    ///
    /// # Errors
    /// What `each` gives.
    pub(super) fn each_chunk(
        &self,
        folder: &Path,
        tally: &mut Tally,
        each: &mut dyn FnMut(&str) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let listed = std::fs::read_dir(folder.join(CHUNKS)).into_iter().flatten();
        let mut files: HashSet<OsString> = listed.flatten().map(|file| file.file_name()).collect();
        for chunk in 0..self.chunks() {
            // of millions of chunks most may not be there, and the name of each takes the values of all its cases
            if files.is_empty() {
                return Ok(());
            }
            let stored = self.stored(folder, chunk);
            files.remove(stored.file.file_name().unwrap_or_default());
            match stored.rows {
                StoredRows::Missing => {}
                StoredRows::Damaged => tally.damaged.push(stored.file),
                StoredRows::Whole(text) => {
                    tally.add(self, chunk, text.lines().skip(1));
                    each(&text)?;
                }
            }
        }
        Ok(())
    }

    fn row(&self, number: u64, values: &[f64], found: &Found) -> String {
        let mut row = format!("{},{number}", self.hash_of_case(values));
        values.iter().for_each(|value| _ = write!(row, ",{}", shown(*value)));
        _ = write!(row, ",{},{},{}", found.verdict, found.why, found.branch);
        found.numbers.iter().for_each(|number| {
            row.push(',');
            row.extend(number.filter(|number| number.is_finite()).map(shown));
        });
        row
    }
}

/// The shortest text that is the same number.
pub(super) fn shown(number: f64) -> String {
    if number == 0.0 {
        "0".to_string()
    } else if number.fract() == 0.0 && number.abs() < 1e15 {
        format!("{number:.0}")
    } else {
        format!("{number:?}")
    }
}

impl Work<'_> {
    /// Computes a chunk unless it is there as a whole, and counts its rows.
    ///
    /// # Errors
    /// If the work is cancelled, or something cannot be written.
    pub(super) fn chunk(&self, chunk: usize, again: &[String], tally: &mut Tally) -> Result<(), Failure> {
        let start = Instant::now();
        let StoredChunk { hash, file, rows } = self.plan.stored(self.folder, chunk);
        let known = match rows {
            StoredRows::Whole(text) => {
                let is_wanted = |row: &str| again.iter().any(|of| of == self.plan.verdict_of(row));
                let rows: Vec<String> = text.lines().skip(1).map(str::to_string).collect();
                if !rows.iter().any(|row| is_wanted(row)) {
                    tally.add(self.plan, chunk, rows.iter().map(String::as_str));
                    return Ok(());
                }
                rows.into_iter().map(|row| (!is_wanted(&row)).then_some(row)).collect()
            }
            StoredRows::Missing | StoredRows::Damaged => vec![None; self.plan.numbers(chunk).count()],
        };
        let journal = Journal::begin(&self.folder.join(OPEN).join(&hash))?;
        let rows = if journal.attempts > CAREFUL {
            self.one_by_one(chunk, known, &journal)
        } else {
            self.together(chunk, known)
        };
        if matches!(rows, Err(Failure::Cancelled)) {
            journal.stop();
        }
        let rows = rows?;
        let text = format!("{}\n{}\n", self.plan.head(), rows.join("\n"));
        write_text(&file, &text)?;
        journal.end();
        tally.add(self.plan, chunk, rows.iter().map(String::as_str));
        self.log(chunk, &hash, start.elapsed());
        Ok(())
    }

    /// Adds to the log of the study how long a chunk took. What cannot be written there is not missed.
    fn log(&self, chunk: usize, hash: &str, elapsed: Duration) {
        let line = serde_json::json!({
            "chunk": chunk,
            "file": hash,
            "cases": self.plan.numbers(chunk).count(),
            "seconds": (elapsed.as_secs_f64() * 1e6).round() / 1e6,
            "threads": rayon::current_num_threads(),
        });
        let log = std::fs::OpenOptions::new().create(true).append(true).open(self.folder.join(LOG));
        // one call, so that lines of several runs do not mix
        _ = log.and_then(|mut log| log.write_all(format!("{line}\n").as_bytes()));
    }

    fn together(&self, chunk: usize, known: Vec<Option<String>>) -> Result<Vec<String>, Failure> {
        let numbers: Vec<(u64, Option<String>)> = self.plan.numbers(chunk).zip(known).collect();
        let mut rows = Vec::with_capacity(numbers.len());
        for cases in numbers.chunks(TOGETHER) {
            crate::project::session::check(self.monitor)?;
            let found = cases.par_iter().map(|(number, known)| match known {
                Some(row) => Ok(row.clone()),
                None => self.case(*number),
            });
            rows.extend(found.collect::<Result<Vec<_>, Failure>>()?);
        }
        Ok(rows)
    }

    fn one_by_one(&self, chunk: usize, known: Vec<Option<String>>, journal: &Journal) -> Result<Vec<String>, Failure> {
        let rows = self.plan.numbers(chunk).zip(known).map(|(number, known)| {
            crate::project::session::check(self.monitor)?;
            match known.or_else(|| journal.row(number)) {
                Some(row) => Ok(row),
                None if journal.deaths(number) >= DEADLY => {
                    let found = self.cases.nothing("crashed", "ended the program");
                    Ok(self.plan.row(number, &self.plan.values(number), &found))
                }
                None => {
                    journal.enter(number)?;
                    let row = self.case(number)?;
                    journal.leave(number, &row)?;
                    Ok(row)
                }
            }
        });
        rows.collect()
    }

    fn case(&self, number: u64) -> Result<String, Failure> {
        let values = self.plan.values(number);
        let until = self.plan.limit.map(|seconds| Instant::now() + Duration::from_secs_f64(seconds));
        let watch = CaseMonitor { until, is_late: AtomicBool::new(false) };
        let found = match self.cases.solved((number, &values), Session::new(self.evaluator, &watch)) {
            Err(Failure::Cancelled) => self.cases.nothing("limit", "took too long"),
            other => other?,
        };
        self.cases.keep(&self.plan.points_file(self.folder, &values), &values, &found)?;
        Ok(self.plan.row(number, &values, &found))
    }
}

/// Ends a case that takes too long.
struct CaseMonitor {
    until: Option<Instant>,
    is_late: AtomicBool,
}

impl Monitor for CaseMonitor {
    fn is_cancelled(&self) -> bool {
        if self.until.is_some_and(|until| Instant::now() > until) {
            self.is_late.store(true, Ordering::Relaxed);
        }
        self.is_late.load(Ordering::Relaxed)
    }
}

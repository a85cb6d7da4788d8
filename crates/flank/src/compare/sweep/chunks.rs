//! Work on the chunks of a study. A chunk is a file that is there whole or not at all: who is killed begins it again.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::collect::{Cases, Found};
use super::plan::{Plan, write_text};
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::requests::{EvaluatorOptions, Session};

/// Cases between two looks at whether the work is cancelled.
const TOGETHER: usize = 64;
/// A chunk that was begun so often and never ended is gone through case by case.
const CAREFUL: u32 = 2;
/// A case that alone ended the program so often is not tried again.
const DEADLY: u32 = 3;

/// A study that is worked on.
pub(super) struct Work<'w> {
    pub(super) folder: &'w Path,
    pub(super) plan: &'w Plan,
    pub(super) cases: &'w Cases,
    pub(super) evaluator: EvaluatorOptions,
    pub(super) monitor: &'w dyn Monitor,
}

impl Plan {
    /// Where the rows of a chunk stand.
    pub(super) fn chunk_file(&self, folder: &Path, chunk: usize) -> PathBuf {
        folder.join("chunks").join(format!("{}.csv", self.hash_of_chunk(chunk)))
    }

    /// The first line of each chunk.
    pub(super) fn head(&self) -> String {
        let inputs = self.inputs.iter().map(|input| input.head());
        let heads = ["case".to_string(), "number".to_string()].into_iter().chain(inputs);
        let all: Vec<String> = heads
            .chain(["verdict".to_string(), "why".to_string()])
            .chain(self.heads.iter().cloned())
            .map(|head| if head.contains(',') { format!("\"{head}\"") } else { head })
            .collect();
        all.join(",")
    }

    fn row(&self, number: u64, values: &[f64], found: &Found) -> String {
        let mut row = format!("{},{number}", self.hash_of_case(values));
        values.iter().for_each(|value| _ = write!(row, ",{}", shown(*value)));
        _ = write!(row, ",{},{}", found.verdict, found.why);
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
    /// Computes a chunk unless it is there.
    ///
    /// # Errors
    /// If the work is cancelled, or something cannot be written.
    pub(super) fn chunk(&self, chunk: usize, again: &[String]) -> Result<(), Failure> {
        let file = self.plan.chunk_file(self.folder, chunk);
        let known = match std::fs::read_to_string(&file) {
            Ok(text) => {
                let is_wanted = |row: &str| verdict_of(self.plan, row).is_some_and(|of| again.iter().any(|o| o == of));
                let rows: Vec<String> = text.lines().skip(1).map(str::to_string).collect();
                if !rows.iter().any(|row| is_wanted(row)) {
                    return Ok(());
                }
                rows.into_iter().map(|row| (!is_wanted(&row)).then_some(row)).collect()
            }
            Err(_) => vec![None; self.plan.numbers(chunk).count()],
        };
        let journal = Journal::begin(&self.folder.join("open").join(self.plan.hash_of_chunk(chunk)))?;
        let rows = if journal.attempts > CAREFUL {
            self.one_by_one(chunk, known, &journal)?
        } else {
            self.together(chunk, known)?
        };
        let text = format!("{}\n{}\n", self.plan.head(), rows.join("\n"));
        write_text(&file, &text)?;
        journal.end();
        Ok(())
    }

    fn together(&self, chunk: usize, known: Vec<Option<String>>) -> Result<Vec<String>, Failure> {
        let numbers: Vec<(u64, Option<String>)> = self.plan.numbers(chunk).zip(known).collect();
        let mut rows = Vec::with_capacity(numbers.len());
        for cases in numbers.chunks(TOGETHER) {
            crate::project::requests::check(self.monitor)?;
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
            crate::project::requests::check(self.monitor)?;
            match known {
                Some(row) => Ok(row),
                None if journal.deaths(number) >= DEADLY => {
                    let found = self.cases.nothing("crashed", "ended the program");
                    Ok(self.plan.row(number, &self.plan.values(number), &found))
                }
                None => {
                    journal.enter(number)?;
                    let row = self.case(number)?;
                    journal.leave(number)?;
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
        let found = match self.cases.solved(&values, Session::new(self.evaluator, &watch)) {
            Err(Failure::Cancelled) => self.cases.nothing("limit", "took too long"),
            other => other?,
        };
        Ok(self.plan.row(number, &values, &found))
    }
}

/// The verdict in a row.
pub(super) fn verdict_of<'r>(plan: &Plan, row: &'r str) -> Option<&'r str> {
    row.split(',').nth(2 + plan.inputs.len())
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

/// What is known of a chunk that was begun: how often, and which cases were worked on when the program ended.
struct Journal {
    path: PathBuf,
    attempts: u32,
    deaths: std::cell::RefCell<Vec<(u64, u32)>>,
}

impl Journal {
    /// One more attempt.
    fn begin(path: &Path) -> Result<Journal, Failure> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let mut lines = text.lines();
        let attempts: u32 = lines.next().and_then(|line| line.parse().ok()).unwrap_or(0);
        let case = |line: &str| {
            let (number, deaths) = line.split_once(' ')?;
            Some((number.parse().ok()?, deaths.parse().ok()?))
        };
        let deaths = lines.filter_map(case).collect();
        let journal = Journal { path: path.to_path_buf(), attempts: attempts + 1, deaths: std::cell::RefCell::new(deaths) };
        journal.write()?;
        Ok(journal)
    }

    fn write(&self) -> Result<(), Failure> {
        let cases: String = self.deaths.borrow().iter().map(|(number, deaths)| format!("{number} {deaths}\n")).collect();
        write_text(&self.path, &format!("{}\n{cases}", self.attempts))
    }

    fn deaths(&self, number: u64) -> u32 {
        self.deaths.borrow().iter().find(|(of, _)| *of == number).map_or(0, |(_, deaths)| *deaths)
    }

    /// A case is worked on: until it is left, the program may end by it.
    fn enter(&self, number: u64) -> Result<(), Failure> {
        let deaths = self.deaths(number) + 1;
        self.deaths.borrow_mut().retain(|(of, _)| *of != number);
        self.deaths.borrow_mut().push((number, deaths));
        self.write()
    }

    fn leave(&self, number: u64) -> Result<(), Failure> {
        self.deaths.borrow_mut().retain(|(of, _)| *of != number);
        self.write()
    }

    /// The chunk is there. A journal that stays says nothing.
    fn end(self) {
        _ = std::fs::remove_file(&self.path);
    }
}

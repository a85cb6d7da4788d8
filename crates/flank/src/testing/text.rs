//! What `flank test` says.

use std::fmt::{self, Display};

use crate::project::units;
use crate::testing::result::{TestResult, TestedSnapshot, TestedSpec};

/// Characters of an expectation that are shown.
const LONGEST: usize = 100;

impl Display for TestResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.specs.iter().try_for_each(|spec| write!(f, "{spec}"))?;
        let tested = self.specs.iter().filter(|spec| spec.says_something()).count();
        if tested == 0 {
            return writeln!(f, "nothing is tested: no job, and no machine that expects something by itself");
        }
        let specs = units::counted(tested, "spec");
        let failed = match self.failed {
            0 => "all hold".to_string(),
            1 => "1 failure".to_string(),
            many => format!("{many} failures"),
        };
        writeln!(f, "{specs}, {}: {failed}", units::counted(self.passed + self.failed, "expectation"))
    }
}

impl TestedSpec {
    /// Whether there is something to say of it: a file of machines or tools without expectations is passed over.
    pub(super) fn says_something(&self) -> bool {
        !self.items.is_empty() || self.failed() > 0
    }

    fn is_as_in_snapshot(&self) -> bool {
        self.snapshot.as_ref().is_some_and(|snapshot| snapshot.is_same)
    }

    /// How many warnings there are, behind what else is said of it.
    fn warned(&self) -> String {
        match self.findings.counts()[1] {
            0 => String::new(),
            warnings => format!(", {}", units::counted(warnings, "warning")),
        }
    }
}

/// A line, and what does not hold below it.
impl Display for TestedSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.says_something() {
            return Ok(());
        }
        let (passed, failed) = (self.passed(), self.failed());
        let all = units::counted(passed + failed, "expectation");
        match (passed, failed) {
            _ if self.is_wrong() => {
                writeln!(f, "{}: {} in the text", self.file, units::counted(self.findings.counts()[0], "error"))?
            }
            (0, 0) if self.is_as_in_snapshot() => writeln!(f, "{}: as in its snapshot{}", self.file, self.warned())?,
            (0, 0) => writeln!(f, "{}: nothing is expected{}", self.file, self.warned())?,
            (_, 0) => {
                let hold = if passed == 1 { "holds" } else { "hold" };
                let compared = if self.is_as_in_snapshot() { ", as in its snapshot" } else { "" };
                writeln!(f, "{}: {all} {hold}{compared}{}", self.file, self.warned())?
            }
            _ => writeln!(f, "{}: {failed} of {all} failed{}", self.file, self.warned())?,
        }
        if let Some(why) = &self.failure {
            writeln!(f, "  {why}")?;
        }
        for item in &self.items {
            for expectation in item.expectations.iter().filter(|expectation| !expectation.holds) {
                let place = &expectation.place;
                // what a job inherits stands in another file
                let from = if place.file == self.file { String::new() } else { format!(" from {}", place.file) };
                let at = format!("{from}:{}:{}", place.line, place.column);
                writeln!(f, "  {}{at}: {}", item.name, shortened(&expectation.expected))?;
                writeln!(f, "    found: {}", expectation.found)?;
                expectation.details.iter().try_for_each(|line| writeln!(f, "    {line}"))?;
            }
        }
        let differs = self.snapshot.iter().filter(|snapshot| !snapshot.is_same);
        differs.into_iter().try_for_each(|snapshot| write!(f, "{snapshot}"))
    }
}

/// An expectation that is too long to be read on one line, without its middle; its tolerance stays.
fn shortened(expected: &str) -> String {
    let size = expected.chars().count();
    if size <= LONGEST {
        return expected.to_string();
    }
    let tail = expected.rfind(" within ").or_else(|| expected.rfind(" in ")).unwrap_or(expected.len());
    let bracket = usize::from(expected[..tail].ends_with([']', ')']));
    let tail = Some(&expected[tail - bracket..]).filter(|tail| tail.chars().count() < LONGEST / 2).unwrap_or_default();
    let head: String = expected.chars().take(LONGEST - 1 - tail.chars().count()).collect();
    format!("{}…{tail}", head.trim_end())
}

impl Display for TestedSnapshot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "  {} {}:", if self.is_accepted { "accepted in" } else { "differs from" }, self.file)?;
        self.differences.iter().try_for_each(|line| writeln!(f, "    {line}"))
    }
}

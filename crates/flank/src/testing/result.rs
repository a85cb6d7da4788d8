//! What `flank test` found.

use schemars::JsonSchema;
use serde::Serialize;

use crate::project::findings::{Finding, Findings, Place};

/// What became of the expectations of specs, of `flank test`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.test/1")]
pub struct TestResult {
    /// In the order of their names.
    pub specs: Vec<TestedSpec>,
    /// Expectations that hold, in all specs.
    pub passed: usize,
    /// Those that do not, specs that are wrong, and snapshots that differ; the exit code is 3 unless it is 0.
    pub failed: usize,
}

/// What became of the expectations of one spec.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct TestedSpec {
    /// As it was given, with forward slashes.
    pub file: String,
    /// Its jobs, and machines that expect something by themselves.
    pub items: Vec<TestedItem>,
    /// What is wrong with it, where that keeps it from being tested; what is doubtful otherwise.
    #[schemars(with = "Vec<Finding>")]
    pub findings: Findings,
    /// Why it was not tested, if the reason is not what is wrong with its text.
    pub failure: Option<String>,
    /// What differs from its snapshot; null where it has none.
    pub snapshot: Option<TestedSnapshot>,
    /// The jobs and machines that a filter could take.
    #[serde(skip)]
    pub names: Vec<String>,
    /// All files that were read for it, without links.
    #[serde(skip)]
    pub read: Vec<std::path::PathBuf>,
}

/// A job or a machine that is tested.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TestedItem {
    /// Its name; empty for what a whole file expects.
    pub name: String,
    /// In the order in which they are written; those of its machines first.
    pub expectations: Vec<TestedExpectation>,
}

/// An expectation, and whether it holds.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TestedExpectation {
    /// As it is written, on one line, without `expect`.
    pub expected: String,
    /// Where.
    pub place: Place,
    /// Whether it holds.
    pub holds: bool,
    /// What was found: the worst value, or how many points are as expected.
    pub found: String,
    /// Where, and what may be the reason, a line each; empty where it holds.
    pub details: Vec<String>,
}

/// What a spec derives beside what it once did.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TestedSnapshot {
    /// Its file.
    pub file: String,
    /// Whether nothing differs.
    pub is_same: bool,
    /// What differs, in words, a line each.
    pub differences: Vec<String>,
    /// Whether what differs was accepted: it is in the file now.
    pub is_accepted: bool,
    /// The text that it would be now; nothing where it is the same.
    #[serde(skip)]
    pub text: Option<String>,
    /// The map of the first surface that moved, in SVG.
    #[serde(skip)]
    pub picture: Option<String>,
}

impl TestResult {
    /// Counts what became of specs.
    pub fn of_specs(specs: Vec<TestedSpec>) -> TestResult {
        let passed = specs.iter().map(TestedSpec::passed).sum();
        let failed = specs.iter().map(TestedSpec::failed).sum();
        TestResult { specs, passed, failed }
    }
}

impl TestedSnapshot {
    /// Whether something differs that nobody accepted.
    pub fn differs(&self) -> bool {
        !self.is_same && !self.is_accepted
    }
}

impl TestedSpec {
    fn expectations(&self) -> impl Iterator<Item = &TestedExpectation> {
        self.items.iter().flat_map(|item| &item.expectations)
    }

    /// Expectations that hold.
    pub fn passed(&self) -> usize {
        self.expectations().filter(|expectation| expectation.holds).count()
    }

    /// What does not hold, or keeps the spec from being tested.
    pub fn failed(&self) -> usize {
        let differs = self.snapshot.as_ref().is_some_and(TestedSnapshot::differs);
        let is_wrong = self.failure.is_some() || self.is_wrong();
        self.expectations().filter(|expectation| !expectation.holds).count()
            + usize::from(differs)
            + usize::from(is_wrong)
    }

    /// Whether something in its text is wrong or doubtful that it does not expect.
    pub fn has_findings(&self) -> bool {
        self.is_wrong() || self.findings.counts()[0] == 0 && !self.findings.is_empty()
    }

    /// Whether its text is wrong in ways that it does not expect.
    pub fn is_wrong(&self) -> bool {
        self.findings.counts()[0] > 0 && self.items.is_empty()
    }
}

//! Whether specs are right.

use schemars::JsonSchema;
use serde::Serialize;

use crate::language::editor::analysis::analyse;
use crate::language::editor::names::IndexedName;
use crate::project::findings::{Finding, Findings};
use crate::project::{Project, shown_path};

/// What is wrong with specs, of `flank check`.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.check/1")]
pub struct CheckResult {
    /// In the order in which they were given.
    pub files: Vec<Checked>,
}

/// What is found in a spec and the files that it uses.
#[derive(Clone, Debug, Serialize, JsonSchema)]
pub struct Checked {
    /// As it was given, with forward slashes.
    pub file: String,
    /// Whether it has no error; warnings are none.
    pub ok: bool,
    /// Errors and warnings, in the order of their places.
    #[schemars(with = "Vec<Finding>")]
    pub findings: Findings,
    /// All names with what they lead to, where they are asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Vec<IndexedName>")]
    pub names: Option<Vec<IndexedName>>,
}

/// Parses a spec, resolves its names and checks dimensions.
pub fn check(project: &Project) -> Checked {
    checked(project, false)
}

/// The same with the index of names.
pub fn check_with_names(project: &Project) -> Checked {
    checked(project, true)
}

fn checked(project: &Project, with_names: bool) -> Checked {
    let analysis = analyse(project);
    let findings = Findings::new(&analysis.diagnostics, &analysis.sources);
    let [errors, _] = findings.counts();
    let names = with_names.then(|| analysis.indexed());
    Checked { file: shown_path(project.file()), ok: errors == 0, findings, names }
}

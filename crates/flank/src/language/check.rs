//! Whether specs are right.

use flank_expr::Graph;
use schemars::JsonSchema;
use serde::Serialize;

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
}

/// Parses a spec, resolves its names and checks dimensions.
pub fn check(project: &Project) -> Checked {
    let graph = Graph::new();
    let compilation = project.compiled(&graph);
    Checked {
        file: shown_path(project.file()),
        ok: !compilation.has_errors(),
        findings: Findings::new(&compilation.diagnostics, &compilation.sources),
    }
}

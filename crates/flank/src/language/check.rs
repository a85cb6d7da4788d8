//! Whether specs are right.

use flank_expr::Graph;
use serde::Serialize;

use crate::project::findings::Findings;
use crate::project::{Project, shown_path};

/// What is found in a spec and the files that it uses.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// The file, as it was named, with forward slashes.
    pub file: String,
    /// Whether it has no error; warnings are none.
    pub ok: bool,
    /// Errors and warnings, in the order of their places.
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

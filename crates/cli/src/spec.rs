//! From the command line's file to jobs, with the findings told on the way.

use std::path::Path;

use flank_chain_dsl::{Compilation, Diagnostic, Job, Severity, Sources, compile_file, render};
use flank_expr::Graph;
use sha2::{Digest, Sha256};

use crate::Ending;
use crate::arguments::Which;

/// The jobs that are asked for; what is wrong has been told.
pub(crate) fn jobs<'g>(graph: &'g Graph, which: &Which) -> Result<(Compilation<'g>, Vec<Job<'g>>), Ending> {
    let mut compilation = compile_file(graph, &which.file, &which.set);
    tell(&compilation.diagnostics, &compilation.sources);
    if compilation.has_errors() {
        return Err(Ending::Wrong);
    }
    match compilation.take_jobs(which.job.as_deref()) {
        Ok(jobs) => Ok((compilation, jobs)),
        Err(finding) => {
            tell(&[finding], &compilation.sources);
            Err(Ending::Wrong)
        }
    }
}

/// Shows findings with the source underlined, and where to read more about the first error.
pub(crate) fn tell(diagnostics: &[Diagnostic], sources: &Sources) {
    if diagnostics.is_empty() {
        return;
    }
    anstream::eprint!("{}", render(diagnostics, sources, true));
    let count = |severity| diagnostics.iter().filter(|finding| finding.severity() == severity).count();
    let of = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
    match (count(Severity::Error), count(Severity::Warning)) {
        (0, warnings) => anstream::eprintln!("{}", of(warnings, "warning")),
        (errors, 0) => anstream::eprintln!("{}", of(errors, "error")),
        (errors, warnings) => {
            anstream::eprintln!("{}, {}", of(errors, "error"), of(warnings, "warning"))
        }
    }
    if let Some(first) = diagnostics.iter().find(|finding| finding.severity() == Severity::Error) {
        anstream::eprintln!("`flank explain {}` tells more", first.code.as_str());
    }
}

/// SHA-256 of all texts that a compilation read, in its order.
pub(crate) fn hash(compilation: &Compilation<'_>) -> String {
    let mut hash = Sha256::new();
    for (_, file) in compilation.sources.files() {
        hash.update((file.text.len() as u64).to_le_bytes());
        hash.update(file.text.as_bytes());
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A path as messages show it: with forward slashes, the same on every system.
pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string().replace('\\', "/")
}

//! A spec with corrected settings: a variant of the job.

use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use flank_chain_dsl::{Buffers, Dimension, Job, Request, Sources, compile_request, format, read_file};
use flank_export::write_atomically;
use flank_expr::Graph;

use crate::project::failure::Failure;
use crate::project::findings::Findings;
use crate::project::requests::JobSelection;
use crate::project::shown_path;
use crate::project::spec::Origin;
use crate::project::units;

/// The text of the spec: the job with the values that were set by hand, then these.
///
/// # Errors
/// If the file is one that was read, or cannot use the job's spec.
pub(in crate::compare) fn text(
    selection: &JobSelection,
    (job, values): (&Job<'_>, &[(String, String)]),
    file: &Path,
    origin: &Origin,
) -> Result<String, Failure> {
    check_unread(file, origin)?;
    let spec = selection.file();
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Failure::Input(format!("there is no folder `{}` for option `write`", shown_path(folder))));
    }
    let used = way(folder, spec).ok_or_else(|| {
        Failure::Input(format!(
            "a spec in `{}` cannot use `{}`: give the job as a file in the same project folder",
            shown_path(file),
            shown_path(spec)
        ))
    })?;
    let own = format!("{}.", job.name);
    let by_hand = selection.set_in(&[job]).into_iter();
    let by_hand = by_hand.map(|(name, value)| (name.strip_prefix(&own).unwrap_or(name).to_string(), value.clone()));
    let kept = by_hand.filter(|(name, _)| !values.iter().any(|(known, _)| known == name));
    let all: Vec<String> = kept.chain(values.iter().cloned()).map(|(name, value)| format!("{name}: {value}")).collect();
    let name = &job.name;
    let text = format!(
        "//! `{name}` with corrected settings.\n\nuse \"{used}\"\n\njob {name}_corrected = {name}({})\n",
        all.join(", ")
    );
    laid_out(selection, file, &text)
}

/// The text in the settled layout, of which it is certain that it is right.
fn laid_out(selection: &JobSelection, file: &Path, text: &str) -> Result<String, Failure> {
    let files = Buffers::over(selection.project.shared_files()).with(file, text.to_string());
    let mut sources = Sources::default();
    let told = |findings: &[flank_chain_dsl::Diagnostic], sources: &Sources| {
        Failure::Findings(Findings::new(findings, sources))
    };
    let id = read_file(&files, &mut sources, file).map_err(|finding| told(&[finding], &sources))?;
    let laid_out = format(text, id).map_err(|findings| told(&findings, &sources))?;
    let files = Buffers::over(selection.project.shared_files()).with(file, laid_out.clone());
    let graph = Graph::new();
    let compiled = compile_request(&graph, file, &Request { files: Arc::new(files), ..Request::default() });
    if compiled.has_errors() {
        return Err(told(&compiled.diagnostics, &compiled.sources));
    }
    Ok(laid_out)
}

/// A value with its unit, as the language has it.
pub(in crate::compare) fn value(dimension: Dimension, value: f64) -> String {
    if [Dimension::LENGTH, Dimension::ANGLE, Dimension::NUMBER].contains(&dimension) {
        return units::as_given(dimension, value);
    }
    format!("{value} {}", units::of_language(dimension))
}

/// Writes it, whole or not at all.
///
/// # Errors
/// If the file is one that was read, or cannot be written.
pub(in crate::compare) fn write(file: &Path, text: &str, origin: &Origin) -> Result<String, Failure> {
    check_unread(file, origin)?;
    write_atomically(file, |out| Ok(out.write_all(text.as_bytes())?))?;
    Ok(shown_path(file))
}

/// # Errors
/// If the file is one that was read.
fn check_unread(file: &Path, origin: &Origin) -> Result<(), Failure> {
    match origin.holds(file) {
        false => Ok(()),
        true => Err(Failure::Input(format!(
            "`{}` is what this command reads and would be written over: name another file with option `write`",
            shown_path(file)
        ))),
    }
}

/// The way from a folder to a file, as `use` has it.
fn way(folder: &Path, file: &Path) -> Option<String> {
    let whole = |path: &Path| std::fs::canonicalize(path).ok();
    let (folder, file) = (whole(folder)?, whole(file)?);
    let [from, to] = [&folder, &file].map(|path| path.components().collect::<Vec<Component<'_>>>());
    let same = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[same..].iter().map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(to[same..].iter().copied()).collect();
    Some(shown_path(&way))
}

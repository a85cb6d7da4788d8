//! What a job of the library is expected to be like, once it gets other values.

use std::collections::HashMap;
use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::Span;
use flank_chain_dsl::syntax::ast::{Expectation, Expected, Job, JobStatement};

use crate::project::shown_path;

/// Jobs of the library by name, each with its file and the text of it.
pub(super) type Jobs = HashMap<String, (&'static Path, &'static str, Job)>;

/// Something that a job is expected to be like.
#[derive(Clone)]
pub(super) struct Expecting {
    pub(super) expected: Expectation,
    /// As it is written.
    pub(super) text: &'static str,
    /// Its file within the library.
    path: &'static Path,
}

/// What a job says itself.
pub(super) fn own(path: &'static Path, text: &'static str, job: &Job) -> Vec<Expecting> {
    let expecting = |statement: &JobStatement| match statement {
        JobStatement::Expect(expected) => {
            let Span { start, end, .. } = expected.span;
            Some(Expecting { expected: expected.clone(), text: &text[start as usize..end as usize], path })
        }
        _ => None,
    };
    job.statements.iter().filter_map(expecting).collect()
}

/// What it takes from the jobs that it extends, those first that all others extend.
pub(super) fn inherited(job: &Job, known: &Jobs) -> Vec<Expecting> {
    let Some((path, text, parent)) = job.extends.as_ref().and_then(|parent| known.get(&parent.node)) else {
        return Vec::new();
    };
    let mut all = inherited(parent, known);
    all.extend(own(path, text, parent));
    for statement in &job.statements {
        let JobStatement::Expect(later) = statement else { continue };
        all.retain(|earlier| later.what != Expected::Nothing && earlier.expected.about != later.about);
    }
    all.retain(|earlier| earlier.expected.what != Expected::Nothing);
    all
}

/// The statements of a job in `folder` that is to inherit these alone: it says them itself, and drops what it inherits.
pub(super) fn anew(kept: &[&Expecting], folder: &Path) -> String {
    let mut text = "\n    expect nothing\n".to_owned();
    for expecting in kept {
        let mut words = expecting.text.to_owned();
        for table in expecting.expected.tables() {
            let moved = beside(folder, &expecting.path.with_file_name(&table));
            words = words.replace(&format!("\"{table}\""), &format!("\"{moved}\""));
        }
        text += &format!("    {words}\n");
    }
    text
}

/// The path of a file as it is named in a folder beside it or beside one of those that hold it.
fn beside(folder: &Path, file: &Path) -> String {
    let (folder, file): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (folder.components().collect(), file.components().collect());
    let same = folder.iter().zip(&file).take_while(|(a, b)| a == b).count();
    let up = (same..folder.len()).map(|_| Component::ParentDir);
    shown_path(&up.chain(file[same..].iter().copied()).collect::<PathBuf>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_named_from_the_folder_of_the_job() {
        let named = |folder: &str| beside(Path::new(folder), Path::new("hobbing/gear.csv"));
        assert_eq!([named("hobbing"), named("bodies")], ["gear.csv", "../hobbing/gear.csv"]);
    }
}

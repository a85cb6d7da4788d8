//! The index of names: every name of every shipped spec leads somewhere.

use std::path::{Path, PathBuf};

use flank_chain_dsl::syntax::{is_reserved, words};
use flank_chain_dsl::{Compilation, Target, compile_file};
use flank_expr::Graph;

fn specs() -> Vec<PathBuf> {
    fn inside(folder: &Path, all: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("a folder of specs") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                inside(&path, all);
            } else if path.extension().is_some_and(|extension| extension == "chain") {
                all.push(path);
            }
        }
    }
    let mut all = Vec::new();
    inside(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs"), &mut all);
    all.sort();
    all
}

/// Words that are no names where no entry stands: they belong to a statement.
const OF_STATEMENTS: [&str; 37] = [
    "profile", "cut", "nc", "error", "insert", "close", "unknown", "solid", "contact", "want", "mill", "expect", "linear",
    "rotary", "inside", "outside", "towards", "where", "along", "about", "for", "as", "keep", "with", "near", "within",
    "travel", "nothing", "of", "passes", "both", "ways", "clear", "scallop", "step", "chord", "lead",
];

fn lost<'c>(compilation: &'c Compilation<'_>) -> Vec<String> {
    let (index, sources) = (&compilation.index, &compilation.sources);
    let Some((main, text)) = sources.files().find(|(_, file)| file.file.is_some()) else { return Vec::new() };
    let mut lost = Vec::new();
    for word in words(&text.text, main) {
        let said = sources.text(word);
        let entry = index.at(main, word.start).filter(|entry| entry.span.start <= word.start && word.end <= entry.span.end);
        let is_found = match entry {
            Some(entry) => !matches!(entry.target, Target::Missing(_)),
            None => is_reserved(said) || OF_STATEMENTS.contains(&said) || ["tilt", "stock"].contains(&said),
        };
        if !is_found {
            let (path, line, column) = sources.place(word);
            lost.push(format!("{}:{line}:{column}: {said}", path.display()));
        }
    }
    lost
}

#[test]
fn every_name_of_every_shipped_spec_leads_somewhere() {
    let mut all = Vec::new();
    let mut names = 0;
    for path in specs() {
        let graph = Graph::new();
        let compilation = compile_file(&graph, &path, &[]);
        names += compilation.index.entries.len();
        all.extend(lost(&compilation));
    }
    assert!(names > 10_000, "{names}");
    assert!(all.is_empty(), "{} lost:\n{}", all.len(), all.join("\n"));
}

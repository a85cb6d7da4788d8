//! The index of names: every name of every shipped spec leads somewhere.

use std::path::{Path, PathBuf};

use flank_chain_dsl::syntax::{TokenKind, is_reserved, tokens, vocabulary};
use flank_chain_dsl::{Compilation, Entry, Target, compile_file};
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

/// What leads nowhere, or to a definition of another name.
fn lost(compilation: &Compilation<'_>) -> Vec<String> {
    let (index, sources) = (&compilation.index, &compilation.sources);
    let Some((main, text)) = sources.files().find(|(_, file)| file.file.is_some()) else { return Vec::new() };
    let mut lost = Vec::new();
    let words = vocabulary();
    let is_of_statements = |word: &str| {
        let lists = [words.in_machine, words.in_tool, words.in_surface, words.in_job, words.inside, words.choices];
        lists.iter().any(|list| list.contains(&word))
    };
    for word in tokens(&text.text, main).iter().filter(|token| token.kind == TokenKind::Word).map(|token| token.span) {
        let said = sources.text(word);
        let entry =
            index.at(main, word.start).filter(|entry| entry.span.start <= word.start && word.end <= entry.span.end);
        let is_found = match entry {
            Some(Entry { target: Target::Missing(_), .. }) => false,
            Some(Entry { target: Target::Symbol(id), .. }) => sources.text(index.symbol(*id).name) == said,
            Some(_) => true,
            // a word of a statement, not a name
            None => is_reserved(said) || is_of_statements(said),
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

//! Names of specs, as editors rename them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{Analysis, Buffers, Disk, NameKind, OutlineItem, Project, analyse};

const BEHIND: &str = "_other";
/// Corners and directions of a sample, which are words of the language, and a column of the tables that a spec is held against.
const FIXED: [&str; 7] = ["toe_root", "heel_root", "toe_tip", "heel_tip", "profilewise", "lengthwise", "spindle"];

fn specs() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs").canonicalize().expect("the library");
    let (mut all, mut folders) = (Vec::new(), vec![root]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "chain") {
                all.push(path);
            }
        }
    }
    all.sort();
    all
}

fn analysed(path: &Path, text: &str) -> Analysis {
    analyse(&Project::open(path, Arc::new(Buffers::over(Arc::new(Disk)).with(path, text))))
}

/// Addresses of programs are letters that controls know.
fn addresses(items: &[OutlineItem]) -> Vec<usize> {
    let own = items.iter().filter(|item| item.kind == NameKind::NcWord).map(|item| item.span.start);
    own.chain(items.iter().flat_map(|item| addresses(&item.inside))).collect()
}

/// Where the words of a text begin.
fn words(text: &str) -> impl Iterator<Item = usize> {
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    let places = text.char_indices();
    places.filter(move |(at, letter)| is_letter(*letter) && !text[..*at].ends_with(is_letter)).map(|(at, _)| at)
}

/// A text with other names for all that it defines itself, and their number.
fn renamed(path: &Path, text: &str, name: impl Fn(&str) -> String) -> (String, usize) {
    let analysis = analysed(path, text);
    let fixed = addresses(&analysis.outline());
    let (mut places, mut definitions) = (BTreeSet::new(), BTreeSet::new());
    for at in words(text) {
        let Some(definition) = analysis.first_definition(at) else { continue };
        let is_fixed = definition.file == path && FIXED.contains(&&text[definition.start..definition.end]);
        if definition.file != path || fixed.contains(&definition.start) || is_fixed {
            continue;
        }
        let places_of = analysis.references(&definition).into_iter().filter(|of| of.span.file == path);
        places.extend(places_of.map(|of| (of.span.start, of.span.end)));
        definitions.insert(definition);
    }
    let mut changed = text.to_string();
    for (start, end) in places.into_iter().rev() {
        changed.replace_range(start..end, &name(&text[start..end]));
    }
    (changed, definitions.len())
}

/// All at once: a use that is not found, or one that is another's, is an error between.
#[test]
fn names_of_every_shipped_spec_are_renamed_there_and_back() {
    let (mut count, mut wrong) = (0, Vec::new());
    for path in specs() {
        let text = std::fs::read_to_string(&path).expect("UTF-8");
        let (there, names) = renamed(&path, &text, |name| format!("{name}{BEHIND}"));
        let told = analysed(&path, &there).findings();
        wrong.extend(told.iter().map(|told| format!("{}: {}", path.display(), told.finding.message)));
        let (back, same) =
            renamed(&path, &there, |name| name.strip_suffix(BEHIND).expect("it was renamed").to_string());
        if back != text || same != names {
            wrong.push(format!("{} is another one: {names} names, {same} back", path.display()));
        }
        count += names;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    println!("{count} names");
    assert!(count > 2_500, "{count}");
}

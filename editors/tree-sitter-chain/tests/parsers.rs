//! The grammar of editors takes what the program's own parser takes.

use std::path::{Path, PathBuf};

use flank_chain_dsl::syntax::{parse, tokens};
use flank_chain_dsl::{FileId, Severity};
use tree_sitter::{Parser, Query};

fn specs() -> Vec<(PathBuf, String)> {
    let mut all = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "chain") {
                let text = std::fs::read_to_string(&path).expect("UTF-8");
                all.push((path, text));
            }
        }
    }
    all.sort();
    all
}

fn parser() -> Parser {
    let mut parser = Parser::new();
    parser.set_language(&tree_sitter_chain::LANGUAGE.into()).expect("a parser of this version");
    parser
}

/// Where the tree has a mistake.
fn mistake(parser: &mut Parser, text: &str) -> Option<String> {
    let tree = parser.parse(text, None).expect("a tree");
    if !tree.root_node().has_error() {
        return None;
    }
    let mut cursor = tree.walk();
    loop {
        let node = cursor.node();
        if node.is_error() || node.is_missing() {
            let place = node.start_position();
            let line = text.lines().nth(place.row).unwrap_or_default();
            return Some(format!("{}:{}: {line}", place.row + 1, place.column + 1));
        }
        if cursor.goto_first_child() {
            continue;
        }
        while !cursor.goto_next_sibling() {
            if !cursor.goto_parent() {
                return Some("somewhere".to_string());
            }
        }
    }
}

fn is_accepted(text: &str) -> bool {
    parse(text, FileId(0)).1.iter().all(|finding| finding.severity() != Severity::Error)
}

/// Numbers that look random, the same each time.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}

/// A text with one of its words left out, doubled, changed with another one, or with the place of another one.
fn mutated(text: &str, random: &mut Random) -> String {
    let all = tokens(text, FileId(0));
    let (a, b) = (all[random.below(all.len())].span, all[random.below(all.len())].span);
    let said = |span: flank_chain_dsl::Span| &text[span.start as usize..span.end as usize];
    let with = |span: flank_chain_dsl::Span, new: &str| {
        format!("{}{new}{}", &text[..span.start as usize], &text[span.end as usize..])
    };
    match random.below(5) {
        0 => with(a, ""),
        1 => with(a, &format!("{0} {0}", said(a))),
        2 => with(a, said(b)),
        3 => with(a, &format!("{} {}", said(a), said(b))),
        _ => {
            // names that are words of statements elsewhere
            let words = ["profile", "error", "lead", "keep", "near", "step", "of", "travel", "along", "with"];
            with(a, words[random.below(words.len())])
        }
    }
}

#[test]
fn every_shipped_spec_has_a_tree_without_a_mistake() {
    let mut parser = parser();
    let specs = specs();
    let wrong: Vec<String> = specs
        .iter()
        .filter_map(|(path, text)| Some(format!("{}:{}", path.display(), mistake(&mut parser, text)?)))
        .collect();
    assert!(specs.len() > 80, "{}", specs.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn mutated_specs_that_the_program_takes_have_a_tree_without_a_mistake() {
    let (mut parser, mut random, specs) = (parser(), Random(0x9E37_79B9_7F4A_7C15), specs());
    let (mut accepted, mut wrong) = (0, Vec::new());
    for _ in 0..3000 {
        let (path, text) = &specs[random.below(specs.len())];
        let changed = mutated(text, &mut random);
        if !is_accepted(&changed) {
            continue;
        }
        accepted += 1;
        if let Some(place) = mistake(&mut parser, &changed) {
            wrong.push(format!("{}:{place}", path.display()));
        }
    }
    assert!(accepted >= 300, "{accepted} of 3000 are right");
    assert!(wrong.is_empty(), "{} of {accepted}:\n{}", wrong.len(), wrong[..wrong.len().min(20)].join("\n"));
}

/// What Neovim calls what it colours, as the queries of the grammar do; and what Helix does.
const CAPTURES: [[&str; 2]; 17] = [
    ["comment", "comment"],
    ["string", "string"],
    ["number", "constant.numeric"],
    ["constant", "constant"],
    ["keyword", "keyword"],
    ["keyword.conditional", "keyword.control.conditional"],
    ["keyword.operator", "keyword.operator"],
    ["operator", "operator"],
    ["punctuation.bracket", "punctuation.bracket"],
    ["punctuation.delimiter", "punctuation.delimiter"],
    ["type", "type"],
    ["type.builtin", "type.builtin"],
    ["function", "function"],
    ["variable", "variable"],
    ["variable.parameter", "variable.parameter"],
    ["property", "variable.other.member"],
    ["module", "namespace"],
];

/// A query with the names of Helix in it.
fn for_helix(query: &str) -> String {
    let mut parts = query.split('@');
    let mut out = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let end = part.find(|letter: char| !letter.is_ascii_lowercase() && letter != '.').unwrap_or(part.len());
        let found = CAPTURES.iter().find(|[name, _]| *name == &part[..end]);
        let [_, helix] = found.unwrap_or_else(|| panic!("no editor knows @{}", &part[..end]));
        out += &format!("@{helix}{}", &part[end..]);
    }
    out
}

/// `UPDATE_PAGES=1` makes the queries of the editors.
#[test]
fn the_queries_of_editors_are_those_of_the_grammar() {
    let editors = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (highlights, folds) = (tree_sitter_chain::HIGHLIGHTS, tree_sitter_chain::FOLDS);
    let indents = folds.replace("@fold", "@indent") + "[\"}\" \")\" \"]\"] @outdent\n";
    let wanted = [
        ("neovim/queries/chain/highlights.scm", highlights.to_string()),
        ("neovim/queries/chain/folds.scm", folds.to_string()),
        ("helix/queries/chain/highlights.scm", for_helix(highlights)),
        ("helix/queries/chain/indents.scm", indents),
    ];
    for (path, query) in wanted {
        Query::new(&tree_sitter_chain::LANGUAGE.into(), &query).expect("a query");
        let path = editors.join(path);
        if std::env::var_os("UPDATE_PAGES").is_some() {
            std::fs::write(&path, &query).expect("the query");
        }
        assert_eq!(std::fs::read_to_string(&path).expect("the query"), query, "{}", path.display());
    }
}

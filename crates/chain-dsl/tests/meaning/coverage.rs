//! Every code has a text that gives it.

use std::collections::BTreeSet;
use std::path::Path;

use flank_chain_dsl::Code;

/// Tests that write files or ask for jobs, which a fixture of one text cannot.
const BY_HAND: &str = include_str!("files.rs");

/// The codes that the remarks in the fixtures of a folder expect.
fn expected(folder: &str, codes: &mut BTreeSet<String>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(folder);
    for entry in std::fs::read_dir(folder).expect("the fixtures are there") {
        let text = std::fs::read_to_string(entry.expect("an entry").path()).expect("a fixture");
        let remarks = text.lines().filter_map(|line| line.strip_prefix("//").map(str::trim_start));
        let words =
            remarks.filter_map(|remark| remark.strip_prefix('^')?.trim_start_matches('^').split_whitespace().next());
        codes.extend(words.map(str::to_string));
    }
}

#[test]
fn every_code_has_a_mistake_that_gives_it() {
    let mut codes = BTreeSet::new();
    expected("meaning/mistakes", &mut codes);
    expected("syntax/mistakes", &mut codes);
    let is_by_hand = |code: &Code| BY_HAND.contains(&format!("[Code::{code:?}]"));
    let missing: Vec<&Code> =
        Code::ALL.iter().filter(|code| !codes.contains(code.as_str()) && !is_by_hand(code)).collect();
    assert!(missing.is_empty(), "no mistake gives {missing:?}");
}

//! Changes of the text: each one that a finding offers mends it, and whatever names a change in words offers it.

use std::collections::BTreeSet;
use std::path::Path;

use flank_chain_dsl::{Code, Cure, Diagnostic, compile_text};
use flank_expr::Graph;

use crate::LIBRARY;
use crate::fixtures::{TITLE, is_remark};

/// What is said where no change of the text follows from it: names of one's own, values that only the user knows, a choice.
const WORDS_ALONE: &str = "tests/meaning/helps_without_changes.txt";

fn folder(name: &str) -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read_to_string(path).expect("a text")).collect()
}

/// The fixtures of a folder, without the remarks in them.
fn mistakes(name: &str) -> Vec<String> {
    let without_remarks = |text: &str| text.split_inclusive('\n').filter(|line| !is_remark(line)).collect();
    let of_file = |file: String| -> Vec<String> {
        let texts = file.split(TITLE).skip(1).map(|text| text.split_once('\n').expect("a text below its title").1);
        texts.map(without_remarks).collect()
    };
    folder(name).into_iter().flat_map(of_file).collect()
}

/// Wrong texts: all fixtures, and the blocks of the pages about errors.
fn wrong_texts() -> Vec<String> {
    let of_page = |page: String| -> Vec<String> {
        let blocks = page.split("```chain\n").skip(1).map(|block| block.split("```").next().unwrap_or_default());
        blocks.map(str::to_string).collect()
    };
    let meaning = mistakes("tests/meaning/mistakes").into_iter().map(|text| format!("{text}{LIBRARY}"));
    let pages = folder("../../docs/errors").into_iter().flat_map(of_page);
    meaning.chain(mistakes("tests/syntax/mistakes")).chain(pages).collect()
}

fn found(text: &str) -> Vec<Diagnostic> {
    compile_text(&Graph::new(), "text", text, &[]).diagnostics
}

fn changed(text: &str, cure: &Cure) -> String {
    let [start, end] = [cure.span.start, cure.span.end].map(|at| at as usize);
    format!("{}{}{}", &text[..start], cure.replacement, &text[end..])
}

/// Whether it is still found where it was found before a change.
fn is_found(all: &[Diagnostic], of: &Diagnostic, by: &Cure) -> bool {
    let start = of.span.start;
    let moved =
        if start >= by.span.end { start + by.replacement.len() as u32 + by.span.start - by.span.end } else { start };
    all.iter().any(|found| (found.code, &found.message, found.span.start) == (of.code, &of.message, moved))
}

/// How much of a text cannot be read.
fn unread(all: &[Diagnostic]) -> usize {
    all.iter().filter(|found| found.code == Code::Syntax).count()
}

/// Without what stands between backquotes, of lists once.
fn pattern(help: &str) -> String {
    let parts: Vec<&str> = help.split('`').collect();
    let plain = parts.iter().enumerate().map(|(k, part)| if k % 2 == 0 { part } else { &"`…`" });
    let mut plain: String = plain.copied().collect();
    while plain.contains("`…`, `…`") {
        plain = plain.replace("`…`, `…`", "`…`");
    }
    plain
}

#[test]
fn every_change_mends_what_offers_it_and_other_helps_name_none() {
    let (mut wrong, mut changes, mut alone) = (Vec::new(), 0, BTreeSet::new());
    for text in wrong_texts() {
        let before = found(&text);
        for finding in &before {
            for cure in &finding.cures {
                let mended = changed(&text, cure);
                let after = found(&mended);
                if is_found(&after, finding, cure) || unread(&after) > unread(&before) {
                    wrong.push(format!("{} {}: {}\n{mended}", finding.code.as_str(), finding.message, cure.title));
                }
                changes += 1;
            }
            if let (Some(help), true) = (&finding.help, finding.cures.is_empty()) {
                alone.insert(format!("{} {}", finding.code.as_str(), pattern(help)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    assert!(changes > 100, "{changes}");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(WORDS_ALONE);
    let said: String = alone.into_iter().map(|line| line + "\n").collect();
    if std::env::var_os("UPDATE_MISTAKES").is_some() {
        std::fs::write(&path, said).expect("a writable file");
    } else {
        let expected = std::fs::read_to_string(&path).expect("the list");
        assert_eq!(
            said, expected,
            "a help that names a change offers it as one; what names none stands in {WORDS_ALONE}"
        );
    }
}

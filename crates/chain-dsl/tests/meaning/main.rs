//! What texts mean: mistakes of meaning with what is said of them, files that use each other, values from outside.

mod coverage;
mod cures;
mod files;
#[path = "../fixtures/mod.rs"]
mod fixtures;
mod formulas;
mod hostile;
mod index;
mod models;
mod poses;
mod profiles;
mod variants;

use flank_chain_dsl::{Code, Diagnostic, Severity, compile_text};
use flank_expr::Graph;

use fixtures::check;

/// What the fixtures draw on, behind their own text.
const LIBRARY: &str = include_str!("library.chain");

fn findings(text: &str) -> Vec<Diagnostic> {
    let graph = Graph::new();
    compile_text(&graph, "text", &format!("{text}{LIBRARY}"), &[]).diagnostics
}

fn errors(text: &str) -> Vec<Diagnostic> {
    findings(text).into_iter().filter(|finding| finding.severity() == Severity::Error).collect()
}

#[test]
fn what_nobody_uses_is_warned_about() {
    assert!(check("meaning/mistakes/unused.txt", true, findings) > 4);
}

#[test]
fn one_mistake_gives_one_report() {
    let files = ["names", "dimensions", "values", "machines", "jobs", "contacts", "expectations"];
    let count: usize = files.iter().map(|file| check(&format!("meaning/mistakes/{file}.txt"), true, errors)).sum();
    assert!(count > 90, "{count}");
}

#[test]
fn several_mistakes_give_one_report_each() {
    let count = check("meaning/mistakes/several.txt", false, findings);
    assert!(count > 20, "{count}");
    for text in include_str!("mistakes/several.txt").split("//---- ").skip(1) {
        let (title, rest) = text.split_once('\n').expect("a text below its title");
        let wanted = ["one", "two", "three", "four"].iter().position(|number| title.starts_with(number));
        let marks = rest.lines().filter_map(|line| line.strip_prefix("//")).filter(|line| line.trim().starts_with('^'));
        assert_eq!(wanted.map(|index| index + 1), Some(marks.count()), "{title}");
    }
}

#[test]
fn the_library_is_right() {
    assert!(findings("").is_empty());
}

/// A range says whether a count may be negative; without one it may not.
#[test]
fn a_count_is_as_negative_as_its_range_says() {
    let planer = |count: &str| {
        format!(
            "machine planer {{
                param k : count in -20 .. 20 = {count}
                axis Y : linear
                frame bed
                frame ram in bed = translate_y(Y + k * 1 mm)
            }}"
        )
    };
    assert!(findings(&planer("-3")).is_empty());
    assert!(findings(&planer("-20")).is_empty());
    let codes = |text: &str| errors(text).iter().map(|finding| finding.code).collect::<Vec<_>>();
    assert_eq!(codes(&planer("-21")), [Code::OutOfRange]);
    assert_eq!(codes(&planer("-3.5")), [Code::WrongDimension]);
    assert_eq!(codes(&planer("-3").replace("in -20 .. 20 ", "")), [Code::WrongDimension]);
}

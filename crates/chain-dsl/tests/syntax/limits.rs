//! Hostile and enormous texts: answered soon, without a crash.

use std::time::{Duration, Instant};

use flank_chain_dsl::Code;

use crate::{read, tree};

/// The only report on a text, which must come soon: a debug build on a loaded machine takes a second for none of these.
fn only(text: &str) -> (Code, String) {
    let start = Instant::now();
    let (_, diagnostics) = read(text);
    assert!(start.elapsed() < Duration::from_secs(10), "took {:?}", start.elapsed());
    assert_eq!(diagnostics.len(), 1, "{:#?}", &diagnostics[..diagnostics.len().min(3)]);
    (diagnostics[0].code, diagnostics[0].message.clone())
}

/// A job with one value of almost a megabyte.
fn long(unit: &str) -> String {
    format!("job j {{ let a = {} }}", unit.repeat(((1 << 20) - 30) / unit.len()))
}

#[test]
fn nesting() {
    let too_deep = (Code::LimitExceeded, "nested deeper than 64 levels".to_owned());
    for unit in ["(", "[", "f(", "-", "- ", "not ", "if ", "[1, (", "if a then b else "] {
        assert_eq!(only(&long(unit)), too_deep, "{unit}");
    }
    assert_eq!(only(&format!("job j {{ let a = {} }}", "(".repeat(100_000))), too_deep);
    for (open, close) in [("(", ")"), ("[", "]"), ("f(", ")"), ("-", ""), ("if a then b else ", "")] {
        // the job's brace is a level too
        let nested = |levels: usize| format!("job j {{ let a = {}x{} }}", open.repeat(levels), close.repeat(levels));
        tree(&nested(63));
        tree(&nested(60));
        assert_eq!(only(&nested(65)), too_deep, "{open}");
    }
}

#[test]
fn nesting_is_counted_for_each_expression_alone() {
    tree(&format!("job j {{ sample s {{ {} }} }}", "u: if a then b else c, v: -1\n".repeat(50)));
    tree(&format!("machine m {{ {} }}", "let a = if b then (c) else -d\n".repeat(200)));
    tree(&format!("job j {{ let a = [{}] }}", "if a then -b else (c), ".repeat(200)));
}

#[test]
fn length_of_a_statement() {
    for unit in ["a.", ".a", "a + ", "1, ", "\"a\" ", "\0"] {
        let (code, message) = only(&long(unit));
        assert_eq!(code, Code::LimitExceeded, "{unit:?}");
        assert_eq!(message, "a statement of more than 65,536 words and signs");
    }
}

#[test]
fn height_of_a_tree() {
    for unit in ["+a", "^a", "^-a", "[0]", " or a"] {
        tree(&format!("job j {{ let a = a{} }}", unit.repeat(100)));
        let (code, message) = only(&format!("job j {{ let a = a{} }}", unit.repeat(20_000)));
        assert_eq!(
            (code, message.as_str()),
            (Code::LimitExceeded, "more than 256 operations hang on each other"),
            "{unit}"
        );
    }
    // sums in brackets in sums: each level alone is within the limit
    let mut text = "x".to_owned();
    for _ in 0..60 {
        text = format!("({text}{})", "^2".repeat(200));
    }
    assert_eq!(only(&format!("job j {{ let a = {text} }}")).0, Code::LimitExceeded);
}

#[test]
fn junk() {
    for unit in ["(", "}", "{", "-", "if ", "a.", "\0", "word\n", "α", "\"", "1.", "\u{feff}"] {
        assert_eq!(only(&unit.repeat((1 << 20) / unit.len())).0, Code::Syntax, "{unit:?}");
    }
}

#[test]
fn length_of_a_word() {
    for (before, unit, after) in [("let ", "a", " = 1"), ("let a = ", "1", ""), ("let a = f(\"", "α", "\")")] {
        let word = |length: usize| format!("job j {{ {before}{}{after} }}", unit.repeat(length));
        tree(&word(998));
        for length in [1001, 300_000] {
            assert_eq!(only(&word(length)), (Code::LimitExceeded, "a word of more than 1,000 characters".to_owned()));
        }
    }
}

#[test]
fn length_of_a_file() {
    assert_eq!(only(&" ".repeat((1 << 20) + 1)), (Code::LimitExceeded, "a file of more than 1 MiB".to_owned()));
    tree(&" ".repeat(1 << 20));
}

#[test]
fn number_of_mistakes() {
    for line in ["let\n", "a = 1\n", "let a = 1;\n", "job b {\n"] {
        let (_, diagnostics) = read(&format!("job j {{\n{}", line.repeat(50_000)));
        assert_eq!(diagnostics.len(), 101, "{line}");
        assert_eq!(diagnostics[100].message, "more than 100 mistakes: the rest is not looked at");
    }
}

//! What is fuzzed: functions that take any bytes and must return.
//!
//! The fuzzers in `fuzz/` and the smoke test in `tests/language/fuzz_smoke.rs` call the same ones.

use flank_chain_dsl::syntax::{comments, parse, parse_expression};
use flank_chain_dsl::{Diagnostic, FileId, Sources, Span, compile_text, derivation, render};
use flank_expr::{Graph, Style};

use crate::layout::check_layout;

const FILE: FileId = FileId(0);

/// The parser has an answer to any text, and its places lie in the text.
pub fn fuzz_parser(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let (_, diagnostics) = parse(&text, FILE);
    places_lie_in(&text, &diagnostics);
    shown(&text, &diagnostics);
    let mut last = 0;
    for comment in comments(&text, FILE) {
        assert!(last <= comment.span.start && comment.span.start <= comment.span.end, "comments in order");
        last = comment.span.end;
    }
    let (_, diagnostics) = parse_expression(&text, FILE, 0);
    places_lie_in(&text, &diagnostics);
}

/// Any text means something or has an error; what means something can be printed.
pub fn fuzz_meaning(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let (_, syntax) = parse(&text, FILE);
    let graph = Graph::new();
    let compilation = compile_text(&graph, "fuzzed", &text, &[]);
    let told = render(&compilation.diagnostics, &compilation.sources, false);
    assert_eq!(compilation.diagnostics.is_empty(), told.is_empty());
    assert!(syntax.is_empty() || compilation.has_errors(), "what the parser found is told");
    places_lie_in(&text, &compilation.diagnostics);
    for job in &compilation.jobs {
        derivation(job, Style::Text);
        job.bindings();
    }
}

/// Whatever parses is laid out; the layout means the same, keeps the comments, and is its own layout.
pub fn fuzz_layout(data: &[u8]) {
    check_layout(&String::from_utf8_lossy(data), "fuzzed");
}

fn places_lie_in(text: &str, diagnostics: &[Diagnostic]) {
    for diagnostic in diagnostics {
        let notes = diagnostic.notes.iter().map(|note| note.span);
        let places = notes.chain(diagnostic.cures.iter().map(|cure| cure.span)).chain([diagnostic.span]);
        for Span { start, end, .. } in places {
            let (start, end) = (start as usize, end as usize);
            assert!(text.get(start..end).is_some(), "{start}..{end} is no part of the text: {diagnostic:?}");
        }
    }
}

fn shown(text: &str, diagnostics: &[Diagnostic]) {
    let mut sources = Sources::default();
    sources.add("fuzzed", text);
    assert_eq!(diagnostics.is_empty(), render(diagnostics, &sources, false).is_empty());
}

//! What must hold for the layout of any text.

use flank_chain_dsl::syntax::{comments, parse};
use flank_chain_dsl::{Code, FileId, format};

const FILE: FileId = FileId(0);

/// The tree of a text without its places, if it has one.
pub fn meaning(text: &str) -> Option<String> {
    let (file, diagnostics) = parse(text, FILE);
    diagnostics.is_empty().then(|| without_spans(&format!("{file:?}")))
}

fn without_spans(tree: &str) -> String {
    const SPAN: &str = "Span { file: FileId(0), start: ";
    let mut parts = tree.split(SPAN);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once('}').expect("the end of a span").1)
}

/// What each comment says and of what kind it is.
fn remarks(text: &str) -> Vec<String> {
    let found = comments(text, FILE).into_iter();
    found
        .map(|comment| {
            let said = &text[comment.span.start as usize..comment.span.end as usize];
            format!("{said} {:?} {}", comment.kind, comment.own_line)
        })
        .collect()
}

/// Asks of the layout of a text what must hold for all: it means the same, keeps the comments, and is its own layout. False
/// if the text does not parse, or would become longer than a file may be.
pub fn check_layout(text: &str, name: &str) -> bool {
    let Some(meaning) = meaning(text) else {
        assert!(format(text, FILE).is_err(), "{name}");
        return false;
    };
    let laid_out = match format(text, FILE) {
        Ok(laid_out) => laid_out,
        Err(findings) => {
            assert!(findings.iter().all(|finding| finding.code == Code::LimitExceeded), "{name}: {findings:?}");
            return false;
        }
    };
    assert_eq!(self::meaning(&laid_out).as_ref(), Some(&meaning), "{name}\n{text}\n-----\n{laid_out}");
    assert_eq!(remarks(&laid_out), remarks(text), "{name}\n{text}\n-----\n{laid_out}");
    let again = format(&laid_out, FILE).expect("a layout parses");
    let change = laid_out.lines().zip(again.lines()).find(|(once, twice)| once != twice);
    assert!(laid_out == again, "{name}: laid out again, it changes at {change:#?}\n{text}\n-----\n{laid_out}");
    assert!(
        !laid_out.contains("\r\n") && !laid_out.contains(" \n") && !laid_out.contains("\n\n\n"),
        "{name}\n{laid_out}"
    );
    assert!(laid_out.is_empty() || laid_out.ends_with('\n') && !laid_out.ends_with("\n\n"), "{name}");
    assert!(!laid_out.starts_with(['\u{feff}', '\n', ' ']), "{name}");
    true
}

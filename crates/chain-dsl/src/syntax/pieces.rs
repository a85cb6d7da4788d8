//! Where statements and items begin and end in a text that does not parse.

use super::scan::{Kind, Scan};
use super::words::{self, Reserved};

/// Whether a token begins a statement or an item, as far as one can see without parsing.
pub(super) fn begins(scan: &Scan, index: usize) -> bool {
    // elsewhere it says where something is expected
    let is_inside = scan.say(index) == "at" && scan.say(index + 1) != "=";
    if !scan.is_opening_word(index) || is_inside {
        return false;
    }
    let after_end = index.checked_sub(1).is_none_or(|before| ends_something(scan, before));
    after_end || (scan.indent(index).is_some() && goes_on(scan, index))
}

/// Whether what follows a word makes it the beginning of a statement.
fn goes_on(scan: &Scan, index: usize) -> bool {
    match scan.kind(index + 1) {
        Some(Kind::Sign) => scan.say(index) == "at",
        Some(Kind::Number) => false,
        _ => true,
    }
}

pub(super) fn ends_something(scan: &Scan, index: usize) -> bool {
    match scan.kind(index) {
        Some(Kind::Word) => words::reserved(scan.say(index)) != Some(Reserved::Keyword),
        Some(Kind::Sign) => matches!(scan.say(index), ")" | "]" | "}" | "{"),
        _ => true,
    }
}

/// Whether a token begins an item and cannot begin a statement in a job.
pub(super) fn begins_item(scan: &Scan, index: usize) -> bool {
    match scan.say(index) {
        "use" | "fn" | "job" => true,
        "machine" | "tool" => scan.say(index + 2) != "=",
        _ => false,
    }
}

/// Like [`begins_item`], for the inside of a job, where `machine m cradle(…)` is more likely to lack its `=`.
pub(super) fn begins_item_in_job(scan: &Scan, index: usize) -> bool {
    match scan.say(index) {
        "machine" | "tool" => matches!(scan.say(index + 2), "{" | "extends"),
        _ => begins_item(scan, index),
    }
}

/// One past the last token of the statement that begins at a token.
pub(super) fn statement_end(scan: &Scan, from: usize) -> usize {
    let sample = scan.say(from) == "sample";
    let named = names_end(scan, from);
    let opened = (from + 1..=named).any(|index| scan.say(index) == "{");
    let lacks_brace = sample && !opened && scan.say(named + 1) == ":";
    let (mut braces, mut brackets) = (usize::from(lacks_brace), 0usize);
    for index in from + 1..scan.tokens.len() {
        match scan.say(index) {
            "{" => braces += 1,
            "}" if braces == 0 || (sample && closes_outer(scan, index, from)) => return index,
            "}" if braces == 1 => return index + 1,
            "}" => braces -= 1,
            "(" | "[" => brackets += 1,
            ")" | "]" => brackets = brackets.saturating_sub(1),
            next => {
                // a sample may lack its `}`, and its own lines may begin with `require`
                let beside = sample && scan.indent(index).is_some() && !is_right_of(scan, index, from);
                let inside = braces > 0 && !beside;
                let label = brackets > 0 && matches!(scan.say(index + 1), ":" | "," | ")" | ".");
                if !next.is_empty() && !inside && !label && begins(scan, index) {
                    return index;
                }
            }
        }
    }
    scan.tokens.len()
}

/// One past the names of a sample that begins at a token, and what is different for them: `sample left, right.edge as root_row`,
/// `sample left, right for side in [1, -1]`.
fn names_end(scan: &Scan, from: usize) -> usize {
    let mut end = from + 2;
    loop {
        match scan.say(end) {
            "." | "," => end += 2,
            "as" if scan.say(end + 1) != ":" => end += 2,
            "for" if scan.say(end + 2) == "in" => {
                let behind = (end + 3..scan.tokens.len()).find(|&index| matches!(scan.say(index), "]" | "{" | "}"));
                return behind.map_or(end, |index| index + usize::from(scan.say(index) == "]"));
            }
            _ => return end,
        }
    }
}

/// One past the last token of the segment of a profile that begins at a token.
pub(super) fn segment_end(scan: &Scan, from: usize) -> usize {
    let mut open = 0usize;
    for index in from + 1..scan.tokens.len() {
        match scan.say(index) {
            "}" => return index,
            "(" | "[" => open += 1,
            ")" | "]" => open = open.saturating_sub(1),
            _ if begins(scan, index) => return index,
            _ if begins_segment(scan, index) && (open == 0 || scan.indent(index).is_some()) => return index,
            _ => {}
        }
    }
    scan.tokens.len()
}

/// Whether a token is the name of a segment of a profile.
pub(super) fn begins_segment(scan: &Scan, index: usize) -> bool {
    scan.kind(index) == Some(Kind::Word) && scan.say(index + 1) == "="
}

/// One past the last token of the `use` or `fn` that begins at a token.
pub(super) fn flat_item_end(scan: &Scan, from: usize) -> usize {
    let mut braces = 0usize;
    let mut assigned = false;
    for index in from + 1..scan.tokens.len() {
        match scan.say(index) {
            "=" => assigned = true,
            "{" => braces += 1,
            "}" if braces <= 1 => return index + braces,
            "}" => braces -= 1,
            // without an `=` it must be the form with braces
            "let" if braces > 0 || !assigned => braces = braces.max(1),
            _ if begins(scan, index) => return index,
            _ => {}
        }
    }
    scan.tokens.len()
}

/// One past the opening brace of the block that begins at a token, or where the lack of one shows.
pub(super) fn head_end(scan: &Scan, from: usize) -> usize {
    for index in from + 1..scan.tokens.len() {
        let name = index == from + 1 && scan.indent(index).is_none();
        match scan.say(index) {
            "{" => return index + 1,
            "}" => return index,
            _ if !name && begins(scan, index) => return index,
            _ => {}
        }
    }
    scan.tokens.len()
}

/// One past the last token of something that begins like no statement: the next statement, or the next line that begins
/// with a name and stands no further right.
pub(super) fn unknown_end(scan: &Scan, from: usize) -> usize {
    let end = statement_end(scan, from);
    let mut open = 0usize;
    for index in from + 1..end {
        match scan.say(index) {
            "(" | "[" | "{" => open += 1,
            ")" | "]" | "}" => open = open.saturating_sub(1),
            _ if open > 0 || !scan.is_name(index) || !ends_something(scan, index - 1) => {}
            _ if !is_right_of(scan, index, from) => return index,
            _ => {}
        }
    }
    end
}

/// The next token that begins an item.
pub(super) fn next_item(scan: &Scan, from: usize) -> usize {
    (from..scan.tokens.len())
        .find(|&index| begins(scan, index) && begins_item(scan, index))
        .unwrap_or(scan.tokens.len())
}

/// Whether a closing brace stands further left than the block that it would close, in a text that lacks closing braces.
pub(super) fn closes_outer(scan: &Scan, brace: usize, head: usize) -> bool {
    scan.lacks_closing_brace
        && matches!((scan.indent(brace), scan.indent(head)), (Some(brace), Some(head)) if brace < head)
}

/// Whether a token stands further right than another, or not at the beginning of a line.
pub(super) fn is_right_of(scan: &Scan, index: usize, other: usize) -> bool {
    match (scan.indent(index), scan.indent(other)) {
        (Some(index), Some(other)) => index > other,
        (None, _) => true,
        (Some(_), None) => false,
    }
}

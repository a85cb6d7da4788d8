//! Numbers and words as files and pictures show them.

pub(crate) mod number;
pub(crate) mod xml;

pub use crate::text::number::{dimension, fixed, levelled, residual, shown_unit, with_minus};
pub use crate::text::xml::escaped;

/// Text that stays on its line and reads from left to right, whatever a user has put into it: control characters, line ends and marks
/// of direction become blanks.
pub fn one_line(text: &str) -> String {
    let is_harmless = |c: char| {
        let is_mark =
            matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        !c.is_control() && !is_mark
    };
    text.chars().map(|c| if is_harmless(c) { c } else { ' ' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_turns_its_line_or_leaves_it() {
        assert_eq!(one_line("a\u{202e}b\u{2066}c\nd\u{2028}e \u{5d0} \u{3a9}"), "a b c d e \u{5d0} \u{3a9}");
    }
}

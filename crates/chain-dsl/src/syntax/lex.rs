//! Single words and signs.

use super::scan::Kind;

/// Kind and length of the token at the start of a text.
pub(super) fn token(text: &str, first: char) -> (Kind, usize) {
    match first {
        '"' => match text[1..].find(['"', '\n', '\r']) {
            Some(end) if text.as_bytes()[end + 1] == b'"' => (Kind::Text, end + 2),
            Some(end) => (Kind::OpenText, text[..end + 1].trim_end().len()),
            None => (Kind::OpenText, text.trim_end().len()),
        },
        '0'..='9' => (Kind::Number, number_length(text.as_bytes())),
        _ if is_word_start(first) => (Kind::Word, text.find(|c| !is_word_part(c)).unwrap_or(text.len())),
        _ => match sign_length(text) {
            0 => (Kind::Strange, first.len_utf8()),
            length => (Kind::Sign, length),
        },
    }
}

fn sign_length(text: &str) -> usize {
    const TWO: [&str; 6] = ["..", "->", "<=", ">=", "==", "!="];
    const ONE: &str = "{}()[],:=.+-*/^<>";
    if TWO.iter().any(|sign| text.starts_with(sign)) { 2 } else { usize::from(text.starts_with(|c| ONE.contains(c))) }
}

fn number_length(text: &[u8]) -> usize {
    let digits = |from: usize| text[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut length = digits(0);
    if text.get(length) == Some(&b'.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if matches!(text.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(length + 1), Some(b'+' | b'-')));
        if digits(length + 1 + sign) > 0 {
            length += 1 + sign + digits(length + 1 + sign);
        }
    }
    length
}

/// Whether a character shows nothing of itself.
pub(super) fn is_invisible(c: char) -> bool {
    c.is_control()
        || c.is_whitespace()
        || matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

fn is_word_start(c: char) -> bool {
    c == '_' || c.is_ascii_alphabetic() || (!c.is_ascii() && pest::unicode::XID_START(c))
}

fn is_word_part(c: char) -> bool {
    c == '_' || c.is_ascii_alphanumeric() || (!c.is_ascii() && pest::unicode::XID_CONTINUE(c))
}

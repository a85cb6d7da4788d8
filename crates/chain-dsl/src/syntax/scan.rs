//! The text as a row of words and signs, without regard to what they mean: enough to find where statements begin, what
//! brackets are open, and which word a message should underline.

use std::ops::Range;

use crate::diagnostics::source::{FileId, Span};

use super::lex::{is_invisible, token};
use super::{pieces, words};

/// One comment.
#[derive(Clone, Debug, PartialEq)]
pub struct Comment {
    /// From the first slash to the end of the line, without the line end.
    pub span: Span,
    /// Plain, or documentation.
    pub kind: CommentKind,
    /// Whether nothing but white space stands before it on its line.
    pub own_line: bool,
}

/// Kinds of comments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CommentKind {
    /// `// …`
    Plain,
    /// `/// …`
    Doc,
    /// `//! …`
    FileDoc,
}

/// What a token looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A name, a keyword, a unit.
    Word,
    /// Digits with fraction and exponent.
    Number,
    /// `"text"`
    Text,
    /// `"text` up to the end of the line.
    OpenText,
    /// A sign of the language.
    Sign,
    /// Anything else, one character.
    Strange,
}

/// A word or a sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) start: u32,
    pub(super) end: u32,
    /// The columns before it if it is the first on its line.
    pub(super) indent: Option<u32>,
}

/// A text cut into tokens and comments.
pub(super) struct Scan<'t> {
    pub(super) text: &'t str,
    pub(super) file: FileId,
    pub(super) tokens: Vec<Token>,
    pub(super) comments: Vec<Comment>,
    /// Whether there are more opening than closing braces.
    pub(super) lacks_closing_brace: bool,
}

impl<'t> Scan<'t> {
    pub(super) fn new(text: &'t str, file: FileId) -> Scan<'t> {
        let mut scan = Scan { text, file, tokens: Vec::new(), comments: Vec::new(), lacks_closing_brace: false };
        let mut at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let mut line = Some(at);
        while let Some(first) = text[at..].chars().next() {
            let start = at;
            if matches!(first, '\n' | '\r') {
                at += 1;
                line = Some(at);
            } else if matches!(first, ' ' | '\t') {
                at += 1;
            } else if text[at..].starts_with("//") {
                at += text[at..].find(['\n', '\r']).unwrap_or(text.len() - at);
                scan.comment(start..at, line.is_some());
            } else {
                let (kind, length) = token(&text[at..], first);
                at += length;
                let span = scan.span(start..at);
                let indent = line.take().map(|line| (start - line) as u32);
                scan.tokens.push(Token { kind, start: span.start, end: span.end, indent });
            }
        }
        let count = |brace| (0..scan.tokens.len()).filter(|&index| scan.say(index) == brace).count();
        scan.lacks_closing_brace = count("{") > count("}");
        scan
    }

    fn comment(&mut self, range: Range<usize>, own_line: bool) {
        let text = &self.text[range.clone()];
        let kind = if text.starts_with("//!") {
            CommentKind::FileDoc
        } else if text.starts_with("///") && !text.starts_with("////") {
            CommentKind::Doc
        } else {
            CommentKind::Plain
        };
        let range = range.start..range.start + text.trim_end().len();
        self.comments.push(Comment { span: self.span(range), kind, own_line });
    }

    /// A range of bytes as a place. The limit on the length of a file makes it fit.
    pub(super) fn span(&self, range: Range<usize>) -> Span {
        Span { file: self.file, start: range.start as u32, end: range.end as u32 }
    }

    /// The place of a token; the end of the text where there is none.
    pub(super) fn place(&self, index: usize) -> Span {
        let end = self.text.len() as u32;
        let (start, end) = self.tokens.get(index).map_or((end, end), |token| (token.start, token.end));
        Span { file: self.file, start, end }
    }

    /// What a token says; nothing where there is none.
    pub(super) fn say(&self, index: usize) -> &'t str {
        self.tokens.get(index).map_or("", |token| &self.text[token.start as usize..token.end as usize])
    }

    /// Whether a name, a number or a text has more than so many characters.
    pub(super) fn is_longer(&self, index: usize, characters: usize) -> bool {
        let is_word = matches!(self.kind(index), Some(Kind::Word | Kind::Number | Kind::Text));
        let word = self.say(index);
        is_word && word.len() > characters && word.chars().count() > characters
    }

    /// A token as messages quote it.
    pub(super) fn quote(&self, index: usize) -> String {
        match (self.kind(index), self.say(index).chars().next()) {
            (Some(Kind::Strange), Some(c)) if is_invisible(c) => {
                format!("the character U+{:04X}", c as u32)
            }
            (Some(Kind::OpenText), _) => "an open text".to_owned(),
            _ => format!("`{}`", self.short(index)),
        }
    }

    /// What a token says, if need be only the beginning of it.
    pub(super) fn short(&self, index: usize) -> String {
        shorten(self.say(index))
    }

    /// Kind of a token.
    pub(super) fn kind(&self, index: usize) -> Option<Kind> {
        self.tokens.get(index).map(|token| token.kind)
    }

    /// The columns before a token if it is the first on its line.
    pub(super) fn indent(&self, index: usize) -> Option<u32> {
        self.tokens.get(index)?.indent
    }

    /// Whether a token begins an item or a statement somewhere. A word that may also be a name does so before another name or
    /// a brace, where something has ended.
    pub(super) fn is_opening_word(&self, index: usize) -> bool {
        let word = self.say(index);
        let before = index.checked_sub(1);
        let introduces = || {
            let next = self.say(index + 1);
            (self.is_name(index + 1) || next == "{" || (word == "expect" && self.begins_expectation(index)))
                && before.is_none_or(|before| pieces::ends_something(self, before))
        };
        // what is expected may have any name, and may be an error
        let is_expected = self.indent(index).is_none() && before.is_some_and(|before| self.say(before) == "expect");
        self.kind(index) == Some(Kind::Word)
            && words::begins_statement(word)
            && (words::reserved(word).is_some() || (introduces() && !is_expected))
    }

    /// Whether `expect` at the beginning of a line is followed by what it may expect, and not by what makes it a name.
    fn begins_expectation(&self, index: usize) -> bool {
        let next = self.say(index + 1);
        next == "on"
            || (self.indent(index).is_some()
                && (matches!(next, "(" | "[" | "-" | "if") || self.kind(index + 1) == Some(Kind::Number)))
    }

    /// The place from one token to the last before another.
    pub(super) fn extent(&self, range: Range<usize>) -> Span {
        let last = range.end.saturating_sub(1).max(range.start);
        self.place(range.start).to(self.place(last))
    }

    /// Whether there is such a token and it may be a name.
    pub(super) fn is_name(&self, index: usize) -> bool {
        self.kind(index) == Some(Kind::Word) && words::reserved(self.say(index)).is_none()
    }

    /// Index of the first token that ends after a place.
    pub(super) fn token_at(&self, place: usize) -> usize {
        self.tokens.partition_point(|token| token.end as usize <= place)
    }

    /// The lines of documentation right above a place.
    pub(super) fn doc_above(&self, place: u32) -> Vec<String> {
        let before = self.tokens.partition_point(|token| token.start < place);
        let from = before.checked_sub(1).map_or(0, |index| self.tokens[index].end);
        let first = self.comments.partition_point(|comment| comment.span.start < from);
        let last = self.comments.partition_point(|comment| comment.span.start < place);
        self.doc_lines(&self.comments[first..last], CommentKind::Doc)
    }

    /// The documentation at the top of the file.
    pub(super) fn file_doc(&self) -> Vec<String> {
        let first = self.tokens.first().map_or(u32::MAX, |token| token.start);
        let end = self.comments.partition_point(|comment| comment.span.start < first);
        self.doc_lines(&self.comments[..end], CommentKind::FileDoc)
    }

    fn doc_lines(&self, comments: &[Comment], kind: CommentKind) -> Vec<String> {
        let own = comments.iter().filter(|comment| comment.kind == kind && comment.own_line);
        own.map(|comment| {
            let line = &self.text[comment.span.start as usize + 3..comment.span.end as usize];
            line.strip_prefix(' ').unwrap_or(line).to_owned()
        })
        .collect()
    }
}

/// A word, or the beginning of a long one.
pub(super) fn shorten(word: &str) -> String {
    const LONGEST: usize = 40;
    match word.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &word[..end]),
        None => word.to_owned(),
    }
}

//! Words and signs with the comments around them.

use std::iter::Peekable;
use std::slice::Iter;

use crate::diagnostics::source::line_starts;
use crate::syntax::{Comment, CommentKind};

/// A word or a sign.
#[derive(Debug, Default)]
pub(super) struct Token {
    /// As it is printed.
    pub(super) text: String,
    /// Comments on lines of their own before it.
    pub(super) above: Vec<Remark>,
    /// The comment that ends its line.
    pub(super) behind: Option<String>,
    /// Whether an empty line stands before it, below its comments.
    pub(super) blank: bool,
    /// Whether it was the first on its line.
    pub(super) starts_line: bool,
    /// How many comments stand before it in the text.
    pub(super) comments_before: usize,
}

/// A comment on a line of its own.
#[derive(Debug)]
pub(super) struct Remark {
    pub(super) text: String,
    pub(super) kind: CommentKind,
    /// Whether an empty line stands before it.
    pub(super) blank: bool,
}

impl Token {
    /// Whether an empty line stands before it and its comments.
    pub(super) fn begins_paragraph(&self) -> bool {
        self.above.first().map_or(self.blank, |first| first.blank)
    }
}

/// Puts tokens in a row, each with the comments before it.
pub(super) struct Tokens<'t> {
    text: &'t str,
    comments: Peekable<Iter<'t, Comment>>,
    count: usize,
    /// Where the last token or comment ends.
    end: usize,
    pub(super) row: Vec<Token>,
}

impl<'t> Tokens<'t> {
    pub(super) fn new(text: &'t str, comments: &'t [Comment]) -> Tokens<'t> {
        Tokens { text, comments: comments.iter().peekable(), count: 0, end: 0, row: Vec::new() }
    }

    /// Adds the token that stands in a range of the text; gives its index.
    pub(super) fn push(&mut self, start: usize, length: usize, text: String) -> usize {
        let last_end = self.end;
        let mut above = Vec::new();
        while let Some(comment) = self.comments.next_if(|comment| (comment.span.start as usize) < start) {
            self.count += 1;
            let place = comment.span.start as usize..comment.span.end as usize;
            let text = self.text[place.clone()].to_owned();
            match self.row.last_mut() {
                Some(last) if !comment.own_line => last.behind = Some(text),
                _ => above.push(Remark { text, kind: comment.kind, blank: self.blank_before(place.start) }),
            }
            self.end = place.end;
        }
        self.row.push(Token {
            text,
            above,
            behind: None,
            blank: self.blank_before(start),
            starts_line: self.text[last_end..start].contains(['\n', '\r']),
            comments_before: self.count,
        });
        self.end = start + length;
        self.row.len() - 1
    }

    /// Adds a token without a text, before which the comments at the end of the file stand.
    pub(super) fn finish(mut self) -> Vec<Token> {
        self.push(self.text.len(), 0, String::new());
        self.row
    }

    fn blank_before(&self, start: usize) -> bool {
        line_starts(&self.text[self.end..start]).count() > 1
    }
}

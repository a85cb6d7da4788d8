//! The text: grammar, parser, tree.
//!
//! [`parse`] reads a whole file by the strict grammar (`grammar.pest`). Only if that fails is the text cut into pieces, each
//! piece parsed by itself, and each mistake reported; see `recover`. Nothing of the grammar's machinery leaves this module.

pub mod ast;

mod build;
mod concrete;
mod expected;
mod explain;
mod grammar;
mod lex;
mod limits;
mod pieces;
mod possible;
mod recover;
mod salvage;
mod scan;
#[cfg(test)]
mod tests;
mod words;

use crate::diagnostics::source::{FileId, Span};
use crate::diagnostics::{Diagnostic, Severity};

pub(crate) use concrete::{Kind, Part};
pub use possible::{Piece, Possible, possible_behind};
pub use scan::{Comment, CommentKind};
pub use words::Vocabulary;

/// Reads a text. Never fails: what did not parse is reported, and what stands around it is in the tree.
///
/// A broken statement that gives a name to something still does so, with [`ast::ExpressionKind::Error`] as its value. Where
/// even a name is missing, it is the empty string; whoever meets one says nothing, for it has been reported.
pub fn parse(text: &str, file: FileId) -> (ast::File, Vec<Diagnostic>) {
    if let Some(diagnostic) = limits::too_long(text, file) {
        return (ast::File::default(), vec![diagnostic]);
    }
    let scan = scan::Scan::new(text, file);
    if limits::first_excess(&scan, 0..scan.tokens.len()).is_some() {
        return recover::file(&scan, None);
    }
    match grammar::strict(grammar::Rule::file, text) {
        Ok(pairs) => build::file(&scan, pairs),
        Err(failure) => recover::file(&scan, Some(&failure)),
    }
}

/// Reads a text from a place on as one expression, such as the value of a setting on the command line. Never fails, like
/// [`parse`]; places are those in the whole text.
pub fn parse_expression(text: &str, file: FileId, start: u32) -> (ast::Expression, Vec<Diagnostic>) {
    let start = start as usize;
    if let Some(diagnostic) = limits::too_long(text, file) {
        let kind = ast::ExpressionKind::Error;
        return (ast::Expression { kind, span: diagnostic.span }, vec![diagnostic]);
    }
    let blank = " ".repeat(start);
    recover::expression(&scan::Scan::new(&format!("{blank}{}", &text[start..]), file), start)
}

/// The items of a text with all their words and signs, or everything that is wrong with it.
pub(crate) fn concrete(text: &str, file: FileId) -> Result<Vec<Part<'_>>, Vec<Diagnostic>> {
    let (_, diagnostics) = parse(text, file);
    if diagnostics.iter().any(|finding| finding.severity() == Severity::Error) {
        return Err(diagnostics);
    }
    let pairs = grammar::strict(grammar::Rule::file, text);
    Ok(pairs.map_or_else(|_| unreachable!("what parses obeys the grammar"), concrete::items))
}

/// The report on a text that is longer than a file may be.
pub(crate) fn too_long(text: &str, file: FileId) -> Option<Diagnostic> {
    limits::too_long(text, file)
}

/// Whether a word belongs to the language, so that nothing can be called by it.
pub fn is_reserved(word: &str) -> bool {
    words::reserved(word).is_some()
}

/// A word or a sign of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// Where it stands.
    pub span: Span,
    /// What it looks like.
    pub kind: TokenKind,
}

/// What a word or a sign looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// A name, a keyword, a unit.
    Word,
    /// Digits with fraction and exponent.
    Number,
    /// `"text"`, perhaps without its end.
    Text,
    /// A sign of the language.
    Sign,
    /// Anything else.
    Strange,
}

/// All words and signs of a text, in order.
pub fn tokens(text: &str, file: FileId) -> Vec<Token> {
    if limits::too_long(text, file).is_some() {
        return Vec::new();
    }
    let scan = scan::Scan::new(text, file);
    let kind = |kind| match kind {
        scan::Kind::Word => TokenKind::Word,
        scan::Kind::Number => TokenKind::Number,
        scan::Kind::Text | scan::Kind::OpenText => TokenKind::Text,
        scan::Kind::Sign => TokenKind::Sign,
        scan::Kind::Strange => TokenKind::Strange,
    };
    let tokens = scan.tokens.iter();
    let span = |token: &scan::Token| Span { file, start: token.start, end: token.end };
    tokens.map(|token| Token { span: span(token), kind: kind(token.kind) }).collect()
}

/// The words of the language.
pub fn vocabulary() -> Vocabulary {
    words::vocabulary()
}

/// All comments of a text, in order.
pub fn comments(text: &str, file: FileId) -> Vec<Comment> {
    if limits::too_long(text, file).is_some() { Vec::new() } else { scan::Scan::new(text, file).comments }
}

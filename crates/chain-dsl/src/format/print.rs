//! Lines, and the comments between them.

use crate::syntax::CommentKind;

use super::STEP;
use super::tokens::{Remark, Token};
use super::tree::Family;

/// A line of the layout.
#[derive(Debug, Default)]
pub(super) struct Line {
    pub(super) indent: usize,
    pub(super) text: String,
    /// The comment that ends it.
    pub(super) behind: Option<String>,
    /// Spaces between text and comment beyond those that always stand there.
    pub(super) padding: usize,
    /// Whether it is a comment and nothing else.
    pub(super) is_remark: bool,
    /// What it is aligned with.
    pub(super) family: Option<Family>,
    /// Bytes of the text before which spaces may be added.
    pub(super) stops: Vec<usize>,
}

impl Line {
    /// Columns without the comment at its end.
    pub(super) fn width(&self) -> usize {
        self.indent + self.text.chars().count()
    }
}

/// Writes lines.
pub(super) struct Printer<'t> {
    pub(super) tokens: &'t [Token],
    lines: Vec<Line>,
    /// The line that is being written, if one is.
    line: Option<Line>,
    column: usize,
    /// Whether a space is due before the next word.
    space: bool,
    /// Whether the next word is a place at which its line may be aligned.
    stop: bool,
    family: Option<Family>,
}

impl<'t> Printer<'t> {
    pub(super) fn new(tokens: &'t [Token]) -> Printer<'t> {
        Printer { tokens, lines: Vec::new(), line: None, column: 0, space: false, stop: false, family: None }
    }

    /// All lines so far, without empty ones at the end.
    pub(super) fn finish(mut self) -> Vec<Line> {
        self.end_line();
        while self.lines.pop_if(|line| line.text.is_empty()).is_some() {}
        self.lines
    }

    /// Begins a line, unless one with nothing on it has just been begun.
    pub(super) fn newline(&mut self, indent: usize) {
        self.end_line();
        self.column = indent;
        self.space = false;
        self.line = Some(Line { indent, ..Line::default() });
    }

    /// Ends the line if one is being written.
    pub(super) fn end_line(&mut self) {
        self.lines.extend(self.line.take().filter(|line| !line.text.is_empty()));
    }

    /// Ends the line and leaves one empty, unless one is.
    pub(super) fn blank(&mut self) {
        self.end_line();
        if self.lines.last().is_some_and(|last| !last.text.is_empty()) {
            self.lines.push(Line::default());
        }
    }

    /// How many lines there are.
    pub(super) fn line_count(&self) -> usize {
        self.lines.len() + usize::from(self.line.as_ref().is_some_and(|line| !line.text.is_empty()))
    }

    /// Puts an empty line before the one with this index.
    pub(super) fn insert_blank(&mut self, index: usize) {
        if self.lines[..index].last().is_some_and(|last| !last.text.is_empty()) {
            self.lines.insert(index, Line::default());
        }
    }

    /// The column at which a token would stand.
    pub(super) fn column(&self, token: usize, indent: usize) -> usize {
        match &self.line {
            Some(line) if line.text.is_empty() => line.indent,
            Some(line) if line.behind.is_none() && self.tokens[token].above.is_empty() => {
                self.column + usize::from(self.space)
            }
            _ => indent + STEP,
        }
    }

    /// Asks for a space before the next word on the line.
    pub(super) fn space(&mut self) {
        self.space = true;
    }

    /// Says that the next word is a place at which its line may be aligned.
    pub(super) fn stop(&mut self) {
        self.stop = true;
    }

    /// Says what the next line is aligned with.
    pub(super) fn align(&mut self, family: Option<Family>) {
        self.family = family;
    }

    /// Writes a token with its comments. A line that has to end before it goes on further in than `indent`.
    pub(super) fn token(&mut self, index: usize, indent: usize) {
        let token = &self.tokens[index];
        if !token.above.is_empty() {
            let margin =
                self.line.as_ref().filter(|line| line.text.is_empty()).map_or(indent + STEP, |line| line.indent);
            self.remarks(token, margin);
        } else if self.line.as_ref().is_none_or(|line| line.behind.is_some()) {
            self.newline(indent + STEP);
        }
        self.text(&token.text);
        self.behind(token);
    }

    /// Writes the comma of an element, on its line also if a comment ends it.
    pub(super) fn comma(&mut self, index: usize, indent: usize) {
        if self.may_join(index) {
            self.space = false;
            self.text(",");
            self.behind(&self.tokens[index]);
        } else {
            self.token(index, indent);
        }
    }

    /// Leaves a comma out if no comment would move by that.
    pub(super) fn drop_comma(&mut self, index: usize, indent: usize) {
        if self.may_join(index) { self.behind(&self.tokens[index]) } else { self.token(index, indent) }
    }

    fn may_join(&self, comma: usize) -> bool {
        let comma = &self.tokens[comma];
        let has_comment = self.line.as_ref().is_none_or(|line| line.behind.is_some());
        comma.above.is_empty() && !(has_comment && comma.behind.is_some())
    }

    pub(super) fn behind(&mut self, token: &Token) {
        if let (Some(line), Some(behind)) = (&mut self.line, &token.behind) {
            line.behind = Some(behind.clone());
        }
    }

    /// Writes words as they are.
    pub(super) fn text(&mut self, text: &str) {
        let Some(line) = &mut self.line else { return };
        if line.text.is_empty() {
            line.family = self.family.take();
        } else if self.space {
            line.text.push(' ');
        }
        if std::mem::take(&mut self.stop) {
            line.stops.push(line.text.len());
        }
        line.text.push_str(text);
        self.space = false;
        self.column = line.width();
    }

    /// Writes the comments above a token, and begins the line for it.
    pub(super) fn remarks(&mut self, token: &Token, margin: usize) {
        let mut last: Option<CommentKind> = None;
        for remark in &token.above {
            self.pause(last, Some(remark.kind), remark.blank);
            self.remark(remark, margin);
            last = Some(remark.kind);
        }
        self.pause(last, None, token.blank);
        self.newline(margin);
    }

    fn remark(&mut self, remark: &Remark, margin: usize) {
        self.end_line();
        self.lines.push(Line { indent: margin, text: remark.text.clone(), is_remark: true, ..Line::default() });
    }

    /// An empty line below a comment if it was there: never below documentation of a statement, always below that of the file.
    fn pause(&mut self, last: Option<CommentKind>, next: Option<CommentKind>, blank: bool) {
        let wanted = match last {
            None | Some(CommentKind::Doc) => false,
            Some(CommentKind::FileDoc) => blank || next != Some(CommentKind::FileDoc),
            Some(CommentKind::Plain) => blank,
        };
        if wanted {
            self.blank();
        }
    }
}

/// The text of lines.
pub(super) fn joined(lines: &[Line]) -> String {
    let mut text = String::new();
    for line in lines {
        if !line.text.is_empty() {
            text.extend(std::iter::repeat_n(' ', line.indent));
        }
        text += &line.text;
        if let Some(behind) = &line.behind {
            text.extend(std::iter::repeat_n(' ', line.padding + BEFORE_COMMENT));
            text += behind;
        }
        text.push('\n');
    }
    text
}

/// Spaces between a line and the comment at its end.
const BEFORE_COMMENT: usize = 2;

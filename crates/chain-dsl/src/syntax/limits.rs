//! How long, how deep: what a text may ask for before anything recurses over it.

use std::ops::Range;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::source::{FileId, Span};
use crate::limits::{FILE_BYTES, NESTING, STATEMENT_TOKENS, WORD};

use super::scan::{Kind, Scan};

/// The report on a file that is too long.
pub(super) fn too_long(text: &str, file: FileId) -> Option<Diagnostic> {
    (text.len() > FILE_BYTES.most).then(|| FILE_BYTES.exceeded(Span { file, start: 0, end: 0 }))
}

/// The report on the first token of a range that goes too deep or too far.
pub(super) fn first_excess(scan: &Scan, range: Range<usize>) -> Option<Diagnostic> {
    let mut nesting = Nesting::default();
    let mut length = 0;
    for index in range {
        let begins = scan.is_opening_word(index);
        length = if begins { 0 } else { length + 1 };
        if begins {
            nesting = Nesting::default();
        }
        nesting.meet(scan, index);
        let limit = if nesting.depth > NESTING.most {
            NESTING
        } else if length > STATEMENT_TOKENS.most {
            STATEMENT_TOKENS
        } else if scan.is_longer(index, WORD.most) {
            WORD
        } else {
            continue;
        };
        return Some(limit.exceeded(scan.place(index)));
    }
    None
}

/// How deep a token lies.
#[derive(Default)]
struct Nesting {
    depth: usize,
    /// `if`s that were open when each open bracket was met.
    brackets: Vec<usize>,
    /// `if`s since the last open bracket or separator.
    conditions: usize,
    /// Signs before the operand to come.
    signs: usize,
    /// Whether an operand has just ended.
    after_operand: bool,
}

impl Nesting {
    fn meet(&mut self, scan: &Scan, index: usize) {
        let word = scan.say(index);
        let sign = matches!(word, "-" | "not") && !self.after_operand;
        self.depth -= if sign { 0 } else { std::mem::take(&mut self.signs) };
        match word {
            _ if sign => {
                self.signs += 1;
                self.depth += 1;
            }
            "(" | "[" | "{" => {
                self.brackets.push(std::mem::take(&mut self.conditions));
                self.depth += 1;
            }
            ")" | "]" | "}" => {
                self.forget_conditions();
                if let Some(conditions) = self.brackets.pop() {
                    self.conditions = conditions;
                    self.depth -= 1;
                }
            }
            "if" => {
                self.conditions += 1;
                self.depth += 1;
            }
            "," | ":" | "=" | ".." | "by" => self.forget_conditions(),
            _ => {}
        }
        self.after_operand = match scan.tokens[index].kind {
            Kind::Word => !matches!(word, "if" | "then" | "else" | "and" | "or" | "not" | "in" | "by"),
            Kind::Number | Kind::Text => true,
            _ => matches!(word, ")" | "]" | "}"),
        };
    }

    fn forget_conditions(&mut self) {
        self.depth -= std::mem::take(&mut self.conditions);
    }
}

//! Brackets that are not closed, and those that close nothing.

use crate::diagnostics::Diagnostic;

use super::Mistake;

impl Mistake<'_> {
    /// A closing bracket that fits to none that is open.
    pub(super) fn stray_bracket(&self) -> Option<Diagnostic> {
        let closes = matches!(self.say(), ")" | "]") && self.open_bracket().is_none();
        closes.then(|| self.here(format!("`{}` closes nothing", self.say())))
    }

    /// The innermost bracket that is open at the mistake.
    pub(super) fn open_bracket(&self) -> Option<usize> {
        let mut open = Vec::new();
        for index in self.range.start..self.found {
            match self.scan.say(index) {
                "(" | "[" | "{" => open.push(index),
                ")" | "]" | "}" => drop(open.pop()),
                _ => {}
            }
        }
        open.pop()
    }

    /// The innermost bracket that is open at the mistake, if it is not closed after it either.
    pub(super) fn unclosed_bracket(&self) -> Option<usize> {
        let open = self.open_bracket()?;
        let mut depth = 0usize;
        for index in self.found..self.range.end {
            match (self.scan.say(index), self.scan.say(open)) {
                ("(" | "[" | "{", _) => depth += 1,
                (")", "(") | ("]", "[") | ("}", "{") if depth == 0 => return None,
                (")" | "]" | "}", _) if depth == 0 => return Some(open),
                (")" | "]" | "}", _) => depth -= 1,
                _ => {}
            }
        }
        Some(open)
    }
}

//! From the grammar's pairs to the tree. What the grammar cannot say (each once, not too deep, commas or new lines) is
//! reported here.

mod expectations;
mod expressions;
mod items;
mod statements;
mod surfaces;

pub(super) use expressions::{NEGATE, NOT, operator};
pub(super) use items::Head;
pub(super) use surfaces::SurfaceParts;

use pest::iterators::{Pair, Pairs};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span, Spanned};
use crate::limits::POWER;

use super::ast::{self, Dimension, Path, Range};
use super::grammar::Rule;
use super::scan::Scan;

/// The tree of a text that the strict grammar accepts.
pub(super) fn file(scan: &Scan, pairs: Pairs<'_, Rule>) -> (ast::File, Vec<Diagnostic>) {
    let mut build = Build::new(scan);
    let items = pairs.filter_map(|pair| build.item(pair)).collect();
    (ast::File { doc: scan.file_doc(), items, lacks_files: false }, build.diagnostics)
}

/// Builds trees from pairs of a piece of the text.
pub(super) struct Build<'s> {
    scan: &'s Scan<'s>,
    /// Where the piece begins in the text.
    pub(super) offset: usize,
    pub(super) diagnostics: Vec<Diagnostic>,
    /// Whether the expression at hand was already found to be too high.
    too_high: bool,
    /// How deep the recursion over the expression at hand is.
    level: usize,
}

impl<'s> Build<'s> {
    pub(super) fn new(scan: &'s Scan<'s>) -> Build<'s> {
        Build { scan, offset: 0, diagnostics: Vec::new(), too_high: false, level: 0 }
    }

    fn report(&mut self, span: Span, message: impl Into<String>, help: &str) {
        self.diagnostics.push(Diagnostic::new(Code::Syntax, span, message).help(help));
    }

    /// The place of a pair, without the white space and the comments that the grammar takes in at its end.
    fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        let (start, end) = (pair.as_span().start() + self.offset, pair.as_span().end() + self.offset);
        let last = self.scan.tokens.partition_point(|token| (token.start as usize) < end);
        let end = last.checked_sub(1).map_or(end, |index| end.min(self.scan.tokens[index].end as usize));
        self.scan.span(start..end.max(start))
    }

    fn doc(&self, pair: &Pair<'_, Rule>) -> Vec<String> {
        self.scan.doc_above(self.span(pair).start)
    }

    fn name(&self, pair: Pair<'_, Rule>) -> Name {
        Spanned { node: pair.as_str().to_owned(), span: self.span(&pair) }
    }

    fn path(&self, pair: Pair<'_, Rule>) -> Path {
        let span = self.span(&pair);
        let names = pair.into_inner().filter(|part| part.as_rule() == Rule::name);
        Path { segments: names.map(|part| self.name(part)).collect(), span }
    }

    fn range(&mut self, pair: Pair<'_, Rule>) -> Range {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let low = self.expression(parts.required(Rule::expression));
        let high = self.expression(parts.required(Rule::expression));
        Range { low, high, span }
    }

    fn dimension(&mut self, pair: Pair<'_, Rule>) -> Dimension {
        let span = self.span(&pair);
        let mut factors = Vec::new();
        let mut sign = 1;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::dimension_operator => sign = if part.as_str() == "/" { -1 } else { 1 },
                _ => {
                    let mut parts = Parts::of(part);
                    if let Some(name) = parts.optional(Rule::dimension_name) {
                        let power = parts.optional(Rule::integer).map_or(1, |power| self.power(power));
                        factors.push((self.name(name), sign * power));
                    }
                }
            }
        }
        Dimension { factors, span }
    }

    fn power(&mut self, pair: Pair<'_, Rule>) -> i32 {
        let power = pair.as_str().parse().unwrap_or(i32::MAX);
        if power.unsigned_abs() as usize <= POWER.most {
            return power;
        }
        self.diagnostics.push(POWER.exceeded(self.span(&pair)));
        1
    }
}

/// The parts of a pair, one after the other, without the words and signs between them.
struct Parts<'i>(Pairs<'i, Rule>);

impl<'i> Parts<'i> {
    fn of(pair: Pair<'i, Rule>) -> Parts<'i> {
        Parts(pair.into_inner())
    }

    /// The next part, if it is of this kind.
    fn optional(&mut self, rule: Rule) -> Option<Pair<'i, Rule>> {
        while let Some(next) = self.0.peek() {
            if next.as_rule() == rule {
                return self.0.next();
            }
            if !is_mark(next.as_rule()) {
                return None;
            }
            self.0.next();
        }
        None
    }

    /// The next part, which the grammar says is of this kind.
    fn required(&mut self, rule: Rule) -> Pair<'i, Rule> {
        self.optional(rule).unwrap_or_else(|| unreachable!("the grammar has a {rule:?} here"))
    }

    /// All the next parts that are of this kind.
    fn all(&mut self, rule: Rule) -> Vec<Pair<'i, Rule>> {
        std::iter::from_fn(|| self.optional(rule)).collect()
    }
}

/// Whether a rule is only a word or sign between parts.
fn is_mark(rule: Rule) -> bool {
    use Rule::*;
    matches!(
        rule,
        kw_use
            | kw_fn
            | kw_machine
            | kw_extends
            | kw_tool
            | kw_job
            | kw_param
            | kw_let
            | kw_require
            | kw_axis
            | kw_frame
            | kw_error
            | kw_insert
            | kw_close
            | kw_about
            | kw_fix
            | kw_couple
            | kw_nc
            | kw_profile
            | kw_along
            | kw_surface
            | kw_at
            | kw_for
            | kw_body
            | kw_towards
            | kw_mount
            | kw_on
            | kw_motion
            | kw_unknown
            | kw_solid
            | kw_contact
            | kw_want
            | kw_with
            | kw_mill
            | kw_of
            | kw_passes
            | kw_side
            | kw_both
            | kw_ways
            | kw_clear
            | kw_drive
            | kw_trim
            | kw_cut
            | kw_sample
            | kw_as
            | kw_expect
            | kw_near
            | kw_within
            | kw_travel
            | kw_nothing
            | kw_keep
            | kw_step
            | kw_in
            | kw_runs
            | kw_by
            | kw_if
            | kw_then
            | kw_else
            | open_brace
            | close_brace
            | open_paren
            | open_group
            | close_paren
            | open_bracket
            | open_index
            | close_bracket
            | comma
            | colon
            | equals
            | arrow
            | dot
            | dots
            | caret
    )
}

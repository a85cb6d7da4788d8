//! What a spec is tested by.

use pest::iterators::Pair;

use crate::diagnostics::source::Span;

use super::super::ast::{Expectation, Expected, Instance};
use super::super::grammar::Rule;
use super::{Build, Parts};

impl Build<'_> {
    pub(super) fn expectation(&mut self, pair: Pair<'_, Rule>) -> Expectation {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let inner = [
            Rule::expected_error,
            Rule::expected_nothing,
            Rule::expected_travel,
            Rule::expected_on,
            Rule::expected_status,
            Rule::expected_value,
            Rule::expected_pose,
        ];
        let found = inner.into_iter().find_map(|rule| parts.optional(rule));
        let found = found.unwrap_or_else(|| unreachable!("the grammar has an expectation here"));
        let (what, about) = self.expected(found);
        Expectation { what, about, span }
    }

    fn expected(&mut self, pair: Pair<'_, Rule>) -> (Expected, String) {
        let rule = pair.as_rule();
        let mut parts = Parts::of(pair);
        match rule {
            Rule::expected_error => {
                let code = self.name(parts.required(Rule::error_code));
                (Expected::Error(code), "error".to_string())
            }
            Rule::expected_nothing => (Expected::Nothing, String::new()),
            Rule::expected_travel => (Expected::Travel, "travel".to_string()),
            Rule::expected_on => {
                let (definition, settings) = self.definition(parts.required(Rule::definition));
                let within = self.expression(parts.required(Rule::expression));
                let about = format!("on {}", definition.node);
                (Expected::On { machine: Instance { name: definition.clone(), definition, settings }, within }, about)
            }
            Rule::expected_status => {
                let surface = self.path(parts.required(Rule::path));
                let status = self.name(parts.required(Rule::status));
                let at = parts.optional(Rule::expression).map(|at| self.expression(at));
                let place = at.as_ref().map_or(String::new(), |at| format!(" at {}", self.words(at.span)));
                let about = format!("{}{place}", surface.joined());
                (Expected::Status { surface, status, at }, about)
            }
            Rule::expected_pose => {
                let frames = [self.name(parts.required(Rule::name)), self.name(parts.required(Rule::name))];
                let transforms = parts.all(Rule::call).into_iter().map(|call| self.call(call)).collect();
                let at = parts.required(Rule::settings);
                let about = format!("{} in {} at {}", frames[0].node, frames[1].node, self.words(self.span(&at)));
                let at = self.settings(at);
                let within = parts.all(Rule::expression).into_iter().map(|part| self.expression(part)).collect();
                (Expected::Pose { frames, transforms, at, within }, about)
            }
            _ => self.expected_value(parts),
        }
    }

    fn expected_value(&mut self, mut parts: Parts<'_>) -> (Expected, String) {
        let surface = parts.optional(Rule::path).map(|path| self.path(path));
        let value = self.expression(parts.required(Rule::expression));
        let of = surface.as_ref().map_or(String::new(), |surface| format!("{}: ", surface.joined()));
        let about = format!("{of}{}", self.words(value.span));
        if let Some(range) = parts.optional(Rule::range) {
            let range = self.range(range);
            return (Expected::InRange { surface, value, range }, about);
        }
        let target = self.expression(parts.required(Rule::expression));
        let within = self.expression(parts.required(Rule::expression));
        (Expected::Near { surface, value, target, within }, about)
    }

    /// The words and signs of a part of the text, without what a layout may change: blanks, comments, commas at the ends of lists.
    fn words(&self, span: Span) -> String {
        let tokens = &self.scan.tokens;
        let first = tokens.partition_point(|token| token.start < span.start);
        let last = tokens.partition_point(|token| token.start < span.end);
        let is_kept = |index: &usize| self.scan.say(*index) != "," || !matches!(self.scan.say(index + 1), ")" | "]");
        (first..last).filter(is_kept).map(|index| self.scan.say(index)).collect()
    }
}

//! The text as a tree of words and signs of which nothing is lost but white space and comments: what a layout is made from.

use std::iter::Peekable;
use std::vec::IntoIter;

use pest::iterators::{Pair, Pairs};

use super::build::{NEGATE, NOT, operator};
use super::grammar::Rule;

/// A word or a sign, or something that is made of several.
#[derive(Clone, Debug)]
pub(crate) struct Part<'t> {
    pub(crate) kind: Kind,
    /// Where its first word begins.
    pub(crate) start: usize,
    /// A word or a sign as written; of the others, only [`Kind::Number`] has a text.
    pub(crate) text: &'t str,
    /// What it is made of.
    pub(crate) parts: Vec<Part<'t>>,
}

/// What a [`Part`] is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A word, a sign, a path, a text.
    Token,
    /// A literal, and its unit, which may have blanks in it.
    Number,
    /// A statement, a `use`, a function without a block, the value at the end of a function's block.
    Statement,
    /// Words up to `{`, statements, `}`.
    Block,
    /// Brackets around elements with commas between them.
    List,
    /// Brackets around one expression.
    Group,
    /// `name: …` between brackets.
    Element,
    /// What stands without a space between: a name and its arguments, a value and its index, a dimension and its exponent.
    Joined,
    /// A sign or `not` and its operand.
    Signed,
    /// Base, `^`, exponent.
    Power,
    /// Operands with operators of one strength between them; `a .. b by n` also.
    Operation,
    /// `if`, condition, `then`, value, `else`, value.
    Conditional,
    /// Factors of a dimension, with their signs.
    Dimension,
    /// The transforms of a frame; names or values in a row, with their commas.
    Steps,
}

/// The items of a file.
pub(super) fn items(pairs: Pairs<'_, Rule>) -> Vec<Part<'_>> {
    let mut items = Vec::new();
    pairs.for_each(|pair| push(pair, &mut items));
    items
}

impl<'t> Part<'t> {
    fn leaf(kind: Kind, pair: &Pair<'t, Rule>) -> Part<'t> {
        Part { kind, start: pair.as_span().start(), text: pair.as_str(), parts: Vec::new() }
    }

    fn node(kind: Kind, parts: Vec<Part<'t>>) -> Part<'t> {
        Part { kind, start: parts.first().map_or(0, |part| part.start), text: "", parts }
    }

    /// Whether it is this word or sign.
    pub(crate) fn is(&self, text: &str) -> bool {
        self.kind == Kind::Token && self.text == text
    }
}

/// Adds what a pair stands for: one part, or all of its parts where the pair is only a name for them.
fn push<'t>(pair: Pair<'t, Rule>, parts: &mut Vec<Part<'t>>) {
    let kind = match pair.as_rule() {
        Rule::EOI => return,
        Rule::number => return parts.push(number(pair)),
        Rule::machine_head
        | Rule::tool_head
        | Rule::job_head
        | Rule::tool_surface_head
        | Rule::profile_head
        | Rule::closed_along
        | Rule::closed_about
        | Rule::expected_error
        | Rule::expected_nothing
        | Rule::expected_on
        | Rule::expected_travel
        | Rule::expected_status
        | Rule::expected_value
        | Rule::expected_pose
        | Rule::label
        | Rule::bound
        | Rule::coordinate => {
            return pair.into_inner().for_each(|inner| push(inner, parts));
        }
        // the grammar looks beyond the sign, and takes in white space and comments on the way
        Rule::equals => return parts.push(Part { text: &pair.as_str()[..1], ..Part::leaf(Kind::Token, &pair) }),
        Rule::expression => return parts.push(expression(pair)),
        Rule::function => return parts.push(function(pair)),
        Rule::motion | Rule::unknown => return parts.push(motion(pair)),
        Rule::frame | Rule::insert => return parts.push(frame(pair)),
        Rule::contact | Rule::close => return parts.push(one_row(pair)),
        Rule::nc_word => return parts.push(nc_word(pair)),
        Rule::entry => return parts.push(entry(pair)),
        Rule::limit => return parts.push(limit(pair)),
        Rule::passes | Rule::side_pass | Rule::along_passes => return parts.push(mill_run(pair)),
        Rule::attitude | Rule::both_ways | Rule::clearance => Kind::Statement,
        Rule::spacing => Kind::Steps,
        Rule::machine | Rule::tool | Rule::job | Rule::tool_surface | Rule::profile | Rule::mill => Kind::Block,
        Rule::variant | Rule::use_item | Rule::param | Rule::let_statement | Rule::axis | Rule::fix | Rule::couple => {
            Kind::Statement
        }
        Rule::at | Rule::body | Rule::machine_instance | Rule::tool_instance | Rule::mount => Kind::Statement,
        Rule::drive | Rule::surface | Rule::sample => Kind::Statement,
        Rule::trim | Rule::cut | Rule::solid | Rule::want | Rule::unknown_axis | Rule::error_term => Kind::Statement,
        Rule::segment | Rule::requirement => Kind::Statement,
        Rule::expectation | Rule::machine_expectation => return parts.push(expectation(pair)),
        Rule::formal | Rule::parameter | Rule::surface_parameter | Rule::setting => Kind::Element,
        Rule::argument | Rule::keep | Rule::kept_axis | Rule::sampled | Rule::change => Kind::Element,
        Rule::arguments | Rule::settings | Rule::changes | Rule::vector => Kind::List,
        Rule::group | Rule::index => Kind::Group,
        Rule::named if pair.clone().into_inner().all(|part| part.as_rule() != Rule::arguments) => {
            return parts.push(Part::leaf(Kind::Token, &pair));
        }
        Rule::definition | Rule::variant_of | Rule::value | Rule::named | Rule::call | Rule::dimension_factor => {
            Kind::Joined
        }
        Rule::value_type | Rule::size => Kind::Joined,
        Rule::range => Kind::Operation,
        Rule::dimension => Kind::Dimension,
        Rule::path => return parts.push(Part::leaf(Kind::Token, &pair)),
        _ if pair.clone().into_inner().next().is_none() => return parts.push(Part::leaf(Kind::Token, &pair)),
        _ => Kind::Statement,
    };
    let rule = pair.as_rule();
    let mut inner = inner(pair);
    if matches!(rule, Rule::drive | Rule::surface | Rule::sample | Rule::mount) {
        inner = rows(inner);
    }
    if matches!(kind, Kind::Block | Kind::Statement) {
        inner = listed(inner, if rule == Rule::sample { ("{", "}") } else { ("(", ")") });
    }
    match <[Part; 1]>::try_from(inner) {
        Ok([only]) if matches!(kind, Kind::Joined | Kind::Element) => parts.push(only),
        Ok(only) => parts.push(Part::node(kind, only.into())),
        Err(inner) => parts.push(Part::node(kind, inner)),
    }
}

fn number(pair: Pair<'_, Rule>) -> Part<'_> {
    let whole = Part::leaf(Kind::Number, &pair);
    Part { parts: pair.into_inner().map(|inner| Part::leaf(Kind::Token, &inner)).collect(), ..whole }
}

fn inner(pair: Pair<'_, Rule>) -> Vec<Part<'_>> {
    let mut parts = Vec::new();
    pair.into_inner().for_each(|inner| push(inner, &mut parts));
    parts
}

/// Makes one part of what stands from the opening bracket to the closing one, if they are there.
fn listed<'t>(mut parts: Vec<Part<'t>>, (open, close): (&str, &str)) -> Vec<Part<'t>> {
    let from = parts.iter().position(|part| part.is(open));
    let to = parts.iter().position(|part| part.is(close));
    if let (Some(from), Some(to)) = (from, to) {
        let list = Part::node(Kind::List, parts.drain(from..=to).collect());
        parts.insert(from, list);
    }
    parts
}

/// Makes one part of what stands in a row with commas between.
fn rows(parts: Vec<Part<'_>>) -> Vec<Part<'_>> {
    let braces = parts.iter().position(|part| part.is("{")).unwrap_or(parts.len());
    let mut rows: Vec<Part> = Vec::new();
    let mut parts = parts.into_iter();
    let mut listed = parts.by_ref().take(braces).peekable();
    while let Some(first) = listed.next() {
        let mut row = vec![first];
        while let Some(comma) = listed.next_if(|part| part.is(",")) {
            let before = row.pop().into_iter().chain([comma]).collect();
            row.push(Part::node(Kind::Element, before));
            row.extend(listed.next());
        }
        match <[Part; 1]>::try_from(row) {
            Ok([only]) => rows.push(only),
            Err(row) => rows.push(Part::node(Kind::Steps, row)),
        }
    }
    rows.extend(parts);
    rows
}

fn function(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = listed(inner(pair), ("(", ")"));
    if !parts.last().is_some_and(|last| last.is("}")) {
        return Part::node(Kind::Statement, parts);
    }
    let value = parts.len() - 2;
    let statement = Part::node(Kind::Statement, vec![parts.remove(value)]);
    parts.insert(value, statement);
    Part::node(Kind::Block, parts)
}

/// What stands behind the sign of a contact or a closed loop is one row, each part with the comma behind it.
fn one_row(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    let equals = parts.iter().position(|part| part.is("=")).map_or(parts.len(), |equals| equals + 1);
    let row = with_commas(parts.split_off(equals));
    parts.push(Part::node(Kind::Steps, row));
    Part::node(Kind::Statement, parts)
}

/// Each part with the comma behind it.
fn with_commas(parts: Vec<Part<'_>>) -> Vec<Part<'_>> {
    let mut row: Vec<Part> = Vec::new();
    for part in parts {
        match row.pop() {
            Some(before) if part.is(",") => row.push(Part::node(Kind::Element, vec![before, part])),
            before => row.extend(before.into_iter().chain([part])),
        }
    }
    row
}

/// An expectation is one row; where it does not fit, its place and its tolerance stand on lines of their own.
fn expectation(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    let head = parts.remove(0);
    if parts.len() > 1 && parts[1].is(":") {
        let of = Part::node(Kind::Element, parts.drain(..2).collect());
        parts.insert(0, of);
    }
    let mut behind = |word| parts.iter().position(|part| part.is(word)).map(|at| parts.split_off(at));
    let (tolerance, place) = (behind("within"), behind("at"));
    let rows = [Some(parts), place, tolerance.map(with_commas)].into_iter().flatten();
    let rows = rows.map(|row| one_of(Kind::Statement, row)).collect();
    Part::node(Kind::Statement, vec![head, one_of(Kind::Steps, rows)])
}

/// Several parts as one.
fn one_of(kind: Kind, parts: Vec<Part<'_>>) -> Part<'_> {
    match <[Part; 1]>::try_from(parts) {
        Ok([only]) => only,
        Err(parts) => Part::node(kind, parts),
    }
}

/// A motion's parameter is laid out like any other statement, unlike those between brackets.
fn motion(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = Vec::new();
    for inner in inner(pair) {
        if inner.kind == Kind::Element { parts.extend(inner.parts) } else { parts.push(inner) }
    }
    Part::node(Kind::Statement, parts)
}

fn frame(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    if let Some(equals) = parts.iter().position(|part| part.is("=")) {
        let calls = parts.split_off(equals + 1);
        parts.push(Part::node(Kind::Steps, calls));
    }
    Part::node(Kind::Statement, parts)
}

/// The increment stands in one row with the value.
fn nc_word(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    if let (Some(equals), true) = (parts.iter().position(|part| part.is("=")), parts.iter().any(|part| part.is("by"))) {
        let value = parts.split_off(equals + 1);
        parts.push(Part::node(Kind::Operation, value));
    }
    Part::node(Kind::Statement, parts)
}

fn entry(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    if let (Some(colon), true) = (parts.iter().position(|part| part.is(":")), parts.iter().any(|part| part.is(".."))) {
        let range = parts.split_off(colon + 1);
        parts.push(Part::node(Kind::Operation, range));
    }
    Part::node(Kind::Element, parts)
}

/// The coordinate and its range stand behind the first word as they do in a sample.
fn mill_run(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    let comma = parts.iter().position(|part| part.is(",")).unwrap_or(parts.len());
    let behind = parts.split_off(comma);
    let entry = Part::node(Kind::Element, parts.split_off(1));
    parts.push(entry);
    parts.extend(behind);
    Part::node(Kind::Statement, parts)
}

/// The message of a requirement may stand on a line of its own.
fn limit(pair: Pair<'_, Rule>) -> Part<'_> {
    let mut parts = inner(pair);
    let message = parts.pop();
    Part::node(Kind::Steps, [Part::node(Kind::Element, parts)].into_iter().chain(message).collect())
}

fn expression(pair: Pair<'_, Rule>) -> Part<'_> {
    let inner_pair = pair.into_inner().next().unwrap_or_else(|| unreachable!("the grammar has an expression here"));
    let is_conditional = inner_pair.as_rule() == Rule::conditional;
    let parts = inner(inner_pair);
    if is_conditional {
        return Part::node(Kind::Conditional, parts);
    }
    operation(&mut parts.into_iter().peekable(), 0)
}

/// Operands and operators that hold at least as tightly as `least`.
fn operation<'t>(row: &mut Peekable<IntoIter<Part<'t>>>, least: u8) -> Part<'t> {
    let mut left = operand(row);
    let mut left_strength = None;
    while let Some(sign) = row.next_if(|part| operator(part.text).1 >= least) {
        let strength = operator(sign.text).1;
        if sign.text == "^" {
            let exponent = operation(row, strength);
            left = Part::node(Kind::Power, vec![left, sign, exponent]);
            continue;
        }
        let right = operation(row, strength + 1);
        if left_strength == Some(strength) {
            left.parts.extend([sign, right]);
        } else {
            left = Part::node(Kind::Operation, vec![left, sign, right]);
        }
        left_strength = Some(strength);
    }
    left
}

fn operand<'t>(row: &mut Peekable<IntoIter<Part<'t>>>) -> Part<'t> {
    let first = row.next().unwrap_or_else(|| unreachable!("the grammar has an operand here"));
    let strength = match first.text {
        "not" => NOT,
        "-" => NEGATE,
        _ => return first,
    };
    let value = operation(row, strength);
    Part::node(Kind::Signed, vec![first, value])
}

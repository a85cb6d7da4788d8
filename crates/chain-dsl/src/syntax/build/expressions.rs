//! Expressions: precedence, and a limit on the height of the tree.

use std::iter::Peekable;
use std::vec::IntoIter;

use pest::iterators::Pair;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span, Spanned};
use crate::limits::OPERATIONS;

use super::super::ast::{
    Argument, BinaryOperator, Bound, Call, Expression, ExpressionKind, Path, Range, UnaryOperator,
};
use super::super::grammar::Rule;
use super::super::words;
use super::{Build, Parts};

/// An expression and the height of its tree.
type Tree = (Expression, usize);

/// How tightly a sign before an operand holds it, between `and` and the comparisons, and between `*` and `^`.
pub(in super::super) const NOT: u8 = 3;
pub(in super::super) const NEGATE: u8 = 7;

impl Build<'_> {
    /// A whole expression.
    pub(in super::super) fn expression(&mut self, pair: Pair<'_, Rule>) -> Expression {
        self.start();
        self.tree(pair).0
    }

    pub(super) fn call(&mut self, pair: Pair<'_, Rule>) -> Call {
        self.start();
        self.call_tree(pair).0
    }

    fn start(&mut self) {
        self.too_high = false;
        self.level = 0;
    }

    fn tree(&mut self, pair: Pair<'_, Rule>) -> Tree {
        let inner = pair.into_inner().next().unwrap_or_else(|| unreachable!("the grammar has an expression here"));
        match inner.as_rule() {
            Rule::conditional => self.conditional(inner),
            _ => {
                let parts: Vec<_> = inner.into_inner().collect();
                let mut row = parts.into_iter().peekable();
                self.operation(&mut row, 0)
            }
        }
    }

    fn conditional(&mut self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let (condition, a) = self.tree(parts.required(Rule::expression));
        let (then, b) = self.tree(parts.required(Rule::expression));
        let (otherwise, c) = self.tree(parts.required(Rule::expression));
        let kind = ExpressionKind::If(Box::new(condition), Box::new(then), Box::new(otherwise));
        self.grow(kind, span, a.max(b).max(c))
    }

    /// Operands and operators that hold at least as tightly as `least`.
    fn operation(&mut self, row: &mut Row<'_>, least: u8) -> Tree {
        self.level += 1;
        let mut left = self.operand(row);
        let mut compared: Option<Span> = None;
        while let Some(next) = row.next_if(|part| operator(part.as_str()).1 >= least) {
            let (kind, strength) = operator(next.as_str());
            let place = self.span(&next);
            if strength == operator_strength(BinaryOperator::Less) {
                self.not_chained(compared, place, &left.0);
                compared = Some(place);
            }
            let right = self.operation(row, if kind == BinaryOperator::Power { strength } else { strength + 1 });
            let span = left.0.span.to(right.0.span);
            let kind = ExpressionKind::Binary(Spanned { node: kind, span: place }, Box::new(left.0), Box::new(right.0));
            left = self.grow(kind, span, left.1.max(right.1));
        }
        self.level -= 1;
        left
    }

    fn not_chained(&mut self, first: Option<Span>, second: Span, left: &Expression) {
        let (Some(first), ExpressionKind::Binary(_, _, middle)) = (first, &left.kind) else { return };
        let text = &self.scan.text[middle.span.start as usize..middle.span.end as usize];
        let behind = Span { start: middle.span.end, ..middle.span };
        let diagnostic = Diagnostic::new(Code::Syntax, second, "comparisons do not chain")
            .note(first, "compared here already")
            .help("write `a < b and b < c`")
            .cure(format!("write `and {text}`"), behind, format!(" and {text}"));
        self.diagnostics.push(diagnostic);
    }

    fn operand(&mut self, row: &mut Row<'_>) -> Tree {
        let next = row.next().unwrap_or_else(|| unreachable!("the grammar has an operand here"));
        if self.level > OPERATIONS.most {
            let span = self.span(&next);
            row.by_ref().for_each(drop);
            return self.cut(span);
        }
        if next.as_rule() == Rule::value {
            return self.value(next);
        }
        let (operator, strength) = match next.as_str() {
            "not" => (UnaryOperator::Not, NOT),
            _ => (UnaryOperator::Negate, NEGATE),
        };
        let place = self.span(&next);
        let (value, height) = self.operation(row, strength);
        let span = place.to(value.span);
        self.grow(ExpressionKind::Unary(Spanned { node: operator, span: place }, Box::new(value)), span, height)
    }

    fn value(&mut self, pair: Pair<'_, Rule>) -> Tree {
        let mut parts = pair.into_inner();
        let primary = parts.next().unwrap_or_else(|| unreachable!("the grammar has a value here"));
        let mut value = self.primary(primary);
        for pair in parts {
            let span = value.0.span.to(self.span(&pair));
            let (index, height) = self.tree(Parts::of(pair).required(Rule::expression));
            let kind = ExpressionKind::Index(Box::new(value.0), Box::new(index));
            value = self.grow(kind, span, value.1.max(height));
        }
        value
    }

    fn primary(&mut self, pair: Pair<'_, Rule>) -> Tree {
        let span = self.span(&pair);
        let (kind, height) = match pair.as_rule() {
            Rule::number => (self.number(pair), 0),
            Rule::string => (ExpressionKind::Text(self.text(pair).node), 0),
            Rule::named if is_call(&pair) => {
                let (call, height) = self.call_tree(pair);
                (ExpressionKind::Call(call), height)
            }
            Rule::named => (ExpressionKind::Path(self.path(pair)), 0),
            Rule::vector => {
                let parts = Parts::of(pair).all(Rule::expression);
                let trees: Vec<Tree> = parts.into_iter().map(|part| self.tree(part)).collect();
                let height = trees.iter().map(|tree| tree.1).max().unwrap_or(0);
                (ExpressionKind::Vector(trees.into_iter().map(|tree| tree.0).collect()), height)
            }
            _ => {
                let (inner, height) = self.tree(Parts::of(pair).required(Rule::expression));
                return (Expression { span, ..inner }, height);
            }
        };
        self.grow(kind, span, height)
    }

    fn call_tree(&mut self, pair: Pair<'_, Rule>) -> (Call, usize) {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let function = self.name(parts.required(Rule::name));
        let mut height = 0;
        let mut arguments = Vec::new();
        for pair in Parts::of(parts.required(Rule::arguments)).all(Rule::argument) {
            let (argument, own) = self.argument(pair);
            height = height.max(own);
            arguments.push(argument);
        }
        (Call { function, arguments, span }, height)
    }

    fn argument(&mut self, pair: Pair<'_, Rule>) -> (Argument, usize) {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = parts.optional(Rule::label).map(|label| self.name(label));
        if let Some(bound) = parts.optional(Rule::bound) {
            let name = name.unwrap_or_else(|| unreachable!("the grammar has a name before it"));
            let (value, height) = self.bound(name, bound, span);
            return (Argument { name: None, value }, height);
        }
        let (value, height) = match parts.optional(Rule::dimension_word) {
            Some(word) => (self.dimension_argument(word), 1),
            None => self.tree(parts.required(Rule::expression)),
        };
        (Argument { name, value }, height)
    }

    /// `k in a .. b: value`, which has the name and this place.
    fn bound(&mut self, name: Name, pair: Pair<'_, Rule>, span: Span) -> Tree {
        let mut parts = Parts::of(pair);
        let range = parts.required(Rule::range);
        let range_span = self.span(&range);
        let mut ends = Parts::of(range);
        let (low, a) = self.tree(ends.required(Rule::expression));
        let (high, b) = self.tree(ends.required(Rule::expression));
        let (value, c) = self.tree(parts.required(Rule::expression));
        let range = Range { low, high, span: range_span };
        self.grow(ExpressionKind::Bound(Box::new(Bound { name, range, value })), span, a.max(b).max(c))
    }

    /// `x: length`: the dimension of a table's column, as a path of one word.
    fn dimension_argument(&self, word: Pair<'_, Rule>) -> Expression {
        let segments = vec![self.name(word)];
        let span = segments[0].span;
        Expression { kind: ExpressionKind::Path(Path { segments, span }), span }
    }

    fn number(&mut self, pair: Pair<'_, Rule>) -> ExpressionKind {
        let mut parts = Parts::of(pair);
        let value = parts.required(Rule::literal).as_str().parse().unwrap_or(f64::NAN);
        let units = parts.optional(Rule::unit).map_or_else(Vec::new, |unit| self.units(unit));
        ExpressionKind::Number(value, units)
    }

    fn units(&mut self, pair: Pair<'_, Rule>) -> Vec<(Name, i32)> {
        let mut units: Vec<(Name, i32)> = Vec::new();
        for part in pair.into_inner() {
            if part.as_rule() == Rule::unit_word {
                let sign = if units.is_empty() { 1 } else { -1 };
                let mut name = self.name(part);
                if name.node == words::GREEK_MICROMETRE {
                    name.node = "µm".to_owned();
                }
                units.push((name, sign));
            } else if let Some((_, exponent)) = units.last_mut() {
                *exponent *= self.power(Parts::of(part).required(Rule::integer));
            }
        }
        units
    }

    /// Puts a node on top of trees of this height.
    fn grow(&mut self, kind: ExpressionKind, span: Span, height: usize) -> Tree {
        if height >= OPERATIONS.most { self.cut(span) } else { (Expression { kind, span }, height + 1) }
    }

    /// What stands for a tree that is too high.
    fn cut(&mut self, span: Span) -> Tree {
        if !std::mem::replace(&mut self.too_high, true) {
            self.diagnostics.push(OPERATIONS.exceeded(span));
        }
        (Expression { kind: ExpressionKind::Error, span }, 0)
    }
}

/// Whether arguments follow the name.
fn is_call(named: &Pair<'_, Rule>) -> bool {
    named.clone().into_inner().any(|part| part.as_rule() == Rule::arguments)
}

/// A flat row of operands, operators, and signs before operands.
type Row<'i> = Peekable<IntoIter<Pair<'i, Rule>>>;

/// Which operator this is, and how tightly it holds.
pub(in super::super) fn operator(text: &str) -> (BinaryOperator, u8) {
    let operator = match text {
        "or" => BinaryOperator::Or,
        "and" => BinaryOperator::And,
        "<" => BinaryOperator::Less,
        "<=" => BinaryOperator::LessEqual,
        ">" => BinaryOperator::Greater,
        ">=" => BinaryOperator::GreaterEqual,
        "==" => BinaryOperator::Equal,
        "!=" => BinaryOperator::NotEqual,
        "+" => BinaryOperator::Add,
        "-" => BinaryOperator::Subtract,
        "*" => BinaryOperator::Multiply,
        "/" => BinaryOperator::Divide,
        _ => BinaryOperator::Power,
    };
    (operator, operator_strength(operator))
}

fn operator_strength(operator: BinaryOperator) -> u8 {
    match operator {
        BinaryOperator::Or => 1,
        BinaryOperator::And => 2,
        BinaryOperator::Less
        | BinaryOperator::LessEqual
        | BinaryOperator::Greater
        | BinaryOperator::GreaterEqual
        | BinaryOperator::Equal
        | BinaryOperator::NotEqual => 4,
        BinaryOperator::Add | BinaryOperator::Subtract => 5,
        BinaryOperator::Multiply | BinaryOperator::Divide => 6,
        BinaryOperator::Power => 8,
    }
}

//! How a written expression holds together: what decides where parentheses go.

use std::collections::HashMap;

use crate::symbolic::graph::{Graph, Node, NodeId};
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::print::Style;
use crate::symbolic::print::name::{PartOfPi, has_exponent};

/// How tightly a written expression holds together, loosest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Binding {
    /// Terms with + or − between them.
    Sum,
    /// A minus in front of a product.
    Signed,
    /// Factors with `*` or `/` between them.
    Product,
    /// A base with an exponent.
    Power,
    /// Stands for itself: a number, a name, a call, a fraction bar.
    Atom,
}

/// The outline of a written expression.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) binding: Binding,
    /// Its first character is a minus.
    pub(super) minus: bool,
    /// Its first character is a digit.
    pub(super) digit: bool,
}

impl Shape {
    /// A name or a call.
    pub(super) const NAME: Shape = Shape { binding: Binding::Atom, minus: false, digit: false };

    /// As it stands where at least `binding` is asked for: in parentheses if need be.
    fn at_least(self, binding: Binding) -> Shape {
        if self.binding >= binding { self } else { Shape::NAME }
    }
}

/// The two operands of a sum in the order in which they are written: a number reads better behind.
pub(super) fn terms(graph: &Graph, a: NodeId, b: NodeId) -> (NodeId, NodeId) {
    if matches!(graph.node(a), Node::Constant(_)) { (b, a) } else { (a, b) }
}

/// The shape of a node from those of its operands.
pub(super) fn shape(graph: &Graph, style: Style, node: Node, known: &HashMap<NodeId, Shape>) -> Shape {
    match node {
        Node::Constant(bits) => number(f64::from_bits(bits), style),
        Node::Variable(_) => Shape::NAME,
        Node::Unary(Unary::Neg, _) => product(Shape { minus: true, ..Shape::NAME }),
        Node::Unary(..) | Node::Curve(..) | Node::Middle(_) | Node::Root(..) | Node::Integral(..) => Shape::NAME,
        Node::Binary(Binary::Add, a, b) => Shape { binding: Binding::Sum, ..known[&terms(graph, a, b).0] },
        Node::Binary(Binary::Sub, a, _) => Shape { binding: Binding::Sum, ..known[&a] },
        Node::Binary(Binary::Mul, a, b) if a == b => power(graph, style, a, known),
        Node::Binary(Binary::Pow, a, _) => power(graph, style, a, known),
        Node::Binary(Binary::Mul, a, _) => product(known[&a].at_least(Binding::Signed)),
        Node::Binary(Binary::Div, a, _) if style == Style::Latex => {
            product(Shape { minus: known[&a].binding == Binding::Signed, ..Shape::NAME })
        }
        Node::Binary(Binary::Div, a, _) => product(known[&a].at_least(Binding::Signed)),
        Node::Binary(Binary::Atan2 | Binary::Min | Binary::Max, ..) => Shape::NAME,
    }
}

fn number(value: f64, style: Style) -> Shape {
    let (is_product, begins_with_digit) = match PartOfPi::of(value) {
        Some(PartOfPi { numerator, denominator }) => {
            (numerator > 1 || denominator > 1, numerator > 1 && (style == Style::Text || denominator == 1))
        }
        None => (style == Style::Latex && has_exponent(value), value.is_finite()),
    };
    Shape {
        binding: match (value < 0.0, is_product) {
            (true, _) => Binding::Signed,
            (false, true) => Binding::Product,
            (false, false) => Binding::Atom,
        },
        minus: value < 0.0,
        digit: value >= 0.0 && begins_with_digit,
    }
}

fn product(first: Shape) -> Shape {
    Shape { binding: if first.minus { Binding::Signed } else { Binding::Product }, ..first }
}

fn power(graph: &Graph, style: Style, base: NodeId, known: &HashMap<NodeId, Shape>) -> Shape {
    let is_function = style == Style::Latex && matches!(graph.node(base), Node::Unary(..));
    Shape { binding: Binding::Power, digit: !is_function && known[&base].at_least(Binding::Atom).digit, minus: false }
}

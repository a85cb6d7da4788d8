//! Writing one expression, from left to right and without recursion: expressions can be a million operations deep.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::symbolic::graph::{Graph, Node, NodeId};
use crate::symbolic::implicit::RootId;
use crate::symbolic::integral::IntegralId;
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::print::Style;
use crate::symbolic::print::name;
use crate::symbolic::print::shape::{Binding, Shape, shape, terms};

/// Writes expressions of a graph, some nodes by name.
pub(super) struct Writer<'g> {
    graph: &'g Graph,
    style: Style,
    names: HashMap<NodeId, String>,
    shapes: HashMap<NodeId, Shape>,
}

/// What is still to be written.
enum Part {
    Text(Cow<'static, str>),
    /// A node, in parentheses if it holds together less than this.
    Node(NodeId, Binding),
    /// A node that starts with a minus, without it and without parentheses.
    Unsigned(NodeId),
}

impl<'g> Writer<'g> {
    /// For the nodes in `order`, operands first; those in `names` appear by name.
    pub(super) fn new(graph: &'g Graph, style: Style, order: &[NodeId], names: HashMap<NodeId, String>) -> Writer<'g> {
        let mut shapes = HashMap::with_capacity(order.len());
        for &id in order {
            let found = match names.get(&id) {
                Some(_) => Shape::NAME,
                None => shape(graph, style, graph.node(id), &shapes),
            };
            shapes.insert(id, found);
        }
        Writer { graph, style, names, shapes }
    }

    /// The name of a node, or what it stands for.
    pub(super) fn text(&self, id: NodeId) -> String {
        match self.names.get(&id) {
            Some(name) => name.clone(),
            None => self.definition(id),
        }
    }

    /// What a node stands for, even if it has a name.
    pub(super) fn definition(&self, id: NodeId) -> String {
        let mut text = String::new();
        let mut left = self.parts(id, false);
        left.reverse();
        while let Some(part) = left.pop() {
            let (id, is_unsigned) = match part {
                Part::Text(piece) => {
                    text.push_str(&piece);
                    continue;
                }
                Part::Node(id, binding) if self.shapes[&id].binding < binding => {
                    let (open, close) = self.parentheses();
                    text.push_str(open);
                    left.extend([close.into(), Part::Node(id, Binding::Sum)]);
                    continue;
                }
                Part::Node(id, _) => (id, false),
                Part::Unsigned(id) => (id, true),
            };
            match self.names.get(&id) {
                Some(name) => text.push_str(name),
                None => left.extend(self.parts(id, is_unsigned).into_iter().rev()),
            }
        }
        text
    }

    /// What a node is written as, one level deep, without its leading minus if asked so.
    fn parts(&self, id: NodeId, is_unsigned: bool) -> Vec<Part> {
        let first = |a: NodeId, binding: Binding| {
            if is_unsigned { Part::Unsigned(a) } else { Part::Node(a, binding) }
        };
        match self.graph.node(id) {
            Node::Constant(bits) => {
                let value = f64::from_bits(bits);
                let value = if is_unsigned { -value } else { value };
                vec![name::number(value, self.style).into()]
            }
            Node::Variable(variable) => {
                vec![name::variable(&self.graph.variable_name(variable), self.style).into()]
            }
            Node::Unary(Unary::Neg, a) => {
                vec![sign(is_unsigned), Part::Node(a, Binding::Product)]
            }
            Node::Unary(op, a) => self.call(op.name(), &[a]),
            Node::Curve(curve, order, a) => self.on_curve(self.graph.curve_of(curve).name(), order, a),
            Node::Middle(a) => vec![Part::Node(a, Binding::Atom)],
            Node::Root(root, ..) => self.root(root),
            Node::Integral(integral, ..) => self.integral(integral),
            Node::Binary(Binary::Add, a, b) => {
                let (a, b) = terms(self.graph, a, b);
                let mut parts = vec![first(a, Binding::Sum)];
                parts.extend(if self.shapes[&b].minus {
                    [" - ".into(), Part::Unsigned(b)]
                } else {
                    [" + ".into(), Part::Node(b, Binding::Sum)]
                });
                parts
            }
            Node::Binary(Binary::Sub, a, b) => {
                let mut parts = vec![first(a, Binding::Sum)];
                parts.extend(if self.shapes[&b].binding == Binding::Signed {
                    [" + ".into(), Part::Unsigned(b)]
                } else {
                    [" - ".into(), Part::Node(b, Binding::Product)]
                });
                parts
            }
            Node::Binary(Binary::Mul, a, b) if a == b => self.square(a),
            Node::Binary(Binary::Mul, a, b) => {
                let (a, b) = if self.begins_with_number(b) { (b, a) } else { (a, b) };
                vec![first(a, Binding::Signed), self.times(b), Part::Node(b, Binding::Product)]
            }
            Node::Binary(Binary::Div, a, b) if self.style == Style::Latex => self.fraction(a, b, is_unsigned),
            Node::Binary(Binary::Div, a, b) => {
                vec![first(a, Binding::Signed), " / ".into(), Part::Node(b, Binding::Power)]
            }
            Node::Binary(Binary::Pow, a, b) => self.power(a, b),
            Node::Binary(op, a, b) => self.call(op.name(), &[a, b]),
        }
    }

    /// Whether a factor is a product with a number in front, which then comes first of all.
    fn begins_with_number(&self, factor: NodeId) -> bool {
        matches!(self.graph.node(factor), Node::Binary(Binary::Mul, c, _) if matches!(self.graph.node(c), Node::Constant(_)))
    }

    fn parentheses(&self) -> (&'static str, &'static str) {
        match self.style {
            Style::Text => ("(", ")"),
            Style::Latex => ("\\left(", "\\right)"),
        }
    }

    /// The sign of multiplication in front of a factor: a thin space, but two numbers need a dot.
    fn times(&self, factor: NodeId) -> Part {
        let shape = self.shapes[&factor];
        match self.style {
            Style::Text => " * ",
            Style::Latex if shape.digit && shape.binding >= Binding::Product => " \\cdot ",
            Style::Latex => "\\,",
        }
        .into()
    }

    fn fraction(&self, a: NodeId, b: NodeId, is_unsigned: bool) -> Vec<Part> {
        let mut parts = if self.shapes[&a].binding == Binding::Signed {
            vec![sign(is_unsigned), "\\frac{".into(), Part::Unsigned(a)]
        } else {
            vec!["\\frac{".into(), Part::Node(a, Binding::Sum)]
        };
        parts.extend(["}{".into(), Part::Node(b, Binding::Sum), "}".into()]);
        parts
    }

    fn square(&self, a: NodeId) -> Vec<Part> {
        if self.style == Style::Text {
            return vec![Part::Node(a, Binding::Atom), "^2".into()];
        }
        match self.graph.node(a) {
            // sin² x, as on paper
            Node::Unary(op, argument) if !self.names.contains_key(&a) && has_bare_name(op) => vec![
                latex_function(op.name()).into(),
                "^{2}\\left(".into(),
                Part::Node(argument, Binding::Sum),
                "\\right)".into(),
            ],
            _ => vec![Part::Node(a, Binding::Atom), "^{2}".into()],
        }
    }

    fn power(&self, base: NodeId, exponent: NodeId) -> Vec<Part> {
        let base = Part::Node(base, Binding::Atom);
        match self.style {
            Style::Text => vec![base, "^".into(), Part::Node(exponent, Binding::Atom)],
            Style::Latex => vec![base, "^{".into(), Part::Node(exponent, Binding::Sum), "}".into()],
        }
    }

    /// A curve's value, primed for each derivative.
    fn on_curve(&self, curve: &str, order: u8, argument: NodeId) -> Vec<Part> {
        let primes = "'".repeat(order.into());
        let (open, close) = self.parentheses();
        let function = format!("{}{primes}{open}", name::variable(curve, self.style));
        vec![function.into(), Part::Node(argument, Binding::Sum), close.into()]
    }

    /// The unknowns with their ranges, and what is zero: `root(x in 0 .. 1: x^2 - a)`.
    fn root(&self, root: RootId) -> Vec<Part> {
        let system = self.graph.implicit_of(root);
        let (open, close) = self.parentheses();
        let (function, within) = match self.style {
            Style::Text => ("root", [" in ", " .. "]),
            Style::Latex => ("\\operatorname{root}", [" \\in ", " \\ldots "]),
        };
        let mut parts = vec![function.into(), open.into()];
        for (k, (unknown, (low, high))) in system.unknowns.iter().zip(&system.ranges).enumerate() {
            let [low, high] = [low, high].map(|end| name::number(*end, self.style));
            parts.extend([if k > 0 { ", " } else { "" }.into(), Part::Node(*unknown, Binding::Sum)]);
            parts.push(format!("{}{low}{}{high}", within[0], within[1]).into());
        }
        for (k, residual) in system.residuals.iter().enumerate() {
            parts.extend([if k > 0 { ", " } else { ": " }.into(), Part::Node(*residual, Binding::Sum)]);
        }
        parts.push(close.into());
        if system.unknowns.len() > 1 {
            parts.push(format!("[{}]", root.component).into());
        }
        parts
    }

    /// `integral(t in a .. b: f)`
    fn integral(&self, integral: IntegralId) -> Vec<Part> {
        let [variable, integrand, from, to] = self.graph.integral_of(integral).written();
        let [variable, integrand, from, to] =
            [variable, integrand, from, to].map(|part| Part::Node(part, Binding::Sum));
        match self.style {
            Style::Text => {
                vec![
                    "integral(".into(),
                    variable,
                    " in ".into(),
                    from,
                    " .. ".into(),
                    to,
                    ": ".into(),
                    integrand,
                    ")".into(),
                ]
            }
            Style::Latex => {
                let (open, close) = self.parentheses();
                let signs = ["\\int_{", "}^{", "} ", " \\, d"].map(Part::from);
                let [sign, above, behind, by] = signs;
                vec![open.into(), sign, from, above, to, behind, integrand, by, variable, close.into()]
            }
        }
    }

    fn call(&self, function: &'static str, arguments: &[NodeId]) -> Vec<Part> {
        let (open, close): (Cow<'static, str>, &'static str) = match (self.style, function) {
            (Style::Text, _) => (format!("{function}(").into(), ")"),
            (Style::Latex, "sqrt") => ("\\sqrt{".into(), "}"),
            (Style::Latex, "abs") => ("\\left|".into(), "\\right|"),
            (Style::Latex, _) => (format!("{}\\left(", latex_function(function)).into(), "\\right)"),
        };
        let mut parts = vec![Part::Text(open)];
        for (index, &argument) in arguments.iter().enumerate() {
            if index > 0 {
                parts.push(", ".into());
            }
            parts.push(Part::Node(argument, Binding::Sum));
        }
        parts.push(close.into());
        parts
    }
}

impl<T: Into<Cow<'static, str>>> From<T> for Part {
    fn from(text: T) -> Part {
        Part::Text(text.into())
    }
}

fn sign(is_unsigned: bool) -> Part {
    if is_unsigned { "" } else { "-" }.into()
}

/// True for a function that LaTeX writes as its name and an argument.
fn has_bare_name(op: Unary) -> bool {
    !matches!(op, Unary::Neg | Unary::Sqrt | Unary::Abs)
}

fn latex_function(name: &str) -> String {
    match name {
        "asin" | "acos" | "atan" => format!("\\arc{}", &name[1..]),
        "asinh" | "acosh" | "atanh" => format!("\\operatorname{{ar{}}}", &name[1..]),
        "arcinv" => "\\operatorname{inv}^{-1}".to_string(),
        "atan2" | "sign" => format!("\\operatorname{{{name}}}"),
        _ => format!("\\{name}"),
    }
}

//! Expressions: handles into a graph, with the operations on them.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::symbolic::graph::{CurveId, Graph, Node, NodeId, VariableId};
use crate::symbolic::op::{Binary, Unary};
use crate::symbolic::rules;

/// A symbolic scalar: a handle into its graph.
#[derive(Clone, Copy)]
pub struct Expr<'g> {
    pub(crate) graph: &'g Graph,
    pub(crate) id: NodeId,
}

impl PartialEq for Expr<'_> {
    /// Same node of the same graph.
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id && std::ptr::eq(self.graph, other.graph)
    }
}

impl Eq for Expr<'_> {}

impl Hash for Expr<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.id.hash(state);
    }
}

impl fmt::Debug for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl<'g> Expr<'g> {
    /// The graph it lives in.
    pub fn graph(self) -> &'g Graph {
        self.graph
    }

    /// What it is made of.
    pub fn node(self) -> Node {
        self.graph.node(self.id)
    }

    /// Its value if it is a number.
    pub fn as_constant(self) -> Option<f64> {
        match self.node() {
            Node::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    /// Its variable if it is one.
    pub fn as_variable(self) -> Option<VariableId> {
        match self.node() {
            Node::Variable(id) => Some(id),
            _ => None,
        }
    }

    /// Numerator and denominator.
    pub(crate) fn as_quotient(self) -> (Expr<'g>, Expr<'g>) {
        match self.node() {
            Node::Binary(Binary::Div, a, b) => (self.graph.expr(a), self.graph.expr(b)),
            Node::Unary(Unary::Neg, a) => {
                let (numerator, denominator) = self.graph.expr(a).as_quotient();
                (-numerator, denominator)
            }
            _ => (self, self.graph.constant(1.0)),
        }
    }

    /// True for the number zero.
    pub fn is_zero(self) -> bool {
        self.as_constant() == Some(0.0)
    }

    /// An operation on it, simplified.
    pub fn unary(self, op: Unary) -> Expr<'g> {
        rules::unary(op, self)
    }

    /// An operation on it and another one, simplified.
    ///
    /// # Panics
    /// If the two are of different graphs.
    pub fn binary(self, op: Binary, other: Expr<'g>) -> Expr<'g> {
        self.graph.assert_owns(other);
        rules::binary(op, self, other)
    }

    /// The same number; of an interval, its middle.
    pub(crate) fn middle(self) -> Expr<'g> {
        if self.as_constant().is_some() { self } else { self.graph.intern(Node::Middle(self.id)) }
    }

    /// A derivative of a curve (order 0: its value) here.
    pub fn on_curve(self, curve: CurveId, order: u8) -> Expr<'g> {
        if let Some(x) = self.as_constant() {
            return self.graph.constant(self.graph.curve_of(curve).value(order, x));
        }
        self.graph.intern(Node::Curve(curve, order, self.id))
    }

    /// x·x.
    pub fn squared(self) -> Expr<'g> {
        self * self
    }

    /// Integer power by repeated squaring; negative ones divide.
    pub fn powi(self, exponent: i32) -> Expr<'g> {
        let one = self.graph.constant(1.0);
        let (mut result, mut square, mut left) = (one, self, exponent.unsigned_abs());
        while left > 0 {
            if left & 1 == 1 {
                result = result * square;
            }
            left >>= 1;
            if left > 0 {
                square = square.squared();
            }
        }
        if exponent < 0 { one / result } else { result }
    }
}

macro_rules! unary_methods {
    ($($method:ident $op:ident $doc:literal;)*) => {
        impl<'g> Expr<'g> {
            $(#[doc = $doc] pub fn $method(self) -> Expr<'g> { self.unary(Unary::$op) })*
        }
    };
}

unary_methods! {
    sqrt Sqrt "Square root; NaN below zero.";
    sin Sin "Sine of radians.";
    cos Cos "Cosine of radians.";
    tan Tan "Tangent of radians.";
    asin Asin "Arc sine in radians; NaN outside [−1, 1].";
    acos Acos "Arc cosine in radians; NaN outside [−1, 1].";
    atan Atan "Arc tangent in radians.";
    sinh Sinh "Hyperbolic sine.";
    cosh Cosh "Hyperbolic cosine.";
    tanh Tanh "Hyperbolic tangent.";
    asinh Asinh "Inverse hyperbolic sine.";
    acosh Acosh "Inverse hyperbolic cosine; NaN below 1.";
    atanh Atanh "Inverse hyperbolic tangent; NaN outside [−1, 1].";
    arcinv Arcinv "The angle in radians whose involute function tan a − a is given.";
    exp Exp "Exponential.";
    ln Ln "Natural logarithm; NaN below zero.";
    abs Abs "Absolute value; its derivative at zero is taken as zero.";
    sign Sign "−1, 0 or 1.";
}

macro_rules! binary_methods {
    ($($method:ident $op:ident $doc:literal;)*) => {
        impl<'g> Expr<'g> {
            $(#[doc = $doc] pub fn $method(self, other: Expr<'g>) -> Expr<'g> { self.binary(Binary::$op, other) })*
        }
    };
}

binary_methods! {
    pow Pow "Power with any exponent.";
    atan2 Atan2 "Angle of the point (x = `other`, y = `self`) in (−π, π].";
    min Min "The smaller of two.";
    max Max "The larger of two.";
}

macro_rules! operators {
    ($($trait:ident $method:ident $op:ident;)*) => {$(
        impl<'g> $trait for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                self.binary(Binary::$op, other)
            }
        }

        impl<'g> $trait<f64> for Expr<'g> {
            type Output = Expr<'g>;
            fn $method(self, other: f64) -> Expr<'g> {
                self.binary(Binary::$op, self.graph.constant(other))
            }
        }

        impl<'g> $trait<Expr<'g>> for f64 {
            type Output = Expr<'g>;
            fn $method(self, other: Expr<'g>) -> Expr<'g> {
                other.graph.constant(self).binary(Binary::$op, other)
            }
        }
    )*};
}

operators! {
    Add add Add;
    Sub sub Sub;
    Mul mul Mul;
    Div div Div;
}

impl<'g> Neg for Expr<'g> {
    type Output = Expr<'g>;
    fn neg(self) -> Expr<'g> {
        self.unary(Unary::Neg)
    }
}

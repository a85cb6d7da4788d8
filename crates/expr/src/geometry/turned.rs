//! Vectors before their own turn about an axis.

use crate::geometry::vector::Vector3;
use crate::symbolic::graph::Expr;
use crate::symbolic::terms::{Products, Sum};

/// A vector that is another one turned about an axis, as a point of a helicoid or of a surface of revolution is. What is computed of
/// such vectors is shorter before the turn, and intervals see its angle once.
#[derive(Clone, Copy)]
pub(crate) struct Turned<'g> {
    /// The vector before the turn.
    pub(crate) before: Vector3<'g>,
    /// The turn of its frame.
    pub(crate) turn: Turn<'g>,
}

/// A right-handed turn about one axis of a frame.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Turn<'g> {
    /// The axis: 0 for x, 1 for y, 2 for z.
    pub(crate) axis: usize,
    pub(crate) angle: Expr<'g>,
}

impl<'g> Turned<'g> {
    /// The turn of a vector about the first axis about which it has one; not one by a number.
    pub(crate) fn of(vector: Vector3<'g>) -> Option<Turned<'g>> {
        [2, 0, 1].into_iter().find_map(|axis| Turned::about(axis, vector))
    }

    /// The turn of a vector about one axis.
    pub(crate) fn about(axis: usize, vector: Vector3<'g>) -> Option<Turned<'g>> {
        let [i, j] = across(axis);
        let ((u, divisor), (v, same)) = (vector.0[i].as_quotient(), vector.0[j].as_quotient());
        if divisor != same {
            return None;
        }
        // as it is written, or else with products of sums written out
        let (angle, parts) = [Products::Kept, Products::WrittenOut].into_iter().find_map(|p| Sum::turned(u, v, p))?;
        let [a, b] = parts.map(|part| part.expression());
        let mut before = vector;
        (before.0[i], before.0[j]) = (a / divisor, b / divisor);
        Some(Turned { before, turn: Turn { axis, angle } })
    }
}

impl<'g> Turn<'g> {
    /// A vector turned.
    pub(crate) fn of(self, vector: Vector3<'g>) -> Vector3<'g> {
        let [i, j] = across(self.axis);
        let (u, v) = (vector.0[i], vector.0[j]);
        let (c, s) = (self.angle.cos(), self.angle.sin());
        let mut turned = vector;
        [turned.0[i], turned.0[j]] = [u * c - v * s, u * s + v * c];
        turned
    }

    /// A vector turned back.
    pub(crate) fn back(self, vector: Vector3<'g>) -> Vector3<'g> {
        Turn { angle: -self.angle, ..self }.of(vector)
    }

    /// The derivative of a turned vector, turned back: how it changes before the turn, and by the turn itself.
    pub(crate) fn derivative(self, before: Vector3<'g>, variable: Expr<'g>) -> Vector3<'g> {
        let [i, j] = across(self.axis);
        let rate = self.angle.derivative(variable);
        let mut derivative = before.derivative(variable);
        derivative.0[i] = derivative.0[i] - rate * before.0[j];
        derivative.0[j] = derivative.0[j] + rate * before.0[i];
        derivative
    }
}

/// The axes that an axis is square to, in their order about it.
fn across(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

//! The range of a spline over an interval.

use super::Interval;
use crate::symbolic::curve::Curve;

impl Curve {
    /// All values of the derivative of an order (0 for the value itself) over an interval; beyond the curve's ends it has
    /// none.
    pub fn enclosure(&self, order: u8, x: Interval) -> Interval {
        let (low, high) = self.domain();
        let inside = x.intersection(Interval::new(low, high));
        if inside.is_empty() {
            return Interval::EMPTY;
        }
        let (first, last) = (self.piece_at(inside.lo), self.piece_at(inside.hi));
        let mut values = Interval { continuous: true, ..Interval::EMPTY };
        for piece in first..=last {
            let (knot, coefficients) = self.piece(piece);
            let from = if piece == first { inside.lo } else { knot };
            let to = if piece == last { inside.hi } else { self.piece(piece + 1).0 };
            let t = Interval::new(from, to) - Interval::point(knot);
            values = values.hull(of_cubic(coefficients, order, t));
        }
        let jumps = order >= 3 && first != last;
        let continuous = values.continuous && x.continuous && !jumps && inside.lo == x.lo && inside.hi == x.hi;
        Interval { continuous, ..values }
    }
}

/// The range of a derivative of a cubic: its values at both ends and where it turns.
fn of_cubic([a, b, c, d]: [f64; 4], order: u8, t: Interval) -> Interval {
    let [a, b, c, d] = [a, b, c, d].map(Interval::point);
    let number = Interval::point;
    let polynomial = match order {
        0 => [a, b, c, d],
        1 => [b, number(2.0) * c, number(3.0) * d, number(0.0)],
        2 => [number(2.0) * c, number(6.0) * d, number(0.0), number(0.0)],
        3 => [number(6.0) * d, number(0.0), number(0.0), number(0.0)],
        _ => [number(0.0); 4],
    };
    let value = |t: Interval| {
        let [p, q, r, s] = polynomial;
        p + t * (q + t * (r + t * s))
    };
    let ends = value(number(t.lo)).hull(value(number(t.hi)));
    let [_, q, r, s] = polynomial;
    turning_points(q, number(2.0) * r, number(3.0) * s, t)
        .into_iter()
        .map(|turn| turn.intersection(t))
        .filter(|turn| !turn.is_empty())
        .fold(ends, |range, turn| range.hull(value(Interval { continuous: true, ..turn })))
}

/// Two intervals that hold every root of q + r t + s t² within t.
fn turning_points(q: Interval, r: Interval, s: Interval, t: Interval) -> [Interval; 2] {
    let slope = q + t * (r + t * s);
    if !slope.contains(0.0) {
        return [Interval::EMPTY; 2];
    }
    let discriminant = r.squared() - Interval::point(4.0) * s * q;
    if discriminant.hi < 0.0 {
        return [Interval::EMPTY; 2];
    }
    // the root without cancellation, and the other one by the product of both
    let root = discriminant.sqrt();
    let sum = if r.middle() < 0.0 { r - root } else { r + root } * Interval::point(-0.5);
    if sum.contains(0.0) {
        return [t; 2];
    }
    let has_two = s.lo != 0.0 || s.hi != 0.0;
    [if has_two { sum / s } else { Interval::EMPTY }, q / sum]
}

//! Elementary functions of intervals: monotone pieces between ends from values whose error is known, most of them correctly rounded.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

use super::{Interval, down, up};
use crate::symbolic::op::inverse_involute;
use crate::tape::kernel;

/// The next float above π.
const PI_ABOVE: f64 = f64::from_bits(PI.to_bits() + 1);
/// The next float above π/2.
const HALF_PI_ABOVE: f64 = f64::from_bits(FRAC_PI_2.to_bits() + 1);

/// Half turns from zero to an angle, with a bound of their rounding error; `None` for angles so large that it is of no use.
fn half_turns(angle: f64) -> Option<(f64, f64)> {
    const LARGEST: f64 = (1u64 << 40) as f64;
    // the quotient is rounded once, its factor once, and a half is added
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    (angle.abs() <= LARGEST).then(|| (angle * FRAC_1_PI, ROUNDING * (angle.abs() + 1.0)))
}

/// The whole numbers between an angle's ends in half turns, each shifted by `offset`; ends nearer to one than their rounding
/// count as beyond it.
enum Crossed {
    None,
    One(f64),
    Many,
}

fn crossed(x: Interval, offset: f64) -> Crossed {
    let Some(((low, low_error), (high, high_error))) = half_turns(x.lo).zip(half_turns(x.hi)) else {
        return Crossed::Many;
    };
    let first = (low + offset - low_error).ceil();
    let last = (high + offset + high_error).floor();
    if first > last {
        Crossed::None
    } else if first == last {
        Crossed::One(first)
    } else {
        Crossed::Many
    }
}

/// Values between −1 and 1 from those at both ends, with a turn where `crossed` says: at an even number upward to `at_even`.
fn wave(x: Interval, crossed: &Crossed, at_even: f64, (low, high): (f64, f64)) -> Interval {
    // the kernel errs by less than a unit in the last place
    let bound = |value: f64| match value {
        0.0 => (0.0, 0.0),
        value => (down(down(value)).max(-1.0), up(up(value)).min(1.0)),
    };
    let ends = Interval { lo: bound(low.min(high)).0, hi: bound(low.max(high)).1, continuous: x.continuous };
    match *crossed {
        Crossed::One(k) => {
            let top = if k % 2.0 == 0.0 { at_even } else { -at_even };
            Interval { lo: ends.lo.min(top), hi: ends.hi.max(top), continuous: x.continuous }
        }
        Crossed::None => ends,
        Crossed::Many => Interval { lo: -1.0, hi: 1.0, continuous: x.continuous },
    }
}

impl Interval {
    /// An increasing function by its ends, where it has the values `known` exactly.
    fn increasing(self, f: fn(f64) -> f64, known: fn(f64) -> Option<f64>) -> Interval {
        if self.is_empty() {
            return self;
        }
        let lower = known(self.lo).unwrap_or_else(|| down(f(self.lo)));
        let upper = known(self.hi).unwrap_or_else(|| up(f(self.hi)));
        Interval::with(lower, upper, self.continuous)
    }

    /// The part of it that lies in a domain; what is left out costs the continuity.
    fn within(self, low: f64, high: f64) -> Interval {
        let inside = self.intersection(Interval { lo: low, hi: high, continuous: true });
        if inside.lo == self.lo && inside.hi == self.hi { inside } else { inside.partial() }
    }

    /// sin x.
    pub fn sin(self) -> Interval {
        self.sin_cos().0
    }

    /// cos x.
    pub fn cos(self) -> Interval {
        self.sin_cos().1
    }

    /// sin x and cos x.
    pub fn sin_cos(self) -> (Interval, Interval) {
        if self.is_empty() {
            return (self, self);
        }
        // sin((k − 1/2) π): 1 for odd k
        let (of_sin, of_cos) = (crossed(self, 0.5), crossed(self, 0.0));
        let (mut low, mut high) = ((0.0, 1.0), (0.0, 1.0));
        if !matches!((&of_sin, &of_cos), (Crossed::Many, Crossed::Many)) {
            low = kernel::sin_cos(self.lo);
            high = if self.lo == self.hi { low } else { kernel::sin_cos(self.hi) };
        }
        (wave(self, &of_sin, -1.0, (low.0, high.0)), wave(self, &of_cos, 1.0, (low.1, high.1)))
    }

    /// tan x; nothing is known over a pole.
    pub fn tan(self) -> Interval {
        match crossed(self, 0.5) {
            Crossed::None => self.increasing(core_math::tan, zero),
            _ if self.is_empty() => self,
            _ => Interval::WHOLE,
        }
    }

    /// The angle whose sine it is.
    pub fn asin(self) -> Interval {
        self.within(-1.0, 1.0).increasing(core_math::asin, zero)
    }

    /// The angle whose cosine it is.
    pub fn acos(self) -> Interval {
        let inside = self.within(-1.0, 1.0);
        if inside.is_empty() {
            return inside;
        }
        let lower = if inside.hi == 1.0 { 0.0 } else { down(core_math::acos(inside.hi)).max(0.0) };
        Interval { lo: lower, hi: up(core_math::acos(inside.lo)), continuous: inside.continuous }
    }

    /// The angle whose tangent it is.
    pub fn atan(self) -> Interval {
        self.increasing(core_math::atan, zero)
    }

    /// sinh x.
    pub fn sinh(self) -> Interval {
        self.increasing(core_math::sinh, zero)
    }

    /// cosh x.
    pub fn cosh(self) -> Interval {
        let size = self.abs();
        let cosh = size.increasing(core_math::cosh, |x| (x == 0.0).then_some(1.0));
        Interval { lo: cosh.lo.max(1.0), ..cosh }
    }

    /// tanh x.
    pub fn tanh(self) -> Interval {
        let tanh = self.increasing(core_math::tanh, zero);
        if tanh.is_empty() {
            return tanh;
        }
        Interval { lo: tanh.lo.max(-1.0), hi: tanh.hi.min(1.0), ..tanh }
    }

    /// The number whose hyperbolic sine it is.
    pub fn asinh(self) -> Interval {
        self.increasing(core_math::asinh, zero)
    }

    /// The number from 0 whose hyperbolic cosine it is.
    pub fn acosh(self) -> Interval {
        self.within(1.0, f64::INFINITY).increasing(core_math::acosh, |x| (x == 1.0).then_some(0.0))
    }

    /// The number whose hyperbolic tangent it is.
    pub fn atanh(self) -> Interval {
        self.within(-1.0, 1.0).increasing(core_math::atanh, zero)
    }

    /// eˣ.
    pub fn exp(self) -> Interval {
        let exp = self.increasing(core_math::exp, |x| (x == 0.0).then_some(1.0));
        if exp.is_empty() { exp } else { Interval { lo: exp.lo.max(0.0), ..exp } }
    }

    /// Natural logarithm.
    pub fn ln(self) -> Interval {
        self.within(0.0, f64::INFINITY).increasing(core_math::log, |x| (x == 1.0).then_some(0.0))
    }

    /// The angle whose involute function tan a − a it is.
    pub fn arcinv(self) -> Interval {
        if self.is_empty() {
            return self;
        }
        let (low, high) = (involute_bounds(self.lo).0, involute_bounds(self.hi).1);
        Interval { lo: low, hi: high, continuous: self.continuous }
    }

    /// The angle of the point (x, y) with y this interval; not continuous over the negative x axis and the origin.
    pub fn atan2(self, x: Interval) -> Interval {
        let y = self;
        if y.is_empty() || x.is_empty() {
            return Interval::EMPTY;
        }
        let continuous = y.continuous && x.continuous;
        if x.lo <= 0.0 && y.lo <= 0.0 && y.hi >= 0.0 {
            return Interval { lo: -PI_ABOVE, hi: PI_ABOVE, continuous: false };
        }
        // the corners that are seen under the smallest and the largest angle
        let (last, first) = if y.lo > 0.0 {
            ((if x.lo < 0.0 { y.lo } else { y.hi }, x.lo), (if x.hi > 0.0 { y.lo } else { y.hi }, x.hi))
        } else if y.hi < 0.0 {
            ((if x.hi > 0.0 { y.hi } else { y.lo }, x.hi), (if x.lo < 0.0 { y.hi } else { y.lo }, x.lo))
        } else {
            ((y.hi, x.lo), (y.lo, x.lo))
        };
        let bound = |(y, x): (f64, f64)| match core_math::atan2(y, x) {
            // on the positive x axis, or closer to it than any float
            0.0 if y == 0.0 => (0.0, 0.0),
            angle => (down(angle), up(angle)),
        };
        Interval { lo: bound(first).0, hi: bound(last).1, continuous }
    }

    /// This to the power of another interval; of a negative number only whole powers are defined.
    pub fn pow(self, exponent: Interval) -> Interval {
        // floats take anything to the power of 0, and 1 to any power, to be 1
        if self.is_empty() || exponent.is_empty() {
            let one = exponent.contains(0.0) || self.contains(1.0);
            return if one { Interval::point(1.0).partial() } else { Interval::EMPTY };
        }
        let continuous = self.continuous && exponent.continuous;
        if self.lo > 0.0 {
            return self.positive_pow(exponent);
        }
        let is_whole = exponent.lo == exponent.hi && exponent.lo.fract() == 0.0;
        let is_known = self.lo > f64::NEG_INFINITY && exponent.lo > f64::NEG_INFINITY && exponent.hi < f64::INFINITY;
        if !is_known || !is_whole && self.lo < 0.0 && exponent.lo != exponent.hi {
            return Interval::WHOLE;
        }
        if !is_whole || exponent.lo <= 0.0 {
            return self.edge_pow(exponent);
        }
        let n = exponent.lo;
        let base = if n % 2.0 == 0.0 { self.abs() } else { self };
        let bound = |x: f64| {
            let power = core_math::pow(x, n);
            if x == 0.0 { (0.0, 0.0) } else { (down(power), up(power)) }
        };
        Interval::with(bound(base.lo).0, bound(base.hi).1, continuous)
    }

    /// Of a positive base: monotone in both, so that the corners bound it.
    fn positive_pow(self, exponent: Interval) -> Interval {
        let corners = [(self.lo, exponent.lo), (self.lo, exponent.hi), (self.hi, exponent.lo), (self.hi, exponent.hi)];
        let empty = Interval { continuous: self.continuous && exponent.continuous, ..Interval::EMPTY };
        let hull = corners.into_iter().fold(empty, |hull, (x, y)| {
            let power = core_math::pow(x, y);
            let (lower, upper) = if x == 1.0 || y == 0.0 { (1.0, 1.0) } else { (down(power).max(0.0), up(power)) };
            Interval { lo: hull.lo.min(lower), hi: hull.hi.max(upper), ..hull }
        });
        // an infinite end stands for numbers, whose small powers are small too
        if self.hi.is_infinite() && exponent.contains(0.0) {
            return Interval { lo: hull.lo.min(1.0), hi: hull.hi.max(1.0), continuous: false };
        }
        hull.bounded()
    }

    /// Bases that reach zero, with an exponent that is not a natural number.
    fn edge_pow(self, exponent: Interval) -> Interval {
        let n = exponent.lo;
        if n == 0.0 && exponent.hi == 0.0 {
            return Interval { lo: 1.0, hi: 1.0, continuous: self.continuous };
        }
        if n == exponent.hi && n < 0.0 && n.fract() == 0.0 {
            return Interval::point(1.0) / self.pow(Interval { lo: -n, hi: -n, ..exponent });
        }
        let base = self.within(0.0, f64::INFINITY);
        if base.is_empty() {
            return base;
        }
        if n > 0.0 {
            let upper = base.positive_part_pow(exponent);
            return Interval::with(0.0, upper, self.continuous && exponent.continuous && self.lo >= 0.0);
        }
        Interval { lo: 0.0, hi: f64::INFINITY, continuous: false }
    }

    /// Upper bound of non-negative numbers to positive powers.
    fn positive_part_pow(self, exponent: Interval) -> f64 {
        let of = |y: f64| if self.hi == 0.0 { 0.0 } else { up(core_math::pow(self.hi, y)) };
        of(exponent.lo).max(of(exponent.hi))
    }
}

/// Odd functions are zero at zero.
fn zero(x: f64) -> Option<f64> {
    (x == 0.0).then_some(0.0)
}

/// tan a − a for 0 ≤ a < π/2.
fn involute(a: f64) -> Interval {
    let angle = Interval::point(a);
    if a > 0.5 {
        return angle.tan() - angle;
    }
    // the tangent's coefficients of a³, a⁵, … as fractions
    const TANGENT: [(f64, f64); 9] = [
        (1.0, 3.0),
        (2.0, 15.0),
        (17.0, 315.0),
        (62.0, 2835.0),
        (1382.0, 155_925.0),
        (21_844.0, 6_081_075.0),
        (929_569.0, 638_512_875.0),
        (6_404_582.0, 10_854_718_875.0),
        (443_861_162.0, 1_856_156_927_625.0),
    ];
    let square = angle.squared();
    let fraction = |(p, q): (f64, f64)| Interval::point(p) / Interval::point(q);
    let last = fraction(TANGENT[8]);
    // each coefficient is less than 4/π² < 0.41 of the one before: what follows the last is less than a geometric series
    let ratio = square * Interval::point(0.41);
    let rest = last * ratio / (Interval::point(1.0) - ratio);
    let tail = Interval { lo: 0.0, ..rest };
    let sum = TANGENT.iter().rev().skip(1).fold(last + tail, |sum, &c| sum * square + fraction(c));
    angle * square * sum
}

/// Bounds of the angle with tan a − a = x, each proven by the involute function itself.
fn involute_bounds(x: f64) -> (f64, f64) {
    if x == 0.0 {
        return (0.0, 0.0);
    }
    if x < 0.0 {
        let (low, high) = involute_bounds(-x);
        return (-high, -low);
    }
    let near = inverse_involute(x);
    let (mut low, mut high) = (0.0, HALF_PI_ABOVE);
    // wide enough to hold what floats make of it, too
    let mut width = 4.0 * f64::EPSILON;
    while width < 1.0 && (low == 0.0 || high == HALF_PI_ABOVE) {
        let (below, above) = (near * (1.0 - width), near * (1.0 + width));
        if low == 0.0 && involute(below).hi <= x {
            low = below;
        }
        if high == HALF_PI_ABOVE && above < FRAC_PI_2 && involute(above).lo >= x {
            high = above;
        }
        width *= 2.0;
    }
    (low, high)
}

//! The elementary operations and what they do to numbers.

use crate::tape::kernel;

/// An operation on one scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)] // each is its name
pub enum Unary {
    Neg,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    /// The angle whose involute function tan a − a is given.
    Arcinv,
    Exp,
    Ln,
    Abs,
    /// −1, 0 or 1: the derivative of `Abs`.
    Sign,
}

/// An operation on two scalars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)] // each is its name
pub enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Atan2,
    Min,
    Max,
}

impl Unary {
    /// All of them, for tests that must cover every one.
    pub const ALL: [Unary; 19] = [
        Unary::Neg,
        Unary::Sqrt,
        Unary::Sin,
        Unary::Cos,
        Unary::Tan,
        Unary::Asin,
        Unary::Acos,
        Unary::Atan,
        Unary::Sinh,
        Unary::Cosh,
        Unary::Tanh,
        Unary::Asinh,
        Unary::Acosh,
        Unary::Atanh,
        Unary::Arcinv,
        Unary::Exp,
        Unary::Ln,
        Unary::Abs,
        Unary::Sign,
    ];

    /// The value; NaN outside the domain.
    #[inline]
    pub fn apply(self, a: f64) -> f64 {
        match self {
            Unary::Neg => -a,
            Unary::Sqrt => a.sqrt(),
            Unary::Sin => kernel::sin(a),
            Unary::Cos => kernel::cos(a),
            Unary::Tan => kernel::tan(a),
            Unary::Asin => kernel::asin(a),
            Unary::Acos => kernel::acos(a),
            Unary::Atan => kernel::atan(a),
            // the standard library's are off by several units in the last place
            Unary::Sinh => core_math::sinh(a),
            Unary::Cosh => core_math::cosh(a),
            Unary::Tanh => core_math::tanh(a),
            Unary::Asinh => core_math::asinh(a),
            Unary::Acosh => core_math::acosh(a),
            Unary::Atanh => core_math::atanh(a),
            Unary::Arcinv => inverse_involute(a),
            Unary::Exp => kernel::exp(a),
            Unary::Ln => kernel::ln(a),
            Unary::Abs => a.abs(),
            Unary::Sign if a == 0.0 => 0.0,
            Unary::Sign => a.signum(),
        }
    }

    /// Name in printed expressions.
    pub fn name(self) -> &'static str {
        match self {
            Unary::Neg => "-",
            Unary::Sqrt => "sqrt",
            Unary::Sin => "sin",
            Unary::Cos => "cos",
            Unary::Tan => "tan",
            Unary::Asin => "asin",
            Unary::Acos => "acos",
            Unary::Atan => "atan",
            // the standard library's are off by several units in the last place
            Unary::Sinh => "sinh",
            Unary::Cosh => "cosh",
            Unary::Tanh => "tanh",
            Unary::Asinh => "asinh",
            Unary::Acosh => "acosh",
            Unary::Atanh => "atanh",
            Unary::Arcinv => "arcinv",
            Unary::Exp => "exp",
            Unary::Ln => "ln",
            Unary::Abs => "abs",
            Unary::Sign => "sign",
        }
    }
}

impl Binary {
    /// All of them, for tests that must cover every one.
    pub const ALL: [Binary; 8] =
        [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div, Binary::Pow, Binary::Atan2, Binary::Min, Binary::Max];

    /// The value; NaN outside the domain. `Atan2` takes (y, x). NaN in, NaN out, for `Min` and `Max` too, which give their
    /// second operand where the two are equal.
    #[inline]
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Pow => a.powf(b),
            Binary::Atan2 => kernel::atan2(a, b),
            // not `f64::min`, which drops a NaN and leaves the sign of min(0, −0) open
            Binary::Min if a < b || a.is_nan() => a,
            Binary::Max if a > b || a.is_nan() => a,
            Binary::Min | Binary::Max => b,
        }
    }

    /// Name in printed expressions.
    pub fn name(self) -> &'static str {
        match self {
            Binary::Add => "+",
            Binary::Sub => "-",
            Binary::Mul => "*",
            Binary::Div => "/",
            Binary::Pow => "^",
            Binary::Atan2 => "atan2",
            Binary::Min => "min",
            Binary::Max => "max",
        }
    }
}

/// Angles up to which the involute function comes from its series.
pub(crate) const INVOLUTE_SERIES_BELOW: f64 = 0.2;

/// Coefficients of a³, a⁵, … in tan a − a: those of the tangent.
pub(crate) const INVOLUTE_SERIES: [f64; 9] = [
    1.0 / 3.0,
    2.0 / 15.0,
    17.0 / 315.0,
    62.0 / 2835.0,
    1382.0 / 155_925.0,
    21_844.0 / 6_081_075.0,
    929_569.0 / 638_512_875.0,
    6_404_582.0 / 10_854_718_875.0,
    443_861_162.0 / 1_856_156_927_625.0,
];

/// tan a − a; by its series where the difference would cancel.
fn involute(a: f64) -> f64 {
    if a.abs() > INVOLUTE_SERIES_BELOW {
        return a.tan() - a;
    }
    let square = a * a;
    a * square * INVOLUTE_SERIES.iter().rev().fold(0.0, |sum, c| sum * square + c)
}

/// The angle in (−π/2, π/2) with tan a − a = x, by Newton from above, where the involute function is convex; good to a few
/// units in the last place.
pub(crate) fn inverse_involute(x: f64) -> f64 {
    let target = x.abs();
    if target == 0.0 || !target.is_finite() {
        return if target.is_infinite() { x.signum() * std::f64::consts::FRAC_PI_2 } else { x };
    }
    // above the root: tan a − a ≥ a³/3, and tan a = x + a < x + π/2
    let mut a = (3.0 * target).cbrt().min((target + std::f64::consts::FRAC_PI_2).atan());
    for _ in 0..60 {
        let next = a - (involute(a) - target) / a.tan().powi(2);
        if next.is_nan() || next >= a || next <= 0.0 {
            break;
        }
        a = next;
    }
    a.copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reference values: mpmath at 40 digits, rounded.
    #[test]
    fn the_inverse_involute_meets_reference_values() {
        for degrees in [1e-4, 0.01, 0.5, 3.0, 11.0, 14.5, 20.0, 25.0, 45.0, 70.0, 89.0, 89.99] {
            let angle = f64::to_radians(degrees);
            let found = inverse_involute(involute(angle));
            assert!((found - angle).abs() <= 4.0 * f64::EPSILON * angle, "{degrees} deg: {found}");
        }
        // inv 20° = 0.0149043838673364…
        assert!((inverse_involute(0.014904383867336446) - 0.3490658503988659).abs() < 1e-15);
        assert_eq!(inverse_involute(0.0), 0.0);
        assert_eq!(inverse_involute(-0.014904383867336446), -inverse_involute(0.014904383867336446));
        assert_eq!(inverse_involute(f64::INFINITY), std::f64::consts::FRAC_PI_2);
        assert!(inverse_involute(f64::NAN).is_nan());
    }

    #[test]
    fn the_series_of_the_involute_meets_the_difference() {
        for angle in [0.1999999, 0.2] {
            assert!((involute(angle) - (f64::tan(angle) - angle)).abs() < 1e-16);
        }
    }
}

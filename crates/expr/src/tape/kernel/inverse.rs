//! Inverse trigonometric functions.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use super::{polynomial, split, two_product, two_sum};

/// What π/2, rounded, lacks; half as much lacks π/4.
const HALF_PI_REST: f64 = 6.123233995736766e-17;
/// The arc tangent of ½, and what it lacks.
const ATAN_HALF: (f64, f64) = (0.4636476090008061, 2.2698777452961687e-17);
/// Below this ratio an arc tangent is the ratio itself, rounded.
const TINY_RATIO: f64 = 1e-9;
/// 2⁵⁰⁰ and 2⁶⁰⁰, the latter in both directions: between the former and its inverse products of two are exact in two words.
const LARGE: f64 = 3.273390607896142e150;
const SHRINK: f64 = 2.409919865102884e-181;
const GROW: f64 = 4.149515568880993e180;

/// (z − atan z) / z³ for |z| ≤ 7/16 (fdlibm s_atan.c).
const ARC_TANGENT: [f64; 11] = [
    0.3333333333333293,
    -0.19999999999876483,
    0.14285714272503466,
    -0.11111110405462356,
    0.09090887133436507,
    -0.0769187620504483,
    0.06661073137387531,
    -0.058335701337905735,
    0.049768779946159324,
    -0.036531572744216916,
    0.016285820115365782,
];

/// The angle of the point (x, y) in [−π, π].
///
/// The tangent of a difference brings the smaller over the larger of the two near 0, ½ or 1, where the numerator is exact;
/// what the division leaves is kept. Then the angle is reflected at 45° and at 90°.
#[inline(always)]
pub(crate) fn atan2(y: f64, x: f64) -> f64 {
    let (rise, run) = (y.abs(), x.abs());
    let (is_steep, is_left) = (rise > run, x.is_sign_negative());
    let quarters = if is_steep {
        1.0
    } else if is_left {
        2.0
    } else {
        0.0
    };
    let sense = if is_steep == is_left { 1.0 } else { -1.0 };

    let (small, large) = if is_steep { (run, rise) } else { (rise, run) };
    let is_infinite = large == f64::INFINITY;
    let scale = if large > LARGE {
        SHRINK
    } else if large < 1.0 / LARGE {
        GROW
    } else {
        1.0
    };
    let both = small == f64::INFINITY;
    let small = if is_infinite { f64::from(u8::from(both)) } else { small * scale };
    let large = if is_infinite { 1.0 } else { large * scale };
    let ratio = small / large;

    let (is_near_half, is_near_one) = (ratio > 0.25, ratio > 0.71875);
    let (center, base, base_rest) = if is_near_one {
        (1.0, FRAC_PI_4, 0.5 * HALF_PI_REST)
    } else if is_near_half {
        (0.5, ATAN_HALF.0, ATAN_HALF.1)
    } else {
        (0.0, 0.0, 0.0)
    };
    let numerator = small - center * large;
    let (denominator, denominator_rest) = two_sum(large, center * small);
    let z = numerator / denominator;
    let (product, product_rest) = two_product(z, denominator);
    let z_rest = (((numerator - product) - product_rest) - z * denominator_rest) / denominator;
    let square = z * z;
    let correction = z_rest - z * square * polynomial(square, ARC_TANGENT);

    let (start, start_rest) = two_sum(quarters * FRAC_PI_2, sense * base);
    let (angle, angle_rest) = two_sum(start, sense * z);
    let magnitude = angle + (angle_rest + start_rest + (sense * (base_rest + correction) + quarters * HALF_PI_REST));
    // rounded once, also where the result is denormal
    let is_plain = ratio < TINY_RATIO && quarters == 0.0 && !is_infinite;
    let magnitude = if is_plain { rise / run } else { magnitude };
    let magnitude = if rise == 0.0 { quarters * FRAC_PI_2 } else { magnitude };
    if x.is_nan() || y.is_nan() { f64::NAN } else { magnitude.copysign(y) }
}

#[inline(always)]
pub(crate) fn atan(x: f64) -> f64 {
    atan2(x, 1.0)
}

/// (asin √z − √z) / √z for z ≤ ¼ (fdlibm e_asin.c).
#[inline(always)]
fn arc_sine_tail(z: f64) -> f64 {
    const P: [f64; 6] = [
        0.16666666666666666,
        -0.3255658186224009,
        0.20121253213486293,
        -0.04005553450067941,
        0.0007915349942898145,
        3.479331075960212e-5,
    ];
    const Q: [f64; 5] = [1.0, -2.403394911734414, 2.0209457602335057, -0.6882839716054533, 0.07703815055590194];
    z * polynomial(z, P) / polynomial(z, Q)
}

/// For |x| > ½ arc functions go by the half angle: asin x = π/2 − 2 asin √((1 − x) / 2).
struct HalfAngle {
    /// The root, its upper half, and what the latter lacks.
    root: f64,
    head: f64,
    rest: f64,
    tail: f64,
}

#[inline(always)]
fn half_angle(magnitude: f64) -> HalfAngle {
    let z = 0.5 * (1.0 - magnitude);
    let root = z.sqrt();
    let head = split(root).0;
    let rest = if root == 0.0 { 0.0 } else { (z - head * head) / (root + head) };
    HalfAngle { root, head, rest, tail: arc_sine_tail(z) }
}

#[inline(always)]
pub(crate) fn asin(x: f64) -> f64 {
    let magnitude = x.abs();
    let direct = magnitude + magnitude * arc_sine_tail(x * x);
    let HalfAngle { root, head, rest, tail } = half_angle(magnitude);
    let lacking = 2.0 * root * tail - (HALF_PI_REST - 2.0 * rest);
    let by_half = FRAC_PI_4 - (lacking - (FRAC_PI_4 - 2.0 * head));
    (if magnitude < 0.5 { direct } else { by_half }).copysign(x)
}

#[inline(always)]
pub(crate) fn acos(x: f64) -> f64 {
    let magnitude = x.abs();
    let direct = FRAC_PI_2 - (x - (HALF_PI_REST - x * arc_sine_tail(x * x)));
    let HalfAngle { root, head, rest, tail } = half_angle(magnitude);
    let right = 2.0 * (head + (tail * root + rest));
    let left = 2.0 * (FRAC_PI_2 - (root + (tail * root - HALF_PI_REST)));
    if magnitude < 0.5 {
        direct
    } else if x < 0.0 {
        left
    } else {
        right
    }
}

//! Sine, cosine and tangent.

use super::payne_hanek;
use super::polynomial;

/// Up to here multiples of π/2 are subtracted in three exact pieces.
pub(crate) const FARTHEST: f64 = 500_000.0;

pub(crate) const TWO_OVER_PI: f64 = std::f64::consts::FRAC_2_PI;
// π/2 in pieces of 33 bits, so that a multiple below 2¹⁹ of each is exact, and what is left
pub(crate) const FIRST: f64 = 1.5707963267341256;
pub(crate) const SECOND: f64 = 6.077100506303966e-11;
pub(crate) const THIRD: f64 = 2.0222662487111665e-21;
pub(crate) const REST: f64 = 8.4784276603689e-32;
/// Adding it rounds to an integer, which then stands in the lowest bits.
pub(crate) const ROUNDER: f64 = 6755399441055744.0; // 1.5 · 2⁵²

/// An angle less a multiple of π/2: within ±π/4, `high + low`.
#[derive(Clone, Copy)]
pub(super) struct Reduced {
    pub(super) high: f64,
    pub(super) low: f64,
    /// How many quarter turns were subtracted; only the two lowest bits count.
    pub(super) quarters: u64,
}

/// True where an angle needs the long reduction; then the functions whose names end in `_far` take it.
#[inline(always)]
pub(crate) fn is_far(x: f64) -> bool {
    x.abs() > FARTHEST
}

#[inline(always)]
fn reduce_near(x: f64) -> Reduced {
    let shifted = x * TWO_OVER_PI + ROUNDER;
    let multiple = shifted - ROUNDER;
    // each difference is exact, or its error is what the next line finds
    let first = x - multiple * FIRST;
    let subtracted = multiple * SECOND;
    let second = first - subtracted;
    let second_error = (first - second) - subtracted;
    let subtracted = multiple * THIRD;
    let third = second - subtracted;
    let third_error = (second - third) - subtracted;
    let rest = (multiple * REST - second_error) - third_error;
    let high = third - rest;
    Reduced { high, low: (third - high) - rest, quarters: shifted.to_bits() }
}

// sine on ±π/4: the coefficient of x³, and those from x⁵ on (fdlibm k_sin.c)
pub(crate) const SINE_CUBE: f64 = -0.16666666666666632;
pub(crate) const SINE_TAIL: [f64; 5] =
    [0.00833333333332249, -0.0001984126982985795, 2.7557313707070068e-6, -2.5050760253406863e-8, 1.58969099521155e-10];
/// Cosine on ±π/4: the coefficients from x⁴ on (fdlibm k_cos.c).
pub(crate) const COSINE_TAIL: [f64; 6] = [
    0.0416666666666666,
    -0.001388888888887411,
    2.480158728947673e-5,
    -2.7557314351390663e-7,
    2.087572321298175e-9,
    -1.1359647557788195e-11,
];

/// Sine on ±π/4.
#[inline(always)]
fn sine(x: f64, low: f64) -> f64 {
    let z = x * x;
    let cube = z * x;
    let tail = polynomial(z, SINE_TAIL);
    x - ((z * (0.5 * low - cube * tail) - low) - cube * SINE_CUBE)
}

/// Cosine on ±π/4, with FreeBSD's way to keep what 1 − x²/2 loses.
#[inline(always)]
fn cosine(x: f64, low: f64) -> f64 {
    let z = x * x;
    let tail = z * polynomial(z, COSINE_TAIL);
    let half = 0.5 * z;
    let most = 1.0 - half;
    most + (((1.0 - most) - half) + (z * tail - x * low))
}

#[inline(always)]
fn sin_cos_of(angle: Reduced) -> (f64, f64) {
    let (s, c) = (sine(angle.high, angle.low), cosine(angle.high, angle.low));
    let is_odd = angle.quarters & 1 == 1;
    let (sin, cos) = if is_odd { (c, s) } else { (s, c) };
    let sin_sign = (angle.quarters & 2) << 62;
    let cos_sign = (angle.quarters.wrapping_add(1) & 2) << 62;
    (f64::from_bits(sin.to_bits() ^ sin_sign), f64::from_bits(cos.to_bits() ^ cos_sign))
}

/// Sine and cosine of an angle that is not far.
#[inline(always)]
pub(crate) fn sin_cos_near(x: f64) -> (f64, f64) {
    sin_cos_of(reduce_near(x))
}

/// Sine and cosine of any angle.
#[inline]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    if is_far(x) { sin_cos_of(payne_hanek::reduce(x)) } else { sin_cos_near(x) }
}

#[inline]
pub(crate) fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

#[inline]
pub(crate) fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// Tangent (fdlibm k_tan.c), its cases computed side by side.
#[inline(always)]
fn tan_of(angle: Reduced) -> f64 {
    const T0: f64 = 0.3333333333333341;
    const T: [f64; 12] = [
        0.13333333333320124,
        0.05396825397622605,
        0.021869488294859542,
        0.0088632398235993,
        0.0035920791075913124,
        0.0014562094543252903,
        0.0005880412408202641,
        0.0002464631348184699,
        7.817944429395571e-5,
        7.140724913826082e-5,
        -1.8558637485527546e-5,
        2.590730518636337e-5,
    ];
    const BIG: f64 = 0.67434;
    const QUARTER_PI: (f64, f64) = (std::f64::consts::FRAC_PI_4, 3.061616997868383e-17);
    let is_big = angle.high.abs() >= BIG;
    let sign = 1f64.copysign(angle.high);
    // near π/4 its distance from there is used
    let x = if is_big { (QUARTER_PI.0 - sign * angle.high) + (QUARTER_PI.1 - sign * angle.low) } else { angle.high };
    let low = if is_big { 0.0 } else { angle.low };
    let z = x * x;
    let cube = z * x;
    let small = (low + z * (cube * polynomial(z, T) + low)) + T0 * cube;
    let tangent = x + small;
    let is_odd = angle.quarters & 1 == 1;
    // tan(π/4 − x) = 1 − 2 (x − tan²x / (1 + tan x) …), and its negative inverse with −1 for 1
    let one = if is_odd { -1.0 } else { 1.0 };
    let from_quarter = sign * (one - 2.0 * (x - (tangent * tangent / (tangent + one) - small)));
    // −1 / tangent with the rounding of both put right
    let cleared = |v: f64| f64::from_bits(v.to_bits() & 0xffff_ffff_0000_0000);
    let inverse = -1.0 / tangent;
    let (head, cut) = (cleared(tangent), cleared(inverse));
    let cotangent = cut + inverse * ((1.0 + cut * head) + cut * (small - (head - x)));
    if is_big {
        from_quarter
    } else if is_odd {
        cotangent
    } else if x == 0.0 {
        x
    } else {
        tangent
    }
}

/// Tangent of an angle that is not far.
#[inline(always)]
pub(crate) fn tan_near(x: f64) -> f64 {
    tan_of(reduce_near(x))
}

/// Tangent of any angle.
#[inline]
pub(crate) fn tan(x: f64) -> f64 {
    if is_far(x) { tan_of(payne_hanek::reduce(x)) } else { tan_near(x) }
}

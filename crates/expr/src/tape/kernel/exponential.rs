//! Exponential and logarithm.

use super::polynomial;

/// ln 2: 32 bits, so that a multiple of it is exact, and the rest.
const LN_2: (f64, f64) = (0.6931471803691238, 1.9082149292705877e-10);

/// 2ᵏ for k in [−1022, 1023], k being an integer.
#[inline(always)]
fn power_of_two(k: f64) -> f64 {
    // the sum's lowest bits are k + 1023
    const SHIFT: f64 = 4503599627370496.0 + 1023.0; // 2⁵² + 1023
    f64::from_bits((k + SHIFT).to_bits() << 52)
}

/// fdlibm e_exp.c
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    const P: [f64; 5] = [
        0.16666666666666602,
        -0.0027777777777015593,
        6.613756321437934e-5,
        -1.6533902205465252e-6,
        4.1381367970572385e-8,
    ];
    const ROUNDER: f64 = 6755399441055744.0; // 1.5 · 2⁵²
    // beyond, the result is infinite or zero anyway; NaN stays
    let x = x.clamp(-750.0, 710.0);
    let k = (x * std::f64::consts::LOG2_E + ROUNDER) - ROUNDER;
    let (high, low) = (x - k * LN_2.0, k * LN_2.1);
    let r = high - low;
    let square = r * r;
    let c = r - square * polynomial(square, P);
    let y = 1.0 - ((low - r * c / (2.0 - c)) - high);
    // in two factors: one alone may be out of range
    let half = (0.5 * k + ROUNDER) - ROUNDER;
    y * power_of_two(half) * power_of_two(k - half)
}

/// fdlibm e_log.c
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    const L: [f64; 7] = [
        0.6666666666666735,
        0.3999999999940942,
        0.2857142874366239,
        0.22222198432149784,
        0.1818357216161805,
        0.15313837699209373,
        0.14798198605116586,
    ];
    const GROW: f64 = 18014398509481984.0; // 2⁵⁴
    const ROOT_HALF: u64 = 0x3fe6_a09e_0000_0000;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    let is_denormal = x < f64::MIN_POSITIVE;
    let grown = if is_denormal { x * GROW } else { x };
    // x = 2ᵏ m with m in [√½, √2)
    let shifted = grown.to_bits().wrapping_add(ONE - ROOT_HALF);
    let exponent = f64::from_bits((shifted >> 52) | 0x4330_0000_0000_0000) - (4503599627370496.0 + 1023.0);
    let k = if is_denormal { exponent - 54.0 } else { exponent };
    let m = f64::from_bits((shifted & 0x000f_ffff_ffff_ffff).wrapping_add(ROOT_HALF));
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let half_square = 0.5 * f * f;
    let tail = z * polynomial(z, L);
    let value = k * LN_2.0 - ((half_square - (s * (half_square + tail) + k * LN_2.1)) - f);
    if x == 0.0 {
        f64::NEG_INFINITY
    } else if x < 0.0 || x.is_nan() {
        f64::NAN
    } else if x == f64::INFINITY {
        x
    } else {
        value
    }
}

//! Elementary functions: the one definition that every evaluator uses.
//!
//! Each is branch-free for the arguments that matter, of additions, multiplications, divisions, square roots and bits only:
//! never a fused multiply-add, which some machines lack. So a loop over lanes becomes vector instructions of any width, and
//! its results are those of one number at a time, bit for bit, on every machine.
//!
//! All errors are below one unit in the last place (`tests/kernels.rs` measures them against correctly rounded values, over
//! the whole range). Polynomials are those of Sun's fdlibm 5.3, whose file is named beside each.

mod exponential;
mod inverse;
mod payne_hanek;
pub(crate) mod trigonometric;

pub(crate) use exponential::{exp, ln};
pub(crate) use inverse::{acos, asin, atan, atan2};
pub(crate) use trigonometric::{cos, sin, sin_cos, tan};
pub(crate) use trigonometric::{is_far, sin_cos_near, tan_near};

/// `value` where |last| ≤ 1, else NaN.
#[inline(always)]
pub(crate) fn settled(value: f64, last: f64) -> f64 {
    value + 0.0 * (1.0 - last.abs()).sqrt()
}

/// Σ cₖ xᵏ.
#[inline(always)]
fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    let mut sum = coefficients[N - 1];
    for k in (0..N - 1).rev() {
        sum = sum * x + coefficients[k];
    }
    sum
}

/// The sum, rounded, and what the rounding left (Knuth).
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let shifted = sum - a;
    (sum, (a - (sum - shifted)) + (b - shifted))
}

/// The upper 26 bits and the rest (Veltkamp); for numbers below 1e300.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a; // 2²⁷ + 1
    let high = shifted - (shifted - a);
    (high, a - high)
}

/// The product, rounded, and what the rounding left (Dekker); for numbers between 1e-140 and 1e140.
#[inline(always)]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a1, a2), (b1, b2)) = (split(a), split(b));
    (product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2)
}

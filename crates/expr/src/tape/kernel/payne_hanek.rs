//! Angles of any size less a multiple of π/2 (Payne and Hanek, 1983): only those bits of 2/π are multiplied that do not make
//! whole turns.

use super::trigonometric::Reduced;
use super::two_product;

/// 64 zeros, then the bits of 2/π behind the point.
const TWO_OVER_PI: [u64; 20] = [
    0,
    0xa2f9836e4e441529,
    0xfc2757d1f534ddc0,
    0xdb6295993c439041,
    0xfe5163abdebbc561,
    0xb7246e3a424dd2e0,
    0x06492eea09d1921c,
    0xfe1deb1cb129a73e,
    0xe88235f52ebb4484,
    0xe99c7026b45f7e41,
    0x3991d639835339f4,
    0x9c845f8bbdf9283b,
    0x1ff897ffde05980f,
    0xef2f118b5a0a6d1f,
    0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b,
    0x3d0739f78a5292ea,
    0x6bfb5fb11f8d5d08,
    0x56033046fc7b6bab,
];
const PI_HALF: (f64, f64) = (std::f64::consts::FRAC_PI_2, 6.123233995736766e-17);

/// Of any |x| above 2²; NaN of an infinity or a NaN.
#[cold]
pub(super) fn reduce(x: f64) -> Reduced {
    if !x.is_finite() {
        return Reduced { high: f64::NAN, low: f64::NAN, quarters: 0 };
    }
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32 - 1075; // |x| = mantissa · 2^exponent
    let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
    // x · 2/π modulo 4: two bits before the point, 190 behind it, good to 137
    let product = multiplied(mantissa, window((exponent - 1 + 63) as usize));
    let fraction = [product[0] << 2 | product[1] >> 62, product[1] << 2 | product[2] >> 62, product[2] << 2];
    let rounds_up = fraction[0] >> 63 == 1;
    let quarters = (product[0] >> 62) + u64::from(rounds_up);
    let share = two_words(if rounds_up { negated(fraction) } else { fraction });
    let (angle, error) = two_product(share.0, PI_HALF.0);
    let rest = error + (share.0 * PI_HALF.1 + share.1 * PI_HALF.0);
    let high = angle + rest;
    let low = (angle - high) + rest;
    let sign = if rounds_up == x.is_sign_negative() { 1.0 } else { -1.0 };
    let quarters = if x.is_sign_negative() { quarters.wrapping_neg() } else { quarters };
    Reduced { high: sign * high, low: sign * low, quarters }
}

/// 192 bits of the table from a bit on.
fn window(first: usize) -> [u64; 3] {
    let (word, shift) = (first / 64, first % 64);
    let at = |k: usize| TWO_OVER_PI.get(k).copied().unwrap_or(0);
    [0, 1, 2].map(|k| {
        let upper = at(word + k);
        if shift == 0 { upper } else { upper << shift | at(word + k + 1) >> (64 - shift) }
    })
}

/// The product modulo 2¹⁹², the most significant word first.
fn multiplied(a: u64, b: [u64; 3]) -> [u64; 3] {
    let wide = |k: usize| u128::from(a) * u128::from(b[k]);
    let lowest = wide(2);
    let middle = wide(1) + (lowest >> 64);
    let highest = wide(0) + (middle >> 64);
    [highest as u64, middle as u64, lowest as u64]
}

fn negated(a: [u64; 3]) -> [u64; 3] {
    let (lowest, carry) = (!a[2]).overflowing_add(1);
    let (middle, carry) = (!a[1]).overflowing_add(u64::from(carry));
    [(!a[0]).wrapping_add(u64::from(carry)), middle, lowest]
}

/// A fraction of 192 bits as a sum of two numbers of 53 bits each.
fn two_words(a: [u64; 3]) -> (f64, f64) {
    let zeros = if a[0] > 0 { a[0].leading_zeros() } else { 64 + a[1].leading_zeros() };
    let [first, second, third] = if zeros < 64 { a } else { [a[1], a[2], 0] };
    let shift = zeros % 64;
    let joined = |upper: u64, lower: u64| if shift == 0 { upper } else { upper << shift | lower >> (64 - shift) };
    let (first, second) = (joined(first, second), joined(second, third));
    let scale = |bits: u32| f64::from_bits(u64::from(1023 - bits) << 52); // 2^−bits
    let high = (first >> 11) as f64 * scale(53 + zeros);
    let next = (first << 53) | (second >> 11);
    (high, (next >> 11) as f64 * scale(106 + zeros))
}

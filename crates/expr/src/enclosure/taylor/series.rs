//! Operations on power series, coefficient by coefficient.
//!
//! A function y = f(a) whose derivative is a series g already known has `k y_k = Σ j a_j g_{k−j}`; where g needs y itself, as with
//! `exp`, its coefficients are worked out just ahead (Moore's recurrences; see Griewank and Walther, Evaluating Derivatives, ch. 13).

use std::array::from_fn;

use super::Coefficient;
use crate::symbolic::curve::Curve;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::{Instruction, Operation};

/// Whole powers up to this one are products, so that they have series at zero as well.
const LARGEST_PRODUCT: i32 = 64;

/// The commonest operations on series so short that their loops are unrolled; `false` for others, which are left to do.
pub(super) fn short<N: Coefficient, const TERMS: usize>(step: &Instruction, registers: &mut [N]) -> bool {
    let (registers, _) = registers.as_chunks_mut::<TERMS>();
    let a = registers[step.a as usize];
    let b = || registers[step.b as usize];
    let none = [N::number(0.0); TERMS];
    let out = match step.operation {
        Operation::Unary(Unary::Neg) => a.map(|a| -a),
        Operation::Unary(Unary::Sqrt) => written(none, |out| root(&a, out)),
        Operation::Binary(Binary::Add) => {
            let b = b();
            from_fn(|k| a[k] + b[k])
        }
        Operation::Binary(Binary::Sub) => {
            let b = b();
            from_fn(|k| a[k] - b[k])
        }
        Operation::Binary(Binary::Mul) => {
            let b = b();
            from_fn(|k| product(&a, &b, k))
        }
        Operation::Binary(Binary::Div) => written(none, |out| quotient(&a, &b(), out)),
        Operation::SinCos => {
            let (mut sine, mut cosine) = (none, none);
            sin_cos(&a, &mut sine, &mut cosine);
            registers[step.b as usize] = cosine;
            sine
        }
        _ => return false,
    };
    registers[step.out as usize] = out;
    true
}

fn written<T>(mut out: T, write: impl FnOnce(&mut T)) -> T {
    write(&mut out);
    out
}

/// A one-operand operation; `other` and `room` (two series long) are overwritten.
pub(super) fn unary<N: Coefficient>(op: Unary, a: &[N], out: &mut [N], other: &mut [N], room: &mut [N]) {
    let one = N::number(1.0);
    match op {
        Unary::Neg => each(out, |k| -a[k]),
        Unary::Sin => sin_cos(a, out, other),
        Unary::Cos => sin_cos(a, other, out),
        Unary::Sinh => sinh_cosh(a, out, other),
        Unary::Cosh => sinh_cosh(a, other, out),
        Unary::Exp => {
            out[0] = a[0].unary(Unary::Exp);
            for k in 1..a.len() {
                out[k] = slope(a, out, k) / count(k);
            }
        }
        Unary::Sqrt => root(a, out),
        Unary::Ln => by_quotient(op, a, a, out),
        Unary::Tan => coupled(op, a, out, room, |y, k| plus_one(product(y, y, k), one, k)),
        Unary::Tanh => coupled(op, a, out, room, |y, k| plus_one(-product(y, y, k), one, k)),
        Unary::Atan => {
            each(other, |k| plus_one(product(a, a, k), one, k));
            by_quotient(op, a, other, out);
        }
        Unary::Atanh => {
            each(other, |k| plus_one(-product(a, a, k), one, k));
            by_quotient(op, a, other, out);
        }
        Unary::Asin | Unary::Acos | Unary::Asinh | Unary::Acosh => {
            let (inner, slope) = room.split_at_mut(a.len());
            match op {
                Unary::Asinh => each(inner, |k| plus_one(product(a, a, k), one, k)),
                Unary::Acosh => each(inner, |k| plus_one(product(a, a, k), -one, k)),
                _ => each(inner, |k| plus_one(-product(a, a, k), one, k)),
            }
            root(inner, slope);
            by_quotient(op, a, slope, out);
            if op == Unary::Acos {
                out[1..].iter_mut().for_each(|coefficient| *coefficient = -*coefficient);
            }
        }
        Unary::Arcinv => arcinv(a, out, other),
        Unary::Abs => {
            let side = a[0].unary(Unary::Sign);
            each(out, |k| if k == 0 { a[0].unary(Unary::Abs) } else { side * a[k] });
        }
        Unary::Sign => each(out, |k| if k == 0 { a[0].unary(Unary::Sign) } else { N::number(0.0) }),
    }
}

/// A two-operand operation; `other` and `room` (two series long) are overwritten.
pub(super) fn binary<N: Coefficient>(op: Binary, a: &[N], b: &[N], out: &mut [N], other: &mut [N], room: &mut [N]) {
    match op {
        Binary::Add => each(out, |k| a[k] + b[k]),
        Binary::Sub => each(out, |k| a[k] - b[k]),
        Binary::Mul => each(out, |k| product(a, b, k)),
        Binary::Div => quotient(a, b, out),
        Binary::Pow => power(a, b, out, other, room),
        Binary::Atan2 => {
            // θ' = (x y' − y x') / (x² + y²)
            let (y, x) = (a, b);
            each(other, |k| product(x, x, k) + product(y, y, k));
            out[0] = y[0].binary(op, x[0]);
            for k in 1..a.len() {
                let turned = (1..=k).map(|j| count::<N>(j) * (x[k - j] * y[j] - y[k - j] * x[j]));
                let before = (1..k).map(|j| count::<N>(j) * out[j] * other[k - j]);
                out[k] = (sum(turned) - sum(before)) / (count::<N>(k) * other[0]);
            }
        }
        Binary::Min | Binary::Max => {
            let half = N::number(0.5);
            let side = (a[0] - b[0]).unary(Unary::Sign) * half;
            let (of_a, of_b) = if op == Binary::Max { (half + side, half - side) } else { (half - side, half + side) };
            each(out, |k| if k == 0 { a[0].binary(op, b[0]) } else { of_a * a[k] + of_b * b[k] });
        }
    }
}

/// sin a and cos a together.
pub(super) fn sin_cos<N: Coefficient>(a: &[N], sine: &mut [N], cosine: &mut [N]) {
    (sine[0], cosine[0]) = (a[0].unary(Unary::Sin), a[0].unary(Unary::Cos));
    for k in 1..a.len() {
        sine[k] = slope(a, cosine, k) / count(k);
        cosine[k] = -slope(a, sine, k) / count(k);
    }
}

fn sinh_cosh<N: Coefficient>(a: &[N], sine: &mut [N], cosine: &mut [N]) {
    (sine[0], cosine[0]) = (a[0].unary(Unary::Sinh), a[0].unary(Unary::Cosh));
    for k in 1..a.len() {
        sine[k] = slope(a, cosine, k) / count(k);
        cosine[k] = slope(a, sine, k) / count(k);
    }
}

/// The derivative of a curve, of some order, along a: its cubic about `a_0`, by Horner.
pub(super) fn on_curve<N: Coefficient>(curve: &Curve, order: u8, a: &[N], out: &mut [N], room: &mut [N]) {
    let (step, sum) = room.split_at_mut(a.len());
    each(step, |k| if k == 0 { N::number(0.0) } else { a[k] });
    out.fill(N::number(0.0));
    for (derivative, factorial) in [(3u8, 6.0), (2, 2.0), (1, 1.0), (0, 1.0)] {
        each(sum, |k| product(out, step, k));
        out.copy_from_slice(&sum[..a.len()]);
        // a curve of cubics has no more than three derivatives
        if order + derivative <= 3 {
            out[0] = out[0] + a[0].on_curve(curve, order + derivative) / N::number(factorial);
        }
    }
}

/// y with `y' = a' / g`.
fn by_quotient<N: Coefficient>(op: Unary, a: &[N], g: &[N], out: &mut [N]) {
    out[0] = a[0].unary(op);
    for k in 1..a.len() {
        let before = (1..k).map(|j| count::<N>(j) * out[j] * g[k - j]);
        out[k] = (count::<N>(k) * a[k] - sum(before)) / (count::<N>(k) * g[0]);
    }
}

/// y with `y' = g a'`, where coefficient k of g follows from those of y up to k.
fn coupled<N: Coefficient>(op: Unary, a: &[N], out: &mut [N], g: &mut [N], of: impl Fn(&[N], usize) -> N) {
    out[0] = a[0].unary(op);
    for k in 1..a.len() {
        g[k - 1] = of(out, k - 1);
        out[k] = slope(a, g, k) / count(k);
    }
}

/// y with tan y − y = a, so that `(y + a)² y' = a'`.
fn arcinv<N: Coefficient>(a: &[N], out: &mut [N], square: &mut [N]) {
    out[0] = a[0].unary(Unary::Arcinv);
    for k in 1..a.len() {
        let tangent = |j: usize, out: &[N]| out[j] + a[j];
        square[k - 1] = sum((0..k).map(|j| tangent(j, out) * tangent(k - 1 - j, out)));
        let before = (1..k).map(|j| count::<N>(j) * out[j] * square[k - j]);
        out[k] = (count::<N>(k) * a[k] - sum(before)) / (count::<N>(k) * square[0]);
    }
}

fn root<N: Coefficient>(a: &[N], out: &mut [N]) {
    out[0] = a[0].unary(Unary::Sqrt);
    for k in 1..a.len() {
        let before = sum((1..k).map(|j| out[j] * out[k - j]));
        out[k] = (a[k] - before) / (N::number(2.0) * out[0]);
    }
}

fn quotient<N: Coefficient>(a: &[N], b: &[N], out: &mut [N]) {
    for k in 0..a.len() {
        out[k] = (a[k] - sum((0..k).map(|j| out[j] * b[k - j]))) / b[0];
    }
}

/// aᵇ: a product for whole b, so that it has a series at zero; else `a y' = b a' y` for constant b, and exp(b ln a).
fn power<N: Coefficient>(a: &[N], b: &[N], out: &mut [N], other: &mut [N], room: &mut [N]) {
    let value = a[0].binary(Binary::Pow, b[0]);
    let is_constant = b[1..].iter().all(|coefficient| coefficient.single() == Some(0.0));
    let whole = b[0].single().filter(|b| is_constant && b.fract() == 0.0 && b.abs() <= f64::from(LARGEST_PRODUCT));
    if let Some(exponent) = whole {
        let (sum, by) = room.split_at_mut(a.len());
        each(other, |k| N::number(if k == 0 { 1.0 } else { 0.0 }));
        for _ in 0..exponent.abs() as u32 {
            each(sum, |k| product(other, a, k));
            other.copy_from_slice(sum);
        }
        if exponent < 0.0 {
            each(by, |k| N::number(if k == 0 { 1.0 } else { 0.0 }));
            quotient(by, other, out);
        } else {
            out.copy_from_slice(other);
        }
    } else if is_constant {
        out[0] = value;
        for k in 1..a.len() {
            let weight = |j: usize| b[0] * count(j) - count(k - j);
            out[k] = sum((1..=k).map(|j| weight(j) * a[j] * out[k - j])) / (count::<N>(k) * a[0]);
        }
    } else {
        by_quotient(Unary::Ln, a, a, other);
        let exponent = &mut room[..a.len()];
        each(exponent, |k| product(b, other, k));
        out[0] = value;
        for k in 1..a.len() {
            out[k] = slope(exponent, out, k) / count(k);
        }
    }
    out[0] = value;
}

/// Coefficient k of a b.
#[inline(always)]
fn product<N: Coefficient>(a: &[N], b: &[N], k: usize) -> N {
    sum((0..=k).map(|j| a[j] * b[k - j]))
}

/// `Σ j a_j g_{k−j}`: k times coefficient k of what has the derivative g a'.
fn slope<N: Coefficient>(a: &[N], g: &[N], k: usize) -> N {
    sum((1..=k).map(|j| count::<N>(j) * a[j] * g[k - j]))
}

#[inline(always)]
fn sum<N: Coefficient>(terms: impl Iterator<Item = N>) -> N {
    terms.reduce(|sum, term| sum + term).unwrap_or(N::number(0.0))
}

fn count<N: Coefficient>(k: usize) -> N {
    N::number(k as f64)
}

fn plus_one<N: Coefficient>(coefficient: N, one: N, k: usize) -> N {
    if k == 0 { coefficient + one } else { coefficient }
}

fn each<N>(out: &mut [N], of: impl Fn(usize) -> N) {
    out.iter_mut().enumerate().for_each(|(k, coefficient)| *coefficient = of(k));
}

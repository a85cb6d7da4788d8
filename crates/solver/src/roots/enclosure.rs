//! What a system is on a whole box of unknowns, and what follows for its roots.

use flank_expr::{Interval, IntervalEvaluator};

use crate::equations::solution::Range;
use crate::equations::system::System;

/// Widenings of the box about a computed root that are tried; each makes it four times as wide.
const WIDENINGS: u32 = 8;
/// The smallest radius, as a share of an unknown: a few units in the last place.
const LEAST_SHARE: f64 = 1e-15;

/// Evaluates a system on boxes at one set of parameters.
pub(crate) struct Enclosure<'s> {
    /// Residuals, then the Jacobian.
    whole: IntervalEvaluator<'s>,
    residuals: IntervalEvaluator<'s>,
    size: usize,
    inputs: Vec<Interval>,
    outputs: Vec<Interval>,
    at_point: Vec<Interval>,
    /// Inverse of the Jacobian's middle, row by row.
    inverse: Vec<f64>,
    /// Room for a matrix, for a row of slopes and for the terms of a sum.
    matrix: Vec<f64>,
    slopes: Vec<Interval>,
    terms: Vec<Interval>,
}

/// What is left of a box.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Contraction {
    /// It holds no root.
    Empty,
    /// All its roots lie in `left`. If it is `regular`, the Jacobian is known well enough to lead somewhere.
    To {
        /// What is left of the box.
        left: Vec<Interval>,
        /// Whether no diagonal entry of the preconditioned Jacobian may vanish.
        regular: bool,
    },
    /// Nothing was learned: the system may be undefined or its derivatives unbounded in it.
    Blind,
}

/// What is proven of a box about a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Proof {
    /// Nothing.
    None,
    /// No two roots lie in it.
    AtMostOne,
    /// Exactly one root lies in it.
    ExactlyOne,
}

impl<'s> Enclosure<'s> {
    pub(crate) fn new(system: &'s System, parameters: &[f64]) -> Enclosure<'s> {
        let size = system.size();
        let mut inputs = vec![Interval::WHOLE; size];
        inputs.extend(parameters.iter().copied().map(Interval::point));
        Enclosure {
            whole: IntervalEvaluator::in_two_parts(system.tape(), size),
            residuals: IntervalEvaluator::new(system.residual_tape()),
            size,
            inputs,
            outputs: vec![Interval::WHOLE; system.tape().output_count()],
            at_point: vec![Interval::WHOLE; size],
            inverse: vec![0.0; size * size],
            matrix: Vec::new(),
            slopes: Vec::new(),
            terms: Vec::new(),
        }
    }

    pub(crate) fn set_parameters(&mut self, parameters: &[f64]) {
        for (input, parameter) in self.inputs[self.size..].iter_mut().zip(parameters) {
            *input = Interval::point(*parameter);
        }
    }

    /// Residuals and Jacobian on a box.
    fn evaluate(&mut self, boxed: &[Interval]) {
        self.inputs[..self.size].copy_from_slice(boxed);
        self.whole.run(&self.inputs, &mut self.outputs);
    }

    /// Residuals on a box; whether one of them has no zero there.
    fn is_empty(&mut self, boxed: &[Interval]) -> bool {
        self.inputs[..self.size].copy_from_slice(boxed);
        let residuals = &mut self.outputs[..self.size];
        self.whole.run_first(&self.inputs, residuals);
        residuals.iter().any(|value| !value.contains(0.0))
    }

    /// The Jacobian on the box of these residuals.
    fn evaluate_slopes(&mut self) {
        self.whole.run_rest(&mut self.outputs[self.size..]);
    }

    /// Residuals at a point.
    fn evaluate_point(&mut self, point: &[f64]) {
        for (input, x) in self.inputs.iter_mut().zip(point) {
            *input = Interval::point(*x);
        }
        self.residuals.run(&self.inputs, &mut self.at_point);
    }

    fn jacobian(&self, row: usize, column: usize) -> Interval {
        self.outputs[self.size * (1 + row) + column]
    }

    /// How much of the change of the residuals over the box of the last contraction is due to one unknown: each row's
    /// changes as shares of their sum.
    pub(crate) fn smear(&self, boxed: &[Interval], column: usize) -> f64 {
        let change = |row: usize, k: usize| self.jacobian(row, k).magnitude() * boxed[k].width();
        let share = |row: usize| {
            let all: f64 = (0..self.size).map(|k| change(row, k)).sum();
            if all > 0.0 { change(row, column) / all } else { 0.0 }
        };
        (0..self.size).map(share).sum()
    }

    /// Cuts off what cannot hold a root: by the values on the box, then by the mean value form row by row, then by the
    /// preconditioned one.
    pub(crate) fn contract(&mut self, boxed: &[Interval]) -> Contraction {
        let n = self.size;
        if self.is_empty(boxed) {
            return Contraction::Empty;
        }
        self.evaluate_slopes();
        if !self.outputs.iter().all(|output| output.continuous) {
            return Contraction::Blind;
        }
        let middle: Vec<f64> = boxed.iter().map(|x| x.middle()).collect();
        self.evaluate_point(&middle);
        let mut left = boxed.to_vec();
        for row in 0..n {
            let slopes = &self.outputs[n * (1 + row)..][..n];
            if !narrow(&mut left, &middle, (self.at_point[row], slopes), None, &mut self.terms) {
                return Contraction::Empty;
            }
        }
        let mut regular = self.invert_middle();
        if regular {
            for row in 0..n {
                let value = self.preconditioned(row);
                regular &= !self.slopes[row].contains(0.0);
                if !narrow(&mut left, &middle, (value, &self.slopes), Some(row), &mut self.terms) {
                    return Contraction::Empty;
                }
            }
        }
        Contraction::To { left, regular }
    }

    /// What Krawczyk's operator proves of the box of these radii about a point.
    ///
    /// If each row of Y J over the box is dominated by its diagonal, measured in the radii, J is regular on it and the
    /// system takes no value twice; if the operator maps the box into its inside, there is a root.
    pub(crate) fn proof(&mut self, point: &[f64], radii: &[f64]) -> Proof {
        let n = self.size;
        let boxed: Vec<Interval> = point.iter().zip(radii).map(|(p, r)| around(*p, *r)).collect();
        self.evaluate(&boxed);
        if !self.outputs.iter().all(|output| output.continuous) || !self.invert_middle() {
            return Proof::None;
        }
        self.evaluate_point(point);
        let mut exists = true;
        for row in 0..n {
            let value = self.preconditioned(row);
            let slopes = &self.slopes;
            let off = |k: usize| if k == row { Interval::point(1.0) - slopes[k] } else { slopes[k] };
            let radius = |k: usize| Interval::point(radii[k]);
            let wander =
                (0..n).fold(Interval::point(0.0), |sum, k| sum + Interval::point(off(k).magnitude()) * radius(k));
            if wander.hi.is_nan() || wander.hi >= radii[row] {
                return Proof::None;
            }
            exists &= (wander + Interval::point(value.magnitude())).hi < radii[row];
        }
        if exists { Proof::ExactlyOne } else { Proof::AtMostOne }
    }

    /// Radii about a computed root within which exactly one root is proven to lie, as small as they are found; `None` if that cannot be
    /// proven.
    pub(crate) fn proven_radii(&mut self, root: &[f64]) -> Option<Vec<f64>> {
        let steps = self.newton_reach(root)?;
        let least = |p: &f64| LEAST_SHARE * p.abs().max(f64::MIN_POSITIVE / LEAST_SHARE);
        let mut radii: Vec<f64> = steps.iter().zip(root).map(|(step, p)| 2.0 * step + least(p)).collect();
        for _ in 0..WIDENINGS {
            if self.proof(root, &radii) == Proof::ExactlyOne {
                return Some(radii);
            }
            radii.iter_mut().for_each(|radius| *radius *= 4.0);
        }
        None
    }

    /// How far Newton's step from a point leads in each unknown, at most; `None` where the Jacobian has no inverse.
    pub(crate) fn newton_reach(&mut self, point: &[f64]) -> Option<Vec<f64>> {
        let here: Vec<Interval> = point.iter().copied().map(Interval::point).collect();
        self.evaluate(&here);
        if !self.invert_middle() {
            return None;
        }
        self.at_point.copy_from_slice(&self.outputs[..self.size]);
        Some((0..self.size).map(|row| self.preconditioned(row).magnitude()).collect())
    }

    /// A row of Y F at the point; the same of Y J on the box is put into `slopes`.
    fn preconditioned(&mut self, row: usize) -> Interval {
        let n = self.size;
        let weights = &self.inverse[row * n..][..n];
        self.slopes.clear();
        for column in 0..n {
            self.slopes.push(weighted(weights, self.outputs[n + column..].iter().step_by(n)));
        }
        weighted(weights, self.at_point.iter())
    }

    /// Puts the inverse of the Jacobian's middle into `inverse`; whether there is one.
    fn invert_middle(&mut self) -> bool {
        let n = self.size;
        self.matrix.clear();
        self.matrix.extend(self.outputs[n..n + n * n].iter().map(|slope| slope.middle()));
        self.inverse.fill(0.0);
        for k in 0..n {
            self.inverse[k * n + k] = 1.0;
        }
        eliminate(&mut self.matrix, &mut self.inverse, n)
    }
}

/// Σ weight · value; what is zero adds nothing.
fn weighted<'v>(weights: &[f64], values: impl Iterator<Item = &'v Interval>) -> Interval {
    let mut sum = None;
    for (weight, value) in weights.iter().zip(values) {
        if is_zero(*value) || *weight == 0.0 && !value.is_empty() {
            continue;
        }
        let term = value.times(*weight);
        sum = Some(sum.map_or(term, |sum| sum + term));
    }
    sum.unwrap_or(ZERO)
}

/// Nothing but zero.
const ZERO: Interval = Interval { lo: 0.0, hi: 0.0, continuous: true };

fn is_zero(value: Interval) -> bool {
    value.lo == 0.0 && value.hi == 0.0
}

/// p ± r, rounded outward.
pub(crate) fn around(p: f64, r: f64) -> Interval {
    let spread = Interval::point(p) + Interval::new(-r, r);
    Interval { continuous: true, ..spread }
}

/// The box of some ranges.
pub(crate) fn box_of(ranges: &[Range]) -> Vec<Interval> {
    ranges.iter().map(|range| Interval::new(range.low, range.high)).collect()
}

/// Solves `value + Σ slopes (x − middle) = 0` for each unknown (or `only` one) in turn; whether anything is left.
fn narrow(
    left: &mut [Interval],
    middle: &[f64],
    (value, slopes): (Interval, &[Interval]),
    only: Option<usize>,
    terms: &mut Vec<Interval>,
) -> bool {
    terms.clear();
    for (slope, (x, m)) in slopes.iter().zip(left.iter().zip(middle)) {
        terms.push(if is_zero(*slope) { ZERO } else { *slope * (*x - Interval::point(*m)) });
    }
    let sum = |terms: &[Interval], sum: Interval| {
        terms.iter().filter(|term| !is_zero(**term)).fold(sum, |sum, term| sum + *term)
    };
    if !sum(terms, value).contains(0.0) {
        return false;
    }
    let columns = match only {
        Some(column) => column..column + 1,
        None => 0..left.len(),
    };
    for column in columns.filter(|&column| !slopes[column].contains(0.0)) {
        let others = sum(&terms[column + 1..], sum(&terms[..column], value));
        let solved = Interval::point(middle[column]) - others / slopes[column];
        left[column] = Interval { continuous: true, ..left[column].intersection(solved) };
        if left[column].is_empty() {
            return false;
        }
    }
    true
}

/// Solves a system of `n` equations for some right sides, the columns of `right`, by Gauss and Jordan with the largest pivot of the
/// column; whether all pivots were numbers other than zero. Its rounding errors do no harm: any matrix may precondition.
pub(crate) fn eliminate(matrix: &mut [f64], right: &mut [f64], n: usize) -> bool {
    let columns = right.len() / n;
    for column in 0..n {
        let size = |row: usize| matrix[row * n + column].abs();
        let Some(pivot) = (column..n).max_by(|&a, &b| size(a).total_cmp(&size(b))) else { return false };
        let scale = matrix[pivot * n + column];
        if scale == 0.0 || !scale.is_finite() {
            return false;
        }
        for k in 0..n {
            matrix.swap(pivot * n + k, column * n + k);
        }
        for k in 0..columns {
            right.swap(pivot * columns + k, column * columns + k);
        }
        matrix[column * n..][..n].iter_mut().for_each(|entry| *entry /= scale);
        right[column * columns..][..columns].iter_mut().for_each(|entry| *entry /= scale);
        for row in (0..n).filter(|&row| row != column) {
            let factor = matrix[row * n + column];
            for k in column..n {
                matrix[row * n + k] -= factor * matrix[column * n + k];
            }
            for k in 0..columns {
                right[row * columns + k] -= factor * right[column * columns + k];
            }
        }
    }
    right.iter().all(|entry| entry.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in ±2 from a linear congruence, every third one zero.
    fn numbers() -> impl FnMut() -> f64 {
        let (mut state, mut count) = (7u64, 0);
        move || {
            count += 1;
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            if count % 3 == 0 { 0.0 } else { (state >> 11) as f64 / (1u64 << 51) as f64 - 2.0 }
        }
    }

    /// What is zero may be left out of a sum, as a factor or as a value: the ends stay the same bits.
    #[test]
    fn zeros_change_no_sum() {
        let mut next = numbers();
        for _ in 0..2000 {
            let weights: Vec<f64> = (0..4).map(|_| next()).collect();
            let ends: Vec<[f64; 2]> = (0..4).map(|_| [next(), next()]).collect();
            let values: Vec<Interval> = ends.iter().map(|[a, b]| Interval::new(a.min(*b), a.max(*b))).collect();
            let all = weights.iter().zip(&values).map(|(weight, value)| value.times(*weight));
            let all = all.fold(Interval::point(0.0), |sum, term| sum + term);
            let found = weighted(&weights, values.iter());
            assert_eq!((found.lo, found.hi), (all.lo, all.hi), "{weights:?} {values:?}");
        }
        assert!(weighted(&[0.0, 1.0], [Interval::EMPTY, Interval::point(1.0)].iter()).is_empty());
    }

    /// No solution of a row is cut off, whatever is zero in it.
    #[test]
    fn a_row_keeps_its_solutions() {
        let mut next = numbers();
        let mut narrowed = 0;
        for _ in 0..2000 {
            let slopes: Vec<f64> = (0..3).map(|_| next()).collect();
            let root: Vec<f64> = (0..3).map(|_| 0.4 * next()).collect();
            let middle: Vec<f64> = root.iter().map(|x| x + 0.2 * next()).collect();
            // of the row Σ slope · (x − root)
            let value = slopes.iter().zip(&middle).zip(&root).fold(Interval::point(0.0), |sum, ((slope, m), x)| {
                sum + Interval::point(*slope) * (Interval::point(*m) - Interval::point(*x))
            });
            let wide: Vec<Interval> =
                slopes.iter().map(|slope| around(*slope, if *slope == 0.0 { 0.0 } else { 0.1 })).collect();
            let whole: Vec<Interval> = middle.iter().map(|m| around(*m, 0.5)).collect();
            let mut left = whole.clone();
            assert!(narrow(&mut left, &middle, (value, &wide), None, &mut Vec::new()), "{slopes:?} {root:?}");
            assert!(left.iter().zip(&root).all(|(x, root)| x.contains(*root)), "{slopes:?} {root:?} {left:?}");
            narrowed += usize::from(left != whole);
        }
        assert!(narrowed > 500, "{narrowed}");
    }
}

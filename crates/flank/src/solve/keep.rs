//! Which `keep` in a sample would select one of several branches.

use std::f64::consts::TAU;

use flank_chain_dsl::{Dimension, RangedVariable};
use flank_solver::SurfacePoint;

use crate::project::quantity::Extent;
use crate::project::units;

/// Of values in messages.
const DECIMALS: usize = 4;
/// Branches are distinguished by what differs by this share of its range at the least: the decimals show that.
const APART: f64 = 1e-3;

/// A condition that one branch meets and the others do not.
pub(crate) struct Keep {
    /// As it stands in a spec before the ends: `spindle`, `apart = spindle + tau`.
    of: String,
    dimension: Dimension,
    low: f64,
    high: f64,
}

/// Something that may tell branches apart: one unknown, or the sum or the difference of two.
struct Function {
    of: String,
    dimension: Dimension,
    weights: Vec<f64>,
    /// What it may be in the ranges of the unknowns.
    low: f64,
    high: f64,
    /// Whether this is a whole turn, behind whose end its beginning may come again.
    is_turn: bool,
}

impl Keep {
    /// `keep spindle: 0.0000 deg .. 180.0000 deg`
    pub(crate) fn text(&self) -> String {
        let value = |x: f64| units::text(self.dimension, x, DECIMALS);
        format!("keep {}: {} .. {}", self.of, value(self.low), value(self.high))
    }

    pub(crate) fn extent(&self) -> Extent {
        Extent::new(&self.of, self.dimension, Some((self.low, self.high)))
    }
}

impl Function {
    fn at(&self, unknowns: &[f64]) -> f64 {
        self.weights.iter().zip(unknowns).map(|(weight, x)| weight * x).sum()
    }

    /// Between which values it lies at some points.
    fn span(&self, points: &[Vec<f64>]) -> (f64, f64) {
        let values = points.iter().map(|point| self.at(point));
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    }

    /// The least gap between the spans of some branches, as a share of what it may be.
    fn gap(&self, branches: &[Vec<Vec<f64>>]) -> f64 {
        let mut spans: Vec<(f64, f64)> = branches.iter().map(|points| self.span(points)).collect();
        spans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let least = spans.windows(2).map(|pair| pair[1].0 - pair[0].1).fold(f64::INFINITY, f64::min);
        least / (self.high - self.low)
    }

    /// From halfway to the branch below to halfway to the one above. Where there is none, to the end of the ranges; a branch that lies outside
    /// of them at the places where it was looked for may come from afar.
    fn around(&self, branches: &[Vec<Vec<f64>>], number: usize) -> Keep {
        let (own_low, own_high) = self.span(&branches[number]);
        let others = branches.iter().enumerate().filter(|(k, _)| *k != number).map(|(_, points)| self.span(points));
        let turn = |by: f64| others.clone().map(move |(low, high)| (low + by, high + by)).filter(|_| self.is_turn);
        let below = others.clone().chain(turn(-TAU)).map(|span| span.1).filter(|x| *x < own_low).reduce(f64::max);
        let above = others.clone().chain(turn(TAU)).map(|span| span.0).filter(|x| *x > own_high).reduce(f64::min);
        let width = self.high - self.low;
        let [lowest, highest] = [
            if own_low < self.low { own_low - width } else { self.low },
            if own_high > self.high { own_high + width } else { self.high },
        ];
        let low = below.map_or(lowest, |x| 0.5 * (x + own_low));
        let high = above.map_or(highest, |x| 0.5 * (x + own_high));
        Keep { of: self.of.clone(), dimension: self.dimension, low, high }
    }
}

/// What may tell branches apart: unknowns, then sums and differences of two angles, as of a spindle and the thread that it turns.
fn functions(unknowns: &[RangedVariable<'_>]) -> Vec<Function> {
    let single = |k: usize| {
        let of = &unknowns[k];
        let weights = (0..unknowns.len()).map(|other| f64::from(u8::from(other == k))).collect();
        let is_turn = units::is_angle(of.dimension) && (of.high - of.low - TAU).abs() < APART;
        Function { of: of.name.clone(), dimension: of.dimension, weights, low: of.low, high: of.high, is_turn }
    };
    let both = |a: usize, b: usize, sign: f64| {
        let (one, other) = (single(a), single(b));
        let operator = if sign > 0.0 { "+" } else { "-" };
        let ends = if sign > 0.0 { [other.low, other.high] } else { [-other.high, -other.low] };
        Function {
            of: format!("apart = {} {operator} {}", one.of, other.of),
            dimension: one.dimension,
            weights: one.weights.iter().zip(&other.weights).map(|(a, b)| a + sign * b).collect(),
            low: one.low + ends[0],
            high: one.high + ends[1],
            is_turn: false,
        }
    };
    let angles: Vec<usize> = (0..unknowns.len()).filter(|k| units::is_angle(unknowns[*k].dimension)).collect();
    let pairs = angles.iter().flat_map(|a| angles.iter().filter(move |b| *b > a).map(move |b| (*a, *b)));
    let pairs = pairs.flat_map(|(a, b)| [both(a, b, 1.0), both(a, b, -1.0)]);
    (0..unknowns.len()).map(single).chain(pairs).collect()
}

/// What distinguishes some branches, each known at some points: wholly if that can be, by the first point of each otherwise.
fn chosen(unknowns: &[RangedVariable<'_>], branches: &[Vec<Vec<f64>>]) -> Vec<Keep> {
    let functions = functions(unknowns);
    let firsts: Vec<Vec<Vec<f64>>> = branches.iter().map(|points| points[..1].to_vec()).collect();
    let best = |branches: &[Vec<Vec<f64>>], functions: &[Function]| {
        let gaps = functions.iter().map(|function| function.gap(branches)).enumerate();
        gaps.filter(|(_, gap)| *gap > APART).max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(k, _)| k)
    };
    let (single, of_two) = functions.split_at(unknowns.len());
    let ways = [(branches, single), (branches, of_two), (&firsts, single)];
    let found = ways.into_iter().find_map(|(points, among)| best(points, among).map(|k| (points, &among[k])));
    found.map_or_else(Vec::new, |(points, function)| {
        (0..branches.len()).map(|number| function.around(points, number)).collect()
    })
}

/// For each of some branches; none if there are not several, or nothing distinguishes them. `courses` are the unknowns of each at
/// further points, as far as they are known.
pub(crate) fn proposed(
    unknowns: &[RangedVariable<'_>],
    branches: &[SurfacePoint],
    courses: &[Vec<Vec<f64>>],
) -> Vec<Keep> {
    let points = |(number, branch): (usize, &SurfacePoint)| {
        let followed = courses.get(number).into_iter().flatten().cloned();
        std::iter::once(branch.unknowns.clone()).chain(followed).collect()
    };
    let branches: Vec<Vec<Vec<f64>>> = branches.iter().enumerate().map(points).collect();
    if branches.len() > 1 { chosen(unknowns, &branches) } else { Vec::new() }
}

/// For a branch against the one that was followed, which is known at one point.
pub(crate) fn against(unknowns: &[RangedVariable<'_>], own: &SurfacePoint, other: &SurfacePoint) -> Option<Keep> {
    let branches = [own, other].map(|point| vec![point.unknowns.clone()]);
    chosen(unknowns, &branches).pop()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(low: f64, high: f64) -> Function {
        let is_turn = high - low == TAU;
        Function { of: "a".to_string(), dimension: Dimension::ANGLE, weights: vec![1.0], low, high, is_turn }
    }

    /// Two branches that lie below a range at the place where they were looked for: each keep holds its own and leaves out the other.
    #[test]
    fn keeps_hold_branches_outside_of_the_ranges() {
        for (low, high, branches) in [(0.3, 1.5, [0.2, -0.1]), (-1.5, -0.3, [0.2, -0.1]), (0.0, 1.0, [-0.1, 1.1])] {
            let branches = branches.map(|x| vec![vec![x]]);
            for (number, own) in branches.iter().enumerate() {
                let keep = angle(low, high).around(&branches, number);
                let holds = |points: &Vec<Vec<f64>>| (keep.low..=keep.high).contains(&points[0][0]);
                assert!(keep.low < keep.high && holds(own) && !holds(&branches[1 - number]), "{}", keep.text());
            }
        }
    }
}

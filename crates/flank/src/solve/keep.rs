//! Which `keep` in a sample would select one of several branches.

use std::f64::consts::TAU;

use flank_chain_dsl::{Dimension, RangedVariable};
use flank_solver::{SurfacePoint, turned};

use crate::project::quantity::Extent;
use crate::project::units;

/// Of values in messages.
const DECIMALS: usize = 4;
/// Branches are distinguished by what differs by this share of its range at the least: the decimals show that.
const APART: f64 = 1e-3;

/// What one branch meets and the others do not: a condition, or two together.
pub(crate) struct Keep(Vec<Condition>);

struct Condition {
    /// As it stands in a spec before the ends: `spindle`, `apart = spindle + tau`.
    of: String,
    dimension: Dimension,
    /// Of the unknowns, in the sum that it is about.
    weights: Vec<f64>,
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
    /// Whether this means the same after a turn, behind whose end its beginning comes again.
    is_turn: bool,
}

impl Keep {
    /// `keep spindle: 0.0000 deg .. 180.0000 deg`; two conditions as they stand in a sample.
    pub(crate) fn text(&self) -> String {
        self.0.iter().map(Condition::text).collect::<Vec<String>>().join(", ")
    }

    /// The condition, if it is one alone.
    pub(crate) fn extent(&self) -> Option<Extent> {
        let [of] = &self.0[..] else { return None };
        Some(Extent::new(&of.of, of.dimension, Some((of.low, of.high))))
    }

    /// Whether some unknowns meet it, perhaps some turns of a periodic one further on, as a sample takes it.
    fn holds(&self, unknowns: &[f64], periodic: &[bool]) -> bool {
        let holds = |unknowns: &[f64]| self.0.iter().all(|of| (of.low..=of.high).contains(&of.at(unknowns)));
        holds(unknowns) || turned(unknowns, periodic).any(|other| holds(&other))
    }
}

impl Condition {
    fn text(&self) -> String {
        let value = |x: f64| units::text(self.dimension, x, DECIMALS);
        format!("keep {}: {} .. {}", self.of, value(self.low), value(self.high))
    }

    fn at(&self, unknowns: &[f64]) -> f64 {
        self.weights.iter().zip(unknowns).map(|(weight, x)| weight * x).sum()
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

    /// The branches whose values follow each other without a gap, together.
    fn groups(&self, branches: &Branches) -> Vec<Vec<usize>> {
        let mut spans: Vec<(usize, (f64, f64))> =
            branches.iter().enumerate().map(|(number, points)| (number, self.span(points))).collect();
        spans.sort_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let mut end = f64::NEG_INFINITY;
        for (number, (low, high)) in spans {
            match groups.last_mut().filter(|_| low - end <= APART * (self.high - self.low)) {
                Some(group) => group.push(number),
                None => groups.push(vec![number]),
            }
            end = end.max(high);
        }
        groups
    }

    /// From halfway to the branch below to halfway to the one above. Where there is none, to the end of the ranges; a branch that lies outside
    /// of them at the places where it was looked for may come from afar.
    fn around(&self, branches: &[Vec<Vec<f64>>], number: usize) -> Condition {
        let (own_low, own_high) = self.span(&branches[number]);
        let others = branches.iter().enumerate().filter(|(k, _)| *k != number).map(|(_, points)| self.span(points));
        let width = self.high - self.low;
        let [lowest, highest] = [
            if own_low < self.low { own_low - width } else { self.low },
            if own_high > self.high { own_high + width } else { self.high },
        ];
        let turn = |by: f64| others.clone().map(move |(low, high)| (low + by, high + by)).filter(|_| self.is_turn);
        let before = others.clone().chain(turn(-TAU).filter(|(_, high)| *high > lowest)).map(|span| span.1);
        let behind = others.clone().chain(turn(TAU).filter(|(low, _)| *low < highest)).map(|span| span.0);
        let below = before.filter(|x| *x < own_low).reduce(f64::max);
        let above = behind.filter(|x| *x > own_high).reduce(f64::min);
        let low = below.map_or(lowest, |x| 0.5 * (x + own_low));
        let high = above.map_or(highest, |x| 0.5 * (x + own_high));
        Condition { of: self.of.clone(), dimension: self.dimension, weights: self.weights.clone(), low, high }
    }
}

/// What may tell branches apart: unknowns, then sums and differences of two angles, as of a spindle and the thread that it turns.
fn functions(unknowns: &[RangedVariable<'_>], periodic: &[bool]) -> Vec<Function> {
    let single = |k: usize| {
        let of = &unknowns[k];
        let weights = (0..unknowns.len()).map(|other| f64::from(u8::from(other == k))).collect();
        let is_turn = periodic[k];
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

/// Some branches, each known at some points.
type Branches = [Vec<Vec<f64>>];

/// What distinguishes some branches: wholly if that can be, by the first point of each otherwise. A condition alone is better than two
/// together, an unknown better than a sum of two, and the widest gap best.
fn chosen(unknowns: &[RangedVariable<'_>], branches: &Branches, periodic: &[bool]) -> Vec<Keep> {
    let functions = functions(unknowns, periodic);
    let (single, of_two) = functions.split_at(unknowns.len());
    let firsts: Vec<Vec<Vec<f64>>> = branches.iter().map(|points| points[..1].to_vec()).collect();
    let alone = |points: &Branches, among: &[Function]| best(alone_by(points, among), points, periodic);
    let together = |points: &Branches| best(together_by(points, single), points, periodic);
    let found = alone(branches, single).or_else(|| alone(branches, of_two)).or_else(|| together(branches));
    found.or_else(|| alone(&firsts, single)).or_else(|| together(&firsts)).unwrap_or_default()
}

/// What takes each branch, with the least gap that it leaves between two of them.
type Offer = (f64, Vec<Keep>);

/// Of some offers the one with the widest gap that keeps each branch and no other one, also where a periodic unknown has turned.
fn best(mut offers: Vec<Offer>, branches: &Branches, periodic: &[bool]) -> Option<Vec<Keep>> {
    offers.sort_by(|a, b| b.0.total_cmp(&a.0));
    let tells_apart = |keeps: &[Keep]| {
        keeps.iter().enumerate().all(|(number, keep)| {
            let mut points = branches.iter().enumerate().flat_map(|(of, points)| points.iter().map(move |x| (of, x)));
            points.all(|(of, point)| keep.holds(point, periodic) == (of == number))
        })
    };
    offers.into_iter().map(|(_, keeps)| keeps).find(|keeps| tells_apart(keeps))
}

/// One condition on each branch.
fn alone_by(branches: &Branches, functions: &[Function]) -> Vec<Offer> {
    let gaps = functions.iter().map(|of| (of.gap(branches), of)).filter(|(gap, _)| *gap > APART);
    gaps.map(|(gap, of)| (gap, (0..branches.len()).map(|k| Keep(vec![of.around(branches, k)])).collect())).collect()
}

/// Two conditions on each branch: the first one parts groups of branches, the second one those of a group.
fn together_by(branches: &Branches, functions: &[Function]) -> Vec<Offer> {
    let pairs = functions.iter().flat_map(|first| functions.iter().map(move |second| (first, second)));
    let offer = |(first, second): (&Function, &Function)| {
        let groups = first.groups(branches);
        let points_of = |group: &Vec<usize>| group.iter().flat_map(|k| branches[*k].clone()).collect();
        let hulls: Vec<Vec<Vec<f64>>> = groups.iter().map(points_of).collect();
        let mut least = first.gap(&hulls);
        let mut keeps: Vec<(usize, Keep)> = Vec::new();
        for (number, group) in groups.iter().enumerate() {
            let members: Vec<Vec<Vec<f64>>> = group.iter().map(|k| branches[*k].clone()).collect();
            least = least.min(if group.len() > 1 { second.gap(&members) } else { f64::INFINITY });
            keeps.extend(group.iter().enumerate().map(|(place, k)| {
                let within = (group.len() > 1).then(|| second.around(&members, place));
                (*k, Keep([first.around(&hulls, number)].into_iter().chain(within).collect()))
            }));
        }
        keeps.sort_by_key(|(number, _)| *number);
        (groups.len() > 1 && least > APART).then(|| (least, keeps.into_iter().map(|(_, keep)| keep).collect()))
    };
    pairs.filter_map(offer).collect()
}

/// For each of some branches; none if there are not several, or nothing distinguishes them. `courses` are the unknowns of each at
/// further points, as far as they are known; `periodic` says which unknowns mean the same after a turn.
pub(crate) fn proposed(
    (unknowns, periodic): (&[RangedVariable<'_>], &[bool]),
    branches: &[SurfacePoint],
    courses: &[Vec<Vec<f64>>],
) -> Vec<Keep> {
    let points = |(number, branch): (usize, &SurfacePoint)| {
        let followed = courses.get(number).into_iter().flatten().cloned();
        std::iter::once(branch.unknowns.clone()).chain(followed).collect()
    };
    let branches: Vec<Vec<Vec<f64>>> = branches.iter().enumerate().map(points).collect();
    if branches.len() > 1 { chosen(unknowns, &branches, periodic) } else { Vec::new() }
}

/// For a branch against the one that was followed, which is known at one point.
pub(crate) fn against(
    (unknowns, periodic): (&[RangedVariable<'_>], &[bool]),
    own: &SurfacePoint,
    other: &SurfacePoint,
) -> Option<Keep> {
    let branches = [own, other].map(|point| vec![point.unknowns.clone()]);
    chosen(unknowns, &branches, periodic).pop()
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

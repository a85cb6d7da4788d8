//! All roots in a box: branch and prune.

pub(crate) mod angles;
pub(crate) mod enclosure;
pub(crate) mod known;

use flank_expr::Interval;

use crate::equations::solution::{ROUNDING, Range, Solution};
use crate::equations::system::{Evaluation, System};
use crate::newton::multistart::{WIDELY, scan};
use crate::newton::scalar::solve_with;
use crate::roots::enclosure::{Contraction, Enclosure, Proof, box_of};

/// Boxes that are looked at before the rest is left undecided.
pub const MOST_BOXES: u64 = 2_000;
/// A box whose sides are all below this share of the ranges is not divided any more.
const SMALLEST: f64 = 1e-5;
/// A contraction that leaves less than this share of a side is worth another one before the box is divided.
const WORTH_IT: f64 = 0.7;
/// Undecided boxes that are nearer to each other than this share of the ranges are reported as one.
const ADJOINING: f64 = 1e-9;

/// What is known of the roots of a system in a box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roots {
    /// Each proven to exist; all roots of the box outside `undecided`.
    pub isolated: Vec<Isolated>,
    /// Found in undecided boxes, but not proven to be there alone.
    pub unproven: Vec<Solution>,
    /// Where nothing is proven: there may be none, one or several roots.
    pub undecided: Vec<Undecided>,
    /// Boxes that were looked at.
    pub boxes: u64,
}

/// A root, and where it is the only one.
#[derive(Clone, Debug, PartialEq)]
pub struct Isolated {
    /// The root.
    pub solution: Solution,
    /// Half the sides of the box about it that is proven to hold no other root.
    pub alone_within: Vec<f64>,
}

/// A part of the box about which nothing is proven.
#[derive(Clone, Debug, PartialEq)]
pub struct Undecided {
    /// Its sides.
    pub ranges: Vec<Range>,
    /// Why it stayed so.
    pub why: Doubt,
}

/// Why a box stayed undecided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The Jacobian has no inverse somewhere in it, as at a double root.
    Singular,
    /// The equations are not defined, not bounded or not smooth everywhere in it.
    Undefined,
    /// The number of boxes was used up.
    Budget,
}

/// Finds every root of the system in the ranges, at most `most_boxes` boxes long.
///
/// Each box is narrowed by the mean value form, with and without preconditioning; Newton from its middle finds roots, and
/// Krawczyk's operator proves each of them alone in a box about it, as large as can be proven. What is neither empty nor in
/// such a box is divided. Where boxes stay undecided, the ranges are scanned as well; of what that finds, what can be proven
/// counts.
///
/// # Panics
/// If the lengths of the slices do not fit the system.
pub fn all_roots(system: &System, ranges: &[Range], parameters: &[f64], most_boxes: u64) -> Roots {
    let mut search = Search {
        evaluation: system.evaluation(parameters),
        enclosure: Enclosure::new(system, parameters),
        ranges,
        known: Vec::new(),
        small: Vec::new(),
    };
    let whole: Vec<Range> = ranges.iter().map(|range| range.wider_by(ROUNDING)).collect();
    let mut boxes = vec![box_of(&whole)];
    let mut looked_at = 0;
    while let Some(boxed) = boxes.pop() {
        if looked_at >= most_boxes {
            boxes.push(boxed);
            break;
        }
        looked_at += 1;
        boxes.extend(search.look_at(boxed));
    }
    search.small.extend(boxes.into_iter().map(|boxed| (boxed, Doubt::Budget)));
    let mut unproven = Vec::new();
    if !search.small.is_empty() {
        let (found, _) = scan(&mut search.evaluation, ranges, WIDELY, Solution::is_solved);
        unproven.extend(found.into_iter().filter(|solution| solution.is_solved() && !search.comes_to_know(solution)));
    }
    let isolated = search.known.into_iter().filter(|known| known.solution.is_solved()).collect();
    Roots { isolated, unproven, undecided: merged(search.small, ranges), boxes: looked_at }
}

struct Search<'s> {
    evaluation: Evaluation<'s>,
    enclosure: Enclosure<'s>,
    ranges: &'s [Range],
    /// Roots, some of them outside the ranges.
    known: Vec<Isolated>,
    small: Vec<(Vec<Interval>, Doubt)>,
}

impl Search<'_> {
    /// The two halves of what is left of a box, if it is not decided; all of that where it just became too small to be divided, but may
    /// hold nothing: a sliver that the wider slopes of the larger box did not cut off.
    fn look_at(&mut self, boxed: Vec<Interval>) -> Vec<Vec<Interval>> {
        let (left, regular, is_blind) = match self.enclosure.contract(&boxed) {
            Contraction::Empty => return Vec::new(),
            Contraction::To { left, regular } => (left, regular, false),
            Contraction::Blind => (boxed.clone(), false, true),
        };
        if self.is_known(&left) || regular && self.finds_root_in(&left) && self.is_known(&left) {
            return Vec::new();
        }
        let shrunk = left.iter().zip(&boxed).any(|(left, whole)| left.width() < WORTH_IT * whole.width());
        if self.ranges.iter().zip(&left).all(|(range, x)| x.width() <= SMALLEST * range.width()) {
            if shrunk {
                return vec![left];
            }
            self.small.push((left, if is_blind { Doubt::Undefined } else { Doubt::Singular }));
            return Vec::new();
        }
        let at = self.widest(&left, is_blind || shrunk);
        let middle = left[at].middle();
        let half = |lo: f64, hi: f64| {
            let mut half = left.clone();
            half[at] = Interval::new(lo, hi);
            half
        };
        vec![half(middle, left[at].hi), half(left[at].lo, middle)]
    }

    /// The unknown to divide at: the one that the residuals depend on most, or the one with the largest share of its range.
    fn widest(&self, boxed: &[Interval], by_share: bool) -> usize {
        let share = |k: usize| boxed[k].width() / self.ranges[k].width();
        let size = |k: usize| {
            if by_share { share(k) } else { self.enclosure.smear(boxed, k) }
        };
        let wide = (0..boxed.len()).filter(|&k| share(k) > SMALLEST).map(|k| (k, size(k)));
        wide.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map_or(0, |(k, _)| k)
    }

    /// Whether all roots of a box are known, there being at most one.
    fn is_known(&self, boxed: &[Interval]) -> bool {
        self.known.iter().any(|known| {
            let alone = known.solution.unknowns.iter().zip(&known.alone_within);
            boxed.iter().zip(alone).all(|(x, (root, radius))| x.lo > root - radius && x.hi < root + radius)
        })
    }

    /// Newton from the middle; whether it led to a root that is proven.
    fn finds_root_in(&mut self, boxed: &[Interval]) -> bool {
        let middle: Vec<f64> = boxed.iter().map(|x| x.middle()).collect();
        let solution = solve_with(&mut self.evaluation, self.ranges, &middle);
        solution.is_root() && self.comes_to_know(&solution)
    }

    /// Whether a root is known, or now proven.
    fn comes_to_know(&mut self, solution: &Solution) -> bool {
        let here: Vec<Interval> = solution.unknowns.iter().copied().map(Interval::point).collect();
        if self.is_known(&here) {
            return true;
        }
        let Some(alone_within) = self.alone_within(&solution.unknowns) else { return false };
        self.known.push(Isolated { solution: solution.clone(), alone_within });
        true
    }

    /// Half the sides of the largest box about a root that is proven to hold one root.
    fn alone_within(&mut self, root: &[f64]) -> Option<Vec<f64>> {
        let radii = |share: f64| -> Vec<f64> { self.ranges.iter().map(|range| share * range.width()).collect() };
        // the root lies within the smaller box, and no other one within the larger
        let mut smallest = (1..=9).map(|k| 0.02 * 0.1f64.powi(k));
        let mut share = smallest.find(|&share| self.enclosure.proof(root, &radii(share)) == Proof::ExactlyOne)?;
        while share < 1.0 && self.enclosure.proof(root, &radii(1.5 * share)) != Proof::None {
            share *= 1.5;
        }
        Some(radii(share))
    }
}

/// Boxes that touch become one.
fn merged(boxes: Vec<(Vec<Interval>, Doubt)>, ranges: &[Range]) -> Vec<Undecided> {
    let mut clusters: Vec<(Vec<Interval>, Doubt)> = Vec::new();
    for (mut boxed, mut why) in boxes {
        while let Some(near) = clusters.iter().position(|(other, _)| adjoin(&boxed, other, ranges)) {
            let (other, its) = clusters.swap_remove(near);
            boxed = boxed.iter().zip(&other).map(|(a, b)| a.hull(*b)).collect();
            why = if its == Doubt::Budget { its } else { why };
        }
        clusters.push((boxed, why));
    }
    let sides = |boxed: &[Interval]| boxed.iter().map(|x| Range { low: x.lo, high: x.hi }).collect();
    clusters.into_iter().map(|(boxed, why)| Undecided { ranges: sides(&boxed), why }).collect()
}

fn adjoin(a: &[Interval], b: &[Interval], ranges: &[Range]) -> bool {
    let gap = |(a, b): (&Interval, &Interval)| (a.lo - b.hi).max(b.lo - a.hi);
    a.iter().zip(b).zip(ranges).all(|(pair, range)| gap(pair) <= ADJOINING * range.width())
}

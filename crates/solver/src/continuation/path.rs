//! The way from a solved point to a neighbour: in steps short enough to stay on the branch.

use crate::continuation::field::SAME_DETERMINANT;
use crate::continuation::grid::{ASTRAY, extrapolated};
use crate::equations::solution::{NEAR, Outcome, Range, Solution, distance};
use crate::equations::system::Evaluation;
use crate::equations::tolerance::CLEAR;
use crate::newton::scalar::solve_with;

/// A step that fails is followed by one of this share of it.
const SHORTER: f64 = 0.25;
/// A step that succeeds is followed by one that is so much longer.
const LONGER: f64 = 2.0;
/// No step is shorter than this share of the way. A fold is approached in steps that leave a sixteenth of what is left, so that this is
/// nearer than a point can be told from the fold itself.
const SHORTEST: f64 = 1e-4;
/// Steps that are tried before the way is given up.
const MOST_TRIES: usize = 48;
/// Between the ends of a step the determinant is what a straight line says, but for this share of it. Where two branches cross, it
/// falls to zero and rises again: of a step across, however short, it lies lower.
const OFF_MEAN: f64 = 0.25;

/// A way between two pairs of targets.
pub(crate) struct Path<'p, 's> {
    evaluation: &'p mut Evaluation<'s>,
    ranges: &'p [Range],
    ways: [[f64; 2]; 2],
    pub(crate) evaluations: u64,
}

/// A place on the way.
#[derive(Clone)]
struct Place {
    /// How much of the way leads there.
    share: f64,
    unknowns: Vec<f64>,
    determinant: f64,
}

impl<'p, 's> Path<'p, 's> {
    pub(crate) fn new(evaluation: &'p mut Evaluation<'s>, ranges: &'p [Range], ways: [[f64; 2]; 2]) -> Path<'p, 's> {
        Path { evaluation, ranges, ways, evaluations: 0 }
    }

    /// The root at the end of the way on the branch of a root at its beginning; `start` is tried first as a guess of it. What is no
    /// root, or one of another branch, has not converged.
    pub(crate) fn follow(&mut self, from: Vec<f64>, start: Vec<f64>) -> Solution {
        let mut at = Place { share: 0.0, determinant: self.determinant(0.0, &from), unknowns: from };
        let (mut length, mut guess) = (1.0, start);
        let mut last = Solution::never_reached(self.ranges);
        for _ in 0..MOST_TRIES {
            let share = (at.share + length).min(1.0);
            let (solution, determinant) = self.solved(share, &guess);
            let there = Place { share, unknowns: solution.unknowns.clone(), determinant };
            if solution.is_root() && self.leads(&at, &there) {
                if share == 1.0 {
                    self.determinant(1.0, &solution.unknowns);
                    // near a fold the next step still moves the root
                    return if self.evaluation.scaled_determinant(self.ranges).abs() < CLEAR {
                        self.solved(1.0, &solution.unknowns).0
                    } else {
                        solution
                    };
                }
                length = LONGER * (share - at.share);
                let ratio = (share + length).min(1.0) - share;
                guess = extrapolated(&there.unknowns, at.unknowns.iter().copied(), ratio / (share - at.share));
                at = there;
            } else {
                last = solution;
                length = SHORTER * (share - at.share);
                if length < SHORTEST {
                    break;
                }
                guess.clone_from(&at.unknowns);
            }
        }
        if last.is_root() {
            // a root, but not one that the way leads to, or not of this target: its residual would mislead
            last.outcome = Outcome::NotConverged { iterations: last.iterations };
            last.residual = f64::NAN;
        }
        last
    }

    fn target(&self, share: f64) -> [f64; 2] {
        let [from, to] = self.ways;
        if share == 1.0 { to } else { [0, 1].map(|k| from[k] + (to[k] - from[k]) * share) }
    }

    fn solved(&mut self, share: f64, start: &[f64]) -> (Solution, f64) {
        let target = self.target(share);
        self.evaluation.set_parameters(&target);
        let solution = solve_with(self.evaluation, self.ranges, start);
        self.evaluations += u64::from(solution.iterations);
        let determinant = self.evaluation.determinant(self.ranges);
        (solution, determinant)
    }

    fn determinant(&mut self, share: f64, unknowns: &[f64]) -> f64 {
        let target = self.target(share);
        self.evaluation.set_parameters(&target);
        self.evaluation.at(unknowns);
        self.evaluations += 1;
        self.evaluation.determinant(self.ranges)
    }

    /// Whether a step leads along one branch: the determinant does not vanish on the way, and tangents lead from one end to the other.
    fn leads(&mut self, from: &Place, to: &Place) -> bool {
        let ratio = to.determinant / from.determinant;
        let is_alike = ratio < SAME_DETERMINANT && ratio * SAME_DETERMINANT > 1.0;
        is_alike && self.stays_near(from, to) && {
            let halfway: Vec<f64> = from.unknowns.iter().zip(&to.unknowns).map(|(a, b)| 0.5 * (a + b)).collect();
            let (between, determinant) = self.solved(0.5 * (from.share + to.share), &halfway);
            between.is_root() && is_between([from.determinant, to.determinant], 0.5, determinant)
        }
    }

    /// Whether the tangents at two solved points lead from one to the other. The shorter one tells; the other one leads far away where
    /// a fold is near.
    fn stays_near(&mut self, from: &Place, to: &Place) -> bool {
        if distance(&from.unknowns, &to.unknowns, self.ranges) <= NEAR {
            return true;
        }
        let (there, back) = (self.led(from, to), self.led(to, from));
        if there.0 <= back.0 { there.1 } else { back.1 }
    }

    /// How far the tangent at a place leads on the way to another one, and whether it leads there.
    fn led(&mut self, from: &Place, to: &Place) -> (f64, bool) {
        let target = self.target(to.share);
        self.evaluation.set_parameters(&target);
        self.evaluation.at(&from.unknowns);
        self.evaluations += 1;
        let led = self.evaluation.tangent_point(self.ranges);
        let length = distance(&from.unknowns, &led, self.ranges);
        (length, distance(&led, &to.unknowns, self.ranges) <= ASTRAY * length + NEAR)
    }
}

/// Whether a determinant at a share of the way between two others is what it is along one branch.
#[inline(always)]
pub(crate) fn is_between([before, behind]: [f64; 2], share: f64, between: f64) -> bool {
    let mean = before + share * (behind - before);
    (before * behind > 0.0) & ((between - mean).abs() <= OFF_MEAN * mean.abs())
}

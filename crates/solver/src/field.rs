//! The points of a grid as they become known, without an allocation for each of them.

use flank_expr::LANES;

use crate::lanes::{LaneNewton, Start};
use crate::line::Midpoint;
use crate::solution::{Outcome, Range, Solution, distance, verdict};

/// A midpoint may lie this share of the way between its neighbours from where it was looked for, and [`NEAR`] of the ranges.
const ASTRAY: f64 = 0.25;
/// Distances below this share of the ranges are never a jump to another branch.
pub(crate) const NEAR: f64 = 1e-3;
/// Around a point the Jacobian has an inverse if its determinants there differ by less than this factor.
const SAME_DETERMINANT: f64 = 4.0;

/// Solutions of a grid, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    size: usize,
    /// Of each point the unknowns, then the scaled determinant of the Jacobian (NaN where it is not known).
    states: Vec<f64>,
    outcomes: Vec<Option<Outcome>>,
    residuals: Vec<f64>,
}

impl Field {
    pub(crate) fn new(size: usize, points: usize) -> Field {
        Field {
            size,
            states: vec![f64::NAN; points * (size + 1)],
            outcomes: vec![None; points],
            residuals: vec![f64::NAN; points],
        }
    }

    pub(crate) fn unknowns(&self, point: usize) -> &[f64] {
        &self.states[point * (self.size + 1)..][..self.size]
    }

    /// The verdict; none where nothing has come near.
    pub(crate) fn outcome(&self, point: usize) -> Option<Outcome> {
        self.outcomes[point]
    }

    pub(crate) fn residual(&self, point: usize) -> f64 {
        self.residuals[point]
    }

    pub(crate) fn is_root(&self, point: usize) -> bool {
        self.outcomes[point].is_some_and(Outcome::is_root)
    }

    pub(crate) fn count(&self, outcome: Outcome) -> usize {
        self.outcomes.iter().filter(|found| **found == Some(outcome)).count()
    }

    /// A point by the careful path.
    pub(crate) fn put(&mut self, point: usize, solution: &Solution) {
        let state = &mut self.states[point * (self.size + 1)..][..=self.size];
        state[..self.size].copy_from_slice(&solution.unknowns);
        state[self.size] = f64::NAN;
        self.outcomes[point] = Some(solution.outcome);
        self.residuals[point] = solution.residual;
    }

    pub(crate) fn set_determinant(&mut self, point: usize, determinant: f64) {
        self.states[point * (self.size + 1) + self.size] = determinant;
    }

    pub(crate) fn solution(&self, point: usize) -> Option<Solution> {
        Some(Solution {
            outcome: self.outcomes[point]?,
            unknowns: self.unknowns(point).to_vec(),
            residual: self.residuals[point],
            iterations: 0,
        })
    }

    /// The points at some places, as lines of their own.
    pub(crate) fn gathered(&self, points: &[usize]) -> Field {
        let mut taken = Field::new(self.size, 0);
        for &point in points {
            taken.states.extend_from_slice(&self.states[point * (self.size + 1)..][..=self.size]);
            taken.outcomes.push(self.outcomes[point]);
            taken.residuals.push(self.residuals[point]);
        }
        taken
    }

    /// Puts back what `gathered` took.
    pub(crate) fn scatter(&mut self, taken: &Field, points: &[usize]) {
        let width = self.size + 1;
        for (from, &to) in points.iter().enumerate() {
            self.states[to * width..][..width].copy_from_slice(&taken.states[from * width..][..width]);
            self.outcomes[to] = taken.outcomes[from];
            self.residuals[to] = taken.residuals[from];
        }
    }

    /// The whole in pieces of some points each, one behind the other.
    pub(crate) fn pieces(&mut self, points: usize) -> Vec<Piece<'_>> {
        let width = self.size + 1;
        let states = self.states.chunks_mut(points * width);
        let verdicts = self.outcomes.chunks_mut(points).zip(self.residuals.chunks_mut(points));
        let piece = |(states, (outcomes, residuals))| Piece { size: width - 1, states, outcomes, residuals };
        states.zip(verdicts).map(piece).collect()
    }
}

/// A point in a lane, and its neighbours.
#[derive(Clone, Copy)]
struct Waiting {
    at: usize,
    beside: [usize; 2],
}

/// Some lines of a field.
pub(crate) struct Piece<'f> {
    size: usize,
    states: &'f mut [f64],
    outcomes: &'f mut [Option<Outcome>],
    residuals: &'f mut [f64],
}

impl Piece<'_> {
    /// Solves what follows from the known points of lines of `length` points; what fails stays unknown, for the careful path.
    /// Gives the number of evaluations.
    pub(crate) fn refine(
        &mut self,
        newton: &mut LaneNewton<'_>,
        ranges: &[Range],
        levels: &[Vec<Midpoint>],
        length: usize,
        targets: &[[f64; 2]],
    ) -> u64 {
        let mut evaluations = 0;
        let mut state = vec![0.0; self.size + 1];
        let mut lanes = [Waiting { at: 0, beside: [0; 2] }; LANES];
        for level in levels {
            let mut count = 0;
            for first in (0..self.outcomes.len()).step_by(length) {
                for midpoint in level {
                    let at = first + midpoint.at;
                    if !self.interpolate(first, midpoint, &mut state) {
                        continue;
                    }
                    let (unknowns, determinant) = (&state[..self.size], state[self.size]);
                    let determinant = (!determinant.is_nan()).then_some(determinant);
                    newton.put(count, &Start { unknowns, parameters: &targets[at], determinant });
                    lanes[count] = Waiting { at, beside: midpoint.beside.map(|place| first + place) };
                    count += 1;
                    if count == LANES {
                        evaluations += self.solve(newton, ranges, &lanes);
                        count = 0;
                    }
                }
            }
            if count > 0 {
                evaluations += self.solve(newton, ranges, &lanes[..count]);
            }
        }
        evaluations
    }

    /// The start of a point that is not known yet: on the polynomial through the known ones around it, or between its two
    /// neighbours if some of them are no roots; the determinant where it cannot vanish between them, else NaN. False if
    /// the point is known, or a neighbour is no root.
    fn interpolate(&self, first: usize, midpoint: &Midpoint, state: &mut [f64]) -> bool {
        let is_known = |place: usize| self.outcomes[first + place].is_some_and(Outcome::is_root);
        let [before, behind] = midpoint.beside;
        if is_known(midpoint.at) || !is_known(before) || !is_known(behind) {
            return false;
        }
        let width = self.size + 1;
        let known = |place: usize| &self.states[(first + place) * width..][..width];
        let share = (midpoint.at - before) as f64 / (behind - before) as f64;
        let linear = [(before, 1.0 - share), (behind, share)];
        let is_complete = midpoint.known.iter().all(|(place, _)| is_known(*place));
        state.fill(0.0);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for &(place, weight) in if is_complete { midpoint.known.as_slice() } else { &linear } {
            for (sum, value) in state.iter_mut().zip(known(place)) {
                *sum += weight * value;
            }
            let determinant = known(place)[self.size];
            (least, most) = (
                if determinant < least { determinant } else { least },
                if determinant > most { determinant } else { most },
            );
        }
        // a NaN among them makes the sum one
        let keeps_sign =
            least > 0.0 && most < SAME_DETERMINANT * least || most < 0.0 && least > SAME_DETERMINANT * most;
        if !keeps_sign {
            state[self.size] = f64::NAN;
        }
        true
    }

    /// Whether a point that came so far from its start may be on another branch than its neighbours.
    fn is_astray(&self, moved: f64, [before, behind]: [usize; 2], ranges: &[Range]) -> bool {
        let unknowns = |point: usize| &self.states[point * (self.size + 1)..][..self.size];
        moved > NEAR && moved > ASTRAY * distance(unknowns(before), unknowns(behind), ranges) + NEAR
    }

    fn solve(&mut self, newton: &mut LaneNewton<'_>, ranges: &[Range], lanes: &[Waiting]) -> u64 {
        let evaluations = newton.run(lanes.len());
        for (lane, &Waiting { at, beside }) in lanes.iter().enumerate() {
            if !newton.is_root(lane) || self.is_astray(newton.moved(lane), beside, ranges) {
                continue;
            }
            let state = &mut self.states[at * (self.size + 1)..][..=self.size];
            for (k, value) in state[..self.size].iter_mut().enumerate() {
                *value = newton.unknown(k, lane);
            }
            state[self.size] = newton.determinant(lane);
            let outcome = match verdict(&state[..self.size], ranges, true, false) {
                Outcome::Solved => newton.side(lane),
                other => other,
            };
            // what the conditions call singular is told by the careful path
            if outcome != Outcome::Singular {
                self.outcomes[at] = Some(outcome);
                self.residuals[at] = newton.residual(lane);
            }
        }
        evaluations
    }
}

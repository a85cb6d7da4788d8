//! Damped Newton inside declared ranges.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, Solve, Svd};

use crate::system::{Evaluation, System};

/// A point is solved when no residual is larger: mm, or mm per radian of a motion.
///
/// Residuals of gears of 100 mm carry rounding errors of about 1e-13; this leaves two orders of room, and Newton goes on
/// past it until nothing gets better.
pub const TOLERANCE: f64 = 1e-11;

/// Iterations after which a start is given up.
const MOST_ITERATIONS: u32 = 60;
/// No unknown moves by more than this share of its range in one step, so that a step does not jump to another branch.
const LONGEST_STEP: f64 = 0.35;
/// How far outside its range an unknown may wander on its way, as a share of the range.
const MARGIN: f64 = 0.25;
/// An unknown is inside its range if it is outside by less than this share of it: rounding of the ends themselves.
const ROUNDING: f64 = 1e-12;
/// Below this pivot (unknowns scaled by their ranges, equations by their size) a Jacobian counts as singular.
const SINGULAR_BELOW: f64 = 1e-12;

/// Where an unknown is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
    pub(crate) fn width(self) -> f64 {
        self.high - self.low
    }

    /// By how much a value is outside; zero inside.
    fn excess(self, value: f64) -> f64 {
        (self.low - value).max(value - self.high).max(0.0)
    }

    fn widened(self, value: f64) -> f64 {
        let margin = MARGIN * self.width();
        value.clamp(self.low - margin, self.high + margin)
    }
}

/// What became of a point that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// All residuals are within [`TOLERANCE`] and all unknowns in their ranges.
    Solved,
    /// There is a root, but one of the unknowns lies outside its range.
    Outside {
        /// Index of the unknown that is farthest outside, relative to its range.
        unknown: usize,
        /// By how much, in its own unit.
        by: f64,
    },
    /// The Jacobian has no inverse where the iteration ended.
    Singular,
    /// The iteration ended without a root.
    NotConverged,
}

impl Outcome {
    /// One word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Solved => "solved",
            Outcome::Outside { .. } => "outside",
            Outcome::Singular => "singular",
            Outcome::NotConverged => "not converged",
        }
    }

    /// Which of two outcomes says more.
    fn rank(self) -> u8 {
        match self {
            Outcome::Solved => 3,
            Outcome::Outside { .. } => 2,
            Outcome::Singular => 1,
            Outcome::NotConverged => 0,
        }
    }
}

/// The end of an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The verdict.
    pub outcome: Outcome,
    /// The unknowns where the iteration ended.
    pub unknowns: Vec<f64>,
    /// The largest residual there.
    pub residual: f64,
    /// Evaluations of the system.
    pub iterations: u32,
}

impl Solution {
    /// A point that no iteration came near.
    pub(crate) fn never_reached(ranges: &[Range]) -> Solution {
        let middle = ranges.iter().map(|range| 0.5 * (range.low + range.high)).collect();
        Solution { outcome: Outcome::NotConverged, unknowns: middle, residual: f64::NAN, iterations: 0 }
    }

    pub(crate) fn is_solved(&self) -> bool {
        self.outcome == Outcome::Solved
    }

    /// Solved, or solved outside the ranges.
    pub(crate) fn is_root(&self) -> bool {
        matches!(self.outcome, Outcome::Solved | Outcome::Outside { .. })
    }

    /// The one of two that says more: solved before outside before singular before not converged, then the smaller
    /// residual.
    pub(crate) fn better(self, other: Solution) -> Solution {
        let (mine, its) = (self.outcome.rank(), other.outcome.rank());
        let no_worse = self.residual <= other.residual || other.residual.is_nan();
        if mine > its || (mine == its && no_worse) { self } else { other }
    }
}

/// The largest difference of two sets of unknowns, as a share of their ranges.
pub(crate) fn distance(a: &[f64], b: &[f64], ranges: &[Range]) -> f64 {
    a.iter().zip(b).zip(ranges).map(|((a, b), range)| (a - b).abs() / range.width()).fold(0.0, f64::max)
}

/// Newton from a start value, damped so that the residuals never grow.
///
/// # Panics
/// If the lengths of the slices do not fit the system.
pub fn solve(system: &System, ranges: &[Range], parameters: &[f64], start: &[f64]) -> Solution {
    solve_with(&mut system.evaluation(parameters), ranges, start)
}

pub(crate) fn solve_with(evaluation: &mut Evaluation<'_>, ranges: &[Range], start: &[f64]) -> Solution {
    let mut p = start.to_vec();
    evaluation.at(&p);
    let mut residual = evaluation.worst_residual();
    let mut norm = squared_norm(evaluation);
    let mut iterations = 1;
    let mut singular = false;
    let mut sizes = vec![0.0; ranges.len()];
    while norm.is_finite() && iterations < MOST_ITERATIONS {
        let step = newton_step(evaluation, ranges, &mut sizes);
        singular = step.singular;
        let was_solved = residual <= TOLERANCE;
        let Some(trial) = descend(evaluation, ranges, &p, &step.by, norm, &mut iterations) else {
            break;
        };
        // below the tolerance go on only while it pays: the floor is the rounding of the residuals
        let gain = trial.residual < 0.5 * residual;
        (p, residual, norm) = (trial.p, trial.residual, trial.norm);
        if (was_solved && !gain) || residual == 0.0 {
            break;
        }
    }
    evaluation.at(&p);
    if residual <= TOLERANCE {
        singular = newton_step(evaluation, ranges, &mut sizes).singular;
    }
    let outcome = verdict(&p, ranges, residual, singular);
    Solution { outcome, unknowns: p, residual, iterations }
}

fn squared_norm(evaluation: &Evaluation<'_>) -> f64 {
    evaluation.residuals().iter().map(|r| r * r).sum()
}

fn verdict(p: &[f64], ranges: &[Range], residual: f64, singular: bool) -> Outcome {
    if residual.is_nan() || residual > TOLERANCE {
        return if singular { Outcome::Singular } else { Outcome::NotConverged };
    }
    let share = |(range, value): (&Range, &f64)| range.excess(*value) / range.width();
    let farthest = ranges
        .iter()
        .zip(p)
        .map(share)
        .enumerate()
        .fold((0, 0.0), |worst, (k, share)| if share > worst.1 { (k, share) } else { worst });
    if farthest.1 > ROUNDING {
        let unknown = farthest.0;
        return Outcome::Outside { unknown, by: ranges[unknown].excess(p[unknown]) };
    }
    if singular { Outcome::Singular } else { Outcome::Solved }
}

struct Step {
    by: Vec<f64>,
    singular: bool,
}

/// −J⁻¹F with unknowns scaled by their ranges and equations by the largest entry that they have had so far (`sizes`), so
/// that an equation whose derivative vanishes on the way shows; the least-squares step of smallest size where J has no
/// inverse.
fn newton_step(evaluation: &Evaluation<'_>, ranges: &[Range], sizes: &mut [f64]) -> Step {
    let n = ranges.len();
    let mut jacobian = Mat::<f64>::zeros(n, n);
    let mut right = Mat::<f64>::zeros(n, 1);
    for i in 0..n {
        let scaled = |j: usize| evaluation.jacobian(i, j) * ranges[j].width();
        sizes[i] = (0..n).map(|j| scaled(j).abs()).fold(sizes[i], f64::max);
        let weight = if sizes[i] > 0.0 && sizes[i].is_finite() { 1.0 / sizes[i] } else { 1.0 };
        for j in 0..n {
            jacobian[(i, j)] = weight * scaled(j);
        }
        right[(i, 0)] = -weight * evaluation.residuals()[i];
    }
    let finite = (0..n).all(|i| (0..n).all(|j| jacobian[(i, j)].is_finite()));
    if !finite {
        return Step { by: vec![0.0; n], singular: true };
    }
    let lu = FullPivLu::new(jacobian.as_ref());
    let least = (0..n).map(|k| lu.U()[(k, k)].abs()).fold(f64::INFINITY, f64::min);
    let singular = least.is_nan() || least <= SINGULAR_BELOW;
    let scaled: Vec<f64> = if singular {
        least_squares(&jacobian, &right)
    } else {
        let solution = lu.solve(&right);
        (0..n).map(|k| solution[(k, 0)]).collect()
    };
    Step { by: scaled.iter().zip(ranges).map(|(step, range)| step * range.width()).collect(), singular }
}

/// The shortest vector that solves J x = b as well as possible.
fn least_squares(jacobian: &Mat<f64>, right: &Mat<f64>) -> Vec<f64> {
    let n = jacobian.nrows();
    let Ok(svd) = Svd::new(jacobian.as_ref()) else {
        return vec![0.0; n];
    };
    let (u, s, v) = (svd.U(), svd.S(), svd.V());
    let largest = s[0];
    let mut x = vec![0.0; n];
    for k in (0..n).filter(|&k| s[k] > 1e-10 * largest) {
        let share: f64 = (0..n).map(|i| u[(i, k)] * right[(i, 0)]).sum::<f64>() / s[k];
        for (i, x) in x.iter_mut().enumerate() {
            *x += share * v[(i, k)];
        }
    }
    x
}

impl Evaluation<'_> {
    /// How far the tangent at the point of the last evaluation says that the root lies, as a share of the ranges.
    pub(crate) fn tangent_step(&self, ranges: &[Range]) -> f64 {
        let step = newton_step(self, ranges, &mut vec![0.0; ranges.len()]);
        step.by.iter().zip(ranges).map(|(by, range)| by.abs() / range.width()).fold(0.0, f64::max)
    }
}

struct Trial {
    p: Vec<f64>,
    residual: f64,
    norm: f64,
}

/// The longest of the step's halves, quarters, … that makes the residuals smaller; `None` if none does.
fn descend(
    evaluation: &mut Evaluation<'_>,
    ranges: &[Range],
    p: &[f64],
    step: &[f64],
    norm: f64,
    iterations: &mut u32,
) -> Option<Trial> {
    const MOST_HALVINGS: i32 = 12;
    let longest = step.iter().zip(ranges).map(|(s, range)| s.abs() / range.width()).fold(0.0, f64::max);
    let first = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
    for halving in 0..MOST_HALVINGS {
        let share = first * 0.5f64.powi(halving);
        let trial: Vec<f64> =
            p.iter().zip(step).zip(ranges).map(|((p, s), range)| range.widened(p + share * s)).collect();
        evaluation.at(&trial);
        *iterations += 1;
        let new = squared_norm(evaluation);
        if new < norm * (1.0 - 1e-4 * share) {
            return Some(Trial { p: trial, residual: evaluation.worst_residual(), norm: new });
        }
    }
    evaluation.at(p);
    None
}

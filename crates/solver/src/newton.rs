//! Damped Newton inside declared ranges.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, Solve, Svd};

use crate::solution::{Outcome, Range, Solution, verdict};
use crate::system::{Evaluation, System};

/// A point is solved when no residual is larger: mm, or mm per radian of a motion.
///
/// Residuals of gears of 100 mm carry rounding errors of about 1e-13; this leaves two orders of room, and Newton goes on
/// past it until nothing gets better. Residuals of very large things are allowed a share of their size.
pub const TOLERANCE: f64 = 1e-11;
/// Share of an equation's size (see [`Evaluation::size_of`]) that its rounding errors stay below.
pub(crate) const OF_SIZE: f64 = 1e-14;
/// No tolerance is larger, however large the thing: points are good to 1e-9 mm or not solved.
pub(crate) const LARGEST_TOLERANCE: f64 = 1e-10;

/// Steps after which a start is given up.
const MOST_STEPS: usize = 40;
/// Halvings of a step that are tried until the residuals get smaller.
const MOST_HALVINGS: i32 = 12;
/// No unknown moves by more than this share of its range in one step, so that a step does not jump to another branch.
pub(crate) const LONGEST_STEP: f64 = 0.35;
/// Below this pivot (unknowns scaled by their ranges, equations by their size) a Jacobian counts as singular.
const SINGULAR_BELOW: f64 = 1e-12;
/// A direction in which a singular Jacobian (scaled in the same way) changes less than this share of what it changes most is left out
/// of a step: rounding of the residuals, 1e-13 of their size, would move the unknowns by a thousandth of their ranges along it.
const WEAKEST: f64 = 1e-10;

/// Newton from a start value, damped so that the residuals never grow.
///
/// # Panics
/// If the lengths of the slices do not fit the system.
pub fn solve(system: &System, ranges: &[Range], parameters: &[f64], start: &[f64]) -> Solution {
    solve_with(&mut system.evaluation(parameters), ranges, start)
}

pub(crate) fn solve_with(evaluation: &mut Evaluation<'_>, ranges: &[Range], start: &[f64]) -> Solution {
    let mut p: Vec<f64> = start.iter().zip(ranges).map(|(start, range)| range.widened(*start)).collect();
    evaluation.at(&p);
    let mut residual = evaluation.worst_residual();
    let mut norm = squared_norm(evaluation);
    let mut iterations = 1;
    let mut singular = false;
    let mut sizes = vec![0.0; ranges.len()];
    for _ in 0..MOST_STEPS {
        if !norm.is_finite() {
            break;
        }
        let step = newton_step(evaluation, ranges, &mut sizes);
        singular = step.singular;
        let was_solved = evaluation.is_at_root();
        // below the tolerance go on only while it pays: the floor is the rounding of the residuals
        let halvings = if was_solved { 1 } else { MOST_HALVINGS };
        let Some(trial) = descend(evaluation, ranges, Start { p: &p, norm }, &step.by, halvings, &mut iterations)
        else {
            break;
        };
        let gain = trial.residual < 0.5 * residual;
        (p, residual, norm) = (trial.p, trial.residual, trial.norm);
        if (was_solved && !gain) || residual == 0.0 {
            break;
        }
    }
    evaluation.at(&p);
    let is_root = evaluation.is_at_root();
    if is_root {
        singular = newton_step(evaluation, ranges, &mut sizes).singular;
    }
    let outcome = match verdict(&p, ranges, is_root, singular) {
        Outcome::Solved => evaluation.side(),
        Outcome::NotConverged { .. } => Outcome::NotConverged { iterations },
        other => other,
    };
    Solution { outcome, unknowns: p, residual, iterations }
}

fn squared_norm(evaluation: &Evaluation<'_>) -> f64 {
    evaluation.residuals().iter().map(|r| r * r).sum()
}

/// Residuals and Jacobian at a point.
pub(crate) trait Linearized {
    fn residual(&self, row: usize) -> f64;
    fn jacobian(&self, row: usize, column: usize) -> f64;
}

pub(crate) struct Step {
    pub(crate) by: Vec<f64>,
    pub(crate) singular: bool,
}

/// −J⁻¹F with unknowns scaled by their ranges and equations by the largest entry that they have had so far (`sizes`), so
/// that an equation whose derivative vanishes on the way shows; the least-squares step of smallest size where J has no
/// inverse.
pub(crate) fn newton_step(evaluation: &impl Linearized, ranges: &[Range], sizes: &mut [f64]) -> Step {
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
        right[(i, 0)] = -weight * evaluation.residual(i);
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

/// J⁻¹ b at the point of the last evaluation; not finite where J has no inverse.
pub(crate) fn inverse_times(evaluation: &Evaluation<'_>, right: &[f64]) -> Vec<f64> {
    let n = right.len();
    let jacobian = Mat::from_fn(n, n, |i, j| evaluation.jacobian(i, j));
    let solution = FullPivLu::new(jacobian.as_ref()).solve(Mat::from_fn(n, 1, |i, _| right[i]));
    (0..n).map(|k| solution[(k, 0)]).collect()
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
    for k in (0..n).filter(|&k| s[k] > WEAKEST * largest) {
        let share: f64 = (0..n).map(|i| u[(i, k)] * right[(i, 0)]).sum::<f64>() / s[k];
        for (i, x) in x.iter_mut().enumerate() {
            *x += share * v[(i, k)];
        }
    }
    x
}

impl Evaluation<'_> {
    /// Whether no residual at the point of the last evaluation is larger than its tolerance; never where one is NaN.
    fn is_at_root(&self) -> bool {
        self.residuals().iter().enumerate().all(|(i, residual)| {
            let tolerance = (OF_SIZE * self.size_of(i)).clamp(TOLERANCE, LARGEST_TOLERANCE);
            residual.abs() <= tolerance
        })
    }

    /// How large the terms are that cancel in a residual: what a change of each unknown by its own size, or by a radian or
    /// a millimetre, makes of it. For a rotation that is the radius at which it carries the point.
    fn size_of(&self, row: usize) -> f64 {
        let unknowns = self.unknowns().iter().enumerate();
        unknowns.map(|(column, p)| self.jacobian(row, column).abs() * p.abs().max(1.0)).sum()
    }

    /// The Jacobian's determinant at the point of the last evaluation, with unknowns scaled by their ranges: along a branch it vanishes
    /// only where the branch turns back or meets another one. Not finite where it is no number.
    pub(crate) fn determinant(&self, ranges: &[Range]) -> f64 {
        let n = ranges.len();
        Mat::from_fn(n, n, |i, j| self.jacobian(i, j) * ranges[j].width()).determinant()
    }

    /// The same with each equation scaled by its largest entry there: how far the Jacobian is from having no inverse.
    pub(crate) fn scaled_determinant(&self, ranges: &[Range]) -> f64 {
        let n = ranges.len();
        let sizes: Vec<f64> = (0..n)
            .map(|i| (0..n).map(|j| (self.jacobian(i, j) * ranges[j].width()).abs()).fold(0.0, f64::max))
            .collect();
        Mat::from_fn(n, n, |i, j| self.jacobian(i, j) * ranges[j].width() / sizes[i]).determinant()
    }

    /// Where the tangent at the point of the last evaluation says that the root lies.
    pub(crate) fn tangent_point(&self, ranges: &[Range]) -> Vec<f64> {
        let step = newton_step(self, ranges, &mut vec![0.0; ranges.len()]);
        self.unknowns().iter().zip(&step.by).map(|(p, by)| p + by).collect()
    }
}

struct Trial {
    p: Vec<f64>,
    residual: f64,
    norm: f64,
}

/// Where a step begins.
#[derive(Clone, Copy)]
struct Start<'p> {
    p: &'p [f64],
    norm: f64,
}

/// The longest of the step, its half, its quarter, … that makes the residuals smaller; `None` if none does.
fn descend(
    evaluation: &mut Evaluation<'_>,
    ranges: &[Range],
    start: Start<'_>,
    step: &[f64],
    halvings: i32,
    evaluations: &mut u32,
) -> Option<Trial> {
    let longest = step.iter().zip(ranges).map(|(s, range)| s.abs() / range.width()).fold(0.0, f64::max);
    let first = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
    for halving in 0..halvings {
        let share = first * 0.5f64.powi(halving);
        let moved = start.p.iter().zip(step).zip(ranges);
        let trial: Vec<f64> = moved.map(|((p, s), range)| range.widened(p + share * s)).collect();
        evaluation.at(&trial);
        *evaluations += 1;
        let new = squared_norm(evaluation);
        if new < start.norm * (1.0 - 1e-4 * share) {
            return Some(Trial { p: trial, residual: evaluation.worst_residual(), norm: new });
        }
    }
    None
}

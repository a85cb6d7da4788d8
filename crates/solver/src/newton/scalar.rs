//! Damped Newton inside declared ranges.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, Solve, Svd};

use crate::equations::solution::{Outcome, Range, Solution, verdict};
use crate::equations::system::{Evaluation, Linearized, System};
use crate::equations::tolerance::{LARGEST_TOLERANCE, OF_SIZE, TOLERANCE};

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
    let mut descent = Descent::new(ranges, start);
    while let Some(point) = descent.asks() {
        evaluation.at(point);
        descent.take(evaluation);
    }
    descent.ended(evaluation)
}

/// Newton from one start, told residuals and Jacobian at each point that it asks for: several of them can be computed at once.
pub(crate) struct Descent<'r> {
    ranges: &'r [Range],
    /// The best point so far, with its largest residual and the sum of their squares.
    p: Vec<f64>,
    residual: f64,
    norm: f64,
    iterations: u32,
    steps: usize,
    singular: bool,
    sizes: Vec<f64>,
    /// Where residuals and Jacobian are wanted.
    asked: Vec<f64>,
    stage: Stage,
    is_root: bool,
}

/// What is asked for.
enum Stage {
    Start,
    /// A share of the step from the best point.
    Trial {
        step: Vec<f64>,
        /// The share of the first trial, which does not leave the branch.
        first: f64,
        halving: i32,
        /// Trials until the step is given up.
        halvings: i32,
        was_solved: bool,
    },
    /// The best point once more, after trials that were worse.
    Best,
    Nothing,
}

impl<'r> Descent<'r> {
    pub(crate) fn new(ranges: &'r [Range], start: &[f64]) -> Descent<'r> {
        let p: Vec<f64> = start.iter().zip(ranges).map(|(start, range)| range.widened(*start)).collect();
        Descent {
            ranges,
            asked: p.clone(),
            p,
            residual: f64::NAN,
            norm: f64::NAN,
            iterations: 1,
            steps: 0,
            singular: false,
            sizes: vec![0.0; ranges.len()],
            stage: Stage::Start,
            is_root: false,
        }
    }

    /// Where residuals and Jacobian are wanted next; `None` at the end.
    pub(crate) fn asks(&self) -> Option<&[f64]> {
        (!matches!(self.stage, Stage::Nothing)).then_some(&self.asked)
    }

    /// Goes on with residuals and Jacobian at the point that was asked for.
    pub(crate) fn take(&mut self, at: &impl Linearized) {
        match std::mem::replace(&mut self.stage, Stage::Nothing) {
            Stage::Start => {
                (self.residual, self.norm) = (worst_residual(at, self.p.len()), squared_norm(at, self.p.len()));
                self.step(at);
            }
            Stage::Trial { step, first, halving, halvings, was_solved } => {
                self.iterations += 1;
                let share = first * 0.5f64.powi(halving);
                let norm = squared_norm(at, self.p.len());
                if norm < self.norm * (1.0 - 1e-4 * share) {
                    self.accept((worst_residual(at, self.p.len()), norm), was_solved, at);
                } else if halving + 1 < halvings {
                    self.try_share(Stage::Trial { step, first, halving: halving + 1, halvings, was_solved });
                } else {
                    self.asked.clone_from(&self.p);
                    self.stage = Stage::Best;
                }
            }
            // the step that led nowhere began here: it has told whether the Jacobian is singular
            Stage::Best => self.is_root = is_at_root(at, &self.p),
            Stage::Nothing => {}
        }
    }

    /// The trial is the best point now.
    fn accept(&mut self, (residual, norm): (f64, f64), was_solved: bool, at: &impl Linearized) {
        let gain = residual < 0.5 * self.residual;
        self.p.clone_from(&self.asked);
        (self.residual, self.norm) = (residual, norm);
        if (was_solved && !gain) || residual == 0.0 { self.end(at) } else { self.step(at) }
    }

    /// Takes Newton's step from the best point, where residuals and Jacobian are known.
    fn step(&mut self, at: &impl Linearized) {
        if self.steps == MOST_STEPS || !self.norm.is_finite() {
            return self.end(at);
        }
        self.steps += 1;
        let Step { by: step, singular } = newton_step(at, self.ranges, &mut self.sizes);
        self.singular = singular;
        let was_solved = is_at_root(at, &self.p);
        // below the tolerance go on only while it pays: the floor is the rounding of the residuals
        let halvings = if was_solved { 1 } else { MOST_HALVINGS };
        let longest = step.iter().zip(self.ranges).map(|(s, range)| s.abs() / range.width()).fold(0.0, f64::max);
        let first = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
        self.try_share(Stage::Trial { step, first, halving: 0, halvings, was_solved });
    }

    /// Asks for the trial of a stage: the longest of the step, its half, its quarter, … that makes the residuals smaller is taken.
    fn try_share(&mut self, trial: Stage) {
        if let Stage::Trial { step, first, halving, .. } = &trial {
            let share = first * 0.5f64.powi(*halving);
            let moved = self.p.iter().zip(step).zip(self.ranges);
            self.asked.clear();
            self.asked.extend(moved.map(|((p, s), range)| range.widened(p + share * s)));
        }
        self.stage = trial;
    }

    /// At the best point, where residuals and Jacobian are known.
    fn end(&mut self, at: &impl Linearized) {
        self.is_root = is_at_root(at, &self.p);
        if self.is_root {
            self.singular = newton_step(at, self.ranges, &mut self.sizes).singular;
        }
    }

    /// Where it ended, and as what by the conditions of the system; the evaluation's parameters are those that it was told of.
    pub(crate) fn ended(self, evaluation: &mut Evaluation<'_>) -> Solution {
        let Descent { p, residual, iterations, .. } = self;
        let outcome = match verdict(&p, self.ranges, self.is_root, self.singular) {
            Outcome::Solved => evaluation.side(&p),
            Outcome::NotConverged { .. } => Outcome::NotConverged { iterations },
            other => other,
        };
        Solution { outcome, unknowns: p, residual, iterations }
    }
}

fn squared_norm(at: &impl Linearized, size: usize) -> f64 {
    (0..size).map(|row| at.residual(row)).map(|r| r * r).sum()
}

/// The largest residual; NaN if any is.
pub(crate) fn worst_residual(at: &impl Linearized, size: usize) -> f64 {
    let residuals = (0..size).map(|row| at.residual(row));
    residuals.fold(0.0, |worst: f64, r| if r.is_nan() { r.abs() } else { worst.max(r.abs()) })
}

/// Whether no residual at a point is larger than its tolerance; never where one is NaN.
fn is_at_root(at: &impl Linearized, p: &[f64]) -> bool {
    (0..p.len()).all(|row| {
        let tolerance = (OF_SIZE * size_of(at, p, row)).clamp(TOLERANCE, LARGEST_TOLERANCE);
        at.residual(row).abs() <= tolerance
    })
}

/// How large the terms are that cancel in a residual: what a change of each unknown by its own size, or by a radian or
/// a millimetre, makes of it. For a rotation that is the radius at which it carries the point.
fn size_of(at: &impl Linearized, p: &[f64], row: usize) -> f64 {
    p.iter().enumerate().map(|(column, p)| at.jacobian(row, column).abs() * p.abs().max(1.0)).sum()
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

//! Damped Newton inside declared ranges.

use faer::Mat;
use faer::linalg::solvers::{FullPivLu, Solve, Svd};

use crate::equations::solution::{Outcome, Range, Solution, verdict};
use crate::equations::system::{Conditions, Evaluation, Linearized, System};
use crate::equations::tolerance::{LARGEST_TOLERANCE, OF_SIZE, TOLERANCE};
use crate::newton::elimination::Elimination;

/// So many equations are eliminated here; more are left to faer.
const FEW: usize = 4;
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
    descent.ended(&mut evaluation.conditions)
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
    newton: Newton,
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
            newton: Newton::new(ranges.len()),
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
        let Step { by: step, singular } = self.newton.step(at, self.ranges);
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
            self.singular = self.newton.step(at, self.ranges).singular;
        }
    }

    /// Where it ended, and as what by the conditions of the system at the parameters that it was told of.
    pub(crate) fn ended(self, conditions: &mut Conditions<'_>) -> Solution {
        let Descent { p, residual, iterations, .. } = self;
        let outcome = match verdict(&p, self.ranges, self.is_root, self.singular) {
            Outcome::Solved => conditions.side(&p),
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

/// The steps of Newton from one start.
#[derive(Clone, Debug)]
pub(crate) struct Newton {
    /// The largest entry that each equation has had so far.
    sizes: Vec<f64>,
    equations: Elimination,
}

impl Newton {
    pub(crate) fn new(size: usize) -> Newton {
        Newton { sizes: vec![0.0; size], equations: Elimination::new(size) }
    }

    /// −J⁻¹F with unknowns scaled by their ranges and equations by the largest entry that they have had so far, so that an equation
    /// whose derivative vanishes on the way shows; the least-squares step of smallest size where J has no inverse.
    pub(crate) fn step(&mut self, at: &impl Linearized, ranges: &[Range]) -> Step {
        let n = ranges.len();
        let Newton { sizes, equations } = self;
        let scaled = |row: usize, column: usize| at.jacobian(row, column) * ranges[column].width();
        for (row, size) in sizes.iter_mut().enumerate() {
            *size = (0..n).map(|column| scaled(row, column).abs()).fold(*size, f64::max);
        }
        let weighted = |row: usize, column: usize| {
            let size = sizes[row];
            let weight = if size > 0.0 && size.is_finite() { 1.0 / size } else { 1.0 };
            weight * if column == n { -at.residual(row) } else { scaled(row, column) }
        };
        if !(0..n).all(|row| (0..n).all(|column| weighted(row, column).is_finite())) {
            return Step { by: vec![0.0; n], singular: true };
        }
        let (least, by) = solved(equations, n, weighted);
        let singular = least.is_nan() || least <= SINGULAR_BELOW;
        let mut by = if singular { least_squares(n, weighted) } else { by };
        by.iter_mut().zip(ranges).for_each(|(step, range)| *step *= range.width());
        Step { by, singular }
    }
}

/// J⁻¹ b at the point of the last evaluation; not finite where J has no inverse.
pub(crate) fn inverse_times(evaluation: &Evaluation<'_>, right: &[f64]) -> Vec<f64> {
    let n = right.len();
    let entry = |row: usize, column: usize| if column == n { right[row] } else { evaluation.jacobian(row, column) };
    solved(&mut Elimination::new(n), n, entry).1
}

/// The size of the smallest pivot, and the unknowns of equations given by row and column, behind the last column the right side; not
/// finite where there is no inverse.
fn solved(few: &mut Elimination, n: usize, entry: impl Fn(usize, usize) -> f64) -> (f64, Vec<f64>) {
    if n <= FEW {
        let least = few.eliminate(entry).least;
        return (least, few.unknowns());
    }
    let lu = FullPivLu::new(Mat::from_fn(n, n, &entry).as_ref());
    let least = (0..n).map(|k| lu.U()[(k, k)].abs()).fold(f64::INFINITY, f64::min);
    let solution = lu.solve(Mat::from_fn(n, 1, |row, _| entry(row, n)));
    (least, (0..n).map(|k| solution[(k, 0)]).collect())
}

/// The shortest vector that solves J x = b as well as possible, given J and behind it b by row and column.
fn least_squares(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    let jacobian = Mat::from_fn(n, n, &entry);
    let Ok(svd) = Svd::new(jacobian.as_ref()) else {
        return vec![0.0; n];
    };
    let (u, s, v) = (svd.U(), svd.S(), svd.V());
    let largest = s[0];
    let mut x = vec![0.0; n];
    for k in (0..n).filter(|&k| s[k] > WEAKEST * largest) {
        let share: f64 = (0..n).map(|i| u[(i, k)] * entry(i, n)).sum::<f64>() / s[k];
        for (i, x) in x.iter_mut().enumerate() {
            *x += share * v[(i, k)];
        }
    }
    x
}

/// The Jacobian's determinant, with unknowns scaled by their ranges: along a branch it vanishes only where the branch turns back or
/// meets another one. Not finite where it is no number.
pub(crate) fn determinant(at: &impl Linearized, ranges: &[Range]) -> f64 {
    let n = ranges.len();
    let entry = |row: usize, column: usize| at.jacobian(row, column) * ranges[column].width();
    Elimination::new(n).eliminate(|row, column| if column == n { 0.0 } else { entry(row, column) }).determinant
}

/// The same with each equation scaled by its largest entry there: how far the Jacobian is from having no inverse.
pub(crate) fn scaled_determinant(at: &impl Linearized, ranges: &[Range]) -> f64 {
    let n = ranges.len();
    let entry = |row: usize, column: usize| at.jacobian(row, column) * ranges[column].width();
    let size = |row: usize| (0..n).map(|column| entry(row, column).abs()).fold(0.0, f64::max);
    let sizes: Vec<f64> = (0..n).map(size).collect();
    let scaled = |row: usize, column: usize| if column == n { 0.0 } else { entry(row, column) / sizes[row] };
    Elimination::new(n).eliminate(scaled).determinant
}

/// Where the tangent at a point says that the root lies.
pub(crate) fn tangent_point(at: &impl Linearized, point: &[f64], ranges: &[Range]) -> Vec<f64> {
    let step = Newton::new(ranges.len()).step(at, ranges);
    point.iter().zip(&step.by).map(|(p, by)| p + by).collect()
}

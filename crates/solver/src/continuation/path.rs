//! The way from a solved point to a neighbour: in steps short enough to stay on the branch.

use crate::continuation::field::SAME_DETERMINANT;
use crate::continuation::grid::{ASTRAY, extrapolated};
use crate::equations::solution::{NEAR, Outcome, Range, Solution, distance};
use crate::equations::system::{Conditions, Evaluation, Linearized};
use crate::equations::tolerance::CLEAR;
use crate::newton::scalar::{Descent, determinant, scaled_determinant, tangent_point};

/// A step that fails is followed by one of this share of it.
const SHORTER: f64 = 0.25;
/// A step that succeeds is followed by one that is so much longer.
const LONGER: f64 = 2.0;
/// No step is shorter than this share of the way. A fold is approached in steps that leave a sixteenth of what is left, so that this is
/// nearer than a point can be told from the fold itself.
const SHORTEST: f64 = 1e-4;
/// A way ends in a fold or a crossing if its end is nearer than that to where it came, and the determinant less than this share of what it is
/// there. At a fold it goes with the root of the distance: the fold is nearer than 10⁻¹⁰ of the way.
const VANISHED: f64 = 1e-3;
/// Steps that are tried before the way is given up.
const MOST_TRIES: usize = 48;
/// Between the ends of a step the determinant is what a straight line says, but for this share of it. Where two branches cross, it
/// falls to zero and rises again: of a step across, however short, it lies lower.
const OFF_MEAN: f64 = 0.25;
/// Where a sheet ends on a pole of the tool, the determinant falls to zero and rises again with its sign on the sheet behind. Of two ends so
/// much alike that a step may count, less than this share of their mean is left halfway then; beside ends on one sheet, less than this share
/// of the smaller one hardly ever.
const LEAST_BETWEEN: f64 = 0.7;

/// A way between two pairs of targets along the branch of a root, told residuals and Jacobian where it asks for them: many ways can
/// be followed at once.
pub(crate) struct Path<'r> {
    ranges: &'r [Range],
    ways: [[f64; 2]; 2],
    /// How far it has come.
    at: Place,
    /// Where the next step leads, and a guess of the root there.
    share: f64,
    guess: Vec<f64>,
    /// The last attempt that failed; at the end what was found.
    last: Solution,
    /// The determinant there.
    determinant: f64,
    tries: usize,
    stage: Stage<'r>,
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

/// Where a step has led.
struct End {
    solution: Solution,
    determinant: f64,
}

/// What residuals and Jacobian are asked for for.
enum Stage<'r> {
    /// The determinant where the way begins.
    Begin,
    /// A root at the end of a step.
    Step(Descent<'r>),
    /// The tangent where the step begins, at the targets of its end.
    There(End),
    /// The tangent at the end, at the targets where the step begins; how far the other one leads, and whether it leads there.
    Back(End, (f64, bool)),
    /// A root halfway.
    Halfway(End, Descent<'r>),
    /// Whether a fold is near where the way ends.
    Arrival(Solution),
    /// The root there once more: near a fold the next step still moves it.
    Again(Descent<'r>),
    Nothing,
}

impl<'r> Path<'r> {
    /// From the unknowns of a root where the way begins; `start` is tried first as a guess of the root at its end.
    pub(crate) fn new(ranges: &'r [Range], ways: [[f64; 2]; 2], from: Vec<f64>, start: Vec<f64>) -> Path<'r> {
        Path {
            ranges,
            ways,
            at: Place { share: 0.0, unknowns: from, determinant: f64::NAN },
            share: 1.0,
            guess: start,
            last: Solution::never_reached(ranges),
            determinant: f64::NAN,
            tries: 0,
            stage: Stage::Begin,
            evaluations: 0,
        }
    }

    /// The root at the end of the way, and the number of evaluations. What is no root, or one of another branch, has not converged.
    pub(crate) fn follow(mut self, evaluation: &mut Evaluation<'_>) -> (Solution, u64) {
        let mut conditions = evaluation.system().conditions(evaluation.parameters());
        while let Some((unknowns, target)) = self.asks() {
            evaluation.set_parameters(&target);
            evaluation.at(unknowns);
            self.take(evaluation, &mut conditions);
        }
        (self.last, self.evaluations)
    }

    /// The unknowns and the targets at which residuals and Jacobian are wanted next; `None` at the end.
    pub(crate) fn asks(&self) -> Option<(&[f64], [f64; 2])> {
        let (unknowns, share) = match &self.stage {
            Stage::Begin => (&*self.at.unknowns, 0.0),
            Stage::There(_) => (&*self.at.unknowns, self.share),
            Stage::Back(end, _) => (&*end.solution.unknowns, self.at.share),
            Stage::Arrival(solution) => (&*solution.unknowns, 1.0),
            Stage::Step(descent) => (descent.asks()?, self.share),
            Stage::Halfway(_, descent) => (descent.asks()?, self.halfway()),
            Stage::Again(descent) => (descent.asks()?, 1.0),
            Stage::Nothing => return None,
        };
        Some((unknowns, self.target(share)))
    }

    /// Goes on with residuals and Jacobian where it asked for them; `conditions` tell what its roots are.
    pub(crate) fn take(&mut self, at: &impl Linearized, conditions: &mut Conditions<'_>) {
        let ranges = self.ranges;
        match std::mem::replace(&mut self.stage, Stage::Nothing) {
            Stage::Begin => {
                self.evaluations += 1;
                self.at.determinant = determinant(at, ranges);
                self.stage = Stage::Step(Descent::new(ranges, &self.guess));
            }
            Stage::Step(mut descent) => {
                if goes_on(&mut descent, at) {
                    self.stage = Stage::Step(descent);
                } else {
                    let end = self.ended(descent, self.share, at, conditions);
                    self.look_back(end);
                }
            }
            Stage::There(end) => {
                let led = self.led(at, &self.at.unknowns, &end.solution.unknowns);
                self.stage = Stage::Back(end, led);
            }
            Stage::Back(end, there) => {
                let back = self.led(at, &end.solution.unknowns, &self.at.unknowns);
                // the shorter one tells; the other one leads far away where a fold is near
                let leads = if there.0 <= back.0 { there.1 } else { back.1 };
                self.evaluations += 2;
                if leads { self.look_halfway(end) } else { self.shorten(end) }
            }
            Stage::Halfway(end, mut descent) => {
                if goes_on(&mut descent, at) {
                    self.stage = Stage::Halfway(end, descent);
                } else {
                    let between = self.ended(descent, self.halfway(), at, conditions);
                    let determinants = [self.at.determinant, end.determinant];
                    let is_alike = is_between(determinants, 0.5, between.determinant);
                    if between.solution.is_root() && is_alike { self.arrive(end) } else { self.shorten(end) }
                }
            }
            Stage::Arrival(solution) => {
                self.evaluations += 1;
                if scaled_determinant(at, ranges).abs() < CLEAR {
                    self.stage = Stage::Again(Descent::new(ranges, &solution.unknowns));
                } else {
                    self.last = solution;
                }
            }
            Stage::Again(mut descent) => {
                if goes_on(&mut descent, at) {
                    self.stage = Stage::Again(descent);
                } else {
                    self.last = self.ended(descent, 1.0, at, conditions).solution;
                }
            }
            Stage::Nothing => {}
        }
    }

    /// What was found, at the end.
    pub(crate) fn found(self) -> Solution {
        self.last
    }

    fn target(&self, share: f64) -> [f64; 2] {
        let [from, to] = self.ways;
        if share == 1.0 { to } else { [0, 1].map(|k| from[k] + (to[k] - from[k]) * share) }
    }

    fn halfway(&self) -> f64 {
        0.5 * (self.at.share + self.share)
    }

    /// Where Newton ended at the targets of a share of the way.
    fn ended(
        &mut self,
        descent: Descent<'r>,
        share: f64,
        at: &impl Linearized,
        conditions: &mut Conditions<'_>,
    ) -> End {
        conditions.set_parameters(&self.target(share));
        let solution = descent.ended(conditions);
        self.evaluations += u64::from(solution.iterations);
        End { solution, determinant: determinant(at, self.ranges) }
    }

    /// Whether a step leads along one branch: the determinant does not vanish on the way, and tangents lead from one end to the other.
    fn look_back(&mut self, end: End) {
        let ratio = end.determinant / self.at.determinant;
        let is_alike = ratio < SAME_DETERMINANT && ratio * SAME_DETERMINANT > 1.0;
        if !end.solution.is_root() || !is_alike {
            self.shorten(end);
        } else if distance(&self.at.unknowns, &end.solution.unknowns, self.ranges) <= NEAR {
            self.look_halfway(end);
        } else {
            self.stage = Stage::There(end);
        }
    }

    fn look_halfway(&mut self, end: End) {
        let pairs = self.at.unknowns.iter().zip(&end.solution.unknowns);
        let halfway: Vec<f64> = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
        self.stage = Stage::Halfway(end, Descent::new(self.ranges, &halfway));
    }

    /// How far the tangent at one end of the step leads on the way to the other one, and whether it leads there.
    fn led(&self, at: &impl Linearized, from: &[f64], to: &[f64]) -> (f64, bool) {
        let led = tangent_point(at, from, self.ranges);
        let length = distance(from, &led, self.ranges);
        (length, distance(&led, to, self.ranges) <= ASTRAY * length + NEAR)
    }

    /// After a step that led along the branch.
    fn arrive(&mut self, end: End) {
        if self.share == 1.0 {
            self.stage = Stage::Arrival(end.solution);
            return;
        }
        let next = (self.share + LONGER * (self.share - self.at.share)).min(1.0);
        let ratio = (next - self.share) / (self.share - self.at.share);
        self.guess = extrapolated(&end.solution.unknowns, self.at.unknowns.iter().copied(), ratio);
        self.at = Place { share: self.share, unknowns: end.solution.unknowns, determinant: end.determinant };
        self.go_to(next);
    }

    /// After a step that did not.
    fn shorten(&mut self, end: End) {
        (self.last, self.determinant) = (end.solution, end.determinant);
        let length = SHORTER * (self.share - self.at.share);
        self.guess.clone_from(&self.at.unknowns);
        if length < SHORTEST { self.give_up() } else { self.go_to(self.at.share + length) }
    }

    fn go_to(&mut self, share: f64) {
        self.tries += 1;
        if self.tries == MOST_TRIES {
            return self.give_up();
        }
        self.share = share.min(1.0);
        self.stage = Stage::Step(Descent::new(self.ranges, &self.guess));
    }

    fn give_up(&mut self) {
        let is_near = self.share == 1.0 && SHORTER * (1.0 - self.at.share) < SHORTEST;
        if self.last.is_root() && is_near && self.determinant.abs() < VANISHED * self.at.determinant.abs() {
            self.last.outcome = Outcome::Singular;
        } else if self.last.is_root() {
            // a root, but not one that the way leads to, or not of this target: its residual would mislead
            self.last.outcome = Outcome::NotConverged { iterations: self.last.iterations };
            self.last.residual = f64::NAN;
        }
    }
}

/// Takes residuals and Jacobian where Newton asked for them; whether it asks for more.
fn goes_on(descent: &mut Descent<'_>, at: &impl Linearized) -> bool {
    descent.take(at);
    descent.asks().is_some()
}

/// Whether a determinant at a share of the way between two others is what it is along one branch.
#[inline(always)]
pub(crate) fn is_between([before, behind]: [f64; 2], share: f64, between: f64) -> bool {
    let mean = before + share * (behind - before);
    (before * behind > 0.0) & ((between - mean).abs() <= OFF_MEAN * mean.abs())
}

/// Whether a determinant falls so far below two others that another sheet may begin between them: `below` their mean, or the smaller one. One
/// that is no number does not.
#[inline(always)]
pub(crate) fn dips(below: f64, between: f64) -> bool {
    between * below < LEAST_BETWEEN * below * below
}

/// The one nearer to zero.
#[inline(always)]
pub(crate) fn smaller([before, behind]: [f64; 2]) -> f64 {
    if before.abs() < behind.abs() { before } else { behind }
}

//! Nonlinear least squares with bounds: Levenberg and Marquardt, each step from the singular values of the Jacobian.

mod decomposed;
pub(crate) mod outliers;
mod thin;

use std::rc::Rc;

use faer::Mat;

use decomposed::{Decomposed, Kept};

use crate::equations::solution::Range;

/// Steps at the most, with those that are tried and not taken.
const MOST_STEPS: usize = 200;
/// A step that leaves more than this share of the sum of squares has nearly come to what the directions that are used can do.
const SLOW: f64 = 0.5;
/// Sums of squares that differ by less than this share are the same.
const ROUNDING: f64 = 1e-13;
/// Residuals of which less than this share is not fitted say nothing of how well others predict them.
const OWN: f64 = 1e-9;
/// A value nearer to an end of its range than this share of its scale stands on it: rounding of the step that led there.
const ON_THE_END: f64 = 1e-13;
/// A direction in the unknowns that changes the residuals by less than this share of what the strongest does is lost in the rounding of
/// an exact Jacobian.
const UNSEEN: f64 = 1e-9;
/// Directions weaker than the resolution are used where they leave less than this share of what is left without them: they make the model
/// true, and do not follow noise or what no unknown explains.
const SHOWN: f64 = 0.1;
/// With more damping than so many squares of the largest singular value no step is tried.
const LARGEST_DAMPING: f64 = 1e8;
/// What damping grows by after a step that failed, the second time by its square, and so on.
const GROWTH: f64 = 2.0;
/// What a step that did all that was promised leaves of it.
const LEAST_DAMPED: f64 = 0.1;
/// What is to be zero weighs so many times the force that it needs: twice for the sum of squares itself, of which the gradient is half, and
/// as much again so that no step pays to leave it.
const FORCED: f64 = 4.0;
/// How much of a step the one before may say of it: more says that the model is not true there.
const TOLD_AHEAD: f64 = 0.3;
/// Residuals are known to this share of the change that settles them.
const KNOWN: f64 = 0.1;

/// An unknown of a [`LeastSquares`] problem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaledUnknown {
    /// Where the search begins; brought into the range.
    pub start: f64,
    /// A change that counts as much as the scales of the other unknowns.
    pub scale: f64,
    /// It is never left; endless ends are allowed.
    pub range: Range,
}

impl ScaledUnknown {
    /// A value, or the end of the range that it lies at or beyond.
    fn within(&self, value: f64) -> f64 {
        let Range { low, high } = self.range;
        let near = ON_THE_END * self.scale;
        if value >= high - near {
            high
        } else if value <= low + near {
            low
        } else {
            value
        }
    }
}

/// Residuals, and their exact derivatives: a row for each residual, a column for each unknown.
#[derive(Clone, Debug)]
pub struct Linearized {
    /// As many for all values of the unknowns.
    pub residuals: Vec<f64>,
    /// By the unknowns as they are, not by their scales.
    pub jacobian: Mat<f64>,
}

/// What is to be minimised: the sum of the squares of residuals.
#[derive(Clone, Debug, PartialEq)]
pub struct LeastSquares {
    /// In this order.
    pub unknowns: Vec<ScaledUnknown>,
    /// So many residuals, the last ones, are to be zero; the squares of all others are as small as that allows.
    pub exact: usize,
    /// A direction in the unknowns, a scale long, that changes the residuals by less than this (root of the mean square) is weak.
    pub resolution: f64,
    /// Whether weak directions are used where they leave next to nothing of the residuals: these come from such values of the unknowns.
    pub uses_weak: bool,
    /// The search ends with a step that changes no residual by more than this; residuals are known to a tenth of it.
    pub settled: f64,
    /// The search is given up with a step that leaves more than this share of the sum of squares, where one of many is worth no more.
    pub given_up: Option<f64>,
}

/// A direction in the unknowns, with what it does.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularDirection {
    /// What the residuals change by for a step one scale long, root of the mean square.
    pub size: f64,
    /// The step, of length one: a share of each unknown's scale; zero for unknowns at a bound.
    pub shares: Vec<f64>,
    /// Whether the search took steps along it.
    pub is_used: bool,
}

/// How a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchEnd {
    /// At a minimum, within the bounds and the directions that are used.
    Settled,
    /// No step made the sum of squares smaller, and the last one tried was not small.
    Stuck,
    /// After as many steps as are taken at the most, or where it was given up.
    Unfinished,
}

/// The end of a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RangeEnd {
    /// The lower one.
    Low,
    /// The upper one.
    High,
}

/// Values with the least sum of squares.
#[derive(Clone, Debug)]
pub struct LeastSquaresFit {
    /// Of the unknowns.
    pub values: Vec<f64>,
    /// What is left, without those that are to be zero.
    pub residuals: Vec<f64>,
    /// What is left of those.
    pub exact: Vec<f64>,
    /// The derivative of half the sum of squares by each unknown, one scale of it, along what residuals that are to be zero allow: zero
    /// within the bounds, at a bound such that it pushes outwards.
    pub gradient: Vec<f64>,
    /// Which unknowns are held at an end of their range.
    pub held: Vec<Option<RangeEnd>>,
    /// As many as unknowns are free, the strongest first.
    pub directions: Vec<SingularDirection>,
    /// Of the unknowns, row by row, for independent residuals that scatter with a variance of one. What directions that are not used
    /// leave open is not in it.
    pub covariance: Vec<Vec<f64>>,
    /// An orthonormal basis of what the directions that are used do to the residuals.
    basis: Mat<f64>,
    /// Steps taken.
    pub steps: usize,
    /// How it ended.
    pub end: SearchEnd,
}

/// Where a search stands. All is by the scales of the unknowns.
struct State {
    values: Vec<f64>,
    residuals: Mat<f64>,
    jacobian: Mat<f64>,
    /// What is to be zero.
    kept: Kept,
    /// The sum of the squares of the residuals.
    squares: f64,
    /// The Jacobian by those unknowns that were free when it was asked for last.
    decomposed: Option<(Vec<bool>, Rc<Decomposed>)>,
    /// What led here.
    before: Option<Before>,
}

/// A state before, with the whole step of the linear model there.
struct Before {
    values: Vec<f64>,
    whole: WholeStep,
}

/// A step without damping that meets no further end and has nothing to bring to zero, in scales of the unknowns.
#[derive(Clone)]
struct WholeStep {
    free: Vec<bool>,
    /// How many directions it uses.
    used: usize,
    by: Vec<f64>,
}

impl State {
    /// The singular values of the Jacobian by the free unknowns: the same for all steps that are tried from here.
    fn decomposed(&mut self, free: Vec<bool>) -> Rc<Decomposed> {
        if let Some((known, decomposed)) = &self.decomposed
            && *known == free
        {
            return decomposed.clone();
        }
        let decomposed = Rc::new(Decomposed::new(self, |k| free[k]));
        self.decomposed = Some((free, decomposed.clone()));
        decomposed
    }

    /// What a step has to lower: the sum of squares, and what is to be zero by a weight.
    fn cost(&self, weight: f64) -> f64 {
        self.squares + weight * size(&self.kept.residuals)
    }
}

/// The sum of the amounts.
fn size(of: &Mat<f64>) -> f64 {
    of.col(0).iter().map(|x| x.abs()).sum()
}

/// A step with what the linear model says of it.
struct Step {
    /// The squares of the smallest and the largest singular value that are used.
    squares: [f64; 2],
    values: Vec<f64>,
    /// The largest change of a residual.
    change: f64,
    /// What is to be zero counts by this against the sum of squares: by more than it costs to bring it there.
    weight: f64,
    /// By how much both together fall.
    fall: f64,
    /// What it is made from.
    whole: Option<WholeStep>,
}

impl LeastSquares {
    /// The values from which no step, in the directions that the residuals tell apart and within the bounds, lowers the sum of squares.
    /// `linearized` gives residuals and their derivatives; `None` where there are none, which no step leads to. `None` if that is
    /// so at the start.
    ///
    /// # Panics
    /// If the sizes of residuals and derivatives do not fit.
    pub fn solve(&self, mut linearized: impl FnMut(&[f64]) -> Option<Linearized>) -> Option<LeastSquaresFit> {
        let start: Vec<f64> = self.unknowns.iter().map(|of| of.within(of.start)).collect();
        let mut state = self.state(start, &mut linearized)?;
        let (mut rank, mut steps, mut tried) = (0, 0, 0);
        let (mut damping, mut growth) = (0.0, GROWTH);
        // whether the whole step from here, along so many directions, was tried and did not do
        let mut failed = None;
        let end = loop {
            if tried == MOST_STEPS {
                break SearchEnd::Unfinished;
            }
            tried += 1;
            let step = self.step(&mut state, rank, damping);
            let trial = self.state(step.values.clone(), &mut linearized);
            let is_small = step.change <= self.settled;
            let error = KNOWN * self.settled * (state.residuals.nrows() as f64).sqrt();
            let cost = state.cost(step.weight);
            let rounding = ROUNDING * cost + 2.0 * error * cost.sqrt();
            // a fall that rounding hides is believed
            let mut is_slow = false;
            let most = if step.fall < rounding { cost + rounding } else { cost };
            match trial.filter(|trial| trial.cost(step.weight) < most) {
                Some(mut trial) => {
                    steps += 1;
                    let values = std::mem::take(&mut state.values);
                    trial.before = step.whole.clone().map(|whole| Before { values, whole });
                    let gain = (cost - trial.cost(step.weight) + rounding) / (step.fall + rounding);
                    (damping, growth) = (step.after(damping, gain), GROWTH);
                    is_slow = trial.cost(step.weight) > SLOW * cost;
                    let is_hopeless = self.given_up.is_some_and(|share| trial.cost(step.weight) > share * cost);
                    state = trial;
                    failed = None;
                    if is_hopeless {
                        break SearchEnd::Unfinished;
                    }
                }
                None if is_small => {}
                None if damping >= LARGEST_DAMPING * step.squares[1] => break SearchEnd::Stuck,
                None => {
                    if damping == 0.0 {
                        failed = Some(rank);
                    }
                    (damping, growth) = (step.raised(damping, growth), growth * GROWTH);
                    continue;
                }
            }
            // a damped step is small for its damping alone
            let shown = if is_small || is_slow { self.shown(&mut state) } else { rank };
            if is_small && damping == 0.0 && shown <= rank {
                break SearchEnd::Settled;
            }
            // neither the whole step nor the shortest one
            if is_small && failed == Some(rank.max(shown)) {
                break SearchEnd::Stuck;
            }
            rank = rank.max(shown);
            damping = if is_small { 0.0 } else { damping };
        };
        Some(self.told(state, (rank, steps, end)))
    }

    fn state(&self, values: Vec<f64>, linearized: &mut impl FnMut(&[f64]) -> Option<Linearized>) -> Option<State> {
        let Linearized { residuals, mut jacobian } = linearized(&values)?;
        assert_eq!((jacobian.nrows(), jacobian.ncols()), (residuals.len(), values.len()), "a row for each residual");
        for (k, unknown) in self.unknowns.iter().enumerate() {
            jacobian.col_mut(k).iter_mut().for_each(|slope| *slope *= unknown.scale);
        }
        let is_finite = residuals.iter().map(|x| x * x).sum::<f64>().is_finite()
            && jacobian.col_iter().all(|of| of.iter().all(|slope| slope.is_finite()));
        let count = residuals.len() - self.exact;
        let column = |from: usize, count: usize| Mat::from_fn(count, 1, |row, _| residuals[from + row]);
        let kept =
            Kept { residuals: column(count, self.exact), jacobian: jacobian.subrows(count, self.exact).to_owned() };
        let residuals = column(0, count);
        let jacobian = if self.exact == 0 { jacobian } else { jacobian.subrows(0, count).to_owned() };
        let squares = residuals.squared_norm_l2();
        is_finite.then_some(State { values, residuals, jacobian, kept, squares, decomposed: None, before: None })
    }

    /// What the sum of squares changes by with each unknown, along what is to be zero: without the part of the gradient that only that
    /// opposes.
    fn gradient(&self, state: &State) -> Mat<f64> {
        let gradient = state.jacobian.transpose() * &state.residuals;
        let forces = self.forces(state, &gradient);
        &gradient + state.kept.jacobian.transpose() * &forces
    }

    /// What residuals that are to be zero have to push with against a gradient, as the unknowns that are inside their ranges say it.
    fn forces(&self, state: &State, gradient: &Mat<f64>) -> Mat<f64> {
        state.kept.forces(gradient, |k| {
            let (Range { low, high }, value) = (self.unknowns[k].range, state.values[k]);
            value > low && value < high
        })
    }

    /// The unknowns that stand at an end of their range and would leave it.
    fn held(&self, state: &State) -> Vec<Option<RangeEnd>> {
        let gradient = self.gradient(state);
        let of = |(k, unknown): (usize, &ScaledUnknown)| {
            let (value, slope) = (state.values[k], gradient[(k, 0)]);
            match unknown.range {
                Range { low, .. } if value <= low && slope >= 0.0 => Some(RangeEnd::Low),
                Range { high, .. } if value >= high && slope <= 0.0 => Some(RangeEnd::High),
                _ => None,
            }
        };
        self.unknowns.iter().enumerate().map(of).collect()
    }

    /// The step to the least sum of squares of the linear model within the bounds.
    fn step(&self, state: &mut State, rank: usize, damping: f64) -> Step {
        let mut fixed: Vec<Option<f64>> = self.held(state).iter().map(|held| held.map(|_| 0.0)).collect();
        loop {
            let taken = Mat::from_fn(fixed.len(), 1, |k, _| fixed[k].unwrap_or(0.0));
            let decomposed = state.decomposed(fixed.iter().map(Option::is_none).collect());
            let used = self.count_used(&decomposed, rank);
            let begun = &taken + &decomposed.onto(&state.kept, &taken);
            let free = decomposed.step(&(&state.residuals + &state.jacobian * &begun), used, damping);
            let step: Vec<f64> = (0..fixed.len()).map(|k| fixed[k].unwrap_or(begun[(k, 0)] + free[k])).collect();
            let beyond = |k: usize| {
                let ScaledUnknown { scale, range, .. } = self.unknowns[k];
                let (from, to) = (state.values[k], state.values[k] + scale * step[k]);
                let end = if to > range.high { range.high } else { range.low };
                (range.excess(to) > 0.0 && fixed[k].is_none()).then(|| ((end - from) / scale, k))
            };
            let share = |(reach, k): &(f64, usize)| reach / step[*k];
            let first = (0..fixed.len()).filter_map(beyond).min_by(|a, b| share(a).total_cmp(&share(b)));
            match first {
                Some((reach, k)) => fixed[k] = Some(reach),
                None => {
                    let is_whole = self.exact == 0 && damping == 0.0 && fixed.iter().flatten().all(|end| *end == 0.0);
                    let free = || fixed.iter().map(Option::is_none).collect();
                    let whole = is_whole.then(|| WholeStep { free: free(), used, by: step.clone() });
                    let ahead = whole.as_ref().and_then(|whole| self.ahead(state, whole));
                    let step = self.stepped(state, &ahead.unwrap_or(step), decomposed.squares(used));
                    return Step { whole, ..step };
                }
            }
        }
    }

    /// Where much is left that no step takes away, each whole step leaves the same share of the one before, by how much the surface of the
    /// residuals bends: a step that goes as far as all of these together (Anderson's acceleration of depth one). `None` where the last two do not
    /// tell that, or are made of other directions.
    fn ahead(&self, state: &State, whole: &WholeStep) -> Option<Vec<f64>> {
        let is_alike = |before: &&Before| before.whole.free == whole.free && before.whole.used == whole.used;
        let before = state.before.as_ref().filter(is_alike)?;
        let changed: Vec<f64> = whole.by.iter().zip(&before.whole.by).map(|(now, before)| now - before).collect();
        let along = |of: &[f64]| changed.iter().zip(of).map(|(a, b)| a * b).sum::<f64>();
        let share = along(&whole.by) / along(&changed);
        // no number where the last two are the same
        if share.is_nan() || share.abs() > TOLD_AHEAD {
            return None;
        }
        let of = |(k, unknown): (usize, &ScaledUnknown)| {
            let taken = (state.values[k] - before.values[k]) / unknown.scale;
            let by = if whole.free[k] { whole.by[k] - share * (taken + changed[k]) } else { 0.0 };
            (unknown.range.excess(state.values[k] + unknown.scale * by) <= 0.0).then_some(by)
        };
        self.unknowns.iter().enumerate().map(of).collect()
    }

    fn stepped(&self, state: &State, step: &[f64], squares: [f64; 2]) -> Step {
        let taken = Mat::from_fn(step.len(), 1, |k, _| step[k]);
        let (by, of_kept) = (&state.jacobian * &taken, &state.kept.jacobian * &taken);
        let forces = self.forces(state, &(state.jacobian.transpose() * &state.residuals));
        let weight = FORCED * forces.col(0).iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        let after = (&state.residuals + &by).squared_norm_l2() + weight * size(&(&state.kept.residuals + &of_kept));
        let values = self.unknowns.iter().zip(step).zip(&state.values);
        let values = values.map(|((of, step), from)| of.within(from + of.scale * step));
        let change = by.col(0).iter().chain(of_kept.col(0).iter()).fold(0.0, |most: f64, by| most.max(by.abs()));
        Step { squares, values: values.collect(), change, weight, fall: state.cost(weight) - after, whole: None }
    }

    /// How many directions are used: those above the resolution, and at least `rank` of them that are more than rounding.
    fn count_used(&self, of: &Decomposed, rank: usize) -> usize {
        let least = self.resolution * of.root();
        let is_used = |(k, size): (usize, &f64)| *size > UNSEEN * of.sizes[0] && (*size >= least || k < rank);
        of.sizes.iter().enumerate().take_while(|of| is_used(*of)).count()
    }

    /// How many directions leave next to nothing; none where not even all of them do.
    fn shown(&self, state: &mut State) -> usize {
        if !self.uses_weak {
            return 0;
        }
        let of = state.decomposed(self.held(state).iter().map(Option::is_none).collect());
        let seen = of.sizes.iter().take_while(|size| **size > UNSEEN * of.sizes[0]).count();
        let mut left = state.squares;
        let mut is_enough = |k: &usize| {
            left -= of.part(&state.residuals, *k).powi(2);
            left < SHOWN.powi(2) * state.squares
        };
        let is_known = state.squares > self.settled.powi(2) * of.rows as f64 && of.rows > seen;
        (0..seen).filter(|_| is_known).find(|k| is_enough(k)).map_or(0, |last| last + 1)
    }

    fn told(&self, mut state: State, (rank, steps, end): (usize, usize, SearchEnd)) -> LeastSquaresFit {
        let held = self.held(&state);
        let of = state.decomposed(held.iter().map(Option::is_none).collect());
        let used = self.count_used(&of, rank);
        let shares = |k: usize| (0..held.len()).map(|unknown| of.share(k, unknown)).collect::<Vec<f64>>();
        let directions: Vec<SingularDirection> = (0..of.sizes.len())
            .map(|k| SingularDirection { size: of.sizes[k] / of.root(), shares: shares(k), is_used: k < used })
            .collect();
        let scale = |k: usize| self.unknowns[k].scale;
        let covariance = |i: usize, j: usize| {
            let terms = (0..used).map(|k| of.share(k, i) * of.share(k, j) / of.sizes[k].powi(2));
            scale(i) * scale(j) * terms.sum::<f64>()
        };
        let all = 0..held.len();
        let gradient = self.gradient(&state);
        LeastSquaresFit {
            values: state.values,
            residuals: state.residuals.col(0).iter().copied().collect(),
            exact: state.kept.residuals.col(0).iter().copied().collect(),
            gradient: gradient.col(0).iter().copied().collect(),
            directions,
            covariance: all.clone().map(|i| all.clone().map(|j| covariance(i, j)).collect()).collect(),
            basis: Mat::from_fn(of.rows, used, |row, k| of.left[(row, k)]),
            held,
            steps,
            end,
        }
    }
}

impl LeastSquaresFit {
    /// How many directions are used.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// The variance of the residuals that the fit leaves; `None` where as many directions are used as there are residuals.
    #[must_use]
    pub fn variance(&self) -> Option<f64> {
        let free = self.residuals.len().checked_sub(self.rank()).filter(|free| *free > 0)?;
        Some(self.residuals.iter().map(|x| x * x).sum::<f64>() / free as f64)
    }
}

impl Step {
    /// After a step that failed. The first damping is felt by the weakest direction alone.
    fn raised(&self, damping: f64, growth: f64) -> f64 {
        let [weakest, strongest] = self.squares;
        if damping == 0.0 { weakest.max(f64::EPSILON * strongest) } else { growth * damping }
    }

    /// After a step that did so much of what the linear model promised, as Nielsen has it: little changes where it did half.
    fn after(&self, damping: f64, gain: f64) -> f64 {
        let lowered = damping * (1.0 - (2.0 * gain.min(1.0) - 1.0).powi(3)).clamp(LEAST_DAMPED, GROWTH);
        if lowered > self.squares[0] { lowered } else { 0.0 }
    }
}

//! The values with which the largest amount of many smooth functions is least.
//!
//! The largest of them is not smooth: where it is least, several are as large. Each step is that of the linear models of all functions,
//! bent by the second derivatives of those that are largest, as they weigh in the step before: Newton's method for the conditions that
//! Karush, Kuhn and Tucker give, with damping as Levenberg has it. What the largest does not tell apart stays near the start: the square of
//! the way from there counts a little, as Tikhonov has it.

mod program;

use faer::Mat;

use crate::newton::least_squares::{Linearized, ScaledUnknown};
use program::{Program, Solved};

/// Quadratic programs at the most.
const MOST_STEPS: usize = 200;
/// A step that does less than this share of what it promised is tried again, with what the functions were behind it.
const POOR: f64 = 0.25;
/// A step that does more than this share lowers the damping.
const GOOD: f64 = 0.75;
/// A step is taken if it does this share at least.
const TAKEN: f64 = 1e-4;
/// Where steps do nothing of what they promise, that may be so many times what counts as nothing.
const BROKEN: f64 = 10.0;
/// What damping grows by.
const GROWTH: f64 = 4.0;
/// What it falls by.
const FALL: f64 = 0.1;
/// With more damping than so many times the largest amount none is tried: functions break where no short step does what slopes promise.
const MOST_DAMPED: f64 = 1e6;
/// Functions that weigh more than this hold the level.
const HOLDS: f64 = 1e-6;
/// By so many times what bends most they are held where directions are looked for along which the level falls.
const HELD: f64 = 1e4;
/// Lengths of steps along these, in scales of the unknowns.
const LENGTHS: [f64; 5] = [1.0, 0.3, 0.1, 0.03, 0.01];

/// Functions with derivatives, of values in the order of the unknowns.
pub(crate) trait Functions {
    /// Their values and slopes; `None` where there are none, which no step leads to.
    fn linearized(&mut self, values: &[f64]) -> Option<Linearized>;

    /// The sum of their second derivatives, each as often as it weighs.
    fn bent(&mut self, values: &[f64], weights: &[f64]) -> Mat<f64>;
}

/// What is to be minimised: the largest amount of functions.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Minimax {
    /// In this order.
    pub unknowns: Vec<ScaledUnknown>,
    /// The search ends where no step promises to lower the largest amount by more than this, or ...
    pub settled: f64,
    /// ... than this share of it.
    pub share: f64,
    /// A way from the start of one scale costs half this share of what is largest there.
    pub kept: f64,
}

/// Values with the least largest amount.
#[derive(Clone, Debug)]
pub(crate) struct MinimaxFit {
    /// Of the unknowns.
    pub values: Vec<f64>,
    /// What the functions are.
    pub residuals: Vec<f64>,
    /// By how much the best step promises to lower the largest.
    pub gap: f64,
    /// Whether that is as little as asked for.
    pub is_settled: bool,
}

/// Where a search stands; slopes are by the scales of the unknowns.
struct State {
    values: Vec<f64>,
    residuals: Vec<f64>,
    jacobian: Mat<f64>,
    largest: f64,
    /// From the start, in scales.
    way: Mat<f64>,
    /// The largest with what that costs.
    cost: f64,
}

/// What is minimised, from where.
struct Search<'m> {
    minimax: &'m Minimax,
    /// What the square of the way from the start costs, twice.
    pull: f64,
}

impl Minimax {
    /// From the starts of the unknowns. `None` if the functions have no values there.
    pub(crate) fn solve(&self, functions: &mut impl Functions) -> Option<MinimaxFit> {
        let free = Search { minimax: self, pull: 0.0 };
        let state = free.state(self.unknowns.iter().map(|of| of.start).collect(), functions)?;
        let search = Search { minimax: self, pull: self.kept * state.largest };
        Some(search.from(state, functions))
    }
}

impl Search<'_> {
    fn from(&self, mut state: State, functions: &mut impl Functions) -> MinimaxFit {
        let count = state.values.len();
        let mut bent = Mat::zeros(count, count);
        let (mut damping, mut gap) = (state.largest, state.largest);
        let mut is_settled = state.largest <= self.least(&state);
        // the most that a step from here promised and did not do
        let mut broken = 0.0_f64;
        for _ in 0..MOST_STEPS {
            let least = self.least(&state);
            if is_settled || damping > MOST_DAMPED * state.largest {
                break;
            }
            let Some(solved) = self.damped(&state, &state.residuals, &bent, damping) else {
                damping *= GROWTH;
                continue;
            };
            gap = state.cost - solved.value;
            if gap <= least && broken > 0.0 {
                (gap, is_settled) = (broken, broken <= BROKEN * least);
                break;
            }
            if gap <= least {
                let weaker = (damping * FALL * FALL).max(least);
                bent = self.bent(&state.values, &solved.weights, functions);
                let is_bowl = self.damped(&state, &state.residuals, &bent, weaker).is_some();
                match if is_bowl { None } else { self.off_saddle(&state, &solved, &bent, functions) } {
                    Some(next) => (state, broken) = (next, 0.0),
                    // as far as can be told, it rises to all sides
                    None => is_settled = !is_bowl || damping <= least,
                }
                damping = if is_bowl { weaker } else { damping };
                continue;
            }
            let (done, next) = self.tried(&state, &solved, (&bent, damping), functions);
            damping = if done < POOR { damping * GROWTH } else { damping };
            damping = if done > GOOD { (damping * FALL).max(least) } else { damping };
            broken = broken.max(gap);
            if let Some((next, weights)) = next {
                (state, broken) = (next, 0.0);
                bent = self.bent(&state.values, &weights, functions);
            }
        }
        MinimaxFit { values: state.values, residuals: state.residuals, gap, is_settled }
    }

    /// What counts as nothing beside the largest amount.
    fn least(&self, state: &State) -> f64 {
        self.minimax.settled.max(self.minimax.share * state.largest)
    }

    /// Slopes promise nothing, but along a direction in which the functions that hold the level do not change it bends down: a state that is
    /// lower beyond, to one side or the other.
    fn off_saddle(
        &self,
        state: &State,
        solved: &Solved,
        bent: &Mat<f64>,
        functions: &mut impl Functions,
    ) -> Option<State> {
        let direction = falling(state, &solved.weights, bent)?;
        let enough = state.cost - 2.0 * self.least(state);
        for length in LENGTHS {
            for signed in [length, -length] {
                let step: Vec<f64> = direction.iter().map(|part| signed * part).collect();
                let Some(beyond) = self.stepped(state, &step, functions) else { continue };
                let none = Mat::zeros(step.len(), step.len());
                let levelled = self
                    .damped(&beyond, &beyond.residuals, &none, state.largest)
                    .and_then(|solved| self.stepped(&beyond, &solved.step, functions));
                let lowest = [Some(beyond), levelled].into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost));
                if let Some(lowest) = lowest.filter(|lowest| lowest.cost < enough) {
                    return Some(lowest);
                }
            }
        }
        None
    }

    /// What share of its promise a step does, and where it leads, with the weights there, if that is lower.
    fn tried(
        &self,
        state: &State,
        solved: &Solved,
        (bent, damping): (&Mat<f64>, f64),
        functions: &mut impl Functions,
    ) -> (f64, Option<(State, Vec<f64>)>) {
        let promised = state.cost - solved.value;
        let done = |next: &State| (state.cost - next.cost) / promised;
        let Some(first) = self.stepped(state, &solved.step, functions) else { return (0.0, None) };
        let did = done(&first);
        if did >= POOR {
            return (did, Some((first, solved.weights.clone())));
        }
        // functions bend away from their linear models: the same step, with what they were behind it
        let moved = &state.jacobian * Mat::from_fn(solved.step.len(), 1, |k, _| solved.step[k]);
        let behind: Vec<f64> = first.residuals.iter().enumerate().map(|(row, at)| at - moved[(row, 0)]).collect();
        let again = self
            .damped(state, &behind, bent, damping)
            .and_then(|again| Some((self.stepped(state, &again.step, functions)?, again.weights)));
        let kept = |(next, weights): (State, Vec<f64>)| (done(&next) > TAKEN).then_some((next, weights));
        match again.filter(|(next, _)| done(next) > did) {
            Some((next, weights)) => (done(&next), kept((next, weights))),
            None => (did, kept((first, solved.weights.clone()))),
        }
    }

    fn stepped(&self, state: &State, step: &[f64], functions: &mut impl Functions) -> Option<State> {
        let each = self.minimax.unknowns.iter().zip(step).zip(&state.values);
        let values: Vec<f64> = each.clone().map(|((of, step), from)| from + of.scale * step).collect();
        let is_within = self.minimax.unknowns.iter().zip(&values).all(|(of, value)| of.range.excess(*value) <= 0.0);
        if is_within { self.state(values, functions) } else { None }
    }

    fn state(&self, values: Vec<f64>, functions: &mut impl Functions) -> Option<State> {
        let Linearized { residuals, mut jacobian } = functions.linearized(&values)?;
        for (k, unknown) in self.minimax.unknowns.iter().enumerate() {
            jacobian.col_mut(k).iter_mut().for_each(|slope| *slope *= unknown.scale);
        }
        let largest = residuals.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
        let is_finite = residuals.iter().all(|of| of.is_finite())
            && jacobian.col_iter().all(|of| of.iter().all(|slope| slope.is_finite()));
        let each = self.minimax.unknowns.iter().zip(&values).map(|(of, value)| (value - of.start) / of.scale);
        let each: Vec<f64> = each.collect();
        let way = Mat::from_fn(each.len(), 1, |k, _| each[k]);
        let cost = largest + 0.5 * self.pull * way.squared_norm_l2();
        is_finite.then_some(State { values, residuals, jacobian, largest, way, cost })
    }

    fn bent(&self, values: &[f64], weights: &[f64], functions: &mut impl Functions) -> Mat<f64> {
        let bent = functions.bent(values, weights);
        let scale = |k: usize| self.minimax.unknowns[k].scale;
        Mat::from_fn(bent.nrows(), bent.ncols(), |i, j| scale(i) * scale(j) * bent[(i, j)])
    }

    /// The step for functions with the slopes of a state. Amounts are of the size of 1 in it.
    fn damped(&self, state: &State, residuals: &[f64], bent: &Mat<f64>, damping: f64) -> Option<Solved> {
        let unit = state.largest;
        let residuals: Vec<f64> = residuals.iter().map(|of| of / unit).collect();
        let jacobian = &state.jacobian * faer::Scale(1.0 / unit);
        let slope = &state.way * faer::Scale(self.pull / unit);
        let round = |i: usize, j: usize| if i == j { damping + self.pull } else { 0.0 };
        let bent = Mat::from_fn(bent.nrows(), bent.ncols(), |i, j| (bent[(i, j)] + round(i, j)) / unit);
        let program = Program { residuals: &residuals, jacobian: &jacobian, slope: &slope, bent: &bent };
        let solved = program.solve()?;
        let walked = 0.5 * self.pull * state.way.squared_norm_l2();
        Some(Solved { value: solved.value * unit + walked, ..solved })
    }
}

/// The direction, of length one, in which what bends falls fastest while the functions that hold the level stay; `None` where it falls in none.
fn falling(state: &State, weights: &[f64], bent: &Mat<f64>) -> Option<Vec<f64>> {
    let holding: Vec<usize> = (0..weights.len()).filter(|row| weights[*row].abs() > HOLDS).collect();
    let held = Mat::from_fn(holding.len(), bent.ncols(), |row, k| state.jacobian[(holding[row], k)]);
    let size = |of: &Mat<f64>| of.norm_l2().max(f64::MIN_POSITIVE);
    let by = HELD * size(bent) / size(&held).powi(2);
    let whole = bent + held.transpose() * &held * faer::Scale(by);
    let eigen = whole.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let falls = eigen.S().column_vector()[0] < 0.0;
    falls.then(|| eigen.U().col(0).iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equations::solution::Range;

    /// Functions of two numbers: each with its slopes, and second derivatives by both, mixed, and by the other.
    struct Given(fn([f64; 2]) -> Vec<[f64; 6]>);

    impl Functions for Given {
        fn linearized(&mut self, values: &[f64]) -> Option<Linearized> {
            let rows = self.0([values[0], values[1]]);
            let jacobian = Mat::from_fn(rows.len(), 2, |row, k| rows[row][1 + k]);
            Some(Linearized { residuals: rows.iter().map(|row| row[0]).collect(), jacobian })
        }

        fn bent(&mut self, values: &[f64], weights: &[f64]) -> Mat<f64> {
            let rows = self.0([values[0], values[1]]);
            Mat::from_fn(2, 2, |i, j| rows.iter().zip(weights).map(|(row, weight)| weight * row[3 + i + j]).sum())
        }
    }

    fn solved(functions: fn([f64; 2]) -> Vec<[f64; 6]>, start: [f64; 2]) -> MinimaxFit {
        let range = Range { low: -10.0, high: 10.0 };
        let unknowns = start.map(|start| ScaledUnknown { start, scale: 1.0, range }).to_vec();
        let minimax = Minimax { unknowns, settled: 1e-11, share: 0.0, kept: 0.0 };
        minimax.solve(&mut Given(functions)).expect("there are values everywhere")
    }

    /// Charalambous and Bandler's second problem (1976): two of three functions hold the level, so that second derivatives decide.
    #[test]
    fn the_second_problem_of_charalambous_and_bandler_is_solved() {
        let functions = |[x, y]: [f64; 2]| {
            let e = 2.0 * (y - x).exp();
            vec![
                [x * x + y.powi(4), 2.0 * x, 4.0 * y.powi(3), 2.0, 0.0, 12.0 * y * y],
                [(2.0 - x).powi(2) + (2.0 - y).powi(2), 2.0 * (x - 2.0), 2.0 * (y - 2.0), 2.0, 0.0, 2.0],
                [e, -e, e, e, -e, e],
            ]
        };
        let fit = solved(functions, [2.0, 2.0]);
        assert!(fit.is_settled && fit.gap < 1e-11, "{:e}", fit.gap);
        let [x, y] = [fit.values[0], fit.values[1]];
        let largest = fit.residuals.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
        // published to seven decimals
        assert!((largest - 1.952_224_5).abs() < 5e-8, "{largest}");
        assert!((x - 1.139_038).abs() < 5e-6 && (y - 0.899_560).abs() < 5e-6, "{x} {y}");
    }

    /// The best line beside a parabola from −1 to 1 is level at a half, and 1/2 off in three places (Chebyshev).
    #[test]
    fn a_polynomial_comes_as_near_as_chebyshev_says() {
        let functions = |[a, b]: [f64; 2]| {
            let of = |x: f64| [a + b * x - x * x, 1.0, x, 0.0, 0.0, 0.0];
            (0..=20).map(|k| of(f64::from(k) / 10.0 - 1.0)).collect()
        };
        let fit = solved(functions, [0.3, 0.8]);
        assert!(fit.is_settled);
        assert!((fit.values[0] - 0.5).abs() < 1e-10 && fit.values[1].abs() < 1e-10, "{:?}", fit.values);
    }

    /// From the crest of a saddle no slope leads down: only what bends does.
    #[test]
    fn a_saddle_is_left() {
        let functions = |[x, y]: [f64; 2]| {
            let bent = [-2.0 * y, 0.0, 0.0, -2.0];
            let of = |sign: f64| [1.0 + sign * x - y * y, sign, bent[0], bent[1], bent[2], bent[3]];
            vec![of(1.0), of(-1.0), [0.5, 0.0, 0.0, 0.0, 0.0, 0.0]]
        };
        let fit = solved(functions, [0.2, 0.0]);
        let largest = fit.residuals.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
        assert!(fit.is_settled && (largest - 0.5).abs() < 1e-10, "{largest}");
    }
}

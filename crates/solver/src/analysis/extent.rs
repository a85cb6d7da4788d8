//! How far a function reaches over ranges: the travel of an axis over its motions.

use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};

use crate::Range;
use crate::newton::multistart::probe;

/// Points along each variable in one round.
const STEPS: usize = 33;
/// Rounds, each around the best point of the one before and with a tenth of its width.
const ROUNDS: usize = 6;
/// So many variables are gone through together; the work grows with the power of their number.
const TOGETHER: usize = 3;
/// Points from which more variables are gone through one after the other, and how often each of them at the most.
const STARTS: u32 = 64;
const SWEEPS: usize = 16;

/// The smallest and the largest value of `value` while the variables of `over` run through their ranges. `None` if it has no finite value anywhere.
///
/// Looked for on a grid and then ever closer around the best points: exact for smooth functions without narrow peaks. Of more than three
/// variables one after the other, from points all over the ranges, until none gets any farther: exact for sums of functions of one
/// variable each, as laws of axes over many motions are, and for products of them.
///
/// # Errors
/// If the value depends on a variable that is not in `over`.
pub fn extent<'g>(value: Expr<'g>, over: &[(Expr<'g>, Range)]) -> Result<Option<Range>, TapeError> {
    let used = value.graph().variables_of(&[value]);
    let over: Vec<(Expr<'g>, Range)> = over
        .iter()
        .copied()
        .filter(|(variable, _)| variable.as_variable().is_some_and(|v| used.contains(&v)))
        .collect();
    let inputs: Vec<Expr<'g>> = over.iter().map(|(variable, _)| *variable).collect();
    let tape = Tape::new(&[value], &inputs)?;
    let ranges: Vec<Range> = over.iter().map(|(_, range)| *range).collect();
    let (low, high) = (furthest(&tape, &ranges, -1.0), furthest(&tape, &ranges, 1.0));
    Ok(low.zip(high).map(|(low, high)| Range { low, high }))
}

/// The largest value of sign · tape, given back without the sign.
fn furthest(tape: &Tape, ranges: &[Range], sign: f64) -> Option<f64> {
    let mut search = Search { evaluator: ScalarEvaluator::new(tape), ranges, sign };
    let all: Vec<usize> = (0..ranges.len()).collect();
    let best = if all.len() <= TOGETHER {
        search.on_grids(&all, &vec![0.0; all.len()])
    } else {
        (1..=STARTS).filter_map(|k| search.one_by_one(probe(ranges, k))).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    best.map(|(largest, _)| sign * largest)
}

/// Looks for a largest value.
struct Search<'t> {
    evaluator: ScalarEvaluator<'t>,
    ranges: &'t [Range],
    sign: f64,
}

impl Search<'_> {
    /// The best point if some variables run and the others stand as they do in `at`.
    fn on_grids(&mut self, running: &[usize], at: &[f64]) -> Option<(f64, Vec<f64>)> {
        let mut boxed = self.ranges.to_vec();
        let mut best: Option<(f64, Vec<f64>)> = None;
        for _ in 0..ROUNDS {
            for mut k in 0..STEPS.pow(running.len() as u32) {
                let mut point = at.to_vec();
                for &variable in running {
                    let share = (k % STEPS) as f64 / (STEPS - 1) as f64;
                    k /= STEPS;
                    point[variable] = boxed[variable].low * (1.0 - share) + boxed[variable].high * share;
                }
                let mut value = [0.0];
                self.evaluator.run(&point, &mut value);
                let signed = self.sign * value[0];
                if signed.is_finite() && best.as_ref().is_none_or(|(largest, _)| signed > *largest) {
                    best = Some((signed, point));
                }
            }
            let (_, around) = best.as_ref()?;
            for &variable in running {
                boxed[variable] = closer(self.ranges[variable], boxed[variable], around[variable]);
            }
        }
        best
    }

    /// The point to which one variable after the other leads from another one.
    fn one_by_one(&mut self, mut at: Vec<f64>) -> Option<(f64, Vec<f64>)> {
        let mut largest: Option<f64> = None;
        for _ in 0..SWEEPS {
            let before = largest;
            for variable in 0..self.ranges.len() {
                if let Some((value, point)) = self.on_grids(&[variable], &at)
                    && largest.is_none_or(|largest| value > largest)
                {
                    (largest, at) = (Some(value), point);
                }
            }
            if largest == before {
                break;
            }
        }
        largest.map(|largest| (largest, at))
    }
}

/// A tenth of the width, around a point, within the whole range.
fn closer(whole: Range, old: Range, at: f64) -> Range {
    let half = 0.05 * old.width();
    Range { low: (at - half).max(whole.low), high: (at + half).min(whole.high) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flank_expr::Graph;

    #[test]
    fn extremes_inside_and_at_the_ends() {
        let graph = Graph::new();
        let (x, y, p) = (graph.variable("x"), graph.variable("y"), graph.variable("p"));
        let range = |low, high| Range { low, high };
        let wave = p * (3.0 * x).sin() + y;
        let [twice, two] = [wave, p].map(|value| graph.substitute(&[value], &[(p, graph.constant(2.0))])[0]);
        let over = [(x, range(0.0, 1.0)), (y, range(-1.0, 2.0))];
        let found = extent(twice, &over).expect("all bound").expect("finite");
        // 2 sin(3x) over [0, 1]: from 0 to 2
        assert!((found.low + 1.0).abs() < 1e-12 && (found.high - 4.0).abs() < 1e-9, "{found:?}");
        let still = extent(two, &over).expect("all bound");
        assert_eq!(still, Some(range(2.0, 2.0)));
        assert_eq!(extent((x - 5.0).sqrt(), &over).expect("all bound"), None);
        assert!(extent(wave, &over).is_err());
    }
    /// As many motions as a job may have are gone through in a moment: 33 to the power of 14 points are more than can be counted.
    #[test]
    fn many_variables_are_gone_through_one_by_one() {
        for count in [4, 6, 14, 40] {
            let graph = Graph::new();
            let variables: Vec<_> = (0..count).map(|k| graph.variable(format!("x{k}"))).collect();
            let over: Vec<_> = variables.iter().map(|x| (*x, Range { low: -1.0, high: 3.0 })).collect();
            // each sine runs from −1 to 1; the product of two variables from −3 to 9, at corners
            let sines = variables.iter().map(|x| (2.0 * *x).sin()).reduce(|a, b| a + b).expect("some");
            let found = extent(sines + variables[0] * variables[1] * 100.0, &over).expect("bound").expect("finite");
            let others = (count - 2) as f64;
            let [low, high] = [(-2f64).sin(), 6f64.sin()];
            // near a corner the product decides over the two sines
            assert!((found.low - (-300.0 + low + high - others)).abs() < 1e-9, "{count}: {found:?}");
            assert!((found.high - (900.0 + 2.0 * high + others)).abs() < 1e-9, "{count}: {found:?}");
        }
    }
}

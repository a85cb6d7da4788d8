//! How far a function reaches over ranges: the travel of an axis over its motions.

use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};

use crate::Range;

/// Points along each variable in one round.
const STEPS: usize = 33;
/// Rounds, each around the best point of the one before and with a tenth of its width.
const ROUNDS: usize = 6;

/// The smallest and the largest value of `value` while the variables of `over` run through their ranges; `bindings` replace
/// the others. `None` if it has no finite value anywhere.
///
/// Looked for on a grid and then ever closer around the best points: exact for smooth functions without narrow peaks.
///
/// # Errors
/// If the value depends on a variable that is neither in `over` nor bound.
pub fn extent<'g>(
    value: Expr<'g>,
    over: &[(Expr<'g>, Range)],
    bindings: &[(Expr<'g>, Expr<'g>)],
) -> Result<Option<Range>, TapeError> {
    let value = value.graph().substitute(&[value], bindings);
    let used = value[0].graph().variables_of(&value);
    let over: Vec<(Expr<'g>, Range)> = over
        .iter()
        .copied()
        .filter(|(variable, _)| variable.as_variable().is_some_and(|v| used.contains(&v)))
        .collect();
    let inputs: Vec<Expr<'g>> = over.iter().map(|(variable, _)| *variable).collect();
    let tape = Tape::new(&value, &inputs)?;
    let ranges: Vec<Range> = over.iter().map(|(_, range)| *range).collect();
    let (low, high) = (furthest(&tape, &ranges, -1.0), furthest(&tape, &ranges, 1.0));
    Ok(low.zip(high).map(|(low, high)| Range { low, high }))
}

/// The largest value of sign · tape, given back without the sign.
fn furthest(tape: &Tape, ranges: &[Range], sign: f64) -> Option<f64> {
    let mut evaluator = ScalarEvaluator::new(tape);
    let mut boxed = ranges.to_vec();
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..ROUNDS {
        for mut k in 0..STEPS.pow(ranges.len() as u32) {
            let point: Vec<f64> = boxed
                .iter()
                .map(|range| {
                    let share = (k % STEPS) as f64 / (STEPS - 1) as f64;
                    k /= STEPS;
                    range.low * (1.0 - share) + range.high * share
                })
                .collect();
            let mut value = [0.0];
            evaluator.run(&point, &mut value);
            let signed = sign * value[0];
            if signed.is_finite() && best.as_ref().is_none_or(|(largest, _)| signed > *largest) {
                best = Some((signed, point));
            }
        }
        let (_, around) = best.as_ref()?;
        boxed = ranges.iter().zip(&boxed).zip(around).map(|((range, old), at)| closer(*range, *old, *at)).collect();
    }
    best.map(|(largest, _)| sign * largest)
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
        let over = [(x, range(0.0, 1.0)), (y, range(-1.0, 2.0))];
        let found = extent(wave, &over, &[(p, graph.constant(2.0))]).expect("all bound").expect("finite");
        // 2 sin(3x) over [0, 1]: from 0 to 2
        assert!((found.low + 1.0).abs() < 1e-12 && (found.high - 4.0).abs() < 1e-9, "{found:?}");
        let still = extent(p, &over, &[(p, graph.constant(2.0))]).expect("all bound");
        assert_eq!(still, Some(range(2.0, 2.0)));
        assert_eq!(extent((x - 5.0).sqrt(), &over, &[]).expect("all bound"), None);
        assert!(extent(wave, &over, &[]).is_err());
    }
}

//! The step of Newton as functions of the unknowns, for systems of few equations: lanes then compute it with the residuals.

use flank_expr::geometry::cofactors;
use flank_expr::{Expr, LaneTape, Tape, TapeError};

use crate::newton::{LARGEST_TOLERANCE, OF_SIZE, TOLERANCE};

/// Equations up to which the step is written out.
pub(crate) const MOST_EQUATIONS: usize = 5;

/// Lays out residuals, the step (as shares of the ranges), one over the tolerance of each residual, and the determinant of the
/// Jacobian, with unknowns scaled by their ranges and each equation by its largest entry. Inputs are the unknowns, the
/// parameters and, the same in all lanes, the widths of the ranges.
///
/// # Errors
/// If a residual depends on a variable that is neither an unknown nor a parameter.
pub(crate) fn written_out<'g>(
    residuals: &[Expr<'g>],
    unknowns: &[Expr<'g>],
    parameters: &[Expr<'g>],
) -> Result<LaneTape, TapeError> {
    let graph = unknowns[0].graph();
    let widths: Vec<Expr<'g>> = (0..unknowns.len()).map(|k| graph.variable(format!("width {k}"))).collect();
    let jacobian: Vec<Vec<Expr<'g>>> =
        residuals.iter().map(|f| unknowns.iter().map(|x| f.derivative(*x)).collect()).collect();
    // row by row
    let cofactors: Vec<Vec<Expr<'g>>> = (0..residuals.len()).map(|row| cofactors(graph, &jacobian, row)).collect();
    let sum = |terms: &mut dyn Iterator<Item = Expr<'g>>| terms.reduce(|a, b| a + b).unwrap_or(graph.constant(0.0));
    let determinant = sum(&mut jacobian[0].iter().zip(&cofactors[0]).map(|(a, b)| *a * *b));
    let steps = (0..unknowns.len()).map(|k| {
        let right = sum(&mut residuals.iter().zip(&cofactors).map(|(f, row)| *f * row[k]));
        -right / (determinant * widths[k])
    });
    let entries = |row: &[Expr<'g>]| row.iter().copied().enumerate().filter(|(_, entry)| !entry.is_zero()).collect();
    let entries: Vec<Vec<(usize, Expr<'g>)>> = jacobian.iter().map(|row| entries(row)).collect();
    let sharpness = entries.iter().map(|row| {
        let size = sum(&mut row.iter().map(|(k, entry)| entry.abs() * unknowns[*k].abs().max(graph.constant(1.0))));
        let allowed = (OF_SIZE * size).max(graph.constant(TOLERANCE)).min(graph.constant(LARGEST_TOLERANCE));
        1.0 / allowed
    });
    let largest = entries.iter().map(|row| {
        let scaled = row.iter().map(|(k, entry)| entry.abs() * widths[*k]);
        scaled.reduce(|a, b| a.max(b)).unwrap_or(graph.constant(0.0))
    });
    let volume = widths.iter().copied().reduce(|a, b| a * b).unwrap_or(graph.constant(1.0));
    let scale = largest.reduce(|a, b| a * b).unwrap_or(graph.constant(1.0));
    let outputs: Vec<Expr<'g>> =
        residuals.iter().copied().chain(steps).chain(sharpness).chain([determinant * volume / scale]).collect();
    let inputs: Vec<Expr<'g>> = unknowns.iter().chain(parameters).chain(&widths).copied().collect();
    let uniform: Vec<bool> = (0..inputs.len()).map(|k| k >= unknowns.len() + parameters.len()).collect();
    Ok(LaneTape::with_uniform(&Tape::new(&outputs, &inputs)?, &uniform))
}

#[cfg(test)]
mod tests {
    use flank_expr::{Graph, InstructionSet, LaneEvaluator};

    use super::*;
    use crate::newton::newton_step;
    use crate::solution::Range;
    use crate::system::System;

    /// Numbers in ±1 from a linear congruence.
    fn next(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A linear system with the matrix and right side as parameters, and its lane tape's outputs at a point.
    fn at(n: usize, parameters: &[f64], p: &[f64], ranges: &[Range]) -> (Vec<f64>, Vec<f64>, bool) {
        let graph = Graph::new();
        let variables = |name: &str, count: usize| -> Vec<Expr<'_>> {
            (0..count).map(|k| graph.variable(format!("{name}{k}"))).collect()
        };
        let (unknowns, given) = (variables("x", n), variables("a", n * (n + 1)));
        let residual = |row: usize| {
            let terms = unknowns.iter().zip(&given[row * n..]).map(|(x, a)| *x * *a);
            terms.fold(graph.constant(0.0), |sum, term| sum + term) - given[n * n + row]
        };
        let residuals: Vec<Expr<'_>> = (0..n).map(residual).collect();
        let tape = written_out(&residuals, &unknowns, &given).expect("nothing is unbound");
        let mut lanes = LaneEvaluator::new(&tape, InstructionSet::fastest());
        for (k, value) in p.iter().chain(parameters).enumerate() {
            lanes.input(k)[0] = *value;
        }
        ranges.iter().enumerate().for_each(|(k, range)| lanes.set_uniform(n * (n + 2) + k, range.width()));
        lanes.run_first(1);
        let system = System::new(&residuals, &unknowns, &given).expect("nothing is unbound");
        let mut evaluation = system.evaluation(parameters);
        evaluation.at(p);
        let careful = newton_step(&evaluation, ranges, &mut vec![0.0; n]);
        ((0..=3 * n).map(|k| lanes.output(k)[0]).collect(), careful.by, careful.singular)
    }

    #[test]
    fn small_systems_have_the_steps_of_the_general_path() {
        let mut state = 7;
        for n in 1..=MOST_EQUATIONS {
            for _ in 0..100 {
                let parameters: Vec<f64> = (0..n * (n + 1)).map(|_| next(&mut state)).collect();
                let p: Vec<f64> = (0..n).map(|_| next(&mut state)).collect();
                let ranges: Vec<Range> = (0..n).map(|_| Range { low: 0.0, high: 2.5 + next(&mut state) }).collect();
                let (found, careful, singular) = at(n, &parameters, &p, &ranges);
                let determinant = found[3 * n].abs();
                assert!(!singular && determinant > 0.0);
                let longest = careful.iter().fold(1.0, |most: f64, by| most.max(by.abs()));
                for k in 0..n {
                    let off = (found[n + k] * ranges[k].width() - careful[k]).abs();
                    assert!(off <= 256.0 * f64::EPSILON * longest / determinant, "{n}: {found:?} {careful:?}");
                }
            }
        }
    }

    #[test]
    fn no_inverse_shows_in_the_determinant() {
        let ranges = [Range { low: 0.0, high: 3.0 }; 3];
        let dependent = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.5, -1.0, 1.0, 1.0, 2.0, 3.0];
        let (found, _, singular) = at(3, &dependent, &[0.1, 0.2, 0.3], &ranges);
        assert!(singular && found[9].abs() < 1e-15, "{found:?}");
        let (found, _, singular) = at(2, &[0.0; 6], &[0.1, 0.2], &ranges[..2]);
        assert!(singular && found[6].is_nan(), "{found:?}");
    }
}

//! The step of Newton as functions of the unknowns, for systems of few equations: lanes then compute it with the residuals.

use flank_expr::geometry::cofactors;
use flank_expr::{Expr, LaneTape, Tape, TapeError, Varies};

use crate::equations::closed_form::given_unknowns;
use crate::equations::lines;
use crate::equations::tolerance::{LARGEST_TOLERANCE, OF_SIZE, TOLERANCE, VITAL};

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
    let linear = Linear::new(residuals, unknowns);
    let (graph, widths) = (unknowns[0].graph(), &linear.widths);
    let steps = (0..unknowns.len()).map(|k| {
        let right = linear.sum(residuals.iter().zip(&linear.cofactors).map(|(f, row)| *f * row[k]));
        -right / (linear.determinant * widths[k])
    });
    let sharpness = linear.entries().map(|row| {
        let size = linear.sum(row.map(|(k, entry)| entry.abs() * unknowns[k].abs().max(graph.constant(1.0))));
        let allowed = (OF_SIZE * size).max(graph.constant(TOLERANCE)).min(graph.constant(LARGEST_TOLERANCE));
        1.0 / allowed
    });
    let outputs = residuals.iter().copied().chain(steps).chain(sharpness).chain([linear.scaled_determinant()]);
    let inputs: Vec<Expr<'g>> = unknowns.iter().chain(parameters).chain(widths).copied().collect();
    let tape = Tape::of_numbers(&outputs.collect::<Vec<_>>(), &inputs, &[])?;
    Ok(LaneTape::with_inputs(&tape, &freely(unknowns.len(), parameters.len())))
}

/// What is wanted at a root.
pub(crate) struct RootOutputs<'a, 'g> {
    pub(crate) residuals: &'a [Expr<'g>],
    pub(crate) conditions: &'a [Expr<'g>],
    pub(crate) extras: &'a [Expr<'g>],
}

impl<'g> RootOutputs<'_, 'g> {
    /// The sum of what must be finite, if anything is: it is so only if all of that is.
    pub(crate) fn vital(&self) -> Option<Expr<'g>> {
        self.extras.iter().take(VITAL).copied().reduce(|a, b| a + b)
    }

    /// All of it, then the sum of what must be finite.
    pub(crate) fn all(&self) -> Vec<Expr<'g>> {
        [self.residuals, self.conditions, self.extras, self.vital().as_slice()].concat()
    }
}

/// What is wanted at a root, with some unknowns in closed form.
#[derive(Clone, Debug)]
pub(crate) struct GivenTapes {
    /// What is wanted, then the unknowns that equations give, and the determinant as in [`written_out`] if they give all of them.
    /// Inputs are those of [`written_out`]; the given unknowns among them have no effect.
    pub(crate) checked: LaneTape,
    /// For lines of points, if all unknowns are given by two parameters: see [`lines::laid_out`].
    pub(crate) on_lines: Option<LaneTape>,
    /// For lines of points that are expected somewhere, if not all unknowns are given: see [`lines::expected`].
    pub(crate) expected: Option<LaneTape>,
    /// The numbers of the given unknowns.
    pub(crate) unknowns: Vec<usize>,
}

impl GivenTapes {
    /// Lays out what is wanted; `None` if no equation gives an unknown.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor a parameter.
    pub(crate) fn new<'g>(
        wanted: &RootOutputs<'_, 'g>,
        unknowns: &[Expr<'g>],
        parameters: &[Expr<'g>],
    ) -> Result<Option<GivenTapes>, TapeError> {
        let given = given_unknowns(wanted.residuals, unknowns);
        if given.is_empty() {
            return Ok(None);
        }
        let has_all = given.len() == unknowns.len();
        let widths = widths(unknowns);
        let linear = has_all.then(|| Linear::with_widths(wanted.residuals, unknowns, widths.clone()));
        let determinant = linear.as_ref().map(Linear::scaled_determinant);
        let found = given.iter().map(|given| unknowns[given.unknown]);
        let outputs: Vec<Expr<'g>> = wanted.all().into_iter().chain(found).chain(determinant).collect();
        let inputs: Vec<Expr<'g>> = unknowns.iter().chain(parameters).chain(&widths).copied().collect();
        let definitions: Vec<_> = given.iter().map(|given| (unknowns[given.unknown], given.form)).collect();
        let tape = Tape::of_numbers(&outputs, &inputs, &definitions)?;
        let checked = LaneTape::with_inputs(&tape, &freely(unknowns.len(), parameters.len()));
        let on_lines = linear.as_ref().filter(|_| parameters.len() == 2);
        let on_lines =
            on_lines.map(|linear| lines::laid_out(wanted, &given, linear, [unknowns, parameters])).transpose()?;
        let expected = || lines::expected(wanted, &given, [unknowns, parameters]);
        let expected = (!has_all).then(expected).transpose()?;
        Ok(Some(GivenTapes {
            checked,
            on_lines,
            expected,
            unknowns: given.iter().map(|given| given.unknown).collect(),
        }))
    }
}

impl GivenTapes {
    pub(crate) fn tapes(&self) -> impl Iterator<Item = &LaneTape> {
        [&self.checked].into_iter().chain(&self.on_lines).chain(&self.expected)
    }

    /// The same with other numbers for the settings of the tapes.
    pub(crate) fn with_settings(&self, values: &[f64]) -> GivenTapes {
        let changed = |tape: &Option<LaneTape>| tape.as_ref().map(|tape| tape.with_settings(values));
        GivenTapes {
            checked: self.checked.with_settings(values),
            on_lines: changed(&self.on_lines),
            expected: changed(&self.expected),
            unknowns: self.unknowns.clone(),
        }
    }
}

/// How the inputs vary: unknowns and parameters freely, then the widths of the ranges.
fn freely(unknowns: usize, parameters: usize) -> Vec<Varies> {
    [vec![Varies::Freely; unknowns + parameters], vec![Varies::Seldom; unknowns]].concat()
}

/// Derivatives of equations.
pub(crate) struct Linear<'g> {
    /// Row by row, with the cofactors.
    jacobian: Vec<Vec<Expr<'g>>>,
    cofactors: Vec<Vec<Expr<'g>>>,
    determinant: Expr<'g>,
    /// Variables for the widths of the ranges.
    pub(crate) widths: Vec<Expr<'g>>,
}

/// Variables for the widths of the ranges.
fn widths<'g>(unknowns: &[Expr<'g>]) -> Vec<Expr<'g>> {
    (0..unknowns.len()).map(|k| unknowns[k].graph().variable(format!("width {k}"))).collect()
}

impl<'g> Linear<'g> {
    fn new(residuals: &[Expr<'g>], unknowns: &[Expr<'g>]) -> Linear<'g> {
        Linear::with_widths(residuals, unknowns, widths(unknowns))
    }

    fn with_widths(residuals: &[Expr<'g>], unknowns: &[Expr<'g>], widths: Vec<Expr<'g>>) -> Linear<'g> {
        let graph = unknowns[0].graph();
        let slopes = |f: &Expr<'g>| unknowns.iter().map(|x| f.derivative(*x)).collect();
        let jacobian: Vec<Vec<Expr<'g>>> = residuals.iter().map(slopes).collect();
        let cofactors: Vec<Vec<Expr<'g>>> = (0..residuals.len()).map(|row| cofactors(graph, &jacobian, row)).collect();
        let terms = jacobian[0].iter().zip(&cofactors[0]).map(|(a, b)| *a * *b);
        let determinant = terms.reduce(|a, b| a + b).unwrap_or(graph.constant(0.0));
        Linear { jacobian, cofactors, determinant, widths }
    }

    fn sum(&self, terms: impl Iterator<Item = Expr<'g>>) -> Expr<'g> {
        terms.reduce(|a, b| a + b).unwrap_or(self.determinant.graph().constant(0.0))
    }

    /// What is not zero in each row, by number of the unknown.
    fn entries(&self) -> impl Iterator<Item = impl Iterator<Item = (usize, Expr<'g>)>> {
        self.jacobian.iter().map(|row| row.iter().copied().enumerate().filter(|(_, entry)| !entry.is_zero()))
    }

    /// The determinant, with unknowns scaled by their ranges and each equation by its largest entry.
    pub(crate) fn scaled_determinant(&self) -> Expr<'g> {
        let graph = self.determinant.graph();
        let product = |factors: &mut dyn Iterator<Item = Expr<'g>>| factors.reduce(|a, b| a * b);
        let largest = self.entries().map(|row| {
            let scaled = row.map(|(k, entry)| entry.abs() * self.widths[k]);
            scaled.reduce(|a, b| a.max(b)).unwrap_or(graph.constant(0.0))
        });
        let scale = product(&mut largest.into_iter()).unwrap_or(graph.constant(1.0));
        let volume = product(&mut self.widths.iter().copied()).unwrap_or(graph.constant(1.0));
        self.determinant * volume / scale
    }
}

#[cfg(test)]
mod tests {
    use flank_expr::{Graph, InstructionSet, LaneEvaluator};

    use super::*;
    use crate::equations::solution::Range;
    use crate::equations::system::System;
    use crate::newton::scalar::Newton;

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
        let careful = Newton::new(n).step(&evaluation, ranges);
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

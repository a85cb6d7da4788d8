//! Unknowns that equations give, as functions of what else is in the equations.

mod explicit;
mod start;
mod unique;

use super::interval::Interval;
use crate::symbolic::graph::Expr;
use crate::symbolic::implicit;
use crate::tape::Tape;

/// How far beyond its range an unknown may lie, over the width of the range.
const MARGIN: f64 = 1e-6;
/// How far the last step of Newton's method may go, over the width of the range. What is left then is some ten times its square.
const REACH: f64 = 1e-8;

/// Something that equations give.
#[derive(Clone, Copy, Debug)]
pub struct Unknown<'g> {
    /// The variable that stands for it in the equations, and nowhere else.
    pub variable: Expr<'g>,
    /// Where it lies.
    pub range: Interval,
}

/// Why equations do not give their unknowns. What moves has the values told, in the order of the ranges that are no points.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoRoot {
    /// There is none in the range.
    #[error("there is no root in the range")]
    None(Vec<f64>),
    /// There is more than one.
    #[error("there is more than one root in the range")]
    Several(Vec<f64>),
    /// Neither is proven.
    #[error("it is not proven that there is one root in the range")]
    Unproven(Vec<f64>),
    /// No polynomial in what moves comes so near that two steps of Newton's method settle.
    #[error("the root changes too fast with what moves")]
    TooFast,
}

/// The equations as tapes over unknowns and what else is in them.
struct System {
    unknowns: Vec<Interval>,
    /// Where the other inputs lie.
    others: Vec<Interval>,
    /// Residuals.
    values: Tape,
    /// Their derivatives by the unknowns, row by row.
    slopes: Tape,
    /// Unknowns that are given in closed form by those above.
    given: Tape,
    /// Where these lie.
    given_ranges: Vec<Interval>,
}

/// A range with a margin: a root at an end is one, rounding or not.
fn widened(range: Interval) -> Interval {
    let margin = MARGIN * (range.hi - range.lo);
    Interval::new(range.lo - margin, range.hi + margin)
}

impl System {
    fn new<'g>(residuals: &[Expr<'g>], unknowns: &[Unknown<'g>], others: &[(Expr<'g>, Interval)]) -> System {
        System::with_given(residuals, unknowns, others, &[])
    }

    /// With unknowns that others give, which have to lie in their ranges, too.
    fn with_given<'g>(
        residuals: &[Expr<'g>],
        unknowns: &[Unknown<'g>],
        others: &[(Expr<'g>, Interval)],
        given: &[(Expr<'g>, Interval)],
    ) -> System {
        assert!(residuals.len() == unknowns.len() && !unknowns.is_empty(), "as many equations as unknowns");
        let variables: Vec<Expr<'g>> = unknowns.iter().map(|unknown| unknown.variable).collect();
        let inputs: Vec<Expr<'g>> = variables.iter().copied().chain(others.iter().map(|other| other.0)).collect();
        let slopes: Vec<Expr<'g>> = residuals
            .iter()
            .flat_map(|residual| variables.iter().map(|variable| residual.derivative(*variable)))
            .collect();
        let tape =
            |outputs: &[Expr<'g>]| Tape::new(outputs, &inputs).expect("every variable of the equations has a range");
        System {
            unknowns: unknowns.iter().map(|unknown| widened(unknown.range)).collect(),
            others: others.iter().map(|other| other.1).collect(),
            values: tape(residuals),
            slopes: tape(&slopes),
            given: tape(&given.iter().map(|given| given.0).collect::<Vec<_>>()),
            given_ranges: given.iter().map(|given| widened(given.1)).collect(),
        }
    }

    /// Numbers of the other inputs that move.
    fn moving(&self) -> Vec<usize> {
        (0..self.others.len()).filter(|k| self.others[*k].lo < self.others[*k].hi).collect()
    }
}

/// The unknowns of as many equations, as functions of what else is in these.
///
/// That there is one solution in the ranges, whatever the `others` are within theirs, is proven: by interval Newton (Krawczyk's operator)
/// over parts of the ranges. An unknown in which an equation is linear, or the sine of something linear, is written by the others. A polynomial in what moves comes near it, two steps of Newton's method written out do the rest, and
/// derivatives come from the equations. Where a value is asked for so far beyond the ranges, or with so different numbers for what stands
/// still, that these two steps do not settle, it is NaN.
///
/// `others` has what the residuals depend on beside the unknowns; what stands still as points.
///
/// ```
/// use flank_expr::{Graph, Interval, Unknown, roots};
///
/// let graph = Graph::new();
/// let (x, a) = (graph.variable("x"), graph.variable("a"));
/// let unknown = Unknown { variable: x, range: Interval::new(0.0, 3.0) };
/// let [root] = roots(&[x * x - a], &[unknown], &[(a, Interval::new(1.0, 4.0))]).expect("it is the square root")[..] else { panic!() };
/// let values = graph.evaluate(&[root, root.derivative(a)], &[0.0, 2.0]);
/// assert!((values[0] - 2.0_f64.sqrt()).abs() < 1e-15 && (values[1] - 0.125_f64.sqrt()).abs() < 1e-15);
/// ```
///
/// # Errors
/// If it is not proven that there is one solution, or no polynomial comes near it.
///
/// # Panics
/// If there are not as many residuals as unknowns, none at all, more than 255, or if a residual depends on what is neither an unknown nor
/// among the `others`.
pub fn roots<'g>(
    residuals: &[Expr<'g>],
    unknowns: &[Unknown<'g>],
    others: &[(Expr<'g>, Interval)],
) -> Result<Vec<Expr<'g>>, NoRoot> {
    assert!(residuals.len() == unknowns.len() && !unknowns.is_empty(), "as many equations as unknowns");
    let reduced = explicit::reduced(residuals, unknowns, others);
    if !reduced.given.is_empty()
        && let Ok(roots) = of_reduced(&reduced, unknowns, others)
    {
        return Ok(roots);
    }
    // all unknowns together tell what is wrong
    let kept = (0..unknowns.len()).collect();
    let whole = explicit::Reduced { residuals: residuals.to_vec(), kept, given: Vec::new() };
    of_reduced(&whole, unknowns, others)
}

fn of_reduced<'g>(
    reduced: &explicit::Reduced<'g>,
    unknowns: &[Unknown<'g>],
    others: &[(Expr<'g>, Interval)],
) -> Result<Vec<Expr<'g>>, NoRoot> {
    let explicit::Reduced { residuals, kept, given } = reduced;
    let graph = residuals[0].graph();
    let left: Vec<Unknown<'g>> = kept.iter().map(|place| unknowns[*place]).collect();
    let given_in: Vec<(Expr<'g>, Interval)> = given.iter().map(|(place, law)| (*law, unknowns[*place].range)).collect();
    let system = System::with_given(residuals, &left, others, &given_in);
    unique::prove(&system, unique::MOST_IN_ALL)?;
    let variables: Vec<Expr<'g>> = left.iter().map(|unknown| unknown.variable).collect();
    let moving: Vec<Expr<'g>> = system.moving().into_iter().map(|k| others[k].0).collect();
    let starts = start::polynomials(&system).ok_or(NoRoot::TooFast)?;
    let starts = starts.into_iter().map(|polynomial| polynomial.written(graph, &moving)).collect();
    let ends = |range: &Interval| (range.lo, range.hi);
    let limits: Vec<(f64, f64)> = system.unknowns.iter().map(ends).collect();
    let ranges: Vec<(f64, f64)> = left.iter().map(|unknown| ends(&unknown.range)).collect();
    let reach = |limits: &(f64, f64)| REACH * (limits.1 - limits.0);
    let reaches: Vec<f64> = limits.iter().map(reach).collect();
    let laws: Vec<Expr<'g>> = given.iter().map(|given| given.1).collect();
    let bounds = laws.iter().zip(system.given_ranges.iter().map(ends));
    let bounds: Vec<(Expr<'g>, (f64, f64), f64)> = bounds.map(|(law, limits)| (*law, limits, reach(&limits))).collect();
    let roots = implicit::roots(residuals, &variables, [&ranges, &limits], starts, (&reaches, &bounds));
    let replacements: Vec<(Expr<'g>, Expr<'g>)> = variables.into_iter().zip(roots.iter().copied()).collect();
    let laws = graph.substitute(&laws, &replacements);
    let mut all: Vec<(usize, Expr<'g>)> =
        kept.iter().copied().zip(roots).chain(given.iter().map(|given| given.0).zip(laws)).collect();
    all.sort_unstable_by_key(|(place, _)| *place);
    Ok(all.into_iter().map(|(_, root)| root).collect())
}

/// Whether [`roots`] is likely to find the unknowns: what it proves is tried with a tenth of its effort.
///
/// # Panics
/// As [`roots`].
pub fn has_one_root<'g>(residuals: &[Expr<'g>], unknowns: &[Unknown<'g>], others: &[(Expr<'g>, Interval)]) -> bool {
    unique::prove(&System::new(residuals, unknowns, others), unique::MOST_IN_ALL / 10).is_ok()
}

/// All solutions of equations in the ranges of their unknowns, in order, where the others have these values; none where that is not
/// decided.
///
/// ```
/// use flank_expr::{Graph, Interval, Unknown, every_root};
///
/// let graph = Graph::new();
/// let (x, a) = (graph.variable("x"), graph.variable("a"));
/// let unknown = Unknown { variable: x, range: Interval::new(-3.0, 3.0) };
/// let found = every_root(&[x * x - a], &[unknown], &[(a, 4.0)]);
/// assert!(found.len() == 2 && (found[0][0] + 2.0).abs() < 1e-15 && (found[1][0] - 2.0).abs() < 1e-15);
/// ```
///
/// # Panics
/// As [`roots`].
pub fn every_root<'g>(residuals: &[Expr<'g>], unknowns: &[Unknown<'g>], others: &[(Expr<'g>, f64)]) -> Vec<Vec<f64>> {
    let values: Vec<f64> = others.iter().map(|other| other.1).collect();
    let others: Vec<(Expr<'g>, Interval)> =
        others.iter().map(|(other, value)| (*other, Interval::point(*value))).collect();
    unique::every(&System::new(residuals, unknowns, &others), &values)
}

/// The only solutions of equations in ranges, for one set of numbers after another. All together look at no more boxes than a proof for
/// what moves.
pub struct OnlyRoots {
    system: System,
    boxes_left: usize,
}

impl OnlyRoots {
    /// The equations; the `others` are what they depend on beside the unknowns.
    ///
    /// ```
    /// use flank_expr::{Graph, Interval, OnlyRoots, Unknown};
    ///
    /// let graph = Graph::new();
    /// let (x, a) = (graph.variable("x"), graph.variable("a"));
    /// let unknown = Unknown { variable: x, range: Interval::new(0.0, 3.0) };
    /// let mut roots = OnlyRoots::new(&[x * x - a], &[unknown], &[a]);
    /// assert!((roots.at(&[2.0]).expect("it is the square root")[0] - 2.0_f64.sqrt()).abs() < 1e-15);
    /// assert!(roots.at(&[-2.0]).is_err());
    /// ```
    ///
    /// # Panics
    /// As [`roots`].
    pub fn new<'g>(residuals: &[Expr<'g>], unknowns: &[Unknown<'g>], others: &[Expr<'g>]) -> OnlyRoots {
        let others: Vec<(Expr<'g>, Interval)> = others.iter().map(|other| (*other, Interval::WHOLE)).collect();
        OnlyRoots { system: System::new(residuals, unknowns, &others), boxes_left: unique::MOST_IN_ALL }
    }

    /// The unknowns for these values of the others, to rounding.
    ///
    /// # Errors
    /// If it is not proven that there is one solution in the ranges; without the places that a [`NoRoot`] otherwise tells.
    ///
    /// # Panics
    /// If there is not a value for each of the others.
    pub fn at(&mut self, others: &[f64]) -> Result<Vec<f64>, NoRoot> {
        assert_eq!(others.len(), self.system.others.len(), "a value for each");
        let place = unique::solution(&self.system, others, &mut self.boxes_left)?;
        start::settled(&self.system, place, others).ok_or(NoRoot::Unproven(Vec::new()))
    }
}

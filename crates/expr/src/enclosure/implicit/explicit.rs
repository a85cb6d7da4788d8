//! Unknowns that one equation alone gives by the others, in closed form.

use std::f64::consts::PI;

use super::{Unknown, widened};
use crate::enclosure::interval::{Interval, IntervalEvaluator};
use crate::symbolic::graph::{Expr, Node};
use crate::symbolic::op::Unary;
use crate::tape::Tape;

/// How near the end of its range an angle may come to a multiple of half a turn that is not meant, in rad.
const NEAR: f64 = 1e-9;

/// Equations without the unknowns that are given in closed form.
pub(super) struct Reduced<'g> {
    /// As many as `kept`.
    pub(super) residuals: Vec<Expr<'g>>,
    /// The places of the unknowns that are left.
    pub(super) kept: Vec<usize>,
    /// The places of the others, each with what gives it by those that are left.
    pub(super) given: Vec<(usize, Expr<'g>)>,
}

/// Takes out one unknown after the other for which there is an equation that is linear in it, with a number as factor, or the sine of
/// something that is, as long as the ranges leave it one multiple of half a turn. One unknown is left in any case.
pub(super) fn reduced<'g>(
    residuals: &[Expr<'g>],
    unknowns: &[Unknown<'g>],
    others: &[(Expr<'g>, Interval)],
) -> Reduced<'g> {
    let graph = residuals[0].graph();
    let ranges: Vec<(Expr<'g>, Interval)> = unknowns
        .iter()
        .map(|unknown| (unknown.variable, widened(unknown.range)))
        .chain(others.iter().copied())
        .collect();
    let mut all = Reduced { residuals: residuals.to_vec(), kept: (0..unknowns.len()).collect(), given: Vec::new() };
    while let Some((row, place, law)) = next(&all, unknowns, &ranges) {
        let replaced = [(unknowns[place].variable, law)];
        all.residuals.remove(row);
        all.kept.retain(|kept| *kept != place);
        all.residuals = graph.substitute(&all.residuals, &replaced);
        for (_, given) in &mut all.given {
            *given = graph.substitute(&[*given], &replaced)[0];
        }
        all.given.push((place, law));
    }
    all
}

/// An equation, the unknown that it gives, and by what: of those there are, an unknown that stands in the fewest equations.
fn next<'g>(
    system: &Reduced<'g>,
    unknowns: &[Unknown<'g>],
    ranges: &[(Expr<'g>, Interval)],
) -> Option<(usize, usize, Expr<'g>)> {
    if system.kept.len() < 2 {
        return None;
    }
    let stands_in = |residual: &Expr<'g>, place: usize| {
        let own = unknowns[place].variable.as_variable();
        residual.graph().variables_of(&[*residual]).into_iter().any(|variable| Some(variable) == own)
    };
    let mut places = system.kept.clone();
    places.sort_by_key(|place| system.residuals.iter().filter(|residual| stands_in(residual, *place)).count());
    places.into_iter().find_map(|place| {
        let rows = system.residuals.iter().enumerate();
        rows.filter(|(_, residual)| stands_in(residual, place))
            .find_map(|(row, residual)| Some((row, place, law(*residual, unknowns[place].variable, ranges)?)))
    })
}

/// What a variable is where an expression is zero.
fn law<'g>(residual: Expr<'g>, variable: Expr<'g>, ranges: &[(Expr<'g>, Interval)]) -> Option<Expr<'g>> {
    let graph = residual.graph();
    // what is linear and has to be zero, and the distance of its possible values
    let (linear, period) = match residual.node() {
        Node::Unary(Unary::Sin, angle) => (graph.expr(angle), Some(PI)),
        _ => (residual, None),
    };
    let factor = linear.derivative(variable).as_constant().filter(|factor| factor.is_normal())?;
    let rest = graph.substitute(&[linear], &[(variable, graph.constant(0.0))])[0];
    let value = match period {
        None => 0.0,
        Some(period) => {
            let angle = enclosure(linear, ranges);
            let (first, last) = (((angle.lo - NEAR) / period).ceil(), ((angle.hi + NEAR) / period).floor());
            if first != last {
                return None;
            }
            first * period
        }
    };
    Some((value - rest) / factor)
}

fn enclosure<'g>(expr: Expr<'g>, ranges: &[(Expr<'g>, Interval)]) -> Interval {
    let (inputs, values): (Vec<Expr<'g>>, Vec<Interval>) = ranges.iter().copied().unzip();
    let tape = Tape::new(&[expr], &inputs).expect("every variable of the equations has a range");
    let mut out = [Interval::WHOLE];
    IntervalEvaluator::new(&tape).run(&values, &mut out);
    out[0]
}

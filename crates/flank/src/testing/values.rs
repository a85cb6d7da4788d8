//! Functions at the points of a surface that is tested.

use flank_chain_dsl::Sample;
use flank_export::Values;
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Outcome, SurfacePoint};

use crate::solve::{cut, geometry};
use crate::testing::points::Tested;

/// What single edges leave, by its name in expectations.
pub(super) const LEFT: &str = "left";

/// A function of points at those that are solved. Curvatures are known of surfaces with a sample.
pub(super) fn values<'g>(
    tested: &Tested<'_, 'g>,
    index: usize,
    (sample, points): (Option<&Sample<'g>>, &[SurfacePoint]),
    (value, known): (Expr<'g>, &[(&'static str, Expr<'g>)]),
) -> Vec<Option<f64>> {
    let surface = tested.surface(index);
    let graph = value.graph();
    let value = graph.substitute(&[value], &tested.job.bindings());
    let used = graph.variables_of(&value);
    let known: Vec<&(&str, Expr<'g>)> =
        known.iter().filter(|(_, variable)| variable.as_variable().is_some_and(|id| used.contains(&id))).collect();
    let is_curved = known.iter().any(|(name, _)| *name != LEFT);
    let fields = match sample.filter(|_| is_curved) {
        Some(sample) => geometry::fields(tested.job, surface, sample, points),
        None => Vec::new(),
    };
    let column = |(name, _): &&(&str, Expr<'g>)| match *name {
        LEFT => cut::heights(tested.job, surface, points, tested.session),
        _ => fields.iter().find(|field| field.name == *name).and_then(|field| match &field.values {
            Values::Scalars(values) => Some((0..points.len()).map(|k| values.at(k)).collect()),
            Values::Vectors(_) => None,
        }),
    };
    let columns: Vec<Option<Vec<Option<f64>>>> = known.iter().map(column).collect();
    let inputs: Vec<Expr<'g>> =
        surface.surface.unknowns.iter().copied().chain(known.iter().map(|(_, variable)| *variable)).collect();
    let tape = Tape::new(&value, &inputs).expect("a job without errors leaves nothing unbound");
    let (mut evaluator, mut out) = (ScalarEvaluator::new(&tape), [0.0]);
    let at = |(k, point): (usize, &SurfacePoint)| {
        if point.outcome != Outcome::Solved {
            return None;
        }
        let mut input = point.unknowns.clone();
        for column in &columns {
            input.push(column.as_ref()?[k]?);
        }
        evaluator.run(&input, &mut out);
        Some(out[0])
    };
    points.iter().enumerate().map(at).collect()
}

//! Motions along which a tool slides within itself: their equations of meshing say nothing.

use flank_expr::Expr;
use flank_expr::geometry::Surface;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::model::{Parameter, RangedVariable};
use crate::values::context::Context;

use super::Builder;

/// Places at which an equation of meshing is looked at. Any other than zero ends it: most jobs are looked at once.
pub(super) const LOOKS: usize = 50;

/// Of the speed along a motion, what rounding leaves across the surface where nothing moves across it.
const NOTHING: f64 = 1e-9;

/// By how much parameters are changed to see whether it is their values that make an equation zero.
const CHANGE: f64 = 1e-3;

impl<'g> Builder<'_, 'g> {
    /// Reports motions that never move the tool across the surface that it has or sweeps: an error if that is so whatever values the
    /// parameters have, a warning if these values make it so.
    pub(super) fn check_sliding(
        &self,
        context: &mut Context<'g>,
        made: &Surface<'g>,
        unknowns: &[RangedVariable<'g>],
        motions: &[(RangedVariable<'g>, Span)],
        what: &str,
    ) -> bool {
        let mut fine = true;
        let of_motions = made.constraints.iter().zip(&made.unknowns[2..]).skip(made.given);
        for (meshing, unknown) in of_motions {
            let Some((motion, span)) = motions.iter().find(|(motion, _)| motion.variable == *unknown) else { continue };
            let is_zero = |mut values: Vec<f64>| is_zero(*meshing, made, unknowns, motion, &mut values);
            if !is_zero(context.values().to_vec()) {
                continue;
            }
            let always = is_zero(self.changed_values(context));
            fine &= !always;
            context.report(sliding(&motion.name, *span, what, always));
        }
        fine
    }

    /// The values of all variables after those parameters that do not follow from others have changed a little.
    fn changed_values(&self, context: &Context<'g>) -> Vec<f64> {
        let of_machines = self.machines.iter().flat_map(|(_, _, built)| &built.parameters);
        let of_tools = self.tools.iter().flat_map(|(_, _, built)| &built.parameters);
        let mut parameters: Vec<&Parameter<'g>> = self.parameters.iter().chain(of_machines).chain(of_tools).collect();
        parameters.sort_by_key(|parameter| parameter.variable.as_variable());
        let mut values = context.values().to_vec();
        for (k, parameter) in parameters.into_iter().enumerate() {
            let Some(variable) = parameter.variable.as_variable() else { continue };
            let follows = !context.variables_of(&[parameter.definition]).is_empty();
            values[variable.index()] = match follows {
                true => context.graph.evaluate(&[parameter.definition], &values)[0],
                false => parameter.value + CHANGE * (1.0 + share(k, 0)) * parameter.value.abs().max(1.0),
            };
        }
        values
    }
}

fn sliding(motion: &str, span: Span, what: &str, always: bool) -> Diagnostic {
    let (code, when, help) = match always {
        true => (
            Code::IdleMotion,
            "",
            "drive an axis with it that moves the tool across its surface, or leave it out of `over:` and the laws of axes",
        ),
        false => (
            Code::Sliding,
            ", with these values",
            "its points cannot be solved: change the values, or leave the motion out",
        ),
    };
    let message = format!("{what} only slides within itself along `{motion}`{when}");
    Diagnostic::new(code, span, message).help(help)
}

/// Whether an equation of meshing is zero wherever the unknowns lie in their ranges.
fn is_zero<'g>(
    meshing: Expr<'g>,
    made: &Surface<'g>,
    unknowns: &[RangedVariable<'g>],
    motion: &RangedVariable<'g>,
    values: &mut [f64],
) -> bool {
    let step = CHANGE * (motion.high - motion.low);
    let [x, y, z] = made.position.0;
    (0..LOOKS).all(|look| {
        for (j, unknown) in unknowns.iter().enumerate() {
            *value(values, unknown) = unknown.low + (unknown.high - unknown.low) * share(look, j);
        }
        let here = meshing.graph().evaluate(&[meshing, x, y, z], values);
        *value(values, motion) += step;
        let there = meshing.graph().evaluate(&[x, y, z], values);
        let way = here[1..].iter().zip(&there).map(|(from, to)| (to - from).powi(2)).sum::<f64>().sqrt();
        here[0].abs() <= NOTHING * way / step
    })
}

pub(super) fn value<'v>(values: &'v mut [f64], unknown: &RangedVariable<'_>) -> &'v mut f64 {
    &mut values[unknown.variable.as_variable().expect("unknowns are variables").index()]
}

/// Shares between 0 and 1 that fill each direction evenly and do not fall on middles, where surfaces have their axes.
pub(super) fn share(look: usize, direction: usize) -> f64 {
    ((look + 1) as f64 * (direction as f64 + 2.0).powf(1.0 / 3.0) * std::f64::consts::E.sqrt()).fract()
}

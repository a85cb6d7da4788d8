//! Axes that leave their travel while the surfaces are made.

use std::collections::HashMap;
use std::fmt::Write;

use flank_chain_dsl::Job;
use flank_expr::{Expr, VariableId};
use flank_solver::{Range, extent};

use crate::table::Solved;
use crate::units;

/// One line for each axis that moves beyond its travel over the motions that the solved points need; empty if none does.
pub(crate) fn beyond(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> String {
    let over = reached(job, solved);
    let bindings = job.bindings();
    let mut out = String::new();
    for machine in &job.machines {
        for axis in &machine.axes {
            let Some((low, high)) = axis.travel else { continue };
            // an axis whose motion no solved point has is at no place that could be told
            let Ok(Some(found)) = extent(axis.law, &over, &bindings) else { continue };
            // rounding of the law itself
            let slack = 1e-9 * (high - low);
            if found.low < low - slack || found.high > high + slack {
                let unit = units::symbol(axis.dimension);
                let [from, to, low, high] =
                    [found.low, found.high, low, high].map(|value| units::shown(axis.dimension, value));
                let _ = writeln!(
                    out,
                    "beyond its travel: axis {}.{} runs from {from:.4} to {to:.4} {unit}, its travel is {low:.4} to {high:.4} {unit}",
                    machine.name, axis.name
                );
            }
        }
    }
    out
}

/// The motions with the ranges that the solved points of all surfaces need.
pub(crate) fn reached<'g>(job: &Job<'g>, solved: &[Solved<'_, 'g>]) -> Vec<(Expr<'g>, Range)> {
    let mut ends: HashMap<Option<VariableId>, Range> = HashMap::new();
    for surface in solved {
        for (k, unknown) in surface.surface.unknowns.iter().enumerate() {
            let Some((low, high)) = surface.summary.unknowns[k].0 else { continue };
            let range = ends.entry(unknown.variable.as_variable()).or_insert(Range { low, high });
            *range = Range { low: range.low.min(low), high: range.high.max(high) };
        }
    }
    let range = |variable: Expr<'g>| ends.get(&variable.as_variable()).map(|range| (variable, *range));
    job.motions.iter().filter_map(|motion| range(motion.variable)).collect()
}

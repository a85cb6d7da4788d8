//! How far axes go while the surfaces are made, and which leave their travel.

use std::collections::HashMap;

use flank_chain_dsl::{Axis, Job};
use flank_export::fixed;
use flank_expr::{Expr, VariableId};
use flank_solver::{Range, extent};

use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;
use crate::solve::solved::Solved;

/// An axis is beyond its travel if it is so by more than this share of it: laws of some hundred operations on numbers of the size of the
/// travel round by far less, and no scale of a machine shows it.
const SLACK: f64 = 1e-9;

/// How far an axis goes over the motions that the solved points need.
pub(crate) struct Run<'j, 'g> {
    pub(crate) axis: &'j Axis<'g>,
    machine: &'j str,
    /// mm or radians; `None` if no solved point has its motion.
    pub(crate) over: Option<Range>,
}

/// All axes of a job, in the order of its machines.
pub(crate) fn runs<'j, 'g>(job: &'j Job<'g>, solved: &[Solved<'_, 'g>]) -> Vec<Run<'j, 'g>> {
    let over = reached(job, solved);
    let bindings = job.bindings();
    let axes = job.machines.iter().flat_map(|machine| machine.axes.iter().map(|axis| (machine.name.as_str(), axis)));
    let run = |(machine, axis): (&'j str, &'j Axis<'g>)| {
        let law = axis.law.graph().substitute(&[axis.law], &bindings)[0];
        Run { axis, machine, over: extent(law, &over).ok().flatten() }
    };
    axes.map(run).collect()
}

impl<'j> Run<'j, '_> {
    /// As the job calls it: `m.X`.
    pub(crate) fn name(&self) -> String {
        format!("{}.{}", self.machine, self.axis.name)
    }

    /// The machine that it is an axis of.
    pub(crate) fn machine(&self) -> &'j str {
        self.machine
    }

    /// Whether it leaves its travel; `None` if it has none, or no known place.
    pub(crate) fn is_beyond(&self) -> Option<bool> {
        let (found, (low, high)) = self.over.zip(self.axis.travel)?;
        let slack = SLACK * (high - low);
        Some(found.low < low - slack || found.high > high + slack)
    }
}

/// Each axis that moves beyond its travel over the motions that the solved points need.
pub(crate) fn beyond(job: &Job<'_>, solved: &[Solved<'_, '_>]) -> Vec<NotDone> {
    let mut all = Vec::new();
    for run in runs(job, solved).iter().filter(|run| run.is_beyond() == Some(true)) {
        let (Some(found), Some((low, high))) = (run.over, run.axis.travel) else { continue };
        let dimension = run.axis.dimension;
        // in the unit that the machine says it in
        let own = run.axis.travel_unit.as_ref();
        let unit = own.map_or(units::symbol(dimension), |own| own.name.as_str());
        let digits = |value: f64| match own {
            Some(own) => fixed(value / own.size, 4),
            None => units::digits(dimension, value, 4),
        };
        let [from, to, low, high] = [found.low, found.high, low, high].map(digits);
        let name = run.name();
        let message = format!(
            "beyond its travel: axis {name} runs from {from} to {to} {unit}, its travel is {low} to {high} {unit}"
        );
        all.push(NotDone::new(NotDoneKind::BeyondTravel, &name, message));
    }
    all
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

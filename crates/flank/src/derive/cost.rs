//! How many operations the equations of a point take.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::Expr;
use flank_solver::System;

use crate::derive::result::{Operations, SurfaceCost};

impl SurfaceCost {
    /// None if no points are asked for.
    pub(super) fn of(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Option<SurfaceCost> {
        let sample = surface.sample.as_ref()?;
        let parts = &surface.surface;
        let graph = sample.coordinates[0].value.graph();
        let targets = [graph.variable("target 1"), graph.variable("target 2")];
        let on_target = sample.coordinates.iter().zip(targets).map(|(coordinate, target)| coordinate.value - target);
        let residuals: Vec<Expr<'_>> = parts.constraints.iter().copied().chain(on_target).collect();
        let is_motion = |unknown: &Expr<'_>| job.motions.iter().any(|motion| motion.variable == *unknown);
        let stages = parts.unknowns.iter().map(|unknown| if is_motion(unknown) { 1 } else { 2 }).chain([2, 2]);

        let settings: Vec<Expr<'_>> = job.parameters.iter().map(|parameter| parameter.variable).collect();
        let inputs: Vec<Expr<'_>> = targets.into_iter().chain(settings.iter().copied()).collect();
        let open = System::new(&residuals, &parts.unknowns, &inputs).ok()?;
        let of_spec = open.tape().cost(&stages.clone().chain(settings.iter().map(|_| 0)).collect::<Vec<usize>>())[0];

        let bound = graph.substitute(&residuals, &job.bindings());
        let system = System::new(&bound, &parts.unknowns, &targets).ok()?;
        let costs = system.tape().cost(&stages.collect::<Vec<usize>>());
        Some(SurfaceCost {
            name: surface.name.clone(),
            equations: residuals.len(),
            per_spec: Operations::from(&of_spec),
            per_motion_value: Operations::from(&costs[1]),
            per_point: Operations::from(&costs[2]),
        })
    }
}

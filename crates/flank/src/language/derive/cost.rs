//! How many operations the equations of a point take.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::Expr;
use flank_solver::BoundSurface;

use crate::language::derive::result::{Operations, SurfaceCost};
use crate::solve::{bound, ranges};

impl SurfaceCost {
    /// None if no points are asked for.
    pub(super) fn of_surface(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Option<SurfaceCost> {
        let sample = surface.sample.as_ref()?;
        let coordinates = sample.functions();
        let is_motion = |unknown: &Expr<'_>| job.motions.iter().any(|motion| motion.variable == *unknown);
        let stages =
            surface.surface.unknowns.iter().map(|unknown| if is_motion(unknown) { 1 } else { 2 }).chain([2, 2]);

        let settings: Vec<Expr<'_>> = job.parameters.iter().map(|parameter| parameter.variable).collect();
        let open = BoundSurface::new(&surface.surface, ranges(surface), &[]);
        let open = open.square_system(coordinates, &settings).ok()?;
        let of_spec = open.tape().cost(&stages.clone().chain(settings.iter().map(|_| 0)).collect::<Vec<usize>>())[0];

        let system = bound(job, surface).square_system(coordinates, &[]).ok()?;
        let costs = system.tape().cost(&stages.collect::<Vec<usize>>());
        Some(SurfaceCost {
            name: surface.name.clone(),
            equations: system.size(),
            per_spec: Operations::from(&of_spec),
            per_motion_value: Operations::from(&costs[1]),
            per_point: Operations::from(&costs[2]),
        })
    }
}

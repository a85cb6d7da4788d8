//! The surfaces of a job as problems for the solver.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::Expr;
use flank_solver::{BoundSurface, Range, SurfaceFamily, SurfaceProblem};

use crate::project::session::Session;
use crate::project::units;

/// A surface with the values of the job's parameters.
pub(crate) fn bound<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>) -> BoundSurface<'g> {
    BoundSurface::new(&surface.surface, ranges(surface), &job.bindings())
}

/// Where the unknowns of a surface are looked for.
pub(crate) fn ranges(surface: &GeneratedSurface<'_>) -> Vec<Range> {
    surface.unknowns.iter().map(|unknown| Range { low: unknown.low, high: unknown.high }).collect()
}

/// Where a surface is followed beyond its ranges: farther on, through a whole turn at least. What is counted goes no farther.
pub(crate) fn followed(surface: &GeneratedSurface<'_>) -> Vec<Range> {
    let wider = surface.unknowns.iter().zip(ranges(surface)).map(|(unknown, range)| match unknown.is_count {
        true => range,
        false => range.beyond(if units::is_angle(unknown.dimension) { std::f64::consts::TAU } else { 0.0 }),
    });
    wider.collect()
}

/// What the sample of a surface keeps, and where.
pub(crate) fn kept<'g>(surface: &GeneratedSurface<'g>) -> Vec<(Expr<'g>, Range)> {
    let kept = surface.sample.iter().flat_map(|sample| &sample.keep);
    kept.map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect()
}

/// Points of a surface at values of two coordinates, on the branch that its sample keeps.
pub(crate) fn problem<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    coordinates: [Expr<'g>; 2],
    session: Session,
) -> SurfaceProblem {
    on_any_branch(job, surface, coordinates, session)
        .keeping(&bound(job, surface), &kept(surface))
        .expect("a job without errors leaves nothing unbound")
}

/// Settings that stay open with their first numbers, and the values of all other parameters.
type OpenSettings<'a, 'g> = (&'a [(Expr<'g>, f64)], &'a [(Expr<'g>, Expr<'g>)]);

/// Such points while settings are open.
pub(crate) fn family<'g>(
    surface: &GeneratedSurface<'g>,
    coordinates: [Expr<'g>; 2],
    (settings, bindings): OpenSettings<'_, 'g>,
    session: Session,
) -> SurfaceFamily {
    let bound = BoundSurface::new(&surface.surface, ranges(surface), bindings);
    let made = SurfaceFamily::new(&bound, coordinates, settings, |problem| {
        problem
            .following_beyond(followed(surface))
            .with_instruction_set(session.instructions())
            .boxes(session.boxes())
            .keeping(&bound, &kept(surface))
    });
    made.expect("a job without errors leaves nothing unbound")
}

/// Points of a surface, whatever its sample keeps.
pub(super) fn on_any_branch<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    coordinates: [Expr<'g>; 2],
    session: Session,
) -> SurfaceProblem {
    let problem = SurfaceProblem::new(&bound(job, surface), coordinates)
        .expect("a job without errors leaves nothing unbound")
        .following_beyond(followed(surface))
        .with_instruction_set(session.instructions())
        .boxes(session.boxes());
    if session.tells_others() { problem } else { problem.points_alone() }
}

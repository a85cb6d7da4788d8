//! Where the blank of a solid ends: points of its surfaces beyond it are none of the body.

use flank_chain_dsl::{GeneratedSurface, Job, OutlineCurve, Solid, SolidForm};
use flank_solver::{Arrangement, CutBy, Outcome, Outline, OutlineSegment, SurfacePoint};

/// The solid to whose tooth spaces a surface belongs.
pub(crate) fn of<'j>(job: &'j Job<'_>, surface: &GeneratedSurface<'_>) -> Option<&'j Solid> {
    job.solids.iter().find(|solid| solid.space.iter().any(|at| job.surfaces[*at].name == surface.name))
}

/// How the spaces of a solid follow each other, as the solver takes it.
pub(crate) fn arrangement(solid: &Solid) -> Arrangement {
    match solid.form {
        SolidForm::Turned => Arrangement::Round,
        SolidForm::Extruded { pitch } => Arrangement::Straight { pitch },
    }
}

/// The outline of a solid as the solver takes it.
pub(crate) fn outline(solid: &Solid) -> Outline {
    let segment = |segment: &flank_chain_dsl::OutlineSegment| OutlineSegment {
        name: segment.name.clone(),
        from: segment.from,
        to: segment.to,
        center: match segment.curve {
            OutlineCurve::Line => None,
            OutlineCurve::Arc { center } => Some(center),
        },
    };
    Outline::new(solid.outline.iter().map(segment).collect())
}

/// Marks the solved points of a surface that lie beyond the outline of its solid.
pub(crate) fn cut(job: &Job<'_>, surface: &GeneratedSurface<'_>, points: &mut [SurfacePoint]) {
    if let Some(solid) = of(job, surface) {
        cut_by(solid, points);
    }
}

/// The same for the blank of a solid.
pub(crate) fn cut_by(solid: &Solid, points: &mut [SurfacePoint]) {
    let (outline, arrangement) = (outline(solid), arrangement(solid));
    for point in points.iter_mut().filter(|point| point.outcome == Outcome::Solved) {
        if let Some((segment, _)) = outline.beyond(arrangement.section(point.position)) {
            point.outcome = Outcome::CutAway(CutBy::Blank(segment));
        }
    }
}

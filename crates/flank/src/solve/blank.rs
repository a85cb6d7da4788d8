//! Where the blank of a solid ends: points of its surfaces beyond it are none of the body.

use flank_chain_dsl::{Contact, GeneratedSurface, Job, OutlineCurve, Solid, SolidForm};
use flank_export::Layout;
use flank_solver::{Alignment, Arrangement, CutBy, Outcome, Outline, OutlineSegment, SurfacePoint};

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

/// In which motion the place of the body with a surface is unknown. It is a shift along y where a solid in the surface's frame has its spaces
/// beside each other, or a contact moves that frame along y and does not turn it; a turn otherwise.
pub(crate) fn alignment(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Alignment {
    let solids = job.solids.iter().filter(|solid| solid.frame == surface.frame);
    let is_bar = |solid: &Solid| arrangement(solid).alignment() == Alignment::Shift;
    let members = job.contacts.iter().flat_map(|contact| [0, 1].map(|member| (contact, member)));
    let mut own = members.filter(|(contact, member)| job.surfaces[contact.surfaces[*member]].frame == surface.frame);
    let is_shifted = |(contact, member): (&Contact<'_>, usize)| {
        let twist = contact.placements[member].twist(contact.roll.variable);
        let [x, y, z] = twist.linear.0;
        twist.angular.0.into_iter().chain([x, z]).all(|part| part.is_zero()) && !y.is_zero()
    };
    match solids.clone().next() {
        Some(_) if solids.clone().any(is_bar) => Alignment::Shift,
        None if own.any(is_shifted) => Alignment::Shift,
        _ => Alignment::Turn,
    }
}

/// How spaces lie beside each other on the body with a surface, and where its tips are: a bar has them where its outline's `tip` is.
pub(crate) fn layout(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Layout {
    if alignment(job, surface) == Alignment::Turn {
        return Layout::Round;
    }
    let mut outlines = job.solids.iter().filter(|solid| solid.frame == surface.frame).map(|solid| &solid.outline);
    let tips_to_x = outlines.find_map(|outline| {
        let height = |segment: &flank_chain_dsl::OutlineSegment| 0.5 * (segment.from[1] + segment.to[1]);
        let tip = outline.iter().find(|segment| segment.name == "tip")?;
        Some(height(tip) > outline.iter().map(height).sum::<f64>() / outline.len() as f64)
    });
    Layout::Straight { tips_to_x }
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

//! Points of the solver as points of files.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job};
use flank_export::{Axis, Outcome, Patch, Point, Unit, Unknown};
use flank_solver::{CutBy, SurfacePoint};

use crate::solve::{blank, reasons};

/// A grid of points of a surface, without further fields.
pub(crate) fn patch(
    job: &Job<'_>,
    name: &str,
    surface: &GeneratedSurface<'_>,
    [rows, columns]: [Axis; 2],
    points: &[SurfacePoint],
) -> Patch {
    let unknowns = surface.unknowns.iter();
    Patch {
        name: name.to_string(),
        frame: surface.frame.clone(),
        layout: blank::layout(job, surface),
        rows,
        columns,
        unknowns: unknowns.map(|u| Unknown { name: u.name.clone(), unit: unit(u.dimension) }).collect(),
        points: points.iter().map(|solved| point(job, surface, solved)).collect(),
        fields: Vec::new(),
    }
}

pub(crate) fn unit(dimension: Dimension) -> Unit {
    match dimension {
        Dimension::LENGTH => Unit::Millimetre,
        Dimension::ANGLE => Unit::Degree,
        _ => Unit::One,
    }
}

pub(crate) fn point(job: &Job<'_>, surface: &GeneratedSurface<'_>, solved: &SurfacePoint) -> Point {
    placed(solved, reasons::of_point(job, surface, solved.outcome))
}

/// With the reason why it is not solved, or an empty one.
pub(crate) fn placed(solved: &SurfacePoint, reason: String) -> Point {
    // a point that is cut away may be one where the surface has no normal
    let has_numbers = || solved.position.iter().chain(&solved.normal).all(|number| number.is_finite());
    let outcome = match solved.outcome {
        flank_solver::Outcome::Solved => Outcome::Solved,
        flank_solver::Outcome::CutAway(CutBy::Other(_) | CutBy::Blank(_)) if has_numbers() => Outcome::Trimmed,
        flank_solver::Outcome::CutAway(_) if has_numbers() => Outcome::Undercut,
        flank_solver::Outcome::Undecided if has_numbers() => Outcome::Undecided,
        other => return Point::unsolved(other.word(), solved.residual, reason),
    };
    let SurfacePoint { position, normal, unknowns, residual, .. } = solved;
    Point { outcome, position: *position, normal: *normal, unknowns: unknowns.clone(), residual: *residual, reason }
}

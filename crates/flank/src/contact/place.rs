//! Places on the flanks of a contact, and units of its error.

use flank_chain_dsl::{Dimension, GeneratedSurface, SampleGrid};
use flank_solver::{ContactPoint, FlankCorners, FlankDirections, Outcome};

use crate::contact::pair::Members;
use crate::project::units;

/// The corners of a flank, where its sample is one of shares.
pub(crate) fn corners(surface: &GeneratedSurface<'_>) -> Option<FlankCorners> {
    let SampleGrid::Shares { corners, .. } = surface.sample.as_ref()?.grid else { return None };
    Some(FlankCorners(corners))
}

/// Directions of the rows of a member's flank where it touches: of a sample of shares exactly, else those of its points around the nearest
/// one.
pub(crate) fn rows_at(members: &Members<'_, '_>, member: usize, point: &ContactPoint) -> Option<FlankDirections> {
    if let Some(corners) = corners(members.surfaces[member]) {
        return corners.directions(point.in_members[member], point.normals[member]);
    }
    let [rows, columns] = members.surfaces[member].sample.as_ref()?.counts;
    let points = &members.points[member];
    let apart = |at: usize| {
        let off: [f64; 3] = std::array::from_fn(|k| points[at].position[k] - point.in_members[member][k]);
        dot(&off, &off)
    };
    let is_solved = |at: &usize| points[*at].outcome == Outcome::Solved;
    let near = (0..points.len()).filter(is_solved).min_by(|a, b| apart(*a).total_cmp(&apart(*b)))?;
    let (row, column) = (near / columns, near % columns);
    let between = |low: usize, high: usize| -> Option<[f64; 3]> {
        let ends = (is_solved(&low) && is_solved(&high) && low != high).then_some([low, high])?;
        let [a, b] = ends.map(|at| points[at].position);
        unit(std::array::from_fn(|k| b[k] - a[k]))
    };
    let at = |row: usize, column: usize| row * columns + column;
    let lengthwise = between(at(row, column.saturating_sub(1)), at(row, (column + 1).min(columns - 1)))?;
    let up = between(at(row.saturating_sub(1), column), at((row + 1).min(rows - 1), column))?;
    let along = dot(&up, &lengthwise);
    let profilewise = unit(std::array::from_fn(|k| up[k] - along * lengthwise[k]))?;
    Some(FlankDirections { lengthwise, profilewise })
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(&v, &v).sqrt();
    (length > 0.0).then(|| v.map(|x| x / length))
}

pub(crate) fn fine(dimension: Dimension, difference: f64) -> f64 {
    difference * if units::is_angle(dimension) { 1e6 } else { 1e3 }
}

pub(crate) fn fine_unit(dimension: Dimension) -> &'static str {
    if units::is_angle(dimension) { "urad" } else { "um" }
}

pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Shares from root to tip and from toe to heel at a point `[z, rho]`, where the sample of a surface is one of shares.
pub(crate) fn shares(surface: &GeneratedSurface<'_>, point: [f64; 2]) -> Option<[f64; 2]> {
    corners(surface)?.shares(point)
}

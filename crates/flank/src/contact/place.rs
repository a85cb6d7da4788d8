//! Places on the flanks of a contact, and units of its error.

use flank_chain_dsl::{Dimension, GeneratedSurface, SampleGrid};
use flank_solver::{ContactPoint, FlankCorners, FlankDirections, Outcome, Outline, OutlineSegment, SurfacePoint};

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

/// The end of a flank's sample in the axial section, as straight lines between the corners of its grid. `None` where these are not solved, or
/// the grid folds there.
pub(crate) fn sampled(surface: &GeneratedSurface<'_>, points: &[SurfacePoint]) -> Option<Outline> {
    let sample = surface.sample.as_ref()?;
    let [rows, columns] = sample.counts;
    let [row, column] = sample.labels.each_ref().map(|label| sides(label, "the sample's"));
    let at = |row: usize, column: usize| {
        let point = points.get(row * columns + column).filter(|point| point.outcome == Outcome::Solved)?;
        Some([point.position[2], point.position[0].hypot(point.position[1])])
    };
    let around = |[top, bottom]: [usize; 2], [left, right]: [usize; 2]| {
        Some([at(top, left)?, at(top, right)?, at(bottom, right)?, at(bottom, left)?])
    };
    let mut corners = around([0, rows.checked_sub(1)?], [0, columns.checked_sub(1)?])?;
    let is_left = turns(&corners, 1.0);
    let side = if is_left { 1.0 } else { -1.0 };
    let mut cells = (1..rows).flat_map(|row| (1..columns).map(move |column| ([row - 1, row], [column - 1, column])));
    let is_flat = turns(&corners, side)
        && cells.all(|(rows, columns)| around(rows, columns).is_none_or(|cell| turns(&cell, side)));
    let ([first_row, last_row], [first_column, last_column]) = (row, column);
    let mut names = [first_row, last_column, last_row, first_column];
    if !is_left {
        // the flank lies on the left of each side
        corners.reverse();
        names[..3].reverse();
    }
    let segment =
        |(k, name): (usize, String)| OutlineSegment { name, from: corners[k], to: corners[(k + 1) % 4], center: None };
    is_flat.then(|| Outline::new(names.into_iter().enumerate().map(segment).collect()).open())
}

/// Whether four corners turn to one side all around: 1 for the left, -1 for the right.
fn turns(corners: &[[f64; 2]; 4], side: f64) -> bool {
    let turn = |k: usize| {
        let [a, b, c] = [k, k + 1, k + 2].map(|k| corners[k % 4]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    (0..4).all(|k| side * turn(k) > 0.0)
}

/// The two sides between which the rows or the columns of a sample run: `root -> tip`, or the least and the greatest `z` of whose it is.
pub(crate) fn sides(label: &str, of: &str) -> [String; 2] {
    match label.split_once(" -> ") {
        Some((from, to)) => [from.to_string(), to.to_string()],
        None => [format!("{of} first {label}"), format!("{of} last {label}")],
    }
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

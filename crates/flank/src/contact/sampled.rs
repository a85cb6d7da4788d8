//! Where the sample of a flank ends.

use flank_chain_dsl::GeneratedSurface;
use flank_solver::{Outcome, Outline, OutlineSegment, SurfacePoint};

/// The end of a flank's sample in the axial section, as straight lines between the corners of its grid. `None` where these are not solved, or
/// the grid folds there.
pub(crate) fn outline(surface: &GeneratedSurface<'_>, points: &[SurfacePoint]) -> Option<Outline> {
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

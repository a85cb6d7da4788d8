//! Nominal points of tooth flanks as gear measuring machines want them, and what they measured.

mod csv;
mod json;
mod measured;

use schemars::JsonSchema;
use serde::Serialize;

use crate::points::dataset::{Header, Patch, Point};
use crate::shape::{Seen, Sides, is_last, is_thread, sides};
use crate::vector::{Vector, add, sub};

pub use csv::write_grid_csv;
pub(crate) use json::schema as json_schema;
pub use json::write_grid_json;
pub use measured::{Measured, MeasuredFault, MeasuredGrid, MeasuredPoint, read_measured};

/// Nominal points of the flanks of a job.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuringGrid {
    /// Where the data come from.
    pub header: Header,
    /// What is left out at each end of the sampled area: shares of it from root to tip, and along the tooth.
    pub margins: [f64; 2],
    /// One for each surface.
    pub flanks: Vec<NominalFlank>,
}

/// Nominal points of one flank. Rows follow each other from root to tip, of a root or a tip itself from its left side to its right one;
/// columns along the tooth from toe to heel, from the lower face to the upper one, or from the inner end to the outer one, along a thread
/// from the lower end to the upper one.
#[derive(Debug, Clone, PartialEq)]
pub struct NominalFlank {
    /// Which flank of a tooth it is; `None` where its points do not tell.
    pub hand: Option<Hand>,
    /// What the ends are called.
    pub ends: FlankEnds,
    /// The parts that are measured, each a grid of its own; name, frame and points are theirs.
    pub parts: Vec<(NominalPart, Patch)>,
}

/// What is measured at a flank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum NominalPart {
    /// The whole flank.
    Grid,
    /// The line from root to tip in the middle of the tooth's length.
    Profile,
    /// The line along the tooth at the middle of its depth.
    Lead,
    /// The one point in the middle of both: pitch and tooth thickness are measured there.
    Middle,
}

impl NominalPart {
    /// As files have it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            NominalPart::Grid => "grid",
            NominalPart::Profile => "profile",
            NominalPart::Lead => "lead",
            NominalPart::Middle => "middle",
        }
    }
}

/// A flank of a tooth, seen along the tooth from the first column to the last one, with the tip up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hand {
    /// Its normal, out of the material, points to the left.
    Left,
    /// Its normal, out of the material, points to the right.
    Right,
}

impl Hand {
    /// Of a grid whose rows run from root to tip and whose columns run along the tooth; `None` where that does not tell, as at the root
    /// or on a thread.
    #[must_use]
    pub fn of_grid(grid: &Patch) -> Option<Hand> {
        let [rows, columns] = [grid.rows.count, grid.columns.count];
        let solved = |at: [usize; 2]| grid.point(at[0], at[1]).filter(|point| point.is_solved());
        let up = sum((0..columns).filter_map(|j| way((0..rows).filter_map(|i| solved([i, j])))));
        let along = sum((0..rows).filter_map(|i| way((0..columns).filter_map(|j| solved([i, j])))));
        let solved = grid.points.iter().filter(|point| point.is_solved());
        let points = solved.map(|point| (point.position, Some(point.normal)));
        let seen = Seen::along([along, up], points, grid.layout)?;
        let hand = if seen.to_the_right() > 0.0 { Hand::Right } else { Hand::Left };
        (seen.is_flank() && !is_thread(grid)).then_some(hand)
    }

    /// As files have it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Hand::Left => "left",
            Hand::Right => "right",
        }
    }
}

/// From the first point to the last one.
fn way<'p>(mut points: impl DoubleEndedIterator<Item = &'p Point>) -> Option<Vector> {
    let first = points.next()?;
    Some(sub(points.next_back()?.position, first.position))
}

fn sum(all: impl Iterator<Item = Vector>) -> Vector {
    all.fold([0.0; 3], add)
}

/// How the grid of a flank lies on its tooth, and what the ends are called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FlankEnds {
    /// Whether the rows of the grid follow each other from root to tip or back, and not the columns.
    pub rows_are_profile: bool,
    /// Whether the profile begins at the tip or the right side, and the other direction at the heel, the upper face, or the outer or
    /// upper end.
    pub reversed: [bool; 2],
    /// Such as root and tip.
    pub profile: [String; 2],
    /// Such as toe and heel.
    pub length: [String; 2],
}

impl FlankEnds {
    /// Of a grid of solved points: by the labels of its rows and columns, else by the way the flank leans. `None` where they do not tell.
    #[must_use]
    pub fn of_patch(patch: &Patch) -> Option<FlankEnds> {
        let Sides { rows, columns, rows_are_profile } = sides(patch)?;
        let (profile, length) = if rows_are_profile { (rows, columns) } else { (columns, rows) };
        let ordered = |[first, last]: [String; 2]| {
            let reversed = is_last(&first);
            (reversed, if reversed { [last, first] } else { [first, last] })
        };
        let ((profile_reversed, profile), (length_reversed, length)) = (ordered(profile), ordered(length));
        Some(FlankEnds { rows_are_profile, reversed: [profile_reversed, length_reversed], profile, length })
    }
}

/// The points of a part with row and column, which count from 1.
fn places(patch: &Patch) -> impl Iterator<Item = ([usize; 2], &Point)> {
    let columns = patch.columns.count.max(1);
    patch.points.iter().enumerate().map(move |(at, point)| ([at / columns + 1, at % columns + 1], point))
}

/// What a reader must know to use the numbers.
fn sentences(grid: &MeasuringGrid) -> Vec<String> {
    let percent = grid.margins.map(|share| crate::text::number::shortest((share * 1e4).round() / 1e2));
    let own = grid.header.conventions.iter().map(|sentence| crate::text::one_line(sentence));
    [
        "lengths in mm; z of the frame is the axis of the work".to_string(),
        "normals have unit length and point out of the material: a deviation along them is plus where there is too much of it".to_string(),
        "rows count from 1 at the root to the tip, of a root or a tip across it from its left side, columns from 1 at the first end of \
         the tooth's length to the other; points row by row"
            .to_string(),
        "part `grid` is the flank, `profile` the middle column, `lead` the middle row, `middle` the point for pitch and tooth thickness"
            .to_string(),
        "left and right: seen along the tooth from column 1 on, the tip up; of a flank where its normal points to"
            .to_string(),
        format!(
            "left out at each end of the sampled area: {} % of it from root to tip, {} % along the tooth",
            percent[0], percent[1]
        ),
    ]
    .into_iter()
    .chain(own)
    .collect()
}

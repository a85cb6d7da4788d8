//! A measuring grid as JSON.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::{Hand, MeasuringGrid, NominalFlank, NominalPart, places, sentences};
use crate::files::error::WriteError;
use crate::points::dataset::{Patch, Point};
use crate::points::json_layout::{Head, write_document};
use crate::schema::schema_of;
use crate::text::number::plain;

/// Writes a measuring grid as JSON, one point a line, keys in a fixed order.
///
/// # Errors
/// When a part has not as many points as it says, or the stream refuses.
pub fn write_grid_json(grid: &MeasuringGrid, out: &mut dyn Write) -> Result<(), WriteError> {
    /// Document, flanks, flank, parts, part, points.
    const BROKEN: usize = 6;
    for (_, patch) in grid.flanks.iter().flat_map(|flank| &flank.parts) {
        patch.check()?;
    }
    let document = Document {
        head: Head::new(&grid.header, sentences(grid)),
        margins: grid.margins.map(Margin),
        flanks: grid.flanks.iter().map(flank_out).collect(),
    };
    write_document(&document, BROKEN, out)
}

/// The schema of the documents.
pub(crate) fn schema() -> serde_json::Value {
    schema_of::<Document<'_>>()
}

/// Nominal points of tooth flanks for a measuring machine. Lengths are mm. Normals have unit length and point out of the material: a
/// deviation along them is plus where there is too much of it.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.grid/1")]
struct Document<'a> {
    #[serde(flatten)]
    head: Head<'a>,
    /// Shares of the sampled area that are left out at each end: from root to tip, along the tooth.
    margins: [Margin; 2],
    /// In the order of the job.
    flanks: Vec<FlankOut<'a>>,
}

/// A share that is left out at both ends.
#[derive(Serialize, JsonSchema)]
#[schemars(extend("minimum" = 0, "exclusiveMaximum" = 0.5))]
struct Margin(f64);

/// A flank of a tooth.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "NominalFlank")]
struct FlankOut<'a> {
    /// Its name in the job.
    surface: &'a str,
    /// Of positions and normals; its z is the axis of the work.
    frame: &'a str,
    /// Seen along the tooth from the first column on, the tip up; null where the points do not tell.
    flank: Option<Hand>,
    /// What the first and the last row lie at.
    rows: &'a [String; 2],
    /// What the first and the last column lie at.
    columns: &'a [String; 2],
    /// What is measured of it.
    parts: Vec<PartOut>,
}

/// Points of a flank that are measured together.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "NominalPoints")]
struct PartOut {
    /// Which they are.
    part: NominalPart,
    /// Number of rows.
    rows: usize,
    /// Number of columns.
    columns: usize,
    /// Row by row.
    points: Vec<PointOut>,
}

/// A nominal point.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "NominalPoint")]
struct PointOut {
    /// From the root on, from 1.
    #[schemars(range(min = 1))]
    row: usize,
    /// Along the tooth, from 1.
    #[schemars(range(min = 1))]
    column: usize,
    /// `solved`, or why not.
    status: &'static str,
    /// In mm; null where it is not solved.
    position: Option<[f64; 3]>,
    /// Null where it is not solved.
    normal: Option<[f64; 3]>,
}

fn flank_out(flank: &NominalFlank) -> FlankOut<'_> {
    let (surface, frame) =
        flank.parts.first().map_or(("", ""), |(_, patch)| (patch.name.as_str(), patch.frame.as_str()));
    FlankOut {
        surface,
        frame,
        flank: flank.hand,
        rows: &flank.ends.profile,
        columns: &flank.ends.length,
        parts: flank.parts.iter().map(|(part, patch)| part_out(*part, patch)).collect(),
    }
}

fn part_out(part: NominalPart, patch: &Patch) -> PartOut {
    let point_out = |([row, column], point): ([usize; 2], &Point)| PointOut {
        row,
        column,
        status: point.outcome.word(),
        position: point.is_solved().then(|| point.position.map(plain)),
        normal: point.is_solved().then(|| point.normal.map(plain)),
    };
    PartOut {
        part,
        rows: patch.rows.count,
        columns: patch.columns.count,
        points: places(patch).map(point_out).collect(),
    }
}

//! A measuring grid as JSON, by the schema `schemas/grid-1.schema.json`.

use std::io::Write;

use serde::Serialize;

use super::{Hand, MeasuringGrid, NominalFlank, Part, places, sentences};
use crate::files::error::WriteError;
use crate::points::dataset::{Patch, Point};
use crate::points::json_layout::{Head, write_document};
use crate::text::number::plain;

/// Name and version of the JSON schema. A later version is a different word: readers compare it whole.
pub const GRID_SCHEMA: &str = "flank.grid/1";

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
        head: Head::new(GRID_SCHEMA, &grid.header, sentences(grid)),
        margins: grid.margins,
        flanks: grid.flanks.iter().map(flank_out).collect(),
    };
    write_document(&document, BROKEN, out)
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    head: Head<'a>,
    margins: [f64; 2],
    flanks: Vec<FlankOut<'a>>,
}

#[derive(Serialize)]
struct FlankOut<'a> {
    surface: &'a str,
    frame: &'a str,
    flank: Option<&'a str>,
    rows: &'a [String; 2],
    columns: &'a [String; 2],
    parts: Vec<PartOut>,
}

#[derive(Serialize)]
struct PartOut {
    part: &'static str,
    rows: usize,
    columns: usize,
    points: Vec<PointOut>,
}

#[derive(Serialize)]
struct PointOut {
    row: usize,
    column: usize,
    status: &'static str,
    position: Option<[f64; 3]>,
    normal: Option<[f64; 3]>,
}

fn flank_out(flank: &NominalFlank) -> FlankOut<'_> {
    let (surface, frame) =
        flank.parts.first().map_or(("", ""), |(_, patch)| (patch.name.as_str(), patch.frame.as_str()));
    FlankOut {
        surface,
        frame,
        flank: flank.hand.map(Hand::word),
        rows: &flank.ends.profile,
        columns: &flank.ends.length,
        parts: flank.parts.iter().map(|(part, patch)| part_out(*part, patch)).collect(),
    }
}

fn part_out(part: Part, patch: &Patch) -> PartOut {
    let point_out = |([row, column], point): ([usize; 2], &Point)| PointOut {
        row,
        column,
        status: point.outcome.word(),
        position: point.is_solved().then(|| point.position.map(plain)),
        normal: point.is_solved().then(|| point.normal.map(plain)),
    };
    PartOut {
        part: part.word(),
        rows: patch.rows.count,
        columns: patch.columns.count,
        points: places(patch).map(point_out).collect(),
    }
}

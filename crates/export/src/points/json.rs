//! Points as JSON, by the schema `schemas/surfaces-3.schema.json`.

use std::io::{self, Write};

use serde::Serialize;
use serde::ser::{Error, SerializeSeq, Serializer};

use crate::files::error::WriteError;
use crate::points::bands::{Banded, Seen, Surfaces};
use crate::points::conventions::sentences;
use crate::points::dataset::{Axis, Field, Patch, Point, Values};
use crate::points::json_layout::{Head, write_document};
use crate::points::tally::Tally;
use crate::text::number::plain;

/// Name and version of the JSON schema. A later version is a different word: readers compare it whole.
pub const SCHEMA: &str = "flank.surfaces/3";

/// Writes all points as JSON, one point a line, keys in a fixed order.
///
/// Positions are mm, angles degrees. Of a point that is not solved, `fields` is `null`; `position`, `normal` and `unknowns` are, too,
/// unless it is undercut, trimmed or undecided. Of a solved one, a field that is not defined there is.
///
/// The points are asked for twice.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, or the stream refuses.
pub fn write_json(surfaces: &Surfaces<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    /// Document, list of surfaces, surface, list of points.
    const BROKEN: usize = 4;
    let (seen, header) = (Seen::of(surfaces)?, surfaces.header);
    let document = Document {
        head: Head::new(SCHEMA, header, sentences(header)),
        tally: TallyOut::of(&seen.all),
        surfaces: surfaces
            .list
            .iter()
            .zip(&seen.tallies)
            .map(|(surface, tally)| surface_out(*surface, tally))
            .collect(),
    };
    write_document(&document, BROKEN, out)
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    head: Head<'a>,
    #[serde(flatten)]
    tally: TallyOut,
    surfaces: Vec<SurfaceOut<'a>>,
}

#[derive(Serialize)]
struct TallyOut {
    asked: usize,
    solved: usize,
    worst_residual: Option<f64>,
}

#[derive(Serialize)]
struct SurfaceOut<'a> {
    name: &'a str,
    frame: &'a str,
    rows: &'a Axis,
    columns: &'a Axis,
    unknowns: Vec<UnknownOut<'a>>,
    fields: Vec<FieldOut<'a>>,
    #[serde(flatten)]
    tally: TallyOut,
    points: PointsOut<'a>,
}

#[derive(Serialize)]
struct UnknownOut<'a> {
    name: &'a str,
    unit: &'static str,
}

/// What is said of a field before its values.
#[derive(Serialize)]
struct FieldOut<'a> {
    name: &'a str,
    unit: &'a str,
    components: usize,
    meaning: &'a str,
}

#[derive(Serialize)]
#[serde(untagged)]
enum ValueOut {
    Scalar(Option<f64>),
    Vector(Option<[f64; 3]>),
}

#[derive(Serialize)]
struct PointOut<'a> {
    i: usize,
    j: usize,
    status: &'static str,
    position: Option<[f64; 3]>,
    normal: Option<[f64; 3]>,
    unknowns: Option<Vec<f64>>,
    residual: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<&'a str>,
    fields: Option<Vec<ValueOut>>,
}

impl TallyOut {
    fn of(tally: &Tally) -> Self {
        TallyOut { asked: tally.asked, solved: tally.solved, worst_residual: tally.worst_residual }
    }
}

/// The points, one after the other as they are handed over.
struct PointsOut<'a>(&'a dyn Banded);

impl Serialize for PointsOut<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let patch = self.0.outline();
        let mut list = serializer.serialize_seq(Some(patch.rows.count.saturating_mul(patch.columns.count)))?;
        let mut first = 0;
        // what the stream says goes out as it is: its kind is told in words later
        let mut refused = None;
        let handed_over = self.0.bands(&mut |points| {
            for (i, j, point) in patch.numbered(first, points) {
                if let Err(error) = list.serialize_element(&point_out(patch, i, j, point)) {
                    refused = Some(error);
                    return Err(io::Error::from(io::ErrorKind::WriteZero).into());
                }
            }
            first += points.len();
            Ok(())
        });
        match refused {
            Some(error) => return Err(error),
            None => handed_over.map_err(S::Error::custom)?,
        }
        list.end()
    }
}

fn surface_out<'a>(surface: &'a dyn Banded, tally: &Tally) -> SurfaceOut<'a> {
    let patch = surface.outline();
    SurfaceOut {
        name: &patch.name,
        frame: &patch.frame,
        rows: &patch.rows,
        columns: &patch.columns,
        unknowns: patch.unknowns.iter().map(|u| UnknownOut { name: &u.name, unit: u.unit.symbol() }).collect(),
        fields: patch.fields.iter().map(field).collect(),
        tally: TallyOut::of(tally),
        points: PointsOut(surface),
    }
}

fn field(field: &Field) -> FieldOut<'_> {
    FieldOut { name: &field.name, unit: &field.unit, components: field.columns().len(), meaning: &field.meaning }
}

fn value_out(values: &Values, point: usize) -> ValueOut {
    match values {
        Values::Scalars(values) => ValueOut::Scalar(values.at(point).map(plain)),
        Values::Vectors(values) => ValueOut::Vector(values.at(point).map(|vector| vector.map(plain))),
    }
}

fn point_out<'a>(patch: &Patch, i: usize, j: usize, point: &'a Point) -> PointOut<'a> {
    let values =
        || patch.unknowns.iter().zip(&point.unknowns).map(|(u, &value)| plain(u.unit.written(value))).collect();
    let at = i * patch.columns.count + j;
    let fields = || patch.fields.iter().map(|field| value_out(&field.values, at)).collect();
    let is_placed = point.is_placed();
    PointOut {
        i,
        j,
        status: point.outcome.word(),
        position: is_placed.then(|| point.position.map(plain)),
        normal: is_placed.then(|| point.normal.map(plain)),
        unknowns: is_placed.then(values),
        residual: point.known_residual().map(plain),
        reason: Some(&*point.reason).filter(|reason| !reason.is_empty()),
        fields: point.is_solved().then(fields),
    }
}

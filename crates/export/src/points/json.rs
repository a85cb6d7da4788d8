//! Points as JSON.

use std::borrow::Cow;
use std::io::{self, Write};

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Serialize;
use serde::ser::{Error, SerializeSeq, Serializer};

use crate::files::error::WriteError;
use crate::points::bands::{Banded, Seen, Surfaces};
use crate::points::conventions::sentences;
use crate::points::dataset::{Axis, Field, Patch, Point, Unknown, Values};
use crate::points::json_layout::{Head, write_document};
use crate::points::tally::Tally;
use crate::schema::schema_of;
use crate::text::number::plain;

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
    let (seen, header) = (Seen::of_surfaces(surfaces)?, surfaces.header);
    let document = Document {
        head: Head::new(header, sentences(header)),
        tally: TallyOut::of_tally(&seen.all),
        surfaces: surfaces
            .list
            .iter()
            .zip(&seen.tallies)
            .map(|(surface, tally)| surface_out(*surface, tally))
            .collect(),
    };
    write_document(&document, BROKEN, out)
}

/// The schema of the documents.
pub(crate) fn schema() -> serde_json::Value {
    schema_of::<Document<'_>>()
}

/// Solved tooth surfaces: grids of points in named frames. Lengths are mm; angles are degrees, not reduced to one turn. A normal points
/// out of the body that owns the surface.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.surfaces/3")]
struct Document<'a> {
    #[serde(flatten)]
    head: Head<'a>,
    /// Of all surfaces.
    #[serde(flatten)]
    tally: TallyOut,
    /// In the order of the job, then lines on them.
    surfaces: Vec<SurfaceOut<'a>>,
}

/// Points, counted.
#[derive(Serialize, JsonSchema)]
struct TallyOut {
    /// Points asked for.
    asked: usize,
    /// Points solved.
    solved: usize,
    /// Largest absolute residual of a solved point; null where none was solved.
    worst_residual: Option<f64>,
}

/// A grid of points.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenSurface")]
struct SurfaceOut<'a> {
    /// Its name.
    name: &'a str,
    /// Of positions and normals.
    frame: &'a str,
    /// What index i runs over.
    rows: &'a Axis,
    /// What index j runs over.
    columns: &'a Axis,
    /// What the points were solved for.
    unknowns: &'a [Unknown],
    /// What more is known of each solved point.
    fields: Vec<FieldOut<'a>>,
    #[serde(flatten)]
    tally: TallyOut,
    /// Row by row.
    points: PointsOut<'a>,
}

/// The head of a field, before its values.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenField")]
struct FieldOut<'a> {
    /// Its name.
    name: &'a str,
    /// Such as `1/mm`; `1` for a plain number or a direction.
    unit: &'a str,
    /// 1: a number; 3: a vector in the surface's frame.
    #[schemars(extend("enum" = [1, 3]))]
    components: usize,
    /// One sentence, with the sign convention.
    meaning: &'a str,
}

/// The value of a field at a point; null where it is not defined there.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "FieldValue")]
#[serde(untagged)]
enum ValueOut {
    /// Of one component.
    Scalar(Option<f64>),
    /// Of three.
    Vector(Option<[f64; 3]>),
}

/// A point. Position, normal and unknowns are null unless the status is `solved`, `undercut`, `trimmed` or `undecided`.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenPoint")]
struct PointOut<'a> {
    /// Row, from 0.
    i: usize,
    /// Column, from 0.
    j: usize,
    /// `solved`, or why not; a point that is `undercut` or `trimmed` lies on the generated surface, but not on the finished work.
    status: &'static str,
    /// In mm.
    position: Option<[f64; 3]>,
    /// Of unit length.
    normal: Option<[f64; 3]>,
    /// In the order and units of the surface's unknowns.
    unknowns: Option<Vec<f64>>,
    /// The largest absolute one; null where there was nothing to measure.
    residual: Option<f64>,
    /// More on a status other than `solved`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "String")]
    reason: Option<&'a str>,
    /// In the order of the surface's fields, each in its unit; null unless the point is solved.
    fields: Option<Vec<ValueOut>>,
}

impl TallyOut {
    fn of_tally(tally: &Tally) -> Self {
        TallyOut { asked: tally.asked, solved: tally.solved, worst_residual: tally.worst_residual }
    }
}

/// The points, one after the other as they are handed over.
struct PointsOut<'a>(&'a dyn Banded);

impl JsonSchema for PointsOut<'_> {
    fn schema_name() -> Cow<'static, str> {
        <Vec<PointOut<'_>>>::schema_name()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        <Vec<PointOut<'_>>>::json_schema(generator)
    }
}

impl Serialize for PointsOut<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let patch = self.0.outline();
        let mut list = serializer.serialize_seq(Some(patch.rows.count.saturating_mul(patch.columns.count)))?;
        let mut first = 0;
        // what the stream says goes out as it is: its kind is put into words later
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
        unknowns: &patch.unknowns,
        fields: patch.fields.iter().map(field).collect(),
        tally: TallyOut::of_tally(tally),
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

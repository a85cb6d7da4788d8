//! Points as JSON, by the schema `schema/surfaces-2.schema.json`.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::Formatter;

use crate::conventions::sentences;
use crate::dataset::{Axis, Dataset, Field, Patch, Point, Values};
use crate::error::WriteError;
use crate::number::plain;
use crate::tally::Tally;

/// Name and version of the JSON schema. A later version is a different word: readers compare it whole.
pub const SCHEMA: &str = "flank.surfaces/2";

/// Writes all points as JSON, one point a line, keys in a fixed order.
///
/// Positions are mm, angles degrees. Of a point that is not solved, `position`, `normal`, `unknowns`
/// and `fields` are `null`; of a solved one, a field that is not defined there is.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_json(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    let header = &dataset.header;
    let document = Document {
        schema: SCHEMA,
        program: &header.program,
        spec: &header.spec,
        spec_hash: &header.spec_hash,
        job: &header.job,
        conventions: sentences(dataset),
        units: Units { length: "mm", angle: "deg" },
        tally: TallyOut::of(&Tally::of(&dataset.patches)),
        surfaces: dataset.patches.iter().map(surface).collect(),
    };
    let mut serializer = serde_json::Serializer::with_formatter(&mut *out, PointPerLine::default());
    document.serialize(&mut serializer).map_err(io::Error::from)?;
    writeln!(out)?;
    Ok(())
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'a str,
    program: &'a str,
    spec: &'a str,
    spec_hash: &'a str,
    job: &'a str,
    conventions: Vec<String>,
    units: Units,
    #[serde(flatten)]
    tally: TallyOut,
    surfaces: Vec<SurfaceOut<'a>>,
}

#[derive(Serialize)]
struct Units {
    length: &'static str,
    angle: &'static str,
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
    rows: AxisOut<'a>,
    columns: AxisOut<'a>,
    unknowns: Vec<UnknownOut<'a>>,
    fields: Vec<FieldOut<'a>>,
    #[serde(flatten)]
    tally: TallyOut,
    points: Vec<PointOut<'a>>,
}

#[derive(Serialize)]
struct AxisOut<'a> {
    label: &'a str,
    count: usize,
}

#[derive(Serialize)]
struct UnknownOut<'a> {
    name: &'a str,
    unit: &'static str,
}

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

fn surface<'a>(patch: &'a Patch) -> SurfaceOut<'a> {
    let axis = |axis: &'a Axis| AxisOut { label: &axis.label, count: axis.count };
    SurfaceOut {
        name: &patch.name,
        frame: &patch.frame,
        rows: axis(&patch.rows),
        columns: axis(&patch.columns),
        unknowns: patch.unknowns.iter().map(|u| UnknownOut { name: &u.name, unit: u.unit.symbol() }).collect(),
        fields: patch.fields.iter().map(field).collect(),
        tally: TallyOut::of(&Tally::of([patch])),
        points: patch.indexed_points().map(|(i, j, point)| point_out(patch, i, j, point)).collect(),
    }
}

fn field(field: &Field) -> FieldOut<'_> {
    FieldOut { name: &field.name, unit: &field.unit, components: field.columns().len(), meaning: &field.meaning }
}

fn value_out(values: &Values, point: usize) -> ValueOut {
    match values {
        Values::Scalars(values) => ValueOut::Scalar(values[point].map(plain)),
        Values::Vectors(values) => ValueOut::Vector(values[point].map(|vector| vector.map(plain))),
    }
}

fn point_out<'a>(patch: &Patch, i: usize, j: usize, point: &'a Point) -> PointOut<'a> {
    let values =
        || patch.unknowns.iter().zip(&point.unknowns).map(|(u, &value)| plain(u.unit.written(value))).collect();
    let at = i * patch.columns.count + j;
    let fields = || patch.fields.iter().map(|field| value_out(&field.values, at)).collect();
    let solved = point.is_solved();
    PointOut {
        i,
        j,
        status: point.outcome.word(),
        position: solved.then(|| point.position.map(plain)),
        normal: solved.then(|| point.normal.map(plain)),
        unknowns: solved.then(values),
        residual: point.known_residual().map(plain),
        reason: Some(&*point.reason).filter(|reason| !reason.is_empty()),
        fields: solved.then(fields),
    }
}

/// Breaks lines down to the points of a surface and keeps each point on one line: people and `diff` read such a file.
#[derive(Default)]
struct PointPerLine {
    depth: usize,
}

impl PointPerLine {
    /// Document, list of surfaces, surface, list of points: four levels.
    const BROKEN: usize = 4;

    fn open<W: ?Sized + Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth += 1;
        out.write_all(bracket)
    }

    fn close<W: ?Sized + Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth -= 1;
        if self.depth < Self::BROKEN {
            self.new_line(out)?;
        }
        out.write_all(bracket)
    }

    fn next<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        if !first {
            out.write_all(b",")?;
        }
        if self.depth <= Self::BROKEN {
            self.new_line(out)
        } else if first {
            Ok(())
        } else {
            out.write_all(b" ")
        }
    }

    fn new_line<W: ?Sized + Write>(&self, out: &mut W) -> io::Result<()> {
        out.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| out.write_all(b"  "))
    }
}

impl Formatter for PointPerLine {
    fn begin_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"]")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.next(out, first)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.next(out, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}

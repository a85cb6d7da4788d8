//! A motion table as JSON.

use std::io::Write;

use schemars::JsonSchema;
use serde::Serialize;

use super::table::{AS_IN_THE_SPEC, MachineAxis, MotionTable};
use crate::files::error::WriteError;
use crate::points::dataset::{Unit, Unknown};
use crate::points::json_layout::{Head, write_document};
use crate::schema::schema_of;
use crate::text::number::plain;

/// Writes a motion table as JSON, one row a line, keys in a fixed order. Lengths are mm, angles degrees.
///
/// # Errors
/// When the table is malformed, or the stream refuses.
pub fn write_motion_json(table: &MotionTable, out: &mut dyn Write) -> Result<(), WriteError> {
    /// Document, list of rows.
    const BROKEN: usize = 2;
    table.check()?;
    let document = Document {
        head: Head::new(&table.header, table.sentences(AS_IN_THE_SPEC)),
        motion: &table.motion,
        axes: (0..table.axes.len()).map(|index| axis_out(table, index)).collect(),
        series: series_out(table),
        seconds: table.rates.as_ref().map(|rates| plain(rates.seconds)),
        rows: (0..table.rows.len()).map(|index| row_out(table, index)).collect(),
    };
    write_document(&document, BROKEN, out)
}

/// The schema of the documents.
pub(crate) fn schema() -> serde_json::Value {
    schema_of::<Document<'_>>()
}

/// What the axes of a machine do over a motion. Lengths are mm; angles are degrees, not reduced to one turn. Axes are named, signed and
/// counted as in the machine's spec.
#[derive(Serialize, JsonSchema)]
#[serde(tag = "schema", rename = "flank.motion/2")]
struct Document<'a> {
    #[serde(flatten)]
    head: Head<'a>,
    /// What runs.
    motion: &'a Unknown,
    /// Of the machine.
    axes: Vec<AxisOut<'a>>,
    /// The axes as polynomials of the motion, in the units of the rows; null where they are not known.
    series: Option<SeriesOut>,
    /// How long the motion takes, evenly, from the first row to the last one; null where no rates are given.
    seconds: Option<f64>,
    /// In the order in which they are passed.
    rows: Vec<RowOut>,
}

/// An axis with how far it goes.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenAxis")]
struct AxisOut<'a> {
    /// In the machine's spec.
    name: &'a str,
    /// In NC programs.
    address: &'a str,
    /// Of its positions.
    unit: Unit,
    /// Of positions in NC programs.
    decimals: u8,
    /// Smallest position of the rows; null without rows.
    low: Option<f64>,
    /// Largest.
    high: Option<f64>,
    /// What the axis can do, in its unit; null where it is not limited.
    travel: Option<Ends>,
}

/// From where to where, in the unit of what it belongs to.
#[derive(Serialize, JsonSchema)]
struct Ends {
    /// Lower end.
    low: f64,
    /// Upper end.
    high: f64,
}

/// The axes as polynomials.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenSeries")]
struct SeriesOut {
    /// The value of the motion about which they are.
    reference: f64,
    /// In the order of the axes.
    axes: Vec<AxisSeriesOut>,
}

/// An axis as a polynomial.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenAxisSeries")]
struct AxisSeriesOut {
    /// Factors of the powers of the distance from the reference, constant first.
    coefficients: Vec<f64>,
    /// Proven bound of what the polynomial leaves over the range of the rows; null without a proof.
    remainder: Option<f64>,
}

/// The axes at one value of the motion.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "WrittenRow")]
struct RowOut {
    /// Value of the motion.
    motion: f64,
    /// In the order and units of the axes.
    axes: Vec<f64>,
    /// Of each axis velocity, acceleration and jerk, in its unit per s, s^2, s^3; null without a time.
    rates: Option<Vec<[f64; 3]>>,
}

fn axis_out(table: &MotionTable, index: usize) -> AxisOut<'_> {
    let axis = &table.axes[index];
    let ends = |ends| {
        let [low, high] = axis.written(ends);
        Ends { low, high }
    };
    let extent = table.extent(index).map(ends);
    AxisOut {
        name: &axis.name,
        address: &axis.address,
        unit: axis.unit(),
        decimals: axis.decimals,
        low: extent.as_ref().map(|extent| extent.low),
        high: extent.as_ref().map(|extent| extent.high),
        travel: axis.travel.map(ends),
    }
}

fn series_out(table: &MotionTable) -> Option<SeriesOut> {
    let series = table.written_series()?;
    let axes = series.axes.into_iter().map(|axis| AxisSeriesOut {
        coefficients: axis.coefficients.into_iter().map(plain).collect(),
        remainder: axis.remainder.map(plain),
    });
    Some(SeriesOut { reference: plain(series.reference), axes: axes.collect() })
}

fn row_out(table: &MotionTable, index: usize) -> RowOut {
    let row = &table.rows[index];
    let position = |(axis, position): (&MachineAxis, &f64)| plain(axis.unit().written(*position));
    RowOut {
        motion: plain(table.motion.unit.written(row.motion)),
        axes: table.axes.iter().zip(&row.axes).map(position).collect(),
        rates: table.written_rates(index),
    }
}

//! A motion table as JSON, by the schema `schemas/motion-2.schema.json`.

use std::io::Write;

use serde::Serialize;

use super::table::{AS_IN_THE_SPEC, MachineAxis, MotionTable};
use crate::files::error::WriteError;
use crate::points::json_layout::{Head, write_document};
use crate::text::number::plain;

/// Name and version of the JSON schema. A later version is a different word: readers compare it whole.
pub const MOTION_SCHEMA: &str = "flank.motion/2";

/// Writes a motion table as JSON, one row a line, keys in a fixed order. Lengths are mm, angles degrees.
///
/// # Errors
/// When the table is malformed, or the stream refuses.
pub fn write_motion_json(table: &MotionTable, out: &mut dyn Write) -> Result<(), WriteError> {
    /// Document, list of rows.
    const BROKEN: usize = 2;
    table.check()?;
    let document = Document {
        head: Head::new(MOTION_SCHEMA, &table.header, table.sentences(AS_IN_THE_SPEC)),
        motion: MotionOut { name: &table.motion.name, unit: table.motion.unit.symbol() },
        axes: (0..table.axes.len()).map(|index| axis_out(table, index)).collect(),
        series: series_out(table),
        seconds: table.rates.as_ref().map(|rates| plain(rates.seconds)),
        rows: (0..table.rows.len()).map(|index| row_out(table, index)).collect(),
    };
    write_document(&document, BROKEN, out)
}

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    head: Head<'a>,
    motion: MotionOut<'a>,
    axes: Vec<AxisOut<'a>>,
    series: Option<SeriesOut>,
    seconds: Option<f64>,
    rows: Vec<RowOut>,
}

#[derive(Serialize)]
struct MotionOut<'a> {
    name: &'a str,
    unit: &'a str,
}

#[derive(Serialize)]
struct AxisOut<'a> {
    name: &'a str,
    address: &'a str,
    unit: &'a str,
    decimals: u8,
    low: Option<f64>,
    high: Option<f64>,
    travel: Option<Ends>,
}

#[derive(Serialize)]
struct Ends {
    low: f64,
    high: f64,
}

#[derive(Serialize)]
struct SeriesOut {
    reference: f64,
    axes: Vec<AxisSeriesOut>,
}

#[derive(Serialize)]
struct AxisSeriesOut {
    coefficients: Vec<f64>,
    remainder: Option<f64>,
}

#[derive(Serialize)]
struct RowOut {
    motion: f64,
    axes: Vec<f64>,
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
        unit: axis.unit().symbol(),
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

//! Points as a Parquet table.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use crate::files::error::WriteError;
use crate::points::bands::{Seen, Surfaces};
use crate::points::columns::{titles, union_of_fields, union_of_unknowns};
use crate::points::conventions::sentences;
use crate::points::dataset::{Field, Outcome, Patch, Point, Unknown};
use crate::text::number::plain;

/// Rows that are held in memory before they are written.
const GROUP: usize = 1 << 16;

/// Writes all points as a Parquet table with the columns of the CSV file ([`write_csv`](crate::write_csv)), not compressed. Numbers that a
/// point does not have are null. The file's metadata state the conventions and what each surface, unknown and field is.
///
/// The points are asked for twice; 65,536 of them are held at a time.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, or the stream refuses.
pub fn write_parquet(surfaces: &Surfaces<'_>, out: &mut (impl Write + Send + ?Sized)) -> Result<(), WriteError> {
    let seen = Seen::of_surfaces(surfaces)?;
    let columns = columns(surfaces, seen.told);
    let unknowns = union_of_unknowns(surfaces.outlines());
    let fields = union_of_fields(surfaces.outlines());
    let titles = titles(&unknowns, seen.told, &fields);
    let kinds = titles.iter().zip(&columns).map(|(title, column)| column.kind(title));
    let schema = Type::group_type_builder("points").with_fields(kinds.collect::<Result<_, _>>()?).build()?;
    let facts = facts(surfaces, &seen).into_iter().map(|(key, value)| KeyValue::new(key, value)).collect();
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::UNCOMPRESSED)
        // hardly a number is there twice
        .set_dictionary_enabled(false)
        .set_created_by(surfaces.header.program.clone())
        .set_key_value_metadata(Some(facts));
    for (title, _) in titles.iter().zip(&columns).filter(|(_, column)| column.repeats()) {
        properties = properties.set_column_dictionary_enabled(vec![title.clone()].into(), true);
    }
    let mut file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build()))?;
    for surface in &surfaces.list {
        let patch = surface.outline();
        let (mut held, mut first) = (Vec::new(), 0);
        surface.bands(&mut |mut points| {
            while !points.is_empty() {
                let (taken, left) = points.split_at(points.len().min(GROUP - held.len()));
                held.extend_from_slice(taken);
                points = left;
                if held.len() == GROUP {
                    write_group(&columns, patch, first, &held, &mut file)?;
                    first += held.len();
                    held.clear();
                }
            }
            Ok(())
        })?;
        write_group(&columns, patch, first, &held, &mut file)?;
    }
    file.close()?;
    Ok(())
}

/// Writes some points, the first of which has this number.
fn write_group<W: Write + Send>(
    columns: &[Column<'_>],
    patch: &Patch,
    first: usize,
    points: &[Point],
    file: &mut SerializedFileWriter<W>,
) -> Result<(), WriteError> {
    if points.is_empty() {
        return Ok(());
    }
    let mut group = file.next_row_group()?;
    columns.iter().try_for_each(|column| column.write(patch, first, points, &mut group))?;
    group.close()?;
    Ok(())
}

/// What a column holds.
enum Column<'a> {
    Surface,
    I,
    J,
    Position(usize),
    Normal(usize),
    Unknown(&'a Unknown),
    Residual,
    Status,
    Reason,
    Field(&'a Field, usize),
}

/// The number of a point, if it has one.
type Numbers<'p> = Box<dyn Fn(usize, &Point) -> Option<f64> + 'p>;

/// The columns in the order of their titles.
fn columns<'b>(surfaces: &Surfaces<'b>, told: bool) -> Vec<Column<'b>> {
    let mut columns = vec![Column::Surface, Column::I, Column::J];
    columns.extend((0..3).map(Column::Position).chain((0..3).map(Column::Normal)));
    columns.extend(union_of_unknowns(surfaces.outlines()).into_iter().map(Column::Unknown));
    columns.extend([Column::Residual, Column::Status]);
    columns.extend(told.then_some(Column::Reason));
    let fields = union_of_fields(surfaces.outlines()).into_iter();
    columns.extend(fields.flat_map(|field| (0..field.columns().len()).map(move |k| Column::Field(field, k))));
    columns
}

impl Column<'_> {
    fn kind(&self, title: &str) -> Result<Arc<Type>, ParquetError> {
        let (physical, repetition, logical) = match self {
            Column::Surface | Column::Status | Column::Reason => {
                (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String))
            }
            Column::I | Column::J => (Physical::INT32, Repetition::REQUIRED, None),
            _ => (Physical::DOUBLE, Repetition::OPTIONAL, None),
        };
        let column =
            Type::primitive_type_builder(title, physical).with_repetition(repetition).with_logical_type(logical);
        Ok(Arc::new(column.build()?))
    }

    /// Whether it has few values, again and again.
    fn repeats(&self) -> bool {
        matches!(self, Column::Surface | Column::I | Column::Status | Column::Reason)
    }

    fn write<W: Write + Send>(
        &self,
        patch: &Patch,
        first: usize,
        points: &[Point],
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else { return Ok(()) };
        let mut texts = |texts: Vec<ByteArray>| column.typed::<ByteArrayType>().write_batch(&texts, None, None);
        match self {
            Column::Surface => {
                texts(vec![patch.name.as_str().into(); points.len()])?;
            }
            Column::Status => {
                let solved = ByteArray::from(Outcome::Solved.word());
                let word = |point: &Point| if point.is_solved() { solved.clone() } else { point.outcome.word().into() };
                texts(points.iter().map(word).collect())?;
            }
            Column::Reason => {
                texts(points.iter().map(|point| point.reason.as_str().into()).collect())?;
            }
            Column::I | Column::J => {
                let columns = patch.columns.count;
                let index = |at| if matches!(self, Column::I) { at / columns } else { at % columns };
                let indices: Vec<i32> = (first..first + points.len()).map(|at| index(at) as i32).collect();
                column.typed::<Int32Type>().write_batch(&indices, None, None)?;
            }
            _ => {
                let number = self.numbers(patch);
                let numbers: Vec<Option<f64>> = (first..).zip(points).map(|(at, point)| number(at, point)).collect();
                let levels: Vec<i16> = numbers.iter().map(|number| i16::from(number.is_some())).collect();
                let known: Vec<f64> = numbers.into_iter().flatten().map(plain).collect();
                column.typed::<DoubleType>().write_batch(&known, Some(&levels), None)?;
            }
        }
        column.close()
    }

    /// The numbers that the points of the patch have in this column.
    fn numbers<'p>(&'p self, patch: &'p Patch) -> Numbers<'p> {
        match self {
            Column::Position(k) => Box::new(|_, point| point.is_placed().then(|| point.position[*k])),
            Column::Normal(k) => Box::new(|_, point| point.is_placed().then(|| point.normal[*k])),
            Column::Residual => Box::new(|_, point| point.known_residual()),
            Column::Unknown(unknown) => {
                let place = patch.unknowns.iter().position(|own| own == *unknown);
                Box::new(move |_, point| {
                    place.filter(|_| point.is_placed()).map(|place| unknown.unit.written(point.unknowns[place]))
                })
            }
            Column::Field(field, k) => {
                let own = patch.fields.iter().find(|own| own.shares_columns(field));
                Box::new(move |at, point| {
                    own.filter(|_| point.is_solved()).and_then(|own| own.values.at(at).get(*k).copied())
                })
            }
            _ => Box::new(|_, _| None),
        }
    }
}

/// What the file says about itself.
fn facts(surfaces: &Surfaces<'_>, seen: &Seen) -> Vec<(String, String)> {
    let header = surfaces.header;
    let mut facts = vec![
        ("spec".to_owned(), format!("{}, hash {}", header.spec, header.spec_hash)),
        ("job".to_owned(), header.job.clone()),
        ("conventions".to_owned(), sentences(header).join("; ")),
    ];
    let unknowns = union_of_unknowns(surfaces.outlines()).into_iter();
    facts.extend(unknowns.map(|unknown| (format!("unknown {}", unknown.name), unknown.unit.symbol().to_owned())));
    let fields = union_of_fields(surfaces.outlines()).into_iter();
    facts.extend(fields.map(|field| (format!("field {}", field.name), format!("{}: {}", field.unit, field.meaning))));
    let told = surfaces.outlines().zip(&seen.tallies);
    facts.extend(told.map(|(patch, tally)| (format!("surface {}", patch.name), patch.told(tally))));
    facts
}

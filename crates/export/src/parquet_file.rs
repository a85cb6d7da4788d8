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

use crate::columns::{titles, union_of_fields, union_of_unknowns};
use crate::conventions::sentences;
use crate::dataset::{Dataset, Field, Patch, Point, Unknown};
use crate::error::WriteError;
use crate::number::plain;
use crate::tally::Tally;

/// Rows that are held in memory before they are written.
const GROUP: usize = 1 << 16;

/// Writes all points as a Parquet table with the columns of the CSV file ([`write_csv`](crate::write_csv)), not compressed. Numbers that a
/// point does not have are null. The file's metadata state the conventions and what each surface, unknown and field is.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_parquet(dataset: &Dataset, out: &mut (dyn Write + Send)) -> Result<(), WriteError> {
    dataset.check()?;
    let told = dataset.has_reasons();
    let columns = columns(dataset, told);
    let unknowns = union_of_unknowns(&dataset.patches);
    let fields = union_of_fields(&dataset.patches);
    let kinds = titles(&unknowns, told, &fields).into_iter().zip(&columns).map(|(title, column)| column.kind(&title));
    let schema = Type::group_type_builder("points").with_fields(kinds.collect::<Result<_, _>>()?).build()?;
    let facts = facts(dataset).into_iter().map(|(key, value)| KeyValue::new(key, value)).collect();
    let properties = WriterProperties::builder()
        .set_compression(Compression::UNCOMPRESSED)
        .set_created_by(dataset.header.program.clone())
        .set_key_value_metadata(Some(facts));
    let mut file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build()))?;
    for patch in &dataset.patches {
        for start in (0..patch.points.len()).step_by(GROUP) {
            let rows = start..patch.points.len().min(start + GROUP);
            let mut group = file.next_row_group()?;
            columns.iter().try_for_each(|column| column.write(patch, rows.clone(), &mut group))?;
            group.close()?;
        }
    }
    file.close()?;
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
fn columns(dataset: &Dataset, told: bool) -> Vec<Column<'_>> {
    let mut columns = vec![Column::Surface, Column::I, Column::J];
    columns.extend((0..3).map(Column::Position).chain((0..3).map(Column::Normal)));
    columns.extend(union_of_unknowns(&dataset.patches).into_iter().map(Column::Unknown));
    columns.extend([Column::Residual, Column::Status]);
    columns.extend(told.then_some(Column::Reason));
    let fields = union_of_fields(&dataset.patches).into_iter();
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

    fn write<W: Write + Send>(
        &self,
        patch: &Patch,
        rows: std::ops::Range<usize>,
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else { return Ok(()) };
        let points = || rows.clone().map(|at| (at, &patch.points[at]));
        let mut texts = |text: &dyn Fn(&Point) -> String| {
            let texts: Vec<ByteArray> = points().map(|(_, point)| text(point).as_str().into()).collect();
            column.typed::<ByteArrayType>().write_batch(&texts, None, None).map(|_| ())
        };
        match self {
            Column::Surface => texts(&|_| patch.name.clone())?,
            Column::Status => texts(&|point| point.outcome.word().to_owned())?,
            Column::Reason => texts(&|point| point.reason.clone())?,
            Column::I | Column::J => {
                let columns = patch.columns.count;
                let index = |at| if matches!(self, Column::I) { at / columns } else { at % columns };
                let indices: Vec<i32> = rows.clone().map(|at| index(at) as i32).collect();
                column.typed::<Int32Type>().write_batch(&indices, None, None)?;
            }
            _ => {
                let number = self.numbers(patch);
                let numbers: Vec<Option<f64>> = points().map(|(at, point)| number(at, point)).collect();
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
            Column::Position(k) => Box::new(|_, point| point.is_solved().then(|| point.position[*k])),
            Column::Normal(k) => Box::new(|_, point| point.is_solved().then(|| point.normal[*k])),
            Column::Residual => Box::new(|_, point| point.known_residual()),
            Column::Unknown(unknown) => {
                let place = patch.unknowns.iter().position(|own| own == *unknown);
                Box::new(move |_, point| {
                    place.filter(|_| point.is_solved()).map(|place| unknown.unit.written(point.unknowns[place]))
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
fn facts(dataset: &Dataset) -> Vec<(String, String)> {
    let header = &dataset.header;
    let mut facts = vec![
        ("spec".to_owned(), format!("{}, hash {}", header.spec, header.spec_hash)),
        ("job".to_owned(), header.job.clone()),
        ("conventions".to_owned(), sentences(&dataset.header).join("; ")),
    ];
    let unknowns = union_of_unknowns(&dataset.patches).into_iter();
    facts.extend(unknowns.map(|unknown| (format!("unknown {}", unknown.name), unknown.unit.symbol().to_owned())));
    let fields = union_of_fields(&dataset.patches).into_iter();
    facts.extend(fields.map(|field| (format!("field {}", field.name), format!("{}: {}", field.unit, field.meaning))));
    facts.extend(
        dataset.patches.iter().map(|patch| (format!("surface {}", patch.name), patch.told(&Tally::of([patch])))),
    );
    facts
}

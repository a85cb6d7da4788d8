//! Rows of a table as Parquet.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use crate::files::error::WriteError;

/// What the cells of a column are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// Words.
    Text,
    /// Whole numbers.
    Count,
    /// Numbers; null where a cell is empty.
    Number,
}

/// A table in Parquet that is written some rows at a time, not compressed.
///
/// ```
/// use flank_export::{CellKind, ParquetRows};
///
/// let mut file = Vec::new();
/// let heads = [("case".to_string(), CellKind::Text), ("slope [um]".to_string(), CellKind::Number)];
/// let mut table = ParquetRows::new(&heads, "flank", &mut file)?;
/// table.add(&[vec!["5e1f", "0.25"], vec!["a3c0", ""]])?;
/// table.finish()?;
/// assert!(file.starts_with(b"PAR1") && file.ends_with(b"PAR1"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ParquetRows<W: Write + Send> {
    file: SerializedFileWriter<W>,
    kinds: Vec<CellKind>,
}

impl<W: Write + Send> ParquetRows<W> {
    /// An empty table with these heads, made by a program.
    ///
    /// # Errors
    /// When the stream refuses.
    pub fn new(heads: &[(String, CellKind)], program: &str, out: W) -> Result<ParquetRows<W>, WriteError> {
        let column = |(head, kind): &(String, CellKind)| -> Result<Arc<Type>, ParquetError> {
            let (physical, repetition, logical) = match kind {
                CellKind::Text => (Physical::BYTE_ARRAY, Repetition::REQUIRED, Some(LogicalType::String)),
                CellKind::Count => (Physical::INT64, Repetition::REQUIRED, None),
                CellKind::Number => (Physical::DOUBLE, Repetition::OPTIONAL, None),
            };
            let column = Type::primitive_type_builder(head, physical).with_repetition(repetition);
            Ok(Arc::new(column.with_logical_type(logical).build()?))
        };
        let columns = heads.iter().map(column).collect::<Result<_, _>>()?;
        let schema = Type::group_type_builder("rows").with_fields(columns).build()?;
        let properties =
            WriterProperties::builder().set_compression(Compression::UNCOMPRESSED).set_created_by(program.to_owned());
        let file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build()))?;
        Ok(ParquetRows { file, kinds: heads.iter().map(|(_, kind)| *kind).collect() })
    }

    /// Adds rows, whose cells are texts in the order of the heads.
    ///
    /// # Errors
    /// When a row has not as many cells as there are heads, a cell is no number that should be one, or the stream refuses.
    pub fn add(&mut self, rows: &[Vec<&str>]) -> Result<(), WriteError> {
        if rows.is_empty() {
            return Ok(());
        }
        if let Some(row) = rows.iter().find(|row| row.len() != self.kinds.len()) {
            return Err(wrong(format!("a row of {} cells in a table of {}", row.len(), self.kinds.len())));
        }
        let mut group = self.file.next_row_group()?;
        for (at, kind) in self.kinds.iter().enumerate() {
            write_column(*kind, rows.iter().map(|row| row[at]), &mut group)?;
        }
        group.close()?;
        Ok(())
    }

    /// The table is whole.
    ///
    /// # Errors
    /// When the stream refuses.
    pub fn finish(self) -> Result<(), WriteError> {
        self.file.close()?;
        Ok(())
    }
}

fn write_column<'r, W: Write + Send>(
    kind: CellKind,
    cells: impl Iterator<Item = &'r str>,
    group: &mut SerializedRowGroupWriter<'_, W>,
) -> Result<(), WriteError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    let no_number = |cell: &str| wrong(format!("`{cell}` is no number"));
    match kind {
        CellKind::Text => {
            let texts: Vec<_> = cells.map(Into::into).collect();
            column.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
        }
        CellKind::Count => {
            let counts = cells.map(|cell| cell.parse().map_err(|_| no_number(cell)));
            column.typed::<Int64Type>().write_batch(&counts.collect::<Result<Vec<i64>, _>>()?, None, None)?;
        }
        CellKind::Number => {
            let (mut levels, mut known) = (Vec::new(), Vec::new());
            for cell in cells {
                levels.push(i16::from(!cell.is_empty()));
                if !cell.is_empty() {
                    known.push(cell.parse().map_err(|_| no_number(cell))?);
                }
            }
            column.typed::<DoubleType>().write_batch(&known, Some(&levels), None)?;
        }
    }
    column.close()?;
    Ok(())
}

fn wrong(reason: String) -> WriteError {
    std::io::Error::new(std::io::ErrorKind::InvalidData, reason).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_cells_are_refused() {
        let heads = [("number".to_string(), CellKind::Count), ("z [mm]".to_string(), CellKind::Number)];
        for row in [vec!["1"], vec!["1.5", "2"], vec!["1", "x"]] {
            let mut table = ParquetRows::new(&heads, "flank", Vec::new()).expect("a table");
            assert!(table.add(std::slice::from_ref(&row)).is_err(), "{row:?}");
        }
    }
}

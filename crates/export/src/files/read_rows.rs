//! Rows of a table of Parquet as text.

use std::fmt::Write as _;
use std::fs::File;

use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

/// Why a table of Parquet could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ParquetFault {
    /// The file is none, or damaged.
    #[error("it is no table of Parquet: {0}")]
    Damaged(#[from] ParquetError),
    /// Its pages are compressed in a way that is not known.
    #[error(
        "its columns are compressed by {0}: write them with Snappy or not compressed, for example with the argument compression=\"snappy\" of pandas and polars"
    )]
    Compressed(String),
    /// A column holds neither numbers nor texts.
    #[error("column `{column}` holds `{value}`, which is neither a number nor a text")]
    OtherKind {
        /// Its name.
        column: String,
        /// The first such value.
        value: String,
    },
    /// Its text is longer than is allowed.
    #[error("as text it has more than {} MiB", .0 >> 20)]
    TooLong(usize),
}

/// A table of Parquet as CSV of at most so many bytes: the names of its columns as heads, numbers as the shortest texts that are the same, nothing
/// for null.
///
/// # Errors
/// If it cannot be read, or holds other things than numbers and texts.
pub fn parquet_as_csv(file: File, most: usize) -> Result<String, ParquetFault> {
    let reader = SerializedFileReader::new(file)?;
    let metadata = reader.metadata();
    let chunks = metadata.row_groups().iter().flat_map(|group| group.columns());
    let is_known = |of: &Compression| matches!(of, Compression::UNCOMPRESSED | Compression::SNAPPY);
    if let Some(other) = chunks.map(|chunk| chunk.compression()).find(|of| !is_known(of)) {
        return Err(ParquetFault::Compressed(other.to_string()));
    }
    let columns = metadata.file_metadata().schema().get_fields();
    let heads: Vec<String> = columns.iter().map(|column| quoted(column.name())).collect();
    let mut text = heads.join(",") + "\n";
    for row in reader.get_row_iter(None)? {
        for (k, (column, field)) in row?.get_column_iter().enumerate() {
            text += if k == 0 { "" } else { "," };
            add_cell(&mut text, column, field)?;
        }
        text.push('\n');
        if text.len() > most {
            return Err(ParquetFault::TooLong(most));
        }
    }
    Ok(text)
}

fn add_cell(text: &mut String, column: &str, field: &Field) -> Result<(), ParquetFault> {
    let mut number = |number: &dyn std::fmt::Debug| _ = write!(text, "{number:?}");
    match field {
        Field::Null => {}
        Field::Byte(of) => number(of),
        Field::Short(of) => number(of),
        Field::Int(of) => number(of),
        Field::Long(of) => number(of),
        Field::UByte(of) => number(of),
        Field::UShort(of) => number(of),
        Field::UInt(of) => number(of),
        Field::ULong(of) => number(of),
        Field::Float(of) => number(of),
        Field::Double(of) => number(of),
        Field::Str(of) => *text += &quoted(of),
        other => {
            return Err(ParquetFault::OtherKind { column: column.to_string(), value: other.to_string() });
        }
    }
    Ok(())
}

/// A cell that stays one, on one line.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r', '#']) {
        format!("\"{}\"", cell.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        cell.to_string()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int32Type};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    use super::*;

    /// A table of these columns, of which `fill` writes each.
    fn table(schema: &str, compression: Compression) -> SerializedFileWriter<File> {
        let schema = Arc::new(parse_message_type(schema).expect("a schema"));
        let properties = Arc::new(WriterProperties::builder().set_compression(compression).build());
        SerializedFileWriter::new(tempfile::tempfile().expect("a file"), schema, properties).expect("a table")
    }

    #[test]
    fn numbers_and_texts_are_read_as_they_are() {
        let schema = "message t { optional double x; required int32 n; required binary s (UTF8); }";
        let mut file = table(schema, Compression::SNAPPY);
        let mut group = file.next_row_group().expect("a group");
        let mut next = group.next_column().expect("a column").expect("x");
        next.typed::<DoubleType>().write_batch(&[98.1, 1e-7], Some(&[1, 0, 1]), None).expect("x");
        next.close().expect("x");
        let mut next = group.next_column().expect("a column").expect("n");
        next.typed::<Int32Type>().write_batch(&[1, -2, 3], None, None).expect("n");
        next.close().expect("n");
        let texts = ["a", "b,c", "d\ne"].map(ByteArray::from);
        let mut next = group.next_column().expect("a column").expect("s");
        next.typed::<ByteArrayType>().write_batch(&texts, None, None).expect("s");
        next.close().expect("s");
        group.close().expect("a group");
        let read = parquet_as_csv(file.into_inner().expect("whole"), 1000).expect("a table");
        assert_eq!(read, "x,n,s\n98.1,1,a\n,-2,\"b,c\"\n1e-7,3,\"d e\"\n");
    }

    #[test]
    fn other_tables_are_refused() {
        let mut file = table("message t { required boolean b; }", Compression::UNCOMPRESSED);
        let mut group = file.next_row_group().expect("a group");
        let mut next = group.next_column().expect("a column").expect("b");
        next.typed::<BoolType>().write_batch(&[true], None, None).expect("b");
        next.close().expect("b");
        group.close().expect("a group");
        let file = file.into_inner().expect("whole");
        let told = |file: File, most| parquet_as_csv(file, most).expect_err("it is refused").to_string();
        assert!(told(file, 1000).contains("column `b` holds `true`"));
        assert!(told(tempfile::tempfile().expect("a file"), 1000).contains("it is no table of Parquet"));
    }
}

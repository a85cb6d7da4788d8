//! What can go wrong when results are written.

use std::io;
use std::path::PathBuf;

/// A dataset that contradicts itself; the fault is in the program that filled it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    /// The grid has holes or leftovers.
    #[error("surface `{surface}` has {points} points, but {rows} rows of {columns}")]
    PointCount {
        /// Name of the patch.
        surface: String,
        /// Rows it declares.
        rows: usize,
        /// Columns it declares.
        columns: usize,
        /// Points it has.
        points: usize,
    },
    /// A solved point has not one value for each unknown.
    #[error("surface `{surface}`, point ({i}, {j}): {given} values for {named} unknowns")]
    UnknownCount {
        /// Name of the patch.
        surface: String,
        /// Row.
        i: usize,
        /// Column.
        j: usize,
        /// Values the point has.
        given: usize,
        /// Unknowns the patch names.
        named: usize,
    },
    /// A field has not one value for each point.
    #[error("surface `{surface}`, field `{field}`: {values} values for {points} points")]
    FieldLength {
        /// Name of the patch.
        surface: String,
        /// Name of the field.
        field: String,
        /// Values it has.
        values: usize,
        /// Points the patch has.
        points: usize,
    },
    /// A row of a motion table has not one position for each axis.
    #[error("row {row} of the motion table has {given} positions for {named} axes")]
    AxisCount {
        /// Row, from 0.
        row: usize,
        /// Positions it has.
        given: usize,
        /// Axes the table names.
        named: usize,
    },
    /// The series of a motion table has not one polynomial for each axis.
    #[error("the series of the motion table has {given} polynomials for {named} axes")]
    SeriesCount {
        /// Polynomials it has.
        given: usize,
        /// Axes the table names.
        named: usize,
    },
    /// A row of a motion table has an infinity or a NaN somewhere.
    #[error("row {row} of the motion table: not all of its numbers are finite")]
    MotionNumber {
        /// Row, from 0.
        row: usize,
    },
    /// A series or a travel of a motion table has an infinity or a NaN somewhere.
    #[error("the motion table's series and travels are not all finite")]
    AxisNumber,
    /// The rates of a motion table are not three finite numbers for each row and axis.
    #[error("the motion table's rates are not all there, or not all finite")]
    RateNumber,
    /// A solved point has an infinity or a NaN somewhere.
    #[error("surface `{surface}`, point ({i}, {j}) is marked as solved, but not all of its numbers are finite")]
    NotANumber {
        /// Name of the patch.
        surface: String,
        /// Row.
        i: usize,
        /// Column.
        j: usize,
    },
}

/// Why a dataset could not be written to a stream.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// There is nothing sensible to write.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The mesh is too large for the format, whose count of triangles has 32 bits.
    #[error("{triangles} triangles are more than an STL file can hold")]
    TooManyTriangles {
        /// How many there are.
        triangles: usize,
    },
    /// The format cannot hold what was handed over: a motion table that makes no NC program ([`NcError`](crate::NcError)), say.
    #[error(transparent)]
    Refused(Box<dyn std::error::Error + Send + Sync>),
    /// The table could not be written.
    #[cfg(feature = "parquet")]
    #[error(transparent)]
    Parquet(parquet::errors::ParquetError),
    /// The stream refused.
    #[error("{}", plain_words(.0))]
    Io(#[from] io::Error),
}

/// Why a file could not be written. What was there before is still there.
#[derive(Debug, thiserror::Error)]
#[error("cannot write `{}`: {reason}", path.display())]
pub struct FileError {
    /// The file, as it was asked for.
    pub path: PathBuf,
    /// What stood in the way.
    #[source]
    pub reason: WriteError,
}

#[cfg(feature = "parquet")]
impl From<parquet::errors::ParquetError> for WriteError {
    fn from(error: parquet::errors::ParquetError) -> WriteError {
        match error {
            // errors of the disk read as for every other format
            parquet::errors::ParquetError::External(inner) => match inner.downcast::<io::Error>() {
                Ok(refused) => WriteError::Io(*refused),
                Err(other) => WriteError::Parquet(parquet::errors::ParquetError::External(other)),
            },
            other => WriteError::Parquet(other),
        }
    }
}

/// Why a folder could not be made.
#[derive(Debug, thiserror::Error)]
#[error("cannot make the folder `{}`: {}", path.display(), words_on_folder(.reason))]
pub struct FolderError {
    /// The folder, as it was asked for.
    pub path: PathBuf,
    /// What stood in the way.
    #[source]
    pub reason: io::Error,
}

/// The same of a folder that is made.
fn words_on_folder(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::AlreadyExists => "there is a file of that name".to_owned(),
        io::ErrorKind::NotADirectory => "a file stands where a folder on the way to it should be".to_owned(),
        io::ErrorKind::NotFound => "the system lets none be made there".to_owned(),
        _ => plain_words(error),
    }
}

/// An input or output error as a user would say it.
fn plain_words(error: &io::Error) -> String {
    let words = match error.kind() {
        io::ErrorKind::NotFound => "the folder does not exist",
        io::ErrorKind::PermissionDenied => "no permission to write there",
        io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only",
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "the disk is full",
        io::ErrorKind::IsADirectory => "it is a folder",
        io::ErrorKind::NotADirectory => "what should be its folder is a file",
        _ => return error.to_string(),
    };
    words.to_owned()
}

//! Files that are complete or not there, what can go wrong when they are written, and tables that are read back.

pub(crate) mod atomic_file;
pub(crate) mod error;
pub(crate) mod lock;
#[cfg(feature = "parquet")]
pub(crate) mod read_rows;
pub(crate) mod regions;
#[cfg(feature = "parquet")]
pub(crate) mod rows;
pub(crate) mod temp_file;

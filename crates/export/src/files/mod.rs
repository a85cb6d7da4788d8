//! Files that are complete or not there, and what can go wrong when they are written.

pub(crate) mod atomic_file;
pub(crate) mod error;
pub(crate) mod lock;
pub(crate) mod regions;
#[cfg(feature = "parquet")]
pub(crate) mod rows;
pub(crate) mod temp_file;

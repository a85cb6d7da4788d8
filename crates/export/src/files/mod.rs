//! Files that are complete or not there, and what can go wrong when they are written.

pub(crate) mod atomic_file;
pub(crate) mod error;
pub(crate) mod lock;
pub(crate) mod regions;
pub(crate) mod temp_file;

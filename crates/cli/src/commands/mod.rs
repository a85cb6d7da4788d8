//! The commands: each asks the library, and prints what it answers.

pub(crate) mod check;
pub(crate) mod editor;
pub(crate) mod explain;
pub(crate) mod fmt;
pub(crate) mod import;
mod interruption;
pub(crate) mod new;
pub(crate) mod operations;
pub(crate) mod schema;
pub(crate) mod shell;
pub(crate) mod sweep;
pub(crate) mod test;

//! What expressions mean: values with dimensions, names in reach, functions, tables.

pub(crate) mod angle_product;
mod bound;
pub(crate) mod context;
pub(crate) mod dimension;
pub(crate) mod evaluate;
pub(crate) mod functions;
pub(crate) mod grids;
pub(crate) mod implicit;
pub(crate) mod lone;
mod nowhere;
pub(crate) mod segment;
pub(crate) mod steel_side;
pub(crate) mod table_files;
pub(crate) mod tables;
pub(crate) mod value;

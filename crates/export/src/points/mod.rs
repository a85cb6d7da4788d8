//! Solved points as files: comma-separated values, JSON, Parquet, and meshes as STL, OBJ, 3MF and VTK.

pub(crate) mod bands;
pub(crate) mod columns;
pub(crate) mod conventions;
pub(crate) mod csv;
pub(crate) mod dataset;
pub(crate) mod facets;
pub(crate) mod json;
pub(crate) mod json_layout;
pub(crate) mod known;
pub(crate) mod obj;
#[cfg(feature = "parquet")]
pub(crate) mod parquet;
pub(crate) mod stl;
pub(crate) mod tally;
pub(crate) mod threemf;
pub(crate) mod vtp;

//! Grids of points: one point is found, the others follow from neighbour to neighbour.

pub(crate) mod anchor;
pub(crate) mod choice;
pub(crate) mod field;
pub(crate) mod follow;
pub(crate) mod grid;
pub(crate) mod lattice;
pub(crate) mod line;
pub(crate) mod path;
pub(crate) mod reach;
pub(crate) mod spread;
pub(crate) mod survey;
pub(crate) mod verdicts;

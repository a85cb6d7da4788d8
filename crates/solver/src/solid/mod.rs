//! Bodies: blanks turned about an axis, or drawn along a line, less their tooth spaces.

pub(crate) mod arrangement;
pub(crate) mod ball;
pub(crate) mod bands;
pub(crate) mod blank;
pub(crate) mod body;
pub(crate) mod bricks;
pub(crate) mod chart;
pub(crate) mod closed;
pub(crate) mod fineness;
pub(crate) mod gauge;
pub(crate) mod mass;
pub(crate) mod mesh;
pub(crate) mod parts;
pub(crate) mod section;
pub(crate) mod sheets;
pub(crate) mod span;
pub(crate) mod triangles;

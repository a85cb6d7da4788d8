//! Numbers and words as files and pictures show them.

pub use crate::conventions::one_line;
pub use crate::number::{dimension, fixed, levelled, residual, shown_unit, with_minus};
pub use crate::xml::escaped;

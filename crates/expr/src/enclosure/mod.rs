//! What is proven: intervals, and power series with bounds.

pub(crate) mod implicit;
pub(crate) mod interval;
pub(crate) mod quadrature;
pub(crate) mod taylor;

//! Newton's method: for one point, with damping and starts of its own, and for many points at once.

pub(crate) mod batch;
pub(crate) mod elimination;
pub(crate) mod least_squares;
pub(crate) mod lines;
pub(crate) mod minimax;
pub(crate) mod multistart;
pub(crate) mod scalar;
pub(crate) mod solvers;

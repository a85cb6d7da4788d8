//! Square systems, what solves some of their unknowns in closed form, and what becomes of a point that is looked for.

pub(crate) mod closed_form;
pub(crate) mod lines;
pub(crate) mod runner;
pub(crate) mod series;
pub(crate) mod solution;
pub(crate) mod step;
pub(crate) mod system;
pub(crate) mod tolerance;

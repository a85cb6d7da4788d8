//! What follows from a solved surface: geometry, sensitivities, deviations, and what cuts it.

pub(crate) mod adjustment;
pub(crate) mod alignment;
pub(crate) mod cutting;
pub(crate) mod deviation;
pub(crate) mod extent;
pub(crate) mod feet;
pub(crate) mod geometry;
pub(crate) mod inspection;
pub(crate) mod integer_points;
pub(crate) mod intersection;
pub(crate) mod involute;
pub(crate) mod scatter;
pub(crate) mod secondary;
pub(crate) mod section;
pub(crate) mod sensitivity;
pub(crate) mod trim;

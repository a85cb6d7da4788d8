//! What counts as solved, and what as clear.

/// A point is solved when no residual is larger: mm, or mm per radian of a motion.
///
/// Residuals of gears of 100 mm carry rounding errors of about 1e-13; this leaves two orders of room, and Newton goes on
/// past it until nothing gets better. Residuals of very large things are allowed a share of their size.
pub const TOLERANCE: f64 = 1e-11;
/// Share of an equation's size (see [`size_of`]) that its rounding errors stay below.
pub(crate) const OF_SIZE: f64 = 1e-14;
/// No tolerance is larger, however large the thing: points are good to 1e-9 mm or not solved.
pub(crate) const LARGEST_TOLERANCE: f64 = 1e-10;

/// A start is a root as it is if its residuals are below this share of the tolerance, so that what its prediction lacks stays
/// well below what the tolerance allows.
pub(crate) const PREDICTED: f64 = 0.25;
/// With a smaller determinant (unknowns scaled by their ranges, equations by their largest entry) a lane is left to the careful
/// path, which says what is singular.
pub(crate) const CLEAR: f64 = 1e-6;

/// Of what else is wanted at a root (position, normal, …), as much must be finite.
pub(crate) const VITAL: usize = 6;

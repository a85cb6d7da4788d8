//! A number that scatters.

/// A number with its change by each cause, to first order.
pub(super) struct Quantity {
    pub(super) name: String,
    /// That it is told in ...
    pub(super) unit: &'static str,
    /// ... and its size in mm and radians.
    pub(super) size: f64,
    /// In mm and radians, per mm, radian or 1 of each cause.
    pub(super) gradient: Vec<f64>,
}

//! A number that scatters.

use super::causes::Cause;

/// What points are solved to, mm ...
const SOLVED: f64 = 1e-9;
/// ... and the angle, radians, that is as much on a circle of a metre.
const TURNED: f64 = 1e-12;

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

impl Quantity {
    /// Without what is rounding: changes by a standard deviation of a cause that are less than what points are solved to.
    pub(super) fn without_rounding(self, causes: &[Cause]) -> Quantity {
        let least = if self.unit == "urad" { TURNED } else { SOLVED };
        let gradient = self.gradient.iter().zip(causes);
        let gradient = gradient.map(|(by, cause)| if (by * cause.scatter).abs() < least { 0.0 } else { *by }).collect();
        Quantity { gradient, ..self }
    }
}

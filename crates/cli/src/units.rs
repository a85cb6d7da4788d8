//! Values in the units that people read: mm, degrees, plain numbers.

use flank_chain_dsl::Dimension;

pub(crate) fn is_angle(dimension: Dimension) -> bool {
    dimension == Dimension::ANGLE
}

/// The unit's symbol; empty for a number.
pub(crate) fn symbol(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::ANGLE => "deg",
        Dimension::LENGTH => "mm",
        _ => "",
    }
}

/// A value in that unit.
pub(crate) fn shown(dimension: Dimension, value: f64) -> f64 {
    if is_angle(dimension) { value.to_degrees() } else { value }
}

/// A value with its unit, with some decimals.
pub(crate) fn text(dimension: Dimension, value: f64, decimals: usize) -> String {
    format!("{:.decimals$} {}", shown(dimension, value), symbol(dimension)).trim_end().to_string()
}

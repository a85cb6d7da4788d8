//! The body of a gear.

use clap::Args;
use flank::SolidPart;

use super::choice::described;
use super::length;

/// What of which body.
#[derive(Args, Debug)]
pub(crate) struct SolidArguments {
    /// Build the closed bodies of the job's solids instead of points, measure them, and write this part of each as stl, obj or 3mf
    #[arg(long, value_name = "PART", value_parser = described::<SolidPart>(), conflicts_with_all = ["limits", "geometry", "sensitivity", "certify"])]
    pub(crate) solid: Option<SolidPart>,
    /// How far the edges of a body's mesh may lie off the exact surfaces
    #[arg(long, value_name = "LENGTH", requires = "solid", allow_hyphen_values = true, default_value = "10um", value_parser = length)]
    pub(crate) deviation: f64,
    /// Density of the body: 7850 kg/m3, 7.85 g/cm3
    #[arg(long, value_name = "DENSITY", requires = "solid", allow_hyphen_values = true, value_parser = density, default_value = "7850 kg/m3")]
    pub(crate) density: f64,
    /// Diameter of the balls that the gear is measured over: 5.25mm; otherwise one that touches about the middle of the flanks
    #[arg(long, value_name = "LENGTH", requires = "solid", allow_hyphen_values = true, value_parser = length)]
    pub(crate) ball: Option<f64>,
}

/// kg/m³
fn density(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let number = |digits: &str, unit: f64| digits.trim().parse::<f64>().ok().map(|value| value * unit);
    let found = match (text.strip_suffix("kg/m3"), text.strip_suffix("g/cm3")) {
        (Some(digits), _) => number(digits, 1.0),
        (None, Some(digits)) => number(digits, 1000.0),
        (None, None) => None,
    };
    found
        .filter(|value| value.is_finite() && *value > 0.0)
        .ok_or("write a density above zero in kg/m3 or g/cm3, for example 7850 kg/m3".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_have_units() {
        assert_eq!(density("7850 kg/m3"), Ok(7850.0));
        assert_eq!(density("7.85g/cm3"), Ok(7850.0));
        for wrong in ["7850", "-1 kg/m3", "0 g/cm3", "inf kg/m3", "kg/m3", "7.85e-9 t/mm3"] {
            assert!(density(wrong).is_err_and(|told| told.contains("in kg/m3 or g/cm3")), "{wrong}");
        }
    }
}

//! Quantities in documents.

use flank_chain_dsl::Dimension;
use flank_export::degrees;
use schemars::JsonSchema;
use serde::Serialize;

use crate::project::units;

/// The unit of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub enum UnitSymbol {
    /// Lengths.
    #[serde(rename = "mm")]
    Millimetre,
    /// Angles.
    #[serde(rename = "deg")]
    Degree,
    /// Plain numbers.
    #[serde(rename = "")]
    One,
}

impl UnitSymbol {
    pub(crate) fn of_dimension(dimension: Dimension) -> UnitSymbol {
        match dimension {
            Dimension::LENGTH => UnitSymbol::Millimetre,
            Dimension::ANGLE => UnitSymbol::Degree,
            _ => UnitSymbol::One,
        }
    }

    /// As it is written behind a value.
    pub fn symbol(self) -> &'static str {
        match self {
            UnitSymbol::Millimetre => "mm",
            UnitSymbol::Degree => "deg",
            UnitSymbol::One => "",
        }
    }
}

/// What something runs through; null where nothing was found.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Extent {
    /// Of what runs through it.
    pub name: String,
    /// Of both ends.
    pub unit: UnitSymbol,
    /// In its unit.
    pub low: Option<f64>,
    /// In its unit.
    pub high: Option<f64>,
}

impl Extent {
    pub(crate) fn new(name: &str, dimension: Dimension, ends: Option<(f64, f64)>) -> Extent {
        let shown = |x: f64| units::shown(dimension, x);
        let (low, high) = ends.unzip();
        Extent {
            name: name.to_string(),
            unit: UnitSymbol::of_dimension(dimension),
            low: low.map(shown),
            high: high.map(shown),
        }
    }

    /// Both ends, if anything was found.
    pub fn ends(&self) -> Option<(f64, f64)> {
        self.low.zip(self.high)
    }
}

/// One value of something.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NamedValue {
    /// Of what has the value.
    pub name: String,
    /// Of the value.
    pub unit: UnitSymbol,
    /// In its unit.
    pub value: f64,
}

impl NamedValue {
    pub(crate) fn new(name: &str, dimension: Dimension, value: f64) -> NamedValue {
        NamedValue {
            name: name.to_string(),
            unit: UnitSymbol::of_dimension(dimension),
            value: units::shown(dimension, value),
        }
    }
}

/// A motion of a job, or another thing that has a unit.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct NamedUnit {
    /// Its name.
    pub name: String,
    /// Of its values.
    pub unit: UnitSymbol,
}

impl NamedUnit {
    pub(crate) fn new(name: &str, dimension: Dimension) -> NamedUnit {
        NamedUnit { name: name.to_string(), unit: UnitSymbol::of_dimension(dimension) }
    }
}

/// What an axis can do, in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Travel {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Travel {
    pub(crate) fn new(dimension: Dimension, (low, high): (f64, f64)) -> Travel {
        // as it was given: 120 deg are not 119.99999999999999 deg
        let [low, high] = [low, high].map(|x| if units::is_angle(dimension) { degrees(x) } else { x });
        Travel { low, high }
    }
}

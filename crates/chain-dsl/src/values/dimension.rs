//! Dimensions: lengths and angles, their products, and what may stand for what.

use std::fmt;

use crate::syntax::ast::{Expression, ExpressionKind};

/// A product of powers of length and angle; all zero is a plain number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dimension {
    /// Exponent of length.
    pub length: i32,
    /// Exponent of angle.
    pub angle: i32,
}

impl Dimension {
    /// A plain number.
    pub const NUMBER: Dimension = Dimension { length: 0, angle: 0 };
    /// A length, mm inside.
    pub const LENGTH: Dimension = Dimension { length: 1, angle: 0 };
    /// An angle, radians inside.
    pub const ANGLE: Dimension = Dimension { length: 0, angle: 1 };

    /// Dimension of a product. Exponents that are no `i32` stay at its end, in quotients and powers, too; a text does not get there.
    pub fn times(self, other: Dimension) -> Dimension {
        Dimension { length: self.length.saturating_add(other.length), angle: self.angle.saturating_add(other.angle) }
    }

    /// Dimension of a quotient.
    pub fn over(self, other: Dimension) -> Dimension {
        self.times(other.power(-1))
    }

    /// Dimension of a whole power.
    pub fn power(self, exponent: i32) -> Dimension {
        Dimension { length: self.length.saturating_mul(exponent), angle: self.angle.saturating_mul(exponent) }
    }

    /// The greatest exponent, by its amount.
    pub(crate) fn greatest_power(self) -> usize {
        self.length.unsigned_abs().max(self.angle.unsigned_abs()) as usize
    }

    /// Dimension of the square root, if the exponents are even.
    pub fn root(self) -> Option<Dimension> {
        (self.length % 2 == 0 && self.angle % 2 == 0)
            .then_some(Dimension { length: self.length / 2, angle: self.angle / 2 })
    }

    /// True if a value of dimension `found` may stand where this one is wanted. An angle is a number where it must be:
    /// radius × angle is a length, angle × angle a number; but an angle alone is not a number, nor a number an angle.
    pub fn accepts(self, found: Dimension) -> bool {
        let absorbed = self.angle == 0 && !(found.length == 0 && found.angle == 1);
        let power_of_angle = self == Dimension::ANGLE && found.length == 0 && found.angle != 0;
        self.length == found.length && (self.angle == found.angle || absorbed || power_of_angle)
    }

    /// The dimension of a sum of both, if they may be added.
    pub fn sum(self, other: Dimension) -> Option<Dimension> {
        if self == other || self.accepts(other) {
            Some(self)
        } else if other.accepts(self) {
            Some(other)
        } else if self.length == other.length && self.length != 0 {
            Some(Dimension { length: self.length, angle: 0 })
        } else {
            None
        }
    }
}

impl fmt::Display for Dimension {
    /// In the user's words: `length`, `angle/length`, `length^2`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut above = Vec::new();
        let mut below = Vec::new();
        for (name, exponent) in [("length", self.length), ("angle", self.angle)] {
            let side = if exponent > 0 { &mut above } else { &mut below };
            match exponent.unsigned_abs() {
                0 => {}
                1 => side.push(name.to_string()),
                e => side.push(format!("{name}^{e}")),
            }
        }
        match (above.is_empty(), below.is_empty()) {
            (true, true) => write!(f, "number"),
            (true, false) => write!(f, "1/{}", below.join("/")),
            (false, true) => write!(f, "{}", above.join("*")),
            (false, false) => write!(f, "{}/{}", above.join("*"), below.join("/")),
        }
    }
}

/// A unit: its size in mm or radians and its dimension.
///
/// `None` if there is no such unit.
pub fn unit_size(name: &str) -> Option<(f64, Dimension)> {
    use std::f64::consts::PI;
    let (size, dimension) = match name {
        "mm" => (1.0, Dimension::LENGTH),
        "um" | "µm" | "μm" => (1e-3, Dimension::LENGTH),
        "cm" => (10.0, Dimension::LENGTH),
        "inch" => (25.4, Dimension::LENGTH),
        "rad" => (1.0, Dimension::ANGLE),
        "deg" => (PI / 180.0, Dimension::ANGLE),
        "arcmin" => (PI / 10_800.0, Dimension::ANGLE),
        "arcsec" => (PI / 648_000.0, Dimension::ANGLE),
        "rev" => (2.0 * PI, Dimension::ANGLE),
        _ => return None,
    };
    Some((size, dimension))
}

/// A number with its unit in mm or radians, correctly rounded where one operation is enough: 20 um is 20/1000.
pub(crate) fn convert(value: f64, name: &str, exponent: i32) -> Option<f64> {
    use std::f64::consts::PI;
    let (size, _) = unit_size(name)?;
    Some(match (name, exponent) {
        ("um" | "µm" | "μm", 1) => value / 1e3,
        ("deg", 1) => value * PI / 180.0,
        ("arcmin", 1) => value * PI / 10_800.0,
        ("arcsec", 1) => value * PI / 648_000.0,
        (_, e) => value * size.powi(e),
    })
}

/// An inside value as people write it: `3 mm`, `20 deg`, `5`.
pub(crate) fn shown(value: f64, dimension: Dimension) -> String {
    match dimension {
        Dimension::ANGLE => format!("{} deg", digits(value.to_degrees())),
        Dimension::LENGTH => format!("{} mm", digits(value)),
        Dimension { length: 1, angle: -1 } => format!("{} mm/rad", digits(value)),
        _ => digits(value),
    }
}

/// A unit that something is written in.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenUnit {
    /// `arcmin`
    pub name: String,
    /// mm or radians
    pub size: f64,
}

/// The unit of a dimension that an expression is written in: that of its first number with one.
pub(crate) fn written_unit(dimension: Dimension, written: &Expression) -> Option<WrittenUnit> {
    let mut found = None;
    written.each(&mut |part| {
        if let ExpressionKind::Number(_, units) = &part.kind
            && let [(unit, 1)] = &units[..]
            && let Some((size, of)) = unit_size(&unit.node)
            && of == dimension
        {
            found.get_or_insert_with(|| WrittenUnit { name: unit.node.clone(), size });
        }
    });
    found
}

/// An inside value in the unit that an expression is written in: -1 arcmin where that is `-1 arcmin`.
pub(crate) fn shown_like(value: f64, dimension: Dimension, written: &Expression) -> String {
    shown_in(value, dimension, written_unit(dimension, written).as_ref())
}

/// An inside value in a unit, if there is one.
pub(crate) fn shown_in(value: f64, dimension: Dimension, unit: Option<&WrittenUnit>) -> String {
    match unit {
        Some(WrittenUnit { name, size }) => format!("{} {name}", digits(value / size)),
        None => shown(value, dimension),
    }
}

/// A value in digits: with an exponent where most of them would only say how large it is.
fn digits(value: f64) -> String {
    let value = without_noise(value);
    if value.is_finite() && value.abs() >= 1e16 { format!("{value:e}") } else { value.to_string() }
}

/// The value with 15 digits if that is as good as itself: within two roundings, such as a conversion's. So 0.38 · 3 is 1.14,
/// and what was written in degrees comes back as written.
fn without_noise(value: f64) -> f64 {
    let short = format!("{value:.14e}").parse().unwrap_or(value);
    let rounding = value.abs().next_up() - value.abs();
    let shown = if (short - value).abs() <= 2.0 * rounding { short } else { value };
    // a zero has no sign
    if shown == 0.0 { 0.0 } else { shown }
}

/// A base dimension by its name in the language.
pub(crate) fn named(name: &str) -> Option<Dimension> {
    match name {
        "length" => Some(Dimension::LENGTH),
        "angle" => Some(Dimension::ANGLE),
        "number" | "count" => Some(Dimension::NUMBER),
        _ => None,
    }
}

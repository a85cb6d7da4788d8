//! Amounts as people write them beside a spec: with the units of the language.

use std::fmt;

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{Dimension, unit_size};

use crate::project::requests::ToleratedAmount;
use crate::project::units;

/// Greater powers of a unit are slips of the pen.
const GREATEST_POWER: i32 = 9;

/// Why a text is no amount.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AmountFault {
    /// It has no number.
    #[error("`{0}` is no amount: write a number with its unit, for example 5um, 1arcmin, 0.001 1/mm or 0.01%")]
    NoNumber(String),
    /// The language has no such unit.
    #[error("there is no unit `{0}`; there is: {units}, their products as 1/mm, and % for a share", units = vocabulary().units.join(", "))]
    UnknownUnit(String),
}

/// A number with a unit, `%` or nothing behind it: `5um`, `-1 arcmin`, `0.01%`, `3`. Units are those of the language, also as `mm^-1` and
/// `mm/rev`, and products of them as results show them: `1/mm`, `mm*rad`.
///
/// # Errors
/// If there is no number, or no such unit.
pub fn read_amount(text: &str) -> Result<ToleratedAmount, AmountFault> {
    let text = text.trim();
    let no_number = || AmountFault::NoNumber(text.to_string());
    let (number, unit) = number_and_unit(text).ok_or_else(no_number)?;
    match unit {
        "" => Ok(ToleratedAmount::Number(number)),
        "%" => Ok(ToleratedAmount::Share(number * 1e-2)),
        // two numbers are none
        _ if unit.starts_with(|c: char| c.is_ascii_digit()) && !unit[1..].trim_start().starts_with('/') => {
            Err(no_number())
        }
        _ => match product_size(unit) {
            Some((size, dimension)) => Ok(ToleratedAmount::of(number * size, dimension)),
            None => Err(AmountFault::UnknownUnit(unit.to_string())),
        },
    }
}

/// The number that a text begins with, as long as it is one, and what stands behind it.
fn number_and_unit(text: &str) -> Option<(f64, &str)> {
    let is_of_number = |c: char| c.is_ascii_digit() || ['+', '-', '.', 'e', 'E'].contains(&c);
    let longest = text.find(|c: char| !is_of_number(c)).unwrap_or(text.len());
    let found = (1..=longest).rev().find_map(|end| Some((text[..end].parse::<f64>().ok()?, text[end..].trim())));
    found.filter(|(number, _)| number.is_finite())
}

/// The size of a product of units in mm and radians, and its dimension: `mm`, `mm^2`, `mm^-1`, `1/mm`, `/mm`, `mm/rev`, `mm*rad`, `1/mm^2*rad`,
/// where all behind a stroke is below it. `None` if one of them is no unit of the language.
pub fn product_size(unit: &str) -> Option<(f64, Dimension)> {
    let mut found = (1.0, Dimension::NUMBER);
    for (at, side) in unit.split('/').enumerate() {
        if at == 0 && ["", "1"].contains(&side.trim()) && unit.contains('/') {
            continue;
        }
        for factor in side.split('*') {
            let (size, dimension) = power_size(factor.trim())?;
            found = match at {
                0 => (found.0 * size, found.1.times(dimension)),
                _ => (found.0 / size, found.1.over(dimension)),
            };
        }
    }
    Some(found)
}

/// Of a unit with its exponent, if it has one.
fn power_size(factor: &str) -> Option<(f64, Dimension)> {
    let (name, exponent) = match factor.split_once('^') {
        Some((name, exponent)) => {
            (name, exponent.parse().ok().filter(|of| (-GREATEST_POWER..=GREATEST_POWER).contains(of))?)
        }
        None => (factor, 1),
    };
    let (size, dimension) = unit_size(name)?;
    Some((size.powi(exponent), dimension.power(exponent)))
}

impl ToleratedAmount {
    /// So much in mm and radians, of a dimension.
    #[must_use]
    pub fn of(size: f64, dimension: Dimension) -> ToleratedAmount {
        match dimension {
            Dimension::LENGTH => ToleratedAmount::Length(size),
            Dimension::ANGLE => ToleratedAmount::Angle(size),
            Dimension::NUMBER => ToleratedAmount::Number(size),
            _ => ToleratedAmount::Product { size, dimension },
        }
    }

    /// As an amount of something that has a dimension and a value, in mm and radians; `None` if it is of another kind, or not above zero.
    pub(crate) fn inside(self, dimension: Dimension, value: f64) -> Option<f64> {
        let is_number = dimension != Dimension::LENGTH && !units::is_angle(dimension);
        let found = match self {
            ToleratedAmount::Length(mm) if dimension.accepts(Dimension::LENGTH) => mm,
            ToleratedAmount::Angle(radians) if units::is_angle(dimension) => radians,
            ToleratedAmount::Number(number) if is_number => number,
            ToleratedAmount::Product { size, dimension: own } if dimension.accepts(own) => size,
            ToleratedAmount::Share(share) => share * value.abs(),
            _ => return None,
        };
        (found.is_finite() && found > 0.0).then_some(found)
    }

    /// Why it is none of what an option names.
    pub(crate) fn refused(self, option: &str, name: &str, (dimension, value): (Dimension, f64)) -> String {
        if matches!(self, ToleratedAmount::Share(_)) && value == 0.0 {
            return format!(
                "option `{option} {name}`: a share of a value that is zero is nothing: say how much, with a unit"
            );
        }
        let wanted = match dimension {
            Dimension::LENGTH => "a length above zero, for example 0.01mm".to_string(),
            Dimension::ANGLE => "an angle above zero, for example 1arcmin".to_string(),
            Dimension::NUMBER => "a plain number above zero, or a share of its value, for example 0.1%".to_string(),
            _ => {
                let unit = units::whole_symbol(dimension);
                format!("an amount in {unit} above zero, for example `0.001 {unit}`, or a share of its value")
            }
        };
        format!("option `{option} {name}`: this takes {wanted}")
    }
}

impl fmt::Display for ToleratedAmount {
    /// As the language reads it; a share in percent, which it does not.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            ToleratedAmount::Length(size) => write!(f, "{size} mm"),
            ToleratedAmount::Angle(size) => write!(f, "{size} rad"),
            ToleratedAmount::Number(size) => write!(f, "{size}"),
            ToleratedAmount::Product { size, dimension } => write!(f, "{size} {}", units::of_language(dimension)),
            ToleratedAmount::Share(share) => write!(f, "{}%", share * 1e2),
        }
    }
}

#[cfg(test)]
mod tests {
    use flank_chain_dsl::lone_value;

    use super::*;

    #[test]
    fn amounts_have_all_units_of_the_language() {
        for unit in vocabulary().units {
            let (size, dimension) = unit_size(unit).expect("a unit");
            let known = match dimension {
                Dimension::ANGLE => ToleratedAmount::Angle(2.0 * size),
                _ => ToleratedAmount::Length(2.0 * size),
            };
            assert_eq!(read_amount(&format!("2{unit}")), Ok(known));
        }
        assert_eq!(read_amount(" -1e-3 inch "), Ok(ToleratedAmount::Length(-25.4e-3)));
        assert_eq!(read_amount("5%"), Ok(ToleratedAmount::Share(0.05)));
        assert_eq!(read_amount("5"), Ok(ToleratedAmount::Number(5.0)));
        for unknown in ["in", "mm^", "mm^2.5", "mm^99", "mm/", "1/", "/", "mm**rad", "1/1", "mm//rad"] {
            assert_eq!(read_amount(&format!("5 {unknown}")), Err(AmountFault::UnknownUnit(unknown.to_string())));
        }
        for none in ["", "um", "nan mm", "1 2 mm", "1e999mm", "-", "e"] {
            assert!(matches!(read_amount(none), Err(AmountFault::NoNumber(_))), "{none}");
        }
    }

    /// As results show a unit, and as the language has it: both are the same amount, and the language agrees.
    #[test]
    fn products_are_read_as_they_are_shown_and_written() {
        for (length, angle) in (-3..=3).flat_map(|length| (-3..=3).map(move |angle| (length, angle))) {
            let dimension = Dimension { length, angle };
            let known = Ok(ToleratedAmount::of(2.5, dimension));
            let (shown, written) = (units::inside(dimension), units::of_language(dimension));
            assert_eq!(read_amount(&format!("2.5 {written}")), known, "{written}");
            assert_eq!(lone_value(&format!("2.5 {written}"), dimension), Some(2.5), "{written}");
            if dimension != Dimension::NUMBER {
                assert_eq!(read_amount(&format!("2.5 {shown}")), known, "{shown}");
            }
        }
        let per_length = Dimension::LENGTH.power(-1);
        for (text, size) in [("2/mm", 2.0), ("2 / cm", 0.2), ("5e-3 1/um", 5.0), ("1 mm^-1", 1.0), ("3 1 / mm", 3.0)] {
            let Ok(ToleratedAmount::Product { size: found, dimension }) = read_amount(text) else { panic!("{text}") };
            // a unit's size and the quotient are rounded
            assert!(dimension == per_length && (found / size - 1.0).abs() < 4.0 * f64::EPSILON, "{text}: {found}");
        }
    }
}

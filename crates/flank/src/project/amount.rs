//! Amounts as people write them beside a spec: with the units of the language.

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{Dimension, unit_size};

use crate::project::requests::ToleratedAmount;

/// Why a text is no amount.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AmountFault {
    /// It has no number.
    #[error("`{0}` is no amount: write a number with its unit, for example 5um, 1arcmin or 0.01%")]
    NoNumber(String),
    /// The language has no such unit.
    #[error("there is no unit `{0}`; there is: {units}, and % for a share", units = vocabulary().units.join(", "))]
    UnknownUnit(String),
}

/// The size of a unit in mm and radians, and what it measures: one of the language, or several of them with powers: `mm`, `1/mm`,
/// `arcmin/mm`, `mm^2`, `um*rad/mm`.
pub fn read_unit(text: &str) -> Option<(f64, Dimension)> {
    /// The highest power of one.
    const HIGHEST: i32 = 9;
    let factor = |text: &str| {
        let (name, power) = text.split_once('^').unwrap_or((text, "1"));
        let power = power.trim().parse().ok().filter(|power| (1..=HIGHEST).contains(power))?;
        let (size, dimension) = unit_size(name.trim())?;
        Some((size.powi(power), dimension.power(power)))
    };
    let product = |text: &str| {
        text.split('*').try_fold((1.0, Dimension::NUMBER), |(size, dimension), text| {
            let (other, of) = factor(text)?;
            Some((size * other, dimension.times(of)))
        })
    };
    let (above, below) = text.split_once('/').map_or((text, None), |(above, below)| (above, Some(below)));
    let above = match above.trim() {
        "1" | "" if below.is_some() => (1.0, Dimension::NUMBER),
        above => product(above)?,
    };
    let below = below.map_or(Some((1.0, Dimension::NUMBER)), product)?;
    Some((above.0 / below.0, above.1.over(below.1)))
}

/// A number with a unit, `%` or nothing behind it: `5um`, `-1 arcmin`, `1e-5 1/mm`, `0.01%`, `3`. Units are those of [`read_unit`].
///
/// # Errors
/// If there is no number, or no such unit.
pub fn read_amount(text: &str) -> Result<ToleratedAmount, AmountFault> {
    let text = text.trim();
    // the longest number that stands in front: `1e-3 inch`
    let known = text.char_indices().map(|(at, c)| at + c.len_utf8()).rev();
    let number = known.filter_map(|end| Some((text[..end].trim_end().parse::<f64>().ok()?, end))).next();
    let no_number = || AmountFault::NoNumber(text.to_string());
    let (number, end) = number.filter(|(number, _)| number.is_finite()).ok_or_else(no_number)?;
    let unit = text[end..].trim();
    match (unit, read_unit(unit)) {
        ("", _) => Ok(ToleratedAmount::Number(number)),
        ("%", _) => Ok(ToleratedAmount::Share(number * 1e-2)),
        (_, Some((size, Dimension::ANGLE))) => Ok(ToleratedAmount::Angle(number * size)),
        (_, Some((size, Dimension::LENGTH))) => Ok(ToleratedAmount::Length(number * size)),
        (_, Some((size, Dimension::NUMBER))) => Ok(ToleratedAmount::Number(number * size)),
        (_, Some((size, dimension))) => Ok(ToleratedAmount::Of(number * size, dimension)),
        (_, None) if unit.starts_with(|c: char| c.is_ascii_digit()) => Err(no_number()),
        (_, None) => Err(AmountFault::UnknownUnit(unit.to_string())),
    }
}

#[cfg(test)]
mod tests {
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
        let per_length = Dimension::LENGTH.power(-1);
        for (text, size, dimension) in [
            ("1e-5 1/mm", 1e-5, per_length),
            ("2e-5/mm", 2e-5, per_length),
            ("0.5 1/cm", 0.05, per_length),
            ("3 mm^2", 3.0, Dimension::LENGTH.power(2)),
            ("4 rad/mm^3", 4.0, Dimension::ANGLE.over(Dimension::LENGTH.power(3))),
            ("5 mm * rad", 5.0, Dimension::LENGTH.times(Dimension::ANGLE)),
        ] {
            assert_eq!(read_amount(text), Ok(ToleratedAmount::Of(size, dimension)), "{text}");
        }
        assert_eq!(read_amount("7 um/mm"), Ok(ToleratedAmount::Number(7e-3)));
        for unknown in ["1/", "/", "mm^", "mm^0", "mm^99", "mm/mm/mm", "*mm", "2/mm"] {
            assert_eq!(read_unit(unknown), None, "{unknown}");
        }
        assert_eq!(read_amount("5in"), Err(AmountFault::UnknownUnit("in".to_string())));
        for none in ["", "um", "nan mm", "1 2 mm", "1e999mm"] {
            assert!(matches!(read_amount(none), Err(AmountFault::NoNumber(_))), "{none}");
        }
    }
}

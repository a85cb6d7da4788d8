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

/// A number with a unit of the language, `%` or nothing behind it: `5um`, `-1 arcmin`, `0.01%`, `3`.
///
/// # Errors
/// If there is no number, or no such unit.
pub fn read_amount(text: &str) -> Result<ToleratedAmount, AmountFault> {
    let text = text.trim();
    let (digits, unit) = text.split_at(text.rfind(|c: char| c.is_ascii_digit() || c == '.').map_or(0, |at| at + 1));
    let number = digits.parse().ok().filter(|number: &f64| number.is_finite());
    let number = number.ok_or_else(|| AmountFault::NoNumber(text.to_string()))?;
    let unit = unit.trim();
    match (unit, unit_size(unit)) {
        ("", _) => Ok(ToleratedAmount::Number(number)),
        ("%", _) => Ok(ToleratedAmount::Share(number * 1e-2)),
        (_, Some((size, Dimension::ANGLE))) => Ok(ToleratedAmount::Angle(number * size)),
        (_, Some((size, _))) => Ok(ToleratedAmount::Length(number * size)),
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
        assert_eq!(read_amount("5in"), Err(AmountFault::UnknownUnit("in".to_string())));
        for none in ["", "um", "nan mm", "1 2 mm", "1e999mm"] {
            assert!(matches!(read_amount(none), Err(AmountFault::NoNumber(_))), "{none}");
        }
    }
}

//! Codes by their names, as `flank explain` is asked for them.

use std::str::FromStr;

use crate::diagnostics::codes::Code;
use crate::diagnostics::spelling::closest;

/// What is not a code, and the code that was perhaps meant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no code `{given}`{}", self.hint())]
pub struct UnknownCode {
    /// As given.
    pub given: String,
    /// The nearest code, if one is near.
    pub nearest: Option<Code>,
}

impl UnknownCode {
    fn hint(&self) -> String {
        let meant = |code: Code| format!("; did you mean `{}` ({})?", code.as_str(), code.title());
        self.nearest.map_or("; `flank explain` lists all codes".to_string(), meant)
    }
}

impl FromStr for Code {
    type Err = UnknownCode;

    /// Reads a code as printed: `E0301`, also in lower case or still in the `error[…]` of a report.
    fn from_str(given: &str) -> Result<Code, UnknownCode> {
        let inside = given.split_once('[').map_or(given, |(_, rest)| rest.split(']').next().unwrap_or(rest));
        let wanted = inside.trim().to_uppercase();
        let found = Code::ALL.iter().copied().find(|code| code.as_str() == wanted);
        found.ok_or_else(|| UnknownCode { given: given.to_string(), nearest: nearest(&wanted) })
    }
}

/// The code that differs in one letter; of several the one with the nearest number: `E0311` was perhaps `E0310`.
fn nearest(wanted: &str) -> Option<Code> {
    let number = |text: &str| text.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().unwrap_or(0_u32);
    let mut codes = Code::ALL.to_vec();
    codes.sort_by_key(|code| number(wanted).abs_diff(number(code.as_str())));
    let meant = closest(wanted, codes.iter().map(|code| code.as_str()))?;
    codes.into_iter().find(|code| code.as_str() == meant)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_read_as_printed() {
        for code in Code::ALL {
            assert_eq!(code.as_str().parse(), Ok(*code));
        }
        assert_eq!("e0301".parse(), Ok(Code::WrongDimension));
        assert_eq!("error[E0301]:".parse(), Ok(Code::WrongDimension));
    }

    #[test]
    fn the_nearest_code_is_named() {
        let nearest = |text: &str| text.parse::<Code>().expect_err("not a code").nearest;
        assert_eq!(nearest("E301"), Some(Code::WrongDimension));
        assert_eq!(nearest("E0311"), Some(Code::Unproven));
        assert_eq!(nearest("E0399"), Some(Code::Unmet));
        assert_eq!(nearest("E0999"), None);
        assert_eq!(nearest("dimension"), None);
        let told = "E301".parse::<Code>().expect_err("not a code").to_string();
        assert_eq!(told, "there is no code `E301`; did you mean `E0301` (a value has the wrong dimension)?");
    }
}

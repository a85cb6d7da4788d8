//! Values in the units that people read: mm, degrees, plain numbers.

use flank_chain_dsl::Dimension;
use flank_export::{degrees, fixed};

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

/// A dimension in mm and radians, the units inside: `mm`, `mm/rad`, `1/mm`; `1` for a number.
pub(crate) fn inside(dimension: Dimension) -> String {
    let powers = [("mm", dimension.length), ("rad", dimension.angle)];
    let side = |sign: i32| -> Vec<String> {
        let on_side = powers.iter().filter(|(_, power)| power * sign > 0);
        on_side
            .map(|(unit, power)| if power.abs() == 1 { (*unit).into() } else { format!("{unit}^{}", power.abs()) })
            .collect()
    };
    let [above, below] = [side(1), side(-1)].map(|units| units.join("*"));
    let above = if above.is_empty() { "1".to_string() } else { above };
    if below.is_empty() { above } else { format!("{above}/{below}") }
}

/// The unit that values are shown in, whatever it is; empty for a number.
pub(crate) fn whole_symbol(dimension: Dimension) -> String {
    match inside(dimension) {
        unit if unit == "1" => String::new(),
        unit if symbol(dimension).is_empty() => unit,
        _ => symbol(dimension).to_string(),
    }
}

/// A dimension in mm and radians as the language has units behind a number: `mm`, `mm^-1`, `mm/rad`; empty for a number.
pub(crate) fn of_language(dimension: Dimension) -> String {
    let power = |unit: &str, exponent: i32| match exponent {
        1 => unit.to_string(),
        _ => format!("{unit}^{exponent}"),
    };
    match (dimension.length, dimension.angle) {
        (0, 0) => String::new(),
        (0, angle) => power("rad", angle),
        (length, 0) => power("mm", length),
        (length, angle) => format!("{}/{}", power("mm", length), power("rad", -angle)),
    }
}

/// A value in that unit.
pub(crate) fn shown(dimension: Dimension, value: f64) -> f64 {
    if is_angle(dimension) { value.to_degrees() } else { value }
}

/// A value in that unit, with some decimals.
pub(crate) fn digits(dimension: Dimension, value: f64, decimals: usize) -> String {
    fixed(shown(dimension, value), decimals)
}

/// A number of any size, with so many digits behind the first one; `0` for zero.
pub(crate) fn scientific(value: f64, decimals: usize) -> String {
    if value == 0.0 { "0".to_string() } else { format!("{value:.decimals$e}") }
}

/// A length of any size, for people: in mm, or in um where it is small.
pub(crate) fn length(mm: f64) -> String {
    match mm.abs() {
        size if size >= 1e-3 => format!("{} mm", fixed(mm, 4)),
        size if size >= 1e-6 => format!("{} um", fixed(1e3 * mm, 4)),
        0.0 => "0 mm".to_string(),
        _ => format!("{:.1e} um", 1e3 * mm),
    }
}

/// How far something is off, in um: by three decimals unless these say nothing of it.
pub(crate) fn off(mm: f64) -> String {
    let um = 1e3 * mm;
    if um == 0.0 || um >= 1e-2 { format!("{um:.3} um") } else { format!("{um:.1e} um") }
}

/// The same with an end of a range, which is rounded so that the range becomes no narrower: down below the value, up above.
pub(crate) fn end_digits(dimension: Dimension, end: f64, decimals: usize, is_upper: bool) -> String {
    // of the last decimal: what rounding leaves of an end that is told exactly
    const SLACK: f64 = 1e-6;
    let unit = 10f64.powi(-(decimals as i32));
    let steps = shown(dimension, end) / unit;
    let outward = if is_upper { (steps - SLACK).ceil() } else { (steps + SLACK).floor() };
    fixed(outward * unit, decimals)
}

/// A value in its unit, with some decimals.
pub(crate) fn text(dimension: Dimension, value: f64, decimals: usize) -> String {
    format!("{} {}", digits(dimension, value, decimals), symbol(dimension)).trim_end().to_string()
}

/// A value with its unit, as short as it was given, or else with four decimals.
pub(crate) fn told(dimension: Dimension, value: f64) -> String {
    let [given, rounded] = [as_given(dimension, value), text(dimension, value, 4)];
    if given.len() <= rounded.len() { given } else { rounded }
}

/// A value as it was given, with its unit: the shortest text that is the same value.
pub(crate) fn as_given(dimension: Dimension, value: f64) -> String {
    let shown = if is_angle(dimension) { degrees(value) } else { value };
    format!("{} {}", if shown == 0.0 { 0.0 } else { shown }, symbol(dimension)).trim_end().to_string()
}

/// `1 point`, `2 points`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_that_is_told_holds_its_ends() {
        let ends =
            |low, high| [(low, false), (high, true)].map(|(end, upper)| end_digits(Dimension::LENGTH, end, 4, upper));
        assert_eq!(ends(-0.12067, 2.132612), ["-0.1207", "2.1327"]);
        assert_eq!(ends(0.12067, -2.132612), ["0.1206", "-2.1326"]);
        // what needs no rounding stays, whatever its binary digits are
        assert_eq!(ends(0.1, 0.3), ["0.1000", "0.3000"]);
        assert_eq!(end_digits(Dimension::ANGLE, (-120.0f64).to_radians(), 4, false), "-120.0000");
    }
}

//! Numbers as text.

/// A length in mm below this is what rounding leaves of none.
const ROUNDING: f64 = 1e-12;

/// The number itself, but never a negative zero: it reads as a fault and differs in bytes only.
pub(crate) fn plain(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value }
}

/// So many decimals, for people; what they show as zero has no sign.
pub fn fixed(value: f64, decimals: usize) -> String {
    let mut text = String::new();
    push_fixed(value, decimals, &mut text);
    text
}

/// Puts [`fixed`] behind a text; returns the number that stands there.
pub(crate) fn push_fixed(value: f64, decimals: usize, text: &mut String) -> f64 {
    /// Up to here a product is off by so little that it shows on which side of a tie it lies.
    const MOST: f64 = 1e12;
    const BESIDE_TIE: f64 = 1e-3;
    const POWERS: [f64; 10] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];
    let scaled = POWERS.get(decimals).map_or(f64::NAN, |power| value.abs() * power);
    if scaled < MOST && (scaled.fract() - 0.5).abs() > BESIDE_TIE {
        let rounded = scaled.round();
        let sign = if value < 0.0 && rounded > 0.0 { -1.0 } else { 1.0 };
        push_digits(rounded as u64, sign < 0.0, decimals, text);
        return sign * (rounded / POWERS[decimals]);
    }
    let plain = format!("{value:.decimals$}");
    let shown = match plain.strip_prefix('-') {
        Some(size) if size.bytes().all(|c| matches!(c, b'0' | b'.')) => size,
        _ => &plain,
    };
    text.push_str(shown);
    shown.parse().unwrap_or(f64::NAN)
}

/// A whole number with a point before its last `decimals` digits.
fn push_digits(mut whole: u64, is_negative: bool, decimals: usize, text: &mut String) {
    let mut letters = [b'0'; 24];
    let (mut at, mut digit) = (letters.len(), 0);
    while whole > 0 || digit <= decimals {
        if digit == decimals && decimals > 0 {
            at -= 1;
            letters[at] = b'.';
        }
        at -= 1;
        letters[at] = b'0' + (whole % 10) as u8;
        (whole, digit) = (whole / 10, digit + 1);
    }
    if is_negative {
        text.push('-');
    }
    text.extend(letters[at..].iter().map(|letter| char::from(*letter)));
}

/// The shortest text that reads back as the same bits (a negative zero becomes `0`).
pub(crate) fn shortest(value: f64) -> String {
    let mut text = Vec::new();
    push_shortest(value, &mut text);
    String::from_utf8(text).expect("digits are ASCII")
}

/// An angle in degrees, by the shortest text that is the same angle but for one rounding: 120 deg are not 119.99999999999999 deg.
#[must_use]
pub fn degrees(radians: f64) -> f64 {
    /// All digits that a number has.
    const MOST: usize = 17;
    let exact = radians.to_degrees();
    let rounded = (0..MOST).filter_map(|decimals| format!("{exact:.decimals$}").parse::<f64>().ok());
    let is_same = |degrees: &f64| (degrees.to_radians() - radians).abs() <= f64::EPSILON * radians.abs();
    rounded.into_iter().find(is_same).unwrap_or(exact)
}

/// Puts [`shortest`] behind a text.
pub(crate) fn push_shortest(value: f64, text: &mut Vec<u8>) {
    let size = value.abs();
    // where JSON has the same form as Rust, in a third of the time
    if (1e-4..1e15).contains(&size) || (f64::MIN_POSITIVE..1e-5).contains(&size) {
        serde_json::to_writer(&mut *text, &value).expect("memory takes a number");
    } else {
        text.extend_from_slice(format!("{:?}", plain(value)).as_bytes());
    }
    if text.ends_with(b".0") {
        text.truncate(text.len() - 2);
    }
}

/// A length for people: to the micrometre, without trailing zeros, with a real minus sign.
pub fn dimension(millimetres: f64) -> String {
    let text = if millimetres.abs() > ROUNDING && !(1e-3..1e7).contains(&millimetres.abs()) {
        format!("{millimetres:.2e}")
    } else {
        fixed(millimetres, 3).trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    text.replace('-', "\u{2212}")
}

/// A bound of bands that are `step` wide, for people: as many decimals as the step needs, with a real minus sign.
pub fn levelled(value: f64, step: f64) -> String {
    let size = value.abs().max(step);
    let text = if value == 0.0 && step < 1e-3 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let decimals = (-step.log10()).ceil().clamp(0.0, 9.0) as usize;
        fixed(value, decimals)
    } else {
        format!("{:.1e}", plain(value))
    };
    text.replace('-', "\u{2212}")
}

/// A unit for people.
pub fn shown_unit(unit: &str) -> String {
    if unit == "1" {
        return "no unit".to_owned();
    }
    let powers = [("^2", "\u{b2}"), ("^3", "\u{b3}")];
    let micro = unit.replace("um", "\u{b5}m").replace("urad", "\u{b5}rad");
    powers.into_iter().fold(micro, |unit, (power, raised)| unit.replace(power, raised))
}

/// A text with numbers, with real minus signs before them.
pub fn with_minus(text: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let is_sign = |at: usize| {
        let behind = letters.get(at + 1).is_some_and(char::is_ascii_digit);
        letters[at] == '-' && behind && (at == 0 || letters[at - 1] == ' ')
    };
    (0..letters.len()).map(|at| if is_sign(at) { '\u{2212}' } else { letters[at] }).collect()
}

/// A residual for people: two significant digits.
pub fn residual(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_numbers_are_those_of_the_formatter() {
        let plain = |value: f64, decimals: usize| {
            let text = format!("{value:.decimals$}");
            let is_zero = text.bytes().all(|c| matches!(c, b'-' | b'0' | b'.'));
            if is_zero { text.trim_start_matches('-').to_owned() } else { text }
        };
        let mut values =
            vec![0.0, -0.0, 0.5, 1.5, 2.5, 0.125, -0.00005, 0.00005, 1e11, 9.99995, 1e15, 1e300, 5e-324, -99.99999];
        // numbers of all sizes, and decimal ties, which no binary number is but by chance
        let mut state = 1u64;
        for k in 0..20_000 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let part = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
            values.push(part * 10f64.powi(k % 14 - 3));
            values.push((part * 1e6).round() / 1e4 + 0.00005);
        }
        for value in values {
            for decimals in [0, 1, 3, 4, 5, 6, 9, 12] {
                let mut text = "x".to_owned();
                let number = push_fixed(value, decimals, &mut text);
                assert_eq!(text[1..], plain(value, decimals), "{value:e} {decimals}");
                assert_eq!(Ok(number), text[1..].parse(), "{value:e} {decimals}");
            }
        }
        assert_eq!([fixed(f64::NAN, 2), fixed(f64::NEG_INFINITY, 2)], ["NaN", "-inf"]);
    }

    #[test]
    fn shortest_reads_back_to_the_bit() {
        for value in [0.1, -1.0 / 3.0, 1e-17, 6.02e23, f64::MAX, f64::MIN_POSITIVE, 5e-324, 40.0, 1e21] {
            assert_eq!(shortest(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
        }
    }

    #[test]
    fn shortest_has_one_form_at_all_sizes() {
        for exponent in -320..=308 {
            for digits in ["1", "-2.5", "3.141592653589793"] {
                let value: f64 = format!("{digits}e{exponent}").parse().unwrap();
                let rust = format!("{value:?}");
                assert_eq!(shortest(value), rust.strip_suffix(".0").unwrap_or(&rust));
            }
        }
        assert_eq!(shortest(f64::NAN), "NaN");
    }

    #[test]
    fn shortest_has_no_ballast() {
        assert_eq!(shortest(-0.0), "0");
        assert_eq!(shortest(40.0), "40");
        assert_eq!(shortest(1e-300), "1e-300");
    }

    #[test]
    fn degrees_have_the_shortest_text_of_their_angle() {
        for (text, value) in
            [("120", 120.0), ("-400.4567", -400.4567), ("15.1004", 15.1004), ("500", 500.0), ("0", 0.0)]
        {
            let radians = f64::to_radians(value);
            assert_eq!(shortest(degrees(radians)), text);
        }
        for radians in [1.0, -0.3, 1e-9, 2e4] {
            assert!((degrees(radians).to_radians() - radians).abs() <= 1e-15 * f64::abs(radians));
        }
    }

    #[test]
    fn a_zero_has_no_sign() {
        assert_eq!(
            [-0.0, -4e-4, 4e-4, -6e-4, -12.0].map(|x| fixed(x, 3)),
            ["0.000", "0.000", "0.000", "-0.001", "-12.000"]
        );
        assert_eq!([-0.4, -0.6].map(|x| fixed(x, 0)), ["0", "-1"]);
    }

    #[test]
    fn levels_have_the_decimals_of_their_step() {
        assert_eq!(levelled(-0.04, 0.02), "\u{2212}0.04");
        assert_eq!(levelled(0.1 + 0.2, 0.1), "0.3");
        assert_eq!(levelled(-0.0, 5.0), "0");
        assert_eq!(levelled(-1e-17, 0.02), "0.00");
        assert_eq!(levelled(1500.0, 500.0), "1500");
        assert_eq!(levelled(2e-5, 1e-5), "2.0e\u{2212}5");
    }

    #[test]
    fn a_minus_is_one_before_numbers_only() {
        assert_eq!(with_minus("-3.2 mm, feed -1 a-1 - 2"), "\u{2212}3.2 mm, feed \u{2212}1 a-1 - 2");
        assert_eq!(shown_unit("um/mm^2"), "\u{b5}m/mm\u{b2}");
    }

    #[test]
    fn dimensions_are_for_people() {
        assert_eq!(dimension(-10.0), "\u{2212}10");
        assert_eq!(dimension(33.828_947_2), "33.829");
        assert_eq!(dimension(-0.0), "0");
        assert_eq!(dimension(-1.7e-15), "0");
        assert_eq!(dimension(100.0), "100");
        assert_eq!(dimension(2.5e-5), "2.50e\u{2212}5");
    }
}

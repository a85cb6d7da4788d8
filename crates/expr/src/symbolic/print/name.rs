//! How numbers and names are written.

use std::f64::consts::PI;

use crate::symbolic::print::Style;

/// A simple part of pi as such; any other number to the last bit: reading it back gives the same one.
pub(super) fn number(value: f64, style: Style) -> String {
    if let Some(part) = PartOfPi::of(value) {
        let sign = if value < 0.0 { "-" } else { "" };
        return format!("{sign}{}", part.text(style));
    }
    if style == Style::Text && !value.is_finite() {
        return value.to_string();
    }
    if value.is_nan() {
        return "\\mathrm{NaN}".to_string();
    }
    if value.is_infinite() {
        return if value < 0.0 { "-\\infty" } else { "\\infty" }.to_string();
    }
    if !has_exponent(value) {
        return value.to_string();
    }
    let plain = format!("{value:e}");
    match plain.split_once('e') {
        Some(("1", exponent)) if style == Style::Latex => format!("10^{{{exponent}}}"),
        Some(("-1", exponent)) if style == Style::Latex => format!("-10^{{{exponent}}}"),
        Some((mantissa, exponent)) if style == Style::Latex => {
            format!("{mantissa} \\cdot 10^{{{exponent}}}")
        }
        _ => plain,
    }
}

/// A product of pi and a fraction in lowest terms.
#[derive(Clone, Copy, Debug)]
pub(super) struct PartOfPi {
    pub(super) numerator: u8,
    pub(super) denominator: u8,
}

impl PartOfPi {
    /// The one that a number's magnitude is to one unit in the last place: conversions of units round that much.
    pub(super) fn of(value: f64) -> Option<PartOfPi> {
        const DENOMINATORS: [u8; 13] = [1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 18, 36, 180];
        const NUMERATORS: std::ops::RangeInclusive<f64> = 1.0..=36.0;
        let size = value.abs();
        DENOMINATORS.into_iter().find_map(|denominator| {
            let parts = f64::from(denominator);
            let numerator = (size * parts / PI).round();
            let product = numerator * PI / parts;
            let is_meant = NUMERATORS.contains(&numerator) && (product.next_down()..=product.next_up()).contains(&size);
            is_meant.then_some(PartOfPi { numerator: numerator as u8, denominator })
        })
    }

    fn text(self, style: Style) -> String {
        let (pi, times) = match style {
            Style::Text => ("pi", " * "),
            Style::Latex => ("\\pi", "\\,"),
        };
        let above = match self.numerator {
            1 => pi.to_string(),
            numerator => format!("{numerator}{times}{pi}"),
        };
        match (self.denominator, style) {
            (1, _) => above,
            (denominator, Style::Text) => format!("{above} / {denominator}"),
            (denominator, Style::Latex) => format!("\\frac{{{above}}}{{{denominator}}}"),
        }
    }
}

/// True for a number that is written with a power of ten.
pub(super) fn has_exponent(value: f64) -> bool {
    value != 0.0 && value.is_finite() && !(1e-4..1e7).contains(&value.abs())
}

/// A variable. In LaTeX one letter stays italic, `phi` and `φ` are the Greek letter, `r_b` and `t1` have an index, a longer
/// word stands upright, and dots stay: `m.radial_distance` is the word, a dot, the word.
pub(super) fn variable(name: &str, style: Style) -> String {
    if style == Style::Text {
        return name.to_string();
    }
    match name.rsplit_once('.') {
        Some((owner, own)) if !own.is_empty() => format!("{}.{}", upright(owner), symbol(own)),
        _ => symbol(name),
    }
}

/// A name without dots.
fn symbol(name: &str) -> String {
    if let Some((head, index)) = name.split_once('_')
        && let Some(letter) = letter(head)
        && !index.is_empty()
    {
        return format!("{letter}_{{{}}}", subscript(index));
    }
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let index = &name[stem.len()..];
    if stem.is_empty() || index.is_empty() {
        return letter(name).unwrap_or_else(|| upright(name));
    }
    let stem = letter(stem).unwrap_or_else(|| upright(stem));
    format!("{stem}_{{{index}}}")
}

fn subscript(index: &str) -> String {
    if index.chars().all(|c| c.is_ascii_digit()) {
        return index.to_string();
    }
    letter(index).unwrap_or_else(|| upright(index))
}

/// A name that is one letter, Latin or Greek.
fn letter(name: &str) -> Option<String> {
    let mut characters = name.chars();
    let only = characters.next().filter(|_| characters.next().is_none());
    if let Some(latin) = only.filter(char::is_ascii_alphabetic) {
        return Some(latin.to_string());
    }
    GREEK.iter().find(|(word, character)| *word == name || Some(*character) == only).map(|(word, _)| match *word {
        "phi" => "\\varphi".to_string(),
        word => format!("\\{word}"),
    })
}

/// Upright letters; what LaTeX would take for a command is escaped.
fn upright(word: &str) -> String {
    let mut escaped = String::with_capacity(word.len());
    for c in word.chars() {
        match c {
            '_' | '{' | '}' | '$' | '%' | '&' | '#' => escaped.extend(['\\', c]),
            '\\' => escaped.push_str("\\backslash "),
            '^' => escaped.push_str("\\wedge "),
            '~' => escaped.push_str("\\sim "),
            ' ' => escaped.push_str("\\ "),
            _ => escaped.push(c),
        }
    }
    format!("\\mathrm{{{escaped}}}")
}

/// The letters that LaTeX has commands for.
pub(crate) const GREEK: [(&str, char); 34] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Pi", 'Π'),
    ("Sigma", 'Σ'),
    ("Upsilon", 'Υ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
];

//! Names that all languages take for identifiers.

use crate::print::GREEK;

/// The names of one function: its own and those of its arguments, all different and free of what the body uses.
pub(super) struct Scope {
    function: String,
    arguments: Vec<String>,
}

impl Scope {
    pub(super) fn new(function: &str, arguments: &[String]) -> Scope {
        let function = freed(identifier(function), is_reserved);
        let mut scope = Scope { function, arguments: Vec::new() };
        for argument in arguments {
            let name = freed(identifier(argument), |name| scope.has(name) || is_reserved(name) || is_local(name));
            scope.arguments.push(name);
        }
        scope
    }

    pub(super) fn function(&self) -> &str {
        &self.function
    }

    pub(super) fn arguments(&self) -> &[String] {
        &self.arguments
    }

    fn has(&self, name: &str) -> bool {
        name == self.function || self.arguments.iter().any(|argument| argument == name)
    }
}

/// The name of a value that the body computes.
pub(super) fn local(number: usize) -> String {
    format!("t{number}")
}

/// The name of a curve's table.
pub(super) fn curve(number: usize) -> String {
    format!("curve{number}")
}

/// Names of the bodies' own.
fn is_local(name: &str) -> bool {
    const FIXED: [&str; 8] = ["values", "derivatives", "coefficients", "distance", "value", "slope", "power", "output"];
    let is_numbered = |prefix: &str| {
        name.strip_prefix(prefix).is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|c| c.is_ascii_digit()))
    };
    FIXED.contains(&name) || is_numbered("t") || is_numbered("curve")
}

/// With underscores behind it until it is free.
fn freed(mut name: String, is_taken: impl Fn(&str) -> bool) -> String {
    while is_taken(&name) {
        name.push('_');
    }
    name
}

/// ASCII letters, digits and underscores, a letter first: Greek letters by their names, all else as underscores.
fn identifier(text: &str) -> String {
    let mut name = String::with_capacity(text.len());
    for c in text.chars() {
        match GREEK.iter().find(|(_, letter)| *letter == c) {
            Some((word, _)) => name.push_str(word),
            None if c.is_ascii_alphanumeric() => name.push(c),
            None => name.push('_'),
        }
    }
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) { name } else { format!("n{name}") }
}

fn is_reserved(name: &str) -> bool {
    KEYWORDS.split_whitespace().chain(MATHEMATICS.split_whitespace()).any(|word| word == name)
}

/// Of C to C23, of C++ where headers are shared, of Rust, and of JavaScript with the globals that bodies use.
const KEYWORDS: &str = "
    abstract alignas alignof and arguments Array asm async auto await become bool box break case catch char class compl
    const constexpr continue crate debugger default delete do double dyn else enum eval explicit export extends extern f32
    f64 false final finally float fn for friend function gen goto if impl implements import in Infinity inline instanceof
    int interface let long loop macro main match Math mod module move mut mutable namespace NaN new not null nullptr
    Number operator or override package priv private protected pub public ref register requires restrict return self short
    signed sizeof static struct super switch template this throw trait true try type typedef typename typeof undefined
    union unsafe unsigned unsized use using var virtual void volatile where while with xor yield";

/// What `math.h` declares without suffix, as C and POSIX have it.
const MATHEMATICS: &str = "
    abs acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs fdim floor fma fmax fmin
    fmod frexp gamma hypot ilogb isfinite isinf isnan isnormal j0 j1 jn ldexp lgamma llrint llround log log10 log1p log2 logb lrint
    lround modf nan nearbyint nextafter nexttoward pow remainder remquo rint round scalbln scalbn signbit sin sinh sqrt tan tanh
    tgamma trunc y0 y1 yn";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        let cases = [
            ("phi", "phi"),
            ("φ", "phi"),
            ("m.cradle_angle", "m_cradle_angle"),
            ("19x62", "n19x62"),
            ("", "n"),
            ("_x", "n_x"),
            ("Wälz winkel", "W_lz_winkel"),
        ];
        for (text, expected) in cases {
            assert_eq!(identifier(text), expected);
        }
    }

    #[test]
    fn names_of_a_function_differ() {
        let arguments = ["phi", "φ", "t12", "values", "return", "sin", "f", "tilt"].map(String::from);
        let scope = Scope::new("f", &arguments);
        assert_eq!(scope.arguments(), ["phi", "phi_", "t12_", "values_", "return_", "sin_", "f_", "tilt"]);
        assert_eq!(Scope::new("main", &[]).function(), "main_");
    }
}

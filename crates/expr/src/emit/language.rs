//! How each language writes what all functions have: comment, head, numbers, tables, loops.

use std::fmt::Write;

use super::Language;
use super::names::Scope;

/// A function without its body.
pub(super) struct Frame<'a> {
    pub(super) language: Language,
    pub(super) scope: &'a Scope,
    pub(super) comment: &'a [String],
    pub(super) arrays: Arrays,
}

/// What a function fills.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrays {
    Values,
    ValuesAndDerivatives,
}

impl Frame<'_> {
    /// The text with the body's statements, for outputs of the given titles.
    pub(super) fn function(&self, titles: &[&str], statements: &[String]) -> String {
        let mut text = self.comment_text(titles);
        text += &self.head(titles.len());
        for line in statements.iter().flat_map(|statement| statement.lines()) {
            let _ = writeln!(text, "    {line}");
        }
        text + "}\n"
    }

    fn comment_text(&self, titles: &[&str]) -> String {
        let mut text = String::from("/**\n");
        let outputs = format!("values: {}", titles.join(", "));
        let slopes = match self.scope.arguments() {
            [only] => format!("derivatives: of these by {only}, in the same order"),
            several => format!("derivatives: of these, each by {}", several.join(", ")),
        };
        let slopes = Some(&*slopes).filter(|_| self.arrays == Arrays::ValuesAndDerivatives);
        for line in self.comment.iter().map(String::as_str).chain([&*outputs]).chain(slopes) {
            let _ = writeln!(text, "{}", format!(" * {}", inert(line)).trim_end());
        }
        text + " */\n"
    }

    fn head(&self, outputs: usize) -> String {
        let (name, arguments) = (self.scope.function(), self.scope.arguments());
        let arrays = match self.arrays {
            Arrays::Values => vec![("values", outputs)],
            Arrays::ValuesAndDerivatives => vec![("values", outputs), ("derivatives", outputs * arguments.len())],
        };
        let inputs = arguments.iter().map(|argument| self.language.input(argument));
        let arrays = arrays.into_iter().map(|(array, length)| self.language.output(array, length));
        let list = inputs.chain(arrays).collect::<Vec<_>>().join(", ");
        match self.language {
            Language::C => format!("void {name}({list})\n{{\n"),
            Language::Rust => format!("#[allow(non_snake_case)]\npub fn {name}({list}) {{\n"),
            Language::JavaScript => format!("export function {name}({list}) {{\n"),
        }
    }
}

/// Text that cannot end a comment, begin one in it, leave its line or turn the direction in which it is read: letters and digits of any
/// script and the signs of ASCII, of which none escapes the end of the line.
fn inert(text: &str) -> String {
    let settled = |c: char| match c {
        ' '..='~' => c,
        c if c.is_control() => ' ',
        c if c.is_alphanumeric() => c,
        _ => '_',
    };
    let line: String = text.chars().map(settled).collect();
    line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
}

impl Language {
    /// An argument that is a number.
    fn input(self, name: &str) -> String {
        match self {
            Language::C => format!("double {name}"),
            Language::Rust => format!("{name}: f64"),
            Language::JavaScript => name.to_string(),
        }
    }

    /// An argument that is an array to fill.
    fn output(self, name: &str, length: usize) -> String {
        match self {
            Language::C => format!("double {name}[{length}]"),
            Language::Rust => format!("{name}: &mut [f64; {length}]"),
            Language::JavaScript => name.to_string(),
        }
    }

    /// A number that reads back as the same bits.
    pub(super) fn number(self, value: f64) -> String {
        match (self, value) {
            (Language::C, value) if value.is_nan() => "NAN".to_string(),
            (Language::C, f64::INFINITY) => "INFINITY".to_string(),
            (Language::C, f64::NEG_INFINITY) => "-INFINITY".to_string(),
            (Language::Rust, value) if value.is_nan() => "f64::NAN".to_string(),
            (Language::Rust, f64::INFINITY) => "f64::INFINITY".to_string(),
            (Language::Rust, f64::NEG_INFINITY) => "f64::NEG_INFINITY".to_string(),
            (Language::JavaScript, value) if value.is_nan() => "NaN".to_string(),
            (Language::JavaScript, f64::INFINITY) => "Infinity".to_string(),
            (Language::JavaScript, f64::NEG_INFINITY) => "-Infinity".to_string(),
            (_, value) => format!("{value:?}"),
        }
    }

    /// A constant of the body.
    pub(super) fn definition(self, name: &str, value: &str) -> String {
        match self {
            Language::C => format!("const double {name} = {value};"),
            Language::Rust => format!("let {name} = {value};"),
            Language::JavaScript => format!("const {name} = {value};"),
        }
    }

    /// A statement that uses a name for nothing, where compilers want one.
    pub(super) fn unused(self, name: &str) -> Option<String> {
        match self {
            Language::C => Some(format!("(void){name};")),
            Language::Rust => Some(format!("let _ = {name};")),
            Language::JavaScript => None,
        }
    }

    /// A table of numbers, one row a line; all rows have the same length.
    pub(super) fn table(self, name: &str, rows: &[Vec<f64>]) -> String {
        let (height, width) = (rows.len(), rows.first().map_or(0, Vec::len));
        let [open, close] = match self {
            Language::C => ["{", "}"],
            Language::Rust | Language::JavaScript => ["[", "]"],
        };
        let mut text = match self {
            Language::C => format!("static const double {name}[{height}][{width}] = {open}\n"),
            Language::Rust => format!("let {name}: &'static [[f64; {width}]; {height}] = &{open}\n"),
            Language::JavaScript => format!("const {name} = {open}\n"),
        };
        for row in rows {
            let numbers: Vec<String> = row.iter().map(|value| self.number(*value)).collect();
            let _ = writeln!(text, "    {open} {} {close},", numbers.join(", "));
        }
        text + close + ";"
    }

    /// Value and slope of the polynomials whose `coefficients` are a table, highest power first.
    pub(super) fn horner(self, argument: &str, reference: f64, powers: usize, outputs: usize) -> String {
        let template = match self {
            Language::C => C_HORNER,
            Language::Rust => RUST_HORNER,
            Language::JavaScript => JAVASCRIPT_HORNER,
        };
        template
            .replace("REFERENCE", &self.number(reference))
            .replace("POWERS", &powers.to_string())
            .replace("OUTPUTS", &outputs.to_string())
            .replace("ARGUMENT", argument)
    }
}

const C_HORNER: &str = "\
const double distance = ARGUMENT - REFERENCE;
double value[OUTPUTS] = { 0.0 };
double slope[OUTPUTS] = { 0.0 };
for (int power = 0; power < POWERS; ++power) {
    for (int output = 0; output < OUTPUTS; ++output) {
        slope[output] = slope[output] * distance + value[output];
        value[output] = value[output] * distance + coefficients[power][output];
    }
}
for (int output = 0; output < OUTPUTS; ++output) {
    values[output] = value[output];
    derivatives[output] = slope[output];
}";

const RUST_HORNER: &str = "\
let distance = ARGUMENT - REFERENCE;
let mut value = [0.0; OUTPUTS];
let mut slope = [0.0; OUTPUTS];
for power in coefficients {
    for output in 0..OUTPUTS {
        slope[output] = slope[output] * distance + value[output];
        value[output] = value[output] * distance + power[output];
    }
}
*values = value;
*derivatives = slope;";

const JAVASCRIPT_HORNER: &str = "\
const distance = ARGUMENT - REFERENCE;
const value = new Array(OUTPUTS).fill(0.0);
const slope = new Array(OUTPUTS).fill(0.0);
for (const power of coefficients) {
    for (let output = 0; output < OUTPUTS; ++output) {
        slope[output] = slope[output] * distance + value[output];
        value[output] = value[output] * distance + power[output];
    }
}
for (let output = 0; output < OUTPUTS; ++output) {
    values[output] = value[output];
    derivatives[output] = slope[output];
}";

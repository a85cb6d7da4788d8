//! Definitions in words: how they are written, what they amount to, what is said of them.

use flank_chain_dsl::{Dimension, KnownValue, NameKind, Span, Symbol, SymbolId, Target, WordKind, unit_size};

use crate::language::editor::analysis::Analysis;
use crate::project::units;

/// Digits of a value that people read at a glance.
const DIGITS: i32 = 5;

impl Analysis {
    /// How a definition is written in one line, with its value: `depth : length = 2 mm (in 0 mm .. 5 mm)`.
    pub(super) fn signature(&self, id: SymbolId) -> String {
        let symbol = self.index.symbol(id);
        let name = self.name(id);
        match symbol.kind {
            NameKind::Machine | NameKind::Tool | NameKind::Job => self.head(id),
            NameKind::Function => format!("fn {}", self.function_head(symbol)),
            NameKind::Axis => format!("axis {}", self.one_line(symbol.extent)),
            NameKind::Frame => format!("frame {}", self.one_line(symbol.extent)),
            NameKind::MachineInstance | NameKind::ToolInstance => {
                let definition = symbol.definition.map_or("…", |definition| self.name(definition));
                format!("{} {name} = {definition}", symbol.kind.described())
            }
            NameKind::Value => match self.shown_values(symbol).as_slice() {
                [value] => format!("let {name} = {value}"),
                _ => format!("let {name}{} = {}", self.dimension_of_let(symbol), self.written_value(symbol)),
            },
            NameKind::Parameter
            | NameKind::MachineError
            | NameKind::Motion
            | NameKind::Unknown
            | NameKind::Argument
            | NameKind::SurfaceParameter
                if symbol.dimension.is_some() =>
            {
                let dimension = symbol.dimension.map_or("", |span| self.sources.text(span));
                let value = match self.shown_values(symbol).as_slice() {
                    [value] => format!(" = {value}"),
                    _ => String::new(),
                };
                let range = symbol.range.map_or(String::new(), |span| format!(" (in {})", self.one_line(span)));
                format!("{name} : {dimension}{value}{range}")
            }
            _ => {
                let whole = self.one_line(symbol.extent);
                let head = whole.split(" {").next().unwrap_or_default();
                format!("{} {head}", symbol.kind.described())
            }
        }
    }

    /// ` : angle` of a `let` that amounts to no one number.
    fn dimension_of_let(&self, symbol: &Symbol) -> String {
        let known = self.index.values_of(symbol).first().map(|value| value.dimension);
        let found = self.index.dimension_of(symbol).or(known);
        found.map_or(String::new(), |dimension| format!(" : {dimension}"))
    }

    fn written_value(&self, symbol: &Symbol) -> String {
        symbol.value.map_or(String::new(), |value| self.one_line(value))
    }

    /// The values that a definition has, each once.
    pub(super) fn shown_values(&self, symbol: &Symbol) -> Vec<String> {
        let mut shown: Vec<String> = Vec::new();
        for value in self.counting(symbol) {
            let text = self.shown(value);
            if !shown.contains(&text) {
                shown.push(text);
            }
        }
        shown
    }

    /// The values that jobs give; where none does, that of the definition by itself.
    pub(super) fn counting(&self, symbol: &Symbol) -> Vec<&KnownValue> {
        let all = self.index.values_of(symbol);
        let owner = symbol.owner.map(|owner| self.name(owner));
        let of_jobs: Vec<&KnownValue> =
            all.iter().filter(|value| Some(value.of.as_str()) != owner || self.is_of_job(symbol)).collect();
        if of_jobs.is_empty() { all.iter().collect() } else { of_jobs }
    }

    fn is_of_job(&self, symbol: &Symbol) -> bool {
        symbol.owner.is_some_and(|owner| self.kind(owner) == NameKind::Job)
    }

    /// A value in the unit in which it is written, where that is one.
    pub(super) fn shown(&self, value: &KnownValue) -> String {
        // they are in the order of their places
        let entries = &self.index.entries;
        let written = value.written;
        let from = entries.partition_point(|entry| (entry.span.file, entry.span.start) < (written.file, written.start));
        let within = entries[from..]
            .iter()
            .take_while(|entry| entry.span.file == written.file && entry.span.start <= written.end);
        let units =
            within.filter(|entry| entry.target == Target::Word(WordKind::Unit) && entry.span.end <= written.end);
        let mut units: Vec<&str> = units.map(|entry| self.sources.text(entry.span)).collect();
        units.dedup();
        if let [unit] = units[..]
            && let Some((size, dimension)) = unit_size(unit)
            && dimension == value.dimension
        {
            return format!("{} {unit}", rounded(value.value / size));
        }
        shown(value.value, value.dimension)
    }

    /// A part of a text without line ends.
    pub(super) fn one_line(&self, span: Span) -> String {
        self.sources.text(span).split_whitespace().collect::<Vec<_>>().join(" ")
    }

    fn head(&self, id: SymbolId) -> String {
        let symbol = self.index.symbol(id);
        let kind = symbol.kind.described();
        match symbol.definition {
            Some(parent) => format!("{kind} {} extends {}", self.name(id), self.name(parent)),
            None => format!("{kind} {}", self.name(id)),
        }
    }

    /// `name(a: length) -> angle`
    fn function_head(&self, symbol: &Symbol) -> String {
        let text = &self.sources.file(symbol.name.file).text;
        let written = &text[symbol.name.start as usize..symbol.extent.end as usize];
        let mut depth = 0;
        for (at, letter) in written.char_indices() {
            match letter {
                '(' => depth += 1,
                ')' => depth -= 1,
                '=' | '{' if depth == 0 => {
                    return written[..at].split_whitespace().collect::<Vec<_>>().join(" ");
                }
                _ => {}
            }
        }
        self.sources.text(symbol.name).to_string()
    }

    /// The lines of documentation above a definition, or at the top of a file.
    pub(super) fn documentation(&self, symbol: &Symbol) -> Vec<String> {
        let text = &self.sources.file(symbol.name.file).text;
        let before = &text[..symbol.name.start as usize];
        // the line of the definition itself comes first
        let above = before.rsplit(['\n', '\r']).skip(1).map(str::trim);
        let lines = above.take_while(|line| line.starts_with("///") && !line.starts_with("////"));
        let mut lines: Vec<String> = lines.map(|line| line[3..].trim().to_string()).collect();
        lines.reverse();
        lines
    }
}

/// A value in mm, degrees or its own unit, as people read it.
pub(super) fn shown(value: f64, dimension: Dimension) -> String {
    let value = units::shown(dimension, value);
    format!("{} {}", rounded(value), units::whole_symbol(dimension)).trim_end().to_string()
}

/// Five digits, fewer where they say the same.
pub(super) fn rounded(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{}", if value == 0.0 { 0.0 } else { value });
    }
    let size = value.abs().log10().floor() as i32;
    if !(-4..=8).contains(&size) {
        let text = format!("{value:.*e}", (DIGITS - 1) as usize);
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        let digits = digits.trim_end_matches('0').trim_end_matches('.');
        return format!("{digits}e{power}");
    }
    let decimals = (DIGITS - 1 - size).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn values_have_five_digits() {
        for (value, text) in [
            (97.95940290780507, "97.959"),
            (0.0, "0"),
            (-0.0, "0"),
            (2.0, "2"),
            (0.001, "0.001"),
            (-0.00130617657, "-0.0013062"),
            (123_456.0, "123456"),
            (1.5e-7, "1.5e-7"),
            (1e12, "1e12"),
        ] {
            assert_eq!(rounded(value), text);
        }
    }
}

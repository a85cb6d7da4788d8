//! Units behind a number: those of the dimension that is wanted.

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{Dimension, NameKind, SymbolId, unit_size};

use super::{Around, CompletionKind, List};
use crate::language::editor::analysis::Analysis;
use crate::language::editor::cursor::Cursor;

/// Coordinates of points that are lengths.
const LENGTHS: [&str; 4] = ["x", "y", "z", "rho"];

/// `2 mm/`: the unit below the line.
pub(super) fn is_ratio(cursor: &Cursor<'_>) -> bool {
    numerator(cursor).is_some()
}

/// The dimension of the unit above the line.
fn numerator(cursor: &Cursor<'_>) -> Option<Dimension> {
    match cursor.before.as_slice() {
        [.., number, unit, "/"] if number.starts_with(|letter: char| letter.is_ascii_digit()) => {
            unit_size(unit).map(|(_, dimension)| dimension)
        }
        _ => None,
    }
}

impl Analysis {
    pub(super) fn units(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        let wanted = self.wanted_dimension(cursor, around);
        let wanted = wanted.as_deref().map(|text| text.split_whitespace().collect::<String>());
        let above = numerator(cursor);
        for unit in vocabulary().units {
            let Some((_, dimension)) = unit_size(unit) else { continue };
            let fits = match (above, wanted.as_deref()) {
                // a length by a length is a number, which needs no unit
                (Some(above), _) => above != dimension,
                (None, Some(text)) if text.starts_with("length") => dimension == Dimension::LENGTH,
                (None, Some(text)) if text.starts_with("angle") => dimension == Dimension::ANGLE,
                (None, Some("number" | "count")) => false,
                _ => true,
            };
            if fits {
                list.add(unit, CompletionKind::Unit, format!("unit of {dimension}"), 0);
            }
        }
    }

    /// The dimension of what is being written, in the words of the language.
    pub(super) fn wanted_dimension(&self, cursor: &Cursor<'_>, around: &Around) -> Option<String> {
        if let Some(call) = cursor.call()
            && let Some(argument) = call.argument
            && let Some(definition) = self.definition_named(around, call.name)
        {
            return self.written_dimension(self.named(Some(definition), argument)?);
        }
        match cursor.opening() {
            "drive" | "fix" | "couple" => self.dimension_of_axis(cursor, around),
            _ if cursor.block() == "sample" => self.dimension_of_entry(cursor, around),
            "expect" => self.dimension_compared(cursor, around),
            word if is_declaration(word) => declared(cursor),
            _ => None,
        }
    }

    fn written_dimension(&self, id: SymbolId) -> Option<String> {
        match self.kind(id) {
            NameKind::Axis => Some(self.dimension_of(id).to_string()),
            _ => self.index.symbol(id).dimension.map(|span| self.sources.text(span).to_string()),
        }
    }

    /// An axis tells by its word what it is.
    fn dimension_of(&self, axis: SymbolId) -> &'static str {
        let symbol = self.index.symbol(axis);
        let behind = &self.sources.file(symbol.name.file).text[symbol.name.end as usize..];
        let kind = behind.trim_start().trim_start_matches(':').trim_start();
        if kind.starts_with("rotary") { "angle" } else { "length" }
    }

    /// Of the axis whose law is written: the one with the number of the law.
    fn dimension_of_axis(&self, cursor: &Cursor<'_>, around: &Around) -> Option<String> {
        let equals = cursor.statement.iter().position(|said| *said == "=")?;
        let laws =
            cursor.calls.is_empty().then(|| cursor.statement[equals..].iter().filter(|said| **said == ",").count());
        let mut targets = cursor.statement[1..equals].split(|said| *said == ",");
        let axis = match targets.nth(laws.unwrap_or(0))? {
            [axis] => self.named(around.item, axis)?,
            [machine, ".", axis] => {
                let machine = self.named(around.item, machine)?;
                self.named(self.index.symbol(machine).definition, axis)?
            }
            _ => return None,
        };
        Some(self.dimension_of(axis).to_string())
    }

    /// Of the coordinate whose values are written in a sample.
    fn dimension_of_entry(&self, cursor: &Cursor<'_>, around: &Around) -> Option<String> {
        let colon = cursor.statement.iter().rposition(|said| *said == ":")?;
        let name = *cursor.statement.get(colon.checked_sub(1)?)?;
        if cursor.last() != ":" && cursor.statement[colon..].contains(&"by") {
            return Some("count".to_string());
        }
        if LENGTHS.contains(&name) {
            return Some("length".to_string());
        }
        match name {
            "polar_angle" => Some("angle".to_string()),
            "nx" | "ny" | "nz" | "profilewise" | "lengthwise" => Some("number".to_string()),
            _ => {
                let symbol = self.sampled_unknowns(cursor, around).into_iter().find(|id| self.name(*id) == name)?;
                self.written_dimension(symbol)
            }
        }
    }

    /// Of what an expectation compares with: the unit or the name that stands on the other side.
    fn dimension_compared(&self, cursor: &Cursor<'_>, around: &Around) -> Option<String> {
        let near = cursor.statement.iter().rposition(|said| ["near", "within"].contains(said))?;
        let before = &cursor.statement[..near];
        let by_unit = before.iter().rev().find_map(|said| unit_size(said)).map(|(_, dimension)| dimension);
        match by_unit {
            Some(Dimension::LENGTH) => Some("length".to_string()),
            Some(Dimension::ANGLE) => Some("angle".to_string()),
            _ => match before.iter().rev().find(|said| said.starts_with(char::is_alphabetic))? {
                name if LENGTHS.contains(name) => Some("length".to_string()),
                &("turn" | "lag" | "polar_angle") => Some("angle".to_string()),
                name => self.written_dimension(self.named(around.item, name)?),
            },
        }
    }
}

/// What a declaration says itself.
fn declared(cursor: &Cursor<'_>) -> Option<String> {
    let colon = cursor.statement.iter().rposition(|said| *said == ":")?;
    let said = cursor.statement[colon + 1..].iter().take_while(|said| !matches!(**said, "in" | "=" | "step"));
    match said.copied().collect::<String>().as_str() {
        "linear" => Some("length".to_string()),
        "rotary" => Some("angle".to_string()),
        "" => None,
        said => Some(said.to_string()),
    }
}

fn is_declaration(word: &str) -> bool {
    ["param", "error", "motion", "unknown", "axis", "surface"].contains(&word)
}

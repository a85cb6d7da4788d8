//! Words that are no units, and units and other words that are no names.

use crate::diagnostics::Diagnostic;
use crate::diagnostics::source::Span;
use crate::diagnostics::spelling::closest;

use super::super::expected;
use super::super::grammar::Rule;
use super::super::pieces;
use super::super::scan::Kind;
use super::super::words::{self, Reserved};
use super::Mistake;

impl<'s> Mistake<'s> {
    /// `job first-gear {`
    pub(super) fn hyphen_in_name(&self) -> Option<Diagnostic> {
        let first = self.range.start + 1;
        let is_part = |index: usize| {
            self.touches(index)
                && (self.scan.say(index) == "-" || matches!(self.scan.kind(index), Some(Kind::Word | Kind::Number)))
        };
        let defines = words::defines(self.scan.say(self.range.start)) && self.scan.is_name(first);
        let is_hyphen = self.found == first + 1 && self.say() == "-" && is_part(self.found) && is_part(self.found + 1);
        (defines && is_hyphen).then(|| {
            let end = (self.found..self.range.end).find(|&index| !is_part(index)).unwrap_or(self.range.end);
            let whole = self.scan.extent(first..end);
            let name = self.scan.text[whole.start as usize..whole.end as usize].replace('-', "_");
            let report = self.here("a name has no `-`");
            report.writing(whole, &name)
        })
    }

    /// `rack(module)`
    pub(super) fn positional(&self) -> Option<Diagnostic> {
        let before = self.found.checked_sub(1).filter(|&index| self.scan.is_name(index))?;
        let of_settings = matches!(self.scan.say(self.range.start), "machine" | "tool" | "job");
        let is_whole = of_settings && matches!(self.say(), ")" | ",") && self.expected.contains(&Rule::colon);
        let is_first = is_whole && matches!(self.scan.say(before.wrapping_sub(1)), "(" | ",");
        let name = self.scan.say(before);
        is_first.then(|| {
            let written = format!("{name}: {name}");
            self.unexpected()
                .help(format!(
                    "settings are given by their names, as in `name: value`; `{written}` where one has this name"
                ))
                .cure(format!("write `{written}`"), self.scan.place(before), written)
        })
    }

    /// The units of the dimension that is declared before a number, where nothing but the number can be of it; all of them elsewhere.
    fn units_that_fit(&self) -> Vec<&'static str> {
        let is_product = |index: usize| matches!(self.scan.say(index), "*" | "/" | "^");
        let begins = |index: &usize| matches!(self.scan.say(*index), ":" | "(" | "[" | "," | "{");
        let is_alone = !(self.found.saturating_sub(2)..self.found).chain([self.found + 1]).any(is_product);
        let colon = (self.range.start..self.found).rev().find(begins).filter(|&index| self.scan.say(index) == ":");
        let declared = colon.filter(|&index| is_alone && !is_product(index + 2)).map(|index| self.scan.say(index + 1));
        let wanted = match declared {
            Some("length" | "linear") => Some("length"),
            Some("angle" | "rotary") => Some("angle"),
            _ => None,
        };
        let units = words::UNITS.iter().copied();
        units.filter(|unit| wanted.is_none_or(|wanted| dimension_of(unit) == wanted)).collect()
    }

    /// `20 mmm`
    pub(super) fn not_a_unit(&self) -> Option<Diagnostic> {
        let unit = self.kind_before() == Some(Kind::Number)
            && !self.leads()
            && !self.ends()
            && self.scan.is_name(self.found)
            && self.scan.say(self.found + 1) != ":"
            && self.expected.iter().any(|rule| matches!(rule, Rule::unit_word | Rule::infix));
        let is_elsewhere = ELSEWHERE.contains(&self.say());
        let like = closest(self.say(), words::UNITS.iter().copied()).or_else(|| of_same_letters(self.say()));
        let like = like.filter(|_| !is_elsewhere);
        if !unit || like.is_none() && self.misspelt(&expected::relevant(self.expected.clone())).is_some() {
            return None;
        }
        let fitting = self.units_that_fit();
        let is_value = !(is_elsewhere || self.touches(self.found) && is_part_of_number(self.say()));
        let product = match is_value {
            true => format!(
                "; a product is written `{} * {}`",
                self.scan.short(self.found - 1),
                self.scan.short(self.found)
            ),
            false => String::new(),
        };
        let help = match like {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("the units are {}{product}", fitting.join(", ")),
        };
        let mut diagnostic = self.here(format!("{} is not a unit", self.scan.quote(self.found))).help(help);
        if like.is_none() && is_value {
            let gap = Span { end: self.place().start, ..self.behind(self.found - 1) };
            diagnostic = diagnostic.cure("write `*`", gap, " * ");
        }
        Some(match like {
            Some(meant) => diagnostic.cure(format!("write `{meant}`"), self.place(), meant),
            None => fitting
                .into_iter()
                .fold(diagnostic, |diagnostic, unit| diagnostic.cure(format!("write `{unit}`"), self.place(), unit)),
        })
    }

    /// A word of the language where a name or a value belongs.
    pub(super) fn not_a_name(&self) -> Option<Diagnostic> {
        let word = self.say();
        let reserved = words::reserved(word).filter(|_| self.kind() == Some(Kind::Word))?;
        let wants = |rules: &[Rule]| rules.iter().any(|rule| self.expected.contains(rule));
        if reserved == Reserved::Unit && wants(&[Rule::dimension, Rule::dimension_factor]) {
            let dimension = dimension_of(word);
            return Some(self.here(format!("`{word}` is a unit, not a dimension")).writing(self.place(), dimension));
        }
        let name = wants(&[Rule::name, Rule::path]);
        let value = wants(&[Rule::expression, Rule::value, Rule::argument]);
        if let Some((word, is_new)) = self.keyword_as_name() {
            let message = format!("`{word}` is a word of the language and cannot be a name");
            let other = format!("{word}_{}", expected::noun(self.scan.say(self.range.start)));
            let help = format!("choose another, such as `{other}`");
            return Some(match is_new {
                true => self.here(message).help(help).cure(format!("write `{other}`"), self.place(), other),
                false => self.here(message),
            });
        }
        match reserved {
            Reserved::Unit if name => Some(self.here(format!("`{word}` is a unit and cannot be a name"))),
            Reserved::Unit if value || wants(&[Rule::infix]) => {
                let written = if value { format!("1 {word}") } else { format!("* 1 {word}") };
                Some(
                    self.here(format!("the unit `{word}` does not follow a number"))
                        .help(format!("a unit follows a number, as in `1 {word}`"))
                        .cure(format!("write `{written}`"), self.place(), written),
                )
            }
            Reserved::Dimension if name || value => {
                Some(self.here(format!("`{word}` is a dimension and cannot be a name")))
            }
            _ => None,
        }
    }

    /// A word of the language itself where a name belongs, and whether that is to be a new one.
    pub(in super::super) fn keyword_as_name(&self) -> Option<(&'s str, bool)> {
        let word = self.say();
        let wants = |rules: &[Rule]| rules.iter().any(|rule| self.expected.contains(rule));
        let is_value = wants(&[Rule::expression, Rule::value, Rule::argument]) && words::begins_statement(word);
        let is_one = self.kind() == Some(Kind::Word)
            && words::reserved(word) == Some(Reserved::Keyword)
            && !(self.found > self.range.start && self.introduces())
            && (is_value || wants(&[Rule::name, Rule::path]));
        let is_new = self.found == self.range.start + 1 && words::defines(self.scan.say(self.range.start));
        is_one.then_some((word, is_new))
    }

    /// Whether the word does what it is there for, so that something is missing before it.
    fn introduces(&self) -> bool {
        if words::begins_statement(self.say()) {
            pieces::begins(self.scan, self.found)
        } else {
            self.scan.is_name(self.found + 1)
        }
    }
}

fn dimension_of(unit: &str) -> &'static str {
    match unit {
        "deg" | "rad" | "arcmin" | "arcsec" | "rev" => "angle",
        _ => "length",
    }
}

/// Units that the language does not have: no names of values.
const ELSEWHERE: [&str; 8] = ["m", "km", "dm", "nm", "gon", "rpm", "s", "min"];

/// `e`, `x10`: what other languages write behind the first digits of a number.
fn is_part_of_number(word: &str) -> bool {
    let mut letters = word.chars();
    letters.next().is_some_and(|first| matches!(first, 'e' | 'E' | 'x' | 'X'))
        && letters.all(|of| of.is_ascii_hexdigit())
}

/// The unit whose letters came in another order.
fn of_same_letters(word: &str) -> Option<&'static str> {
    let sorted = |word: &str| {
        let mut letters: Vec<char> = word.chars().take(10).collect();
        letters.sort_unstable();
        letters
    };
    words::UNITS.iter().copied().find(|unit| sorted(unit) == sorted(word))
}

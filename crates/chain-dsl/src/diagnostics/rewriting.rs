//! Changes of a text whose words stand in the text itself: what they write is known once all texts are at hand.

use crate::diagnostics::Cure;
use crate::diagnostics::source::{Sources, Span};

/// A change of the text that mends a finding.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Rewriting {
    /// A value gets its unit.
    Unit(Span, &'static str),
    /// A value is divided by one of a unit.
    Per(Span, &'static str),
    /// Two places change their words.
    Exchange([Span; 2]),
    /// An entry leaves its list; nothing of a list of one.
    Entry(Span),
    /// A place goes, and this word before it.
    Without(&'static str, Span),
    /// The word before a place becomes another one.
    WordBefore(&'static str, Span, &'static str),
    /// The first of these words in a place becomes another one.
    Word(Span, String, String),
    /// Of all entries of a list these stand in it, in this order.
    Ordered(Span, Vec<Span>),
    /// The entries of a list, with brackets unless these stand around it.
    Entries(Span, String),
    /// The vector behind an argument's name in a place becomes another one.
    Vector(&'static str, Span, String),
    /// What is called so goes, with all of its statement and what is said of it above.
    Statement(Span, Span),
    /// The machine or the tool of this name and definition gets further settings.
    Settings(Span, String, String),
    /// The pose whose first frame stands in a place says where one more axis stands.
    Pose(Span, String),
    /// The `close` whose frames stand in a place says more.
    Closing(Span, String),
}

impl Rewriting {
    /// Nothing where the text is not written as such a change expects it.
    pub(crate) fn cure(&self, sources: &Sources) -> Option<Cure> {
        let text = |span: Span| sources.text(span);
        let whole = |span: Span| sources.file(span.file).text.as_str();
        let writing = |span: Span, text: String| Cure { title: format!("write `{text}`"), span, replacement: text };
        match self {
            Rewriting::Unit(span, unit) => Some(writing(*span, with_unit(text(*span), unit))),
            Rewriting::Per(span, unit) => Some(writing(*span, per_unit(text(*span), unit))),
            Rewriting::Exchange([first, second]) => {
                let between = Span { start: first.end, end: second.start, ..*first };
                Some(writing(first.to(*second), [text(*second), text(between), text(*first)].concat()))
            }
            Rewriting::Entry(span) => {
                let span = with_comma(whole(*span), *span)?;
                Some(leaving_out(text(span).trim_matches([',', ' ', '\n', '\r', '\t']), span))
            }
            Rewriting::Without(word, span) => {
                let before = whole(*span)[..span.start as usize].trim_end().strip_suffix(word)?;
                let start = before.trim_end().len() as u32;
                Some(leaving_out(word, Span { start, ..*span }))
            }
            Rewriting::WordBefore(word, span, other) => {
                let before = whole(*span)[..span.start as usize].trim_end();
                let start = before.strip_suffix(word)?.len() as u32;
                Some(writing(Span { start, end: before.len() as u32, ..*span }, (*other).to_string()))
            }
            Rewriting::Word(span, word, other) => {
                let start = span.start + text(*span).find(word.as_str())? as u32;
                Some(writing(Span { start, end: start + word.len() as u32, ..*span }, other.clone()))
            }
            Rewriting::Ordered(all, entries) => {
                let list: Vec<&str> = entries.iter().map(|span| text(*span)).collect();
                Some(writing(*all, list.join(", ")))
            }
            Rewriting::Entries(span, list) => {
                let is_inside = whole(*span)[..span.start as usize].trim_end().ends_with('[');
                Some(writing(*span, if is_inside { list.clone() } else { format!("[{list}]") }))
            }
            Rewriting::Vector(argument, span, point) => {
                let inside = text(*span);
                let behind = inside.find(argument)? + argument.len();
                let start = behind + inside[behind..].len() - inside[behind..].trim_start().len();
                let length = length_of_vector(&inside[start..])?;
                let start = span.start + start as u32;
                Some(writing(Span { start, end: start + length as u32, ..*span }, point.clone()))
            }
            Rewriting::Statement(name, span) => {
                let span = whole_statement(whole(*span), *span)?;
                Some(Cure { title: format!("leave `{}` out", text(*name)), span, replacement: String::new() })
            }
            Rewriting::Settings(name, definition, settings) => {
                let (at, written) = further_settings(&whole(*name)[name.end as usize..], definition, settings)?;
                let at = name.end + at as u32;
                let title = format!("add `{settings}`");
                Some(Cure { title, span: Span { start: at, end: at, ..*name }, replacement: written })
            }
            Rewriting::Pose(frame, axis) => {
                let behind = &whole(*frame)[frame.end as usize..];
                let list = behind.find(" at (").filter(|at| !behind[..*at].contains("within"))? + " at (".len();
                let at = frame.end + list as u32;
                let comma = if behind[list..].trim_start().starts_with(')') { "" } else { ", " };
                let span = Span { start: at, end: at, ..*frame };
                Some(Cure { title: format!("add `{axis}`"), span, replacement: format!("{axis}{comma}") })
            }
            Rewriting::Closing(span, keep) => {
                let end = end_of_close(whole(*span), span.end as usize) as u32;
                let span = Span { start: end, end, ..*span };
                Some(Cure { title: format!("add `{keep}`"), span, replacement: format!(" {keep}") })
            }
        }
    }
}

fn leaving_out(what: &str, span: Span) -> Cure {
    Cure { title: format!("leave `{what}` out"), span, replacement: String::new() }
}

/// Units stand behind numbers only.
fn with_unit(text: &str, unit: &str) -> String {
    let is_number =
        text.trim_start_matches('-').chars().all(|letter| letter.is_ascii_digit() || ".eE".contains(letter));
    if is_number { format!("{text} {unit}") } else { format!("({text}) * 1 {unit}") }
}

/// `5 mm/rev`, `e * cos(g) / 1 rad`, `(a + b) / 1 rad`.
fn per_unit(text: &str, unit: &str) -> String {
    let is_literal = text.trim_start_matches('-').starts_with(|letter: char| letter.is_ascii_digit())
        && text.ends_with(char::is_alphabetic)
        && text.chars().all(|letter| letter.is_alphanumeric() || " .-".contains(letter));
    if is_literal {
        return format!("{text}/{unit}");
    }
    let mut depth = 0_usize;
    let is_sum = text.char_indices().any(|(at, letter)| {
        match letter {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && at > 0 && "+-".contains(letter)
    });
    if is_sum || text.starts_with("if ") { format!("({text}) / 1 {unit}") } else { format!("{text} / 1 {unit}") }
}

/// An entry of a list with the comma behind it, or else the one before it.
fn with_comma(whole: &str, entry: Span) -> Option<Span> {
    let (before, behind) = (&whole[..entry.start as usize], &whole[entry.end as usize..]);
    if let Some(rest) = behind.trim_start().strip_prefix(',') {
        return Some(Span { end: (whole.len() - rest.trim_start_matches(' ').len()) as u32, ..entry });
    }
    let before = before.trim_end().strip_suffix(',')?;
    Some(Span { start: before.len() as u32, ..entry })
}

/// The lines of a statement that has them for itself, with the lines above that say what it is.
fn whole_statement(whole: &str, span: Span) -> Option<Span> {
    let line = |at: usize| whole[..at].rfind(['\n', '\r']).map_or(0, |end| end + 1);
    let mut start = line(span.start as usize);
    if !whole[start..span.start as usize].trim().chars().all(char::is_alphabetic) {
        return None;
    }
    while start > 0 {
        let above = line(start - 1);
        if !whole[above..start].trim_start().starts_with("///") {
            break;
        }
        start = above;
    }
    let behind = &whole[span.end as usize..];
    let rest = behind.split(['\n', '\r']).next().unwrap_or_default();
    let is_alone = rest.trim().is_empty() || rest.trim_start().starts_with("//");
    let end = rest.len() + behind[rest.len()..].find(|letter| !['\n', '\r'].contains(&letter)).unwrap_or(0).min(1);
    is_alone.then(|| Span { start: start as u32, end: span.end + end as u32, ..span })
}

/// Where settings go behind the name of an instance, and what is written there: ` = rack(…)`.
fn further_settings(behind: &str, definition: &str, settings: &str) -> Option<(usize, String)> {
    let called = behind.trim_start().strip_prefix('=')?.trim_start().strip_prefix(definition)?;
    let at = behind.len() - called.len();
    if !called.starts_with('(') {
        return Some((at, format!("({settings})")));
    }
    let inside = &called[1..length_of_vector(called)? - 1];
    let given = inside.trim_end().trim_end_matches(',');
    let comma = if given.trim().is_empty() { "" } else { ", " };
    Some((at + 1 + given.len(), format!("{comma}{settings}")))
}

/// Of the brackets that a text begins with.
fn length_of_vector(text: &str) -> Option<usize> {
    let mut depth = 0_usize;
    for (at, letter) in text.char_indices() {
        match letter {
            '[' | '(' => depth += 1,
            ']' | ')' => depth = depth.checked_sub(1)?,
            _ if depth == 0 => return None,
            _ => {}
        }
        if depth == 0 {
            return Some(at + 1);
        }
    }
    None
}

/// Behind the lists of axes of a `close`, which may stand on lines of their own; before a comment.
fn end_of_close(whole: &str, from: usize) -> usize {
    let mut at = from;
    loop {
        let line = whole[at..].split(['\n', '\r']).next().unwrap_or_default();
        let code = line.split("//").next().unwrap_or_default().trim_end();
        let next = whole[at + line.len()..].trim_start();
        if !["along ", "about "].iter().any(|word| next.starts_with(word)) {
            return at + code.len();
        }
        at = whole.len() - next.len();
    }
}

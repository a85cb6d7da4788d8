//! The words of the language, and the word that somebody may have meant.

/// Why a word cannot be a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reserved {
    /// A word of the language itself.
    Keyword,
    /// A unit.
    Unit,
    /// A dimension.
    Dimension,
}

/// Words that begin an item.
pub(super) const ITEMS: &[&str] = &["use", "fn", "machine", "tool", "job"];

/// Words that begin a statement in a machine.
pub(super) const IN_MACHINE: &[&str] = &[
    "param", "let", "axis", "unknown", "error", "frame", "insert", "close", "fix", "couple", "nc", "require", "expect",
];

/// Words that begin a statement in a tool.
pub(super) const IN_TOOL: &[&str] = &["param", "let", "profile", "surface", "require"];

/// Words that begin a statement in a tool's surface.
pub(super) const IN_SURFACE: &[&str] = &["let", "at", "body"];

/// Words that begin a statement in a job.
pub(super) const IN_JOB: &[&str] = &[
    "param", "let", "machine", "tool", "mount", "motion", "unknown", "drive", "surface", "trim", "cut", "profile",
    "solid", "contact", "want", "mill", "sample", "require", "expect",
];

/// Those of all these that are followed by a new name.
const DEFINING: &[&str] = &[
    "fn", "machine", "tool", "job", "param", "let", "axis", "error", "frame", "insert", "profile", "surface", "motion",
    "unknown", "solid", "contact", "want", "mill",
];

/// Words that begin something only where nothing else can, and are names elsewhere.
const FREE: &[&str] =
    &["profile", "cut", "nc", "error", "insert", "close", "unknown", "solid", "contact", "want", "mill", "expect"];

/// Words inside statements and expressions.
const CONNECTING: &[&str] = &["extends", "on", "in", "by", "if", "then", "else", "and", "or", "not"];

/// Words inside statements that are names elsewhere.
const INSIDE: &[&str] = &[
    "step", "as", "keep", "along", "about", "towards", "where", "for", "with", "of", "near", "within", "travel",
    "nothing", "passes", "side", "both", "ways", "clear", "scallop", "chord", "lead", "tilt", "stock",
];

/// What an axis is, and the sides of a surface.
const CHOICES: &[&str] = &["linear", "rotary", "inside", "outside"];

/// The words of the language, each in one or several lists.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vocabulary {
    /// Words that begin an item.
    pub items: &'static [&'static str],
    /// Words that begin a statement in a machine.
    pub in_machine: &'static [&'static str],
    /// Words that begin a statement in a tool.
    pub in_tool: &'static [&'static str],
    /// Words that begin a statement in a tool's surface.
    pub in_surface: &'static [&'static str],
    /// Words that begin a statement in a job.
    pub in_job: &'static [&'static str],
    /// Words inside statements and expressions, which are no names.
    pub connecting: &'static [&'static str],
    /// Words inside statements that are names elsewhere.
    pub inside: &'static [&'static str],
    /// What an axis is, and the sides of a surface.
    pub choices: &'static [&'static str],
    /// Units, in the order in which messages list them.
    pub units: &'static [&'static str],
    /// Dimensions.
    pub dimensions: &'static [&'static str],
    /// Functions, transforms, ways to make a surface.
    pub functions: Vec<&'static str>,
    /// What every point has.
    pub coordinates: &'static [&'static str],
    /// What the flank of a blank is asked for by in a sample, and passes run by.
    pub of_outlines: &'static [&'static str],
    /// What may become of a point.
    pub statuses: &'static [&'static str],
    /// What is known of a contact once it is solved.
    pub of_contacts: Vec<&'static str>,
    /// What is known of a solid.
    pub of_solids: Vec<&'static str>,
}

pub(super) fn vocabulary() -> Vocabulary {
    Vocabulary {
        items: ITEMS,
        in_machine: IN_MACHINE,
        in_tool: IN_TOOL,
        in_surface: IN_SURFACE,
        in_job: IN_JOB,
        connecting: CONNECTING,
        inside: INSIDE,
        choices: CHOICES,
        units: UNITS,
        dimensions: DIMENSIONS,
        functions: crate::definitions::index::functions(),
        coordinates: &crate::job::sample::OF_POINTS,
        of_outlines: &crate::definitions::index::OUTLINE,
        statuses: &crate::job::expect::STATUSES,
        of_contacts: crate::job::expect::numbers_of_contacts().collect(),
        of_solids: crate::job::expect::numbers_of_solids().collect(),
    }
}

/// Units as they are listed in messages.
pub(super) const UNITS: &[&str] = &["mm", "um", "µm", "cm", "inch", "deg", "rad", "arcmin", "arcsec", "rev"];

/// `µm` with the Greek letter instead of the micro sign: read alike.
pub(super) const GREEK_MICROMETRE: &str = "μm";

/// Dimensions.
pub(super) const DIMENSIONS: &[&str] = &["length", "angle", "number", "count"];

/// Whether a word begins an item or a statement somewhere.
pub(super) fn begins_statement(word: &str) -> bool {
    [ITEMS, IN_MACHINE, IN_TOOL, IN_SURFACE, IN_JOB].iter().any(|words| words.contains(&word))
}

/// Whether what such a word is followed by is a new name.
pub(super) fn defines(word: &str) -> bool {
    DEFINING.contains(&word)
}

/// Why a word cannot be a name, if it cannot.
pub(super) fn reserved(word: &str) -> Option<Reserved> {
    if UNITS.contains(&word) || word == GREEK_MICROMETRE {
        Some(Reserved::Unit)
    } else if DIMENSIONS.contains(&word) {
        Some(Reserved::Dimension)
    } else if FREE.contains(&word) {
        None
    } else if begins_statement(word) || CONNECTING.contains(&word) {
        Some(Reserved::Keyword)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Words in quotes: those of the grammar. Where it tells words by their first letters they are not whole.
    fn quoted(grammar: &str) -> BTreeSet<&str> {
        let lines = grammar.lines().map(|line| line.split("//").next().unwrap_or_default());
        let lines = lines.filter(|line| !line.contains("'..'"));
        let texts = lines.flat_map(|line| line.split('"').skip(1).step_by(2));
        texts.filter(|text| text.chars().count() > 1 && text.chars().all(char::is_alphabetic)).collect()
    }

    #[test]
    fn the_vocabulary_is_that_of_the_grammar() {
        let of = vocabulary();
        let lists =
            [of.items, of.in_machine, of.in_tool, of.in_surface, of.in_job, of.connecting, of.inside, of.choices];
        let known: BTreeSet<&str> =
            lists.iter().chain(&[of.units, of.dimensions]).flat_map(|list| list.iter().copied()).collect();
        let mut grammar = quoted(include_str!("grammar.pest"));
        assert!(grammar.remove(GREEK_MICROMETRE));
        assert_eq!(known, grammar);
    }
}

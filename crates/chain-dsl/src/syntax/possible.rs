//! What a text that is being written may go on with, from where the grammar gives up on it.

use super::expected;
use super::grammar::{self, Rule};

/// What a text that is being written is the beginning of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Piece {
    /// Something that stands by itself in a file.
    Item,
    /// A statement of a machine.
    InMachine,
    /// A statement of a tool, of a surface or a profile its head.
    InTool,
    /// A statement of a tool's surface.
    InSurface,
    /// A segment of a profile.
    InProfile,
    /// A statement of a job.
    InJob,
}

/// What may stand behind a text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Possible {
    /// Words of the language.
    pub words: Vec<&'static str>,
    /// Whether a name or a value may stand there.
    pub name: bool,
    /// Whether a dimension may.
    pub dimension: bool,
    /// Whether it may be what becomes of points.
    pub status: bool,
}

/// What may stand behind the beginning of a piece of text; none where the grammar gives up before its end.
pub fn possible_behind(text: &str, piece: Piece) -> Option<Possible> {
    // no sign of the language, so it fails there whatever stands before
    let unfinished = format!("{text}\u{1}");
    let failure = grammar::strict(rule_of(piece, text), &unfinished).err()?;
    if failure.place != text.len() {
        return None;
    }
    let mut possible = Possible::default();
    failure.expected.iter().for_each(|rule| possible.add(*rule));
    possible.words.sort_unstable();
    possible.words.dedup();
    Some(possible)
}

fn rule_of(piece: Piece, text: &str) -> Rule {
    let is_head = ["surface", "profile"].iter().any(|word| text.trim_start().starts_with(word));
    match piece {
        Piece::Item => Rule::file,
        Piece::InMachine => Rule::machine_piece,
        Piece::InTool if is_head => Rule::head_piece,
        Piece::InTool => Rule::tool_piece,
        Piece::InSurface => Rule::tool_surface_piece,
        Piece::InProfile => Rule::profile_piece,
        Piece::InJob => Rule::job_piece,
    }
}

impl Possible {
    fn add(&mut self, rule: Rule) {
        match rule {
            Rule::dimension | Rule::dimension_factor | Rule::dimension_name | Rule::dimension_word => {
                self.dimension = true;
            }
            Rule::status => self.status = true,
            Rule::axis_kind => self.words.extend(["linear", "rotary"]),
            Rule::side => self.words.extend(["inside", "outside"]),
            Rule::spacing_word => self.words.extend(["scallop", "step", "chord", "by"]),
            Rule::attitude_word => self.words.extend(["lead", "tilt", "stock"]),
            Rule::kw_near => self.words.push("near"),
            Rule::kw_within => self.words.push("within"),
            Rule::kw_let => self.words.push("let"),
            Rule::infix => self.words.extend(["and", "or"]),
            Rule::expression | Rule::argument | Rule::expected_value => {
                self.words.extend(["if", "not"]);
                self.name = true;
            }
            rule if is_named(rule) => self.name = true,
            rule => {
                let word = expected::sign(rule).filter(|sign| sign.starts_with(char::is_alphabetic));
                self.words.extend(word);
            }
        }
    }
}

/// Whether a name or a value may begin with it.
fn is_named(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::name
            | Rule::path
            | Rule::operation
            | Rule::conditional
            | Rule::value
            | Rule::prefix
            | Rule::label
            | Rule::named
            | Rule::call
            | Rule::definition
            | Rule::variant_of
            | Rule::sampled
            | Rule::range
            | Rule::setting
            | Rule::change
            | Rule::entry
            | Rule::formal
            | Rule::surface_parameter
            | Rule::parameter
            | Rule::segment
            | Rule::expected_status
            | Rule::expected_pose
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str, piece: Piece) -> Vec<&'static str> {
        possible_behind(text, piece).expect("it is right so far").words
    }

    #[test]
    fn words_follow_where_the_grammar_has_them() {
        assert_eq!(words("param b : length ", Piece::InMachine), ["in", "step"]);
        assert_eq!(words("axis C : ", Piece::InMachine), ["linear", "rotary"]);
        assert_eq!(words("machine a ", Piece::Item), ["extends"]);
        assert_eq!(words("mount r ", Piece::InJob), ["on"]);
        assert_eq!(words("surface s(u: ", Piece::InTool), ["along"]);
        assert_eq!(words("expect flank near 3 mm ", Piece::InJob), ["and", "or", "within"]);
        assert_eq!(words("let x = if a ", Piece::InTool), ["and", "or", "then"]);
    }

    #[test]
    fn names_and_dimensions_follow_where_the_grammar_has_them() {
        let of = |text| possible_behind(text, Piece::Item).expect("it is right so far");
        assert!(of("fn f(a: ").dimension && !of("fn f(a: ").name);
        assert!(of("fn f() -> ").dimension);
        assert!(of("fn f() = 2 * ").name && !of("fn f() = 2 * ").dimension);
        assert!(!of("machine a ").name);
        assert!(possible_behind("expect all ", Piece::InJob).is_some_and(|of| of.status));
        assert_eq!(possible_behind("mount on ", Piece::InJob), None);
    }
}

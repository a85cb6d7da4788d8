//! Why a piece of text does not parse: one report on its first mistake, from where the grammar gave up and what it hoped for.

use std::ops::Range;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::diagnostics::spelling::closest;

use super::expected::{self, Before};
use super::grammar::Rule;
use super::scan::{Kind, Scan};
use super::words;

mod brackets;
mod habits;
mod names;

pub(super) use habits::{belongs_to_value, block_comment, foreign, line_comment};

/// A piece of text that does not parse.
pub(super) struct Mistake<'s> {
    scan: &'s Scan<'s>,
    /// The tokens of the piece.
    range: Range<usize>,
    /// The token that cannot stand where it does; the end of the range if the piece is only too short.
    pub(super) found: usize,
    expected: Vec<Rule>,
}

impl<'s> Mistake<'s> {
    pub(super) fn new(scan: &'s Scan<'s>, range: Range<usize>, place: usize, expected: Vec<Rule>) -> Mistake<'s> {
        let mut found = scan.token_at(place).clamp(range.start, range.end);
        // A frame's last name is not followed by a parenthesis: then the name itself is wrong, unless there is one further on.
        let lacks_parenthesis = matches!(scan.say(range.start), "frame" | "insert") && expected == [Rule::open_paren];
        if lacks_parenthesis && (scan.say(found) != "(" || scan.indent(found).is_some()) {
            found -= 1;
        }
        Mistake { scan, range, found, expected }
    }

    /// Where a whole statement ends that is followed by a new line or a sign like a semicolon.
    pub(super) fn whole_before(&self) -> Option<u32> {
        let whole = self.expected.contains(&Rule::EOI) || self.lacks_parenthesis();
        let within = self.found > self.range.start && self.found < self.range.end;
        let separate = self.leads() || self.kind() == Some(Kind::Strange);
        (whole && within && separate).then(|| self.scan.place(self.found - 1).end)
    }

    /// Whether the name at hand is no call where only calls can stand, and another call stands before it.
    fn lacks_parenthesis(&self) -> bool {
        self.expected == [Rule::open_paren] && self.before() == ")"
    }

    pub(super) fn explain(&self) -> Diagnostic {
        let special = [
            Self::text,
            Self::by_of_one_value,
            Self::not_a_unit,
            Self::not_a_name,
            Self::hyphen_in_name,
            Self::positional,
            Self::habit,
            Self::stray_bracket,
            Self::frame_in_its_place,
            Self::no_tolerance,
            Self::pose_without_place,
            Self::expect_with_colon,
            Self::no_range,
            Self::no_operator,
        ];
        special.iter().find_map(|explain| explain(self)).unwrap_or_else(|| self.unexpected())
    }

    fn say(&self) -> &'s str {
        if self.found < self.range.end { self.scan.say(self.found) } else { "" }
    }

    fn before(&self) -> &'s str {
        if self.found > self.range.start { self.scan.say(self.found - 1) } else { "" }
    }

    fn kind(&self) -> Option<Kind> {
        self.scan.kind(self.found).filter(|_| self.found < self.range.end)
    }

    fn kind_before(&self) -> Option<Kind> {
        self.found.checked_sub(1).filter(|&index| index >= self.range.start).and_then(|index| self.scan.kind(index))
    }

    /// Whether the piece is only too short.
    fn ends(&self) -> bool {
        self.found == self.range.end
    }

    /// Whether the mistake begins a line, other than the first of the piece.
    fn leads(&self) -> bool {
        self.found > self.range.start && self.scan.indent(self.found).is_some()
    }

    /// Whether no white space stands between a token and the one before it.
    fn touches(&self, index: usize) -> bool {
        index > 0 && self.scan.place(index - 1).end == self.scan.place(index).start
    }

    /// Where it is.
    fn place(&self) -> Span {
        self.scan.place(self.found)
    }

    /// Where a token ends.
    fn behind(&self, index: usize) -> Span {
        let place = self.scan.place(index);
        Span { start: place.end, ..place }
    }

    fn here(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Code::Syntax, self.place(), message)
    }

    fn text(&self) -> Option<Diagnostic> {
        (self.kind() == Some(Kind::OpenText)).then(|| {
            let text = self.scan.say(self.found).trim_end();
            let end = Span { start: self.place().start + text.len() as u32, ..self.place() };
            let help = "write `\"` at its end, on the same line";
            self.here("the text is not closed").help(help).cure("write `\"` at its end", end, "\"")
        })
    }

    /// `frame work in table`
    fn frame_in_its_place(&self) -> Option<Diagnostic> {
        let word = |k: usize| self.scan.say(self.range.start + k);
        let is_bare = self.ends() && self.range.len() == 4 && word(0) == "frame" && word(2) == "in";
        let written = " = translate_z(0 mm)";
        is_bare.then(|| {
            let help = format!(
                "say how it stands in `{}`, as `= rotate_z(10 deg)`; `{}` where it stands alike",
                word(3),
                written.trim()
            );
            self.unexpected().help(help).cure(
                format!("write `{}`", written.trim()),
                self.behind(self.found - 1),
                written,
            )
        })
    }

    /// `expect ratio near 1.6`
    fn no_tolerance(&self) -> Option<Diagnostic> {
        let is_open = self.scan.say(self.range.start) == "expect" && self.expected.contains(&Rule::kw_within);
        let report = is_open.then(|| self.unexpected()).filter(|report| report.help.is_none())?;
        Some(report.help("say by how much it may differ, such as `within 1 um`"))
    }

    /// `expect work in bed near translate_x(3 mm) within 1 um`: the grammar takes `within` for another transform.
    fn pose_without_place(&self) -> Option<Diagnostic> {
        let is_pose = self.scan.say(self.range.start) == "expect" && self.expected == [Rule::open_paren];
        (is_pose && self.before() == "within").then(|| {
            let place = self.scan.place(self.found - 1);
            let start = Span { end: place.start, ..place };
            Diagnostic::new(Code::Syntax, place, "expected `at (…)` before `within`: where the axes stand")
                .help("give the free axes their values, as in `at (X: 10 mm)`; `at ()` where none moves the frame")
                .cure("write `at ()` before it", start, "at () ")
        })
    }

    /// `expect: all solved`
    fn expect_with_colon(&self) -> Option<Diagnostic> {
        let is_first = self.found == self.range.start + 1 && self.scan.say(self.range.start) == "expect";
        (is_first && self.say() == ":").then(|| {
            let help = "leave it out; a `:` stands behind a surface, as in `expect flank: rho in 46 mm .. 52 mm`";
            self.here("no `:` stands behind `expect`").help(help).cure("leave `:` out", self.place(), "")
        })
    }

    /// `z: 0 mm by 3` in a sample.
    fn by_of_one_value(&self) -> Option<Diagnostic> {
        let before = (self.range.start..self.found).rev().map(|index| self.scan.say(index));
        let mut entry = before.take_while(|word| !matches!(*word, "," | "{" | "by"));
        let is_of_sample = self.scan.say(self.range.start) == "sample" && self.say() == "by";
        (is_of_sample && !entry.any(|word| word == "..")).then(|| {
            let gap = self.behind(self.found - 1).to(self.scan.place(self.found + 1));
            self.here("one value is one point and takes no `by`")
                .help("leave it out, or write a range: `-5 mm .. 5 mm by 3`")
                .cure("leave `by` out", gap, "")
        })
    }

    /// `motion roll : angle`
    fn no_range(&self) -> Option<Diagnostic> {
        let is_moving = matches!(self.scan.say(self.range.start), "motion" | "unknown" | "surface");
        let lacks = is_moving && self.expected.contains(&Rule::kw_in) && words::DIMENSIONS.contains(&self.before());
        let range = match self.before() {
            "length" => "in 0 mm .. 10 mm",
            "angle" => "in -40 deg .. 40 deg",
            _ => "in 0 .. 1",
        };
        let report = lacks.then(|| self.unexpected()).filter(|report| report.help.is_none())?;
        Some(report.help(format!("say between which values it lies, as in `{range}`")))
    }

    /// `drive m.Y = radius roll`
    fn no_operator(&self) -> Option<Diagnostic> {
        let is_value = self.scan.is_name(self.found) || self.kind() == Some(Kind::Number);
        let follows = self.scan.is_name(self.found.wrapping_sub(1))
            || self.kind_before() == Some(Kind::Number)
            || words::UNITS.contains(&self.before())
            || matches!(self.before(), ")" | "]");
        // a name before a colon begins the next entry of a list
        let is_entry = self.scan.say(self.found + 1) == ":";
        let others = [Rule::dots, Rule::kw_then, Rule::kw_else];
        let wants = self.expected.contains(&Rule::infix) && !others.iter().any(|rule| self.expected.contains(rule));
        let is_missing = is_value && follows && wants && !is_entry && !self.ends() && !self.leads();
        let report = is_missing.then(|| self.unexpected());
        let report = report.filter(|report| report.help.is_none())?;
        let (before, found) = (self.scan.quote(self.found - 1), self.scan.quote(self.found));
        let help = "an operator such as `*` belongs between";
        Some(report.help(format!("{help} {before} and {found}, or a comma if they are two values")))
    }

    fn closest(&self, candidates: impl IntoIterator<Item = &'static str>) -> Option<&'static str> {
        closest(self.say(), candidates)
    }

    /// Whatever it is: what was expected, and what is there.
    fn unexpected(&self) -> Diagnostic {
        let mut rules = expected::relevant(self.expected.clone());
        let open = self.unclosed_bracket().filter(|_| rules.iter().any(|rule| closes(*rule)));
        if open.is_some() && (self.ends() || matches!(self.say(), ")" | "]" | "}")) {
            rules.retain(|rule| closes(*rule));
        }
        let diagnostic = self.expects(&rules);
        let diagnostic = match open {
            Some(open) => {
                let text = format!("this `{}` is not closed", self.scan.say(open));
                diagnostic.note(self.scan.place(open), text)
            }
            None => diagnostic,
        };
        match self.misspelt(&rules) {
            Some(meant) => diagnostic.help(format!("did you mean `{meant}`?")).cure(
                format!("write `{meant}`"),
                self.place(),
                meant,
            ),
            None if self.lacks_operator(&rules) => self.with_product(diagnostic),
            None => diagnostic,
        }
    }

    /// Whether two values stand side by side.
    fn lacks_operator(&self, rules: &[Rule]) -> bool {
        let is_value = match self.kind() {
            Some(Kind::Word) => words::reserved(self.say()).is_none(),
            Some(Kind::Number | Kind::Text) => true,
            _ => matches!(self.say(), "(" | "["),
        };
        is_value && rules.contains(&Rule::infix) && !self.leads() && !self.ends()
    }

    /// `module teeth`, `2(u + v)`
    fn with_product(&self, diagnostic: Diagnostic) -> Diagnostic {
        if [self.kind(), self.kind_before()].contains(&Some(Kind::Text)) {
            return diagnostic;
        }
        let gap = Span { end: self.place().start, ..self.behind(self.found - 1) };
        let (before, found) = (self.scan.short(self.found - 1), self.scan.short(self.found));
        diagnostic.help(format!("a product is written `{before} * {found}`")).cure("write `*`", gap, " * ")
    }

    fn expects(&self, rules: &[Rule]) -> Diagnostic {
        let found = self.scan.quote(self.found);
        let list = expected::list(rules, &self.surroundings());
        if self.expected.contains(&Rule::EOI) && self.leads() && !self.ends() {
            self.here(format!("expected the next statement, found {found}"))
        } else if self.leads() || self.ends() {
            self.missing(&list)
        } else if self.lacks_operator(rules) {
            let before = self.scan.quote(self.found - 1);
            self.here(format!("expected an operator between {before} and {found}"))
        } else {
            self.here(format!("expected {list}, found {found}"))
        }
    }

    /// Something is missing at the end of a line: the last word before is underlined.
    fn missing(&self, list: &str) -> Diagnostic {
        let last = self.found.saturating_sub(1).max(self.range.start);
        let after = if list.contains(" after ") { String::new() } else { format!(" after {}", self.scan.quote(last)) };
        Diagnostic::new(Code::Syntax, self.scan.place(last), format!("expected {list}{after}"))
    }

    fn surroundings(&self) -> Before<'s> {
        let last = self.found.wrapping_sub(1);
        let open = self.open_bracket();
        Before {
            statement: self.scan.say(self.range.start),
            last: self.before(),
            name: self.scan.is_name(last),
            in_brackets: open.is_some(),
            in_parentheses: open.is_some_and(|open| self.scan.say(open) == "("),
        }
    }

    /// The word that was meant, among those expected.
    fn misspelt(&self, rules: &[Rule]) -> Option<&'static str> {
        let mut candidates: Vec<&str> = rules.iter().filter_map(|rule| expected::sign(*rule)).collect();
        if rules.contains(&Rule::axis_kind) {
            candidates.extend(["linear", "rotary"]);
        }
        if rules.contains(&Rule::side) {
            candidates.extend(["inside", "outside"]);
        }
        if rules.contains(&Rule::infix) {
            candidates.extend(["and", "or"]);
        }
        candidates.retain(|candidate| candidate.len() > 1 && candidate.starts_with(char::is_alphabetic));
        self.closest(candidates).filter(|_| self.kind() == Some(Kind::Word))
    }
}

fn closes(rule: Rule) -> bool {
    matches!(rule, Rule::close_paren | Rule::close_bracket | Rule::close_brace)
}

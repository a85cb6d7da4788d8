//! Reading a text that has mistakes: it is cut where statements begin, every piece is parsed by itself, a piece that does
//! not parse gives one report, and what it would have defined is put into the tree as an error.

mod block;
mod blocks;

use std::ops::Range;

use pest::iterators::Pair;

use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::diagnostics::spelling::closest;
use crate::diagnostics::{Cure, Diagnostic};
use crate::limits::MISTAKES;

use super::ast::{Expression, ExpressionKind, File, Item};
use super::build::Build;
use super::explain::{self, Mistake};
use super::grammar::{self, Failure, Rule};
use super::scan::{Kind, Scan};
use super::{limits, pieces, salvage, words};

/// The tree and the reports of a text; `failure` is what the strict grammar had against it.
pub(super) fn file(scan: &Scan, failure: Option<&Failure>) -> (File, Vec<Diagnostic>) {
    let mut recover = Recover::new(scan);
    recover.items();
    let mut diagnostics = recover.without_uses_of_misnamed();
    if diagnostics.is_empty() {
        let found = failure.map_or(0, |failure| scan.token_at(failure.place));
        let message = format!("{} does not belong here", scan.quote(found));
        diagnostics.push(Diagnostic::new(Code::Syntax, scan.place(found), message));
    }
    diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
    (File { doc: scan.file_doc(), items: recover.items, lacks_files: recover.lacks_files }, diagnostics)
}

/// An expression that begins at a place, behind nothing but white space.
pub(super) fn expression(scan: &Scan, start: usize) -> (Expression, Vec<Diagnostic>) {
    let end = scan.tokens.len();
    let span = scan.span(start..scan.text.len());
    let error = Expression { kind: ExpressionKind::Error, span };
    if end == 0 {
        return (error, vec![Diagnostic::new(Code::Syntax, span, "expected a value")]);
    }
    let mut recover = Recover::new(scan);
    let parsed = recover.piece(Rule::expression_piece, 0..end);
    let value = parsed.map(|pair| recover.build.expression(pair));
    if recover.at < end {
        let message = format!("{} does not belong here", scan.quote(recover.at));
        recover.report(recover.at, message);
    }
    // half of a value would only lead to findings about what is not meant
    let value = value.filter(|_| recover.build.diagnostics.is_empty());
    (value.unwrap_or(error), recover.build.diagnostics)
}

/// A reading of a text with mistakes.
struct Recover<'s> {
    scan: &'s Scan<'s>,
    build: Build<'s>,
    /// The next token.
    at: usize,
    items: Vec<Item>,
    /// How many items that stand inside others are being read.
    nested: usize,
    /// Whether a `use` could not be read.
    lacks_files: bool,
    /// Words of the language that are to be new names, which is reported.
    misnamed: Vec<&'s str>,
    /// Such words where names are used, each with the number of its report.
    misused: Vec<(usize, &'s str)>,
}

impl<'s> Recover<'s> {
    fn new(scan: &'s Scan<'s>) -> Recover<'s> {
        Recover {
            scan,
            build: Build::new(scan),
            at: 0,
            items: Vec::new(),
            nested: 0,
            lacks_files: false,
            misnamed: Vec::new(),
            misused: Vec::new(),
        }
    }

    /// The reports; a name that cannot be one is wrong where it is defined, and not once more where it is used.
    fn without_uses_of_misnamed(&mut self) -> Vec<Diagnostic> {
        let reports = std::mem::take(&mut self.build.diagnostics).into_iter().enumerate();
        let follows =
            |number: usize| self.misused.iter().any(|(report, word)| *report == number && self.misnamed.contains(word));
        reports.filter(|(number, _)| !follows(*number)).map(|(_, report)| report).collect()
    }

    fn items(&mut self) {
        while self.goes_on() {
            if self.say() == "}" {
                self.stray_brace();
            } else if !self.scan.is_opening_word(self.at) {
                self.unknown_item();
            } else if pieces::begins_item(self.scan, self.at) {
                self.item(self.say(), true);
            } else {
                self.outside();
            }
        }
    }

    /// Whether there is more to read, and not too many mistakes yet.
    fn goes_on(&mut self) -> bool {
        if self.build.diagnostics.len() > MISTAKES.most {
            return false;
        }
        let full = self.build.diagnostics.len() == MISTAKES.most;
        if full && self.at < self.scan.tokens.len() {
            self.build.diagnostics.push(MISTAKES.exceeded(self.scan.place(self.at)));
        }
        !full && self.at < self.scan.tokens.len()
    }

    fn say(&self) -> &'s str {
        self.scan.say(self.at)
    }

    fn report(&mut self, index: usize, message: impl Into<String>) -> &mut Diagnostic {
        let diagnostic = Diagnostic::new(Code::Syntax, self.scan.place(index), message);
        self.build.diagnostics.push(diagnostic);
        let last = self.build.diagnostics.len() - 1;
        &mut self.build.diagnostics[last]
    }

    /// An item by its first word, which is misspelt in the text if it is not `strict`.
    fn item(&mut self, word: &'s str, strict: bool) {
        let is_variant = word == "job" && self.scan.say(self.at + 2) == "=";
        if matches!(word, "use" | "fn") || is_variant {
            let end = pieces::flat_item_end(self.scan, self.at);
            let range = self.at..end;
            let mistakes = self.build.diagnostics.len();
            let parsed = if strict { self.piece(Rule::item_piece, range.clone()) } else { None };
            let item = match parsed {
                Some(pair) => self.build.item(pair),
                None => salvage::flat_item(self.scan, word, range.clone()),
            };
            self.items.extend(item);
            self.lacks_files |= word == "use" && (!strict || self.build.diagnostics.len() > mistakes);
            self.at = self.at.max(if strict { 0 } else { end });
        } else {
            self.block_item(word, strict);
        }
    }

    /// Parses a piece and moves behind it, or reports what is wrong with it. A line in it that starts with a name, after a
    /// whole statement, is left to be read as the next statement.
    fn piece(&mut self, rule: Rule, range: Range<usize>) -> Option<Pair<'s, Rule>> {
        self.at = range.end;
        if let Some(diagnostic) = limits::first_excess(self.scan, range.clone()) {
            self.build.diagnostics.push(diagnostic);
            return None;
        }
        let scan: &'s Scan<'s> = self.scan;
        let place = scan.extent(range.clone());
        let start = place.start as usize;
        let text = &scan.text[start..place.end as usize];
        self.build.offset = start;
        let failure = match grammar::strict(rule, text) {
            Ok(mut pairs) => return pairs.next(),
            Err(failure) => failure,
        };
        let mistake = Mistake::new(scan, range, start + failure.place, failure.expected);
        let whole = mistake.whole_before().filter(|_| !explain::belongs_to_value(scan, mistake.found));
        if whole.is_some() && scan.kind(mistake.found) == Some(Kind::Word) {
            self.at = mistake.found;
        } else {
            match mistake.keyword_as_name() {
                Some((word, true)) => self.misnamed.push(word),
                Some((word, false)) => self.misused.push((self.build.diagnostics.len(), word)),
                None => {}
            }
            self.build.diagnostics.push(mistake.explain());
        }
        let before = whole.map(|end| &text[..end as usize - start])?;
        grammar::strict(rule, before).ok().and_then(|mut pairs| pairs.next())
    }

    fn stray_brace(&mut self) {
        self.report(self.at, "`}` closes nothing");
        while self.say() == "}" {
            self.at += 1;
        }
    }

    fn unknown_item(&mut self) {
        const LIST: &str = "`machine`, `tool`, `job`, `fn` or `use`";
        if self.is_swapped() && words::ITEMS.contains(&self.scan.say(self.at + 1)) {
            self.swapped();
            return self.item(self.scan.say(self.at + 1), false);
        }
        let word = self.scan.kind(self.at) == Some(Kind::Word);
        let of_others = match self.say() {
            "import" | "include" => Some("use"),
            "def" | "func" | "function" => Some("fn"),
            _ => None,
        };
        let meant = of_others.or_else(|| closest(self.say(), words::ITEMS.iter().copied()).filter(|_| word));
        let Some(meant) = meant else {
            self.lacks_files |= [0, 1].iter().any(|k| self.scan.kind(self.at + k) == Some(Kind::Text));
            self.report_sign(LIST, "a file consists of machines, tools, jobs and functions");
            self.at = pieces::next_item(self.scan, self.at + 1);
            return;
        };
        let message = format!("expected {LIST}, found {}", self.scan.quote(self.at));
        let place = self.scan.place(self.at);
        mean(self.report(self.at, message), place, meant);
        self.item(meant, false);
    }

    /// Whether a name stands before the word that should introduce it: `X axis : linear`.
    fn is_swapped(&self) -> bool {
        let next = self.at + 1;
        self.scan.is_name(self.at)
            && self.scan.is_opening_word(next)
            && self.scan.indent(next).is_none()
            && !self.scan.is_name(next + 1)
    }

    fn swapped(&mut self) {
        let (name, word) = (self.scan.short(self.at), self.scan.say(self.at + 1));
        let message = format!("expected `{word}` before `{name}`, not after it");
        let place = self.scan.extent(self.at..self.at + 2);
        let (whole, word) = (self.scan.say(self.at), word.to_string());
        let diagnostic = self.report(self.at, message);
        diagnostic.help = Some(format!("write `{word} {name}`"));
        diagnostic.cures.push(Cure {
            title: format!("write `{word} {name}`"),
            span: place,
            replacement: format!("{word} {whole}"),
        });
    }

    /// Reports what can begin nothing.
    fn report_sign(&mut self, expected: &str, help: &str) {
        let diagnostic = explain::foreign(self.scan, self.at).unwrap_or_else(|| {
            let message = format!("expected {expected}, found {}", self.scan.quote(self.at));
            let diagnostic = Diagnostic::new(Code::Syntax, self.scan.place(self.at), message);
            let Some(comment) = explain::block_comment(self.scan, self.at) else { return diagnostic.help(help) };
            match explain::line_comment(self.scan, self.at) {
                Some((title, span, text)) => diagnostic.help(comment).cure(title, span, text),
                None => diagnostic.help(comment),
            }
        });
        self.build.diagnostics.push(diagnostic);
    }

    /// A statement that stands by itself.
    fn outside(&mut self) {
        let message = format!("`{}` stands outside of every machine, tool and job", self.say());
        self.report(self.at, message);
        self.at = pieces::next_item(self.scan, self.at + 1);
    }
}

/// Says which word was meant.
fn mean(diagnostic: &mut Diagnostic, place: Span, word: &str) {
    diagnostic.help = Some(format!("did you mean `{word}`?"));
    diagnostic.cures.push(Cure { title: format!("write `{word}`"), span: place, replacement: word.to_string() });
}

//! Machines, tools, jobs and the surfaces of tools, statement by statement.

use pest::iterators::Pair;

use crate::diagnostics::source::Span;
use crate::diagnostics::spelling::closest;
use crate::diagnostics::{Cure, Note};

use super::super::ast::{Item, Job, JobStatement, Machine, Profile, Segment, Tool, ToolStatement};
use super::super::build::Head;
use super::super::expected::SEGMENT;
use super::super::grammar::Rule;
use super::super::scan::Kind;
use super::super::{pieces, salvage, words};
use super::block::Block;
use super::{Recover, mean};

/// Items inside each other that are still read as such.
const NESTED_ITEMS: usize = 4;

impl<'s> Recover<'s> {
    /// A machine, tool or job.
    pub(super) fn block_item(&mut self, word: &'s str, strict: bool) {
        let first = self.at;
        let (head, opened) = self.head(strict);
        let Head { doc, name, extends, changes } = match head {
            Some(pair) => self.build.head(pair),
            None => salvage::head(self.scan, first),
        };
        let mut block = match word {
            "machine" => Block::Machine(Vec::new()),
            "tool" => Block::Tool(Vec::new()),
            _ => Block::Job(Vec::new()),
        };
        let is_closed = self.block(&mut block, first, opened);
        let span = self.span_since(first);
        self.items.push(match block {
            Block::Machine(statements) => Item::Machine(Machine { doc, name, extends, statements, span }),
            Block::Job(statements) => Item::Job(Job { doc, name, extends, changes, statements, span, is_closed }),
            Block::Tool(statements) => Item::Tool(Tool { doc, name, statements }),
            Block::Surface(_) => return,
        });
    }

    fn span_since(&self, first: usize) -> Span {
        self.scan.extent(first..self.at.max(first + 1))
    }

    /// What stands before a block, and its opening brace if it has one.
    fn head(&mut self, strict: bool) -> (Option<Pair<'s, Rule>>, Option<usize>) {
        let first = self.at;
        let end = pieces::head_end(self.scan, first);
        let parsed = if strict { self.piece(Rule::head_piece, first..end) } else { None };
        self.at = end;
        (parsed, Some(end - 1).filter(|&index| index > first && self.scan.say(index) == "{"))
    }

    /// Reads statements up to the closing brace of a block that begins at a token; whether it is there.
    fn block(&mut self, block: &mut Block, first: usize, mut opened: Option<usize>) -> bool {
        let mut extra = 0;
        while self.goes_on() {
            if self.say() == "}" && extra > 0 && !self.scan.lacks_closing_brace {
                (self.at, extra) = (self.at + 1, extra - 1);
            } else if self.say() == "}" {
                if matches!(block, Block::Surface(_)) && pieces::closes_outer(self.scan, self.at, first) {
                    self.unclosed(opened);
                    return false;
                }
                self.at += 1;
                if self.nested > 0 || !self.closed_too_early(block) {
                    return true;
                }
            } else if self.ends_block(block, first) {
                self.unclosed(opened);
                return false;
            } else if self.begins_item(block) {
                self.nested_item(block);
                opened = None;
            } else if self.scan.is_opening_word(self.at) || self.lacks_what_follows(block) {
                self.known_statement(block);
            } else {
                if self.say() == "{" {
                    (opened, extra) = (None, extra + 1);
                }
                self.unknown_statement(block);
            }
        }
        if self.at == self.scan.tokens.len() {
            self.unclosed(opened);
        }
        false
    }

    /// Whether a word that begins a statement of the block is followed by nothing that it could introduce, nor is it a name.
    fn lacks_what_follows(&self, block: &Block) -> bool {
        block.words().contains(&self.say()) && self.scan.say(self.at + 1) != "="
    }

    fn begins_item(&self, block: &Block) -> bool {
        match block {
            Block::Job(_) => pieces::begins_item_in_job(self.scan, self.at),
            _ => pieces::begins_item(self.scan, self.at),
        }
    }

    /// Whether the next token cannot belong to a block and stands no further right than its first word, so that the block's
    /// closing brace must be missing.
    fn ends_block(&self, block: &Block, first: usize) -> bool {
        let outer = matches!(block, Block::Surface(_))
            && words::IN_TOOL.contains(&self.say())
            && !words::IN_SURFACE.contains(&self.say());
        let indents = (self.scan.indent(self.at), self.scan.indent(first));
        let further_left = matches!(indents, (Some(this), Some(block)) if this <= block);
        (outer || self.begins_item(block)) && (further_left || self.nested == NESTED_ITEMS)
    }

    /// An item inside a block: it is read nevertheless.
    fn nested_item(&mut self, block: &Block) {
        let word = self.say();
        let help = format!("is a `}}` missing before this `{word}`?");
        let place = self.scan.place(self.at);
        let lacks_brace = self.scan.lacks_closing_brace;
        let diagnostic = self.report(self.at, format!("`{word}` cannot stand in a {}", block.noun()));
        diagnostic.help = Some(help);
        if lacks_brace {
            let before = Span { end: place.start, ..place };
            diagnostic.cures.push(Cure {
                title: "write `}` before it".into(),
                span: before,
                replacement: "}\n\n".into(),
            });
        }
        self.nested += 1;
        self.item(word, true);
        self.nested -= 1;
    }

    fn unclosed(&mut self, opened: Option<usize>) {
        let Some(opened) = opened else { return };
        let end = self.scan.tokens.len();
        let (index, message) = if self.at < end {
            (self.at, format!("expected `}}` before `{}`", self.say()))
        } else {
            (end - 1, "expected `}` at the end of the file".to_owned())
        };
        self.report_with_note(index, message, opened, "this `{` is not closed");
    }

    fn report_with_note(&mut self, index: usize, message: String, place: usize, text: &str) {
        let note = Note { span: self.scan.place(place), text: text.to_owned() };
        self.report(index, message).notes.push(note);
    }

    /// Whether statements go on after the closing brace of a block; reports it.
    fn closed_too_early(&mut self, block: &Block) -> bool {
        let (scan, at) = (self.scan, self.at);
        let word = self.say();
        let elsewhere = matches!(block, Block::Surface(_)) && words::IN_TOOL.contains(&word);
        if !block.words().contains(&word) || elsewhere || pieces::begins_item(scan, at) {
            return false;
        }
        let text = format!("this `{word}` belongs in the {}", block.noun());
        self.report_with_note(at - 1, format!("`}}` ends the {} before its last statement", block.noun()), at, &text);
        true
    }

    fn known_statement(&mut self, block: &mut Block) {
        let (scan, first) = (self.scan, self.at);
        let word = self.say();
        if !block.words().contains(&word) {
            return self.misplaced(block);
        }
        if matches!(block, Block::Tool(_)) && word == "surface" {
            return self.tool_surface(block, true);
        }
        if let (Block::Tool(statements), "profile") = (&mut *block, word) {
            return statements.push(ToolStatement::Profile(self.profile(true)));
        }
        if let (Block::Job(statements), "profile") = (&mut *block, word) {
            return statements.push(JobStatement::Profile(self.profile(true)));
        }
        let range = first..pieces::statement_end(scan, first);
        match self.piece(block.rule(), range.clone()) {
            Some(pair) => block.add(&mut self.build, pair),
            None => block.add_broken(scan, word, range),
        }
    }

    fn misplaced(&mut self, block: &Block) {
        let word = self.say();
        let places = [
            (words::IN_MACHINE, "a machine"),
            (words::IN_TOOL, "a tool"),
            (words::IN_SURFACE, "a surface of a tool"),
            (words::IN_JOB, "a job"),
        ];
        let fitting: Vec<_> =
            places.iter().filter(|(words, _)| words.contains(&word)).map(|(_, place)| *place).collect();
        let help = match fitting.split_last() {
            Some((last, rest)) if !rest.is_empty() => {
                format!("it belongs in {} or {last}", rest.join(", "))
            }
            _ => format!("it belongs in {}", fitting.join(", ")),
        };
        self.report(self.at, format!("`{word}` cannot stand in a {}", block.noun())).help = Some(help);
        self.at = pieces::statement_end(self.scan, self.at);
    }

    fn unknown_statement(&mut self, block: &mut Block) {
        let (scan, first) = (self.scan, self.at);
        let word = self.say();
        let list = format!("a {} consists of `{}`", block.noun(), block.words().join("`, `"));
        if scan.kind(first) != Some(Kind::Word) {
            self.report_sign("a statement", &list);
            let end = pieces::unknown_end(scan, first);
            self.at = if word == "{" { first + 1 } else { end };
            return;
        }
        if self.is_swapped() && block.words().contains(&scan.say(first + 1)) {
            self.swapped();
            self.at = pieces::statement_end(scan, first + 1);
            return block.add_broken(scan, scan.say(first + 1), first..self.at);
        }
        let assigns = scan.say(first + 1) == "=";
        let meant = closest(word, block.words().iter().copied()).filter(|meant| !assigns || *meant == "at");
        let named = if assigns { first } else { first + 1 };
        let place = scan.place(first);
        let is_let = block.words().contains(&"let") && scan.is_name(named) && scan.say(named + 1) == "=";
        let diagnostic = self.report(first, format!("{} does not begin a statement", scan.quote(first)));
        match meant {
            Some(meant) => mean(diagnostic, place, meant),
            None if is_let => {
                diagnostic.help = Some(format!("write `let {} = …` to give a value a name", scan.short(named)));
                let before = Span { end: if assigns { place.start } else { place.end }, ..place };
                let replacement = if assigns { "let " } else { "let" }.to_string();
                diagnostic.cures.push(Cure { title: "write `let`".to_string(), span: before, replacement });
            }
            None => diagnostic.help = Some(list),
        }
        if meant == Some("surface") && matches!(block, Block::Tool(_)) {
            return self.tool_surface(block, false);
        }
        if let (Block::Tool(statements), Some("profile")) = (&mut *block, meant) {
            return statements.push(ToolStatement::Profile(self.profile(false)));
        }
        self.at = pieces::unknown_end(scan, first);
        let otherwise = if scan.say(first + 2) == "on" { "mount" } else { "let" };
        block.add_broken(scan, meant.unwrap_or(otherwise), first..self.at);
    }

    /// A profile, segment by segment.
    fn profile(&mut self, strict: bool) -> Profile {
        let (scan, first) = (self.scan, self.at);
        let mistakes = self.build.diagnostics.len();
        let (head, opened) = self.head(strict);
        let Head { doc, name, .. } = match head {
            Some(pair) => self.build.head(pair),
            None => salvage::head(scan, first),
        };
        let mut segments = Vec::new();
        let ends = |at| scan.is_opening_word(at) && !pieces::is_right_of(scan, at, first);
        while self.goes_on() && self.say() != "}" && !ends(self.at) {
            segments.extend(self.segment());
        }
        if self.say() == "}" {
            self.at += 1;
        } else if self.at == scan.tokens.len() || ends(self.at) {
            self.unclosed(opened);
        }
        let broken = self.build.diagnostics.len() > mistakes;
        Profile { doc, name, segments, broken }
    }

    /// The next segment of a profile, or a report on what stands in its place.
    fn segment(&mut self) -> Option<Segment> {
        let (scan, first) = (self.scan, self.at);
        if pieces::begins_segment(scan, first) {
            let range = first..pieces::segment_end(scan, first);
            return match self.piece(Rule::profile_piece, range.clone()) {
                Some(pair) => self.build.segment(pair),
                None => Some(salvage::segment(scan, range)),
            };
        }
        if scan.is_opening_word(first) {
            self.report(first, format!("`{}` cannot stand in a profile", scan.say(first)));
            self.at = pieces::statement_end(scan, first);
            return None;
        }
        self.report_sign(SEGMENT, "a profile consists of lines, arcs and splines, each with a name");
        self.at = pieces::segment_end(scan, first);
        None
    }

    fn tool_surface(&mut self, block: &mut Block, strict: bool) {
        let first = self.at;
        let mistakes = self.build.diagnostics.len();
        let (head, opened) = self.head(strict);
        let parts = match head {
            Some(pair) => self.build.surface_head(pair),
            None => salvage::surface_head(self.scan, first..self.at),
        };
        let mut surface = Block::Surface(Box::new(parts));
        if opened.is_some() || words::IN_SURFACE.contains(&self.say()) {
            self.block(&mut surface, first, opened);
        }
        if let (Block::Tool(statements), Block::Surface(mut parts)) = (block, surface) {
            parts.broken |= self.build.diagnostics.len() > mistakes;
            statements.push(ToolStatement::Surface(self.build.finish_surface(*parts)));
        }
    }
}

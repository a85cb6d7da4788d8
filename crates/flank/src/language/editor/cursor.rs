//! What stands around a place in a text that is being written.

use flank_chain_dsl::FileId;
use flank_chain_dsl::syntax::{TokenKind, Vocabulary, comments, is_reserved, tokens, vocabulary};

/// The surroundings of a place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursor<'t> {
    /// The word that is being written begins here.
    pub(super) word: usize,
    /// What stands before it, in order; empty within comments and texts.
    pub(super) before: Vec<&'t str>,
    /// Where each of these begins.
    pub(super) starts: Vec<usize>,
    /// Which of these is the first of the statement.
    pub(super) first: usize,
    /// Whether the word before, on the same line, is a number.
    pub(super) is_after_number: bool,
    /// The blocks around it, the outermost first.
    pub(super) blocks: Vec<Block<'t>>,
    /// Words and signs of the statement before the word, from its first word on.
    pub(super) statement: Vec<&'t str>,
    /// The calls whose arguments are being written, the outermost first.
    pub(super) calls: Vec<Call<'t>>,
    /// Whether a statement may begin here.
    pub(super) is_beginning: bool,
    /// Whether it lies within a comment, a text, a number or a sign.
    pub(super) is_quiet: bool,
}

/// A block that is open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Block<'t> {
    /// The word that begins it.
    pub(super) word: &'t str,
    /// What it is called.
    pub(super) name: &'t str,
    /// Which of the words before the place is the first of its head.
    pub(super) first: usize,
}

/// A call that is open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Call<'t> {
    /// What is called; nothing of a parenthesis or a list.
    pub(super) name: &'t str,
    /// The arguments that have names before and behind the place.
    pub(super) given: Vec<&'t str>,
    /// The name of the argument that is being written.
    pub(super) argument: Option<&'t str>,
    /// How many arguments stand before it.
    pub(super) number: usize,
}

impl<'t> Cursor<'t> {
    /// Around a byte of a text.
    pub(super) fn at(text: &'t str, offset: usize) -> Cursor<'t> {
        let file = FileId(0);
        let is_inside = |start: u32, end: u32| (start as usize) < offset && offset <= end as usize;
        if comments(text, file).iter().any(|comment| is_inside(comment.span.start, comment.span.end)) {
            return Cursor { word: offset, is_quiet: true, ..Cursor::default() };
        }
        let words = vocabulary();
        let all = tokens(text, file);
        let mut cursor = Cursor { word: offset, is_beginning: true, ..Cursor::default() };
        let mut last_end = 0;
        for token in &all {
            let (start, end) = (token.span.start as usize, token.span.end as usize);
            if start >= offset {
                cursor.close(text, &all, offset);
                break;
            }
            if offset <= end && token.kind == TokenKind::Word {
                cursor.word = start;
                cursor.close(text, &all, end);
                break;
            }
            // within a number or a sign nothing begins
            let is_inside =
                offset < end || (token.kind == TokenKind::Text && is_within(&text[start..end], offset - start));
            if is_inside {
                cursor.is_quiet = true;
                return cursor;
            }
            let is_new_line = text[last_end..start].contains(['\n', '\r']);
            cursor.meet((&text[start..end], start), token.kind, (&words, is_new_line));
            last_end = end;
        }
        let gap_end = cursor.word.max(last_end);
        if text[last_end..gap_end].contains(['\n', '\r']) {
            cursor.is_beginning |= cursor.has_ended();
            cursor.is_after_number = false;
        }
        cursor
    }

    /// The innermost call.
    pub(super) fn call(&self) -> Option<&Call<'t>> {
        self.calls.last()
    }

    /// The word or sign before the place.
    pub(super) fn last(&self) -> &'t str {
        self.before.last().copied().unwrap_or_default()
    }

    /// The word that begins the statement.
    pub(super) fn opening(&self) -> &'t str {
        self.statement.first().copied().unwrap_or_default()
    }

    /// The word of the innermost block; nothing outside of all.
    pub(super) fn block(&self) -> &'t str {
        self.blocks.last().map_or("", |block| block.word)
    }

    /// The byte at which the statement begins, that of the place if it does not yet.
    pub(super) fn statement_start(&self) -> usize {
        self.starts.get(self.first).copied().unwrap_or(self.word)
    }

    /// One word or sign before the place.
    fn meet(&mut self, (said, start): (&'t str, usize), kind: TokenKind, (words, is_new_line): (&Vocabulary, bool)) {
        if kind == TokenKind::Word && self.begins(said, words, is_new_line) {
            self.statement.clear();
            self.calls.clear();
        }
        if self.statement.is_empty() {
            self.first = self.before.len();
        }
        match said {
            "{" => {
                let name = self.statement.get(1).copied().unwrap_or_default();
                self.blocks.push(Block { word: self.opening(), name, first: self.first });
                self.statement.clear();
            }
            "}" => {
                self.blocks.pop();
                self.statement.clear();
                self.calls.clear();
            }
            "(" | "[" => {
                let name = if said == "(" { self.last() } else { "" };
                let is_name = name.chars().next().is_some_and(|letter| letter.is_alphabetic() || letter == '_');
                self.calls.push(Call { name: if is_name { name } else { "" }, ..Call::default() });
            }
            ")" | "]" => drop(self.calls.pop()),
            ":" => {
                if let (Some(call), Some(name)) = (self.calls.last_mut(), self.before.last()) {
                    call.given.push(name);
                    call.argument = Some(name);
                }
            }
            "," => self.calls.iter_mut().last().into_iter().for_each(|call| {
                call.argument = None;
                call.number += 1;
            }),
            _ => {}
        }
        self.is_beginning = matches!(said, "{" | "}");
        self.is_after_number = kind == TokenKind::Number;
        self.before.push(said);
        self.starts.push(start);
        if matches!(said, "{" | "}") {
            self.first = self.before.len();
        } else {
            self.statement.push(said);
        }
    }

    /// Whether a word begins a statement of the block that is open.
    fn begins(&self, said: &str, words: &Vocabulary, is_new_line: bool) -> bool {
        let list = match self.block() {
            "" => words.items,
            "machine" => words.in_machine,
            "tool" => words.in_tool,
            "job" => words.in_job,
            "surface" => words.in_surface,
            _ => return is_new_line && self.has_ended(),
        };
        let ends = self.before.last().is_none_or(|last| is_end(last));
        // a word that is no name begins a statement, whatever was left open on the line before
        let is_sure = is_new_line && is_reserved(said);
        list.contains(&said) && (is_sure || (ends && (self.calls.is_empty() || is_new_line)))
    }

    /// Whether what stands before may be whole.
    fn has_ended(&self) -> bool {
        self.calls.is_empty() && self.before.last().is_none_or(|last| is_end(last))
    }

    /// Arguments of the call behind the place are given, too.
    fn close(&mut self, text: &'t str, all: &[flank_chain_dsl::syntax::Token], from: usize) {
        let Some(call) = self.calls.last_mut() else { return };
        let behind = all.iter().filter(|token| token.span.start as usize >= from);
        let (mut depth, mut last) = (0, "");
        for token in behind {
            let said = &text[token.span.start as usize..token.span.end as usize];
            match said {
                "(" | "[" => depth += 1,
                ")" | "]" if depth == 0 => break,
                ")" | "]" => depth -= 1,
                "{" | "}" => break,
                ":" if depth == 0 => call.given.push(last),
                _ => {}
            }
            last = said;
        }
    }
}

/// Whether a place lies within a text in quotes, or at the end of one that is still open.
fn is_within(text: &str, place: usize) -> bool {
    let is_closed = text.len() > 1 && text.ends_with('"');
    place < text.len() || (place == text.len() && !is_closed)
}

/// Whether a statement may end with a word or sign.
fn is_end(said: &str) -> bool {
    !matches!(
        said,
        "," | "=" | ":" | "(" | "[" | "+" | "-" | "*" | "/" | "^" | "." | ".." | "in" | "on" | "by" | "extends" | "->"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(marked: &str) -> Cursor<'static> {
        let text: &'static str = Box::leak(marked.replace('|', "").into_boxed_str());
        Cursor::at(text, marked.find('|').expect("a mark"))
    }

    #[test]
    fn a_place_knows_its_block_and_its_statement() {
        let cursor = at("machine m {\n axis X : linear\n fra|\n}");
        assert!(cursor.is_beginning);
        assert_eq!(cursor.blocks, [Block { word: "machine", name: "m", first: 0 }]);
        let cursor = at("job j {\n mount c on m.|\n}");
        assert_eq!((cursor.statement.first(), cursor.before.last()), (Some(&"mount"), Some(&".")));
        assert!(!cursor.is_beginning);
    }

    #[test]
    fn a_call_knows_what_is_given() {
        let cursor = at("job j {\n machine m = lathe(depth: 2 mm, |, lead: 3 mm)\n}");
        let call = cursor.call().expect("a call").clone();
        assert_eq!((call.name, call.given, call.argument), ("lathe", vec!["depth", "lead"], None));
        let cursor = at("job j {\n machine m = lathe(depth: 2 |)\n}");
        assert!(cursor.is_after_number);
        assert_eq!(cursor.call().expect("a call").argument, Some("depth"));
    }

    #[test]
    fn a_number_ends_with_its_line() {
        assert!(!at("tool t {\n let n = 3\n |\n}").is_after_number);
        assert!(at("tool t {\n let n = 3\n |\n}").is_beginning);
        assert!(at("tool t {\n let n = 3 |\n}").is_after_number);
    }

    #[test]
    fn comments_and_texts_are_left_alone() {
        assert!(at("// a |comment").is_quiet);
        assert!(at("use \"a|b\"").is_quiet);
        assert!(at("use \"ma|").is_quiet && at("use \"|").is_quiet);
        assert!(!at("use \"a\" |").is_quiet);
        assert!(at("let x = 1|0 mm").is_quiet && at("u: 1 mm .|. 2 mm").is_quiet);
        assert!(!at("u: 1 mm ..| 2 mm").is_quiet && !at("let x = a.|b").is_quiet);
    }
}

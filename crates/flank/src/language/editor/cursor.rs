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
    /// Whether the word before is a number.
    pub(super) is_after_number: bool,
    /// The blocks around it, the outermost first: the word that begins each, and its name.
    pub(super) blocks: Vec<(&'t str, &'t str)>,
    /// Words and signs of the statement before the word, from its first word on.
    pub(super) statement: Vec<&'t str>,
    /// The call whose argument is being written: what is called, and the arguments that are named already.
    pub(super) call: Option<Call<'t>>,
    /// Whether a statement may begin here.
    pub(super) is_beginning: bool,
    /// Whether it lies within a comment or a text.
    pub(super) is_quiet: bool,
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
        let mut calls: Vec<Call<'t>> = Vec::new();
        let mut last_end = 0;
        for token in &all {
            let (start, end) = (token.span.start as usize, token.span.end as usize);
            if start >= offset {
                cursor.close(text, &all, offset, &mut calls);
                break;
            }
            if offset <= end && token.kind == TokenKind::Word {
                cursor.word = start;
                cursor.is_beginning |= text[last_end..start].contains(['\n', '\r']) && cursor.has_ended(&calls);
                cursor.close(text, &all, end, &mut calls);
                break;
            }
            if offset <= end && token.kind == TokenKind::Text && offset < end {
                cursor.is_quiet = true;
                return cursor;
            }
            let said = &text[start..end];
            let is_new_line = text[last_end..start].contains(['\n', '\r']);
            cursor.meet(said, token.kind, (&words, is_new_line), &mut calls);
            last_end = end;
        }
        let gap_end = cursor.word.max(last_end);
        cursor.is_beginning |= text[last_end..gap_end].contains(['\n', '\r']) && cursor.has_ended(&calls);
        cursor.call = calls.pop();
        cursor
    }

    /// One word or sign before the place.
    fn meet(
        &mut self,
        said: &'t str,
        kind: TokenKind,
        (words, is_new_line): (&Vocabulary, bool),
        calls: &mut Vec<Call<'t>>,
    ) {
        if kind == TokenKind::Word && self.begins(said, words, is_new_line, calls) {
            self.statement.clear();
            calls.clear();
        }
        match said {
            "{" => {
                let word = self.statement.first().copied().unwrap_or_default();
                let name = self.statement.get(1).copied().unwrap_or_default();
                self.blocks.push((word, name));
                self.statement.clear();
            }
            "}" => {
                self.blocks.pop();
                self.statement.clear();
                calls.clear();
            }
            "(" | "[" => {
                let name = if said == "(" { self.before.last().copied().unwrap_or_default() } else { "" };
                let name = if name.chars().next().is_some_and(|letter| letter.is_alphabetic() || letter == '_') {
                    name
                } else {
                    ""
                };
                calls.push(Call { name, ..Call::default() });
            }
            ")" | "]" => drop(calls.pop()),
            ":" => {
                if let (Some(call), Some(name)) = (calls.last_mut(), self.before.last()) {
                    call.given.push(name);
                    call.argument = Some(name);
                }
            }
            "," => calls.iter_mut().last().into_iter().for_each(|call| call.argument = None),
            _ => {}
        }
        self.is_beginning = matches!(said, "{" | "}");
        self.is_after_number = kind == TokenKind::Number;
        self.before.push(said);
        if !matches!(said, "{" | "}") {
            self.statement.push(said);
        }
    }

    /// Whether a word begins a statement of the block that is open.
    fn begins(&self, said: &str, words: &Vocabulary, is_new_line: bool, calls: &[Call<'t>]) -> bool {
        let list = match self.blocks.last() {
            None => words.items,
            Some(("machine", _)) => words.in_machine,
            Some(("tool", _)) => words.in_tool,
            Some(("job", _)) => words.in_job,
            Some(("surface", _)) => words.in_surface,
            Some(_) => return is_new_line && calls.is_empty(),
        };
        let ends = self.before.last().is_none_or(|last| is_end(last));
        // a word that is no name begins a statement, whatever was left open on the line before
        let is_sure = is_new_line && is_reserved(said);
        list.contains(&said) && (is_sure || (ends && (calls.is_empty() || is_new_line)))
    }

    /// Whether what stands before may be whole.
    fn has_ended(&self, calls: &[Call<'t>]) -> bool {
        calls.is_empty() && self.before.last().is_none_or(|last| is_end(last))
    }

    /// Arguments of the call behind the place are given, too.
    fn close(&mut self, text: &'t str, all: &[flank_chain_dsl::syntax::Token], from: usize, calls: &mut [Call<'t>]) {
        let Some(call) = calls.last_mut() else { return };
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
        assert_eq!(cursor.blocks, [("machine", "m")]);
        let cursor = at("job j {\n mount c on m.|\n}");
        assert_eq!((cursor.statement.first(), cursor.before.last()), (Some(&"mount"), Some(&".")));
        assert!(!cursor.is_beginning);
    }

    #[test]
    fn a_call_knows_what_is_given() {
        let cursor = at("job j {\n machine m = lathe(depth: 2 mm, |, lead: 3 mm)\n}");
        let call = cursor.call.expect("a call");
        assert_eq!((call.name, call.given, call.argument), ("lathe", vec!["depth", "lead"], None));
        let cursor = at("job j {\n machine m = lathe(depth: 2 |)\n}");
        assert!(cursor.is_after_number);
        assert_eq!(cursor.call.expect("a call").argument, Some("depth"));
    }

    #[test]
    fn comments_and_texts_are_left_alone() {
        assert!(at("// a |comment").is_quiet);
        assert!(at("use \"a|b\"").is_quiet);
    }
}

//! What words are, for their colours, and what formulas amount to, beside them.

use std::collections::BTreeMap;

use flank_chain_dsl::syntax::{TokenKind, tokens};
use flank_chain_dsl::{FileId, NameKind, Target, WordKind};

use crate::language::editor::analysis::{Analysis, TextSpan};

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WordClass {
    /// Something that a text defines.
    Name(NameKind),
    /// A word of the language.
    Word(WordKind),
}

/// A word with what it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassifiedWord {
    /// The word.
    pub span: TextSpan,
    /// What it is.
    pub class: WordClass,
    /// Whether it is defined here.
    pub is_definition: bool,
}

/// What a formula amounts to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InlayValue {
    /// The byte behind the formula.
    pub offset: usize,
    /// The value with its unit.
    pub value: String,
}

impl Analysis {
    /// The words of the spec that lead somewhere, in order.
    pub fn classified(&self) -> Vec<ClassifiedWord> {
        let own = self.index.entries.iter().filter(|entry| entry.span.file == self.main);
        let classified = own.filter_map(|entry| {
            let class = match entry.target {
                Target::Symbol(id) => WordClass::Name(self.kind(id)),
                Target::Word(kind) => WordClass::Word(kind),
                Target::File(_) | Target::Missing(_) => return None,
            };
            Some(ClassifiedWord { span: self.text_span(entry.span)?, class, is_definition: entry.is_definition })
        });
        classified.collect()
    }

    /// What `let`s and settings amount to that stand in a part of the spec; also plain numbers with `literals`.
    pub fn inlay_values(&self, from: usize, to: usize, literals: bool) -> Vec<InlayValue> {
        let mut seen: BTreeMap<usize, Option<String>> = BTreeMap::new();
        let values = self.index.symbols.iter().flat_map(|symbol| self.counting(symbol));
        for value in values.filter(|value| value.written.file == self.main) {
            let end = value.written.end as usize;
            if !(from..=to).contains(&end) || value.written == value.name {
                continue;
            }
            if !literals && is_literal(self.sources.text(value.written)) {
                continue;
            }
            let shown = self.shown(value);
            // what differs from job to job has no one value
            let known = seen.entry(end).or_insert_with(|| Some(shown.clone()));
            known.take_if(|known| *known != shown);
        }
        seen.into_iter().filter_map(|(offset, value)| Some(InlayValue { offset, value: value? })).collect()
    }
}

/// Whether a formula is a number with its unit.
fn is_literal(text: &str) -> bool {
    let all = tokens(text, FileId(0));
    let numbers = all.iter().filter(|token| token.kind == TokenKind::Number).count();
    let is_part = |said: &str| ["-", "/", "^"].contains(&said) || flank_chain_dsl::unit_size(said).is_some();
    let others = all.iter().filter(|token| token.kind != TokenKind::Number);
    numbers == 1 && others.map(|token| &text[token.span.start as usize..token.span.end as usize]).all(is_part)
}

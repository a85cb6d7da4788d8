//! The parts of a text: what it defines, what can be folded, its jobs.

use std::collections::HashMap;

use flank_chain_dsl::syntax::{comments, tokens};
use flank_chain_dsl::{NameKind, SymbolId};

use crate::language::editor::analysis::{Analysis, TextSpan};

/// A definition with those inside it.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineItem {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: NameKind,
    /// Of one line.
    pub detail: String,
    /// The name.
    pub span: TextSpan,
    /// The whole definition.
    pub extent: TextSpan,
    /// What belongs to it.
    pub inside: Vec<OutlineItem>,
}

/// Lines that can be folded, from 0, both inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fold {
    /// The line that stays.
    pub first: usize,
    /// The last line that is hidden.
    pub last: usize,
    /// Whether they are comments.
    pub is_comment: bool,
}

/// A job of the spec itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutlinedJob {
    /// Its name.
    pub name: String,
    /// Where its name stands.
    pub span: TextSpan,
}

impl Analysis {
    /// What the spec itself defines.
    pub fn outline(&self) -> Vec<OutlineItem> {
        let mut parts: HashMap<SymbolId, Vec<SymbolId>> = HashMap::new();
        for (symbol, id) in self.index.symbols.iter().zip(0u32..) {
            let is_part = !matches!(symbol.kind, NameKind::Argument | NameKind::SurfaceParameter);
            if let Some(owner) = symbol.owner.filter(|_| is_part) {
                parts.entry(owner).or_default().push(SymbolId(id));
            }
        }
        let own = self.items().filter(|id| self.index.symbol(*id).name.file == self.main);
        own.filter_map(|id| self.outlined(id, &parts)).collect()
    }

    fn outlined(&self, id: SymbolId, parts: &HashMap<SymbolId, Vec<SymbolId>>) -> Option<OutlineItem> {
        let symbol = self.index.symbol(id);
        let own = parts.get(&id).into_iter().flatten();
        let inside: Vec<OutlineItem> = own.filter_map(|inner| self.outlined(*inner, parts)).collect();
        let (span, mut extent) = (self.text_span(symbol.name)?, self.text_span(symbol.extent)?);
        for inner in &inside {
            extent.start = extent.start.min(inner.extent.start);
            extent.end = extent.end.max(inner.extent.end);
        }
        let detail = self.signature(id).chars().take(100).collect();
        Some(OutlineItem { name: self.name(id).to_string(), kind: symbol.kind, detail, span, extent, inside })
    }

    /// What can be folded: whatever brackets hold over several lines, and comments in a row.
    pub fn folds(&self) -> Vec<Fold> {
        let text = self.text();
        let mut starts = vec![0];
        starts.extend(text.char_indices().filter(|(at, letter)| is_line_end(text, *at, *letter)).map(|(at, _)| at + 1));
        let line = |at: usize| starts.partition_point(|start| *start <= at) - 1;
        let mut open: Vec<usize> = Vec::new();
        let mut folds = Vec::new();
        for token in tokens(text, self.main) {
            match &text[token.span.start as usize..token.span.end as usize] {
                "{" | "(" | "[" => open.push(line(token.span.start as usize)),
                "}" | ")" | "]" => {
                    let (Some(first), last) = (open.pop(), line(token.span.start as usize)) else { continue };
                    // the line of the closing bracket stays
                    if first + 1 < last {
                        folds.push(Fold { first, last: last - 1, is_comment: false });
                    }
                }
                _ => {}
            }
        }
        let mut run: Option<Fold> = None;
        for comment in comments(text, self.main).iter().filter(|comment| comment.own_line) {
            let at = line(comment.span.start as usize);
            match &mut run {
                Some(fold) if fold.last + 1 == at => fold.last = at,
                _ => folds.extend(run.replace(Fold { first: at, last: at, is_comment: true })),
            }
        }
        folds.extend(run);
        folds.retain(|fold| fold.first < fold.last);
        folds.sort();
        folds.dedup_by_key(|fold| fold.first);
        folds
    }

    /// The jobs of the spec itself.
    pub fn jobs(&self) -> Vec<OutlinedJob> {
        let own = self.items().filter(|id| self.kind(*id) == NameKind::Job);
        let own = own.filter(|id| self.index.symbol(*id).name.file == self.main);
        let job = |id| {
            Some(OutlinedJob { name: self.name(id).to_string(), span: self.text_span(self.index.symbol(id).name)? })
        };
        own.filter_map(job).collect()
    }
}

fn is_line_end(text: &str, at: usize, letter: char) -> bool {
    letter == '\n' || (letter == '\r' && text.as_bytes().get(at + 1) != Some(&b'\n'))
}

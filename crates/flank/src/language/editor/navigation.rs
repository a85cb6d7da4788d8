//! From a name to where it is defined, and to all its uses.

use flank_chain_dsl::{Span, SymbolId, Target, WordKind};

use crate::language::editor::analysis::{Analysis, TextSpan};
use crate::language::editor::shipped;

/// A place at which something is named.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reference {
    /// The name.
    pub span: TextSpan,
    /// Whether it is defined here.
    pub is_definition: bool,
}

impl Analysis {
    /// Where the name at a byte of the spec is defined; in the shipped library, where no file of the project does. What is known of a contact or
    /// a solid, as `drive_side.lag`, comes with it.
    pub fn definition(&self, offset: usize) -> Option<TextSpan> {
        let entry = self.index.at(self.main, offset as u32)?;
        match entry.target {
            Target::Symbol(id) => self.text_span(self.index.symbol(id).name),
            Target::File(file) => self.text_span(Span { file, start: 0, end: 0 }),
            Target::Word(WordKind::Number) => self.definition(self.owner(entry.span)?),
            Target::Word(_) => None,
            Target::Missing(kind) => shipped::definition(self.sources.text(entry.span), kind),
        }
    }

    /// Where the name stands whose dot is before a place.
    fn owner(&self, span: Span) -> Option<usize> {
        let before = self.text().get(..span.start as usize)?.trim_end().strip_suffix('.')?.trim_end();
        Some(before.len() - before.chars().next_back()?.len_utf8())
    }

    /// The definition that all statements of one name in a machine and its variants go back to.
    pub fn first_definition(&self, offset: usize) -> Option<TextSpan> {
        match self.index.at(self.main, offset as u32)?.target {
            Target::Symbol(id) => self.text_span(self.index.symbol(self.index.root(id)).name),
            _ => None,
        }
    }

    /// All places that lead to a definition, in any file of the spec.
    pub fn references(&self, definition: &TextSpan) -> Vec<Reference> {
        let Some(id) = self.symbol_at(definition) else { return Vec::new() };
        let uses = self.index.uses(id);
        let reference = uses.filter_map(|entry| {
            Some(Reference { span: self.text_span(entry.span)?, is_definition: entry.is_definition })
        });
        reference.collect()
    }

    /// The symbol whose name stands at a place.
    pub(super) fn symbol_at(&self, definition: &TextSpan) -> Option<SymbolId> {
        let (file, _) = self.sources.files().find(|(_, file)| file.file.as_ref() == Some(&definition.file))?;
        let span = Span { file, start: definition.start as u32, end: definition.end as u32 };
        let found = self.index.symbols.iter().position(|symbol| symbol.name == span)?;
        Some(SymbolId(found as u32))
    }
}

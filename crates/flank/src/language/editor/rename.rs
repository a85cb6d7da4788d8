//! A new name for something, everywhere.

use flank_chain_dsl::syntax::{TokenKind, is_reserved, tokens};
use flank_chain_dsl::{FileId, NameKind, Symbol, SymbolId, Target, WordKind};
use thiserror::Error;

use crate::language::editor::analysis::{Analysis, TextSpan};
use crate::language::editor::shipped;

/// Why something cannot have a name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RenameError {
    /// There is nothing of the spec's own at the place.
    #[error("there is no name of a definition here")]
    NoName,
    /// It belongs to the library, which is read only.
    #[error(
        "`{0}` belongs to the shipped library, which stays as it is; `flank new {0}` takes a copy into the project"
    )]
    OfLibrary(String),
    /// The new name is none.
    #[error("`{0}` is not a name: letters, digits and `_`, not beginning with a digit")]
    NotAName(String),
    /// The new name is a word of the language.
    #[error("`{0}` is a word of the language")]
    Reserved(String),
    /// Something else has the name.
    #[error("`{0}` is the name of something else there already: line {1}")]
    Taken(String, usize),
}

impl Analysis {
    /// The name at a byte of the spec that can be changed.
    ///
    /// # Errors
    /// If there is none, or it is the library's.
    pub fn renamed(&self, offset: usize) -> Result<TextSpan, RenameError> {
        let entry = self.index.at(self.main, offset as u32).ok_or(RenameError::NoName)?;
        let definition = self.first_definition(offset).ok_or(RenameError::NoName)?;
        if shipped::is_shipped(&definition.file) {
            return Err(RenameError::OfLibrary(self.sources.text(entry.span).to_string()));
        }
        self.text_span(entry.span).ok_or(RenameError::NoName)
    }

    /// Whether a definition may have a new name.
    ///
    /// # Errors
    /// If it is none, or something beside it has it already.
    pub fn check_name(&self, definition: &TextSpan, name: &str) -> Result<(), RenameError> {
        let all = tokens(name, FileId(0));
        let is_name = matches!(all.as_slice(), [token] if token.kind == TokenKind::Word && token.span.end as usize == name.len() && token.span.start == 0);
        if !is_name {
            return Err(RenameError::NotAName(name.to_string()));
        }
        if is_reserved(name) {
            return Err(RenameError::Reserved(name.to_string()));
        }
        let Some(id) = self.symbol_at(definition) else { return Ok(()) };
        let own = self.index.root(id);
        let owners: Vec<Option<SymbolId>> = self.alike(own).map(|symbol| symbol.owner).collect();
        let is_beside = |owner: Option<SymbolId>| {
            let is_related = |other: &Option<SymbolId>| match (owner, *other) {
                (Some(owner), Some(other)) => self.extends(owner, other) || self.extends(other, owner),
                (owner, other) => owner == other,
            };
            owners.iter().any(is_related)
        };
        let beside = self.index.symbols.iter().zip(0u32..).find(|(symbol, other)| {
            let is_own = self.index.root(SymbolId(*other)) == own;
            let is_alike = is_apart(symbol.kind) == is_apart(self.kind(own));
            // a job that extends another one may ask for points by a coordinate of the same name
            let is_of_another_sample = [symbol.kind, self.kind(own)] == [NameKind::Coordinate; 2]
                && symbol.owner != self.index.symbol(own).owner;
            !is_own
                && is_alike
                && !is_of_another_sample
                && self.sources.text(symbol.name) == name
                && is_beside(symbol.owner)
        });
        match beside {
            Some((symbol, _)) => Err(RenameError::Taken(name.to_string(), self.sources.place(symbol.name).1)),
            None => Ok(()),
        }
    }

    /// The first name that leads elsewhere, or to another word of the language, once names are changed and nothing else: what it would mean
    /// then, in words.
    pub fn first_other_meaning(&self, renamed: &Analysis) -> Option<String> {
        let (before, after) = (&self.index.entries, &renamed.index.entries);
        // renaming moves places, and leaves their order and that of definitions
        let other =
            before.iter().zip(after).find(|(before, after)| !is_alike(self, before.target, renamed, after.target));
        if let Some((before, after)) = other {
            let (_, line, _) = renamed.sources.place(after.span);
            let name = renamed.sources.text(after.span);
            let [was, is] = [self.meaning(before.target), renamed.meaning(after.target)];
            return Some(format!("`{name}` in line {line} would be {is}, and not {was}"));
        }
        (before.len() != after.len()).then(|| "names would be read otherwise".to_string())
    }

    /// What a name leads to, in words.
    fn meaning(&self, target: Target) -> String {
        match target {
            Target::Symbol(id) => {
                let Symbol { kind, name, .. } = self.index.symbol(id);
                format!("the {} of line {}", kind.described(), self.sources.place(*name).1)
            }
            Target::File(_) => "a file".to_string(),
            Target::Word(WordKind::Coordinate) => "the coordinate of a point".to_string(),
            Target::Word(WordKind::Function) => "the function of the language".to_string(),
            Target::Word(_) => "the word of the language".to_string(),
            Target::Missing(kind) => format!("a {} that there is not", kind.described()),
        }
    }

    /// All that goes back to one definition.
    fn alike(&self, root: SymbolId) -> impl Iterator<Item = &Symbol> {
        let all = self.index.symbols.iter().zip(0u32..);
        all.filter(move |(_, id)| self.index.root(SymbolId(*id)) == root).map(|(symbol, _)| symbol)
    }

    /// Whether a definition is another one, or extends it.
    fn extends(&self, id: SymbolId, other: SymbolId) -> bool {
        let line = std::iter::successors(Some(id), |id| self.index.symbol(*id).definition);
        // as many steps as there are definitions: a circle is wrong, and ends here
        line.take(self.index.symbols.len()).any(|id| id == other)
    }
}

/// Frames, words of NC programs and surfaces of tools may be called as an axis or a parameter beside them; whether any name would lead elsewhere
/// then is seen once it has changed.
fn is_apart(kind: NameKind) -> Option<NameKind> {
    Some(kind).filter(|kind| [NameKind::Frame, NameKind::NcWord, NameKind::ToolSurface].contains(kind))
}

/// Whether names lead to the same thing: definitions are in the same order whatever they are called.
fn is_alike(of: &Analysis, target: Target, other_of: &Analysis, other: Target) -> bool {
    match (target, other) {
        (Target::Symbol(id), Target::Symbol(other)) => id == other && of.index.root(id) == other_of.index.root(other),
        (target, other) => target == other,
    }
}

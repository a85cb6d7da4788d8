//! The index of names as a document, for other tools.

use flank_chain_dsl::{Entry, Target};
use schemars::JsonSchema;
use serde::Serialize;

use crate::language::editor::analysis::Analysis;
use crate::project::findings::Place;
use crate::project::units;

/// One name in a spec or a file that it uses.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct IndexedName {
    /// Where it stands, with the name itself.
    pub place: Place,
    /// What it stands for, in the words of the language; `word` for words of the language that may also be names, `file` for the path
    /// of a file, `missing` for what is not defined.
    pub what: String,
    /// Where it is defined; null where it has no definition.
    pub defined: Option<Place>,
    /// Whether it is defined here.
    pub is_definition: bool,
    /// Lines of documentation, of a definition.
    pub doc: Vec<String>,
    /// The dimension as written, of a definition that has one.
    pub dimension: Option<String>,
    /// The range as written, of a definition that has one.
    pub range: Option<String>,
    /// The value as written, of a definition that has one.
    pub written: Option<String>,
    /// What it amounts to, of a definition that has values.
    pub values: Vec<IndexedValue>,
}

/// What a name amounts to.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct IndexedValue {
    /// Whose value it is: `job.m` for the machine m of a job.
    pub of: String,
    /// Of the value; empty for a number.
    pub unit: String,
    /// In its unit.
    pub value: f64,
}

impl Analysis {
    /// All names, in the order of their places.
    pub fn indexed(&self) -> Vec<IndexedName> {
        self.index.entries.iter().map(|entry| self.indexed_name(entry)).collect()
    }

    fn indexed_name(&self, entry: &Entry) -> IndexedName {
        let mut named = IndexedName {
            place: Place::of_span(&self.sources, entry.span),
            what: "word".to_string(),
            defined: None,
            is_definition: entry.is_definition,
            doc: Vec::new(),
            dimension: None,
            range: None,
            written: None,
            values: Vec::new(),
        };
        match entry.target {
            Target::Word(_) => {}
            Target::Missing(_) => named.what = "missing".to_string(),
            Target::File(file) => {
                named.what = "file".to_string();
                let start = flank_chain_dsl::Span { file, start: 0, end: 0 };
                named.defined = Some(Place::of_span(&self.sources, start));
            }
            Target::Symbol(id) => {
                let symbol = self.index.symbol(id);
                named.what = symbol.kind.described().to_string();
                named.defined = Some(Place::of_span(&self.sources, symbol.name));
                if entry.is_definition {
                    let text = |span| self.one_line(span);
                    named.doc = self.documentation(symbol);
                    named.dimension = symbol.dimension.map(text);
                    named.range = symbol.range.map(text);
                    named.written = symbol.value.map(text);
                    let values = self.index.values_of(symbol).iter();
                    named.values = values
                        .map(|value| IndexedValue {
                            of: value.of.clone(),
                            unit: units::whole_symbol(value.dimension),
                            value: units::shown(value.dimension, value.value),
                        })
                        .collect();
                }
            }
        }
        named
    }
}

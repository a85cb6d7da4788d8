//! Machines and tools of the library by themselves.

use std::path::Path;

use flank_chain_dsl::syntax::ast::Item;
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, Span};

use crate::exchange::changes::{Changes, Given};
use crate::exchange::library::{texts, used_by};
use crate::exchange::made::{Made, MadeKind, NewJob};
use crate::project::failure::Failure;

/// A machine or a tool of the library.
pub(super) struct Part {
    pub(super) name: String,
    pub(super) kind: MadeKind,
    pub(super) doc: Vec<String>,
    /// Its file within the library.
    path: &'static Path,
    text: &'static str,
}

/// All of them by name; those in files of jobs belong to these.
pub(super) fn all() -> Vec<Part> {
    let mut parts: Vec<Part> = texts().flat_map(|(path, text)| in_file(path, text)).collect();
    parts.sort_by(|a, b| a.name.cmp(&b.name));
    parts
}

pub(super) fn find(name: &str) -> Option<Part> {
    all().into_iter().find(|part| part.name == name)
}

fn in_file(path: &'static Path, text: &'static str) -> Vec<Part> {
    let (file, _) = parse(text, FileId(0));
    if file.items.iter().any(|item| matches!(item, Item::Job(_) | Item::Variant(_))) {
        return Vec::new();
    }
    let part = |item: Item| {
        let (name, kind, doc) = match item {
            Item::Machine(machine) => (machine.name.node, MadeKind::Machine, machine.doc),
            Item::Tool(tool) => (tool.name.node, MadeKind::Tool, tool.doc),
            _ => return None,
        };
        Some(Part { name, kind, doc, path, text })
    };
    let mut parts: Vec<Part> = file.items.into_iter().filter_map(part).collect();
    // the head of a file says what its first machine or tool is
    if let Some(first) = parts.first_mut().filter(|_| !file.doc.is_empty()) {
        first.doc = file.doc;
    }
    parts
}

impl Part {
    /// Its file as it is, or the file of a variant, with all that it uses.
    ///
    /// # Errors
    /// If it is given values, which it has none of, or a tool another name.
    pub(super) fn made(&self, request: &NewJob) -> Result<Made, Failure> {
        if let Some((value, _)) = request.values.first() {
            return Err(Failure::Request(format!(
                "`{}` gets its values in a job: `{value}` is given there, as a setting of it",
                self.name
            )));
        }
        let own = (self.path.to_path_buf(), self.text.to_string());
        let (mut files, changes) = match (&request.name, self.kind) {
            (None, _) => (vec![own], Changes::new(Vec::new())),
            (Some(name), MadeKind::Machine) => {
                let file = self.path.file_name().unwrap_or_default().to_string_lossy();
                let head = format!(
                    "//! A variant of `{of}`: parameters, axes and frames beside its own, or in the place of those of the same name.\n\n\
                     use \"{file}\"\n\nmachine ",
                    of = self.name
                );
                let place = Span { file: FileId(0), start: head.len() as u32, end: head.len() as u32 };
                let changes = Changes::new(vec![(place, Given::name(name))]);
                let path = self.path.with_file_name(format!("{}.chain", name.text));
                if path == self.path {
                    return Err(Failure::Request(format!(
                        "`{}` is the library's own file: take another name",
                        name.text
                    )));
                }
                let text = changes.applied(&format!("{head} extends {} {{}}\n", self.name));
                (vec![(path, text), own], changes)
            }
            (Some(_), _) => {
                return Err(Failure::Request(format!(
                    "`{}` is a tool, which no other one extends: take it under its own name, and change the copy",
                    self.name
                )));
            }
        };
        used_by(self.path, self.text, &mut files).map_err(Failure::Input)?;
        Ok(Made { files, changes })
    }
}

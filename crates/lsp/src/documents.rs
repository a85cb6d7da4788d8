//! The texts that the editor has, and files beneath them.

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank::{Disk, Files, FolderEntry, ShippedFiles};
use gen_lsp_types::TextDocumentContentChangeEvent;

use super::position::Lines;
use super::uri;

/// A text in the editor.
#[derive(Clone, Debug)]
pub(super) struct Document {
    /// As the editor calls it.
    pub(super) uri: String,
    /// Of the text, as the editor counts.
    pub(super) version: i32,
    pub(super) text: Arc<str>,
    /// The generation of all texts with which it came to be as it is.
    pub(super) since: u64,
}

impl Document {
    pub(super) fn new(uri: String, version: i32, text: String) -> Document {
        Document { uri, version, text: text.into(), since: 0 }
    }
}

/// All texts in the editor by their paths.
#[derive(Clone, Debug, Default)]
pub(super) struct Documents {
    open: Arc<BTreeMap<PathBuf, Document>>,
    /// Counts changes.
    pub(super) generation: u64,
}

impl Documents {
    pub(super) fn open(&mut self, mut document: Document) -> PathBuf {
        let path = real(&uri::path(&document.uri));
        self.generation += 1;
        document.since = self.generation;
        Arc::make_mut(&mut self.open).insert(path.clone(), document);
        path
    }

    pub(super) fn close(&mut self, path: &Path) {
        self.generation += 1;
        Arc::make_mut(&mut self.open).remove(path);
    }

    /// Takes changes in their order; false for a text that is not open.
    pub(super) fn change(&mut self, path: &Path, version: i32, changes: Vec<TextDocumentContentChangeEvent>) -> bool {
        self.generation += 1;
        let Some(document) = Arc::make_mut(&mut self.open).get_mut(path) else { return false };
        let mut text = document.text.to_string();
        for change in changes {
            match change {
                TextDocumentContentChangeEvent::TextDocumentContentChangeWholeDocument(whole) => text = whole.text,
                TextDocumentContentChangeEvent::TextDocumentContentChangePartial(part) => {
                    let lines = Lines::of(&text);
                    let (start, end) = (lines.offset(part.range.start), lines.offset(part.range.end));
                    text.replace_range(start..end.max(start), &part.text);
                }
            }
        }
        document.text = text.into();
        document.version = version;
        document.since = self.generation;
        true
    }

    pub(super) fn get(&self, path: &Path) -> Option<&Document> {
        self.open.get(path)
    }

    /// The text behind an address, open or not.
    pub(super) fn find(&self, address: &str) -> Option<(PathBuf, &Document)> {
        // most are asked for as they were opened
        let same = self.open.iter().find(|(_, document)| document.uri == address);
        let found = same.map(|(path, _)| path.clone()).unwrap_or_else(|| real(&uri::path(address)));
        self.open.get(&found).map(|document| (found, document))
    }

    pub(super) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.open.keys()
    }

    /// How the editor calls a file.
    pub(super) fn uri_of(&self, path: &Path) -> String {
        self.open.get(path).map_or_else(|| uri::of_path(path), |document| document.uri.clone())
    }
}

/// A path without links and `..`, of a file that need not be there.
pub(super) fn real(path: &Path) -> PathBuf {
    if let Ok(found) = std::fs::canonicalize(path) {
        return found;
    }
    let plain = plain(path);
    match (plain.parent().map(std::fs::canonicalize), plain.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => plain,
    }
}

fn plain(path: &Path) -> PathBuf {
    use std::path::Component;
    path.components().fold(PathBuf::new(), |mut out, part| {
        match part {
            Component::ParentDir => drop(out.pop()),
            Component::CurDir => {}
            other => out.push(other),
        }
        out
    })
}

impl Files for Documents {
    fn real_path(&self, path: &Path) -> Result<PathBuf> {
        let plain = plain(path);
        if self.open.contains_key(&plain) {
            return Ok(plain);
        }
        if ShippedFiles::inside(&plain).is_some() {
            return ShippedFiles.real_path(&plain);
        }
        match Disk.real_path(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let real = real(path);
                if self.open.contains_key(&real) { Ok(real) } else { Err(error) }
            }
            found => found,
        }
    }

    fn exists(&self, path: &Path) -> bool {
        self.open.contains_key(path) || ShippedFiles.exists(path) || Disk.exists(path)
    }

    fn read(&self, path: &Path, most: usize) -> Result<String> {
        match self.open.get(path) {
            Some(document) if document.text.len() > most => Err(Error::from(ErrorKind::FileTooLarge)),
            Some(document) => Ok(document.text.to_string()),
            None if ShippedFiles::inside(path).is_some() => ShippedFiles.read(path, most),
            None => Disk.read(path, most),
        }
    }

    fn entries(&self, folder: &Path, most: usize) -> Vec<FolderEntry> {
        let folder = plain(folder);
        if ShippedFiles::inside(&folder).is_some() {
            return ShippedFiles.entries(&folder, most);
        }
        let folder = real(&folder);
        FolderEntry::with_texts(Disk.entries(&folder, most), &folder, self.open.keys())
    }
}

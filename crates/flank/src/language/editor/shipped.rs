//! The library inside the program as files that can be read.

use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::syntax::ast::Item;
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, Files, FolderEntry, NameKind};

use crate::exchange::library;
use crate::language::editor::analysis::TextSpan;

/// The folder that stands for the library.
const ROOT: &str = "/flank-library:";

/// The library's files, below a folder that no system has; all others are read from elsewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShippedFiles;

impl ShippedFiles {
    /// Where a file of the library is found, by its path within.
    pub fn path(inside: &str) -> PathBuf {
        Path::new(ROOT).join(inside.trim_start_matches('/'))
    }

    /// The path within the library.
    pub fn inside(path: &Path) -> Option<&Path> {
        path.strip_prefix(ROOT).ok()
    }

    /// The text of a file, by its path within the library.
    pub fn text(inside: &Path) -> Option<&'static str> {
        library::text(inside)
    }
}

impl Files for ShippedFiles {
    fn real_path(&self, path: &Path) -> Result<PathBuf> {
        let plain = path.components().fold(PathBuf::new(), |mut out, part| {
            match part {
                Component::ParentDir => drop(out.pop()),
                Component::CurDir => {}
                other => out.push(other),
            }
            out
        });
        let is_there =
            Self::inside(&plain).is_some_and(|inside| library::text(inside).is_some() || library::has_folder(inside));
        if is_there { Ok(plain) } else { Err(ErrorKind::NotFound.into()) }
    }

    fn exists(&self, path: &Path) -> bool {
        // the library is a project of its own
        path == Path::new(ROOT).join("flank.toml") || self.real_path(path).is_ok()
    }

    fn read(&self, real: &Path, _: usize) -> Result<String> {
        let text = Self::inside(real).and_then(library::text);
        text.map(str::to_string).ok_or_else(|| Error::from(ErrorKind::NotFound))
    }

    fn entries(&self, folder: &Path, _: usize) -> Vec<FolderEntry> {
        Self::inside(folder).map(library::entries).unwrap_or_default()
    }
}

/// Whether a file is one of the library.
pub(super) fn is_shipped(file: &Path) -> bool {
    ShippedFiles::inside(file).is_some()
}

/// Where the library defines something.
pub(super) fn definition(name: &str, kind: NameKind) -> Option<TextSpan> {
    library::texts().find_map(|(path, text)| {
        let (file, _) = text.contains(name).then(|| parse(text, FileId(0)))?;
        let found =
            file.items.iter().find(|item| is_of_kind(item, kind) && item.name().is_some_and(|of| of.node == name))?;
        let span = found.name()?.span;
        Some(TextSpan { file: Path::new(ROOT).join(path), start: span.start as usize, end: span.end as usize })
    })
}

fn is_of_kind(item: &Item, kind: NameKind) -> bool {
    match item {
        Item::Machine(_) => kind == NameKind::Machine,
        Item::Tool(_) => kind == NameKind::Tool,
        Item::Job(_) | Item::Variant(_) => kind == NameKind::Job,
        Item::Function(_) => kind == NameKind::Function,
        Item::Use(_) => false,
    }
}

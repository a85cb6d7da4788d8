//! The texts of the library.

use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::syntax::ast::Item;
use flank_chain_dsl::syntax::parse;
use flank_chain_dsl::{FileId, FolderEntry};
use include_dir::{Dir, include_dir};

use crate::project::shown_path;

/// The library as it was when the program was built.
static LIBRARY: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../specs");

/// Whether a file of the library defines something of a name.
pub(crate) fn defines(path: &str, name: &str) -> bool {
    let text = LIBRARY.get_file(path).and_then(|file| file.contents_utf8()).unwrap_or_default();
    parse(text, FileId(0)).0.items.iter().filter_map(Item::name).any(|known| known.node == name)
}

/// All specs with their paths within the library.
pub(crate) fn texts() -> impl Iterator<Item = (&'static Path, &'static str)> {
    files(&LIBRARY).filter(|(path, _)| path.extension().is_some_and(|extension| extension == "chain"))
}

/// The text of a file by its path within the library.
pub(crate) fn text(path: &Path) -> Option<&'static str> {
    LIBRARY.get_file(path)?.contents_utf8()
}

/// Whether there is such a folder.
pub(crate) fn has_folder(path: &Path) -> bool {
    path.as_os_str().is_empty() || LIBRARY.get_dir(path).is_some()
}

/// What a folder of the library holds.
pub(crate) fn entries(path: &Path) -> Vec<FolderEntry> {
    let Some(folder) = (if path.as_os_str().is_empty() { Some(&LIBRARY) } else { LIBRARY.get_dir(path) }) else {
        return Vec::new();
    };
    let entry = |path: &Path, is_folder| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        FolderEntry { name, is_folder }
    };
    let folders = folder.dirs().map(|inner| entry(inner.path(), true));
    folders.chain(folder.files().map(|file| entry(file.path(), false))).collect()
}

fn files(folder: &'static Dir<'static>) -> impl Iterator<Item = (&'static Path, &'static str)> {
    let inner = folder.dirs().flat_map(|inner| files(inner).collect::<Vec<_>>());
    folder.files().filter_map(|file| Some((file.path(), file.contents_utf8()?))).chain(inner)
}

/// Adds what a file of the library uses, and what that uses; also the tables that they are tested by.
pub(super) fn used_by(path: &Path, text: &str, all: &mut Vec<(PathBuf, String)>) -> Result<(), String> {
    let (file, _) = parse(text, FileId(0));
    for table in file.expected_tables() {
        let path = plain(&path.with_file_name(table));
        if all.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let text = LIBRARY.get_file(&path).and_then(|file| file.contents_utf8());
        all.push((path.clone(), text.ok_or_else(|| format!("the library lacks {}", shown_path(&path)))?.to_owned()));
    }
    for item in file.items {
        let Item::Use(used) = item else { continue };
        let path = plain(&path.with_file_name(used.node));
        if all.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let text = LIBRARY.get_file(&path).and_then(|file| file.contents_utf8());
        let text = text.ok_or_else(|| format!("the library lacks {}", shown_path(&path)))?;
        all.push((path.clone(), text.to_owned()));
        used_by(&path, text, all)?;
    }
    Ok(())
}

/// A path without `..`.
fn plain(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut out, part| {
        match part {
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
        out
    })
}

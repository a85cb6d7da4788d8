//! Files that a `use` may name.

use std::path::{Component, Path, PathBuf};

use flank_chain_dsl::syntax::{TokenKind, tokens};
use flank_chain_dsl::{FileId, Files, project_folder};

use crate::language::editor::analysis::{Analysis, TextSpan};
use crate::language::editor::completion::{Completion, CompletionKind};

/// Entries of a folder that are looked at, and those that are proposed.
const LOOKED_AT: usize = 20_000;
const MOST: usize = 500;

/// Files and folders that may stand at a place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PathCompletions {
    /// In their order.
    pub found: Vec<Completion>,
    /// Whether there may be more: with more letters, others are found.
    pub is_part: bool,
}

/// A path that is being written.
struct Written<'t> {
    /// The folders before the name at the place, with their last slash.
    folders: &'t str,
    /// What is written of the name before the place.
    name: &'t str,
    /// The whole name.
    start: usize,
    end: usize,
    /// Whether a slash stands behind it already.
    has_slash: bool,
}

impl Analysis {
    /// The files and folders that may stand at a byte of the spec, of those that are there now; nothing where the place is not within the path
    /// of a `use`.
    pub fn path_completions(&self, offset: usize, files: &dyn Files) -> Option<PathCompletions> {
        let written = written(self.text(), offset)?;
        let own = self.files().into_iter().next()?;
        let here = own.parent()?;
        let project = project_folder(files, &own);
        let folder = tidy(&here.join(written.folders));
        if !folder.starts_with(&project) || Path::new(written.folders).is_absolute() {
            return Some(PathCompletions::default());
        }
        let entries = files.entries(&folder, LOOKED_AT);
        let replaces = TextSpan { file: own.clone(), start: written.start, end: written.end };
        let slash = if written.has_slash { "" } else { "/" };
        let proposal = |name: &str, is_folder: bool| Completion {
            label: if is_folder { format!("{name}/") } else { name.to_string() },
            kind: if is_folder { CompletionKind::Folder } else { CompletionKind::File },
            detail: String::new(),
            text: if is_folder { format!("{name}{slash}") } else { name.to_string() },
            is_snippet: false,
            replaces: replaces.clone(),
            rank: if is_folder { 1 } else { 0 },
        };
        let is_meant = |name: &str, is_folder: bool| {
            let is_spec = name.ends_with(".chain") && folder.join(name) != own && !written.has_slash;
            !name.contains(['"', '\\', '\n', '\r']) && (is_folder || is_spec)
        };
        let all = entries.iter().filter(|entry| is_meant(&entry.name, entry.is_folder));
        let mut found: Vec<Completion> = all.map(|entry| proposal(&entry.name, entry.is_folder)).collect();
        found.sort_by_key(|one| one.rank);
        let is_many = found.len() > MOST;
        if is_many {
            let begun = written.name.to_lowercase();
            found.retain(|one| one.label.to_lowercase().starts_with(&begun));
        }
        found.truncate(MOST);
        let is_upward = written.folders.split_terminator('/').all(|part| part == "..");
        if is_upward && folder.parent().is_some_and(|above| above.starts_with(&project)) {
            found.push(Completion { rank: 2, ..proposal("..", true) });
        }
        Some(PathCompletions { found, is_part: is_many || entries.len() >= LOOKED_AT })
    }
}

/// The path of a `use` around a place; an open text in quotes goes on to the end of its line.
fn written(text: &str, offset: usize) -> Option<Written<'_>> {
    let before = text.get(..offset)?;
    let all = tokens(text, FileId(0));
    let at = all.iter().rposition(|token| (token.span.start as usize) < offset)?;
    let [word, path] =
        [all.get(at.checked_sub(1)?)?, &all[at]].map(|token| token.span.start as usize..token.span.end as usize);
    if all[at].kind != TokenKind::Text || &text[word] != "use" {
        return None;
    }
    let is_closed = path.len() > 1 && text[path.clone()].ends_with('"');
    let said = &before[path.start + 1..];
    if (is_closed && offset >= path.end) || said.contains(['\n', '\r']) {
        return None;
    }
    let folders = said.rfind('/').map_or(0, |slash| slash + 1);
    let start = path.start + 1 + folders;
    // the rest of an open text may be what was there before
    let rest = if is_closed { text[offset..path.end].find(['/', '"']).unwrap_or(0) } else { 0 };
    let end = offset + rest;
    let has_slash = is_closed && text[end..].starts_with('/');
    Some(Written { folders: &said[..folders], name: &said[folders..], start, end, has_slash })
}

fn tidy(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut out, part| {
        match part {
            Component::ParentDir => drop(out.pop()),
            Component::CurDir => {}
            other => out.push(other),
        }
        out
    })
}

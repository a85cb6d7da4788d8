//! The file that a path with slips in it most likely means.

use std::path::Path;

use crate::diagnostics::spelling::closest;
use crate::load::files::{Files, FolderEntry};
use crate::load::tidy;

/// How much of a folder is looked at.
const LOOKED_AT: usize = 4096;
/// What specs end with.
const ENDING: &str = ".chain";

/// A path from a folder that leads to a spec, with each of its names as written or the nearest of those that are there.
pub(super) fn nearest(from: &dyn Files, here: &Path, used: &str) -> Option<String> {
    let mut folder = here.to_path_buf();
    let mut meant = Vec::new();
    let (folders, name) = used.rsplit_once('/').map_or((None, used), |(folders, name)| (Some(folders), name));
    for part in folders.iter().flat_map(|folders| folders.split('/')) {
        let part = match part {
            "" | "." | ".." => part.to_string(),
            _ => of_those(part, &from.entries(&folder, LOOKED_AT), true)?,
        };
        folder = tidy(&folder.join(&part));
        meant.push(part);
    }
    let stem = name.strip_suffix(ENDING).unwrap_or(name);
    meant.push(of_those(stem, &from.entries(&folder, LOOKED_AT), false)? + ENDING);
    Some(meant.join("/"))
}

/// Of folders, or of specs without what they end with.
fn of_those(name: &str, entries: &[FolderEntry], are_folders: bool) -> Option<String> {
    let plain = |entry: &&FolderEntry| entry.is_folder == are_folders && !entry.name.contains(['"', '\\']);
    let names = entries.iter().filter(plain).map(|entry| entry.name.as_str());
    let names = names.filter_map(|name| if are_folders { Some(name) } else { name.strip_suffix(ENDING) });
    let names: Vec<&str> = names.collect();
    let same = names.iter().find(|known| **known == name).copied();
    same.or_else(|| closest(name, names)).map(str::to_string)
}

//! Which specs are tested.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use flank_chain_dsl::unreadable_reason;

use crate::project::failure::Failure;
use crate::project::shown_path;

/// Folders inside each other that are still looked into.
const DEEPEST: usize = 32;

/// The specs that paths lead to, each once, by name: a file itself, of a folder all that end in `.chain`, also in the folders of it.
/// Links to folders and hidden folders are left out. A file to which several paths lead is there under the first of its names.
///
/// # Errors
/// If a path leads nowhere, or a folder holds no spec.
pub fn find_specs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut all = BTreeMap::new();
    let mut add = |spec: PathBuf| {
        let real = std::fs::canonicalize(&spec).unwrap_or_else(|_| spec.clone());
        let name = all.entry(real).or_insert_with(|| spec.clone());
        if spec < *name {
            *name = spec;
        }
    };
    for path in paths {
        let unreadable =
            |error: &std::io::Error| format!("cannot read `{}`: {}", shown_path(path), unreadable_reason(error));
        let kind = std::fs::metadata(path).map_err(|error| unreadable(&error))?;
        if !kind.is_dir() {
            add(path.clone());
            continue;
        }
        let mut found = Vec::new();
        look_into(path, DEEPEST, &mut found).map_err(|error| unreadable(&error))?;
        if found.is_empty() {
            let message = format!("`{}` holds no spec: their names end in `.chain`", shown_path(path));
            return Err(Failure::Input(message));
        }
        found.into_iter().for_each(&mut add);
    }
    let mut specs: Vec<PathBuf> = all.into_values().collect();
    specs.sort();
    Ok(specs)
}

fn look_into(folder: &Path, deepest: usize, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let (path, kind) = (entry.path(), entry.file_type()?);
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        if kind.is_dir() && !is_hidden && deepest > 0 {
            look_into(&path, deepest - 1, found)?;
        // a link that leads nowhere is a spec that cannot be read
        } else if !kind.is_dir()
            && !path.is_dir()
            && !is_hidden
            && path.extension().is_some_and(|extension| extension == "chain")
        {
            found.push(path);
        }
    }
    Ok(())
}

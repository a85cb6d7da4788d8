//! From the command line's file to a spec.

use std::path::Path;
use std::sync::Arc;

use flank::{Disk, Project};

use crate::failure::Failure;

/// A spec with the files that it uses; the standard input where its file is called `-`.
///
/// # Errors
/// If the standard input cannot be read.
pub(crate) fn project(file: &Path) -> Result<Project, Failure> {
    if !is_stdin(file) {
        return Ok(Project::open(file, Arc::new(Disk)));
    }
    let read = Project::read(file, std::io::stdin());
    Ok(read.map_err(|error| format!("cannot read the standard input: {error}"))?)
}

pub(crate) fn is_stdin(file: &Path) -> bool {
    file.as_os_str() == "-"
}

//! Files that are complete or not there.

use std::fs::{self, File};
use std::io::{self, BufWriter};
#[cfg(unix)]
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use crate::error::{FileError, FolderError, WriteError};
use crate::regions::Target;
use crate::unfinished::Unfinished;

/// Bytes that go to the system at once.
const BUFFER: usize = 1 << 16;

/// Writes a file so that a reader sees the old one or the new one, never half of it.
///
/// The content goes to a file in the same folder that has no name (a hidden one where the system knows no others), is forced to
/// the disk, and gets its name at the end, with the permissions of what was there and its owner where the system lets that be given. On any
/// error that file is gone and what was there before stays. A link is followed, so the file it names is replaced; further names of that
/// file (hard links) keep what it was. A device or a pipe is written to as it is. A file that may not be written to is not replaced either.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("points.csv");
/// flank_export::write_atomically(&path, |out| Ok(out.write_all(b"x,y,z\n")?))?;
/// assert_eq!(std::fs::read(&path)?, b"x,y,z\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Names the file and says in plain words what stood in the way, be it the disk or `content`.
pub fn write_atomically(
    path: &Path,
    content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>,
) -> Result<(), FileError> {
    replace(path, content).map_err(|reason| FileError { path: path.to_owned(), reason })
}

/// Makes a folder, and those on the way to it, if they are not there.
///
/// # Errors
/// Names the folder and says in plain words what stood in the way.
pub fn make_folder(path: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(path).map_err(|reason| FolderError { path: path.to_owned(), reason })
}

fn replace(path: &Path, content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>) -> Result<(), WriteError> {
    let existing = match fs::metadata(path) {
        Ok(found) => Some(found),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    match existing {
        Some(found) if found.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory).into()),
        Some(found) if !found.is_file() => fill(File::options().write(true).open(path)?, content).map(|_| ()),
        Some(found) => {
            // a folder may be written to where the file may not
            File::options().append(true).open(path)?;
            through_temporary(&fs::canonicalize(path)?, Some(&found), content)
        }
        None => through_temporary(path, None, content),
    }
}

fn through_temporary(
    path: &Path,
    before: Option<&fs::Metadata>,
    content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let folder = folder_of(path);
    let unfinished = Unfinished::within(&folder)?;
    let file = fill(unfinished.file()?, content)?;
    if let Some(before) = before {
        // who writes may not be who owns, and not every system lets a file be given away
        #[cfg(unix)]
        let _ = std::os::unix::fs::fchown(&file, Some(before.uid()), Some(before.gid()));
        file.set_permissions(before.permissions())?;
    }
    file.sync_all()?;
    // if the power fails before the folder is on the disk, what was there before is, whole
    Ok(unfinished.finish(path)?)
}

fn fill(file: File, content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>) -> Result<File, WriteError> {
    let mut buffer = BufWriter::with_capacity(BUFFER, file);
    content(&mut buffer)?;
    buffer.into_inner().map_err(|error| error.into_error().into())
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

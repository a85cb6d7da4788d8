//! Files that are complete or not there.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter};
#[cfg(unix)]
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use crate::files::error::{FileError, FolderError, WriteError};
use crate::files::lock::Lock;
use crate::files::regions::Target;
use crate::files::temp_file::Unfinished;

/// Bytes that go to the system at once.
const BUFFER: usize = 1 << 16;

/// Files that belong together: they get their names one right after the other when all of them are whole.
///
/// The content of each goes to a file in its folder that has no name (a hidden one where the system knows no others), is forced to
/// the disk, and gets its name at the end, with the permissions of what was there and its owner where the system lets that be given. On
/// any error, and if the set is dropped, these files are gone and what was there before stays. A link is followed, so the file it names
/// is replaced; further names of that file (hard links) keep what it was. A device or a pipe is written to as it is. A file that may not
/// be written to is not replaced either.
///
/// While files get their names the folder is locked: of two sets of the same names that programs write at the same time, one is there in
/// the end. What programs that were killed have left in the folder is removed.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// let [points, mesh] = ["points.csv", "mesh.obj"].map(|name| folder.path().join(name));
/// let mut files = flank_export::FileSet::default();
/// files.write(&points, |out| Ok(out.write_all(b"x,y,z\n")?))?;
/// files.write(&mesh, |out| Ok(out.write_all(b"o flank\n")?))?;
/// assert!(!points.exists());
/// files.finish()?;
/// assert!(points.exists() && mesh.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct FileSet(Vec<Whole>);

/// A file that is whole but has no name yet.
#[derive(Debug)]
struct Whole {
    asked: PathBuf,
    /// The same without links.
    path: PathBuf,
    file: Unfinished,
}

/// Systems let a program hold so many files and more; those of a larger set get their names in several turns.
const MOST_HELD: usize = 256;

impl FileSet {
    /// Writes a file that gets its name when the set is finished; a device or a pipe is written to now.
    ///
    /// # Errors
    /// Names the file and says in plain words what stood in the way, be it the disk or `content`.
    pub fn write(
        &mut self,
        path: &Path,
        content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>,
    ) -> Result<(), FileError> {
        if self.0.len() == MOST_HELD {
            std::mem::take(self).finish()?;
        }
        let whole = written(path, content).map_err(|reason| FileError { path: path.to_owned(), reason })?;
        self.0.extend(whole);
        Ok(())
    }

    /// Gives all files their names.
    ///
    /// # Errors
    /// Names the first file that could not get its name, and says why; those after it are not there either.
    pub fn finish(self) -> Result<(), FileError> {
        let folders: BTreeSet<PathBuf> = self.0.iter().map(|whole| folder_of(&whole.path)).collect();
        let _locks: Vec<Lock> = folders.iter().map(|folder| Lock::of_folder(folder)).collect();
        self.0.into_iter().try_for_each(|whole| {
            whole.file.finish(&whole.path).map_err(|reason| FileError { path: whole.asked, reason: reason.into() })
        })
    }
}

/// Writes one file so that a reader sees the old one or the new one, never half of it, as a [`FileSet`] does.
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
    let mut files = FileSet::default();
    files.write(path, content)?;
    files.finish()
}

/// Makes a folder, and those on the way to it, if they are not there.
///
/// # Errors
/// Names the folder and says in plain words what stood in the way.
pub fn make_folder(path: &Path) -> Result<(), FolderError> {
    fs::create_dir_all(path).map_err(|reason| FolderError { path: path.to_owned(), reason })
}

/// A whole file without its name; nothing where a device or a pipe has taken the content.
fn written(
    path: &Path,
    content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>,
) -> Result<Option<Whole>, WriteError> {
    let existing = match fs::metadata(path) {
        Ok(found) => Some(found),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    match existing {
        Some(found) if found.is_dir() => Err(io::Error::from(io::ErrorKind::IsADirectory).into()),
        Some(found) if !found.is_file() => fill(File::options().write(true).open(path)?, content).map(|_| None),
        Some(found) => {
            // a folder may be written to where the file may not
            File::options().append(true).open(path)?;
            let target = fs::canonicalize(path)?;
            let file = nameless(&target, Some(&found), content)?;
            Ok(Some(Whole { asked: path.to_owned(), path: target, file }))
        }
        None => {
            let file = nameless(path, None, content)?;
            Ok(Some(Whole { asked: path.to_owned(), path: path.to_owned(), file }))
        }
    }
}

fn nameless(
    path: &Path,
    before: Option<&fs::Metadata>,
    content: impl FnOnce(&mut dyn Target) -> Result<(), WriteError>,
) -> Result<Unfinished, WriteError> {
    let unfinished = Unfinished::within(&folder_of(path))?;
    let file = fill(unfinished.file()?, content)?;
    if let Some(before) = before {
        // who writes may not be who owns, and not every system lets a file be given away
        #[cfg(unix)]
        let _ = std::os::unix::fs::fchown(&file, Some(before.uid()), Some(before.gid()));
        file.set_permissions(before.permissions())?;
    }
    file.sync_all()?;
    // if the power fails before the folder is on the disk, what was there before is, whole
    Ok(unfinished)
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

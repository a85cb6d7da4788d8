//! A folder in which one program at a time gives files their names.

use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, Instant};

use crate::files::temp_file;

/// Names are given in milliseconds. Who holds a folder for longer does not give names: it may well be who started this program, as
/// `flock FOLDER flank …` does.
const PATIENCE: Duration = Duration::from_secs(2);
const BETWEEN_ATTEMPTS: Duration = Duration::from_millis(5);

/// The right to give names in a folder until it is dropped, where the system and the disk know locks of folders.
pub(crate) struct Lock {
    _held: Option<File>,
}

impl Lock {
    /// Waits for its turn, and removes what programs that were killed have left.
    pub(crate) fn of_folder(folder: &Path) -> Lock {
        let held = held(folder);
        if held.is_some() {
            remove_what_was_left(folder);
        }
        Lock { _held: held }
    }
}

/// What an attempt to hold a folder comes to.
enum Attempt {
    Held(File),
    /// Another program holds it.
    Busy,
    /// There are no locks here.
    Never,
}

fn held(folder: &Path) -> Option<File> {
    let start = Instant::now();
    loop {
        match attempt(folder) {
            Attempt::Held(file) => return Some(file),
            Attempt::Busy if start.elapsed() < PATIENCE => std::thread::sleep(BETWEEN_ATTEMPTS),
            Attempt::Busy | Attempt::Never => return None,
        }
    }
}

#[cfg(not(windows))]
fn attempt(folder: &Path) -> Attempt {
    let Ok(folder) = File::open(folder) else { return Attempt::Never };
    match folder.try_lock() {
        Ok(()) => Attempt::Held(folder),
        Err(fs::TryLockError::WouldBlock) => Attempt::Busy,
        Err(fs::TryLockError::Error(_)) => Attempt::Never,
    }
}

/// Windows knows no locks of folders. A file in it that one program at a time may open takes their place; it goes when its handle is closed,
/// also that of a program that was killed.
#[cfg(windows)]
fn attempt(folder: &Path) -> Attempt {
    use std::os::windows::fs::OpenOptionsExt;

    const FILE_FLAG_DELETE_ON_CLOSE: u32 = 0x0400_0000;
    const ERROR_ACCESS_DENIED: i32 = 5; // it is just being deleted
    const ERROR_SHARING_VIOLATION: i32 = 32;
    let mut options = File::options();
    options.write(true).create(true).truncate(false).share_mode(0).custom_flags(FILE_FLAG_DELETE_ON_CLOSE);
    match options.open(folder.join(".flank-lock")) {
        Ok(file) => Attempt::Held(file),
        Err(error) => match error.raw_os_error() {
            Some(ERROR_ACCESS_DENIED | ERROR_SHARING_VIOLATION) => Attempt::Busy,
            _ => Attempt::Never,
        },
    }
}

/// Who may not read the folder, or remove from it, leaves it as it is.
fn remove_what_was_left(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        if temp_file::is_left(&entry) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

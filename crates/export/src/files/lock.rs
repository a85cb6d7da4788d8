//! A folder in which one program at a time gives files their names.

use std::fs::{self, File, TryLockError};
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
    pub(crate) fn of(folder: &Path) -> Lock {
        let held = held(folder);
        if held.is_some() {
            remove_what_was_left(folder);
        }
        Lock { _held: held }
    }
}

fn held(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    let start = Instant::now();
    loop {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => std::thread::sleep(BETWEEN_ATTEMPTS),
            Err(_) => return None,
        }
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

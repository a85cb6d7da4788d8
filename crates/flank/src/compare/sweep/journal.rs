//! What is known of chunks that were begun and not ended.

use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::project::failure::Failure;

/// The journals that this process has open, with the case that is worked on.
static OPEN: Mutex<BTreeMap<PathBuf, Option<u64>>> = Mutex::new(BTreeMap::new());

fn open() -> MutexGuard<'static, BTreeMap<PathBuf, Option<u64>>> {
    OPEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Notes in the studies that this process works on that it is ended from outside, and not by the case that it works on. The process has to end
/// after that: what it begins then waits for ever.
pub fn note_interruption() {
    let open = open();
    for (path, case) in &*open {
        // who cannot write any more ends all the same
        _ = std::fs::OpenOptions::new().append(true).open(path).and_then(|mut file| write_stop(&mut file, *case));
    }
    // no case may begin between this and the end
    std::mem::forget(open);
}

fn write_stop(file: &mut std::fs::File, case: Option<u64>) -> std::io::Result<()> {
    let case = case.map_or(String::new(), |case| format!(" {case}"));
    file.write_all(format!("\nstopped{case}\n").as_bytes())
}

/// What is known of a chunk that was begun: how often, which cases were worked on when the program ended, and the rows that were computed
/// one by one. A text of lines `begun`, `enter NUMBER`, `row NUMBER ROW`, and `stopped` or `stopped NUMBER` where somebody ended the program
/// while it did nothing wrong, each added to the end; what was cut off in the middle of a line does not count.
pub(super) struct Journal {
    file: RefCell<std::fs::File>,
    path: PathBuf,
    /// With this one.
    pub(super) attempts: u32,
    deaths: HashMap<u64, u32>,
    rows: HashMap<u64, String>,
}

impl Journal {
    /// One more attempt.
    pub(super) fn begin(path: &Path) -> Result<Journal, Failure> {
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let file =
            std::fs::OpenOptions::new().create(true).append(true).open(path).map_err(|why| unwritten(path, &why))?;
        let mut journal = Journal {
            file: RefCell::new(file),
            path: path.to_path_buf(),
            attempts: 1,
            deaths: HashMap::new(),
            rows: HashMap::new(),
        };
        text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n')).for_each(|line| journal.read(line));
        open().insert(path.to_path_buf(), None);
        // a line that was cut off ends here
        journal.add("\nbegun")?;
        Ok(journal)
    }

    fn read(&mut self, line: &str) {
        let mut words = line.splitn(3, ' ');
        let (kind, number, rest) = (words.next(), words.next(), words.next());
        match (kind, number.and_then(|number| number.parse().ok()), rest) {
            (Some("begun"), ..) => self.attempts += 1,
            (Some("enter"), Some(number), _) => *self.deaths.entry(number).or_default() += 1,
            (Some("row"), Some(number), Some(row)) => _ = self.rows.insert(number, row.to_string()),
            (Some("stopped"), number, _) => {
                self.attempts = self.attempts.saturating_sub(1).max(1);
                let deaths = number.and_then(|number| self.deaths.get_mut(&number));
                deaths.into_iter().for_each(|deaths| *deaths = deaths.saturating_sub(1));
            }
            _ => {}
        }
    }

    fn add(&self, line: &str) -> Result<(), Failure> {
        let written = self.file.borrow_mut().write_all(format!("{line}\n").as_bytes());
        written.map_err(|why| unwritten(&self.path, &why))
    }

    /// How often the program ended while a case was worked on.
    pub(super) fn deaths(&self, number: u64) -> u32 {
        self.deaths.get(&number).copied().unwrap_or(0)
    }

    /// The row of a case, if an earlier run computed it.
    pub(super) fn row(&self, number: u64) -> Option<String> {
        self.rows.get(&number).cloned()
    }

    /// A case is worked on: until its row is there, the program may end by it.
    pub(super) fn enter(&self, number: u64) -> Result<(), Failure> {
        let mut open = open();
        open.insert(self.path.clone(), Some(number));
        self.add(&format!("enter {number}"))
    }

    pub(super) fn leave(&self, number: u64, row: &str) -> Result<(), Failure> {
        let mut open = open();
        open.insert(self.path.clone(), None);
        self.add(&format!("row {number} {row}"))
    }

    /// Who follows the work has cancelled it.
    pub(super) fn stop(&self) {
        let case = open().get(&self.path).copied().flatten();
        // then it counts as one that was killed
        _ = write_stop(&mut self.file.borrow_mut(), case);
    }

    /// The chunk is there. A journal that stays says nothing.
    pub(super) fn end(self) {
        _ = std::fs::remove_file(&self.path);
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        open().remove(&self.path);
    }
}

fn unwritten(path: &Path, why: &std::io::Error) -> Failure {
    Failure::Input(format!("cannot write {}: {why}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_is_stopped_has_not_died() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("chunk");
        let died = Journal::begin(&path).expect("a journal");
        died.enter(3).expect("written");
        drop(died);
        for _ in 0..9 {
            let stopped = Journal::begin(&path).expect("a journal");
            assert_eq!((stopped.attempts, stopped.deaths(3), stopped.deaths(4)), (2, 1, 0));
            stopped.enter(4).expect("written");
            stopped.stop();
        }
        let rest = Journal::begin(&path).expect("a journal");
        rest.enter(4).expect("written");
        rest.leave(4, "a row").expect("written");
        rest.stop();
        drop(rest);
        let last = Journal::begin(&path).expect("a journal");
        assert_eq!((last.attempts, last.row(4)), (2, Some("a row".to_string())));
        last.end();
        assert!(!path.exists());
    }
}

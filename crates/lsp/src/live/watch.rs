//! What is saved of a spec and the files that it uses.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use flank::{Disk, Project, analyse};

/// How often the files are looked at.
const EVERY: Duration = Duration::from_millis(15);

/// What the system says of a file: when it was written, and its size; nothing of one that is not there.
type Stamp = Option<(SystemTime, u64)>;

/// Shows a spec, and again whenever one of its files changes, as long as the program runs.
pub fn follow(file: &Path, mut show: impl FnMut(Project)) {
    let mut watched = vec![file.to_path_buf()];
    loop {
        let project = Project::open(file, Arc::new(Disk));
        // before it is shown: what is saved meanwhile counts as a change
        let mut read: BTreeMap<PathBuf, Stamp> = watched.iter().map(|path| stamped(path)).collect();
        show(project.clone());
        for (path, stamp) in files(file, &project).iter().map(|path| stamped(path)) {
            read.entry(path).or_insert(stamp);
        }
        while read.iter().all(|(path, stamp)| stamped(path).1 == *stamp) {
            std::thread::sleep(EVERY);
        }
        settle(&read);
        watched = read.into_keys().collect();
    }
}

/// Waits until nothing more is written: a save may empty a file before it fills it.
fn settle(read: &BTreeMap<PathBuf, Stamp>) {
    let stamps = || read.keys().map(|path| stamped(path).1).collect::<Vec<Stamp>>();
    let mut before = stamps();
    loop {
        std::thread::sleep(EVERY);
        let now = stamps();
        if now == before {
            return;
        }
        before = now;
    }
}

/// The files that a spec is made of, and itself where it cannot be read.
fn files(file: &Path, project: &Project) -> Vec<PathBuf> {
    let mut files = analyse(project).files();
    files.push(file.to_path_buf());
    files
}

fn stamped(path: &Path) -> (PathBuf, Stamp) {
    let found = std::fs::metadata(path).ok();
    let stamp = found.and_then(|found| Some((found.modified().ok()?, found.len())));
    (path.to_path_buf(), stamp)
}

//! Studies of `flank sweep` in folders of their own.

use super::{flank, text};

pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

pub fn study(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

/// What `flank sweep gather` prints, as rows of cells; all of them may say that something was not solved.
pub fn rows(study: &str) -> Vec<Vec<String>> {
    let run = flank(&["sweep", "gather", study]);
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text(&run.stderr));
    let out = text(&run.stdout);
    out.lines().skip(1).map(|line| line.split(',').map(str::to_string).collect()).collect()
}

pub fn gathered(study: &str) -> String {
    text(&flank(&["sweep", "gather", study]).stdout).to_string()
}

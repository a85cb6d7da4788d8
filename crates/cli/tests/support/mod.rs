//! The binary and its files, for all tests of it.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part of it

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

pub fn flank(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_flank")).args(arguments).current_dir(top()).output().expect("the binary runs")
}

/// A folder of its own for each test, empty.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

pub fn written(folder: &Path, name: &str, content: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("the test's file");
    path.to_str().expect("a plain path").to_string()
}

/// Specs of the library as one file that uses no other.
pub fn self_contained(specs: &[&str]) -> String {
    let read = |name: &&str| std::fs::read_to_string(top().join(format!("specs/{name}.chain"))).expect("it is shipped");
    let all: String = specs.iter().map(read).collect();
    all.lines().filter(|line| !line.starts_with("use ")).map(|line| format!("{line}\n")).collect()
}

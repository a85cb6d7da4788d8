//! `flank fmt` as a user runs it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const LAID_OUT: &str = "machine m {\n    frame bed  // the root\n}\n";
const NOT_YET: &str = "\u{feff}machine m{frame bed // the root\r\n}";
const WRONG: &str = "machine m { frame }\n";

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn fmt(arguments: &[&str], input: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flank"));
    command.arg("fmt").args(arguments).current_dir(top());
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut run = command.spawn().expect("the binary runs");
    run.stdin.take().expect("a pipe").write_all(input.as_bytes()).expect("it reads");
    run.wait_with_output().expect("it ends")
}

/// A folder of its own for each test, with these files.
fn folder(name: &str, files: &[(&str, &str)]) -> Vec<String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    let write = |&(name, text): &(&str, &str)| {
        let path = folder.join(name);
        std::fs::write(&path, text).expect("the test's file");
        path.to_str().expect("a plain path").replace('\\', "/")
    };
    files.iter().map(write).collect()
}

fn read(path: &str) -> String {
    std::fs::read_to_string(path).expect("the test's file")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// All files of the library.
fn specs() -> Vec<String> {
    let mut files = Vec::new();
    for folder in
        std::fs::read_dir(top().join("specs")).expect("the library").map(|entry| entry.expect("an entry").path())
    {
        if folder.is_dir() {
            let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
            files.extend(entries.filter(|path| path.extension().is_some_and(|it| it == "chain")));
        }
    }
    files.iter().map(|path| path.to_str().expect("a plain path").to_owned()).collect()
}

#[test]
fn shipped_specs_are_laid_out() {
    let files = specs();
    assert!(files.len() >= 9);
    let arguments: Vec<&str> = std::iter::once("--check").chain(files.iter().map(String::as_str)).collect();
    let run = fmt(&arguments, "");
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(0), ""), "run `flank fmt` on these");
}

#[test]
fn files_are_rewritten_and_named() {
    let files = folder("fmt", &[("new.chain", NOT_YET), ("old.chain", LAID_OUT)]);
    let run = fmt(&[&files[0], &files[1]], "");
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(0), format!("{}\n", files[0]).as_str()));
    assert_eq!([read(&files[0]), read(&files[1])], [LAID_OUT, LAID_OUT]);
    let run = fmt(&[&files[0], &files[1]], "");
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(0), ""));
}

#[test]
fn check_changes_nothing() {
    let files = folder("fmt-check", &[("new.chain", NOT_YET), ("old.chain", LAID_OUT)]);
    let run = fmt(&["--check", &files[0], &files[1]], "");
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), format!("{}\n", files[0]).as_str()));
    assert_eq!(read(&files[0]), NOT_YET);
    assert_eq!(fmt(&["--check", &files[1]], "").status.code(), Some(0));
}

#[test]
fn a_wrong_file_stays_and_the_others_do_not_wait() {
    let files = folder("fmt-wrong", &[("wrong.chain", WRONG), ("new.chain", NOT_YET)]);
    let run = fmt(&[&files[0], &files[1]], "");
    assert_eq!(run.status.code(), Some(1));
    assert!(text(&run.stderr).contains("E0101") && text(&run.stderr).contains("wrong.chain:1:13"), "{:?}", run.stderr);
    assert_eq!([read(&files[0]).as_str(), &read(&files[1])], [WRONG, LAID_OUT]);
}

#[test]
fn from_stdin_to_stdout() {
    let run = fmt(&["-"], NOT_YET);
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(0), LAID_OUT));
    let run = fmt(&["-"], WRONG);
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), ""));
    assert!(text(&run.stderr).contains("E0101"));
    let run = fmt(&["--check", "-"], NOT_YET);
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), "-\n"));
    assert_eq!(fmt(&["--check", "-"], LAID_OUT).status.code(), Some(0));
}

#[test]
fn no_file_is_a_mistake_of_usage() {
    assert_eq!(fmt(&[], "").status.code(), Some(2));
}

/// What leads to a file stays, and what else is called by its name is told.
#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let files = folder("fmt-links", &[("linked.chain", NOT_YET), ("twice.chain", NOT_YET)]);
    let beside = |name: &str| Path::new(&files[0]).with_file_name(name).to_str().expect("a plain path").to_owned();
    let mode = |path: &str| std::fs::metadata(path).expect("it is there").permissions().mode() & 0o777;
    std::fs::set_permissions(&files[0], std::fs::Permissions::from_mode(0o640)).expect("it is the test's own");
    let (link, other) = (beside("link.chain"), beside("other.chain"));
    symlink("linked.chain", &link).expect("a link");
    std::fs::hard_link(&files[1], &other).expect("another name");
    let run = fmt(&[&link, &files[1]], "");
    assert_eq!((run.status.code(), text(&run.stdout)), (Some(0), format!("{link}\n{}\n", files[1]).as_str()));
    assert!(std::fs::symlink_metadata(&link).expect("it is there").is_symlink());
    assert_eq!((read(&files[0]).as_str(), mode(&files[0])), (LAID_OUT, 0o640));
    assert_eq!((read(&files[1]).as_str(), read(&other).as_str()), (LAID_OUT, NOT_YET));
    let told = format!("note: {} has another name (hard links), where the text stays as it was\n", files[1]);
    assert_eq!(text(&run.stderr), told);
}

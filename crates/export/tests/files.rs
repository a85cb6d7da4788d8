//! Files on disk are complete or untouched.

mod synthetic;

use std::fs;
use std::io::{Error, ErrorKind};
use std::path::Path;

use flank_export::{FileError, WriteError, write_atomically, write_csv};
use synthetic::{bevel, dataset};

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

fn refusal(path: &Path) -> String {
    let error = write_atomically(path, |out| Ok(out.write_all(b"new")?)).expect_err("nothing can be written there");
    error.to_string()
}

#[test]
fn a_file_appears_and_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flank.csv");
    let dataset = dataset("job", vec![bevel([4, 3])]);
    for _ in 0..2 {
        write_atomically(&path, |out| write_csv(&dataset.surfaces(), out)).unwrap();
    }
    assert!(fs::read_to_string(&path).unwrap().contains("concave flank,3,2,"));
    assert_eq!(names_in(folder.path()), ["flank.csv"]);
}

#[test]
fn a_failure_half_way_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flank.csv");
    fs::write(&path, "old").unwrap();
    let result: Result<(), FileError> = write_atomically(&path, |out| {
        out.write_all(&vec![b'x'; 100_000])?;
        Err(WriteError::Io(Error::from(ErrorKind::StorageFull)))
    });
    let message = result.expect_err("the disk is full").to_string();
    assert_eq!(message, format!("cannot write `{}`: the disk is full", path.display()));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names_in(folder.path()), ["flank.csv"]);
}

#[test]
fn errors_name_the_file_and_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let nowhere = folder.path().join("no such folder/flank.csv");
    assert_eq!(refusal(&nowhere), format!("cannot write `{}`: the folder does not exist", nowhere.display()));
    assert_eq!(refusal(folder.path()), format!("cannot write `{}`: it is a folder", folder.path().display()));
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let below = file.join("flank.csv");
    assert_eq!(refusal(&below), format!("cannot write `{}`: what should be its folder is a file", below.display()));
}

#[cfg(unix)]
#[test]
fn permissions_links_and_devices_are_respected() {
    use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;

    let usual = folder.path().join("usual");
    fs::write(&usual, "").unwrap();
    let fresh = folder.path().join("fresh");
    write_atomically(&fresh, |out| Ok(out.write_all(b"new")?)).unwrap();
    assert_eq!(mode(&fresh), mode(&usual));

    let target = folder.path().join("target");
    fs::write(&target, "old").unwrap();
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
    let link = folder.path().join("link");
    symlink(&target, &link).unwrap();
    write_atomically(&link, |out| Ok(out.write_all(b"new")?)).unwrap();
    assert_eq!((fs::read_to_string(&target).unwrap().as_str(), mode(&target)), ("new", 0o640));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());

    // only the system's owner may give a file away, and then it stays with whom it was given to
    if std::os::unix::fs::chown(&target, Some(4711), Some(4712)).is_ok() {
        write_atomically(&link, |out| Ok(out.write_all(b"newer")?)).unwrap();
        let found = fs::metadata(&target).unwrap();
        assert_eq!((found.uid(), found.gid(), mode(&target)), (4711, 4712, 0o640));
    }

    write_atomically(Path::new("/dev/null"), |out| Ok(out.write_all(b"new")?)).unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}

/// A folder that may be written to says nothing of its files: one that may not be written to stays. (The system's owner may always.)
#[cfg(unix)]
#[test]
fn a_file_that_may_not_be_written_to_stays() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().expect("a folder for the test");
    let path = folder.path().join("points.csv");
    std::fs::write(&path, "old").expect("the test's file");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o444)).expect("it is the test's own");
    let may = std::fs::File::options().append(true).open(&path).is_ok();
    let done = flank_export::write_atomically(&path, |out| Ok(out.write_all(b"new")?));
    assert_eq!(done.is_ok(), may);
    assert_eq!(std::fs::read_to_string(&path).expect("it is there"), if may { "new" } else { "old" });
}

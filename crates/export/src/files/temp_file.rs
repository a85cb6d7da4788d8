//! A file on its way, which nobody sees under its name before it is whole.

use std::fs::{self, DirEntry, File};
use std::io;
use std::path::Path;
use std::time::Duration;

use tempfile::NamedTempFile;

/// Names of hidden files: those that are written to, and those that wait for their name to be free.
const PREFIX: &str = ".flank-";
const PART: &str = ".part";
const WHOLE: &str = ".whole";
/// A hidden file is locked by who writes it, but not in the moment in which it is made.
const YOUNG: Duration = Duration::from_secs(60);

/// What is written to until it is whole.
#[derive(Debug)]
pub(crate) enum Unfinished {
    /// Without any name: when the program ends, be it killed, nothing is left.
    #[cfg(target_os = "linux")]
    Nameless(File),
    /// With a hidden name beside the target, where the system or the disk knows no other way.
    Hidden(NamedTempFile),
}

impl Unfinished {
    /// An empty file in a folder, with the permissions that a new file has there.
    pub(crate) fn within(folder: &Path) -> io::Result<Unfinished> {
        #[cfg(target_os = "linux")]
        if let Ok(file) = nameless::open(folder) {
            return Ok(Unfinished::Nameless(file));
        }
        hidden(folder).map(Unfinished::Hidden)
    }

    pub(crate) fn file(&self) -> io::Result<File> {
        match self {
            #[cfg(target_os = "linux")]
            Unfinished::Nameless(file) => file.try_clone(),
            Unfinished::Hidden(file) => file.as_file().try_clone(),
        }
    }

    /// Gives it its name, in the folder in which it is; what had that name before is replaced.
    pub(crate) fn finish(self, path: &Path) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Unfinished::Nameless(file) => nameless::link(&file, path),
            Unfinished::Hidden(file) => file.persist(path).map(|_| ()).map_err(|error| error.error),
        }
    }
}

/// Whether a program that was killed has left it, in a folder that is locked: names are given under the lock, and who lives holds the lock
/// of what it writes.
pub(crate) fn is_left(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let Some(name) = name.to_str().filter(|name| name.starts_with(PREFIX)) else { return false };
    let is_old = || {
        let changed = entry.metadata().and_then(|found| found.modified()).ok();
        changed.and_then(|time| time.elapsed().ok()).is_some_and(|age| age > YOUNG)
    };
    let is_free = || File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
    name.ends_with(WHOLE) || (name.ends_with(PART) && is_old() && is_free())
}

/// Not with the private permissions of a secret.
fn hidden(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(PART);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(folder)?;
    // a disk without locks has nobody who looks for them either
    let _ = file.as_file().try_lock();
    Ok(file)
}

#[cfg(target_os = "linux")]
mod nameless {
    use std::os::fd::AsRawFd;

    use rustix::fs::{AtFlags, CWD, Mode, OFlags};

    use super::{File, PREFIX, Path, WHOLE, fs, io};

    /// Fails where the disk has no such files, and where there would be no way to name one later.
    pub(super) fn open(folder: &Path) -> io::Result<File> {
        fs::metadata("/proc/self/fd")?;
        let how = OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC;
        Ok(File::from(rustix::fs::open(folder, how, Mode::from_raw_mode(0o666))?))
    }

    /// A link cannot take a name that is in use: a hidden one comes first, and is moved.
    pub(super) fn link(file: &File, path: &Path) -> io::Result<()> {
        let descriptor = format!("/proc/self/fd/{}", file.as_raw_fd());
        let beside = |attempt: u32| path.with_file_name(format!("{PREFIX}{}-{attempt}{WHOLE}", std::process::id()));
        let linked = (0..1000).find_map(|attempt| {
            let hidden = beside(attempt);
            match rustix::fs::linkat(CWD, &*descriptor, CWD, &hidden, AtFlags::SYMLINK_FOLLOW) {
                Err(rustix::io::Errno::EXIST) => None,
                Err(error) => Some(Err(io::Error::from(error))),
                Ok(()) => Some(Ok(hidden)),
            }
        });
        let hidden = linked.unwrap_or_else(|| Err(io::ErrorKind::AlreadyExists.into()))?;
        fs::rename(&hidden, path).inspect_err(|_| drop(fs::remove_file(&hidden)))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    const WAYS: [fn(&Path) -> io::Result<Unfinished>; 2] =
        [Unfinished::within, |folder| hidden(folder).map(Unfinished::Hidden)];

    /// Both ways lead to the same, and leave nothing beside it.
    #[test]
    fn both_ways_replace_what_was_there() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let path = folder.path().join("points.csv");
        for (k, way) in WAYS.into_iter().enumerate() {
            let unfinished = way(folder.path()).expect("the folder can be written to");
            write!(unfinished.file().expect("it is open"), "{k}").expect("there is room");
            unfinished.finish(&path).expect("the name can be had");
            assert_eq!(fs::read_to_string(&path).expect("it is there"), k.to_string());
            assert_eq!(fs::read_dir(folder.path()).expect("it is there").count(), 1);
        }
    }

    /// What killed programs left goes, but not what a program that lives writes, what is young, and what is of others.
    #[test]
    fn what_was_left_is_told_from_what_is_in_work() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        let old = std::time::SystemTime::now() - 2 * YOUNG;
        let made = |name: &str| {
            let file = File::create(folder.path().join(name)).expect("the test's file");
            file.set_modified(old).expect("it is the test's own");
            file
        };
        for name in [".flank-12-0.whole", ".flank-x.part", "points.csv", ".flank-notes", ".other.part"] {
            drop(made(name));
        }
        let in_work = hidden(folder.path()).expect("it can be made");
        in_work.as_file().set_modified(old).expect("it is the test's own");
        drop(File::create(folder.path().join(".flank-young.part")).expect("the test's file"));
        let entries = fs::read_dir(folder.path()).expect("it is there").flatten();
        let mut left: Vec<String> =
            entries.filter(is_left).map(|entry| entry.file_name().into_string().expect("a plain name")).collect();
        left.sort();
        assert_eq!(left, [".flank-12-0.whole", ".flank-x.part"]);
    }

    /// What is given up is gone.
    #[test]
    fn what_is_not_finished_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder for the test");
        for way in WAYS {
            write!(way(folder.path()).expect("it can be made").file().expect("it is open"), "half")
                .expect("there is room");
        }
        assert_eq!(fs::read_dir(folder.path()).expect("it is there").count(), 0);
    }
}

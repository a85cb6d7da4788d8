//! Where texts come from: the disk, or texts in memory that lie over it.

use std::collections::BTreeMap;
use std::fmt::Debug;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::load::tidy;

/// A file or a folder in a folder.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FolderEntry {
    /// Without the path to it.
    pub name: String,
    /// Whether it is a folder.
    pub is_folder: bool,
}

impl FolderEntry {
    /// What a folder holds where texts in memory lie over it, in folders that need not be there.
    pub fn with_texts<'t>(
        mut entries: Vec<FolderEntry>,
        folder: &Path,
        texts: impl Iterator<Item = &'t PathBuf>,
    ) -> Vec<FolderEntry> {
        for inside in texts.filter_map(|text| text.strip_prefix(folder).ok()) {
            let mut parts = inside.components();
            let name = parts.next().map(|first| first.as_os_str().to_string_lossy().into_owned());
            if let Some(name) = name.filter(|name| !name.starts_with('.')) {
                entries.push(FolderEntry { name, is_folder: parts.next().is_some() });
            }
        }
        entries.sort();
        entries.dedup();
        entries
    }
}

/// What a compilation reads its texts from.
pub trait Files: Debug + Send + Sync {
    /// The path of a plain file or a folder, without links and `..`.
    ///
    /// # Errors
    /// If nothing is there, or something that may never end, as a pipe.
    fn real_path(&self, path: &Path) -> Result<PathBuf>;

    /// Whether there is a file or a folder.
    fn exists(&self, path: &Path) -> bool;

    /// The text of a plain file of at most so many bytes, whose path has no links.
    ///
    /// # Errors
    /// Of the kind [`ErrorKind::FileTooLarge`] if it has more, of the kind [`ErrorKind::InvalidData`] if it is not UTF-8.
    fn read(&self, real: &Path, most: usize) -> Result<String>;

    /// What a folder holds in the order of names, without what is hidden, of so many that are looked at; nothing where it cannot be looked into.
    fn entries(&self, _folder: &Path, _most: usize) -> Vec<FolderEntry> {
        Vec::new()
    }
}

/// The files of the system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disk;

impl Files for Disk {
    fn real_path(&self, path: &Path) -> Result<PathBuf> {
        // a pipe may have no such path
        ask_plain(path)?;
        std::fs::canonicalize(path)
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn read(&self, real: &Path, most: usize) -> Result<String> {
        ask_plain(real)?;
        let mut bytes = Vec::new();
        std::fs::File::open(real)?.take((most as u64).saturating_add(1)).read_to_end(&mut bytes)?;
        if bytes.len() > most { Err(ErrorKind::FileTooLarge.into()) } else { decoded(bytes) }
    }

    fn entries(&self, folder: &Path, most: usize) -> Vec<FolderEntry> {
        let all = std::fs::read_dir(folder).into_iter().flatten().take(most).filter_map(Result::ok);
        let shown = all.filter_map(|entry| {
            let name = entry.file_name().into_string().ok().filter(|name| !name.starts_with('.'))?;
            // what a link leads to
            let is_folder = match entry.file_type().ok()? {
                kind if kind.is_symlink() => entry.path().is_dir(),
                kind => kind.is_dir(),
            };
            Some(FolderEntry { name, is_folder })
        });
        let mut shown: Vec<FolderEntry> = shown.collect();
        shown.sort();
        shown
    }
}

/// Texts in memory, such as an editor's buffers, over other files: each is taken for what stands in its file, which need not be there.
#[derive(Clone, Debug)]
pub struct Buffers {
    below: Arc<dyn Files>,
    texts: BTreeMap<PathBuf, String>,
}

impl Buffers {
    /// No text yet.
    pub fn over(below: Arc<dyn Files>) -> Buffers {
        Buffers { below, texts: BTreeMap::new() }
    }

    /// The same with the text of one more file.
    pub fn with(mut self, path: &Path, text: impl Into<String>) -> Buffers {
        self.texts.insert(self.place(path), text.into());
        self
    }

    /// Where a file would stand that need not be there: in a folder without links.
    fn place(&self, path: &Path) -> PathBuf {
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        let absolute = tidy(&absolute);
        let (folder, name) = (absolute.parent().unwrap_or(Path::new("/")), absolute.file_name().unwrap_or_default());
        self.below.real_path(folder).unwrap_or_else(|_| folder.to_path_buf()).join(name)
    }
}

impl Files for Buffers {
    fn real_path(&self, path: &Path) -> Result<PathBuf> {
        let place = self.place(path);
        if self.texts.contains_key(&place) { Ok(place) } else { self.below.real_path(path) }
    }

    fn exists(&self, path: &Path) -> bool {
        self.texts.contains_key(&self.place(path)) || self.below.exists(path)
    }

    fn read(&self, real: &Path, most: usize) -> Result<String> {
        match self.texts.get(real) {
            Some(text) => limited(text.clone(), most),
            None => self.below.read(real, most),
        }
    }

    fn entries(&self, folder: &Path, most: usize) -> Vec<FolderEntry> {
        let folder = self.place(folder);
        FolderEntry::with_texts(self.below.entries(&folder, most), &folder, self.texts.keys())
    }
}

/// The text of a file that is no spec, such as a table. Spreadsheets put a byte order mark before it, which is none of its text.
///
/// # Errors
/// As [`Files::read`].
pub(crate) fn read_other(files: &dyn Files, real: &Path, most: usize) -> Result<String> {
    let text = files.read(real, most)?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text))
}

/// The text that bytes are in UTF-8. Of another encoding of Unicode each letter of a spec has zeros, in which UTF-8 may see letters.
fn decoded(bytes: Vec<u8>) -> Result<String> {
    let head = &bytes[..bytes.len().min(ENCODING)];
    let zeros = head.iter().filter(|byte| **byte == 0).count();
    let is_marked = [[0xff, 0xfe], [0xfe, 0xff]].iter().any(|mark| head.starts_with(mark));
    let encoding = match 8 * zeros {
        most if most > 5 * head.len() && zeros < head.len() => "UTF-32",
        half if half > 3 * head.len() && zeros < head.len() || is_marked => "UTF-16",
        _ => return String::from_utf8(bytes).map_err(|_| ErrorKind::InvalidData.into()),
    };
    Err(Error::new(ErrorKind::InvalidData, format!("it is {encoding} text: save it as UTF-8")))
}

/// Bytes of a text by which its encoding is told.
const ENCODING: usize = 1024;

fn limited(text: String, most: usize) -> Result<String> {
    if text.len() > most { Err(ErrorKind::FileTooLarge.into()) } else { Ok(text) }
}

/// A pipe would make the reader wait, a device never end.
fn ask_plain(path: &Path) -> Result<()> {
    let kind = std::fs::metadata(path)?;
    if kind.is_file() || kind.is_dir() {
        return Ok(());
    }
    let reason = "it is not a plain file: what comes from a pipe or a device may never end; save it to a file first";
    Err(Error::other(reason))
}

//! The texts of a compilation and places in them.

use std::path::{Path, PathBuf};

/// Index of a file in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u32);

/// A half-open range of bytes in one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// The file that the range lies in.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// The smallest range that holds both; both must lie in the same file.
    pub fn to(self, other: Span) -> Span {
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A value together with the place where it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Spanned<T> {
    /// What was written.
    pub node: T,
    /// Where.
    pub span: Span,
}

/// A name as written.
pub type Name = Spanned<String>;

/// One text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// The path as the user knows it: shown in messages.
    pub path: PathBuf,
    /// The file that it was read from, without links and `..`; none of a text that is no file, as the command line gives them.
    pub file: Option<PathBuf>,
    /// The whole text.
    pub text: String,
    /// Where its lines begin.
    lines: Vec<usize>,
}

impl SourceFile {
    /// The line that a byte lies in, from 1, and where that line begins.
    pub(crate) fn line(&self, at: usize) -> (usize, usize) {
        let number = self.lines.partition_point(|&start| start <= at);
        (number, self.lines[number - 1])
    }
}

/// Where lines begin behind their ends in a text: line feeds, carriage returns, or one after the other.
pub(crate) fn line_starts(text: &str) -> impl Iterator<Item = usize> {
    let bytes = text.as_bytes();
    let is_end = |at: usize| bytes[at] == b'\n' || (bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
    (0..bytes.len()).filter(move |at| is_end(*at)).map(|at| at + 1)
}

/// All texts of one compilation.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<SourceFile>,
}

impl Sources {
    /// Adds a text that is no file.
    pub fn add(&mut self, path: impl Into<PathBuf>, text: impl Into<String>) -> FileId {
        self.push(path.into(), None, text.into())
    }

    /// Adds the text of a file, with its path as the user knows it and as it really is.
    pub fn add_file(&mut self, path: &Path, real: &Path, text: impl Into<String>) -> FileId {
        self.push(path.to_path_buf(), Some(real.to_path_buf()), text.into())
    }

    fn push(&mut self, path: PathBuf, file: Option<PathBuf>, text: String) -> FileId {
        let id = FileId(u32::try_from(self.files.len()).expect("fewer than 2^32 files"));
        let lines = std::iter::once(0).chain(line_starts(&text)).collect();
        self.files.push(SourceFile { path, file, text, lines });
        id
    }

    /// Shows the files below one folder as files below another one.
    pub fn show_below(&mut self, real: &Path, shown: &Path) {
        for file in &mut self.files {
            if let Ok(inner) = file.path.strip_prefix(real) {
                file.path = shown.join(inner);
            }
        }
    }

    /// The file behind an index of this collection.
    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    /// All files in the order they were added.
    pub fn files(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        (0u32..).map(FileId).zip(&self.files)
    }

    /// The text of a range.
    pub fn text(&self, span: Span) -> &str {
        &self.file(span.file).text[span.start as usize..span.end as usize]
    }

    /// Path, line and column (both from 1, columns in characters) of the start of a range.
    pub fn place(&self, span: Span) -> (&Path, usize, usize) {
        let file = self.file(span.file);
        let at = span.start as usize;
        let (line, start) = file.line(at);
        (&file.path, line, file.text[start..at].chars().count() + 1)
    }
}

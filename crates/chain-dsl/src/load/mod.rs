//! Reading a file and the files that it uses.

pub(crate) mod files;
mod nearest;
mod parsed;

use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{FileId, Name, Sources, Span, Spanned};
use crate::limits::{self, Limit};
use crate::load::files::{Files, read_other};
use crate::syntax::ast::{File, Item};

/// All files of a compilation, each once, used ones before those that use them.
pub(crate) struct Loaded {
    /// What they were read from; tables are read from it, too.
    pub(crate) from: Arc<dyn Files>,
    pub(crate) sources: Sources,
    pub(crate) files: Vec<(FileId, Arc<File>)>,
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Whether a file is used that was not read: what it declares is not known.
    pub(crate) lacks_files: bool,
    /// Where files are used, with those that are.
    pub(crate) used: Vec<(Span, FileId)>,
    /// The project folder of each file; a text that is not a file has none.
    pub(crate) projects: HashMap<FileId, PathBuf>,
    /// The file that was asked for: the last one, unless the one beside it uses it.
    pub(crate) main: Option<FileId>,
    /// The file that was asked for beside the main one.
    pub(crate) beside: Option<FileId>,
}

struct Loader {
    loaded: Loaded,
    /// The project folder of the file being read.
    project: PathBuf,
    known: HashMap<PathBuf, FileId>,
    /// Size of what has been read.
    bytes: usize,
    /// Files on the way from the first one to the one being read.
    open: Vec<FileId>,
}

/// Reads `path` and everything it uses, after a file `beside` it and what that uses.
///
/// Files that are used must lie in the [`project_folder`] of the one that was asked for.
pub(crate) fn load(from: Arc<dyn Files>, path: &Path, beside: Option<&Path>) -> Loaded {
    let mut loader = Loader {
        loaded: Loaded {
            from,
            sources: Sources::default(),
            files: Vec::new(),
            diagnostics: Vec::new(),
            lacks_files: false,
            used: Vec::new(),
            projects: HashMap::new(),
            main: None,
            beside: None,
        },
        project: PathBuf::new(),
        known: HashMap::new(),
        bytes: 0,
        open: Vec::new(),
    };
    if let Some(beside) = beside {
        loader.asked_for(beside);
        loader.loaded.beside = loader.id_of(beside);
    }
    loader.asked_for(path);
    loader.loaded.main = loader.id_of(path).or(loader.loaded.files.last().map(|(id, _)| *id));
    loader.loaded
}

/// Reads one file, without those that it uses.
///
/// # Errors
/// Says why it cannot be read; the place is an empty text of the file's name.
pub fn read_file(from: &dyn Files, sources: &mut Sources, path: &Path) -> Result<FileId, Diagnostic> {
    read_as((from, sources), path, |real| from.read(real, limits::FILE_BYTES.most), unreadable)
}

/// The same for a text that is no spec, of at most so many bytes.
///
/// # Errors
/// As [`read_file`].
pub fn read_other_file(
    from: &dyn Files,
    sources: &mut Sources,
    path: &Path,
    most: usize,
) -> Result<FileId, Diagnostic> {
    read_as(
        (from, sources),
        path,
        |real| read_other(from, real, most),
        |error, path, place| match error.kind() {
            ErrorKind::FileTooLarge => {
                let message = format!("cannot read `{}`: it has more than {} MiB", path.display(), most >> 20);
                Diagnostic::new(Code::UnreadableFile, place, message)
            }
            _ => unreadable(error, path, place),
        },
    )
}

fn read_as(
    (from, sources): (&dyn Files, &mut Sources),
    path: &Path,
    read: impl Fn(&Path) -> std::io::Result<String>,
    report: impl Fn(&std::io::Error, &Path, Span) -> Diagnostic,
) -> Result<FileId, Diagnostic> {
    match from.real_path(path).and_then(|real| Ok((read(&real)?, real))) {
        Ok((text, real)) => Ok(sources.add_file(path, &real, text)),
        Err(error) => Err(report(&error, path, Span { file: sources.add(path, ""), start: 0, end: 0 })),
    }
}

/// Parses one text that uses no other file.
pub(crate) fn load_text(name: &str, text: &str) -> Loaded {
    let mut sources = Sources::default();
    let id = sources.add(name, text);
    let (file, mut diagnostics) = parsed::parsed(text, id);
    let mut lacks_files = file.lacks_files;
    for item in &file.items {
        if let Item::Use(path) = item {
            lacks_files = true;
            diagnostics.push(Diagnostic::new(
                Code::UnreadableFile,
                path.span,
                "a text that is not a file cannot use files",
            ));
        }
    }
    let (from, projects) = (Arc::new(files::Disk), HashMap::new());
    Loaded {
        from,
        sources,
        files: vec![(id, file)],
        diagnostics,
        lacks_files,
        used: Vec::new(),
        projects,
        main: Some(id),
        beside: None,
    }
}

/// The nearest folder above a file, given without links, that holds a `.git` or a `flank.toml`; else the folder above that of the
/// file. It is the same from wherever the program is called.
pub fn project_folder(from: &dyn Files, real: &Path) -> PathBuf {
    let is_marked = |folder: &&Path| [".git", "flank.toml"].iter().any(|mark| from.exists(&folder.join(mark)));
    let mut above = real.ancestors().skip(1);
    let folder = above.clone().find(is_marked).or_else(|| above.nth(1));
    folder.unwrap_or(Path::new("/")).to_path_buf()
}

impl Loader {
    /// A file that was read.
    fn id_of(&self, path: &Path) -> Option<FileId> {
        let real = self.loaded.from.real_path(path).ok()?;
        self.known.get(&real).copied()
    }

    /// A file that no other one asks for; it lies in a project of its own.
    fn asked_for(&mut self, path: &Path) {
        match self.loaded.from.real_path(path) {
            Ok(real) if self.known.contains_key(&real) => {}
            Ok(real) => {
                self.project = project_folder(&*self.loaded.from, &real);
                self.read(path, &real, None);
            }
            Err(error) => self.unreadable(path, &error, None),
        }
    }

    fn read(&mut self, shown: &Path, real: &Path, used_at: Option<Span>) {
        match self.loaded.from.read(real, limits::FILE_BYTES.most) {
            Ok(text) => self.take(shown, real, text),
            Err(error) => self.unreadable(shown, &error, used_at),
        }
    }

    fn take(&mut self, shown: &Path, real: &Path, text: String) {
        self.bytes += text.len();
        let id = self.loaded.sources.add_file(shown, real, text);
        self.loaded.projects.insert(id, self.project.clone());
        self.known.insert(real.to_path_buf(), id);
        let (file, diagnostics) = parsed::parsed(&self.loaded.sources.file(id).text, id);
        self.loaded.diagnostics.extend(diagnostics);
        self.loaded.lacks_files |= file.lacks_files;
        self.open.push(id);
        for item in &file.items {
            if let Item::Use(used) = item {
                self.follow(shown, real, used);
            }
        }
        self.open.pop();
        self.loaded.files.push((id, file));
    }

    fn follow(&mut self, from_shown: &Path, from_real: &Path, used: &Spanned<String>) {
        let here = from_real.parent().unwrap_or(Path::new("/"));
        let shown = tidy(&from_shown.parent().unwrap_or(Path::new("")).join(&used.node));
        if used.node.is_empty() {
            self.loaded.lacks_files = true;
            let help = "write its path from the folder of this file on, as `../machines/generator.chain`";
            let nameless = Diagnostic::new(Code::UnreadableFile, used.span, "no file is named here").help(help);
            return self.loaded.diagnostics.push(nameless);
        }
        if Path::new(&used.node).is_absolute() {
            self.loaded.lacks_files = true;
            let message = format!("`{}` is an absolute path, which leads elsewhere on another machine", used.node);
            let help = "write it from the folder of this file on, as `../machines/generator.chain`";
            return self.loaded.diagnostics.push(Diagnostic::new(Code::OutsideProject, used.span, message).help(help));
        }
        let real = match self.loaded.from.real_path(&here.join(&used.node)) {
            Ok(real) => real,
            // a path that leaves the project says so whether the file exists or not
            Err(_) if !tidy(&here.join(&used.node)).starts_with(&self.project) => {
                return self.outside(used);
            }
            Err(error) => return self.missing(&error, [&shown, here], used),
        };
        if !real.starts_with(&self.project) {
            return self.outside(used);
        }
        match self.known.get(&real) {
            Some(id) if self.open.contains(id) => {
                let message = format!("`{}` uses this file again, in a circle", used.node);
                let diagnostic =
                    Diagnostic::new(Code::CyclicUse, used.span, message).help("move what both need into a third file");
                self.loaded.diagnostics.push(diagnostic);
            }
            Some(_) => {}
            None if self.open.len() >= limits::USE_DEPTH.most => self.exceeded(limits::USE_DEPTH, used),
            None if self.known.len() >= limits::FILES.most => self.exceeded(limits::FILES, used),
            None if self.bytes > limits::ALL_BYTES.most => self.exceeded(limits::ALL_BYTES, used),
            None => self.read(&shown, &real, Some(used.span)),
        }
        self.loaded.used.extend(self.known.get(&real).map(|file| (used.span, *file)));
    }

    fn exceeded(&mut self, limit: Limit, used: &Name) {
        self.loaded.lacks_files = true;
        self.loaded.diagnostics.push(limit.exceeded(used.span));
    }

    fn outside(&mut self, used: &Name) {
        self.loaded.lacks_files = true;
        let message = format!("`{}` lies outside the project folder {}", used.node, self.project.display());
        let help = "use only files of the project; an empty `flank.toml` marks the project's top folder";
        self.loaded.diagnostics.push(Diagnostic::new(Code::OutsideProject, used.span, message).help(help));
    }

    /// A file that is used and cannot be found, perhaps by a slip in its path.
    fn missing(&mut self, error: &std::io::Error, [shown, here]: [&Path; 2], used: &Name) {
        self.loaded.lacks_files = true;
        let mut diagnostic = unreadable(error, shown, used.span);
        if error.kind() == ErrorKind::NotFound {
            let meant = nearest::nearest(&*self.loaded.from, here, &used.node);
            let meant = meant.filter(|meant| tidy(&here.join(meant)).starts_with(&self.project));
            diagnostic = match meant {
                Some(meant) => diagnostic
                    .help(format!("did you mean `{meant}`? the path starts from the folder of this file"))
                    .cure(format!("write `{meant}`"), used.span, format!("\"{meant}\"")),
                None => diagnostic.help("the path starts from the folder of the file that says `use`"),
            };
        }
        self.loaded.diagnostics.push(diagnostic);
    }

    fn unreadable(&mut self, shown: &Path, error: &std::io::Error, used_at: Option<Span>) {
        self.loaded.lacks_files |= used_at.is_some();
        let span = self.place(shown, used_at);
        self.loaded.diagnostics.push(unreadable(error, shown, span));
    }

    /// Where a file is asked for; the start of an empty text of its own if on the command line.
    fn place(&mut self, shown: &Path, used_at: Option<Span>) -> Span {
        used_at.unwrap_or_else(|| Span { file: self.loaded.sources.add(shown, ""), start: 0, end: 0 })
    }
}

/// A spec that cannot be read.
fn unreadable(error: &std::io::Error, shown: &Path, place: Span) -> Diagnostic {
    match error.kind() {
        ErrorKind::FileTooLarge => limits::FILE_BYTES.exceeded(place),
        _ => {
            let message = format!("cannot read `{}`: {}", shown.display(), reason(error));
            Diagnostic::new(Code::UnreadableFile, place, message)
        }
    }
}

/// A path without `.` and without `folder/..`.
pub(crate) fn tidy(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

/// Why a file cannot be read, in words.
pub fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::InvalidData if error.get_ref().is_some() => error.to_string(),
        ErrorKind::NotFound => "there is no such file".to_string(),
        ErrorKind::InvalidData => "it is not UTF-8 text".to_string(),
        ErrorKind::IsADirectory => "it is a folder".to_string(),
        ErrorKind::PermissionDenied => "reading it is not permitted".to_string(),
        _ => error.to_string(),
    }
}

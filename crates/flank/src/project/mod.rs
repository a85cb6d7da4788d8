//! A spec with the files that it uses, and what is found in them.

pub(crate) mod amount;
pub(crate) mod answer;
pub(crate) mod choices;
pub(crate) mod columns;
pub(crate) mod failure;
pub(crate) mod files;
pub(crate) mod findings;
pub(crate) mod job;
pub(crate) mod monitor;
pub(crate) mod once;
pub(crate) mod quantity;
pub(crate) mod remark;
pub(crate) mod requests;
pub(crate) mod session;
pub(crate) mod spec;
pub(crate) mod units;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank_chain_dsl::limits::FILE_BYTES;
use flank_chain_dsl::{Buffers, Compilation, Disk, Files, Request, compile_request};
use flank_expr::Graph;

/// A spec and where its texts come from. Nothing is read before an operation asks for it.
#[derive(Clone, Debug)]
pub struct Project {
    file: PathBuf,
    files: Arc<dyn Files>,
}

impl Project {
    /// The spec in a file, which may use other files of its project folder.
    pub fn open(file: impl Into<PathBuf>, files: Arc<dyn Files>) -> Project {
        Project { file: file.into(), files }
    }

    /// A spec that comes from elsewhere, such as the standard input, and is taken for what stands in a file. One byte more than a spec
    /// may have is read, so that a longer text is refused and not cut.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(file: impl Into<PathBuf>, from: impl Read) -> std::io::Result<Project> {
        let (file, mut text) = (file.into(), String::new());
        from.take(FILE_BYTES.most as u64 + 1).read_to_string(&mut text)?;
        let files = Buffers::over(Arc::new(Disk)).with(&file, text);
        Ok(Project::open(file, Arc::new(files)))
    }

    /// The file, as it was named.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Where its texts come from.
    pub fn files(&self) -> &dyn Files {
        &*self.files
    }

    pub(crate) fn shared_files(&self) -> Arc<dyn Files> {
        Arc::clone(&self.files)
    }

    pub(crate) fn compiled<'g>(&self, graph: &'g Graph) -> Compilation<'g> {
        let request = Request { files: Arc::clone(&self.files), ..Request::default() };
        compile_request(graph, &self.file, &request)
    }
}

/// A path as documents show it: with forward slashes, the same on every system.
pub fn shown_path(path: &Path) -> String {
    path.display().to_string().replace('\\', "/")
}

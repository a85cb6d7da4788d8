//! A spec with the files that it uses, and what is found in them.

pub(crate) mod failure;
pub(crate) mod findings;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use flank_chain_dsl::{Compilation, Files, Request, compile_request};
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

    /// The file, as it was named.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// Where its texts come from.
    pub fn files(&self) -> &dyn Files {
        &*self.files
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

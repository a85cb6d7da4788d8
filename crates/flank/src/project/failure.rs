//! Why an operation did not do what it was asked for.

use flank_export::{FileError, FolderError};

use crate::project::findings::Findings;
use crate::project::remark::NotDone;

/// What ends an operation early.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A spec is wrong.
    #[error("the spec is wrong")]
    Findings(Findings),
    /// What is asked for does not go together, or names something that there is not, whatever the files say.
    #[error("{0}")]
    Request(String),
    /// A file is not what it should be, or has not what is asked of it.
    #[error("{0}")]
    Input(String),
    /// What was asked for cannot be solved.
    #[error("{0}")]
    Unsolved(String),
    /// The same, as data.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    NotDone(Vec<NotDone>),
    /// What was asked for takes more memory than there is to spare.
    #[error("{0}")]
    TooLarge(String),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Whoever follows the work has cancelled it ([`Monitor::is_cancelled`](crate::Monitor::is_cancelled)). No file got its name.
    #[error("cancelled")]
    Cancelled,
    /// A folder cannot be made.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

impl From<String> for Failure {
    fn from(reason: String) -> Failure {
        Failure::Input(reason)
    }
}

impl Failure {
    /// The same for something that cannot be solved.
    pub(crate) fn unsolved(self) -> Failure {
        match self {
            Failure::Input(reason) => Failure::Unsolved(reason),
            other => other,
        }
    }
}

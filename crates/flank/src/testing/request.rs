//! How specs are tested.

use std::sync::Arc;

use flank_chain_dsl::Disk;

use crate::project::session::EvaluatorOptions;
use crate::project::{Project, shown_path};

/// How specs are tested.
#[derive(Clone, Debug)]
pub struct TestRequest {
    /// The spec.
    pub project: Project,
    /// Jobs and machines alone whose `file:name` contains this.
    pub filter: Option<String>,
    /// Also beside its snapshot, if there is one.
    pub snapshot: bool,
    /// Also what its snapshot would be, if there is none.
    pub propose: bool,
    /// How the numbers are worked out.
    pub evaluator: EvaluatorOptions,
}

impl TestRequest {
    /// A spec of the disk with its snapshot.
    pub fn new(file: impl Into<std::path::PathBuf>) -> TestRequest {
        TestRequest {
            project: Project::open(file, Arc::new(Disk)),
            filter: None,
            snapshot: true,
            propose: false,
            evaluator: EvaluatorOptions::default(),
        }
    }

    /// Whether a job or a machine of the spec is asked for.
    pub(super) fn takes(&self, name: &str) -> bool {
        let whole = format!("{}:{name}", shown_path(self.project.file()));
        self.filter.as_ref().is_none_or(|filter| whole.contains(filter.as_str()))
    }
}

//! What all results of operations have in common.

use std::fmt::{self, Display};
use std::time::Duration;

use serde::Serialize;

use crate::project::remark::{NotDone, Remark};
use crate::project::units;

/// The result of an operation on jobs. Its [`Display`] is the text for people, its serialisation a document with its `schema`
/// ([`schema_of`](crate::schema_of) has what it says).
pub trait Answer: Display + Serialize + Send + Sync + 'static {
    /// What was asked for and not done; empty if everything was.
    fn not_done(&self) -> &[NotDone];

    /// What is to be known beside it.
    fn remarks(&self) -> &[Remark] {
        &[]
    }

    /// How long it took, if that was measured. Documents leave it out: they are the same for the same input.
    fn timing(&self) -> Option<Timing> {
        None
    }

    /// Whether everything was done that was asked for.
    fn is_complete(&self) -> bool {
        self.not_done().is_empty()
    }
}

/// What is counted where times are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Timed {
    /// Points of surfaces.
    #[default]
    Points,
    /// Cases of a study.
    Cases,
}

/// How long the points of a result took, or its cases. Its [`Display`] is `231 points in 12 ms`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// As many were asked for.
    pub points: usize,
    /// What these are.
    pub what: Timed,
    /// From the request to the result.
    pub elapsed: Duration,
}

impl Display for Timing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.what {
            Timed::Points => "point",
            Timed::Cases => "case",
        };
        write!(f, "{} in {:.0} ms", units::counted(self.points, what), self.elapsed.as_secs_f64() * 1e3)
    }
}

//! Who follows an operation.

use crate::project::findings::Findings;
use crate::project::remark::Remark;

/// Follows an operation: hears how far long work is, what is to be known beside its result, and what is doubtful in a spec; and may
/// cancel it.
///
/// Operations call it from one thread.
pub trait Monitor: Sync {
    /// Long work begins, `solving concave`; it is over when what comes back is dropped.
    fn begin(&self, what: String) -> Box<dyn Work> {
        let _ = what;
        Box::new(Unseen)
    }

    /// Whether the operation is to end. It looks between pieces of its work (surfaces, bands of rows, pictures, files), and ends with
    /// [`Failure::Cancelled`](crate::Failure::Cancelled); the files of a job stay as they were.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Something to know that belongs to no result.
    fn remark(&self, remark: &Remark) {
        let _ = remark;
    }

    /// A message that goes into a file, with its options as the file's readers spell them. Messages of this library name the fields of
    /// requests as "option `no_align`", or with a value as "option `set teeth=25`".
    fn spelled(&self, message: &str) -> String {
        message.to_string()
    }

    /// Warnings of a spec that is right.
    fn warn(&self, findings: &Findings) {
        let _ = findings;
    }
}

/// Work that goes on.
pub trait Work {
    /// How far it is, `20 of 80 rows`; asked for only if somebody looks.
    fn reached(&self, how_far: &dyn Fn() -> String) {
        let _ = how_far;
    }
}

/// Nobody follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unwatched;

impl Monitor for Unwatched {}

struct Unseen;

impl Work for Unseen {}

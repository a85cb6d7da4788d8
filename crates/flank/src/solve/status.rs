//! What became of points, in the words of documents and tables.

use flank_solver::{CutBy, Outcome};
use schemars::JsonSchema;
use serde::Serialize;

/// What became of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// All residuals are within their tolerance and all unknowns in their ranges.
    Solved,
    /// There is a root, but one of the unknowns lies outside its range, or where the sample's `keep` does not take it.
    OutOfRange,
    /// The tool that generates the point cuts it away.
    Undercut,
    /// Another surface of the job cuts it away.
    Trimmed,
    /// The ranges hold several branches, and nothing says which one is meant.
    Ambiguous,
    /// It is not clear whether another surface cuts it away.
    Undecided,
    /// The equations do not fix a single point there, or the surface has no normal or no tangent plane.
    Singular,
    /// No root was found.
    NotConverged,
}

impl From<Outcome> for Status {
    fn from(outcome: Outcome) -> Status {
        match outcome {
            Outcome::Solved => Status::Solved,
            Outcome::CutAway(CutBy::Other(_) | CutBy::Blank(_)) => Status::Trimmed,
            Outcome::CutAway(_) => Status::Undercut,
            Outcome::Undecided => Status::Undecided,
            Outcome::Outside { .. } | Outcome::NotKept { .. } => Status::OutOfRange,
            Outcome::Singular => Status::Singular,
            Outcome::NotConverged { .. } => Status::NotConverged,
            Outcome::Ambiguous => Status::Ambiguous,
        }
    }
}

impl From<flank_export::Outcome> for Status {
    fn from(outcome: flank_export::Outcome) -> Status {
        match outcome {
            flank_export::Outcome::Solved => Status::Solved,
            flank_export::Outcome::Undercut => Status::Undercut,
            flank_export::Outcome::Trimmed => Status::Trimmed,
            flank_export::Outcome::Undecided => Status::Undecided,
            flank_export::Outcome::Unsolved(word) => {
                Status::ALL.into_iter().find(|status| status.word() == word).unwrap_or(Status::NotConverged)
            }
        }
    }
}

impl Status {
    /// All of them.
    pub const ALL: [Status; 8] = [
        Status::Solved,
        Status::OutOfRange,
        Status::Undercut,
        Status::Trimmed,
        Status::Ambiguous,
        Status::Undecided,
        Status::Singular,
        Status::NotConverged,
    ];

    /// As documents and tables have it.
    pub fn word(self) -> &'static str {
        match self {
            Status::Solved => "solved",
            Status::OutOfRange => "out_of_range",
            Status::Undercut => "undercut",
            Status::Trimmed => "trimmed",
            Status::Ambiguous => "ambiguous",
            Status::Undecided => "undecided",
            Status::Singular => "singular",
            Status::NotConverged => "not_converged",
        }
    }
}

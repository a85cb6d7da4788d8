//! Contacts, and what is wanted of them.

use flank_expr::Expr;
use flank_expr::geometry::Chain;

use crate::diagnostics::source::Span;
use crate::model::RangedVariable;
use crate::values::dimension::Dimension;

/// What a contact shall be like at its vertex, where the error is extreme. Places and directions are on the second flank.
#[derive(Clone, Debug, PartialEq)]
pub struct WantedContact {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The contact, as an index into those of the job.
    pub contact: usize,
    /// In the order in which they are written.
    pub conditions: Vec<ContactCondition>,
    /// Thickness of the film that the ellipse is of, mm.
    pub film: f64,
    /// Where its name is written.
    pub written: Span,
}

/// What one number of a contact shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactCondition {
    /// Which number.
    pub of: ContactQuantity,
    /// mm or radians.
    pub value: f64,
    /// How far it may be off, as least squares weigh it; a condition without one holds exactly.
    pub within: Option<f64>,
    /// Where it is written.
    pub written: Span,
}

/// A number of a contact at its vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactQuantity {
    /// Along the axis of the second member.
    Z,
    /// Distance from that axis.
    Rho,
    /// Share of the way from toe to heel of the sample of the second flank.
    Lengthwise,
    /// Share of the way from root to tip.
    Profilewise,
    /// Angle of the path against the rows of that sample: positive where it comes nearer to the tip on its way to the heel.
    Path,
    /// Length of the ellipse within the film: its longer axis.
    Ellipse,
    /// Height of the error's parabola over a pitch.
    TransmissionError,
}

/// Two flanks on a pair of shafts that roll on each other.
#[derive(Clone, Debug)]
pub struct Contact<'g> {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// The flanks, as indices into the surfaces of the job.
    pub surfaces: [usize; 2],
    /// The frames that they are mounted on, as `m.pinion`.
    pub frames: [String; 2],
    /// From the root of the pair's machine to each flank, in the roll, the unknown, mounting errors and parameters.
    pub placements: [Chain<'g>; 2],
    /// What is added to the laws of the axes on the way: zero, unless the pair is mounted wrong.
    pub errors: Vec<MountingAxis<'g>>,
    /// The motion that the pair rolls by.
    pub roll: RangedVariable<'g>,
    /// The unknown that the contact determines.
    pub lag: RangedVariable<'g>,
    /// How far it rolls from one pair of teeth to the next, mm or radians, if that is said.
    pub every: Option<f64>,
    /// Where its name is written.
    pub written: Span,
}

/// An axis of a pair's machine that may be mounted wrong.
#[derive(Clone, Debug)]
pub struct MountingAxis<'g> {
    /// Its name, as `m.E`.
    pub name: String,
    /// What is added to its law.
    pub variable: Expr<'g>,
    /// A length or an angle.
    pub dimension: Dimension,
    /// Whether a motion or an unknown drives it: the pair turns by it.
    pub is_driven: bool,
}

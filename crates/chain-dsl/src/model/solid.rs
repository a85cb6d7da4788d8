//! Bodies: blanks with tooth spaces.

use crate::diagnostics::source::Span;

/// How the tooth spaces of a body follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SolidForm {
    /// About the z axis of its frame, all around: the outline is in `[z, rho]`.
    Turned,
    /// Beside each other along the y axis of its frame: the outline is in `[z, x]`.
    Extruded {
        /// From one space to the next, mm.
        pitch: f64,
    },
}

/// A blank with tooth spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its name.
    pub name: String,
    /// Its doc comment.
    pub doc: Vec<String>,
    /// Its frame, as `m.work`.
    pub frame: String,
    /// How its spaces follow each other.
    pub form: SolidForm,
    /// Its outline in the section that the form says, mm: closed, the material on the left.
    pub outline: Vec<OutlineSegment>,
    /// How many tooth spaces it has.
    pub teeth: u32,
    /// The surfaces of one space from one side to the other, as indices into the surfaces of the job.
    pub space: Vec<usize>,
    /// Where spaces differ, the name of the parameter that says of which of them the surfaces are, from 0 on.
    pub each: Option<String>,
    /// Where its name is written.
    pub written: Span,
}

/// A segment of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineSegment {
    /// Its name: tip, toe, heel.
    pub name: String,
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// What it runs along.
    pub curve: OutlineCurve,
}

/// What a segment of an outline runs along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlineCurve {
    /// A straight line.
    Line,
    /// An arc of less than half a turn.
    Arc {
        /// Its centre.
        center: [f64; 2],
    },
}

//! Profiles of tools as values: smooth pieces in a plane, one after the other, that one length runs over.

use std::rc::Rc;

use flank_expr::{CurveId, Expr};

use crate::diagnostics::source::Span;

/// A profile of a tool.
#[derive(Debug)]
pub(crate) struct Profile<'g> {
    pub(crate) segments: Vec<Rc<Segment<'g>>>,
}

/// A smooth piece of a profile.
#[derive(Debug)]
pub(crate) struct Segment<'g> {
    pub(crate) name: String,
    /// Where it is written.
    pub(crate) span: Span,
    pub(crate) shape: Shape<'g>,
    /// The run at which it begins and ends.
    pub(crate) from: Expr<'g>,
    pub(crate) to: Expr<'g>,
}

/// What a segment runs along.
#[derive(Debug)]
pub(crate) enum Shape<'g> {
    /// A point and the unit vector along the line.
    Line { from: [Expr<'g>; 2], direction: [Expr<'g>; 2] },
    /// The angle goes from the first coordinate to the second, and with the run if `sense` is 1, against it if −1.
    Arc { center: [Expr<'g>; 2], radius: Expr<'g>, from: Expr<'g>, sense: f64 },
    /// An arc by the point and the direction in which it begins; the radius is negative if it turns against the angles. It may
    /// be as large as that of a nearly straight line: nothing is a difference of large numbers.
    Bow { from: [Expr<'g>; 2], direction: Expr<'g>, radius: Expr<'g> },
    /// Both coordinates over the length of the chords between the points.
    Spline([CurveId; 2]),
    /// A spline through points that have no values yet.
    Unknown([Expr<'g>; 2]),
}

impl<'g> Segment<'g> {
    /// The point at a run along the profile, mm: beyond its ends a line and an arc go on, a spline has no points.
    pub(crate) fn point(&self, run: Expr<'g>) -> [Expr<'g>; 2] {
        let own = run - self.from;
        match &self.shape {
            Shape::Line { from, direction } => [0, 1].map(|k| from[k] + direction[k] * own),
            Shape::Arc { center, radius, from, sense } => {
                let angle = *from + own / *radius * own.graph().constant(*sense);
                [center[0] + *radius * angle.cos(), center[1] + *radius * angle.sin()]
            }
            Shape::Bow { from, direction, radius } => {
                let half_turn = own / (*radius + *radius);
                let chord = (*radius + *radius) * half_turn.sin();
                let towards = *direction + half_turn;
                [from[0] + chord * towards.cos(), from[1] + chord * towards.sin()]
            }
            Shape::Spline(coordinates) => coordinates.map(|curve| own.on_curve(curve, 0)),
            Shape::Unknown(point) => *point,
        }
    }
}

//! Whether the tool, in another of its positions, cuts away a point that it generates.
//!
//! The clearance's Hessian ([`clearance_minors`](flank_expr::geometry::Surface::clearance_minors)) tells of the positions just before and after. Here each point goes through
//! the tool's frame as the motions have it, and is checked against all pieces of the tool's surface: where it crosses one, the tool's
//! steel has been on both sides of it.

mod cells;
mod grid;
mod line;
mod net;
mod slip;
mod tape;

use flank_expr::geometry::Chain;
use flank_expr::{Expr, TapeError};

use crate::analysis::secondary::net::Piece;
use crate::analysis::secondary::slip::{Slip, Touch};
use crate::analysis::secondary::tape::PlaceTape;
use crate::equations::solution::Range;
use crate::surface::bound::BoundSurface;
pub use grid::{Judged, Unseen};

/// A tool with its positions.
#[derive(Clone, Debug)]
pub struct SecondaryCutting {
    pieces: Vec<Piece>,
    /// Of the motions: the work's pose in the tool, then its derivative by each motion; rotation row by row, then translation.
    pose: PlaceTape,
    ranges: Vec<Range>,
    /// Along which all pieces slide in themselves.
    slip: Option<Slip>,
}

impl SecondaryCutting {
    /// Of `pieces`, a tool's surfaces of two free unknowns in its own frame with normals out of its steel, each with the number by
    /// which it is named. `t_work_tool` is the pose of the tool in the work, which depends on `motions` alone; these run through their
    /// `ranges`.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor a motion nor has a value.
    ///
    /// # Panics
    /// If a piece does not have two unknowns, or there are not as many ranges as motions.
    pub fn new<'g>(
        pieces: &[(usize, BoundSurface<'g>)],
        t_work_tool: &Chain<'g>,
        (motions, ranges): (&[Expr<'g>], Vec<Range>),
    ) -> Result<SecondaryCutting, TapeError> {
        assert_eq!(motions.len(), ranges.len(), "one range for each motion");
        let t_tool_work = t_work_tool.inverse().merged().pose();
        let own: Vec<Expr<'g>> = t_tool_work.rotation.entries().into_iter().chain(t_tool_work.translation.0).collect();
        let derived = motions.iter().flat_map(|&motion| own.iter().map(move |entry| entry.derivative(motion)));
        let outputs: Vec<Expr<'g>> = own.iter().copied().chain(derived).collect();
        let piece = |(number, surface): &(usize, BoundSurface<'g>)| Piece::new(*number, surface);
        let (pieces, slip) = netted(pieces.iter().map(piece).collect::<Result<_, _>>()?);
        Ok(SecondaryCutting { pieces, pose: PlaceTape::new(&outputs, motions)?, ranges, slip })
    }

    /// The same of a tool and motions that were given while settings were open ([`Graph::with_settings`](flank_expr::Graph::with_settings)),
    /// with these values of them.
    #[must_use]
    pub fn with_settings(&self, values: &[f64]) -> SecondaryCutting {
        let (pieces, slip) = if self.pieces.iter().any(Piece::uses_settings) {
            netted(self.pieces.iter().map(|piece| piece.with_settings(values)).collect())
        } else {
            (self.pieces.clone(), self.slip)
        };
        SecondaryCutting { pieces, pose: self.pose.with_settings(values), ranges: self.ranges.clone(), slip }
    }

    /// The same along the same motions with other `ranges`.
    ///
    /// # Panics
    /// If there are not as many ranges as motions.
    #[must_use]
    pub fn over(&self, ranges: Vec<Range>) -> SecondaryCutting {
        assert_eq!(self.ranges.len(), ranges.len(), "one range for each motion");
        SecondaryCutting { ranges, ..self.clone() }
    }

    /// Makes the machine code that those with other settings share.
    pub fn translate(&self) {
        self.pieces.iter().for_each(Piece::translate);
        self.pose.translate();
    }
}

/// The pieces of a tool with their nets, and what all of them slide along.
fn netted(pieces: Vec<Piece>) -> (Vec<Piece>, Option<Slip>) {
    let touches: Vec<Vec<Touch>> = pieces.iter().map(|piece| piece.seen().touches()).collect();
    let along = |slip: Slip| {
        let slides = touches.iter().map(|own| slip.along(own)).collect::<Option<Vec<_>>>()?;
        let may_slide = pieces.iter().zip(&slides).all(|(piece, slide)| piece.may_slide(*slide));
        may_slide.then_some((slides, slip))
    };
    let (slides, slip) = match Slip::of(&touches.concat()).and_then(along) {
        Some((slides, slip)) => (slides, Some(slip)),
        None => (vec![[0.0; 2]; pieces.len()], None),
    };
    (pieces.into_iter().zip(slides).map(|(piece, slide)| piece.netted(slide)).collect(), slip)
}

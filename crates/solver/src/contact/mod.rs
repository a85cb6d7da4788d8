//! Where two generated flanks touch while a pair rolls, and how evenly they turn each other.
//!
//! Two surfaces stand in one frame at a roll position; what follows the roll (the other member's turn, say) has one unknown added, the
//! lag. They touch where positions agree and normals are opposite: with the constraints of both as many equations as unknowns, so that
//! a contact is a curve over the roll.

mod change;
mod corners;
mod edge;
mod mesh;
mod nearest;
mod outline;
mod path;
mod pattern;
mod point;
mod proof;
mod start;
mod synthesis;
mod touching;
mod track;
mod watch;
mod wish;

use std::sync::Arc;

use flank_expr::geometry::{Chain, Surface, Vector3};
use flank_expr::{Expr, Tape, TapeError};

use crate::equations::solution::Range;
use crate::equations::system::System;
use crate::surface::bound::BoundSurface;
pub use change::ContactChange;
pub use corners::{FlankCorners, FlankDirections};
use edge::EdgeSystems;
pub use edge::FlankEdge;
pub use mesh::{Carried, Engagement};
pub use outline::{Outline, OutlineSegment};
pub use path::ContactPath;
pub use pattern::{Gap, GapProblem};
pub use point::{ContactPoint, ContactState};
pub use proof::ContactProof;
pub use start::NoContact;
pub use synthesis::{ContactSynthesis, SynthesizedContact};
use watch::Watch;
pub use wish::{ContactNumber, ContactWish};

/// Two surfaces that roll on each other.
#[derive(Clone, Debug)]
pub struct RollingPair<'s, 'g> {
    /// The flanks, each in the frame of its member, with normals out of the member.
    pub surfaces: [&'s BoundSurface<'g>; 2],
    /// Of each member its pose in a frame that both share, in the roll and the lag alone.
    pub placements: [Chain<'g>; 2],
    /// What the contact is followed over.
    pub roll: Expr<'g>,
    /// What the contact determines, and between which values.
    pub lag: (Expr<'g>, Range),
    /// Where the teeth of each member end; a flank without one reaches as far as its unknowns' ranges, and has no edges.
    pub outlines: [Option<Outline>; 2],
    /// Mounting errors and settings by which the contact is differentiated, with their values.
    pub parameters: Vec<(Expr<'g>, f64)>,
}

impl RollingPair<'_, '_> {
    /// The same pair with its members named the other way round: it touches at the same places.
    pub fn swapped(mut self) -> Self {
        self.surfaces.reverse();
        self.placements.reverse();
        self.outlines.reverse();
        self
    }
}

/// The equations of a contact of two flanks.
#[derive(Clone, Debug)]
pub struct ContactProblem {
    /// Unknowns of the first flank, of the second, the lag; the roll, what the contact is differentiated by, and two directions are
    /// parameters.
    touching: System,
    /// Unknowns of the second flank and the lag, at which it passes through a point of the first one: the unknowns of the first flank
    /// and the roll are parameters.
    through: System,
    /// From the unknowns, the lag and the roll: what [`point`] reads.
    state: Tape,
    /// From the lag, the roll and what the contact is differentiated by: of each member its origin and its axes, row by row.
    poses: Tape,
    /// Numbers of unknowns and of constraints of each flank.
    unknowns: [usize; 2],
    constraints: [usize; 2],
    ranges: Vec<Range>,
    outlines: [Option<Outline>; 2],
    /// Of what the contact is differentiated by.
    values: Vec<f64>,
    /// Where an edge of either flank may touch.
    edges: Option<EdgeSystems>,
    /// Where else the pair may touch first.
    watch: Option<Arc<Watch>>,
}

impl ContactProblem {
    /// # Errors
    /// If something depends on a variable that is neither an unknown, nor the roll or lag, nor has a value.
    ///
    /// # Panics
    /// If a surface does not have two unknowns more than constraints.
    pub fn new<'g>(pair: &RollingPair<'_, 'g>) -> Result<ContactProblem, TapeError> {
        let graph = pair.roll.graph();
        // flanks of one job may be envelopes over the same motion, which may also be the roll
        let own = [pair.surfaces[0].renamed("of the first"), pair.surfaces[1].renamed("of the second")];
        let [first, second] = [0, 1].map(|k| own[k].surface().moved(&pair.placements[k]));
        let (lag, range) = pair.lag;
        let vector = |name: &str| Vector3(["x", "y", "z"].map(|axis| graph.variable(format!("{name} {axis}"))));
        let directions = [vector("first direction"), vector("second direction")];
        let apart = first.position - second.position;
        let opposite = directions.map(|direction| (first.normal + second.normal).dot(direction));
        let constraints = |surface: &Surface<'g>| surface.constraints.clone();
        let residuals = [constraints(&first), constraints(&second), apart.0.to_vec(), opposite.to_vec()].concat();
        let unknowns = [&first.unknowns[..], &second.unknowns, &[lag]].concat();
        let given: Vec<Expr<'_>> =
            [pair.roll].into_iter().chain(pair.parameters.iter().map(|(name, _)| *name)).collect();
        let parameters = [&given[..], &directions[0].0, &directions[1].0].concat();
        let through = [constraints(&second), apart.0.to_vec()].concat();
        let followed = [&second.unknowns[..], &[lag]].concat();
        let of_first = [&first.unknowns[..], &given].concat();
        let inputs = [&unknowns[..], &given].concat();
        let placed = [0, 1].map(|k| edge::PlacedFlank { own: own[k].surface(), placement: &pair.placements[k] });
        let poses: Vec<Expr<'_>> = pair.placements.iter().flat_map(|placement| point::pose(placement)).collect();
        let has_edges = pair.outlines.iter().any(Option::is_some);
        let edges = has_edges.then(|| EdgeSystems::new(&placed, &unknowns, &given)).transpose()?;
        Ok(ContactProblem {
            touching: System::one_by_one(&residuals, &unknowns, &parameters)?,
            through: System::new(&through, &followed, &of_first)?,
            state: Tape::new(&point::outputs(&placed, [&first, &second], pair.roll, lag), &inputs)?,
            poses: Tape::new(&poses, &[&[lag][..], &given].concat())?,
            unknowns: [first.unknowns.len(), second.unknowns.len()],
            constraints: [first.constraints.len(), second.constraints.len()],
            ranges: [pair.surfaces[0].ranges(), pair.surfaces[1].ranges(), &[range]].concat(),
            outlines: pair.outlines.clone(),
            values: pair.parameters.iter().map(|(_, value)| *value).collect(),
            edges,
            watch: None,
        })
    }

    /// The same pair with other values of what it is differentiated by.
    ///
    /// # Panics
    /// If there are not as many.
    pub fn with_values(&self, values: &[f64]) -> ContactProblem {
        assert_eq!(values.len(), self.values.len(), "one value for each parameter");
        ContactProblem { values: values.to_vec(), ..self.clone() }
    }

    /// The same with flanks that go on beyond the ranges of their tools, and a lag beyond its own.
    fn beyond_ranges(mut self) -> ContactProblem {
        self.ranges.iter_mut().for_each(|range| *range = range.beyond(0.0));
        self
    }

    /// The roll, then the values of what the contact is differentiated by.
    fn given(&self, roll: f64) -> impl Iterator<Item = f64> {
        [roll].into_iter().chain(self.values.iter().copied())
    }

    fn lag_at(&self) -> usize {
        self.unknowns[0] + self.unknowns[1]
    }
}

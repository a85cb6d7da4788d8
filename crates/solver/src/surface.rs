//! Points of one surface at given values of two coordinates.

use flank_expr::geometry::Surface;
use flank_expr::{Expr, LaneTape, Tape, TapeError};

use crate::grid::{Effort, solve_field};
use crate::points::SurfacePoints;
use crate::solution::{Outcome, Range};
use crate::system::System;

/// A surface under constraint with two coordinates that points are asked for by.
#[derive(Clone, Debug)]
pub struct SurfaceProblem {
    system: System,
    /// Position and normal.
    point: LaneTape,
    ranges: Vec<Range>,
}

/// A point that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The verdict; the other fields describe a point of the surface only if it is [`Outcome::Solved`].
    pub outcome: Outcome,
    /// The surface's unknowns, mm or radians.
    pub unknowns: Vec<f64>,
    /// Position, mm, in the frame of the surface.
    pub position: [f64; 3],
    /// Unit vector out of the body that owns the surface.
    pub normal: [f64; 3],
    /// The largest residual, mm or mm per radian.
    pub residual: f64,
}

impl SurfaceProblem {
    /// Points of `surface` at which two `coordinates` (functions of its unknowns) have given values, with the unknowns in
    /// `ranges`. `bindings` replace the remaining variables (parameters) by numbers.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor bound.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints, or `ranges` not one entry per unknown.
    pub fn new<'g>(
        surface: &Surface<'g>,
        coordinates: [Expr<'g>; 2],
        ranges: Vec<Range>,
        bindings: &[(Expr<'g>, Expr<'g>)],
    ) -> Result<SurfaceProblem, TapeError> {
        let bound = surface.bound(bindings);
        let conditions = bound.clearance_minors();
        SurfaceProblem::of(&bound, coordinates, ranges, bindings, &conditions)
    }

    /// Points of the line on `surface` on which `quantity` is zero, at given values of one more coordinate: solve it with
    /// targets `[0, value]`. The singular line has the last of [`Surface::clearance_minors`] as its quantity, the limit of
    /// the contact on the tool [`Surface::contact_limit`].
    ///
    /// No point of the line is cut away or singular by the clearance's Hessian: the line is where that changes. The rest is
    /// as for [`SurfaceProblem::new`].
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor bound.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints, or `ranges` not one entry per unknown.
    pub fn line<'g>(
        surface: &Surface<'g>,
        quantity: Expr<'g>,
        along: Expr<'g>,
        ranges: Vec<Range>,
        bindings: &[(Expr<'g>, Expr<'g>)],
    ) -> Result<SurfaceProblem, TapeError> {
        SurfaceProblem::of(&surface.bound(bindings), [quantity, along], ranges, bindings, &[])
    }

    fn of<'g>(
        bound: &Surface<'g>,
        coordinates: [Expr<'g>; 2],
        ranges: Vec<Range>,
        bindings: &[(Expr<'g>, Expr<'g>)],
        conditions: &[Expr<'g>],
    ) -> Result<SurfaceProblem, TapeError> {
        assert_eq!(bound.unknowns.len(), ranges.len(), "one range for each unknown");
        let graph = coordinates[0].graph();
        let targets = [graph.variable("target 1"), graph.variable("target 2")];
        let coordinates = graph.substitute(&coordinates, bindings);
        let on_target = coordinates.into_iter().zip(targets).map(|(coordinate, target)| coordinate - target);
        let residuals: Vec<Expr<'g>> = bound.constraints.iter().copied().chain(on_target).collect();
        let point: Vec<Expr<'g>> = bound.position.0.into_iter().chain(bound.normal.0).collect();
        let system = System::new(&residuals, &bound.unknowns, &targets)?;
        Ok(SurfaceProblem {
            system: system.with_conditions(conditions, &bound.unknowns, &targets)?,
            point: LaneTape::new(&Tape::new(&point, &bound.unknowns)?),
            ranges,
        })
    }

    /// The system that is solved for each point.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Solves a grid of targets, row by row; every point gets a verdict.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` targets.
    pub fn solve(&self, targets: &[[f64; 2]], counts: [usize; 2]) -> (Vec<SurfacePoint>, Effort) {
        let (points, effort) = self.solve_points(targets, counts, None);
        ((0..points.len()).map(|k| points.point(k)).collect(), effort)
    }

    /// The same for very many points. `start`, if there is one, tells the branch: unknowns from which Newton reaches it at the
    /// point in the middle of the grid. If it does not, the branch is looked for as without.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` targets, or `start` has not one number for each unknown.
    pub fn solve_points(
        &self,
        targets: &[[f64; 2]],
        counts: [usize; 2],
        start: Option<&[f64]>,
    ) -> (SurfacePoints, Effort) {
        let (field, effort) = solve_field(&self.system, &self.ranges, targets, counts, start);
        (SurfacePoints::new(field, &self.point, &self.ranges, targets.len()), effort)
    }
}

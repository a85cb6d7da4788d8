//! Cutting edges: lines of a tool that sweep surfaces.

use crate::geometry::chain::Chain;
use crate::geometry::surface::Surface;
use crate::geometry::vector::Vector3;
use crate::symbolic::graph::Expr;

/// A cutting edge `position(u)` in its tool's frame, with a direction that points from it into the tool's steel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edge<'g> {
    /// The variable that runs along it.
    pub parameter: Expr<'g>,
    /// A point of it, mm.
    pub position: Vector3<'g>,
    /// Into the tool's steel; of any length.
    pub steel: Vector3<'g>,
}

impl<'g> Edge<'g> {
    /// `r_u × v`, square to the swept surface, in the tool's frame and not of unit length; v is the edge's velocity against
    /// the work along a motion.
    pub fn raw_normal(&self, t_work_tool: &Chain<'g>, motion: Expr<'g>) -> Vector3<'g> {
        let velocity = t_work_tool.twist(motion).velocity(self.position);
        self.position.derivative(self.parameter).cross(velocity)
    }

    /// What the edge leaves on a work that it moves against: swept over the first motion, enveloped over the others.
    ///
    /// The normal is along [`Edge::raw_normal`] of the first motion (or against it, if `flipped`) and should point to the
    /// tool's steel, out of the work's. Further motions add `n · v = 0` (with n out of the tool's steel, as for an
    /// envelope), which is `det(r_u, v₁, v₂) = 0` for a second one.
    ///
    /// # Panics
    /// If there is no motion.
    pub fn sweep(&self, t_work_tool: &Chain<'g>, motions: &[Expr<'g>], flipped: bool) -> Surface<'g> {
        let normal = self.raw_normal(t_work_tool, motions[0]).normalized();
        let normal = if flipped { -normal } else { normal };
        let unknowns = [self.parameter].into_iter().chain(motions.iter().copied()).collect();
        let swept = Surface { unknowns, position: self.position, normal, constraints: Vec::new(), given: 0 };
        let constraints = motions[1..].iter().map(|&motion| -swept.meshing(t_work_tool, motion)).collect();
        Surface { constraints, ..swept.moved(t_work_tool) }
    }
}

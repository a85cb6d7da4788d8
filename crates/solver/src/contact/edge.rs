//! Edges of a flank on the other flank: where a tooth touches with its tip, toe or heel.
//!
//! An edge is where a flank ends at a segment of its outline. It touches the other flank where its tangent is square to that flank's
//! normal; a corner, and a crossing of two edges, touch where they are.

use flank_expr::geometry::{Chain, Surface, Vector3 as Vector};
use flank_expr::{Expr, TapeError};
use nalgebra::{Matrix2, Vector2, Vector3};

use crate::analysis::geometry::tangents;
use crate::contact::ContactProblem;
use crate::contact::outline::Bound;
use crate::contact::point::{ALONG, Member};
use crate::equations::system::System;

/// The end of a flank at a segment of its outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FlankEdge {
    /// Of the first flank, 0, or of the second, 1.
    pub member: usize,
    /// Which segment of its outline.
    pub segment: usize,
}

/// A flank in its own frame, and its pose in the frame of the contact.
pub(super) struct PlacedFlank<'s, 'g> {
    pub(super) own: &'s Surface<'g>,
    pub(super) placement: &'s Chain<'g>,
}

/// The equations of each way to touch with edges. Unknowns are those of both flanks and the lag; parameters the roll and what the contact is
/// differentiated by, then the numbers of each bound.
#[derive(Clone, Debug)]
pub(super) struct EdgeSystems {
    edge: [System; 2],
    corner: [System; 2],
    crossing: System,
}

impl EdgeSystems {
    pub(super) fn new<'g>(
        flanks: &[PlacedFlank<'_, 'g>; 2],
        unknowns: &[Expr<'g>],
        given: &[Expr<'g>],
    ) -> Result<EdgeSystems, TapeError> {
        let graph = given[0].graph();
        let [a, b] =
            ["first", "second"].map(|of| BoundNames::new(&|name| graph.variable(format!("{of} bound {name}"))));
        let [first, second] = flanks.each_ref().map(|flank| flank.own.moved(flank.placement));
        let apart = (first.position - second.position).0;
        let both = [&first.constraints[..], &second.constraints, &apart].concat();
        let system = |further: &[Expr<'g>], bounds: &[&BoundNames<'g>]| {
            let numbers = bounds.iter().flat_map(|bound| bound.numbers);
            let parameters: Vec<Expr<'g>> = given.iter().copied().chain(numbers).collect();
            System::one_by_one(&[&both, further].concat(), unknowns, &parameters)
        };
        let edge = |k: usize, other: &Surface<'g>| {
            let square = flanks[k].placement.direction(a.tangent(flanks[k].own)).dot(other.normal);
            system(&[a.height(flanks[k].own), square], &[&a])
        };
        let corner = |k: usize| system(&[&a, &b].map(|bound| bound.height(flanks[k].own)), &[&a, &b]);
        Ok(EdgeSystems {
            edge: [edge(0, &second)?, edge(1, &first)?],
            corner: [corner(0)?, corner(1)?],
            crossing: system(&[a.height(flanks[0].own), b.height(flanks[1].own)], &[&a, &b])?,
        })
    }

    /// The one in which these edges touch, one or two in rising order.
    pub(super) fn system(&self, edges: &[FlankEdge]) -> &System {
        match edges {
            [edge] => &self.edge[edge.member],
            [a, b] if a.member == b.member => &self.corner[a.member],
            _ => &self.crossing,
        }
    }
}

/// The numbers of a [`Bound`] as parameters.
struct BoundNames<'g> {
    numbers: [Expr<'g>; Bound::NUMBERS],
}

impl<'g> BoundNames<'g> {
    fn new(variable: &dyn Fn(&str) -> Expr<'g>) -> BoundNames<'g> {
        BoundNames { numbers: ["z", "rho", "inward z", "inward rho", "bend"].map(variable) }
    }

    /// The point from the bound's origin, and its distance from the axis.
    fn relative(&self, flank: &Surface<'g>) -> ([Expr<'g>; 2], Expr<'g>) {
        let [x, y, z] = flank.position.0;
        let rho = (x * x + y * y).sqrt();
        ([z - self.numbers[0], rho - self.numbers[1]], rho)
    }

    fn height(&self, flank: &Surface<'g>) -> Expr<'g> {
        let ([z, rho], _) = self.relative(flank);
        let [_, _, inward_z, inward_rho, bend] = self.numbers;
        inward_z * z + inward_rho * rho + bend * 0.5 * (z * z + rho * rho)
    }

    /// Along the edge, in the flank's frame: square to the flank's normal and to the gradient of the bound.
    fn tangent(&self, flank: &Surface<'g>) -> Vector<'g> {
        let ([z, out], rho) = self.relative(flank);
        let [_, _, inward_z, inward_rho, bend] = self.numbers;
        let (by_z, by_rho) = (inward_z + bend * z, inward_rho + bend * out);
        let [x, y, _] = flank.position.0;
        flank.normal.cross(Vector([by_rho * x / rho, by_rho * y / rho, by_z]))
    }
}

impl ContactProblem {
    pub(super) fn bound(&self, edge: FlankEdge) -> Option<Bound> {
        Some(self.outlines[edge.member].as_ref()?.segments()[edge.segment].bound())
    }

    /// The edge beyond which a member's point lies, and how far: the farthest of both members.
    pub(super) fn beyond(&self, members: &[Member; 2]) -> Option<FlankEdge> {
        let of = |member: usize| {
            let (segment, distance) = self.outlines[member].as_ref()?.beyond(members[member].section())?;
            Some((FlankEdge { member, segment }, distance))
        };
        (0..2).filter_map(of).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(edge, _)| edge)
    }

    /// For each edge that touches by how much the lag opens more towards it, as a share of the slope of the lag: negative where the pair
    /// does not stay at it, because the lag opens more away from it.
    pub(super) fn multipliers(&self, edges: &[FlankEdge], members: &[Member; 2]) -> Vec<f64> {
        let [first, second] = members;
        let moved = second.moved[1] - first.moved[1];
        let speed = second.normal.dot(&moved);
        let in_plane = tangents(first.normal);
        // the point of both, moved along the first flank, moves along the second by less what the lag moves that
        let climb = -in_plane.transpose() * second.normal;
        let inwards = |edge: &FlankEdge| {
            let gradient = self.bound(*edge).map_or(Vector3::zeros(), |bound| members[edge.member].gradient(&bound));
            let along_lag = if edge.member == 0 { 0.0 } else { moved.dot(&gradient) / speed };
            (in_plane.transpose() * (gradient - second.normal * along_lag)).normalize()
        };
        let size = climb.norm();
        // on a line along which both flanks touch the lag is the same all along it: what is left of its slope is rounding
        if size < ALONG {
            return vec![0.0; edges.len()];
        }
        match edges {
            [] => Vec::new(),
            [edge, rest @ ..] => {
                let columns: [Vector2<f64>; 2] = match rest {
                    [other, ..] => [inwards(edge), inwards(other)],
                    [] => [inwards(edge), Vector2::new(-inwards(edge).y, inwards(edge).x)],
                };
                let by =
                    Matrix2::from_columns(&columns).try_inverse().map_or(Vector2::zeros(), |inverse| inverse * climb);
                by.iter().take(edges.len()).map(|share| -share / size).collect()
            }
        }
    }

    /// The direction in which the members press on each other, out of the first: the normal of the flank that an edge or corner touches,
    /// and what is square to both of two edges that cross.
    pub(super) fn pressing(&self, edges: &[FlankEdge], members: &[Member; 2]) -> Vector3<f64> {
        let [first, second] = members;
        match edges {
            [a, b] if a.member != b.member => {
                let along = |edge: &FlankEdge| {
                    let member = &members[edge.member];
                    self.bound(*edge).map(|bound| member.normal.cross(&member.gradient(&bound)))
                };
                let square = along(a).zip(along(b)).map_or(first.normal, |(a, b)| a.cross(&b).normalize());
                if square.dot(&(first.normal - second.normal)) < 0.0 { -square } else { square }
            }
            [edge, ..] if edge.member == 0 => -second.normal,
            _ => first.normal,
        }
    }
}

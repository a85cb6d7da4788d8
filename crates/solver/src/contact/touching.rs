//! A contact from a start value near it: flank on flank, or the edges that touch instead.

use nalgebra::Vector3;

use crate::contact::ContactProblem;
use crate::contact::edge::FlankEdge;
use crate::contact::outline::Outline;
use crate::contact::point::{ContactPoint, ContactState, Member, directions};
use crate::equations::solution::{Outcome, Solution};
use crate::equations::system::System;
use crate::newton::scalar::solve_with;

/// Times that an edge comes to touch, or is left, on the way to the contact.
const MOST_CHANGES: usize = 10;
/// Edges that touch at a time: each leaves one direction less to move in.
const MOST_EDGES: usize = 2;
/// A multiplier below this, as a share of the slope of the lag, leaves its edge: less is rounding.
const RELEASED: f64 = -1e-9;
/// A normal that is off by more than this has turned: its directions are no tangents any more.
const TURNED: f64 = 0.5;
/// Times that the directions in which normals are compared are turned with them.
const MOST_TURNS: usize = 2;

impl ContactProblem {
    /// The equations with which the members touch so, with the values of their parameters; normals of flanks are compared square to one.
    pub(super) fn equations(
        &self,
        edges: &[FlankEdge],
        roll: f64,
        normal: &Vector3<f64>,
    ) -> Option<(&System, Vec<f64>)> {
        if edges.is_empty() {
            return Some((&self.touching, self.given(roll).chain(directions(normal)).collect()));
        }
        let bounds: Option<Vec<_>> = edges.iter().map(|edge| Some(self.bound(*edge)?.numbers())).collect();
        Some((self.edges.as_ref()?.system(edges), self.given(roll).chain(bounds?.concat()).collect()))
    }

    /// The contact near unknowns of both and a lag: with these edges, or with those that come to touch instead.
    pub(super) fn touching_near(
        &self,
        roll: f64,
        unknowns: &[f64],
        edges: &[FlankEdge],
        normal: Vector3<f64>,
    ) -> Option<ContactPoint> {
        let (mut edges, mut start, mut normal) = (edges.to_vec(), unknowns.to_vec(), normal);
        for _ in 0..MOST_CHANGES {
            let (root, members) = self.root(roll, &start, &edges, normal)?;
            let Some(changed) = self.changed(&edges, &members) else {
                let point = self.point(root, roll, edges, &members);
                let point = self.end_of_line(&point).unwrap_or(point);
                return (point.is_of_flanks() || !self.is_beyond_known(&point.edges)).then_some(point);
            };
            (edges, start, normal) = (changed, root.unknowns, members[0].normal);
        }
        None
    }

    /// Whether one of these edges is where what is known of a flank ends, and not the flank.
    fn is_beyond_known(&self, edges: &[FlankEdge]) -> bool {
        edges.iter().any(|edge| self.outlines[edge.member].as_ref().is_some_and(Outline::is_open))
    }

    /// Where the line along which flank touches flank at a point ends at an edge, the nearer end: along the line nothing says where the contact
    /// is, and with an edge it is one point. `None` where they touch in a point, or where no edge ends the line.
    fn end_of_line(&self, point: &ContactPoint) -> Option<ContactPoint> {
        if !point.edges.is_empty() || point.state != Some(ContactState::Line) {
            return None;
        }
        let segments = |member: usize| self.outlines[member].as_ref().map_or(0, |outline| outline.segments().len());
        let edges = (0..2).flat_map(|member| (0..segments(member)).map(move |segment| FlankEdge { member, segment }));
        let ends = edges.filter_map(|edge| {
            let (root, members) = self.root(point.roll, &point.all_unknowns(), &[edge], point.first_normal.into())?;
            let end = self.beyond(&members).is_none().then(|| self.point(root, point.roll, vec![edge], &members))?;
            (end.state == Some(ContactState::Line)).then_some(end)
        });
        let from = Vector3::from(point.position);
        let off = |end: &ContactPoint| (Vector3::from(end.position) - from).norm();
        ends.min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// The root with these edges and no others, however far beyond other edges it lies.
    pub(super) fn root(
        &self,
        roll: f64,
        start: &[f64],
        edges: &[FlankEdge],
        normal: Vector3<f64>,
    ) -> Option<(Solution, [Member; 2])> {
        let (mut start, mut normal) = (start.to_vec(), normal);
        for _ in 0..MOST_TURNS {
            let (system, parameters) = self.equations(edges, roll, &normal)?;
            let root = solve_with(&mut system.evaluation(&parameters), &self.ranges, &start);
            if !matches!(root.outcome, Outcome::Solved | Outcome::Outside { .. }) {
                return None;
            }
            let members = self.members(&root.unknowns, roll);
            if !edges.is_empty() || (members[0].normal - normal).norm() < TURNED {
                return ContactProblem::faces(edges, &members).then_some((root, members));
            }
            (start, normal) = (root.unknowns, members[0].normal);
        }
        None
    }

    /// Which edges touch instead: one more where the root lies beyond it, one less where the lag opens further away from it; `None` where
    /// it is these.
    fn changed(&self, edges: &[FlankEdge], members: &[Member; 2]) -> Option<Vec<FlankEdge>> {
        let multipliers = self.multipliers(edges, members);
        let least = (0..edges.len()).min_by(|a, b| multipliers[*a].total_cmp(&multipliers[*b]));
        let mut changed = edges.to_vec();
        match self.beyond(members).filter(|edge| !edges.contains(edge)) {
            Some(edge) => {
                if let Some(least) = least.filter(|_| edges.len() == MOST_EDGES) {
                    changed.remove(least);
                }
                changed.push(edge);
                changed.sort();
            }
            None => {
                changed.remove(least.filter(|least| multipliers[*least] < RELEASED)?);
            }
        }
        Some(changed)
    }
}

//! Where a part of a gear is cut off from the rest: its sides, and the faces that end there.

use super::shell::{Edge, Shell};
use super::solid::{GearSide, TurnedSegment};
use super::spline::SplineSurface;
use crate::files::error::WriteError;
use crate::vector::{Vector, cross, dot};

/// The edges of a side.
struct Cut {
    /// From the row inwards, where the spaces begin and where they end.
    ends: [Edge; 2],
    /// Along the segments of the rest of the outline.
    rest: Vec<Edge>,
    /// The vertices at the corners of the rest, from the end of the spaces on.
    corners: Vec<usize>,
}

impl Shell<'_, '_, '_> {
    /// The edges of a side, from the first row or, with the first side, the last one inwards. What both have on the axis is there once.
    fn cut(&mut self, side: &GearSide, first: Option<&Cut>) -> Result<Cut, WriteError> {
        let which = usize::from(first.is_some());
        let row = if which == 0 { self.rows[0] } else { self.rows[self.rows.len() - 1] };
        let (run, ways) = (self.body.run, self.ways[which]);
        let [begin, _, end] = &self.body.ends;
        let count = self.body.rest.len();
        let places: Vec<[f64; 2]> = self.body.rest.iter().map(|segment| segment.from).chain([begin.from]).collect();
        let mut corners = Vec::new();
        for (k, place) in places.iter().enumerate() {
            if let Some(first) = first.filter(|_| run.is_on_axis(*place)) {
                corners.push(first.corners[k]);
                continue;
            }
            let point = match side {
                GearSide::Bent { rest, .. } if k < count => rest[k][0],
                _ => run.at(*place, ways[usize::from(k == 0 && count > 0)]),
            };
            let point = self.part.point(point)?;
            corners.push(self.vertex(point)?);
        }
        let mut lines = Vec::new();
        for (k, segment) in self.body.rest.iter().enumerate() {
            if let Some(first) = first.filter(|_| run.is_along_axis(segment)) {
                lines.push(first.rest[k]);
                continue;
            }
            let vertices = [corners[k], corners[k + 1]];
            lines.push(match side {
                GearSide::Flat => self.seam(segment, vertices, ways[0])?,
                GearSide::Bent { rest, .. } => self.spline_through(vertices, &rest[k])?,
            });
        }
        // on the ends towards the corners, against the sense of the outline at the beginning
        let down = |segment: &TurnedSegment, is_reversed: bool| match is_reversed {
            true => TurnedSegment { from: segment.to, to: segment.from, ..segment.clone() },
            false => segment.clone(),
        };
        let at_begin = self.seam(&down(begin, true), [row.vertices[0], corners[count]], ways[0])?;
        let at_end = self.seam(&down(end, false), [row.vertices[1], corners[0]], ways[1])?;
        Ok(Cut { ends: [at_begin, at_end], rest: lines, corners })
    }

    fn spline_through(&mut self, vertices: [usize; 2], points: &[Vector]) -> Result<Edge, WriteError> {
        // of a strip that is the line twice
        let strip: Vec<Vector> = points.iter().chain(points).copied().collect();
        let spline = SplineSurface::through(strip, [2, points.len()]);
        let mut poles = Vec::new();
        for pole in &spline.poles[..points.len()] {
            poles.push(self.part.point(*pole)?);
        }
        self.spline_edge(vertices, &poles, &spline.directions[1])
    }

    /// The ends, the rest of the outline and the sides of a part.
    pub(super) fn cut_faces(&mut self, sides: &[GearSide; 2]) -> Result<Vec<usize>, WriteError> {
        let first = self.cut(&sides[0], None)?;
        let last = self.cut(&sides[1], Some(&first))?;
        let cuts = [first, last];
        let [begin, _, end] = self.body.ends.clone();
        let places: Vec<[f64; 2]> = self.body.rest.iter().map(|segment| segment.from).chain([begin.from]).collect();
        let mut across = Vec::new();
        for (k, place) in places.iter().enumerate() {
            let is_line = !self.body.run.is_on_axis(*place);
            let path = is_line.then(|| self.path([cuts[0].corners[k], cuts[1].corners[k]], *place));
            across.push(path.transpose()?);
        }
        let across = |k: usize, is_forward: bool| across[k].map(|edge| (edge, is_forward));
        let columns = |end: usize| self.columns.iter().map(move |both| both[end]);
        let at_begin = columns(0).map(|edge| (edge, true));
        let below = [Some((cuts[1].ends[0], true)), across(places.len() - 1, false), Some((cuts[0].ends[0], false))];
        let begin_loop: Vec<(Edge, bool)> = at_begin.chain(below.into_iter().flatten()).collect();
        let at_end: Vec<(Edge, bool)> = columns(1).map(|edge| (edge, false)).collect();
        let below = [Some((cuts[0].ends[1], true)), across(0, true), Some((cuts[1].ends[1], false))];
        let end_loop: Vec<(Edge, bool)> = below.into_iter().flatten().chain(at_end.into_iter().rev()).collect();
        let seam = self.seam_of(0);
        let mut faces = Vec::new();
        for (segment, edges) in [(&begin, begin_loop), (&end, end_loop)] {
            let surface = self.surface(segment, seam)?;
            faces.push(self.face(&segment.name, &[edges], surface)?);
        }
        for (k, segment) in self.body.rest.iter().enumerate() {
            if self.body.run.is_along_axis(segment) {
                continue;
            }
            let surface = self.surface(segment, seam)?;
            let [down, up] = [(cuts[0].rest[k], true), (cuts[1].rest[k], false)];
            let edges = [Some(down), across(k + 1, true), Some(up), across(k, false)];
            faces.push(self.face(&segment.name, &[edges.into_iter().flatten().collect()], surface)?);
        }
        for (which, side) in sides.iter().enumerate() {
            let row = if which == 0 { self.rows[0] } else { self.rows[self.rows.len() - 1] };
            let cut = &cuts[which];
            // the first one as the face before it goes round it
            let inwards = [(row.edge, false), (cut.ends[0], true)].into_iter();
            let back = cut.rest.iter().rev().map(|edge| (*edge, false)).chain([(cut.ends[1], false)]);
            let mut edges: Vec<(Edge, bool)> = inwards.chain(back).collect();
            if which == 1 {
                edges.reverse();
                edges.iter_mut().for_each(|(_, is_forward)| *is_forward = !*is_forward);
            }
            let surface = self.side_surface(side, which)?;
            faces.push(self.face("cut", &[edges], surface)?);
        }
        Ok(faces)
    }

    /// The surface of a side, and whether its own normal points out of the body.
    fn side_surface(&mut self, side: &GearSide, which: usize) -> Result<(usize, bool), WriteError> {
        let [out, on] = self.body.run.directions(self.ways[which][0]);
        let away = if which == 0 { on.map(|x| -x) } else { on };
        match side {
            GearSide::Flat => {
                let place = self.body.run.at([0.0, 0.0], self.ways[which][0]);
                let place = self.part.placement(place, away, out)?;
                Ok((self.part.add(&format!("PLANE('',#{place})"))?, true))
            }
            GearSide::Bent { points, counts, .. } => {
                let spline = SplineSurface::through(points.clone(), *counts);
                let mut poles = Vec::new();
                for pole in &spline.poles {
                    poles.push(self.part.point(*pole)?);
                }
                let [at, by_u, by_v] = spline.at(0.5 * (counts[0] - 1) as f64, 0.5 * (counts[1] - 1) as f64);
                let [_, on] = self.body.run.directions(self.body.run.way(at));
                let is_on = dot(cross(by_u, by_v), on) > 0.0;
                Ok((self.part.spline_surface("cut", &spline, &poles)?, is_on == (which == 1)))
            }
        }
    }
}

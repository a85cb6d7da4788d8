//! The closed shell of a gear: strips from where the spaces begin to where they end, the ends, and the rest of the outline.

use std::f64::consts::{PI, TAU};

use super::blank::is_plane;
use super::solid::{GearBody, GearStrip, TurnedSegment};
use super::spline::{Direction, SplineSurface};
use super::{DataSection, knots, numbers, text};
use crate::files::error::WriteError;

/// An edge with its vertices.
#[derive(Clone, Copy)]
pub(super) struct Edge(pub(super) usize);

/// A circle of the blank: its vertices by angle, and the edges that follow them.
struct Ring {
    vertices: Vec<(f64, usize)>,
    edges: Vec<Edge>,
}

/// A line between strips, from where the spaces begin to where they end, with its vertices.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) edge: Edge,
    pub(super) vertices: [usize; 2],
}

/// The edges and vertices of a gear, each once.
pub(super) struct Shell<'p, 'w, 'b> {
    pub(super) part: &'p mut DataSection<'w>,
    pub(super) body: &'b GearBody,
    splines: Vec<SplineSurface>,
    /// Of each strip that is a surface the poles as points, row by row.
    poles: Vec<Vec<usize>>,
    /// Before each strip, and behind the last one: of a ring that is the first one again.
    pub(super) rows: Vec<Row>,
    /// Of each strip the edges at its beginning and at its end.
    pub(super) columns: Vec<[Edge; 2]>,
    /// The way to the first row, and to the last one: at their beginnings and at their ends.
    pub(super) ways: [[f64; 2]; 2],
    /// At the corners of the rest of the outline, from the end of the spaces on.
    rings: Vec<Ring>,
}

impl<'p, 'w, 'b> Shell<'p, 'w, 'b> {
    pub(super) fn new(part: &'p mut DataSection<'w>, body: &'b GearBody) -> Result<Shell<'p, 'w, 'b>, WriteError> {
        let splines =
            body.surfaces.iter().map(|(_, points, counts)| SplineSurface::through(points.clone(), *counts)).collect();
        let mut shell = Shell {
            part,
            body,
            splines,
            poles: Vec::new(),
            rows: Vec::new(),
            columns: Vec::new(),
            ways: [[0.0; 2]; 2],
            rings: Vec::new(),
        };
        shell.poles()?;
        shell.rows()?;
        shell.columns()?;
        Ok(shell)
    }

    fn is_ring(&self) -> bool {
        self.body.sides.is_none()
    }

    fn surface_of(&self, strip: usize) -> Option<(usize, i32)> {
        match self.body.strips[strip] {
            GearStrip::Surface { surface, spaces } => Some((surface, spaces)),
            GearStrip::Land => None,
        }
    }

    /// Columns of all surfaces.
    fn along(&self) -> usize {
        self.splines[0].directions[1].count
    }

    pub(super) fn vertex(&mut self, point: usize) -> Result<usize, WriteError> {
        self.part.add(&format!("VERTEX_POINT('',#{point})"))
    }

    pub(super) fn edge(&mut self, [from, to]: [usize; 2], curve: usize) -> Result<Edge, WriteError> {
        Ok(Edge(self.part.add(&format!("EDGE_CURVE('',#{from},#{to},#{curve},.T.)"))?))
    }

    pub(super) fn spline_edge(
        &mut self,
        vertices: [usize; 2],
        poles: &[usize],
        of: &Direction,
    ) -> Result<Edge, WriteError> {
        let (counts, values) = knots(of);
        let curve = format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{},{},.UNSPECIFIED.,.F.,.F.,{counts},{values},.UNSPECIFIED.)",
            of.degree,
            numbers(poles)
        );
        let curve = self.part.add(&curve)?;
        self.edge(vertices, curve)
    }

    /// The poles of all surfaces as points: a row that two have in common is there once.
    fn poles(&mut self) -> Result<(), WriteError> {
        let columns = self.along();
        let last = self.body.strips.len() - 1;
        for strip in 0..=last {
            let Some((surface, spaces)) = self.surface_of(strip) else {
                self.poles.push(Vec::new());
                continue;
            };
            let before = self.poles.last().map_or(&[][..], |before| &before[before.len().saturating_sub(columns)..]);
            let mut points: Vec<usize> = before.to_vec();
            let closes = self.is_ring() && strip == last && self.surface_of(0).is_some();
            let own = self.splines[surface].poles.len() - if closes { columns } else { 0 };
            for at in points.len()..own {
                let pole = self.body.run.moved(self.splines[surface].poles[at], spaces);
                points.push(self.part.point(pole)?);
            }
            if closes {
                points.extend_from_slice(&self.poles[0][..columns]);
            }
            self.poles.push(points);
        }
        Ok(())
    }

    fn rows(&mut self) -> Result<(), WriteError> {
        let (columns, count) = (self.along(), self.body.strips.len());
        let direction = self.splines[0].directions[1].clone();
        for row in 0..count + usize::from(!self.is_ring()) {
            let line: Vec<usize> = match self.poles.get(row).filter(|poles| !poles.is_empty()) {
                Some(poles) => poles[..columns].to_vec(),
                None => self.poles[row - 1][self.poles[row - 1].len() - columns..].to_vec(),
            };
            let vertices = [self.vertex(line[0])?, self.vertex(line[columns - 1])?];
            let edge = self.spline_edge(vertices, &line, &direction)?;
            self.rows.push(Row { edge, vertices });
        }
        if self.is_ring() {
            self.rows.push(self.rows[0]);
        }
        Ok(())
    }

    fn columns(&mut self) -> Result<(), WriteError> {
        let columns = self.along();
        for strip in 0..self.body.strips.len() {
            let ends = [0, 1].map(|end| [self.rows[strip].vertices[end], self.rows[strip + 1].vertices[end]]);
            let tip = [self.body.ends[1].from, self.body.ends[1].to];
            let mut both = [Edge(0); 2];
            for (end, column) in [0, columns - 1].into_iter().enumerate() {
                both[end] = match self.surface_of(strip) {
                    Some((surface, _)) => {
                        let line: Vec<usize> =
                            self.poles[strip].iter().skip(column).step_by(columns).copied().collect();
                        let direction = self.splines[surface].directions[0].clone();
                        self.spline_edge(ends[end], &line, &direction)?
                    }
                    None => self.path(ends[end], tip[end])?,
                };
            }
            self.columns.push(both);
        }
        Ok(())
    }

    /// The ways to the first row of the first surface and to the last row of the last one.
    fn find_ways(&mut self) {
        let columns = self.along();
        let last = self.body.strips.len() - 1;
        let way = |strip: usize, is_last: bool, end: usize| {
            let (surface, spaces) = self.surface_of(strip).expect("a ring and a part begin and end with surfaces");
            let points = &self.body.surfaces[surface].1;
            let first = if is_last { points.len() - columns } else { 0 };
            self.body.run.way(self.body.run.moved(points[first + end * (columns - 1)], spaces))
        };
        let first = [0, 1].map(|end| way(0, false, end));
        // the last strip of a ring may be a land
        let last = if self.is_ring() { first } else { [0, 1].map(|end| way(last, true, end)) };
        self.ways = [first, last];
    }

    pub(super) fn faces(mut self) -> Result<Vec<usize>, WriteError> {
        self.find_ways();
        let mut faces = Vec::new();
        let [begin, tip, end] = self.body.ends.clone();
        let mut land = None;
        for strip in 0..self.body.strips.len() {
            let (name, surface) = match self.surface_of(strip) {
                // across by along points into the body, as the way by the outline does that has the material on its left
                Some((surface, _)) => {
                    let name = self.body.surfaces[surface].0.clone();
                    let face = self.part.spline_surface(&name, &self.splines[surface], &self.poles[strip])?;
                    (name, (face, false))
                }
                // all lands lie on one surface
                None => {
                    let surface = match land {
                        Some(surface) => surface,
                        None => self.surface(&tip, self.seam_of(0))?,
                    };
                    land = Some(surface);
                    (tip.name.clone(), surface)
                }
            };
            let [at_begin, at_end] = self.columns[strip];
            let [before, behind] = [self.rows[strip], self.rows[strip + 1]].map(|row| row.edge);
            faces.push(self.face(
                &name,
                &[vec![(before, true), (at_end, true), (behind, false), (at_begin, false)]],
                surface,
            )?);
        }
        if let Some(sides) = &self.body.sides {
            faces.extend(self.cut_faces(sides)?);
            return Ok(faces);
        }
        self.rings()?;
        faces.push(self.end_face(&begin, 0)?);
        faces.push(self.end_face(&end, 1)?);
        for (k, segment) in self.body.rest.iter().enumerate() {
            if !self.body.run.is_along_axis(segment) {
                faces.push(self.rest_face(segment, k)?);
            }
        }
        Ok(faces)
    }

    /// Where surfaces that close around the axis have their seam: a ring at an end of its first row, a part where it is not.
    pub(super) fn seam_of(&self, end: usize) -> f64 {
        let [first, last] = self.ways;
        if self.is_ring() {
            return first[end];
        }
        let span = (last[0] - first[0]).rem_euclid(TAU);
        first[0] + 0.5 * span + PI
    }

    /// A face within loops that run anticlockwise about its outward normal; one around a place on the axis is none.
    pub(super) fn face(
        &mut self,
        name: &str,
        loops: &[Vec<(Edge, bool)>],
        (surface, sense): (usize, bool),
    ) -> Result<usize, WriteError> {
        let letter = |is: bool| if is { ".T." } else { ".F." };
        let mut bounds = Vec::new();
        for (k, edges) in loops.iter().filter(|edges| !edges.is_empty()).enumerate() {
            let mut oriented = Vec::new();
            for (Edge(edge), is_forward) in edges {
                oriented.push(self.part.add(&format!("ORIENTED_EDGE('',*,*,#{edge},{})", letter(*is_forward)))?);
            }
            let border = self.part.add(&format!("EDGE_LOOP('',{})", numbers(&oriented)))?;
            let kind = if k == 0 { "FACE_OUTER_BOUND" } else { "FACE_BOUND" };
            bounds.push(self.part.add(&format!("{kind}('',#{border},.T.)"))?);
        }
        self.part.add(&format!("ADVANCED_FACE({},{},#{surface},{})", text(name), numbers(&bounds), letter(sense)))
    }

    /// The circles of the rest of the outline, on the axis a vertex alone. Seams of the rest lie at the angle of the end's first vertex, that of a beginning which is
    /// no plane at its own.
    fn rings(&mut self) -> Result<(), WriteError> {
        let begin = &self.body.ends[0];
        let places: Vec<[f64; 2]> = self.body.rest.iter().map(|segment| segment.from).chain([begin.from]).collect();
        let [own, seam] = self.ways[0];
        for (k, place) in places.iter().enumerate() {
            let mut angles = vec![seam];
            if k + 1 == places.len() && !is_plane(begin) && own != seam {
                angles.push(own);
                angles.sort_by(f64::total_cmp);
            }
            let mut vertices = Vec::new();
            for angle in &angles {
                let point = self.part.point(self.body.run.at(*place, *angle))?;
                vertices.push((*angle, self.vertex(point)?));
            }
            let mut edges = Vec::new();
            let count = if self.body.run.is_on_axis(*place) { 0 } else { vertices.len() };
            for i in 0..count {
                edges.push(self.path([vertices[i].1, vertices[(i + 1) % vertices.len()].1], *place)?);
            }
            self.rings.push(Ring { vertices, edges });
        }
        Ok(())
    }

    /// Where all spaces of a ring begin (0) or end (1).
    fn end_face(&mut self, segment: &TurnedSegment, end: usize) -> Result<usize, WriteError> {
        let is_begin = end == 0;
        let mut profile: Vec<(Edge, bool)> = self.columns.iter().map(|both| (both[end], is_begin)).collect();
        let (angle, vertex) = (self.ways[0][end], self.rows[0].vertices[end]);
        let ring = if is_begin { self.rings.len() - 1 } else { 0 };
        let mut around = self.around(ring, angle);
        if is_begin {
            around = around.into_iter().rev().map(|(edge, _)| (edge, false)).collect();
        } else {
            profile.reverse();
        }
        let surface = self.surface(segment, angle)?;
        if is_plane(segment) {
            let loops = if segment.from[1].max(segment.to[1]) == if is_begin { segment.to[1] } else { segment.from[1] }
            {
                [profile, around]
            } else {
                [around, profile]
            };
            return self.face(&segment.name, &loops, surface);
        }
        let on_ring = self.vertex_of(ring, angle);
        let ends = if is_begin { [on_ring, vertex] } else { [vertex, on_ring] };
        let seam = self.seam(segment, ends, angle)?;
        let (far, near) = if is_begin { (profile, around) } else { (around, profile) };
        let all = [vec![(seam, true)], far, vec![(seam, false)], near].concat();
        self.face(&segment.name, &[all], surface)
    }

    fn rest_face(&mut self, segment: &TurnedSegment, k: usize) -> Result<usize, WriteError> {
        let angle = self.ways[0][1];
        let surface = self.surface(segment, angle)?;
        let near: Vec<(Edge, bool)> = self.around(k, angle).into_iter().rev().map(|(edge, _)| (edge, false)).collect();
        let far = self.around(k + 1, angle);
        if is_plane(segment) {
            let loops = if segment.to[1] > segment.from[1] { [far, near] } else { [near, far] };
            return self.face(&segment.name, &loops, surface);
        }
        let ends = [self.vertex_of(k, angle), self.vertex_of(k + 1, angle)];
        let seam = self.seam(segment, ends, angle)?;
        let all = [vec![(seam, true)], far, vec![(seam, false)], near].concat();
        self.face(&segment.name, &[all], surface)
    }

    fn vertex_of(&self, ring: usize, angle: f64) -> usize {
        let vertices = &self.rings[ring].vertices;
        vertices.iter().find(|(at, _)| *at == angle).map_or(vertices[0].1, |(_, vertex)| *vertex)
    }

    /// Once around a ring from a vertex, the angle growing.
    fn around(&self, ring: usize, angle: f64) -> Vec<(Edge, bool)> {
        let Ring { vertices, edges } = &self.rings[ring];
        let start = vertices.iter().position(|(at, _)| *at == angle).unwrap_or(0);
        (0..edges.len()).map(|k| (edges[(start + k) % edges.len()], true)).collect()
    }
}

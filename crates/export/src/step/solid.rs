//! The body of a gear as one closed shell whose faces share their edges and vertices.

use std::f64::consts::TAU;
use std::io::Write;

use super::spline::SplineSurface;
use super::{DataSection, knots, numbers, real, text};
use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::solid::PlacedFrame;
use crate::vector::Vector;

/// A line or an arc `[z, rho]` of the outline of a turned blank, the material on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedSegment {
    /// What it is called.
    pub name: String,
    /// Where it begins.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// The centre of an arc.
    pub center: Option<[f64; 2]>,
}

/// A gear: a turned blank with equal tooth spaces.
#[derive(Clone, Debug, PartialEq)]
pub struct GearBody {
    /// What it is called.
    pub name: String,
    /// How many spaces it has.
    pub teeth: usize,
    /// The surfaces of one space in the order of the angle about z, each with its name and a grid of points, row by row, mm: rows across the
    /// space, columns from where it begins to where it ends. Neighbours have a row in common, and all have as many columns.
    pub space: Vec<(String, Vec<Vector>, [usize; 2])>,
    /// Whether the last surface of a space ends in the line where the first one of the next begins: then no tooth has a land of the blank.
    pub has_edge: bool,
    /// The segments of the outline that spaces begin at, leave the blank by, and end at.
    pub ends: [TurnedSegment; 3],
    /// The others, from the end of the spaces round to their beginning.
    pub rest: Vec<TurnedSegment>,
    /// How far the faces are off the exact surfaces at the most, mm.
    pub deviation: f64,
    /// mm³
    pub volume: f64,
    /// mm²
    pub area: f64,
    /// mm
    pub centre: Vector,
}

/// How far the cubic spline through a grid of points, row by row, is off a lattice of the same surface with one more row and column between any
/// two, mm.
///
/// # Panics
/// If there are not `counts[0] · counts[1]` points, and as many between them as there have to be.
#[must_use]
pub fn spline_deviation(points: Vec<Vector>, counts: [usize; 2], doubled: &[Vector]) -> f64 {
    SplineSurface::through(points, counts).off(doubled)
}

/// A gear where it is mounted.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedBody<'b> {
    /// In its own frame.
    pub body: &'b GearBody,
    /// That frame in the one of the assembly.
    pub place: PlacedFrame,
}

/// Writes a gear as one STEP AP242 file, mm: a `MANIFOLD_SOLID_BREP` whose edges are splines that both their faces have, with volume, area
/// and centre as geometric validation properties (CAx-IF recommended practices, version 4.3). The same body gives the same bytes.
///
/// # Errors
/// When the stream refuses.
pub fn write_step_body(header: &Header, body: &GearBody, out: &mut dyn Write) -> Result<(), WriteError> {
    super::write_head(header, &[told(body)], out)?;
    let mut part = DataSection { out, last: 0 };
    part.product_of_body(body)?;
    super::write_end(part.out)
}

/// Writes gears where they are mounted as an assembly in one STEP AP242 file, mm: a product with its `MANIFOLD_SOLID_BREP` for each, and their
/// places in the product that they are parts of.
///
/// # Errors
/// When the stream refuses.
pub fn write_step_assembly(header: &Header, bodies: &[PlacedBody<'_>], out: &mut dyn Write) -> Result<(), WriteError> {
    let told: Vec<String> = bodies.iter().map(|placed| told(placed.body)).collect();
    super::write_head(header, &told, out)?;
    let mut part = DataSection { out, last: 0 };
    let [product, shape] = part.product_and_shape(&header.job)?;
    let (context, _) = part.units_of(LEAST_UNCERTAINTY)?;
    let own = part.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])?;
    let mut places = Vec::new();
    for PlacedBody { place: PlacedFrame { origin, axes }, .. } in bodies {
        places.push(part.placement(*origin, axes[2], axes[0])?);
    }
    let items = numbers(&[&[own][..], &places].concat());
    let whole = part.add(&format!("SHAPE_REPRESENTATION({},{items},#{context})", text(&header.job)))?;
    part.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{whole})"))?;
    for (k, (placed, place)) in bodies.iter().zip(places).enumerate() {
        let BodyProduct { definition, place: from, representation } = part.product_of_body(placed.body)?;
        let name = text(&placed.body.name);
        let usage = format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('{}',{name},'',#{product},#{definition},$)", k + 1);
        let usage = part.add(&usage)?;
        let shape = part.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{usage})"))?;
        let moved = part.add(&format!("ITEM_DEFINED_TRANSFORMATION('','',#{from},#{place})"))?;
        let related = part.add(&format!(
            "(REPRESENTATION_RELATIONSHIP('','',#{representation},#{whole})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{moved})SHAPE_REPRESENTATION_RELATIONSHIP())"
        ))?;
        part.add(&format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{related},#{shape})"))?;
    }
    super::write_end(part.out)
}

/// What a body is and how far its faces are off, in one line.
fn told(body: &GearBody) -> String {
    format!(
        "`{}`: {} spaces of {} faces, off by at most {:.2e} um; volume {:.4} mm3",
        body.name,
        body.teeth,
        body.space.len(),
        1e3 * body.deviation,
        body.volume
    )
}

/// A product that is a body.
struct BodyProduct {
    definition: usize,
    place: usize,
    representation: usize,
}

/// What readers take for one point at the least, mm.
const LEAST_UNCERTAINTY: f64 = 1e-7;

impl DataSection<'_> {
    fn product_of_body(&mut self, body: &GearBody) -> Result<BodyProduct, WriteError> {
        let [definition, shape] = self.product_and_shape(&body.name)?;
        let (context, length) = self.units_of(body.deviation.max(LEAST_UNCERTAINTY))?;
        let faces = Shell::new(self, body)?.faces()?;
        let shell = self.add(&format!("CLOSED_SHELL('',{})", numbers(&faces)))?;
        let name = text(&body.name);
        let solid = self.add(&format!("MANIFOLD_SOLID_BREP({name},#{shell})"))?;
        let place = self.placement([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])?;
        let made = format!("ADVANCED_BREP_SHAPE_REPRESENTATION({name},(#{place},#{solid}),#{context})");
        let representation = self.add(&made)?;
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"))?;
        self.validation(definition, (context, length), body)?;
        Ok(BodyProduct { definition, place, representation })
    }

    fn direction(&mut self, [x, y, z]: Vector) -> Result<usize, WriteError> {
        self.add(&format!("DIRECTION('',({},{},{}))", real(x), real(y), real(z)))
    }

    fn placement(&mut self, origin: Vector, axis: Vector, reference: Vector) -> Result<usize, WriteError> {
        let origin = self.point(origin)?;
        let [axis, reference] = [self.direction(axis)?, self.direction(reference)?];
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{origin},#{axis},#{reference})"))
    }

    fn validation(
        &mut self,
        product: usize,
        (context, length): (usize, usize),
        body: &GearBody,
    ) -> Result<(), WriteError> {
        let unit = |part: &mut Self, power: &str| {
            let element = part.add(&format!("DERIVED_UNIT_ELEMENT(#{length},{power})"))?;
            part.add(&format!("DERIVED_UNIT((#{element}))"))
        };
        let [square, cube] = [unit(self, "2.")?, unit(self, "3.")?];
        let volume =
            format!("MEASURE_REPRESENTATION_ITEM('volume measure',VOLUME_MEASURE({}),#{cube})", real(body.volume));
        let area =
            format!("MEASURE_REPRESENTATION_ITEM('surface area measure',AREA_MEASURE({}),#{square})", real(body.area));
        let [x, y, z] = body.centre.map(real);
        let centre = format!("CARTESIAN_POINT('centre point',({x},{y},{z}))");
        for (what, item) in [("volume", volume), ("surface area", area), ("centroid", centre)] {
            let property =
                self.add(&format!("PROPERTY_DEFINITION('geometric validation property','{what}',#{product})"))?;
            let item = self.add(&item)?;
            let value = self.add(&format!("REPRESENTATION('{what}',(#{item}),#{context})"))?;
            self.add(&format!("PROPERTY_DEFINITION_REPRESENTATION(#{property},#{value})"))?;
        }
        Ok(())
    }
}

/// An edge with its vertices.
#[derive(Clone, Copy)]
struct Edge(usize);

/// A circle of the blank: its vertices by angle, and the edges that follow them.
struct Ring {
    vertices: Vec<(f64, usize)>,
    edges: Vec<Edge>,
}

/// The edges and vertices of a gear, each once.
struct Shell<'p, 'w, 'b> {
    part: &'p mut DataSection<'w>,
    body: &'b GearBody,
    splines: Vec<SplineSurface>,
    /// Of each space the lines between its surfaces, the first and the last at the tip.
    rows: Vec<Vec<Edge>>,
    /// Of each space and surface the edges at its beginning and at its end.
    columns: Vec<Vec<[Edge; 2]>>,
    /// From each space to the next, at the beginning and at the end.
    tips: Vec<[Edge; 2]>,
    /// The vertices of the first space's first line.
    first: [(f64, usize); 2],
    /// At the corners of the rest of the outline, from the end of the spaces on.
    rings: Vec<Ring>,
    poles: Vec<Vec<Vec<usize>>>,
}

fn turned([x, y, z]: Vector, by: f64) -> Vector {
    let (sin, cos) = by.sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

fn at([z, rho]: [f64; 2], angle: f64) -> Vector {
    [rho * angle.cos(), rho * angle.sin(), z]
}

impl<'p, 'w, 'b> Shell<'p, 'w, 'b> {
    fn new(part: &'p mut DataSection<'w>, body: &'b GearBody) -> Result<Shell<'p, 'w, 'b>, WriteError> {
        let splines =
            body.space.iter().map(|(_, points, counts)| SplineSurface::through(points.clone(), *counts)).collect();
        let mut shell = Shell {
            part,
            body,
            splines,
            rows: Vec::new(),
            columns: Vec::new(),
            tips: Vec::new(),
            first: [(0.0, 0); 2],
            rings: Vec::new(),
            poles: Vec::new(),
        };
        shell.spaces()?;
        shell.rings()?;
        Ok(shell)
    }

    fn vertex(&mut self, point: usize) -> Result<usize, WriteError> {
        self.part.add(&format!("VERTEX_POINT('',#{point})"))
    }

    fn edge(&mut self, [from, to]: [usize; 2], curve: usize) -> Result<Edge, WriteError> {
        Ok(Edge(self.part.add(&format!("EDGE_CURVE('',#{from},#{to},#{curve},.T.)"))?))
    }

    fn spline_edge(&mut self, vertices: [usize; 2], poles: &[usize], of: (usize, usize)) -> Result<Edge, WriteError> {
        let direction = &self.splines[of.0].directions[of.1];
        let (counts, values) = knots(direction);
        let curve = format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{},{},.UNSPECIFIED.,.F.,.F.,{counts},{values},.UNSPECIFIED.)",
            direction.degree,
            numbers(poles)
        );
        let curve = self.part.add(&curve)?;
        self.edge(vertices, curve)
    }

    /// Part of a circle about the axis.
    fn arc(&mut self, vertices: [usize; 2], [z, rho]: [f64; 2]) -> Result<Edge, WriteError> {
        let place = self.part.placement([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])?;
        let circle = self.part.add(&format!("CIRCLE('',#{place},{})", real(rho)))?;
        self.edge(vertices, circle)
    }

    /// Points, vertices and edges of all spaces.
    fn spaces(&mut self) -> Result<(), WriteError> {
        let count = self.splines.len();
        let mut corners: Vec<[[usize; 2]; 2]> = Vec::new();
        for tooth in 0..self.body.teeth {
            let poles = self.poles_of(tooth)?;
            // where teeth end in an edge, it is one line of both spaces
            let before =
                corners.last().filter(|_| self.body.has_edge).map(|[_, last]| (self.rows[tooth - 1][count], *last));
            let is_last = self.body.has_edge && tooth + 1 == self.body.teeth;
            let behind = corners.first().filter(|_| is_last).map(|[first, _]| (self.rows[0][0], *first));
            let (mut rows, mut vertices) = (Vec::new(), Vec::new());
            for k in 0..=count {
                let there = if k == 0 { before } else { behind.filter(|_| k == count) };
                let (row, ends) = match there {
                    Some(there) => there,
                    None => self.row(&poles, k)?,
                };
                rows.push(row);
                vertices.push(ends);
            }
            let columns = self.splines[0].directions[1].count;
            let mut sides = Vec::new();
            for k in 0..count {
                let mut both = [Edge(0); 2];
                for (end, column) in [0, columns - 1].into_iter().enumerate() {
                    let line: Vec<usize> = poles[k].iter().skip(column).step_by(columns).copied().collect();
                    both[end] = self.spline_edge([vertices[k][end], vertices[k + 1][end]], &line, (k, 0))?;
                }
                sides.push(both);
            }
            if tooth == 0 {
                let points = &self.body.space[0].1;
                let angle = |[x, y, _]: Vector| y.atan2(x);
                self.first = [(angle(points[0]), vertices[0][0]), (angle(points[columns - 1]), vertices[0][1])];
            }
            corners.push([vertices[0], vertices[count]]);
            self.rows.push(rows);
            self.columns.push(sides);
            self.poles.push(poles);
        }
        if self.body.has_edge {
            return Ok(());
        }
        let tip = &self.body.ends[1];
        for tooth in 0..self.body.teeth {
            let next = corners[(tooth + 1) % self.body.teeth][0];
            let own = corners[tooth][1];
            let both = [self.arc([own[0], next[0]], tip.from)?, self.arc([own[1], next[1]], tip.to)?];
            self.tips.push(both);
        }
        Ok(())
    }

    /// The poles of a space's surfaces as points: a row that two have in common is there once.
    fn poles_of(&mut self, tooth: usize) -> Result<Vec<Vec<usize>>, WriteError> {
        let angle = TAU / self.body.teeth as f64 * tooth as f64;
        let columns = self.splines[0].directions[1].count;
        let is_last = self.body.has_edge && tooth > 0 && tooth + 1 == self.body.teeth;
        let mut all: Vec<Vec<usize>> = Vec::new();
        for k in 0..self.splines.len() {
            let before = match all.last() {
                Some(before) => Some(before),
                None => self.poles.last().filter(|_| self.body.has_edge).and_then(|space| space.last()),
            };
            let mut points: Vec<usize> = before.map_or(Vec::new(), |before| before[before.len() - columns..].to_vec());
            let behind = is_last && k + 1 == self.splines.len();
            let own = self.splines[k].poles.len() - if behind { columns } else { 0 };
            for at in points.len()..own {
                let pole = turned(self.splines[k].poles[at], angle);
                points.push(self.part.point(pole)?);
            }
            if behind {
                points.extend_from_slice(&self.poles[0][0][..columns]);
            }
            all.push(points);
        }
        Ok(all)
    }

    /// The line between a surface of a space and the one before, with its vertices.
    fn row(&mut self, poles: &[Vec<usize>], k: usize) -> Result<(Edge, [usize; 2]), WriteError> {
        let columns = self.splines[0].directions[1].count;
        let line = match k.checked_sub(1) {
            None => poles[0][..columns].to_vec(),
            Some(before) => poles[before][poles[before].len() - columns..].to_vec(),
        };
        let ends = [self.vertex(line[0])?, self.vertex(line[columns - 1])?];
        Ok((self.spline_edge(ends, &line, (k.min(self.splines.len() - 1), 1))?, ends))
    }

    /// The circles of the rest of the outline. Seams of the rest lie at the angle of the end's first vertex, that of a beginning which is
    /// no plane at its own.
    fn rings(&mut self) -> Result<(), WriteError> {
        let begin = &self.body.ends[0];
        let places: Vec<[f64; 2]> = self.body.rest.iter().map(|segment| segment.from).chain([begin.from]).collect();
        let [(own, _), (seam, _)] = self.first;
        for (k, place) in places.iter().enumerate() {
            let mut angles = vec![seam];
            if k + 1 == places.len() && !is_plane(begin) && own != seam {
                angles.push(own);
                angles.sort_by(f64::total_cmp);
            }
            let mut vertices = Vec::new();
            for angle in &angles {
                let point = self.part.point(at(*place, *angle))?;
                vertices.push((*angle, self.vertex(point)?));
            }
            let mut edges = Vec::new();
            for i in 0..vertices.len() {
                edges.push(self.arc([vertices[i].1, vertices[(i + 1) % vertices.len()].1], *place)?);
            }
            self.rings.push(Ring { vertices, edges });
        }
        Ok(())
    }

    fn faces(mut self) -> Result<Vec<usize>, WriteError> {
        let mut faces = Vec::new();
        for tooth in 0..self.body.teeth {
            for k in 0..self.splines.len() {
                faces.push(self.chart_face(tooth, k)?);
            }
        }
        let [begin, tip, end] = self.body.ends.clone();
        let mut land = None;
        for tooth in 0..self.tips.len() {
            // all lands lie on one surface of revolution
            let surface = match land {
                Some(surface) => surface,
                None => self.surface(&tip, self.first[0].0)?,
            };
            land = Some(surface);
            let next = (tooth + 1) % self.body.teeth;
            let own = *self.rows[tooth].last().expect("a line at the tip");
            let [at_begin, at_end] = self.tips[tooth];
            let sides = [(own, true), (at_end, true), (self.rows[next][0], false), (at_begin, false)];
            faces.push(self.face(&tip.name, &[sides.to_vec()], surface)?);
        }
        faces.push(self.end_face(&begin, 0)?);
        faces.push(self.end_face(&end, 1)?);
        for (k, segment) in self.body.rest.iter().enumerate() {
            faces.push(self.rest_face(segment, k)?);
        }
        Ok(faces)
    }

    /// A face within loops that run anticlockwise about its outward normal.
    fn face(
        &mut self,
        name: &str,
        loops: &[Vec<(Edge, bool)>],
        (surface, sense): (usize, bool),
    ) -> Result<usize, WriteError> {
        let letter = |is: bool| if is { ".T." } else { ".F." };
        let mut bounds = Vec::new();
        for (k, edges) in loops.iter().enumerate() {
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

    fn chart_face(&mut self, tooth: usize, k: usize) -> Result<usize, WriteError> {
        let name = &self.body.space[k].0;
        let surface = self.part.spline_surface(name, &self.splines[k], &self.poles[tooth][k])?;
        let [at_begin, at_end] = self.columns[tooth][k];
        let sides = [(self.rows[tooth][k], true), (at_end, true), (self.rows[tooth][k + 1], false), (at_begin, false)];
        // across by along points into the body, as the angle by the outline does that has the material on its left
        self.face(name, &[sides.to_vec()], (surface, false))
    }

    /// Where all spaces begin (0) or end (1).
    fn end_face(&mut self, segment: &TurnedSegment, end: usize) -> Result<usize, WriteError> {
        let is_begin = end == 0;
        let mut profile = Vec::new();
        for tooth in 0..self.body.teeth {
            profile.extend(self.columns[tooth].iter().map(|ends| (ends[end], is_begin)));
            profile.extend(self.tips.get(tooth).map(|ends| (ends[end], is_begin)));
        }
        let (angle, vertex) = self.first[end];
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
        let angle = self.first[1].0;
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

    /// The segment itself, in the half plane at an angle.
    fn seam(&mut self, segment: &TurnedSegment, vertices: [usize; 2], angle: f64) -> Result<Edge, WriteError> {
        let [from, to] = [segment.from, segment.to];
        let curve = match segment.center {
            None => {
                let [a, b] = [at(from, angle), at(to, angle)];
                let along = crate::vector::sub(b, a);
                let length = crate::vector::length(along);
                let (point, direction) = (self.part.point(a)?, self.part.direction(along.map(|x| x / length))?);
                let vector = self.part.add(&format!("VECTOR('',#{direction},1.)"))?;
                self.part.add(&format!("LINE('',#{point},#{vector})"))?
            }
            Some(center) => {
                let [out, to] = [from, to].map(|end| [end[0] - center[0], end[1] - center[1]]);
                let radius = out[0].hypot(out[1]);
                let turn = (out[0] * to[1] - out[1] * to[0]).signum();
                // z by rho is minus the direction of the angle
                let axis = [turn * angle.sin(), -turn * angle.cos(), 0.0];
                let reference = at([out[0] / radius, out[1] / radius], angle);
                let place = self.part.placement(at(center, angle), axis, reference)?;
                self.part.add(&format!("CIRCLE('',#{place},{})", real(radius)))?
            }
        };
        self.edge(vertices, curve)
    }

    /// The surface that a segment turns out, its seam at an angle, and whether its own normal points out of the body.
    fn surface(&mut self, segment: &TurnedSegment, seam: f64) -> Result<(usize, bool), WriteError> {
        let [from, to] = [segment.from, segment.to];
        let (dz, drho) = (to[0] - from[0], to[1] - from[1]);
        let up = [0.0, 0.0, 1.0];
        let reference = [seam.cos(), seam.sin(), 0.0];
        let on_axis = |z: f64| [0.0, 0.0, z];
        if let Some(center) = segment.center {
            let out = [from[0] - center[0], from[1] - center[1]];
            let radius = real(out[0].hypot(out[1]));
            let place = self.part.placement(on_axis(center[0]), up, reference)?;
            // an arc that turns left bulges out of the material
            let is_outward = out[0] * (to[1] - center[1]) - out[1] * (to[0] - center[0]) > 0.0;
            let surface = if center[1] == 0.0 {
                format!("SPHERICAL_SURFACE('',#{place},{radius})")
            } else {
                format!("TOROIDAL_SURFACE('',#{place},{},{radius})", real(center[1]))
            };
            return Ok((self.part.add(&surface)?, is_outward));
        }
        // outside is on the right
        if is_plane(segment) {
            let place = self.part.placement(on_axis(from[0]), up, reference)?;
            return Ok((self.part.add(&format!("PLANE('',#{place})"))?, drho > 0.0));
        }
        if drho == 0.0 {
            let place = self.part.placement(on_axis(from[0]), up, reference)?;
            return Ok((self.part.add(&format!("CYLINDRICAL_SURFACE('',#{place},{})", real(from[1])))?, dz < 0.0));
        }
        // the radius of a cone grows along its axis
        let axis = [0.0, 0.0, (drho / dz).signum()];
        let place = self.part.placement(on_axis(from[0]), axis, reference)?;
        let half = (drho / dz).abs().atan();
        let cone = format!("CONICAL_SURFACE('',#{place},{},{})", real(from[1]), real(half));
        Ok((self.part.add(&cone)?, dz < 0.0))
    }
}

fn is_plane(segment: &TurnedSegment) -> bool {
    segment.center.is_none() && segment.from[0] == segment.to[0]
}

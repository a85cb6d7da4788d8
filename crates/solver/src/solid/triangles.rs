//! Triangles of a body's closed surface as they are added.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::contact::OutlineSegment;
use crate::solid::arrangement::Polar;
use crate::solid::bands::{BandFace, is_first_diagonal, stitched};
use crate::solid::body::{Body, ON_AXIS, shifted};
use crate::solid::closed::ClosedMesh;
use crate::solid::fineness::Off;
use crate::solid::mesh::{Cells, Tooth};
use crate::solid::section::Layout;

/// Triangles as they are added; a node gets its vertex when it is first asked for.
pub(crate) struct Surface<'b> {
    body: &'b Body,
    layout: &'b Layout,
    cells: &'b Cells,
    /// One, or all.
    teeth: Vec<Tooth>,
    /// Columns of the tooth's block at the tip that are one line, where teeth end in an edge.
    one_at_tip: usize,
    /// Vertices of nodes at places along, then of nodes at places of the rest.
    vertices: [Vec<u32>; 2],
    /// Those on the axis, which all nodes at a place along, or of the rest, have in common.
    on_axis: BTreeMap<[usize; 2], u32>,
    mesh: ClosedMesh,
    /// How far sides lie off the tip, and off the rest of the outline.
    offs: [Off; 2],
}

const NONE: u32 = u32::MAX;

impl<'b> Surface<'b> {
    pub(crate) fn new(body: &'b Body, (layout, cells): (&'b Layout, &'b Cells), teeth: Vec<Tooth>) -> Surface<'b> {
        let [along, rest] = [teeth[0].places.len(), teeth[0].rest.len()];
        let vertices = [vec![NONE; cells.count() * along], vec![NONE; cells.count() * rest]];
        let mesh = ClosedMesh { vertices: Vec::new(), triangles: Vec::new() };
        let one_at_tip = if body.has_edge { layout.tooth + 1 } else { 0 };
        let (on_axis, offs) = (BTreeMap::new(), Default::default());
        Surface { body, layout, cells, teeth, one_at_tip, vertices, on_axis, mesh, offs }
    }

    /// The mesh, and how far sides lie off the tip and off the rest of the outline.
    pub(crate) fn finished(self) -> (ClosedMesh, [Off; 2]) {
        (self.mesh.turned_outwards(), self.offs)
    }

    fn tooth(&self, number: usize) -> &Tooth {
        let first = if self.cells.is_before { self.teeth.len() - 1 } else { 0 };
        &self.teeth[(first + number) % self.teeth.len()]
    }

    fn is_on_axis(&self, [_, rho, _]: Polar) -> bool {
        self.body.arrangement().is_closed() && rho.abs() < ON_AXIS
    }

    fn place(&self, (node, j): (usize, usize)) -> Polar {
        let (tooth, own) = self.cells.of(node);
        self.tooth(tooth).places[j][own]
    }

    fn vertex(&mut self, (node, j): (usize, usize)) -> u32 {
        let (tooth, own) = self.cells.of(node);
        let node = if own < self.one_at_tip { node - own } else { node };
        let place = self.place((node, j));
        let slot = node * self.teeth[0].places.len() + j;
        self.numbered([0, slot, j], tooth, place)
    }

    /// The vertex of a node below at a place of the rest of the outline; the first and what follows the last are those of the ends.
    fn vertex_of_rest(&mut self, node: usize, k: usize) -> u32 {
        if k == 0 {
            return self.vertex((node, self.teeth[0].places.len() - 1));
        }
        let count = self.teeth[0].rest.len();
        if k == count {
            return self.vertex((node, 0));
        }
        let (tooth, own) = self.cells.of(node);
        let place = self.tooth(tooth).rest[k][own - self.layout.in_rim(self.layout.rim, 0)];
        self.numbered([1, node * count + k, k], tooth, place)
    }

    fn numbered(&mut self, [kind, slot, at]: [usize; 3], tooth: usize, place: Polar) -> u32 {
        if self.vertices[kind][slot] == NONE {
            let own = self.mesh.vertices.len() as u32;
            let number = if self.is_on_axis(place) { *self.on_axis.entry([kind, at]).or_insert(own) } else { own };
            if number == own {
                let back = if self.cells.is_before { self.body.way_of(1) } else { 0.0 };
                let place = shifted(place, self.body.way_of(tooth) - back);
                self.mesh.vertices.push(self.body.arrangement.position(place));
            }
            self.vertices[kind][slot] = number;
        }
        self.vertices[kind][slot]
    }

    /// Nothing along the axis: that bounds no body.
    pub(crate) fn quad(&mut self, corners: [(usize, usize); 4]) {
        if corners.iter().all(|corner| self.is_on_axis(self.place(*corner))) {
            return;
        }
        // of diagonals that are as long both sides of a part have the same one
        let rank = corners.map(|(node, j)| (j, self.cells.of(node).1));
        let of_equal = rank[0].min(rank[2]) < rank[1].min(rank[3]);
        let [a, b, c, d] = corners.map(|corner| self.vertex(corner));
        let is_first = is_first_diagonal([a, b, c, d].map(|vertex| self.at(vertex)), of_equal);
        let triangles = if is_first { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        triangles.into_iter().for_each(|triangle| self.add(triangle));
    }

    /// All along the tooth between nodes that follow each other.
    pub(crate) fn band(&mut self, face: BandFace, nodes: &[usize]) {
        let body = self.body;
        if face == BandFace::Tip && self.one_at_tip > 0 {
            return;
        }
        for j in 1..self.teeth[0].places.len() {
            if face == BandFace::Chart {
                nodes.windows(2).for_each(|of| self.quad([(of[0], j - 1), (of[1], j - 1), (of[1], j), (of[0], j)]));
                continue;
            }
            if nodes.iter().all(|node| [j - 1, j].iter().all(|j| self.is_on_axis(self.place((*node, *j))))) {
                continue;
            }
            let lines = [j - 1, j].map(|j| nodes.iter().map(|node| self.vertex((*node, j))).collect::<Vec<u32>>());
            match face {
                BandFace::Tip => self.stitch(lines, 0, &[body.blank().bounds()[1]]),
                _ => self.stitch(lines, 1, &body.blank().rest()),
            }
        }
    }

    /// All around the rest of the outline, in rings from one of its places to the next. Columns of nodes go straight on from where the spaces begin,
    /// and join those that lie nearest where the spaces end, however far these have wound.
    pub(crate) fn rings(&mut self) {
        let (body, layout, count) = (self.body, self.layout, self.teeth[0].rest.len());
        let columns = self.cells.teeth * layout.width();
        let node = |of: usize| {
            let (tooth, column) = (of / layout.width() % self.cells.teeth, of % layout.width());
            self.cells.number(layout, tooth, layout.in_rim(layout.rim, column))
        };
        let nodes: Vec<usize> = (0..columns).map(node).collect();
        let rest = body.blank().rest();
        for k in 0..count {
            if self.is_along_axis(k) {
                continue;
            }
            let ring = |surface: &mut Surface<'b>, k: usize| {
                nodes.iter().map(|node| surface.vertex_of_rest(*node, k)).collect::<Vec<u32>>()
            };
            let [near, mut far] = [ring(self, k + 1), ring(self, k)];
            let at = |vertex: u32| self.at(vertex);
            let aside = |vertex: u32| {
                let way = |vertex: u32| body.arrangement().place(at(vertex).into())[2];
                (body.arrangement().near(way(vertex), way(near[0])) - way(near[0])).abs()
            };
            let nearest = (0..columns).min_by(|a, b| aside(far[*a]).total_cmp(&aside(far[*b]))).unwrap_or_default();
            far.rotate_left(if k == 0 { nearest } else { 0 });
            let backwards = |ring: Vec<u32>| ring[..1].iter().chain(ring.iter().rev()).copied().collect::<Vec<u32>>();
            self.stitch([near, far].map(backwards), 1, &rest);
        }
    }

    /// Joins two lines of vertices on a face of the blank, and measures how far the sides lie off it.
    fn stitch(&mut self, lines: [Vec<u32>; 2], face: usize, segments: &[&OutlineSegment]) {
        let points = lines.each_ref().map(|line| line.iter().map(|vertex| self.at(*vertex)).collect::<Vec<_>>());
        let arrangement = self.body.arrangement();
        let off = |ends: [[usize; 2]; 2]| {
            let [a, b] = ends.map(|[line, point]| points[line][point]);
            let middle = arrangement.section((0.5 * (a + b)).into());
            let far = segments
                .iter()
                .map(|segment| segment.nearest(middle))
                .map(|[z, rho]| (z - middle[0]).hypot(rho - middle[1]));
            far.fold(f64::INFINITY, f64::min)
        };
        let mut most = Off::default();
        for corners in stitched([&points[0], &points[1]]) {
            for ends in [[corners[0], corners[1]], [corners[1], corners[2]], [corners[2], corners[0]]] {
                let is_across = ends[0][0] == ends[1][0];
                let part = match is_across {
                    true => &mut most.across,
                    false if ends[0][1] == ends[1][1] => &mut most.along,
                    false => &mut most.diagonal,
                };
                *part = part.max(off(ends));
            }
            self.add(corners.map(|[line, point]| lines[line][point]));
        }
        self.offs[face] = self.offs[face].or(most);
    }

    /// Whether the rest of the outline runs along the axis behind one of its places.
    fn is_along_axis(&self, k: usize) -> bool {
        let (tooth, below) = (&self.teeth[0], self.layout.in_rim(self.layout.rim, 0));
        let next = tooth.rest.get(k + 1).map_or(tooth.places[0][below], |places| places[0]);
        self.is_on_axis(tooth.rest[k][0]) && self.is_on_axis(next)
    }

    fn at(&self, vertex: u32) -> Vector3<f64> {
        self.mesh.vertices[vertex as usize].into()
    }

    /// Nothing where corners are the same.
    fn add(&mut self, [a, b, c]: [u32; 3]) {
        if a != b && b != c && c != a {
            self.mesh.triangles.push([a, b, c]);
        }
    }
}

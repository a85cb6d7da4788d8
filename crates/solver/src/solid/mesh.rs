//! The closed surface of a body as triangles that share their corners.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use crate::contact::OutlineSegment;
use crate::solid::arrangement::{Arrangement, Polar};
use crate::solid::body::{Body, ON_AXIS, shifted};
use crate::solid::section::{Fineness, Layout};

/// Cells of a chart in one direction at the most.
const MOST_CELLS: usize = 256;
/// A body whose beginning and end are turned by less than this against each other is straight.
const STRAIGHT: f64 = 1e-9;

/// What of a body is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyPart {
    /// All of it.
    Gear,
    /// One tooth, from the middle of a space to the middle of the next.
    Tooth,
    /// One space, from the middle of a tooth to the middle of the next.
    Space,
}

/// A closed surface of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    /// The corners, mm, each once.
    pub vertices: Vec<[f64; 3]>,
    /// Each as three vertices, anticlockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The cells of a part in a section: each with its tooth, and the nodes of all teeth numbered one after the other.
pub(crate) struct Cells {
    /// Whether the first tooth is the one before the first space, and not the one behind it.
    is_before: bool,
    /// Nodes of one tooth.
    nodes: usize,
    /// Teeth that the nodes are of.
    teeth: usize,
    pub(crate) cells: Vec<[usize; 4]>,
}

impl Cells {
    pub(crate) fn new(body: &Body, part: BodyPart, layout: &Layout) -> Cells {
        let own = layout.cells();
        let nodes = layout.nodes();
        let all = body.teeth() as usize;
        let is_closed = body.arrangement().is_closed();
        let teeth = match part {
            BodyPart::Gear => all,
            BodyPart::Tooth => 1,
            BodyPart::Space => 2,
        };
        // a node on the far side of a tooth is one of the next tooth
        let last = layout.width();
        let next: Vec<(usize, usize)> =
            (0..=layout.rim).map(|row| (layout.in_rim(row, last), layout.in_rim(row, 0))).collect();
        let number = |tooth: usize, node: usize| match next.iter().find(|(far, _)| *far == node) {
            Some((_, near))
                if (part == BodyPart::Gear && is_closed) || (part != BodyPart::Tooth && tooth + 1 < teeth) =>
            {
                (tooth + 1) % teeth * nodes + near
            }
            _ => tooth * nodes + node,
        };
        let is_wanted = |tooth: usize, cell: &[usize; 4]| {
            part != BodyPart::Space || (tooth == 0) != layout.is_before_middle(cell[0])
        };
        let cells = (0..teeth).flat_map(|tooth| {
            let wanted = own.iter().filter(move |cell| is_wanted(tooth, cell));
            wanted.map(move |cell| cell.map(|node| number(tooth, node)))
        });
        Cells { is_before: part == BodyPart::Space, nodes, teeth, cells: cells.collect() }
    }

    /// The tooth of a node, and which node of it.
    pub(crate) fn of(&self, node: usize) -> (usize, usize) {
        (node / self.nodes, node % self.nodes)
    }

    /// How many numbers nodes have.
    pub(crate) fn count(&self) -> usize {
        self.nodes * self.teeth
    }

    /// The sides of cells that no other cell has, the cell on their left.
    pub(crate) fn border(&self) -> Vec<[usize; 2]> {
        let sides = || self.cells.iter().flat_map(|cell| (0..4).map(move |k| [cell[k], cell[(k + 1) % 4]]));
        let all: BTreeSet<[usize; 2]> = sides().collect();
        sides().filter(|[a, b]| !all.contains(&[*b, *a])).collect()
    }
}

/// Where the rest of the outline is cut into cells: its places `[z, rho]` from the end of the spaces round to their beginning, each
/// with its share of the way.
fn around_rest(body: &Body, twist: f64, fineness: &Fineness) -> Vec<([f64; 2], f64)> {
    let rest = body.blank().rest();
    let whole: f64 = rest.iter().map(|segment| segment.length()).sum();
    let mut before = 0.0;
    let mut places = Vec::new();
    for segment in rest {
        let cells = if segment.center.is_some() { fineness.arc } else { 1 };
        let cells = if twist.abs() > STRAIGHT { cells.max(fineness.along) } else { cells };
        let length = segment.length();
        places.extend((0..cells).map(|k| {
            let share = k as f64 / cells as f64;
            (if k == 0 { segment.from } else { segment.at(share) }, (before + share * length) / whole)
        }));
        before += length;
    }
    places
}

impl Body {
    /// The closed surface of a part, its corners on the exact surfaces.
    pub fn mesh(&self, part: BodyPart, fineness: &Fineness) -> ClosedMesh {
        let layout = Layout::new(fineness);
        let cells = Cells::new(self, part, &layout);
        let teeth: Vec<Tooth> =
            (0..self.distinct()).map(|tooth| Tooth::new(self, tooth, (&layout, fineness))).collect();
        let mut surface = Surface::new(self, (&layout, &cells), teeth);
        for cell in &cells.cells {
            surface.quad(cell.map(|node| (node, fineness.along)));
            let [a, b, c, d] = cell.map(|node| (node, 0));
            surface.quad([a, d, c, b]);
        }
        let has_rings = part == BodyPart::Gear && self.arrangement().is_closed();
        for [a, b] in cells.border() {
            // whole rings have cells of their own; a part has sides, which go on below
            let is_below = [a, b].iter().all(|node| layout.is_below(cells.of(*node).1));
            if is_below && has_rings {
                surface.around_rest([a, b]);
            } else {
                (1..=fineness.along).for_each(|j| surface.quad([(a, j - 1), (b, j - 1), (b, j), (a, j)]));
            }
        }
        surface.mesh.turned_outwards()
    }

    /// So finely that the middles of cells' sides are no farther than `tolerance` (mm) from the exact surfaces.
    pub fn fineness(&self, part: BodyPart, tolerance: f64) -> Fineness {
        let mut charts = vec![2; self.charts().len()];
        let rest = self.blank().rest();
        // diagonals are off along the angle and along the arc
        let arcs = rest.iter().map(|segment| arc_cells(segment, 0.5 * tolerance)).collect::<Vec<usize>>();
        let arc = arcs.iter().copied().max().unwrap_or(1);
        let mut along = (2 * rest.len()).next_power_of_two();
        if !(part == BodyPart::Gear && self.arrangement().is_closed()) {
            // sides of a part have as many cells below as along, and each segment its share
            let whole: f64 = rest.iter().map(|segment| segment.length()).sum();
            let of_all = |(segment, cells): (&&OutlineSegment, &usize)| *cells as f64 * whole / segment.length();
            let needed = rest.iter().zip(&arcs).filter(|(_, cells)| **cells > 1).map(of_all).fold(0.0, f64::max);
            along = along.max(needed.ceil() as usize).next_power_of_two().min(MOST_CELLS);
        }
        for (k, chart) in self.spaces.iter().flat_map(|charts| charts.iter().enumerate()) {
            let count = &mut charts[k];
            let doubled = |cells: usize| (0..=2 * cells).map(|k| k as f64 / (2 * cells) as f64).collect::<Vec<f64>>();
            while *count < MOST_CELLS
                && sag(&chart.lattice(&doubled(*count), &[0.0, 0.5, 1.0]), [2 * *count + 1, 3], 0) > tolerance
            {
                *count *= 2;
            }
            while along < MOST_CELLS
                && sag(&chart.lattice(&[0.0, 0.5, 1.0], &doubled(along)), [3, 2 * along + 1], 1) > tolerance
            {
                along *= 2;
            }
        }
        // the two flanks have as many rows as each other, and so do the fillets beside them
        let last = charts.len() - 1;
        for k in 0..=last / 2 {
            let both = charts[k].max(charts[last - k]);
            (charts[k], charts[last - k]) = (both, both);
        }
        let [line, next] = self.tooth_lines(0, &vec![vec![0.0, 0.5, 1.0]; self.charts().len()], &[0.5]);
        let (tip, land) = (line[0][0][1], next[0][0][2] - line[0][line[0].len() - 1][2]);
        let steps = |rho: f64, angle: f64| match self.arrangement {
            Arrangement::Round => (angle * (rho / (8.0 * tolerance)).sqrt()).ceil() as usize,
            Arrangement::Straight { .. } => 1,
        };
        let widest =
            rest.iter().flat_map(|segment| [0.0, 0.5, 1.0].map(|share| segment.at(share)[1])).fold(0.0, f64::max);
        let of_charts = Layout::new(&Fineness { charts: charts.clone(), tooth: 0, rim: 1, along, arc }).width();
        // twice as many, since they are not even
        let below = (2 * steps(widest, self.pitch())).saturating_sub(of_charts);
        let tooth = steps(tip, land).max(below).max(2).next_multiple_of(2);
        self.fine_ends(Fineness { charts, tooth, rim: 1, along, arc }, tolerance)
    }

    /// Finer until curved ends are near enough.
    fn fine_ends(&self, mut fineness: Fineness, tolerance: f64) -> Fineness {
        loop {
            let EndSag { around, in_teeth, below, diagonal } = self.sag_of_ends(&fineness);
            let down = in_teeth.max(below);
            if around.max(down).max(diagonal) <= tolerance {
                return fineness;
            }
            // a diagonal is as far off as sides of both directions together
            let is_around = around > tolerance || (down <= tolerance && around >= down);
            let finest_chart = fineness.charts.iter().copied().max().unwrap_or_default();
            if is_around && fineness.tooth < MOST_CELLS {
                fineness.tooth *= 2;
            } else if below >= in_teeth && fineness.rim < MOST_CELLS {
                fineness.rim *= 2;
            } else if below < in_teeth && finest_chart < MOST_CELLS {
                fineness.charts.iter_mut().for_each(|cells| *cells *= 2);
            } else {
                return fineness;
            }
        }
    }

    /// How far cells on curved ends lie off these.
    fn sag_of_ends(&self, fineness: &Fineness) -> EndSag {
        let (across, _) = Body::shares_of(fineness);
        let layout = Layout::new(fineness);
        let [lines, next] = self.tooth_lines(0, &across, &[0.0, 0.5, 1.0]);
        let arrangement = self.arrangement;
        let shares = layout.shares(&layout.top([&lines[1], &next[1]]), arrangement);
        let [begin, _, end] = self.blank().bounds();
        let mut most = EndSag::default();
        for (j, segment, below) in [(0, begin, begin.from), (2, end, end.to)] {
            if segment.center.is_none() && segment.from[0] == segment.to[0] {
                continue;
            }
            let places = layout.places([&lines[j], &next[j]], below, &shares);
            let sag = |a: usize, b: usize| {
                let [p, q] = [places[a], places[b]].map(|place| on_end(segment, place));
                let middle = on_end(segment, [0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
                let [p, q, middle] = [p, q, middle].map(|place| Vector3::from(arrangement.position(place)));
                (0.5 * (p + q) - middle).norm()
            };
            for [a, b, c, d] in layout.cells() {
                most.around = most.around.max(sag(a, b)).max(sag(d, c));
                let down = if layout.is_in_rim(a) { &mut most.below } else { &mut most.in_teeth };
                *down = down.max(sag(a, d)).max(sag(b, c));
                if segment.center.is_some() {
                    most.diagonal = most.diagonal.max(sag(a, c)).max(sag(b, d));
                }
            }
        }
        most
    }
}

/// How far the sides of cells on curved ends lie off these in their middles, mm.
#[derive(Default)]
struct EndSag {
    /// Along the angle.
    around: f64,
    /// From the tip to where the block below begins.
    in_teeth: f64,
    /// From there to the rest of the outline.
    below: f64,
    /// Of cells on arcs.
    diagonal: f64,
}

/// A place of an end: what lies between places of an arc is brought to it.
fn on_end(segment: &OutlineSegment, place: Polar) -> Polar {
    let [z, rho] = if segment.center.is_some() { segment.nearest([place[0], place[1]]) } else { [place[0], place[1]] };
    [z, rho, place[2]]
}

/// Cells along a segment whose middles are no farther from it, mm.
fn arc_cells(segment: &OutlineSegment, tolerance: f64) -> usize {
    let Some(center) = segment.center else { return 1 };
    let radius = (segment.from[0] - center[0]).hypot(segment.from[1] - center[1]);
    let most = 2.0 * (1.0 - tolerance / radius).max(0.0).acos();
    ((segment.length() / radius / most).ceil() as usize).max(1)
}

/// How far points between two others lie off their chord, in one direction of a lattice of doubled fineness.
fn sag(points: &[[f64; 3]], [rows, columns]: [usize; 2], direction: usize) -> f64 {
    let step = if direction == 0 { columns } else { 1 };
    let mut most: f64 = 0.0;
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let along = if direction == 0 { i } else { j };
        if along.is_multiple_of(2) {
            continue;
        }
        let at = i * columns + j;
        let off = [0, 1, 2].map(|k| points[at][k] - 0.5 * (points[at - step][k] + points[at + step][k]));
        most = most.max(off.iter().map(|x| x * x).sum::<f64>().sqrt());
    }
    most
}

/// Where the nodes of a tooth lie.
struct Tooth {
    /// At each place along.
    places: Vec<Vec<Polar>>,
    /// Those on the rest of the outline, at the places of which it consists.
    rest: Vec<Vec<Polar>>,
}

impl Tooth {
    fn new(body: &Body, tooth: usize, (layout, fineness): (&Layout, &Fineness)) -> Tooth {
        let (across, along) = Body::shares_of(fineness);
        let [lines, next] = body.tooth_lines(tooth, &across, &along);
        let (half, last) = (lines.len() / 2, lines.len() - 1);
        let shares = layout.shares(&layout.top([&lines[half], &next[half]]), body.arrangement());
        let below = body.blank().below(last);
        let mut places: Vec<Vec<Polar>> =
            (0..=last).map(|j| layout.places([&lines[j], &next[j]], below[j], &shares)).collect();
        let [begin, _, end] = body.blank().bounds();
        for (nodes, segment) in [(0, begin), (last, end)] {
            places[nodes].iter_mut().for_each(|place| *place = on_end(segment, *place));
        }
        let middles = |j: usize| [lines[j][layout.middle][2], next[j][layout.middle][2]];
        let (from, to) = (middles(last), middles(0));
        let rest = around_rest(body, to[0] - from[0], fineness).into_iter().map(|([z, rho], share)| {
            let [start, end] = [0, 1].map(|k| (1.0 - share) * from[k] + share * to[k]);
            shares.iter().map(|along| [z, rho, start + along * (end - start)]).collect()
        });
        Tooth { rest: rest.collect(), places }
    }
}

/// Triangles as they are added; a node gets its vertex when it is first asked for.
struct Surface<'b> {
    body: &'b Body,
    cells: &'b Cells,
    /// One, or all.
    teeth: Vec<Tooth>,
    first_below: usize,
    /// Columns of the tooth's block at the tip that are one line, where teeth end in an edge.
    one_at_tip: usize,
    /// Vertices of nodes at places along, then of nodes at places of the rest.
    vertices: [Vec<u32>; 2],
    /// Those on the axis, which all nodes at a place along, or of the rest, have in common.
    on_axis: BTreeMap<[usize; 2], u32>,
    mesh: ClosedMesh,
}

const NONE: u32 = u32::MAX;

impl<'b> Surface<'b> {
    fn new(body: &'b Body, (layout, cells): (&Layout, &'b Cells), teeth: Vec<Tooth>) -> Surface<'b> {
        let [along, rest] = [teeth[0].places.len(), teeth[0].rest.len()];
        let vertices = [vec![NONE; cells.count() * along], vec![NONE; cells.count() * rest]];
        let mesh = ClosedMesh { vertices: Vec::new(), triangles: Vec::new() };
        let one_at_tip = if body.has_edge { layout.tooth + 1 } else { 0 };
        let first_below = layout.in_rim(layout.rim, 0);
        let on_axis = BTreeMap::new();
        Surface { body, cells, teeth, first_below, one_at_tip, vertices, on_axis, mesh }
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
        let place = self.tooth(tooth).rest[k][own - self.first_below];
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
    fn quad(&mut self, corners: [(usize, usize); 4]) {
        if corners.iter().all(|corner| self.is_on_axis(self.place(*corner))) {
            return;
        }
        let corners = corners.map(|corner| self.vertex(corner));
        self.split(corners);
    }

    fn around_rest(&mut self, [a, b]: [usize; 2]) {
        let segments: Vec<bool> = (0..self.teeth[0].rest.len()).map(|k| self.is_along_axis(k)).collect();
        for (k, _) in segments.iter().enumerate().filter(|(_, is_along_axis)| !**is_along_axis) {
            let corners = [(a, k + 1), (b, k + 1), (b, k), (a, k)].map(|(node, k)| self.vertex_of_rest(node, k));
            self.split(corners);
        }
    }

    /// Whether the rest of the outline runs along the axis behind one of its places.
    fn is_along_axis(&self, k: usize) -> bool {
        let tooth = &self.teeth[0];
        let next = tooth.rest.get(k + 1).map_or(tooth.places[0][self.first_below], |places| places[0]);
        self.is_on_axis(tooth.rest[k][0]) && self.is_on_axis(next)
    }

    /// Two triangles along the shorter diagonal; one, or none, where corners are the same.
    fn split(&mut self, [a, b, c, d]: [u32; 4]) {
        let at = |vertex: u32| self.mesh.vertices[vertex as usize];
        let squared = |p: u32, q: u32| [0, 1, 2].map(|k| at(p)[k] - at(q)[k]).iter().map(|x| x * x).sum::<f64>();
        let triangles = if squared(a, c) <= squared(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        self.mesh.triangles.extend(triangles.into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
    }
}

impl ClosedMesh {
    /// What it encloses, mm³.
    pub fn volume(&self) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|k| nalgebra::Vector3::from(self.vertices[k as usize]));
        self.triangles.iter().map(corners).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
    }

    /// Its area, mm².
    pub fn area(&self) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|k| nalgebra::Vector3::from(self.vertices[k as usize]));
        self.triangles.iter().map(corners).map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
    }

    /// Vertices less edges plus faces: 2 of a ball, 0 of a ring.
    pub fn euler_characteristic(&self) -> i64 {
        let edges = self.triangles.len() * 3 / 2;
        self.vertices.len() as i64 - edges as i64 + self.triangles.len() as i64
    }

    /// Whether every edge has two triangles that run along it in opposite senses.
    pub fn is_closed(&self) -> bool {
        let sides = self.triangles.iter().flat_map(|t| (0..3).map(move |k| (t[k], t[(k + 1) % 3])));
        let mut all: Vec<(u32, u32)> = sides.collect();
        all.sort_unstable();
        let is_once = all.windows(2).all(|pair| pair[0] != pair[1]);
        is_once && all.iter().all(|(a, b)| all.binary_search(&(*b, *a)).is_ok())
    }

    fn turned_outwards(mut self) -> ClosedMesh {
        if self.volume() < 0.0 {
            self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        self
    }
}

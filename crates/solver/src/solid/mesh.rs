//! The closed surface of a body as triangles that share their corners.

use std::collections::BTreeSet;

use crate::contact::OutlineSegment;
use crate::solid::arrangement::Polar;
use crate::solid::bands::{Band, BandFace};
use crate::solid::body::Body;
use crate::solid::closed::ClosedMesh;
use crate::solid::fineness::Offs;
use crate::solid::section::{Fineness, Layout};
use crate::solid::triangles::Surface;

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

/// The cells of a part in a section: each with its tooth, and the nodes of all teeth numbered one after the other.
pub(crate) struct Cells {
    /// Whether the first tooth is the one before the first space, and not the one behind it.
    pub(crate) is_before: bool,
    /// Nodes of one tooth.
    nodes: usize,
    /// Teeth that the nodes are of.
    pub(crate) teeth: usize,
    /// Whether the last of them is the neighbour of the first.
    is_ring: bool,
    pub(crate) cells: Vec<[usize; 4]>,
}

impl Cells {
    pub(crate) fn new(body: &Body, part: BodyPart, layout: &Layout) -> Cells {
        let own = layout.cells();
        let teeth = match part {
            BodyPart::Gear => body.teeth() as usize,
            BodyPart::Tooth => 1,
            BodyPart::Space => 2,
        };
        let is_ring = part == BodyPart::Gear && body.arrangement().is_closed();
        let is_before = part == BodyPart::Space;
        let mut cells = Cells { is_before, nodes: layout.nodes(), teeth, is_ring, cells: Vec::new() };
        let is_wanted = |tooth: usize, cell: &[usize; 4]| {
            part != BodyPart::Space || (tooth == 0) != layout.is_before_middle(cell[0])
        };
        cells.cells = (0..teeth)
            .flat_map(|tooth| {
                let wanted = own.iter().filter(move |cell| is_wanted(tooth, cell));
                wanted.map(|cell| cell.map(|node| cells.number(layout, tooth, node))).collect::<Vec<_>>()
            })
            .collect();
        cells
    }

    /// The number of a node of a tooth. One on its far side is a node of the next tooth, if there is one.
    pub(crate) fn number(&self, layout: &Layout, tooth: usize, node: usize) -> usize {
        let row = node.checked_sub(layout.in_rim(0, 0)).filter(|of| of % (layout.width() + 1) == layout.width());
        match row.map(|of| of / (layout.width() + 1)) {
            Some(row) if self.is_ring || tooth + 1 < self.teeth => {
                (tooth + 1) % self.teeth * self.nodes + layout.in_rim(row, 0)
            }
            _ => tooth * self.nodes + node,
        }
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

/// Where the rest of the outline is cut into cells: its places `[z, rho]` from the end of the spaces round to their beginning.
fn around_rest(body: &Body, fineness: &Fineness) -> Vec<[f64; 2]> {
    let of_segment = |segment: &OutlineSegment| {
        let cells = if segment.center.is_some() { fineness.arc } else { 1 };
        let place = |k: usize| if k == 0 { segment.from } else { segment.at(k as f64 / cells as f64) };
        (0..cells).map(place).collect::<Vec<[f64; 2]>>()
    };
    body.blank().rest().into_iter().flat_map(of_segment).collect()
}

impl Body {
    /// The closed surface of a part, its corners on the exact surfaces, so fine that the middles of its sides are no farther than `tolerance` (mm)
    /// from these; and how far they are off.
    ///
    /// # Errors
    /// With how many triangles that would take, if they are more than `most`.
    pub fn mesh(&self, part: BodyPart, tolerance: f64, most: usize) -> Result<(ClosedMesh, f64), usize> {
        let mut fineness = self.fineness(part, tolerance);
        loop {
            let triangles = self.triangles(part, &fineness);
            if triangles > most {
                return Err(triangles);
            }
            let (mesh, offs) = self.meshed(part, &fineness);
            match offs.finer(&fineness, tolerance) {
                Some(finer) => fineness = finer,
                None => return Ok((mesh, offs.most())),
            }
        }
    }

    fn meshed(&self, part: BodyPart, fineness: &Fineness) -> (ClosedMesh, Offs) {
        let layout = Layout::new(fineness);
        let cells = Cells::new(self, part, &layout);
        let teeth: Vec<Tooth> =
            (0..self.distinct()).map(|tooth| Tooth::new(self, (tooth, part), (&layout, fineness))).collect();
        let mut surface = Surface::new(self, (&layout, &cells), teeth);
        for cell in &cells.cells {
            surface.quad(cell.map(|node| (node, fineness.along)));
            let [a, b, c, d] = cell.map(|node| (node, 0));
            surface.quad([a, d, c, b]);
        }
        let has_rings = part == BodyPart::Gear && self.arrangement().is_closed();
        let mut done: BTreeSet<[usize; 2]> = BTreeSet::new();
        for tooth in 0..cells.teeth {
            for Band { face, nodes } in layout.bands(fineness, (part, tooth)) {
                let nodes: Vec<usize> = nodes.into_iter().map(|node| cells.number(&layout, tooth, node)).collect();
                done.extend(nodes.windows(2).map(|pair| [pair[0], pair[1]]));
                // whole rings have cells of their own
                if face != BandFace::Below || !has_rings {
                    surface.band(face, &nodes);
                }
            }
        }
        if has_rings {
            surface.rings();
        }
        // what is left is where a part is cut off
        for [a, b] in cells.border().into_iter().filter(|side| !done.contains(side)) {
            (1..=fineness.along).for_each(|j| surface.quad([(a, j - 1), (b, j - 1), (b, j), (a, j)]));
        }
        let (mesh, [tip, below]) = surface.finished();
        let offs = Offs { charts: self.offs_of_charts(fineness), tip, below, ends: self.off_of_ends(fineness) };
        (mesh, offs)
    }
}

/// Where the nodes of a tooth lie.
pub(crate) struct Tooth {
    /// At each place along.
    pub(crate) places: Vec<Vec<Polar>>,
    /// Those on the rest of the outline, at the places of which it consists.
    pub(crate) rest: Vec<Vec<Polar>>,
}

impl Tooth {
    fn new(body: &Body, (tooth, part): (usize, BodyPart), (layout, fineness): (&Layout, &Fineness)) -> Tooth {
        let (across, along) = Body::shares_of(fineness);
        let [lines, next] = body.tooth_lines(tooth, &across, &along);
        let (half, last) = (lines.len() / 2, lines.len() - 1);
        let shares = layout.shares(&layout.top([&lines[half], &next[half]]), body.arrangement());
        let below = body.blank().below(last);
        let mut places: Vec<Vec<Polar>> =
            (0..=last).map(|j| layout.places([&lines[j], &next[j]], below[j], &shares)).collect();
        if part == BodyPart::Space {
            places.iter_mut().for_each(|nodes| layout.straighten(nodes));
        }
        let [begin, _, end] = body.blank().bounds();
        for (nodes, segment) in [(0, begin), (last, end)] {
            places[nodes].iter_mut().for_each(|place| *place = on_end(segment, *place));
        }
        let columns = &places[0][layout.in_rim(layout.rim, 0)..];
        let ring = |[z, rho]: [f64; 2]| columns.iter().map(|[_, _, way]| [z, rho, *way]).collect();
        Tooth { rest: around_rest(body, fineness).into_iter().map(ring).collect(), places }
    }
}

/// A place of an end: what lies between places of an arc is brought to it.
pub(crate) fn on_end(segment: &OutlineSegment, place: Polar) -> Polar {
    let [z, rho] = if segment.center.is_some() { segment.nearest([place[0], place[1]]) } else { [place[0], place[1]] };
    [z, rho, place[2]]
}

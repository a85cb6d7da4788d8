//! A body cut into bricks for finite elements.
//!
//! A section across a tooth is laid out in blocks of cells (`layout`) and its nodes are placed (`section`); the bricks lie between one section
//! and the next. Of the second order, the lattice of nodes is twice as fine, so that the nodes in the middle of edges lie on the
//! exact surfaces, too.

pub(crate) mod counts;
pub(crate) mod element;
pub(crate) mod layout;
pub(crate) mod quality;
pub(crate) mod section;
pub(crate) mod shaft;
pub(crate) mod skin;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::solid::arrangement::{Arrangement, Polar};
use crate::solid::body::{Body, shifted};
use crate::solid::bricks::counts::{BrickCounts, refined};
use crate::solid::bricks::layout::{Cell, CellSide, Layout};
use crate::solid::bricks::section::Sections;
use crate::solid::bricks::shaft::ShaftLattice;

/// The order of a brick's shape functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrickOrder {
    /// Eight corners.
    First,
    /// Twenty nodes: corners and the middles of edges.
    Second,
}

impl BrickOrder {
    /// Nodes of a brick.
    pub fn nodes(self) -> usize {
        match self {
            BrickOrder::First => 8,
            BrickOrder::Second => 20,
        }
    }

    /// Steps of the lattice of nodes from one corner of a brick to the next.
    pub(crate) fn steps(self) -> usize {
        match self {
            BrickOrder::First => 1,
            BrickOrder::Second => 2,
        }
    }
}

/// What faces of bricks lie on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BrickSide {
    /// A chart of the tooth spaces, by its place in [`Body::charts`].
    Chart(usize),
    /// A segment of the outline, by its place in it.
    Outline(usize),
    /// Where the model is cut through the middle of a space: 0 before its first tooth, 1 behind its last. The nodes of both are the same, turned
    /// by the teeth between.
    Cut(usize),
}

/// Faces of the bricks of one tooth on one side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrickFaces {
    /// What they lie on.
    pub side: BrickSide,
    /// The tooth, from 0.
    pub tooth: usize,
    /// Each as its brick and its face, both from 0. Faces are those of C3D8: 0 holds the first four corners, 1 the last four, 2 to 5 the edges
    /// from the first corner to the second and so on.
    pub faces: Vec<(u32, u8)>,
}

/// Bricks that share their nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickMesh {
    /// The order of all bricks.
    pub order: BrickOrder,
    /// mm, each once.
    pub nodes: Vec<[f64; 3]>,
    /// The nodes of each brick one after the other, as C3D8 and C3D20 have them: corners of one face, those of the face opposite, then the
    /// middles of the edges of the first face, of the second, and between both.
    pub bricks: Vec<u32>,
    /// How many teeth it has; the bricks of one follow those of the other.
    pub teeth: usize,
    /// The outer faces.
    pub faces: Vec<BrickFaces>,
    /// How far faces on charts are off these at the most, mm.
    pub deviation: f64,
}

impl BrickMesh {
    /// How many bricks.
    pub fn len(&self) -> usize {
        self.bricks.len() / self.order.nodes()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bricks.is_empty()
    }

    /// The tooth that a brick is of, from 0.
    pub fn tooth(&self, brick: usize) -> usize {
        brick * self.teeth / self.len()
    }

    /// The nodes of a face of a brick: corners, then of the second order the middles of its edges.
    pub fn face_nodes(&self, (brick, face): (u32, u8)) -> impl Iterator<Item = u32> + '_ {
        let count = self.order.nodes();
        let own = &self.bricks[brick as usize * count..][..count];
        element::FACES[face as usize].iter().filter(move |node| **node < count).map(|node| own[*node])
    }

    /// The nodes of the faces on a side, in rising order.
    pub fn side_nodes(&self, faces: &[&BrickFaces]) -> Vec<u32> {
        let mut nodes: Vec<u32> =
            faces.iter().flat_map(|of| &of.faces).flat_map(|face| self.face_nodes(*face)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

impl Body {
    /// The bricks of so many neighbouring teeth, each from the middle of a space to the middle of the next; of all of them, the whole gear.
    ///
    /// # Panics
    /// If there are no teeth or more than the body has, or `counts` are not those of its charts.
    pub fn bricks(&self, counts: &BrickCounts, order: BrickOrder, teeth: usize) -> BrickMesh {
        assert!((1..=self.teeth() as usize).contains(&teeth), "between one tooth and all");
        let stations = counts.stations(self, order);
        let layout = Layout::new(self, counts, order);
        let places = |tooth: usize| {
            let sections = Sections::new((self, tooth), &layout, counts, &stations);
            (0..stations.sections()).into_par_iter().map(|a| sections.places(a)).collect::<Vec<Vec<Polar>>>()
        };
        let places: Vec<Vec<Vec<Polar>>> = (0..self.distinct().min(teeth)).map(places).collect();
        let is_ring = teeth == self.teeth() as usize && self.arrangement.is_closed();
        let numbers = Numbers::new(&layout, &stations, (teeth, is_ring));
        let nodes = numbers.positions(self, &places);
        let of_teeth = &places[0][stations.before()..];
        let is_forward = is_forward(self.arrangement, layout.cells[0], of_teeth, order.steps());
        let bricks = bricks_of(&layout, &numbers, (counts, is_forward), order);
        let faces = faces_of(self, &layout, (counts, &stations), (teeth, numbers.is_ring), is_forward);
        BrickMesh { order, nodes, bricks, teeth, faces, deviation: skin::deviation(self, &stations, order) }
    }
}

/// Whether the corners of a cell, then those of the next section, are in the order of a brick's.
fn is_forward(arrangement: Arrangement, cell: Cell, places: &[Vec<Polar>], steps: usize) -> bool {
    let corner =
        |section: usize, k: usize| nalgebra::Vector3::from(arrangement.position(places[section][cell.nodes[k]]));
    let from = corner(0, 0);
    let [a, b, c] = [corner(0, 1), corner(0, 3), corner(steps, 0)].map(|to| to - from);
    a.cross(&b).dot(&c) > 0.0
}

/// The numbers of nodes: those of a tooth follow each other, without the ones that it shares with the next tooth.
struct Numbers<'l> {
    layout: &'l Layout,
    /// Of each section and node of the layout the number within its tooth; none of nodes that no brick has.
    own: Vec<Option<u32>>,
    /// Nodes of one tooth.
    of_tooth: usize,
    /// Of each section the number among those on the far side of the last tooth, of nodes that lie there.
    last: BTreeMap<(usize, usize), u32>,
    teeth: usize,
    is_ring: bool,
}

impl<'l> Numbers<'l> {
    fn new(layout: &'l Layout, stations: &Stations, (teeth, is_ring): (usize, bool)) -> Numbers<'l> {
        let sections = stations.sections();
        let (mut own, mut of_tooth, mut last) = (vec![None; sections * layout.nodes], 0, BTreeMap::new());
        for section in 0..sections {
            let is_between = !section.is_multiple_of(layout.steps);
            let is_of_teeth = stations.of_teeth(section).is_some();
            for node in 0..layout.nodes {
                if !layout.is_used(node, is_between) || !(is_of_teeth || layout.is_of_shaft(node)) {
                    continue;
                }
                if layout.twin(node).is_some() {
                    last.insert((section, node), last.len() as u32);
                } else {
                    own[section * layout.nodes + node] = Some(of_tooth);
                    of_tooth += 1;
                }
            }
        }
        Numbers { layout, own, of_tooth: of_tooth as usize, last, teeth, is_ring }
    }

    fn own(&self, section: usize, node: usize) -> u32 {
        self.own[section * self.layout.nodes + node].expect("bricks have used nodes alone")
    }

    fn of(&self, tooth: usize, section: usize, node: usize) -> u32 {
        let base = |tooth: usize| (tooth * self.of_tooth) as u32;
        match self.layout.twin(node) {
            None => base(tooth) + self.own(section, node),
            Some(_) if tooth + 1 == self.teeth && !self.is_ring => base(self.teeth) + self.last[&(section, node)],
            Some(twin) => base((tooth + 1) % self.teeth) + self.own(section, twin),
        }
    }

    /// By the places of each tooth that differs from the first, and of that.
    fn positions(&self, body: &Body, places: &[Vec<Vec<Polar>>]) -> Vec<[f64; 3]> {
        let of = |tooth: usize| &places[tooth % places.len()];
        let is_used = |own: &Option<u32>| own.is_some();
        let used = |places: &Vec<Vec<Polar>>| -> Vec<Polar> {
            places.iter().flatten().zip(&self.own).filter(|(_, own)| is_used(own)).map(|(place, _)| *place).collect()
        };
        let used: Vec<Vec<Polar>> = places.iter().map(used).collect();
        let placed = |place: Polar, tooth: usize| body.arrangement.position(shifted(place, body.way_of(tooth)));
        let mut nodes: Vec<[f64; 3]> = Vec::with_capacity(self.teeth * used[0].len() + self.last.len());
        for tooth in 0..self.teeth {
            nodes.par_extend(used[tooth % used.len()].par_iter().map(|place| placed(*place, tooth)));
        }
        if !self.is_ring {
            let last = self.last.keys().map(|(section, node)| of(self.teeth - 1)[*section][*node]);
            nodes.extend(last.map(|place| placed(place, self.teeth - 1)));
        }
        nodes
    }
}

fn bricks_of(
    layout: &Layout,
    numbers: &Numbers<'_>,
    (counts, is_forward): (&BrickCounts, bool),
    order: BrickOrder,
) -> Vec<u32> {
    let steps = order.steps();
    let brick = |tooth: usize, a: usize, cell: &Cell| {
        let (from, to) = if is_forward { (a * steps, (a + 1) * steps) } else { ((a + 1) * steps, a * steps) };
        let at = move |section: usize, node: usize| numbers.of(tooth, section, node);
        let corners = [from, to].map(|section| [0, 1, 2, 3].map(|k| at(section, cell.nodes[k])));
        let mut nodes = corners.concat();
        if order == BrickOrder::Second {
            for section in [from, to] {
                nodes.extend((4..8).map(|k| at(section, cell.nodes[k])));
            }
            nodes.extend((0..4).map(|k| at(a * steps + 1, cell.nodes[k])));
        }
        nodes
    };
    let layers: Vec<(usize, usize)> =
        (0..numbers.teeth).flat_map(|tooth| (0..counts.layers()).map(move |a| (tooth, a))).collect();
    let layer = |(tooth, a): (usize, usize)| {
        layout
            .cells
            .iter()
            .filter(|cell| counts.has(a, cell))
            .flat_map(|cell| brick(tooth, a, cell))
            .collect::<Vec<u32>>()
    };
    layers.into_par_iter().map(layer).collect::<Vec<Vec<u32>>>().concat()
}

fn faces_of(
    body: &Body,
    layout: &Layout,
    (counts, stations): (&BrickCounts, &Stations),
    (teeth, is_ring): (usize, bool),
    is_forward: bool,
) -> Vec<BrickFaces> {
    let ends = body.blank().ends;
    let shaft = stations.shaft.as_ref();
    let below = stations.below_segments(body, counts);
    let [before, _] = counts.shaft.map_or([0, 0], |shaft| shaft.ends);
    let mut found: BTreeMap<(BrickSide, usize), Vec<(u32, u8)>> = BTreeMap::new();
    let [first, last] = if is_forward { [0, 1] } else { [1, 0] };
    let mut brick = 0;
    for tooth in 0..teeth {
        for (a, below) in below.iter().enumerate() {
            for cell in layout.cells.iter().filter(|cell| counts.has(a, cell)) {
                let mut add = |side, face| found.entry((side, tooth)).or_default().push((brick, face));
                // where teeth end, or a shaft
                let [from, to] = match cell.shaft_row {
                    None => [before, before + counts.along - 1],
                    Some(_) => [0, counts.layers() - 1],
                };
                let end = |side: usize| match (cell.shaft_row, shaft) {
                    (Some(row), Some(shaft)) => shaft.sides[side][row],
                    _ => ends[2 * side],
                };
                if a == from {
                    add(BrickSide::Outline(end(0)), first);
                }
                if a == to {
                    add(BrickSide::Outline(end(1)), last);
                }
                for (k, side) in cell.sides.iter().enumerate() {
                    let side = match side {
                        CellSide::Inner => continue,
                        CellSide::Chart(chart) => BrickSide::Chart(*chart),
                        CellSide::Tip => BrickSide::Outline(ends[1]),
                        CellSide::Below => BrickSide::Outline(*below),
                        CellSide::Above => match shaft.and_then(|shaft| shaft.above(a, counts.along)) {
                            Some(segment) => BrickSide::Outline(segment),
                            None => continue,
                        },
                        CellSide::Before if tooth == 0 && !is_ring => BrickSide::Cut(0),
                        CellSide::Behind if tooth + 1 == teeth && !is_ring => BrickSide::Cut(1),
                        CellSide::Before | CellSide::Behind => continue,
                    };
                    add(side, 2 + k as u8);
                }
                brick += 1;
            }
        }
    }
    found.into_iter().map(|((side, tooth), faces)| BrickFaces { side, tooth, faces }).collect()
}

/// Where lines of the lattice of nodes lie.
pub(crate) struct Stations {
    /// Shares across each chart.
    pub(crate) across: Vec<Vec<f64>>,
    /// Shares along the tooth.
    pub(crate) along: Vec<f64>,
    /// Layers along the tooth.
    pub(crate) layers: usize,
    /// The place below each section `[z, rho]`: on the rest of the outline, or on the line above a shaft.
    pub(crate) below: Vec<[f64; 2]>,
    /// Below that, and beyond the teeth.
    pub(crate) shaft: Option<ShaftLattice>,
}

impl Stations {
    /// Sections before the first one across the teeth.
    pub(crate) fn before(&self) -> usize {
        let steps = (self.below.len() - 1) / self.layers;
        self.shaft.as_ref().map_or(0, |shaft| shaft.top[0].len() * steps)
    }

    /// All sections, those of a shaft alone among them.
    pub(crate) fn sections(&self) -> usize {
        self.shaft.as_ref().map_or(self.along.len(), |shaft| shaft.places.len())
    }

    /// The section across the teeth that one is, if it is one.
    pub(crate) fn of_teeth(&self, section: usize) -> Option<usize> {
        section.checked_sub(self.before()).filter(|section| *section < self.along.len())
    }

    /// The segment of the outline below each layer.
    fn below_segments(&self, body: &Body, counts: &BrickCounts) -> Vec<usize> {
        match &self.shaft {
            Some(shaft) => shaft.bottom.clone(),
            None => body.blank().below_cells(counts.along).into_iter().map(|(segment, _)| segment).collect(),
        }
    }
}

impl BrickCounts {
    /// Layers of bricks along the axis: those of the teeth, and of a shaft beyond them.
    pub(crate) fn layers(&self) -> usize {
        self.along + self.shaft.map_or(0, |shaft| shaft.ends[0] + shaft.ends[1])
    }

    /// Whether a layer has a brick in a cell: beyond the teeth there is only the shaft.
    pub(crate) fn has(&self, layer: usize, cell: &Cell) -> bool {
        let before = self.shaft.map_or(0, |shaft| shaft.ends[0]);
        cell.shaft_row.is_some() || (before..before + self.along).contains(&layer)
    }

    /// Bricks, and no fewer nodes than they have, of so many teeth.
    pub fn size(&self, body: &Body, order: BrickOrder, teeth: usize) -> [usize; 2] {
        let layout = Layout::new(body, self, order);
        let sections = self.layers() * order.steps() + 1;
        let of_shaft = layout.cells.iter().filter(|cell| cell.shaft_row.is_some()).count();
        let bricks = layout.cells.len() * self.along + of_shaft * (self.layers() - self.along);
        [bricks * teeth, layout.nodes * sections * teeth]
    }

    pub(crate) fn stations(&self, body: &Body, order: BrickOrder) -> Stations {
        let steps = order.steps();
        let across = self.charts.iter().enumerate().map(|(k, count)| counts::even_shares(body, k, count * steps));
        let even: Vec<f64> = (0..=self.along).map(|k| k as f64 / self.along as f64).collect();
        let shaft = self.shaft_of(body).zip(self.shaft);
        let shaft = shaft.and_then(|(shaft, counts)| shaft.lattice(counts, self.along, steps));
        let below = match &shaft {
            Some(shaft) => {
                let before = shaft.top[0].len() * steps;
                (0..=self.along * steps).map(|k| shaft.places[before + k][0]).collect()
            }
            None => self.below(body, steps),
        };
        let along = refined(&even, steps);
        Stations { across: across.collect(), along, below, shaft, layers: self.along }
    }

    /// Places on the rest of the outline below each section.
    fn below(&self, body: &Body, steps: usize) -> Vec<[f64; 2]> {
        let segments = body.blank().outline.segments();
        let mut below: Vec<[f64; 2]> = Vec::new();
        for (segment, [from, to]) in body.blank().below_cells(self.along) {
            let at = |k: usize| segments[segment].at(from + (to - from) * k as f64 / steps as f64);
            below.extend((0..steps).map(at));
            if below.len() == self.along * steps {
                below.push(segments[segment].at(to));
            }
        }
        below
    }
}

//! The cells of a section across a tooth, in blocks.
//!
//! On both sides a band of layers follows the space from the tip over flank and fillet to the middle of the root. Between the bands
//! lies the core of the tooth down to a row of the fillet, below it the rim. Where core and rim part, five cells meet in one
//! node; everywhere else inside there are four.

use crate::solid::arrangement::Polar;
use crate::solid::body::Body;
use crate::solid::bricks::BrickOrder;
use crate::solid::bricks::counts::{BrickCounts, even_shares};
use crate::solid::bricks::section::normals;

/// The core of a tooth ends where the band has turned by so much from the flank's direction, as a sine: the cells that meet there have the best
/// corners.
const TURNED: f64 = 0.64;

/// What the side of a cell lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CellSide {
    Inner,
    Chart(usize),
    Tip,
    /// The rest of the outline.
    Below,
    /// The shaft's own surface, beyond the teeth; inside below these.
    Above,
    /// The middle of the space before the tooth.
    Before,
    /// The middle of the space behind it.
    Behind,
}

/// A cell: its corners, the middles of its sides (of the second order), and what its sides lie on. Side `k` runs from corner `k` to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cell {
    pub(crate) nodes: [usize; 8],
    pub(crate) sides: [CellSide; 4],
    /// Of a cell of the shaft, which goes on beyond the teeth: its row.
    pub(crate) shaft_row: Option<usize>,
}

/// Blocks of a lattice of nodes, and its cells. Counts of nodes are in steps of the lattice.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Steps from one corner to the next.
    pub(crate) steps: usize,
    /// From the tip to the middle of the root.
    pub(crate) profile: usize,
    /// From the tip to where the core of the tooth ends.
    pub(crate) depth: usize,
    pub(crate) band: usize,
    pub(crate) core: usize,
    pub(crate) rim: usize,
    /// From the rim to the bottom of a shaft.
    pub(crate) shaft: usize,
    /// Nodes of a section.
    pub(crate) nodes: usize,
    pub(crate) cells: Vec<Cell>,
    /// Cells that a node is a corner of, or has in the middle of a side.
    used: Vec<Use>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    Corner,
    Middle,
    Nothing,
}

/// The side of a tooth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hand {
    /// Before the tooth, at the lower angle.
    Low,
    High,
}

impl Layout {
    pub(crate) fn new(body: &Body, counts: &BrickCounts, order: BrickOrder) -> Layout {
        let steps = order.steps();
        let whole: usize = counts.charts.iter().sum();
        assert!(counts.charts.len() == body.charts().len() && whole.is_multiple_of(2), "counts of this body's charts");
        let profile = whole / 2;
        let depth = depth(body, counts, profile);
        let mut layout = Layout {
            steps,
            profile: profile * steps,
            depth: depth * steps,
            band: counts.band * steps,
            core: counts.core * steps,
            rim: counts.rim * steps,
            shaft: counts.shaft.map_or(0, |shaft| shaft.rows * steps),
            nodes: 0,
            cells: Vec::new(),
            used: Vec::new(),
        };
        layout.nodes = layout.in_rim(layout.rim + layout.shaft, layout.width()) + 1;
        layout.cells = layout.all_cells(&chart_of_row(counts, profile));
        layout.used = vec![Use::Nothing; layout.nodes];
        for cell in &layout.cells {
            cell.nodes[4..].iter().for_each(|node| layout.used[*node] = Use::Middle);
        }
        for cell in &layout.cells {
            cell.nodes[..4].iter().for_each(|node| layout.used[*node] = Use::Corner);
        }
        layout
    }

    /// From one middle of the root to the next, below the tooth's core.
    pub(crate) fn width(&self) -> usize {
        2 * (self.profile - self.depth) + self.core
    }

    /// A node of a band: from the tip to the middle of the root, from the surface inwards.
    pub(crate) fn in_band(&self, hand: Hand, row: usize, layer: usize) -> usize {
        let first = if hand == Hand::Low { 0 } else { (self.profile + 1) * (self.band + 1) };
        first + row * (self.band + 1) + layer
    }

    /// A node of the tooth's core: from the tip down, from the lower angle on. Its outer columns are those of the bands.
    pub(crate) fn in_core(&self, row: usize, column: usize) -> usize {
        if column == 0 {
            return self.in_band(Hand::Low, row, self.band);
        }
        if column == self.core {
            return self.in_band(Hand::High, row, self.band);
        }
        2 * (self.profile + 1) * (self.band + 1) + row * (self.core - 1) + column - 1
    }

    /// Whether a node lies on the line between teeth and shaft or below it.
    pub(crate) fn is_of_shaft(&self, node: usize) -> bool {
        self.shaft > 0 && node >= self.in_rim(self.rim, 0)
    }

    /// A node of the rim: from the bands and the tooth's core down, from one middle of the root to the next; behind it those of a shaft.
    pub(crate) fn in_rim(&self, row: usize, column: usize) -> usize {
        if row > 0 {
            let before = 2 * (self.profile + 1) * (self.band + 1) + (self.depth + 1) * (self.core - 1);
            return before + (row - 1) * (self.width() + 1) + column;
        }
        let beside = self.profile - self.depth;
        if column <= beside {
            self.in_band(Hand::Low, self.profile - column, self.band)
        } else if column <= beside + self.core {
            self.in_core(self.depth, column - beside)
        } else {
            self.in_band(Hand::High, self.depth + column - beside - self.core, self.band)
        }
    }

    /// The node in the middle of the space before the tooth that one in the middle of the space behind it becomes when it is turned by a tooth.
    pub(crate) fn twin(&self, node: usize) -> Option<usize> {
        let [low, high] = [Hand::Low, Hand::High].map(|hand| self.in_band(hand, self.profile, 0));
        if (high..=high + self.band).contains(&node) {
            return Some(low + node - high);
        }
        let first = self.in_rim(1, 0);
        let is_last = node >= first && (node - first) % (self.width() + 1) == self.width();
        is_last.then(|| node - self.width())
    }

    /// Whether a brick has a node of a section; between two sections of corners it has only those below corners.
    pub(crate) fn is_used(&self, node: usize, is_between: bool) -> bool {
        match self.used[node] {
            Use::Corner => true,
            Use::Middle => !is_between,
            Use::Nothing => false,
        }
    }

    fn all_cells(&self, chart_of_row: &dyn Fn(Hand, usize) -> usize) -> Vec<Cell> {
        let steps = self.steps;
        let lattice = |rows: usize, columns: usize| {
            (0..rows / steps).flat_map(move |i| (0..columns / steps).map(move |j| (i, j)))
        };
        let mut cells = Vec::new();
        for hand in [Hand::Low, Hand::High] {
            let side = if hand == Hand::Low { CellSide::Before } else { CellSide::Behind };
            for (i, j) in lattice(self.profile, self.band) {
                // the angle grows from the first corner to the second
                let node = |row: usize, layer: usize| match hand {
                    Hand::Low => self.in_band(hand, row, layer),
                    Hand::High => self.in_band(hand, row, self.band - layer),
                };
                let is_outer = if hand == Hand::Low { j == 0 } else { (j + 1) * steps == self.band };
                let chart = if is_outer { CellSide::Chart(chart_of_row(hand, i)) } else { CellSide::Inner };
                let tip = if i == 0 { CellSide::Tip } else { CellSide::Inner };
                let end = if (i + 1) * steps == self.profile { side } else { CellSide::Inner };
                let sides = match hand {
                    Hand::Low => [tip, CellSide::Inner, end, chart],
                    Hand::High => [tip, chart, end, CellSide::Inner],
                };
                cells.push(self.cell((i, j), &node, sides));
            }
        }
        for (i, j) in lattice(self.depth, self.core) {
            let tip = if i == 0 { CellSide::Tip } else { CellSide::Inner };
            let sides = [tip, CellSide::Inner, CellSide::Inner, CellSide::Inner];
            cells.push(self.cell((i, j), &|row, column| self.in_core(row, column), sides));
        }
        for (i, j) in lattice(self.rim + self.shaft, self.width()) {
            let on = |is_so: bool, side: CellSide| if is_so { side } else { CellSide::Inner };
            let sides = [
                on(i * steps == self.rim, CellSide::Above),
                on((j + 1) * steps == self.width(), CellSide::Behind),
                on((i + 1) * steps == self.rim + self.shaft, CellSide::Below),
                on(j == 0, CellSide::Before),
            ];
            let shaft_row = i.checked_sub(self.rim / steps);
            let cell = self.cell((i, j), &|row, column| self.in_rim(row, column), sides);
            cells.push(Cell { shaft_row, ..cell });
        }
        cells
    }

    /// The cell of a block at a row and a column of corners: the column grows from the first corner to the second, the row from the second
    /// to the third.
    fn cell(&self, (i, j): (usize, usize), node: &dyn Fn(usize, usize) -> usize, sides: [CellSide; 4]) -> Cell {
        let at = |row: usize, column: usize| node(i * self.steps + row, j * self.steps + column);
        let (all, half) = (self.steps, self.steps / 2);
        let nodes =
            [at(0, 0), at(0, all), at(all, all), at(all, 0), at(0, half), at(half, all), at(all, half), at(half, 0)];
        Cell { nodes, sides, shaft_row: None }
    }
}

/// The chart that lies between two rows of corners of a band.
fn chart_of_row(counts: &BrickCounts, profile: usize) -> impl Fn(Hand, usize) -> usize {
    let along_space: Vec<usize> =
        counts.charts.iter().enumerate().flat_map(|(chart, count)| std::iter::repeat_n(chart, *count)).collect();
    move |hand, row| match hand {
        Hand::High => along_space[row],
        Hand::Low => along_space[2 * profile - 1 - row],
    }
}

/// Rows of corners from the tip to where the tooth's core ends, half-way along.
fn depth(body: &Body, counts: &BrickCounts, profile: usize) -> usize {
    let turned = turned(body, &counts.charts, body.middle_below(counts.shaft_of(body).as_ref()));
    let most = |row: usize| turned[row].max(turned[2 * profile - row]);
    (1..profile).rev().find(|row| most(*row) <= TURNED).unwrap_or(1)
}

/// Rows of corners from the tip to where each side of a space, half-way along, has turned so far that the core of a tooth ends there.
pub(crate) fn depths(body: &Body, charts: &[usize], below: [f64; 2]) -> [usize; 2] {
    let turned = turned(body, charts, below);
    let (last, profile) = (turned.len() - 1, turned.len() / 2);
    let depth = |turned: &dyn Fn(usize) -> f64| (1..profile).rev().find(|row| turned(*row) <= TURNED).unwrap_or(1);
    [depth(&|row| turned[row]), depth(&|row| turned[last - row])]
}

/// How far the corners of a line across a space have turned from the direction towards a place below, as a sine.
fn turned(body: &Body, charts: &[usize], below: [f64; 2]) -> Vec<f64> {
    let across: Vec<Vec<f64>> = charts.iter().enumerate().map(|(k, count)| even_shares(body, k, *count)).collect();
    let line: Vec<Polar> = body.lines(&across, &[0.5]).remove(0);
    normals(&line, below, body.arrangement()).iter().map(|normal| normal[1]).collect()
}

//! Which way a direction of a surface's grid goes on its body: along the profile of a tooth, along the tooth, along a thread.

use std::f64::consts::{PI, TAU};

use super::mesh::{Mesh, Node};
use crate::points::dataset::Layout;
use crate::vector::{Vector, add, dot, sub};

/// A tooth whose radius changes by less than this share of its way along the axis lies between two faces: a cone of 6 degrees.
const LEAST_CONE: f64 = 0.1;
/// What winds about the axis farther than by this many times its way along it is a thread, with a lead below 30 degrees; by more than the
/// other number it goes nowhere along it.
const STEEP: [f64; 2] = [1.732, 1e4];
/// Along a tooth that is made by a screw motion the normals stay as they are, as seen from the axis: they change by less than this share of
/// what they do along the profile, for each mm. What crownings of the jobs that ship change is a hundredth, along the profile of a face worm wheel 0.04.
const OF_A_SCREW: f64 = 0.03;
/// Changes of normals per mm that are rounding.
const ROUNDING: f64 = 1e-9;
/// A flank that leans less to its tip than this share of how it leans the other way has its tip the other way, as that of a face gear.
const LEANS: f64 = 0.25;

/// One direction of the grid.
pub(super) struct Direction {
    /// From the first line to the last in space, summed over all that go that way, mm.
    pub(super) chord: Vector,
    /// The same in the section of the blank, on average: along z, and towards the tip, mm.
    pub(super) way: [f64; 2],
    /// How much the normals lean towards its end, less than 1.
    pub(super) lean: f64,
    /// Whether it is that of a thread, which goes about its axis as a tooth goes past it.
    pub(super) winds: bool,
    /// How far it goes across the section on average, mm.
    around: f64,
    /// How much the normals change, as seen from the axis, per mm of the way.
    change: f64,
}

/// Those of the rows and the columns; `None` where a grid has not both.
pub(super) fn directions(mesh: &Mesh, layout: Layout) -> Option<[Direction; 2]> {
    let [mut rows, mut columns] = [Direction::of_mesh(mesh, true, layout)?, Direction::of_mesh(mesh, false, layout)?];
    if layout == Layout::Round {
        let threads = [rows.is_thread(&columns), columns.is_thread(&rows)];
        [rows.winds, columns.winds] = [rows.winds || threads[0], columns.winds || threads[1]];
    }
    Some([rows, columns])
}

/// Whether rows follow the profile, by their shape: a thread winds along its length; a tooth between two faces is a screw along its length; all
/// else leans to its tip, most for its length in the direction of its profile.
pub(super) fn rows_are_profile(rows: &Direction, columns: &Direction) -> bool {
    match [[rows.winds, columns.winds], [rows.is_length(columns), columns.is_length(rows)]] {
        [[false, true], _] => true,
        [[true, false], _] => false,
        [_, [false, true]] => true,
        [_, [true, false]] => false,
        _ if rows.long() == 0.0 || columns.long() == 0.0 => columns.long() > rows.long(),
        _ => rows.lean.abs() / rows.long() > columns.lean.abs() / columns.long(),
    }
}

impl Direction {
    fn of_mesh(mesh: &Mesh, along_rows: bool, layout: Layout) -> Option<Direction> {
        let (steps, lines) = if along_rows { (mesh.rows, mesh.columns) } else { (mesh.columns, mesh.rows) };
        let line = |line: usize| -> Vec<Node> {
            let at = |step: usize| if along_rows { step * mesh.columns + line } else { line * mesh.columns + step };
            (0..steps).filter_map(|step| mesh.nodes[at(step)]).collect()
        };
        let known: Vec<Vec<Node>> = (0..lines).map(line).filter(|line| !line.is_empty()).collect();
        let ends = || known.iter().map(|line| [line[0].position, line[line.len() - 1].position]);
        let share = 1.0 / known.len().max(1) as f64;
        let mean = |of: &dyn Fn(&[Node]) -> f64| known.iter().map(|line| share * of(line)).sum::<f64>();
        let way = ends().fold([0.0; 2], |sum, [first, last]| {
            let ([z, out], [to_z, to_out]) = (layout.section(first), layout.section(last));
            [sum[0] + share * (to_z - z), sum[1] + share * (to_out - out)]
        });
        let long = way[0].hypot(way[1]);
        let leans: Vec<f64> = mesh.nodes.iter().flatten().filter_map(|node| lean(node, way, layout)).collect();
        let around = mean(&|line| across(line, layout));
        // across a rack's root nothing changes in the section
        let is_known = long > 0.0 || (layout != Layout::Round && around > 0.0);
        is_known.then(|| Direction {
            chord: ends().fold([0.0; 3], |sum, [first, last]| add(sum, sub(last, first))),
            way,
            lean: leans.iter().sum::<f64>() / leans.len().max(1) as f64,
            winds: layout == Layout::Round && mean(&turn) > PI,
            around,
            change: if long > 0.0 { mean(&|line| spread(line, layout)) / long } else { 0.0 },
        })
    }

    fn long(&self) -> f64 {
        self.way[0].hypot(self.way[1])
    }

    /// Whether the distance from the axis stays.
    fn is_level(&self) -> bool {
        self.way[1].abs() < LEAST_CONE * self.way[0].abs()
    }

    /// Whether a screw motion along it leaves the surface as it is, and the other direction leads away from the axis.
    fn is_screw(&self, other: &Direction) -> bool {
        let leads_out = other.way[1].abs() > LEAST_CONE * other.way[0].abs();
        self.is_level() && leads_out && self.change <= OF_A_SCREW * other.change + ROUNDING
    }

    fn is_thread(&self, other: &Direction) -> bool {
        let [least, most] = STEEP.map(|steep| steep * self.long());
        self.is_screw(other) && self.around > least && self.around < most
    }

    fn is_length(&self, other: &Direction) -> bool {
        self.is_screw(other) && other.lean.abs() >= LEANS * self.lean.abs()
    }

    /// Whether a profile goes from root to tip: where the body says so, else as it leans.
    pub(super) fn rises(&self, layout: Layout) -> bool {
        match layout {
            Layout::Straight { tips_to_x: Some(is_up) } => (self.way[1] > 0.0) == is_up,
            _ => self.lean > 0.0,
        }
    }

    /// What the ends are called along a tooth or a thread.
    pub(super) fn length_words(&self, layout: Layout) -> [&'static str; 2] {
        let [along_z, out] = self.way;
        let (words, rise) = if self.winds {
            (["lower end", "upper end"], along_z)
        } else if layout != Layout::Round || self.is_level() {
            (["lower face", "upper face"], along_z)
        } else {
            (["inner end", "outer end"], out)
        };
        super::sides::in_order(words, rise > 0.0)
    }
}

/// How much a normal leans along a way in the section.
fn lean(node: &Node, way: [f64; 2], layout: Layout) -> Option<f64> {
    let normal = node.normal?;
    let [out, _] = layout.directions(node.position);
    let lean = (way[0] * normal[2] + way[1] * dot(normal, out)) / way[0].hypot(way[1]);
    lean.is_finite().then_some(lean)
}

/// The steps of an angle about z, each the shorter way round, radians.
fn turn(line: &[Node]) -> f64 {
    let angle = |node: &Node| node.position[1].atan2(node.position[0]);
    line.windows(2).map(|pair| (angle(&pair[1]) - angle(&pair[0]) + PI).rem_euclid(TAU) - PI).sum::<f64>().abs()
}

/// How far a line goes across the section, mm.
fn across(line: &[Node], layout: Layout) -> f64 {
    let step = |pair: &[Node]| {
        let [_, along] = layout.directions(pair[0].position);
        dot(sub(pair[1].position, pair[0].position), along)
    };
    line.windows(2).map(step).sum::<f64>().abs()
}

/// How far the normals of a line lie apart, as seen from the axis.
fn spread(line: &[Node], layout: Layout) -> f64 {
    let seen = line.iter().filter_map(|node| {
        let (normal, [out, along]) = (node.normal?, layout.directions(node.position));
        Some([dot(normal, out), dot(normal, along), normal[2]])
    });
    let first = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [low, high] = seen.fold(first, |[low, high], normal| {
        [std::array::from_fn(|k| low[k].min(normal[k])), std::array::from_fn(|k| high[k].max(normal[k]))]
    });
    let apart = sub(high, low);
    if apart.iter().all(|part| part.is_finite()) { dot(apart, apart).sqrt() } else { 0.0 }
}

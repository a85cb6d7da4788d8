//! A patch laid flat: turned into the axial plane, or, where that shows nothing of it, by its rows and columns.

use super::mesh::{Mesh, Node};
use crate::conventions::one_line;
use crate::dataset::Patch;
use crate::vector::{Vector, cross, length, sub};

/// A patch of which less than this share is seen in the axial plane is laid by rows and columns.
const LEAST_SHARE: f64 = 0.04;

/// A side of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    FirstRow,
    LastRow,
    FirstColumn,
    LastColumn,
}

/// The nodes of a patch on paper.
pub(super) struct Projection {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Across and up: mm in the axial plane, shares of rows and columns otherwise.
    pub(super) nodes: Vec<Option<[f64; 2]>>,
    /// Whether the nodes are mm in the axial plane.
    pub(super) is_axial: bool,
    /// What goes across and up.
    pub(super) titles: [String; 2],
    /// What the sides are called.
    pub(super) words: Vec<(Side, String)>,
    /// Whether across is the radius, and not z.
    swapped: bool,
}

impl Projection {
    pub(super) fn of(patch: &Patch, mesh: &Mesh) -> Projection {
        let flat: Vec<Option<[f64; 2]>> = mesh.nodes.iter().map(|node| Some(axial(node.as_ref()?.position))).collect();
        if share_seen(mesh, &flat) < LEAST_SHARE {
            Projection::by_index(patch, mesh)
        } else {
            axially(patch, mesh, flat)
        }
    }

    fn by_index(patch: &Patch, mesh: &Mesh) -> Projection {
        let share = |k: usize, count: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
        let place = |at: usize| [share(at % mesh.columns, mesh.columns), share(at / mesh.columns, mesh.rows)];
        let arrow = |label: &str| format!("{} \u{2192}", one_line(label));
        let titles = [&patch.columns.label, &patch.rows.label]
            .map(|label| if ends(label).is_some() { String::new() } else { arrow(label) });
        Projection {
            rows: mesh.rows,
            columns: mesh.columns,
            nodes: (0..mesh.nodes.len()).map(|at| mesh.nodes[at].map(|_| place(at))).collect(),
            is_axial: false,
            titles: [
                titles[0].clone(),
                if titles[1].is_empty() { String::new() } else { format!("up: {}", titles[1]) },
            ],
            words: named_sides(patch),
            swapped: false,
        }
    }

    /// Where a place in space lies on paper, if it is a projection of space.
    pub(super) fn place(&self, position: Vector) -> Option<[f64; 2]> {
        let [z, radius] = axial(position);
        self.is_axial.then_some(if self.swapped { [radius, z] } else { [z, radius] })
    }

    /// The numbers of the nodes along a side, in the order of growing index.
    pub(super) fn side(&self, side: Side) -> Vec<usize> {
        let (rows, columns) = (self.rows, self.columns);
        match side {
            Side::FirstRow => (0..columns).collect(),
            Side::LastRow => ((rows - 1) * columns..rows * columns).collect(),
            Side::FirstColumn => (0..rows).map(|i| i * columns).collect(),
            Side::LastColumn => (0..rows).map(|i| (i + 1) * columns - 1).collect(),
        }
    }
}

fn axially(patch: &Patch, mesh: &Mesh, flat: Vec<Option<[f64; 2]>>) -> Projection {
    let reach = |k: usize| {
        let known = || flat.iter().flatten().map(|place| place[k]);
        known().fold(f64::MIN, f64::max) - known().fold(f64::MAX, f64::min)
    };
    // the longer one goes across
    let swapped = reach(1) > reach(0);
    let nodes =
        if swapped { flat.iter().map(|place| place.map(|[z, radius]| [radius, z])).collect() } else { flat.clone() };
    let titles = ["z, mm".to_owned(), "radius, mm".to_owned()];
    let [z, radius] = titles;
    Projection {
        rows: mesh.rows,
        columns: mesh.columns,
        nodes,
        is_axial: true,
        titles: if swapped { [radius, z] } else { [z, radius] },
        words: words(patch, mesh),
        swapped,
    }
}

/// z and the distance from it.
fn axial(position: Vector) -> [f64; 2] {
    [position[2], position[0].hypot(position[1])]
}

/// How much of the area is left in the axial plane, less what lies on itself there.
fn share_seen(mesh: &Mesh, flat: &[Option<[f64; 2]>]) -> f64 {
    let (mut seen, mut all) = (0.0, 0.0);
    for face in mesh.faces() {
        let [a, b, c] = [face[0], face[1], face[2]];
        let (Some(p), Some(q), Some(r)) = (mesh.nodes[a], mesh.nodes[b], mesh.nodes[c]) else { continue };
        all += length(cross(sub(q.position, p.position), sub(r.position, p.position)));
        let (Some(p), Some(q), Some(r)) = (flat[a], flat[b], flat[c]) else { continue };
        seen += (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    }
    if all > 0.0 { seen.abs() / all } else { 0.0 }
}

/// The two words of a label like `root -> tip`.
fn ends(label: &str) -> Option<[String; 2]> {
    let (from, to) = label.split_once("->").or_else(|| label.split_once('\u{2192}'))?;
    let words = [from, to].map(|word| one_line(word.trim()));
    words.iter().all(|word| !word.is_empty()).then_some(words)
}

/// The sides that the labels of rows and columns name.
fn named_sides(patch: &Patch) -> Vec<(Side, String)> {
    let mut words = Vec::new();
    for (label, sides) in [
        (&patch.rows.label, [Side::FirstRow, Side::LastRow]),
        (&patch.columns.label, [Side::FirstColumn, Side::LastColumn]),
    ] {
        if let Some(named) = ends(label) {
            words.extend(sides.into_iter().zip(named));
        }
    }
    words
}

/// One direction of the grid, as the axial plane shows it.
struct Direction {
    /// From the first line to the last, on average: along z, along the radius, mm.
    way: [f64; 2],
    /// How much the normals lean towards its end, less than 1.
    lean: f64,
}

impl Direction {
    fn of(mesh: &Mesh, along_rows: bool) -> Option<Direction> {
        let (steps, lines) = if along_rows { (mesh.rows, mesh.columns) } else { (mesh.columns, mesh.rows) };
        let node = |step: usize, line: usize| -> Option<Node> {
            mesh.nodes[if along_rows { step * mesh.columns + line } else { line * mesh.columns + step }]
        };
        let across = |line: usize| {
            let first = (0..steps).find_map(|step| node(step, line))?;
            let last = (0..steps).rev().find_map(|step| node(step, line))?;
            let ([z, radius], [to_z, to_radius]) = (axial(first.position), axial(last.position));
            Some([to_z - z, to_radius - radius])
        };
        let ways: Vec<[f64; 2]> = (0..lines).filter_map(across).collect();
        let share = 1.0 / ways.len().max(1) as f64;
        let way = ways.iter().fold([0.0; 2], |sum, way| [sum[0] + share * way[0], sum[1] + share * way[1]]);
        let long = way[0].hypot(way[1]);
        let leans: Vec<f64> = mesh
            .nodes
            .iter()
            .flatten()
            .filter_map(|node| {
                let normal = node.normal?;
                let radius = node.position[0].hypot(node.position[1]);
                let outward = (normal[0] * node.position[0] + normal[1] * node.position[1]) / radius;
                let lean = (way[0] * normal[2] + way[1] * outward) / long;
                lean.is_finite().then_some(lean)
            })
            .collect();
        let lean = leans.iter().sum::<f64>() / leans.len().max(1) as f64;
        (long > 0.0).then_some(Direction { way, lean })
    }

    fn long(&self) -> f64 {
        self.way[0].hypot(self.way[1])
    }
}

/// Whether the rows of a flank follow each other from root to tip or back; `None` where its grid does not tell.
pub(super) fn rows_follow_profile(patch: &Patch) -> Option<bool> {
    if let Some(labelled) = labelled_profile(patch) {
        return Some(labelled);
    }
    let mesh = Mesh::of(patch, 40);
    let [rows, columns] = [true, false].map(|along_rows| Direction::of(&mesh, along_rows));
    Some(leans_more(&rows?, &columns?))
}

/// What the sides of a flank's grid are called.
pub(crate) struct Sides {
    /// Of the first row and the last.
    pub(crate) rows: [String; 2],
    /// Of the first column and the last.
    pub(crate) columns: [String; 2],
    pub(crate) rows_are_profile: bool,
}

/// The names of all four sides; `None` where the grid does not tell them.
pub(crate) fn sides(patch: &Patch) -> Option<Sides> {
    let words = words(patch, &Mesh::of(patch, 40));
    let word = |side: Side| words.iter().find(|(named, _)| *named == side).map(|(_, word)| word.clone());
    Some(Sides {
        rows: [word(Side::FirstRow)?, word(Side::LastRow)?],
        columns: [word(Side::FirstColumn)?, word(Side::LastColumn)?],
        rows_are_profile: rows_follow_profile(patch)?,
    })
}

/// The same by the labels of rows and columns, where these name root and tip.
fn labelled_profile(patch: &Patch) -> Option<bool> {
    let is_profile =
        |label: &str| ends(label).is_some_and(|words| words.iter().any(|word| word == "root" || word == "tip"));
    match [is_profile(&patch.rows.label), is_profile(&patch.columns.label)] {
        [true, _] => Some(true),
        [_, true] => Some(false),
        _ => None,
    }
}

/// A flank leans to its tip, most for its length in the direction of its profile.
fn leans_more(one: &Direction, other: &Direction) -> bool {
    one.lean.abs() / one.long() > other.lean.abs() / other.long()
}

/// What the sides are: as the labels name them; else from the shape.
fn words(patch: &Patch, mesh: &Mesh) -> Vec<(Side, String)> {
    let mut words = named_sides(patch);
    let is_named = |side: Side, words: &[(Side, String)]| words.iter().any(|(named, _)| *named == side);
    let directions = [true, false].map(|along_rows| Direction::of(mesh, along_rows));
    let [Some(rows), Some(columns)] = directions else { return words };
    let rows_are_profile = labelled_profile(patch).unwrap_or_else(|| leans_more(&rows, &columns));
    let both = [
        (&rows, rows_are_profile, [Side::FirstRow, Side::LastRow]),
        (&columns, !rows_are_profile, [Side::FirstColumn, Side::LastColumn]),
    ];
    for (direction, is_profile, sides) in both {
        if is_named(sides[0], &words) {
            continue;
        }
        let [along_z, along_radius] = direction.way;
        let (names, rise) = if is_profile {
            (["root", "tip"], direction.lean)
        } else if along_z.abs() > along_radius.abs() {
            (["lower face", "upper face"], along_z)
        } else {
            (["inner end", "outer end"], along_radius)
        };
        let [first, last] = if rise > 0.0 { sides } else { [sides[1], sides[0]] };
        words.extend([(first, names[0].to_owned()), (last, names[1].to_owned())]);
    }
    words
}

/// The point between some.
pub(super) fn middle(places: &[[f64; 2]]) -> [f64; 2] {
    let share = 1.0 / places.len().max(1) as f64;
    places.iter().fold([0.0; 2], |sum, place| [sum[0] + share * place[0], sum[1] + share * place[1]])
}

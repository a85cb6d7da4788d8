//! Patches as shaded faces, grid lines and borders, each with its depth.

use super::camera::View;
use super::paint::{Colour, Item, Place};
use super::palette;
use flank_export::shape::{Edge, Mesh, Node};
use flank_export::vector::{Vector, add, length, scale, sub, unit};

/// Pieces overlap their neighbours by half of this, so much that no ground shines through where their edges are smoothed.
pub(super) const SEAM: f64 = 2.4;

/// A cell is drawn in at most this many pieces in each direction.
const FINEST: usize = 64;

/// How fine a patch is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// A direction with fewer cells than this is refined for smooth shading.
    pub(super) smooth: usize,
    /// At least this far apart, sheet units, are the lines inside the grid.
    pub(super) grid_spacing: f64,
    pub(super) grid_width: f64,
    pub(super) border_width: f64,
}

/// Items with how near the eye they are; sorted, the near ones cover the far ones.
#[derive(Debug, Default)]
pub(super) struct Layers(Vec<(f64, Item)>);

impl Layers {
    pub(super) fn push(&mut self, depth: f64, item: Item) {
        self.0.push((depth, item));
    }

    /// The items from far to near; those at one depth keep their order.
    pub(super) fn into_items(mut self) -> impl Iterator<Item = Item> {
        self.0.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.0.into_iter().map(|(_, item)| item)
    }

    /// The faces alone, for what must keep clear of them.
    pub(super) fn shapes(&self) -> impl Iterator<Item = &[Place]> {
        self.0.iter().filter_map(|(_, item)| match item {
            Item::Polygon { points, .. } | Item::Line { points, .. } => Some(points.as_slice()),
            Item::Text { .. } => None,
        })
    }
}

/// Adds a mesh to the layers: faces, thin grid lines, strong borders, and dots where points stand alone.
pub(super) fn add_mesh(mesh: &Mesh, base: Colour, view: &View, detail: Detail, layers: &mut Layers) {
    let cells = |count: usize| count.saturating_sub(1).max(1);
    let parts = [detail.smooth.div_ceil(cells(mesh.rows)), detail.smooth.div_ceil(cells(mesh.columns))];
    for face in mesh.faces() {
        let corners: Vec<Node> = face.iter().filter_map(|&at| mesh.nodes[at]).collect();
        add_face(&corners, parts, base, view, layers);
    }
    add_lines(mesh, base, view, detail, parts, layers);
}

/// One face in `parts` by `parts` pieces, each in its own light.
fn add_face(corners: &[Node], parts: [usize; 2], base: Colour, view: &View, layers: &mut Layers) {
    let Ok([a, b, c, d]) = <[Node; 4]>::try_from(corners.to_vec()) else {
        add_piece(corners, base, view, layers);
        return;
    };
    // Corners run a, b down the column, then c, and d in the first row again.
    let [down, right] = parts.map(|parts| parts.clamp(1, FINEST));
    let at = |i: usize, j: usize| {
        let (s, t) = (i as f64 / down as f64, j as f64 / right as f64);
        between(&between(&a, &b, s), &between(&d, &c, s), t)
    };
    for i in 0..down {
        for j in 0..right {
            add_piece(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], base, view, layers);
        }
    }
}

fn between(a: &Node, b: &Node, t: f64) -> Node {
    let mix = |a: Vector, b: Vector| add(a, scale(t, sub(b, a)));
    let normal = match (a.normal, b.normal) {
        (Some(a), Some(b)) => Some(mix(a, b)),
        (a, b) => a.or(b),
    };
    Node { position: mix(a.position, b.position), normal }
}

fn add_piece(corners: &[Node], base: Colour, view: &View, layers: &mut Layers) {
    let share = 1.0 / corners.len() as f64;
    let centre = corners.iter().fold([0.0; 3], |sum, node| add(sum, scale(share, node.position)));
    let normal = corners.iter().filter_map(|node| node.normal).fold([0.0; 3], add);
    let fill = match unit(normal) {
        Some(normal) => palette::shaded(base, view.camera.seen(normal)),
        None => base,
    };
    let points = corners.iter().map(|node| view.place(node.position)).collect();
    layers.push(view.depth(centre), Item::Polygon { points, fill, outline: fill, width: SEAM });
}

fn add_lines(mesh: &Mesh, base: Colour, view: &View, detail: Detail, parts: [usize; 2], layers: &mut Layers) {
    let edges = mesh.edges();
    let thin = base.towards(palette::INK, 0.55);
    let strong = base.towards(palette::INK, 0.85);
    let lift = lift(mesh, edges.keys(), parts);
    let steps = grid_steps(mesh, view, detail.grid_spacing);
    let mut joined = vec![false; mesh.nodes.len()];
    for (&(from, to), &faces) in &edges {
        joined[from] = true;
        joined[to] = true;
        let (colour, width) = match faces {
            2 if is_grid_line(mesh, (from, to), steps) => (thin, detail.grid_width),
            2 => continue,
            _ => (strong, detail.border_width),
        };
        if let (Some(a), Some(b)) = (mesh.nodes[from], mesh.nodes[to]) {
            let pieces = pieces((from, to), mesh, parts);
            for piece in 0..pieces {
                let at = |k: usize| between(&a, &b, (piece + k) as f64 / pieces as f64).position;
                let depth = 0.5 * (view.depth(at(0)) + view.depth(at(1))) + lift;
                layers.push(depth, Item::Line { points: vec![view.place(at(0)), view.place(at(1))], colour, width });
            }
        }
    }
    for (node, _) in mesh.nodes.iter().zip(joined).filter(|(_, joined)| !joined) {
        if let Some(node) = node {
            let place = view.place(node.position);
            let dot = Item::Line { points: vec![place, place], colour: strong, width: 7.0 };
            layers.push(view.depth(node.position) + lift, dot);
        }
    }
}

/// How many pieces an edge is drawn in: as many as the faces beside it.
fn pieces((from, to): Edge, mesh: &Mesh, parts: [usize; 2]) -> usize {
    let [down, right] = parts.map(|parts| parts.clamp(1, FINEST));
    if from / mesh.columns == to / mesh.columns {
        right
    } else if from % mesh.columns == to % mesh.columns {
        down
    } else {
        down.max(right)
    }
}

/// How far, mm, lines are drawn in front of their own faces: about two painted pieces.
fn lift<'a>(mesh: &Mesh, edges: impl Iterator<Item = &'a Edge>, parts: [usize; 2]) -> f64 {
    let size = |&edge: &Edge| match (mesh.nodes[edge.0], mesh.nodes[edge.1]) {
        (Some(from), Some(to)) => length(sub(from.position, to.position)) / pieces(edge, mesh, parts) as f64,
        _ => 0.0,
    };
    2.0 * edges.map(size).fold(0.0, f64::max)
}

/// Every how many rows and columns a line is drawn.
fn grid_steps(mesh: &Mesh, view: &View, spacing: f64) -> [usize; 2] {
    let neighbours = [mesh.columns, 1].map(|step| {
        let pairs = mesh.nodes.iter().zip(mesh.nodes.iter().skip(step)).enumerate();
        let pairs = pairs.filter(|(at, _)| step > 1 || (at + 1) % mesh.columns != 0);
        let gaps = pairs.filter_map(|(_, (from, to))| {
            let (from, to) = (view.place(from.as_ref()?.position), view.place(to.as_ref()?.position));
            Some((from[0] - to[0]).hypot(from[1] - to[1]))
        });
        let (count, sum) = gaps.fold((0.0, 0.0), |(count, sum), gap| (count + 1.0, sum + gap));
        if count > 0.0 { sum / count } else { spacing }
    });
    // A float cast saturates: lines that all fall together are drawn once.
    neighbours.map(|gap| ((spacing / gap).ceil() as usize).max(1))
}

/// Whether an edge inside the grid lies on one of the rows or columns that are drawn.
fn is_grid_line(mesh: &Mesh, (from, to): Edge, [rows, columns]: [usize; 2]) -> bool {
    let place = |at: usize| (at / mesh.columns, at % mesh.columns);
    let ((i, j), (k, l)) = (place(from), place(to));
    (i == k && i % rows == 0) || (j == l && j % columns == 0)
}

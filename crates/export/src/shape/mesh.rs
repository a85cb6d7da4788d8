//! A patch as nodes, faces and edges, thinned to what a picture can show.

use std::collections::BTreeMap;

use crate::points::dataset::{Patch, Point};
use crate::vector::{Vector, unit};

/// Beyond a thousand kilometres nothing is a gear, and squares of coordinates could overflow.
const FARTHEST: f64 = 1e9;

/// A solved point that can be drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Position, mm.
    pub position: Vector,
    /// Unit normal, where the point has one.
    pub normal: Option<Vector>,
}

/// An edge of the mesh: two node numbers, the smaller first.
pub type Edge = (usize, usize);

/// The nodes of a patch in a grid.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Lines of nodes.
    pub rows: usize,
    /// Nodes on each.
    pub columns: usize,
    /// Row by row; `None` where a point is not solved.
    pub nodes: Vec<Option<Node>>,
    /// Whether nodes beside each other are joined: not those of a list.
    pub is_joined: bool,
}

/// The point as a node, if it is solved and within reach.
pub fn node(point: &Point) -> Option<Node> {
    let drawable = point.is_solved() && point.position.iter().all(|x| x.abs() <= FARTHEST);
    drawable.then(|| Node { position: point.position, normal: unit(point.normal) })
}

impl Mesh {
    /// The patch with at most `cells` cells in each direction, or as many points of a list as these have; first and last rows and
    /// columns always stay.
    pub fn of_patch(patch: &Patch, cells: usize) -> Self {
        let rows = thinned(patch.rows.count, cells);
        let is_list = patch.rows.is_list();
        let columns = thinned(patch.columns.count, if is_list { cells.saturating_mul(cells) } else { cells });
        let nodes = rows.iter().flat_map(|&i| columns.iter().map(move |&j| patch.point(i, j).and_then(node))).collect();
        Mesh { rows: rows.len(), columns: columns.len(), nodes, is_joined: !is_list }
    }

    /// The same with at most `cells` cells in each direction.
    pub fn coarser(&self, cells: usize) -> Self {
        let (rows, columns) = (thinned(self.rows, cells), thinned(self.columns, cells));
        let nodes = rows.iter().flat_map(|&i| columns.iter().map(move |&j| self.nodes[i * self.columns + j])).collect();
        Mesh { rows: rows.len(), columns: columns.len(), nodes, is_joined: self.is_joined }
    }

    /// The numbers of the patch's points that the nodes are, in the order of the nodes.
    pub fn picked(&self, patch: &Patch) -> impl Iterator<Item = usize> {
        let rows = thinned(patch.rows.count, self.rows.saturating_sub(1));
        let columns = thinned(patch.columns.count, self.columns.saturating_sub(1));
        let across = patch.columns.count;
        rows.into_iter().flat_map(move |i| columns.clone().into_iter().map(move |j| i * across + j))
    }

    /// A sentence on what is not drawn of a patch; nothing if all of it is.
    pub fn thinned_from(&self, patch: &Patch) -> Option<String> {
        let (rows, columns) = (patch.rows.count, patch.columns.count);
        let thinned = self.rows < rows || self.columns < columns;
        thinned.then(|| format!("Drawn from {} x {} of {rows} x {columns} points.", self.rows, self.columns))
    }

    /// Node numbers of each face, in order around it: four, or three where one corner is missing.
    pub fn faces(&self) -> Vec<Vec<usize>> {
        let mut faces = Vec::new();
        for i in 1..self.rows {
            for j in 1..self.columns {
                let at = i * self.columns + j;
                let corners = [at - self.columns - 1, at - 1, at, at - self.columns];
                let known: Vec<usize> = corners.into_iter().filter(|&corner| self.nodes[corner].is_some()).collect();
                if known.len() >= 3 {
                    faces.push(known);
                }
            }
        }
        faces
    }

    /// How many faces each edge borders. Edges between solved neighbours without any face are there with zero.
    pub fn edges(&self) -> BTreeMap<Edge, usize> {
        let mut edges: BTreeMap<Edge, usize> = BTreeMap::new();
        for face in self.faces() {
            for (k, &from) in face.iter().enumerate() {
                let to = face[(k + 1) % face.len()];
                *edges.entry((from.min(to), from.max(to))).or_default() += 1;
            }
        }
        for at in (0..self.nodes.len()).filter(|_| self.is_joined) {
            let right = ((at + 1) % self.columns != 0).then_some(at + 1);
            let below = Some(at + self.columns).filter(|&below| below < self.nodes.len());
            for next in [right, below].into_iter().flatten() {
                if self.nodes[at].is_some() && self.nodes[next].is_some() {
                    edges.entry((at, next)).or_default();
                }
            }
        }
        edges
    }
}

/// Indices `0..count` with equal steps, at most `steps` of them, both ends included.
fn thinned(count: usize, steps: usize) -> Vec<usize> {
    let Some(last) = count.checked_sub(1) else {
        return Vec::new();
    };
    let steps = last.min(steps.max(1));
    if steps == 0 {
        return vec![0];
    }
    // Wide numbers: a grid's count times a step may not fit.
    (0..=steps).map(|k| (k as u128 * last as u128 / steps as u128) as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_both_ends() {
        assert_eq!(thinned(0, 5), Vec::<usize>::new());
        assert_eq!(thinned(1, 5), [0]);
        assert_eq!(thinned(4, 5), [0, 1, 2, 3]);
        assert_eq!(thinned(101, 4), [0, 25, 50, 75, 100]);
    }

    #[test]
    fn a_missing_corner_leaves_a_triangle_and_an_inner_border() {
        let here = Some(Node { position: [0.0; 3], normal: None });
        let mesh = Mesh {
            rows: 3,
            columns: 3,
            nodes: vec![here, here, here, here, here, here, here, here, None],
            is_joined: true,
        };
        let faces = mesh.faces();
        assert_eq!(faces.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4, 4, 3]);
        let edges = mesh.edges();
        assert_eq!(edges[&(5, 7)], 1);
        assert_eq!(edges[&(1, 4)], 2);
    }

    #[test]
    fn points_of_a_list_are_not_joined() {
        let here = Some(Node { position: [0.0; 3], normal: None });
        let row = Mesh { rows: 1, columns: 3, nodes: vec![here; 3], is_joined: true };
        assert_eq!(row.edges().len(), 2);
        assert!(Mesh { is_joined: false, ..row }.edges().is_empty());
    }
}

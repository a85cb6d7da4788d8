//! Solved points and the triangles between them, for the formats that hold a mesh.

use crate::dataset::{Patch, Point};
use crate::vector::{add, cross, dot, length, sub};

/// The triangles of rows of points as numbers of these, wound so that they face where the points' normals do: out of the body.
///
/// A grid cell becomes two triangles along its shorter diagonal, or one where a single corner is not solved.
pub(crate) fn facets(points: &[Point], columns: usize) -> impl Iterator<Item = [usize; 3]> {
    let rows = points.len().checked_div(columns).unwrap_or(0);
    let cells = (1..rows).flat_map(move |i| (1..columns).map(move |j| i * columns + j));
    cells.flat_map(move |at| {
        let corners = [at - columns - 1, at - 1, at, at - columns].map(|at| (at, &points[at]));
        split(corners.map(Some).map(|corner| corner.filter(|(_, point)| point.is_solved())))
            .into_iter()
            .flatten()
            .map(outward)
    })
}

type Corner<'a> = (usize, &'a Point);

/// Splits a cell, given by its corners in order around it, into triangles of solved points.
fn split(corners: [Option<Corner<'_>>; 4]) -> [Option<[Corner<'_>; 3]>; 2] {
    match corners {
        [Some(a), Some(b), Some(c), Some(d)] => {
            let diagonal = |p: Corner<'_>, q: Corner<'_>| length(sub(p.1.position, q.1.position));
            let along_ac = diagonal(a, c) <= diagonal(b, d);
            if along_ac { [Some([a, b, c]), Some([a, c, d])] } else { [Some([a, b, d]), Some([b, c, d])] }
        }
        [None, Some(b), Some(c), Some(d)] => [Some([b, c, d]), None],
        [Some(a), None, Some(c), Some(d)] => [Some([a, c, d]), None],
        [Some(a), Some(b), None, Some(d)] => [Some([a, b, d]), None],
        [Some(a), Some(b), Some(c), None] => [Some([a, b, c]), None],
        _ => [None, None],
    }
}

fn outward([a, b, c]: [Corner<'_>; 3]) -> [usize; 3] {
    let wound = cross(sub(b.1.position, a.1.position), sub(c.1.position, a.1.position));
    let normals = add(add(a.1.normal, b.1.normal), c.1.normal);
    if dot(wound, normals) < 0.0 { [a.0, c.0, b.0] } else { [a.0, b.0, c.0] }
}

/// Where the solved points of a patch stand when only they are written.
pub(crate) struct Places {
    /// Of each point of the patch, how many solved ones come before it.
    before: Vec<usize>,
    /// How many are solved.
    pub(crate) solved: usize,
}

impl Places {
    pub(crate) fn of(patch: &Patch) -> Places {
        let mut solved = 0;
        let place = |point: &Point| {
            let place = solved;
            solved += usize::from(point.is_solved());
            place
        };
        let before = patch.points.iter().map(place).collect();
        Places { before, solved }
    }

    /// From 0; of a solved point.
    pub(crate) fn of_point(&self, at: usize) -> usize {
        self.before[at]
    }
}

//! Solved points and the triangles between them, for the formats that hold a mesh.

use crate::files::error::WriteError;
use crate::points::bands::Banded;
use crate::points::dataset::Point;
use crate::vector::{add, cross, dot, length, sub};

/// The triangles between the rows of a surface, as these are handed over.
pub(crate) struct Mesh {
    columns: usize,
    /// The last row.
    above: Vec<Point>,
    /// Of its points, and of those handed over next, how many that are counted come before them.
    places: Vec<usize>,
    counted: usize,
    counts: fn(&Point) -> bool,
}

/// A corner of a triangle: a solved point with its number among those of its surface that are counted, from 0.
pub(crate) type Numbered<'a> = (usize, &'a Point);

impl Mesh {
    /// Of a file that holds the points which it `counts`.
    pub(crate) fn of_surface(surface: &dyn Banded, counts: fn(&Point) -> bool) -> Mesh {
        Mesh { columns: surface.outline().columns.count, above: Vec::new(), places: Vec::new(), counted: 0, counts }
    }

    /// Hands over the triangles between rows that come next and of these with the last one, wound so that they face where the
    /// points' normals do: out of the body. A grid cell becomes two triangles along its shorter diagonal, or one where a single
    /// corner is not solved.
    ///
    /// # Errors
    /// What `take` gives.
    pub(crate) fn add(
        &mut self,
        points: &[Point],
        take: &mut dyn FnMut([Numbered<'_>; 3]) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        let Mesh { columns, above, places, counted, counts } = self;
        for point in points {
            places.push(*counted);
            *counted += usize::from(counts(point));
        }
        let kept = above.len();
        let point = |at: usize| if at < kept { &above[at] } else { &points[at - kept] };
        let rows = places.len().checked_div(*columns).unwrap_or(0);
        for (i, j) in (1..rows).flat_map(|i| (1..*columns).map(move |j| (i, j))) {
            let at = i * *columns + j;
            let corners = [at - *columns - 1, at - 1, at, at - *columns].map(|at| (places[at], point(at)));
            let corners = corners.map(|corner| Some(corner).filter(|(_, point)| point.is_solved()));
            split(corners).into_iter().flatten().map(outward).try_for_each(&mut *take)?;
        }
        let last = places.len().saturating_sub(*columns);
        *above = (last..places.len()).map(|at| point(at).clone()).collect();
        places.drain(..last);
        Ok(())
    }
}

/// Hands over all triangles of a surface, whose solved points are counted.
///
/// # Errors
/// What `take` gives, or if the surface cannot hand over its points.
pub(crate) fn each_facet(
    surface: &dyn Banded,
    take: &mut dyn FnMut([Numbered<'_>; 3]) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let mut mesh = Mesh::of_surface(surface, Point::is_solved);
    surface.bands(&mut |points| mesh.add(points, take))
}

/// How many triangles a surface has.
///
/// # Errors
/// If it cannot hand over its points.
pub(crate) fn count_facets(surface: &dyn Banded) -> Result<usize, WriteError> {
    let mut count = 0;
    each_facet(surface, &mut |_| {
        count += 1;
        Ok(())
    })?;
    Ok(count)
}

/// Splits a cell, given by its corners in order around it, into triangles of solved points.
fn split<'a>(corners: [Option<Numbered<'a>>; 4]) -> [Option<[Numbered<'a>; 3]>; 2] {
    match corners {
        [Some(a), Some(b), Some(c), Some(d)] => {
            let diagonal = |p: Numbered<'_>, q: Numbered<'_>| length(sub(p.1.position, q.1.position));
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

fn outward<'a>([a, b, c]: [Numbered<'a>; 3]) -> [Numbered<'a>; 3] {
    let wound = cross(sub(b.1.position, a.1.position), sub(c.1.position, a.1.position));
    let normals = add(add(a.1.normal, b.1.normal), c.1.normal);
    if dot(wound, normals) < 0.0 { [a, c, b] } else { [a, b, c] }
}

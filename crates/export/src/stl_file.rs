//! Surfaces as a binary STL mesh.

use std::io::Write;

use crate::conventions::one_line;
use crate::dataset::{Dataset, Patch, Point};
use crate::error::WriteError;
use crate::vector::{Vector, add, cross, dot, length, sub, unit};

/// One triangle: its corners, wound to agree with the normals of the three points.
struct Triangle {
    normal: Vector,
    corners: [Vector; 3],
}

/// Writes all patches as one binary STL mesh, mm.
///
/// A grid cell becomes two triangles along its shorter diagonal, or one where a single corner is not solved. Facets are
/// wound so that their normals agree with those of the points, out of the body. A triangle that has no area in the
/// format's single precision is left out. The surfaces are open: the mesh has no volume.
///
/// # Errors
/// When the dataset is malformed, there are more triangles than the format can count, or the stream refuses.
pub fn write_stl(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    let triangles: Vec<Triangle> = dataset.patches.iter().flat_map(triangles_of).collect();
    let count =
        u32::try_from(triangles.len()).map_err(|_| WriteError::TooManyTriangles { triangles: triangles.len() })?;
    out.write_all(&head(dataset))?;
    out.write_all(&count.to_le_bytes())?;
    for triangle in &triangles {
        for number in [triangle.normal].iter().chain(&triangle.corners).flatten() {
            out.write_all(&single(*number).to_le_bytes())?;
        }
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

/// The 80 free bytes. They must not begin with `solid`, which marks a text file.
fn head(dataset: &Dataset) -> [u8; 80] {
    let header = &dataset.header;
    let text = one_line(&format!("binary STL in mm; {}; {}; {}", header.program, header.spec, header.job));
    let mut bytes = [b' '; 80];
    for (byte, letter) in bytes.iter_mut().zip(text.chars()) {
        *byte = if letter.is_ascii() { letter as u8 } else { b'?' };
    }
    bytes
}

fn triangles_of(patch: &Patch) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    // A grid of many rows without columns has no points, but would take for ever.
    if patch.points.is_empty() {
        return triangles;
    }
    for i in 1..patch.rows.count {
        for j in 1..patch.columns.count {
            let corners = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)];
            let corners = corners.map(|(i, j)| patch.point(i, j).filter(|point| point.is_solved()));
            triangles.extend(split(corners).into_iter().filter_map(triangle));
        }
    }
    triangles
}

/// Splits a cell, given by its corners in order around it, into triangles of solved points.
fn split(corners: [Option<&Point>; 4]) -> Vec<[&Point; 3]> {
    match corners {
        [Some(a), Some(b), Some(c), Some(d)] => {
            let diagonal = |p: &Point, q: &Point| length(sub(p.position, q.position));
            if diagonal(a, c) <= diagonal(b, d) { vec![[a, b, c], [a, c, d]] } else { vec![[a, b, d], [b, c, d]] }
        }
        [None, Some(b), Some(c), Some(d)] => vec![[b, c, d]],
        [Some(a), None, Some(c), Some(d)] => vec![[a, c, d]],
        [Some(a), Some(b), None, Some(d)] => vec![[a, b, d]],
        [Some(a), Some(b), Some(c), None] => vec![[a, b, c]],
        _ => Vec::new(),
    }
}

fn triangle(points: [&Point; 3]) -> Option<Triangle> {
    // Rounded first: the normal is that of the triangle in the file.
    let [a, b, c] = points.map(|point| point.position.map(|x| f64::from(single(x))));
    let normal = unit(cross(sub(b, a), sub(c, a)))?;
    let outward = points.iter().fold([0.0; 3], |sum, point| add(sum, point.normal));
    let flipped = dot(normal, outward) < 0.0;
    Some(if flipped {
        Triangle { normal: normal.map(|x| -x), corners: [a, c, b] }
    } else {
        Triangle { normal, corners: [a, b, c] }
    })
}

/// The format's precision, without negative zeros.
fn single(value: f64) -> f32 {
    let single = value as f32;
    if single == 0.0 { 0.0 } else { single }
}

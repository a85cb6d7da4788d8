//! Surfaces as a binary STL mesh.

use std::io::Write;

use crate::bands::{Banded, Seen, in_one_piece};
use crate::conventions::one_line;
use crate::dataset::{Dataset, Header, Point};
use crate::error::WriteError;
use crate::facets::facets;
use crate::vector::{cross, sub, unit};

/// Writes all patches as one binary STL mesh, mm.
///
/// A grid cell becomes two triangles along its shorter diagonal, or one where a single corner is not solved. They are
/// wound so that they face where the normals of the points do, out of the body. A triangle that has no area in the
/// format's single precision is left out. The surfaces are open: the mesh has no volume.
///
/// # Errors
/// When the dataset is malformed, there are more triangles than the format can count, or the stream refuses.
pub fn write_stl(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    write_stl_in_bands(&dataset.header, &in_one_piece(dataset), out)
}

/// The same for surfaces that hand over their points in bands of rows; they are asked to three times.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, there are more triangles than the format can count, or the
/// stream refuses.
pub fn write_stl_in_bands(header: &Header, surfaces: &[&dyn Banded], out: &mut dyn Write) -> Result<(), WriteError> {
    Seen::of(header, surfaces)?;
    let mut triangles = 0;
    for surface in surfaces {
        each_triangle(*surface, &mut |_| {
            triangles += 1;
            Ok(())
        })?;
    }
    let count = u32::try_from(triangles).map_err(|_| WriteError::TooManyTriangles { triangles })?;
    out.write_all(&head(header))?;
    out.write_all(&count.to_le_bytes())?;
    for surface in surfaces {
        each_triangle(*surface, &mut |triangle| {
            let mut bytes = [0; 50];
            for (place, number) in bytes.chunks_exact_mut(4).zip(triangle.as_flattened()) {
                place.copy_from_slice(&number.to_le_bytes());
            }
            Ok(out.write_all(&bytes)?)
        })?;
    }
    Ok(())
}

/// The 80 free bytes. They must not begin with `solid`, which marks a text file.
fn head(header: &Header) -> [u8; 80] {
    let text = one_line(&format!("binary STL in mm; {}; {}; {}", header.program, header.spec, header.job));
    let mut bytes = [b' '; 80];
    for (byte, letter) in bytes.iter_mut().zip(text.chars()) {
        *byte = if letter.is_ascii() { letter as u8 } else { b'?' };
    }
    bytes
}

type Triangle = [[f32; 3]; 4];

/// The triangles between each row and the one before, as rows are handed over.
fn each_triangle(
    surface: &dyn Banded,
    take: &mut dyn FnMut(&Triangle) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    let columns = surface.outline().columns.count;
    let mut above: Vec<Point> = Vec::new();
    surface.bands(&mut |points| {
        let between = above.iter().chain(points).take(2 * above.len()).cloned().collect::<Vec<Point>>();
        for points in [&between, points] {
            let triangles = facets(points, columns).filter_map(|facet| triangle(points, facet));
            triangles.into_iter().try_for_each(|triangle| take(&triangle))?;
        }
        above = points[points.len().saturating_sub(columns)..].to_vec();
        Ok(())
    })
}

/// Normal and corners; nothing where the rounded corners leave no area.
fn triangle(points: &[Point], facet: [usize; 3]) -> Option<Triangle> {
    // Rounded first: the normal is that of the triangle in the file.
    let corners = facet.map(|at| points[at].position.map(single));
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let normal = unit(cross(sub(b, a), sub(c, a)))?.map(single);
    Some([normal, corners[0], corners[1], corners[2]])
}

/// The format's precision, without negative zeros.
fn single(value: f64) -> f32 {
    let single = value as f32;
    if single == 0.0 { 0.0 } else { single }
}

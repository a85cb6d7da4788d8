//! Surfaces as a binary STL mesh.

use std::io::{SeekFrom, Write};

use crate::files::error::WriteError;
use crate::files::regions::Target;
use crate::points::bands::{Banded, Seen, Surfaces};
use crate::points::dataset::Header;
use crate::points::facets::{Numbered, each_facet};
use crate::text::one_line;
use crate::vector::{cross, sub, unit};

/// Writes all patches as one binary STL mesh, mm.
///
/// A grid cell becomes two triangles along its shorter diagonal, or one where a single corner is not solved. They are
/// wound so that they face where the normals of the points do, out of the body. A triangle that has no area in the
/// format's single precision is left out. The surfaces are open: the mesh has no volume.
///
/// The points are asked for twice; the number of triangles is put in its place when they are written.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, there are more triangles than the format can count, or the
/// target refuses.
pub fn write_stl(surfaces: &Surfaces<'_>, out: &mut dyn Target) -> Result<(), WriteError> {
    Seen::of_surfaces(surfaces)?;
    out.write_all(&head(surfaces.header))?;
    let place = out.stream_position()?;
    out.write_all(&[0; 4])?;
    let mut triangles = 0;
    for surface in &surfaces.list {
        each_triangle(*surface, &mut |triangle| {
            triangles += 1;
            write_normal_and_corners(triangle, out)
        })?;
    }
    let count = u32::try_from(triangles).map_err(|_| WriteError::TooManyTriangles { triangles })?;
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(place))?;
    out.write_all(&count.to_le_bytes())?;
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

/// The 80 free bytes. They must not begin with `solid`, which marks a text file.
pub(crate) fn head(header: &Header) -> [u8; 80] {
    let text = one_line(&format!("binary STL in mm; {}; {}; {}", header.program, header.spec, header.job));
    let mut bytes = [b' '; 80];
    for (byte, letter) in bytes.iter_mut().zip(text.chars()) {
        *byte = if letter.is_ascii() { letter as u8 } else { b'?' };
    }
    bytes
}

type Triangle = [[f32; 3]; 4];

fn write_normal_and_corners(triangle: &Triangle, out: &mut (impl Write + ?Sized)) -> Result<(), WriteError> {
    let mut bytes = [0; 50];
    for (place, number) in bytes.chunks_exact_mut(4).zip(triangle.as_flattened()) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    Ok(out.write_all(&bytes)?)
}

/// Writes a triangle of a mesh, which has an area or none.
pub(crate) fn write_triangle(corners: [[f32; 3]; 3], out: &mut (impl Write + ?Sized)) -> Result<(), WriteError> {
    let normal = normal(corners).unwrap_or_default();
    write_normal_and_corners(&[normal, corners[0], corners[1], corners[2]], out)
}

/// Of the triangle in the file.
fn normal(corners: [[f32; 3]; 3]) -> Option<[f32; 3]> {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    Some(unit(cross(sub(b, a), sub(c, a)))?.map(single))
}

/// The triangles that have an area in the file.
fn each_triangle(
    surface: &dyn Banded,
    take: &mut dyn FnMut(&Triangle) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    each_facet(surface, &mut |corners| triangle(corners).map_or(Ok(()), |triangle| take(&triangle)))
}

/// Normal and corners; nothing where the rounded corners leave no area.
fn triangle(corners: [Numbered<'_>; 3]) -> Option<Triangle> {
    let corners = corners.map(|(_, point)| point.position.map(single));
    Some([normal(corners)?, corners[0], corners[1], corners[2]])
}

/// The format's precision, without negative zeros.
pub(crate) fn single(value: f64) -> f32 {
    let single = value as f32;
    if single == 0.0 { 0.0 } else { single }
}

//! Surfaces as a binary STL mesh.

use std::io::Write;

use crate::conventions::one_line;
use crate::dataset::{Dataset, Patch};
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
    dataset.check()?;
    let triangles =
        || dataset.patches.iter().flat_map(|patch| facets(patch).filter_map(|facet| triangle(patch, facet)));
    let triangles_there = triangles().count();
    let count =
        u32::try_from(triangles_there).map_err(|_| WriteError::TooManyTriangles { triangles: triangles_there })?;
    out.write_all(&head(dataset))?;
    out.write_all(&count.to_le_bytes())?;
    for triangle in triangles() {
        let mut bytes = [0; 50];
        for (place, number) in bytes.chunks_exact_mut(4).zip(triangle.as_flattened()) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        out.write_all(&bytes)?;
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

/// Normal and corners; nothing where the rounded corners leave no area.
fn triangle(patch: &Patch, facet: [usize; 3]) -> Option<[[f32; 3]; 4]> {
    // Rounded first: the normal is that of the triangle in the file.
    let corners = facet.map(|at| patch.points[at].position.map(single));
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let normal = unit(cross(sub(b, a), sub(c, a)))?.map(single);
    Some([normal, corners[0], corners[1], corners[2]])
}

/// The format's precision, without negative zeros.
fn single(value: f64) -> f32 {
    let single = value as f32;
    if single == 0.0 { 0.0 } else { single }
}

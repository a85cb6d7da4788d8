//! A body as a binary STL mesh.

use std::io::Write;

use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::points::stl::{head, single, write_triangle};
use crate::solid::BodyMesh;

/// Writes a body as one binary STL mesh, mm. A triangle two of whose corners are the same in the format's single precision is left out: the
/// mesh stays closed without it.
///
/// # Errors
/// When there are more triangles than the format can count, or the stream refuses.
pub fn write_body_stl(header: &Header, body: &BodyMesh<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| body.vertices[vertex as usize].map(single));
    let triangles = || body.triangles.iter().map(corners).filter(|[a, b, c]| a != b && b != c && c != a);
    let triangles_in_all = triangles().count();
    let count =
        u32::try_from(triangles_in_all).map_err(|_| WriteError::TooManyTriangles { triangles: triangles_in_all })?;
    out.write_all(&head(header))?;
    out.write_all(&count.to_le_bytes())?;
    triangles().try_for_each(|corners| write_triangle(corners, out))
}

//! A body as a Wavefront OBJ mesh.

use std::io::Write;

use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::points::obj::{remarks, vector_line};
use crate::solid::{BodyMesh, sentences};
use crate::text::one_line;

/// Writes a body as a Wavefront OBJ mesh, mm: one object, whose triangles share their vertices. Comments at the head state the conventions.
///
/// # Errors
/// When the stream refuses.
pub fn write_body_obj(header: &Header, body: &BodyMesh<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    remarks(header, &sentences(header), out)?;
    let [frame, name] = [body.frame, body.name].map(one_line);
    writeln!(out, "# frame {}\no {}", frame.trim_end_matches('\\'), name.trim_end_matches('\\'))?;
    let mut line = Vec::new();
    for vertex in body.vertices {
        vector_line("v", *vertex, &mut line);
        out.write_all(&line)?;
    }
    for triangle in body.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

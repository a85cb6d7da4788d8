//! A body as a 3MF package.

use std::io::Write;

use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::points::threemf::{write_head, write_package, write_vertex};
use crate::solid::{BodyMesh, sentences};
use crate::text::one_line;
use crate::text::xml::escaped;

/// Writes a body as one 3MF package in mm: an object of type `model`, which printers take for a body with a volume. Its metadata state the
/// conventions.
///
/// # Errors
/// When the stream refuses.
pub fn write_body_3mf(header: &Header, body: &BodyMesh<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    write_package(out, |model| write_model(header, body, model))
}

fn write_model(header: &Header, body: &BodyMesh<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    write_head(header, sentences(header), out)?;
    let name = escaped(&one_line(&format!("{} in {}", body.name, body.frame)));
    writeln!(out, "<resources>\n<object id=\"1\" type=\"model\" name=\"{name}\"><mesh>\n<vertices>")?;
    let mut line = Vec::new();
    body.vertices.iter().try_for_each(|vertex| write_vertex(*vertex, &mut line, out))?;
    writeln!(out, "</vertices>\n<triangles>")?;
    for [a, b, c] in body.triangles {
        writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
    }
    writeln!(out, "</triangles>\n</mesh></object>\n</resources>\n<build>\n<item objectid=\"1\"/>\n</build>\n</model>")?;
    Ok(())
}

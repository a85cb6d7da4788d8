//! A body as a 3MF package.

use std::io::Write;

use crate::files::error::WriteError;
use crate::points::dataset::Header;
use crate::points::threemf::{write_head, write_package, write_vertex};
use crate::solid::{BodyMesh, PlacedFrame, sentences};
use crate::text::number::shortest;
use crate::text::one_line;
use crate::text::xml::escaped;

/// Writes bodies where they stand as one 3MF package in mm: objects of type `model`, which printers take for bodies with a volume. Its metadata
/// state the conventions.
///
/// # Errors
/// When the stream refuses.
pub fn write_body_3mf(
    header: &Header,
    bodies: &[(BodyMesh<'_>, PlacedFrame)],
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    write_package(out, |model| write_model(header, bodies, model))
}

fn write_model(header: &Header, bodies: &[(BodyMesh<'_>, PlacedFrame)], out: &mut dyn Write) -> Result<(), WriteError> {
    write_head(header, sentences(header), out)?;
    writeln!(out, "<resources>")?;
    for (k, (body, _)) in bodies.iter().enumerate() {
        write_object(k + 1, body, out)?;
    }
    writeln!(out, "</resources>\n<build>")?;
    for (k, (_, place)) in bodies.iter().enumerate() {
        writeln!(out, "<item objectid=\"{}\"{}/>", k + 1, transform(*place))?;
    }
    Ok(writeln!(out, "</build>\n</model>")?)
}

/// The place of an item as the format has it: three rows and the origin. Nothing where it stands in its own frame.
fn transform(place: PlacedFrame) -> String {
    if place == PlacedFrame::default() {
        return String::new();
    }
    let numbers: Vec<String> = place.axes.iter().chain([&place.origin]).flatten().map(|x| shortest(*x)).collect();
    format!(" transform=\"{}\"", numbers.join(" "))
}

fn write_object(id: usize, body: &BodyMesh<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let name = escaped(&one_line(&format!("{} in {}", body.name, body.frame)));
    writeln!(out, "<object id=\"{id}\" type=\"model\" name=\"{name}\"><mesh>\n<vertices>")?;
    let mut line = Vec::new();
    body.vertices.iter().try_for_each(|vertex| write_vertex(*vertex, &mut line, out))?;
    writeln!(out, "</vertices>\n<triangles>")?;
    for [a, b, c] in body.triangles {
        writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
    }
    Ok(writeln!(out, "</triangles>\n</mesh></object>")?)
}

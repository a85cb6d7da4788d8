//! Surfaces as a 3MF package.

use std::io::{self, Write};

use zip::write::SimpleFileOptions;
use zip::{DateTime, ZipWriter};

use crate::files::error::WriteError;
use crate::points::bands::{Banded, Seen, Surfaces};
use crate::points::conventions::sentences_of_mesh;
use crate::points::dataset::Header;
use crate::points::facets::{count_facets, each_facet};
use crate::text::number::push_shortest;
use crate::text::one_line;
use crate::text::xml::escaped;

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

/// How hard the texts are packed: the usual level, 6, takes several times as long.
const FAST: i64 = 1;

/// Writes all patches as one 3MF package in mm: an object of type `surface` for each patch with a triangle, since open meshes have no
/// volume; triangles face out of the body. Its metadata state the conventions.
///
/// The points are asked for four times.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, or the stream refuses.
pub fn write_3mf(surfaces: &Surfaces<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    Seen::of_surfaces(surfaces)?;
    write_package(out, |model| write_model(surfaces, model))
}

/// A package around a model.
pub(crate) fn write_package(
    out: &mut dyn Write,
    write_model: impl Fn(&mut dyn Write) -> Result<(), WriteError>,
) -> Result<(), WriteError> {
    // one date for all, so that the same surfaces give the same bytes
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    let options = options.compression_level(Some(FAST));
    let mut package = ZipWriter::new_stream(out);
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        package.start_file(name, options).map_err(io::Error::from)?;
        package.write_all(text.as_bytes())?;
    }
    package.start_file("3D/3dmodel.model", options.large_file(true)).map_err(io::Error::from)?;
    let mut model = io::BufWriter::new(&mut package);
    write_model(&mut model)?;
    model.flush()?;
    drop(model);
    package.finish().map_err(io::Error::from)?.into_inner().flush()?;
    Ok(())
}

fn write_model(surfaces: &Surfaces<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    write_head(surfaces.header, sentences_of_mesh(surfaces.header), out)?;
    let mut drawn = Vec::new();
    for (k, surface) in surfaces.list.iter().enumerate() {
        if count_facets(*surface)? > 0 {
            drawn.push((k + 1, *surface));
        }
    }
    writeln!(out, "<resources>")?;
    drawn.iter().try_for_each(|(id, surface)| write_object(*id, *surface, out))?;
    writeln!(out, "</resources>\n<build>")?;
    drawn.iter().try_for_each(|(id, _)| writeln!(out, r#"<item objectid="{id}"/>"#))?;
    writeln!(out, "</build>\n</model>")?;
    Ok(())
}

/// The beginning of a model and its metadata.
pub(crate) fn write_head(header: &Header, sentences: Vec<String>, out: &mut dyn Write) -> Result<(), WriteError> {
    let text = |text: &str| escaped(&one_line(text));
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">"#
    )?;
    writeln!(out, r#"<metadata name="Title">{}</metadata>"#, text(&header.job))?;
    writeln!(out, r#"<metadata name="Application">{}</metadata>"#, text(&header.program))?;
    let about = [format!("spec: {}, hash {}", header.spec, header.spec_hash)];
    let about: Vec<String> = about.into_iter().chain(sentences).collect();
    writeln!(out, r#"<metadata name="Description">{}</metadata>"#, text(&about.join("; ")))?;
    Ok(())
}

fn write_object(id: usize, surface: &dyn Banded, out: &mut dyn Write) -> Result<(), WriteError> {
    let outline = surface.outline();
    let name = escaped(&one_line(&format!("{} in {}", outline.name, outline.frame)));
    writeln!(out, r#"<object id="{id}" type="surface" name="{name}"><mesh>"#)?;
    writeln!(out, "<vertices>")?;
    let mut line = Vec::new();
    surface.bands(&mut |points| {
        for point in points.iter().filter(|point| point.is_solved()) {
            write_vertex(point.position, &mut line, out)?;
        }
        Ok(())
    })?;
    writeln!(out, "</vertices>\n<triangles>")?;
    each_facet(surface, &mut |corners| {
        let [a, b, c] = corners.map(|(place, _)| place);
        Ok(writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?)
    })?;
    writeln!(out, "</triangles>\n</mesh></object>")?;
    Ok(())
}

/// A corner of triangles; `line` lends its memory.
pub(crate) fn write_vertex(position: [f64; 3], line: &mut Vec<u8>, out: &mut dyn Write) -> Result<(), WriteError> {
    line.clear();
    line.extend_from_slice(b"<vertex");
    for (name, number) in [" x=\"", " y=\"", " z=\""].iter().zip(position) {
        line.extend_from_slice(name.as_bytes());
        push_shortest(number, line);
        line.push(b'"');
    }
    line.extend_from_slice(b"/>\n");
    Ok(out.write_all(line)?)
}

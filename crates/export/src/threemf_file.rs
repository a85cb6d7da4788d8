//! Surfaces as a 3MF package.

use std::io::{self, Write};

use zip::write::SimpleFileOptions;
use zip::{DateTime, ZipWriter};

use crate::conventions::{one_line, sentences};
use crate::dataset::{Dataset, Patch};
use crate::error::WriteError;
use crate::facets::{Places, facets};
use crate::number::shortest;
use crate::xml::escaped;

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

/// Writes all patches as one 3MF package in mm: an object of type `surface` for each patch with a triangle, since open meshes have no
/// volume; triangles face out of the body. Its metadata state the conventions.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_3mf(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    // one date for all, so that the same dataset gives the same bytes
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    let mut package = ZipWriter::new_stream(out);
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        package.start_file(name, options).map_err(io::Error::from)?;
        package.write_all(text.as_bytes())?;
    }
    package.start_file("3D/3dmodel.model", options.large_file(true)).map_err(io::Error::from)?;
    let mut model = io::BufWriter::new(&mut package);
    write_model(dataset, &mut model)?;
    model.flush()?;
    drop(model);
    package.finish().map_err(io::Error::from)?.into_inner().flush()?;
    Ok(())
}

fn write_model(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    let header = &dataset.header;
    let text = |text: &str| escaped(&one_line(text));
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">"#
    )?;
    writeln!(out, r#"<metadata name="Title">{}</metadata>"#, text(&header.job))?;
    writeln!(out, r#"<metadata name="Application">{}</metadata>"#, text(&header.program))?;
    let about = [format!("spec: {}, hash {}", header.spec, header.spec_hash)];
    let about: Vec<String> = about.into_iter().chain(sentences(&dataset.header)).collect();
    writeln!(out, r#"<metadata name="Description">{}</metadata>"#, text(&about.join("; ")))?;
    let drawn = || {
        dataset
            .patches
            .iter()
            .enumerate()
            .filter(|(_, patch)| facets(&patch.points, patch.columns.count).next().is_some())
    };
    writeln!(out, "<resources>")?;
    drawn().try_for_each(|(k, patch)| write_object(k + 1, patch, out))?;
    writeln!(out, "</resources>\n<build>")?;
    drawn().try_for_each(|(k, _)| writeln!(out, r#"<item objectid="{}"/>"#, k + 1))?;
    writeln!(out, "</build>\n</model>")?;
    Ok(())
}

fn write_object(id: usize, patch: &Patch, out: &mut dyn Write) -> Result<(), WriteError> {
    let name = escaped(&one_line(&format!("{} in {}", patch.name, patch.frame)));
    writeln!(out, r#"<object id="{id}" type="surface" name="{name}"><mesh>"#)?;
    writeln!(out, "<vertices>")?;
    for point in patch.points.iter().filter(|point| point.is_solved()) {
        let [x, y, z] = point.position.map(shortest);
        writeln!(out, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#)?;
    }
    writeln!(out, "</vertices>\n<triangles>")?;
    let places = Places::of(patch);
    for facet in facets(&patch.points, patch.columns.count) {
        let [a, b, c] = facet.map(|at| places.of_point(at));
        writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
    }
    writeln!(out, "</triangles>\n</mesh></object>")?;
    Ok(())
}

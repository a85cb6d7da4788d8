//! Surfaces as a Wavefront OBJ mesh.

use std::io::Write;

use crate::files::error::WriteError;
use crate::points::bands::{Banded, Seen, Surfaces};
use crate::points::conventions::sentences_of_mesh;
use crate::points::dataset::{Header, Point};
use crate::points::facets::each_facet;
use crate::text::number::push_shortest;
use crate::text::one_line;

/// Writes all surfaces as one Wavefront OBJ mesh, one object for each: solved points in mm with their normals, and triangles
/// that face out of the body. Comments at the head state the conventions.
///
/// The points are asked for four times.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, or the stream refuses.
pub fn write_obj(surfaces: &Surfaces<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let (seen, header) = (Seen::of_surfaces(surfaces)?, surfaces.header);
    remarks(header, &sentences_of_mesh(header), out)?;
    let mut before = 0;
    for (surface, tally) in surfaces.list.iter().zip(&seen.tallies) {
        let outline = surface.outline();
        let [frame, name] = [&outline.frame, &outline.name].map(|text| one_line(text));
        writeln!(out, "# frame {}\no {}", frame.trim_end_matches('\\'), name.trim_end_matches('\\'))?;
        write_vectors(*surface, "v", |point| point.position, out)?;
        write_vectors(*surface, "vn", |point| point.normal, out)?;
        each_facet(*surface, &mut |corners| {
            // counted from 1, over all objects
            let [a, b, c] = corners.map(|(place, _)| before + place + 1);
            Ok(writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?)
        })?;
        before += tally.solved;
    }
    Ok(())
}

/// Where a mesh comes from and what is said of it, as comments.
pub(crate) fn remarks(header: &Header, sentences: &[String], out: &mut dyn Write) -> Result<(), WriteError> {
    let [program, spec, hash, job] =
        [&header.program, &header.spec, &header.spec_hash, &header.job].map(|text| one_line(text));
    let origin = format!("{program}; spec: {spec}, hash {hash}; job: {job}");
    // a backslash at the end of a line would join the next one to it
    let mut remarks = std::iter::once(&origin).chain(sentences).map(|text| text.trim_end_matches('\\'));
    Ok(remarks.try_for_each(|text| writeln!(out, "# {text}"))?)
}

/// The line of a vector, in place of what `line` held.
pub(crate) fn vector_line(letters: &str, vector: [f64; 3], line: &mut Vec<u8>) {
    line.clear();
    line.extend_from_slice(letters.as_bytes());
    for number in vector {
        line.push(b' ');
        push_shortest(number, line);
    }
    line.push(b'\n');
}

/// A vector of each solved point, one a line.
fn write_vectors(
    surface: &dyn Banded,
    letters: &str,
    vector: fn(&Point) -> [f64; 3],
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut line = Vec::new();
    surface.bands(&mut |points| {
        for point in points.iter().filter(|point| point.is_solved()) {
            vector_line(letters, vector(point), &mut line);
            out.write_all(&line)?;
        }
        Ok(())
    })
}

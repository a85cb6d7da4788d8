//! Surfaces as a Wavefront OBJ mesh.

use std::io::Write;

use crate::conventions::{one_line, sentences};
use crate::dataset::Dataset;
use crate::error::WriteError;
use crate::facets::{Places, facets};
use crate::number::shortest;

/// Writes all patches as one Wavefront OBJ mesh, one object for each patch: solved points in mm with their normals, and triangles
/// that face out of the body. Comments at the head state the conventions.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_obj(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    let header = &dataset.header;
    writeln!(out, "# {}; spec: {}; job: {}", one_line(&header.program), one_line(&header.spec), one_line(&header.job))?;
    sentences(&dataset.header).iter().try_for_each(|sentence| writeln!(out, "# {sentence}"))?;
    let mut before = 0;
    for patch in &dataset.patches {
        writeln!(out, "# frame {}\no {}", one_line(&patch.frame), one_line(&patch.name))?;
        let places = Places::of(patch);
        for (letters, vector) in
            [("v", (|point| point.position) as fn(&crate::dataset::Point) -> [f64; 3]), ("vn", |point| point.normal)]
        {
            for point in patch.points.iter().filter(|point| point.is_solved()) {
                let [x, y, z] = vector(point).map(shortest);
                writeln!(out, "{letters} {x} {y} {z}")?;
            }
        }
        for facet in facets(&patch.points, patch.columns.count) {
            // counted from 1, over all objects
            let [a, b, c] = facet.map(|at| before + places.of_point(at) + 1);
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        }
        before += places.solved;
    }
    Ok(())
}

//! Points of cases as files of a study.

use std::path::Path;

use flank_chain_dsl::Job;
use flank_export::{Axis, Dataset, Header, Patch, write_atomically, write_csv};

use super::super::inputs::StudyInput;
use super::SolvedSample;
use crate::project::failure::Failure;
use crate::solve::patch;
use crate::solve::points::placed;

/// What the files of all cases have in common.
pub(super) struct KeptPoints {
    header: Header,
    /// The sampled surfaces, without points.
    outlines: Vec<Patch>,
}

impl KeptPoints {
    pub(super) fn new(job: &Job<'_>, header: Header) -> KeptPoints {
        let outlines = job.surfaces.iter().filter_map(|surface| {
            let sample = surface.sample.as_ref()?;
            let axis = |k: usize| Axis { label: sample.labels[k].clone(), count: sample.counts[k] };
            Some(patch(job, &surface.name, surface, [axis(0), axis(1)], &[]))
        });
        KeptPoints { header, outlines: outlines.collect() }
    }

    /// Writes the points of a case as `flank solve` writes those of a job: CSV, with the inputs in its head.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn write<'i>(
        &self,
        file: &Path,
        inputs: impl Iterator<Item = (&'i StudyInput, &'i f64)>,
        points: &[SolvedSample],
    ) -> Result<(), Failure> {
        let given = inputs.map(|(input, value)| {
            let (name, value) = input.as_setting(*value);
            format!("in this case: {name} = {value}")
        });
        let conventions = self.header.conventions.iter().cloned().chain(given).collect();
        let header = Header { conventions, ..self.header.clone() };
        let patches = self.outlines.iter().zip(points).map(|(outline, (counts, points))| {
            let axis = |of: &Axis, k: usize| Axis { count: counts[k], ..of.clone() };
            let (rows, columns) = (axis(&outline.rows, 0), axis(&outline.columns, 1));
            // why a point is missing names other surfaces, which are not at hand where cases are compiled once
            let points = points.iter().map(|point| placed(point, String::new())).collect();
            Patch { rows, columns, points, ..outline.clone() }
        });
        let dataset = Dataset { header, patches: patches.collect() };
        Ok(write_atomically(file, |out| write_csv(&dataset.surfaces(), out))?)
    }
}

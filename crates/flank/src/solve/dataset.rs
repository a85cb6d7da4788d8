//! Solved surfaces as files and pictures take them.

use flank_chain_dsl::Job;
use flank_export::{Axis, Dataset, Header, Patch};

use crate::project::requests::JobSelection;
use crate::project::shown_path;
use crate::project::spec::Origin;
use crate::solve::limits::Line;
use crate::solve::points::patch;
use crate::solve::sensitivity::Sensitivity;
use crate::solve::solved::Solved;

/// The points of all surfaces, with all that is known of them, and lines on them.
pub(crate) fn dataset(job: &Job<'_>, solved: &[Solved<'_, '_>], lines: &[&Line<'_, '_>], header: Header) -> Dataset {
    let surfaces = solved.iter().map(|solved| {
        let axis = |k: usize| Axis { label: solved.sample.labels[k].clone(), count: solved.counts()[k] };
        let asked = solved.summary.asked;
        let name = match solved.streamed {
            Some(_) => format!("{} ({} of {asked} points drawn)", solved.surface.name, solved.points.len()),
            None => solved.surface.name.clone(),
        };
        let patch = patch(job, &name, solved.surface, [axis(0), axis(1)], &solved.points);
        let moved = solved.sensitivity.iter().flat_map(Sensitivity::fields);
        Patch { fields: solved.fields.iter().cloned().chain(moved).collect(), ..patch }
    });
    let lines = lines.iter().filter(|line| line.summary.solved() > 0).filter_map(|line| line.patch(job));
    Dataset { header, patches: surfaces.chain(lines).collect() }
}

/// Where the data of a job comes from; of further jobs what was set by hand.
pub(crate) fn header(jobs: &[&Job<'_>], which: &JobSelection, origin: &Origin) -> Header {
    let settings = which.set_in(jobs).into_iter().map(|(name, value)| format!("set by hand: {name} = {value}"));
    Header {
        program: concat!("flank ", env!("CARGO_PKG_VERSION")).to_string(),
        spec: shown_path(which.file()),
        spec_hash: format!("sha256:{}", origin.hash),
        job: jobs.first().map_or(String::new(), |job| job.name.clone()),
        conventions: settings.collect(),
    }
}

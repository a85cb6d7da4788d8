//! Points that several parts of one operation ask for: a sample is solved once, by whoever comes first.

use std::sync::{Arc, Mutex, PoisonError};

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_solver::{GridReport, SurfacePoint};

use crate::solve::secondary::Positions;

/// What is known of samples of one compilation.
#[derive(Debug, Default)]
pub(crate) struct SolvedOnce {
    samples: Mutex<Vec<(Key, Solved)>>,
}

/// The points of a sample as they are solved, or without those that are cut away, and what it took to find them.
#[derive(Clone, Debug)]
pub(crate) struct Solved {
    pub(crate) points: Vec<SurfacePoint>,
    pub(crate) effort: GridReport,
    /// Of the tool, that points were checked against; none where they are as they were solved.
    pub(crate) positions: Option<Positions>,
}

/// Names of job and surface, and where points are asked for.
#[derive(Debug, PartialEq)]
struct Key {
    names: [String; 2],
    coordinates: [String; 2],
    counts: [usize; 2],
    targets: Arc<[[f64; 2]]>,
    is_judged: bool,
}

impl SolvedOnce {
    /// The points of the sample of a surface; those that are judged are known apart.
    pub(crate) fn sample(
        &self,
        (job, surface): (&Job<'_>, &GeneratedSurface<'_>),
        sample: &Sample<'_>,
        is_judged: bool,
        solve: impl FnOnce() -> Solved,
    ) -> Solved {
        let key = Key {
            names: [job.name.clone(), surface.name.clone()],
            coordinates: sample.coordinates.each_ref().map(|coordinate| coordinate.name.clone()),
            counts: sample.counts,
            targets: sample.targets().into(),
            is_judged,
        };
        let known = || self.samples.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, found)) = known().iter().find(|(other, _)| *other == key) {
            return found.clone();
        }
        let found = solve();
        known().push((key, found.clone()));
        found
    }
}

//! What several parts of one operation ask of a sample: it is found once, by whoever comes first.

use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

use flank_chain_dsl::{GeneratedSurface, Job, Sample};

/// What is known of samples of one compilation.
#[derive(Debug, Default)]
pub(crate) struct KnownSamples {
    samples: Mutex<Vec<(Key, Arc<dyn Any + Send + Sync>)>>,
}

/// Names of job and surface, where points are asked for, and what is asked of them.
#[derive(Debug, PartialEq)]
struct Key {
    names: [String; 2],
    coordinates: [String; 2],
    counts: [usize; 2],
    targets: Vec<[f64; 2]>,
    what: &'static str,
}

impl KnownSamples {
    /// What is asked of the sample of a surface.
    pub(super) fn find<Found: Clone + Send + Sync + 'static>(
        &self,
        (job, surface): (&Job<'_>, &GeneratedSurface<'_>),
        sample: &Sample<'_>,
        what: &'static str,
        find: impl FnOnce() -> Found,
    ) -> Found {
        let key = Key {
            names: [job.name.clone(), surface.name.clone()],
            coordinates: sample.coordinates.each_ref().map(|coordinate| coordinate.name.clone()),
            counts: sample.counts,
            targets: sample.targets(),
            what,
        };
        let known = || self.samples.lock().unwrap_or_else(PoisonError::into_inner);
        let before = known().iter().find(|(other, _)| *other == key).map(|(_, found)| Arc::clone(found));
        if let Some(before) = before.as_deref().and_then(<dyn Any + Send + Sync>::downcast_ref::<Found>) {
            return before.clone();
        }
        let found = find();
        known().push((key, Arc::new(found.clone())));
        found
    }
}

//! Millings on a page: what they leave as colours of the flanks, and the cutters on their passes.

use flank_chain_dsl::Job;
use flank_draw::PageMilling;
use flank_export::{Field, Patch, Values};
use rayon::prelude::*;

use crate::convert::milling::flank::MilledFlank;
use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::solve::solved::Solved;

/// Adds what each milling leaves to the points of the surface that it mills; returns the cutters on their passes, and what cannot be milled.
///
/// # Errors
/// If a cutter is none, something that it keeps clear of is not sampled, or the work is cancelled.
pub(super) fn add_left(
    job: &Job<'_>,
    solved: &[Solved<'_, '_>],
    patches: &mut [Patch],
    (jobs, session): (&JobSelection, Session<'_>),
) -> Result<(Vec<PageMilling>, Vec<NotDone>), Failure> {
    let (mut pages, mut missing) = (Vec::new(), Vec::new());
    for milling in &job.millings {
        let name = &job.surfaces[milling.surface].name;
        let Some(at) = solved.iter().position(|solved| solved.surface.name == *name) else { continue };
        let flank = match MilledFlank::on_page(job, milling, at, (jobs, session))? {
            Ok((flank, page)) => {
                pages.push(page);
                flank
            }
            Err(why) => {
                missing.extend(why);
                continue;
            }
        };
        let points = &patches[at].points;
        let left = |point: &flank_export::Point| {
            let left = point.is_solved().then(|| flank.left(point.position)).flatten()?;
            Some(1e3 * (left - flank.stock()))
        };
        let values: Vec<Option<f64>> = points.par_iter().map(left).collect();
        patches[at].fields.push(Field {
            name: format!("left by {}", milling.name),
            unit: "um".to_string(),
            meaning: format!("height of what {} leaves over the surface beside the stock", milling.cutter_name),
            values: Values::Scalars(values.into_iter().collect()),
        });
        missing.extend(flank.not_done);
    }
    Ok((pages, missing))
}

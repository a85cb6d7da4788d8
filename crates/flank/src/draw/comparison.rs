//! One surface compared with another one, as a map and as a topography.

use flank_chain_dsl::Job;
use flank_draw::{PictureOptions, topography};
use flank_export::Dataset;

use super::result::PlotResult;
use super::{Drawing, options, told, with_origin, write};
use crate::compare::deviation;
use crate::compare::map::{DeviationMap, find};
use crate::project::choices::{Choice, PlotKind};
use crate::project::failure::Failure;
use crate::project::requests::PlotRequest;
use crate::project::session::Session;
use crate::project::spec::Origin;

/// What there is to draw of a comparison.
const KINDS: [PlotKind; 2] = [PlotKind::Deviation, PlotKind::Topography];

/// # Errors
/// In words, if the request do not compare two surfaces.
pub(super) fn check(request: &PlotRequest) -> Result<(), Failure> {
    if request.surface.len() != 1 {
        let message = "option `reference` holds one surface against another one: name one with option `surface`";
        return Err(Failure::Request(message.to_string()));
    }
    match request.what.iter().find(|what| !KINDS.contains(what)) {
        Some(other) => {
            let (other, kinds) = (other.name(), KINDS.map(PlotKind::name).join(", "));
            let message =
                format!("option `what {other}` does not compare surfaces\nwhat fits with option `reference`: {kinds}");
            Err(Failure::Request(message))
        }
        None => Ok(()),
    }
}

/// # Errors
/// In words: what is missing, or does not fit.
pub(super) fn plot(
    jobs: &[Job<'_>],
    from: &str,
    (request, session): (&PlotRequest, Session<'_>),
    origin: &Origin,
) -> Result<PlotResult, Failure> {
    let surface = find(jobs, &request.surface[0])?;
    let measured = deviation::measure([surface, find(jobs, from)?], false, session)?;
    let asked = if request.what.is_empty() { &KINDS[..] } else { &request.what };
    let drawings: Vec<(PlotKind, Drawing)> =
        asked.iter().map(|&what| (what, draw(&measured, what, request, origin, &options(request)))).collect();
    let written = write(&drawings, &surface.whole_name(), (request, session), origin)?;
    Ok(told(&surface.job.name, written, measured.missing(origin), request))
}

fn draw(
    measured: &DeviationMap<'_, '_>,
    what: PlotKind,
    request: &PlotRequest,
    origin: &Origin,
    options: &PictureOptions,
) -> Drawing {
    let dataset = measured.dataset(&request.jobs, origin);
    let dataset = Dataset { header: with_origin(dataset.header, request), ..dataset };
    let title = measured.title();
    let picture = match what {
        PlotKind::Topography => topography(&dataset, &title, &[(0, 0)], &measured.note(), options),
        _ => measured.picture(&dataset, options),
    };
    Drawing { picture, shows: format!("deviation of {title}") }
}

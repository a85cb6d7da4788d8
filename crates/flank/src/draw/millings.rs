//! Pictures of millings.

use flank_chain_dsl::{Job, Milling};
use flank_draw::{MillingDrawing, PictureOptions};
use flank_export::Header;

use super::Drawing;
use crate::convert::milling::drawn;
use crate::project::choices::PlotKind;
use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::requests::{MillRequest, PlotRequest};
use crate::project::session::Session;

/// Why they do not fit a job.
pub(super) const NONE: &str = "no `mill` of it says which surface is milled";

/// # Errors
/// In words, if the request names a milling and draws none.
pub(super) fn check(request: &PlotRequest) -> Result<(), Failure> {
    if request.milling.is_some() && !request.what.contains(&PlotKind::Milling) {
        let message = "option `milling` is of pictures of a milling: add `milling` to option `what`".to_string();
        return Err(Failure::Request(message));
    }
    Ok(())
}

/// The milling of a job that is meant: the one that is named, or the first.
///
/// # Errors
/// In words, if the job has no milling of that name.
pub(super) fn of_job<'j, 'g>(job: &'j Job<'g>, request: &PlotRequest) -> Result<Option<&'j Milling<'g>>, Failure> {
    let Some(name) = &request.milling else { return Ok(job.millings.first()) };
    let found = job.millings.iter().find(|milling| milling.name == *name);
    let known = || job.millings.iter().map(|milling| format!("`{}`", milling.name)).collect::<Vec<String>>().join(", ");
    match found {
        None if !job.millings.is_empty() => {
            Err(Failure::from(format!("there is no milling `{name}`; there is: {}", known())))
        }
        found => Ok(found),
    }
}

/// A picture of a milling with what of it was not done; no picture where there is no plan.
///
/// # Errors
/// If the cutter is none, something that it keeps clear of is not sampled, or the work is cancelled.
pub(super) fn drawing(
    job: &Job<'_>,
    milling: &Milling<'_>,
    request: &PlotRequest,
    (header, session): (Header, Session<'_>),
) -> Result<(Option<Drawing>, Vec<NotDone>), Failure> {
    let wanted = MillRequest::new(request.jobs.clone());
    let (result, drawn) = drawn::shown(job, milling, &wanted, (header, session))?;
    let drawing = drawn.map(|drawn| draw(&drawn, &super::options(request)));
    Ok((drawing, result.not_done))
}

/// A milling as a picture.
pub(crate) fn draw(drawn: &MillingDrawing, options: &PictureOptions) -> Drawing {
    let picture = flank_draw::milling(drawn, options);
    Drawing { picture, shows: format!("ridges, clearances and rotary axes of {}", drawn.title) }
}

//! Pictures of contacts.

use flank_chain_dsl::{Contact, Job};
use flank_draw::{ContactPicture, DrawnContact, PictureOptions};
use flank_export::Header;

use super::{Drawing, Unfit};
use crate::contact;
use crate::contact::picture::{about, drawing, names};
use crate::project::choices::{Choice, PlotKind};
use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::requests::{ContactRequest, PlotRequest};
use crate::project::session::Session;

/// The kinds that show contacts.
pub(crate) const KINDS: [PlotKind; 4] = [PlotKind::Pattern, PlotKind::Error, PlotKind::Gap, PlotKind::Path];

/// Why they do not fit a job.
pub(super) const NONE: &str = "no `contact` of it says which flanks touch";

/// # Errors
/// In words, if the request says of contacts what none of its pictures shows.
pub(super) fn check(request: &PlotRequest) -> Result<(), Failure> {
    let of_contacts = [
        ("contact", !request.contact.is_empty()),
        ("error", !request.errors.is_empty()),
        ("compound", request.compound.is_some()),
        ("positions", request.positions.is_some()),
    ];
    let said = of_contacts.into_iter().find(|(_, is_said)| *is_said);
    match said.filter(|_| !request.what.iter().any(|what| KINDS.contains(what))) {
        Some((option, _)) => {
            let kinds = KINDS.map(PlotKind::name).join(", ");
            let message =
                format!("option `{option}` is of pictures of a contact: add one of them to option `what`: {kinds}");
            Err(Failure::Request(message))
        }
        None => Ok(()),
    }
}

/// The contacts of a job that are meant: those that are named, or all.
pub(super) fn of_job<'j, 'g>(job: &'j Job<'g>, request: &PlotRequest) -> Vec<&'j Contact<'g>> {
    let is_meant = |contact: &&Contact<'_>| request.contact.is_empty() || request.contact.contains(&contact.name);
    job.contacts.iter().filter(is_meant).collect()
}

/// # Errors
/// In words, if a contact is named that no job has.
pub(super) fn check_names(jobs: &[Job<'_>], request: &PlotRequest) -> Result<(), Failure> {
    let known = || jobs.iter().flat_map(|job| &job.contacts).map(|contact| contact.name.as_str());
    match request.contact.iter().find(|name| !known().any(|other| other == *name)) {
        Some(name) if known().next().is_some() => {
            let known = known().map(|name| format!("`{name}`")).collect::<Vec<String>>().join(", ");
            Err(Failure::from(format!("there is no contact `{name}`; there is: {known}")))
        }
        _ => Ok(()),
    }
}

/// Contacts of a job as pictures show them, and what of them was not found.
#[derive(Default)]
pub(crate) struct Solved {
    pub(super) contacts: Vec<DrawnContact>,
    pub(super) not_done: Vec<NotDone>,
}

/// # Errors
/// If an error names no axis of a pair, a flank is not sampled, or the work is cancelled.
pub(super) fn solved(job: &Job<'_>, request: &PlotRequest, session: Session) -> Result<Solved, Failure> {
    let plain = ContactRequest::new(request.jobs.clone());
    let wanted = ContactRequest {
        errors: request.errors.clone(),
        compound: request.compound.unwrap_or(plain.compound),
        positions: request.positions.unwrap_or(plain.positions),
        ..plain
    };
    let mut solved = Solved::default();
    for contact in of_job(job, request) {
        let (result, drawn) = contact::shown(job, contact, &wanted, session)?;
        solved.not_done.extend(result.not_done);
        solved.contacts.extend(drawn);
    }
    Ok(solved)
}

/// What is asked for of contacts; nothing of contacts that are not found.
///
/// # Errors
/// The first kind that does not fit the job, and why.
pub(super) fn drawings(
    job: &Job<'_>,
    found: &Solved,
    request: &PlotRequest,
    header: &Header,
) -> Result<Vec<(PlotKind, Drawing)>, (PlotKind, Unfit)> {
    let mut asked = request.what.iter().copied().filter(|what| KINDS.contains(what));
    if of_job(job, request).is_empty() {
        return asked.next().map_or(Ok(Vec::new()), |what| Err((what, NONE.to_string())));
    }
    if found.contacts.is_empty() {
        return Ok(Vec::new());
    }
    let options = super::options(request);
    Ok(asked.map(|what| (what, draw(&job.name, &found.contacts, what, (header.clone(), &options)))).collect())
}

/// A picture of contacts of a job.
pub(crate) fn draw(
    job: &str,
    contacts: &[DrawnContact],
    what: PlotKind,
    (header, options): (Header, &PictureOptions),
) -> Drawing {
    let kind = match what {
        PlotKind::Pattern => ContactPicture::Pattern,
        PlotKind::Error => ContactPicture::Error,
        PlotKind::Gap => ContactPicture::Gap,
        _ => ContactPicture::Path,
    };
    let drawing = drawing(job, contacts.to_vec(), kind, header);
    let shows = format!("{} of {}", about(kind), names(contacts));
    Drawing { picture: flank_draw::contact(kind, &drawing, options), shows }
}

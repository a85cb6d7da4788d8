//! What scatters: settings of a job, and axes of the machines of its contacts.

use flank_chain_dsl::{Contact, Dimension, Job, Parameter, ValueSource};

use crate::compare::fit::settings::find;
use crate::project::failure::Failure;
use crate::project::requests::ToleranceRequest;
use crate::project::units;
use crate::solve::sensitivity::usual_change;

/// The usual errors of a mounting, mm and radians.
const A_LENGTH: f64 = 0.01;
const AN_ANGLE: f64 = std::f64::consts::PI / 180.0 / 60.0;

/// Where a cause stands in its job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum CausePlace {
    /// Among the parameters.
    Setting(usize),
    /// Of the first contact that has it the axis.
    Axis(usize, usize),
}

/// A setting or an axis that scatters.
pub(super) struct Cause {
    pub(super) at: CausePlace,
    pub(super) name: String,
    pub(super) dimension: Dimension,
    /// mm, radians; 0 of an axis.
    pub(super) value: f64,
    /// One standard deviation.
    pub(super) scatter: f64,
}

impl Cause {
    /// The parameter, unless it is an axis.
    pub(super) fn setting<'j, 'g>(&self, job: &'j Job<'g>) -> Option<&'j Parameter<'g>> {
        match self.at {
            CausePlace::Setting(at) => Some(&job.parameters[at]),
            CausePlace::Axis(..) => None,
        }
    }
}

/// The causes that are named, or all with a usual change; settings in the order of the job, then axes. Contacts are given by their places.
///
/// # Errors
/// If one is not there, named twice, or has an amount of another kind.
pub(super) fn causes(job: &Job<'_>, contacts: &[usize], request: &ToleranceRequest) -> Result<Vec<Cause>, Failure> {
    if request.scatter.is_empty() {
        return Ok(usual(job, contacts));
    }
    let mut causes: Vec<Cause> = Vec::new();
    for (name, amount) in &request.scatter {
        let cause = match axis(job, contacts, name) {
            Some(cause) => cause,
            None => setting(job, find(job, name)?),
        };
        if causes.iter().any(|known| known.at == cause.at) {
            return Err(Failure::Request(format!("option `scatter` names `{name}` twice: leave one of them out")));
        }
        let scatter = amount
            .inside(cause.dimension, cause.value)
            .ok_or_else(|| Failure::Input(amount.refused("scatter", name, (cause.dimension, cause.value))))?;
        causes.push(Cause { scatter, ..cause });
    }
    causes.sort_by_key(|cause| cause.at);
    Ok(causes)
}

fn setting(job: &Job<'_>, at: usize) -> Cause {
    let of = &job.parameters[at];
    Cause {
        at: CausePlace::Setting(at),
        name: of.name.clone(),
        dimension: of.dimension,
        value: of.value,
        scatter: usual_scatter(of),
    }
}

/// An error lies within its range with three standard deviations to both sides; all else is off by a usual change.
fn usual_scatter(of: &Parameter<'_>) -> f64 {
    let width = of.range.filter(|_| of.is_error).map(|(low, high)| high - low);
    width.map_or_else(|| usual_change(of), |width| width / 6.0)
}

/// An axis of one of the contacts.
fn axis(job: &Job<'_>, contacts: &[usize], name: &str) -> Option<Cause> {
    let own = |contact: usize| job.contacts[contact].errors.iter().position(|axis| axis.name == name);
    let (contact, at) = contacts.iter().find_map(|contact| Some((*contact, own(*contact)?)))?;
    Some(axis_of(&job.contacts[contact], (contact, at)))
}

fn axis_of(of: &Contact<'_>, (contact, at): (usize, usize)) -> Cause {
    let axis = &of.errors[at];
    let scatter = if units::is_angle(axis.dimension) { AN_ANGLE } else { A_LENGTH };
    Cause { at: CausePlace::Axis(contact, at), name: axis.name.clone(), dimension: axis.dimension, value: 0.0, scatter }
}

/// All that the job gives a value, errors of its machines, and all axes that are not driven.
fn usual(job: &Job<'_>, contacts: &[usize]) -> Vec<Cause> {
    let is_given =
        |of: &Parameter<'_>| !of.is_count && (of.is_error || !matches!(of.given_by, ValueSource::Definition(_)));
    let settings = (0..job.parameters.len()).filter(|at| is_given(&job.parameters[*at])).map(|at| setting(job, at));
    let mut causes: Vec<Cause> = settings.collect();
    for &contact in contacts {
        let of = &job.contacts[contact];
        let still = (0..of.errors.len()).filter(|at| !of.errors[*at].is_driven);
        for cause in still.map(|at| axis_of(of, (contact, at))) {
            if !causes.iter().any(|known| known.name == cause.name) {
                causes.push(cause);
            }
        }
    }
    causes
}

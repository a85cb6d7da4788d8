//! A contact that is compiled once for many values of settings and mounting errors.

use flank_chain_dsl::{Contact, Dimension, Job, Parameter};
use flank_solver::{ContactPoint, ContactProblem, ContactState, FlankCorners, Outcome};

use crate::contact::place::{corners, fine};
use crate::contact::rolling::Rolling;
use crate::contact::{Rolled, rolled};
use crate::project::failure::Failure;
use crate::project::requests::ContactRequest;
use crate::project::session::Session;
use crate::project::units;

/// A pair whose axes and settings stay open, with its contact as the job itself has it.
pub(crate) struct ContactFamily {
    problem: ContactProblem,
    /// The contact of the job itself that others are followed from, and what that of the middle is like.
    first: ContactPoint,
    is_vertex: bool,
    state: Option<ContactState>,
    /// Positions of a pitch, how far it is, if that is known, and the ends of the roll.
    steps: usize,
    every: Option<f64>,
    limits: [f64; 2],
    film: f64,
    lag: Dimension,
    corners: Option<FlankCorners>,
}

/// The numbers of a contact that differ from case to case, in the units that people read; those that are not known are missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactNumbers {
    pub(crate) peak_to_peak: Option<f64>,
    /// The lag in the middle.
    pub(crate) lag: f64,
    pub(crate) ratio: Option<f64>,
    /// Where the middle lies on the second flank: shares from toe to heel and from root to tip, height and radius.
    pub(crate) shares: Option<[f64; 2]>,
    pub(crate) place: [f64; 2],
    /// Half axes of the ellipse in the middle, the longer one first.
    pub(crate) ellipse: Option<[f64; 2]>,
}

impl ContactFamily {
    /// With some axes of the pair's machine and some settings open. `None` where these change the pitch, and where something is not as it
    /// should be in the contact of the job itself, which each case is then asked for by itself.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn new<'g>(
        job: &Job<'g>,
        contact: &Contact<'g>,
        (axes, settings): (&[usize], &[&Parameter<'g>]),
        request: &ContactRequest,
        session: Session,
    ) -> Result<Option<ContactFamily>, Failure> {
        let Rolled { result, members, found } = match rolled(job, contact, request, session) {
            Err(Failure::Cancelled) => return Err(Failure::Cancelled),
            Err(_) => return Ok(None),
            Ok(rolled) => rolled,
        };
        let Some((rolling, _)) = found.filter(|_| result.not_done.is_empty()) else { return Ok(None) };
        let Some(middle) = rolling.middle() else { return Ok(None) };
        Ok(members.open_in(job, axes, settings).map(|problem| ContactFamily {
            problem,
            is_vertex: rolling.vertex.is_some(),
            state: middle.state,
            first: rolling.first.clone(),
            steps: request.positions as usize,
            every: members.pitch(job),
            limits: [contact.roll.low, contact.roll.high],
            film: request.compound,
            lag: contact.lag.dimension,
            corners: corners(members.surfaces[1]),
        }))
    }

    /// With values of the axes and then of the settings, followed from the contact of the job itself: `None` where it is lost, or of
    /// another kind.
    pub(crate) fn at(&self, values: &[f64]) -> Option<ContactNumbers> {
        let problem = self.problem.with_values(values);
        let first = problem.again(&self.first, self.first.roll).filter(|first| first.edges == self.first.edges)?;
        let rolling = Rolling::from_first(problem, first, (self.steps, self.every), self.limits);
        let middle = rolling.middle().filter(|middle| middle.outcome == Outcome::Solved)?;
        let is_alike = rolling.vertex.is_some() == self.is_vertex && middle.state == self.state;
        if !is_alike || rolling.outside() > 0 {
            return None;
        }
        let [x, y, z] = middle.in_members[1];
        let place = [z, x.hypot(y)];
        let span = rolling.span(&rolling.transfers());
        Some(ContactNumbers {
            peak_to_peak: span.map(|[low, high]| fine(self.lag, high - low)),
            lag: units::shown(self.lag, middle.lag),
            ratio: rolling.ratio(&rolling.flank_ends()),
            shares: self.corners.and_then(|corners| corners.shares(place)).map(|[v, u]| [u, v]),
            place,
            ellipse: middle.ellipse(self.film).map(|[short, long]| [long, short]),
        })
    }
}

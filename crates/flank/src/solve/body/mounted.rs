//! Where the bodies of a pair stand in their housing while they mesh.

use flank_chain_dsl::Job;
use flank_expr::{ScalarEvaluator, Tape};
use schemars::JsonSchema;
use serde::Serialize;

use crate::contact::pair::Members;
use crate::contact::pattern::on_both;
use crate::contact::rolling::Rolling;
use crate::contact::summary::penetration;
use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::session::Session;

/// Steps over a pitch at which the contact is followed: its middle is all that is wanted.
const STEPS: usize = 12;
/// Flanks are compared while they are near enough for a film of this, mm: what they reach into each other does not depend on it.
const FILM: f64 = 0.0;

/// Bodies of a job as a contact has them in mesh.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Mounting {
    /// The contact in whose middle they stand.
    pub contact: String,
    /// Of the motion that the pair rolls by, rad or mm.
    pub roll: f64,
    /// Of the unknown of the contact, rad or mm.
    pub lag: f64,
    /// Both members.
    pub members: Vec<MountedSolid>,
}

/// A body in the frame of the pair's machine.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct MountedSolid {
    /// Its name.
    pub solid: String,
    /// Of the origin of its frame.
    pub origin_mm: [f64; 3],
    /// The directions of the x, y and z of its frame.
    pub axes: [[f64; 3]; 3],
}

/// The bodies in the middle of the first contact that has both, and whether they reach into each other over a pitch; nothing where there is
/// none.
///
/// # Errors
/// If a flank is not sampled, the flanks do not touch, or the work is cancelled.
pub(crate) fn mounting(job: &Job<'_>, session: Session<'_>) -> Result<Option<(Mounting, Option<NotDone>)>, Failure> {
    let has_both = |surfaces: &[usize; 2]| {
        surfaces.iter().all(|surface| job.solids.iter().any(|solid| solid.space.contains(surface)))
    };
    let Some(contact) = job.contacts.iter().find(|contact| has_both(&contact.surfaces)) else { return Ok(None) };
    let mut members = Members::solved(job, contact, session)?;
    let errors = vec![0.0; contact.errors.len()];
    let rolling = Rolling::of_members(job, &mut members, &errors, STEPS).ok();
    let touch = rolling.as_ref().and_then(Rolling::middle);
    let Some((roll, lag)) = touch.map(|point| (point.roll, point.lag)) else {
        return Err(format!("the flanks of contact `{}` do not touch", contact.name).into());
    };
    let pair = members.pair(job, &errors, &[]);
    let told = rolling.and_then(|rolling| penetration(&members, &on_both(&members, &pair, &rolling, FILM)));
    let placed = |(k, placement): (usize, &flank_expr::geometry::Chain<'_>)| {
        let tape = Tape::new(&placement.pose().matrix4().concat(), &[contact.roll.variable, contact.lag.variable])
            .expect("a job without errors leaves nothing unbound");
        let mut rows = [0.0; 16];
        ScalarEvaluator::new(&tape).run(&[roll, lag], &mut rows);
        let column = |at: usize| [0, 1, 2].map(|row: usize| rows[4 * row + at]);
        MountedSolid {
            solid: members.solids[k].map_or_else(String::new, |solid| solid.name.clone()),
            origin_mm: column(3),
            axes: [0, 1, 2].map(column),
        }
    };
    let placed = pair.placements.iter().enumerate().map(placed).collect();
    Ok(Some((Mounting { contact: contact.name.clone(), roll, lag, members: placed }, told)))
}

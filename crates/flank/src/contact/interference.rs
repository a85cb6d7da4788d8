//! Whether the edges of a tooth come too near to what its mate's tooth space has beside the flank: fillet and root.
//!
//! A place of an edge touches such a surface at a lag of its own. As long as that opens the pair less than the lag with which it rolls, there
//! is room.

use flank_chain_dsl::Job;
use flank_solver::{ContactProblem, SurfacePoint};

use crate::contact::edge_places::edges;
use crate::contact::fouling;
use crate::contact::least_room::least_between;
use crate::contact::pair::Members;
use crate::contact::result::Clearance;
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::session::Session;
use crate::project::units;

/// Room below this is no rounding: the tooth cuts into its mate, mm.
const REACHES_IN: f64 = -1e-7;

/// What is known of the room in tooth spaces.
pub(crate) struct Rooms {
    pub(crate) clearances: Vec<Clearance>,
    pub(crate) not_done: Vec<NotDone>,
    pub(crate) remarks: Vec<Remark>,
}

/// Of each other surface of the tooth spaces the least room, what of them is cut into, and what is not looked at.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn of_spaces(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    errors: &[f64],
    rolling: &Rolling,
    session: Session,
) -> Result<Rooms, Failure> {
    let (others, unknown) = members.beside(job, session)?;
    let edges = [0, 1].map(|flank| edges(job, members, flank, session));
    let mut clearances = Vec::new();
    for other in &others {
        session.check()?;
        clearances.extend(clearance(job, members, other, (errors, rolling), &edges));
    }
    let cuts = |room: &&Clearance| room.least_mm < REACHES_IN;
    clearances.extend(fouling::of_flanks(job, members, (errors, rolling), (&edges, REACHES_IN), session)?);
    let name = &members.contact.name;
    let not_done = clearances.iter().filter(cuts).map(|room| {
        let Clearance { of, with, .. } = room;
        let least = units::scientific(-room.least_mm, 2);
        NotDone::new(
            NotDoneKind::Penetration,
            of,
            format!("contact {name}: an edge of {of} cuts {least} mm into {with}"),
        )
    });
    let not_done: Vec<NotDone> = not_done.collect();
    let remarks = unknown.into_iter().map(|surface| {
        let message =
            format!("contact {name}: {surface} is not sampled: whether the mate cuts into it is not looked at");
        Remark::new(RemarkKind::NotLookedAt, surface, message)
    });
    Ok(Rooms { not_done, remarks: remarks.collect(), clearances })
}

/// The least room between the edges of a flank and a surface of the mate's space; `None` where they never come together, or keep the pair
/// from moving the other way, as the opposite flank does.
fn clearance<'g>(
    job: &Job<'g>,
    members: &Members<'_, 'g>,
    other: &Members<'_, 'g>,
    (errors, rolling): (&[f64], &Rolling),
    edges: &[Vec<SurfacePoint>; 2],
) -> Option<Clearance> {
    let of = usize::from(other.surfaces[0].name == members.surfaces[0].name);
    let flank = 1 - of;
    let edges = &edges[flank];
    let pair = other.pair(job, errors, &[]);
    let pair = if flank == 0 { pair } else { pair.swapped() };
    let problem = ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound");
    let opens = rolling.middle()?.opening.signum();
    let room = |places: &[SurfacePoint], roll: f64, lag: f64| -> Vec<Option<f64>> {
        let passed = problem.passed(roll, lag, [places, &other.points[of]]).into_iter();
        let of_place = |[there, opening]: [f64; 2]| (opening * opens > 0.0).then_some((lag - there) * opening);
        passed.map(|place| place.and_then(of_place)).collect()
    };
    let rolls: Vec<f64> = rolling.all_steps().map(|step| rolling.roll(step)).collect();
    let at_step = |step: isize| {
        let carried = rolling.engagement.carried(step);
        carried.map_or(vec![None; edges.len()], |carried| room(edges, rolling.roll(step), carried.lag))
    };
    let of_steps: Vec<Vec<Option<f64>>> = rolling.all_steps().map(at_step).collect();
    let mut least: Option<(f64, f64)> = None;
    for (place, edge) in edges.iter().enumerate() {
        let rooms: Vec<Option<f64>> = of_steps.iter().map(|rooms| rooms[place]).collect();
        let at = |roll: f64| room(std::slice::from_ref(edge), roll, rolling.lag_at(roll)?)[0];
        least = least_between(&rolls, &rooms, least, at);
    }
    let (least_mm, roll) = least?;
    Some(Clearance {
        of: other.surfaces[flank].name.clone(),
        with: other.surfaces[of].name.clone(),
        least_mm,
        turn: units::shown(members.contact.roll.dimension, roll),
    })
}

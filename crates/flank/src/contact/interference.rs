//! Whether the edges of a tooth come too near to what its mate's tooth space has beside the flank: fillet and root.
//!
//! A place of an edge touches such a surface at a lag of its own. As long as that opens the pair less than the lag with which it rolls, there
//! is room.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_solver::{ContactProblem, Outcome, OutlineSegment, SurfacePoint};

use crate::contact::pair::Members;
use crate::contact::result::Clearance;
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::session::Session;
use crate::project::units;
use crate::solve::{self, blank};

/// Places along each edge.
const PLACES: usize = 9;
/// An edge is one of a flank whose points come so near to it, as a share of the way across them.
const BESIDE: f64 = 0.3;
/// Room below this is no rounding: the tooth cuts into its mate, mm.
const REACHES_IN: f64 = -1e-7;

/// Golden sections of the way from one roll position to the next but one: to 1e-6 of it, where also a kink is as exact as room is told.
const SECTIONS: usize = 28;

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
    let mut clearances = Vec::new();
    for other in &others {
        session.check()?;
        clearances.extend(clearance(job, members, other, (errors, rolling), session));
    }
    let name = &members.contact.name;
    let cuts = |room: &&Clearance| room.least_mm < REACHES_IN;
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
    session: Session,
) -> Option<Clearance> {
    let of = usize::from(other.surfaces[0].name == members.surfaces[0].name);
    let flank = 1 - of;
    let edges = edges(job, members, flank, session);
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
        carried.map_or(vec![None; edges.len()], |carried| room(&edges, rolling.roll(step), carried.lag))
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

/// The least of a place over the roll, and where: of its rooms at roll positions, and between those that are next to the least ones where it may be
/// less than what is known.
fn least_between(
    rolls: &[f64],
    rooms: &[Option<f64>],
    known: Option<(f64, f64)>,
    at: impl Fn(f64) -> Option<f64>,
) -> Option<(f64, f64)> {
    let room = |k: usize| rooms.get(k).copied().flatten();
    let beside = |k: usize| [k.wrapping_sub(1), k + 1].map(room);
    let is_least = |k: &usize| room(*k).is_some_and(|own| beside(*k).into_iter().flatten().all(|other| own <= other));
    let mut least = known;
    for k in (0..rooms.len()).filter(is_least) {
        let Some(own) = room(k) else { continue };
        if least.is_none_or(|(least, _)| own < least) {
            least = Some((own, rolls[k]));
        }
        // between two positions it falls by no more than to the one that is next
        let fall = beside(k).into_iter().flatten().map(|other| other - own).fold(0.0, f64::max);
        if least.is_some_and(|(least, _)| own - fall > least) {
            continue;
        }
        let ends = [k.saturating_sub(1), (k + 1).min(rolls.len() - 1)].map(|k| rolls[k]);
        let found = lowest(ends, |roll| at(roll).unwrap_or(f64::INFINITY));
        if least.is_none_or(|(least, _)| found.0 < least) {
            least = Some(found);
        }
    }
    least
}

/// The least value between two ends and where it is, by golden section.
fn lowest([mut low, mut high]: [f64; 2], at: impl Fn(f64) -> f64) -> (f64, f64) {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    let inner = |low: f64, high: f64| [high - share * (high - low), low + share * (high - low)];
    let mut places = inner(low, high);
    let mut values = places.map(&at);
    for _ in 0..SECTIONS {
        if values[0] <= values[1] {
            high = places[1];
            let next = inner(low, high)[0];
            (places, values) = ([next, places[0]], [at(next), values[0]]);
        } else {
            low = places[0];
            let next = inner(low, high)[1];
            (places, values) = ([places[1], next], [values[1], at(next)]);
        }
    }
    if values[0] <= values[1] { (values[0], places[0]) } else { (values[1], places[1]) }
}

/// Points of a flank along the segments of its outline at which it ends.
fn edges(job: &Job<'_>, members: &Members<'_, '_>, flank: usize, session: Session) -> Vec<SurfacePoint> {
    let (surface, Some(solid)) = (members.surfaces[flank], members.solids[flank]) else { return Vec::new() };
    let solved: Vec<&SurfacePoint> =
        members.points[flank].iter().filter(|point| point.outcome == Outcome::Solved).collect();
    let outline = blank::outline(solid);
    let along = |segment: &OutlineSegment| along(job, surface, segment, (&solved, session));
    outline.segments().iter().flat_map(along).collect()
}

fn along<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    segment: &OutlineSegment,
    (solved, session): (&[&SurfacePoint], Session),
) -> Vec<SurfacePoint> {
    let section = |point: &SurfacePoint| [point.position[2], point.position[0].hypot(point.position[1])];
    let off = |point: &SurfacePoint| {
        let [z, rho] = section(point);
        let [near_z, near_rho] = segment.nearest([z, rho]);
        (z - near_z).hypot(rho - near_rho)
    };
    let ends = |k: usize| {
        let values = solved.iter().map(|point| section(point)[k]);
        values.fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)])
    };
    let [[z0, z1], [rho0, rho1]] = [ends(0), ends(1)];
    let Some(near) = solved.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return Vec::new() };
    if off(near) > BESIDE * (z1 - z0).min(rho1 - rho0) {
        return Vec::new();
    }
    let [x, y, z] = surface.surface.position.0;
    let problem = solve::problem(job, surface, [z, (x * x + y * y).sqrt()], session);
    let places = segment.places(PLACES);
    let (points, _) = problem.solve_points(&places, [1, PLACES], Some(&near.unknowns), None);
    (0..points.len()).map(|k| points.point(k)).filter(|point| point.outcome == Outcome::Solved).collect()
}

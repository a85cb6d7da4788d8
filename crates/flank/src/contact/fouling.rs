//! Whether two teeth run into each other after they have left each other's flank, or before they come to it: in a ring that has few teeth more than its
//! pinion, tips are in each other's way far from the line of centres.
//!
//! From each end of its contact a pair of teeth is followed as long as an edge of one of them is within the blank of the other. Until then it cannot
//! have come to the other side of the mate's tooth but through it.

use flank_chain_dsl::Job;
use flank_solver::{ContactProblem, SurfacePoint};

use crate::contact::edge_places::edges;
use crate::contact::least_room::least_between;
use crate::contact::pair::Members;
use crate::contact::result::Clearance;
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::project::units;

/// Positions of a pitch.
const LOOKS: f64 = 24.0;

/// The least room of the edges of each flank beside the mate's flank, where the pair of teeth does not touch, if an edge comes nearer there once it has
/// gone away. Nothing is told of pairs that do not turn evenly, nor of teeth that end nowhere.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn of_flanks(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    (errors, rolling): (&[f64], &Rolling),
    session: Session<'_>,
) -> Result<Vec<Clearance>, Failure> {
    let is_known = rolling.has_pitch && members.solids.iter().all(Option::is_some) && members.is_even(job);
    if !is_known {
        return Ok(Vec::new());
    }
    let ends = rolling.flank_ends();
    let half_turn = std::f64::consts::PI / members.turns(job, 0.5)[0].map(f64::abs).into_iter().fold(0.0, f64::max);
    let mut found = Vec::new();
    for flank in 0..2 {
        let pair = members.pair(job, errors, &[]);
        let pair = if flank == 0 { pair } else { pair.swapped() };
        let problem = ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound");
        let edges = edges(job, members, flank, session);
        let mate = &members.points[1 - flank];
        let side = Side { problem: &problem, rolling, edges: &edges, mate };
        let mut least: Option<(f64, f64)> = None;
        for (way, end) in &ends {
            session.check()?;
            least = side.least([end.roll, end.roll + *way as f64 * half_turn], least);
        }
        found.extend(least.map(|(least_mm, roll)| Clearance {
            of: members.surfaces[flank].name.clone(),
            with: members.surfaces[1 - flank].name.clone(),
            least_mm,
            turn: units::shown(members.contact.roll.dimension, roll),
        }));
    }
    Ok(found)
}

/// The edges of one flank beside the other flank.
struct Side<'s> {
    problem: &'s ContactProblem,
    rolling: &'s Rolling,
    edges: &'s [SurfacePoint],
    mate: &'s [SurfacePoint],
}

impl Side<'_> {
    /// Of some edges the room at a roll position, of those that are within the mate's blank; `None` where none is.
    fn rooms(&self, edges: &[SurfacePoint], roll: f64) -> Option<Vec<Option<f64>>> {
        let lag = self.rolling.lag_at(roll)?;
        let is_within = self.problem.within_mate(roll, lag, edges);
        if !is_within.contains(&true) {
            return None;
        }
        let opens = self.rolling.middle()?.opening.signum();
        let of_edge = |(passed, is_within): (Option<[f64; 2]>, bool)| {
            let [there, opening] = passed.filter(|_| is_within)?;
            (opening * opens > 0.0).then_some((lag - there) * opening)
        };
        Some(self.problem.passed(roll, lag, [edges, self.mate]).into_iter().zip(is_within).map(of_edge).collect())
    }

    /// The least room from the end of a contact to another roll position, where it is less than one before; with its roll position.
    fn least(&self, [from, to]: [f64; 2], known: Option<(f64, f64)>) -> Option<(f64, f64)> {
        let step = (to - from).signum() * self.rolling.engagement.pitch / LOOKS;
        let count = ((to - from) / step) as usize;
        let rolls: Vec<f64> = (1..=count).map(|k| from + k as f64 * step).collect();
        let looked: Vec<Vec<Option<f64>>> = rolls.iter().map_while(|roll| self.rooms(self.edges, *roll)).collect();
        let mut least = known;
        for (place, edge) in self.edges.iter().enumerate() {
            let mut rooms: Vec<Option<f64>> = looked.iter().map(|rooms| rooms[place]).collect();
            // as far as it goes away from the flank that it has left
            let is_nearer = |pair: &[Option<f64>]| matches!(pair, [Some(a), Some(b)] if b < a);
            let Some(first) = rooms.windows(2).position(is_nearer) else { continue };
            rooms[..=first].fill(None);
            let at = |roll: f64| self.rooms(std::slice::from_ref(edge), roll)?[0];
            least = least_between(&rolls, &rooms, least, at);
        }
        least
    }
}

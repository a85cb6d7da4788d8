//! Whether two teeth run into each other after they have left each other's flank, or before they come to it: in a ring that has few teeth more than its
//! pinion, tips are in each other's way far from the line of centres.
//!
//! From each end of its contact a pair of teeth is followed as long as an edge of one of them is within the blank of the other. Until then it cannot
//! have come to the other side of the mate's tooth but through it.

use flank_chain_dsl::Job;
use flank_solver::{ContactProblem, SurfacePoint};

use crate::contact::least_room::least_between;
use crate::contact::pair::Members;
use crate::contact::result::Clearance;
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::project::units;

/// Positions of a pitch, about.
const LOOKS: usize = 24;

/// The least room of the edges of each flank beside the mate's flank, where the pair of teeth does not touch, if an edge comes nearer there once it has
/// gone away, and nearer than `most`, mm. Nothing is told of pairs that do not turn evenly, nor of teeth that end nowhere.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn of_flanks(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    (errors, rolling): (&[f64], &Rolling),
    (edges, most): (&[Vec<SurfacePoint>; 2], f64),
    session: Session<'_>,
) -> Result<Vec<Clearance>, Failure> {
    let is_known = rolling.has_pitch && members.solids.iter().all(Option::is_some) && members.is_even(job);
    if !is_known {
        return Ok(Vec::new());
    }
    let ends = rolling.flank_ends();
    let half_turn = std::f64::consts::PI / members.turns(job, 0.5)[0].map(f64::abs).into_iter().fold(0.0, f64::max);
    let mut found = Vec::new();
    for (flank, edges) in edges.iter().enumerate() {
        let pair = members.pair(job, errors, &[]);
        let pair = if flank == 0 { pair } else { pair.swapped() };
        let problem = ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound");
        let mate = &members.points[1 - flank];
        let side = Side { problem: &problem, rolling, edges, mate };
        // what is more says nothing: just where an edge has left the flank there is hardly any room
        let mut least = (most, f64::NAN);
        for (way, end) in &ends {
            session.check()?;
            least = side.least((*way, end.roll), half_turn, least);
        }
        let (least_mm, roll) = least;
        found.extend((least_mm < most).then(|| Clearance {
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
    /// Of some edges the room at a roll position and its lag, of those that are within the mate's blank; `None` where none is.
    fn rooms(&self, edges: &[SurfacePoint], (roll, lag): (f64, f64)) -> Option<Vec<Option<f64>>> {
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

    /// Positions from the end of a contact on, to one side and no farther than so much of the roll: those of which the composite lag is known.
    fn positions(&self, (way, end): (isize, f64), most: f64) -> impl Iterator<Item = (f64, Option<f64>)> {
        let of = self.rolling.looked_at();
        let steps_to_end = (end - self.rolling.roll_of(of, 0)) * of.steps as f64 / of.pitch;
        let first = if way > 0 { steps_to_end.floor() as isize + 1 } else { steps_to_end.ceil() as isize - 1 };
        let stride = (of.steps / LOOKS).max(1);
        let steps = (0..).step_by(stride).map(move |k: isize| first + way * k);
        let at = move |step: isize| (self.rolling.roll_of(of, step), of.carried(step).map(|carried| carried.lag));
        steps.map(at).take_while(move |(roll, _)| (roll - end).abs() <= most)
    }

    /// The least room on one side of the end of a contact, where it is less than one before; with its roll position.
    fn least(&self, end: (isize, f64), most: f64, known: (f64, f64)) -> (f64, f64) {
        let positions: Vec<(f64, Option<f64>)> = self.positions(end, most).collect();
        let of_edges = |(roll, lag): &(f64, Option<f64>)| self.rooms(self.edges, (*roll, (*lag)?));
        let looked: Vec<Vec<Option<f64>>> = positions.iter().map_while(of_edges).collect();
        // also the one at which no edge is within the blank any more: the last one leaves it before
        let rolls: Vec<f64> = positions.iter().map(|(roll, _)| *roll).collect();
        let mut least = known;
        for (place, edge) in self.edges.iter().enumerate() {
            let mut rooms: Vec<Option<f64>> = looked.iter().map(|rooms| rooms[place]).collect();
            // as far as it goes away from the flank that it has left
            let is_nearer = |pair: &[Option<f64>]| matches!(pair, [Some(a), Some(b)] if b < a);
            let Some(first) = rooms.windows(2).position(is_nearer) else { continue };
            rooms[..=first].fill(None);
            let at = |roll: f64| self.rooms(std::slice::from_ref(edge), (roll, self.rolling.lag_at(roll)?))?[0];
            least = least_between(&rolls, &rooms, Some(least), at).unwrap_or(least);
        }
        least
    }
}

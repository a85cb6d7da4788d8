//! What the moves of a program must not cut into: the milled surface and what the cutter keeps clear of, in all spaces of the work.

use flank_solver::{Guard, Obstacle, SpacePlace, Struck, ToolBody};
use rayon::prelude::*;

use super::Found;
use super::block::Motion;
use super::cutter::MillingCutter;
use super::machine::FreeAxes;
use super::obstacles::{Guarded, body_of};
use super::program::Move;
use super::target::Target;
use crate::project::remark::{NotDone, NotDoneKind};

/// A move in which a rotary axis turns farther is looked at in parts, radians.
const TURNED: f64 = 0.5;
/// What a move may pass over, mm: of rapids, which keep away, and of cutting blocks, which are beside the surface all the way.
const CLOSE: [f64; 2] = [0.05, 0.2];
/// Where it cuts in, its depth is looked at every so often, mm.
const STEP: f64 = 0.25;
/// Of so many moves that cut in the deepest is told.
const MOST: usize = 100;
/// What is less deep, mm, is not told.
const SHALLOW: f64 = 0.01;

/// Surfaces with the bodies that do not cut into them.
pub(super) struct Guards<'f, 'j, 'g> {
    target: &'f Target<'j, 'g>,
    guarded: &'f [Guarded<'j>],
    milled: Obstacle,
    /// Of the cutter, the part that rapids keep away from the milled surface, and its name.
    part: (String, ToolBody),
    places: Vec<SpacePlace>,
    /// How deep moves may go, mm.
    allowed: f64,
}

/// A move that cuts in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub(super) line: usize,
    /// Which guard; the last one is of the milled surface.
    guard: usize,
    part: usize,
    struck: Struck,
}

impl<'f, 'j, 'g> Guards<'f, 'j, 'g> {
    pub(super) fn new(target: &'f Target<'j, 'g>, found: &'f Found<'j, 'g>, promised: f64) -> Guards<'f, 'j, 'g> {
        let MillingCutter { cutting } = &found.cutter;
        let part = match found.guarded.first() {
            Some(of) => (of.body_name.clone(), of.body.clone()),
            None => (target.milling.cutter_name.clone(), body_of(cutting)),
        };
        Guards {
            target,
            guarded: &found.guarded,
            milled: Obstacle::new(found.fields.surface.clone()),
            part,
            places: found.spaces.places(),
            allowed: promised.max(SHALLOW),
        }
    }

    /// Of all surfaces; the milled one is the last.
    fn all(&self) -> Vec<Guard<'_>> {
        let alone = || vec![SpacePlace::default()];
        let of = |of: &'f Guarded<'j>| {
            let places = if of.is_fixture { alone() } else { self.places.clone() };
            Guard::new(&of.kept.obstacle, &of.body, places)
        };
        let milled = Guard::new(&self.milled, &self.part.1, self.places.clone());
        self.guarded.iter().map(of).chain([milled]).collect()
    }

    /// The move of a kind that cuts in deepest, and how many do.
    pub(super) fn worst(&self, moves: &[Move], motion: Motion, axes: &FreeAxes) -> Option<(Hit, usize)> {
        let mut guards = self.all();
        if motion == Motion::Straight {
            // what blocks leave on the milled surface is measured
            guards.pop();
        }
        let (guards, allowed) = (&guards, self.allowed);
        let close = CLOSE[usize::from(motion == Motion::Straight)];
        let of_move = |one: &Move| -> Option<Hit> {
            let parts = one.parts(axes, TURNED);
            let hits = parts.iter().enumerate().flat_map(|(part, one)| {
                let series = one.series(axes);
                let hits = guards.iter().enumerate().filter_map(move |(guard, of)| {
                    let struck = of.struck(&series, -allowed, close)?;
                    Some(Hit { line: one.line, guard, part, struck })
                });
                hits.collect::<Vec<Hit>>()
            });
            hits.min_by_key(|hit| hit.part)
        };
        let some: Vec<&Move> = moves.iter().filter(|one| one.motion == motion).collect();
        let hits: Vec<(usize, Hit)> =
            some.par_iter().enumerate().filter_map(|(k, one)| Some((k, of_move(one)?))).collect();
        let depth = |(number, hit): &(usize, Hit)| {
            let part = &some[*number].parts(axes, TURNED)[hit.part];
            Hit { struck: guards[hit.guard].deepest(&part.series(axes), hit.struck, STEP), ..*hit }
        };
        let depths: Vec<Hit> = hits[..hits.len().min(MOST)].par_iter().map(depth).collect();
        let worst =
            depths.into_iter().reduce(|a, b| if b.struck.distance < a.struck.distance - SHALLOW { b } else { a })?;
        Some((worst, hits.len()))
    }

    /// That a move cuts in.
    pub(super) fn told(&self, what: &str, (hit, count): (Hit, usize), way: &str) -> NotDone {
        let shares = hit.struck.shares;
        let (name, body, place) = match self.guarded.get(hit.guard) {
            Some(of) => (of.kept.name.as_str(), of.body_name.as_str(), (of.kept.place)(shares)),
            None => (self.target.name(), self.part.0.as_str(), self.target.place(shares)),
        };
        let space = match hit.struck.place {
            0 => String::new(),
            place => format!(" of space {}", place + 1),
        };
        let message = format!("{what} cuts {:.4} mm into {name}{space} at {place}", -hit.struck.distance);
        let others = (count > 1).then(|| format!("of moves of this kind {count} cut in, this one deepest"));
        let details = [Some(format!("it is {body} that does")), others, Some(way.to_string())];
        NotDone::new(NotDoneKind::TooDeep, name, message).with(details.into_iter().flatten().collect())
    }
}

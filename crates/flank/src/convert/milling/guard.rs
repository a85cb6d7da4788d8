//! What the moves of a program must not cut into: the milled surface and what the cutter keeps clear of, in all spaces of the work.

use std::collections::HashMap;
use std::f64::consts::TAU;

use flank_solver::{Guard, Obstacle, PoseSeries, SpacePlace, Struck, ToolBody};
use rayon::prelude::*;

use super::Found;
use super::block::Motion;
use super::cutter::MillingCutter;
use super::machine::{FreeAxes, moved_by};
use super::obstacles::{Guarded, body_of};
use super::program::Move;
use super::target::Target;
use crate::project::remark::{NotDone, NotDoneKind};

/// A move in which a rotary axis turns farther is looked at in parts, radians.
const TURNED: f64 = 0.5;
/// What a move may pass over, mm: of rapids, which keep away, and of cutting blocks, which are beside the surface all the way.
const CLOSE: [f64; 2] = [0.05, 0.2];
/// Where it cuts in, its depth is looked at every so often, mm, and solved where it is deepest.
const STEP: f64 = 0.25;
/// Of so many moves that cut in the deepest is told.
const MOST: usize = 100;
/// What is less deep, mm, is not told.
const SHALLOW: f64 = 0.01;
/// Moves are alike whose cutters are nowhere farther apart than this, mm, ...
const SAME: f64 = 1e-3;
/// ... as points so far from the tip see it, mm, at these places of the way: uneven ones, so that whole turns are not taken for none.
const REACH: f64 = 100.0;
const PLACES: [f64; 5] = [0.0, 0.07, 0.31, 0.68, 1.0];
/// Where moves begin is told by cells so wide, mm: wider than [`SAME`].
const CELL: f64 = 0.1;

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

/// Of both that which is deeper; of the same the first.
fn deeper(a: Hit, b: Hit) -> Hit {
    let is_deeper = b.struck.distance < a.struck.distance - SHALLOW;
    let is_as_deep = b.struck.distance < a.struck.distance + SHALLOW;
    if is_deeper || is_as_deep && b.line < a.line { b } else { a }
}

/// Moves that bring the cutter the same way over the spaces of the work, but for a turn from space to space: the first of them, and how many.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Alike {
    first: usize,
    count: usize,
}

/// The cutter at [`PLACES`] of a way.
type Places = [[f64; 6]; PLACES.len()];

/// The moves that differ: what stands in all spaces is met alike by a move and by the same in another space. Spaces that stand in a row have ends,
/// and no two moves over them are alike.
fn alike(moves: &[&Move], places: &[SpacePlace], axes: &FreeAxes) -> Vec<Alike> {
    let is_round = places.len() > 1 && places.iter().all(|place| place.shift == 0.0);
    if !is_round {
        return (0..moves.len()).map(|first| Alike { first, count: 1 }).collect();
    }
    let ways: Vec<Places> = moves.par_iter().map(|one| in_first_space(&one.series(axes), places)).collect();
    let mut found: Vec<Alike> = Vec::new();
    let mut known: HashMap<[i64; 3], Vec<(usize, Places)>> = HashMap::new();
    for (number, way) in ways.into_iter().enumerate() {
        let cell = [0, 1, 2].map(|k| (way[0][k] / CELL).floor() as i64);
        let beside = |by: usize| [by / 9, by / 3 % 3, by % 3].map(|by| by as i64 - 1);
        let near = (0..27).map(beside).filter_map(|by| known.get(&[0, 1, 2].map(|k| cell[k] + by[k])));
        let is_same = |other: &&(usize, Places)| way.iter().zip(&other.1).all(|(a, b)| moved_by(a, b, REACH) <= SAME);
        let same = near.flatten().find(is_same).map(|(first, _)| *first);
        match same {
            Some(first) => found[first].count += 1,
            None => {
                known.entry(cell).or_default().push((found.len(), way));
                found.push(Alike { first: number, count: 1 });
            }
        }
    }
    found
}

/// Poses of a way, turned back by as many spaces as bring its middle next to the first one.
fn in_first_space(way: &PoseSeries, places: &[SpacePlace]) -> Places {
    let poses = PLACES.map(|share| way.at(share));
    let [x, y, ..] = poses[PLACES.len() / 2];
    let pitch = TAU / places.len() as f64;
    let turn = -pitch * (y.atan2(x) / pitch).round();
    poses.map(|pose| SpacePlace { turn, shift: 0.0 }.placed(&pose))
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

    /// Those that are looked at along moves of a kind: of a surface that stands in all spaces, or of one that stands alone. The milled one is the last.
    fn of(&self, motion: Motion, is_alone: bool) -> Vec<(usize, Guard<'_>)> {
        let kept = self.guarded.iter().enumerate().filter(|(_, of)| of.is_fixture == is_alone);
        let places = || if is_alone { vec![SpacePlace::default()] } else { self.places.clone() };
        let kept = kept.map(|(number, of)| (number, Guard::new(&of.kept.obstacle, &of.body, places())));
        // what blocks leave on the milled surface is measured
        let has_milled = motion == Motion::Rapid && !is_alone;
        let milled = has_milled.then(|| (self.guarded.len(), Guard::new(&self.milled, &self.part.1, places())));
        kept.chain(milled).collect()
    }

    /// The move of a kind that cuts in deepest, and how many do.
    pub(super) fn worst(&self, moves: &[Move], motion: Motion, axes: &FreeAxes) -> Option<(Hit, usize)> {
        let some: Vec<&Move> = moves.iter().filter(|one| one.motion == motion).collect();
        let all: Vec<Alike> = (0..some.len()).map(|first| Alike { first, count: 1 }).collect();
        let turned = alike(&some, &self.places, axes);
        let kinds = [(false, turned), (true, all)]
            .map(|(is_alone, looked_at)| self.worst_of(&some, &looked_at, &self.of(motion, is_alone), axes));
        let count = kinds.iter().flatten().map(|(_, count)| count).sum();
        let worst = kinds.into_iter().flatten().map(|(hit, _)| hit).reduce(deeper)?;
        Some((worst, count))
    }

    fn worst_of(
        &self,
        moves: &[&Move],
        looked_at: &[Alike],
        guards: &[(usize, Guard<'_>)],
        axes: &FreeAxes,
    ) -> Option<(Hit, usize)> {
        let allowed = self.allowed;
        let of_move = |one: &Move| -> Option<Hit> {
            let close = CLOSE[usize::from(one.motion == Motion::Straight)];
            let parts = one.parts(axes, TURNED);
            let hits = parts.iter().enumerate().flat_map(|(part, one)| {
                let series = one.series(axes);
                let hits = guards.iter().filter_map(move |(guard, of)| {
                    let struck = of.struck(&series, -allowed, close)?;
                    Some(Hit { line: one.line, guard: *guard, part, struck })
                });
                hits.collect::<Vec<Hit>>()
            });
            hits.min_by_key(|hit| hit.part)
        };
        if guards.is_empty() {
            return None;
        }
        let hits: Vec<(Alike, Hit)> =
            looked_at.par_iter().filter_map(|alike| Some((*alike, of_move(moves[alike.first])?))).collect();
        let depth = |(alike, hit): &(Alike, Hit)| {
            let part = &moves[alike.first].parts(axes, TURNED)[hit.part];
            let (_, guard) = guards.iter().find(|(number, _)| *number == hit.guard).expect("it is one of them");
            Hit { struck: guard.deepest(&part.series(axes), hit.struck, STEP), ..*hit }
        };
        let depths: Vec<Hit> = hits[..hits.len().min(MOST)].par_iter().map(depth).collect();
        Some((depths.into_iter().reduce(deeper)?, hits.iter().map(|(alike, _)| alike.count).sum()))
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

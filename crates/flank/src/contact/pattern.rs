//! What the marking compound shows on the flanks of a pair.

use std::f64::consts::TAU;

use flank_solver::{ContactPoint, Gap, GapProblem, Outcome, RollingPair};

use crate::contact::composite::CompositeLag;
use crate::contact::pair::Members;
use crate::contact::result::ContactPattern;
use crate::contact::rolling::Rolling;
use crate::contact::sampled::sides;

/// The flanks of a pair of teeth are compared while they are nearer than this, or so many films, mm.
const NEAR: f64 = 0.2;
const FILMS: f64 = 10.0;
/// A mate is looked for no farther away than this, mm, and than this share of the way from one tooth to the next.
const FARTHEST: f64 = 5.0;
const SHARE: f64 = 0.4;
/// Teeth that are nearer to each other than this, mm, are none: what goes on along the normal by so little stands still.
const NO_WAY: f64 = 1e-3;

/// How near the mate comes to the points of a flank's sample.
pub(crate) struct GapMap {
    /// In the order of the sample.
    pub(crate) gaps: Vec<Option<Gap>>,
    pub(crate) pattern: ContactPattern,
}

/// On both flanks, over all of the roll at which one pair of teeth is near.
pub(crate) fn on_both(
    members: &Members<'_, '_>,
    pair: &RollingPair<'_, '_>,
    rolling: &Rolling,
    compound: f64,
) -> Vec<GapMap> {
    let (positions, reach) = (with_transfers(rolling, compound), reach_of(rolling, members.teeth()));
    let rolls: Vec<f64> = positions.iter().map(|position| position[0]).collect();
    let composite = CompositeLag::new(rolling, &rolls);
    let lag = |roll: f64| composite.at(roll);
    let of_member = |member: usize| {
        let problem = GapProblem::new(pair, member).expect("a job without errors leaves nothing unbound");
        let mate = &members.points[1 - member];
        let gaps = problem.least_over(&members.points[member], (&positions, &lag), mate, reach);
        let pattern = pattern(members, member, &gaps, compound);
        GapMap { gaps, pattern }
    };
    vec![of_member(0), of_member(1)]
}

/// The contact of the pair of teeth itself at a roll position.
fn own(rolling: &Rolling, roll: f64) -> Option<ContactPoint> {
    rolling.problem.pair_at(rolling.looked_at(), 0, roll)
}

/// The same as [`positions`], and where one pair of teeth hands over to the next, in the order of the roll: the composite lag has kinks there.
fn with_transfers(rolling: &Rolling, compound: f64) -> Vec<[f64; 2]> {
    let mut positions = positions(rolling, compound);
    let Some([low, high]) = positions.first().zip(positions.last()).map(|(first, last)| [first[0], last[0]]) else {
        return positions;
    };
    let pitch = rolling.engagement.pitch;
    let of_transfer = |roll: f64| {
        let pitches = |end: f64| (end - roll) / pitch;
        let all = pitches(low).ceil() as i64..=pitches(high).floor() as i64;
        all.map(move |by| roll + by as f64 * pitch)
    };
    let near = |roll: f64| {
        let (lag, point) = (rolling.lag_at(roll)?, own(rolling, roll)?);
        (((lag - point.lag) * point.opening).abs() <= reach_of_film(compound)).then_some([roll, lag])
    };
    let more: Vec<[f64; 2]> = rolling.transfers().into_iter().flat_map(of_transfer).filter_map(near).collect();
    positions.extend(more);
    positions.sort_by(|a, b| a[0].total_cmp(&b[0]));
    positions
}

/// Roll positions and lags at which one pair of teeth is near.
pub(crate) fn positions(rolling: &Rolling, compound: f64) -> Vec<[f64; 2]> {
    let engagement = rolling.looked_at();
    let steps = engagement.first..engagement.first + engagement.points.len() as isize;
    let lag = |step: isize| match rolling.has_pitch {
        true => engagement.carried(step).map(|carried| carried.lag),
        false => engagement.point(0, step).map(|point| point.lag),
    };
    let reach = reach_of_film(compound);
    let position = |step: isize| {
        let (lag, point) = (lag(step)?, engagement.point(0, step)?);
        let apart = ((lag - point.lag) * point.opening).abs();
        (apart <= reach).then(|| [rolling.roll_of(engagement, step), lag])
    };
    steps.filter_map(position).collect()
}

/// Flanks of a pair of teeth are compared while they are nearer than this, mm.
pub(crate) fn reach_of_film(compound: f64) -> f64 {
    NEAR.max(FILMS * compound)
}

/// How far away a mate is looked for, mm: a part of the way from one tooth to the next along the normal, where the pitch is known.
pub(crate) fn reach_of(rolling: &Rolling, teeth: [Option<u32>; 2]) -> f64 {
    let middle = rolling.middle().filter(|_| rolling.has_pitch);
    let way = middle.and_then(|middle| way_to_next(middle, rolling.engagement.pitch, teeth));
    way.map_or(FARTHEST, |way| FARTHEST.min(SHARE * way))
}

/// From a tooth to the next along the normal of a contact, mm: as the members go on with the roll, or by the teeth of one that turns. Where one
/// stands and the other goes around in it, as the disc of a cycloidal drive does, neither goes on along the normal. `None` where nothing tells.
fn way_to_next(at: &ContactPoint, pitch: f64, teeth: [Option<u32>; 2]) -> Option<f64> {
    let by_teeth = (0..2).filter_map(|k| {
        let ([x, y, _], [nx, ny, _]) = (at.in_members[k], at.normals[k]);
        Some((x * ny - y * nx).abs() * TAU / f64::from(teeth[k]?))
    });
    let ways = by_teeth.chain([(at.advance * pitch).abs()]);
    ways.reduce(f64::max).filter(|way| *way > NO_WAY)
}

fn pattern(members: &Members<'_, '_>, member: usize, gaps: &[Option<Gap>], compound: f64) -> ContactPattern {
    let surface = members.surfaces[member];
    let [rows, columns] = surface.sample.as_ref().map_or([1, 1], |sample| sample.counts);
    let is_within = |at: &usize| gaps[*at].is_some_and(|gap| gap.distance <= compound);
    let touched: Vec<usize> = (0..gaps.len()).filter(is_within).collect();
    let extent = |place: &dyn Fn(usize) -> usize, count: usize| {
        let ends = touched.iter().map(|at| place(*at)).map(|at| (at, at)).reduce(|(a, b), (c, _)| (a.min(c), b.max(c)));
        ends.map(|(low, high)| [low, high].map(|at| at as f64 / (count.max(2) - 1) as f64))
    };
    let (rows, columns) = (extent(&|at| at / columns, rows), extent(&|at| at % columns, columns));
    let labels = surface.sample.as_ref().map_or(["", ""], |sample| sample.labels.each_ref().map(String::as_str));
    let touches = [(rows, labels[0]), (columns, labels[1])].into_iter().flat_map(|(extent, label)| {
        let sides = sides(label, "its");
        let reached = extent.map_or([false; 2], |[low, high]| [low == 0.0, high == 1.0]);
        sides.into_iter().zip(reached).filter_map(|(side, reached)| reached.then_some(side))
    });
    ContactPattern {
        surface: surface.name.clone(),
        film_um: compound * 1e3,
        within: touched.len(),
        points: members.points[member].iter().filter(|point| point.outcome == Outcome::Solved).count(),
        rows,
        columns,
        least_um: gaps.iter().flatten().map(|gap| 1e3 * gap.distance).reduce(f64::min),
        touches: touches.collect(),
    }
}

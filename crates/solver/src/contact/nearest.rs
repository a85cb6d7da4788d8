//! How near the mate comes to a point of a flank between the positions at which it was looked at.

use flank_expr::LANES;
use rayon::prelude::*;

use crate::contact::pattern::{Gap, GapProblem, Mate, TILE};
use crate::equations::solution::Outcome;
use crate::newton::batch::LaneNewton;
use crate::surface::points::SurfacePoint;

/// Parabolas through three places on the way to a least distance: each is nearer to it by some orders of magnitude.
const PARABOLAS: usize = 4;
/// A distance that is expected to fall by less than this, mm, has fallen: below what any number shows.
const FALLEN: f64 = 1e-9;
/// A parabola tells how far a distance falls if that is right within this share of it, and else there is a kink.
const SMOOTH: f64 = 0.25;
/// Golden sections of the way from the position before a least distance to the one after it: to 1e-4 of it.
const SECTIONS: usize = 20;

/// A place on the roll with the distance there; none where the normal does not meet the mate's tooth.
type Place = (f64, Option<f64>);

impl GapProblem {
    /// As [`GapProblem::least`], but over all of the roll between positions in its order: `lag` is that at any roll position. Where it has a kink,
    /// as where one pair of teeth hands over to the next, there should be a position.
    pub fn least_over(
        &self,
        nodes: &[SurfacePoint],
        (positions, lag): (&[[f64; 2]], &(dyn Fn(f64) -> Option<f64> + Sync)),
        mate: &[SurfacePoint],
        reach: f64,
    ) -> Vec<Option<Gap>> {
        let points: Vec<&SurfacePoint> = mate.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        if points.is_empty() {
            return vec![None; nodes.len()];
        }
        let mate = Mate::new(points, reach);
        let poses: Vec<_> = positions.iter().map(|at| self.pose_at(*at)).collect();
        let of_tile = |tile: &[SurfacePoint]| {
            let mut newton = LaneNewton::new(&self.along_normal, &self.ranges);
            let in_lanes = |nodes: &[SurfacePoint]| {
                let feet = self.feet(&mut newton, nodes, &poses, &mate);
                let of_lane = |(lane, node): (usize, &SurfacePoint)| {
                    let distances: Vec<Option<f64>> = self.on_mate(node, &poses, feet.distances(lane), reach).collect();
                    let places: Vec<Place> = positions.iter().map(|at| at[0]).zip(distances).collect();
                    let known = (0..places.len()).filter_map(|k| Some((k, places[k].1?)));
                    let (k, _) = known.min_by(|a, b| a.1.total_cmp(&b.1))?;
                    let start = feet.foot(k, lane);
                    let at = |roll: f64| self.distance_at(node, [roll, lag(roll)?], &start, reach);
                    Some(least_beside(&places, k, &at))
                };
                nodes.iter().enumerate().map(of_lane).collect::<Vec<Option<Gap>>>()
            };
            tile.chunks(LANES).flat_map(in_lanes).collect::<Vec<_>>()
        };
        nodes.par_chunks(TILE).flat_map_iter(of_tile).collect()
    }
}

/// The least distance beside the least of those that are known.
fn least_beside(places: &[Place], k: usize, at: &dyn Fn(f64) -> Option<f64>) -> Gap {
    let (roll, distance) = places[k];
    let known = Gap { distance: distance.unwrap_or(f64::INFINITY), roll };
    let beside = |at: Option<usize>| at.and_then(|at| places.get(at)).copied();
    let ends = [beside(k.checked_sub(1)), beside(Some(k + 1))];
    let through = || {
        let [before, after] = ends.map(|end| Some(Gap { distance: end?.1?, roll: end?.0 }));
        of_parabolas([before?, known, after?], at)
    };
    through().unwrap_or_else(|| {
        let [low, high] = ends.map(|end| end.map_or(roll, |(roll, _)| roll));
        let found = of_sections([low, high], at);
        if found.distance < known.distance { found } else { known }
    })
}

/// By parabolas through the least of three distances and those beside it; `None` where they are none of the distance.
fn of_parabolas(mut three: [Gap; 3], at: &dyn Fn(f64) -> Option<f64>) -> Option<Gap> {
    for _ in 0..PARABOLAS {
        let [a, b, c] = three;
        let [before, after] = [a, c].map(|of| (of.distance - b.distance) / (of.roll - b.roll));
        let bend = (after - before) / (c.roll - a.roll);
        let slope = before + bend * (b.roll - a.roll);
        let (way, fall) = (-0.5 * slope / bend, 0.25 * slope * slope / bend);
        if bend.is_nan() || bend <= 0.0 || fall < FALLEN {
            return Some(b);
        }
        let roll = b.roll + way;
        let there = Gap { distance: at(roll)?, roll };
        if (b.distance - there.distance - fall).abs() > SMOOTH * fall {
            return None;
        }
        three = if way > 0.0 { [b, there, c] } else { [a, there, b] };
    }
    Some(three[1])
}

/// By golden section between two roll positions.
fn of_sections([mut low, mut high]: [f64; 2], at: &dyn Fn(f64) -> Option<f64>) -> Gap {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    let gap = |roll: f64| Gap { distance: at(roll).unwrap_or(f64::INFINITY), roll };
    let inner = |low: f64, high: f64| [high - share * (high - low), low + share * (high - low)];
    let mut places = inner(low, high).map(gap);
    for _ in 0..SECTIONS {
        if places[0].distance <= places[1].distance {
            high = places[1].roll;
            places = [gap(inner(low, high)[0]), places[0]];
        } else {
            low = places[0].roll;
            places = [places[1], gap(inner(low, high)[1])];
        }
    }
    if places[0].distance <= places[1].distance { places[0] } else { places[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn least_of(function: &dyn Fn(f64) -> Option<f64>) -> Gap {
        let places: Vec<Place> = (0..11).map(|k| 0.1 * f64::from(k)).map(|roll| (roll, function(roll))).collect();
        let known = (0..places.len()).filter_map(|k| Some((k, places[k].1?)));
        let (k, _) = known.min_by(|a, b| a.1.total_cmp(&b.1)).expect("one is known");
        least_beside(&places, k, function)
    }

    #[test]
    fn the_least_lies_between_positions() {
        let found = least_of(&|roll| Some(2.0 - (roll - 0.337).cos()));
        assert!((found.distance - 1.0).abs() < 1e-9 && (found.roll - 0.337).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn the_least_may_be_a_kink_or_an_end() {
        let kink = least_of(&|roll| Some((roll - 0.337).abs() + 0.1 * roll));
        assert!((kink.distance - 0.0337).abs() < 2e-5 && (kink.roll - 0.337).abs() < 2e-5, "{kink:?}");
        let end = least_of(&|roll| (roll < 0.533).then_some(1.0 - roll));
        assert!((end.distance - 0.467).abs() < 2e-5, "{end:?}");
        let first = least_of(&|roll| Some(roll));
        assert_eq!(first, Gap { distance: 0.0, roll: 0.0 });
    }
}

//! Whether a body on a way cuts into a surface, or into the same surface in another space of the work.

use crate::milling::distance::{Nearest, Obstacle, Shape, ToolBody};
use crate::milling::outline::OutlinePiece;
use crate::milling::series::PoseSeries;

/// Where a surface stands once more: turned about z, radians, and shifted along y, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpacePlace {
    /// About z.
    pub turn: f64,
    /// Along y.
    pub shift: f64,
}

impl SpacePlace {
    /// A pose over the first space as it stands over this one.
    pub fn placed(self, pose: &[f64; 6]) -> [f64; 6] {
        let [x, y, z, i, j, k] = *pose;
        let (s, c) = self.turn.sin_cos();
        [c * x - s * y, s * x + c * y + self.shift, z, c * i - s * j, s * i + c * j, k]
    }

    /// A pose over this space as it stands over the first one.
    pub(super) fn back(self, pose: &[f64; 6]) -> [f64; 6] {
        let [x, y, z, i, j, k] = *pose;
        let (s, c) = self.turn.sin_cos();
        let y = y - self.shift;
        [c * x + s * y, c * y - s * x, z, c * i + s * j, c * j - s * i, k]
    }
}

/// A surface in all spaces of the work, and a body that does not cut into it.
#[derive(Clone, Debug)]
pub struct Guard<'o> {
    pub(super) obstacle: &'o Obstacle,
    body: ToolBody,
    pub(super) shape: Shape,
    /// No point of the body is farther from the tip, mm.
    reach: f64,
    pub(super) places: Vec<SpacePlace>,
}

/// Where a body cuts in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Struck {
    /// mm; negative.
    pub distance: f64,
    /// Of the way.
    pub share: f64,
    /// Which of the places.
    pub place: usize,
    /// Of the surface.
    pub shares: [f64; 2],
}

/// Of both that which is nearer to the surface, or deeper in it.
pub(super) fn nearer(a: Struck, b: Struck) -> Struck {
    if b.distance < a.distance { b } else { a }
}

impl<'o> Guard<'o> {
    /// Of a surface at places.
    pub fn new(obstacle: &'o Obstacle, body: &ToolBody, places: Vec<SpacePlace>) -> Guard<'o> {
        let far = |piece: &OutlinePiece| match *piece {
            OutlinePiece::Line { from, to } => from[0].hypot(from[1]).max(to[0].hypot(to[1])),
            OutlinePiece::Arc { center, radius, .. } => center[0].hypot(center[1]) + radius,
        };
        let reach = body.pieces.iter().map(far).fold(0.0, f64::max);
        Guard { obstacle, body: body.clone(), shape: body.shape(), reach, places }
    }

    /// The first place of a way at which the body is nearer than `limit`, mm; what is nearer by less than `close` may be passed over.
    ///
    /// A distance changes by no more than the body moves. So a step is as long as it takes to come down to the limit, and a way is passed over
    /// whose middle is far enough away.
    pub fn struck(&self, way: &PoseSeries, limit: f64, close: f64) -> Option<Struck> {
        let rate = self.rate(way);
        self.nearest(&way.at(0.5), 0.5, (f64::NEG_INFINITY, limit + 0.5 * rate))?;
        let mut share = 0.0;
        loop {
            let far = limit + ((1.0 - share) * rate).max(close);
            let found = self.nearest(&way.at(share), share, (limit + close, far))?;
            if found.distance < limit {
                return Some(found);
            }
            if share >= 1.0 {
                return None;
            }
            share = (share + (found.distance - limit).max(close) / rate).min(1.0);
        }
    }

    /// Where the body is deepest on a way, from a share on, looked at every `step` mm, and solved beside the deepest of these.
    pub fn deepest(&self, way: &PoseSeries, first: Struck, step: f64) -> Struck {
        let by = step / self.rate(way);
        let count = ((1.0 - first.share) / by).ceil() as usize;
        let all = (1..=count).map(|k| (first.share + k as f64 * by).min(1.0));
        let found = all.filter_map(|share| self.nearest(&way.at(share), share, (0.0, 0.0)));
        let deepest = found.fold(first, nearer);
        // what is known of the surface beside a place may lead astray
        nearer(deepest, self.sharpened(way, deepest))
    }

    /// How far a point of the body moves with the share at the most, mm.
    pub(super) fn rate(&self, way: &PoseSeries) -> f64 {
        let [tip, axis] = way.rates(0.0);
        (tip + self.reach * axis).max(f64::MIN_POSITIVE)
    }

    /// What of all places is nearest, exactly where that is below `exact`, else a bound; `None` if nothing is nearer than `far`.
    fn nearest(&self, pose: &[f64; 6], share: f64, (exact, far): (f64, f64)) -> Option<Struck> {
        let mut least = Struck { distance: far, share, place: 0, shares: [0.0; 2] };
        for (place, stands) in self.places.iter().enumerate() {
            let pose = stands.back(pose);
            let bound = self.obstacle.bound(&self.shape, &pose, least.distance);
            if bound >= least.distance {
                continue;
            }
            let found = if bound < exact { self.obstacle.nearest(&self.body, &pose, f64::INFINITY) } else { None };
            let Nearest { distance, shares } = found.unwrap_or(Nearest { distance: bound, shares: [0.0; 2] });
            if distance < least.distance {
                least = Struck { distance, share, place, shares };
            }
        }
        (least.distance < far).then_some(least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::milling::series::PoseField;
    use crate::solid::chart::Chart;

    /// A plane of 4 mm by 6 mm at x = 30, and a pin of radius 2 that stands on end.
    fn case() -> (Obstacle, ToolBody) {
        let shares = [Chart::shares(5), Chart::shares(7)];
        let points = shares[0].iter().flat_map(|u| shares[1].iter().map(move |w| (4.0 * u - 2.0, 6.0 * w - 3.0)));
        let plane = PoseField::through(points.map(|(y, z)| [30.0, y, z, 1.0, 0.0, 0.0]).collect(), [5, 7]);
        let pieces = vec![
            OutlinePiece::Line { from: [0.0, 0.0], to: [2.0, 0.0] },
            OutlinePiece::Line { from: [2.0, 0.0], to: [2.0, 40.0] },
        ];
        (Obstacle::new(plane), ToolBody { pieces })
    }

    #[test]
    fn a_long_way_meets_the_surface_in_whichever_space_it_stands() {
        let (obstacle, body) = case();
        let turns = |count: u32| {
            (0..count)
                .map(move |k| SpacePlace { turn: std::f64::consts::TAU * f64::from(k) / f64::from(count), shift: 0.0 })
        };
        let [alone, all] = [1, 4].map(|count| Guard::new(&obstacle, &body, turns(count).collect()));
        // from far outside into the plane that a quarter turn brings to y = 30
        let way = PoseSeries::sampled(3, |s| [0.5, 1000.0 - 969.0 * s, -1.0, 0.0, 0.0, 1.0]);
        assert_eq!(alone.struck(&way, -0.01, 0.05), None);
        let found = all.struck(&way, -0.01, 0.05).expect("it is met");
        assert_eq!(found.place, 1);
        assert!((1000.0 - 969.0 * found.share - 32.0).abs() < 0.1, "{found:?}");
        let deepest = all.deepest(&way, found, 0.05);
        // at the end the surface is 1 mm off the pin's axis, and 4 mm long
        assert!((deepest.distance + 1.0).abs() < 1e-9 && deepest.share == 1.0, "{deepest:?}");
        let past = PoseSeries::sampled(3, |s| [10.0 - 20.0 * s, 32.5, -1.0, 0.0, 0.0, 1.0]);
        assert_eq!(all.struck(&past, -0.01, 0.05), None);
    }

    #[test]
    fn a_space_of_a_rack_stands_beside_the_first() {
        let place = SpacePlace { turn: 0.0, shift: 7.0 };
        let pose = [1.0, 2.0, 3.0, 0.0, 0.6, 0.8];
        assert_eq!(place.placed(&pose)[1], 9.0);
        assert_eq!(place.back(&place.placed(&pose)), pose);
    }
}

//! How deep a body on a short way goes into a surface: the least distance over the way and over the surface together.
//!
//! Beside a contact the surface is known by its derivatives at a place, so that a distance costs no more than that of a point. The least of all
//! is looked for with these, then with those at the place that was found, and again: an error of the place counts by its square.

use crate::milling::distance::{APART, Nearest, Obstacle, Positions, least_value};
use crate::milling::guard::{Guard, Struck, nearer};
use crate::milling::series::PoseSeries;

/// A way is looked at in parts on which no point of the body moves farther than this, mm; in so many at the most.
const PART: f64 = 2.0;
const MOST_PARTS: f64 = 1000.0;
/// Places of a part that are looked at first.
const PLACES: usize = 3;
/// Rounds of a search between them, each with steps so much shorter.
const ROUNDS: usize = 4;
const SHORTER: f64 = 0.25;
/// Times that the surface is known anew at the place that was found.
const AGAIN: usize = 3;
/// What is known of the surface is enough as far as this from where it is known, mm: what third derivatives leave there, of a flank that bends by
/// 1/10 mm and another tenth farther on by half of that, is 3e-6 mm.
const NEAR: f64 = 0.15;
/// A search that is begun anew looks so far before and behind, as a share of a part.
const BESIDE: f64 = 0.05;

/// A surface beside a place: its position with the first and second derivatives there.
struct Beside {
    at: [f64; 2],
    position: [f64; 3],
    slopes: [[f64; 3]; 2],
    /// Twice by the first share, by both, twice by the second.
    bends: [[f64; 3]; 3],
}

impl Beside {
    fn new(obstacle: &Obstacle, at: [f64; 2]) -> Beside {
        // differences need both sides
        let at = at.map(|share| share.clamp(APART, 1.0 - APART));
        let [[a, w, b], [s, o, n], [c, e, d]] = obstacle.surface.around(at, APART);
        let each = |of: &dyn Fn(usize) -> f64, by: f64| [0, 1, 2].map(|k| of(k) / by);
        let square = APART * APART;
        Beside {
            at,
            position: o,
            slopes: [each(&|k| e[k] - w[k], 2.0 * APART), each(&|k| n[k] - s[k], 2.0 * APART)],
            bends: [
                each(&|k| e[k] - 2.0 * o[k] + w[k], square),
                each(&|k| d[k] - c[k] - b[k] + a[k], 4.0 * square),
                each(&|k| n[k] - 2.0 * o[k] + s[k], square),
            ],
        }
    }

    /// Whether a place is so near that what is known here is enough.
    fn is_near(&self, shares: [f64; 2]) -> bool {
        let way = |k: usize| (shares[k] - self.at[k]).abs() * self.slopes[k].map(|x| x * x).iter().sum::<f64>().sqrt();
        way(0) + way(1) < NEAR
    }
}

impl Positions for Beside {
    fn position(&self, shares: [f64; 2]) -> [f64; 3] {
        let [u, w] = [0, 1].map(|k| shares[k] - self.at[k]);
        [0, 1, 2].map(|k| {
            let bent = 0.5 * u * u * self.bends[0][k] + u * w * self.bends[1][k] + 0.5 * w * w * self.bends[2][k];
            self.position[k] + u * self.slopes[0][k] + w * self.slopes[1][k] + bent
        })
    }

    fn around(&self, shares: [f64; 2], apart: f64) -> [[[f64; 3]; 3]; 3] {
        let beside = [-apart, 0.0, apart];
        beside.map(|u| beside.map(|w| self.position([shares[0] + u, shares[1] + w])))
    }
}

/// The cutter over one of the places, and the surface beside what it is nearest to.
struct Part<'g, 'o> {
    guard: &'g Guard<'o>,
    way: &'g PoseSeries,
    place: usize,
    beside: Beside,
}

impl Part<'_, '_> {
    fn pose(&self, share: f64) -> [f64; 6] {
        self.guard.places[self.place].back(&self.way.at(share))
    }

    /// What is nearest at a share of the way, from a start.
    fn foot(&self, share: f64, start: [f64; 2]) -> Struck {
        let pose = self.pose(share);
        let Nearest { distance, shares } =
            least_value(&self.beside, &|point| self.guard.shape.distance(&pose, point), start);
        Struck { distance, share, place: self.place, shares }
    }

    /// From the lowest of places so far `apart` on in parabolas, between two ends.
    fn lowest(&self, first: Struck, mut apart: f64, [low, high]: [f64; 2]) -> Struck {
        let mut best = first;
        for _ in 0..ROUNDS {
            let foot = |by: f64| self.foot((best.share + by * apart).clamp(low, high), best.shares);
            let next = if best.share <= low {
                foot(1.0)
            } else if best.share >= high {
                foot(-1.0)
            } else {
                let reach = apart.min(best.share - low).min(high - best.share) / apart;
                let [before, after] = [foot(-reach), foot(reach)];
                let slope = 0.5 * (after.distance - before.distance);
                let bend = before.distance - 2.0 * best.distance + after.distance;
                let by = if bend > 0.0 { (-slope / bend).clamp(-1.0, 1.0) } else { -slope.signum() };
                [after, foot(by * reach)].into_iter().fold(before, nearer)
            };
            best = nearer(best, next);
            apart *= SHORTER;
        }
        best
    }
}

impl Guard<'_> {
    /// Where the body is nearest to the surface, or deepest in it, over all of a way and all places; `None` where it stays farther away than
    /// `limit`, mm. [`Guard::sharpened`] makes more of it.
    ///
    /// A distance is off by some 1e-5 mm.
    pub fn lowest(&self, way: &PoseSeries, limit: f64) -> Option<Struck> {
        let rate = self.rate(way);
        let count = (rate / PART).ceil().clamp(1.0, MOST_PARTS);
        let width = 1.0 / count;
        let parts = (0..count as usize).flat_map(|part| (0..self.places.len()).map(move |place| (part, place)));
        let found = parts.filter_map(|(part, place)| {
            let ends = [part as f64 * width, (part + 1) as f64 * width];
            self.lowest_of(way, (ends, place), limit + 0.5 * width * rate)
        });
        found.reduce(nearer).filter(|found| found.distance <= limit)
    }

    /// The same on a part of the way over one place; `None` where its middle stays farther away than `far`.
    fn lowest_of(&self, way: &PoseSeries, ([low, high], place): ([f64; 2], usize), far: f64) -> Option<Struck> {
        let middle = 0.5 * (low + high);
        let pose = self.places[place].back(&way.at(middle));
        if self.obstacle.far(&self.shape, &pose) > far {
            return None;
        }
        let coarse = self.obstacle.nearest_point(&self.shape, &pose, far)?;
        let mut part = Part { guard: self, way, place, beside: Beside::new(self.obstacle, coarse.shares) };
        let first = part.foot(middle, coarse.shares);
        if !part.beside.is_near(first.shares) {
            part.beside = Beside::new(self.obstacle, first.shares);
        }
        let apart = (high - low) / (PLACES - 1) as f64;
        let all = (0..PLACES).map(|k| part.foot(low + k as f64 * apart, first.shares));
        let mut best = part.lowest(all.reduce(nearer)?, 0.5 * apart, [low, high]);
        for _ in 0..AGAIN {
            if part.beside.is_near(best.shares) {
                break;
            }
            part.beside = Beside::new(self.obstacle, best.shares);
            best = part.lowest(part.foot(best.share, best.shares), BESIDE * (high - low), [low, high]);
        }
        Some(best)
    }

    /// The same place exactly: with the surface's own derivatives where it is found.
    pub fn sharpened(&self, way: &PoseSeries, found: Struck) -> Struck {
        let apart = BESIDE * (PART / self.rate(way)).min(1.0);
        let mut best = found;
        for _ in 0..AGAIN {
            let beside = Beside::new(self.obstacle, best.shares);
            let part = Part { guard: self, way, place: best.place, beside };
            best = part.lowest(part.foot(best.share, best.shares), apart, [0.0, 1.0]);
        }
        let exact =
            self.obstacle.nearest_from(&self.shape, &self.places[best.place].back(&way.at(best.share)), best.shares);
        Struck { distance: exact.distance, shares: exact.shares, ..best }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::milling::guard::SpacePlace;
    use crate::milling::outline::{Cutter, OutlinePiece};
    use crate::milling::series::PoseField;
    use crate::solid::chart::Chart;

    /// A cylinder of radius 30 about z, from 30° to 60°, and a ball of radius 1.
    fn case() -> (Obstacle, Cutter) {
        let shares = [Chart::shares(21), Chart::shares(7)];
        let at = |u: &f64, w: &f64| {
            let (s, c) = (30.0 + 30.0 * u).to_radians().sin_cos();
            [30.0 * c, 30.0 * s, 20.0 * w - 10.0, c, s, 0.0]
        };
        let points = shares[0].iter().flat_map(|u| shares[1].iter().map(move |w| at(u, w)));
        let surface = PoseField::through(points.collect(), [21, 7]);
        let between = [0.0, std::f64::consts::FRAC_PI_2];
        (
            Obstacle::new(surface),
            Cutter { pieces: vec![OutlinePiece::Arc { center: [0.0, 1.0], radius: 1.0, between }] },
        )
    }

    /// The ball goes straight with its centre from one place to another, upright on the cylinder's middle.
    fn ball(from: [f64; 3], to: [f64; 3]) -> PoseSeries {
        let (s, c) = 45.0_f64.to_radians().sin_cos();
        PoseSeries::sampled(9, |share| {
            let at = [0, 1, 2].map(|k| from[k] + share * (to[k] - from[k]));
            [at[0] - c, at[1] - s, at[2], c, s, 0.0]
        })
    }

    fn polar(radius: f64, degrees: f64, z: f64) -> [f64; 3] {
        let (s, c) = degrees.to_radians().sin_cos();
        [radius * c, radius * s, z]
    }

    #[test]
    fn a_chord_is_deepest_where_it_is_nearest_to_the_axis() {
        let (obstacle, cutter) = case();
        let guard = Guard::new(&obstacle, &cutter.body(), vec![SpacePlace::default()]);
        for (from, to, over) in [(44.0, 46.5, 0.0), (41.0, 49.0, -0.02), (43.3, 44.1, 0.03)] {
            // both ends stand `over` the touching ball, and the chord lies below by its sagitta
            let way = ball(polar(31.0 + over, from, 1.0), polar(31.0 + over, to, 1.7));
            let found = guard.lowest(&way, 0.1).expect("it is near");
            let exact = (31.0 + over) * (0.5 * f64::to_radians(to - from)).cos() - 31.0;
            let sharp = guard.sharpened(&way, found);
            assert!((found.distance - exact).abs() < 2e-5, "{found:?} {exact}");
            assert!((sharp.distance - exact).abs() < 1e-11, "{sharp:?} {exact}");
            assert!((sharp.share - 0.5).abs() < 1e-4, "{sharp:?}");
            let middle = 0.5 * (from + to);
            assert!((30.0 + 30.0 * sharp.shares[0] - middle).abs() < 1e-3, "{sharp:?}");
        }
    }

    #[test]
    fn a_dive_is_deepest_at_its_end_in_whichever_space() {
        let (obstacle, cutter) = case();
        let places = (0..4).map(|k| SpacePlace { turn: f64::from(k) * std::f64::consts::FRAC_PI_2, shift: 0.0 });
        let guard = Guard::new(&obstacle, &cutter.body(), places.collect());
        let depths = [0.0173, 0.3];
        for (place, depth) in (0..4).flat_map(|place| depths.map(|depth| (place, depth))) {
            let way = ball(polar(31.4, 44.0, 0.0), polar(31.0 - depth, 45.3, 0.4));
            let turned = PoseSeries::sampled(9, |share| guard.places[place].placed(&way.at(share)));
            let found = guard.sharpened(&turned, guard.lowest(&turned, 0.1).expect("it is near"));
            assert!((found.distance + depth).abs() < 1e-11 && found.place == place, "{found:?} {depth}");
            assert!((found.share - 1.0).abs() < 1e-9, "{found:?}");
        }
        let past = ball(polar(33.0, 40.0, 0.0), polar(33.0, 50.0, 0.0));
        assert_eq!(guard.lowest(&past, 0.1), None);
    }
}

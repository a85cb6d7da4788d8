//! A pair of teeth on its way through the mesh, and all pairs together.
//!
//! The lag of the next pair is that of this one a pitch of the roll later, so that one pair followed from its first touch to its last says
//! what all do. At each roll position the pair that opens the members most carries: the composite lag.

use crate::contact::ContactProblem;
use crate::contact::point::{ContactPoint, ContactState, Member};
use crate::contact::track::Track;

/// Steps of Newton, safeguarded by halving, until a place of the roll is settled, and the share of a pitch at which it is.
const MOST_STEPS: usize = 60;
const SETTLED: f64 = 1e-14;

/// Edges that contact of the flanks may come to within one step of the roll.
const MOST_EDGES: usize = 4;
/// A point this near to an edge lies on it, mm: rounding of a solved point.
const ON_EDGE: f64 = 1e-12;
/// Lags that differ by less than this share are alike: rounding.
const ALIKE: f64 = 1e-13;

/// A pair of teeth from where it begins to touch to where it ends, at even steps of the roll.
#[derive(Clone, Debug, PartialEq)]
pub struct Engagement {
    /// How far the members roll from one pair of teeth to the next.
    pub pitch: f64,
    /// Steps of a pitch.
    pub steps: usize,
    /// At which step of the roll the first point is, counted from where it was begun.
    pub first: isize,
    /// Where the pair touches, in the order of the roll.
    pub points: Vec<ContactPoint>,
    /// Whether it ends before a limit of the roll: the pair is out of reach there.
    pub is_whole: [bool; 2],
    /// Roll positions at which a place of the teeth opens the pair more than any contact that was found: what is known of them is too little.
    pub missed: Vec<f64>,
}

/// Which pair carries at a roll position, and the one next to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// The pair that carries: how many pitches it is ahead.
    pub pair: isize,
    /// The composite lag.
    pub lag: f64,
    /// By how much the second pair stays behind; `None` where there is only one.
    pub behind: Option<f64>,
}

impl ContactProblem {
    /// The pair that touches at a contact, followed by even steps of the roll until it no longer touches, or to the ends of the roll.
    pub fn engagement(&self, from: &ContactPoint, pitch: f64, steps: usize, limits: [f64; 2]) -> Engagement {
        let track = Track::new(self, from, (pitch, steps, limits)).watched();
        let missed = track.missed();
        let (first, points) = track.contiguous();
        let last = first + points.len() as isize - 1;
        let is_whole = [first - 1, last + 1].map(|step| track.roll(step).is_some());
        Engagement { pitch, steps, first, points, is_whole, missed }
    }

    /// Where on the roll a contact of flank on flank begins or ends beside a point of it: where it comes to an edge, or the end of what a
    /// tool's surface makes. `way` is -1 towards smaller rolls.
    pub fn flank_end(&self, of: &Engagement, way: isize) -> Option<ContactPoint> {
        let is_flank = |point: &&ContactPoint| point.is_of_flanks();
        let inner = if way < 0 { of.points.iter().find(is_flank) } else { of.points.iter().rev().find(is_flank) }?;
        let step = way as f64 * of.pitch / of.steps as f64;
        let at_edge = match inner.state {
            Some(ContactState::Line) => self.end_of_lines(inner, inner.roll + step),
            _ => self.end_at_edge(inner, inner.roll + step),
        };
        // an edge may open the pair more before
        let outer = match way {
            -1 => of.points.iter().rev().find(|point| point.roll < inner.roll),
            _ => of.points.iter().find(|point| point.roll > inner.roll),
        };
        let is_open = |end: &ContactPoint| outer.is_none_or(|outer| !self.is_overtaken(end, outer));
        at_edge.filter(is_open).or_else(|| self.end_by_halving(inner, outer, step, SETTLED * of.pitch))
    }

    /// Whether another contact of the same teeth, followed to the roll position of one, opens the pair more.
    fn is_overtaken(&self, point: &ContactPoint, by: &ContactPoint) -> bool {
        self.followed(by, point.roll).is_some_and(|other| other.is_beyond(point.height()))
    }

    /// Where the line along which the flanks touch leaves them at a corner, between a point inside and a roll position at which the corner
    /// alone touches: there the normals are opposite.
    fn end_of_lines(&self, inner: &ContactPoint, beyond: f64) -> Option<ContactPoint> {
        let outer = self.followed(inner, beyond).filter(|outer| !outer.is_of_flanks() && outer.edges.len() == 2)?;
        let corner = |roll: f64, near: &ContactPoint| {
            let start = near.predicted(roll - near.roll)?;
            self.root(roll, &start, &outer.edges, near.first_normal.into())
        };
        let climb = |members: &[Member; 2]| members[0].normal + members[1].normal;
        let towards = climb(&self.members(&outer.all_unknowns(), outer.roll));
        let height = |members: &[Member; 2]| climb(members).dot(&towards);
        let mut at = corner(inner.roll, &outer)?;
        let (mut low, mut high) = ((inner.roll, height(&at.1)), (outer.roll, towards.norm_squared()));
        if low.1 > 0.0 {
            return None;
        }
        let mut roll = inner.roll;
        for _ in 0..MOST_STEPS {
            let next = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            if !next.is_finite() || (next - roll).abs() <= SETTLED * (high.0 - low.0).abs() {
                break;
            }
            roll = next;
            at = corner(roll, &outer)?;
            let found = height(&at.1);
            // the end that stays counts half the next time, so that both come nearer
            if found.signum() == low.1.signum() {
                (low, high.1) = ((roll, found), 0.5 * high.1);
            } else {
                (high, low.1) = ((roll, found), 0.5 * low.1);
            }
        }
        let (root, members) = at;
        Some(self.point(root, roll, outer.edges.clone(), &members))
    }

    /// Where contact of the flanks comes to an edge between a point inside and a roll position, at which it would lie beyond one.
    fn end_at_edge(&self, inner: &ContactPoint, beyond: f64) -> Option<ContactPoint> {
        let flanks = |roll: f64| {
            let start = inner.predicted(roll - inner.roll)?;
            self.root(roll, &start, &[], inner.first_normal.into())
        };
        let mut outer = (beyond, flanks(beyond)?);
        for _ in 0..MOST_EDGES {
            let edge = self.beyond(&outer.1.1)?;
            let bound = self.bound(edge)?;
            let height = |members: &[Member; 2]| bound.height(members[edge.member].section());
            let inside = height(&self.members(&inner.all_unknowns(), inner.roll));
            let (mut low, mut high) = ((inner.roll, inside), (outer.0, height(&outer.1.1)));
            for _ in 0..MOST_STEPS {
                let roll = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
                if !roll.is_finite() || roll == low.0 || roll == high.0 {
                    break;
                }
                outer = (roll, flanks(roll)?);
                let found = height(&outer.1.1);
                if found.abs() <= ON_EDGE {
                    break;
                }
                // the end that stays counts half the next time, so that both come nearer
                if found.signum() == low.1.signum() {
                    (low, high.1) = ((roll, found), 0.5 * high.1);
                } else {
                    (high, low.1) = ((roll, found), 0.5 * low.1);
                }
            }
            if self.beyond(&outer.1.1).is_none() {
                let (roll, (root, members)) = outer;
                return Some(self.point(root, roll, Vec::new(), &members));
            }
        }
        None
    }

    /// The last point of contact of the flanks within a step of the roll, beyond which an outer contact opens the pair more or there is none:
    /// found by halving.
    fn end_by_halving(
        &self,
        inner: &ContactPoint,
        outer: Option<&ContactPoint>,
        step: f64,
        settled: f64,
    ) -> Option<ContactPoint> {
        let is_open =
            |point: &ContactPoint| point.is_of_flanks() && outer.is_none_or(|outer| !self.is_overtaken(point, outer));
        let (mut low, mut high) = (0.0, 1.0);
        let mut best = inner.clone();
        for _ in 0..MOST_STEPS {
            let share = 0.5 * (low + high);
            if (high - low) * step.abs() <= settled {
                break;
            }
            match self.followed(&best, inner.roll + share * step).filter(is_open) {
                Some(point) => (best, low) = (point, share),
                None => high = share,
            }
        }
        Some(best)
    }

    /// The roll position between two at which two pairs carry together, `ahead` pitches apart: where the one hands over to the other.
    pub fn transfer(&self, of: &Engagement, pairs: [isize; 2], between: [f64; 2]) -> Option<f64> {
        let [mut low, mut high] = between;
        let height = |roll: f64| {
            let lags = pairs.map(|pair| {
                self.pair_at(of, pair, roll)
                    .map(|point| (point.lag * point.opening.signum(), point.lag_slopes[0] * point.opening.signum()))
            });
            let [Some(a), Some(b)] = lags else { return None };
            Some((a.0 - b.0, a.1 - b.1))
        };
        let sign = height(low)?.0.signum();
        let mut at = 0.5 * (low + high);
        for _ in 0..MOST_STEPS {
            let (value, slope) = height(at)?;
            if value == 0.0 {
                return Some(at);
            }
            if value.signum() == sign {
                low = at
            } else {
                high = at
            }
            let next = at - value / slope;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - at).abs() <= SETTLED * of.pitch {
                return Some(next);
            }
            at = next;
        }
        Some(at)
    }

    /// A pair, some pitches ahead, at a roll position of the first: of what its neighbours on both sides lead to, that which opens the pair
    /// more.
    pub fn pair_at(&self, of: &Engagement, pair: isize, roll: f64) -> Option<ContactPoint> {
        let roll = roll + pair as f64 * of.pitch;
        let after = of.points.partition_point(|point| point.roll < roll);
        let mut near: Vec<&ContactPoint> = of.points[after.saturating_sub(1)..].iter().take(2).collect();
        near.sort_by(|a, b| (a.roll - roll).abs().total_cmp(&(b.roll - roll).abs()));
        // two of one kind lead to the same contact
        let is_one = near.windows(2).all(|two| two[0].edges == two[1].edges);
        let found: Vec<ContactPoint> =
            near.iter().filter_map(|point| self.followed(point, roll)).take(if is_one { 1 } else { 2 }).collect();
        found.into_iter().max_by(|a, b| a.height().total_cmp(&b.height()))
    }
}

impl Engagement {
    /// The point of a pair, some pitches ahead, at a step of the roll; `None` where it does not touch.
    pub fn point(&self, pair: isize, step: isize) -> Option<&ContactPoint> {
        let at = step + pair * self.steps as isize - self.first;
        self.points.get(usize::try_from(at).ok()?)
    }

    /// The pairs that may touch at a step of the roll, those behind first.
    pub fn pairs(&self, step: isize) -> Vec<isize> {
        let (steps, last) = (self.steps as isize, self.first + self.points.len() as isize - 1);
        let lowest = (self.first - step).div_euclid(steps);
        let highest = (last - step).div_euclid(steps) + 1;
        (lowest..=highest).filter(|pair| self.point(*pair, step).is_some()).collect()
    }

    /// Which pair carries at a step of the roll; `None` where none touches. Of pairs that are ahead alike, one whose flanks touch.
    pub fn carried(&self, step: isize) -> Option<Carried> {
        let touching: Vec<(isize, &ContactPoint)> =
            self.pairs(step).into_iter().filter_map(|pair| Some((pair, self.point(pair, step)?))).collect();
        let height = |point: &ContactPoint| point.lag * point.opening.signum();
        let most = touching.iter().map(|(_, point)| height(point)).reduce(f64::max)?;
        let is_ahead = |of: &&(isize, &ContactPoint)| most - height(of.1) <= ALIKE * (1.0 + most.abs());
        let ahead = || touching.iter().filter(is_ahead);
        let (pair, point) = *ahead().find(|(_, point)| point.is_of_flanks()).or_else(|| ahead().next())?;
        let others = touching.iter().filter(|(other, _)| *other != pair);
        let behind = others.map(|(_, second)| height(point) - height(second)).reduce(f64::min);
        Some(Carried { pair, lag: point.lag, behind })
    }
}

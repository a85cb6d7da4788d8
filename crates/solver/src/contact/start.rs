//! A contact without a start value.
//!
//! At a roll position each point of the first flank says at which lag the second one would pass through it. The flanks touch where
//! that lag is extreme: before, they are apart everywhere, and beyond, they cut into each other. On a grid of solved points the
//! extreme is near the contact.

use flank_expr::{LANES, ScalarEvaluator};
use nalgebra::Vector3;

use crate::contact::ContactProblem;
use crate::contact::edge::FlankEdge;
use crate::contact::point::{ContactPoint, ContactState, Pose, opening, placed, turned};
use crate::equations::solution::Outcome;
use crate::newton::batch::LaneNewton;
use crate::newton::scalar::solve;
use crate::surface::points::SurfacePoint;

/// Places, the most extreme first, from which a contact is looked for.
const STARTS: usize = 12;
/// A point that opens the pair less than the grid's most by this share of the lag's range is as high: rounding.
const UNEVEN: f64 = 1e-12;
/// A lag that moves the flank along the normal by less than this share of what it moves it at all does not open the pair.
const LOCKED: f64 = 1e-6;

/// Normals at points beside each other, one of each flank, that are less than this far apart face the same way: their product.
const AVERTED: f64 = 0.3;
/// Points at most from which the second flank is passed through with care.
const WITH_CARE: usize = 24;
/// Points of the first flank through which the second is passed at first, if it has more: all where none of them leads to a contact.
const FEW: usize = 150;

/// Why no contact was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoContact {
    /// The second flank passes through no point of the first one within the range of the lag.
    Apart,
    /// The outline of a member, 0 or 1, holds no point of its flank.
    NoFlank(usize),
    /// The flanks face the same way where they meet: a member inside the other, or the wrong flank of a tooth.
    SameSide,
    /// The lag moves nothing along the normal: the pair is self-locking there.
    Locked,
    /// They meet, and no point at which they touch was found from there.
    NotFound,
    /// They touch along a line, and nothing says where that ends: no point of it is told from the others.
    Endless,
}

/// A point of the first flank through which the second passes.
struct Passing {
    unknowns: Vec<f64>,
    /// What the lag is, with the sign with which more of it opens.
    height: f64,
    normal: Vector3<f64>,
}

/// Whether a contact is one, whether it is on the flanks as far as they are looked for, and whether nothing opens the pair more.
fn rank(point: &ContactPoint, least: f64) -> (bool, bool, bool) {
    let is_contact = matches!(point.state, Some(ContactState::Touching | ContactState::Line));
    (is_contact, point.outcome == Outcome::Solved, point.lag * point.opening.signum() >= least)
}

impl ContactPoint {
    /// Whether the lag moves nothing along the normal there, so that what it is, is rounding.
    pub(super) fn is_locked(&self) -> bool {
        self.opening.abs() < LOCKED * Vector3::from(self.position).norm().max(1.0)
    }
}

impl ContactProblem {
    /// The contact at a roll position, found from solved points of both flanks: those that a grid of each has.
    ///
    /// # Errors
    /// Why there is none.
    pub fn find(&self, roll: f64, [first, second]: [&[SurfacePoint]; 2]) -> Result<ContactPoint, NoContact> {
        let solved = |points: &'_ [SurfacePoint]| -> Vec<SurfacePoint> {
            points.iter().filter(|point| point.outcome == Outcome::Solved).cloned().collect()
        };
        let (first, second) = (solved(first), solved(second));
        let stride = first.len().div_ceil(FEW);
        let few: Vec<SurfacePoint> = first.iter().step_by(stride.max(1)).cloned().collect();
        match self.find_from(roll, [&few, &second]) {
            Err(_) if stride > 1 => self.find_from(roll, [&first, &second]),
            found => found,
        }
    }

    /// For points of the first flank, at its edges say, the lag near a given one at which the second flank passes through each, and how far
    /// that flank moves along its own normal, into the first, for a step of the lag: `None` where it does not pass, ends before, or
    /// faces the other way. Found from the nearest solved points of the second flank; those of the first are to be solved.
    pub fn passed(&self, roll: f64, lag: f64, [first, second]: [&[SurfacePoint]; 2]) -> Vec<Option<[f64; 2]>> {
        let second: Vec<&SurfacePoint> = second.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        let [of_first, of_second] = self.poses_at(lag, roll);
        let places: Vec<[f64; 3]> = second.iter().map(|point| placed(&of_second, point.position)).collect();
        let start = |point: &SurfacePoint| {
            let place = placed(&of_first, point.position);
            let off = |at: &usize| (0..3).map(|k| (places[*at][k] - place[k]).powi(2)).sum::<f64>();
            let nearest = (0..second.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
            Some([&second[nearest].unknowns[..], &[lag]].concat())
        };
        let starts: Option<Vec<_>> = first.iter().map(|point| Some((&point.unknowns[..], start(point)?))).collect();
        let Some(starts) = starts else { return vec![None; first.len()] };
        let mut all = vec![None; first.len()];
        for (at, ((p, _), through)) in starts.iter().zip(self.through(roll, &starts, false)).enumerate() {
            let Some(through) = through else { continue };
            let members = self.members(&[p, &through[..]].concat(), roll);
            let [own, mate] = &members;
            let ends = self.outlines[1].as_ref().is_some_and(|outline| !outline.holds(mate.section()));
            if !ends && own.normal.dot(&mate.normal) < 0.0 {
                all[at] = Some([through[through.len() - 1], opening(&members, &-mate.normal)]);
            }
        }
        all
    }

    /// Whether points of the first flank are in the blank of the second one at a roll position and a lag, in its teeth or between them.
    pub fn within_mate(&self, roll: f64, lag: f64, first: &[SurfacePoint]) -> Vec<bool> {
        let [of_first, of_second] = self.poses_at(lag, roll);
        let is_within = |point: &SurfacePoint| {
            let place = placed(&of_first, point.position);
            let off: [f64; 3] = std::array::from_fn(|k| place[k] - of_second[k]);
            let [x, y, z] =
                std::array::from_fn(|k| (0..3).map(|row| of_second[3 + 3 * row + k] * off[row]).sum::<f64>());
            self.outlines[1].as_ref().is_none_or(|outline| outline.holds([z, x.hypot(y)]))
        };
        first.iter().map(is_within).collect()
    }

    fn find_from(&self, roll: f64, points: [&[SurfacePoint]; 2]) -> Result<ContactPoint, NoContact> {
        let mut passing = self.passing(roll, points, true)?;
        passing.sort_by(|a, b| b.height.total_cmp(&a.height));
        let mut best: Option<ContactPoint> = None;
        // no point that both flanks have may open the pair more than the contact does
        let least = passing[0].height - UNEVEN * self.ranges[self.lag_at()].width();
        for start in passing.iter().take(STARTS) {
            for edges in self.ways() {
                let Some(found) = self.touching_near(roll, &start.unknowns, &edges, start.normal) else { continue };
                if best.as_ref().is_none_or(|best| rank(&found, least) > rank(best, least)) {
                    best = Some(found);
                }
                if best.as_ref().is_some_and(|best| rank(best, least) == (true, true, true)) {
                    return Ok(best.expect("there is one"));
                }
            }
        }
        // where the lag would have to go beyond its range the flanks do not come together within it
        let is_apart =
            |best: &ContactPoint| matches!(best.outcome, Outcome::Outside { unknown, .. } if unknown == self.lag_at());
        match best {
            Some(best) if is_apart(&best) => Err(NoContact::Apart),
            best => best.ok_or(NoContact::NotFound),
        }
    }

    /// With which edges a contact is looked for: flank on flank first, then each edge, then each corner of an outline.
    pub(super) fn ways(&self) -> Vec<Vec<FlankEdge>> {
        let segments = |member: usize| self.outlines[member].as_ref().map_or(0, |outline| outline.segments().len());
        let edges = |member: usize| (0..segments(member)).map(move |segment| vec![FlankEdge { member, segment }]);
        let corners = |member: usize| {
            let count = segments(member);
            (0..count).filter(move |_| count > 2).map(move |k| {
                let mut corner = [k, (k + 1) % count].map(|segment| FlankEdge { member, segment });
                corner.sort();
                corner.to_vec()
            })
        };
        let all = std::iter::once(Vec::new()).chain(edges(0)).chain(edges(1));
        all.chain(corners(0)).chain(corners(1)).collect()
    }

    fn passing(&self, roll: f64, points: [&[SurfacePoint]; 2], with_care: bool) -> Result<Vec<Passing>, NoContact> {
        for (member, outline) in self.outlines.iter().enumerate() {
            let section = |point: &SurfacePoint| [point.position[2], point.position[0].hypot(point.position[1])];
            if outline.as_ref().is_some_and(|outline| !points[member].iter().any(|point| outline.holds(section(point))))
            {
                return Err(NoContact::NoFlank(member));
            }
        }
        let lag = self.ranges[self.lag_at()].middle();
        let [of_first, of_second] = self.poses_at(lag, roll);
        let [first, second] = points;
        let places: Vec<[f64; 3]> = second.iter().map(|point| placed(&of_second, point.position)).collect();
        let mut refused = None;
        let mut starts: Vec<(&[f64], Vec<f64>)> = Vec::new();
        for point in first {
            let (place, normal) = (placed(&of_first, point.position), turned(&of_first, point.normal));
            let off = |at: &usize| (0..3).map(|k| (places[*at][k] - place[k]).powi(2)).sum::<f64>();
            let Some(nearest) = (0..second.len()).min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
            let facing = turned(&of_second, second[nearest].normal);
            if (0..3).map(|k| normal[k] * facing[k]).sum::<f64>() > AVERTED {
                refused = refused.or(Some(NoContact::SameSide));
                continue;
            }
            starts.push((&point.unknowns, [&second[nearest].unknowns[..], &[lag]].concat()));
        }
        let mut found = Vec::new();
        for ((p, _), through) in starts.iter().zip(self.through(roll, &starts, with_care)) {
            let Some(through) = through else { continue };
            let unknowns = [p, &through[..]].concat();
            let members = self.members(&unknowns, roll);
            if self.beyond(&members).is_some() {
                continue;
            }
            let opening = opening(&members, &members[0].normal);
            let least = LOCKED * members[1].position.norm().max(1.0);
            if members[0].normal.dot(&members[1].normal) > 0.0 {
                refused = refused.or(Some(NoContact::SameSide));
            } else if opening.abs() < least {
                refused = refused.or(Some(NoContact::Locked));
            } else {
                let height = unknowns[self.lag_at()] * opening.signum();
                found.push(Passing { unknowns, height, normal: members[0].normal });
            }
        }
        if found.is_empty() { Err(refused.unwrap_or(NoContact::Apart)) } else { Ok(found) }
    }

    /// Of both members at a lag and a roll position.
    pub(super) fn poses_at(&self, lag: f64, roll: f64) -> [Pose; 2] {
        let mut poses = [0.0; 24];
        let inputs: Vec<f64> = [lag].into_iter().chain(self.given(roll)).collect();
        ScalarEvaluator::new(&self.poses).run(&inputs, &mut poses);
        [0, 1].map(|member| std::array::from_fn(|k| poses[12 * member + k]))
    }

    /// Unknowns of the second flank and the lag at which it passes through points of the first one, each from a start: many at once, and
    /// with care, if that is wanted, where none of them is found so.
    fn through(&self, roll: f64, starts: &[(&[f64], Vec<f64>)], with_care: bool) -> Vec<Option<Vec<f64>>> {
        let ranges = &self.ranges[self.unknowns[0]..];
        let parameters = |p: &[f64]| p.iter().copied().chain(self.given(roll)).collect::<Vec<f64>>();
        let mut newton = LaneNewton::new(&self.through, ranges);
        let mut found = Vec::with_capacity(starts.len());
        for starts in starts.chunks(LANES) {
            for (lane, (p, start)) in starts.iter().enumerate() {
                newton.put(lane, start.iter().copied(), &parameters(p));
            }
            newton.run(&vec![true; starts.len()], true);
            found.extend((0..starts.len()).map(|lane| {
                let is_root = newton.is_root(lane) && newton.outcome(lane) == Outcome::Solved;
                is_root.then(|| (0..ranges.len()).map(|k| newton.input(k)[lane]).collect())
            }));
        }
        if !with_care || found.iter().any(Option::is_some) {
            return found;
        }
        let alone = |(p, start): &(&[f64], Vec<f64>)| {
            let solution = solve(&self.through, ranges, &parameters(p), start);
            (solution.outcome == Outcome::Solved).then_some(solution.unknowns)
        };
        let stride = starts.len().div_ceil(WITH_CARE).max(1);
        starts.iter().enumerate().map(|(k, start)| k.is_multiple_of(stride).then(|| alone(start)).flatten()).collect()
    }
}

//! A contact without a start value.
//!
//! At a roll position each point of the first flank says at which lag the second one would pass through it. The flanks touch where
//! that lag is extreme: before, they are apart everywhere, and beyond, they cut into each other. On a grid of solved points the
//! extreme is near the contact.

use flank_expr::ScalarEvaluator;
use nalgebra::Vector3;

use crate::contact::ContactProblem;
use crate::contact::edge::FlankEdge;
use crate::contact::point::{ContactPoint, ContactState, Pose, opening, placed};
use crate::equations::solution::Outcome;
use crate::newton::scalar::solve_with;
use crate::surface::points::SurfacePoint;

/// Places, the most extreme first, from which a contact is looked for.
const STARTS: usize = 12;
/// A point that opens the pair less than the grid's most by this share of the lag's range is as high: rounding.
const UNEVEN: f64 = 1e-12;
/// A lag that moves the flank along the normal by less than this share of what it moves it at all does not open the pair.
const LOCKED: f64 = 1e-6;

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

    fn find_from(&self, roll: f64, points: [&[SurfacePoint]; 2]) -> Result<ContactPoint, NoContact> {
        let mut passing = self.passing(roll, points)?;
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

    /// With which edges a contact is looked for: flank on flank first.
    fn ways(&self) -> Vec<Vec<FlankEdge>> {
        let edges = |member: usize| {
            let segments = self.outlines[member].as_ref().map_or(0, |outline| outline.segments().len());
            (0..segments).map(move |segment| vec![FlankEdge { member, segment }])
        };
        std::iter::once(Vec::new()).chain(edges(0)).chain(edges(1)).collect()
    }

    fn passing(&self, roll: f64, points: [&[SurfacePoint]; 2]) -> Result<Vec<Passing>, NoContact> {
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
        let mut found = Vec::new();
        let mut refused = None;
        let mut last: Option<Vec<f64>> = None;
        for point in first {
            let place = placed(&of_first, point.position);
            let off = |at: &usize| (0..3).map(|k| (places[*at][k] - place[k]).powi(2)).sum::<f64>();
            let nearest = (0..second.len()).min_by(|a, b| off(a).total_cmp(&off(b)));
            let beside = nearest.map(|k| [&second[k].unknowns[..], &[lag]].concat());
            let (starts, p) = (last.iter().cloned().chain(beside), &point.unknowns[..]);
            let Some(through) = starts.into_iter().find_map(|start| self.through(roll, p, &start)) else { continue };
            let unknowns = [p, &through[..]].concat();
            let members = self.members(&unknowns, roll);
            last = Some(through);
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
    fn poses_at(&self, lag: f64, roll: f64) -> [Pose; 2] {
        let mut poses = [0.0; 24];
        let inputs: Vec<f64> = [lag].into_iter().chain(self.given(roll)).collect();
        ScalarEvaluator::new(&self.poses).run(&inputs, &mut poses);
        [0, 1].map(|member| std::array::from_fn(|k| poses[12 * member + k]))
    }

    /// Unknowns of the second flank and the lag at which it passes through a point of the first.
    fn through(&self, roll: f64, p: &[f64], start: &[f64]) -> Option<Vec<f64>> {
        let mut evaluation = self.through.evaluation(&p.iter().copied().chain(self.given(roll)).collect::<Vec<f64>>());
        let solution = solve_with(&mut evaluation, &self.ranges[self.unknowns[0]..], start);
        (solution.outcome == Outcome::Solved).then_some(solution.unknowns)
    }
}

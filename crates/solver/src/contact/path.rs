//! A contact followed over the roll.

use crate::contact::ContactProblem;
use crate::contact::point::{ContactPoint, ContactState};
use crate::contact::start::NoContact;
use crate::equations::solution::Outcome;
use crate::surface::points::SurfacePoint;

/// Halvings of a step of the roll until the contact is lost, in a point and along a line: past a corner the end of a line runs off many times
/// as fast.
const HALVINGS: [u32; 2] = [12, 18];
/// Steps from one roll position to another until the contact is lost.
const MOST_STEPS: usize = 200;
/// A point this much farther from where it was expected than the way to it, as a share of that, is of another contact.
const ASTRAY: f64 = 0.3;
/// Steps until a vertex is settled, and the change of the roll, as a share of what is followed, at which it is.
const VERTEX_STEPS: usize = 60;
const SETTLED: f64 = 1e-13;

/// A contact at many roll positions.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPath {
    /// At each roll position; `None` where the contact was not found.
    pub points: Vec<Option<ContactPoint>>,
    /// Why none was found at all.
    pub refused: Option<NoContact>,
}

impl ContactProblem {
    /// The contact at roll positions in rising order, found at the middle one, or where that has none at the others from there
    /// outwards, and followed to both sides.
    pub fn path(&self, rolls: &[f64], points: [&[SurfacePoint]; 2]) -> ContactPath {
        let mut path = ContactPath { points: vec![None; rolls.len()], refused: None };
        let middle = rolls.len() / 2;
        let mut order: Vec<usize> = (0..rolls.len()).collect();
        order.sort_by_key(|k| k.abs_diff(middle));
        for first in order {
            match self.find(rolls[first], points) {
                Ok(found) => {
                    path.points[first] = Some(found);
                    self.follow(&mut path, rolls, (first..rolls.len()).collect());
                    self.follow(&mut path, rolls, (0..=first).rev().collect());
                    path.refused = None;
                    return path;
                }
                Err(reason) => path.refused = path.refused.or(Some(reason)),
            }
        }
        path
    }

    fn follow(&self, path: &mut ContactPath, rolls: &[f64], places: Vec<usize>) {
        for pair in places.windows(2) {
            let Some(from) = path.points[pair[0]].clone() else { return };
            path.points[pair[1]] = self.followed(&from, rolls[pair[1]]);
        }
    }

    /// The contact at another roll position, on the way from one that is known; `None` where it is lost.
    pub fn followed(&self, from: &ContactPoint, roll: f64) -> Option<ContactPoint> {
        let mut at = from.clone();
        let most = HALVINGS[usize::from(from.state == Some(ContactState::Line))];
        let mut halvings = 0;
        for _ in 0..MOST_STEPS {
            if at.roll == roll {
                return Some(at);
            }
            let step = (roll - at.roll) * 0.5f64.powi(halvings);
            let next = if halvings == 0 { roll } else { at.roll + step };
            // a step that is rounding of the roll leads nowhere
            if next == at.roll {
                return None;
            }
            match self.step(&at, next) {
                Some(found) => {
                    at = found;
                    halvings = halvings.saturating_sub(1);
                }
                None if halvings as u32 == most => return None,
                None => halvings += 1,
            }
        }
        None
    }

    fn step(&self, from: &ContactPoint, roll: f64) -> Option<ContactPoint> {
        let expected = from.predicted(roll - from.roll)?;
        let found = self.touching_near(roll, &expected, &from.edges, from.first_normal.into())?;
        // past a corner the end of a line of contact goes along another edge, however fast
        let is_line = |point: &ContactPoint| point.state == Some(ContactState::Line);
        if is_line(from) && is_line(&found) && found.edges != from.edges {
            return Some(found);
        }
        let share = |a: &[f64], b: &[f64]| {
            let off = a.iter().zip(b).zip(&self.ranges).map(|((a, b), range)| ((a - b) / range.width()).abs());
            off.fold(0.0, f64::max)
        };
        let (astray, way) = (share(&found.all_unknowns(), &expected), share(&expected, &from.all_unknowns()));
        (astray <= ASTRAY * way.max(1e-6)).then_some(found)
    }

    /// The contact at a roll position near one that is known of the same pair with other values of its parameters.
    pub fn again(&self, near: &ContactPoint, roll: f64) -> Option<ContactPoint> {
        self.touching_near(roll, &near.all_unknowns(), &near.edges, near.first_normal.into())
    }

    /// Where the flanks touch at a roll position, near a contact that is known of the same pair with other values of its parameters: flank on
    /// flank, however far beyond the outlines of both and the ranges of their tools.
    pub fn of_flanks(&self, near: &ContactPoint, roll: f64) -> Option<ContactPoint> {
        let (root, members) = self.root(roll, &near.all_unknowns(), &[], near.first_normal.into())?;
        Some(self.point(root, roll, Vec::new(), &members))
    }

    /// The roll position near a known contact at which the lag is extreme: where its first derivative is zero. `None` where it has not
    /// different signs at two roll positions, and where the lag is locked.
    pub fn vertex(&self, near: &ContactPoint, between: [f64; 2]) -> Option<ContactPoint> {
        let [mut low, mut high] = between;
        let width = high - low;
        let [begin, end] = between.map(|roll| self.followed(near, roll));
        let (begin, end) = (begin?, end?);
        let sign = begin.lag_slopes[0].signum();
        if sign == end.lag_slopes[0].signum() {
            return None;
        }
        let mut at = near.clone();
        for _ in 0..VERTEX_STEPS {
            let step = -at.lag_slopes[0] / at.lag_slopes[1];
            if step.abs() <= SETTLED * width || high - low <= SETTLED * width {
                return (at.outcome == Outcome::Solved && !at.is_locked()).then_some(at);
            }
            if at.lag_slopes[0].signum() == sign {
                low = at.roll
            } else {
                high = at.roll
            }
            let next = at.roll + step;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            at = self.followed(&at, next)?;
        }
        None
    }

    /// The same from a contact near it, by Newton's steps alone.
    pub fn vertex_near(&self, near: &ContactPoint) -> Option<ContactPoint> {
        let mut at = near.clone();
        for _ in 0..VERTEX_STEPS {
            let step = -at.lag_slopes[0] / at.lag_slopes[1];
            if step.abs() <= SETTLED {
                return (at.outcome == Outcome::Solved && !at.is_locked()).then_some(at);
            }
            at = self.followed(&at, at.roll + step)?;
        }
        None
    }
}

//! What a mounting error or a setting changes of a contact.
//!
//! The unknowns have power series along any direction of roll and parameter together. Mixed derivatives come from series along different
//! directions: of those along (1, t) and (1, −t) the part that is odd in t.

use flank_expr::TaylorEvaluator;
use nalgebra::DMatrix;

use crate::analysis::geometry::{curvature_change_in, tangents};
use crate::contact::ContactProblem;
use crate::contact::point::{ContactPoint, Member};

/// By how much a contact changes with parameters, per unit of their change. Lengths are mm, angles radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactChange {
    /// Of the roll position, where the contact is followed as the vertex of the lag; zero where the roll is held.
    pub roll: f64,
    /// Of the lag.
    pub lag: f64,
    /// Of the first derivative of the lag by the roll, at the roll position that it had.
    pub lag_slope: f64,
    /// Of the second derivative of the lag by the roll.
    pub lag_curvature: f64,
    /// How the point moves, in the frame of each member, mm.
    pub moved: [[f64; 3]; 2],
    /// How the unit vectors out of each member turn, in its frame.
    pub normals: [[f64; 3]; 2],
    /// Of the way of the point over each member, in its frame, mm per radian of roll.
    pub path: [[f64; 3]; 2],
    /// Of the curvatures of the gap, 1/mm, the greater first; `None` where an edge touches.
    pub gap: Option<[f64; 2]>,
}

/// Series of all unknowns in the roll, to the third order.
type Rolled = Vec<Vec<f64>>;

/// How the unknowns change with a direction of roll and parameters, and the derivatives of the lag with them.
struct Rates {
    /// Of the unknowns.
    unknowns: Vec<f64>,
    /// Of their derivatives by the roll.
    slopes: Vec<f64>,
    /// Of the second derivative of the lag by the roll.
    lag_curvature: f64,
}

impl ContactChange {
    /// With a share of another change added.
    fn plus(self, share: f64, other: &ContactChange) -> ContactChange {
        let add = |a: [[f64; 3]; 2], b: &[[f64; 3]; 2]| [0, 1].map(|k| [0, 1, 2].map(|i| a[k][i] + share * b[k][i]));
        let gap = self.gap.zip(other.gap);
        ContactChange {
            roll: self.roll + share * other.roll,
            lag: self.lag + share * other.lag,
            lag_slope: self.lag_slope + share * other.lag_slope,
            lag_curvature: self.lag_curvature + share * other.lag_curvature,
            moved: add(self.moved, &other.moved),
            normals: add(self.normals, &other.normals),
            path: add(self.path, &other.path),
            gap: gap.map(|(a, b)| [a[0] + share * b[0], a[1] + share * b[1]]),
        }
    }
}

impl ContactProblem {
    /// What a change of parameters changes, each by its number with its share in the change; shares of one parameter add up. At the vertex of the
    /// lag, if the point is it and stays it, else at the same roll position. `None` where the contact is singular.
    pub fn change(&self, at: &ContactPoint, of: &[(usize, f64)], is_vertex: bool) -> Option<ContactChange> {
        let (by_roll, mut changes) = self.changes(at, &[of.to_vec()])?;
        let held = changes.pop()?;
        let roll = if is_vertex { -held.lag_slope / by_roll.lag_slope } else { 0.0 };
        let lag_slope = held.lag_slope;
        Some(ContactChange { lag_slope, ..held.plus(roll, &by_roll) })
    }

    /// What the roll changes of a contact, and what each of several changes of parameters does at the same roll position; each by its number
    /// with its share in the change. `None` where the contact is singular.
    pub fn changes(&self, at: &ContactPoint, of: &[Vec<(usize, f64)>]) -> Option<(ContactChange, Vec<ContactChange>)> {
        let (unknowns, lag) = (at.all_unknowns(), self.lag_at());
        let (system, parameters) = self.equations(&at.edges, at.roll, &at.first_normal.into())?;
        let along = |roll: f64, change: f64, of: &[(usize, f64)]| {
            let changed = of.iter().map(|(parameter, share)| (1 + parameter, share * change));
            let rates: Vec<(usize, f64)> = [(0, roll)].into_iter().chain(changed).collect();
            system.series(&unknowns, &parameters, &rates, 3)
        };
        let rolled: Rolled = along(1.0, 0.0, &[])?;
        let by_roll = Rates {
            unknowns: rolled.iter().map(|of| of[1]).collect(),
            slopes: rolled.iter().map(|of| 2.0 * of[2]).collect(),
            lag_curvature: 6.0 * rolled[lag][3],
        };
        let own = |of: &Vec<(usize, f64)>| {
            let (changed, both, against) = (along(0.0, 1.0, of)?, along(1.0, 1.0, of)?, along(1.0, -1.0, of)?);
            let rates = Rates {
                unknowns: changed.iter().map(|of| of[1]).collect(),
                slopes: both.iter().zip(&against).map(|(both, against)| 0.5 * (both[2] - against[2])).collect(),
                lag_curvature: both[lag][3] - against[lag][3] - 2.0 * changed[lag][3],
            };
            self.changed_by(at, (0.0, of), &rates, &rolled)
        };
        Some((self.changed_by(at, (1.0, &[]), &by_roll, &rolled)?, of.iter().map(own).collect::<Option<_>>()?))
    }

    /// What becomes of a contact where roll, parameters and unknowns change at these rates.
    fn changed_by(
        &self,
        at: &ContactPoint,
        (roll, of): (f64, &[(usize, f64)]),
        rates: &Rates,
        rolled: &Rolled,
    ) -> Option<ContactChange> {
        let values = at.all_unknowns().into_iter().chain(self.given(at.roll));
        // a parameter that is listed more than once changes by the sum of its shares
        let share = |k: usize| of.iter().filter(|(parameter, _)| *parameter == k).map(|(_, share)| share).sum::<f64>();
        let speeds = rates.unknowns.iter().copied().chain([roll]).chain((0..self.values.len()).map(share));
        let inputs: Vec<f64> = values.zip(speeds).flat_map(|(value, speed)| [value, speed]).collect();
        let mut outputs = vec![0.0; 2 * self.state.output_count()];
        TaylorEvaluator::new(&self.state, 1).run(&inputs, &mut outputs);
        let part = |order: usize| outputs.chunks(2).map(|series| series[order]).collect::<Vec<f64>>();
        let (here, speeds) = (self.members_from(&part(0)), self.members_from(&part(1)));
        // of the unknowns of each flank
        let own = |member: usize, of: &dyn Fn(usize) -> f64| {
            let from = member * self.unknowns[0];
            DMatrix::from_fn(self.unknowns[member], 1, |row, _| of(from + row))
        };
        let path = [0, 1].map(|k| {
            let (first, second) = (own(k, &|at| rolled[at][1]), own(k, &|at| rates.slopes[at]));
            let path = &speeds[k].own_slopes * first + &here[k].own_slopes * second;
            [path[(0, 0)], path[(1, 0)], path[(2, 0)]]
        });
        let gap = if at.edges.is_empty() { self.gap_change([&part(0), &part(1)]) } else { None };
        let lag = self.lag_at();
        let change = ContactChange {
            roll,
            lag: rates.unknowns[lag],
            lag_slope: rates.slopes[lag],
            lag_curvature: rates.lag_curvature,
            moved: speeds.each_ref().map(|speeds| speeds.own.into()),
            normals: speeds.each_ref().map(|speeds| speeds.own_normal.into()),
            path,
            gap,
        };
        change.moved.iter().chain(&change.path).flatten().all(|x| x.is_finite()).then_some(change)
    }

    /// Of the curvatures of the gap, where what they follow from changes so.
    fn gap_change(&self, [here, speeds]: [&[f64]; 2]) -> Option<[f64; 2]> {
        let (at, rates) = (self.members_from(here), self.members_from(speeds));
        let tangents = tangents(at[0].normal);
        let own = |k: usize| curvature_change_in(tangents, curvature_parts(&at[k]), curvature_parts(&rates[k]));
        let ((first, by_first), (second, by_second)) = (own(0)?, own(1)?);
        Some(first.plus(&second).principal_change(&by_first.plus(&by_second)))
    }
}

/// What a flank's curvatures follow from, in the order that [`curvature_change_in`] takes it.
fn curvature_parts(of: &Member) -> [&DMatrix<f64>; 3] {
    [&of.slopes, &of.normal_slopes, &of.constraint_slopes]
}

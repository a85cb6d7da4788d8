//! From solved points to their neighbours with care, many ways at once.

use std::collections::HashSet;

use flank_expr::LANES;

use crate::continuation::field::Field;
use crate::continuation::grid::{Grid, extrapolated};
use crate::continuation::lattice::Ways;
use crate::continuation::path::Path;
use crate::equations::solution::Solution;
use crate::newton::batch::LaneNewton;
use crate::newton::multistart::Lanes;

/// Ways that are followed before lanes go on from where they lead, as long as that solves others of them; twice as many each time that
/// it does not.
const FEW: usize = 8;
const MANY: usize = 1024;

/// A way between points beside each other on a lattice.
struct Attempt {
    from: usize,
    to: usize,
    /// The point on the other side of `from`, if there is one.
    behind: Option<usize>,
}

impl Grid<'_> {
    /// From roots to everything that can be reached from neighbour to neighbour on the lattice of some rows and columns, along
    /// the branch: never across a place where the Jacobian has no inverse. There a sheet ends at a fold, with another sheet
    /// behind it, or crosses another branch. A few ways, far from each other, are followed first: lanes may go on from there.
    pub(crate) fn spread(
        &mut self,
        field: &mut Field,
        newton: &mut LaneNewton<'_>,
        edge: &[usize],
        lattice: [&[usize]; 2],
    ) {
        let (mut known, mut together) = (HashSet::new(), FEW);
        let mut waiting = self.attempts(field, edge, lattice, &mut known);
        while !waiting.is_empty() {
            let attempts = picked(&mut waiting, together);
            let found = self.followed(field, &attempts);
            let mut edge = Vec::new();
            for (Attempt { to, .. }, mut solution) in attempts.iter().zip(found) {
                if let Some(earlier) = field.solution(*to) {
                    solution = earlier.better(solution);
                }
                field.put(*to, &solution);
                edge.extend(solution.is_root().then_some(*to));
            }
            self.settle(field, newton, &edge);
            if !self.is_careful {
                let further = self.spread_in_lanes(field, newton, edge.clone(), (lattice, Ways::Straight));
                edge.extend(further);
            }
            let before = waiting.len();
            waiting.retain(|attempt| !field.is_root(attempt.to));
            together = if before - waiting.len() >= attempts.len() { FEW } else { MANY.min(2 * together) };
            waiting.extend(self.attempts(field, &edge, lattice, &mut known));
        }
    }

    /// The ways from some points to points that are no roots, without those that are known.
    fn attempts(
        &self,
        field: &Field,
        edge: &[usize],
        [rows, columns]: [&[usize]; 2],
        known: &mut HashSet<[usize; 2]>,
    ) -> Vec<Attempt> {
        let place = |places: &[usize], index: usize| places.binary_search(&index).expect("a point of the lattice");
        let of = |&from: &usize| {
            let (row, column) = (place(rows, from / self.columns), place(columns, from % self.columns));
            let beside = move |di: isize, dj: isize| {
                let row = rows.get(row.checked_add_signed(di)?)?;
                Some(row * self.columns + columns.get(column.checked_add_signed(dj)?)?)
            };
            let ways = [(0, 1), (0, -1), (1, 0), (-1, 0)];
            ways.map(|(di, dj)| Some(Attempt { from, to: beside(di, dj)?, behind: beside(-di, -dj) }))
        };
        let all = edge.iter().flat_map(of).flatten();
        all.filter(|Attempt { from, to, .. }| !field.is_root(*to) && known.insert([*from, *to])).collect()
    }

    /// What ways lead to.
    fn followed(&mut self, field: &Field, attempts: &[Attempt]) -> Vec<Solution> {
        let (mut lanes, mut conditions) = (Lanes::new(self.system), self.system.conditions(&[0.0; 2]));
        let mut found = vec![Solution::never_reached(self.ranges); attempts.len()];
        let mut waiting = attempts.iter().map(|attempt| self.path(field, attempt)).enumerate();
        let (mut open, mut evaluations) = (Vec::new(), 0);
        loop {
            open.extend(waiting.by_ref().take(LANES - open.len()));
            if open.is_empty() {
                break;
            }
            for (lane, (_, path)) in open.iter().enumerate() {
                let (unknowns, target) = path.asks().expect("it is open");
                lanes.set_unknowns(lane, unknowns);
                lanes.set_parameters(lane, &target);
            }
            lanes.run(open.len());
            for (lane, (_, path)) in open.iter_mut().enumerate() {
                path.take(&lanes.at(lane), &mut conditions);
            }
            for (number, path) in open.extract_if(.., |(_, path)| path.asks().is_none()) {
                evaluations += path.evaluations;
                found[number] = path.found();
            }
        }
        drop(waiting);
        self.effort.evaluations += evaluations;
        found
    }

    /// A way, with a guess of where it leads: straight on from behind.
    fn path(&self, field: &Field, Attempt { from, to, behind }: &Attempt) -> Path<'_> {
        let near: Vec<f64> = field.unknowns(*from).collect();
        let gap = |other: usize| {
            let [(i, j), (k, l)] = [*from, other].map(|point| (point / self.columns, point % self.columns));
            (i.abs_diff(k) + j.abs_diff(l)) as f64
        };
        let behind = behind.filter(|behind| field.is_root(*behind));
        let start = behind
            .map_or_else(|| near.clone(), |behind| extrapolated(&near, field.unknowns(behind), gap(*to) / gap(behind)));
        Path::new(self.ranges, [self.targets[*from], self.targets[*to]], near, start)
    }
}

/// Takes some attempts out, evenly spread, no two of them for one point.
fn picked(waiting: &mut Vec<Attempt>, count: usize) -> Vec<Attempt> {
    let (step, mut number, mut points) = (waiting.len().div_ceil(count), 0, HashSet::new());
    let is_meant = |attempt: &mut Attempt| {
        number += 1;
        (number - 1) % step == 0 && points.insert(attempt.to)
    };
    waiting.extract_if(.., is_meant).collect()
}

//! From solved points to their neighbours with care, many ways at once.

use std::collections::HashSet;

use flank_expr::LANES;

use crate::continuation::field::Field;
use crate::continuation::grid::{Grid, extrapolated};
use crate::continuation::path::Path;
use crate::equations::solution::Solution;
use crate::newton::multistart::Lanes;

/// Ways that are followed before any of their ends counts.
const TOGETHER: usize = 1024;

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
    /// behind it, or crosses another branch. Gives the points it has solved.
    pub(crate) fn spread(&mut self, field: &mut Field, mut wave: Vec<usize>, lattice: [&[usize]; 2]) -> Vec<usize> {
        let mut solved = Vec::new();
        while !wave.is_empty() {
            let (mut attempts, first) = (self.attempts(field, &wave, lattice), solved.len());
            while !attempts.is_empty() {
                let mut tried = HashSet::new();
                let (now, mut later): (Vec<Attempt>, Vec<Attempt>) =
                    attempts.into_iter().partition(|attempt| tried.insert(attempt.to));
                for attempts in now.chunks(TOGETHER) {
                    let found = self.followed(field, attempts);
                    for (Attempt { to, .. }, mut solution) in attempts.iter().zip(found) {
                        if let Some(earlier) = field.solution(*to) {
                            solution = earlier.better(solution);
                        }
                        field.put(*to, &solution);
                        solved.extend(solution.is_root().then_some(*to));
                    }
                }
                later.retain(|attempt| !field.is_root(attempt.to));
                attempts = later;
            }
            wave = solved[first..].to_vec();
        }
        solved
    }

    /// All ways from the points of a wave to points that are no roots, each once.
    fn attempts(&self, field: &Field, wave: &[usize], [rows, columns]: [&[usize]; 2]) -> Vec<Attempt> {
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
        let mut seen = HashSet::new();
        let points = wave.iter().filter(|point| seen.insert(**point));
        points.flat_map(of).flatten().filter(|attempt| !field.is_root(attempt.to)).collect()
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

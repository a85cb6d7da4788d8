//! The lattice of points that a grid is filled from, many points at once.

use std::collections::VecDeque;

use flank_expr::LANES;

use crate::field::{Field, NEAR, SAME_DETERMINANT};
use crate::grid::{ASTRAY, Grid};
use crate::lanes::LaneNewton;
use crate::solution::distance;

/// A step from a solved point to the next one.
#[derive(Clone, Copy)]
struct Leap {
    from: usize,
    to: usize,
}

impl Grid<'_> {
    /// From the anchor to the points of the lattice of some rows and columns, in waves: along the tangent, then by Newton. A
    /// step counts only if it passes the test of the careful path in `stays_near` and the determinant hardly changes. Gives
    /// the solved points beside those that are left for that path.
    pub(crate) fn spread_in_lanes(
        &mut self,
        field: &mut Field,
        newton: &mut LaneNewton<'_>,
        anchor: usize,
        lattice: [&[usize]; 2],
    ) -> VecDeque<usize> {
        let mut unfinished = VecDeque::new();
        let mut wave = vec![anchor];
        while !wave.is_empty() {
            let leaps = self.leaps(field, &wave, lattice);
            let mut next = Vec::new();
            for block in leaps.chunks(LANES) {
                self.leap(field, newton, block);
                next.extend(block.iter().map(|leap| leap.to).filter(|to| field.is_root(*to)));
            }
            unfinished.extend(leaps.iter().filter(|leap| !field.is_root(leap.to)).map(|leap| leap.from));
            wave = next;
        }
        unfinished
    }

    /// Where the points of a wave lead that is not solved yet; each point once.
    fn leaps(&self, field: &Field, wave: &[usize], [rows, columns]: [&[usize]; 2]) -> Vec<Leap> {
        let mut leaps: Vec<Leap> = Vec::new();
        for &from in wave {
            let (i, j) = (from / self.columns, from % self.columns);
            let beside = |places: &[usize], at: usize| {
                let index = places.partition_point(|place| *place < at);
                [index.checked_sub(1), Some(index + 1)].map(|k| k.and_then(|k| places.get(k).copied()))
            };
            let (across, along) = (beside(columns, j), beside(rows, i));
            let corners = along.iter().flat_map(|i| across.iter().map(move |j| (*i, *j)));
            let straight = across.iter().map(|j| (Some(i), *j)).chain(along.iter().map(|i| (*i, Some(j))));
            for to in straight.chain(corners).filter_map(|(i, j)| Some(i? * self.columns + j?)) {
                if !field.is_root(to) && leaps.iter().all(|leap| leap.to != to) {
                    leaps.push(Leap { from, to });
                }
            }
        }
        leaps
    }

    fn leap(&mut self, field: &mut Field, newton: &mut LaneNewton<'_>, leaps: &[Leap]) {
        let (count, size) = (leaps.len(), self.ranges.len());
        // of one leap after the other
        let of = |lane: usize| lane * size..(lane + 1) * size;
        let put = |newton: &mut LaneNewton<'_>, unknowns: &[f64], target: fn(&Leap) -> usize| {
            for (lane, leap) in leaps.iter().enumerate() {
                newton.put(lane, unknowns[of(lane)].iter().copied(), &self.targets[target(leap)]);
            }
        };
        let points = leaps.iter().map(|leap| leap.from);
        let starts: Vec<f64> = points.flat_map(|point| field.unknowns(point)).collect();
        put(newton, &starts, |leap| leap.to);
        let led = self.along_tangents(newton, &starts);
        put(newton, &led, |leap| leap.to);
        // a start that is not finite fails like any other
        self.effort.evaluations += 2 * count as u64 + newton.run(&[true; LANES][..count], true);
        for (lane, leap) in leaps.iter().enumerate() {
            let ratio = newton.determinant()[lane] / field.determinant(leap.from);
            if newton.is_root(lane) && ratio < SAME_DETERMINANT && ratio * SAME_DETERMINANT > 1.0 {
                field.take(leap.to, newton, lane);
            }
        }
        let points = leaps.iter().map(|leap| if field.is_root(leap.to) { leap.to } else { leap.from });
        let ends: Vec<f64> = points.flat_map(|point| field.unknowns(point)).collect();
        put(newton, &ends, |leap| leap.from);
        let back = self.along_tangents(newton, &ends);
        for (lane, leap) in leaps.iter().enumerate() {
            let [start, led, end, back] = [&starts, &led, &ends, &back].map(|unknowns| &unknowns[of(lane)]);
            let leads = |from: &[f64], led: &[f64], to: &[f64]| {
                let allowed = ASTRAY * distance(from, led, self.ranges) + NEAR;
                distance(led, to, self.ranges) <= allowed
            };
            let stays = distance(start, end, self.ranges) <= NEAR || leads(start, led, end) && leads(end, back, start);
            if field.is_root(leap.to) && !stays {
                field.forget(leap.to);
            }
        }
    }

    /// Where the tangents at the first lanes lead, from the points that they hold.
    fn along_tangents(&self, newton: &mut LaneNewton<'_>, from: &[f64]) -> Vec<f64> {
        let size = self.ranges.len();
        let steps = newton.tangents(from.len() / size.max(1));
        let moved = |(k, from): (usize, &f64)| from + steps[k % size][k / size] * self.ranges[k % size].width();
        from.iter().enumerate().map(moved).collect()
    }
}

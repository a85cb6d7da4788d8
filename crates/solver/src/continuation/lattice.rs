//! The lattice of points that a grid is filled from, many points at once.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use std::array;
use std::collections::HashSet;

use flank_expr::LANES;

use crate::continuation::field::{Field, SAME_DETERMINANT};
use crate::continuation::grid::{ASTRAY, Grid};
use crate::continuation::path::dips;
use crate::equations::solution::{NEAR, Range};
use crate::newton::batch::{LaneNewton, Lanes};

/// Newton's step from where the middle of a leap is expected is no longer than this share of the leap, and [`NEAR`] of the ranges.
const OFF_HALFWAY: f64 = 0.125;

/// Which points beside each other are steps apart.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Ways {
    Straight,
    /// Also over corners.
    All,
}

/// A step from a solved point to the next one.
#[derive(Clone, Copy)]
struct Leap {
    from: usize,
    to: usize,
}

impl Grid<'_> {
    /// From solved points to those of the lattice of some rows and columns, in waves: along the tangent, then by Newton. A
    /// step counts only if tangents lead from each end to the other one, the determinant hardly changes, and halfway lies a root of the
    /// same sheet. Gives the solved points beside those that are left for the careful path.
    pub(crate) fn spread_in_lanes(
        &mut self,
        field: &mut Field,
        newton: &mut LaneNewton<'_>,
        mut wave: Vec<usize>,
        (lattice, ways): ([&[usize]; 2], Ways),
    ) -> Vec<usize> {
        let mut unfinished = Vec::new();
        while !wave.is_empty() {
            let leaps = self.leaps(field, &wave, lattice, ways);
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
    fn leaps(&self, field: &Field, wave: &[usize], [rows, columns]: [&[usize]; 2], ways: Ways) -> Vec<Leap> {
        let (mut leaps, mut reached) = (Vec::new(), HashSet::new());
        for &from in wave {
            let (i, j) = (from / self.columns, from % self.columns);
            let beside = |places: &[usize], at: usize| {
                let index = places.partition_point(|place| *place < at);
                [index.checked_sub(1), Some(index + 1)].map(|k| k.and_then(|k| places.get(k).copied()))
            };
            let (across, along) = (beside(columns, j), beside(rows, i));
            let corners = along.iter().flat_map(|i| across.iter().map(move |j| (*i, *j)));
            let straight = across.iter().map(|j| (Some(i), *j)).chain(along.iter().map(|i| (*i, Some(j))));
            let corners = corners.filter(|_| ways == Ways::All);
            for to in straight.chain(corners).filter_map(|(i, j)| Some(i? * self.columns + j?)) {
                if !field.is_root(to) && reached.insert(to) {
                    leaps.push(Leap { from, to });
                }
            }
        }
        leaps
    }

    fn leap(&mut self, field: &mut Field, newton: &mut LaneNewton<'_>, leaps: &[Leap]) {
        let count = leaps.len();
        let [from, to] = [0, 1].map(|end| leaps.iter().map(move |leap| [leap.from, leap.to][end]));
        let starts = self.unknowns(field, from.clone());
        self.put(newton, &starts, to.clone());
        let led = self.along_tangents(newton, count, &starts);
        self.put(newton, &led, to);
        // a start that is not finite fails like any other
        self.effort.evaluations += 2 * count as u64 + newton.run(&[true; LANES][..count], true);
        for (lane, leap) in leaps.iter().enumerate() {
            let ratio = newton.determinant()[lane] / field.determinant(leap.from);
            if newton.is_root(lane) && ratio < SAME_DETERMINANT && ratio * SAME_DETERMINANT > 1.0 {
                field.take(leap.to, newton, lane);
            }
        }
        let points = leaps.iter().map(|leap| if field.is_root(leap.to) { leap.to } else { leap.from });
        let ends = self.unknowns(field, points);
        self.put(newton, &ends, from);
        let back = self.along_tangents(newton, count, &ends);
        let pairs = [(&starts, &ends), (&starts, &led), (&led, &ends), (&ends, &back), (&back, &starts)];
        let [whole, there, beside_end, returned, beside_start] = pairs.map(|(a, b)| self.distances(a, b));
        let is_broken = self.is_broken_halfway(field, newton, (leaps, &whole), [&starts[..], &led, &ends, &back]);
        for (lane, leap) in leaps.iter().enumerate() {
            let leads = |tangent: &Lanes, beside: &Lanes| beside[lane] <= ASTRAY * tangent[lane] + NEAR;
            let stays = whole[lane] <= NEAR
                || leads(&there, &beside_end) && leads(&returned, &beside_start) && !is_broken[lane];
            if field.is_root(leap.to) && !stays {
                field.forget(leap.to);
            }
        }
    }

    /// Whether each leap may lead to another sheet: halfway, on the cubic with the tangents at both ends, lies no root of one sheet. Either
    /// Newton's step leads away from there, as above a hole, or the determinant [`dips`].
    fn is_broken_halfway(
        &mut self,
        field: &Field,
        newton: &mut LaneNewton<'_>,
        (leaps, whole): (&[Leap], &Lanes),
        [starts, led, ends, back]: [&[Lanes]; 4],
    ) -> [bool; LANES] {
        let size = self.ranges.len();
        for k in 0..size {
            let (start, led, end, back) = (&starts[k], &led[k], &ends[k], &back[k]);
            *newton.input(k) = array::from_fn(|lane| {
                let bend = (led[lane] - start[lane]) + (back[lane] - end[lane]);
                0.5 * (start[lane] + end[lane]) + 0.125 * bend
            });
        }
        for (lane, leap) in leaps.iter().enumerate() {
            let [from, to] = [leap.from, leap.to].map(|point| self.targets[point]);
            (0..2).for_each(|k| newton.input(size + k)[lane] = 0.5 * (from[k] + to[k]));
        }
        let mut step = [0.0; LANES];
        for steps in newton.tangents(leaps.len()) {
            for lane in 0..leaps.len() {
                // where there is no clear tangent none of them is a number
                step[lane] = if steps[lane].abs() <= step[lane] { step[lane] } else { steps[lane].abs() };
            }
        }
        self.effort.evaluations += leaps.len() as u64;
        let halfway = *newton.determinant();
        let mut is_broken = [false; LANES];
        for (lane, leap) in leaps.iter().enumerate() {
            let mean = 0.5 * (field.determinant(leap.from) + field.determinant(leap.to));
            let is_near = step[lane] <= OFF_HALFWAY * whole[lane] + NEAR;
            is_broken[lane] = !is_near || dips(mean, halfway[lane]);
        }
        is_broken
    }

    /// The unknowns of points, a lane for each.
    fn unknowns(&self, field: &Field, points: impl Iterator<Item = usize>) -> Vec<Lanes> {
        let mut unknowns = vec![[0.0; LANES]; self.ranges.len()];
        for (lane, point) in points.enumerate() {
            unknowns.iter_mut().zip(field.unknowns(point)).for_each(|(unknown, value)| unknown[lane] = value);
        }
        unknowns
    }

    /// Puts unknowns into the first lanes, with the targets of some points.
    fn put(&self, newton: &mut LaneNewton<'_>, unknowns: &[Lanes], points: impl Iterator<Item = usize>) {
        let size = unknowns.len();
        unknowns.iter().enumerate().for_each(|(k, unknown)| *newton.input(k) = *unknown);
        for (lane, point) in points.enumerate() {
            (0..2).for_each(|k| newton.input(size + k)[lane] = self.targets[point][k]);
        }
    }

    /// Where the tangents at the first lanes lead, from the unknowns that they hold.
    fn along_tangents(&self, newton: &mut LaneNewton<'_>, count: usize, from: &[Lanes]) -> Vec<Lanes> {
        let steps = newton.tangents(count);
        let moved = |((from, steps), range): ((&Lanes, &Lanes), &Range)| {
            array::from_fn(|lane| from[lane] + steps[lane] * range.width())
        };
        from.iter().zip(steps).zip(self.ranges).map(moved).collect()
    }

    /// What `distance` is, of each lane.
    fn distances(&self, a: &[Lanes], b: &[Lanes]) -> Lanes {
        let mut farthest = [0.0; LANES];
        for ((a, b), range) in a.iter().zip(b).zip(self.ranges) {
            for lane in 0..LANES {
                let share = (a[lane] - b[lane]).abs() / range.width();
                farthest[lane] = if share > farthest[lane] { share } else { farthest[lane] };
            }
        }
        farthest
    }
}

//! The same lanes of all lines of a field: what one thread solves.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::LANES;

use super::numbers::Numbers;
use super::{Along, Mark, SAME_DETERMINANT, Shape, block_of, number, take};
use crate::continuation::line::{Midpoint, STENCIL};
use crate::continuation::path::{dips, is_between, smaller};
use crate::equations::solution::NEAR;
use crate::equations::solution::Range;
use crate::newton::batch::{LaneNewton, Lanes};
use crate::newton::lines::OnLine;

/// A midpoint may lie this share of the way between its neighbours from where it was looked for, and [`NEAR`] of the ranges.
const ASTRAY: f64 = 0.25;
/// Lanes whose targets are put in order at once: a line of a cache takes so many.
const BESIDE: usize = 8;

/// The same part of all lines of a field.
pub(crate) struct Strip<'f> {
    pub(super) shape: Shape,
    pub(super) ranges: &'f [Range],
    /// Where the lanes are on the lines.
    pub(super) first: usize,
    pub(super) width: usize,
    pub(super) values: &'f mut [f64],
    pub(super) marks: &'f mut [[Mark; LANES]],
}

impl Strip<'_> {
    /// Solves what follows from the known lines, of which those of `along` are known at some places; what fails stays unknown, for
    /// the careful path. Gives the number of evaluations.
    pub(crate) fn refine(
        &mut self,
        newton: &mut LaneNewton<'_>,
        along: Option<&Along>,
        levels: &[Vec<Midpoint>],
        targets: &[[f64; 2]],
    ) -> u64 {
        let mut ordered = std::mem::take(newton.targets());
        self.put_in_order(targets, &mut ordered);
        let mut evaluations = along.map_or(0, |along| self.refine_along(newton, along, &ordered));
        let (mut rough, mut plain) = (true, true);
        let mut full: Vec<bool> = (0..self.shape.count).map(|line| self.is_line_of_roots(line)).collect();
        let mut empty: Vec<bool> = (0..self.shape.count).map(|line| self.is_untouched(line)).collect();
        for midpoint in levels.iter().flatten() {
            let is_free = empty[midpoint.at] && midpoint.known().iter().all(|(line, _)| full[*line]);
            empty[midpoint.at] = false;
            if let Some(expected) = newton.expected().filter(|_| is_free && plain && !rough) {
                evaluations += self.width as u64;
                full[midpoint.at] = self.is_as_expected(midpoint, expected, &ordered[midpoint.at]);
                if full[midpoint.at] {
                    continue;
                }
                rough = true;
            }
            for k in 0..2 {
                *newton.input(self.shape.size + k) = ordered[midpoint.at][k];
            }
            if is_free {
                if newton.has_all_given() {
                    *newton.determinant() = *self.plane(midpoint.beside[0], self.shape.size);
                } else {
                    self.interpolate_line(midpoint, newton, rough);
                }
                evaluations += newton.run(&[true; LANES][..self.width], rough);
            } else {
                let mut active = [false; LANES];
                for lane in 0..self.width {
                    active[lane] = self.interpolate_lane(midpoint, newton, lane);
                }
                let Some(first) = active.iter().position(|active| *active) else { continue };
                repeat_lane(self.shape, newton, first, &active[..self.width]);
                evaluations += newton.run(&active[..self.width], rough);
            }
            rough = newton.were_rough();
            let stays = self.stay_on_branch(midpoint, newton);
            plain = stays[..self.width].iter().all(|stays| *stays) && self.take_plain(midpoint.at, newton);
            full[midpoint.at] = plain || self.take_lanes(midpoint, newton, &stays);
        }
        *newton.targets() = ordered;
        evaluations
    }

    /// Computes lines one after the other whose points are given by the first target of the line and the second targets of the first
    /// line: those of which there is what [`OnLine::prepared`] has found. `known` are lines with a determinant on them; from one to the
    /// next each line follows from the one before if all of that are plain roots with determinants of that sign. What fails
    /// stays as it was. Gives the number of evaluations.
    pub(crate) fn compute(
        &mut self,
        on_line: &mut OnLine<'_>,
        known: &[(usize, f64)],
        lines: &[Option<Vec<f64>>],
        targets: &[[f64; 2]],
    ) -> u64 {
        let (mut second, mut evaluations) = ([0.0; LANES], 0);
        second.iter_mut().zip(self.targets_on(0, targets)).for_each(|(value, target)| *value = target[1]);
        on_line.set_second_targets(&second);
        let mut known = known.iter().peekable();
        let mut follows = false;
        let mut spare = Numbers::default();
        spare.set_len(self.shape.planes * LANES);
        let spare = spare.as_chunks_mut::<LANES>().0;
        // of all lines one after the other, as they lie in memory: between runs each would be waited for
        let untouched: Vec<bool> = (0..self.shape.count).map(|line| self.is_untouched(line)).collect();
        for (line, prepared) in lines.iter().enumerate() {
            let beside = known.next_if(|(known, _)| *known == line);
            if let Some((_, determinant)) = beside {
                on_line.set_determinant(*determinant);
            }
            let is_free = untouched[line];
            let is_next = beside.is_some() || follows && is_free;
            follows = false;
            let Some(prepared) = prepared.as_ref().filter(|_| is_next) else { continue };
            let values = &mut self.values.as_chunks_mut::<LANES>().0[line * self.shape.planes..][..self.shape.planes];
            let out = if is_free { &mut *values } else { &mut *spare };
            follows = on_line.run(prepared, self.width, out);
            evaluations += self.width as u64;
            if follows {
                self.marks[line][..self.width].fill(Mark::Plain);
                if !is_free {
                    values.copy_from_slice(spare);
                }
            }
        }
        evaluations
    }

    /// The targets of all lines.
    fn put_in_order(&self, targets: &[[f64; 2]], ordered: &mut Vec<[Lanes; 2]>) {
        let shape = self.shape;
        ordered.resize(shape.count, [[0.0; LANES]; 2]);
        let width = self.width.min(LANES);
        if shape.lanes_are_beside() {
            for (line, ordered) in ordered.iter_mut().enumerate() {
                let targets = &targets[shape.point(line, self.first)..][..width];
                let [first, second] = ordered;
                for ((target, first), second) in targets.iter().zip(first).zip(second) {
                    [*first, *second] = *target;
                }
            }
            return;
        }
        // some lanes at once, each from where its targets lie beside each other; of lanes that are not there the last one's
        for lanes in (0..width).step_by(BESIDE) {
            let rows: [&[[f64; 2]]; BESIDE] = std::array::from_fn(|k| {
                let lane = (lanes + k).min(width - 1);
                &targets[shape.point(0, self.first + lane)..][..shape.count]
            });
            for (line, ordered) in ordered.iter_mut().enumerate() {
                let [first, second] = ordered.each_mut().map(|target| &mut target[lanes..][..BESIDE]);
                for k in 0..BESIDE {
                    [first[k], second[k]] = rows[k][line];
                }
            }
        }
    }

    fn targets_on<'t>(&self, line: usize, targets: &'t [[f64; 2]]) -> impl Iterator<Item = &'t [f64; 2]> + use<'t> {
        let next = self.shape.point(line, 1) - self.shape.point(line, 0);
        targets[self.shape.point(line, self.first)..].iter().step_by(next).take(self.width)
    }

    pub(super) fn is_line_of_roots(&self, line: usize) -> bool {
        self.are_all(line, Mark::is_root)
    }

    fn is_untouched(&self, line: usize) -> bool {
        self.are_all(line, |mark| mark == Mark::Unknown)
    }

    /// Without an end at the first one that is not meant: that is vectors.
    fn are_all(&self, line: usize, is_meant: impl Fn(Mark) -> bool) -> bool {
        self.marks[line][..self.width].iter().fold(true, |all, mark| all & is_meant(*mark))
    }

    pub(super) fn plane(&self, line: usize, plane: usize) -> &Lanes {
        &self.values.as_chunks::<LANES>().0[line * self.shape.planes + plane]
    }

    /// The starts of a whole line, from whole lines. What is given needs none, but for a step from rough starts.
    fn interpolate_line(&self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>, rough: bool) {
        let size = self.shape.size;
        newton.instructions().dispatch(
            #[inline(always)]
            || {
                for plane in 0..size {
                    if rough || !newton.is_given(plane) {
                        *newton.input(plane) = self.sums(midpoint.known(), plane);
                    }
                }
                let [before, behind] = midpoint.beside.map(|line| self.plane(line, size));
                let (determinant, share) = (newton.determinant(), midpoint.share());
                for lane in 0..LANES {
                    determinant[lane] = determinant_between([before[lane], behind[lane]], share);
                }
            },
        );
    }

    /// The start of a lane of a line: on the polynomial through the known points around it, or between its two neighbours if some of
    /// them are no roots; the determinant where it cannot vanish between them, else NaN. False if the point is known or a neighbour
    /// is not: then it is not to be solved next.
    fn interpolate_lane(&self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>, lane: usize) -> bool {
        let (shape, values) = (self.shape, &*self.values);
        let is_root = |line: usize| self.marks[line][lane].is_root();
        let first = |line: usize| line * shape.planes * LANES + lane;
        let [before, behind] = midpoint.beside;
        if is_root(midpoint.at) || !is_root(before) || !is_root(behind) {
            return false;
        }
        let (mut stencil, mut is_complete) = ([(0, 0.0); STENCIL], true);
        for (known, (line, weight)) in stencil.iter_mut().zip(midpoint.known()) {
            is_complete &= is_root(*line);
            *known = (first(*line), *weight);
        }
        let share = midpoint.share();
        let linear = [(first(before), 1.0 - share), (first(behind), share)];
        let known = if is_complete { &stencil[..midpoint.known().len()] } else { &linear };
        let sum =
            |plane: usize| known.iter().map(|(first, weight)| weight * values[first + plane * LANES]).sum::<f64>();
        for k in 0..shape.size {
            newton.input(k)[lane] = sum(k);
        }
        let beside = linear.map(|(first, _)| values[first + shape.size * LANES]);
        newton.determinant()[lane] = determinant_between(beside, share);
        true
    }

    /// Takes what the lanes have come to if all are plain roots.
    pub(super) fn take_plain(&mut self, line: usize, newton: &mut LaneNewton<'_>) -> bool {
        let (shape, width) = (self.shape, self.width);
        let are_plain = newton.all_plain(width, NEAR);
        if are_plain {
            let values = &mut self.values.as_chunks_mut::<LANES>().0[line * shape.planes..][..shape.planes];
            for (k, values) in values.iter_mut().enumerate() {
                *values = *number(shape, newton, k);
            }
            self.marks[line][..width].fill(Mark::Solved);
        }
        are_plain
    }

    /// Where the determinant is what it is along the branch of both neighbours, or of all points that the start is from. Of lanes that took
    /// no step that is known before, and what is given in closed form has no other branch.
    fn stay_on_branch(&self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>) -> [bool; LANES] {
        let mut stays = [true; LANES];
        if !newton.were_rough() || newton.has_all_given() {
            return stays;
        }
        let (share, size) = (midpoint.share(), self.shape.size);
        let [before, behind] = midpoint.beside.map(|line| self.plane(line, size));
        let (instructions, found) = (newton.instructions(), newton.determinant());
        instructions.dispatch(
            #[inline(always)]
            || {
                for lane in 0..LANES {
                    stays[lane] = is_between([before[lane], behind[lane]], share, found[lane]);
                }
            },
        );
        if !stays[..self.width].iter().all(|stays| *stays) {
            let expected: Lanes = self.sums(midpoint.known(), size);
            for lane in 0..self.width {
                let is_known = || midpoint.known().iter().all(|(line, _)| self.marks[*line][lane].is_root());
                stays[lane] |= before[lane] * behind[lane] > 0.0
                    && before[lane] * expected[lane] > 0.0
                    && is_between([expected[lane]; 2], 0.0, found[lane])
                    && !dips(smaller([before[lane], behind[lane]]), found[lane])
                    && is_known();
            }
        }
        stays
    }

    /// Takes what the lanes have come to, one by one; whether all of them are roots now.
    fn take_lanes(&mut self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>, stays: &[bool; LANES]) -> bool {
        let (line, shape) = (midpoint.at, self.shape);
        for lane in 0..self.width {
            let [before, behind] = midpoint.beside;
            let apart = || {
                let share = |(k, range): (usize, &Range)| {
                    (self.plane(before, k)[lane] - self.plane(behind, k)[lane]).abs() / range.width()
                };
                self.ranges.iter().enumerate().map(share).fold(0.0, f64::max)
            };
            if stays[lane] && newton.is_root(lane) && !is_astray(newton.moved(lane), apart) {
                let values = block_of(shape, self.values, line);
                take(shape, values, &mut self.marks[line], lane, newton, lane);
            }
        }
        self.is_line_of_roots(line)
    }
}

/// The determinant at a share of the way between two places; no number where it may vanish there. Not on a polynomial through many lines:
/// of determinants only a few digits are known, and a polynomial makes much of what is wrong with them.
#[inline(always)]
pub(super) fn determinant_between([before, behind]: [f64; 2], share: f64) -> f64 {
    if is_same_side(before, behind) { before + share * (behind - before) } else { f64::NAN }
}

/// Whether the determinant cannot vanish between two places beside each other where it has these values. Not if one is no number.
#[inline(always)]
pub(super) fn is_same_side(a: f64, b: f64) -> bool {
    let (product, most) = (a * b, SAME_DETERMINANT * a * a);
    (product > 0.0) & (product < most) & (SAME_DETERMINANT * product > a * a)
}

/// Lanes that are not active get the numbers of one that is.
fn repeat_lane(shape: Shape, newton: &mut LaneNewton<'_>, from: usize, active: &[bool]) {
    for k in 0..shape.size + 2 {
        let values = newton.input(k);
        for lane in (0..active.len()).filter(|lane| !active[*lane]) {
            values[lane] = values[from];
        }
    }
}

/// Whether a point that came so far from its start may be on another branch than its neighbours, which are so far apart.
pub(super) fn is_astray(moved: f64, apart: impl Fn() -> f64) -> bool {
    moved > NEAR && moved > ASTRAY * apart() + NEAR
}

//! The same lanes of all lines of a field: what one thread solves.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::LANES;

use super::{Mark, NEAR, OnLine, Shape, block_of, interpolate, is_astray, keeps_sign, number, repeat_lane, take};
use crate::lanes::{LaneNewton, Lanes};
use crate::line::Midpoint;
use crate::solution::Range;

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
    /// Solves what follows from the known lines; what fails stays unknown, for the careful path. Gives the number of
    /// evaluations.
    pub(crate) fn refine(
        &mut self,
        newton: &mut LaneNewton<'_>,
        levels: &[Vec<Midpoint>],
        targets: &[[f64; 2]],
    ) -> u64 {
        let (mut evaluations, mut rough) = (0, true);
        let mut full: Vec<bool> = (0..self.shape.count).map(|line| self.is_line_of_roots(line)).collect();
        let mut empty: Vec<bool> = (0..self.shape.count).map(|line| self.is_untouched(line)).collect();
        for midpoint in levels.iter().flatten() {
            let is_free = empty[midpoint.at] && midpoint.known().iter().all(|(line, _)| full[*line]);
            empty[midpoint.at] = false;
            self.set_targets(midpoint.at, newton, targets);
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
            full[midpoint.at] = self.take_line(midpoint, newton);
        }
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
        let mut spare = vec![[0.0; LANES]; self.shape.planes];
        for (line, prepared) in lines.iter().enumerate() {
            let beside = known.next_if(|(known, _)| *known == line);
            if let Some((_, determinant)) = beside {
                on_line.set_determinant(*determinant);
            }
            let is_free = self.is_untouched(line);
            let is_next = beside.is_some() || follows && is_free;
            follows = false;
            let Some(prepared) = prepared.as_ref().filter(|_| is_next) else { continue };
            let values = &mut self.values.as_chunks_mut::<LANES>().0[line * self.shape.planes..][..self.shape.planes];
            let out = if is_free { &mut *values } else { &mut spare };
            follows = on_line.run(prepared, self.width, out);
            evaluations += self.width as u64;
            if follows {
                self.marks[line][..self.width].fill(Mark::Solved);
                if !is_free {
                    values.copy_from_slice(&spare);
                }
            }
        }
        evaluations
    }

    fn set_targets(&self, line: usize, newton: &mut LaneNewton<'_>, targets: &[[f64; 2]]) {
        for k in 0..2 {
            let values = newton.input(self.shape.size + k);
            for (value, target) in values.iter_mut().zip(self.targets_on(line, targets)) {
                *value = target[k];
            }
        }
    }

    fn targets_on<'t>(&self, line: usize, targets: &'t [[f64; 2]]) -> impl Iterator<Item = &'t [f64; 2]> + use<'t> {
        let next = self.shape.point(line, 1) - self.shape.point(line, 0);
        targets[self.shape.point(line, self.first)..].iter().step_by(next).take(self.width)
    }

    fn is_line_of_roots(&self, line: usize) -> bool {
        self.marks[line][..self.width].iter().all(|mark| mark.is_root())
    }

    fn is_untouched(&self, line: usize) -> bool {
        self.marks[line][..self.width].iter().all(|mark| *mark == Mark::Unknown)
    }

    fn plane(&self, line: usize, plane: usize) -> &Lanes {
        &self.values.as_chunks::<LANES>().0[line * self.shape.planes + plane]
    }

    /// The starts of a whole line, from whole lines. What is given needs none, but for a step from rough starts.
    fn interpolate_line(&self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>, rough: bool) {
        let size = self.shape.size;
        newton.instructions().dispatch(
            #[inline(always)]
            || {
                for plane in 0..=size {
                    if newton.is_given(plane) && !rough {
                        continue;
                    }
                    let mut sums = [0.0; LANES];
                    for (line, weight) in midpoint.known() {
                        let values = self.plane(*line, plane);
                        for lane in 0..LANES {
                            sums[lane] += weight * values[lane];
                        }
                    }
                    if plane < size {
                        *newton.input(plane) = sums;
                    } else {
                        *newton.determinant() = sums;
                    }
                }
                let [before, behind] = midpoint.beside.map(|line| self.plane(line, size));
                let determinant = newton.determinant();
                for lane in 0..LANES {
                    let is_known = keeps_sign(before[lane], determinant[lane], behind[lane]);
                    determinant[lane] = if is_known { determinant[lane] } else { f64::NAN };
                }
            },
        );
    }

    /// The start of one point; false if the point is known, or does not follow.
    fn interpolate_lane(&self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>, lane: usize) -> bool {
        interpolate(self.shape, midpoint, (self.values, self.marks), |line| (line, lane), newton, lane)
    }

    /// Takes what the lanes have come to if all are plain roots.
    fn take_plain(&mut self, line: usize, newton: &mut LaneNewton<'_>) -> bool {
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

    /// Takes what the lanes have come to; whether all of them are roots now.
    fn take_line(&mut self, midpoint: &Midpoint, newton: &mut LaneNewton<'_>) -> bool {
        let line = midpoint.at;
        let (shape, width) = (self.shape, self.width);
        if self.take_plain(line, newton) {
            return true;
        }
        for lane in 0..width {
            let [before, behind] = midpoint.beside;
            let apart = || {
                let share = |(k, range): (usize, &Range)| {
                    (self.plane(before, k)[lane] - self.plane(behind, k)[lane]).abs() / range.width()
                };
                self.ranges.iter().enumerate().map(share).fold(0.0, f64::max)
            };
            if newton.is_root(lane) && !is_astray(newton.moved(lane), apart) {
                let values = block_of(shape, self.values, line);
                take(shape, values, &mut self.marks[line], lane, newton, lane);
            }
        }
        self.is_line_of_roots(line)
    }
}

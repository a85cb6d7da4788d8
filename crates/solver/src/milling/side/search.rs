//! The motion that leaves least.

use std::f64::consts::FRAC_PI_2;

use faer::Mat;

use super::bend::bent;
use super::left::nearest_shares;
use super::{FREE, SideMotion, SidePass, SideStrip, weighted, weights};
use crate::equations::solution::Range;
use crate::milling::height::{Lowest, NormalLine, lowest, slopes_of_side};
use crate::milling::outline::{Cutter, meridian};
use crate::milling::series::PoseSeries;
use crate::newton::least_squares::{LeastSquares, Linearized, ScaledUnknown};
use crate::newton::minimax::{Functions, Minimax};
use crate::solid::chart::Chart;

/// A lean up to this to both sides, radians.
const FARTHEST_LEAN: f64 = 0.7;
/// Steps that change no height by more than this end the search for the least squares, mm ...
const ALIKE: f64 = 1e-11;
/// ... and so do steps that leave more than this share of them: it is where the search for the least largest begins.
const SLOW: f64 = 0.9;
/// That ends where no step promises to lower the largest by more than this, mm, ...
const SETTLED: f64 = 1e-8;
/// ... or by more than this share of it: a tenth of a nanometre of 0.1 mm, and less than what is printed.
const SHARE: f64 = 1e-6;
/// What the largest does not tell apart stays where the squares are least: a way of 1 mm or 0.1 rad from there may cost half this share of
/// the largest.
const KEPT: f64 = 1e-4;
/// What counts as much as a radian of turn or lean, mm of height: a cutter's side is some 10 mm long.
const SCALE: f64 = 10.0;

/// What a strip's pass leaves over points, as functions of what is free.
struct LeftOver<'s> {
    strip: &'s SideStrip,
    cutter: Cutter,
    points: &'s [NormalLine],
    /// Where on the way the cutter was lowest over each the last time.
    near: Vec<f64>,
}

impl SideStrip {
    fn left_over<'s>(&'s self, free: &[f64], points: &'s [NormalLine]) -> LeftOver<'s> {
        let cutter = Cutter { pieces: vec![self.side.lengthened().piece()] };
        let near = nearest_shares(&self.way(free), &cutter, points);
        LeftOver { strip: self, cutter, points, near }
    }

    /// A motion of which the sum of the squares of what it leaves over points is nearly least, from turns at so many places of the way.
    /// `None` if the cutter does not pass over one of the points at the start.
    pub fn squared(&self, turns: &[f64], points: &[NormalLine]) -> Option<SideMotion> {
        let unknowns = unknowns(turns);
        let mut left = self.left_over(&unknowns.iter().map(|of| of.start).collect::<Vec<f64>>(), points);
        let squares = LeastSquares {
            unknowns,
            exact: 0,
            resolution: 0.0,
            uses_weak: false,
            settled: ALIKE,
            given_up: Some(SLOW),
        };
        let fit = squares.solve(|values| left.linearized(values))?;
        Some(SideMotion { free: fit.values, left: fit.residuals })
    }

    /// Where the search begins whose axis is free at as many places as there are turns: at the best motion of half as many, and so on, from
    /// the least squares where the fewest are free. What few places do well stays smooth where more of them do little.
    pub fn begun(&self, turns: &[f64], points: &[NormalLine]) -> Option<SideMotion> {
        let counts = std::iter::successors(Some(turns.len()), |count| Some(count / 2).filter(|half| *half > 0));
        let mut counts: Vec<usize> = counts.skip(1).collect();
        counts.reverse();
        let mut known: Option<SideMotion> = None;
        for count in counts {
            let start = match known {
                Some(coarser) => Some(coarser.freed(count)),
                None => self.squared(&resampled(turns, count), points),
            };
            known = start.and_then(|start| self.nearest_pass(&start, points)).map(|pass| pass.motion);
        }
        known.map(|coarser| coarser.freed(turns.len())).or_else(|| self.squared(turns, points))
    }

    /// The motion of which the largest amount of what it leaves over points is least, from another one.
    /// `None` if the cutter does not pass over one of the points at the start.
    pub fn nearest_pass(&self, start: &SideMotion, points: &[NormalLine]) -> Option<SidePass> {
        let mut left = self.left_over(&start.free, points);
        let unknowns = unknowns(&start.free[..start.free.len() / FREE]).into_iter().zip(&start.free);
        let unknowns = unknowns.map(|(of, start)| ScaledUnknown { start: *start, ..of }).collect();
        let fit = Minimax { unknowns, settled: SETTLED, share: SHARE, kept: KEPT }.solve(&mut left)?;
        let way = self.way(&fit.values);
        let above = |(line, left): (&NormalLine, &f64), share: f64| {
            let height = left + self.stock;
            meridian(&way.at(share), [0, 1, 2].map(|k| line[k] + height * line[3 + k]))[1]
        };
        left.linearized(&fit.values)?;
        let above = points.iter().zip(&fit.residuals).zip(&left.near).map(|(of, share)| above(of, *share));
        let touches = above.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        let motion = SideMotion { free: fit.values, left: fit.residuals };
        Some(SidePass { way, motion, touches, gap: fit.gap, is_settled: fit.is_settled })
    }
}

impl SideMotion {
    /// The same, free at more places.
    fn freed(self, count: usize) -> SideMotion {
        let each = self.free.chunks(self.free.len() / FREE).flat_map(|values| resampled(values, count));
        SideMotion { free: each.collect(), left: self.left }
    }
}

/// Values of a polynomial at so many places of the way, from those at others.
fn resampled(values: &[f64], count: usize) -> Vec<f64> {
    let places = if count == 1 { vec![0.5] } else { Chart::shares(count) };
    places.into_iter().map(|share| weighted(values, &weights(values.len(), share))).collect()
}

/// Turns, leans and heights at so many places.
fn unknowns(turns: &[f64]) -> Vec<ScaledUnknown> {
    let angle =
        |start: f64, most: f64| ScaledUnknown { start, scale: 1.0 / SCALE, range: Range { low: -most, high: most } };
    let endless = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    (turns.iter().map(|turn| angle(*turn, FRAC_PI_2)))
        .chain(turns.iter().map(|_| angle(0.0, FARTHEST_LEAN)))
        .chain(turns.iter().map(|_| ScaledUnknown { start: 0.0, scale: 1.0, range: endless }))
        .collect()
}

impl Functions for LeftOver<'_> {
    fn linearized(&mut self, values: &[f64]) -> Option<Linearized> {
        let (way, count) = (self.strip.way(values), values.len() / FREE);
        let mut jacobian = Mat::zeros(self.points.len(), values.len());
        let (mut shares, mut residuals) = (Vec::new(), Vec::new());
        for (row, (line, near)) in self.points.iter().zip(&self.near).enumerate() {
            let found = lowest(&way, &self.cutter, line, *near)?;
            // the place changes the height by nothing where it is lowest, and not at all at the end of the way
            let share = found.share.clamp(0.0, 1.0);
            let lying = self.strip.lying(share, SideStrip::free(values, share));
            let by_pose = slopes_of_side(&self.strip.side, &lying.pose(), line, found.height);
            let weights = weights(count, share);
            for (k, slope) in lying.slopes().iter().enumerate() {
                let by_free: f64 = by_pose.iter().zip(slope).map(|(a, b)| a * b).sum();
                weights.iter().enumerate().for_each(|(at, weight)| jacobian[(row, k * count + at)] = by_free * weight);
            }
            shares.push(share);
            residuals.push(found.height - self.strip.stock);
        }
        self.near = shares;
        Some(Linearized { residuals, jacobian })
    }

    fn bent(&mut self, values: &[f64], weights: &[f64]) -> Mat<f64> {
        let way = self.strip.way(values);
        let slopes = self.strip.slopes(values, way.values());
        let mut sum = Mat::zeros(values.len(), values.len());
        let each = self.points.iter().zip(&self.near).zip(weights);
        for ((line, near), weight) in each.filter(|(_, weight)| **weight != 0.0) {
            let Some(found) = lowest(&way, &self.cutter, line, *near) else { continue };
            self.strip.add_bent((&way, &slopes), values, (line, found, *weight), &mut sum);
        }
        sum
    }
}

impl SideStrip {
    /// How the pose changes with turn, lean and height, as polynomials through so many values.
    fn slopes(&self, values: &[f64], count: usize) -> [PoseSeries; FREE] {
        let nodes = Chart::shares(count);
        let rows: Vec<[[f64; 6]; FREE]> =
            nodes.into_iter().map(|share| self.lying(share, Self::free(values, share)).slopes()).collect();
        [0, 1, 2].map(|k| PoseSeries::through(&rows.iter().map(|row| row[k]).collect::<Vec<[f64; 6]>>()))
    }

    /// Adds the second derivatives of what is left over a point by all that is free, as often as it weighs.
    ///
    /// The height is least along the way: as the values change, so does the place, and what that lowers it by is of second order.
    fn add_bent(
        &self,
        (way, slopes): (&PoseSeries, &[PoseSeries; FREE]),
        values: &[f64],
        (line, found, weight): (&NormalLine, Lowest, f64),
        sum: &mut Mat<f64>,
    ) {
        let count = values.len() / FREE;
        let share = found.share.clamp(0.0, 1.0);
        let [pose, speed, bend] = way.moving(share);
        let lying = self.lying(share, Self::free(values, share));
        let [turn, both, lean] = lying.bends();
        let turning = slopes.each_ref().map(|of| of.moving(share)[1]);
        let none = [0.0; 6];
        let [first, second, third] = lying.slopes();
        let bends = [
            [turn, both, none, turning[0]],
            [both, lean, none, turning[1]],
            [none, none, none, turning[2]],
            [turning[0], turning[1], turning[2], bend],
        ];
        let (rises, by) = bent(&self.side, (&pose, line, found.height), &[first, second, third, speed], &bends);
        let (weights, sloping) = (weights(count, share), weight_slopes(count, share));
        let along: Vec<f64> = (0..values.len())
            .map(|k| by[k / count][FREE] * weights[k % count] + rises[k / count] * sloping[k % count])
            .collect();
        let moves = if found.is_within { 1.0 / by[FREE][FREE] } else { 0.0 };
        for i in 0..values.len() {
            for j in 0..values.len() {
                let still = by[i / count][j / count] * weights[i % count] * weights[j % count];
                sum[(i, j)] += weight * (still - along[i] * along[j] * moves);
            }
        }
    }
}

fn weight_slopes(count: usize, share: f64) -> Vec<f64> {
    if count == 1 { vec![0.0] } else { Chart::weight_slopes(count, share) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::milling::outline::StraightSide;

    /// Slopes and second derivatives against differences, on a saddle under a cone whose lean, turn and height all change along the way.
    #[test]
    fn derivatives_of_what_is_left_are_exact() {
        let at = |v: f64, u: f64| {
            let (zu, zv) = (v / 60.0 - u / 80.0, u / 60.0);
            let size = (1.0 + zu * zu + zv * zv).sqrt();
            [u, v, u * v / 60.0 - u * u / 160.0, -zu / size, -zv / size, 1.0 / size]
        };
        let strip = SideStrip {
            middle: PoseSeries::sampled(33, |share| at(0.0, 20.0 * share - 10.0)),
            spindle_left: true,
            side: StraightSide { half_angle: 0.1, heights: [5.0, 45.0], radius: 3.0 },
            heights: vec![24.0, 25.0, 26.5],
            stock: 0.1,
        };
        // the last point lies where the way ends before
        let points = [at(-3.0, -4.0), at(2.0, 1.0), at(4.0, 5.0), at(1.0, 13.0)];
        let free = [0.11, 0.09, 0.12, 0.01, -0.02, 0.015, 0.003, -0.004, 0.002];
        let mut left = strip.left_over(&free, &points);
        let weights = [0.4, -0.3, 0.2, 0.1];
        let bent = left.bent(&free, &weights);
        let here = left.linearized(&free).expect("it passes");
        const STEP: f64 = 1e-5;
        for k in 0..free.len() {
            let [up, down] = [STEP, -STEP].map(|step| {
                let mut values = free;
                values[k] += step;
                left.linearized(&values).expect("it passes there, too")
            });
            for row in 0..points.len() {
                let slope = (up.residuals[row] - down.residuals[row]) / (2.0 * STEP);
                // third derivatives of up to some 1e3 mm, rounding of 1e-14 mm over the step
                assert!((here.jacobian[(row, k)] - slope).abs() < 1e-6, "{row} {k}: {slope}");
            }
            for i in 0..free.len() {
                let slope = |of: &Linearized| (0..4).map(|row| weights[row] * of.jacobian[(row, i)]).sum::<f64>();
                let bend = (slope(&up) - slope(&down)) / (2.0 * STEP);
                let scale = 1.0 + bend.abs();
                assert!((bent[(i, k)] - bend).abs() < 1e-6 * scale, "{i} {k}: {} {bend}", bent[(i, k)]);
            }
        }
    }
}

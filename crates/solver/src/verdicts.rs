//! What makes a root of a surface's system a point of the branch that is meant: conditions on its unknowns, and a tangent plane.

use std::f64::consts::TAU;
use std::ops;

use flank_expr::{ScalarEvaluator, Tape};

use crate::enclosure::invert;
use crate::field::Field;
use crate::newton::Linearized;
use crate::solution::{Outcome, Range};
use crate::system::System;

/// Where the second direction of a tangent plane moves the point less than this share of what the unknowns move it, all of them through
/// the whole of their ranges, the surface is a line there: of a flank of 100 mm the tenth part of a micrometre. Rounding leaves less than
/// a thousandth of that, as roots are good to 1e-11.
const COLLAPSED: f64 = 1e-6;
/// Points that are looked at to see whether a sheet has tangent planes at all, at the most. Between bifurcations, over which no step
/// leads, a sheet has them all over or nowhere, but for lines on which its determinant vanishes, too.
const SAMPLED: usize = 7;
/// Points of the largest grid all of which are looked at where some are missing: a sheet may end at a branch that crosses it.
const MOST_LOOKED_AT: usize = 4096;

/// What a branch must be like.
pub(crate) struct Keep<'c> {
    /// Functions of the unknowns.
    pub(crate) tape: &'c Tape,
    /// Between which values they lie.
    pub(crate) between: &'c [Range],
    /// Where its unknowns may be.
    pub(crate) ranges: &'c [Range],
}

impl Keep<'_> {
    /// The first condition that does not hold.
    pub(crate) fn broken(&self, unknowns: &[f64]) -> Option<usize> {
        let mut values = vec![0.0; self.between.len()];
        ScalarEvaluator::new(self.tape).run(unknowns, &mut values);
        values.iter().zip(self.between).position(|(value, range)| !(range.low <= *value && *value <= range.high))
    }

    /// The same point where all conditions hold, perhaps a turn of one of its periodic unknowns further on.
    fn turned(&self, unknowns: &[f64], ranges: &[Range], periodic: &[bool]) -> Result<Vec<f64>, usize> {
        let Some(condition) = self.broken(unknowns) else { return Ok(unknowns.to_vec()) };
        let turning = (0..periodic.len()).filter(|k| periodic[*k]);
        let others = turning.flat_map(|k| [TAU, -TAU].map(|turn| (k, turn))).map(|(k, turn)| {
            let mut other = unknowns.to_vec();
            other[k] += turn;
            other
        });
        let is_within = |other: &[f64]| other.iter().zip(ranges).all(|(x, range)| range.excess(*x) == 0.0);
        let mut kept = others.filter(|other| is_within(other) && self.broken(other).is_none());
        kept.next().ok_or(condition)
    }

    /// The verdicts on some points of a field.
    pub(crate) fn judge(&self, field: &mut Field, points: ops::Range<usize>, ranges: &[Range], periodic: &[bool]) {
        for point in points.filter(|point| field.is_root(*point) && !field.is_outside(*point)).collect::<Vec<_>>() {
            let unknowns: Vec<f64> = field.unknowns(point).collect();
            match self.turned(&unknowns, ranges, periodic) {
                Ok(turned) if turned == unknowns => {}
                Ok(turned) => field.turn(point, &turned),
                Err(condition) => field.judge(point, Outcome::NotKept { condition }),
            }
        }
    }
}

/// Sees where a surface has no tangent plane.
#[derive(Clone, Copy)]
pub(crate) struct TangentPlanes<'c> {
    pub(crate) system: &'c System,
    /// The derivatives of the position by each unknown.
    pub(crate) slopes: &'c Tape,
    pub(crate) ranges: &'c [Range],
}

impl TangentPlanes<'_> {
    /// Whether there is none at a root: with T a basis of the directions in which the constraints do not change, ∂r/∂p·T has a rank
    /// below 2.
    pub(crate) fn is_collapsed(&self, unknowns: &[f64]) -> bool {
        let n = self.ranges.len();
        let mut evaluation = self.system.evaluation(&[0.0; 2]);
        evaluation.at(unknowns);
        let width = |k: usize| self.ranges[k].width();
        let mut jacobian: Vec<f64> = (0..n * n).map(|k| evaluation.jacobian(k / n, k % n) * width(k % n)).collect();
        let mut inverse: Vec<f64> = (0..n * n).map(|k| f64::from(u8::from(k / n == k % n))).collect();
        // the last two equations are the coordinates: along each of them the other equations do not change
        if !invert(&mut jacobian, &mut inverse, n) {
            return true;
        }
        let column = |j: usize| (0..n).map(|k| inverse[k * n + j]).collect::<Vec<f64>>();
        let (a, mut b) = (unit(column(n - 2)), column(n - 1));
        let along: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
        b.iter_mut().zip(&a).for_each(|(b, a)| *b -= along * a);
        let b = unit(b);
        let mut slopes = vec![0.0; 3 * n];
        ScalarEvaluator::new(self.slopes).run(unknowns, &mut slopes);
        let moved = |t: &[f64]| -> [f64; 3] {
            std::array::from_fn(|i| (0..n).map(|k| slopes[3 * k + i] * width(k) * t[k]).sum())
        };
        let (a, b) = (moved(&a), moved(&b));
        let area = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let scale = length(&(0..3 * n).map(|k| slopes[k] * width(k / 3)).collect::<Vec<f64>>());
        // what is not a number stays to the other verdicts
        length(&area) <= COLLAPSED * scale * length(&a).max(length(&b))
    }

    /// The verdicts on some points of a field: of those that the careful path has solved one by one, and of all if it is so at some of
    /// them.
    pub(crate) fn judge(&self, field: &mut Field, points: ops::Range<usize>) {
        let has_gaps = points.len() <= MOST_LOOKED_AT && !points.clone().all(|point| field.is_root(point));
        if has_gaps || self.are_missing(field, points.clone()) {
            for point in points {
                if self.is_missing(field, point) {
                    field.judge(point, Outcome::Singular);
                }
            }
        }
    }

    /// Whether there is none at some of the points that are looked at first.
    pub(crate) fn are_missing(&self, field: &Field, mut points: ops::Range<usize>) -> bool {
        let (first, step) = (points.start, points.len().div_ceil(SAMPLED).max(1));
        points.any(|point| {
            ((point - first).is_multiple_of(step) || field.determinant(point).is_nan()) && self.is_missing(field, point)
        })
    }

    fn is_missing(&self, field: &Field, point: usize) -> bool {
        let is_judged = field.is_root(point) && !field.is_outside(point);
        is_judged && self.is_collapsed(&field.unknowns(point).collect::<Vec<f64>>())
    }
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn unit(v: Vec<f64>) -> Vec<f64> {
    let size = length(&v);
    v.into_iter().map(|x| x / size).collect()
}

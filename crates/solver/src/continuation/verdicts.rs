//! What makes a root of a surface's system a point of the branch that is meant: conditions on its unknowns, and a tangent plane.

use std::f64::consts::TAU;
use std::ops;

use flank_expr::{InstructionSet, LANES, LaneEvaluator, LaneTape, ScalarEvaluator, Tape};

use crate::continuation::field::Field;
use crate::equations::solution::{Outcome, Range};
use crate::roots::enclosure::eliminate;

/// Where the second direction of a tangent plane moves the point less than this share of what the unknowns move it, all of them through
/// the whole of their ranges, the surface is a line there: of a flank of 100 mm the tenth part of a micrometre. Rounding leaves less than
/// a thousandth of that, as roots are good to 1e-11.
const COLLAPSED: f64 = 1e-6;
/// Points that are looked at to see whether a sheet has tangent planes at all, at the most. Between bifurcations a sheet has them all over
/// or nowhere, but for lines on which its determinant vanishes, too.
const SAMPLED: usize = 7;
/// Points of the largest grid all of which are looked at: where branches cross at a small angle, a step may have led from one to the other.
const FEW: usize = 512;
/// Points of the largest grid all of which are looked at where some are missing: a sheet may end at a branch that crosses it.
const MOST_LOOKED_AT: usize = 4096;

/// Turns of a periodic unknown after which conditions are looked at, the nearest first.
const TURNS: [f64; 4] = [1.0, -1.0, 2.0, -2.0];

/// What a branch must be like.
pub(crate) struct Keep<'c> {
    /// Functions of the unknowns.
    pub(crate) tape: &'c Tape,
    pub(crate) in_lanes: &'c LaneTape,
    /// Between which values they lie.
    pub(crate) between: &'c [Range],
    /// Where its unknowns may be.
    pub(crate) ranges: &'c [Range],
}

/// The same unknowns some turns of a periodic one further on, the nearest first: where a `keep` is looked at if it does not hold for themselves.
pub fn turned(unknowns: &[f64], periodic: &[bool]) -> impl Iterator<Item = Vec<f64>> {
    let turning = (0..periodic.len()).filter(|k| periodic[*k]);
    turning.flat_map(|k| TURNS.map(|turns| (k, turns))).map(|(k, turns)| {
        let mut other = unknowns.to_vec();
        other[k] += turns * TAU;
        other
    })
}

impl Keep<'_> {
    /// The first condition that does not hold.
    pub(crate) fn broken(&self, unknowns: &[f64]) -> Option<usize> {
        let mut values = vec![0.0; self.between.len()];
        ScalarEvaluator::new(self.tape).run(unknowns, &mut values);
        values.iter().zip(self.between).position(|(value, range)| !(range.low <= *value && *value <= range.high))
    }

    /// The same unknowns, perhaps some turns of a periodic one further on, where all conditions hold; a condition that does not, where they
    /// hold after none of these turns.
    fn met(&self, unknowns: &[f64], periodic: &[bool]) -> Result<Vec<Vec<f64>>, usize> {
        let Some(condition) = self.broken(unknowns) else { return Ok(vec![unknowns.to_vec()]) };
        let met: Vec<Vec<f64>> = turned(unknowns, periodic).filter(|other| self.broken(other).is_none()).collect();
        if met.is_empty() { Err(condition) } else { Ok(met) }
    }

    /// Whether all conditions hold, perhaps some turns of what is periodic further on.
    pub(crate) fn holds(&self, unknowns: &[f64], periodic: &[bool]) -> bool {
        self.met(unknowns, periodic).is_ok()
    }

    /// The same point in the turn in which all conditions hold. Its values stay within its ranges: where that turn lies beyond them, they
    /// are those that it has.
    fn turned(&self, unknowns: &[f64], ranges: &[Range], periodic: &[bool]) -> Result<Vec<f64>, usize> {
        let is_within = |other: &Vec<f64>| other.iter().zip(ranges).all(|(x, range)| range.excess(*x) == 0.0);
        let met = self.met(unknowns, periodic)?;
        Ok(met.into_iter().find(is_within).unwrap_or_else(|| unknowns.to_vec()))
    }

    /// Those of some points of a field at which a condition does not hold.
    fn doubtful(&self, field: &Field, points: ops::Range<usize>) -> Vec<usize> {
        let judged: Vec<usize> = points.filter(|point| is_judged(field, *point)).collect();
        // few runs do not pay for machine code
        let mut evaluator = LaneEvaluator::new(self.in_lanes, InstructionSet::widest());
        let mut doubtful = Vec::new();
        for points in judged.chunks(LANES) {
            for (lane, point) in points.iter().enumerate() {
                field.unknowns(*point).enumerate().for_each(|(k, value)| evaluator.input(k)[lane] = value);
            }
            evaluator.run_first(points.len());
            let holds = |lane: usize| {
                let within =
                    |(k, range): (usize, &Range)| (range.low..=range.high).contains(&evaluator.output(k)[lane]);
                self.between.iter().enumerate().all(within)
            };
            doubtful.extend(points.iter().enumerate().filter(|(lane, _)| !holds(*lane)).map(|(_, point)| *point));
        }
        doubtful
    }

    /// The verdicts on some points of a field.
    pub(crate) fn judge(&self, field: &mut Field, points: ops::Range<usize>, ranges: &[Range], periodic: &[bool]) {
        for point in self.doubtful(field, points) {
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
    /// Of the unknowns and the targets: the Jacobian of the equations row by row, then the derivatives of the position by each unknown.
    pub(crate) slopes: &'c LaneTape,
    pub(crate) ranges: &'c [Range],
}

impl TangentPlanes<'_> {
    /// Whether there is none at a root.
    pub(crate) fn is_collapsed(&self, unknowns: &[f64]) -> bool {
        let mut slopes = Slopes::new(self);
        unknowns.iter().enumerate().for_each(|(k, value)| slopes.evaluator.input(k)[0] = *value);
        slopes.evaluator.run_first(1);
        slopes.is_collapsed(0)
    }

    /// The verdicts on some points of a field: of those that the careful path has solved one by one, and of all if it is so at some of
    /// them.
    pub(crate) fn judge(&self, field: &mut Field, points: ops::Range<usize>) {
        let has_gaps = points.len() <= MOST_LOOKED_AT && !field.are_roots(points.clone());
        if has_gaps || self.are_missing(field, points.clone()) {
            let judged: Vec<usize> = points.filter(|point| is_judged(field, *point)).collect();
            let mut slopes = Slopes::new(self);
            for points in judged.chunks(LANES) {
                slopes.look_at(field, points);
                for (lane, point) in points.iter().enumerate() {
                    if slopes.is_collapsed(lane) {
                        field.judge(*point, Outcome::Singular);
                    }
                }
            }
        }
    }

    /// Whether there is none at some of the points that are looked at first.
    pub(crate) fn are_missing(&self, field: &Field, points: ops::Range<usize>) -> bool {
        let step = if points.len() <= FEW { 1 } else { points.len().div_ceil(SAMPLED) };
        // of each part the first point that can be judged: a grid may lie outside the ranges but for a few
        let end = points.end;
        let parts = points.clone().step_by(step).map(|first| first..end.min(first + step));
        let spread = parts.filter_map(|mut part| part.find(|point| is_judged(field, *point)));
        let without = field.without_determinant(points).into_iter();
        let first: Vec<usize> = spread.chain(without.filter(|point| is_judged(field, *point))).collect();
        let mut slopes = Slopes::new(self);
        first.chunks(LANES).any(|points| {
            slopes.look_at(field, points);
            (0..points.len()).any(|lane| slopes.is_collapsed(lane))
        })
    }
}

fn is_judged(field: &Field, point: usize) -> bool {
    field.is_root(point) && !field.is_outside(point)
}

/// How equations and position change at many roots at once.
struct Slopes<'c> {
    evaluator: LaneEvaluator<'c>,
    ranges: &'c [Range],
    /// Room for a Jacobian and for two directions.
    jacobian: Vec<f64>,
    directions: Vec<f64>,
}

impl<'c> Slopes<'c> {
    fn new(planes: &TangentPlanes<'c>) -> Slopes<'c> {
        // few runs do not pay for machine code
        let evaluator = LaneEvaluator::new(planes.slopes, InstructionSet::widest());
        Slopes { evaluator, ranges: planes.ranges, jacobian: Vec::new(), directions: Vec::new() }
    }

    fn look_at(&mut self, field: &Field, points: &[usize]) {
        for (lane, point) in points.iter().enumerate() {
            field.unknowns(*point).enumerate().for_each(|(k, value)| self.evaluator.input(k)[lane] = value);
        }
        self.evaluator.run_first(points.len());
    }

    /// Whether there is no tangent plane: with T a basis of the directions in which the constraints do not change, ∂r/∂p·T has a rank
    /// below 2.
    fn is_collapsed(&mut self, lane: usize) -> bool {
        let Slopes { evaluator, ranges, jacobian, directions } = self;
        let n = ranges.len();
        jacobian.clear();
        jacobian.extend((0..n * n).map(|k| evaluator.output(k)[lane] * ranges[k % n].width()));
        directions.clear();
        directions.resize(2 * n, 0.0);
        // the last two equations are the coordinates: along each of them the other equations do not change
        (directions[2 * (n - 2)], directions[2 * (n - 1) + 1]) = (1.0, 1.0);
        if !eliminate(jacobian, directions, n) {
            return true;
        }
        let rows = || directions.as_chunks::<2>().0.iter();
        let sum = |of: fn(&[f64; 2]) -> f64| rows().map(of).sum::<f64>();
        let (size, along) = (sum(|[a, _]| a * a).sqrt(), sum(|[a, b]| a * b));
        let along = along / size;
        let apart = rows().map(|[a, b]| (b - along * (a / size)).powi(2)).sum::<f64>().sqrt();
        // what each of two perpendicular units along them moves the point, and the whole of all ranges
        let (mut along_first, mut along_second, mut scale) = ([0.0; 3], [0.0; 3], 0.0);
        for ((k, [a, b]), range) in rows().enumerate().zip(ranges.iter()) {
            let a = a / size;
            let b = (b - along * a) / apart;
            for (i, (first, second)) in along_first.iter_mut().zip(&mut along_second).enumerate() {
                let slope = evaluator.output(n * n + 3 * k + i)[lane] * range.width();
                *first += slope * a;
                *second += slope * b;
                scale += slope * slope;
            }
        }
        let (a, b) = (along_first, along_second);
        let area = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        // what is not a number stays to the other verdicts
        length(area) <= COLLAPSED * scale.sqrt() * length(a).max(length(b))
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

//! Start values: the ranges are scanned, no user supplies a guess.

use std::ops::Range as Span;

use flank_expr::{LANES, LaneEvaluator};

use crate::equations::solution::{Range, Solution, distance};
use crate::equations::system::{Evaluation, Linearized, System};
use crate::newton::scalar::{Descent, worst_residual};

/// Bases of the Halton sequence: one for each unknown.
const PRIMES: [u32; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

/// The k-th point of a sequence that fills the box evenly, the same in every run.
pub(crate) fn probe(ranges: &[Range], k: u32) -> Vec<f64> {
    ranges
        .iter()
        .zip(PRIMES.into_iter().cycle())
        .map(|(range, base)| range.low + range.width() * radical_inverse(k, base))
        .collect()
}

/// The digits of k in a base, mirrored behind the point: van der Corput's sequence.
fn radical_inverse(mut k: u32, base: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0 / f64::from(base));
    while k > 0 {
        value += f64::from(k % base) * digit;
        k /= base;
        digit /= f64::from(base);
    }
    value
}

/// Two iterations that end nearer than this share of the ranges found the same root.
const SAME_ROOT: f64 = 1e-6;

/// How widely a scan looks.
#[derive(Clone, Copy)]
pub(crate) struct Scan {
    /// Points at which the residuals are looked at.
    pub(crate) probes: u32,
    /// The most promising of them, from which Newton starts.
    pub(crate) starts: usize,
}

/// Wide enough to meet every branch of common jobs.
pub(crate) const WIDELY: Scan = Scan { probes: 1024, starts: 64 };

/// Looks for roots anywhere in the box: residuals at `scan.probes` points, Newton from the best `scan.starts` of them.
///
/// All different ends that are looked for, such as roots inside the ranges, in the order in which they were found; if there is none,
/// the most telling failure. Beside them the number of evaluations.
pub(crate) fn scan(
    evaluation: &mut Evaluation<'_>,
    ranges: &[Range],
    scan: Scan,
    is_sought: impl Fn(&Solution) -> bool,
) -> (Vec<Solution>, u64) {
    let mut lanes = Lanes::over(evaluation);
    let mut candidates: Vec<(f64, u32)> = Vec::with_capacity(scan.probes as usize);
    let probes: Vec<u32> = (1..=scan.probes).collect();
    for numbers in probes.chunks(LANES) {
        lanes.compute(numbers.iter().map(|k| probe(ranges, *k)));
        let worst = numbers.iter().enumerate().map(|(lane, k)| (worst_residual(&lanes.at(lane), ranges.len()), *k));
        candidates.extend(worst.filter(|(worst, _)| worst.is_finite()));
    }
    candidates.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    candidates.truncate(scan.starts);
    let mut evaluations = u64::from(scan.probes);
    let mut found: Vec<Solution> = Vec::new();
    let mut failure = Solution::never_reached(ranges);
    for descent in lanes.descend(ranges, candidates.iter().map(|(_, k)| probe(ranges, *k)).collect()) {
        let solution = descent.ended(&mut evaluation.conditions);
        evaluations += u64::from(solution.iterations);
        if !is_sought(&solution) {
            failure = solution.better(failure);
        } else if found.iter().all(|root| distance(&root.unknowns, &solution.unknowns, ranges) > SAME_ROOT) {
            found.push(solution);
        }
    }
    if found.is_empty() {
        found.push(failure);
    }
    (found, evaluations)
}

/// Residuals and Jacobian of a system at many points at once. The bits are those of an [`Evaluation`].
pub(crate) struct Lanes<'s> {
    evaluator: LaneEvaluator<'s>,
    size: usize,
}

/// The same at one of the points.
pub(crate) struct Lane<'l, 's>(&'l Lanes<'s>, usize);

impl<'s> Lanes<'s> {
    pub(crate) fn new(system: &'s System) -> Lanes<'s> {
        Lanes { evaluator: system.in_lanes(), size: system.size() }
    }

    /// With the parameters of an evaluation in all lanes.
    fn over(evaluation: &Evaluation<'s>) -> Lanes<'s> {
        let mut lanes = Lanes::new(evaluation.system());
        for lane in 0..LANES {
            lanes.set_parameters(lane, evaluation.parameters());
        }
        lanes
    }

    pub(crate) fn set_parameters(&mut self, lane: usize, parameters: &[f64]) {
        for (k, parameter) in parameters.iter().enumerate() {
            self.evaluator.input(self.size + k)[lane] = *parameter;
        }
    }

    pub(crate) fn set_unknowns(&mut self, lane: usize, unknowns: &[f64]) {
        for (k, value) in unknowns.iter().enumerate() {
            self.evaluator.input(k)[lane] = *value;
        }
    }

    /// In the first lanes.
    pub(crate) fn run(&mut self, count: usize) {
        self.evaluator.run_first(count);
    }

    /// At the first points, as many as there are lanes at the most.
    fn compute<P: AsRef<[f64]>>(&mut self, points: impl Iterator<Item = P>) {
        let mut count = 0;
        for point in points {
            self.set_unknowns(count, point.as_ref());
            count += 1;
        }
        self.run(count);
    }

    pub(crate) fn at(&self, lane: usize) -> Lane<'_, 's> {
        Lane(self, lane)
    }

    /// Newton from each of the starts, in their order.
    fn descend<'r>(&mut self, ranges: &'r [Range], starts: Vec<Vec<f64>>) -> Vec<Descent<'r>> {
        let mut descents: Vec<Descent<'r>> = starts.iter().map(|start| Descent::new(ranges, start)).collect();
        let mut waiting: Span<usize> = 0..descents.len();
        let mut open: Vec<usize> = waiting.by_ref().take(LANES).collect();
        while !open.is_empty() {
            self.compute(open.iter().filter_map(|number| descents[*number].asks()));
            for (lane, number) in open.iter().enumerate() {
                descents[*number].take(&self.at(lane));
            }
            open.retain(|number| descents[*number].asks().is_some());
            open.extend(waiting.by_ref().take(LANES - open.len()));
        }
        descents
    }
}

impl Linearized for Lane<'_, '_> {
    fn residual(&self, row: usize) -> f64 {
        let Lane(lanes, lane) = self;
        lanes.evaluator.output(row)[*lane]
    }

    fn jacobian(&self, row: usize, column: usize) -> f64 {
        let Lane(lanes, lane) = self;
        lanes.evaluator.output(lanes.size * (1 + row) + column)[*lane]
    }
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;

    use super::*;
    use crate::newton::scalar::solve_with;

    /// More starts than lanes, some of which lead nowhere: a line that misses the circle for one, no start is held up by another.
    #[test]
    fn many_starts_at_once_end_where_each_ends_alone() {
        let graph = Graph::new();
        let [x, y, level] = ["x", "y", "level"].map(|name| graph.variable(name));
        let residuals = [x * x + y * y - 4.0, (3.0 * x).sin() * y.cos() - level];
        let system = System::new(&residuals, &[x, y], &[level]).expect("nothing else is unknown");
        let ranges = [Range { low: -3.0, high: 3.0 }, Range { low: -2.5, high: 3.5 }];
        let starts: Vec<Vec<f64>> = (1..=5 * LANES as u32 + 3).map(|k| probe(&ranges, k)).collect();
        for level in [0.1, 0.9, 7.0] {
            let mut evaluation = system.evaluation(&[level]);
            let together = Lanes::over(&evaluation).descend(&ranges, starts.clone());
            let together: Vec<Solution> =
                together.into_iter().map(|one| one.ended(&mut evaluation.conditions)).collect();
            for (start, together) in starts.iter().zip(together) {
                assert_eq!(together, solve_with(&mut evaluation, &ranges, start), "from {start:?}");
            }
        }
    }
}

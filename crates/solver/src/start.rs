//! Start values: the ranges are scanned, no user supplies a guess.

use crate::newton::solve_with;
use crate::solution::{Range, Solution, distance};
use crate::system::Evaluation;

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
    let mut candidates: Vec<(f64, u32)> = Vec::with_capacity(scan.probes as usize);
    for k in 1..=scan.probes {
        evaluation.at(&probe(ranges, k));
        let worst = evaluation.worst_residual();
        if worst.is_finite() {
            candidates.push((worst, k));
        }
    }
    candidates.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    let mut evaluations = u64::from(scan.probes);
    let mut found: Vec<Solution> = Vec::new();
    let mut failure = Solution::never_reached(ranges);
    for &(_, k) in candidates.iter().take(scan.starts) {
        let solution = solve_with(evaluation, ranges, &probe(ranges, k));
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

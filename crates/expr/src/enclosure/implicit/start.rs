//! Polynomials that come near the solution of equations, as functions of what moves.

use super::unique::{MOST_IN_ALL, inverse, solution};
use super::{REACH, System};
use crate::enclosure::interval::Interval;
use crate::symbolic::graph::{Expr, Graph};
use crate::tape::Tape;
use crate::tape::evaluate::ScalarEvaluator;

/// Degrees in each input that are tried.
const DEGREES: [usize; 14] = [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96];
/// Coefficients of a polynomial, at most.
const MOST_COEFFICIENTS: usize = 300;
/// Steps from a place that holds one solution, at most.
const MOST_STEPS: usize = 20;
/// Places in each input at which a start is looked at, at least, as long as they are not more than so many in all: what moves along a
/// part of the way alone is seen, however low the degree is.
const PLACES: [usize; 2] = [17, 300];
/// A start is good where the second step from it goes a tenth as far as it may.
const GOOD: f64 = 0.1 * REACH;

/// A sum of products of Chebyshev polynomials, one factor for each input.
pub(super) struct Polynomial {
    degree: usize,
    ranges: Vec<Interval>,
    /// Those of the last input next to each other.
    coefficients: Vec<f64>,
}

impl Polynomial {
    /// As an expression of the inputs: Clenshaw's recurrence, input by input.
    pub(super) fn written<'g>(&self, graph: &'g Graph, inputs: &[Expr<'g>]) -> Expr<'g> {
        let scaled: Vec<Expr<'g>> = inputs
            .iter()
            .zip(&self.ranges)
            .map(|(input, range)| (*input - range.middle()) / (0.5 * (range.hi - range.lo)))
            .collect();
        let coefficients: Vec<Expr<'g>> = self.coefficients.iter().map(|number| graph.constant(*number)).collect();
        clenshaw(&coefficients, self.degree, &scaled)
    }
}

fn clenshaw<'g>(coefficients: &[Expr<'g>], degree: usize, scaled: &[Expr<'g>]) -> Expr<'g> {
    let [t, others @ ..] = scaled else { return coefficients[0] };
    let parts: Vec<Expr<'g>> =
        coefficients.chunks(coefficients.len() / (degree + 1)).map(|part| clenshaw(part, degree, others)).collect();
    let zero = t.graph().constant(0.0);
    let (mut first, mut second) = (zero, zero);
    for part in parts[1..].iter().rev() {
        (first, second) = (*part + 2.0 * (*t * first) - second, first);
    }
    parts[0] + *t * first - second
}

/// One for each unknown, of the least degree that is good.
pub(super) fn polynomials(system: &System) -> Option<Vec<Polynomial>> {
    let moving = system.moving();
    let mut newton = Newton::new(system);
    DEGREES
        .into_iter()
        .take_while(|degree| (degree + 1).pow(moving.len() as u32) <= MOST_COEFFICIENTS)
        .take(if moving.is_empty() { 1 } else { DEGREES.len() })
        .find_map(|degree| {
            let fitted = fitted(system, &moving, degree, &mut newton)?;
            is_good(system, &moving, degree, &fitted, &mut newton).then_some(fitted)
        })
}

/// Through the solutions at the zeros of the next Chebyshev polynomial.
fn fitted(system: &System, moving: &[usize], degree: usize, newton: &mut Newton<'_>) -> Option<Vec<Polynomial>> {
    let count = degree + 1;
    let angle = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / count as f64;
    let ranges: Vec<Interval> = moving.iter().map(|k| system.others[*k]).collect();
    let nodes = lattice(moving.len(), count, &|k| angle(k).cos(), &ranges);
    let solutions: Option<Vec<Vec<f64>>> = nodes
        .iter()
        .map(|node| {
            let others = system.others_at(moving, node);
            let start = solution(system, &others, &mut { MOST_IN_ALL }).ok()?;
            newton.settled(start, &others)
        })
        .collect();
    let solutions = solutions?;
    let polynomial = |unknown: usize| {
        let mut values: Vec<f64> = solutions.iter().map(|solution| solution[unknown]).collect();
        for axis in 0..moving.len() {
            let stride = count.pow((moving.len() - 1 - axis) as u32);
            let before = values.clone();
            for (place, value) in values.iter_mut().enumerate() {
                let order = place / stride % count;
                let first = place - order * stride;
                let term = |k: usize| before[first + k * stride] * (order as f64 * angle(k)).cos();
                *value = (0..count).map(term).sum::<f64>() * if order == 0 { 1.0 } else { 2.0 } / count as f64;
            }
        }
        Polynomial { degree, ranges: ranges.clone(), coefficients: values }
    };
    Some((0..system.unknowns.len()).map(polynomial).collect())
}

/// Whether two steps settle, at twice as many places as there are coefficients, ends of the ranges among them. The others lie at no even
/// distances: what comes again and again over the range would be the same at all of them.
fn is_good(system: &System, moving: &[usize], degree: usize, starts: &[Polynomial], newton: &mut Newton<'_>) -> bool {
    let ranges: Vec<Interval> = moving.iter().map(|k| system.others[*k]).collect();
    let suffices = |count: &usize| count.pow(moving.len() as u32) <= PLACES[1];
    let least = (2..=PLACES[0]).rev().find(suffices).unwrap_or(2);
    let places = lattice(moving.len(), least.max(2 * degree + 3), &uneven, &ranges);
    let graph = Graph::new();
    let inputs: Vec<Expr<'_>> = moving.iter().map(|_| graph.variable("")).collect();
    let starts: Vec<Expr<'_>> = starts.iter().map(|start| start.written(&graph, &inputs)).collect();
    let starts = Tape::new(&starts, &inputs).expect("polynomials of the inputs");
    let mut starts = ScalarEvaluator::new(&starts);
    let mut start = vec![0.0; system.unknowns.len()];
    places.iter().all(|place| {
        starts.run(place, &mut start);
        let start = start.iter().zip(&system.unknowns).map(|(start, range)| start.clamp(range.lo, range.hi)).collect();
        let (_, last) = newton.from(start, &system.others_at(moving, place), 2);
        last.iter().zip(&system.unknowns).all(|(step, range)| step.abs() <= GOOD * (range.hi - range.lo))
    })
}

/// Both ends of -1 to 1, and then numbers that fill it evenly, none at a distance from another that is a simple part of the whole: multiples of
/// the golden ratio.
fn uneven(k: usize) -> f64 {
    match k {
        0 => -1.0,
        1 => 1.0,
        _ => 2.0 * (k as f64 * std::f64::consts::GOLDEN_RATIO).fract() - 1.0,
    }
}

/// All combinations of `count` values in each of the ranges, the last range changing first.
fn lattice(inputs: usize, count: usize, at: &dyn Fn(usize) -> f64, ranges: &[Interval]) -> Vec<Vec<f64>> {
    let scaled = |range: Interval, t: f64| range.middle() + 0.5 * (range.hi - range.lo) * t;
    (0..count.pow(inputs as u32))
        .map(|place| {
            let digit = |axis: usize| place / count.pow((inputs - 1 - axis) as u32) % count;
            ranges.iter().enumerate().map(|(axis, range)| scaled(*range, at(digit(axis)))).collect()
        })
        .collect()
}

impl System {
    /// The other inputs, those that move with these values.
    fn others_at(&self, moving: &[usize], values: &[f64]) -> Vec<f64> {
        let mut others: Vec<f64> = self.others.iter().map(|range| range.lo).collect();
        moving.iter().zip(values).for_each(|(place, value)| others[*place] = *value);
        others
    }
}

/// The solution near a place that is known to hold it alone, to rounding; `None` if Newton's method does not settle.
pub(super) fn settled(system: &System, start: Vec<f64>, others: &[f64]) -> Option<Vec<f64>> {
    Newton::new(system).settled(start, others)
}

/// Newton's method in numbers, within the ranges.
struct Newton<'s> {
    system: &'s System,
    values: ScalarEvaluator<'s>,
    slopes: ScalarEvaluator<'s>,
}

impl<'s> Newton<'s> {
    fn new(system: &'s System) -> Newton<'s> {
        Newton { system, values: ScalarEvaluator::new(&system.values), slopes: ScalarEvaluator::new(&system.slopes) }
    }

    /// As [`settled`].
    fn settled(&mut self, start: Vec<f64>, others: &[f64]) -> Option<Vec<f64>> {
        let mut at = start;
        for _ in 0..MOST_STEPS {
            let (next, last) = self.from(at, others, 1);
            let is_near = |(step, range): (&f64, &Interval)| step.abs() <= REACH * (range.hi - range.lo);
            if last.iter().zip(&self.system.unknowns).all(is_near) {
                // what is left is some ten times the square of the last step
                return Some(self.from(next, others, 1).0);
            }
            at = next;
        }
        None
    }

    /// Where so many steps lead, and the last of them; NaN where there is none.
    fn from(&mut self, start: Vec<f64>, others: &[f64], steps: usize) -> (Vec<f64>, Vec<f64>) {
        let size = start.len();
        let (mut at, mut last) = (start, vec![f64::NAN; size]);
        for _ in 0..steps {
            let inputs: Vec<f64> = at.iter().chain(others).copied().collect();
            let (mut values, mut slopes) = (vec![0.0; size], vec![0.0; size * size]);
            self.values.run(&inputs, &mut values);
            self.slopes.run(&inputs, &mut slopes);
            let Some(inverse) = inverse(&slopes, size) else { return (at, vec![f64::NAN; size]) };
            for row in 0..size {
                last[row] = (0..size).map(|column| inverse[row * size + column] * values[column]).sum();
                let range = self.system.unknowns[row];
                at[row] = (at[row] - last[row]).clamp(range.lo, range.hi);
            }
        }
        (at, last)
    }
}

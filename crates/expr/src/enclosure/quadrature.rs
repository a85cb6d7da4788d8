//! Integrals by Gauss–Legendre quadrature, written out, with a proven bound on what it leaves.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use super::interval::{Interval, IntervalEvaluator};
use super::taylor::TaylorEvaluator;
use crate::symbolic::graph::Expr;
use crate::symbolic::integral;
use crate::tape::Tape;

/// Nodes of a piece, at most.
const MOST_NODES: usize = 16;
/// Coefficients of the integrand's power series that are bounded.
const TERMS: usize = 2 * MOST_NODES + 1;
/// Pieces of the range, at most.
const MOST_PIECES: u32 = 64;
/// Parts of the range in which the integrand is bounded: at first, and at most.
const FEWEST_PARTS: u32 = 16;
const MOST_PARTS: u32 = 256;
/// What may be left, over the length of the range times the greatest magnitude of the integrand: a few roundings.
const ALLOWED: f64 = 4.0 * f64::EPSILON;

/// How far the numbers of a rule may be off, its places over the length of the range and its weights together over their sum.
const ROUNDED: f64 = 16.0 * f64::EPSILON;

/// An end of an integral.
#[derive(Clone, Copy, Debug)]
pub struct End<'g> {
    /// What it is.
    pub expr: Expr<'g>,
    /// Where it lies.
    pub range: Interval,
}

/// Why an integral cannot be written out.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unproven {
    /// An end may lie anywhere.
    #[error("an end of the range may lie anywhere")]
    Endless,
    /// The integrand has a pole or a kink, is not defined, or cannot be bounded, near a value of the variable.
    #[error("the integrand cannot be bounded near {0}")]
    Unbounded(f64),
    /// So many nodes are not enough.
    #[error("{MOST_NODES} nodes in each of {MOST_PIECES} pieces are not enough")]
    TooLong,
}

impl Unproven {
    /// Parts after which it stays so. The bounds are sharp early, while a pole or a kink is looked for more closely.
    fn most_parts(self) -> u32 {
        if self == Unproven::TooLong { MOST_PARTS / 4 } else { MOST_PARTS }
    }
}

/// The integral of an integrand over a variable, by a sum over the nodes of Gauss–Legendre quadrature. Over intervals it is enclosed, with
/// what the sum leaves.
///
/// With `n` nodes on each of `p` pieces of a range of length L, `κ L²ⁿ⁺¹ p⁻²ⁿ M` bounds what is left, M being a bound on the
/// integrand's Taylor coefficient of order 2n over the range, and κ = n!⁴ / ((2n + 1) (2n)!²). The fewest nodes are taken for which
/// this is proven to be at most 1e-15 L max |integrand| for all values in the given ranges. Where the integrand stands still but for
/// the variable, and so does the lower end, the middle of the upper end's range splits the integral: the part up to it is a constant.
///
/// By a variable that moves the ends alone, its derivative is the integrand there: no sum. By one that moves the integrand, it is the
/// derivative of the sum.
///
/// `ranges` has the variables that the integrand depends on beside its own; those that stand still as points.
///
/// # Errors
/// If no bound is proven.
///
/// # Panics
/// If the integrand depends on a variable that is not in `ranges`, or `variable` is none.
pub fn integral<'g>(
    integrand: Expr<'g>,
    variable: Expr<'g>,
    [from, to]: [End<'g>; 2],
    ranges: &[(Expr<'g>, Interval)],
) -> Result<Expr<'g>, Unproven> {
    if ![from, to]
        .iter()
        .all(|end| end.range.lo.is_finite() && end.range.hi.is_finite() && end.range.lo <= end.range.hi)
    {
        return Err(Unproven::Endless);
    }
    let mut inputs: Vec<Expr<'g>> = ranges.iter().map(|range| range.0).collect();
    inputs.push(variable);
    let ranges = ranges.iter().map(|range| range.1).collect();
    let tape = Tape::new(&[integrand], &inputs).expect("every variable of the integrand has a range");
    // where a kink lies is seen in the slope, and where two pieces of a curve meet, in the third derivative
    let slopes: [Expr<'g>; 3] = std::array::from_fn(|k| (0..=k).fold(integrand, |f, _| f.derivative(variable)));
    let slopes = Tape::new(&slopes, &inputs).expect("every variable of the integrand has a range");
    let integrand = Integrand { expr: integrand, variable, tape, slopes, ranges };
    let stands = integrand.ranges.iter().chain([&from.range]).all(|range| is_point(*range));
    let value = if !stands || is_point(to.range) {
        integrand.between(from, to)?
    } else {
        let middle = to.range.middle();
        let middle = End { expr: variable.graph().constant(middle), range: Interval::point(middle) };
        let (first, second) = (integrand.between(from, middle)?, integrand.between(middle, to)?);
        (first.0 + second.0, first.1 + second.1)
    };
    Ok(integral::integral(integrand.expr, variable, [from.expr, to.expr], value))
}

/// Narrow enough to be one number that was rounded.
fn is_point(range: Interval) -> bool {
    range.width() <= 64.0 * f64::EPSILON * range.magnitude()
}

/// Rules that were found lately. Texts are compiled again and again, with each keystroke of an editor, say, and most of what an integral takes
/// is its bound.
static KNOWN: Mutex<VecDeque<Known>> = Mutex::new(VecDeque::new());
/// So many of them.
const MOST_KNOWN: usize = 64;

/// A rule, and all that it follows from.
struct Known {
    tapes: [Tape; 2],
    ranges: Vec<Interval>,
    /// The ends of the range, and its length.
    place: [f64; 3],
    found: Result<Rule, Unproven>,
}

impl Known {
    fn is_of(&self, integrand: &Integrand<'_>, place: [f64; 3]) -> bool {
        let bits = |of: [f64; 3]| of.map(f64::to_bits);
        let ends = |range: &Interval| (range.lo.to_bits(), range.hi.to_bits(), range.continuous);
        let are_ranges = self.ranges.iter().map(ends).eq(integrand.ranges.iter().map(ends));
        bits(self.place) == bits(place)
            && are_ranges
            && self.tapes[0].is_same(&integrand.tape)
            && self.tapes[1].is_same(&integrand.slopes)
    }
}

struct Integrand<'g> {
    expr: Expr<'g>,
    variable: Expr<'g>,
    tape: Tape,
    /// Its first three derivatives by the variable.
    slopes: Tape,
    ranges: Vec<Interval>,
}

impl<'g> Integrand<'g> {
    /// The sum over the nodes, and how far it is off at the most.
    fn between(&self, from: End<'g>, to: End<'g>) -> Result<(Expr<'g>, f64), Unproven> {
        let (low, high) = (from.range.lo.min(to.range.lo), from.range.hi.max(to.range.hi));
        let length = (to.range - from.range).magnitude();
        if low == high || from.expr == to.expr {
            return Ok((self.variable.graph().constant(0.0), 0.0));
        }
        let Rule { nodes, pieces, left } = self.known_rule([low, high, length])?;
        Ok((self.written_out(from.expr, to.expr, nodes, pieces), length * left))
    }

    /// The rule for a range between two ends, of a length.
    fn known_rule(&self, place: [f64; 3]) -> Result<Rule, Unproven> {
        // whoever panics while others wait has changed nothing by halves
        let known = || KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = known().iter().find(|known| known.is_of(self, place)) {
            return known.found;
        }
        let found = self.rule(place);
        let (tapes, ranges) = ([self.tape.clone(), self.slopes.clone()], self.ranges.clone());
        let mut known = known();
        known.push_front(Known { tapes, ranges, place, found });
        known.truncate(MOST_KNOWN);
        found
    }

    fn rule(&self, [low, high, length]: [f64; 3]) -> Result<Rule, Unproven> {
        let mut parts = FEWEST_PARTS;
        loop {
            let found = self.bounds(low, high, parts).and_then(|bounds| bounds.fewest(length).ok_or(Unproven::TooLong));
            match found {
                Err(reason) if parts < reason.most_parts() => parts *= 4,
                found => return found,
            }
        }
    }

    /// Bounds on the integrand's even Taylor coefficients over a range, from those over its parts.
    fn bounds(&self, low: f64, high: f64, parts: u32) -> Result<Bounds, Unproven> {
        let mut series = TaylorEvaluator::new(&self.tape, TERMS - 1);
        let (mut values, mut slopes) = (IntervalEvaluator::new(&self.tape), IntervalEvaluator::new(&self.slopes));
        let mut inputs = vec![Interval::point(0.0); TERMS * (self.ranges.len() + 1)];
        let mut at = self.ranges.clone();
        at.push(Interval::WHOLE);
        for (k, range) in self.ranges.iter().enumerate() {
            inputs[TERMS * k] = *range;
        }
        let own = TERMS * self.ranges.len();
        inputs[own + 1] = Interval::point(1.0);
        let (mut out, mut at_middle) = (vec![Interval::WHOLE; TERMS], vec![Interval::WHOLE; TERMS]);
        let mut bounds = Bounds { value: 0.0, slope: 0.0, even: [0.0; MOST_NODES] };
        let end = |k: u32| low + (high - low) * (f64::from(k) / f64::from(parts));
        for k in 0..parts {
            let last = if k + 1 == parts { high } else { end(k + 1) };
            let part = Interval::new(end(k), last);
            at[self.ranges.len()] = part;
            let (mut value, mut slope) = ([Interval::WHOLE], [Interval::WHOLE; 3]);
            values.run(&at, &mut value);
            slopes.run(&at, &mut slope);
            inputs[own] = part;
            series.run(&inputs, &mut out);
            let middle = part.middle();
            inputs[own] = Interval::point(middle);
            series.run(&inputs, &mut at_middle);
            let is_smooth = value.iter().chain(&slope).all(|found| found.continuous)
                && out.iter().all(|term| term.magnitude().is_finite());
            if !is_smooth {
                return Err(Unproven::Unbounded(middle));
            }
            bounds.value = bounds.value.max(value[0].magnitude());
            bounds.slope = bounds.slope.max(slope[0].magnitude());
            let reach = (middle - part.lo).max(part.hi - middle);
            for (n, bound) in bounds.even.iter_mut().enumerate() {
                *bound = bound.max(over_part(2 * (n + 1), &at_middle, reach, out[TERMS - 1]));
            }
        }
        Ok(bounds)
    }

    /// The sum over the nodes of all pieces.
    fn written_out(&self, from: Expr<'g>, to: Expr<'g>, nodes: usize, pieces: u32) -> Expr<'g> {
        let graph = self.variable.graph();
        let rule = legendre(nodes);
        let whole = to - from;
        let mut sum = graph.constant(0.0);
        for piece in 0..pieces {
            for &(place, weight) in &rule {
                let share = (f64::from(piece) + 0.5 + 0.5 * place) / f64::from(pieces);
                let at = from + graph.constant(share) * whole;
                let value = graph.substitute(&[self.expr], &[(self.variable, at)])[0];
                sum = sum + graph.constant(0.5 * weight / f64::from(pieces)) * value;
            }
        }
        whole * sum
    }
}

/// A bound on the coefficient of an order over a part, from the series at its middle and the coefficient of the last order over it: far
/// less than what the recurrence says of the whole part.
fn over_part(order: usize, at_middle: &[Interval], reach: f64, last: Interval) -> f64 {
    let (mut power, mut sum) = (1.0, 0.0);
    let coefficients = at_middle[..TERMS - 1].iter().chain([&last]);
    for (k, coefficient) in coefficients.enumerate().skip(order) {
        sum += power * coefficient.magnitude();
        power *= reach * (k + 1) as f64 / (k + 1 - order) as f64;
    }
    sum
}

/// How an integral is written out.
#[derive(Clone, Copy, Debug)]
struct Rule {
    /// Of each piece.
    nodes: usize,
    pieces: u32,
    /// What it leaves at the most, over the length of the range.
    left: f64,
}

/// Bounds on the magnitude of an integrand, of its slope, and of its Taylor coefficients of order 2, 4, ….
struct Bounds {
    value: f64,
    slope: f64,
    even: [f64; MOST_NODES],
}

impl Bounds {
    /// The numbers of nodes and of pieces with the fewest nodes in all for which the bound is small enough.
    fn fewest(&self, length: f64) -> Option<Rule> {
        let mut best: Option<Rule> = None;
        let mut pieces = 1;
        while pieces <= MOST_PIECES {
            // n!⁴ / (2n)!² grows by the factor (n / (2 (2n − 1)))² · … from n − 1 to n
            let mut ratio = 1.0;
            for n in 1..=MOST_NODES {
                let count = n as f64;
                ratio *= (count / (2.0 * (2.0 * count - 1.0))).powi(2);
                let left =
                    ratio / (2.0 * count + 1.0) * (length / f64::from(pieces)).powi(2 * n as i32) * self.even[n - 1];
                // the bound itself is rounded a few times
                let left = left * 1.001;
                if left <= ALLOWED * self.value {
                    let is_fewer = best.is_none_or(|best| n as u32 * pieces < best.nodes as u32 * best.pieces);
                    if is_fewer {
                        let rounded = ROUNDED * (self.value + length * self.slope);
                        best = Some(Rule { nodes: n, pieces, left: left + rounded });
                    }
                    break;
                }
            }
            pieces *= 2;
        }
        best
    }
}

/// Nodes in −1 … 1 and weights of Gauss–Legendre quadrature: roots of the Legendre polynomial by Newton's method.
fn legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let rule = (0..count).map(|k| {
        let mut x = -(std::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut last, mut value) = (1.0, x);
            for j in 2..=count {
                let j = j as f64;
                (last, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * last) / j);
            }
            if count == 1 {
                (last, value) = (1.0, x);
            }
            slope = n * (x * value - last) / (x * x - 1.0);
            x -= value / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    });
    rule.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With n nodes, powers up to x²ⁿ⁻¹ are integrated exactly.
    #[test]
    fn powers_are_integrated_to_rounding() {
        for count in 1..=MOST_NODES {
            let rule = legendre(count);
            for power in 0..2 * count as i32 {
                let sum: f64 = rule.iter().map(|(x, weight)| weight * x.powi(power)).sum();
                let exact = if power % 2 == 0 { 2.0 / f64::from(power + 1) } else { 0.0 };
                assert!((sum - exact).abs() < 4e-15, "{count} nodes, power {power}: {sum}, not {exact}");
            }
        }
    }
}

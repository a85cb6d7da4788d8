//! Integrals by Gauss–Legendre quadrature, written out, with a proven bound on what it leaves.

use super::interval::{Interval, IntervalEvaluator};
use super::taylor::TaylorEvaluator;
use crate::symbolic::graph::Expr;
use crate::tape::Tape;

/// Nodes of a piece, at most.
const MOST_NODES: usize = 16;
/// Pieces of the range, at most.
const MOST_PIECES: u32 = 64;
/// Parts of the range in which the integrand is bounded: at first, and at most.
const FEWEST_PARTS: u32 = 16;
const MOST_PARTS: u32 = 4096;
/// What may be left, over the length of the range times the greatest magnitude of the integrand: a few roundings.
const ALLOWED: f64 = 4.0 * f64::EPSILON;

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

/// The integral of an integrand over a variable as a sum over the nodes of Gauss–Legendre quadrature, which differentiates, encloses and
/// runs like any other sum.
///
/// With `n` nodes on each of `p` pieces of a range of length L, `κ L²ⁿ⁺¹ p⁻²ⁿ M` bounds what is left, M being a bound on the
/// integrand's Taylor coefficient of order 2n over the range, and κ = n!⁴ / ((2n + 1) (2n)!²). The fewest nodes are taken for which
/// this is proven to be at most 1e-15 L max |integrand| for all values in the given ranges. Where the integrand stands still but for
/// the variable, and so does the lower end, the middle of the upper end's range splits the integral: the part up to it is a constant.
///
/// By a variable that moves the ends alone, its derivative is the integrand there: no sum.
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
    if !stands || is_point(to.range) {
        return integrand.between(from, to);
    }
    let middle = to.range.middle();
    let middle = End { expr: variable.graph().constant(middle), range: Interval::point(middle) };
    Ok(integrand.between(from, middle)? + integrand.between(middle, to)?)
}

/// Narrow enough to be one number that was rounded.
fn is_point(range: Interval) -> bool {
    range.width() <= 64.0 * f64::EPSILON * range.magnitude()
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
    fn between(&self, from: End<'g>, to: End<'g>) -> Result<Expr<'g>, Unproven> {
        let (low, high) = (from.range.lo.min(to.range.lo), from.range.hi.max(to.range.hi));
        let length = (to.range - from.range).magnitude();
        if low == high || from.expr == to.expr {
            return Ok(self.variable.graph().constant(0.0));
        }
        let mut parts = FEWEST_PARTS;
        loop {
            let found = self.bounds(low, high, parts).and_then(|bounds| bounds.fewest(length).ok_or(Unproven::TooLong));
            match found {
                Ok((nodes, pieces)) => return Ok(self.written_out(from.expr, to.expr, nodes, pieces)),
                Err(reason) if parts >= MOST_PARTS => return Err(reason),
                Err(_) => parts *= 4,
            }
        }
    }

    /// Bounds on the integrand's even Taylor coefficients over a range, from those over its parts.
    fn bounds(&self, low: f64, high: f64, parts: u32) -> Result<Bounds, Unproven> {
        const TERMS: usize = 2 * MOST_NODES + 1;
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
        let mut out = vec![Interval::WHOLE; TERMS];
        let mut bounds = Bounds { value: 0.0, even: [0.0; MOST_NODES] };
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
            let is_smooth = value.iter().chain(&slope).all(|found| found.continuous)
                && out.iter().all(|term| term.magnitude().is_finite());
            if !is_smooth {
                return Err(Unproven::Unbounded(part.middle()));
            }
            bounds.value = bounds.value.max(value[0].magnitude());
            for (n, bound) in bounds.even.iter_mut().enumerate() {
                *bound = bound.max(out[2 * (n + 1)].magnitude());
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
        let integral = whole * sum;
        self.remember_slopes(integral, from, to);
        integral
    }

    /// By what moves the ends alone, an integral changes as its integrand there says: no sum over nodes.
    fn remember_slopes(&self, integral: Expr<'g>, from: Expr<'g>, to: Expr<'g>) {
        let graph = self.variable.graph();
        let [at_from, at_to] = [from, to].map(|end| graph.substitute(&[self.expr], &[(self.variable, end)])[0]);
        let fixed = graph.variables_of(&[self.expr]);
        for variable in graph.variables_of(&[from, to]).into_iter().filter(|variable| !fixed.contains(variable)) {
            let by = graph.expr_of(variable);
            let slope = at_to * to.derivative(by) - at_from * from.derivative(by);
            graph.remember_derivative(variable, integral.id, slope.id);
        }
    }
}

/// Bounds on the magnitude of an integrand and of its Taylor coefficients of order 2, 4, ….
struct Bounds {
    value: f64,
    even: [f64; MOST_NODES],
}

impl Bounds {
    /// The numbers of nodes and of pieces with the fewest nodes in all for which the bound is small enough.
    fn fewest(&self, length: f64) -> Option<(usize, u32)> {
        let mut best: Option<(usize, u32)> = None;
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
                if left * 1.001 <= ALLOWED * self.value {
                    let is_fewer = best.is_none_or(|(nodes, others)| n as u32 * pieces < nodes as u32 * others);
                    if is_fewer {
                        best = Some((n, pieces));
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

//! Smooth curves through tabulated points.

use thiserror::Error;

/// A cubic spline through points: twice continuously differentiable, three times within each interval.
///
/// The first two and the last two intervals share one cubic each ("not a knot"), so that a table of a cubic is met exactly
/// and a table of a smooth function to fourth order up to its ends. Two points give a line, three a parabola.
///
/// ```
/// let curve = flank_expr::Curve::through("y", &[(0.0, 0.0), (1.0, 1.0), (2.0, 8.0), (4.0, 64.0)]).expect("increasing");
/// assert!((curve.value(0, 3.0) - 27.0).abs() < 1e-12);
/// assert!((curve.value(1, 3.0) - 27.0).abs() < 1e-12);
/// assert!(curve.value(0, 5.0).is_nan());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    name: String,
    knots: Vec<f64>,
    /// Coefficients of each interval's cubic in the distance from its left knot, constant first.
    pieces: Vec<[f64; 4]>,
}

/// Why points make no curve.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum CurveError {
    /// One point is not a curve.
    #[error("a curve needs at least two points")]
    TooFew,
    /// The abscissae of points `0` and the one before it.
    #[error("x does not increase at point {0}")]
    NotIncreasing(usize),
    /// A coordinate of this point is NaN or infinite.
    #[error("point {0} is not finite")]
    NotFinite(usize),
}

/// Beyond its ends by more than this share of its width a curve has no value: rounding of the ends themselves.
const MARGIN: f64 = 1e-9;

impl Curve {
    /// The curve through `points`, pairs of x and y with x increasing; the name is for printing.
    ///
    /// # Errors
    /// If there are fewer than two points, or one is not finite, or x does not increase.
    pub fn through(name: impl Into<String>, points: &[(f64, f64)]) -> Result<Curve, CurveError> {
        if points.len() < 2 {
            return Err(CurveError::TooFew);
        }
        if let Some(index) = points.iter().position(|(x, y)| !(x.is_finite() && y.is_finite())) {
            return Err(CurveError::NotFinite(index));
        }
        if let Some(index) = points.windows(2).position(|pair| pair[1].0 <= pair[0].0) {
            return Err(CurveError::NotIncreasing(index + 1));
        }
        let bends = second_derivatives(points);
        let piece = |i: usize| {
            let ((x0, y0), (x1, y1)) = (points[i], points[i + 1]);
            let (h, m0, m1) = (x1 - x0, bends[i], bends[i + 1]);
            [y0, (y1 - y0) / h - h * (2.0 * m0 + m1) / 6.0, m0 / 2.0, (m1 - m0) / (6.0 * h)]
        };
        let pieces = (0..points.len() - 1).map(piece).collect();
        Ok(Curve { name: name.into(), knots: points.iter().map(|(x, _)| *x).collect(), pieces })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// First and last x.
    pub fn ends(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }

    /// The derivative of an order (0 for the value itself) at x; NaN beyond the ends.
    ///
    /// At a knot the third derivative is that of the interval to the right.
    pub fn value(&self, order: u8, x: f64) -> f64 {
        let (low, high) = self.domain();
        if x.is_nan() || x < low || x > high {
            return f64::NAN;
        }
        let (knot, [a, b, c, d]) = self.piece(self.piece_at(x));
        let t = x - knot;
        match order {
            0 => a + t * (b + t * (c + t * d)),
            1 => b + t * (2.0 * c + t * 3.0 * d),
            2 => 2.0 * c + t * 6.0 * d,
            3 => 6.0 * d,
            _ => 0.0,
        }
    }
}

/// Pieces, for whoever evaluates it.
impl Curve {
    /// Where it has a value: its ends with the margin for their rounding.
    pub(crate) fn domain(&self) -> (f64, f64) {
        let (low, high) = self.ends();
        let margin = MARGIN * (high - low);
        (low - margin, high + margin)
    }

    /// The piece that has the value at x: at a knot the one to the right.
    pub(crate) fn piece_at(&self, x: f64) -> usize {
        self.knots.partition_point(|knot| *knot <= x).clamp(1, self.pieces.len()) - 1
    }

    pub(crate) fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Left knot of a piece, and the coefficients of its cubic in the distance from there, constant first.
    pub(crate) fn piece(&self, index: usize) -> (f64, [f64; 4]) {
        (self.knots[index], self.pieces[index])
    }
}

/// Second derivatives at the knots, from the tridiagonal equations of a C² cubic spline with not-a-knot ends.
fn second_derivatives(points: &[(f64, f64)]) -> Vec<f64> {
    let n = points.len();
    let h: Vec<f64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let slope: Vec<f64> = points.windows(2).zip(&h).map(|(pair, h)| (pair[1].1 - pair[0].1) / h).collect();
    match n {
        2 => return vec![0.0; 2],
        3 => return vec![2.0 * (slope[1] - slope[0]) / (h[0] + h[1]); 3],
        _ => {}
    }
    // rows 1 … n−2: lower·m[i−1] + diagonal·m[i] + upper·m[i+1] = right; the ends' m are expressed by their neighbours
    let inner = n - 2;
    let mut diagonal: Vec<f64> = (0..inner).map(|k| 2.0 * (h[k] + h[k + 1])).collect();
    let mut lower: Vec<f64> = (0..inner).map(|k| h[k]).collect();
    let mut upper: Vec<f64> = (0..inner).map(|k| h[k + 1]).collect();
    let mut right: Vec<f64> = (0..inner).map(|k| 6.0 * (slope[k + 1] - slope[k])).collect();
    let (first, last) = (h[0] / h[1], h[n - 2] / h[n - 3]);
    diagonal[0] += h[0] * (1.0 + first);
    upper[0] -= h[0] * first;
    diagonal[inner - 1] += h[n - 2] * (1.0 + last);
    lower[inner - 1] -= h[n - 2] * last;
    // Thomas' elimination
    for k in 1..inner {
        let factor = lower[k] / diagonal[k - 1];
        diagonal[k] -= factor * upper[k - 1];
        right[k] -= factor * right[k - 1];
    }
    let mut m = vec![0.0; n];
    for k in (0..inner).rev() {
        let beyond = if k + 1 < inner { upper[k] * m[k + 2] } else { 0.0 };
        m[k + 1] = (right[k] - beyond) / diagonal[k];
    }
    m[0] = m[1] - first * (m[2] - m[1]);
    m[n - 1] = m[n - 2] + last * (m[n - 2] - m[n - 3]);
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(count: usize, f: impl Fn(f64) -> f64) -> Curve {
        // uneven abscissae
        let x = |k: usize| (k as f64 / (count - 1) as f64).powf(1.2) * 2.0 - 0.5;
        let points: Vec<(f64, f64)> = (0..count).map(|k| (x(k), f(x(k)))).collect();
        Curve::through("f", &points).expect("increasing")
    }

    #[test]
    fn polynomials_up_to_the_third_degree_are_met_exactly() {
        for count in [4, 5, 9] {
            let curve = sampled(count, |x| 1.0 - 2.0 * x + 3.0 * x * x - 4.0 * x.powi(3));
            for k in 0..50 {
                let x = -0.5 + 2.0 * f64::from(k) / 49.0;
                let exact = [
                    1.0 - 2.0 * x + 3.0 * x * x - 4.0 * x.powi(3),
                    -2.0 + 6.0 * x - 12.0 * x * x,
                    6.0 - 24.0 * x,
                    -24.0,
                ];
                for (order, exact) in (0u8..).zip(exact) {
                    assert!((curve.value(order, x) - exact).abs() < 1e-11, "order {order} at {x}");
                }
            }
        }
        assert!((sampled(3, |x| x * x).value(0, 1.1) - 1.21).abs() < 1e-14);
        assert!((sampled(2, |x| 3.0 * x).value(1, 1.1) - 3.0).abs() < 1e-14);
    }

    #[test]
    fn value_slope_and_bend_are_continuous_at_the_knots() {
        let curve = sampled(12, f64::sin);
        for &knot in &curve.knots[1..11] {
            for order in 0..=2 {
                let jump = curve.value(order, knot.next_down()) - curve.value(order, knot);
                assert!(jump.abs() < 1e-12, "order {order} at {knot}: {jump:e}");
            }
        }
    }

    #[test]
    fn a_smooth_function_is_met_to_fourth_order() {
        let worst = |count: usize| {
            let curve = sampled(count, f64::exp);
            (0..400)
                .map(|k| -0.5 + 2.0 * f64::from(k) / 399.0)
                .map(|x| (curve.value(0, x) - x.exp()).abs())
                .fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(20), worst(40));
        assert!(fine < coarse / 10.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn wrong_tables_are_refused() {
        let through = |points: &[(f64, f64)]| Curve::through("f", points).map(|_| ());
        assert_eq!(through(&[(0.0, 0.0)]), Err(CurveError::TooFew));
        assert_eq!(through(&[(0.0, 0.0), (1.0, 1.0), (1.0, 2.0)]), Err(CurveError::NotIncreasing(2)));
        assert_eq!(through(&[(0.0, 0.0), (1.0, f64::NAN)]), Err(CurveError::NotFinite(1)));
    }
}

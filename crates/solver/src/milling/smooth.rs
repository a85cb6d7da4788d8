//! Positions of a surface with their derivatives, and bounds of these everywhere: what a proof over boxes needs.

use crate::milling::series::{PoseField, PoseSeries};

/// Positions over two shares as sums of Chebyshev's polynomials.
#[derive(Clone, Debug)]
pub(crate) struct SmoothField {
    counts: [usize; 2],
    coefficients: Vec<[f64; 3]>,
    pub(crate) bounds: FieldBounds,
}

/// What derivatives of the position by the shares are no longer than, mm.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FieldBounds {
    pub(crate) slopes: [f64; 2],
    /// By the first share twice, by the second twice.
    pub(crate) bends: [f64; 2],
    pub(crate) mixed: f64,
}

/// What first and second derivatives of a motion by its share are no longer than: mm of the position, and of the unit vector of the axis.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MotionBounds {
    pub(crate) tip: [f64; 2],
    pub(crate) axis: [f64; 2],
}

/// The largest first and second derivative of a Chebyshev polynomial by a share: Markov's bounds, on an interval of half the length.
fn steepest(degree: usize) -> [f64; 2] {
    let square = (degree * degree) as f64;
    [2.0 * square, 4.0 * square * (square - 1.0).max(0.0) / 3.0]
}

fn length(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Chebyshev's polynomials and their derivatives by the share.
fn basis(count: usize, share: f64) -> Vec<[f64; 2]> {
    let x = 2.0 * share - 1.0;
    let mut out = vec![[1.0, 0.0], [x, 2.0]];
    for k in 2..count {
        let ([a, da], [b, db]) = (out[k - 2], out[k - 1]);
        out.push([2.0 * x * b - a, 4.0 * b + 2.0 * x * db - da]);
    }
    out
}

impl SmoothField {
    pub(crate) fn new(field: &PoseField) -> SmoothField {
        let (counts, coefficients) = field.position_coefficients();
        let mut bounds = FieldBounds::default();
        for (k, coefficient) in coefficients.iter().enumerate() {
            let size = length(coefficient);
            let [[by_first, by_first_twice], [by_second, by_second_twice]] =
                [k / counts[1], k % counts[1]].map(steepest);
            bounds.slopes[0] += by_first * size;
            bounds.slopes[1] += by_second * size;
            bounds.bends[0] += by_first_twice * size;
            bounds.bends[1] += by_second_twice * size;
            bounds.mixed += by_first * by_second * size;
        }
        SmoothField { counts, coefficients, bounds }
    }

    /// The position and its derivatives by both shares.
    pub(crate) fn at(&self, shares: [f64; 2]) -> [[f64; 3]; 3] {
        let [by_row, by_column] = [0, 1].map(|k| basis(self.counts[k], shares[k]));
        let mut out = [[0.0; 3]; 3];
        for (row, [value, slope]) in self.coefficients.chunks(self.counts[1]).zip(&by_row) {
            let mut inner = [[0.0; 3]; 2];
            for (c, [value, slope]) in row.iter().zip(&by_column) {
                for i in 0..3 {
                    inner[0][i] += value * c[i];
                    inner[1][i] += slope * c[i];
                }
            }
            for i in 0..3 {
                out[0][i] += value * inner[0][i];
                out[1][i] += slope * inner[0][i];
                out[2][i] += value * inner[1][i];
            }
        }
        out
    }
}

impl MotionBounds {
    pub(crate) fn new(motion: &PoseSeries) -> MotionBounds {
        let mut bounds = MotionBounds::default();
        for (degree, c) in motion.coefficients().iter().enumerate() {
            let (tip, axis) = (length(&c[..3]), length(&c[3..]));
            for (k, by) in steepest(degree).into_iter().enumerate() {
                bounds.tip[k] += by * tip;
                bounds.axis[k] += by * axis;
            }
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::chart::Chart;

    #[test]
    fn derivatives_are_those_of_the_function_and_below_their_bounds() {
        let shares = [Chart::shares(15), Chart::shares(17)];
        let f = |u: f64, w: f64| [(2.0 * u).sin() * w, (u * w).exp(), u - w * w];
        let values = shares[0].iter().flat_map(|u| shares[1].iter().map(move |w| (*u, *w)));
        let values = values.map(|(u, w)| {
            let [x, y, z] = f(u, w);
            [x, y, z, 0.0, 0.0, 1.0]
        });
        let field = SmoothField::new(&PoseField::through(values.collect(), [15, 17]));
        for [u, w] in [[0.0, 0.3], [0.41, 1.0], [0.77, 0.62]] {
            let [at, by_first, by_second] = field.at([u, w]);
            let first = [2.0 * (2.0 * u).cos() * w, w * (u * w).exp(), 1.0];
            let second = [(2.0 * u).sin(), u * (u * w).exp(), -2.0 * w];
            for i in 0..3 {
                // a derivative loses the square of the degree
                assert!((at[i] - f(u, w)[i]).abs() < 1e-13, "{u} {w}");
                assert!((by_first[i] - first[i]).abs() < 1e-11 && (by_second[i] - second[i]).abs() < 1e-11, "{u} {w}");
            }
            assert!(length(&by_first) <= field.bounds.slopes[0] && length(&by_second) <= field.bounds.slopes[1]);
            let bent = [-4.0 * (2.0 * u).sin() * w, w * w * (u * w).exp(), 0.0];
            assert!(length(&bent) <= field.bounds.bends[0] && 2.0 <= field.bounds.bends[1], "{u} {w}");
        }
    }
}

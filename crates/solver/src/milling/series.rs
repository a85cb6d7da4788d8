//! Six functions of a share as series in Chebyshev's polynomials: position and direction along a line.

use std::f64::consts::PI;

use crate::solid::chart::Chart;

/// Position (mm) and direction of a tool's origin and axis, or of a surface and its normal, over a share from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseSeries {
    /// Of each polynomial T₀, T₁, … its six coefficients.
    coefficients: Vec<[f64; 6]>,
}

/// Position and direction with their first and second derivatives by the share.
pub type Moving = [[f64; 6]; 3];

impl PoseSeries {
    /// Through values at [`Chart::shares`].
    ///
    /// # Panics
    /// If there are fewer than two.
    pub fn through(values: &[[f64; 6]]) -> PoseSeries {
        let last = values.len() - 1;
        assert!(last > 0, "a line has two points");
        let cosines: Vec<f64> = (0..2 * last).map(|k| (PI * k as f64 / last as f64).cos()).collect();
        let coefficient = |degree: usize| {
            let mut sum = [0.0; 6];
            for (k, value) in values.iter().enumerate() {
                // the shares run against the cosine
                let cosine = cosines[(degree * (last - k)) % (2 * last)];
                let end = if k == 0 || k == last { 0.5 } else { 1.0 };
                (0..6).for_each(|i| sum[i] += end * cosine * value[i]);
            }
            let whole = if degree == 0 || degree == last { 1.0 } else { 2.0 };
            sum.map(|sum| sum * whole / last as f64)
        };
        PoseSeries { coefficients: (0..=last).map(coefficient).collect() }
    }

    /// Of a motion that is given at any share, as exact as that of so many values.
    pub fn sampled(count: usize, at: impl Fn(f64) -> [f64; 6]) -> PoseSeries {
        PoseSeries::through(&Chart::shares(count).into_iter().map(at).collect::<Vec<[f64; 6]>>())
    }

    /// Through how many values it goes.
    pub(crate) fn values(&self) -> usize {
        self.coefficients.len()
    }

    /// Of each polynomial T₀, T₁, … its six coefficients.
    pub(crate) fn coefficients(&self) -> &[[f64; 6]] {
        &self.coefficients
    }

    /// The values at a share.
    pub fn at(&self, share: f64) -> [f64; 6] {
        let x = 2.0 * share - 1.0;
        let mut value = [[0.0; 6]; 2];
        // Clenshaw's recurrence
        for c in self.coefficients[1..].iter().rev() {
            let next = |i: usize| c[i] + 2.0 * x * value[0][i] - value[1][i];
            value = [[0, 1, 2, 3, 4, 5].map(next), value[0]];
        }
        [0, 1, 2, 3, 4, 5].map(|i| self.coefficients[0][i] + x * value[0][i] - value[1][i])
    }

    /// The values with their derivatives by the share.
    pub fn moving(&self, share: f64) -> Moving {
        let x = 2.0 * share - 1.0;
        let (mut value, mut slope, mut bend) = ([[0.0; 6]; 2], [[0.0; 6]; 2], [[0.0; 6]; 2]);
        // the same recurrence, differentiated twice
        for c in self.coefficients[1..].iter().rev() {
            for i in 0..6 {
                let b = 2.0 * (2.0 * slope[0][i] + x * bend[0][i]) - bend[1][i];
                let s = 2.0 * (value[0][i] + x * slope[0][i]) - slope[1][i];
                let v = c[i] + 2.0 * x * value[0][i] - value[1][i];
                (bend[1][i], bend[0][i]) = (bend[0][i], b);
                (slope[1][i], slope[0][i]) = (slope[0][i], s);
                (value[1][i], value[0][i]) = (value[0][i], v);
            }
        }
        let mut out = [[0.0; 6]; 3];
        for i in 0..6 {
            out[0][i] = self.coefficients[0][i] + x * value[0][i] - value[1][i];
            out[1][i] = 2.0 * (value[0][i] + x * slope[0][i] - slope[1][i]);
            out[2][i] = 4.0 * (2.0 * slope[0][i] + x * bend[0][i] - bend[1][i]);
        }
        out
    }

    /// How fast the position so far along the direction (mm) and the direction change with the share at the most.
    pub(crate) fn rates(&self, along: f64) -> [f64; 2] {
        let place = |c: &[f64; 6]| [c[0] + along * c[3], c[1] + along * c[4], c[2] + along * c[5], c[3], c[4], c[5]];
        let of_degree = |(degree, c)| lengths(&place(c)).map(|length| fastest(degree) * length);
        let each = self.coefficients.iter().enumerate().map(of_degree);
        each.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])
    }

    /// The largest of the last two coefficients: how far the series may be off.
    pub fn tail(&self) -> f64 {
        let last = self.coefficients.iter().rev().take(2).flatten();
        last.fold(0.0, |most: f64, c| most.max(c.abs()))
    }
}

/// The length of the position's part of a coefficient, and that of the direction's.
fn lengths(coefficient: &[f64; 6]) -> [f64; 2] {
    let length = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>().sqrt();
    [length(&coefficient[..3]), length(&coefficient[3..])]
}

/// How fast a polynomial of Chebyshev's changes with the share at the most.
fn fastest(degree: usize) -> f64 {
    2.0 * (degree * degree) as f64
}

/// Positions and directions over two shares: of passes, and along them. The polynomial through values at [`Chart::shares`].
#[derive(Clone, Debug, PartialEq)]
pub struct PoseField {
    counts: [usize; 2],
    nodes: [Vec<f64>; 2],
    values: Vec<[f64; 6]>,
}

impl PoseField {
    /// Row by row: a row is a pass.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` values, or fewer than two rows or columns.
    pub fn through(values: Vec<[f64; 6]>, counts: [usize; 2]) -> PoseField {
        assert!(values.len() == counts[0] * counts[1] && counts.iter().all(|count| *count > 1), "a grid of values");
        PoseField { counts, nodes: counts.map(Chart::shares), values }
    }

    /// The values at a share across the passes and one along them, which may lie a little beyond the ends.
    pub fn at(&self, shares: [f64; 2]) -> [f64; 6] {
        let [by_row, by_column] = [0, 1].map(|k| Chart::weights_at(&self.nodes[k], shares[k]));
        let mut sum = [0.0; 6];
        for (row, weight) in self.values.chunks(self.counts[1]).zip(&by_row) {
            let mut inner = [0.0; 6];
            for (value, weight) in row.iter().zip(&by_column) {
                (0..6).for_each(|i| inner[i] += weight * value[i]);
            }
            (0..6).for_each(|i| sum[i] += weight * inner[i]);
        }
        sum
    }

    /// The position at shares.
    pub(crate) fn position(&self, shares: [f64; 2]) -> [f64; 3] {
        let [x, y, z, ..] = self.at(shares);
        [x, y, z]
    }

    /// The positions so far before shares, at them, and so far behind, across the passes and along them.
    pub(crate) fn around(&self, shares: [f64; 2], apart: f64) -> [[[f64; 3]; 3]; 3] {
        let weights = |k: usize| [-1.0, 0.0, 1.0].map(|by| Chart::weights_at(&self.nodes[k], shares[k] + by * apart));
        let (by_row, by_column) = (weights(0), weights(1));
        let mut sum = [[[0.0; 3]; 3]; 3];
        for (row, values) in self.values.chunks(self.counts[1]).enumerate() {
            let mut inner = [[0.0; 3]; 3];
            for (column, value) in values.iter().enumerate() {
                for (inner, weights) in inner.iter_mut().zip(&by_column) {
                    (0..3).for_each(|i| inner[i] += weights[column] * value[i]);
                }
            }
            for (sum, weights) in sum.iter_mut().zip(&by_row) {
                for (sum, inner) in sum.iter_mut().zip(&inner) {
                    (0..3).for_each(|i| sum[i] += weights[row] * inner[i]);
                }
            }
        }
        sum
    }

    /// The pass at a share.
    pub fn pass(&self, share: f64) -> PoseSeries {
        let [rows, columns] = self.counts;
        let weights = Chart::weights(rows, share);
        let at = |column: usize| self.weighted(&weights, |row| row * columns + column);
        PoseSeries::through(&(0..columns).map(at).collect::<Vec<[f64; 6]>>())
    }

    /// The line across all passes at a share of the way along them.
    pub fn across(&self, share: f64) -> PoseSeries {
        let [rows, columns] = self.counts;
        let weights = Chart::weights(columns, share);
        let at = |row: usize| self.weighted(&weights, |column| row * columns + column);
        PoseSeries::through(&(0..rows).map(at).collect::<Vec<[f64; 6]>>())
    }

    /// How many polynomials of Chebyshev's in both shares it is a sum of, and the position's coefficients, row by row.
    pub(crate) fn position_coefficients(&self) -> ([usize; 2], Vec<[f64; 3]>) {
        let [rows, columns] = self.counts;
        let along: Vec<PoseSeries> = self.values.chunks(columns).map(PoseSeries::through).collect();
        let mut out = vec![[0.0; 3]; rows * columns];
        for column in 0..columns {
            let line: Vec<[f64; 6]> = along.iter().map(|series| series.coefficients[column]).collect();
            for (row, [x, y, z, ..]) in PoseSeries::through(&line).coefficients.into_iter().enumerate() {
                out[row * columns + column] = [x, y, z];
            }
        }
        (self.counts, out)
    }

    /// How far the polynomial may be off between its values: mm, and for directions radians.
    pub fn tail(&self) -> f64 {
        let [rows, columns] = self.counts;
        let along = self.values.chunks(columns).map(|row| PoseSeries::through(row).tail());
        let across = (0..columns).map(|column| {
            let line: Vec<[f64; 6]> = (0..rows).map(|row| self.values[row * columns + column]).collect();
            PoseSeries::through(&line).tail()
        });
        along.chain(across).fold(0.0, f64::max)
    }

    fn weighted(&self, weights: &[f64], place: impl Fn(usize) -> usize) -> [f64; 6] {
        let mut sum = [0.0; 6];
        for (k, weight) in weights.iter().enumerate() {
            let value = &self.values[place(k)];
            (0..6).for_each(|i| sum[i] += weight * value[i]);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_their_derivatives_are_those_of_the_functions() {
        let f = |s: f64| [s.sin(), (2.0 * s).exp(), s * s, 1.0, s, (3.0 * s).cos()];
        let series = PoseSeries::sampled(21, f);
        for s in [0.0, 0.3, 0.77, 1.0] {
            let [value, slope, bend] = series.moving(s);
            let slopes = [s.cos(), 2.0 * (2.0 * s).exp(), 2.0 * s, 0.0, 1.0, -3.0 * (3.0 * s).sin()];
            let bends = [-s.sin(), 4.0 * (2.0 * s).exp(), 2.0, 0.0, 0.0, -9.0 * (3.0 * s).cos()];
            for i in 0..6 {
                // a derivative loses the square of the degree, a second one its fourth power
                assert!((value[i] - f(s)[i]).abs() < 1e-14, "{s} {i}");
                assert!((slope[i] - slopes[i]).abs() < 1e-12, "{s} {i}");
                assert!((bend[i] - bends[i]).abs() < 1e-9, "{s} {i}");
            }
        }
    }

    #[test]
    fn a_field_is_its_function_along_and_across() {
        let f = |p: f64, u: f64| [p * u, (p + u).sin(), u.exp(), p.cos(), 1.0, p - u];
        let (rows, columns) = (Chart::shares(15), Chart::shares(17));
        let values = rows.iter().flat_map(|p| columns.iter().map(move |u| f(*p, *u))).collect();
        let field = PoseField::through(values, [15, 17]);
        assert!(field.tail() < 1e-13);
        let (along, across) = (field.pass(0.37).at(0.81), field.across(0.81).at(0.37));
        for i in 0..6 {
            assert!((along[i] - f(0.37, 0.81)[i]).abs() < 1e-13 && (across[i] - along[i]).abs() < 1e-13);
        }
    }
}

//! A piece of a surface as the polynomial through its points.

use std::f64::consts::PI;

/// A piece of a surface over two shares, `[across, along]`, each from 0 to 1: the polynomial through exact points at Chebyshev's nodes.
///
/// Two charts whose border rows hold the same points have the same border: its polynomial depends on no other points.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    counts: [usize; 2],
    /// Row by row, mm.
    points: Vec<[f64; 3]>,
}

impl Chart {
    /// The shares at which a chart with so many rows, or columns, has its points: both ends among them.
    pub fn shares(count: usize) -> Vec<f64> {
        (0..count).map(|k| 0.5 - 0.5 * (PI * k as f64 / (count - 1) as f64).cos()).collect()
    }

    /// Through points, row by row, at the [`shares`](Chart::shares) of `counts` rows and columns.
    ///
    /// # Panics
    /// If there are not `counts[0] · counts[1]` points, or fewer than two rows or columns.
    pub fn through(points: Vec<[f64; 3]>, counts: [usize; 2]) -> Chart {
        assert!(points.len() == counts[0] * counts[1] && counts.iter().all(|count| *count > 1), "a grid of points");
        Chart { counts, points }
    }

    /// Rows and columns of points.
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// Its points, row by row, mm.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The same piece with its rows in the other order.
    #[must_use]
    pub fn reversed(&self) -> Chart {
        let rows = self.points.chunks(self.counts[1]).rev();
        Chart { counts: self.counts, points: rows.flatten().copied().collect() }
    }

    /// The same with the points of a row replaced.
    ///
    /// # Panics
    /// If there is no such row, or not as many points as columns.
    #[must_use]
    pub fn with_row(mut self, row: usize, points: &[[f64; 3]]) -> Chart {
        self.points[row * self.counts[1]..][..self.counts[1]].copy_from_slice(points);
        self
    }

    /// The points of a row.
    ///
    /// # Panics
    /// If there is none.
    pub fn row(&self, row: usize) -> &[[f64; 3]] {
        &self.points[row * self.counts[1]..][..self.counts[1]]
    }

    /// What the value at each of so many shares counts in that of the polynomial through them.
    pub(crate) fn weights(count: usize, share: f64) -> Vec<f64> {
        Chart::weights_at(&Chart::shares(count), share)
    }

    /// The same at shares that are known.
    pub(crate) fn weights_at(nodes: &[f64], share: f64) -> Vec<f64> {
        let count = nodes.len();
        if let Some(node) = nodes.iter().position(|node| *node == share) {
            return (0..count).map(|k| if k == node { 1.0 } else { 0.0 }).collect();
        }
        let terms: Vec<f64> = (0..count).map(|k| barycentric_weight(count, k) / (share - nodes[k])).collect();
        let sum: f64 = terms.iter().sum();
        terms.iter().map(|term| term / sum).collect()
    }

    /// How what each value counts changes with the share.
    pub(crate) fn weight_slopes(count: usize, share: f64) -> Vec<f64> {
        Basis::at(count, share).slopes
    }

    /// The position at two shares, mm.
    pub fn at(&self, shares: [f64; 2]) -> [f64; 3] {
        self.summed([0, 1].map(|k| Chart::weights(self.counts[k], shares[k])))
    }

    /// Position and its derivatives by both shares, mm.
    pub fn frame(&self, shares: [f64; 2]) -> [[f64; 3]; 3] {
        let [u, w] = [0, 1].map(|k| Basis::at(self.counts[k], shares[k]));
        [
            self.summed([u.values.clone(), w.values.clone()]),
            self.summed([u.slopes, w.values]),
            self.summed([u.values, w.slopes]),
        ]
    }

    /// The same on a lattice of shares, for each share along all those across.
    pub(crate) fn frames(&self, across: &[f64], along: &[f64]) -> Vec<[[f64; 3]; 3]> {
        let across: Vec<Basis> = across.iter().map(|u| Basis::at(self.counts[0], *u)).collect();
        let of_line = |w: &f64| {
            let Basis { values, slopes } = Basis::at(self.counts[1], *w);
            let [rows, sloping] = [values, slopes].map(|w| (0..self.counts[0]).map(|i| self.in_row(i, &w)).collect());
            let sum = |u: &[f64], rows: &Vec<[f64; 3]>| weighted(u.iter().copied().zip(rows.iter().copied()));
            let frame = |u: &Basis| [sum(&u.values, &rows), sum(&u.slopes, &rows), sum(&u.values, &sloping)];
            across.iter().map(frame).collect::<Vec<_>>()
        };
        along.iter().flat_map(of_line).collect()
    }

    /// Positions on a lattice of shares, row by row, mm.
    pub fn lattice(&self, across: &[f64], along: &[f64]) -> Vec<[f64; 3]> {
        let [rows, columns] = self.counts.map(Chart::shares);
        let along: Vec<Vec<f64>> = along.iter().map(|w| Chart::weights_at(&columns, *w)).collect();
        let row = |u: &f64| {
            let weights = Chart::weights_at(&rows, *u);
            // the row's points first, then the places on it
            let row: Vec<[f64; 3]> = (0..self.counts[1])
                .map(|j| weighted((0..self.counts[0]).map(|i| (weights[i], self.points[i * self.counts[1] + j]))))
                .collect();
            let place = |weights: &Vec<f64>| weighted(weights.iter().copied().zip(row.iter().copied()));
            along.iter().map(place).collect::<Vec<[f64; 3]>>()
        };
        across.iter().flat_map(row).collect()
    }

    /// The largest of the last two coefficients of its series in Chebyshev's polynomials, across and along, mm: how far it may be off
    /// between its points in that direction, since those that follow fall faster still.
    pub fn tails(&self) -> [f64; 2] {
        let [rows, columns] = self.counts;
        let [by_row, by_column] = self.counts.map(last_coefficients);
        let size = |sum: [f64; 3]| sum.into_iter().fold(0.0, |size: f64, part| size.max(part.abs()));
        let column = |j: usize| (0..rows).map(move |i| self.points[i * columns + j]);
        let across = by_row
            .iter()
            .flat_map(|weights| (0..columns).map(move |j| size(weighted(weights.iter().copied().zip(column(j))))));
        let along = by_column.iter().flat_map(|weights| (0..rows).map(move |i| size(self.in_row(i, weights))));
        [across.fold(0.0, f64::max), along.fold(0.0, f64::max)]
    }

    fn summed(&self, [u, w]: [Vec<f64>; 2]) -> [f64; 3] {
        weighted(u.iter().enumerate().map(|(i, weight)| (*weight, self.in_row(i, &w))))
    }

    /// The sum over a row.
    fn in_row(&self, row: usize, w: &[f64]) -> [f64; 3] {
        weighted(w.iter().copied().zip(self.points[row * self.counts[1]..].iter().copied()))
    }
}

fn weighted(terms: impl Iterator<Item = (f64, [f64; 3])>) -> [f64; 3] {
    terms.fold([0.0; 3], |sum, (weight, point)| [0, 1, 2].map(|k| sum[k] + weight * point[k]))
}

/// Of the polynomial through values at the nodes: what each value counts at a share, and in the derivative there.
struct Basis {
    values: Vec<f64>,
    slopes: Vec<f64>,
}

/// Of Chebyshev's nodes of the second kind (Berrut and Trefethen, Barycentric Lagrange Interpolation, 2004, eq. 5.4).
fn barycentric_weight(count: usize, k: usize) -> f64 {
    let end = if k == 0 || k + 1 == count { 0.5 } else { 1.0 };
    if k.is_multiple_of(2) { end } else { -end }
}

impl Basis {
    /// Values by barycentric weights, slopes by eq. 9.4 there.
    fn at(count: usize, share: f64) -> Basis {
        let nodes = Chart::shares(count);
        let weight = |k: usize| barycentric_weight(count, k);
        let values = Chart::weights(count, share);
        let mut slopes = vec![0.0; count];
        for (k, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            for j in (0..count).filter(|j| *j != k) {
                let by = value * weight(j) / weight(k) / (nodes[k] - nodes[j]);
                slopes[j] += by;
                slopes[k] -= by;
            }
        }
        Basis { values, slopes }
    }
}

/// What each value at the nodes counts in the last two coefficients of the series.
fn last_coefficients(count: usize) -> [Vec<f64>; 2] {
    let last = count - 1;
    [last, last - 1].map(|degree| {
        let value = |k: usize| {
            let end = if k == 0 || k == last { 0.5 } else { 1.0 };
            let of_degree = if degree == last { 1.0 } else { 2.0 };
            of_degree * end / last as f64 * (PI * (degree * k) as f64 / last as f64).cos()
        };
        (0..count).map(value).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(u: f64, w: f64) -> [f64; 3] {
        [(u + 0.3 * w).sin(), (u * w).exp(), u * u - w]
    }

    #[test]
    fn a_chart_is_exact_between_its_points() {
        let (rows, columns) = (Chart::shares(17), Chart::shares(15));
        let points = rows.iter().flat_map(|u| columns.iter().map(move |w| surface(*u, *w))).collect();
        let chart = Chart::through(points, [17, 15]);
        assert!(chart.tails().iter().all(|tail| *tail < 1e-14), "{:?}", chart.tails());
        for [u, w] in [[0.21, 0.77], [0.0, 0.5], [1.0, 0.123]] {
            let [at, by_u, by_w] = chart.frame([u, w]);
            let c = (u + 0.3 * w).cos();
            let e = (u * w).exp();
            let exact = [surface(u, w), [c, w * e, 2.0 * u], [0.3 * c, u * e, -1.0]];
            for (found, exact) in [at, by_u, by_w].iter().zip(exact) {
                // a derivative loses as many digits as the square of the number of nodes has
                assert!((0..3).all(|k| (found[k] - exact[k]).abs() < 1e-11), "{found:?} {exact:?}");
            }
            let [same] = chart.lattice(&[u], &[w])[..] else { panic!("one place") };
            assert!((0..3).all(|k| (same[k] - at[k]).abs() < 1e-14), "{same:?} {at:?}");
        }
    }

    #[test]
    fn the_tail_tells_how_far_it_is_off() {
        let points = Chart::shares(5)
            .iter()
            .flat_map(|u| Chart::shares(9).into_iter().map(move |w| surface(6.0 * u, w)))
            .collect();
        let chart = Chart::through(points, [5, 9]);
        let [across, along] = chart.tails();
        // five rows of six turns, nine columns of one
        assert!(across > 1.0 && along < 0.5, "{across} {along}");
        let off = (0..50).map(|k| {
            let u = k as f64 / 49.0;
            (chart.at([u, 0.4])[0] - surface(6.0 * u, 0.4)[0]).abs()
        });
        assert!(off.fold(0.0, f64::max) < 2.0 * across);
    }
}

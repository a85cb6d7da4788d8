//! B-spline surfaces through grids of points.

use crate::vector::{Vector, add, cross, dot, length, scale, sub};

/// The highest degree: curvature continues from piece to piece.
const CUBIC: usize = 3;
/// Nonzeros of a row of the interpolation, around its diagonal.
const BAND: usize = 2 * CUBIC + 1;
/// Steps to the foot of a normal; from a start between four neighbours they are three or four.
const MOST_STEPS: usize = 20;

/// A tensor-product B-spline surface through a grid of points, over `0 ..= count - 1` in both directions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SplineSurface {
    pub(super) directions: [Direction; 2],
    /// Row by row.
    pub(super) poles: Vec<Vector>,
}

/// Degree and knots of one direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direction {
    pub(super) degree: usize,
    pub(super) count: usize,
    /// Each as often as it counts.
    pub(super) knots: Vec<f64>,
}

impl SplineSurface {
    /// Of the third degree where there are four points or more, else of the degree that they determine; the third derivative
    /// continues over the second and the last but one point ("not a knot").
    pub(super) fn through(points: Vec<Vector>, counts: [usize; 2]) -> SplineSurface {
        let directions = counts.map(Direction::through);
        let [rows, columns] = counts;
        let mut poles = points;
        let along_row = directions[1].factored();
        poles.chunks_exact_mut(columns).for_each(|row| solve(&along_row, row));
        let along_column = directions[0].factored();
        for j in 0..columns {
            let mut column: Vec<Vector> = (0..rows).map(|i| poles[i * columns + j]).collect();
            solve(&along_column, &mut column);
            column.into_iter().enumerate().for_each(|(i, pole)| poles[i * columns + j] = pole);
        }
        SplineSurface { directions, poles }
    }

    /// The point at `(u, v)` and its derivatives by `u` and `v`.
    pub(super) fn at(&self, u: f64, v: f64) -> [Vector; 3] {
        let [along, across] = &self.directions;
        let ((first_row, rows), (first_column, columns)) = (along.basis(u), across.basis(v));
        let mut out = [[0.0; 3]; 3];
        for (k, [row, row_slope]) in rows.into_iter().take(along.degree + 1).enumerate() {
            for (l, [column, column_slope]) in columns.into_iter().take(across.degree + 1).enumerate() {
                let pole = self.poles[(first_row + k) * across.count + first_column + l];
                for (sum, weight) in out.iter_mut().zip([row * column, row_slope * column, row * column_slope]) {
                    *sum = add(*sum, scale(weight, pole));
                }
            }
        }
        out
    }

    /// How far it lies from the points of a lattice with one more row and column between any two, at the same parameters, mm.
    pub(super) fn off(&self, doubled: &[Vector]) -> f64 {
        let [rows, columns] = self.directions.each_ref().map(|direction| 2 * direction.count - 1);
        let at = |i: usize, j: usize| self.at(0.5 * i as f64, 0.5 * j as f64)[0];
        let off = |k: usize| length(sub(doubled[k], at(k / columns, k % columns)));
        (0..rows * columns).map(off).fold(0.0, f64::max)
    }

    /// How far the surface lies from a point along the point's normal, mm; `None` if the normal does not meet it near `start`.
    pub(super) fn distance(&self, point: Vector, normal: Vector, start: [f64; 2]) -> Option<f64> {
        let [mut u, mut v] = start;
        // the foot of a point on the border may lie a little beyond it
        let end = self.directions.each_ref().map(|direction| direction.count as f64 - 0.5);
        for _ in 0..MOST_STEPS {
            let [at, by_u, by_v] = self.at(u, v);
            let off = sub(point, at);
            // off = du by_u + dv by_v + d normal
            let volume = dot(cross(by_u, by_v), normal);
            let du = dot(cross(off, by_v), normal) / volume;
            let dv = dot(cross(by_u, off), normal) / volume;
            if !(du.is_finite() && dv.is_finite()) {
                return None;
            }
            (u, v) = ((u + du).clamp(-0.5, end[0]), (v + dv).clamp(-0.5, end[1]));
            // what is left moves the foot by less than 1e-9 of a cell, and the distance by its square
            if du.abs().max(dv.abs()) < 1e-9 {
                return Some(dot(sub(point, self.at(u, v)[0]), normal));
            }
        }
        None
    }
}

impl Direction {
    fn through(count: usize) -> Direction {
        let degree = CUBIC.min(count - 1);
        let last = (count - 1) as f64;
        let first_inner = degree.div_ceil(2);
        let inner = (0..count.saturating_sub(degree + 1)).map(|k| (first_inner + k) as f64);
        let ends = |value| std::iter::repeat_n(value, degree + 1);
        Direction { degree, count, knots: ends(0.0).chain(inner).chain(ends(last)).collect() }
    }

    /// The first of the `degree + 1` basis functions that do not vanish at `t`, and their values and slopes (de Boor's recurrence).
    fn basis(&self, t: f64) -> (usize, [[f64; 2]; CUBIC + 1]) {
        let knots = &self.knots;
        let span = knots[self.degree..self.count].partition_point(|knot| *knot <= t).max(1) - 1 + self.degree;
        let mut values = [[0.0; 2]; CUBIC + 1];
        values[0][0] = 1.0;
        for degree in 1..=self.degree {
            let lower = values;
            values = [[0.0; 2]; CUBIC + 1];
            for k in 0..degree {
                let from = span + 1 + k - degree;
                let width = knots[from + degree] - knots[from];
                let share = (t - knots[from]) / width;
                let [value, slope] = lower[k];
                values[k][0] += (1.0 - share) * value;
                values[k][1] += (1.0 - share) * slope - value / width;
                values[k + 1][0] += share * value;
                values[k + 1][1] += share * slope + value / width;
            }
        }
        (span - self.degree, values)
    }

    /// The interpolation's matrix at the points `0, 1, …`, in triangular factors. It is totally positive, so that no pivots are needed
    /// (C. de Boor, A Practical Guide to Splines, chapter XIII).
    fn factored(&self) -> Vec<[f64; BAND]> {
        let mut rows: Vec<[f64; BAND]> = (0..self.count)
            .map(|k| {
                let mut row = [0.0; BAND];
                let (first, values) = self.basis(k as f64);
                for (l, [value, _]) in values.into_iter().enumerate().filter(|(_, [value, _])| *value != 0.0) {
                    row[first + l + CUBIC - k] = value;
                }
                row
            })
            .collect();
        for pivot in 0..self.count {
            for below in pivot + 1..self.count.min(pivot + CUBIC + 1) {
                let shift = below - pivot;
                let factor = rows[below][CUBIC - shift] / rows[pivot][CUBIC];
                for at in 1..=CUBIC {
                    rows[below][CUBIC - shift + at] -= factor * rows[pivot][CUBIC + at];
                }
                rows[below][CUBIC - shift] = factor;
            }
        }
        rows
    }
}

/// Points become poles.
fn solve(factors: &[[f64; BAND]], values: &mut [Vector]) {
    for k in 0..values.len() {
        for shift in 1..=CUBIC.min(k) {
            values[k] = sub(values[k], scale(factors[k][CUBIC - shift], values[k - shift]));
        }
    }
    for k in (0..values.len()).rev() {
        for shift in 1..=CUBIC.min(values.len() - 1 - k) {
            values[k] = sub(values[k], scale(factors[k][CUBIC + shift], values[k + shift]));
        }
        values[k] = scale(1.0 / factors[k][CUBIC], values[k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bent(u: f64, v: f64) -> Vector {
        [u - 0.1 * v * v, v + 0.02 * u * u * v, 0.3 * u - 0.01 * u * u * u + 0.05 * v * v * v]
    }

    fn through_bent(counts: [usize; 2]) -> SplineSurface {
        let points = (0..counts[0] * counts[1]).map(|at| bent((at / counts[1]) as f64, (at % counts[1]) as f64));
        SplineSurface::through(points.collect(), counts)
    }

    #[test]
    fn a_cubic_is_met_everywhere() {
        for counts in [[4, 4], [5, 9], [12, 4]] {
            let surface = through_bent(counts);
            for (u, v) in [(0.0, 0.0), (0.3, 2.9), (2.5, 1.1), (counts[0] as f64 - 1.0, counts[1] as f64 - 1.0)] {
                let [at, by_u, _] = surface.at(u, v);
                let slope = [1.0, 0.04 * u * v, 0.3 - 0.03 * u * u];
                for k in 0..3 {
                    // a handful of roundings of numbers up to 40
                    assert!((at[k] - bent(u, v)[k]).abs() < 1e-12, "{counts:?} {u} {v}: {at:?}");
                    assert!((by_u[k] - slope[k]).abs() < 1e-12, "{counts:?} {u} {v}: {by_u:?}");
                }
            }
        }
    }

    #[test]
    fn few_points_lower_the_degree() {
        let surface = through_bent([2, 3]);
        assert_eq!(surface.directions.each_ref().map(|direction| direction.degree), [1, 2]);
        assert_eq!(surface.at(1.0, 2.0)[0], bent(1.0, 2.0));
    }

    #[test]
    fn a_point_beside_the_surface_is_as_far_off_as_it_was_put() {
        let surface = through_bent([6, 6]);
        let [at, by_u, by_v] = surface.at(2.37, 3.61);
        let normal = crate::vector::unit(cross(by_u, by_v)).expect("a regular point");
        let off = surface.distance(add(at, scale(0.002, normal)), normal, [2.5, 3.5]).expect("near");
        assert!((off - 0.002).abs() < 1e-14, "{off}");
    }
}

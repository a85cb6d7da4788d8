//! A few linear equations, by Gauss with the largest pivot of all.

/// Equations, with room for their elimination.
#[derive(Clone, Debug)]
pub(crate) struct Elimination {
    size: usize,
    /// Row by row, behind each row its right side.
    entries: Vec<f64>,
    /// Which unknown stands in each column.
    order: Vec<usize>,
}

/// What the pivots of a matrix tell of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pivots {
    /// The size of the smallest one; no number where one is none.
    pub(crate) least: f64,
    pub(crate) determinant: f64,
}

impl Elimination {
    /// Room for so many equations with as many unknowns.
    pub(crate) fn new(size: usize) -> Elimination {
        Elimination { size, entries: vec![0.0; size * (size + 1)], order: vec![0; size] }
    }

    /// Brings equations into triangular form, given their entries by row and column; the column behind the last unknown's is the right
    /// side.
    pub(crate) fn eliminate(&mut self, entry: impl Fn(usize, usize) -> f64) -> Pivots {
        let (n, width) = (self.size, self.size + 1);
        for row in 0..n {
            for column in 0..width {
                self.entries[row * width + column] = entry(row, column);
            }
            self.order[row] = row;
        }
        let mut pivots = Pivots { least: f64::INFINITY, determinant: 1.0 };
        for step in 0..n {
            self.bring_largest_to(step, &mut pivots.determinant);
            let (done, below) = self.entries.split_at_mut((step + 1) * width);
            let own = &done[step * width..];
            let pivot = own[step];
            pivots.determinant *= pivot;
            let is_less = pivot.is_nan() || pivot.abs() < pivots.least;
            pivots.least = if is_less { pivot.abs() } else { pivots.least };
            for row in below.chunks_exact_mut(width) {
                // below a largest pivot of zero there is nothing else
                let factor = if pivot == 0.0 { 0.0 } else { row[step] / pivot };
                for (entry, own) in row[step + 1..].iter_mut().zip(&own[step + 1..]) {
                    *entry -= factor * own;
                }
            }
        }
        pivots
    }

    /// Swaps rows and columns from `step` on so that the largest entry stands first; each swap turns the sign of the determinant.
    fn bring_largest_to(&mut self, step: usize, determinant: &mut f64) {
        let (n, width) = (self.size, self.size + 1);
        let (mut at, mut most) = ((step, step), -1.0);
        for row in step..n {
            for column in step..n {
                let size = self.entries[row * width + column].abs();
                if size > most {
                    (at, most) = ((row, column), size);
                }
            }
        }
        if at.0 != step {
            (step..width).for_each(|column| self.entries.swap(step * width + column, at.0 * width + column));
            *determinant = -*determinant;
        }
        if at.1 != step {
            (0..n).for_each(|row| self.entries.swap(row * width + step, row * width + at.1));
            self.order.swap(step, at.1);
            *determinant = -*determinant;
        }
    }

    /// The unknowns of the equations that were eliminated last; not finite where their matrix has no inverse.
    pub(crate) fn unknowns(&self) -> Vec<f64> {
        let (n, width) = (self.size, self.size + 1);
        let mut found = vec![0.0; n];
        for step in (0..n).rev() {
            let row = &self.entries[step * width..][..width];
            let known = (step + 1..n).map(|column| row[column] * found[self.order[column]]);
            found[self.order[step]] = (row[n] - known.sum::<f64>()) / row[step];
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// Numbers in ±1 from a linear congruence.
    fn next(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    #[test]
    fn unknowns_and_determinants_are_those_of_another_program() {
        let mut state = 11;
        for n in 1..=7 {
            for _ in 0..50 {
                let matrix = DMatrix::from_fn(n, n, |_, _| next(&mut state));
                let right = DVector::from_fn(n, |_, _| next(&mut state));
                let mut equations = Elimination::new(n);
                let entry = |row: usize, column: usize| if column < n { matrix[(row, column)] } else { right[row] };
                let pivots = equations.eliminate(entry);
                let expected = matrix.determinant();
                assert!((pivots.determinant - expected).abs() <= 1e-13, "{pivots:?} {expected}");
                let left = &matrix * DVector::from_vec(equations.unknowns()) - &right;
                assert!(left.amax() <= 1e-13 / pivots.least.min(1.0), "{left} {pivots:?}");
            }
        }
    }

    #[test]
    fn pivots_tell_the_rank() {
        let of = |rows: [[f64; 3]; 3]| {
            let mut equations = Elimination::new(3);
            equations.eliminate(|row, column| rows[row].get(column).copied().unwrap_or(1.0))
        };
        let dependent = of([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.5, -1.0, 1.0]]);
        assert!(dependent.least <= 1e-15 && dependent.determinant.abs() <= 1e-14);
        // a column of zeros, and nothing but zeros
        assert_eq!(of([[1.0, 0.0, 3.0], [2.0, 0.0, 5.0], [0.5, 0.0, 1.0]]).least, 0.0);
        let nothing = of([[0.0; 3]; 3]);
        assert_eq!([nothing.least, nothing.determinant], [0.0; 2]);
        assert!(of([[1.0, f64::NAN, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).least.is_nan());
        // two swaps
        assert_eq!(of([[0.0, 1.0, 0.0], [0.0, 0.0, 2.0], [3.0, 0.0, 0.0]]).determinant, 6.0);
    }
}

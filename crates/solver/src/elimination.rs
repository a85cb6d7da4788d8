//! Linear systems of a few unknowns, without a branch: a loop over many of them becomes vector instructions.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

/// A solved linear system.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eliminated<const N: usize> {
    /// x of J x = b.
    pub(crate) solution: [f64; N],
    /// The smallest pivot: how far J is from having no inverse.
    pub(crate) least_pivot: f64,
    /// The determinant.
    pub(crate) determinant: f64,
}

/// Gauss with row pivots.
#[inline(always)]
pub(crate) fn eliminate<const N: usize>(mut j: [[f64; N]; N], mut b: [f64; N]) -> Eliminated<N> {
    let (mut least_pivot, mut determinant) = (f64::INFINITY, 1.0);
    for k in 0..N {
        for row in k + 1..N {
            // the larger one moves up
            let swaps = j[row][k].abs() > j[k][k].abs();
            for column in k..N {
                (j[k][column], j[row][column]) = swapped(swaps, j[k][column], j[row][column]);
            }
            (b[k], b[row]) = swapped(swaps, b[k], b[row]);
            determinant = if swaps { -determinant } else { determinant };
        }
        let pivot = j[k][k];
        determinant *= pivot;
        least_pivot = if pivot.abs() >= least_pivot { least_pivot } else { pivot.abs() };
        let inverse = 1.0 / pivot;
        for row in k + 1..N {
            let factor = j[row][k] * inverse;
            for column in k + 1..N {
                j[row][column] -= factor * j[k][column];
            }
            b[row] -= factor * b[k];
        }
        b[k] *= inverse;
        for column in k + 1..N {
            j[k][column] *= inverse;
        }
    }
    for k in (0..N).rev() {
        for column in k + 1..N {
            b[k] -= j[k][column] * b[column];
        }
    }
    Eliminated { solution: b, least_pivot, determinant }
}

#[inline(always)]
fn swapped(swaps: bool, a: f64, b: f64) -> (f64, f64) {
    (if swaps { b } else { a }, if swaps { a } else { b })
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;
    use faer::linalg::solvers::{FullPivLu, Solve};

    /// Numbers in ±1 from a linear congruence.
    fn next(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn against_faer<const N: usize>() {
        let mut state = 7;
        for _ in 0..2000 {
            let j: [[f64; N]; N] = std::array::from_fn(|_| std::array::from_fn(|_| next(&mut state)));
            let b: [f64; N] = std::array::from_fn(|_| next(&mut state));
            let found = eliminate(j, b);
            let matrix = Mat::from_fn(N, N, |row, column| j[row][column]);
            let careful = FullPivLu::new(matrix.as_ref()).solve(Mat::from_fn(N, 1, |row, _| b[row]));
            for k in 0..N {
                let size = found.solution.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                let allowed = 64.0 * f64::EPSILON * size / found.least_pivot;
                assert!((found.solution[k] - careful[(k, 0)]).abs() <= allowed, "{j:?} {b:?}: {found:?} {careful:?}");
            }
            assert!((found.determinant - matrix.determinant()).abs() < 1e-13);
        }
    }

    #[test]
    fn small_systems_have_the_solutions_of_the_general_path() {
        against_faer::<1>();
        against_faer::<2>();
        against_faer::<3>();
        against_faer::<4>();
        against_faer::<5>();
    }

    #[test]
    fn no_inverse_shows_in_the_pivots() {
        let found = eliminate([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.5, -1.0, 1.0]], [1.0, 2.0, 3.0]);
        assert!(found.least_pivot < 1e-15 && found.determinant == 0.0);
    }
}

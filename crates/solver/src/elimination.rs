//! Linear systems of a few unknowns, several side by side, without a branch: each operation becomes a vector instruction.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

/// A number of each of the systems.
pub(crate) type Side<const W: usize> = [f64; W];

/// Solved linear systems.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eliminated<const N: usize, const W: usize> {
    /// x of J x = b.
    pub(crate) solution: [Side<W>; N],
    /// The smallest pivot: how far J is from having no inverse.
    pub(crate) least_pivot: Side<W>,
    /// The determinant.
    pub(crate) determinant: Side<W>,
}

/// One operation on all systems.
#[inline(always)]
pub(crate) fn each<const W: usize>(a: Side<W>, b: Side<W>, f: impl Fn(f64, f64) -> f64) -> Side<W> {
    let mut result = [0.0; W];
    for side in 0..W {
        result[side] = f(a[side], b[side]);
    }
    result
}

/// `yes` where |a| > |b|, else `no`.
#[inline(always)]
fn where_larger<const W: usize>(a: Side<W>, b: Side<W>, yes: Side<W>, no: Side<W>) -> Side<W> {
    let mut result = [0.0; W];
    for side in 0..W {
        result[side] = if a[side].abs() > b[side].abs() { yes[side] } else { no[side] };
    }
    result
}

/// a − b c
#[inline(always)]
fn less<const W: usize>(a: Side<W>, b: Side<W>, c: Side<W>) -> Side<W> {
    each(a, each(b, c, |b, c| b * c), |a, product| a - product)
}

/// Gauss with row pivots.
#[inline(always)]
pub(crate) fn eliminate<const N: usize, const W: usize>(
    mut j: [[Side<W>; N]; N],
    mut b: [Side<W>; N],
) -> Eliminated<N, W> {
    let (mut least_pivot, mut determinant) = ([f64::INFINITY; W], [1.0; W]);
    for k in 0..N {
        for row in k + 1..N {
            // the larger one moves up
            let (lower, upper) = (j[row][k], j[k][k]);
            determinant = where_larger(lower, upper, determinant.map(|d| -d), determinant);
            for column in k..N {
                let (above, below) = (j[k][column], j[row][column]);
                j[k][column] = where_larger(lower, upper, below, above);
                j[row][column] = where_larger(lower, upper, above, below);
            }
            let (above, below) = (b[k], b[row]);
            b[k] = where_larger(lower, upper, below, above);
            b[row] = where_larger(lower, upper, above, below);
        }
        let pivot = j[k][k];
        determinant = each(determinant, pivot, |determinant, pivot| determinant * pivot);
        // a NaN is the smallest
        least_pivot = each(least_pivot, pivot, |least, pivot| if pivot.abs() >= least { least } else { pivot.abs() });
        let inverse = pivot.map(|pivot| 1.0 / pivot);
        for row in k + 1..N {
            let factor = each(j[row][k], inverse, |a, b| a * b);
            for column in k + 1..N {
                j[row][column] = less(j[row][column], factor, j[k][column]);
            }
            b[row] = less(b[row], factor, b[k]);
        }
        b[k] = each(b[k], inverse, |a, b| a * b);
        for column in k + 1..N {
            j[k][column] = each(j[k][column], inverse, |a, b| a * b);
        }
    }
    for k in (0..N).rev() {
        for column in k + 1..N {
            b[k] = less(b[k], j[k][column], b[column]);
        }
    }
    Eliminated { solution: b, least_pivot, determinant }
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

    /// One system, as (solution, least pivot, determinant), beside others.
    fn alone<const N: usize>(j: [[f64; N]; N], b: [f64; N]) -> ([f64; N], f64, f64) {
        let others = |x: f64| [1.0 - x, x, 0.0];
        let found = eliminate(j.map(|row| row.map(others)), b.map(others));
        (found.solution.map(|x| x[1]), found.least_pivot[1], found.determinant[1])
    }

    fn against_faer<const N: usize>() {
        let mut state = 7;
        for _ in 0..2000 {
            let j: [[f64; N]; N] = std::array::from_fn(|_| std::array::from_fn(|_| next(&mut state)));
            let b: [f64; N] = std::array::from_fn(|_| next(&mut state));
            let (solution, least_pivot, determinant) = alone(j, b);
            let matrix = Mat::from_fn(N, N, |row, column| j[row][column]);
            let careful = FullPivLu::new(matrix.as_ref()).solve(Mat::from_fn(N, 1, |row, _| b[row]));
            for k in 0..N {
                let size = solution.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                let allowed = 64.0 * f64::EPSILON * size / least_pivot;
                assert!((solution[k] - careful[(k, 0)]).abs() <= allowed, "{j:?} {b:?}: {solution:?} {careful:?}");
            }
            assert!((determinant - matrix.determinant()).abs() < 1e-13);
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
        let (_, least_pivot, determinant) =
            alone([[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.5, -1.0, 1.0]], [1.0, 2.0, 3.0]);
        assert!(least_pivot < 1e-15 && determinant == 0.0);
    }
}

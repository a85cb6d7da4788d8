//! Directions in which constraints do not change.

use faer::Mat;
use faer::linalg::solvers::Svd;
use nalgebra::DMatrix;

/// A singular value below this share of the largest counts as zero: rounding leaves about 1e-15 of it.
const ZERO: f64 = 1e-10;

/// An orthonormal basis, as columns, of the vectors that `rows` (each scaled to length one) map to zero.
///
/// `None` if the rows are not independent, or not finite: then there is no telling how many directions are free.
pub(super) fn null_space(rows: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (m, n) = rows.shape();
    if m == 0 {
        return Some(DMatrix::identity(n, n));
    }
    let sizes: Vec<f64> = rows.row_iter().map(|row| row.norm()).collect();
    if sizes.iter().any(|size| !size.is_finite() || *size == 0.0) {
        return None;
    }
    let svd = Svd::new(Mat::from_fn(m, n, |i, j| rows[(i, j)] / sizes[i]).as_ref()).ok()?;
    let (s, v) = (svd.S(), svd.V());
    (m <= n && s[m - 1] > ZERO * s[0]).then(|| DMatrix::from_fn(n, n - m, |i, j| v[(i, m + j)]))
}

/// How the basis of what rows map to zero changes with the rows, where it changes least: by nothing that they map to zero themselves.
///
/// `None` if the rows are not independent, or something is not finite.
pub(super) fn null_space_change(
    rows: &DMatrix<f64>,
    changes: &DMatrix<f64>,
    free: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    if rows.nrows() == 0 {
        return Some(DMatrix::zeros(free.nrows(), free.ncols()));
    }
    let scaled = |all: &DMatrix<f64>| {
        let mut all = all.clone();
        all.row_iter_mut().zip(rows.row_iter()).for_each(|(mut row, of)| row /= of.norm());
        all
    };
    let asked = -(scaled(changes) * free);
    let is_finite = rows.iter().chain(asked.iter()).all(|entry| entry.is_finite());
    let svd = is_finite.then(|| scaled(rows).svd(true, true))?;
    let least = ZERO * svd.singular_values.max();
    svd.solve(&asked, least).ok().filter(|_| svd.singular_values.min() > least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_of_the_space_is_free() {
        let free = null_space(&DMatrix::from_row_slice(1, 3, &[3e6, 4e6, 0.0])).expect("independent");
        assert_eq!(free.shape(), (3, 2));
        let along = DMatrix::from_row_slice(1, 3, &[0.6, 0.8, 0.0]) * &free;
        assert!(along.norm() < 1e-15 && (free.transpose() * &free - DMatrix::identity(2, 2)).norm() < 1e-14);
        assert_eq!(null_space(&DMatrix::zeros(0, 2)), Some(DMatrix::identity(2, 2)));
    }

    #[test]
    fn a_basis_changes_so_that_the_rows_stay_square_to_it() {
        let rows = DMatrix::from_row_slice(2, 4, &[3e6, 4e6, 1e6, 0.0, 0.2, -0.1, 0.7, 0.3]);
        let changes = DMatrix::from_row_slice(2, 4, &[1e5, -2e6, 5e5, 3e6, -0.4, 0.6, 0.1, 0.2]);
        let free = null_space(&rows).expect("independent");
        let change = null_space_change(&rows, &changes, &free).expect("independent");
        let off = &rows * &change + &changes * &free;
        assert!(off.row(0).norm() < 1e-8 && off.row(1).norm() < 1e-15, "{off}");
        assert!((free.transpose() * &change).norm() < 1e-15);
        assert_eq!(null_space_change(&DMatrix::zeros(1, 3), &DMatrix::zeros(1, 3), &DMatrix::identity(3, 2)), None);
    }

    #[test]
    fn dependent_rows_leave_it_open() {
        assert_eq!(null_space(&DMatrix::from_row_slice(2, 3, &[1.0, 2.0, 3.0, -2.0, -4.0, -6.0])), None);
        assert_eq!(null_space(&DMatrix::zeros(1, 3)), None);
        assert_eq!(null_space(&DMatrix::from_element(1, 3, f64::NAN)), None);
    }
}

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
    fn dependent_rows_leave_it_open() {
        assert_eq!(null_space(&DMatrix::from_row_slice(2, 3, &[1.0, 2.0, 3.0, -2.0, -4.0, -6.0])), None);
        assert_eq!(null_space(&DMatrix::zeros(1, 3)), None);
        assert_eq!(null_space(&DMatrix::from_element(1, 3, f64::NAN)), None);
    }
}

//! The Jacobian by the free unknowns, along what is to be zero.

use faer::Mat;
use faer::linalg::solvers::Svd;

use super::thin::ThinSvd;
use super::{State, UNSEEN};

/// Residuals that are to be zero, with their derivatives by the scales of the unknowns.
pub(super) struct Kept {
    pub(super) residuals: Mat<f64>,
    pub(super) jacobian: Mat<f64>,
}

impl Kept {
    /// What each has to push with against a gradient, as the unknowns that are inside their ranges say it.
    pub(super) fn forces(&self, gradient: &Mat<f64>, is_inside: impl Fn(usize) -> bool) -> Mat<f64> {
        if self.residuals.nrows() == 0 {
            return Mat::zeros(0, 1);
        }
        let inside: Vec<usize> = (0..gradient.nrows()).filter(|k| is_inside(*k)).collect();
        let of_inside = Mat::from_fn(inside.len(), 1, |row, _| -gradient[(inside[row], 0)]);
        Free::new(self, &inside).forces(&of_inside)
    }
}

/// What is to be zero, by its singular values in the free unknowns.
struct Free {
    left: Mat<f64>,
    sizes: Vec<f64>,
    /// A column for each free unknown's share; those behind the sizes are the directions that keep it.
    right: Mat<f64>,
}

impl Free {
    fn new(kept: &Kept, free: &[usize]) -> Free {
        let (rows, columns) = (kept.jacobian.nrows(), free.len());
        let none = || Free { left: Mat::zeros(rows, 0), sizes: Vec::new(), right: Mat::identity(columns, columns) };
        if rows == 0 || columns == 0 {
            return none();
        }
        let own = Mat::from_fn(rows, columns, |row, k| kept.jacobian[(row, free[k])]);
        // all is finite, so that the values converge
        let Ok(svd) = Svd::new(own.as_ref()) else { return none() };
        let sizes: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        let least = UNSEEN * sizes.first().copied().unwrap_or_default();
        let sizes: Vec<f64> = sizes.into_iter().take_while(|size| *size > least).collect();
        Free { left: svd.U().to_owned(), right: svd.V().to_owned(), sizes }
    }

    /// Directions that change nothing of it.
    fn keeping(&self) -> Mat<f64> {
        let from = self.sizes.len();
        Mat::from_fn(self.right.nrows(), self.right.ncols() - from, |row, k| self.right[(row, from + k)])
    }

    /// The shortest step of the free unknowns against residuals.
    fn against(&self, residuals: &Mat<f64>) -> Mat<f64> {
        let mut step = Mat::zeros(self.right.nrows(), 1);
        for (k, size) in self.sizes.iter().enumerate() {
            let along = -(self.left.col(k).transpose() * residuals.col(0)) / size;
            (0..step.nrows()).for_each(|row| step[(row, 0)] += along * self.right[(row, k)]);
        }
        step
    }

    /// What each of it has to push with, so that together they come nearest to a gradient of the free unknowns.
    fn forces(&self, gradient: &Mat<f64>) -> Mat<f64> {
        let mut forces = Mat::zeros(self.left.nrows(), 1);
        for (k, size) in self.sizes.iter().enumerate() {
            let along = (self.right.col(k).transpose() * gradient.col(0)) / size;
            (0..forces.nrows()).for_each(|row| forces[(row, 0)] += along * self.left[(row, k)]);
        }
        forces
    }
}

/// The singular values of the Jacobian by the free unknowns, along directions that keep what is to be zero.
pub(super) struct Decomposed {
    pub(super) rows: usize,
    /// The place of each unknown among the free ones.
    columns: Vec<Option<usize>>,
    kept: Free,
    pub(super) left: Mat<f64>,
    /// Falling.
    pub(super) sizes: Vec<f64>,
    right: Mat<f64>,
}

impl Decomposed {
    pub(super) fn new(state: &State, is_free: impl Fn(usize) -> bool) -> Decomposed {
        let count = state.values.len();
        let free: Vec<usize> = (0..count).filter(|k| is_free(*k)).collect();
        let columns: Vec<Option<usize>> = (0..count).map(|k| free.iter().position(|of| *of == k)).collect();
        let rows = state.jacobian.nrows();
        let kept = Free::new(&state.kept, &free);
        let keeping = kept.keeping();
        let none = |kept: Free| {
            let (left, right) = (Mat::zeros(rows, 0), Mat::zeros(free.len(), 0));
            Decomposed { rows, columns: columns.clone(), kept, left, sizes: vec![], right }
        };
        if keeping.ncols() == 0 {
            return none(kept);
        }
        // rows of zeros change nothing, and leave a direction for each unknown where there are fewer residuals
        let slope = |row: usize, k: usize| if row < rows { state.jacobian[(row, free[k])] } else { 0.0 };
        let jacobian = Mat::from_fn(rows.max(free.len()), free.len(), slope);
        // without anything to keep, the directions are the unknowns themselves
        let jacobian = if kept.sizes.is_empty() { jacobian } else { &jacobian * &keeping };
        let ThinSvd { mut left, sizes, right } = ThinSvd::new(&jacobian);
        let mut right = if kept.sizes.is_empty() { right } else { &keeping * &right };
        // a direction and its opposite are the same: the one whose largest share is positive is told
        for k in 0..sizes.len() {
            let largest = right.col(k).iter().fold(0.0, |most: f64, x| if x.abs() > most.abs() { *x } else { most });
            if largest < 0.0 {
                right.col_mut(k).iter_mut().for_each(|x| *x = -*x);
                left.col_mut(k).iter_mut().for_each(|x| *x = -*x);
            }
        }
        Decomposed { rows, columns, kept, left, sizes, right }
    }

    /// From a root of the mean square to a length.
    pub(super) fn root(&self) -> f64 {
        (self.rows.max(1) as f64).sqrt()
    }

    /// Of the weakest and the strongest of so many singular values.
    pub(super) fn squares(&self, used: usize) -> [f64; 2] {
        let square = |k: usize| self.sizes.get(k).map_or(0.0, |size| size.powi(2));
        [square(used.saturating_sub(1)), square(0)]
    }

    /// Of residuals in the direction of one singular value.
    pub(super) fn part(&self, residuals: &Mat<f64>, k: usize) -> f64 {
        self.left.col(k).iter().zip(residuals.col(0).iter()).map(|(a, b)| a * b).sum()
    }

    /// Of an unknown in a direction.
    pub(super) fn share(&self, k: usize, unknown: usize) -> f64 {
        self.columns[unknown].map_or(0.0, |column| self.right[(column, k)])
    }

    /// The step of the free unknowns, beside one that is taken, after which what is to be zero is that.
    pub(super) fn onto(&self, kept: &Kept, taken: &Mat<f64>) -> Mat<f64> {
        let step = self.kept.against(&(&kept.residuals + &kept.jacobian * taken));
        Mat::from_fn(self.columns.len(), 1, |k, _| self.columns[k].map_or(0.0, |column| step[(column, 0)]))
    }

    /// Against residuals, along the first so many directions; zero for unknowns that are not free.
    pub(super) fn step(&self, residuals: &Mat<f64>, used: usize, damping: f64) -> Vec<f64> {
        let mut step = vec![0.0; self.columns.len()];
        for k in 0..used {
            let size = self.sizes[k];
            let along = -self.part(residuals, k) * size / (size.powi(2) + damping);
            step.iter_mut().enumerate().for_each(|(unknown, step)| *step += along * self.share(k, unknown));
        }
        step
    }
}

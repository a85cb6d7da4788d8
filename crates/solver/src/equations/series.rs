//! Power series of the roots of a system in one of its parameters.

use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};
use flank_expr::TaylorEvaluator;

use crate::equations::system::{Linearized, System};

impl System {
    /// Series of each unknown in powers of h, about a root, where parameters change by multiples of h: coefficients up to an order, constant
    /// first; `None` where the root is singular.
    ///
    /// Order by order, `J q_k = −F_k` with F_k the coefficient of the residuals along the series so far: exact but for rounding, no
    /// differences.
    pub(crate) fn series(
        &self,
        root: &[f64],
        parameters: &[f64],
        along: &[(usize, f64)],
        order: usize,
    ) -> Option<Vec<Vec<f64>>> {
        let (size, terms) = (self.size(), order + 1);
        let mut evaluation = self.evaluation(parameters);
        evaluation.at(root);
        let jacobian = Mat::from_fn(size, size, |i, j| evaluation.jacobian(i, j));
        let inverse = PartialPivLu::new(jacobian.as_ref());
        let mut inputs = vec![0.0; terms * (size + parameters.len())];
        root.iter().chain(parameters).enumerate().for_each(|(k, x)| inputs[terms * k] = *x);
        if order > 0 {
            along.iter().for_each(|(k, rate)| inputs[terms * (size + k) + 1] = *rate);
        }
        let mut outputs = vec![0.0; terms * size];
        let mut evaluator = TaylorEvaluator::new(self.residual_tape(), order);
        for k in 1..terms {
            evaluator.run(&inputs, &mut outputs);
            let by = inverse.solve(&Mat::from_fn(size, 1, |i, _| -outputs[terms * i + k]));
            (0..size).for_each(|i| inputs[terms * i + k] = by[(i, 0)]);
        }
        inputs.truncate(terms * size);
        inputs.iter().all(|c| c.is_finite()).then(|| inputs.chunks(terms).map(<[f64]>::to_vec).collect())
    }
}

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
        let size = self.size();
        let mut evaluation = self.evaluation(parameters);
        evaluation.at(root);
        let jacobian = Mat::from_fn(size, size, |i, j| evaluation.jacobian(i, j));
        let inverse = PartialPivLu::new(jacobian.as_ref());
        let rate = |k: usize| along.iter().filter(|(of, _)| size + of == k).map(|(_, rate)| rate).sum::<f64>();
        let mut series: Vec<Vec<f64>> = root.iter().map(|x| vec![*x]).collect();
        for k in 1..=order {
            let unknowns = series.iter().map(|known| &known[..]);
            let given: Vec<[f64; 2]> = parameters.iter().enumerate().map(|(j, x)| [*x, rate(size + j)]).collect();
            let known = unknowns.chain(given.iter().map(|given| &given[..]));
            let inputs: Vec<f64> =
                known.flat_map(|known| (0..=k).map(|j| known.get(j).copied().unwrap_or(0.0))).collect();
            let mut outputs = vec![0.0; (k + 1) * size];
            TaylorEvaluator::new(self.residual_tape(), k).run(&inputs, &mut outputs);
            let by = inverse.solve(&Mat::from_fn(size, 1, |i, _| -outputs[(k + 1) * i + k]));
            series.iter_mut().enumerate().for_each(|(i, series)| series.push(by[(i, 0)]));
        }
        series.iter().flatten().all(|c| c.is_finite()).then_some(series)
    }
}

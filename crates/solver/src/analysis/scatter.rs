//! How what follows from numbers scatters when these do.

use nalgebra::{DMatrix, DVector};

/// Numbers that scatter about their means as Gauss has it.
///
/// Two numbers of standard deviations 3 and 4, and their sum: independent it scatters by 5, correlated by 0.5 by √(9 + 16 + 12).
///
/// ```
/// use flank_solver::Scatter;
///
/// let independent = Scatter::new(&[3.0, 4.0], &[]).expect("positive definite");
/// assert!((independent.deviation(&[1.0, 1.0]) - 5.0).abs() < 1e-15);
/// assert_eq!(independent.worst(&[1.0, -1.0]), 7.0);
/// let together = Scatter::new(&[3.0, 4.0], &[(0, 1, 0.5)]).expect("positive definite");
/// assert!((together.deviation(&[1.0, 1.0]) - 37f64.sqrt()).abs() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct Scatter {
    deviations: Vec<f64>,
    /// Of numbers by their standard deviations: the correlations are L Lᵀ.
    factor: DMatrix<f64>,
}

impl Scatter {
    /// Of numbers with these standard deviations; of pairs by their places the correlation, zero of those that are not named. `None` if no
    /// numbers are correlated like that: the matrix is not positive definite.
    ///
    /// # Panics
    /// If there is no number at a place.
    #[must_use]
    pub fn new(deviations: &[f64], correlations: &[(usize, usize, f64)]) -> Option<Scatter> {
        let mut matrix = DMatrix::identity(deviations.len(), deviations.len());
        for &(a, b, correlation) in correlations {
            (matrix[(a, b)], matrix[(b, a)]) = (correlation, correlation);
        }
        let factor = matrix.cholesky()?.unpack();
        Some(Scatter { deviations: deviations.to_vec(), factor })
    }

    /// Numbers that are correlated in the same way, with other standard deviations.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn with_deviations(&self, deviations: Vec<f64>) -> Scatter {
        assert_eq!(deviations.len(), self.deviations.len(), "a standard deviation for each number");
        Scatter { deviations, factor: self.factor.clone() }
    }

    /// The standard deviation of what changes with the numbers by this gradient: √(G C Gᵀ).
    #[must_use]
    pub fn deviation(&self, gradient: &[f64]) -> f64 {
        (self.factor.transpose() * self.scaled(gradient)).norm()
    }

    /// Of the variance of what changes with the numbers by this gradient the share that each number has in it, with half of what each pair
    /// has together; their sum is one. Zeros where nothing changes.
    #[must_use]
    pub fn shares(&self, gradient: &[f64]) -> Vec<f64> {
        let scaled = self.scaled(gradient);
        let together = &self.factor * (self.factor.transpose() * &scaled);
        let parts = scaled.component_mul(&together);
        let all = parts.sum();
        parts.iter().map(|part| if all > 0.0 { part / all } else { 0.0 }).collect()
    }

    /// The most that what has this gradient changes while no number is off by more than one standard deviation: Σ |Gₖ| σₖ.
    #[must_use]
    pub fn worst(&self, gradient: &[f64]) -> f64 {
        self.scaled(gradient).iter().map(|part| part.abs()).sum()
    }

    /// How far the numbers are off their means in one case.
    pub fn drawn(&self, draw: &mut GaussianDraw) -> Vec<f64> {
        let normal = DVector::from_fn(self.deviations.len(), |_, _| draw.next());
        let own = &self.factor * normal;
        own.iter().zip(&self.deviations).map(|(own, deviation)| own * deviation).collect()
    }

    fn scaled(&self, gradient: &[f64]) -> DVector<f64> {
        DVector::from_fn(self.deviations.len(), |k, _| gradient[k] * self.deviations[k])
    }
}

/// Random numbers of mean zero and variance one that are the same in every run: SplitMix64 (Steele, Lea, Flood 2014), turned into
/// normal ones as Box and Muller do.
#[derive(Clone, Debug)]
pub struct GaussianDraw(u64);

impl GaussianDraw {
    /// Another number begins another sequence.
    #[must_use]
    pub fn new(seed: u64) -> GaussianDraw {
        GaussianDraw(seed)
    }

    /// The next number.
    #[expect(clippy::should_implement_trait, reason = "it has no end")]
    pub fn next(&mut self) -> f64 {
        let [radius, angle] = [self.uniform(), self.uniform()];
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }

    /// Above 0 and not above 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 11) as f64 + 1.0) / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of 40,000 draws within four standard errors: 1/√n of the mean, √(2/n) of the variance, √(24/n) of the kurtosis.
    #[test]
    fn drawn_numbers_scatter_as_they_are_said_to() {
        let scatter = Scatter::new(&[2.0, 0.5], &[(0, 1, -0.6)]).expect("positive definite");
        let (mut draw, count) = (GaussianDraw::new(1), 40_000);
        let (mut sums, mut fourth) = ([0.0; 4], 0.0);
        for _ in 0..count {
            let [a, b] = scatter.drawn(&mut draw)[..] else { unreachable!("two numbers") };
            let [a, b] = [a / 2.0, b / 0.5];
            sums.iter_mut().zip([a, a * a, b * b, a * b]).for_each(|(sum, x)| *sum += x);
            fourth += b.powi(4);
        }
        let n = f64::from(count);
        let [mean, one, other, both] = sums.map(|sum| sum / n);
        assert!(mean.abs() < 4.0 / n.sqrt(), "{mean}");
        assert!([one, other].iter().all(|of| (of - 1.0).abs() < 4.0 * (2.0 / n).sqrt()), "{one} {other}");
        assert!((both + 0.6).abs() < 4.0 * (1.36 / n).sqrt(), "{both}");
        assert!((fourth / n - 3.0).abs() < 4.0 * (96.0 / n).sqrt(), "{fourth}");
    }

    #[test]
    fn shares_have_the_sum_one_and_impossible_correlations_are_none() {
        let scatter = Scatter::new(&[1.0, 2.0, 3.0], &[(0, 2, 0.9)]).expect("positive definite");
        let shares = scatter.shares(&[1.0, -1.0, 0.5]);
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert_eq!(scatter.shares(&[0.0; 3]), [0.0; 3]);
        assert!(Scatter::new(&[1.0; 3], &[(0, 1, 0.9), (0, 2, 0.9), (1, 2, -0.9)]).is_none());
    }
}

//! Residuals that do not go with the others.

use faer::Mat;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::{LeastSquaresFit, OWN};

/// What the others predict elsewhere by more standard deviations than this does not go with them: of 45 residuals that scatter as Gauss has
/// it one in three hundred fits shows one.
const OUTLYING: f64 = 4.0;
/// As much as leaving out a further residual has to lower the logarithm of the variance, times the number of residuals: half the square of a residual
/// that lies off by four standard deviations, which one of chance hardly does.
const WORTH: f64 = 8.0;
/// So many times something is left out at the most, ...
const MOST_LEFT_OUT: usize = 32;
/// ... of one in so many residuals at the most: of fewer that remain nobody could say that these are the ones that go together.
const PART: usize = 3;

/// What a linear model leaves of residuals, from which any of them may be left out: the others predict it then.
#[derive(Clone, Debug)]
pub struct LinearModel {
    /// A row for each residual; of those that the model knows, the columns are square to each other and of length one.
    basis: Mat<f64>,
    /// What is left, of those that are left out what the others predict less of it.
    residuals: Vec<f64>,
    is_known: Vec<bool>,
}

/// Residuals that are left out together.
struct Part {
    rows: Vec<usize>,
    /// Of the sum of squares without them.
    left: f64,
    /// What they lie off by, root of the mean square, in standard deviations of the others; as Gauss has it.
    sigmas: f64,
    /// What the one lies off by that is farthest off, beside the sign.
    most: f64,
}

impl LeastSquaresFit {
    /// The linear model at the end of the search, in the directions that are used.
    #[must_use]
    pub fn linear_model(&self) -> LinearModel {
        let mut residuals = self.residuals.clone();
        // a search that came to no end leaves some of what these directions do
        for k in 0..self.rank() {
            let unit: Vec<f64> = self.basis.col(k).iter().copied().collect();
            without(&mut residuals, &unit);
        }
        LinearModel { basis: self.basis.clone(), is_known: vec![true; residuals.len()], residuals }
    }
}

impl LinearModel {
    /// Of residuals, and of no unknown.
    #[must_use]
    pub fn new(residuals: &[f64]) -> LinearModel {
        LinearModel {
            basis: Mat::zeros(residuals.len(), 0),
            residuals: residuals.to_vec(),
            is_known: vec![true; residuals.len()],
        }
    }

    /// With further unknowns, each of which changes the residuals so; what others do as well counts once.
    ///
    /// # Panics
    /// If they have not as many entries, or a residual was left out.
    #[must_use]
    pub fn with(mut self, effects: &[Vec<f64>]) -> LinearModel {
        assert!(self.is_known.iter().all(|known| *known), "what is left out is left out of all of it");
        let mut columns: Vec<Vec<f64>> =
            (0..self.rank()).map(|k| self.basis.col(k).iter().copied().collect()).collect();
        for effect in effects {
            assert_eq!(effect.len(), self.residuals.len(), "a change for each residual");
            let mut own = effect.clone();
            // twice is enough
            for _ in 0..2 {
                columns.iter().for_each(|of| without(&mut own, of));
            }
            let length = product(&own, &own).sqrt();
            if length * length > OWN * product(effect, effect) {
                own.iter_mut().for_each(|x| *x /= length);
                without(&mut self.residuals, &own);
                columns.push(own);
            }
        }
        self.basis = Mat::from_fn(self.residuals.len(), columns.len(), |row, k| columns[k][row]);
        self
    }

    /// How many unknowns it tells apart.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.basis.ncols()
    }

    /// How many residuals it knows.
    #[must_use]
    pub fn count(&self) -> usize {
        self.is_known.iter().filter(|known| **known).count()
    }

    /// How many more these are.
    #[must_use]
    pub fn free(&self) -> usize {
        self.count().saturating_sub(self.rank())
    }

    /// What is left of the residuals that it knows, root of the mean square.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.squares() / self.count().max(1) as f64).sqrt()
    }

    /// The variance of the residuals that it knows; `None` with no more of them than unknowns.
    #[must_use]
    pub fn variance(&self) -> Option<f64> {
        Some(self.free()).filter(|free| *free > 0).map(|free| self.squares() / free as f64)
    }

    /// Of a residual that it knows the share that fitting takes of it, from 0 to 1.
    ///
    /// # Panics
    /// If there is no such residual.
    #[must_use]
    pub fn leverage(&self, row: usize) -> f64 {
        self.basis.row(row).iter().map(|x| x * x).sum()
    }

    /// By how much a residual that is left out differs from what the others predict, and the standard deviation of that.
    ///
    /// # Panics
    /// If there is no such residual, or it is not left out.
    #[must_use]
    pub fn off(&self, row: usize) -> (f64, f64) {
        assert!(!self.is_known[row], "it takes part in what is predicted");
        (self.residuals[row], (self.variance().unwrap_or_default() * (1.0 + self.leverage(row))).sqrt())
    }

    /// What some residuals would be if the fit did not know of them: how well the others predict them. `None` where these do not determine that.
    ///
    /// # Panics
    /// If there is no such residual.
    #[must_use]
    pub fn left_out(&self, rows: &[usize]) -> Option<Vec<f64>> {
        let (_, shares) = self.known_without(rows)?;
        Some(rows.iter().map(|row| self.predicted(*row, &shares)).collect())
    }

    /// Without these residuals. `None` where the others do not determine all unknowns.
    #[must_use]
    pub fn without(&self, rows: &[usize]) -> Option<LinearModel> {
        let (factors, shares) = self.known_without(rows)?;
        let (count, rank) = (self.residuals.len(), self.rank());
        let mut of = DMatrix::from_fn(rank, count, |k, row| self.basis[(row, k)]);
        let residuals = (0..count).map(|row| self.residuals[row] - of.column(row).dot(&shares)).collect();
        factors.l_dirty().solve_lower_triangular_mut(&mut of);
        let mut is_known = self.is_known.clone();
        rows.iter().for_each(|row| is_known[*row] = false);
        Some(LinearModel { basis: Mat::from_fn(count, rank, |row, k| of[(k, row)]), residuals, is_known })
    }

    /// The residuals that do not go with the others, by their places. One after the other is left out that lowers what is left most, or one
    /// of `lines` of them as a whole, where that pays more than as many residuals one by one. Of these, it is those that all others, without any of them,
    /// predict elsewhere: by more than four standard deviations, and by more than `least`.
    #[must_use]
    pub fn outlying(&self, lines: &[Vec<usize>], least: f64) -> Vec<usize> {
        let mut found: Vec<usize> = Vec::new();
        let (mut shown, mut rest) = (0, self.clone());
        let most = self.count() / PART;
        for _ in 0..MOST_LEFT_OUT {
            let mut parts = rest.parts(lines);
            parts.retain(|part| found.len() + part.rows.len() <= most);
            let Some(best) = rest.most_worth(parts) else { break };
            let Some(next) = rest.without(&best.rows) else { break };
            let is_shown = best.sigmas > OUTLYING && best.most > least;
            found.extend(best.rows);
            if is_shown {
                shown = found.len();
            }
            rest = next;
        }
        found.truncate(shown);
        self.confirmed(found, least)
    }

    /// Those that the others, without any of them, predict elsewhere.
    fn confirmed(&self, mut found: Vec<usize>, least: f64) -> Vec<usize> {
        while let Some(rest) = self.without(&found).filter(|_| !found.is_empty()) {
            let free = rest.free();
            let sigmas = |row: usize| match rest.off(row) {
                (off, _) if off.abs() <= least => 0.0,
                (off, deviation) => as_gauss(off.abs() / deviation, free),
            };
            let weakest = found.iter().map(|row| sigmas(*row)).enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            match weakest {
                Some((k, sigmas)) if sigmas <= OUTLYING => _ = found.swap_remove(k),
                _ => break,
            }
        }
        found.sort_unstable();
        found
    }

    /// Each residual, and each line of them, of those that are known.
    fn parts(&self, lines: &[Vec<usize>]) -> Vec<Part> {
        let all = self.squares();
        let single = |row: usize| {
            let (residual, own) = (self.residuals[row], 1.0 - self.leverage(row));
            let is_told = own > OWN;
            is_told.then(|| self.part(vec![row], all - residual * residual / own, (residual / own).abs()))?
        };
        let line = |rows: &Vec<usize>| {
            let rows: Vec<usize> = rows.iter().copied().filter(|row| self.is_known[*row]).collect();
            let (_, shares) = (rows.len() > 1).then(|| self.known_without(&rows))??;
            let off = |row: usize| self.predicted(row, &shares);
            let falls = rows.iter().map(|row| self.residuals[*row] * off(*row)).sum::<f64>();
            let most = rows.iter().map(|row| off(*row).abs()).fold(0.0, f64::max);
            self.part(rows, all - falls, most)
        };
        self.known().filter_map(single).chain(lines.iter().filter_map(line)).collect()
    }

    fn part(&self, rows: Vec<usize>, left: f64, most: f64) -> Option<Part> {
        let free = self.free().checked_sub(rows.len()).filter(|free| *free > 0)?;
        let left = left.max(0.0);
        let sigmas = ((self.squares() - left) / rows.len() as f64 / (left / free as f64)).sqrt();
        Some(Part { rows, left, sigmas: as_gauss(sigmas, free), most })
    }

    /// What lowers the variance of what is left most for as few residuals as can be.
    fn most_worth(&self, parts: Vec<Part>) -> Option<Part> {
        let (count, free) = (self.count() as f64, self.free());
        let cost = |part: &Part| {
            let left = part.left / (free - part.rows.len()) as f64;
            count * left.max(f64::MIN_POSITIVE).ln() + 2.0 * WORTH * part.rows.len() as f64
        };
        parts.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))
    }

    /// What leaving out some residuals changes: the factors of what the others know of the unknowns, and by how much these change. `None` where the
    /// others do not determine all of them.
    fn known_without(&self, rows: &[usize]) -> Option<(Cholesky<f64, Dyn>, DVector<f64>)> {
        let rank = self.rank();
        let known = DMatrix::from_fn(rank, rank, |i, j| {
            f64::from(i == j) - rows.iter().map(|row| self.basis[(*row, i)] * self.basis[(*row, j)]).sum::<f64>()
        });
        let gone = DVector::from_fn(rank, |k, _| {
            -rows.iter().map(|row| self.basis[(*row, k)] * self.residuals[*row]).sum::<f64>()
        });
        let factors = known.cholesky()?;
        let is_determined = rank == 0 || factors.l_dirty().diagonal().min().powi(2) > OWN;
        is_determined.then(|| {
            let shares = factors.solve(&gone);
            (factors, shares)
        })
    }

    /// What a residual is off by where the unknowns change so.
    fn predicted(&self, row: usize, shares: &DVector<f64>) -> f64 {
        self.residuals[row] - (0..self.rank()).map(|k| self.basis[(row, k)] * shares[k]).sum::<f64>()
    }

    fn known(&self) -> impl Iterator<Item = usize> {
        self.is_known.iter().enumerate().filter(|(_, known)| **known).map(|(row, _)| row)
    }

    fn squares(&self) -> f64 {
        self.known().map(|row| self.residuals[row].powi(2)).sum()
    }
}

/// Standard deviations that chance exceeds as often as these, which are by a deviation that so many free residuals tell: Student's distribution by
/// Gauss's, after Wallace.
fn as_gauss(sigmas: f64, free: usize) -> f64 {
    let free = free as f64;
    (8.0 * free + 1.0) / (8.0 * free + 3.0) * (free * (sigmas * sigmas / free).ln_1p()).sqrt()
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn without(of: &mut [f64], unit: &[f64]) {
    let along = product(of, unit);
    of.iter_mut().zip(unit).for_each(|(of, unit)| *of -= along * unit);
}

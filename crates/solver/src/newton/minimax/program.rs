//! The step of a minimax search: a quadratic program, solved from within.
//!
//! Of all steps d that with which t + gᵀ d + ½ dᵀ B d is least, t being the largest amount |rᵢ + Jᵢ d| of the linear model: Mehrotra's
//! predictor and corrector, with a weight for either sign of each function.

use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

/// Iterations at the most; they take 10 to 30.
const MOST: usize = 80;
/// Ends where this is what the largest amount may still be off, of one that is about 1.
const OFF: f64 = 1e-13;
/// How far of the way to where a weight or a distance would be zero.
const SHORT: f64 = 0.995;

/// Functions of the step, and what bends the model.
pub(super) struct Program<'p> {
    pub(super) residuals: &'p [f64],
    pub(super) jacobian: &'p Mat<f64>,
    /// g.
    pub(super) slope: &'p Mat<f64>,
    /// B: positive definite where no function of large weight holds a direction.
    pub(super) bent: &'p Mat<f64>,
}

/// What solves it.
#[derive(Clone, Debug)]
pub(super) struct Solved {
    pub(super) step: Vec<f64>,
    /// Of each function, negative where it counts from below; their amounts add up to 1.
    pub(super) weights: Vec<f64>,
    /// t + gᵀ d + ½ dᵀ B d.
    pub(super) value: f64,
}

/// For each function the two sides: how far it is below the level, and how much that side weighs.
#[derive(Clone)]
struct Sides {
    apart: [Vec<f64>; 2],
    weights: [Vec<f64>; 2],
}

/// A change of step and level, and what it does to the sides.
struct Change {
    step: Mat<f64>,
    level: f64,
    apart: [Vec<f64>; 2],
    weights: [Vec<f64>; 2],
}

const SIGNS: [f64; 2] = [1.0, -1.0];

impl Sides {
    fn count(&self) -> usize {
        self.apart[0].len()
    }

    /// What complementarity is off by, all together.
    fn gap(&self) -> f64 {
        (0..2).map(|s| self.apart[s].iter().zip(&self.weights[s]).map(|(a, w)| a * w).sum::<f64>()).sum()
    }

    fn signed(&self) -> Vec<f64> {
        self.weights[0].iter().zip(&self.weights[1]).map(|(up, down)| up - down).collect()
    }

    fn sum(&self) -> f64 {
        self.weights.iter().flatten().sum()
    }

    /// What share of a change leaves distances and weights positive.
    fn reach(&self, change: &Change) -> f64 {
        let of = |now: &[f64], by: &[f64]| {
            let ends = now.iter().zip(by).filter(|(_, by)| **by < 0.0).map(|(now, by)| -now / by);
            ends.fold(f64::INFINITY, f64::min)
        };
        let each =
            (0..2).flat_map(|s| [of(&self.apart[s], &change.apart[s]), of(&self.weights[s], &change.weights[s])]);
        each.fold(f64::INFINITY, f64::min)
    }

    fn moved(&self, change: &Change, share: f64) -> Sides {
        let moved = |now: &[f64], by: &[f64]| now.iter().zip(by).map(|(now, by)| now + share * by).collect();
        Sides {
            apart: [0, 1].map(|s| moved(&self.apart[s], &change.apart[s])),
            weights: [0, 1].map(|s| moved(&self.weights[s], &change.weights[s])),
        }
    }
}

impl Program<'_> {
    /// `None` where the model has no least value, as a bent that is negative in a direction that no function holds.
    pub(super) fn solve(&self) -> Option<Solved> {
        let (rows, columns) = (self.jacobian.nrows(), self.jacobian.ncols());
        let most = self.residuals.iter().fold(0.0, |most: f64, of| most.max(of.abs()));
        let mut step = Mat::<f64>::zeros(columns, 1);
        let mut level = 1.1 * most;
        let even = 0.5 / rows as f64;
        let mut sides = Sides {
            apart: SIGNS.map(|sign| self.residuals.iter().map(|of| level - sign * of).collect()),
            weights: [vec![even; rows], vec![even; rows]],
        };
        for _ in 0..MOST {
            let off = self.off(&step, &sides);
            let farthest = off.col(0).iter().fold(0.0, |most: f64, of| most.max(of.abs()));
            if sides.gap() < OFF * level && farthest < OFF.sqrt() {
                break;
            }
            let change = self.change(&off, &sides)?;
            let share = (SHORT * sides.reach(&change)).min(1.0);
            step += &change.step * faer::Scale(share);
            level += share * change.level;
            sides = sides.moved(&change, share);
            if share < 1e-10 {
                break;
            }
        }
        let bend = (step.transpose() * self.bent * &step)[(0, 0)];
        let value = level + 0.5 * bend + (self.slope.transpose() * &step)[(0, 0)];
        value.is_finite().then(|| Solved {
            step: step.col(0).iter().copied().collect(),
            weights: sides.signed(),
            value,
        })
    }

    /// What is to be zero: the slope of the Lagrangian by the step, and last by the level.
    fn off(&self, step: &Mat<f64>, sides: &Sides) -> Mat<f64> {
        let signed = sides.signed();
        let slope = self.slope + self.bent * step + self.jacobian.transpose() * column(&signed);
        let columns = step.nrows();
        Mat::from_fn(columns + 1, 1, |k, _| if k < columns { slope[(k, 0)] } else { 1.0 - sides.sum() })
    }

    /// Towards the solution, as Mehrotra has it: first without a barrier, which says how strong the barrier and what the second order is.
    fn change(&self, off: &Mat<f64>, sides: &Sides) -> Option<Change> {
        let factors = self.factors(sides)?;
        let count = 2 * sides.count();
        let nothing = || [vec![0.0; sides.count()], vec![0.0; sides.count()]];
        let first = self.solved(&factors, off, sides, &nothing());
        let (gap, ahead) = (sides.gap(), sides.moved(&first, sides.reach(&first).min(1.0)).gap());
        let barrier = (ahead / gap).powi(3) * gap / count as f64;
        let wanted = [0, 1].map(|s| {
            let both = first.apart[s].iter().zip(&first.weights[s]);
            both.map(|(apart, weight)| barrier - apart * weight).collect::<Vec<f64>>()
        });
        Some(self.solved(&factors, off, sides, &wanted))
    }

    fn factors(&self, sides: &Sides) -> Option<Llt<f64>> {
        let (rows, columns) = (self.jacobian.nrows(), self.jacobian.ncols());
        let stiff = |row: usize| {
            SIGNS.map(|sign| {
                let s = usize::from(sign < 0.0);
                sides.weights[s][row] / sides.apart[s][row]
            })
        };
        let stiff: Vec<[f64; 2]> = (0..rows).map(stiff).collect();
        // a row and a column more for the level, which both sides hold
        let weighted = Mat::from_fn(rows, columns + 1, |row, k| {
            let [up, down] = stiff[row];
            if k < columns { (up + down) * self.jacobian[(row, k)] } else { down - up }
        });
        let lower = self.jacobian.transpose() * &weighted;
        let level: f64 = stiff.iter().map(|[up, down]| up + down).sum();
        let system = Mat::from_fn(columns + 1, columns + 1, |i, j| match (i < columns, j < columns) {
            (true, true) => self.bent[(i, j)] + lower[(i, j)],
            (true, false) => lower[(i, columns)],
            (false, true) => lower[(j, columns)],
            (false, false) => level,
        });
        Llt::new(system.as_ref(), Side::Lower).ok()
    }

    /// With distances times weights brought to what is wanted.
    fn solved(&self, factors: &Llt<f64>, off: &Mat<f64>, sides: &Sides, wanted: &[Vec<f64>; 2]) -> Change {
        let (rows, columns) = (sides.count(), self.jacobian.ncols());
        let held = [0, 1].map(|s| {
            let each = (0..rows).map(|k| wanted[s][k] / sides.apart[s][k] - sides.weights[s][k]);
            each.collect::<Vec<f64>>()
        });
        let signed: Vec<f64> = held[0].iter().zip(&held[1]).map(|(up, down)| up - down).collect();
        let by_step = self.jacobian.transpose() * column(&signed);
        let sum: f64 = held.iter().flatten().sum();
        let right =
            Mat::from_fn(
                columns + 1,
                1,
                |k, _| {
                    if k < columns { -off[(k, 0)] - by_step[(k, 0)] } else { -off[(k, 0)] + sum }
                },
            );
        let found = factors.solve(&right);
        let (step, level) = (found.subrows(0, columns).to_owned(), found[(columns, 0)]);
        let moved = self.jacobian * &step;
        let apart = SIGNS.map(|sign| (0..rows).map(|k| level - sign * moved[(k, 0)]).collect::<Vec<f64>>());
        let weights = [0, 1].map(|s| {
            let each = (0..rows).map(|k| held[s][k] - sides.weights[s][k] / sides.apart[s][k] * apart[s][k]);
            each.collect()
        });
        Change { step, level, apart, weights }
    }
}

fn column(of: &[f64]) -> Mat<f64> {
    Mat::from_fn(of.len(), 1, |k, _| of[k])
}

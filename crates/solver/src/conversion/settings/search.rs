//! Settings and poses by least squares, from starts all over the ranges.

use std::f64::consts::{PI, TAU};

use faer::Mat;
use flank_expr::{ScalarEvaluator, Tape};
use rayon::prelude::*;

use super::{SettingBounds, SettingKind, SettingsFit};
use crate::equations::solution::Range;
use crate::newton::least_squares::{LeastSquares, LeastSquaresFit, Linearized, ScaledUnknown};
use crate::newton::multistart::probe;

/// Rows of a pose's deviation: three displacements, nine entries of a rotation.
const ROWS: usize = 12;
/// Poses on which starts are tried; more of them only make each step dearer.
const FEW: usize = 5;
/// Starts that are tried together.
const BATCH: u32 = 32;
/// So many ends with the same sum of squares, up to a share of it, are no chance.
const AGREEING: usize = 4;
const SAME_END: f64 = 1e-6;
/// A step by less, of the reach or in radians, comes near an end: the one after it leaves rounding alone.
const NEAR: f64 = 1e-7;
/// What loses less than a thousandth of the sum of squares in a step creeps.
const CREEPS: f64 = 0.999;
/// A deviation, of the reach or in radians, that is rounding.
const EXACT: f64 = 1e-12;
/// A setting that is outside its range by less than this share of it, of the reach at most, is on its end: poses that are met to
/// [`EXACT`] leave a setting that moves them a thousandth as much as others uncertain by so much.
const WITHIN: f64 = 1e-9;
/// Numbers are looked for up to this size: ratios and coefficients of machines are smaller.
const LARGE: f64 = 1e3;
/// A direction in the settings that changes the poses by less than this share of what others do is not determined.
const UNSEEN: f64 = 1e-9;
/// A share of such a direction that is more than rounding.
const SHARE: f64 = 1e-6;

/// The numbers of a [`SettingsProblem`](super::SettingsProblem).
#[derive(Clone, Debug)]
pub(super) struct Search {
    pub(super) settings: Vec<SettingBounds>,
    /// Of what moves.
    pub(super) is_rotary: Vec<bool>,
    /// Of settings, what moves, and the source's motions: rows of the deviation, then their derivatives by the first two.
    pub(super) tape: Tape,
    /// As far as the poses reach, mm.
    pub(super) reach: f64,
    /// Starts after which the nearest is taken.
    pub(super) starts: u32,
}

/// Unknowns of several poses and the sum of squares that they leave.
#[derive(Clone)]
struct State {
    settings: Vec<f64>,
    moving: Vec<Vec<f64>>,
    cost: f64,
}

impl State {
    /// With other values of the free settings, then of what moves in each pose.
    fn with(&self, values: &[f64], free: &[usize]) -> State {
        let (own, moving) = values.split_at(free.len());
        let mut next = self.clone();
        free.iter().zip(own).for_each(|(k, value)| next.settings[*k] = *value);
        next.moving.iter_mut().flatten().zip(moving).for_each(|(of, value)| *of = *value);
        next
    }
}

impl Search {
    pub(super) fn fit(&self, motions: &[Vec<f64>]) -> SettingsFit {
        let mut held = vec![None; self.settings.len()];
        let best = self.search(motions, &held);
        let unseen = self.unseen(&best, motions);
        let loose = self.loose(unseen.clone());
        if loose.is_empty() {
            return self.told(best, motions, Vec::new());
        }
        loose.iter().for_each(|&k| held[k] = Some(self.settings[k].usual.unwrap_or(best.settings[k])));
        let settled = self.search(motions, &held);
        // what makes no difference there may make one elsewhere
        let is_as_good = settled.cost <= best.cost.max(self.rounding(motions.len()));
        let (told, unseen) = if is_as_good {
            let unseen = self.unseen(&settled, motions);
            (settled, unseen)
        } else {
            (best, unseen)
        };
        let has_share = |k: &usize| loose.contains(k) || unseen.iter().any(|of| of[*k].abs() > SHARE);
        let undetermined = (0..self.settings.len()).filter(has_share).collect();
        self.told(told, motions, undetermined)
    }

    pub(super) fn stand(&self, settings: &[f64], motions: &[f64], near: &[f64]) -> Vec<f64> {
        let start = State { settings: settings.to_vec(), moving: vec![near.to_vec()], cost: f64::INFINITY };
        let held: Vec<Option<f64>> = settings.iter().map(|x| Some(*x)).collect();
        self.descend(start, &[motions.to_vec()], &held, EXACT).moving.swap_remove(0)
    }

    /// The best end of descents from starts all over the ranges, on a few poses first; but for the settings that are held.
    fn search(&self, motions: &[Vec<f64>], held: &[Option<f64>]) -> State {
        let few = spread(motions, FEW);
        let (mut ends, mut exact): (Vec<State>, Vec<State>) = (Vec::new(), Vec::new());
        for before in (0..self.starts).step_by(BATCH as usize) {
            let starts = (before + 1..=self.starts.min(before.saturating_add(BATCH))).into_par_iter();
            let found: Vec<State> = starts.map(|k| self.descend(self.start(k, &few, held), &few, held, NEAR)).collect();
            let is_exact = |end: &&State| end.cost <= self.rounding(few.len());
            exact.extend(found.iter().filter(is_exact).map(|end| self.widened(end.clone(), motions, held)));
            exact.sort_by(|a, b| self.rank(a, motions.len()).total_cmp(&self.rank(b, motions.len())));
            if let Some(best) = exact.first().filter(|best| self.is_good(best, motions.len())) {
                return self.nearest(best.clone(), motions, held);
            }
            ends.extend(found);
            ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            // what several starts lead to is the nearest that there is
            if exact.is_empty()
                && ends.iter().take_while(|end| end.cost <= ends[0].cost * (1.0 + SAME_END)).count() >= AGREEING
            {
                break;
            }
        }
        // of those that are as near, mirror images among them, one within the ranges
        let mut nearest = ends.iter().take_while(|end| end.cost <= ends[0].cost * (1.0 + SAME_END));
        let nearest = nearest.find(|end| self.is_within(end)).unwrap_or(&ends[0]);
        exact.into_iter().next().unwrap_or_else(|| self.widened(nearest.clone(), motions, held))
    }

    /// Of what does the same with an angle half a turn further on, as a swivel and a tilt the other way do, the nearest to what is usual.
    fn nearest(&self, mut best: State, motions: &[Vec<f64>], held: &[Option<f64>]) -> State {
        let is_open = |k: &usize| held[*k].is_none() && self.settings[*k].kind == SettingKind::Angle;
        let angles: Vec<usize> = (0..held.len()).filter(is_open).collect();
        let spins = || (0..self.is_rotary.len()).filter(|k| self.is_rotary[*k]).map(Some);
        let turns: Vec<(usize, Option<usize>)> =
            angles.iter().flat_map(|k| [None].into_iter().chain(spins()).map(|spin| (*k, spin))).collect();
        for _ in 0..angles.len() {
            let turned = turns.par_iter().map(|(k, spin)| {
                let mut state = best.clone();
                state.settings[*k] += PI;
                spin.iter().for_each(|spin| state.moving.iter_mut().for_each(|moving| moving[*spin] += PI));
                self.unwound(self.descend(state, motions, held, EXACT), motions)
            });
            let turned: Vec<State> = turned.filter(|state| self.is_good(state, motions.len())).collect();
            let rank = |state: &State| self.rank(state, motions.len());
            let Some(other) = turned.into_iter().min_by(|a, b| rank(a).total_cmp(&rank(b))) else { break };
            if rank(&other) >= rank(&best) * (1.0 - SAME_END) {
                break;
            }
            best = other;
        }
        best
    }

    /// From a few poses to all.
    fn widened(&self, few: State, motions: &[Vec<f64>], held: &[Option<f64>]) -> State {
        let last = few.moving.len() - 1;
        let near = |k: usize| few.moving[(k * last + (motions.len() - 1) / 2) / (motions.len() - 1).max(1)].clone();
        let moving = motions.iter().enumerate().map(|(k, at)| self.stand(&few.settings, at, &near(k))).collect();
        let state = self.descend(State { moving, settings: few.settings, cost: f64::INFINITY }, motions, held, EXACT);
        self.unwound(state, motions)
    }

    /// Angles without whole turns, and rotary axes without jumps of whole turns, where these make no difference.
    fn unwound(&self, state: State, motions: &[Vec<f64>]) -> State {
        let whole = |angle: f64| (angle / TAU).round() * TAU;
        let mut settings = state.settings.clone();
        for (value, _) in settings.iter_mut().zip(&self.settings).filter(|(_, s)| s.kind == SettingKind::Angle) {
            *value -= whole(*value);
        }
        let state = self.kept(State { settings, ..state.clone() }, state, motions);
        let mut moving = state.moving.clone();
        let middle = moving.len() / 2;
        for k in (0..self.is_rotary.len()).filter(|k| self.is_rotary[*k]) {
            moving[middle][k] -= whole(moving[middle][k]);
            for pose in middle + 1..moving.len() {
                moving[pose][k] -= whole(moving[pose][k] - moving[pose - 1][k]);
            }
            for pose in (0..middle).rev() {
                moving[pose][k] -= whole(moving[pose][k] - moving[pose + 1][k]);
            }
        }
        self.kept(State { moving, ..state.clone() }, state, motions)
    }

    /// A state that is told otherwise, unless it leaves more of the poses.
    fn kept(&self, otherwise: State, state: State, motions: &[Vec<f64>]) -> State {
        let cost = self.cost(&otherwise.settings, &otherwise.moving, motions);
        let same = (state.cost * (1.0 + SAME_END)).max(self.rounding(motions.len()));
        if cost <= same { State { cost, ..otherwise } } else { state }
    }

    fn start(&self, k: u32, motions: &[Vec<f64>], held: &[Option<f64>]) -> State {
        let unit = Range { low: 0.0, high: 1.0 };
        let shares = probe(&vec![unit; self.settings.len() + self.is_rotary.len()], k);
        let values = self.settings.iter().zip(&shares).zip(held);
        let settings = values
            .map(|((setting, share), held)| held.unwrap_or_else(|| somewhere(setting, self.reach, *share)))
            .collect();
        // what moves may do so at about the pace of the motion, one way or the other
        let middle = &motions[motions.len() / 2];
        let paces: Vec<f64> = shares[self.settings.len()..].iter().map(|share| 4.0 * share - 2.0).collect();
        let moving = |at: &Vec<f64>| paces.iter().map(|pace| pace * (at[0] - middle[0])).collect();
        State { settings, moving: motions.iter().map(moving).collect(), cost: f64::INFINITY }
    }

    /// Settings and poses together, but for the settings that are held.
    fn descend(&self, start: State, motions: &[Vec<f64>], held: &[Option<f64>], settled: f64) -> State {
        let free: Vec<usize> = (0..held.len()).filter(|k| held[*k].is_none()).collect();
        let found = self.solved(&start, motions, &free, settled);
        let found = found.map(|fit| {
            let cost = fit.residuals.iter().map(|off| off * off).sum();
            State { cost, ..start.with(&fit.values, &free) }
        });
        found.unwrap_or(State { cost: f64::INFINITY, ..start })
    }

    /// By least squares of what the poses are off, in the free settings and then in what moves in each pose.
    fn solved(&self, start: &State, motions: &[Vec<f64>], free: &[usize], settled: f64) -> Option<LeastSquaresFit> {
        let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let unknown = |start: f64, scale: f64| ScaledUnknown { start, scale, range: everywhere };
        let settings = free.iter().map(|k| unknown(start.settings[*k], self.scale(*k)));
        let moving = start.moving.iter().flatten().enumerate();
        let moving = moving.map(|(k, at)| unknown(*at, self.moving_scale(k % self.is_rotary.len())));
        let unknowns = settings.chain(moving).collect();
        let problem =
            LeastSquares { unknowns, exact: 0, resolution: 0.0, uses_weak: false, settled, given_up: Some(CREEPS) };
        let mut evaluator = ScalarEvaluator::new(&self.tape);
        let mut out = vec![0.0; self.tape.output_count()];
        problem.solve(|values| {
            let at = start.with(values, free);
            Some(self.linearized((&mut evaluator, &mut out), &at, motions, free))
        })
    }

    fn linearized(
        &self,
        (evaluator, out): (&mut ScalarEvaluator<'_>, &mut [f64]),
        state: &State,
        motions: &[Vec<f64>],
        free: &[usize],
    ) -> Linearized {
        let (own, of_each) = (free.len(), self.is_rotary.len());
        let mut jacobian = Mat::zeros(ROWS * motions.len(), own + of_each * motions.len());
        let mut residuals = Vec::with_capacity(ROWS * motions.len());
        let unknowns = self.settings.len() + of_each;
        for (pose, (moving, at)) in state.moving.iter().zip(motions).enumerate() {
            evaluator.run(&[&state.settings[..], moving, at].concat(), out);
            for row in 0..ROWS {
                let slope = |k: usize| out[ROWS + row * unknowns + k];
                residuals.push(out[row]);
                free.iter().enumerate().for_each(|(column, &k)| jacobian[(ROWS * pose + row, column)] = slope(k));
                for k in 0..of_each {
                    jacobian[(ROWS * pose + row, own + of_each * pose + k)] = slope(self.settings.len() + k);
                }
            }
        }
        Linearized { residuals, jacobian }
    }

    fn cost(&self, settings: &[f64], moving: &[Vec<f64>], motions: &[Vec<f64>]) -> f64 {
        let mut out = vec![0.0; self.tape.output_count()];
        let mut evaluator = ScalarEvaluator::new(&self.tape);
        let each = moving.iter().zip(motions).map(|(moving, at)| {
            evaluator.run(&[settings, moving, at].concat(), &mut out);
            out[..ROWS].iter().map(|x| x * x).sum::<f64>()
        });
        each.sum()
    }

    /// A change that counts as much as others.
    fn scale(&self, setting: usize) -> f64 {
        if self.settings[setting].kind == SettingKind::Length { self.reach } else { 1.0 }
    }

    fn moving_scale(&self, k: usize) -> f64 {
        if self.is_rotary[k] { 1.0 } else { self.reach }
    }

    /// The sum of squares of so many poses that rounding makes.
    fn rounding(&self, poses: usize) -> f64 {
        (ROWS * poses) as f64 * EXACT.powi(2)
    }

    fn is_good(&self, state: &State, poses: usize) -> bool {
        state.cost <= self.rounding(poses) && self.is_within(state)
    }

    fn is_within(&self, state: &State) -> bool {
        let margin = |range: Range| WITHIN * range.width().min(self.reach);
        self.settings.iter().zip(&state.settings).all(|(s, x)| s.range.excess(*x) <= margin(s.range))
    }

    /// Less is better: the deviation, then ranges, then what is usual.
    fn rank(&self, state: &State, poses: usize) -> f64 {
        let unusual = |(k, (setting, x)): (usize, (&SettingBounds, &f64))| {
            ((x - setting.usual.unwrap_or(0.0)) / self.scale(k)).powi(2).min(1e6)
        };
        let unusual: f64 = self.settings.iter().zip(&state.settings).enumerate().map(unusual).sum();
        let beyond = if self.is_within(state) { 0.0 } else { 1e12 };
        let off = (state.cost / self.rounding(poses)).max(1.0) - 1.0;
        1e18 * off + beyond + unusual
    }

    /// The directions in which settings can change together without changing the poses.
    fn unseen(&self, state: &State, motions: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let all: Vec<usize> = (0..self.settings.len()).collect();
        let Some(fit) = self.solved(state, motions, &all, EXACT) else { return Vec::new() };
        let largest = fit.directions.first().map_or(0.0, |of| of.size);
        let unseen = fit.directions.iter().filter(|of| of.size <= UNSEEN * largest);
        unseen.map(|of| of.shares[..all.len()].to_vec()).collect()
    }

    /// As few settings as fix all others, with the directions that the poses do not see: those with a usual value first.
    fn loose(&self, mut directions: Vec<Vec<f64>>) -> Vec<usize> {
        let mut loose = Vec::new();
        // Gauss and Jordan: each direction gives up the setting that is easiest to settle
        while let Some((row, pivot)) = self.pivot(&directions, &loose) {
            let leading = directions.swap_remove(row);
            for other in &mut directions {
                let factor = other[pivot] / leading[pivot];
                other.iter_mut().zip(&leading).for_each(|(x, by)| *x -= factor * by);
            }
            loose.push(pivot);
        }
        loose.sort_unstable();
        loose
    }

    /// The direction and the setting to be settled next.
    fn pivot(&self, directions: &[Vec<f64>], settled: &[usize]) -> Option<(usize, usize)> {
        let open = (0..self.settings.len()).filter(|k| !settled.contains(k));
        let candidates = open.flat_map(|k| directions.iter().enumerate().map(move |(row, d)| (row, k, d[k].abs())));
        let seen = candidates.filter(|(.., share)| *share > SHARE);
        let weight = |k: usize, share: f64| if self.settings[k].usual.is_some() { 1.0 + share } else { share };
        seen.max_by(|a, b| weight(a.1, a.2).total_cmp(&weight(b.1, b.2))).map(|(row, k, _)| (row, k))
    }

    fn told(&self, state: State, motions: &[Vec<f64>], undetermined: Vec<usize>) -> SettingsFit {
        let mut out = vec![0.0; self.tape.output_count()];
        let mut evaluator = ScalarEvaluator::new(&self.tape);
        let (mut displacement, mut turn): (f64, f64) = (0.0, 0.0);
        for (moving, at) in state.moving.iter().zip(motions) {
            evaluator.run(&[&state.settings[..], moving, at].concat(), &mut out);
            let size = |rows: &[f64]| rows.iter().map(|x| x * x).sum::<f64>().sqrt();
            displacement = displacement.max(size(&out[..3]) * self.reach);
            // |R − 1| = √8 sin(φ / 2) for a rotation by φ
            turn = turn.max(2.0 * (size(&out[3..ROWS]) / 8f64.sqrt()).min(1.0).asin());
        }
        let is_exact = state.cost <= self.rounding(motions.len());
        SettingsFit { settings: state.settings, undetermined, moving: state.moving, displacement, turn, is_exact }
    }
}

/// A value for a start: at a share of where a setting is looked for, lengths as far as `reach` from zero, mm.
fn somewhere(setting: &SettingBounds, reach: f64, share: f64) -> f64 {
    match setting.kind {
        SettingKind::Length => setting.range.near_zero(reach).at(share),
        SettingKind::Angle => setting.range.near_zero(std::f64::consts::PI).at(share),
        // numbers are as often around one as around ten
        SettingKind::Number => {
            let Range { low, high } = setting.range.near_zero(LARGE);
            Range { low: low.asinh(), high: high.asinh() }.at(share).sinh()
        }
    }
}

/// A few of the positions, ends and middle among them.
fn spread(motions: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    if motions.len() <= count {
        return motions.to_vec();
    }
    (0..count).map(|k| motions[k * (motions.len() - 1) / (count - 1)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_spread_over_the_range_wherever_it_lies() {
        for kind in [SettingKind::Length, SettingKind::Angle, SettingKind::Number] {
            for (low, high) in [(2e3, 5e3), (-5e3, -2e3), (0.5, 0.7), (-1.0, 2e4), (4.0, 5.0), (2e3, f64::INFINITY)] {
                let sought = SettingBounds { kind, range: Range { low, high }, usual: None };
                let starts: Vec<f64> = (0..=10).map(|k| somewhere(&sought, 100.0, f64::from(k) / 10.0)).collect();
                // arsinh and sinh take a few roundings
                let is_within = |x: &f64| sought.range.excess(*x) <= 1e-12 * x.abs();
                assert!(starts.iter().all(is_within), "{kind:?} {low} .. {high}: {starts:?}");
                assert!(starts.windows(2).all(|pair| pair[0] < pair[1]), "{kind:?} {low} .. {high}: {starts:?}");
            }
        }
    }
}

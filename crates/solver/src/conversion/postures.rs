//! Of all ways in which a machine can stand, the one that stays within its travels.

use std::f64::consts::TAU;

use crate::conversion::poses::{PoseProblem, Posture};
use crate::equations::solution::{Outcome, ROUNDING, distance};
use crate::newton::scalar::solve_with;

/// A posture stands elsewhere if it does so by more than this share of the ranges.
const SAME: f64 = 1e-6;

impl PoseProblem<'_> {
    /// Postures along several walks of the motions that begin at `start`: from one of [`PoseProblem::postures`] there, or one that is
    /// whole turns away from it, the first with which all axes stay within their travels all the way; if there is none, that which is the
    /// least beyond them. Without walks that begin anywhere there are none.
    pub fn walks(&self, start: &[f64], walks: &[Vec<Vec<f64>>]) -> Vec<Vec<Posture>> {
        let mut best: Option<(f64, Vec<Vec<Posture>>)> = None;
        let mut take = |lines: Vec<Vec<Posture>>| -> bool {
            let off = self.off(&lines);
            if best.as_ref().is_none_or(|(least, _)| off < *least) {
                best = Some((off, lines));
            }
            off == 0.0
        };
        for first in self.postures(start) {
            let lines = self.lines(&first, walks);
            let turned = self.turned(&first, &lines, start);
            if take(lines) || turned.is_some_and(|first| take(self.lines(&first, walks))) {
                break;
            }
        }
        best.map_or(Vec::new(), |(_, lines)| lines)
    }

    fn lines(&self, first: &Posture, walks: &[Vec<Vec<f64>>]) -> Vec<Vec<Posture>> {
        walks.iter().map(|walk| self.follow(first, walk)).collect()
    }

    /// Less is better: the postures that are none, then how far axes are beyond their travels at the most, as a share of them.
    fn off(&self, lines: &[Vec<Posture>]) -> f64 {
        let is_met = |posture: &&Posture| {
            matches!(posture.outcome, Outcome::Solved | Outcome::Outside { .. }) && posture.missing.is_none()
        };
        let lost = lines.iter().flatten().filter(|posture| !is_met(posture)).count();
        let beyond = (0..self.travels().len()).map(|axis| {
            let travel = self.travels()[axis];
            let [low, high] = extent(lines, axis);
            let by = travel.excess(low).max(travel.excess(high)) / travel.width();
            if by > ROUNDING { by } else { 0.0 }
        });
        let most = beyond.fold(0.0, f64::max);
        // a share is as large as it likes, and never as bad as a posture that is none
        lost as f64 + most / (1.0 + most)
    }

    /// The posture with the axes that go beyond their travels whole turns nearer to their middles, if it is one.
    fn turned(&self, first: &Posture, lines: &[Vec<Posture>], start: &[f64]) -> Option<Posture> {
        let mut unknowns = first.unknowns().to_vec();
        for (axis, travel) in self.travels().iter().enumerate().filter(|(axis, _)| self.is_rotary(*axis)) {
            let [low, high] = extent(lines, axis);
            if travel.excess(low).max(travel.excess(high)) > ROUNDING * travel.width() {
                unknowns[axis] += ((travel.middle() - 0.5 * (low + high)) / TAU).round() * TAU;
            }
        }
        let moved = |by: &[f64]| distance(by, &unknowns, self.widths());
        if moved(first.unknowns()) <= SAME {
            return None;
        }
        let solution = solve_with(&mut self.system().evaluation(start), &self.wide(), &unknowns);
        // an axis that is no plain turn stands elsewhere, or nowhere
        (solution.is_solved() && moved(&solution.unknowns) <= SAME).then(|| self.posture(start, solution))
    }
}

fn extent(lines: &[Vec<Posture>], axis: usize) -> [f64; 2] {
    let values = lines.iter().flatten().map(|posture| posture.axes[axis]);
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

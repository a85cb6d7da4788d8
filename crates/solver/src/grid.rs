//! Grids of points: one is looked for, the others follow from neighbour to neighbour.

use std::collections::VecDeque;

use crate::Outcome;
use crate::newton::solve_with;
use crate::solution::{Range, Solution, distance};
use crate::start::{Scan, roots};
use crate::system::{Evaluation, System};

/// How widely the anchor of a grid is looked for.
const ANCHOR: Scan = Scan { probes: 1024, starts: 64 };
/// Points that are tried as the anchor before a grid is taken for unsolvable.
const MOST_ANCHORS: usize = 9;
/// Parts into which the way to a neighbour is divided where one step is too long.
const SUBSTEPS: [u32; 3] = [1, 4, 16];
/// A corrected point may lie this share of the tangent's length from where the tangent leads; beyond, it may be on another
/// branch, and the step is divided. The last step to where a branch turns back like a parabola has one.
const ASTRAY: f64 = 0.75;
/// Distances below this share of the ranges are never a jump.
const NEAR: f64 = 1e-3;

/// What a grid cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Evaluations of residuals with Jacobian.
    pub evaluations: u64,
    /// Roots that were found in the ranges at the anchor; more than one means that the ranges hold several branches. The
    /// one that reaches the most points was taken, of several such the one nearest the middle of the ranges.
    pub branches: u32,
}

/// Solves the system at each pair of targets of a grid (row by row); every point gets a verdict.
///
/// The system's parameters are the two targets. One point, the anchor, is looked for in the whole of the ranges, the middle
/// of the grid first; each solved point then is the start for its neighbours, in steps short enough to stay on the branch.
/// So all points lie on one branch; a point where that branch leaves the ranges is outside, even if another branch has a
/// point there.
///
/// # Panics
/// If there are not `counts[0] · counts[1]` targets.
pub fn solve_grid(
    system: &System,
    ranges: &[Range],
    targets: &[[f64; 2]],
    counts: [usize; 2],
) -> (Vec<Solution>, Effort) {
    assert_eq!(targets.len(), counts[0] * counts[1], "one target for each point of the grid");
    let mut grid = Grid {
        evaluation: system.evaluation(&[0.0; 2]),
        ranges,
        targets,
        rows: counts[0],
        columns: counts[1],
        effort: Effort::default(),
    };
    let order = grid.middle_first();
    let mut failures: Vec<Option<Solution>> = vec![None; targets.len()];
    for &anchor in order.iter().step_by((order.len() / MOST_ANCHORS).max(1)) {
        let found = grid.look_for(anchor);
        grid.effort.branches = found.iter().filter(|root| root.outcome == Outcome::Solved).count() as u32;
        if grid.effort.branches == 0 {
            failures[anchor] = found.into_iter().next();
            continue;
        }
        let best = grid.best_filling(anchor, found);
        return (grid.completed(best), grid.effort);
    }
    (grid.completed(failures), grid.effort)
}

struct Grid<'s> {
    evaluation: Evaluation<'s>,
    ranges: &'s [Range],
    targets: &'s [[f64; 2]],
    rows: usize,
    columns: usize,
    effort: Effort,
}

impl Grid<'_> {
    /// All points, the ones near the middle first.
    fn middle_first(&self) -> Vec<usize> {
        let distance = |point: usize| {
            let (i, j) = (point / self.columns, point % self.columns);
            let across = |k: usize, count: usize| (2 * k).abs_diff(count - 1) * 1000 / count.max(2);
            (across(i, self.rows).max(across(j, self.columns)), point)
        };
        let mut order: Vec<usize> = (0..self.targets.len()).collect();
        order.sort_by_key(|&point| distance(point));
        order
    }

    fn look_for(&mut self, point: usize) -> Vec<Solution> {
        self.evaluation.set_parameters(&self.targets[point]);
        let (found, evaluations) = roots(&mut self.evaluation, self.ranges, ANCHOR);
        self.effort.evaluations += evaluations;
        found
    }

    /// The filling that reaches the most points; of several such, the one whose root lies nearest the middle of the ranges:
    /// which branch is taken depends on the ranges, not on the order in which a scan finds roots.
    fn best_filling(&mut self, anchor: usize, mut roots: Vec<Solution>) -> Vec<Option<Solution>> {
        let middle: Vec<f64> = self.ranges.iter().map(|range| range.middle()).collect();
        let off = |root: &Solution| distance(&root.unknowns, &middle, self.ranges);
        roots.sort_by(|a, b| off(a).total_cmp(&off(b)));
        let (mut best, mut most) = (Vec::new(), 0);
        for root in roots {
            let filling = self.fill(anchor, root);
            let solved = filling.iter().flatten().filter(|point| point.is_solved()).count();
            if solved > most {
                (best, most) = (filling, solved);
            }
            if most == self.targets.len() {
                break;
            }
        }
        best
    }

    /// Everything that can be reached from the anchor, ring by ring; what is not reached stays `None`.
    fn fill(&mut self, anchor: usize, root: Solution) -> Vec<Option<Solution>> {
        let mut found: Vec<Option<Solution>> = vec![None; self.targets.len()];
        found[anchor] = Some(root);
        let mut queue = VecDeque::from([anchor]);
        while let Some(point) = queue.pop_front() {
            let (i, j) = ((point / self.columns) as isize, (point % self.columns) as isize);
            for (di, dj) in [(0, 1), (0, -1), (1, 0), (-1, 0)] {
                let Some(next) = self.index(i + di, j + dj) else {
                    continue;
                };
                if found[next].as_ref().is_some_and(Solution::is_root) {
                    continue;
                }
                let far = self.index(i - di, j - dj).and_then(|far| found[far].as_ref()).filter(|far| far.is_root());
                let Some(near) = &found[point] else { continue };
                let near = near.unknowns.clone();
                let start = extrapolated(&near, far.map(|far| &far.unknowns[..]));
                let solution = self.step(point, next, &near, &start);
                let is_root = solution.is_root();
                found[next] = Some(match found[next].take() {
                    Some(earlier) => earlier.better(solution),
                    None => solution,
                });
                if is_root {
                    queue.push_back(next);
                }
            }
        }
        found
    }

    fn index(&self, i: isize, j: isize) -> Option<usize> {
        let inside = (0..self.rows as isize).contains(&i) && (0..self.columns as isize).contains(&j);
        inside.then(|| i as usize * self.columns + j as usize)
    }

    /// From a solved point to its neighbour: at once from a good start, else in ever shorter steps along the way.
    fn step(&mut self, from: usize, to: usize, near: &[f64], start: &[f64]) -> Solution {
        let (a, b) = (self.targets[from], self.targets[to]);
        let mut last = None;
        for parts in SUBSTEPS {
            let (mut at, mut reached) = (near.to_vec(), a);
            // straight on as before: where branches cross, the way leads across
            let first_step = |(near, start): (&f64, &f64)| near + (start - near) / f64::from(parts);
            let mut first: Vec<f64> = near.iter().zip(start).map(first_step).collect();
            let mut stepped = None;
            for part in 1..=parts {
                let share = f64::from(part) / f64::from(parts);
                let target = if part == parts { b } else { [0, 1].map(|k| a[k] + (b[k] - a[k]) * share) };
                self.evaluation.set_parameters(&target);
                let solution = solve_with(&mut self.evaluation, self.ranges, &first);
                self.effort.evaluations += u64::from(solution.iterations);
                let stays = solution.is_root() && self.stays_near([&at, &solution.unknowns], [&reached, &target]);
                first = extrapolated(&solution.unknowns, Some(&at));
                at.clone_from(&solution.unknowns);
                reached = target;
                stepped = Some((solution, stays));
                if !stays {
                    break;
                }
            }
            match stepped {
                Some((solution, true)) => return solution,
                Some((solution, false)) => last = Some(solution),
                None => {}
            }
        }
        let mut lost = last.unwrap_or_else(|| Solution::never_reached(self.ranges));
        if lost.is_root() {
            // a root, but not one that the way leads to, or not of this target: its residual would mislead
            lost.outcome = Outcome::NotConverged;
            lost.residual = f64::NAN;
        }
        lost
    }

    /// Whether the tangents at both of two solved points lead to the other one. One tangent is not enough: where branches
    /// cross or turn back it allows any step.
    fn stays_near(&mut self, points: [&[f64]; 2], targets: [&[f64; 2]; 2]) -> bool {
        distance(points[0], points[1], self.ranges) <= NEAR
            || (0..2).all(|k| {
                self.evaluation.set_parameters(targets[1 - k]);
                self.evaluation.at(points[k]);
                self.effort.evaluations += 1;
                let led = self.evaluation.tangent_point(self.ranges);
                let allowed = ASTRAY * distance(points[k], &led, self.ranges) + NEAR;
                distance(&led, points[1 - k], self.ranges) <= allowed
            })
    }

    /// A verdict for every point: those that nothing leads to are not converged.
    fn completed(&self, found: Vec<Option<Solution>>) -> Vec<Solution> {
        found.into_iter().map(|point| point.unwrap_or_else(|| Solution::never_reached(self.ranges))).collect()
    }
}

/// The start for the next point in line: straight on from the two before it, or the one before it.
fn extrapolated(near: &[f64], far: Option<&[f64]>) -> Vec<f64> {
    match far {
        Some(far) => near.iter().zip(far).map(|(a, b)| 2.0 * a - b).collect(),
        None => near.to_vec(),
    }
}

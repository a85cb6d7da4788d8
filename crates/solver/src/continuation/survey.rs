//! What is known of branches beside the one that a grid follows.
//!
//! A grid that is not complete is looked at as a part of a finer one, so that which of its points are solved does not depend on how
//! many of them there are. Roots are looked for at places of the grid's rectangle that do not depend on that either.

use flank_expr::LANES;

use crate::continuation::anchor::{course, follow_alone};
use crate::continuation::choice::{Choice, Several, is_same_root};
use crate::continuation::field::Field;
use crate::continuation::grid::{Elsewhere, Followed, Grid, GridReport, extrapolated};
use crate::continuation::reach::{back_into, is_within};
use crate::equations::solution::{Outcome, ROUNDING, Range, Solution};
use crate::newton::batch::LaneNewton;
use crate::newton::multistart::probe;
use crate::newton::scalar::solve_with;
use crate::newton::solvers::Solvers;
use crate::roots::{Doubt, Undecided};

/// Steps from the first row, or column, to the last one that a finer grid has at the least.
const FINE: usize = 32;
/// Points of the largest grid that is looked at as a part of a finer one.
const MOST_REFINED: usize = 1024;
/// Places between its corners at which branches are looked for in a grid that is complete: another branch may be valid on a part of it
/// alone.
const BETWEEN: usize = 12;
/// The same where points are missing.
const MORE_PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// How often starts are drawn for points all over a grid whose branch has an end or leaves the ranges: another branch may have so few
/// points in the ranges that it is seen nowhere else.
const DRAWN: usize = 2048;
/// How often at the same point, at the most.
const OFTEN: usize = 64;
/// Points that are missing at which branches are looked for.
const MISSING: usize = 16;
/// Where a branch folds back, its unknowns change with the root of the distance from the fold. From the last solved point the other
/// sheet is so many times as far as the point before, for a fold at a tenth, at a half and at the whole of the step to the next point.
const ACROSS_FOLDS: [f64; 3] = [0.86, 2.7, 4.8];
/// Points of the largest grid on which several further branches are followed; of larger ones the first is told.
const MOST_FOLLOWED: usize = 4096;
/// Branches that are told of, at the most.
const TOLD: usize = 4;
/// A grid as far as its branch can be followed; further branches stand in the grid's effort.
pub(crate) fn surveyed(grid: &mut Grid<'_>, solvers: &mut Solvers<'_>, choice: &Choice<'_>) -> Followed {
    let mut followed = follow_alone(grid, solvers, None, choice);
    let leads_astray = |field: &Field| choice.planes.is_some_and(|planes| planes.are_missing(field, 0..field.len()));
    if !grid.is_careful && leads_astray(&followed.field) {
        grid.is_careful = true;
        let evaluations = grid.effort.evaluations;
        grid.effort = GridReport { evaluations, ..GridReport::default() };
        followed = follow_alone(grid, solvers, None, choice);
    }
    if followed.field.outcome(0) == Some(Outcome::Ambiguous) {
        return followed;
    }
    if followed.field.is_complete() {
        if !choice.tells_others {
            return followed;
        }
        let field = &followed.field;
        let all: Vec<usize> = (0..field.len()).collect();
        // beyond its ranges, too, this branch may be complete
        let is_partial = field.solved() < field.len() || followed.is_beyond;
        let points = if is_partial { all_over(&all) } else { places(grid) };
        grid.effort.elsewhere = beside_complete(grid, &mut solvers.careful, (field, points), choice);
        return followed;
    }
    let factors = [grid.rows, grid.columns].map(|count| FINE.div_ceil(count.max(2) - 1));
    if factors == [1, 1] || grid.targets.len() > MOST_REFINED {
        let points: Vec<usize> = (0..grid.targets.len()).collect();
        return with_others(grid, &mut solvers.careful, (followed, &points), choice);
    }
    let (targets, counts) = refined(grid, factors);
    let mut fine = Grid::new(grid.system, grid.ranges, (&targets, counts), None);
    fine.is_careful = grid.is_careful;
    let found = follow_alone(&mut fine, solvers, None, choice);
    let same = |point: usize| {
        let (i, j) = (point / grid.columns, point % grid.columns);
        i * grid.factor(factors, 0) * counts[1] + j * grid.factor(factors, 1)
    };
    let points: Vec<usize> = (0..grid.targets.len()).map(same).collect();
    let found = with_others(&mut fine, &mut solvers.careful, (found, &points), choice);
    let evaluations = grid.effort.evaluations;
    grid.effort = fine.effort;
    grid.effort.evaluations += evaluations;
    let counts_of_own = [grid.rows, grid.columns];
    let mut field = Field::new(found.field.ranges(), counts_of_own, grid.system.extra_count(), None);
    for (point, same) in points.into_iter().enumerate() {
        field.copy(point, &found.field, same);
    }
    Followed { field, is_beyond: found.is_beyond }
}

impl Grid<'_> {
    /// How many steps of a finer grid one of this is.
    fn factor(&self, factors: [usize; 2], direction: usize) -> usize {
        if [self.rows, self.columns][direction] == 1 { 1 } else { factors[direction] }
    }
}

/// The targets of a grid with further points between its own.
fn refined(grid: &Grid<'_>, factors: [usize; 2]) -> (Vec<[f64; 2]>, [usize; 2]) {
    let own = [grid.rows, grid.columns];
    let counts = [0, 1].map(|k| (own[k] - 1) * grid.factor(factors, k) + 1);
    let share = |k: usize, at: usize| at as f64 / (counts[k].max(2) - 1) as f64;
    let target = |point: usize| {
        let (i, j) = (point / counts[1], point % counts[1]);
        let [down, across] = [grid.factor(factors, 0), grid.factor(factors, 1)];
        // its own points bit for bit
        if i.is_multiple_of(down) && j.is_multiple_of(across) {
            grid.targets[i / down * grid.columns + j / across]
        } else {
            grid.target_at([share(0, i), share(1, j)])
        }
    };
    ((0..counts[0] * counts[1]).map(target).collect(), counts)
}

/// Of a grid that is not complete: branches at places spread over it, at points that are missing, and at those of its `points` that are
/// asked for. If the branch that was followed has no point in the middle, and another one has points, too, nothing says which is meant.
fn with_others(
    grid: &mut Grid<'_>,
    newton: &mut LaneNewton<'_>,
    (mut followed, asked): (Followed, &[usize]),
    choice: &Choice<'_>,
) -> Followed {
    let is_undecided = grid.effort.anchor != grid.target_at([0.5; 2]) && grid.effort.branches.len() == 1;
    let is_nowhere = (0..followed.field.len()).all(|point| !followed.field.is_root(point));
    let is_settled = !is_undecided && !is_nowhere;
    if followed.field.outcome(0) == Some(Outcome::Ambiguous) || is_settled && !choice.tells_others {
        return followed;
    }
    let shares = MORE_PLACES.into_iter().flat_map(|v| MORE_PLACES.map(|u| [v, u]));
    let mut points: Vec<usize> = shares.map(|shares| grid.nearest(shares)).collect();
    let field = &followed.field;
    let missing: Vec<usize> = (0..field.len()).filter(|point| !field.is_solved(*point)).collect();
    points.extend(missing.iter().step_by(missing.len().div_ceil(MISSING).max(1)));
    let mut others = Others { own: &followed.field, found: Vec::new() };
    for (point, start) in beyond(grid, &followed.field) {
        grid.evaluation.set_parameters(&grid.targets[point]);
        let root = solve_with(&mut grid.evaluation, grid.ranges, &start);
        grid.effort.evaluations += u64::from(root.iterations);
        others.learn(grid, choice, point, root);
    }
    let mut seen = Vec::new();
    let kept = choice.kept(grid.ranges);
    for point in points {
        if seen.contains(&point) || grid.effort.boxes >= choice.most_boxes {
            continue;
        }
        seen.push(point);
        let found = (choice.roots)(&kept, &grid.targets[point]);
        grid.effort.boxes += found.boxes;
        for root in found.isolated.into_iter().map(|root| root.solution).chain(found.unproven) {
            others.learn(grid, choice, point, root);
        }
    }
    let coordinates = coordinates(grid, &followed.field);
    for (number, point) in all_over(asked).into_iter().enumerate() {
        if !others.found.is_empty() {
            break;
        }
        for root in drawn(grid, newton, (&kept, &coordinates), (point, number)) {
            others.learn(grid, choice, point, root);
        }
    }
    let others = others.found;
    // a root that leads nowhere is one of many at a place where the equations fix no single point
    let leads_on = |(_, field): &(Elsewhere, Field)| field.solved() > 1 || field.len() == 1;
    if is_nowhere && others.iter().any(leads_on) {
        return begun_at(grid, others.into_iter().filter(leads_on).collect(), choice);
    }
    if is_undecided && !others.is_empty() {
        grid.effort.places = vec![grid.effort.anchor];
        grid.effort.courses = vec![course(&followed.field)];
        for (other, field) in others {
            grid.effort.places.push(other.place);
            grid.effort.branches.push(other.root);
            grid.effort.courses.push(course(&field));
        }
        followed.field = grid.ambiguous();
        followed.is_beyond = false;
    } else {
        grid.effort.elsewhere = others.into_iter().map(|(elsewhere, _)| elsewhere).collect();
    }
    followed
}

/// The branch that is meant where none was followed, of those that were found elsewhere: there is at least one.
fn begun_at(grid: &mut Grid<'_>, others: Vec<(Elsewhere, Field)>, choice: &Choice<'_>) -> Followed {
    grid.effort.anchor = others[0].0.place;
    // not all of the ranges was looked at there either
    if !grid.effort.undecided.is_empty() {
        grid.effort.undecided = vec![Undecided { ranges: choice.kept(grid.ranges), why: Doubt::Budget }];
    }
    grid.effort.is_given_up = false;
    grid.effort.is_kept_elsewhere = choice.keep.is_some();
    grid.effort.branches = others.iter().map(|(other, _)| other.root.clone()).collect();
    let fields = others.iter().map(|(_, field)| field);
    if others.len() > 1 && choice.several == Several::Refuse {
        grid.effort.places = others.iter().map(|(other, _)| other.place).collect();
        grid.effort.courses = fields.map(course).collect();
        return Followed { field: grid.ambiguous(), is_beyond: false };
    }
    let widest = others.into_iter().map(|(_, field)| field).reduce(|a, b| if b.solved() > a.solved() { b } else { a });
    Followed { field: widest.expect("at least one"), is_beyond: false }
}

/// Branches beside the one that was followed.
struct Others<'f> {
    own: &'f Field,
    /// Each with what it leads to.
    found: Vec<(Elsewhere, Field)>,
}

impl Others<'_> {
    /// Keeps a root at a point if it is one of another branch that qualifies.
    fn learn(&mut self, grid: &mut Grid<'_>, choice: &Choice<'_>, point: usize, root: Solution) {
        let most = if grid.targets.len() > MOST_FOLLOWED { 1 } else { TOLD };
        let is_on = |field: &Field| {
            // of singular points, too: roots without a normal, say
            let is_somewhere = !matches!(field.outcome(point), None | Some(Outcome::NotConverged { .. }));
            let own: Vec<f64> = field.unknowns(point).collect();
            is_somewhere && is_same_root(&root.unknowns, &own, grid.ranges, choice.periodic)
        };
        let is_known = is_on(self.own) || self.found.iter().any(|(_, field)| is_on(field));
        if self.found.len() >= most || is_known || !qualifies(&root, choice) {
            return;
        }
        let beside = self.own.solution(point).filter(|own| {
            own.is_root() && is_within(&back_into(grid.ranges, choice.periodic, &own.unknowns), grid.ranges)
        });
        let elsewhere = Elsewhere { place: grid.targets[point], root: root.clone(), beside };
        let mut own = grid.within(grid.ranges);
        let field = own.fill(&mut Solvers::new(grid.system, grid.ranges), point, &root);
        grid.effort.evaluations += own.effort.evaluations;
        self.found.push((elsewhere, field));
    }
}

/// Places beside the ends of a branch with starts for what may lie there: at points that are missing straight on from two that are
/// solved, where branches cross the way that no step takes; at the last that are solved the other sheet, where the branch folds back.
fn beyond(grid: &Grid<'_>, field: &Field) -> Vec<(usize, Vec<f64>)> {
    let [rows, columns] = [grid.rows, grid.columns];
    let beside = |point: usize| {
        let (i, j) = (point / columns, point % columns);
        let at = |di: isize, dj: isize| {
            let (i, j) = (i.checked_add_signed(di)?, j.checked_add_signed(dj)?);
            Some(i * columns + j).filter(|at| i < rows && j < columns && field.is_solved(*at))
        };
        let ways = [(0, 1), (0, -1), (1, 0), (-1, 0)];
        ways.into_iter().find_map(|(di, dj)| Some([point, at(di, dj)?, at(2 * di, 2 * dj)?]))
    };
    let edge: Vec<[usize; 3]> = (0..field.len()).filter(|point| !field.is_root(*point)).filter_map(beside).collect();
    let step = edge.len().div_ceil(MISSING).max(1);
    let starts = |[missing, near, far]: [usize; 3]| {
        let from: Vec<f64> = field.unknowns(near).collect();
        let on = |ratio: f64| extrapolated(&from, field.unknowns(far), ratio);
        let folded = ACROSS_FOLDS.map(|ratio| (near, on(ratio)));
        [(missing, on(1.0))].into_iter().chain(folded).collect::<Vec<_>>()
    };
    edge.into_iter().step_by(step).flat_map(starts).collect()
}

/// Whether a root is a point that another branch would have solved.
fn qualifies(root: &Solution, choice: &Choice<'_>) -> bool {
    root.is_solved() && choice.keeps(&root.unknowns) && choice.has_tangent_plane(&root.unknowns)
}

/// The corners of a grid, and places spread over it; in the middle all roots are known.
fn places(grid: &Grid<'_>) -> Vec<usize> {
    let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
    // no two in a line along either coordinate
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let between = (0..BETWEEN).map(|k| [(k as f64 + 0.5) / BETWEEN as f64, (k as f64 * golden).fract()]);
    let mut points: Vec<usize> = Vec::new();
    for shares in corners.into_iter().chain(between) {
        let point = grid.nearest(shares);
        if !points.contains(&point) {
            points.push(point);
        }
    }
    points
}

/// Some of these points, spread evenly, and all of them again and again where they are few.
fn all_over(points: &[usize]) -> Vec<usize> {
    let spread: Vec<usize> = points.iter().copied().step_by(points.len().div_ceil(DRAWN)).collect();
    spread.repeat((DRAWN / spread.len()).clamp(1, OFTEN))
}

/// For each unknown the coordinate that it is, if it is one: at the first, the middle and the last of the roots.
fn coordinates(grid: &Grid<'_>, field: &Field) -> Vec<Option<usize>> {
    let roots: Vec<usize> = (0..field.len()).filter(|point| field.is_root(*point)).collect();
    let some: Vec<usize> = [0, roots.len() / 2, roots.len().saturating_sub(1)]
        .into_iter()
        .filter_map(|number| roots.get(number).copied())
        .collect();
    let known: Vec<Vec<f64>> = some.iter().map(|point| field.unknowns(*point).collect()).collect();
    let is = |unknown: usize, coordinate: usize| {
        let mut pairs = some.iter().zip(&known).map(|(point, own)| (grid.targets[*point][coordinate], own[unknown]));
        !some.is_empty() && pairs.all(|(target, own)| (own - target).abs() <= ROUNDING * target.abs().max(1.0))
    };
    (0..grid.ranges.len()).map(|unknown| (0..2).find(|coordinate| is(unknown, *coordinate))).collect()
}

/// The points in some ranges that starts spread over them lead to, many at once; each number has starts of its own. An unknown that is one of
/// the `coordinates` starts from its value.
fn drawn(
    grid: &Grid<'_>,
    newton: &mut LaneNewton<'_>,
    (kept, coordinates): (&[Range], &[Option<usize>]),
    (point, number): (usize, usize),
) -> Vec<Solution> {
    let target = &grid.targets[point];
    for lane in 0..LANES {
        let start = probe(kept, (number * LANES + lane + 1) as u32).into_iter().zip(coordinates);
        let start = start.map(|(probe, coordinate)| coordinate.map_or(probe, |coordinate| target[coordinate]));
        newton.put(lane, start, target);
        newton.determinant()[lane] = f64::NAN;
    }
    newton.run(&[true; LANES], true);
    let mut found = Vec::new();
    for lane in 0..LANES {
        if newton.is_root(lane) && newton.outcome(lane) == Outcome::Solved {
            let unknowns: Vec<f64> = (0..kept.len()).map(|k| newton.input(k)[lane]).collect();
            let residual = newton.residuals()[lane];
            found.push(Solution { outcome: Outcome::Solved, unknowns, residual, iterations: 0 });
        }
    }
    found
}

/// Of a grid that is complete: roots beside its own at a few places, from starts spread over the ranges, many at once.
fn beside_complete(
    grid: &mut Grid<'_>,
    newton: &mut LaneNewton<'_>,
    (field, points): (&Field, Vec<usize>),
    choice: &Choice<'_>,
) -> Vec<Elsewhere> {
    let mut others: Vec<Elsewhere> = Vec::new();
    let kept = choice.kept(grid.ranges);
    let coordinates = coordinates(grid, field);
    for (number, point) in points.into_iter().enumerate() {
        let own: Vec<f64> = field.unknowns(point).collect();
        let target = grid.targets[point];
        for root in drawn(grid, newton, (&kept, &coordinates), (point, number)) {
            let is_own = is_same_root(&root.unknowns, &own, grid.ranges, choice.periodic);
            if !is_own && qualifies(&root, choice) {
                let beside = field
                    .solution(point)
                    .filter(|_| is_within(&back_into(grid.ranges, choice.periodic, &own), grid.ranges));
                others.push(Elsewhere { place: target, root, beside });
                return others;
            }
        }
    }
    others
}

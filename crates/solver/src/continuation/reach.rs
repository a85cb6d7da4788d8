//! A branch beyond its ranges: it may leave them, come back, and mean the same after a turn.

use std::f64::consts::TAU;
use std::ops;

use flank_expr::{InstructionSet, LANES, LaneEvaluator, LaneTape};

use crate::continuation::field::Field;
use crate::continuation::grid::{Followed, Grid};
use crate::equations::solution::{Outcome, Range, Solution, verdict};
use crate::newton::batch::LaneNewton;
use crate::newton::multistart::probe;
use crate::newton::scalar::solve_with;
use crate::newton::solvers::Solvers;

/// Where functions are looked at to see whether a turn changes them.
const PROBES: usize = 8;
/// Changes below this share of a function, or of a millimetre, are rounding.
const UNCHANGED: f64 = 1e-10;

/// Where branches are followed beyond the ranges.
#[derive(Clone, Debug)]
pub(crate) struct Reach {
    pub(crate) ranges: Vec<Range>,
    /// Where they are looked for: of what is periodic a turn is enough.
    pub(crate) searched: Vec<Range>,
}

/// The branch of a field that is not complete, also where it is beyond the ranges; what was found within them stays.
pub(crate) fn follow_on(grid: &mut Grid<'_>, reach: &Reach, anchor: usize, own: Field) -> Followed {
    let Some(root) = own.solution(anchor) else { return Followed { field: own, is_beyond: false } };
    let mut beyond = grid.within(&reach.ranges);
    let mut field = beyond.fill(&mut Solvers::new(grid.system, &reach.ranges), anchor, &root);
    grid.effort.evaluations += beyond.effort.evaluations;
    let points = 0..own.len();
    if points.clone().all(|point| own.is_root(point) || !field.is_root(point)) {
        return Followed { field: own, is_beyond: false };
    }
    for point in points {
        if own.is_root(point) || own.outcome(point).is_some() && !field.is_root(point) {
            field.copy(point, &own, point);
        }
    }
    Followed { field, is_beyond: true }
}

/// The verdicts on some points of a field within the ranges of its grid, wherever its branch was followed: what a turn brings back
/// into them is within them.
pub(crate) fn settle(
    grid: &mut Grid<'_>,
    field: &mut Field,
    newton: &mut LaneNewton<'_>,
    points: ops::Range<usize>,
    periodic: &[bool],
) {
    let ranges = grid.ranges;
    if !(field.is_of_others(ranges) || periodic.contains(&true) && field.has_outside()) {
        return;
    }
    field.judge_by(ranges);
    let mut back: Vec<(usize, Vec<f64>)> = Vec::new();
    for point in points {
        if !field.is_root(point) {
            continue;
        }
        let found: Vec<f64> = field.unknowns(point).collect();
        let unknowns = back_into(ranges, periodic, &found);
        match verdict(&unknowns, ranges, true, false) {
            Outcome::Solved if unknowns == found && !field.is_outside(point) => {}
            Outcome::Solved => back.push((point, unknowns)),
            outcome => {
                field.put(point, &Solution { outcome, unknowns, residual: field.residual(point), iterations: 0 });
            }
        }
    }
    for block in back.chunks(LANES) {
        for (lane, (point, unknowns)) in block.iter().enumerate() {
            newton.put(lane, unknowns.iter().copied(), &grid.targets[*point]);
            newton.determinant()[lane] = f64::NAN;
        }
        grid.effort.evaluations += newton.run(&vec![true; block.len()], false);
        for (lane, (point, unknowns)) in block.iter().enumerate() {
            if newton.is_root(lane) && newton.outcome(lane) == Outcome::Solved {
                field.take(*point, newton, lane);
            } else {
                grid.evaluation.set_parameters(&grid.targets[*point]);
                let solution = solve_with(&mut grid.evaluation, ranges, unknowns);
                grid.effort.evaluations += u64::from(solution.iterations);
                field.put(*point, &solution);
            }
        }
    }
    field.place_loose(newton);
}

/// The same point with its periodic unknowns turned into their ranges, or as near as turns bring them.
pub(crate) fn back_into(ranges: &[Range], periodic: &[bool], unknowns: &[f64]) -> Vec<f64> {
    let turned = |((x, range), is_periodic): ((&f64, &Range), &bool)| {
        if *is_periodic && range.excess(*x) > 0.0 { x - TAU * ((x - range.middle()) / TAU).round() } else { *x }
    };
    let mut all = unknowns.to_vec();
    let turned: Vec<f64> = unknowns.iter().zip(ranges).zip(periodic).map(turned).collect();
    all[..turned.len()].copy_from_slice(&turned);
    all
}

/// The same point with its periodic unknowns turned as near to those of another one as turns bring them.
pub(crate) fn nearest_turn(unknowns: &[f64], other: &[f64], periodic: &[bool]) -> Vec<f64> {
    let mut all = unknowns.to_vec();
    for ((x, other), _) in all.iter_mut().zip(other).zip(periodic).filter(|(_, is_periodic)| **is_periodic) {
        *x -= TAU * ((*x - other) / TAU).round();
    }
    all
}

/// Whether all unknowns lie in their ranges.
pub(crate) fn is_within(unknowns: &[f64], ranges: &[Range]) -> bool {
    verdict(unknowns, ranges, true, false) == Outcome::Solved
}

/// The unknowns that, turned once, change none of the first `count` outputs of a tape: those among its first inputs, which have ranges; the
/// others are zero.
pub(crate) fn periodic_in(tape: &LaneTape, count: usize, ranges: &[Range]) -> Vec<bool> {
    let mut evaluator = LaneEvaluator::new(tape, InstructionSet::widest());
    let places: Vec<Vec<f64>> = (1..=PROBES).map(|number| probe(ranges, number as u32)).collect();
    let (mut is_known, mut is_same) = (vec![false; ranges.len()], vec![true; ranges.len()]);
    // the places as they are, then with one unknown turned, then with the next one
    let all: Vec<usize> = (0..ranges.len()).collect();
    for turned in all.chunks(LANES / PROBES - 1) {
        for (input, _) in ranges.iter().enumerate() {
            for (lane, value) in evaluator.input(input)[..(1 + turned.len()) * PROBES].iter_mut().enumerate() {
                let is_turned = lane >= PROBES && turned[lane / PROBES - 1] == input;
                *value = places[lane % PROBES][input] + if is_turned { TAU } else { 0.0 };
            }
        }
        evaluator.run_first((1 + turned.len()) * PROBES);
        for output in 0..count {
            let (here, there) = evaluator.output(output).split_at(PROBES);
            for (unknown, there) in turned.iter().zip(there.chunks(PROBES)) {
                for (a, b) in here.iter().zip(there).filter(|(a, b)| a.is_finite() || b.is_finite()) {
                    is_known[*unknown] = true;
                    is_same[*unknown] &= (a - b).abs() <= UNCHANGED * a.abs().max(1.0);
                }
            }
        }
    }
    is_known.into_iter().zip(is_same).map(|(is_known, is_same)| is_known && is_same).collect()
}

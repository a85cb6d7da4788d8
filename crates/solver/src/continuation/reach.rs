//! A branch beyond its ranges: it may leave them, come back, and mean the same after a turn.

use std::f64::consts::TAU;
use std::ops;

use flank_expr::{LANES, ScalarEvaluator, Tape};

use crate::continuation::field::Field;
use crate::continuation::grid::{Followed, Grid};
use crate::equations::solution::{Outcome, Range, Solution, verdict};
use crate::newton::batch::LaneNewton;
use crate::newton::multistart::probe;
use crate::newton::scalar::solve_with;
use crate::newton::solvers::Solvers;

/// Where functions are looked at to see whether a turn changes them.
const PROBES: u32 = 8;
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

/// The inputs of functions that change none of them by a turn: those among the first ones, which have ranges; the others are zero.
pub(crate) fn periodic_in(tapes: &[&Tape], ranges: &[Range]) -> Vec<bool> {
    let mut functions: Vec<_> = tapes.iter().map(|tape| (ScalarEvaluator::new(tape), tape)).collect();
    let mut values = |inputs: &[f64]| -> Vec<f64> {
        let of = |(evaluator, tape): &mut (ScalarEvaluator<'_>, &&Tape)| {
            let mut out = vec![0.0; tape.output_count()];
            evaluator.run(&inputs[..tape.input_count()], &mut out);
            out
        };
        functions.iter_mut().flat_map(of).collect()
    };
    let most = tapes.iter().map(|tape| tape.input_count()).max().unwrap_or(0);
    // what the functions are at each place, as far as it was asked for
    let mut known_here: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let is_periodic = |k: usize| {
        let mut known = 0;
        for number in 1..=PROBES {
            let place = number as usize - 1;
            if known_here.len() == place {
                let mut inputs = probe(ranges, number);
                inputs.resize(most, 0.0);
                let here = values(&inputs);
                known_here.push((inputs, here));
            }
            let (inputs, here) = &mut known_here[place];
            let stays = inputs[k];
            inputs[k] += TAU;
            let there = values(inputs);
            inputs[k] = stays;
            for (a, b) in here.iter().zip(&there).filter(|(a, b)| a.is_finite() || b.is_finite()) {
                known += 1;
                let is_same = (a - b).abs() <= UNCHANGED * a.abs().max(1.0);
                if !is_same {
                    return false;
                }
            }
        }
        known > 0
    };
    (0..ranges.len()).map(is_periodic).collect()
}

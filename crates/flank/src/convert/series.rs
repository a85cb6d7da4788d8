//! The axes as polynomials of the motion, and what cutting them off leaves on the flank.

use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{PoseProblem, Posture, Tube, Unproven};

use super::source::{Flank, Source};
use super::{Conversion, at, is_met};
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::ConvertRequest;

/// The highest order that is tried.
pub(crate) const HIGHEST: usize = 30;

/// Power series of the axes about the middle position.
pub(crate) struct Series {
    /// The motion's value that it is about.
    pub(crate) about: f64,
    /// The order that was asked for, or the smallest one that meets the tolerance.
    pub(crate) order: usize,
    /// Of each axis the coefficients up to the order, mm or rad per rad (or mm) of the motion to the power.
    pub(crate) axes: Vec<Vec<f64>>,
    /// The largest normal distance between the flank and what polynomials of each order leave of it, from order 0 to the last
    /// that was tried, mm; none where no points are solved.
    pub(crate) deviations: Vec<f64>,
    /// Whether the tolerance is met.
    pub(crate) meets: bool,
    /// What the polynomials leave of each axis at the positions, at most, mm or rad.
    pub(crate) seen: Vec<f64>,
    /// What they leave of it anywhere on the way, at most.
    pub(crate) remainders: Result<Vec<f64>, Unproven>,
    /// Where the axes are proven to stand.
    pub(crate) tube: Result<Tube, Unproven>,
}

impl Series {
    pub(crate) fn of_conversion(carried: &Conversion<'_, '_>, request: &ConvertRequest) -> Option<Series> {
        let Conversion { source, problem, positions, line, .. } = carried;
        let about = at(source.ranges[0], 0.5);
        let middle = middle(carried, about)?;
        let highest = if request.tolerance.is_some() { HIGHEST } else { request.order() };
        let all = problem.series(&middle, &[about], 0, highest)?;
        let mut flanks: Vec<Moved<'_, '_, '_>> = source
            .flanks
            .iter()
            .filter(|flank| flank.solved().next().is_some())
            .map(|flank| Moved::new(problem, source, flank))
            .collect();
        let mut deviations = Vec::new();
        let mut order = request.order();
        // where nothing is solved nothing shows what an order leaves
        let mut meets = request.tolerance.is_none();
        if !flanks.is_empty() {
            for tried in 0..=highest {
                let most = flanks.iter_mut().map(|flank| flank.deviation(&all, tried, about)).fold(0.0, f64::max);
                deviations.push(most);
                meets = request.tolerance.is_none_or(|tolerance| most <= tolerance);
                if request.tolerance.is_some() {
                    order = tried;
                    if meets {
                        break;
                    }
                }
            }
        }
        let axes: Vec<Vec<f64>> = all[..middle.axes.len()].iter().map(|series| series[..=order].to_vec()).collect();
        let off = |axis: usize| {
            let each = positions.iter().zip(line);
            each.map(|(at, posture)| (posture.axes[axis] - value(&axes[axis], at[0] - about)).abs()).fold(0.0, f64::max)
        };
        let seen = (0..axes.len()).map(off).collect();
        let tube = problem.tube(&middle, about, source.ranges[0]);
        let remainders = tube.as_ref().map(|tube| tube.distances(about, &axes)).map_err(|unproven| *unproven);
        Some(Series { about, order, axes, deviations, meets, seen, remainders, tube })
    }
}

impl Series {
    /// In words, that no order meets a tolerance, and what can be done; nothing if one does.
    pub(crate) fn unmet(&self, tolerance: Option<f64>, (machine, source): (&str, &Source<'_, '_>)) -> Option<NotDone> {
        let not_reached = |message: String| Some(NotDone::new(NotDoneKind::NotReached, machine, message));
        /// Nearer than this the flank is not computed, mm.
        const ROUNDING: f64 = 1e-11;
        let tolerance = tolerance.filter(|_| !self.meets)?;
        let Some((order, least)) = self.deviations.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)) else {
            let why = if source.flanks.is_empty() {
                "the points show it where a face of the tool touches the flank, and this tool is an edge; give the order (option `order`)"
            } else {
                "the points of the flank show it, and none is sampled and solved; add a `sample`, or give the order (option `order`)"
            };
            return not_reached(format!(
                "not reached: no order is known to keep the flank within {:.3e} um: {why}",
                tolerance * 1e3
            ));
        };
        let why = if *least < ROUNDING {
            "nearer than rounding lets it: ask for a larger tolerance"
        } else {
            "the series do not reach the ends of the motion: carry over a shorter part of it, with a sample of less of the flank, or \
             take the positions or the exact form (option `emit_form exact`) instead of polynomials"
        };
        not_reached(format!(
            "not reached: no order up to {HIGHEST} keeps the flank within {:.3e} um; order {order} comes nearest, {:.3e} um; {why}",
            tolerance * 1e3,
            least * 1e3
        ))
    }
}

/// The posture in the middle of the motion, which need not be one of the positions; nothing if it cannot be followed there.
fn middle(carried: &Conversion<'_, '_>, about: f64) -> Option<Posture> {
    let Conversion { problem, positions, line, .. } = carried;
    let apart = |k: &usize| (positions[*k][0] - about).abs();
    let nearest = (0..positions.len()).min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    problem.follow(&line[nearest], &[positions[nearest].clone(), vec![about]]).pop().filter(is_met)
}

/// A polynomial at a distance from what it is about.
fn value(coefficients: &[f64], h: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * h + c)
}

/// The solved points of a surface, and where the target's axes bring the points of the tool that made them.
struct Moved<'s, 'j, 'g> {
    flank: &'s Flank<'j, 'g>,
    /// Of the tool's unknowns and the target's: a point of the tool in the work.
    tape: Tape,
    tool_unknowns: usize,
    /// Index of the motion among the surface's unknowns.
    motion: usize,
}

impl<'s, 'j, 'g> Moved<'s, 'j, 'g> {
    fn new(problem: &PoseProblem<'g>, source: &Source<'_, 'g>, flank: &'s Flank<'j, 'g>) -> Moved<'s, 'j, 'g> {
        let inputs: Vec<Expr<'g>> = flank.tool.unknowns.iter().chain(problem.unknowns()).copied().collect();
        let position = problem.chain().point(flank.tool.position);
        let variable = source.motions[0].variable;
        let motion = flank.surface.unknowns.iter().position(|unknown| unknown.variable == variable);
        Moved {
            flank,
            tape: Tape::new(&position.0, &inputs).expect("a job without errors leaves nothing unbound"),
            tool_unknowns: flank.tool.unknowns.len(),
            motion: motion.expect("the surface is an envelope over the motion"),
        }
    }

    /// The largest normal distance that polynomials of an order leave. An envelope moves along its normal as the points of the tool
    /// do that touch it; what they do along the surface, and squares of the distance, do not count.
    fn deviation(&mut self, series: &[Vec<f64>], order: usize, about: f64) -> f64 {
        let mut evaluator = ScalarEvaluator::new(&self.tape);
        let mut moved = [0.0; 3];
        let of = |point: &flank_solver::SurfacePoint| {
            let h = point.unknowns[self.motion] - about;
            let axes = series.iter().map(|c| value(&c[..=order], h));
            let inputs: Vec<f64> = point.unknowns[..self.tool_unknowns].iter().copied().chain(axes).collect();
            evaluator.run(&inputs, &mut moved);
            (0..3).map(|k| point.normal[k] * (moved[k] - point.position[k])).sum::<f64>().abs()
        };
        self.flank.solved().map(of).fold(0.0, f64::max)
    }
}

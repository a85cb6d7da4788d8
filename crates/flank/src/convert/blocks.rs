//! What a program of straight blocks leaves on the flank: between positions the axes run straight, and positions are rounded.

use flank_chain_dsl::Axis;
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{PoseProblem, Range, Tube};

use super::Conversion;
use super::files::decimals;
use super::result::NcDeviation;
use super::source::{Flank, Source};
use crate::project::units;

/// What straight blocks through positions of one motion, in order, leave; `tube` is where the axes are proven to stand. Largest normal
/// distances from the flank where points are sampled; each a sum over the axes, as if all were off the worse way at once.
pub(super) fn nc_deviation(carried: &Conversion<'_, '_>, tube: Option<&Tube>) -> NcDeviation {
    let Conversion { problem, source, free: axes, positions, line, .. } = carried;
    let mut worst = NcDeviation { straight_mm: None, rounding_mm: None };
    let each = line.iter().zip(positions).map(|(posture, at)| problem.series(posture, at, 0, 2));
    let Some(series) = each.collect::<Option<Vec<Vec<Vec<f64>>>>>() else { return worst };
    let ends = positions.windows(2).zip(line.windows(2));
    let blocks = ends.zip(&series).map(|((at, postures), start)| {
        let range = Range { low: at[0][0], high: at[1][0] };
        let step = range.high - range.low;
        let [from, to] = [&postures[0].axes, &postures[1].axes];
        let chords: Vec<Vec<f64>> = from.iter().zip(to).map(|(a, b)| vec![*a, (b - a) / step]).collect();
        let bends = tube.map_or(vec![0.0; axes.len()], |tube| tube.distances_over(range, range.low, &chords));
        Block { from: range.low, step, start, bends }
    });
    let blocks: Vec<Block<'_>> = blocks.collect();
    let halves: Vec<f64> = axes.iter().map(|axis| half_increment(axis)).collect();
    for flank in &source.flanks {
        for (straight, rounding) in Influence::new(problem, source, flank, axes.len()).off(&blocks, &halves) {
            worst.straight_mm = tube.map(|_| straight.max(worst.straight_mm.unwrap_or(0.0)));
            worst.rounding_mm = Some(rounding.max(worst.rounding_mm.unwrap_or(0.0)));
        }
    }
    worst
}

/// What lies between two positions.
struct Block<'s> {
    from: f64,
    step: f64,
    /// Series of all unknowns about its first position.
    start: &'s [Vec<f64>],
    /// How far each axis is off the straight line in between, mm or rad, at most; zero without a proof.
    bends: Vec<f64>,
}

impl Block<'_> {
    fn unknowns(&self, at: f64) -> Vec<f64> {
        let h = at - self.from;
        self.start.iter().map(|c| c[0] + h * (c[1] + h * c[2])).collect()
    }
}

fn half_increment(axis: &Axis<'_>) -> f64 {
    let half = 0.5 * 10f64.powi(-i32::from(decimals(axis.dimension, &axis.word)));
    if units::is_angle(axis.dimension) { half.to_radians() } else { half }
}

/// How far axes move the points of a tool that touch a flank, along its normal.
struct Influence<'f, 'j, 'g> {
    flank: &'f Flank<'j, 'g>,
    /// Of the tool's unknowns and the target's: a point's derivatives by each axis.
    tape: Tape,
    tool: usize,
    /// Index of the motion among the surface's unknowns.
    motion: usize,
    axes: usize,
}

impl<'f, 'j, 'g> Influence<'f, 'j, 'g> {
    fn new(
        problem: &PoseProblem<'g>,
        source: &Source<'_, 'g>,
        flank: &'f Flank<'j, 'g>,
        axes: usize,
    ) -> Influence<'f, 'j, 'g> {
        let inputs: Vec<Expr<'g>> = flank.tool.unknowns.iter().chain(problem.unknowns()).copied().collect();
        let position = problem.chain().point(flank.tool.position);
        let slopes: Vec<Expr<'g>> =
            problem.unknowns()[..axes].iter().flat_map(|axis| position.derivative(*axis).0).collect();
        let motion = flank.surface.unknowns.iter().position(|u| u.variable == source.motions[0].variable);
        Influence {
            flank,
            tape: Tape::new(&slopes, &inputs).expect("a job without errors leaves nothing unbound"),
            tool: flank.tool.unknowns.len(),
            motion: motion.expect("the surface is an envelope over the motion"),
            axes,
        }
    }

    /// Of each solved point what straight blocks and rounding leave.
    fn off(&self, blocks: &[Block<'_>], halves: &[f64]) -> Vec<(f64, f64)> {
        let mut evaluator = ScalarEvaluator::new(&self.tape);
        let mut slopes = vec![0.0; 3 * self.axes];
        let of = |point: &flank_solver::SurfacePoint| {
            let at = point.unknowns[self.motion];
            let block = &blocks[blocks.partition_point(|block| block.from + block.step < at).min(blocks.len() - 1)];
            let inputs: Vec<f64> = point.unknowns[..self.tool].iter().copied().chain(block.unknowns(at)).collect();
            evaluator.run(&inputs, &mut slopes);
            let along = |k: usize| (0..3).map(|i| point.normal[i] * slopes[3 * k + i]).sum::<f64>().abs();
            let sum = |off: &[f64]| (0..self.axes).map(|k| along(k) * off[k]).sum::<f64>();
            (sum(&block.bends), sum(halves))
        };
        if blocks.is_empty() { Vec::new() } else { self.flank.solved().map(of).collect() }
    }
}

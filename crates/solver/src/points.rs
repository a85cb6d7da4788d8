//! Solved points of a surface, without an allocation for each of them.

use flank_expr::{InstructionSet, LANES, LaneEvaluator, LaneTape};
use rayon::prelude::*;

use crate::field::Field;
use crate::solution::{Outcome, Range};
use crate::surface::SurfacePoint;

/// Blocks of lanes that a thread works on at a time.
const BLOCKS: usize = 8;

/// Points that were asked for, in the order of their targets.
#[derive(Clone, Debug)]
pub struct SurfacePoints {
    field: Field,
    /// Position and normal of each.
    placed: Vec<[f64; 6]>,
    /// What is told of points that nothing came near.
    middle: Vec<f64>,
}

impl SurfacePoints {
    /// `point` computes position and normal from the unknowns.
    pub(crate) fn new(field: Field, point: &LaneTape, ranges: &[Range], count: usize) -> SurfacePoints {
        let mut points = SurfacePoints {
            field,
            placed: vec![[f64::NAN; 6]; count],
            middle: ranges.iter().map(|range| range.middle()).collect(),
        };
        let mut placed = std::mem::take(&mut points.placed);
        let place = |evaluator: &mut LaneEvaluator<'_>, k: usize, out: &mut [[f64; 6]]| {
            for (block, out) in out.chunks_mut(LANES).enumerate() {
                points.place(evaluator, (k * BLOCKS + block) * LANES, out);
            }
        };
        let another = || LaneEvaluator::new(point, InstructionSet::fastest());
        if rayon::current_num_threads() == 1 || count <= BLOCKS * LANES {
            let mut evaluator = another();
            placed.chunks_mut(BLOCKS * LANES).enumerate().for_each(|(k, out)| place(&mut evaluator, k, out));
        } else {
            let pieces = placed.par_chunks_mut(BLOCKS * LANES).enumerate();
            pieces.for_each_init(another, |evaluator, (k, out)| place(evaluator, k, out));
        }
        points.placed = placed;
        points
    }

    /// Position and normal of the points from `first` on, a block of lanes at most.
    fn place(&self, evaluator: &mut LaneEvaluator<'_>, first: usize, out: &mut [[f64; 6]]) {
        for k in 0..self.middle.len() {
            let unknowns = evaluator.input(k);
            for (lane, unknown) in unknowns.iter_mut().enumerate() {
                *unknown = self.unknowns(first + lane.min(out.len() - 1))[k];
            }
        }
        evaluator.run();
        for k in 0..6 {
            let values = evaluator.output(k);
            for (lane, placed) in out.iter_mut().enumerate() {
                placed[k] = values[lane];
            }
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.placed.len()
    }

    /// Whether none was asked for.
    pub fn is_empty(&self) -> bool {
        self.placed.is_empty()
    }

    /// The verdict; the rest describes a point of the surface only if it is [`Outcome::Solved`].
    ///
    /// # Panics
    /// If there is no such point, as for all that follow.
    pub fn outcome(&self, point: usize) -> Outcome {
        self.field.outcome(point).unwrap_or(Outcome::NotConverged { iterations: 0 }).of_placed(&self.placed[point])
    }

    /// The surface's unknowns, mm or radians.
    pub fn unknowns(&self, point: usize) -> &[f64] {
        if self.field.outcome(point).is_some() { self.field.unknowns(point) } else { &self.middle }
    }

    /// Position, mm, in the frame of the surface, then the unit normal out of the body that owns the surface.
    pub fn placed(&self, point: usize) -> [f64; 6] {
        self.placed[point]
    }

    /// The largest residual, mm or mm per radian.
    pub fn residual(&self, point: usize) -> f64 {
        self.field.residual(point)
    }

    /// All of that for one point.
    pub fn point(&self, point: usize) -> SurfacePoint {
        let [x, y, z, nx, ny, nz] = self.placed[point];
        SurfacePoint {
            outcome: self.outcome(point),
            unknowns: self.unknowns(point).to_vec(),
            position: [x, y, z],
            normal: [nx, ny, nz],
            residual: self.residual(point),
        }
    }
}

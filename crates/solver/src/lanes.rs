//! Newton on many points at once, without damping: points that need care are told, not solved.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::{InstructionSet, LANES, LaneEvaluator};

use crate::elimination::eliminate;
use crate::newton::{LARGEST_TOLERANCE, Linearized, OF_SIZE, TOLERANCE, newton_step};
use crate::solution::{Outcome, Range};
use crate::system::{System, side_of};

/// Steps after which a lane is left to the careful path.
const MOST_STEPS: usize = 5;
/// A start is a root as it is if its residuals are below this share of the tolerance, so that what its prediction lacks stays
/// well below what the tolerance allows.
const PREDICTED: f64 = 0.25;
/// Newton stops below this share of the tolerance, or at the tolerance when a step no longer pays.
const POLISHED: f64 = 0.1;
/// With a smaller pivot (scaled as in `newton_step`) a lane is left to the careful path, which says what is singular.
const CLEAR_PIVOT: f64 = 1e-6;

type Lanes = [f64; LANES];

/// Solves up to [`LANES`] points of a system at once.
pub(crate) struct LaneNewton<'s> {
    ranges: &'s [Range],
    residuals: LaneEvaluator<'s>,
    linearized: LaneEvaluator<'s>,
    conditions: LaneEvaluator<'s>,
    condition_count: usize,
    /// Unknowns and parameters.
    input_count: usize,
    instructions: InstructionSet,
    /// The last step of each unknown, as a share of its range.
    steps: Vec<Lanes>,
    /// One over the tolerance of each residual.
    sharpness: Vec<Lanes>,
    /// The largest residual, as a share of its tolerance.
    worst: Lanes,
    /// The determinant of the Jacobian, scaled as in `newton_step`; known from the start, or from the last step.
    determinant: Lanes,
    least_pivot: Lanes,
    /// How far each lane has come from its start, as a share of the ranges.
    moved: Lanes,
    ends: [End; LANES],
}

#[derive(Clone, Copy, PartialEq)]
enum End {
    Open,
    Root,
    Lost,
}

/// Where a lane begins.
pub(crate) struct Start<'p> {
    pub(crate) unknowns: &'p [f64],
    pub(crate) parameters: &'p [f64],
    /// The determinant at the start if it is known not to vanish around there; else the lane takes one step at least.
    pub(crate) determinant: Option<f64>,
}

impl<'s> LaneNewton<'s> {
    pub(crate) fn new(system: &'s System, ranges: &'s [Range], instructions: InstructionSet) -> LaneNewton<'s> {
        LaneNewton {
            ranges,
            residuals: LaneEvaluator::new(&system.lanes.residuals, instructions),
            linearized: LaneEvaluator::new(&system.lanes.linearized, instructions),
            conditions: LaneEvaluator::new(&system.lanes.conditions, instructions),
            condition_count: system.lanes.conditions.output_count(),
            input_count: system.tape().input_count(),
            instructions,
            steps: vec![[0.0; LANES]; ranges.len()],
            sharpness: vec![[0.0; LANES]; ranges.len()],
            worst: [0.0; LANES],
            determinant: [0.0; LANES],
            least_pivot: [0.0; LANES],
            moved: [0.0; LANES],
            ends: [End::Open; LANES],
        }
    }

    pub(crate) fn put(&mut self, lane: usize, start: &Start<'_>) {
        for (k, value) in start.unknowns.iter().chain(start.parameters).enumerate() {
            self.residuals.input(k)[lane] = *value;
        }
        self.determinant[lane] = start.determinant.unwrap_or(f64::NAN);
    }

    /// Solves the first `count` lanes; gives the number of evaluations.
    pub(crate) fn run(&mut self, count: usize) -> u64 {
        self.begin(count);
        let mut evaluations = count as u64;
        for _ in 0..MOST_STEPS {
            let open = self.ends.iter().filter(|end| **end == End::Open).count() as u64;
            if open == 0 {
                break;
            }
            let before = self.worst;
            self.step();
            self.measure();
            evaluations += 2 * open;
            for lane in 0..count {
                self.judge(lane, before[lane]);
            }
        }
        for lane in 0..count {
            if self.ends[lane] == End::Open {
                self.ends[lane] = if self.worst[lane] <= 1.0 { End::Root } else { End::Lost };
            }
        }
        if self.condition_count > 0 {
            self.copy_inputs_to_conditions();
            self.conditions.run();
        }
        evaluations
    }

    /// Whether a lane has come to a root.
    pub(crate) fn is_root(&self, lane: usize) -> bool {
        self.ends[lane] == End::Root
    }

    /// How far a lane has come from its start, as a share of the ranges.
    pub(crate) fn moved(&self, lane: usize) -> f64 {
        self.moved[lane]
    }

    pub(crate) fn unknown(&mut self, k: usize, lane: usize) -> f64 {
        self.residuals.input(k)[lane]
    }

    pub(crate) fn determinant(&self, lane: usize) -> f64 {
        self.determinant[lane]
    }

    /// The largest residual of a lane.
    pub(crate) fn residual(&self, lane: usize) -> f64 {
        (0..self.ranges.len()).map(|row| self.residuals.output(row)[lane].abs()).fold(0.0, f64::max)
    }

    /// What a root is by the conditions of the system.
    pub(crate) fn side(&self, lane: usize) -> Outcome {
        side_of((0..self.condition_count).map(|k| self.conditions.output(k)[lane]))
    }

    fn begin(&mut self, count: usize) {
        // idle lanes repeat the first one
        for k in 0..self.input_count {
            let first = self.residuals.input(k)[0];
            self.residuals.input(k)[count..].fill(first);
        }
        self.sharpness.fill([1.0 / TOLERANCE; LANES]);
        self.moved = [0.0; LANES];
        self.ends = [End::Root; LANES];
        self.measure();
        for lane in 0..count {
            let is_root = self.worst[lane] <= PREDICTED && !self.determinant[lane].is_nan();
            self.ends[lane] = if is_root { End::Root } else { End::Open };
        }
    }

    /// Residuals at the unknowns.
    fn measure(&mut self) {
        self.residuals.run();
        self.worst = [0.0; LANES];
        for (row, sharpness) in self.sharpness.iter().enumerate() {
            let residual = self.residuals.output(row);
            for lane in 0..LANES {
                let share = residual[lane].abs() * sharpness[lane];
                // NaN stays
                self.worst[lane] =
                    if share <= self.worst[lane] || self.worst[lane].is_nan() { self.worst[lane] } else { share };
            }
        }
    }

    /// What has become of an open lane after a step.
    fn judge(&mut self, lane: usize, before: f64) {
        if self.ends[lane] != End::Open {
            return;
        }
        let worst = self.worst[lane];
        if worst <= POLISHED || (worst <= 1.0 && worst >= 0.5 * before) {
            self.ends[lane] = End::Root;
        }
        let inside = (0..self.ranges.len()).all(|k| {
            let value = self.residuals.input(k)[lane];
            self.ranges[k].widened(value) == value
        });
        // a comparison that fails for NaN, too
        let is_clear = self.least_pivot[lane] >= CLEAR_PIVOT;
        if !(inside && is_clear) {
            self.ends[lane] = End::Lost;
        }
    }

    /// One step of Newton in the open lanes.
    fn step(&mut self) {
        for k in 0..self.input_count {
            *self.linearized.input(k) = *self.residuals.input(k);
        }
        self.linearized.run();
        match self.ranges.len() {
            1 => self.eliminate::<1>(),
            2 => self.eliminate::<2>(),
            3 => self.eliminate::<3>(),
            4 => self.eliminate::<4>(),
            5 => self.eliminate::<5>(),
            _ => self.eliminate_one_by_one(),
        }
        for (k, steps) in self.steps.iter().enumerate() {
            let unknowns = self.residuals.input(k);
            for lane in 0..LANES {
                if self.ends[lane] == End::Open {
                    unknowns[lane] += steps[lane] * self.ranges[k].width();
                }
            }
        }
        for lane in 0..LANES {
            let longest = self.steps.iter().map(|step| step[lane].abs()).fold(0.0, f64::max);
            self.moved[lane] += longest;
        }
    }

    /// The steps by elimination of N unknowns, scaled as in `newton_step`.
    fn eliminate<const N: usize>(&mut self) {
        let LaneNewton {
            instructions, linearized, residuals, ranges, steps, sharpness, determinant, least_pivot, ..
        } = self;
        let right: [&Lanes; N] = std::array::from_fn(|row| linearized.output(row));
        let jacobian: [[&Lanes; N]; N] =
            std::array::from_fn(|row| std::array::from_fn(|column| linearized.output(N * (1 + row) + column)));
        let sizes: [Lanes; N] = std::array::from_fn(|k| residuals.input(k).map(|p| p.abs().max(1.0)));
        let widths: [f64; N] = std::array::from_fn(|k| ranges[k].width());
        let (mut found, mut tolerances) = ([[0.0; LANES]; N], [[0.0; LANES]; N]);
        instructions.dispatch(
            #[inline(always)]
            || {
                for lane in 0..LANES {
                    let (mut j, mut b) = ([[0.0; N]; N], [0.0; N]);
                    for row in 0..N {
                        let (mut largest, mut size) = (0.0, 0.0);
                        for column in 0..N {
                            let entry = jacobian[row][column][lane];
                            j[row][column] = entry * widths[column];
                            let scaled = j[row][column].abs();
                            largest = if scaled > largest { scaled } else { largest };
                            size += entry.abs() * sizes[column][lane];
                        }
                        let weight = 1.0 / largest;
                        for column in 0..N {
                            j[row][column] *= weight;
                        }
                        b[row] = -right[row][lane] * weight;
                        tolerances[row][lane] = size;
                    }
                    let solved = eliminate(j, b);
                    for k in 0..N {
                        found[k][lane] = solved.solution[k];
                    }
                    determinant[lane] = solved.determinant;
                    least_pivot[lane] = solved.least_pivot;
                }
            },
        );
        for k in 0..N {
            steps[k] = found[k];
            sharpness[k] = tolerances[k].map(|size| 1.0 / (OF_SIZE * size).clamp(TOLERANCE, LARGEST_TOLERANCE));
        }
    }

    /// The same by the general path, for systems of any size. Determinants stay unknown.
    fn eliminate_one_by_one(&mut self) {
        let n = self.ranges.len();
        for lane in (0..LANES).filter(|lane| self.ends[*lane] == End::Open) {
            let at = Lane { linearized: &self.linearized, size: n, lane };
            let step = newton_step(&at, self.ranges, &mut vec![0.0; n]);
            for k in 0..n {
                self.steps[k][lane] = step.by[k] / self.ranges[k].width();
                let unknowns = (0..n).map(|column| self.residuals.input(column)[lane]);
                let size: f64 = unknowns.enumerate().map(|(c, p)| at.jacobian(k, c).abs() * p.abs().max(1.0)).sum();
                self.sharpness[k][lane] = 1.0 / (OF_SIZE * size).clamp(TOLERANCE, LARGEST_TOLERANCE);
            }
            self.least_pivot[lane] = if step.singular { 0.0 } else { 1.0 };
        }
    }

    fn copy_inputs_to_conditions(&mut self) {
        for k in 0..self.input_count {
            *self.conditions.input(k) = *self.residuals.input(k);
        }
    }
}

/// One lane of an evaluated system.
struct Lane<'e, 's> {
    linearized: &'e LaneEvaluator<'s>,
    size: usize,
    lane: usize,
}

impl Linearized for Lane<'_, '_> {
    fn residual(&self, row: usize) -> f64 {
        self.linearized.output(row)[self.lane]
    }

    fn jacobian(&self, row: usize, column: usize) -> f64 {
        self.linearized.output(self.size * (1 + row) + column)[self.lane]
    }
}

//! Newton on many points at once, without damping: points that need care are told, not solved.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::{InstructionSet, LANES, LaneEvaluator};

use crate::elimination::{Side, each, eliminate};
use crate::newton::{LARGEST_TOLERANCE, Linearized, OF_SIZE, TOLERANCE, newton_step};
use crate::solution::{Outcome, Range, verdict};
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

/// Of what else is wanted at a root (position, normal, …), as much must be finite.
pub(crate) const VITAL: usize = 6;
/// Lanes whose linear systems are solved side by side.
const GROUP: usize = 8;

pub(crate) type Lanes = [f64; LANES];

/// Solves up to [`LANES`] points of a system at once.
pub(crate) struct LaneNewton<'s> {
    ranges: &'s [Range],
    instructions: InstructionSet,
    /// Residuals, conditions and what else is wanted at a root.
    checked: LaneEvaluator<'s>,
    linearized: LaneEvaluator<'s>,
    condition_count: usize,
    /// Unknowns and parameters.
    input_count: usize,
    /// The last step of each unknown, as a share of its range.
    steps: Vec<Lanes>,
    /// One over the tolerance of each residual.
    sharpness: Vec<Lanes>,
    /// The largest residual, as it is and as a share of its tolerance.
    residual: Lanes,
    worst: Lanes,
    determinant: Lanes,
    least_pivot: Lanes,
    /// How far each lane has come from its start, as a share of the ranges.
    moved: Lanes,
    ends: [End; LANES],
    were_rough: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum End {
    /// Nothing is looked for in the lane.
    Idle,
    Open,
    Root,
    Lost,
}

impl<'s> LaneNewton<'s> {
    pub(crate) fn new(system: &'s System, ranges: &'s [Range], instructions: InstructionSet) -> LaneNewton<'s> {
        LaneNewton {
            ranges,
            instructions,
            checked: LaneEvaluator::new(&system.lanes.checked, instructions),
            linearized: LaneEvaluator::new(&system.lanes.linearized, instructions),
            condition_count: system.condition_count(),
            input_count: system.tape().input_count(),
            steps: vec![[0.0; LANES]; ranges.len()],
            sharpness: vec![[0.0; LANES]; ranges.len()],
            residual: [0.0; LANES],
            worst: [0.0; LANES],
            determinant: [f64::NAN; LANES],
            least_pivot: [0.0; LANES],
            moved: [0.0; LANES],
            ends: [End::Idle; LANES],
            were_rough: true,
        }
    }

    pub(crate) fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// An unknown (its start before a run, the root after it) or, after the unknowns, a parameter.
    pub(crate) fn input(&mut self, k: usize) -> &mut Lanes {
        self.checked.input(k)
    }

    /// Puts the unknowns and the parameters of a point into a lane.
    pub(crate) fn put(&mut self, lane: usize, unknowns: &[f64], parameters: &[f64]) {
        for (k, value) in unknowns.iter().chain(parameters).enumerate() {
            self.checked.input(k)[lane] = *value;
        }
    }

    /// Before a run the determinant at the start where it is known not to vanish around there, else NaN: then the lane takes
    /// one step at least. After it the one at the root. Scaled as in `newton_step`.
    pub(crate) fn determinant(&mut self) -> &mut Lanes {
        &mut self.determinant
    }

    /// Solves those of the first lanes that are `active`; gives the number of evaluations. Where starts are `rough` it begins with
    /// a step, without a look at whether it is needed.
    pub(crate) fn run(&mut self, active: &[bool], rough: bool) -> u64 {
        let count = active.len();
        self.sharpness.fill([1.0 / TOLERANCE; LANES]);
        self.moved = [0.0; LANES];
        self.ends = [End::Idle; LANES];
        let known = if rough { [false; LANES] } else { self.determinant.map(|determinant| !determinant.is_nan()) };
        let mut evaluations = 0;
        if !rough {
            self.measure(count);
            evaluations += active.iter().filter(|active| **active).count() as u64;
        }
        for lane in (0..count).filter(|lane| active[*lane]) {
            let is_root = known[lane] && self.worst[lane] <= PREDICTED;
            self.ends[lane] = if is_root { End::Root } else { End::Open };
        }
        self.were_rough = !rough && self.ends.contains(&End::Open);
        for round in 0..MOST_STEPS {
            let open = self.ends.iter().filter(|end| **end == End::Open).count() as u64;
            if open == 0 {
                break;
            }
            self.step(count);
            if rough && round == 0 {
                self.worst = self.worst_before_step();
                self.were_rough = (0..count).any(|lane| active[lane] && self.worst[lane] > PREDICTED);
            }
            let before = self.worst;
            self.advance();
            self.measure(count);
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
        evaluations
    }

    /// Whether a start of the last run was no root: the next ones are likely to need a step, too.
    pub(crate) fn were_rough(&self) -> bool {
        self.were_rough
    }

    /// The largest residual where the last step began, as a share of the tolerance.
    fn worst_before_step(&self) -> Lanes {
        let worst = |lane: usize| {
            let residuals = (0..self.ranges.len()).map(|row| self.linearized.output(row)[lane].abs());
            residuals.fold(0.0, f64::max) / TOLERANCE
        };
        std::array::from_fn(worst)
    }

    /// For the first lanes: by how much the tangent at the inputs leads away from them, as shares of the ranges. Not finite, or
    /// none, where there is no clear tangent.
    pub(crate) fn tangents(&mut self, count: usize) -> &[Lanes] {
        self.step(count);
        for lane in 0..count {
            if !self.is_clear(lane) {
                self.steps.iter_mut().for_each(|steps| steps[lane] = f64::NAN);
            }
        }
        &self.steps
    }

    /// Whether a lane has come to a root.
    pub(crate) fn is_root(&self, lane: usize) -> bool {
        self.ends[lane] == End::Root
    }

    /// Whether all of the first lanes have come to a root that is nothing special: near their starts, inside the ranges, with all
    /// conditions met and numbers for what else is wanted.
    pub(crate) fn all_plain(&mut self, count: usize, near: f64) -> bool {
        let vital = self.vital_outputs().end;
        let LaneNewton { ranges, instructions, checked, condition_count, moved, ends, .. } = self;
        if !ends[..count].iter().all(|end| *end == End::Root) {
            return false;
        }
        let n = ranges.len();
        instructions.dispatch(
            #[inline(always)]
            || {
                let mut is_plain = [true; LANES];
                for lane in 0..LANES {
                    is_plain[lane] &= moved[lane] <= near;
                }
                for (k, range) in ranges.iter().enumerate() {
                    let values = checked.input(k);
                    for lane in 0..LANES {
                        is_plain[lane] &= (range.low <= values[lane]) & (values[lane] <= range.high);
                    }
                }
                for k in n..vital {
                    let least = if k < n + *condition_count { 0.0 } else { f64::NEG_INFINITY };
                    let values = checked.output(k);
                    for lane in 0..LANES {
                        is_plain[lane] &= (least < values[lane]) & (values[lane] < f64::INFINITY);
                    }
                }
                is_plain[..count].iter().all(|is_plain| *is_plain)
            },
        )
    }

    /// How far a lane has come from its start, as a share of the ranges.
    pub(crate) fn moved(&self, lane: usize) -> f64 {
        self.moved[lane]
    }

    /// The largest residual of each lane.
    pub(crate) fn residuals(&self) -> &Lanes {
        &self.residual
    }

    /// What else was wanted at a root, by number.
    pub(crate) fn extra(&self, k: usize) -> &Lanes {
        self.checked.output(self.ranges.len() + self.condition_count + k)
    }

    /// Computes what is wanted at a root for the first lanes, whatever they hold.
    pub(crate) fn place(&mut self, count: usize) {
        self.checked.run_first(count);
    }

    /// Numbers of the outputs that must be finite.
    fn vital_outputs(&self) -> std::ops::Range<usize> {
        let first = self.ranges.len() + self.condition_count;
        first..self.checked.output_count().min(first + VITAL)
    }

    /// What the root of a lane is; singular also where what else is wanted is no number.
    pub(crate) fn outcome(&mut self, lane: usize) -> Outcome {
        let unknowns: Vec<f64> = (0..self.ranges.len()).map(|k| self.checked.input(k)[lane]).collect();
        let first = self.ranges.len();
        let extras = self.vital_outputs();
        match verdict(&unknowns, self.ranges, true, false) {
            Outcome::Solved if extras.into_iter().any(|k| !self.checked.output(k)[lane].is_finite()) => {
                Outcome::Singular
            }
            Outcome::Solved => side_of((0..self.condition_count).map(|k| self.checked.output(first + k)[lane])),
            other => other,
        }
    }

    /// Residuals at the unknowns.
    fn measure(&mut self, count: usize) {
        self.checked.run_first(count);
        let LaneNewton { instructions, checked, sharpness, worst, residual, .. } = self;
        (*worst, *residual) = ([0.0; LANES], [0.0; LANES]);
        instructions.dispatch(
            #[inline(always)]
            || {
                for (row, sharpness) in sharpness.iter().enumerate() {
                    let values = checked.output(row);
                    for lane in 0..LANES {
                        let size = values[lane].abs();
                        let share = size * sharpness[lane];
                        residual[lane] = if size > residual[lane] { size } else { residual[lane] };
                        // what is not a number stays so
                        let stays = (share <= worst[lane]) | worst[lane].is_nan();
                        worst[lane] = if stays { worst[lane] } else { share };
                    }
                }
            },
        );
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
            let value = self.checked.input(k)[lane];
            self.ranges[k].widened(value) == value
        });
        if !(inside && self.is_clear(lane)) {
            self.ends[lane] = End::Lost;
        }
    }

    /// Whether the Jacobian of the last step had an inverse, and not one that is only rounding.
    pub(crate) fn is_clear(&self, lane: usize) -> bool {
        // a comparison that fails for NaN, too
        self.least_pivot[lane] >= CLEAR_PIVOT
    }

    /// The step of Newton at the inputs, as shares of the ranges.
    fn step(&mut self, count: usize) {
        for k in 0..self.input_count {
            *self.linearized.input(k) = *self.checked.input(k);
        }
        self.linearized.run_first(count);
        match self.ranges.len() {
            1 => self.eliminate::<1>(count),
            2 => self.eliminate::<2>(count),
            3 => self.eliminate::<3>(count),
            4 => self.eliminate::<4>(count),
            5 => self.eliminate::<5>(count),
            _ => self.eliminate_one_by_one(count),
        }
    }

    /// Takes the step in the open lanes.
    fn advance(&mut self) {
        let mut longest = [0.0; LANES];
        for (k, steps) in self.steps.iter().enumerate() {
            let (unknowns, width) = (self.checked.input(k), self.ranges[k].width());
            for lane in 0..LANES {
                if self.ends[lane] == End::Open {
                    unknowns[lane] += steps[lane] * width;
                    longest[lane] = steps[lane].abs().max(longest[lane]);
                }
            }
        }
        for lane in 0..LANES {
            self.moved[lane] += longest[lane];
        }
    }

    /// The steps by elimination of N unknowns, scaled as in `newton_step`.
    fn eliminate<const N: usize>(&mut self, count: usize) {
        let LaneNewton {
            instructions, linearized, checked, ranges, steps, sharpness, determinant, least_pivot, ..
        } = self;
        let right: [&Lanes; N] = std::array::from_fn(|row| linearized.output(row));
        let jacobian: [[&Lanes; N]; N] =
            std::array::from_fn(|row| std::array::from_fn(|column| linearized.output(N * (1 + row) + column)));
        let unknowns: [Lanes; N] = std::array::from_fn(|k| *checked.input(k));
        instructions.dispatch(
            #[inline(always)]
            || {
                for first in (0..count).step_by(GROUP) {
                    let group = |lanes: &Lanes| -> Side<GROUP> { std::array::from_fn(|side| lanes[first + side]) };
                    let (mut j, mut b) = ([[[0.0; GROUP]; N]; N], [[0.0; GROUP]; N]);
                    let sizes = unknowns.each_ref().map(|lanes| group(lanes).map(|p| p.abs().max(1.0)));
                    for row in 0..N {
                        let (mut largest, mut size) = ([0.0; GROUP], [0.0; GROUP]);
                        for column in 0..N {
                            let entries = group(jacobian[row][column]);
                            let width = ranges[column].width();
                            j[row][column] = entries.map(|entry| entry * width);
                            largest = each(j[row][column], largest, |a, b| if a.abs() > b { a.abs() } else { b });
                            size = each(size, each(entries, sizes[column], |a, b| a.abs() * b), |a, b| a + b);
                        }
                        let weight = largest.map(|largest| 1.0 / largest);
                        for column in 0..N {
                            j[row][column] = each(j[row][column], weight, |a, b| a * b);
                        }
                        b[row] = each(group(right[row]), weight, |a, b| -a * b);
                        sharpness[row][first..][..GROUP].copy_from_slice(&size.map(|size| {
                            let allowed = OF_SIZE * size;
                            let allowed = if allowed > TOLERANCE { allowed } else { TOLERANCE };
                            1.0 / if allowed < LARGEST_TOLERANCE { allowed } else { LARGEST_TOLERANCE }
                        }));
                    }
                    let solved = eliminate(j, b);
                    for k in 0..N {
                        steps[k][first..][..GROUP].copy_from_slice(&solved.solution[k]);
                    }
                    determinant[first..][..GROUP].copy_from_slice(&solved.determinant);
                    least_pivot[first..][..GROUP].copy_from_slice(&solved.least_pivot);
                }
            },
        );
    }

    /// The same by the general path, for systems of any size. Determinants stay unknown.
    fn eliminate_one_by_one(&mut self, count: usize) {
        let n = self.ranges.len();
        self.determinant = [f64::NAN; LANES];
        for lane in 0..count {
            let at = Lane { linearized: &self.linearized, size: n, lane };
            let step = newton_step(&at, self.ranges, &mut vec![0.0; n]);
            for k in 0..n {
                self.steps[k][lane] = step.by[k] / self.ranges[k].width();
                let unknowns = (0..n).map(|column| self.checked.input(column)[lane]);
                let size: f64 = unknowns.enumerate().map(|(c, p)| at.jacobian(k, c).abs() * p.abs().max(1.0)).sum();
                self.sharpness[k][lane] = 1.0 / (OF_SIZE * size).clamp(TOLERANCE, LARGEST_TOLERANCE);
            }
            self.least_pivot[lane] = if step.singular { 0.0 } else { 1.0 };
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

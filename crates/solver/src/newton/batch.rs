//! Newton on many points at once, without damping: points that need care are told, not solved.

#![allow(clippy::needless_range_loop)] // several arrays are gone through in step

use flank_expr::{InstructionSet, LANES, LaneEvaluator, LaneTape};

use crate::equations::solution::{NEAR, Outcome, Range, distance, verdict};
use crate::equations::system::{Linearized, System, side_of};
use crate::equations::tolerance::{CLEAR, LARGEST_TOLERANCE, OF_SIZE, PREDICTED, TOLERANCE, VITAL};
use crate::newton::lines::Expected;
use crate::newton::scalar::Newton;

/// Steps after which a lane is left to the careful path.
const MOST_STEPS: usize = 5;
/// Newton stops below this share of the tolerance, or at the tolerance when a step no longer pays.
const POLISHED: f64 = 0.1;
pub(crate) type Lanes = [f64; LANES];

/// Solves up to [`LANES`] points of a system at once.
pub(crate) struct LaneNewton<'s> {
    ranges: &'s [Range],
    instructions: InstructionSet,
    /// Residuals, conditions and what else is wanted at a root.
    checked: LaneEvaluator<'s>,
    expected: Option<Expected<'s>>,
    linearized: LaneEvaluator<'s>,
    is_written_out: bool,
    /// Unknowns that the last outputs of `checked` give, whatever the inputs.
    given: &'s [usize],
    condition_count: usize,
    extra_count: usize,
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
    /// Whether the Jacobian of the last step had an inverse, and not one that is only rounding.
    is_clear: [bool; LANES],
    /// How far each lane has come from its start, as a share of the ranges.
    moved: Lanes,
    ends: [End; LANES],
    were_rough: bool,
    /// Room for the unknowns of a lane.
    unknowns: Vec<f64>,
    /// Room for the targets of lines.
    targets: Vec<[Lanes; 2]>,
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
    pub(crate) fn new(system: &'s System, ranges: &'s [Range]) -> LaneNewton<'s> {
        LaneNewton::on(system, ranges, system.instructions())
    }

    /// The same with other instructions than the system says.
    pub(crate) fn on(system: &'s System, ranges: &'s [Range], instructions: InstructionSet) -> LaneNewton<'s> {
        let tapes = (&system.lanes.checked, &[][..], system.lanes.expected.as_ref());
        LaneNewton::with_tapes(system, ranges, tapes, instructions)
    }

    /// The same with unknowns in closed form where equations give them; none if they give none.
    pub(crate) fn with_given(
        system: &'s System,
        ranges: &'s [Range],
        instructions: InstructionSet,
    ) -> Option<LaneNewton<'s>> {
        let given = system.lanes.given.as_ref()?;
        let tapes = (&given.checked, given.unknowns.as_slice(), given.expected.as_ref());
        Some(LaneNewton::with_tapes(system, ranges, tapes, instructions))
    }

    fn with_tapes(
        system: &'s System,
        ranges: &'s [Range],
        (checked, given, expected): (&'s LaneTape, &'s [usize], Option<&'s LaneTape>),
        instructions: InstructionSet,
    ) -> LaneNewton<'s> {
        let mut linearized = LaneEvaluator::new(&system.lanes.linearized, instructions);
        let input_count = system.tape().input_count();
        let is_written_out = system.lanes.is_written_out;
        let expected = expected.map(|tape| Expected::new(tape, instructions, ranges, input_count, given));
        let mut checked = LaneEvaluator::new(checked, instructions);
        for (k, range) in ranges.iter().enumerate() {
            let width = (input_count + k, range.width());
            if is_written_out {
                linearized.set_uniform(width.0, width.1);
            }
            if !given.is_empty() {
                checked.set_uniform(width.0, width.1);
            }
        }
        LaneNewton {
            ranges,
            instructions,
            checked,
            expected,
            linearized,
            is_written_out,
            given,
            condition_count: system.condition_count(),
            extra_count: system.extra_count(),
            input_count,
            steps: vec![[0.0; LANES]; ranges.len()],
            sharpness: vec![[1.0 / TOLERANCE; LANES]; ranges.len()],
            residual: [0.0; LANES],
            worst: [0.0; LANES],
            determinant: [f64::NAN; LANES],
            is_clear: [false; LANES],
            moved: [0.0; LANES],
            ends: [End::Idle; LANES],
            were_rough: true,
            unknowns: Vec::new(),
            targets: Vec::new(),
        }
    }

    pub(crate) fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// What looks at whole lines where they are expected; none where equations give all unknowns.
    pub(crate) fn expected(&mut self) -> Option<&mut Expected<'s>> {
        self.expected.as_mut()
    }

    /// Room for the targets of lines.
    pub(crate) fn targets(&mut self) -> &mut Vec<[Lanes; 2]> {
        &mut self.targets
    }

    /// An unknown (its start before a run, the root after it) or, after the unknowns, a parameter.
    pub(crate) fn input(&mut self, k: usize) -> &mut Lanes {
        self.checked.input(k)
    }

    /// Puts the unknowns and the parameters of a point into a lane.
    pub(crate) fn put(&mut self, lane: usize, unknowns: impl Iterator<Item = f64>, parameters: &[f64]) {
        for (k, value) in unknowns.chain(parameters.iter().copied()).enumerate() {
            self.checked.input(k)[lane] = value;
        }
    }

    /// Whether an unknown is given in closed form: what it is before a run has no effect.
    pub(crate) fn is_given(&self, unknown: usize) -> bool {
        self.given.contains(&unknown)
    }

    /// Whether what is given at a root comes out near it, as a root.
    pub(crate) fn leads_to(&mut self, unknowns: &[f64], parameters: &[f64]) -> bool {
        self.put(0, unknowns.iter().copied(), parameters);
        self.sharpness.fill([1.0 / TOLERANCE; LANES]);
        self.measure(1);
        let found: Vec<f64> = (0..unknowns.len()).map(|k| self.checked.input(k)[0]).collect();
        self.worst[0] <= 1.0 && distance(unknowns, &found, self.ranges) <= NEAR
    }

    /// Whether all of them are.
    pub(crate) fn has_all_given(&self) -> bool {
        self.given.len() == self.ranges.len()
    }

    /// Before a run the determinant at the start where it is known not to vanish around there, else NaN: then the lane takes
    /// one step at least. After it the one at the root. Scaled as in [`Newton::step`]. Where all unknowns are given only its sign
    /// counts: the root must be on that side of where the determinant vanishes.
    pub(crate) fn determinant(&mut self) -> &mut Lanes {
        &mut self.determinant
    }

    /// Solves those of the first lanes that are `active`; gives the number of evaluations. Where starts are `rough` it begins with
    /// a step, without a look at whether it is needed.
    pub(crate) fn run(&mut self, active: &[bool], rough: bool) -> u64 {
        let count = active.len();
        // what is given is no rough start
        let rough = rough && !self.has_all_given();
        self.sharpness.fill([1.0 / TOLERANCE; LANES]);
        self.moved = [0.0; LANES];
        self.ends = [End::Idle; LANES];
        let mut evaluations = 0;
        let mut open = active.iter().filter(|active| **active).count() as u64;
        if rough {
            self.ends[..count].fill(End::Open);
        } else {
            self.measure(count);
            evaluations += open;
            let is_root = self.are_predicted();
            if is_root[..count].iter().all(|is_root| *is_root) && open == count as u64 {
                self.ends[..count].fill(End::Root);
                self.were_rough = false;
                return evaluations;
            }
            self.ends = is_root.map(|is_root| if is_root { End::Root } else { End::Open });
            self.ends[count..].fill(End::Idle);
        }
        for lane in (0..count).filter(|lane| !active[*lane]) {
            self.ends[lane] = End::Idle;
        }
        for round in 0..MOST_STEPS {
            open = if rough && round == 0 { open } else { self.open_lanes() };
            if round == 0 {
                self.were_rough = open > 0;
            }
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
            self.judge(&before, count);
        }
        for lane in 0..count {
            if self.ends[lane] == End::Open {
                self.ends[lane] = if self.worst[lane] <= 1.0 { End::Root } else { End::Lost };
            }
        }
        evaluations
    }

    /// Where what was measured is a root, so that no step is needed.
    fn are_predicted(&mut self) -> [bool; LANES] {
        self.take_given_determinant();
        let LaneNewton { instructions, worst, determinant, .. } = self;
        // a determinant that is not known is no number
        instructions.dispatch(
            #[inline(always)]
            || each_lane(|lane| (worst[lane] <= PREDICTED) & !determinant[lane].is_nan()),
        )
    }

    /// Where all unknowns are given, so is the determinant: a number only if it is clear and has the sign that it had before.
    fn take_given_determinant(&mut self) {
        if !self.has_all_given() {
            return;
        }
        let LaneNewton { instructions, checked, determinant, .. } = self;
        let given = checked.output(checked.output_count() - 1);
        instructions.dispatch(
            #[inline(always)]
            || {
                for lane in 0..LANES {
                    let is_clear = (given[lane].abs() >= CLEAR) & (given[lane] * determinant[lane] > 0.0);
                    determinant[lane] = if is_clear { given[lane] } else { f64::NAN };
                }
            },
        );
    }

    fn open_lanes(&self) -> u64 {
        self.ends.iter().filter(|end| **end == End::Open).count() as u64
    }

    /// Whether a start of the last run was no root: the next ones are likely to need a step, too.
    pub(crate) fn were_rough(&self) -> bool {
        self.were_rough
    }

    /// The largest residual where the last step began, as a share of the tolerance.
    fn worst_before_step(&self) -> Lanes {
        let mut worst = [0.0; LANES];
        for row in 0..self.ranges.len() {
            let residuals = self.linearized.output(row);
            for lane in 0..LANES {
                let share = residuals[lane].abs() * (1.0 / TOLERANCE);
                worst[lane] = if share > worst[lane] { share } else { worst[lane] };
            }
        }
        worst
    }

    /// For the first lanes: by how much the tangent at the inputs leads away from them, as shares of the ranges. Not finite, or
    /// none, where there is no clear tangent.
    pub(crate) fn tangents(&mut self, count: usize) -> &[Lanes] {
        self.step(count);
        for lane in 0..count {
            if !self.is_clear[lane] {
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
        let vital = (self.extra_count > 0).then(|| self.first_given() - 1);
        let LaneNewton { ranges, instructions, checked, condition_count, moved, ends, .. } = self;
        if !ends[..count].iter().all(|end| *end == End::Root) {
            return false;
        }
        let n = ranges.len();
        let is_plain = instructions.dispatch(
            #[inline(always)]
            || {
                // how far they are out of bounds, the least condition, and a sum of zeros with what is not finite
                let (mut excess, mut least, mut zero) = ([0.0; LANES], [f64::INFINITY; LANES], [0.0; LANES]);
                for lane in 0..LANES {
                    excess[lane] = moved[lane] - near;
                }
                for (k, range) in ranges.iter().enumerate() {
                    let values = checked.input(k);
                    for lane in 0..LANES {
                        let (below, above) = (range.low - values[lane], values[lane] - range.high);
                        let outside = if below > above { below } else { above };
                        excess[lane] = if outside > excess[lane] { outside } else { excess[lane] };
                        zero[lane] += 0.0 * values[lane];
                    }
                }
                for k in n..n + *condition_count {
                    let values = checked.output(k);
                    for lane in 0..LANES {
                        least[lane] = if values[lane] < least[lane] { values[lane] } else { least[lane] };
                        zero[lane] += 0.0 * values[lane];
                    }
                }
                if let Some(vital) = vital {
                    let values = checked.output(vital);
                    for lane in 0..LANES {
                        zero[lane] += 0.0 * values[lane];
                    }
                }
                each_lane(|lane| (excess[lane] <= 0.0) & (least[lane] > 0.0) & (zero[lane] == 0.0))
            },
        );
        is_plain[..count].iter().fold(true, |all, is_plain| all & is_plain)
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

    /// Computes what is wanted at a root for the first lanes, which hold it, but for what is given.
    pub(crate) fn place(&mut self, count: usize) {
        self.checked.run_first(count);
    }

    /// The output after all that is wanted at a root and the sum of what must be finite, if anything is.
    fn first_given(&self) -> usize {
        self.ranges.len() + self.condition_count + self.extra_count + usize::from(self.extra_count > 0)
    }

    /// Numbers of the outputs that must be finite.
    fn vital_outputs(&self) -> std::ops::Range<usize> {
        let first = self.ranges.len() + self.condition_count;
        first..first + self.extra_count.min(VITAL)
    }

    /// What the root of a lane is; singular also where what else is wanted is no number.
    pub(crate) fn outcome(&mut self, lane: usize) -> Outcome {
        let mut unknowns = std::mem::take(&mut self.unknowns);
        unknowns.clear();
        unknowns.extend((0..self.ranges.len()).map(|k| self.checked.input(k)[lane]));
        let outcome = self.outcome_at(&unknowns, lane);
        self.unknowns = unknowns;
        outcome
    }

    fn outcome_at(&self, unknowns: &[f64], lane: usize) -> Outcome {
        let first = self.ranges.len();
        let extras = self.vital_outputs();
        match verdict(unknowns, self.ranges, true, false) {
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
        let first = self.first_given();
        for (k, unknown) in self.given.iter().enumerate() {
            *self.checked.input(*unknown) = *self.checked.output(first + k);
        }
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

    /// What has become of the open lanes after a step.
    fn judge(&mut self, before: &Lanes, count: usize) {
        let LaneNewton { instructions, ranges, checked, worst, ends, is_clear, .. } = self;
        let (is_done, is_lost) = instructions.dispatch(
            #[inline(always)]
            || {
                let is_done = each_lane(|lane| {
                    (worst[lane] <= POLISHED) | (worst[lane] <= 1.0) & (worst[lane] >= 0.5 * before[lane])
                });
                let mut is_lost = is_clear.map(|is_clear| !is_clear);
                for (k, range) in ranges.iter().enumerate() {
                    let (values, wider) = (checked.input(k), range.wide());
                    for lane in 0..LANES {
                        is_lost[lane] |= !((wider.low <= values[lane]) & (values[lane] <= wider.high));
                    }
                }
                (is_done, is_lost)
            },
        );
        for lane in 0..count {
            if ends[lane] == End::Open {
                ends[lane] = match (is_lost[lane], is_done[lane]) {
                    (true, _) => End::Lost,
                    (false, true) => End::Root,
                    (false, false) => End::Open,
                };
            }
        }
    }

    /// Whether the Jacobian of the last step had an inverse, and not one that is only rounding.
    pub(crate) fn is_clear(&self, lane: usize) -> bool {
        self.is_clear[lane]
    }

    /// The step of Newton at the inputs, as shares of the ranges.
    fn step(&mut self, count: usize) {
        for k in 0..self.input_count {
            *self.linearized.input(k) = *self.checked.input(k);
        }
        self.linearized.run_first(count);
        if !self.is_written_out {
            return self.eliminate_one_by_one(count);
        }
        let n = self.ranges.len();
        for k in 0..n {
            self.steps[k] = *self.linearized.output(n + k);
            self.sharpness[k] = *self.linearized.output(2 * n + k);
        }
        self.determinant = *self.linearized.output(3 * n);
        // not where it is no number
        self.is_clear = self.determinant.map(|determinant| determinant.abs() >= CLEAR);
    }

    /// Takes the step in the open lanes.
    fn advance(&mut self) {
        let LaneNewton { instructions, ranges, checked, steps, moved, ends, .. } = self;
        let takes = ends.map(|end| if end == End::Open { 1.0 } else { 0.0 });
        instructions.dispatch(
            #[inline(always)]
            || {
                let mut longest = [0.0; LANES];
                for (k, (steps, range)) in steps.iter().zip(ranges.iter()).enumerate() {
                    let (unknowns, width) = (checked.input(k), range.width());
                    for lane in 0..LANES {
                        let moved = unknowns[lane] + steps[lane] * width;
                        unknowns[lane] = if takes[lane] > 0.0 { moved } else { unknowns[lane] };
                        let size = if takes[lane] > 0.0 { steps[lane].abs() } else { 0.0 };
                        longest[lane] = if size > longest[lane] { size } else { longest[lane] };
                    }
                }
                for lane in 0..LANES {
                    moved[lane] += longest[lane];
                }
            },
        );
    }

    /// The step by the general path, for systems of any size. Determinants stay unknown.
    fn eliminate_one_by_one(&mut self, count: usize) {
        let n = self.ranges.len();
        self.determinant = [f64::NAN; LANES];
        for lane in 0..count {
            let at = Lane { linearized: &self.linearized, size: n, lane };
            let step = Newton::new(n).step(&at, self.ranges);
            for k in 0..n {
                self.steps[k][lane] = step.by[k] / self.ranges[k].width();
                let unknowns = (0..n).map(|column| self.checked.input(column)[lane]);
                let size: f64 = unknowns.enumerate().map(|(c, p)| at.jacobian(k, c).abs() * p.abs().max(1.0)).sum();
                self.sharpness[k][lane] = 1.0 / (OF_SIZE * size).clamp(TOLERANCE, LARGEST_TOLERANCE);
            }
            self.is_clear[lane] = !step.singular;
        }
    }
}

#[inline(always)]
fn each_lane(is_so: impl Fn(usize) -> bool) -> [bool; LANES] {
    let mut result = [false; LANES];
    for lane in 0..LANES {
        result[lane] = is_so(lane);
    }
    result
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

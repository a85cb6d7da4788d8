//! Square systems with their exact Jacobian, as one tape.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use flank_expr::{Expr, InstructionSet, LaneEvaluator, LaneTape, ScalarEvaluator, Tape, TapeError};

use crate::equations::lines;
use crate::equations::runner::Runner;
use crate::equations::solution::{CutBy, Outcome};
use crate::equations::step::{GivenTapes, MOST_EQUATIONS, RootOutputs, written_out};

/// Points at which a system is evaluated one by one before it is translated to machine code, which costs as much as some twenty of them.
const BEFORE_TRANSLATED: u64 = 64;
/// Points in grids that a system has been solved at before its machine code is laid out in an order that waits less. That takes some
/// 0.3 ms for a tape of 600 steps, and saves 1 to 2 ns a point.
const BEFORE_ORDERED: u64 = 100_000;
/// Bytes of a grid's numbers from which on machine code writes them past the caches. Those that are not read again in between: more than
/// a core has for itself. Those from which others are predicted soon: more than is left of a cache that cores share.
pub(crate) const WRITTEN_ONCE: usize = 8 << 20;
pub(crate) const READ_AGAIN: usize = 20 << 20;

/// As many equations as unknowns, with parameters that are given for each solution.
#[derive(Clone, Debug)]
pub struct System {
    size: usize,
    tape: Tape,
    residuals: Tape,
    /// What must be positive at a root for it to be one of the thing that is looked for.
    conditions: Tape,
    pub(crate) lanes: LaneTapes,
    /// Residuals, then the Jacobian row by row, for many points at once: laid out when it is wanted first.
    in_lanes: OnceLock<LaneTape>,
    singly: Count,
    in_grids: Count,
    extra_count: usize,
    instructions: InstructionSet,
}

/// Points at which a system was evaluated.
#[derive(Debug, Default)]
struct Count(AtomicU64);

impl Clone for Count {
    fn clone(&self) -> Count {
        Count(AtomicU64::new(self.get()))
    }
}

impl Count {
    fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }

    fn add(&self, points: u64) {
        self.0.fetch_add(points, Ordering::Relaxed);
    }
}

/// The same for many points at once; all take unknowns, then parameters.
#[derive(Clone, Debug)]
pub(crate) struct LaneTapes {
    /// Residuals, conditions, and what else is wanted at a root, with what these have in common; then the sum of what must be finite
    /// of that, if anything is wanted.
    pub(crate) checked: LaneTape,
    /// The step of Newton, see [`written_out`]; residuals, then the Jacobian row by row where it is not written out.
    pub(crate) linearized: LaneTape,
    pub(crate) is_written_out: bool,
    /// For lines of points that are expected somewhere, see [`lines::expected`]; none if an equation gives an unknown.
    pub(crate) expected: Option<LaneTape>,
    pub(crate) given: Option<GivenTapes>,
}

impl LaneTapes {
    fn translate(&self, instructions: InstructionSet) {
        let LaneTapes { checked, linearized, is_written_out: _, expected, given } = self;
        let given = given.iter().flat_map(|given| given.tapes());
        [checked, linearized].into_iter().chain(expected).chain(given).for_each(|tape| tape.translate(instructions));
    }

    fn with_settings(&self, values: &[f64]) -> LaneTapes {
        LaneTapes {
            checked: self.checked.with_settings(values),
            linearized: self.linearized.with_settings(values),
            is_written_out: self.is_written_out,
            expected: self.expected.as_ref().map(|tape| tape.with_settings(values)),
            given: self.given.as_ref().map(|given| given.with_settings(values)),
        }
    }
}

impl System {
    /// The system `residuals = 0` in `unknowns`; `parameters` are given numbers for each solution.
    ///
    /// # Errors
    /// If a residual depends on a variable that is neither an unknown nor a parameter.
    ///
    /// # Panics
    /// If there are not as many residuals as unknowns.
    pub fn new<'g>(
        residuals: &[Expr<'g>],
        unknowns: &[Expr<'g>],
        parameters: &[Expr<'g>],
    ) -> Result<System, TapeError> {
        if unknowns.len() > MOST_EQUATIONS || unknowns.is_empty() {
            return System::one_by_one(residuals, unknowns, parameters);
        }
        System::laid_out(residuals, unknowns, parameters, true)
    }

    /// The same without what makes many points at once fast.
    ///
    /// # Errors
    /// As for [`System::new`].
    ///
    /// # Panics
    /// As for [`System::new`].
    pub(crate) fn one_by_one(
        residuals: &[Expr<'_>],
        unknowns: &[Expr<'_>],
        parameters: &[Expr<'_>],
    ) -> Result<System, TapeError> {
        System::laid_out(residuals, unknowns, parameters, false)
    }

    /// The same; the steps of many points at once are written out, or solved for from the Jacobian.
    fn laid_out<'g>(
        residuals: &[Expr<'g>],
        unknowns: &[Expr<'g>],
        parameters: &[Expr<'g>],
        is_written_out: bool,
    ) -> Result<System, TapeError> {
        assert_eq!(residuals.len(), unknowns.len(), "a system is square");
        let jacobian = residuals.iter().flat_map(|f| unknowns.iter().map(|x| f.derivative(*x)));
        let outputs: Vec<Expr<'_>> = residuals.iter().copied().chain(jacobian).collect();
        let inputs: Vec<Expr<'_>> = unknowns.iter().chain(parameters).copied().collect();
        let (tape, conditions) = (Tape::new(&outputs, &inputs)?, Tape::new(&[], &inputs)?);
        let linearized =
            if is_written_out { written_out(residuals, unknowns, parameters)? } else { LaneTape::new(&tape) };
        let residuals = Tape::new(residuals, &inputs)?;
        let checked = LaneTape::new(&residuals);
        let lanes = LaneTapes { checked, linearized, is_written_out, expected: None, given: None };
        let instructions = InstructionSet::fastest();
        let [singly, in_grids] = [Count::default(), Count::default()];
        let size = unknowns.len();
        Ok(System {
            size,
            tape,
            residuals,
            conditions,
            lanes,
            in_lanes: OnceLock::new(),
            singly,
            in_grids,
            extra_count: 0,
            instructions,
        })
    }

    /// The same system, whose roots are cut away by the tool ([`CutBy::ItsTool`]) where one of `conditions`, functions of
    /// the unknowns and parameters it was made with, is negative, and singular where one is zero. `extras` are computed at
    /// the roots of a grid, where unknowns have a closed form if an equation is linear in them.
    ///
    /// # Errors
    /// If a condition depends on another variable.
    pub(crate) fn with_conditions<'g>(
        self,
        residuals: &[Expr<'g>],
        conditions: &[Expr<'g>],
        extras: &[Expr<'g>],
        inputs: &[Expr<'g>],
    ) -> Result<System, TapeError> {
        let wanted = RootOutputs { residuals, conditions, extras };
        let (unknowns, parameters) = inputs.split_at(self.size);
        let checked = LaneTape::new(&Tape::of_numbers(&wanted.all(), inputs, &[])?);
        let is_written_out = self.lanes.is_written_out;
        let given = || GivenTapes::new(&wanted, unknowns, parameters);
        let given = if is_written_out { given()? } else { None };
        let is_expected = is_written_out && given.is_none();
        let expected = is_expected.then(|| lines::expected(&wanted, &[], [unknowns, parameters])).transpose()?;
        let conditions = Tape::new(conditions, inputs)?;
        let lanes = LaneTapes { checked, expected, given, ..self.lanes };
        Ok(System { conditions, lanes, extra_count: extras.len(), ..self })
    }

    /// The same system, for whose grids only these instructions are used: without machine code of its own, say. The results are
    /// the same, bit for bit.
    pub fn with_instruction_set(self, instructions: InstructionSet) -> System {
        System { instructions, ..self }
    }

    /// Makes the machine code of its tapes, which those with other settings share.
    pub(crate) fn translate(&self) {
        self.lanes.translate(self.instructions);
    }

    /// The same system with other numbers for the settings of its tapes.
    pub(crate) fn with_settings(&self, values: &[f64]) -> System {
        System {
            tape: self.tape.with_settings(values),
            residuals: self.residuals.with_settings(values),
            conditions: self.conditions.with_settings(values),
            lanes: self.lanes.with_settings(values),
            in_lanes: self
                .in_lanes
                .get()
                .map(|tape| tape.with_settings(values))
                .map_or_else(OnceLock::new, OnceLock::from),
            singly: self.singly.clone(),
            in_grids: self.in_grids.clone(),
            ..*self
        }
    }

    pub(crate) fn instructions(&self) -> InstructionSet {
        self.instructions
    }

    /// The instructions for the strips of a grid with so many points, whose numbers go past the caches from so many bytes on.
    pub(crate) fn instructions_on(&self, points: usize, past_caches: usize) -> InstructionSet {
        self.in_grids.add(points as u64);
        // unknowns, determinant and residual, and what else is wanted
        if points * (self.size + 2 + self.extra_count) * size_of::<f64>() >= past_caches {
            self.instructions.past_caches()
        } else if self.in_grids.get() >= BEFORE_ORDERED {
            self.instructions.for_many()
        } else {
            self.instructions
        }
    }

    pub(crate) fn condition_count(&self) -> usize {
        self.conditions.output_count()
    }

    /// Numbers that are wanted at a root beside the unknowns.
    pub(crate) fn extra_count(&self) -> usize {
        self.extra_count
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// The tape: unknowns, then parameters in; residuals, then the Jacobian row by row out.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// The tape of the residuals alone, with the same inputs.
    pub(crate) fn residual_tape(&self) -> &Tape {
        &self.residuals
    }

    /// Something that computes residuals and Jacobian at many points at once.
    pub(crate) fn in_lanes(&self) -> LaneEvaluator<'_> {
        LaneEvaluator::new(self.lane_tape(), self.instructions)
    }

    fn lane_tape(&self) -> &LaneTape {
        self.in_lanes.get_or_init(|| LaneTape::new(&self.tape))
    }

    /// What computes residuals and Jacobian at one point after the other, as machine code where there is any.
    fn translated(&self) -> Runner<'_> {
        Runner::new(&self.tape, self.lane_tape(), self.instructions)
    }

    /// Something that tells what roots at one set of parameters are.
    pub(crate) fn conditions(&self, parameters: &[f64]) -> Conditions<'_> {
        Conditions {
            evaluator: ScalarEvaluator::new(&self.conditions),
            size: self.size,
            inputs: [&vec![0.0; self.size], parameters].concat(),
            met: vec![0.0; self.conditions.output_count()],
        }
    }

    /// Something that evaluates it at one set of parameters.
    pub(crate) fn evaluation(&self, parameters: &[f64]) -> Evaluation<'_> {
        let mut inputs = vec![0.0; self.size];
        inputs.extend_from_slice(parameters);
        let outputs = vec![0.0; self.tape.output_count()];
        let is_often = self.singly.get() >= BEFORE_TRANSLATED;
        Evaluation {
            system: self,
            runner: if is_often { self.translated() } else { Runner::Scalar(ScalarEvaluator::new(&self.tape)) },
            is_counted: !is_often,
            conditions: self.conditions(parameters),
            size: self.size,
            inputs,
            outputs,
        }
    }
}

/// Residuals and Jacobian at a point.
pub(crate) trait Linearized {
    fn residual(&self, row: usize) -> f64;
    fn jacobian(&self, row: usize, column: usize) -> f64;
}

/// Residuals and Jacobian at a point.
pub(crate) struct Evaluation<'s> {
    system: &'s System,
    runner: Runner<'s>,
    /// Whether it is still open if the system is evaluated often.
    is_counted: bool,
    /// At the same parameters.
    pub(crate) conditions: Conditions<'s>,
    size: usize,
    inputs: Vec<f64>,
    outputs: Vec<f64>,
}

/// Tells what a root is by the conditions of its system.
pub(crate) struct Conditions<'s> {
    evaluator: ScalarEvaluator<'s>,
    size: usize,
    inputs: Vec<f64>,
    met: Vec<f64>,
}

impl Conditions<'_> {
    pub(crate) fn side(&mut self, root: &[f64]) -> Outcome {
        self.inputs[..self.size].copy_from_slice(root);
        self.evaluator.run(&self.inputs, &mut self.met);
        side_of(self.met.iter().copied())
    }

    pub(crate) fn set_parameters(&mut self, parameters: &[f64]) {
        self.inputs[self.size..].copy_from_slice(parameters);
    }
}

impl<'s> Evaluation<'s> {
    pub(crate) fn system(&self) -> &'s System {
        self.system
    }

    pub(crate) fn parameters(&self) -> &[f64] {
        &self.inputs[self.size..]
    }

    pub(crate) fn at(&mut self, unknowns: &[f64]) {
        if self.is_counted {
            self.system.singly.add(1);
            if self.system.singly.get() >= BEFORE_TRANSLATED {
                (self.runner, self.is_counted) = (self.system.translated(), false);
            }
        }
        self.inputs[..self.size].copy_from_slice(unknowns);
        self.runner.run(&self.inputs, &mut self.outputs);
    }

    pub(crate) fn set_parameters(&mut self, parameters: &[f64]) {
        self.inputs[self.size..].copy_from_slice(parameters);
        self.conditions.set_parameters(parameters);
    }
}

impl Linearized for Evaluation<'_> {
    fn residual(&self, row: usize) -> f64 {
        self.outputs[row]
    }

    fn jacobian(&self, row: usize, column: usize) -> f64 {
        self.outputs[self.size * (1 + row) + column]
    }
}

/// What a root is where the conditions of its system have these values.
pub(crate) fn side_of(conditions: impl Iterator<Item = f64> + Clone) -> Outcome {
    if conditions.clone().any(|condition| condition < 0.0) {
        Outcome::CutAway(CutBy::ItsTool)
    } else if conditions.clone().all(|condition| condition > 0.0) {
        Outcome::Solved
    } else {
        Outcome::Singular
    }
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;

    use super::*;

    #[test]
    fn a_system_has_the_same_bits_once_it_is_translated() {
        let graph = Graph::new();
        let [x, y, c] = ["x", "y", "c"].map(|name| graph.variable(name));
        let residuals = [x.sin() * y + c / (x + 3.0), (x * x + y.exp()).sqrt() - c.cos()];
        let system = System::new(&residuals, &[x, y], &[c]).expect("nothing is unbound");
        let numbers = |often: &mut Evaluation<'_>, k: u64| {
            let k = k as f64;
            often.at(&[0.1 * k, 1.0 - 0.07 * k]);
            often.outputs.iter().map(|value| value.to_bits()).collect::<Vec<u64>>()
        };
        let mut often = system.evaluation(&[0.8]);
        assert!(often.is_counted);
        for k in 0..2 * BEFORE_TRANSLATED {
            let once = System::new(&residuals, &[x, y], &[c]).expect("nothing is unbound");
            let mut once = once.evaluation(&[0.8]);
            assert_eq!(numbers(&mut often, k), numbers(&mut once, k));
            assert!(matches!(once.runner, Runner::Scalar(_)));
        }
        assert!(!often.is_counted && !system.evaluation(&[0.8]).is_counted);
    }

    #[test]
    fn machine_code_is_laid_out_for_many_points_once_there_were_many() {
        let graph = Graph::new();
        let [x, c] = ["x", "c"].map(|name| graph.variable(name));
        let system = System::new(&[x.sin() - c], &[x], &[c]).expect("nothing is unbound");
        let has_code = system.instructions().machine_code().is_some();
        let half = BEFORE_ORDERED as usize / 2;
        assert!(!system.instructions_on(half, READ_AGAIN).is_for_many());
        assert_eq!(system.instructions_on(half, READ_AGAIN).is_for_many(), has_code);
        // cases of other settings have their points counted on
        assert_eq!(system.with_settings(&[]).instructions_on(1, READ_AGAIN).is_for_many(), has_code);
        assert!(!system.with_instruction_set(InstructionSet::widest()).instructions_on(1, READ_AGAIN).is_for_many());
    }
}

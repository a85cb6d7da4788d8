//! Tapes that run at one place after the other, or at many at once.

use flank_expr::{InstructionSet, LaneEvaluator, LaneTape, ScalarEvaluator, Tape};

/// Runs a tape: as machine code where there is any, of whose lanes the first is used, else instruction by instruction. Both give the
/// same bits.
pub(crate) enum Runner<'t> {
    MachineCode(LaneEvaluator<'t>),
    Scalar(ScalarEvaluator<'t>),
}

impl<'t> Runner<'t> {
    /// Of a tape, and the same one laid out for many places.
    pub(crate) fn new(tape: &'t Tape, lanes: &'t LaneTape, instructions: InstructionSet) -> Runner<'t> {
        let lanes = LaneEvaluator::new(lanes, instructions);
        if lanes.has_machine_code() { Runner::MachineCode(lanes) } else { Runner::Scalar(ScalarEvaluator::new(tape)) }
    }

    /// Something that runs many places at once, where that is faster.
    pub(crate) fn lanes(&mut self) -> Option<&mut LaneEvaluator<'t>> {
        match self {
            Runner::MachineCode(lanes) => Some(lanes),
            Runner::Scalar(_) => None,
        }
    }

    pub(crate) fn run(&mut self, inputs: &[f64], outputs: &mut [f64]) {
        match self {
            Runner::MachineCode(lanes) => lanes.run_at(inputs, outputs),
            Runner::Scalar(evaluator) => evaluator.run(inputs, outputs),
        }
    }
}

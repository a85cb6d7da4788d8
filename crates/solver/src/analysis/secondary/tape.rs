//! Tapes that run at one place after the other, or at many at once.

use flank_expr::{Expr, InstructionSet, LaneEvaluator, LaneTape, ScalarEvaluator, Tape, TapeError};

/// A tape that may be run often enough to pay for machine code.
#[derive(Clone, Debug)]
pub(super) struct PlaceTape {
    tape: Tape,
    lanes: LaneTape,
}

/// Runs a tape: as machine code where there is any, of whose lanes the first is used, else instruction by instruction. Both give the
/// same bits.
pub(super) enum Runner<'t> {
    MachineCode(LaneEvaluator<'t>),
    Scalar(ScalarEvaluator<'t>),
}

impl PlaceTape {
    pub(super) fn new(outputs: &[Expr<'_>], inputs: &[Expr<'_>]) -> Result<PlaceTape, TapeError> {
        let tape = Tape::new(outputs, inputs)?;
        Ok(PlaceTape { lanes: LaneTape::new(&tape), tape })
    }

    pub(super) fn with_settings(&self, values: &[f64]) -> PlaceTape {
        PlaceTape { tape: self.tape.with_settings(values), lanes: self.lanes.with_settings(values) }
    }

    pub(super) fn uses_settings(&self) -> bool {
        self.tape.uses_settings()
    }

    pub(super) fn translate(&self) {
        self.lanes.translate(InstructionSet::fastest());
    }

    pub(super) fn output_count(&self) -> usize {
        self.tape.output_count()
    }

    pub(super) fn runner(&self) -> Runner<'_> {
        let lanes = LaneEvaluator::new(&self.lanes, InstructionSet::fastest());
        if lanes.has_machine_code() {
            Runner::MachineCode(lanes)
        } else {
            Runner::Scalar(ScalarEvaluator::new(&self.tape))
        }
    }
}

impl<'t> Runner<'t> {
    /// Something that runs many places at once, where that is faster.
    pub(super) fn lanes(&mut self) -> Option<&mut LaneEvaluator<'t>> {
        match self {
            Runner::MachineCode(lanes) => Some(lanes),
            Runner::Scalar(_) => None,
        }
    }

    pub(super) fn run(&mut self, inputs: &[f64], outputs: &mut [f64]) {
        match self {
            Runner::MachineCode(lanes) => {
                inputs.iter().enumerate().for_each(|(k, value)| lanes.input(k)[0] = *value);
                lanes.run_first(1);
                outputs.iter_mut().enumerate().for_each(|(k, value)| *value = lanes.output(k)[0]);
            }
            Runner::Scalar(evaluator) => evaluator.run(inputs, outputs),
        }
    }
}

//! Tapes of a tool and its positions.

use flank_expr::{Expr, InstructionSet, LaneTape, Tape, TapeError};

use crate::equations::runner::Runner;

/// A tape that may be run often enough to pay for machine code.
#[derive(Clone, Debug)]
pub(super) struct PlaceTape {
    tape: Tape,
    lanes: LaneTape,
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
        Runner::new(&self.tape, &self.lanes, InstructionSet::fastest())
    }
}

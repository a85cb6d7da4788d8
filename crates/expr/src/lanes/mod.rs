//! The evaluator in lanes: many points at a time.

mod block;
mod program;

use pulp::Arch;

use crate::evaluate::execute;
use block::Block;
pub use block::LANES;
pub use program::LaneTape;

/// Instructions of the machine that lanes run on. All give the same bits.
#[derive(Clone, Copy, Debug)]
pub struct InstructionSet(Arch);

impl InstructionSet {
    /// The widest that this machine has.
    pub fn widest() -> InstructionSet {
        InstructionSet(Arch::new())
    }

    /// All that this machine has, the plain one first.
    pub fn available() -> Vec<InstructionSet> {
        let mut found = vec![InstructionSet(Arch::Scalar)];
        #[cfg(target_arch = "x86_64")]
        found.extend(pulp::x86::V3::try_new().map(|avx2| InstructionSet(Arch::V3(avx2))));
        found.push(InstructionSet::widest());
        found
    }

    /// Calls a function whose loops, where they are inlined (`#[inline(always)]`), become these instructions.
    #[inline(always)]
    pub fn dispatch<R>(self, run: impl FnOnce() -> R) -> R {
        self.0.dispatch(run)
    }
}

/// Runs a tape on [`LANES`] points at once; keeps its registers, so that a run allocates nothing.
///
/// Every lane has the bits that [`ScalarEvaluator`](crate::ScalarEvaluator) gives.
#[derive(Clone, Debug)]
pub struct LaneEvaluator<'t> {
    tape: &'t LaneTape,
    instructions: InstructionSet,
    scalars: Vec<f64>,
    blocks: Vec<Block>,
    /// A uniform input changed since the last run.
    is_stale: bool,
}

impl<'t> LaneEvaluator<'t> {
    /// An evaluator for one tape.
    pub fn new(tape: &'t LaneTape, instructions: InstructionSet) -> LaneEvaluator<'t> {
        let blocks = vec![Block::default(); tape.block_count];
        LaneEvaluator { tape, instructions, scalars: tape.scalars.clone(), blocks, is_stale: true }
    }

    /// The values of an input, one for each lane; they stay from run to run.
    ///
    /// # Panics
    /// If there is no such input or it is uniform.
    pub fn input(&mut self, index: usize) -> &mut [f64; LANES] {
        let register = self.tape.inputs[index].expect("the input differs from lane to lane");
        &mut self.blocks[register as usize].0
    }

    /// Gives a uniform input its value.
    ///
    /// # Panics
    /// If there is no such input or it is not uniform.
    pub fn set_uniform(&mut self, index: usize, value: f64) {
        assert!(self.tape.inputs[index].is_none(), "the input is the same in all lanes");
        self.is_stale |= self.scalars[index].to_bits() != value.to_bits();
        self.scalars[index] = value;
    }

    /// Computes the outputs at the inputs. A domain error gives NaN in its lane.
    pub fn run(&mut self) {
        let LaneEvaluator { tape, instructions, scalars, blocks, .. } = self;
        if self.is_stale {
            execute(&tape.once, &tape.curves, scalars);
            self.is_stale = false;
        }
        instructions.dispatch(
            #[inline(always)]
            || block::run(&tape.each, &tape.curves, scalars, blocks),
        );
    }

    /// An output after a run.
    ///
    /// # Panics
    /// If there is no such output.
    pub fn output(&self, index: usize) -> &[f64; LANES] {
        &self.blocks[self.tape.outputs[index] as usize].0
    }
}

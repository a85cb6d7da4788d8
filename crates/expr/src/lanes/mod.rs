//! The evaluator in lanes: many points at a time.

mod block;
#[cfg(target_arch = "x86_64")]
mod native;
#[cfg(not(target_arch = "x86_64"))]
#[path = "no_native.rs"]
mod native;
mod program;

use pulp::Arch;

use crate::evaluate::execute;
use block::Block;
pub use block::LANES;
use native::Native;
pub use program::LaneTape;

/// Instructions of the machine that lanes run on. All give the same bits.
#[derive(Clone, Copy, Debug)]
pub struct InstructionSet {
    loops: Arch,
    /// Tapes become machine code.
    is_native: bool,
}

impl InstructionSet {
    /// What is fastest on this machine: tapes as machine code where it can be made, else the widest.
    pub fn fastest() -> InstructionSet {
        InstructionSet { is_native: native::is_available(), ..InstructionSet::widest() }
    }

    /// The widest vectors that this machine has, with tapes gone through instruction by instruction.
    pub fn widest() -> InstructionSet {
        InstructionSet { loops: Arch::new(), is_native: false }
    }

    /// All that this machine has, the plain one first.
    pub fn available() -> Vec<InstructionSet> {
        let loops = |loops| InstructionSet { loops, is_native: false };
        let mut found = vec![loops(Arch::Scalar)];
        #[cfg(target_arch = "x86_64")]
        found.extend(pulp::x86::V3::try_new().map(|avx2| loops(Arch::V3(avx2))));
        found.extend([InstructionSet::widest(), InstructionSet::fastest()]);
        found
    }

    /// Calls a function whose loops, where they are inlined (`#[inline(always)]`), become these instructions.
    #[inline(always)]
    pub fn dispatch<R>(self, run: impl FnOnce() -> R) -> R {
        self.loops.dispatch(run)
    }
}

/// Runs a tape on [`LANES`] points at once; keeps its registers, so that a run allocates nothing.
///
/// Every lane has the bits that [`ScalarEvaluator`](crate::ScalarEvaluator) gives.
#[derive(Clone, Debug)]
pub struct LaneEvaluator<'t> {
    tape: &'t LaneTape,
    instructions: InstructionSet,
    native: Option<&'t Native>,
    scalars: Vec<f64>,
    /// Those of the tape; for machine code the outputs follow.
    blocks: Vec<Block>,
    scratch: Vec<f64>,
    /// A uniform input changed since the last run.
    is_stale: bool,
}

impl<'t> LaneEvaluator<'t> {
    /// An evaluator for one tape.
    pub fn new(tape: &'t LaneTape, instructions: InstructionSet) -> LaneEvaluator<'t> {
        let native = instructions.is_native.then(|| tape.native()).flatten();
        let mut scalars = tape.scalars.clone();
        scalars.extend_from_slice(native.map_or(&[], Native::constants));
        LaneEvaluator {
            tape,
            instructions,
            native,
            scalars,
            blocks: vec![Block::default(); native.map_or(tape.block_count, Native::block_count)],
            scratch: vec![0.0; native.map_or(0, Native::scratch_len)],
            is_stale: true,
        }
    }

    /// The values of an input, one for each lane; they stay from run to run.
    ///
    /// # Panics
    /// If there is no such input or it is uniform.
    #[inline]
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
        self.run_first(LANES);
    }

    /// The same for the first `count` lanes alone; outputs of the others mean nothing.
    pub fn run_first(&mut self, count: usize) {
        let LaneEvaluator { tape, instructions, native, scalars, blocks, scratch, .. } = self;
        if self.is_stale {
            execute(&tape.once, &tape.curves, scalars);
            self.is_stale = false;
        }
        if native.is_some_and(|native| native.run(count, scalars, blocks, scratch)) {
            return;
        }
        instructions.dispatch(
            #[inline(always)]
            || block::run(&tape.each, &tape.curves, scalars, blocks),
        );
        if native.is_some() {
            for (k, &output) in tape.outputs.iter().enumerate() {
                blocks[tape.block_count + k] = blocks[output as usize];
            }
        }
    }

    /// Number of outputs.
    pub fn output_count(&self) -> usize {
        self.tape.outputs.len()
    }

    /// An output after a run.
    ///
    /// # Panics
    /// If there is no such output.
    #[inline]
    pub fn output(&self, index: usize) -> &[f64; LANES] {
        let of_tape = self.tape.outputs[index] as usize;
        let block = if self.native.is_some() { self.tape.block_count + index } else { of_tape };
        &self.blocks[block].0
    }
}

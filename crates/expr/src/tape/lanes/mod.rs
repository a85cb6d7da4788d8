//! The evaluator in lanes: many points at a time.

mod block;
#[cfg(target_arch = "x86_64")]
mod native;
#[cfg(not(target_arch = "x86_64"))]
#[path = "no_native.rs"]
mod native;
mod program;

use pulp::Arch;

use crate::tape::evaluate::execute;
use block::Block;
pub use block::LANES;
use native::{EightLanes, Native, Part, Vectors, Wide, settle};
use program::LaneInstruction;
pub use program::{LaneTape, Varies};

/// Instructions of the machine that lanes run on. All give the same bits.
#[derive(Clone, Copy, Debug)]
pub struct InstructionSet {
    loops: Loops,
    /// Tapes become machine code for these.
    native: Option<Vectors>,
    layout: Layout,
}

/// What machine code is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Layout {
    /// Few points: its steps are in the order of the tape.
    AsTold,
    /// Many points: they are in an order that waits less.
    Ordered,
    /// The same for so many at once that caches do not hold their numbers: what goes to memory of the caller goes past them, as it would
    /// have to be read into them first.
    PastCaches,
}

impl Layout {
    /// Of a tape with so many outputs that go to memory of the caller. Of a line of a cache that is not written as a whole the caches would
    /// be asked for the rest.
    fn of(self, vectors: Vectors, written: usize) -> Layout {
        let is_past = self == Layout::PastCaches && written > 0 && vectors.are_cache_lines();
        if self == Layout::PastCaches && !is_past { Layout::Ordered } else { self }
    }
}

/// What the compiler makes of loops.
#[derive(Clone, Copy, Debug)]
enum Loops {
    Eight(EightLanes),
    Other(Arch),
}

impl Loops {
    fn widest() -> Loops {
        EightLanes::available().map_or_else(|| Loops::Other(Arch::new()), Loops::Eight)
    }
}

impl InstructionSet {
    /// What is fastest on this machine: tapes as machine code where it can be made, else the widest.
    pub fn fastest() -> InstructionSet {
        InstructionSet { native: Vectors::available().last(), ..InstructionSet::widest() }
    }

    /// The same with the steps of machine code in an order that waits less: worth its while for many points; a tape of 600 steps takes some 0.3 ms.
    #[must_use]
    pub fn for_many(self) -> InstructionSet {
        self.laid_out(Layout::Ordered)
    }

    /// The same for so many points at once that caches do not hold their numbers: what goes to memory of the caller goes past them. Before
    /// another thread reads it, [`InstructionSet::settle`].
    #[must_use]
    pub fn past_caches(self) -> InstructionSet {
        self.laid_out(Layout::PastCaches)
    }

    fn laid_out(self, layout: Layout) -> InstructionSet {
        InstructionSet { layout: if self.native.is_some() { layout } else { self.layout }, ..self }
    }

    /// Waits until all that this thread has written with these instructions can be seen by other threads.
    pub fn settle(self) {
        if self.layout == Layout::PastCaches {
            settle();
        }
    }

    /// Whether it is laid out for many points.
    pub fn is_for_many(self) -> bool {
        self.layout != Layout::AsTold
    }

    /// The widest vectors that this machine has, with tapes gone through instruction by instruction.
    pub fn widest() -> InstructionSet {
        InstructionSet { loops: Loops::widest(), native: None, layout: Layout::AsTold }
    }

    /// All that this machine has, the plain one first.
    pub fn available() -> Vec<InstructionSet> {
        let loops = |loops| InstructionSet { loops: Loops::Other(loops), native: None, layout: Layout::AsTold };
        let mut found = vec![loops(Arch::Scalar)];
        #[cfg(target_arch = "x86_64")]
        found.extend(pulp::x86::V3::try_new().map(|avx2| loops(Arch::V3(avx2))));
        found.push(InstructionSet::widest());
        let native = |vectors| InstructionSet { native: Some(vectors), ..InstructionSet::widest() };
        found.extend(Vectors::available().map(native).flat_map(|set| [set, set.for_many(), set.past_caches()]));
        found
    }

    /// How many numbers a register of its machine code holds; `None` where tapes are gone through instruction by instruction.
    pub fn machine_code(self) -> Option<usize> {
        self.native.map(Vectors::lanes)
    }

    /// Calls a function whose loops, where they are inlined (`#[inline(always)]`), become these instructions.
    #[inline(always)]
    pub fn dispatch<R>(self, run: impl FnOnce() -> R) -> R {
        match self.loops {
            Loops::Eight(loops) => loops.dispatch(run),
            Loops::Other(loops) => loops.dispatch(run),
        }
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
    /// Those of the tape; for machine code its constants follow.
    scalars: Vec<f64>,
    /// The same for machine code that reads them as wide as a register.
    wide: Vec<Wide>,
    /// Those of the tape; for machine code the outputs follow.
    blocks: Vec<Block>,
    scratch: Vec<Block>,
    /// A uniform input changed since the last run.
    is_stale: bool,
    /// So did what varies by lane alone.
    is_kept_stale: bool,
}

impl<'t> LaneEvaluator<'t> {
    /// An evaluator for one tape.
    pub fn new(tape: &'t LaneTape, instructions: InstructionSet) -> LaneEvaluator<'t> {
        let native = tape.native(instructions);
        let constants = native.map_or(&[][..], Native::constants);
        let scalars = [tape.scalars.as_slice(), constants].concat();
        let is_wide = native.is_some_and(Native::reads_wide);
        LaneEvaluator {
            tape,
            instructions,
            native,
            wide: scalars.iter().filter(|_| is_wide).map(|number| Wide([*number; _])).collect(),
            scalars,
            blocks: vec![Block::default(); native.map_or(tape.block_count, Native::block_count)],
            scratch: vec![Block::default(); native.map_or(0, Native::scratch_len)],
            is_stale: true,
            is_kept_stale: true,
        }
    }

    /// Whether the tape runs as machine code.
    pub fn has_machine_code(&self) -> bool {
        self.native.is_some()
    }

    /// The values of an input, one for each lane; they stay from run to run.
    ///
    /// # Panics
    /// If there is no such input or it is uniform.
    #[inline]
    pub fn input(&mut self, index: usize) -> &mut [f64; LANES] {
        let register = self.tape.inputs[index].expect("the input differs from lane to lane");
        self.is_kept_stale |= self.tape.varies[index] == Varies::ByLane;
        &mut self.blocks[register as usize].0
    }

    /// Gives a uniform input its value.
    ///
    /// # Panics
    /// If there is no such input or it is not uniform.
    pub fn set_uniform(&mut self, index: usize, value: f64) {
        assert!(self.tape.inputs[index].is_none(), "the input is the same in all lanes");
        let is_new = self.scalars[index].to_bits() != value.to_bits();
        self.is_stale |= is_new;
        self.is_kept_stale |= is_new && self.tape.varies[index] == Varies::Seldom;
        self.scalars[index] = value;
    }

    /// What is computed once for all lanes from the uniform inputs as they are, added to what is there: for
    /// [`LaneEvaluator::set_prepared`].
    pub fn prepare(&mut self, prepared: &mut Vec<f64>) {
        self.execute_once();
        prepared.extend_from_slice(&self.scalars[..self.tape.inputs.len()]);
        prepared.extend_from_slice(&self.scalars[self.tape.results()]);
    }

    /// Gives all uniform inputs the values that they had for [`LaneEvaluator::prepare`] of an evaluator of the same tape, without
    /// computing anything anew. Those that vary seldom must be as they were.
    ///
    /// # Panics
    /// If there are not as many numbers as that one added.
    pub fn set_prepared(&mut self, prepared: &[f64]) {
        let inputs = self.tape.inputs.len();
        self.scalars[..inputs].copy_from_slice(&prepared[..inputs]);
        self.scalars[self.tape.results()].copy_from_slice(&prepared[inputs..]);
        self.widen(0..inputs);
        self.widen(self.tape.results());
        self.is_stale = false;
    }

    /// Gives machine code the scalars of a range.
    fn widen(&mut self, range: std::ops::Range<usize>) {
        if self.native.is_some_and(Native::reads_wide) {
            let pairs = self.wide[range.clone()].iter_mut().zip(&self.scalars[range]);
            self.instructions.dispatch(
                #[inline(always)]
                || pairs.for_each(|(wide, number)| *wide = Wide([*number; _])),
            );
        }
    }

    fn execute_once(&mut self) {
        if self.is_stale {
            execute(&self.tape.once, &self.tape.curves, &mut self.scalars);
            self.widen(0..self.tape.scalars.len());
            self.is_stale = false;
        }
    }

    /// Computes the outputs at the inputs. A domain error gives NaN in its lane.
    pub fn run(&mut self) {
        self.run_first(LANES);
    }

    /// The same for the first `count` lanes alone; outputs of the others mean nothing.
    pub fn run_first(&mut self, count: usize) {
        self.run_into(count, &mut []);
    }

    /// The outputs at one place, as many as are asked for: those of the first lane. For a tape none of whose inputs is uniform and none of
    /// whose outputs goes to memory of the caller.
    ///
    /// # Panics
    /// If there are not so many inputs or outputs, or an input is uniform.
    pub fn run_at(&mut self, inputs: &[f64], outputs: &mut [f64]) {
        for (register, value) in self.tape.inputs[..inputs.len()].iter().zip(inputs) {
            let register = register.expect("the input differs from lane to lane");
            self.blocks[register as usize].0[0] = *value;
        }
        self.is_kept_stale |= !self.tape.by_lane.is_empty();
        self.run_first(1);
        let of_tape = &self.tape.outputs[..outputs.len()];
        if self.native.is_some() {
            let blocks = &self.blocks[self.tape.block_count..][..outputs.len()];
            outputs.iter_mut().zip(blocks).for_each(|(output, block)| *output = block.0[0]);
        } else {
            let blocks = of_tape.iter().map(|block| &self.blocks[*block as usize]);
            outputs.iter_mut().zip(blocks).for_each(|(output, block)| *output = block.0[0]);
        }
    }

    /// The same for a tape whose first outputs go to memory of the caller ([`LaneTape::writing`]). Instructions that write
    /// [past the caches](InstructionSet::past_caches) are slow where that does not begin at a multiple of 64 bytes.
    ///
    /// # Panics
    /// If `out` has not one entry for each of these.
    pub fn run_into(&mut self, count: usize, out: &mut [[f64; LANES]]) {
        assert_eq!(out.len(), self.tape.written, "one entry for each output that goes there");
        self.execute_once();
        let LaneEvaluator { tape, instructions, native, scalars, wide, blocks, scratch, .. } = self;
        let mut is_done = |work, steps: &[LaneInstruction], blocks: &mut [Block], out: &mut [[f64; LANES]]| {
            let is_native = native.is_some_and(|native| native.run(work, (scalars, wide), blocks, scratch, out));
            if !is_native {
                instructions.dispatch(
                    #[inline(always)]
                    || block::run(steps, &tape.curves, scalars, blocks),
                );
            }
            is_native
        };
        if self.is_kept_stale && !tape.by_lane.is_empty() {
            is_done((Part::ByLane, LANES), &tape.by_lane, blocks, &mut []);
        }
        self.is_kept_stale = false;
        if is_done((Part::Each, count), &tape.each, blocks, out) {
            return;
        }
        for (k, &output) in tape.outputs.iter().enumerate() {
            let values = blocks[output as usize];
            match out.get_mut(k) {
                Some(out) => *out = values.0,
                None if native.is_some() => blocks[tape.block_count + k] = values,
                None => {}
            }
        }
    }

    /// Number of outputs.
    pub fn output_count(&self) -> usize {
        self.tape.outputs.len()
    }

    /// An output after a run; not one that goes to memory of the caller.
    ///
    /// # Panics
    /// If there is no such output.
    #[inline]
    pub fn output(&self, index: usize) -> &[f64; LANES] {
        debug_assert!(index >= self.tape.written, "outputs that are kept");
        let of_tape = self.tape.outputs[index] as usize;
        let block = if self.native.is_some() { self.tape.block_count + index } else { of_tape };
        &self.blocks[block].0
    }
}

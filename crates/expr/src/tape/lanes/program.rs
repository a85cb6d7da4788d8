//! A tape divided into what is computed once and what is computed for each block of lanes.

use std::sync::{Arc, OnceLock};

use super::InstructionSet;
use super::native::Native;
use crate::symbolic::curve::Curve;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::{Instruction, Operation, Tape};

/// What an instruction does; registers are blocks of lanes unless it says scalar.
#[derive(Clone, Copy, Debug)]
pub(super) enum LaneOperation {
    /// `out = op(a)`
    Unary(Unary),
    /// `out = sin(a)`, `b = cos(a)`
    SinCos,
    /// `out` = the derivative of this order of curve number `b`, at `a`
    Curve(u8),
    /// `out = a`
    Copy,
    /// `out = a` where |b| ≤ 1, else NaN
    Settled,
    /// `out = op(a, b)`
    Binary(Binary),
    /// `out = op(scalar a, b)`
    ScalarLeft(Binary),
    /// `out = op(a, scalar b)`
    ScalarRight(Binary),
    /// `out` = scalar `a`
    Spread,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LaneInstruction {
    pub(super) operation: LaneOperation,
    pub(super) out: u32,
    pub(super) a: u32,
    pub(super) b: u32,
}

/// How an input changes, and with it all that depends on nothing else: that is computed as often.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varies {
    /// The same in all lanes, seldom another number.
    Seldom,
    /// The same in all lanes, another number for each run.
    ByRun,
    /// Another number in each lane, for many runs.
    ByLane,
    /// Another number in each lane and for each run.
    Freely,
}

impl Varies {
    fn is_uniform(self) -> bool {
        matches!(self, Varies::Seldom | Varies::ByRun)
    }

    /// How something changes that depends on two things.
    fn and(self, other: Varies) -> Varies {
        match (self, other) {
            (Varies::Seldom, other) | (other, Varies::Seldom) => other,
            (one, other) if one == other => one,
            _ => Varies::Freely,
        }
    }
}

/// A tape laid out for [`LaneEvaluator`](crate::LaneEvaluator)s.
#[derive(Clone, Debug)]
pub struct LaneTape {
    /// Registers of the first stage: inputs (those that are uniform are used), constants, then one for each result. Their
    /// values before it: the constants are among them.
    pub(super) scalars: Vec<f64>,
    result_count: usize,
    /// How many of the constants are settings: the first ones.
    setting_count: usize,
    pub(super) once: Vec<Instruction>,
    /// What depends on the lane alone; results have blocks of their own, which are named.
    pub(super) by_lane: Vec<LaneInstruction>,
    #[cfg_attr(not(target_arch = "x86_64"), expect(dead_code, reason = "only machine code asks for it"))]
    pub(super) kept: Vec<u32>,
    pub(super) each: Vec<LaneInstruction>,
    pub(super) curves: Vec<Arc<Curve>>,
    pub(super) block_count: usize,
    /// The block of each input; none if it is uniform.
    pub(super) inputs: Vec<Option<u32>>,
    pub(super) varies: Vec<Varies>,
    /// The block of each output.
    pub(super) outputs: Vec<u32>,
    /// How many outputs go to memory of the caller.
    pub(super) written: usize,
    /// For four lanes and for eight, in each layout.
    native: [[OnceLock<Option<Native>>; 3]; 2],
}

/// Where the value lives that a register of the tape holds at some step.
#[derive(Clone, Copy, Debug)]
struct Place {
    varies: Varies,
    /// The number of a scalar if it is uniform, else of a block.
    index: u32,
}

impl LaneTape {
    /// A tape whose inputs all differ from lane to lane.
    pub fn new(tape: &Tape) -> LaneTape {
        LaneTape::with_inputs(tape, &vec![Varies::Freely; tape.input_count()])
    }

    /// A tape some of whose inputs are the same in all lanes, or for many runs. What depends only on these is computed only after
    /// one of them changed, and once for all lanes if it is the same in all.
    ///
    /// # Panics
    /// If there is not one entry of `varies` for each input.
    pub fn with_inputs(tape: &Tape, varies: &[Varies]) -> LaneTape {
        assert_eq!(varies.len(), tape.input_count(), "one entry for each input");
        let mut division = Division::new(tape, varies);
        let block = |place: &Place| (!place.varies.is_uniform()).then_some(place.index);
        let inputs = division.places[..tape.input_count()].iter().map(block).collect();
        division.each.reserve(tape.instructions().len());
        tape.instructions().iter().for_each(|step| division.step(step));
        let outputs = tape.outputs().iter().map(|&register| division.output(register)).collect();
        let mut scalars = vec![0.0; division.scalar_count as usize];
        scalars[tape.input_count()..][..tape.constants().len()].copy_from_slice(tape.constants());
        LaneTape {
            result_count: scalars.len() - tape.input_count() - tape.constants().len(),
            scalars,
            setting_count: tape.setting_count(),
            once: division.once,
            by_lane: division.by_lane,
            kept: division.kept,
            each: division.each,
            curves: tape.curves().to_vec(),
            block_count: division.block_count as usize,
            inputs,
            varies: varies.to_vec(),
            outputs,
            written: 0,
            native: Default::default(),
        }
    }

    /// The same, but its first `count` outputs go to memory of the caller
    /// ([`LaneEvaluator::run_into`](crate::LaneEvaluator::run_into)).
    ///
    /// # Panics
    /// If there are not as many.
    pub fn writing(self, count: usize) -> LaneTape {
        assert!(count <= self.outputs.len(), "as many outputs");
        LaneTape { written: count, native: Default::default(), ..self }
    }

    /// Its machine code, made when it is asked for first.
    pub(super) fn native(&self, instructions: InstructionSet) -> Option<&Native> {
        let vectors = instructions.native?;
        let layout = instructions.layout.of(vectors, self.written);
        let code = &self.native[vectors.index()][layout as usize];
        code.get_or_init(|| Native::translate(self, vectors, layout)).as_ref()
    }

    /// Number of outputs.
    pub fn output_count(&self) -> usize {
        self.outputs.len()
    }

    /// Results of the first stage follow inputs and constants.
    pub(super) fn results(&self) -> std::ops::Range<usize> {
        self.scalars.len() - self.result_count..self.scalars.len()
    }

    /// Instructions that are executed once for all lanes, those that are executed after an input changed that varies by lane, and
    /// those for each run.
    pub fn stages(&self) -> [usize; 3] {
        [self.once.len(), self.by_lane.len(), self.each.len()]
    }
}

impl LaneTape {
    /// Makes the machine code that evaluators of these instructions want, if there is any: copies made from then on share it.
    pub fn translate(&self, instructions: InstructionSet) {
        self.native(instructions);
    }

    /// The same tape with other numbers for its settings; machine code that was made is shared.
    ///
    /// # Panics
    /// If there are not as many as the tape has that it was laid out from.
    #[must_use]
    pub fn with_settings(&self, values: &[f64]) -> LaneTape {
        let mut tape = self.clone();
        if tape.setting_count > 0 {
            let first = tape.inputs.len();
            tape.scalars[first..first + tape.setting_count].copy_from_slice(values);
        }
        tape
    }
}

struct Division {
    places: Vec<Place>,
    /// The block that stands for a register of the tape, once it has one.
    blocks: Vec<Option<u32>>,
    scalar_count: u32,
    block_count: u32,
    once: Vec<Instruction>,
    by_lane: Vec<LaneInstruction>,
    kept: Vec<u32>,
    each: Vec<LaneInstruction>,
}

impl Division {
    fn new(tape: &Tape, varies: &[Varies]) -> Division {
        let scalar_count = (tape.input_count() + tape.constants().len()) as u32;
        let place = |index: usize| Place {
            varies: varies.get(index).filter(|varies| varies.is_uniform()).copied().unwrap_or(Varies::Seldom),
            index: index as u32,
        };
        let places: Vec<Place> = (0..tape.register_count()).map(place).collect();
        let mut division = Division {
            blocks: vec![None; places.len()],
            places,
            scalar_count,
            block_count: 0,
            once: Vec::new(),
            by_lane: Vec::new(),
            kept: Vec::new(),
            each: Vec::new(),
        };
        for (input, varies) in varies.iter().enumerate().filter(|(_, varies)| !varies.is_uniform()) {
            let index = division.fresh_block();
            division.blocks[input] = Some(index);
            division.places[input] = Place { varies: *varies, index };
        }
        division
    }

    fn fresh_block(&mut self) -> u32 {
        self.block_count += 1;
        self.block_count - 1
    }

    /// What a register of the tape holds from now on is kept in a place of its own kind.
    fn place(&mut self, register: u32, varies: Varies) -> u32 {
        let index = match varies {
            Varies::Seldom | Varies::ByRun => {
                self.scalar_count += 1;
                self.scalar_count - 1
            }
            Varies::ByLane => {
                let block = self.fresh_block();
                self.kept.push(block);
                block
            }
            Varies::Freely => {
                let block = self.blocks[register as usize].unwrap_or_else(|| self.fresh_block());
                self.blocks[register as usize] = Some(block);
                block
            }
        };
        self.places[register as usize] = Place { varies, index };
        index
    }

    fn push(&mut self, varies: Varies, instruction: LaneInstruction) {
        if varies == Varies::ByLane { &mut self.by_lane } else { &mut self.each }.push(instruction);
    }

    fn step(&mut self, step: &Instruction) {
        let Place { varies, index: a } = self.places[step.a as usize];
        let operation = match step.operation {
            Operation::Binary(op) => return self.binary(op, step.out, step.a, step.b),
            Operation::Settled => return self.settled(step),
            Operation::Middle | Operation::Widened => LaneOperation::Copy,
            Operation::SinCos => LaneOperation::SinCos,
            Operation::Unary(op) => LaneOperation::Unary(op),
            Operation::Curve(order) => LaneOperation::Curve(order),
        };
        let out = self.place(step.out, varies);
        let b = match step.operation {
            Operation::SinCos => self.place(step.b, varies),
            Operation::Curve(_) => step.b,
            _ => a,
        };
        if varies.is_uniform() {
            self.once.push(Instruction { operation: step.operation, out, a, b });
        } else {
            self.push(varies, LaneInstruction { operation, out, a, b });
        }
    }

    fn binary(&mut self, op: Binary, register: u32, a: u32, b: u32) {
        let [a, b] = [a, b].map(|register| self.places[register as usize]);
        let varies = a.varies.and(b.varies);
        let out = self.place(register, varies);
        let operation = match (a.varies.is_uniform(), b.varies.is_uniform()) {
            (true, true) => {
                self.once.push(Instruction { operation: Operation::Binary(op), out, a: a.index, b: b.index });
                return;
            }
            (true, false) => LaneOperation::ScalarLeft(op),
            (false, true) => LaneOperation::ScalarRight(op),
            (false, false) => LaneOperation::Binary(op),
        };
        self.push(varies, LaneInstruction { operation, out, a: a.index, b: b.index });
    }

    /// Uniform operands get lanes of their own: seldom is only one of the two uniform.
    fn settled(&mut self, step: &Instruction) {
        let [a, b] = [step.a, step.b].map(|register| self.places[register as usize]);
        let varies = a.varies.and(b.varies);
        if varies.is_uniform() {
            let out = self.place(step.out, varies);
            self.once.push(Instruction { operation: Operation::Settled, out, a: a.index, b: b.index });
            return;
        }
        let [a, b] = [a, b].map(|operand| {
            if !operand.varies.is_uniform() {
                return operand.index;
            }
            let out = self.fresh_block();
            let spread = LaneInstruction { operation: LaneOperation::Spread, out, a: operand.index, b: operand.index };
            self.push(varies, spread);
            out
        });
        let out = self.place(step.out, varies);
        self.push(varies, LaneInstruction { operation: LaneOperation::Settled, out, a, b });
    }

    fn output(&mut self, register: u32) -> u32 {
        let Place { varies, index } = self.places[register as usize];
        if !varies.is_uniform() {
            return index;
        }
        let out = self.place(register, Varies::Freely);
        self.push(Varies::Freely, LaneInstruction { operation: LaneOperation::Spread, out, a: index, b: index });
        out
    }
}

//! A tape divided into what is computed once and what is computed for each block of lanes.

use std::sync::{Arc, OnceLock};

use super::native::Native;
use crate::curve::Curve;
use crate::op::{Binary, Unary};
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

/// A tape laid out for [`LaneEvaluator`](crate::LaneEvaluator)s.
#[derive(Clone, Debug)]
pub struct LaneTape {
    /// Registers of the first stage: inputs (those that are uniform are used), constants, then one for each result. Their
    /// values before it: the constants are among them.
    pub(super) scalars: Vec<f64>,
    pub(super) once: Vec<Instruction>,
    pub(super) each: Vec<LaneInstruction>,
    pub(super) curves: Vec<Arc<Curve>>,
    pub(super) block_count: usize,
    /// The block of each input; none if it is uniform.
    pub(super) inputs: Vec<Option<u32>>,
    /// The block of each output.
    pub(super) outputs: Vec<u32>,
    native: OnceLock<Option<Native>>,
}

/// Where the value lives that a register of the tape holds at some step.
#[derive(Clone, Copy, Debug)]
enum Place {
    Scalar(u32),
    Block(u32),
}

impl LaneTape {
    /// A tape whose inputs all differ from lane to lane.
    pub fn new(tape: &Tape) -> LaneTape {
        LaneTape::with_uniform(tape, &vec![false; tape.input_count()])
    }

    /// A tape some of whose inputs are the same in all lanes. What depends only on these is computed once for all lanes, and
    /// only after one of them changed.
    ///
    /// # Panics
    /// If there is not one entry of `uniform` for each input.
    pub fn with_uniform(tape: &Tape, uniform: &[bool]) -> LaneTape {
        assert_eq!(uniform.len(), tape.input_count(), "one entry for each input");
        let mut division = Division::new(tape, uniform);
        let inputs = (0..tape.input_count()).map(|k| match division.places[k] {
            Place::Block(block) => Some(block),
            Place::Scalar(_) => None,
        });
        let inputs = inputs.collect();
        tape.instructions().iter().for_each(|step| division.step(step));
        let outputs = tape.outputs().iter().map(|&register| division.output(register)).collect();
        let mut scalars = vec![0.0; division.scalar_count as usize];
        scalars[tape.input_count()..][..tape.constants().len()].copy_from_slice(tape.constants());
        LaneTape {
            scalars,
            once: division.once,
            each: division.each,
            curves: tape.curves().to_vec(),
            block_count: division.block_count as usize,
            inputs,
            outputs,
            native: OnceLock::new(),
        }
    }

    /// Its machine code, made when it is asked for first.
    pub(super) fn native(&self) -> Option<&Native> {
        self.native.get_or_init(|| Native::translate(self)).as_ref()
    }

    /// Number of outputs.
    pub fn output_count(&self) -> usize {
        self.outputs.len()
    }

    /// Instructions that are executed once for all lanes, and for each block of them.
    pub fn stages(&self) -> [usize; 2] {
        [self.once.len(), self.each.len()]
    }
}

struct Division {
    places: Vec<Place>,
    /// The block that stands for a register of the tape, once it has one.
    blocks: Vec<Option<u32>>,
    scalar_count: u32,
    block_count: u32,
    once: Vec<Instruction>,
    each: Vec<LaneInstruction>,
}

impl Division {
    fn new(tape: &Tape, uniform: &[bool]) -> Division {
        let scalar_count = (tape.input_count() + tape.constants().len()) as u32;
        let places: Vec<Place> = (0..tape.register_count() as u32).map(Place::Scalar).collect();
        let blocks = vec![None; places.len()];
        let mut division =
            Division { places, blocks, scalar_count, block_count: 0, once: Vec::new(), each: Vec::new() };
        for input in (0..tape.input_count()).filter(|&k| !uniform[k]) {
            division.block(input as u32);
        }
        division
    }

    /// A register of the tape holds a value of lanes from now on.
    fn block(&mut self, register: u32) -> u32 {
        let block = *self.blocks[register as usize].get_or_insert_with(|| {
            self.block_count += 1;
            self.block_count - 1
        });
        self.places[register as usize] = Place::Block(block);
        block
    }

    /// A register of the tape holds a value of the first stage from now on.
    fn scalar(&mut self, register: u32) -> u32 {
        self.scalar_count += 1;
        self.places[register as usize] = Place::Scalar(self.scalar_count - 1);
        self.scalar_count - 1
    }

    fn step(&mut self, step: &Instruction) {
        use Place::{Block, Scalar};
        let a = self.places[step.a as usize];
        match (step.operation, a) {
            (Operation::Binary(op), _) => self.binary(op, step.out, a, self.places[step.b as usize]),
            (Operation::SinCos, Scalar(a)) => {
                let (out, b) = (self.scalar(step.out), self.scalar(step.b));
                self.once.push(Instruction { operation: step.operation, out, a, b });
            }
            (Operation::SinCos, Block(a)) => {
                let (out, b) = (self.block(step.out), self.block(step.b));
                self.each.push(LaneInstruction { operation: LaneOperation::SinCos, out, a, b });
            }
            (Operation::Unary(_) | Operation::Curve(_), Scalar(a)) => {
                let out = self.scalar(step.out);
                // `b` is the number of a curve, or not used: a register that exists
                let b = if matches!(step.operation, Operation::Curve(_)) { step.b } else { a };
                self.once.push(Instruction { operation: step.operation, out, a, b });
            }
            (Operation::Unary(op), Block(a)) => {
                let out = self.block(step.out);
                self.each.push(LaneInstruction { operation: LaneOperation::Unary(op), out, a, b: a });
            }
            (Operation::Curve(order), Block(a)) => {
                let out = self.block(step.out);
                self.each.push(LaneInstruction { operation: LaneOperation::Curve(order), out, a, b: step.b });
            }
        }
    }

    fn binary(&mut self, op: Binary, register: u32, a: Place, b: Place) {
        use Place::{Block, Scalar};
        let (operation, a, b) = match (a, b) {
            (Scalar(a), Scalar(b)) => {
                let out = self.scalar(register);
                self.once.push(Instruction { operation: Operation::Binary(op), out, a, b });
                return;
            }
            (Scalar(a), Block(b)) => (LaneOperation::ScalarLeft(op), a, b),
            (Block(a), Scalar(b)) => (LaneOperation::ScalarRight(op), a, b),
            (Block(a), Block(b)) => (LaneOperation::Binary(op), a, b),
        };
        let out = self.block(register);
        self.each.push(LaneInstruction { operation, out, a, b });
    }

    fn output(&mut self, register: u32) -> u32 {
        match self.places[register as usize] {
            Place::Block(block) => block,
            Place::Scalar(scalar) => {
                let out = self.block(register);
                self.each.push(LaneInstruction { operation: LaneOperation::Spread, out, a: scalar, b: scalar });
                out
            }
        }
    }
}

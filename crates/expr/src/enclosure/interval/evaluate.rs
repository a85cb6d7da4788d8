//! Runs a tape on intervals.

use std::borrow::Cow;
use std::ops::Range;

use super::Interval;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::{Instruction, Operation, Tape};

/// Runs a tape on intervals; keeps its registers, so that a run allocates nothing.
///
/// ```
/// use flank_expr::{Graph, Interval, IntervalEvaluator, Tape};
///
/// let graph = Graph::new();
/// let x = graph.variable("x");
/// let tape = Tape::new(&[x.sin() + 2.0], &[x]).expect("x is the input");
/// let mut out = [Interval::WHOLE];
/// IntervalEvaluator::new(&tape).run(&[Interval::new(0.0, 3.0)], &mut out);
/// assert!(out[0].lo <= 2.0 && out[0].hi >= 3.0 && out[0].continuous);
/// ```
#[derive(Clone, Debug)]
pub struct IntervalEvaluator<'t> {
    tape: &'t Tape,
    /// What a run does, and where it leaves the outputs.
    instructions: Cow<'t, [Instruction]>,
    outputs: Cow<'t, [u32]>,
    /// Inputs that a run is given.
    given: usize,
    /// How many instructions and outputs [`IntervalEvaluator::run_first`] takes.
    first: [usize; 2],
    registers: Vec<Interval>,
}

impl<'t> IntervalEvaluator<'t> {
    /// An evaluator for one tape.
    pub fn new(tape: &'t Tape) -> IntervalEvaluator<'t> {
        let mut registers = vec![Interval::WHOLE; tape.register_count()];
        for (register, constant) in registers[tape.input_count()..].iter_mut().zip(tape.constants()) {
            *register = Interval::point(*constant);
        }
        let (instructions, outputs) = (tape.instructions().into(), tape.outputs().into());
        IntervalEvaluator { tape, instructions, outputs, given: tape.input_count(), first: [0; 2], registers }
    }

    /// The same where the first outputs, so many, can be had before the others: by [`IntervalEvaluator::run_first`], which
    /// [`IntervalEvaluator::run_rest`] follows. The bits are the same.
    ///
    /// # Panics
    /// If the tape has not so many outputs.
    pub fn in_two_parts(tape: &'t Tape, first: usize) -> IntervalEvaluator<'t> {
        let mut evaluator = IntervalEvaluator::new(tape);
        // the second part finds all that the first one wrote: nothing is written to twice
        let mut register_of: Vec<u32> = (0..tape.register_count() as u32).collect();
        let registers = &mut evaluator.registers;
        let renamed = tape.instructions().iter().map(|step| {
            let mut moved = Instruction { a: register_of[step.a as usize], ..*step };
            if reads_two(step) {
                moved.b = register_of[step.b as usize];
            }
            let mut written = |register: u32| {
                register_of[register as usize] = registers.len() as u32;
                registers.push(Interval::WHOLE);
                register_of[register as usize]
            };
            moved.out = written(step.out);
            if step.operation == Operation::SinCos {
                moved.b = written(step.b);
            }
            moved
        });
        let renamed: Vec<Instruction> = renamed.collect();
        evaluator.outputs = tape.outputs().iter().map(|register| register_of[*register as usize]).collect();
        let mut is_needed = vec![false; evaluator.registers.len()];
        evaluator.outputs[..first].iter().for_each(|register| is_needed[*register as usize] = true);
        for step in renamed.iter().rev() {
            let is_second = step.operation == Operation::SinCos && is_needed[step.b as usize];
            if is_needed[step.out as usize] || is_second {
                is_needed[step.out as usize] = true;
                is_needed[step.a as usize] = true;
                is_needed[step.b as usize] |= reads_two(step);
            }
        }
        let (mut instructions, rest): (Vec<Instruction>, Vec<Instruction>) =
            renamed.into_iter().partition(|step| is_needed[step.out as usize]);
        evaluator.first = [instructions.len(), first];
        instructions.extend(rest);
        evaluator.instructions = instructions.into();
        evaluator
    }

    /// The same where the last inputs are always these: what follows from them alone is computed here, once. A run takes the other inputs, and
    /// gives the same bits.
    ///
    /// # Panics
    /// If these are more than the tape's inputs.
    pub fn with_last_inputs(tape: &'t Tape, last: &[Interval]) -> IntervalEvaluator<'t> {
        let mut evaluator = IntervalEvaluator::new(tape);
        evaluator.given = tape.input_count() - last.len();
        evaluator.registers[evaluator.given..tape.input_count()].copy_from_slice(last);
        let fixed = evaluator.given..tape.input_count() + tape.constants().len();
        // a value that is known goes to a register that nothing else is written to, behind all others
        let is_known =
            |register: u32| fixed.contains(&(register as usize)) || register as usize >= tape.register_count();
        let mut register_of: Vec<u32> = (0..tape.register_count() as u32).collect();
        let (mut done, mut left) = (Vec::new(), Vec::new());
        for step in tape.instructions() {
            let is_binary = reads_two(step);
            let mut moved = Instruction { a: register_of[step.a as usize], ..*step };
            if is_binary {
                moved.b = register_of[step.b as usize];
            }
            let is_done = is_known(moved.a) && (!is_binary || is_known(moved.b));
            let mut written = |register: u32| {
                let to = if is_done { evaluator.registers.len() as u32 } else { register };
                evaluator.registers.extend(is_done.then_some(Interval::WHOLE));
                register_of[register as usize] = to;
                to
            };
            moved.out = written(step.out);
            if step.operation == Operation::SinCos {
                moved.b = written(step.b);
            }
            if is_done { done.push(moved) } else { left.push(moved) }
        }
        execute(tape, &done, &mut evaluator.registers);
        evaluator.outputs = tape.outputs().iter().map(|register| register_of[*register as usize]).collect();
        evaluator.instructions = left.into();
        evaluator
    }

    /// Encloses the outputs over the box of the inputs.
    ///
    /// # Panics
    /// If the slices do not have the lengths that the tape states.
    pub fn run(&mut self, inputs: &[Interval], outputs: &mut [Interval]) {
        self.registers[..self.given].copy_from_slice(inputs);
        execute(self.tape, &self.instructions, &mut self.registers);
        self.write(0..self.outputs.len(), outputs);
    }

    /// Encloses the outputs that come first, of an evaluator in two parts.
    ///
    /// # Panics
    /// If the slices do not have the lengths of inputs and first outputs.
    pub fn run_first(&mut self, inputs: &[Interval], outputs: &mut [Interval]) {
        let [instructions, count] = self.first;
        self.registers[..self.given].copy_from_slice(inputs);
        execute(self.tape, &self.instructions[..instructions], &mut self.registers);
        self.write(0..count, outputs);
    }

    /// The other ones, over the box of the inputs that the first ones were given.
    ///
    /// # Panics
    /// If the slice does not have the length of these outputs.
    pub fn run_rest(&mut self, outputs: &mut [Interval]) {
        let [instructions, count] = self.first;
        execute(self.tape, &self.instructions[instructions..], &mut self.registers);
        self.write(count..self.outputs.len(), outputs);
    }

    fn write(&self, which: Range<usize>, outputs: &mut [Interval]) {
        assert_eq!(outputs.len(), which.len(), "number of outputs");
        for (output, &register) in outputs.iter_mut().zip(&self.outputs[which]) {
            *output = self.registers[register as usize];
        }
    }
}

/// Whether a step reads its second register.
fn reads_two(step: &Instruction) -> bool {
    matches!(step.operation, Operation::Binary(_) | Operation::Settled | Operation::Widened)
}

fn execute(tape: &Tape, instructions: &[Instruction], registers: &mut [Interval]) {
    for step in instructions {
        let a = registers[step.a as usize];
        registers[step.out as usize] = match step.operation {
            Operation::Unary(op) => op.apply_interval(a),
            Operation::Curve(order) => tape.curves()[step.b as usize].enclosure(order, a),
            Operation::Binary(op) => binary(op, step, a, &registers[step.b as usize]),
            Operation::Middle => Interval::point(a.middle()),
            Operation::Settled => a.settled(registers[step.b as usize]),
            Operation::Widened => a.widened(registers[step.b as usize]),
            Operation::SinCos => {
                let (sin, cos) = a.sin_cos();
                registers[step.b as usize] = cos;
                sin
            }
        };
    }
}

/// One register twice is one number twice. Most steps are sums and products: these are written out where steps are taken.
#[inline(always)]
fn binary(op: Binary, step: &Instruction, a: Interval, b: &Interval) -> Interval {
    match op {
        Binary::Add => a + *b,
        Binary::Sub => a - *b,
        Binary::Mul if step.a == step.b => a.squared(),
        Binary::Mul => a * *b,
        _ => op.apply_interval(a, *b),
    }
}

impl Interval {
    /// The value of a root after its last step. A step of Newton's method from one middle encloses the solution; floats come to it from
    /// another place, and differ by as much as the rounding in the equations makes the enclosure wide: not more than 1e-11 mm where
    /// they make sense.
    #[cold]
    #[inline(never)]
    pub(crate) fn settled(self, last: Interval) -> Interval {
        let width = if self.is_empty() { 0.0 } else { self.width().min(1e-11) };
        let value = self + Interval::new(-width, width);
        let settles = !last.intersection(Interval::new(-1.0, 1.0)).is_empty();
        if settles { value } else { value.partial() }
    }

    /// All that lies within a bound of it.
    pub(crate) fn widened(self, bound: Interval) -> Interval {
        self + Interval::new(-bound.hi, bound.hi)
    }
}

impl Unary {
    /// All values on an interval.
    pub fn apply_interval(self, a: Interval) -> Interval {
        match self {
            Unary::Neg => -a,
            Unary::Sqrt => a.sqrt(),
            Unary::Sin => a.sin(),
            Unary::Cos => a.cos(),
            Unary::Tan => a.tan(),
            Unary::Asin => a.asin(),
            Unary::Acos => a.acos(),
            Unary::Atan => a.atan(),
            Unary::Sinh => a.sinh(),
            Unary::Cosh => a.cosh(),
            Unary::Tanh => a.tanh(),
            Unary::Asinh => a.asinh(),
            Unary::Acosh => a.acosh(),
            Unary::Atanh => a.atanh(),
            Unary::Arcinv => a.arcinv(),
            Unary::Exp => a.exp(),
            Unary::Ln => a.ln(),
            Unary::Abs => a.abs(),
            Unary::Sign => a.sign(),
        }
    }
}

impl Binary {
    /// All values on a pair of intervals. `Atan2` takes (y, x).
    #[inline]
    pub fn apply_interval(self, a: Interval, b: Interval) -> Interval {
        match self {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Pow => a.pow(b),
            Binary::Atan2 => a.atan2(b),
            Binary::Min => a.min(b),
            Binary::Max => a.max(b),
        }
    }
}

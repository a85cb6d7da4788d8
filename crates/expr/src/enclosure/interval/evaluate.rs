//! Runs a tape on intervals.

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
    registers: Vec<Interval>,
}

impl<'t> IntervalEvaluator<'t> {
    /// An evaluator for one tape.
    pub fn new(tape: &'t Tape) -> IntervalEvaluator<'t> {
        let mut registers = vec![Interval::WHOLE; tape.register_count()];
        for (register, constant) in registers[tape.input_count()..].iter_mut().zip(tape.constants()) {
            *register = Interval::point(*constant);
        }
        IntervalEvaluator { tape, registers }
    }

    /// Encloses the outputs over the box of the inputs.
    ///
    /// # Panics
    /// If the slices do not have the lengths that the tape states.
    pub fn run(&mut self, inputs: &[Interval], outputs: &mut [Interval]) {
        assert_eq!(outputs.len(), self.tape.output_count(), "number of outputs");
        self.registers[..self.tape.input_count()].copy_from_slice(inputs);
        for step in self.tape.instructions() {
            let a = self.registers[step.a as usize];
            self.registers[step.out as usize] = match step.operation {
                Operation::Unary(op) => op.apply_interval(a),
                Operation::Curve(order) => self.tape.curves()[step.b as usize].enclosure(order, a),
                Operation::Binary(op) => binary(op, step, a, self.registers[step.b as usize]),
                Operation::SinCos => {
                    self.registers[step.b as usize] = a.cos();
                    a.sin()
                }
            };
        }
        for (output, &register) in outputs.iter_mut().zip(self.tape.outputs()) {
            *output = self.registers[register as usize];
        }
    }
}

/// One register twice is one number twice.
#[inline]
fn binary(op: Binary, step: &Instruction, a: Interval, b: Interval) -> Interval {
    if step.a == step.b && op == Binary::Mul { a.squared() } else { op.apply_interval(a, b) }
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

//! The scalar evaluator: one set of inputs at a time.

use std::sync::Arc;

use crate::symbolic::curve::Curve;
use crate::symbolic::op::Binary;
use crate::tape::kernel;
use crate::tape::{Instruction, Operation, Tape};

/// Runs a tape on floats; keeps its registers, so that a run allocates nothing.
#[derive(Clone, Debug)]
pub struct ScalarEvaluator<'t> {
    tape: &'t Tape,
    registers: Vec<f64>,
}

impl<'t> ScalarEvaluator<'t> {
    /// An evaluator for one tape.
    pub fn new(tape: &'t Tape) -> ScalarEvaluator<'t> {
        let mut registers = vec![0.0; tape.register_count()];
        let first = tape.input_count();
        registers[first..first + tape.constants().len()].copy_from_slice(tape.constants());
        ScalarEvaluator { tape, registers }
    }

    /// Computes the outputs at the inputs. A domain error gives NaN.
    ///
    /// # Panics
    /// If the slices do not have the lengths that the tape states.
    pub fn run(&mut self, inputs: &[f64], outputs: &mut [f64]) {
        assert_eq!(outputs.len(), self.tape.output_count(), "number of outputs");
        self.registers[..self.tape.input_count()].copy_from_slice(inputs);
        execute(self.tape.instructions(), self.tape.curves(), &mut self.registers);
        for (output, &register) in outputs.iter_mut().zip(self.tape.outputs()) {
            *output = self.registers[register as usize];
        }
    }
}

/// Out of the way of what tapes mostly consist of.
#[cold]
#[inline(never)]
fn seldom_settled(value: f64, last: f64) -> f64 {
    kernel::settled(value, last)
}

pub(crate) fn execute(instructions: &[Instruction], curves: &[Arc<Curve>], registers: &mut [f64]) {
    for step in instructions {
        let a = registers[step.a as usize];
        registers[step.out as usize] = match step.operation {
            Operation::Unary(op) => op.apply(a),
            Operation::Curve(order) => curves[step.b as usize].value(order, a),
            // most of what there is, without a call
            Operation::Binary(Binary::Add) => a + registers[step.b as usize],
            Operation::Binary(Binary::Sub) => a - registers[step.b as usize],
            Operation::Binary(Binary::Mul) => a * registers[step.b as usize],
            Operation::Binary(Binary::Div) => a / registers[step.b as usize],
            Operation::Binary(op) => op.apply(a, registers[step.b as usize]),
            Operation::Middle | Operation::Widened => a,
            Operation::Settled => seldom_settled(a, registers[step.b as usize]),
            Operation::SinCos => {
                let (sine, cosine) = kernel::sin_cos(a);
                registers[step.b as usize] = cosine;
                sine
            }
        };
    }
}

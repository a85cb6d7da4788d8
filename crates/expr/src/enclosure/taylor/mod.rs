//! Tapes on truncated power series: what a tape's outputs do along a path of its inputs, to any order.

mod series;

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::enclosure::interval::Interval;
use crate::symbolic::curve::Curve;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::{Operation, Tape, kernel};

/// A coefficient of a power series: a float, or an interval that encloses it.
pub trait Coefficient:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A number.
    fn number(x: f64) -> Self;
    /// An operation on one value.
    fn unary(self, op: Unary) -> Self;
    /// An operation on two values.
    fn binary(self, op: Binary, other: Self) -> Self;
    /// A derivative of a curve at the value.
    fn on_curve(self, curve: &Curve, order: u8) -> Self;
    /// The value of a root, if the last step to it was short enough.
    fn settled(self, last: Self) -> Self;
    /// A value that is off by a bound at the most.
    fn widened(self, bound: Self) -> Self;
    /// The value if it is a single number.
    fn single(self) -> Option<f64>;
}

impl Coefficient for f64 {
    fn number(x: f64) -> f64 {
        x
    }

    fn unary(self, op: Unary) -> f64 {
        op.apply(self)
    }

    fn binary(self, op: Binary, other: f64) -> f64 {
        op.apply(self, other)
    }

    fn on_curve(self, curve: &Curve, order: u8) -> f64 {
        curve.value(order, self)
    }

    fn settled(self, last: f64) -> f64 {
        kernel::settled(self, last)
    }

    fn widened(self, _bound: f64) -> f64 {
        self
    }

    fn single(self) -> Option<f64> {
        Some(self)
    }
}

impl Coefficient for Interval {
    fn number(x: f64) -> Interval {
        Interval::point(x)
    }

    fn unary(self, op: Unary) -> Interval {
        op.apply_interval(self)
    }

    fn binary(self, op: Binary, other: Interval) -> Interval {
        op.apply_interval(self, other)
    }

    fn on_curve(self, curve: &Curve, order: u8) -> Interval {
        curve.enclosure(order, self)
    }

    fn settled(self, last: Interval) -> Interval {
        Interval::settled(self, last)
    }

    fn widened(self, bound: Interval) -> Interval {
        Interval::widened(self, bound)
    }

    fn single(self) -> Option<f64> {
        (self.lo == self.hi).then_some(self.lo)
    }
}

/// Runs a tape on power series `Σ c_k hᵏ`, cut off after some order; keeps its registers, so that a run allocates nothing.
///
/// The coefficients are those of the derivatives divided by factorials. On intervals they enclose the coefficients at every
/// point of the interval `c_0` of the inputs: with that of the order one higher than is used, they bound what the series leaves.
///
/// ```
/// use flank_expr::{Graph, Tape, TaylorEvaluator};
///
/// let graph = Graph::new();
/// let x = graph.variable("x");
/// let tape = Tape::new(&[x.exp()], &[x]).expect("x is the input");
/// let mut series = [0.0; 4];
/// // along x = 0 + 1·h
/// TaylorEvaluator::new(&tape, 3).run(&[0.0, 1.0, 0.0, 0.0], &mut series);
/// assert_eq!(series, [1.0, 1.0, 0.5, 1.0 / 6.0]);
/// ```
#[derive(Clone, Debug)]
pub struct TaylorEvaluator<'t, N> {
    tape: &'t Tape,
    terms: usize,
    registers: Vec<N>,
    /// Both operands, two results, and room for what is worked out on the way.
    scratch: Vec<N>,
}

impl<'t, N: Coefficient> TaylorEvaluator<'t, N> {
    /// An evaluator for one tape with series up to hᵒʳᵈᵉʳ.
    pub fn new(tape: &'t Tape, order: usize) -> TaylorEvaluator<'t, N> {
        let terms = order + 1;
        let mut registers = vec![N::number(0.0); terms * tape.register_count()];
        for (k, constant) in tape.constants().iter().enumerate() {
            registers[terms * (tape.input_count() + k)] = N::number(*constant);
        }
        TaylorEvaluator { tape, terms, registers, scratch: vec![N::number(0.0); 6 * terms] }
    }

    /// The outputs' series, one after the other, from the inputs' series, one after the other, constant terms first. At a kink
    /// (`abs`, `min`, `max`) the mean of the two sides is taken, as in [`Expr::derivative`](crate::Expr::derivative).
    ///
    /// # Panics
    /// If the slices do not hold `order + 1` coefficients for each input and output.
    pub fn run(&mut self, inputs: &[N], outputs: &mut [N]) {
        let terms = self.terms;
        assert_eq!(outputs.len(), terms * self.tape.output_count(), "coefficients of the outputs");
        self.registers[..terms * self.tape.input_count()].copy_from_slice(inputs);
        let (a, rest) = self.scratch.split_at_mut(terms);
        let (b, rest) = rest.split_at_mut(terms);
        let (out, rest) = rest.split_at_mut(terms);
        let (other, room) = rest.split_at_mut(terms);
        for step in self.tape.instructions() {
            let is_done = match terms {
                2 => series::short::<N, 2>(step, &mut self.registers),
                3 => series::short::<N, 3>(step, &mut self.registers),
                _ => false,
            };
            if is_done {
                continue;
            }
            let place = |register: u32| terms * register as usize..terms * (register as usize + 1);
            a.copy_from_slice(&self.registers[place(step.a)]);
            match step.operation {
                Operation::Unary(op) => series::unary(op, a, out, other, room),
                Operation::Curve(order) => {
                    series::on_curve(&self.tape.curves()[step.b as usize], order, a, out, room);
                }
                Operation::Binary(op) => {
                    b.copy_from_slice(&self.registers[place(step.b)]);
                    series::binary(op, a, b, out, other, room);
                }
                Operation::Middle => out.copy_from_slice(a),
                Operation::Settled => {
                    out.copy_from_slice(a);
                    out[0] = a[0].settled(self.registers[place(step.b)][0]);
                }
                Operation::Widened => {
                    out.copy_from_slice(a);
                    out[0] = a[0].widened(self.registers[place(step.b)][0]);
                }
                Operation::SinCos => {
                    series::sin_cos(a, out, other);
                    self.registers[place(step.b)].copy_from_slice(other);
                }
            }
            self.registers[place(step.out)].copy_from_slice(out);
        }
        for (k, &register) in self.tape.outputs().iter().enumerate() {
            let from = terms * register as usize;
            outputs[terms * k..terms * (k + 1)].copy_from_slice(&self.registers[from..from + terms]);
        }
    }
}

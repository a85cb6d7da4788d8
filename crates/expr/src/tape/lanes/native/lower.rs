//! From instructions on blocks to steps on the lanes of a register, each of which gives one value.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::encode::Packed;
use crate::symbolic::curve::Curve;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::kernel::trigonometric as trig;
use crate::tape::lanes::program::{LaneInstruction, LaneOperation, LaneTape};

/// A value by the number of the step that gives it.
pub(super) type Value = u32;

#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// The lanes of a block, or one number in all lanes: no work until they are used.
    Input(u32),
    Scalar(u32),
    Packed(Packed, Value, Value),
    SquareRoot(Value),
    Unordered(Value, Value),
    Shift(Value, u8),
    Select {
        mask: Value,
        set: Value,
        clear: Value,
    },
    /// The operation of this number, which is a function of the program.
    Call(u32, Value, Value),
    /// Puts a value where it is wanted.
    Store(Target, Value),
}

/// Where a value goes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    Block(u32),
    /// An output in memory of the caller.
    Output(u32),
}

impl Step {
    pub(super) fn operands(self) -> [Option<Value>; 3] {
        match self {
            Step::Input(_) | Step::Scalar(_) => [None; 3],
            Step::SquareRoot(a) | Step::Shift(a, _) | Step::Store(_, a) => [Some(a), None, None],
            Step::Packed(_, a, b) | Step::Unordered(a, b) | Step::Call(_, a, b) => [Some(a), Some(b), None],
            Step::Select { mask, set, clear } => [Some(mask), Some(set), Some(clear)],
        }
    }

    /// The same step on other values.
    pub(super) fn with_operands(self, other: impl Fn(Value) -> Value) -> Step {
        match self {
            Step::Input(_) | Step::Scalar(_) => self,
            Step::Packed(op, a, b) => Step::Packed(op, other(a), other(b)),
            Step::SquareRoot(a) => Step::SquareRoot(other(a)),
            Step::Unordered(a, b) => Step::Unordered(other(a), other(b)),
            Step::Shift(a, by) => Step::Shift(other(a), by),
            Step::Select { mask, set, clear } => {
                Step::Select { mask: other(mask), set: other(set), clear: other(clear) }
            }
            Step::Call(number, a, b) => Step::Call(number, other(a), other(b)),
            Step::Store(target, a) => Step::Store(target, other(a)),
        }
    }
}

/// An operation that is a function of the program.
#[derive(Debug)]
pub(super) enum Call {
    Unary(Unary),
    Binary(Binary),
    Curve(u8, Arc<Curve>),
}

/// A tape in steps.
pub(super) struct Lowered {
    pub(super) steps: Vec<Step>,
    /// Numbers that follow those of the tape.
    pub(super) constants: Vec<f64>,
    /// Operations by the number that calls have.
    pub(super) calls: Vec<Call>,
    pub(super) has_angles: bool,
}

/// Lays out instructions of a tape; `stores` are blocks with where they go. The largest angle of each lane goes to `angles`.
/// `constants` are those that follow the numbers of the tape already.
pub(super) fn lower(
    tape: &LaneTape,
    instructions: &[LaneInstruction],
    stores: impl Iterator<Item = (u32, Target)>,
    angles: u32,
    constants: Vec<f64>,
) -> Lowered {
    let mut lowering = Lowering {
        steps: Vec::new(),
        blocks: vec![None; tape.block_count],
        scalars: BTreeMap::new(),
        constants,
        first_constant: tape.scalars.len() as u32,
        calls: Vec::new(),
        largest_angle: None,
    };
    instructions.iter().for_each(|instruction| lowering.instruction(instruction, &tape.curves));
    for (from, to) in stores {
        let value = lowering.block(from);
        lowering.push(Step::Store(to, value));
    }
    let has_angles = lowering.largest_angle.is_some();
    if let Some(angle) = lowering.largest_angle {
        lowering.push(Step::Store(Target::Block(angles), angle));
    }
    Lowered { steps: lowering.steps, constants: lowering.constants, calls: lowering.calls, has_angles }
}

struct Lowering {
    steps: Vec<Step>,
    /// The value that a block of the tape has by now.
    blocks: Vec<Option<Value>>,
    scalars: BTreeMap<u32, Value>,
    constants: Vec<f64>,
    first_constant: u32,
    calls: Vec<Call>,
    largest_angle: Option<Value>,
}

impl Lowering {
    fn push(&mut self, step: Step) -> Value {
        self.steps.push(step);
        (self.steps.len() - 1) as Value
    }

    /// The value of a block: what it holds before the code runs if nothing has been put there.
    fn block(&mut self, block: u32) -> Value {
        if let Some(value) = self.blocks[block as usize] {
            return value;
        }
        let value = self.push(Step::Input(block));
        self.blocks[block as usize] = Some(value);
        value
    }

    fn scalar(&mut self, index: u32) -> Value {
        if let Some(known) = self.scalars.get(&index) {
            return *known;
        }
        debug_assert!(index < self.first_constant + self.constants.len() as u32, "scalars of the tape or constants");
        let value = self.push(Step::Scalar(index));
        self.scalars.insert(index, value);
        value
    }

    fn constant(&mut self, number: f64) -> Value {
        let known = self.constants.iter().position(|other| other.to_bits() == number.to_bits());
        let index = known.unwrap_or(self.constants.len());
        if known.is_none() {
            self.constants.push(number);
        }
        self.scalar(self.first_constant + index as u32)
    }

    fn bits(&mut self, bits: u64) -> Value {
        self.constant(f64::from_bits(bits))
    }

    fn packed(&mut self, op: Packed, a: Value, b: Value) -> Value {
        self.push(Step::Packed(op, a, b))
    }

    fn add(&mut self, a: Value, b: Value) -> Value {
        self.packed(Packed::Add, a, b)
    }

    fn subtract(&mut self, a: Value, b: Value) -> Value {
        self.packed(Packed::Subtract, a, b)
    }

    fn multiply(&mut self, a: Value, b: Value) -> Value {
        self.packed(Packed::Multiply, a, b)
    }

    fn instruction(&mut self, instruction: &LaneInstruction, curves: &[Arc<Curve>]) {
        let LaneInstruction { operation, out, a, b } = *instruction;
        let value = match operation {
            LaneOperation::Unary(Unary::Sin) => {
                let angle = self.block(a);
                self.sin_cos(angle).0
            }
            LaneOperation::Unary(Unary::Cos) => {
                let angle = self.block(a);
                self.sin_cos(angle).1
            }
            LaneOperation::SinCos => {
                let angle = self.block(a);
                let (sine, cosine) = self.sin_cos(angle);
                self.blocks[b as usize] = Some(cosine);
                sine
            }
            LaneOperation::Unary(op) => {
                let a = self.block(a);
                self.unary(op, a)
            }
            LaneOperation::Binary(op) => {
                let (a, b) = (self.block(a), self.block(b));
                self.binary(op, a, b)
            }
            LaneOperation::ScalarLeft(op) => {
                let (a, b) = (self.scalar(a), self.block(b));
                self.binary(op, a, b)
            }
            LaneOperation::ScalarRight(op) => {
                let (a, b) = (self.block(a), self.scalar(b));
                self.binary(op, a, b)
            }
            LaneOperation::Curve(order) => {
                let (curve, a) = (curves[b as usize].clone(), self.block(a));
                self.call(Call::Curve(order, curve), a, a)
            }
            LaneOperation::Spread => self.scalar(a),
            LaneOperation::Copy => self.block(a),
            LaneOperation::Settled => {
                let (a, b) = (self.block(a), self.block(b));
                self.settled(a, b)
            }
        };
        self.blocks[out as usize] = Some(value);
    }

    fn call(&mut self, call: Call, a: Value, b: Value) -> Value {
        self.calls.push(call);
        self.push(Step::Call((self.calls.len() - 1) as u32, a, b))
    }

    fn unary(&mut self, op: Unary, a: Value) -> Value {
        match op {
            Unary::Neg => {
                let sign = self.bits(SIGN);
                self.packed(Packed::ExclusiveOr, a, sign)
            }
            Unary::Abs => self.magnitude(a),
            Unary::Sqrt => self.push(Step::SquareRoot(a)),
            _ => self.call(Call::Unary(op), a, a),
        }
    }

    fn binary(&mut self, op: Binary, a: Value, b: Value) -> Value {
        match op {
            Binary::Add => self.add(a, b),
            Binary::Sub => self.subtract(a, b),
            Binary::Mul => self.multiply(a, b),
            Binary::Div => self.packed(Packed::Divide, a, b),
            Binary::Min => self.extreme(Packed::Minimum, a, b),
            Binary::Max => self.extreme(Packed::Maximum, a, b),
            Binary::Atan2 | Binary::Pow => self.call(Call::Binary(op), a, b),
        }
    }

    /// What `kernel::settled` does, operation by operation.
    fn settled(&mut self, a: Value, b: Value) -> Value {
        let [one, zero] = [1.0, 0.0].map(|number| self.constant(number));
        let size = self.magnitude(b);
        let left = self.subtract(one, size);
        let root = self.push(Step::SquareRoot(left));
        let nothing = self.multiply(zero, root);
        self.add(a, nothing)
    }

    fn magnitude(&mut self, a: Value) -> Value {
        let mask = self.bits(!SIGN);
        self.packed(Packed::And, a, mask)
    }

    /// The machine gives `b` where one is NaN, the tape a NaN.
    fn extreme(&mut self, op: Packed, a: Value, b: Value) -> Value {
        let extreme = self.packed(op, a, b);
        let mask = self.push(Step::Unordered(a, a));
        self.push(Step::Select { mask, set: a, clear: extreme })
    }

    /// What `kernel::sin_cos_near` does, operation by operation.
    fn sin_cos(&mut self, x: Value) -> (Value, Value) {
        let size = self.magnitude(x);
        let before = self.largest_angle.unwrap_or_else(|| self.constant(0.0));
        // a NaN on the left leaves the right
        self.largest_angle = Some(self.packed(Packed::Maximum, size, before));
        let (high, low, quarters) = self.reduced(x);
        let sine = self.sine(high, low);
        let cosine = self.cosine(high, low);
        // the lowest bits of the number of quarters, as signs
        let odd = self.push(Step::Shift(quarters, 63));
        let half = self.push(Step::Shift(quarters, 62));
        let sign = self.bits(SIGN);
        let sine_sign = self.packed(Packed::And, half, sign);
        let turned = self.packed(Packed::ExclusiveOr, half, odd);
        let cosine_sign = self.packed(Packed::And, turned, sign);
        let first = self.push(Step::Select { mask: odd, set: cosine, clear: sine });
        let second = self.push(Step::Select { mask: odd, set: sine, clear: cosine });
        (self.packed(Packed::ExclusiveOr, first, sine_sign), self.packed(Packed::ExclusiveOr, second, cosine_sign))
    }

    fn reduced(&mut self, x: Value) -> (Value, Value, Value) {
        let [per_quarter, rounder] = [trig::TWO_OVER_PI, trig::ROUNDER].map(|number| self.constant(number));
        let turned = self.multiply(x, per_quarter);
        let shifted = self.add(turned, rounder);
        let multiple = self.subtract(shifted, rounder);
        let [first, second, third, rest] =
            [trig::FIRST, trig::SECOND, trig::THIRD, trig::REST].map(|number| self.constant(number));
        let piece = self.multiply(multiple, first);
        let first = self.subtract(x, piece);
        let (second, second_error) = self.less_exactly(first, multiple, second);
        let (third, third_error) = self.less_exactly(second, multiple, third);
        let piece = self.multiply(multiple, rest);
        let rest = self.subtract(piece, second_error);
        let rest = self.subtract(rest, third_error);
        let high = self.subtract(third, rest);
        let lost = self.subtract(third, high);
        (high, self.subtract(lost, rest), shifted)
    }

    /// `from − multiple · piece`, and what its rounding left.
    fn less_exactly(&mut self, from: Value, multiple: Value, piece: Value) -> (Value, Value) {
        let subtracted = self.multiply(multiple, piece);
        let difference = self.subtract(from, subtracted);
        let back = self.subtract(from, difference);
        (difference, self.subtract(back, subtracted))
    }

    fn polynomial(&mut self, x: Value, coefficients: &[f64]) -> Value {
        let (last, others) = coefficients.split_last().expect("a polynomial has coefficients");
        let mut sum = self.constant(*last);
        for coefficient in others.iter().rev() {
            let product = self.multiply(sum, x);
            let coefficient = self.constant(*coefficient);
            sum = self.add(product, coefficient);
        }
        sum
    }

    fn sine(&mut self, x: Value, low: Value) -> Value {
        let z = self.multiply(x, x);
        let cube = self.multiply(z, x);
        let tail = self.polynomial(z, &trig::SINE_TAIL);
        let half = self.constant(0.5);
        let half_low = self.multiply(half, low);
        let product = self.multiply(cube, tail);
        let inner = self.subtract(half_low, product);
        let inner = self.multiply(z, inner);
        let inner = self.subtract(inner, low);
        let leading = self.constant(trig::SINE_CUBE);
        let leading = self.multiply(cube, leading);
        let correction = self.subtract(inner, leading);
        self.subtract(x, correction)
    }

    fn cosine(&mut self, x: Value, low: Value) -> Value {
        let z = self.multiply(x, x);
        let tail = self.polynomial(z, &trig::COSINE_TAIL);
        let tail = self.multiply(z, tail);
        let [half, one] = [0.5, 1.0].map(|number| self.constant(number));
        let half = self.multiply(half, z);
        let most = self.subtract(one, half);
        let lost = self.subtract(one, most);
        let lost = self.subtract(lost, half);
        let tail = self.multiply(z, tail);
        let shift = self.multiply(x, low);
        let small = self.subtract(tail, shift);
        let small = self.add(lost, small);
        self.add(most, small)
    }
}

const SIGN: u64 = 1 << 63;

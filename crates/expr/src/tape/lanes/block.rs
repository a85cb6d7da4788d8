//! Instructions on blocks of lanes, as loops that the compiler turns into vector instructions where they are inlined.

use std::sync::Arc;

use super::program::{LaneInstruction, LaneOperation};
use crate::symbolic::curve::Curve;
use crate::symbolic::op::{Binary, Unary};
use crate::tape::kernel;

/// Points that are evaluated at once: enough to hide the cost of going through the instructions, few enough that a hundred
/// registers stay in the first-level cache.
pub const LANES: usize = 32;

/// Lanes that are worked on together.
const GROUP: usize = 8;

/// One number for each lane.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Block(pub(super) [f64; LANES]);

impl Default for Block {
    fn default() -> Block {
        Block([0.0; LANES])
    }
}

impl Block {
    #[inline(always)]
    fn group(&self, k: usize) -> [f64; GROUP] {
        self.0.as_chunks::<GROUP>().0[k]
    }

    #[inline(always)]
    fn set_group(&mut self, k: usize, values: [f64; GROUP]) {
        self.0.as_chunks_mut::<GROUP>().0[k] = values;
    }
}

#[inline(always)]
pub(super) fn run(instructions: &[LaneInstruction], curves: &[Arc<Curve>], scalars: &[f64], blocks: &mut [Block]) {
    for step in instructions {
        let (out, a, b) = (step.out as usize, step.a as usize, step.b as usize);
        match step.operation {
            LaneOperation::Binary(op) => binary(op, blocks, out, (Block::group, a), (Block::group, b)),
            LaneOperation::ScalarLeft(op) => {
                let left = scalars[a];
                binary(
                    op,
                    blocks,
                    out,
                    (
                        #[inline(always)]
                        move |_: &Block, _| [left; GROUP],
                        b,
                    ),
                    (Block::group, b),
                );
            }
            LaneOperation::ScalarRight(op) => {
                let right = scalars[b];
                binary(
                    op,
                    blocks,
                    out,
                    (Block::group, a),
                    (
                        #[inline(always)]
                        move |_: &Block, _| [right; GROUP],
                        a,
                    ),
                );
            }
            LaneOperation::Unary(op) => unary(op, blocks, out, a),
            LaneOperation::SinCos => {
                let (sine, cosine) = sin_cos(&blocks[a]);
                blocks[out] = sine;
                blocks[b] = cosine;
            }
            LaneOperation::Curve(order) => {
                let curve = &curves[b];
                blocks[out].0 = blocks[a].0.map(|x| curve.value(order, x));
            }
            LaneOperation::Copy => blocks[out] = blocks[a],
            LaneOperation::Settled => combine(blocks, out, (Block::group, a), (Block::group, b), kernel::settled),
            LaneOperation::Spread => blocks[out].0 = [scalars[a]; LANES],
        }
    }
}

/// `out = f(a, b)`, group by group; each operand is a block and how its groups are read.
#[inline(always)]
fn combine(
    blocks: &mut [Block],
    out: usize,
    (left, a): (impl Fn(&Block, usize) -> [f64; GROUP], usize),
    (right, b): (impl Fn(&Block, usize) -> [f64; GROUP], usize),
    f: impl Fn(f64, f64) -> f64,
) {
    for k in 0..LANES / GROUP {
        let (x, y) = (left(&blocks[a], k), right(&blocks[b], k));
        let mut result = [0.0; GROUP];
        for i in 0..GROUP {
            result[i] = f(x[i], y[i]);
        }
        blocks[out].set_group(k, result);
    }
}

#[inline(always)]
fn binary(
    op: Binary,
    blocks: &mut [Block],
    out: usize,
    a: (impl Fn(&Block, usize) -> [f64; GROUP], usize),
    b: (impl Fn(&Block, usize) -> [f64; GROUP], usize),
) {
    match op {
        Binary::Add => combine(blocks, out, a, b, |x, y| x + y),
        Binary::Sub => combine(blocks, out, a, b, |x, y| x - y),
        Binary::Mul => combine(blocks, out, a, b, |x, y| x * y),
        Binary::Div => combine(blocks, out, a, b, |x, y| x / y),
        Binary::Min => combine(blocks, out, a, b, |x, y| Binary::Min.apply(x, y)),
        Binary::Max => combine(blocks, out, a, b, |x, y| Binary::Max.apply(x, y)),
        Binary::Atan2 => combine(blocks, out, a, b, kernel::atan2),
        Binary::Pow => combine(blocks, out, a, b, |x, y| Binary::Pow.apply(x, y)),
    }
}

/// `out = f(a)`, in one loop over all lanes.
#[inline(always)]
fn map(blocks: &mut [Block], out: usize, a: usize, f: impl Fn(f64) -> f64) {
    let arguments = blocks[a];
    let mut result = Block::default();
    for i in 0..LANES {
        result.0[i] = f(arguments.0[i]);
    }
    blocks[out] = result;
}

#[inline(always)]
fn unary(op: Unary, blocks: &mut [Block], out: usize, a: usize) {
    match op {
        Unary::Neg => map(blocks, out, a, |x| -x),
        Unary::Abs => map(blocks, out, a, f64::abs),
        Unary::Sqrt => map(blocks, out, a, f64::sqrt),
        Unary::Sign => map(blocks, out, a, |x| Unary::Sign.apply(x)),
        Unary::Sin => blocks[out] = sin_cos(&blocks[a]).0,
        Unary::Cos => blocks[out] = sin_cos(&blocks[a]).1,
        Unary::Tan => {
            let arguments = blocks[a];
            map(blocks, out, a, kernel::tan_near);
            repair(&arguments, |i, x| blocks[out].0[i] = kernel::tan(x));
        }
        Unary::Asin => map(blocks, out, a, kernel::asin),
        Unary::Acos => map(blocks, out, a, kernel::acos),
        Unary::Atan => map(blocks, out, a, kernel::atan),
        Unary::Exp => map(blocks, out, a, kernel::exp),
        Unary::Ln => map(blocks, out, a, kernel::ln),
        Unary::Sinh | Unary::Cosh | Unary::Tanh | Unary::Asinh | Unary::Acosh | Unary::Atanh | Unary::Arcinv => {
            blocks[out].0 = blocks[a].0.map(|x| op.apply(x));
        }
    }
}

#[inline(always)]
fn sin_cos(angles: &Block) -> (Block, Block) {
    let (mut sine, mut cosine) = (Block::default(), Block::default());
    for i in 0..LANES {
        (sine.0[i], cosine.0[i]) = kernel::sin_cos_near(angles.0[i]);
    }
    repair(angles, |i, x| (sine.0[i], cosine.0[i]) = kernel::sin_cos(x));
    (sine, cosine)
}

/// Lanes whose angle needs the long reduction, one by one.
#[inline(always)]
fn repair(angles: &Block, mut put: impl FnMut(usize, f64)) {
    if angles.0.iter().fold(false, |any, x| any | kernel::is_far(*x)) {
        for (i, &x) in angles.0.iter().enumerate().filter(|(_, x)| kernel::is_far(**x)) {
            put(i, x);
        }
    }
}

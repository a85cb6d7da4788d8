//! Tapes as machine code: AVX2 on x86-64, four lanes at a time, registers instead of blocks.
//!
//! The code does what the instructions of the tape say, in their order, so its results have the same bits. Where an angle is
//! too large for the short reduction it says so, and the tape runs again, instruction by instruction. This module
//! holds all unsafe code of the project: to enter code that was made at run time, and to be called by it. Memory is written
//! first and executable then, never both.

mod encode;
mod lower;
mod registers;

use std::sync::Arc;

use memmap2::{Mmap, MmapMut};
use pulp::Arch;

use self::lower::{Call, lower};
use self::registers::{OPERANDS, RESULT, assemble};
use super::block::{Block, LANES};
use super::program::LaneTape;
use crate::kernel;
use crate::kernel::trigonometric::FARTHEST;
use crate::op::Unary;

/// Lanes of a vector register.
const WIDTH: usize = 4;
/// Longer tapes are not translated: their code would not stay in a cache.
const MOST_INSTRUCTIONS: usize = 20_000;

type Vector = [f64; WIDTH];

/// The code of a tape.
#[derive(Clone, Debug)]
pub(super) struct Native(Arc<Translation>);

#[derive(Debug)]
struct Translation {
    memory: Mmap,
    /// Numbers that follow the scalars of the tape.
    constants: Vec<f64>,
    /// What the code has the program do; it holds their addresses.
    _calls: Vec<Call>,
    blocks: usize,
    scalars: usize,
    scratch: usize,
    /// The block of the largest angles.
    angles: usize,
}

impl Native {
    /// None where the machine lacks the instructions or forbids such memory, and for tapes too long for it.
    pub(super) fn translate(tape: &LaneTape) -> Option<Native> {
        if !is_available() || tape.each.len() > MOST_INSTRUCTIONS {
            return None;
        }
        let lowered = lower(tape);
        let addresses: Vec<usize> = lowered.calls.iter().map(|call| std::ptr::from_ref(call).addr()).collect();
        let assembled = assemble(&lowered, (called as *const ()).addr(), &addresses);
        let mut memory = MmapMut::map_anon(assembled.code.len()).ok()?;
        memory.copy_from_slice(&assembled.code);
        let angles = tape.block_count + tape.outputs.len();
        Some(Native(Arc::new(Translation {
            memory: memory.make_exec().ok()?,
            scalars: tape.scalars.len() + lowered.constants.len(),
            constants: lowered.constants,
            _calls: lowered.calls,
            blocks: angles + 1,
            scratch: WIDTH * assembled.scratch,
            angles,
        })))
    }

    /// Blocks that it works on: those of the tape, one for each output, and one more.
    pub(super) fn block_count(&self) -> usize {
        self.0.blocks
    }

    /// Numbers of scratch memory.
    pub(super) fn scratch_len(&self) -> usize {
        self.0.scratch
    }

    /// What follows the scalars of the tape.
    pub(super) fn constants(&self) -> &[f64] {
        &self.0.constants
    }

    /// Runs the first lanes, `count` of them at least; false if a lane has an angle that is too large.
    pub(super) fn run(&self, count: usize, scalars: &[f64], blocks: &mut [Block], scratch: &mut [f64]) -> bool {
        let vectors = count.clamp(1, LANES).div_ceil(WIDTH);
        self.enter(vectors, scalars, blocks, scratch);
        blocks[self.0.angles].0[..vectors * WIDTH].iter().all(|angle| *angle <= FARTHEST)
    }

    #[allow(unsafe_code)]
    fn enter(&self, vectors: usize, scalars: &[f64], blocks: &mut [Block], scratch: &mut [f64]) {
        let code = &self.0;
        assert!(blocks.len() >= code.blocks && scalars.len() >= code.scalars && scratch.len() >= code.scratch);
        // SAFETY: the memory holds a whole function of this type, made by `assemble` for a machine that has AVX2. It reads and
        // writes blocks, scalars and scratch memory only up to the lengths that were just compared, and of each block the
        // first `vectors` vectors, which it has.
        unsafe {
            let function: extern "sysv64" fn(*mut Block, *const f64, *mut f64, usize) =
                std::mem::transmute(code.memory.as_ptr());
            function(blocks.as_mut_ptr(), scalars.as_ptr(), scratch.as_mut_ptr(), vectors);
        }
    }
}

/// Whether this machine can run such code.
pub(super) fn is_available() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

/// What the code calls: an operation on four lanes of the scratch memory.
#[allow(unsafe_code)]
extern "sysv64" fn called(call: *const Call, scratch: *mut Vector) {
    // SAFETY: only code that `assemble` made calls this, with an address of a `Call` that lives as long as the code and its own
    // scratch memory, of which the places for operands and result are always a part.
    let (call, places) = unsafe { (&*call, std::slice::from_raw_parts_mut(scratch, RESULT + 1)) };
    places[RESULT] = call.apply(OPERANDS.map(|place| places[place]));
}

impl Call {
    fn apply(&self, [a, b]: [Vector; 2]) -> Vector {
        Arch::new().dispatch(
            #[inline(always)]
            || match self {
                Call::Unary(Unary::Asin) => a.map(kernel::asin),
                Call::Unary(Unary::Acos) => a.map(kernel::acos),
                Call::Unary(Unary::Exp) => a.map(kernel::exp),
                Call::Unary(Unary::Ln) => a.map(kernel::ln),
                Call::Unary(op) => a.map(|a| op.apply(a)),
                Call::Binary(op) => std::array::from_fn(|lane| op.apply(a[lane], b[lane])),
                Call::Curve(order, curve) => a.map(|a| curve.value(*order, a)),
            },
        )
    }
}

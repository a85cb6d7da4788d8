//! Tapes as machine code on x86-64: four lanes at a time (AVX2) or eight (AVX-512), registers instead of blocks.
//!
//! The code does what the instructions of the tape say, so its results have the same bits, in whatever order that needs. Where an angle is
//! too large for the short reduction it says so, and the tape runs again, instruction by instruction. This module
//! holds all unsafe code of the libraries: to enter code that was made at run time, to be called by it, to wait for what it has written,
//! and to run loops of the compiler on AVX-512. Memory is written first and executable then, never both.

mod encode;
mod loops;
mod lower;
mod registers;
mod schedule;

use std::sync::Arc;

use memmap2::{Mmap, MmapMut};
use pulp::Arch;

pub(super) use self::loops::EightLanes;
use self::lower::{Call, Lowered, Target, lower};
use self::registers::{OPERANDS, RESULT, assemble};
use self::schedule::ordered;
use super::Layout;
use super::block::{Block, LANES};
use super::program::LaneTape;
use crate::symbolic::op::Unary;
use crate::tape::kernel;
use crate::tape::kernel::trigonometric::FARTHEST;

/// Longer tapes are not translated: their code would not stay in a cache.
const MOST_INSTRUCTIONS: usize = 20_000;

/// Vector registers of the machine, by their lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Vectors {
    /// AVX2.
    Four,
    /// AVX-512, with its instructions on masks and bits of doubles (DQ).
    Eight,
}

impl Vectors {
    /// Those that this machine has, the widest last.
    pub(super) fn available() -> impl DoubleEndedIterator<Item = Vectors> {
        let four = std::arch::is_x86_feature_detected!("avx2").then_some(Vectors::Four);
        let has_eight =
            std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("avx512dq");
        four.into_iter().chain(has_eight.then_some(Vectors::Eight))
    }

    /// For tables with a place for each.
    pub(super) fn index(self) -> usize {
        self as usize
    }

    pub(super) fn lanes(self) -> usize {
        match self {
            Vectors::Four => 4,
            Vectors::Eight => 8,
        }
    }

    /// Whether a register is as long as a line of a cache.
    pub(super) fn are_cache_lines(self) -> bool {
        self == Vectors::Eight
    }

    fn registers(self) -> usize {
        match self {
            Vectors::Four => 16,
            Vectors::Eight => 32,
        }
    }

    /// How often a scalar lies in memory: as wide as a register, or once where instructions can spread it.
    fn spread(self) -> usize {
        match self {
            Vectors::Four => 4,
            Vectors::Eight => 1,
        }
    }
}

/// A scalar as wide as a register of four lanes.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(super) struct Wide(#[expect(dead_code, reason = "machine code reads it")] pub(super) [f64; 4]);

/// The code of a tape.
#[derive(Clone, Debug)]
pub(super) struct Native(Arc<Translation>);

#[derive(Debug)]
struct Translation {
    memory: Mmap,
    vectors: Vectors,
    /// Numbers that follow the scalars of the tape.
    constants: Vec<f64>,
    /// What the code has the program do; it holds their addresses.
    _calls: [Vec<Call>; 2],
    /// Where the code of [`Part::Each`] begins.
    each: usize,
    blocks: usize,
    scalars: usize,
    scratch: usize,
    /// Outputs that go to memory of the caller.
    written: usize,
    /// The block of the largest angles, and whether the two functions write it.
    angles: usize,
    has_angles: [bool; 2],
    /// Whether these outputs go there past the caches.
    streams: bool,
}

/// Which of a tape's instructions.
#[derive(Clone, Copy)]
pub(super) enum Part {
    ByLane,
    Each,
}

impl Native {
    /// None where the machine forbids such memory, and for tapes too long for it.
    pub(super) fn translate(tape: &LaneTape, vectors: Vectors, layout: Layout) -> Option<Native> {
        if tape.by_lane.len() + tape.each.len() > MOST_INSTRUCTIONS {
            return None;
        }
        let angles = tape.block_count + tape.outputs.len();
        let kept = tape.kept.iter().map(|block| (*block, Target::Block(*block)));
        let mut kept = lower(tape, &tape.by_lane, kept, angles as u32, Vec::new());
        let outputs = tape.outputs.iter().enumerate().map(|(k, block)| {
            let is_written = k < tape.written;
            let target =
                if is_written { Target::Output(k as u32) } else { Target::Block((tape.block_count + k) as u32) };
            (*block, target)
        });
        let mut each = lower(tape, &tape.each, outputs, angles as u32, kept.constants.clone());
        if layout != Layout::AsTold {
            for part in [&mut kept, &mut each] {
                part.steps = ordered(std::mem::take(&mut part.steps), vectors);
            }
        }
        let assembled = |lowered: &Lowered| {
            let addresses: Vec<usize> = lowered.calls.iter().map(|call| std::ptr::from_ref(call).addr()).collect();
            let function = match vectors {
                Vectors::Four => (called::<4> as *const ()).addr(),
                Vectors::Eight => (called::<8> as *const ()).addr(),
            };
            assemble(lowered, (vectors, layout == Layout::PastCaches), function, &addresses)
        };
        let [kept_code, each_code] = [&kept, &each].map(assembled);
        let code = [kept_code.code.as_slice(), &each_code.code].concat();
        let mut memory = MmapMut::map_anon(code.len()).ok()?;
        memory.copy_from_slice(&code);
        Some(Native(Arc::new(Translation {
            memory: memory.make_exec().ok()?,
            vectors,
            each: kept_code.code.len(),
            scalars: tape.scalars.len() + each.constants.len(),
            constants: each.constants,
            _calls: [kept.calls, each.calls],
            blocks: angles + 1,
            scratch: (kept_code.scratch.max(each_code.scratch) * vectors.lanes()).div_ceil(LANES),
            written: tape.written,
            angles,
            has_angles: [kept.has_angles, each.has_angles],
            streams: layout == Layout::PastCaches,
        })))
    }

    /// Blocks that it works on: those of the tape, one for each output, and one more.
    pub(super) fn block_count(&self) -> usize {
        self.0.blocks
    }

    /// Blocks of scratch memory.
    pub(super) fn scratch_len(&self) -> usize {
        self.0.scratch
    }

    /// What follows the scalars of the tape.
    pub(super) fn constants(&self) -> &[f64] {
        &self.0.constants
    }

    /// Whether it reads scalars as wide as a register, or the numbers themselves.
    pub(super) fn reads_wide(&self) -> bool {
        self.0.vectors.spread() > 1
    }

    /// Runs the first lanes, `count` of them at least; false if a lane has an angle that is too large, or `out` begins where the code
    /// cannot write. Outputs that go to memory of the caller, those of [`Part::Each`], go to `out`.
    pub(super) fn run(
        &self,
        (part, count): (Part, usize),
        scalars: (&[f64], &[Wide]),
        blocks: &mut [Block],
        scratch: &mut [Block],
        out: &mut [[f64; LANES]],
    ) -> bool {
        let lanes = self.0.vectors.lanes();
        if self.0.streams && !out.is_empty() && !out.as_ptr().addr().is_multiple_of(lanes * size_of::<f64>()) {
            return false;
        }
        let vectors = count.clamp(1, LANES).div_ceil(lanes);
        self.enter((part, vectors), scalars, blocks, scratch, out);
        let angles = &blocks[self.0.angles].0[..vectors * lanes];
        !self.0.has_angles[part as usize] || angles.iter().all(|angle| *angle <= FARTHEST)
    }

    #[allow(unsafe_code)]
    fn enter(
        &self,
        (part, vectors): (Part, usize),
        (scalars, wide): (&[f64], &[Wide]),
        blocks: &mut [Block],
        scratch: &mut [Block],
        out: &mut [[f64; LANES]],
    ) {
        let code = &self.0;
        let (length, scalars) = match code.vectors {
            Vectors::Four => (wide.len(), wide.as_ptr().cast()),
            Vectors::Eight => (scalars.len(), scalars.as_ptr()),
        };
        let (start, written) = match part {
            Part::ByLane => (0, 0),
            Part::Each => (code.each, code.written),
        };
        assert!(blocks.len() >= code.blocks && length >= code.scalars && scratch.len() >= code.scratch);
        assert!(out.len() >= written);
        // SAFETY: the memory holds two whole functions of this type, one after the other, made by `assemble` for vectors that
        // this machine has, and `start` is where one of them begins. They read and write blocks, scalars, scratch memory and outputs only
        // up to the lengths that were just compared, and of each block the first `vectors` vectors, which it has. Code that streams is
        // entered with outputs that begin where a register's length lets them.
        unsafe {
            let function: extern "sysv64" fn(*mut Block, *const f64, *mut Block, *mut [f64; LANES], usize) =
                std::mem::transmute(code.memory.as_ptr().add(start));
            function(blocks.as_mut_ptr(), scalars, scratch.as_mut_ptr(), out.as_mut_ptr(), vectors);
        }
    }
}

/// Waits until all that this thread's code has written past the caches can be seen by other threads.
#[allow(unsafe_code)]
pub(super) fn settle() {
    // SAFETY: each x86-64 processor has this instruction.
    unsafe { std::arch::x86_64::_mm_sfence() }
}

/// What the code calls: an operation on as many lanes of the scratch memory as a register has.
#[allow(unsafe_code)]
extern "sysv64" fn called<const WIDTH: usize>(call: *const Call, scratch: *mut [f64; WIDTH]) {
    // SAFETY: only code that `assemble` made calls this, with an address of a `Call` that lives as long as the code and its own
    // scratch memory, of which the places for operands and result are always a part.
    let (call, places) = unsafe { (&*call, std::slice::from_raw_parts_mut(scratch, RESULT + 1)) };
    places[RESULT] = call.apply(OPERANDS.map(|place| places[place]));
}

impl Call {
    fn apply<const WIDTH: usize>(&self, [a, b]: [[f64; WIDTH]; 2]) -> [f64; WIDTH] {
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

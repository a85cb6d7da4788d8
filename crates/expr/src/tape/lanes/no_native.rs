//! Machines that tapes are not translated for.

use super::Layout;
use super::block::{Block, LANES};
use super::program::LaneTape;

/// Vector registers that code is made for: none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Vectors {}

impl Vectors {
    pub(super) fn available() -> impl DoubleEndedIterator<Item = Vectors> {
        std::iter::empty()
    }

    pub(super) fn index(self) -> usize {
        match self {}
    }

    pub(super) fn lanes(self) -> usize {
        match self {}
    }

    pub(super) fn are_cache_lines(self) -> bool {
        match self {}
    }
}

/// Loops for registers that this machine does not have.
#[derive(Clone, Copy, Debug)]
pub(super) enum EightLanes {}

impl EightLanes {
    pub(super) fn available() -> Option<EightLanes> {
        None
    }

    pub(super) fn dispatch<R>(self, _: impl FnOnce() -> R) -> R {
        match self {}
    }
}

/// A scalar as wide as a register.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wide(#[expect(dead_code, reason = "there is no machine code to read it")] pub(super) [f64; 1]);

/// Which of a tape's instructions.
#[derive(Clone, Copy)]
pub(super) enum Part {
    ByLane,
    Each,
}

/// The code of a tape: there is none.
#[derive(Clone, Debug)]
pub(super) enum Native {}

impl Native {
    pub(super) fn translate(_: &LaneTape, vectors: Vectors, _: Layout) -> Option<Native> {
        match vectors {}
    }

    pub(super) fn block_count(&self) -> usize {
        match *self {}
    }

    pub(super) fn scratch_len(&self) -> usize {
        match *self {}
    }

    pub(super) fn constants(&self) -> &[f64] {
        match *self {}
    }

    pub(super) fn reads_wide(&self) -> bool {
        match *self {}
    }

    pub(super) fn run(
        &self,
        _: (Part, usize),
        _: (&[f64], &[Wide]),
        _: &mut [Block],
        _: &mut [Block],
        _: &mut [[f64; LANES]],
    ) -> bool {
        match *self {}
    }
}

/// Nothing is written past the caches.
pub(super) fn settle() {}

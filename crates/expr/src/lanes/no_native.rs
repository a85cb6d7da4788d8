//! Machines that tapes are not translated for.

use super::block::Block;
use super::program::LaneTape;

/// What fills a vector register.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wide(pub(super) [f64; WIDTH]);

pub(super) const WIDTH: usize = 1;

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
    pub(super) fn translate(_: &LaneTape) -> Option<Native> {
        None
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

    pub(super) fn run(&self, _: Part, _: usize, _: &[Wide], _: &mut [Block], _: &mut [Wide]) -> bool {
        match *self {}
    }
}

pub(super) fn is_available() -> bool {
    false
}

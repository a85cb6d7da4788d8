//! Machines that tapes are not translated for.

use super::block::Block;
use super::program::LaneTape;

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

    pub(super) fn run(&self, _: usize, _: &[f64], _: &mut [Block], _: &mut [f64]) -> bool {
        match *self {}
    }
}

pub(super) fn is_available() -> bool {
    false
}

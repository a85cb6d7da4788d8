//! Memory for the numbers of a field.

use std::ops::{Deref, DerefMut};

/// Bytes of a line of a cache: vectors that begin at one do not lie across two, and machine code can write them past the caches.
const CACHE_LINE: usize = 64;

/// Numbers that begin at a line of the cache.
#[derive(Clone, Debug, Default)]
pub(super) struct Numbers {
    memory: Vec<f64>,
    first: usize,
    length: usize,
}

impl Numbers {
    /// As many numbers, whatever they are, in the memory that is there if that is enough.
    pub(super) fn set_len(&mut self, length: usize) {
        let most = length + CACHE_LINE / size_of::<f64>();
        if self.memory.len() < most {
            // memory that comes with zeros in it is not touched before it is used
            self.memory = vec![0.0; most];
        }
        // where the place cannot be told it may be any
        self.first = self.memory.as_ptr().align_offset(CACHE_LINE).min(most - length);
        self.length = length;
    }
}

impl Deref for Numbers {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.memory[self.first..][..self.length]
    }
}

impl DerefMut for Numbers {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.memory[self.first..][..self.length]
    }
}

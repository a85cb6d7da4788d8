//! A hash for tables of nodes: a few multiplications where the standard one takes tens of nanoseconds, and the same in every
//! run. No result depends on it.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A table whose keys are nodes or their numbers.
pub(crate) type NodeMap<K, V> = HashMap<K, V, BuildHasherDefault<NodeHasher>>;

/// Bits of the golden ratio: odd, and without a pattern.
const MULTIPLIER: u64 = 0x9e37_79b9_7f4a_7c15;

/// Folds each word in by a multiplication to 128 bits, of which both halves count.
#[derive(Default)]
pub(crate) struct NodeHasher(u64);

impl Hasher for NodeHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_u64(u64::from(byte)));
    }

    fn write_u8(&mut self, word: u8) {
        self.write_u64(u64::from(word));
    }

    fn write_u32(&mut self, word: u32) {
        self.write_u64(u64::from(word));
    }

    fn write_u64(&mut self, word: u64) {
        // the sum keeps a zero word from being nothing
        let wide = u128::from((self.0 ^ word).wrapping_add(MULTIPLIER)) * u128::from(MULTIPLIER);
        self.0 = wide as u64 ^ (wide >> 64) as u64;
    }

    fn write_usize(&mut self, word: usize) {
        self.write_u64(word as u64);
    }

    fn write_isize(&mut self, word: isize) {
        self.write_u64(word as u64);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;
    use std::hash::{BuildHasher, BuildHasherDefault};

    use super::NodeHasher;
    use crate::symbolic::graph::{Node, NodeId};
    use crate::symbolic::op::Binary;

    /// Sums of neighbours and small whole numbers, which differ in few bits, do not crowd into few buckets.
    #[test]
    fn nodes_that_look_alike_spread() {
        const COUNT: u32 = 1 << 16;
        let build = BuildHasherDefault::<NodeHasher>::default();
        let sums = (0..COUNT).map(|k| Node::Binary(Binary::Add, NodeId(k), NodeId(k + 1)));
        let numbers = (0..COUNT).map(|k| Node::constant(f64::from(k)));
        for nodes in [sums.collect::<Vec<_>>(), numbers.collect()] {
            let low: HashSet<u64> = nodes.iter().map(|node| build.hash_one(node) % u64::from(COUNT)).collect();
            let high: HashSet<u64> = nodes.iter().map(|node| build.hash_one(node) >> 48).collect();
            // dice would hit 63 % of as many boxes
            for hit in [low, high] {
                assert!(hit.len() > COUNT as usize / 2, "{} buckets", hit.len());
            }
        }
    }
}

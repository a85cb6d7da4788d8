//! Roots that were found before: a grid that is not complete is begun once more as a part of a finer one, in the same middle.

use std::sync::{Mutex, PoisonError};

use crate::equations::solution::Range;
use crate::roots::Roots;

/// All roots of one system that were looked for.
#[derive(Debug, Default)]
pub(crate) struct KnownRoots(Mutex<Vec<Known>>);

#[derive(Debug)]
struct Known {
    ranges: Vec<Range>,
    target: [f64; 2],
    roots: Roots,
}

impl KnownRoots {
    /// Those in these ranges at this target, looked for unless they are known.
    pub(crate) fn find(&self, ranges: &[Range], target: &[f64; 2], find: impl FnOnce() -> Roots) -> Roots {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |known: &&Known| known.ranges == ranges && known.target == *target;
        let before = known().iter().find(is_same).map(|known| known.roots.clone());
        before.unwrap_or_else(|| {
            let roots = find();
            known().push(Known { ranges: ranges.to_vec(), target: *target, roots: roots.clone() });
            roots
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_looked_for_once_in_the_same_ranges_at_the_same_target() {
        let known = KnownRoots::default();
        let wide = [Range { low: 0.0, high: 2.0 }];
        let found = |boxes| Roots { boxes, ..Roots::default() };
        assert_eq!(known.find(&wide, &[1.0, 2.0], || found(3)).boxes, 3);
        assert_eq!(known.find(&wide, &[1.0, 2.0], || found(4)).boxes, 3);
        assert_eq!(known.find(&wide, &[1.0, 2.5], || found(5)).boxes, 5);
        assert_eq!(known.find(&[Range { low: 0.0, high: 1.0 }], &[1.0, 2.0], || found(6)).boxes, 6);
    }
}

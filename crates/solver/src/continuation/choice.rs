//! Which branch is meant, and what tells it from others.

use std::ops;

use crate::continuation::field::Field;
use crate::continuation::reach::{Reach, nearest_turn};
use crate::continuation::verdicts::{Keep, TangentPlanes};
use crate::equations::solution::{Range, distance};
use crate::roots::Roots;

/// Roots that are nearer to each other than this share of the ranges are the same.
const SAME_ROOT: f64 = 1e-6;

/// What is done where several branches qualify.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Several {
    /// No point is solved.
    Refuse,
    /// The one that reaches the most points is taken, of several such the one nearest the middle of the ranges.
    TakeWidest,
}

/// Which branch is meant.
pub(crate) struct Choice<'c> {
    /// All branches in ranges, at given targets.
    pub(crate) roots: &'c (dyn Fn(&[Range], &[f64; 2]) -> Roots + Sync),
    /// What tells branches apart, if anything does.
    pub(crate) keep: Option<Keep<'c>>,
    pub(crate) several: Several,
    /// Whether it is told of branches that have points beside those of a grid.
    pub(crate) tells_others: bool,
    /// Boxes that are looked at, at all points together, before the search is given up.
    pub(crate) most_boxes: u64,
    /// Where a branch is followed beyond its ranges; nowhere if there is none.
    pub(crate) reach: Option<&'c Reach>,
    /// Unknowns that mean the same after a turn.
    pub(crate) periodic: &'c [bool],
    /// Sees where the roots are no points of a surface; all are if there is none.
    pub(crate) planes: Option<TangentPlanes<'c>>,
}

impl Choice<'_> {
    /// Whether a branch with these unknowns in the middle qualifies.
    pub(crate) fn keeps(&self, unknowns: &[f64]) -> bool {
        self.keep.as_ref().is_none_or(|keep| keep.holds(unknowns, self.periodic))
    }

    /// Whether a root is a point of a surface at all.
    pub(crate) fn has_tangent_plane(&self, unknowns: &[f64]) -> bool {
        self.planes.is_none_or(|planes| !planes.is_collapsed(unknowns))
    }

    /// The verdicts on some points of a field that was settled in these ranges.
    pub(crate) fn judge(&self, field: &mut Field, points: ops::Range<usize>, ranges: &[Range]) {
        if let Some(planes) = &self.planes {
            planes.judge(field, points.clone());
        }
        if let Some(keep) = &self.keep {
            keep.judge(field, points, ranges, self.periodic);
        }
    }

    /// Those of some ranges in which a branch can qualify.
    pub(crate) fn kept(&self, ranges: &[Range]) -> Vec<Range> {
        let Some(keep) = &self.keep else { return ranges.to_vec() };
        kept(ranges, keep.ranges, self.periodic)
    }
}

/// What is kept of some ranges.
pub(crate) fn kept(ranges: &[Range], kept: &[Range], periodic: &[bool]) -> Vec<Range> {
    let of = |((range, kept), is_periodic): ((&Range, &Range), &bool)| {
        if *is_periodic { range.common_turns(*kept) } else { range.common(*kept) }
    };
    ranges.iter().zip(kept).zip(periodic).map(of).collect()
}

/// Whether two roots at the same targets are one, but for turns of what is periodic.
pub(crate) fn is_same_root(root: &[f64], other: &[f64], ranges: &[Range], periodic: &[bool]) -> bool {
    distance(&nearest_turn(root, other, periodic), other, ranges) <= SAME_ROOT
}

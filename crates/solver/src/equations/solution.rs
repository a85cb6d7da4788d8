//! Ranges, and what becomes of a point that is looked for in them.

use std::f64::consts::{PI, TAU};

/// How far outside its range an unknown may wander on its way, as a share of the range.
const MARGIN: f64 = 0.25;
/// How far beyond its range a branch is followed, as a share of the range.
const BEYOND: f64 = 2.0;
/// An unknown is inside its range if it is outside by less than this share of it: rounding of the ends themselves, and of
/// targets that lie on them.
pub(crate) const ROUNDING: f64 = 1e-10;

/// Distances below this share of the ranges are never a jump to another branch.
pub(crate) const NEAR: f64 = 1e-3;

/// Where an unknown is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
    pub(crate) const EVERYTHING: Range = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };

    #[inline]
    pub(crate) fn width(self) -> f64 {
        self.high - self.low
    }

    pub(crate) fn middle(self) -> f64 {
        0.5 * (self.low + self.high)
    }

    /// The value at a share of the way from its lower end to its upper one.
    pub(crate) fn at(self, share: f64) -> f64 {
        self.low + share * self.width()
    }

    /// With twice its width beyond both ends, and at least as much about its middle.
    pub fn beyond(self, at_least: f64) -> Range {
        let (wider, middle) = (self.wider_by(BEYOND), self.middle());
        let half = 0.5 * at_least;
        Range { low: wider.low.min(middle - half), high: wider.high.max(middle + half) }
    }

    /// A full turn about its middle; all of it, where that is more.
    pub(crate) fn turn(self) -> Range {
        let middle = self.middle();
        Range { low: self.low.min(middle - PI), high: self.high.max(middle + PI) }
    }

    /// What both have in common; where that is nothing, the end of this one that is nearest.
    pub(crate) fn common(self, other: Range) -> Range {
        Range { low: other.low.clamp(self.low, self.high), high: other.high.clamp(self.low, self.high) }
    }

    /// What this has in common with all turns of another one, of a value that a turn does not change, and what lies between. Where that is
    /// nothing, as in [`Range::common`].
    pub(crate) fn common_turns(self, other: Range) -> Range {
        let turned = [0.0, 1.0, -1.0, 2.0, -2.0].map(|turns| turns * TAU);
        let turned = turned.map(|turn| Range { low: other.low + turn, high: other.high + turn });
        let met = turned.into_iter().filter(|of| of.low < self.high && of.high > self.low);
        let both = |a: Range, b: Range| Range { low: a.low.min(b.low), high: a.high.max(b.high) };
        met.map(|of| self.common(of)).reduce(both).unwrap_or_else(|| self.common(other))
    }

    /// Where something of a size is looked for in it: as far as that from zero; where all of it lies farther out, from its near end on, no
    /// farther than twice that end is from zero, or twice the size.
    pub(crate) fn near_zero(self, size: f64) -> Range {
        if self.low > size {
            Range { high: self.high.min(self.low + 2.0 * size.max(self.low)), ..self }
        } else if self.high < -size {
            Range { low: self.low.max(self.high - 2.0 * size.max(-self.high)), ..self }
        } else {
            self.common(Range { low: -size, high: size })
        }
    }

    /// With a share of its width beyond both ends.
    pub(crate) fn wider_by(self, share: f64) -> Range {
        let margin = share * self.width();
        Range { low: self.low - margin, high: self.high + margin }
    }

    /// By how much a value is outside; zero inside.
    pub(crate) fn excess(self, value: f64) -> f64 {
        (self.low - value).max(value - self.high).max(0.0)
    }

    #[inline]
    pub(crate) fn widened(self, value: f64) -> f64 {
        let wider = self.wide();
        value.clamp(wider.low, wider.high)
    }

    /// Where an unknown may wander on its way.
    #[inline]
    pub(crate) fn wide(self) -> Range {
        self.wider_by(MARGIN)
    }
}

/// What became of a point that was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// All residuals are within their tolerance ([`TOLERANCE`](crate::TOLERANCE)) and all unknowns in their ranges.
    Solved,
    /// There is a root in the ranges, but it is no point of the finished work: its unknowns, position and normal are those of the
    /// surface that the tool generates.
    CutAway(CutBy),
    /// There is a root in the ranges, but whether another surface cuts it away is not clear: see [`Trim`](crate::Trim).
    Undecided,
    /// There is a root, but one of the unknowns lies outside its range.
    Outside {
        /// Index of the unknown that is farthest outside, relative to its range.
        unknown: usize,
        /// By how much, in its own unit.
        by: f64,
    },
    /// There is a root in the ranges, but not where the branch is to be kept: see
    /// [`SurfaceProblem::keeping`](crate::SurfaceProblem::keeping).
    NotKept {
        /// Index of the first condition that does not hold.
        condition: usize,
    },
    /// The Jacobian has no inverse where the iteration ended, or the surface no normal or no tangent plane there.
    Singular,
    /// The iteration ended without a root.
    NotConverged {
        /// Evaluations of the system that the last attempt took; zero where nothing led there.
        iterations: u32,
    },
    /// The ranges hold several branches, and nothing says which one is meant.
    Ambiguous,
}

/// What takes away a point that a tool generates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutBy {
    /// The tool itself, before or after it generates the point: undercut, see
    /// [`Surface::clearance_minors`](flank_expr::geometry::Surface::clearance_minors).
    ItsTool,
    /// The tool itself in another of its positions, by the piece of its surface that has this number for
    /// [`SecondaryCutting`](crate::SecondaryCutting).
    ItsToolElsewhere(usize),
    /// Another surface, by the number that it has for [`Trim`](crate::Trim).
    Other(usize),
    /// Nothing that is generated: the blank ends before, at this segment of its [`Outline`](crate::Outline).
    Blank(usize),
}

impl Outcome {
    /// One word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Solved => "solved",
            Outcome::CutAway(CutBy::Other(_) | CutBy::Blank(_)) => "trimmed",
            Outcome::CutAway(_) => "undercut",
            Outcome::Undecided => "undecided",
            Outcome::Outside { .. } | Outcome::NotKept { .. } => "out_of_range",
            Outcome::Singular => "singular",
            Outcome::NotConverged { .. } => "not_converged",
            Outcome::Ambiguous => "ambiguous",
        }
    }

    /// There is a root, whether or not it is one that is looked for.
    pub(crate) fn is_root(self) -> bool {
        !matches!(self, Outcome::Singular | Outcome::NotConverged { .. })
    }

    /// The verdict once position and normal are known: where a surface has no normal, a root of its equations is no point
    /// that is solved.
    pub(crate) fn of_placed(self, placed: &[f64; 6]) -> Outcome {
        let is_point = placed.iter().all(|x| x.is_finite());
        if self == Outcome::Solved && !is_point { Outcome::Singular } else { self }
    }

    /// Which of two outcomes says more.
    fn rank(self) -> u8 {
        match self {
            Outcome::Solved => 4,
            Outcome::CutAway(_) | Outcome::Undecided => 3,
            Outcome::Outside { .. } | Outcome::NotKept { .. } => 2,
            Outcome::Singular => 1,
            Outcome::NotConverged { .. } | Outcome::Ambiguous => 0,
        }
    }
}

/// The end of an iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The verdict.
    pub outcome: Outcome,
    /// The unknowns where the iteration ended.
    pub unknowns: Vec<f64>,
    /// The largest residual there.
    pub residual: f64,
    /// Evaluations of the system; zero for points of a grid, whose [`GridReport`](crate::GridReport) has their sum.
    pub iterations: u32,
}

impl Solution {
    /// A point that no iteration came near.
    pub(crate) fn never_reached(ranges: &[Range]) -> Solution {
        let middle = ranges.iter().map(|range| range.middle()).collect();
        let outcome = Outcome::NotConverged { iterations: 0 };
        Solution { outcome, unknowns: middle, residual: f64::NAN, iterations: 0 }
    }

    pub(crate) fn is_solved(&self) -> bool {
        self.outcome == Outcome::Solved
    }

    /// A root, whether or not it is one that is looked for.
    pub(crate) fn is_root(&self) -> bool {
        self.outcome.is_root()
    }

    /// The one of two that says more: solved before cut away before outside before singular before not converged, then the smaller
    /// residual.
    pub(crate) fn better(self, other: Solution) -> Solution {
        let (mine, its) = (self.outcome.rank(), other.outcome.rank());
        let no_worse = self.residual <= other.residual || other.residual.is_nan();
        if mine > its || (mine == its && no_worse) { self } else { other }
    }
}

/// The largest difference of two sets of unknowns, as a share of their ranges.
pub(crate) fn distance(a: &[f64], b: &[f64], ranges: &[Range]) -> f64 {
    a.iter().zip(b).zip(ranges).map(|((a, b), range)| (a - b).abs() / range.width()).fold(0.0, f64::max)
}

/// The value that is farthest outside its range, as a share of it, with by how much; nothing if all are inside.
pub(crate) fn farthest_outside(values: &[f64], ranges: &[Range]) -> Option<(usize, f64)> {
    let share = |(range, value): (&Range, &f64)| range.excess(*value) / range.width();
    let (worst, most) = ranges
        .iter()
        .zip(values)
        .map(share)
        .enumerate()
        .fold((0, 0.0), |worst, (k, share)| if share > worst.1 { (k, share) } else { worst });
    (most > 0.0).then(|| (worst, ranges[worst].excess(values[worst])))
}

/// What the end of an iteration means.
pub(crate) fn verdict(p: &[f64], ranges: &[Range], is_root: bool, singular: bool) -> Outcome {
    if !is_root {
        return if singular { Outcome::Singular } else { Outcome::NotConverged { iterations: 0 } };
    }
    if let Some((unknown, by)) = farthest_outside(p, ranges)
        && by > ROUNDING * ranges[unknown].width()
    {
        return Outcome::Outside { unknown, by };
    }
    if singular { Outcome::Singular } else { Outcome::Solved }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_looked_for_lies_in_its_range() {
        let of = |low: f64, high: f64| {
            let Range { low, high } = Range { low, high }.near_zero(1e3);
            [low, high]
        };
        assert_eq!(of(-10.0, 5e3), [-10.0, 1e3]);
        assert_eq!(of(f64::NEG_INFINITY, f64::INFINITY), [-1e3, 1e3]);
        assert_eq!(of(2e3, 5e3), [2e3, 5e3]);
        assert_eq!(of(-5e3, -2e3), [-5e3, -2e3]);
        assert_eq!(of(2e3, f64::INFINITY), [2e3, 6e3]);
        assert_eq!(of(f64::NEG_INFINITY, -2e3), [-6e3, -2e3]);
    }

    #[test]
    fn the_farthest_is_so_by_its_share() {
        let range = |low, high| Range { low, high };
        let ranges = [range(0.0, 1.0), range(0.0, 100.0)];
        assert_eq!(farthest_outside(&[-0.5, 110.0], &ranges), Some((0, 0.5)));
        assert_eq!(farthest_outside(&[1.0, 110.0], &ranges), Some((1, 10.0)));
        assert_eq!(farthest_outside(&[1.0, 0.0], &ranges), None);
        assert_eq!(verdict(&[1.0 + 0.5 * ROUNDING, 50.0], &ranges, true, false), Outcome::Solved);
        assert_eq!(verdict(&[2.0, 50.0], &ranges, true, false), Outcome::Outside { unknown: 0, by: 1.0 });
    }
}

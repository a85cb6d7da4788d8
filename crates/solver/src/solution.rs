//! Ranges, and what becomes of a point that is looked for in them.

/// How far outside its range an unknown may wander on its way, as a share of the range.
const MARGIN: f64 = 0.25;
/// An unknown is inside its range if it is outside by less than this share of it: rounding of the ends themselves, and of
/// targets that lie on them.
pub(crate) const ROUNDING: f64 = 1e-10;

/// Where an unknown is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
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

    /// What both have in common; where that is nothing, the end of this one that is nearest.
    pub(crate) fn common(self, other: Range) -> Range {
        Range { low: other.low.clamp(self.low, self.high), high: other.high.clamp(self.low, self.high) }
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
    /// There is a root in the ranges, but it is no point of the finished work.
    CutAway(CutBy),
    /// There is a root in the ranges, but whether another surface cuts it away is not clear: see [`trim`](crate::trim).
    Undecided,
    /// There is a root, but one of the unknowns lies outside its range.
    Outside {
        /// Index of the unknown that is farthest outside, relative to its range.
        unknown: usize,
        /// By how much, in its own unit.
        by: f64,
    },
    /// The Jacobian has no inverse where the iteration ended, or the surface no normal there.
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
    /// Another surface, by the number that it has for [`trim`](crate::trim).
    Other(usize),
}

impl Outcome {
    /// One word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Solved => "solved",
            Outcome::CutAway(_) => "cut away",
            Outcome::Undecided => "undecided",
            Outcome::Outside { .. } => "outside",
            Outcome::Singular => "singular",
            Outcome::NotConverged { .. } => "not converged",
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
            Outcome::Outside { .. } => 2,
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
    /// Evaluations of the system; zero for points of a grid, whose [`Effort`](crate::Effort) has their sum.
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

/// What the end of an iteration means.
pub(crate) fn verdict(p: &[f64], ranges: &[Range], is_root: bool, singular: bool) -> Outcome {
    if !is_root {
        return if singular { Outcome::Singular } else { Outcome::NotConverged { iterations: 0 } };
    }
    let share = |(range, value): (&Range, &f64)| range.excess(*value) / range.width();
    let farthest = ranges
        .iter()
        .zip(p)
        .map(share)
        .enumerate()
        .fold((0, 0.0), |worst, (k, share)| if share > worst.1 { (k, share) } else { worst });
    if farthest.1 > ROUNDING {
        let unknown = farthest.0;
        return Outcome::Outside { unknown, by: ranges[unknown].excess(p[unknown]) };
    }
    if singular { Outcome::Singular } else { Outcome::Solved }
}

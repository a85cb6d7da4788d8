//! Points, counted once each of them has been looked at.

use std::collections::BTreeMap;
use std::ops::Range;

use flank_solver::{CutBy, Outcome, SurfacePoint};

/// The smallest and the largest of some numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ends(pub(crate) Option<(f64, f64)>);

impl Ends {
    fn add(&mut self, x: f64) {
        self.0 =
            Some(self.0.map_or((x, x), |(low, high)| (if x < low { x } else { low }, if x > high { x } else { high })));
    }
}

/// Where some points of a grid are.
#[derive(Clone, Debug)]
pub(crate) struct Places {
    pub(crate) count: usize,
    /// How many are in each row, and in each column.
    lines: [Vec<usize>; 2],
}

impl Places {
    /// None yet, in so many rows and columns.
    pub(crate) fn new(counts: [usize; 2]) -> Places {
        Places { count: 0, lines: counts.map(|count| vec![0; count]) }
    }

    /// One more, by its number, row by row.
    pub(crate) fn add(&mut self, at: usize) {
        let columns = self.lines[1].len();
        self.count += 1;
        self.lines[0][at / columns] += 1;
        self.lines[1][at % columns] += 1;
    }

    /// How many are in some rows (0), or in some columns (1).
    pub(crate) fn on_lines(&self, direction: usize, lines: Range<usize>) -> usize {
        self.lines[direction][lines].iter().sum()
    }
}

/// Points that are outside the range of an unknown.
#[derive(Clone, Debug)]
pub(crate) struct Outside {
    pub(crate) places: Places,
    /// By how much at most.
    pub(crate) most: f64,
}

/// The points of a grid, counted.
#[derive(Clone, Debug)]
pub(crate) struct Summary {
    pub(crate) asked: usize,
    /// By the words of tables.
    pub(crate) outcomes: BTreeMap<&'static str, usize>,
    /// Of the solved points, as what follows: the distance from the z axis, z, and the unknowns.
    pub(crate) worst_residual: Option<f64>,
    pub(crate) rho: Ends,
    pub(crate) z: Ends,
    pub(crate) unknowns: Vec<Ends>,
    /// For each unknown.
    pub(crate) outside: Vec<Outside>,
    /// For each condition that the branch is kept by.
    pub(crate) not_kept: BTreeMap<usize, usize>,
    pub(crate) cut_by_tool: usize,
    /// By the surface whose tool cuts it away in another position.
    pub(crate) cut_elsewhere: BTreeMap<usize, usize>,
    /// By the number of the trim.
    pub(crate) trimmed: BTreeMap<usize, usize>,
    /// Beyond a segment of the outline of their solid.
    pub(crate) beyond_blank: BTreeMap<usize, usize>,
    /// Of the points that did not converge; NaN if none came near.
    pub(crate) least_residual: f64,
}

impl Summary {
    /// Of no points yet, with so many unknowns, in so many rows and columns.
    pub(crate) fn new(unknowns: usize, counts: [usize; 2]) -> Summary {
        Summary {
            asked: 0,
            outcomes: BTreeMap::new(),
            worst_residual: None,
            rho: Ends::default(),
            z: Ends::default(),
            unknowns: vec![Ends::default(); unknowns],
            outside: vec![Outside { places: Places::new(counts), most: 0.0 }; unknowns],
            not_kept: BTreeMap::new(),
            cut_by_tool: 0,
            cut_elsewhere: BTreeMap::new(),
            trimmed: BTreeMap::new(),
            beyond_blank: BTreeMap::new(),
            least_residual: f64::NAN,
        }
    }

    pub(crate) fn of_points(unknowns: usize, counts: [usize; 2], points: &[SurfacePoint]) -> Summary {
        let mut summary = Summary::new(unknowns, counts);
        points.iter().for_each(|point| summary.add(point));
        summary
    }

    /// The next point, row by row.
    pub(crate) fn add(&mut self, point: &SurfacePoint) {
        *self.outcomes.entry(point.outcome.word()).or_default() += 1;
        match point.outcome {
            Outcome::Solved => {
                self.worst_residual =
                    Some(self.worst_residual.map_or(point.residual, |worst| worst.max(point.residual)));
                self.rho.add(point.position[0].hypot(point.position[1]));
                self.z.add(point.position[2]);
                self.unknowns.iter_mut().zip(&point.unknowns).for_each(|(ends, x)| ends.add(*x));
            }
            Outcome::Outside { unknown, by } => {
                let outside = &mut self.outside[unknown];
                outside.most = outside.most.max(by);
                outside.places.add(self.asked);
            }
            Outcome::NotKept { condition } => *self.not_kept.entry(condition).or_default() += 1,
            Outcome::CutAway(CutBy::ItsTool) => self.cut_by_tool += 1,
            Outcome::CutAway(CutBy::ItsToolElsewhere(by)) => *self.cut_elsewhere.entry(by).or_default() += 1,
            Outcome::CutAway(CutBy::Other(number)) => *self.trimmed.entry(number).or_default() += 1,
            Outcome::CutAway(CutBy::Blank(segment)) => *self.beyond_blank.entry(segment).or_default() += 1,
            Outcome::NotConverged { .. } => self.least_residual = self.least_residual.min(point.residual),
            Outcome::Undecided | Outcome::Singular | Outcome::Ambiguous => {}
        }
        self.asked += 1;
    }

    /// How many points have an outcome, whatever it says further.
    pub(crate) fn count(&self, outcome: Outcome) -> usize {
        self.outcomes.get(outcome.word()).copied().unwrap_or(0)
    }

    /// Whether the surface, as far as it was followed, did not come to a point.
    pub(crate) fn has_unreached(&self) -> bool {
        let is_outside = self.outside.iter().any(|outside| outside.places.count > 0);
        is_outside || self.count(Outcome::NotConverged { iterations: 0 }) > 0
    }

    /// How many points their own tool cuts away, in whatever position.
    pub(crate) fn cut_by_its_tool(&self) -> usize {
        self.cut_by_tool + self.cut_elsewhere.values().sum::<usize>()
    }

    pub(crate) fn solved(&self) -> usize {
        self.count(Outcome::Solved)
    }
}

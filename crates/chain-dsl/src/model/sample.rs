//! Points that are asked for of a surface.

use std::ops::{Add, Mul, Sub};

use flank_expr::{Expr, Graph};

use crate::diagnostics::source::Span;
use crate::values::dimension::Dimension;

/// A grid of points that is asked for: two coordinates and their values.
#[derive(Clone, Debug)]
pub struct Sample<'g> {
    /// The two functions of the unknowns that are given values.
    pub coordinates: [Coordinate<'g>; 2],
    /// What a row and a column of the grid are.
    pub labels: [String; 2],
    /// Number of rows and of columns.
    pub counts: [usize; 2],
    /// Where its points are.
    pub grid: SampleGrid,
    /// The same where its points end, as the spec has it: in the parameters of the job.
    pub ends: SampleEnds<'g>,
    /// Functions of the unknowns, and the ends between which they lie on the branch that is meant.
    pub keep: Vec<(Coordinate<'g>, (f64, f64))>,
    /// What every point must fulfil.
    pub limits: Vec<PointRequirement<'g>>,
}

impl<'g> Sample<'g> {
    /// The two functions that are given values, without their names.
    pub fn functions(&self) -> [Expr<'g>; 2] {
        self.coordinates.each_ref().map(|coordinate| coordinate.value)
    }
}

/// A function of the unknowns that must lie between two ends at every point of a sample.
#[derive(Clone, Debug)]
pub struct PointRequirement<'g> {
    /// The function.
    pub of: Coordinate<'g>,
    /// Lower and upper end.
    pub ends: (f64, f64),
    /// The message where it does not, in the words of the spec.
    pub message: String,
    /// Where its name stands.
    pub place: Span,
}

/// Values of two coordinates in rows and columns, told one by one: there may be millions.
#[derive(Clone, Debug)]
pub enum SampleGrid {
    /// Those of the first coordinate in the rows, and of the second in the columns.
    Values([Vec<f64>; 2]),
    /// Shares of the way from root to tip, and from toe to heel.
    Shares {
        /// Of the rows, and of the columns.
        shares: [Vec<f64>; 2],
        /// Both coordinates at toe root, heel root, toe tip, heel tip.
        corners: [[f64; 2]; 4],
    },
    /// Points that are listed one by one, in one row.
    Points(Vec<[f64; 2]>),
}

/// Where a [`SampleGrid`] ends, in the parameters of the job.
#[derive(Clone, Debug)]
pub struct SampleEnds<'g> {
    /// The first and the last value, or share, of the rows, and of the columns.
    pub values: [[Expr<'g>; 2]; 2],
    /// Of shares the corners, as [`SampleGrid::Shares`] has them.
    pub corners: Option<[[Expr<'g>; 2]; 4]>,
}

impl<'g> SampleEnds<'g> {
    /// Both coordinates at the first row's first and last point, and at the last row's.
    pub fn corners(&self) -> [[Expr<'g>; 2]; 4] {
        let [rows, columns] = self.values;
        let places = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(row, column)| [rows[row], columns[column]]);
        let Some(corners) = self.corners else { return places };
        places.map(|shares| between(corners, shares))
    }
}

/// The point at shares of the way from root to tip, and from toe to heel, between toe root, heel root, toe tip, heel tip.
pub(super) fn between<T>([toe_root, heel_root, toe_tip, heel_tip]: [[T; 2]; 4], [v, u]: [T; 2]) -> [T; 2]
where
    T: Copy + Add<Output = T> + Mul<Output = T>,
    f64: Sub<T, Output = T>,
{
    [0, 1].map(|k| {
        (1.0 - v) * ((1.0 - u) * toe_root[k] + u * heel_root[k]) + v * ((1.0 - u) * toe_tip[k] + u * heel_tip[k])
    })
}

impl SampleGrid {
    /// The values of the coordinates in a row and a column.
    ///
    /// # Panics
    /// If there is no such row or column.
    pub fn at(&self, row: usize, column: usize) -> [f64; 2] {
        match self {
            SampleGrid::Values([rows, columns]) => [rows[row], columns[column]],
            SampleGrid::Shares { shares: [rows, columns], corners } => between(*corners, [rows[row], columns[column]]),
            SampleGrid::Points(points) => points[column],
        }
    }

    /// Half-way between the coordinates of the first and of the last point of so many rows and columns.
    ///
    /// # Panics
    /// If there are not as many.
    pub fn middle(&self, [rows, columns]: [usize; 2]) -> [f64; 2] {
        let (first, last) = (self.at(0, 0), self.at(rows - 1, columns - 1));
        std::array::from_fn(|k| 0.5 * (first[k] + last[k]))
    }

    /// With these rows and these columns only.
    ///
    /// # Panics
    /// If one of them is not there.
    pub fn picked(&self, lines: &[Vec<usize>; 2]) -> SampleGrid {
        let pick = |values: &[Vec<f64>; 2]| [0, 1].map(|k| lines[k].iter().map(|at| values[k][*at]).collect());
        match self {
            SampleGrid::Values(values) => SampleGrid::Values(pick(values)),
            SampleGrid::Shares { shares, corners } => SampleGrid::Shares { shares: pick(shares), corners: *corners },
            SampleGrid::Points(points) => SampleGrid::Points(lines[1].iter().map(|at| points[*at]).collect()),
        }
    }

    /// With one more row between any two and one more column between any two, half-way.
    pub fn halved(&self) -> SampleGrid {
        let halved = |values: &[f64]| {
            (1..2 * values.len()).map(|at| 0.5 * (values[(at - 1) / 2] + values[at / 2])).collect::<Vec<f64>>()
        };
        match self {
            SampleGrid::Values(values) => SampleGrid::Values(values.each_ref().map(|values| halved(values))),
            SampleGrid::Shares { shares, corners } => {
                SampleGrid::Shares { shares: shares.each_ref().map(|shares| halved(shares)), corners: *corners }
            }
            SampleGrid::Points(points) => {
                let half = |at: usize| [0, 1].map(|k| 0.5 * (points[(at - 1) / 2][k] + points[at / 2][k]));
                SampleGrid::Points((1..2 * points.len()).map(half).collect())
            }
        }
    }
}

impl<'g> Sample<'g> {
    /// A value of the rows (0) or columns (1) that lies beyond two ends.
    pub(crate) fn beyond(&self, axis: usize, (low, high): (f64, f64)) -> Option<f64> {
        let SampleGrid::Values(values) = &self.grid else { return None };
        let slack = ON_END * (high - low);
        values[axis].iter().copied().find(|value| *value < low - slack || *value > high + slack)
    }

    /// The rows (0) or columns (1) whose values lie between two ends, with these; `None` if there are none.
    pub(crate) fn within(mut self, graph: &'g Graph, axis: usize, (low, high): (f64, f64)) -> Option<Sample<'g>> {
        let SampleGrid::Values(values) = &mut self.grid else { return None };
        let slack = ON_END * (high - low);
        values[axis].retain(|value| *value >= low - slack && *value <= high + slack);
        values[axis].iter_mut().for_each(|value| *value = value.clamp(low, high));
        let ends = [*values[axis].first()?, *values[axis].last()?];
        self.counts[axis] = values[axis].len();
        self.ends.values[axis] = ends.map(|end| graph.constant(end));
        Some(self)
    }
}

/// A value this near to an end, as a share of the way between both, is the end: rounding.
const ON_END: f64 = 1e-12;

impl Sample<'_> {
    /// Values of the coordinates at all points, row by row.
    pub fn targets(&self) -> Vec<[f64; 2]> {
        self.each_target().collect()
    }

    /// The same one by one.
    pub fn each_target(&self) -> impl Iterator<Item = [f64; 2]> {
        let [rows, columns] = self.counts;
        (0..rows).flat_map(move |row| (0..columns).map(move |column| self.grid.at(row, column)))
    }
}

/// A function of the unknowns that a sample gives values to.
#[derive(Clone, Debug)]
pub struct Coordinate<'g> {
    /// `z`, `rho`, or the name of an unknown.
    pub name: String,
    /// Its expression.
    pub value: Expr<'g>,
    /// Its dimension.
    pub dimension: Dimension,
}

//! The mean point of a grid: halfway between the first and the last value of its rows and of its columns, whether it is one of its points or not.

use flank_chain_dsl::{Sample, SampleGrid};

/// A value this near to halfway, as a share of the way from the first to the last, is there: rounding.
const ROUNDING: f64 = 1e-9;

/// Where the middle of a sample lies in a grid that has all points of the sample, and more where the mean point is none of them.
pub(crate) struct Centre {
    /// Where the rows and the columns of the sample lie: their values, or their shares.
    pub(crate) lines: [Vec<f64>; 2],
    /// The rows and the columns of the sample, by their numbers in the grid.
    own: [Vec<usize>; 2],
    /// Rows and columns of the grid.
    counts: [usize; 2],
    /// Row and column of the middle in the grid.
    middle: [usize; 2],
    /// Whether that is the mean point.
    is_mean: bool,
}

impl Centre {
    /// A sample with the mean point among its points: where no row or no column of its own goes through it, with one more. A list of points has
    /// none; the point half-way along it stands for it.
    pub(crate) fn of_sample<'g>(sample: &Sample<'g>) -> (Sample<'g>, Centre) {
        let (lines, grid): (_, &dyn Fn([Vec<f64>; 2]) -> SampleGrid) = match &sample.grid {
            SampleGrid::Values(lines) => (lines, &SampleGrid::Values),
            SampleGrid::Shares { shares, corners } => {
                (shares, &|shares| SampleGrid::Shares { shares, corners: *corners })
            }
            SampleGrid::Points(points) => return (sample.clone(), Centre::of_nodes([1, points.len()])),
        };
        let [(rows, row), (columns, column)] = lines.each_ref().map(|values| with_halfway(values));
        let own = |all: &[f64], at: usize, own: &[f64]| -> Vec<usize> {
            (0..all.len()).filter(|k| all.len() == own.len() || *k != at).collect()
        };
        let centre = Centre {
            lines: lines.clone(),
            own: [own(&rows, row, &lines[0]), own(&columns, column, &lines[1])],
            counts: [rows.len(), columns.len()],
            middle: [row, column],
            is_mean: true,
        };
        (Sample { counts: centre.counts, grid: grid([rows, columns]), ..sample.clone() }, centre)
    }

    /// Of a grid whose rows and columns lie at even distances. Where their number is even, a point beside the mean point stands for it.
    pub(crate) fn of_nodes(counts: [usize; 2]) -> Centre {
        Centre {
            lines: counts.map(|count| (0..count).map(|k| k as f64).collect()),
            own: counts.map(|count| (0..count).collect()),
            counts,
            middle: counts.map(|count| count / 2),
            is_mean: counts.iter().all(|count| count % 2 == 1),
        }
    }

    /// Number of the middle among the points of the grid.
    pub(crate) fn middle(&self) -> usize {
        self.number(self.middle)
    }

    /// Row and column of the point that stands for the mean point.
    pub(crate) fn stand_in(&self) -> Option<[usize; 2]> {
        (!self.is_mean).then_some(self.middle)
    }

    /// Numbers of the first and the last point of the column through the middle, and of the row.
    pub(crate) fn ends(&self) -> [[usize; 2]; 2] {
        let ([rows, columns], [row, column]) = (self.counts, self.middle);
        [[[0, column], [rows - 1, column]], [[row, 0], [row, columns - 1]]].map(|ends| ends.map(|at| self.number(at)))
    }

    /// Of what belongs to the points of the grid, that of the sample's own.
    pub(crate) fn own<T: Clone>(&self, all: &[T]) -> Vec<T> {
        let [rows, columns] = &self.own;
        let numbers = rows.iter().flat_map(|row| columns.iter().map(|column| self.number([*row, *column])));
        numbers.map(|at| all[at].clone()).collect()
    }

    fn number(&self, [row, column]: [usize; 2]) -> usize {
        row * self.counts[1] + column
    }
}

/// Values in order, with the one half-way between the first and the last among them, and where it is.
fn with_halfway(values: &[f64]) -> (Vec<f64>, usize) {
    let (first, last) = (values[0], values[values.len() - 1]);
    let (halfway, way) = (0.5 * (first + last), last - first);
    let near = |value: &f64| (value - halfway).abs() <= ROUNDING * way.abs();
    if let Some(at) = values.iter().position(near) {
        return (values.to_vec(), at);
    }
    let at = values.partition_point(|value| (value - halfway) * way < 0.0);
    (values[..at].iter().copied().chain([halfway]).chain(values[at..].iter().copied()).collect(), at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_halfway_between_the_ends() {
        assert_eq!(with_halfway(&[3.0]), (vec![3.0], 0));
        assert_eq!(with_halfway(&[1.0, 2.0, 3.0]), (vec![1.0, 2.0, 3.0], 1));
        assert_eq!(with_halfway(&[2.0, 1.0]), (vec![2.0, 1.5, 1.0], 1));
        assert_eq!(with_halfway(&[-15.0, -14.0, -13.0, 20.0]), (vec![-15.0, -14.0, -13.0, 2.5, 20.0], 3));
        // a tenth is none in binary
        assert_eq!(with_halfway(&[0.1, 0.2, 0.30000000000000004]).1, 1);
    }
}

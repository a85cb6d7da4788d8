//! The faces along a tooth as bands of nodes, and how neighbouring lines of points are joined by triangles.

use nalgebra::Vector3;

use crate::solid::mesh::BodyPart;
use crate::solid::section::{Fineness, Layout};

/// Distances that differ by less, as a share of their squares, are the same: their rounding decides nothing.
const SAME: f64 = 1e-12;

/// What nodes of a section lie on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BandFace {
    /// A surface of a space.
    Chart,
    /// The tip of the blank.
    Tip,
    /// The rest of the outline.
    Below,
}

/// Nodes of a section in their order, the material on their left.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    pub(crate) face: BandFace,
    pub(crate) nodes: Vec<usize>,
}

impl Layout {
    /// The bands of what a part has of a tooth: of a space the far half of the tooth before it, and the near half of the one behind it.
    pub(crate) fn bands(&self, fineness: &Fineness, (part, tooth): (BodyPart, usize)) -> Vec<Band> {
        let (before, behind) = (part != BodyPart::Space || tooth == 1, part != BodyPart::Space || tooth == 0);
        let middle = self.tooth / 2;
        let columns = (if before { 0 } else { middle })..=(if behind { self.tooth } else { middle });
        let mut bands = Vec::new();
        if before {
            bands.extend(self.on_charts(fineness, self.middle..=self.last, |line| self.on_near_side(line)));
        }
        bands.push(Band { face: BandFace::Tip, nodes: columns.map(|k| self.in_tooth(0, k)).collect() });
        if behind {
            bands.extend(self.on_charts(fineness, 0..=self.middle, |line| self.on_far_side(line)));
        }
        let middle = self.in_middle();
        let columns = (if before { 0 } else { middle })..=(if behind { self.width() } else { middle });
        let below = columns.rev().map(|k| self.in_rim(self.rim, k)).collect();
        bands.push(Band { face: BandFace::Below, nodes: below });
        bands
    }

    /// Bands of the charts that points of a line across a space lie on.
    fn on_charts(
        &self,
        fineness: &Fineness,
        line: std::ops::RangeInclusive<usize>,
        node: impl Fn(usize) -> usize,
    ) -> Vec<Band> {
        let mut start = 0;
        let mut bands = Vec::new();
        for count in &fineness.charts {
            let (low, high) = (start.max(*line.start()), (start + count).min(*line.end()));
            start += count;
            if low < high {
                bands.push(Band { face: BandFace::Chart, nodes: (low..=high).map(&node).collect() });
            }
        }
        bands
    }

    /// The node of a point of the line across the space before the tooth.
    fn on_near_side(&self, line: usize) -> usize {
        match self.last - line {
            row if row <= self.depth => self.in_tooth(row, 0),
            _ => self.in_rim(0, line - self.middle),
        }
    }

    /// The node of a point of the line across the space behind the tooth.
    fn on_far_side(&self, line: usize) -> usize {
        if line <= self.depth {
            return self.in_tooth(line, self.tooth);
        }
        self.in_rim(0, self.width() + line - self.middle)
    }

    /// The column of the lower block that goes on below the middle of the tooth.
    pub(crate) fn in_middle(&self) -> usize {
        self.last - self.middle - self.depth + self.tooth / 2
    }
}

/// Triangles between two lines of points from their first points to their last ones, each as three corners: which line, and which point of
/// it. Wherever there is a choice, they have the shorter sides across: where lines wind about an axis these do not wind with them.
pub(crate) fn stitched(lines: [&[Vector3<f64>]; 2]) -> Vec<[[usize; 2]; 3]> {
    let [low, high] = lines;
    let (mut i, mut k) = (0, 0);
    let mut triangles = Vec::with_capacity(low.len() + high.len());
    while i + 1 < low.len() || k + 1 < high.len() {
        let on_low = low.get(i + 1).map(|next| (next - high[k]).norm_squared());
        let on_high = high.get(k + 1).map(|next| (next - low[i]).norm_squared());
        let is_low = on_low.is_some_and(|a| on_high.is_none_or(|b| a <= b * (1.0 + SAME)));
        if is_low {
            triangles.push([[0, i], [0, i + 1], [1, k]]);
            i += 1;
        } else {
            triangles.push([[0, i], [1, k + 1], [1, k]]);
            k += 1;
        }
    }
    triangles
}

/// Whether a cell is parted by the diagonal from its first corner; of diagonals that are as long the one that is said is taken.
pub(crate) fn is_first_diagonal([a, b, c, d]: [Vector3<f64>; 4], of_equal: bool) -> bool {
    let [first, second] = [(a - c).norm_squared(), (b - d).norm_squared()];
    if (first - second).abs() <= SAME * first { of_equal } else { first < second }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a cylinder, lines that a thread has moved on by three of their own steps are joined along the axis, and not along the thread.
    #[test]
    fn lines_that_wind_are_joined_straight() {
        let line = |from: f64, z: f64| -> Vec<Vector3<f64>> {
            (0..40).map(|k| from + 0.05 * f64::from(k)).map(|a| Vector3::new(a.cos(), a.sin(), z)).collect()
        };
        let [low, high] = [line(0.0, 0.0), line(0.15, 0.01)];
        let triangles = stitched([&low, &high]);
        assert_eq!(triangles.len(), 78);
        let across = triangles.iter().filter(|of| of.iter().any(|[line, _]| *line == 1));
        let apart = |of: &&[[usize; 2]; 3]| {
            let steps = of.iter().map(|[line, point]| point + 3 * line).collect::<Vec<usize>>();
            steps.iter().max().unwrap_or(&0) - steps.iter().min().unwrap_or(&0)
        };
        // but for those at both ends, whose sides are given
        assert!(across.skip(3).take(72).all(|of| apart(&of) == 1));
    }
}

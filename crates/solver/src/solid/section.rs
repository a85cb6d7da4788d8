//! A tooth between the middles of two spaces, laid out in cells of four sides on every line across it.
//!
//! The tooth itself is one block, from flank to flank; what lies below it and the two half spaces, down to the rest of the outline, is
//! another one. Both share the row below the flanks.

use crate::solid::arrangement::{Arrangement, Polar};
use crate::solid::body::Body;

/// How finely a tooth is laid out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fineness {
    /// Cells across each chart of a space.
    pub charts: Vec<usize>,
    /// Cells from flank to flank.
    pub tooth: usize,
    /// Cells from the root to the rest of the outline.
    pub rim: usize,
    /// Cells along the tooth.
    pub along: usize,
    /// Cells along each arc of the rest of the outline, where that goes round in rings.
    pub arc: usize,
}

/// The nodes and cells of a section of a tooth; where they lie, a line across says.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Points of a line across a space, less one.
    pub(crate) last: usize,
    /// The point in the middle of the root.
    pub(crate) middle: usize,
    /// Rows of the tooth's block.
    pub(crate) depth: usize,
    pub(crate) tooth: usize,
    pub(crate) rim: usize,
}

impl Layout {
    pub(crate) fn new(fineness: &Fineness) -> Layout {
        let charts = &fineness.charts;
        let last: usize = charts.iter().sum();
        let middle = last / 2;
        let of_both = |k: usize| charts[k].min(charts[charts.len() - 1 - k]);
        // fillets lie beside the ground, below the flanks and what is above these; three surfaces have none
        let fillet = ((charts.len() - 1) / 2).saturating_sub(1).max(1);
        let flanks: usize = (0..fillet).map(of_both).sum();
        // where a fillet has turned by about half: there the cells of both blocks have the best corners
        let beyond = if charts.len() > 3 { of_both(fillet) / 2 } else { 0 };
        let depth = (flanks + beyond).min(middle).min(last - middle).max(1);
        Layout { last, middle, depth, tooth: fineness.tooth, rim: fineness.rim }
    }

    /// Cells from one middle of the root to the next.
    pub(crate) fn width(&self) -> usize {
        self.last - 2 * self.depth + self.tooth
    }

    /// Nodes of a section, the sides included.
    pub(crate) fn nodes(&self) -> usize {
        self.depth * (self.tooth + 1) + (self.rim + 1) * (self.width() + 1)
    }

    /// A node of the tooth's block: from the tip down, from the angle's lower side on.
    pub(crate) fn in_tooth(&self, row: usize, column: usize) -> usize {
        if row < self.depth {
            row * (self.tooth + 1) + column
        } else {
            self.in_rim(0, self.last - self.middle - self.depth + column)
        }
    }

    /// A node of the block below: from the root down, from one middle of the root to the next.
    pub(crate) fn in_rim(&self, row: usize, column: usize) -> usize {
        self.depth * (self.tooth + 1) + row * (self.width() + 1) + column
    }

    /// The cells, each as its nodes: the angle grows from the first to the second, the depth from the second to the third.
    pub(crate) fn cells(&self) -> Vec<[usize; 4]> {
        let tooth = (0..self.depth).flat_map(|i| (0..self.tooth).map(move |k| (i, k)));
        let tooth = tooth.map(|(i, k)| {
            [self.in_tooth(i, k), self.in_tooth(i, k + 1), self.in_tooth(i + 1, k + 1), self.in_tooth(i + 1, k)]
        });
        let rim = (0..self.rim).flat_map(|i| (0..self.width()).map(move |k| (i, k)));
        let rim = rim
            .map(|(i, k)| [self.in_rim(i, k), self.in_rim(i, k + 1), self.in_rim(i + 1, k + 1), self.in_rim(i + 1, k)]);
        tooth.chain(rim).collect()
    }

    /// Whether a cell that begins at a node lies before the middle of the tooth.
    pub(crate) fn is_before_middle(&self, node: usize) -> bool {
        let in_tooth = self.depth * (self.tooth + 1);
        if node < in_tooth {
            return node % (self.tooth + 1) < self.tooth / 2;
        }
        (node - in_tooth) % (self.width() + 1) < self.width() / 2
    }

    /// Whether a node lies in the block below the tooth.
    pub(crate) fn is_in_rim(&self, node: usize) -> bool {
        node >= self.in_rim(0, 0)
    }

    /// Of the points along the top of the lower block the share of the way from its one side to the other, half by length and half
    /// evenly.
    pub(crate) fn shares(&self, top: &[Polar], arrangement: Arrangement) -> Vec<f64> {
        let mut sums = vec![0.0];
        for pair in top.windows(2) {
            sums.push(sums[sums.len() - 1] + arrangement.distance(pair[0], pair[1]));
        }
        let (whole, count) = (sums[sums.len() - 1], self.width() as f64);
        sums.iter().enumerate().map(|(k, sum)| 0.5 * sum / whole + 0.5 * k as f64 / count).collect()
    }

    /// The top of the lower block, from one middle of the root to the next, by lines across the spaces before the tooth and behind it.
    pub(crate) fn top(&self, [line, next]: [&[Polar]; 2]) -> Vec<Polar> {
        let own = line[self.middle..=self.last - self.depth].iter().copied();
        let (from, to) = (line[self.last - self.depth], next[self.depth]);
        let under = (1..self.tooth).map(|k| between(from, to, k as f64 / self.tooth as f64));
        own.chain(under).chain(next[self.depth..=self.middle].iter().copied()).collect()
    }

    /// Where the nodes of a section lie, by lines across the spaces before the tooth and behind it, where the rest of the outline is below
    /// them, `[z, rho]`, and the shares of [`Layout::shares`].
    pub(crate) fn places(&self, [line, next]: [&[Polar]; 2], below: [f64; 2], shares: &[f64]) -> Vec<Polar> {
        let top = self.top([line, next]);
        let mut places = Vec::with_capacity(self.nodes());
        for i in 0..self.depth {
            let (from, to) = (line[self.last - i], next[i]);
            places.extend((0..=self.tooth).map(|k| between(from, to, k as f64 / self.tooth as f64)));
        }
        let (start, width) = (line[self.middle][2], next[self.middle][2] - line[self.middle][2]);
        for row in 0..=self.rim {
            let share = row as f64 / self.rim as f64;
            places.extend(
                top.iter()
                    .zip(shares)
                    .map(|(place, along)| between(*place, [below[0], below[1], start + along * width], share)),
            );
        }
        places
    }

    /// Brings the middle of the tooth, in which spaces are cut off from each other, to the way of the middle of its tip, from there down to
    /// the rest of the outline.
    pub(crate) fn straighten(&self, places: &mut [Polar]) {
        let (half, from) = (self.tooth / 2, self.in_middle() - self.tooth / 2);
        let wanted = places[self.in_tooth(0, half)][2];
        let rows = (0..self.depth).map(|row| self.in_tooth(row, 0));
        for first in rows.chain((0..=self.rim).map(|row| self.in_rim(row, from))) {
            let by = wanted - places[first + half][2];
            for k in 0..=self.tooth {
                let share = k.min(self.tooth - k) as f64 / half as f64;
                places[first + k][2] += share * by;
            }
        }
    }
}

fn between(from: Polar, to: Polar, share: f64) -> Polar {
    if share == 0.0 {
        return from;
    }
    if share == 1.0 {
        return to;
    }
    [0, 1, 2].map(|k| (1.0 - share) * from[k] + share * to[k])
}

impl Body {
    /// Shares across the charts for cells of one size each, and along.
    pub(crate) fn shares_of(fineness: &Fineness) -> (Vec<Vec<f64>>, Vec<f64>) {
        let even = |count: usize| (0..=count).map(|k| k as f64 / count as f64).collect::<Vec<f64>>();
        (fineness.charts.iter().map(|count| even(*count)).collect(), even(fineness.along))
    }
}

//! Positions of a tool, and where among them something is least.

use std::f64::consts::TAU;

use crate::machine::Range;

/// Positions of the tool that are tried, where it stands still, for one motion, and for each of two.
const POSITIONS: [usize; 3] = [1, 321, 41];

/// Positions beside a known one, from an eighth of the ranges down.
pub fn around(at: &[f64], ranges: &[Range]) -> Vec<Vec<f64>> {
    let ways = directions(at.len(), 16);
    let shares = (3..16).map(|halvings| 0.5f64.powi(halvings));
    let near = shares.flat_map(|share| ways.iter().map(move |way| moved(at, way, share, ranges)));
    [at.to_vec()].into_iter().chain(near).collect()
}

/// Positions of the tool, evenly spread over no, one or two motions.
#[derive(Clone, Debug)]
pub struct Lattice {
    pub ranges: Vec<Range>,
    side: usize,
}

impl Lattice {
    pub fn new(ranges: Vec<Range>) -> Lattice {
        Lattice { side: POSITIONS[ranges.len()], ranges }
    }

    pub fn len(&self) -> usize {
        self.side.pow(self.ranges.len() as u32)
    }

    pub fn at(&self, n: usize) -> Vec<f64> {
        let places = [n % self.side, n / self.side];
        self.ranges.iter().zip(places).map(|(range, k)| range.at(k as f64 / (self.side - 1) as f64)).collect()
    }

    pub fn neighbours(&self, n: usize) -> impl Iterator<Item = usize> {
        let side = self.side as isize;
        let (i, k) = ((n / self.side) as isize, (n % self.side) as isize);
        let rows = if self.ranges.len() == 2 { -1..=1 } else { 0..=0 };
        let offsets = rows.flat_map(|a| (-1..=1).map(move |b| (a, b))).filter(|offset| *offset != (0, 0));
        let near = offsets.map(move |(a, b)| (i + a, k + b));
        let is_one = self.ranges.len() == 2;
        near.filter(move |(i, k)| (0..side).contains(k) && (!is_one && *i == 0 || is_one && (0..side).contains(i)))
            .map(move |(i, k)| (i * side + k) as usize)
    }

    /// The positions that neighbours, all of which see the point beside the surface, join to one at which it is not in the steel.
    pub fn beside_the_outside(&self, heights: &[f64]) -> Vec<bool> {
        let mut is_reached: Vec<bool> = heights.iter().map(|height| height.is_finite() && *height >= 0.0).collect();
        let mut open: Vec<usize> = (0..heights.len()).filter(|n| is_reached[*n]).collect();
        while let Some(n) = open.pop() {
            for other in self.neighbours(n) {
                if heights[other].is_finite() && !is_reached[other] {
                    is_reached[other] = true;
                    open.push(other);
                }
            }
        }
        is_reached
    }

    /// Down from a position, by steps that shrink where none leads down.
    pub fn descent(&self, height: &impl Fn(&[f64]) -> f64, from: usize) -> Vec<f64> {
        let mut at = self.at(from);
        let mut least = height(&at);
        let mut step = 0.5 / (self.side - 1).max(1) as f64;
        while step > 1e-8 {
            let ways = directions(self.ranges.len(), 8)
                .into_iter()
                .map(|direction| moved(&at, &direction, step, &self.ranges));
            let lower = ways.map(|to| (height(&to), to)).filter(|(there, _)| *there < least);
            match lower.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some(lower) => (least, at) = lower,
                None => step *= 0.5,
            }
        }
        at
    }
}

/// Unit vectors evenly spread.
fn directions(dimensions: usize, count: usize) -> Vec<Vec<f64>> {
    match dimensions {
        0 => Vec::new(),
        1 => vec![vec![1.0], vec![-1.0]],
        _ => (0..count).map(|k| k as f64 * TAU / count as f64).map(|angle| vec![angle.cos(), angle.sin()]).collect(),
    }
}

/// Beside a position by a share of the ranges, at their ends at the most.
fn moved(at: &[f64], direction: &[f64], share: f64, ranges: &[Range]) -> Vec<f64> {
    let places = at.iter().zip(direction).zip(ranges);
    places.map(|((at, along), range)| (at + along * share * range.width()).clamp(range.low, range.high)).collect()
}

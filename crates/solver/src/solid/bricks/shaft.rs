//! What lies below the teeth of a blank that goes on beyond them, as a shaft does: a lattice in the section of the outline.
//!
//! A straight line below the teeth divides both. Under it, and beyond it on either side, the outline is a figure with four sides: on top the
//! dividing line between the surfaces of the shaft, then its end faces, and opposite the bore.

use crate::contact::OutlineSegment;
use crate::solid::blank::Blank;
use crate::solid::bricks::counts::refined;

/// What goes on beyond the teeth by less is rounding, mm.
const BEYOND: f64 = 1e-6;
/// Bricks along a part of the shaft, and from the dividing line to the bore, at the most.
const MOST: f64 = 64.0;

/// Bricks of a shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaftCounts {
    /// From below the teeth to the bore.
    pub rows: usize,
    /// Along what goes on before the beginning of the spaces and behind their end.
    pub ends: [usize; 2],
}

/// The outline around a shaft.
pub(crate) struct Shaft<'b> {
    /// From the end face to the teeth where the spaces begin, and from the teeth to the end face where they end.
    top: [Chain<'b>; 2],
    /// The end faces, from top to bottom.
    sides: [Chain<'b>; 2],
    bottom: Chain<'b>,
    /// The line below the teeth, `[z, rho]`.
    divide: [[f64; 2]; 2],
}

/// Parts of segments that follow each other: the number of each segment, it, and between which shares of it the part runs.
struct Chain<'b> {
    parts: Vec<(usize, &'b OutlineSegment, [f64; 2])>,
}

/// Where the nodes of a shaft lie in the section, and what its outer sides are.
pub(crate) struct ShaftLattice {
    /// Of each section from one end face to the other the places `[z, rho]` from the top to the bottom.
    pub(crate) places: Vec<Vec<[f64; 2]>>,
    /// The segment on top of each layer beyond the teeth, before these and behind.
    pub(crate) top: [Vec<usize>; 2],
    /// The segment below each layer.
    pub(crate) bottom: Vec<usize>,
    /// The segment at the side of each row, on both end faces.
    pub(crate) sides: [Vec<usize>; 2],
}

impl<'b> Shaft<'b> {
    /// Of a blank whose outline below the teeth goes on beyond them on one side or both, and ends there in a face; `None` of others.
    pub(crate) fn of_blank(blank: &'b Blank) -> Option<Shaft<'b>> {
        let [begin, _, end] = blank.bounds();
        let segments = blank.outline.segments();
        let count = segments.len();
        let rest = blank.rest().len();
        // from the beginning of the spaces round to their end, against the outline's own way
        let number = |k: usize| (blank.ends[2] + rest - k) % count;
        let part = |k: usize| (number(k), &segments[number(k)], [1.0, 0.0]);
        let places: Vec<[f64; 2]> =
            std::iter::once(begin.from).chain((0..rest).map(|k| segments[number(k)].from)).collect();
        let last = |of: &dyn Fn(usize) -> bool| (0..=rest).rev().find(|k| of(*k));
        let first = |of: &dyn Fn(usize) -> bool| (0..=rest).find(|k| of(*k));
        // the corners of the end face beyond an end of the spaces, in the order of the places
        let face = |of: &OutlineSegment| {
            let beyond = |k: usize| -of.bound().height(places[k]);
            let most = (0..=rest).map(beyond).fold(0.0, f64::max);
            let is_farthest = |k: usize| beyond(k) >= most - BEYOND;
            (most > BEYOND && of.center.is_none()).then(|| Some((first(&is_farthest)?, last(&is_farthest)?))).flatten()
        };
        let (before, behind) = (face(begin), face(end));
        if before.is_none() && behind.is_none() {
            return None;
        }
        // the dividing line is as deep on the side that has no shaft
        let depth = |place: [f64; 2], of: &OutlineSegment| {
            let share = (place[1] - of.from[1]) / (of.to[1] - of.from[1]);
            (of.center.is_none() && (BEYOND..1.0 - BEYOND).contains(&share)).then_some(share)
        };
        let chain = |from: usize, to: usize| (from..to).map(part).collect::<Vec<_>>();
        let (start, top_before, side_before, from) = match before {
            Some((top, bottom)) => (places[0], turned(chain(0, top)), chain(top, bottom), bottom),
            None => {
                let share = depth(places[rest], begin)?;
                (begin.at(share), Vec::new(), vec![(blank.ends[0], begin, [share, 0.0])], 0)
            }
        };
        let (stop, top_behind, side_behind, to) = match behind {
            Some((bottom, top)) => (places[rest], turned(chain(top, rest)), turned(chain(bottom, top)), bottom),
            None => {
                let share = depth(places[0], end)?;
                (end.at(share), Vec::new(), vec![(blank.ends[2], end, [share, 1.0])], rest)
            }
        };
        let bottom = (from < to).then(|| chain(from, to))?;
        let is_whole = !side_before.is_empty() && !side_behind.is_empty();
        let chained = |parts| Chain { parts };
        is_whole.then(|| Shaft {
            top: [top_before, top_behind].map(chained),
            sides: [side_before, side_behind].map(chained),
            bottom: chained(bottom),
            divide: [start, stop],
        })
    }

    /// The middle of the dividing line, `[z, rho]`.
    pub(crate) fn middle(&self) -> [f64; 2] {
        self.divided(0.5)
    }

    /// Bricks about as long as those of the teeth.
    pub(crate) fn counts(&self, along: usize) -> ShaftCounts {
        let [from, to] = self.divide;
        let size = (to[0] - from[0]).hypot(to[1] - from[1]) / along as f64;
        let of = |chain: &Chain<'_>| {
            let wanted = (chain.length() / size).ceil().min(MOST) as usize;
            wanted.max(chain.parts.len())
        };
        ShaftCounts { rows: of(&self.sides[0]).max(of(&self.sides[1])), ends: self.top.each_ref().map(of) }
    }

    /// Its nodes, with so many steps from one corner of a brick to the next; `None` where the corners of the outline do not fit those of bricks.
    pub(crate) fn lattice(&self, counts: ShaftCounts, along: usize, steps: usize) -> Option<ShaftLattice> {
        let of_chain = |chain: &Chain<'_>, count: usize| snapped(even(count), &chain.corners());
        let ends = [of_chain(&self.top[0], counts.ends[0])?, of_chain(&self.top[1], counts.ends[1])?];
        let top = |ends: [&[f64]; 2], middle: &[f64]| -> Vec<[f64; 2]> {
            let before = ends[0].iter().map(|share| self.top[0].at(*share));
            let behind = ends[1].iter().map(|share| self.top[1].at(*share));
            let [before, behind] = [before.collect::<Vec<_>>(), behind.collect()];
            let middle: Vec<[f64; 2]> = middle.iter().map(|share| self.divided(*share)).collect();
            // both ends of the dividing line are also those of its neighbours
            let before = &before[..before.len() - 1];
            before.iter().chain(&middle).chain(behind.iter().skip(1)).copied().collect()
        };
        let coarse = top([&ends[0], &ends[1]], &even(along));
        let bottom = snapped(self.shares(&coarse), &self.bottom.corners())?;
        let sides = [of_chain(&self.sides[0], counts.rows)?, of_chain(&self.sides[1], counts.rows)?];
        let fine = |shares: &[f64]| refined(shares, steps);
        let upper = top([&fine(&ends[0]), &fine(&ends[1])], &fine(&even(along)));
        let lower = fine(&bottom);
        let down = [fine(&sides[0]), fine(&sides[1])];
        let corners = [upper[0], upper[upper.len() - 1], self.bottom.at(0.0), self.bottom.at(1.0)];
        let place = |i: usize, j: usize| {
            if j == 0 {
                return upper[i];
            }
            let (u, v) = (lower[i], 0.5 * (down[0][j] + down[1][j]));
            let (above, below) = (upper[i], self.bottom.at(u));
            let (left, right) = (self.sides[0].at(down[0][j]), self.sides[1].at(down[1][j]));
            [0, 1].map(|k| {
                let [a, b, c, d] = corners.map(|corner| corner[k]);
                let twice = (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d);
                (1.0 - v) * above[k] + v * below[k] + (1.0 - u) * left[k] + u * right[k] - twice
            })
        };
        let rows = down[0].len();
        let places = (0..upper.len()).map(|i| (0..rows).map(|j| place(i, j)).collect()).collect();
        Some(ShaftLattice {
            places,
            top: [0, 1].map(|side| self.top[side].segments(&ends[side])),
            bottom: self.bottom.segments(&bottom),
            sides: [0, 1].map(|side| self.sides[side].segments(&sides[side])),
        })
    }

    fn divided(&self, share: f64) -> [f64; 2] {
        let [from, to] = self.divide;
        [0, 1].map(|k| (1.0 - share) * from[k] + share * to[k])
    }

    /// Shares of the bottom below places on the top: half by length, half by how far these are along the dividing line.
    fn shares(&self, top: &[[f64; 2]]) -> Vec<f64> {
        let [from, to] = self.divide;
        let along =
            |place: [f64; 2]| (place[0] - from[0]) * (to[0] - from[0]) + (place[1] - from[1]) * (to[1] - from[1]);
        let mut lengths = vec![0.0];
        for pair in top.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            lengths.push(lengths[lengths.len() - 1] + step);
        }
        let (whole, last) = (lengths[lengths.len() - 1], top.len() - 1);
        let (start, width) = (along(top[0]), along(top[last]) - along(top[0]));
        let share = |k: usize| 0.5 * (lengths[k] / whole + (along(top[k]) - start) / width);
        (0..=last).map(|k| if k == last { 1.0 } else { share(k) }).collect()
    }
}

impl ShaftLattice {
    /// The segment on top of a layer beyond the teeth, which have so many layers.
    pub(crate) fn above(&self, layer: usize, along: usize) -> Option<usize> {
        let [before, behind] = &self.top;
        let beyond = || behind.get(layer.checked_sub(before.len() + along)?);
        before.get(layer).or_else(beyond).copied()
    }
}

impl Chain<'_> {
    fn lengths(&self) -> impl Iterator<Item = f64> {
        self.parts.iter().map(|(_, segment, [from, to])| segment.length() * (to - from).abs())
    }

    fn length(&self) -> f64 {
        self.lengths().sum()
    }

    /// The part at a share of its length, and the share of that.
    fn part(&self, share: f64) -> Option<(usize, f64)> {
        let mut left = share * self.length();
        let last = self.parts.len().checked_sub(1)?;
        for (k, length) in self.lengths().enumerate() {
            if left <= length || k == last {
                return Some((k, (left / length).min(1.0)));
            }
            left -= length;
        }
        None
    }

    /// The place `[z, rho]` at a share of its length; of nothing no number.
    fn at(&self, share: f64) -> [f64; 2] {
        let Some((part, share)) = self.part(share) else { return [f64::NAN; 2] };
        let (_, segment, [from, to]) = self.parts[part];
        segment.at(from + share * (to - from))
    }

    /// The shares at which one part ends and the next begins.
    fn corners(&self) -> Vec<f64> {
        let whole = self.length();
        let mut passed = 0.0;
        let end = |length: f64| {
            passed += length;
            passed / whole
        };
        self.lengths().take(self.parts.len().saturating_sub(1)).map(end).collect()
    }

    /// The segments that lie between shares.
    fn segments(&self, shares: &[f64]) -> Vec<usize> {
        let between = shares.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        between.filter_map(|share| self.part(share)).map(|(part, _)| self.parts[part].0).collect()
    }
}

/// The same from its end to its beginning.
fn turned(parts: Vec<(usize, &OutlineSegment, [f64; 2])>) -> Vec<(usize, &OutlineSegment, [f64; 2])> {
    parts.into_iter().rev().map(|(number, segment, [from, to])| (number, segment, [to, from])).collect()
}

fn even(count: usize) -> Vec<f64> {
    (0..=count).map(|k| if count == 0 { 0.0 } else { k as f64 / count as f64 }).collect()
}

/// Shares of which one is at each corner: those that are nearest are moved there. `None` where a corner has none of its own, or order is lost.
fn snapped(mut shares: Vec<f64>, corners: &[f64]) -> Option<Vec<f64>> {
    let last = shares.len() - 1;
    let mut from = 1;
    for (k, corner) in corners.iter().enumerate() {
        let to = last.checked_sub(corners.len() - k)?;
        let near = (from..=to).min_by(|a, b| (shares[*a] - corner).abs().total_cmp(&(shares[*b] - corner).abs()))?;
        shares[near] = *corner;
        from = near + 1;
    }
    shares.windows(2).all(|pair| pair[0] < pair[1]).then_some(shares)
}

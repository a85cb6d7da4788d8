//! How tooth spaces lie in the outline of a blank: between two ends, open at the tip.

use flank_expr::Expr;

use crate::contact::{Outline, OutlineSegment};

/// Steps of the bisection for a place on the tip: as many as a number has binary digits.
const HALVINGS: usize = 60;

/// An outline in which tooth spaces run from one segment to another and leave the blank at the one between.
#[derive(Clone, Debug, PartialEq)]
pub struct Blank {
    /// Closed, the material on the left.
    pub outline: Outline,
    /// The segment where the spaces begin, the one that they leave the blank by, and the one where they end: each begins where the
    /// one before ends.
    pub ends: [usize; 3],
}

impl Blank {
    /// The segments of begin, tip and end.
    pub fn bounds(&self) -> [&OutlineSegment; 3] {
        self.ends.map(|at| &self.outline.segments()[at])
    }

    /// The other segments, from the one that follows the end on.
    pub fn rest(&self) -> Vec<&OutlineSegment> {
        let segments = self.outline.segments();
        let count = segments.len();
        (1..count)
            .map(|k| (self.ends[2] + k) % count)
            .take_while(|k| *k != self.ends[0])
            .map(|k| &segments[k])
            .collect()
    }

    /// The segment of the rest that is no farther from a place `[z, rho]`, by its number.
    pub(crate) fn rest_at(&self, place: [f64; 2], near: f64) -> Option<usize> {
        let off = |segment: &OutlineSegment| {
            let [z, rho] = segment.nearest(place);
            (z - place[0]).hypot(rho - place[1])
        };
        let at = self.rest().into_iter().position(|segment| off(segment) <= near)?;
        Some((self.ends[2] + 1 + at) % self.outline.segments().len())
    }

    /// Places `[z, rho]` around the rest, from where the spaces begin to where they end, with so many steps: its corners among them where
    /// there are as many steps as segments.
    pub(crate) fn below(&self, steps: usize) -> Vec<[f64; 2]> {
        let segments = self.outline.segments();
        let cells = self.below_cells(steps);
        let mut places: Vec<[f64; 2]> = cells.iter().map(|(segment, [from, _])| segments[*segment].at(*from)).collect();
        places.push(self.bounds()[2].to);
        places
    }

    /// The same as cells: of each the segment of the outline, and the shares of it between which it runs.
    pub(crate) fn below_cells(&self, steps: usize) -> Vec<(usize, [f64; 2])> {
        let rest = self.rest();
        let whole: f64 = rest.iter().map(|segment| segment.length()).sum();
        let mut left = steps;
        let mut cells = Vec::with_capacity(steps);
        let mut passed = 0.0;
        for (k, segment) in rest.iter().enumerate().rev() {
            passed += segment.length();
            let wanted = (steps as f64 * passed / whole).round() as usize;
            let count = wanted.saturating_sub(steps - left).max(1).min(left.saturating_sub(k));
            let count = if k == 0 { left } else { count };
            let number = (self.ends[2] + 1 + k) % self.outline.segments().len();
            let share = |step: usize| 1.0 - step as f64 / count as f64;
            cells.extend((0..count).map(|step| (number, [share(step), share(step + 1)])));
            left -= count;
        }
        cells
    }

    /// How far a place `[z, rho]` lies beyond the tip, mm.
    pub fn above_tip(&self, place: [f64; 2]) -> f64 {
        -self.bounds()[1].bound().height(place)
    }

    /// How far a place `[z, rho]` lies from begin to end, as a share.
    pub fn share([begin, _, end]: [&OutlineSegment; 3], place: [f64; 2]) -> f64 {
        let [a, b] = [begin, end].map(|segment| segment.bound().height(place));
        a / (a + b)
    }

    /// The same as a function of `z` and `rho`.
    pub fn share_of<'g>(&self, [z, rho]: [Expr<'g>; 2]) -> Expr<'g> {
        let [begin, _, end] = self.bounds();
        let height = |segment: &OutlineSegment| {
            let bound = segment.bound();
            let (x, y) = (z - bound.origin[0], rho - bound.origin[1]);
            let flat = x * bound.inward[0] + y * bound.inward[1];
            if bound.bend == 0.0 { flat } else { flat + (x * x + y * y) * (0.5 * bound.bend) }
        };
        match between_parallels([begin, end]) {
            Some(width) => height(begin) / width,
            None => height(begin) / (height(begin) + height(end)),
        }
    }

    /// How far a place `[z, rho]` lies beyond the ends of the spaces, mm; nothing between them.
    pub fn beyond_ends(&self, place: [f64; 2]) -> f64 {
        let [begin, _, end] = self.bounds();
        [begin, end].map(|segment| -segment.bound().height(place)).into_iter().fold(0.0, f64::max)
    }

    /// The place `[z, rho]` on the tip at a share of the way from begin to end.
    pub fn tip(&self, share: f64) -> [f64; 2] {
        let bounds = self.bounds();
        let tip = bounds[1];
        if share <= 0.0 {
            return tip.from;
        }
        if share >= 1.0 {
            return tip.to;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if Blank::share(bounds, tip.at(middle)) < share { low = middle } else { high = middle }
        }
        tip.at(0.5 * (low + high))
    }
}

/// How far two parallel lines lie apart that have the material between them.
fn between_parallels([begin, end]: [&OutlineSegment; 2]) -> Option<f64> {
    let [a, b] = [begin, end].map(OutlineSegment::bound);
    let are_opposite = (0..2).all(|k| a.inward[k] == -b.inward[k]);
    (a.bend == 0.0 && b.bend == 0.0 && are_opposite).then(|| a.height(b.origin))
}

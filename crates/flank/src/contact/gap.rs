//! Where no pair of teeth is known to touch over a pitch: between the end of one pair and the beginning of the next.

use flank_solver::ContactPoint;

use super::rolling::Rolling;

/// Halvings of the way between two positions until the end of a pair's contact is settled: to rounding.
const HALVINGS: usize = 50;
/// A stretch below this share of a pitch is none: rounding.
const NOTHING: f64 = 1e-9;

/// Both ends of the contact of a pair of teeth.
pub(crate) struct PairEnds {
    /// The first contact and the last.
    pub(crate) points: [ContactPoint; 2],
    /// Whether the range of the roll ends there, and not the contact.
    pub(crate) is_of_roll: [bool; 2],
}

impl PairEnds {
    /// How far the members roll between them.
    pub(crate) fn width(&self) -> f64 {
        self.points[1].roll - self.points[0].roll
    }
}

impl Rolling {
    /// Where the pair of teeth begins and ends to touch, solved between the last position at which it does and the next.
    pub(crate) fn pair_ends(&self) -> Option<PairEnds> {
        let of = self.looked_at();
        let outermost = [of.points.first()?, of.points.last()?];
        let step = of.pitch / of.steps as f64;
        let end = |k: usize| {
            let beyond = match of.is_whole[k] {
                true => outermost[k].roll + [-step, step][k],
                false => self.limits[k],
            };
            let mut last = outermost[k].clone();
            if let Some(there) = self.problem.followed(&last, beyond) {
                return (there, !of.is_whole[k]);
            }
            let mut outside = beyond;
            for _ in 0..HALVINGS {
                match self.problem.followed(&last, 0.5 * (last.roll + outside)) {
                    Some(point) => last = point,
                    None => outside = 0.5 * (last.roll + outside),
                }
            }
            (last, false)
        };
        let [(first, is_first), (last, is_last)] = [end(0), end(1)];
        Some(PairEnds { points: [first, last], is_of_roll: [is_first, is_last] })
    }

    /// The ends of the pair of teeth where the next one does not yet touch when it ends: nothing is known between, and over the rest of a pitch the
    /// error is that of this pair.
    pub(crate) fn gap(&self) -> Option<PairEnds> {
        let of = self.looked_at();
        let is_short = self.has_pitch && of.points.len() <= of.steps;
        let (pitch, ends) = (of.pitch, is_short.then(|| self.pair_ends()).flatten()?);
        (ends.width() < (1.0 - NOTHING) * pitch).then_some(ends)
    }
}

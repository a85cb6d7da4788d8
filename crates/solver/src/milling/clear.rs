//! A proof that a body stays away from a surface while its cutter moves along a block.
//!
//! The signed distance of a point from a solid changes by no more than the point moves against the solid. So it is looked at in the middle of
//! a box of both shares of the surface and the share of the block, less how far the surface and the motion reach from there; what that does
//! not settle is halved. How fast surface and motion change is bounded by the coefficients of their polynomials.

use crate::milling::distance::{Obstacle, Shape, ToolBody};
use crate::milling::outline::OutlinePiece;
use crate::milling::series::PoseSeries;

/// The angle between unit vectors whose tips are no farther apart than this is below [`ANGLE`] times that.
const CHORD: f64 = 0.9;
const ANGLE: f64 = 1.04;

/// What is known of the distance of a body from a surface over a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Clear {
    /// It is nowhere below the limit.
    Proven,
    /// It is below the limit at this share of the block and these shares of the surface.
    Missed {
        /// mm.
        distance: f64,
        /// Of the block.
        along: f64,
        /// Of the surface.
        shares: [f64; 2],
    },
    /// As many boxes as were allowed did not settle it.
    Open,
}

/// A surface and a body, between which distances are proven.
#[derive(Clone, Debug)]
pub struct ClearProof<'o> {
    obstacle: &'o Obstacle,
    body: Shape,
    /// How fast a point of the surface moves with each share at the most, mm.
    rates: [f64; 2],
}

/// A box: the middle and the half width of both shares of the surface and of that of the block.
#[derive(Clone, Copy, Debug)]
struct Cell {
    middle: [f64; 3],
    half: [f64; 3],
}

impl<'o> ClearProof<'o> {
    /// The body ends at the height where its outline does.
    pub fn new(obstacle: &'o Obstacle, body: &ToolBody) -> ClearProof<'o> {
        let mut body = body.clone();
        let end = body.pieces.last().map(|piece| match *piece {
            OutlinePiece::Line { to, .. } => to,
            OutlinePiece::Arc { center, radius, between: [_, angle] } => {
                [center[0] + radius * angle.sin(), center[1] - radius * angle.cos()]
            }
        });
        let top = end.filter(|end| end[0] > 0.0).map(|end| OutlinePiece::Line { from: end, to: [0.0, end[1]] });
        body.pieces.extend(top);
        ClearProof { obstacle, body: body.shape(), rates: obstacle.surface.rates() }
    }

    /// Whether the body is nowhere nearer than `limit` on a block, after `most` boxes at the most.
    pub fn along(&self, block: &PoseSeries, limit: f64, most: usize) -> Clear {
        let [tip_rate, axis_rate] = block.rates();
        let mut open = vec![Cell { middle: [0.5; 3], half: [0.5; 3] }];
        let mut looked_at = 0;
        while let Some(cell) = open.pop() {
            looked_at += 1;
            if looked_at > most {
                return Clear::Open;
            }
            let [first, second, along] = cell.middle;
            let [x, y, z, ..] = self.obstacle.surface.at([first, second]);
            let pose = block.at(along);
            let distance = self.body.distance(&pose, [x, y, z]);
            if distance < limit {
                return Clear::Missed { distance, along, shares: [first, second] };
            }
            let [by_first, by_second] = [self.rates[0] * cell.half[0], self.rates[1] * cell.half[1]];
            let from_tip = (x - pose[0]).hypot(y - pose[1]).hypot(z - pose[2]) + by_first + by_second;
            let chord = axis_rate * cell.half[2];
            let turn = if chord < CHORD { ANGLE * chord } else { std::f64::consts::PI };
            let by_motion = tip_rate * cell.half[2] + from_tip * turn;
            if distance - by_first - by_second - by_motion >= limit {
                continue;
            }
            let parts = [by_first, by_second, by_motion];
            let widest = (0..3).max_by(|a, b| parts[*a].total_cmp(&parts[*b])).expect("there are three");
            let mut half = cell.half;
            half[widest] *= 0.5;
            for side in [-1.0, 1.0] {
                let mut middle = cell.middle;
                middle[widest] += side * half[widest];
                open.push(Cell { middle, half });
            }
        }
        Clear::Proven
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::milling::series::PoseField;
    use crate::solid::chart::Chart;

    /// A plane at a height, and a pin of radius 2 with a flat end that slides over it and leans.
    fn case(height: f64) -> (Obstacle, ToolBody, PoseSeries) {
        let shares = [Chart::shares(5), Chart::shares(7)];
        let points = shares[0].iter().flat_map(|u| shares[1].iter().map(move |w| (20.0 * u - 10.0, 30.0 * w - 15.0)));
        let plane = PoseField::through(points.map(|(x, y)| [x, y, height, 0.0, 0.0, 1.0]).collect(), [5, 7]);
        let pieces = vec![
            OutlinePiece::Line { from: [0.0, 0.0], to: [2.0, 0.0] },
            OutlinePiece::Line { from: [2.0, 0.0], to: [2.0, 40.0] },
        ];
        let block = PoseSeries::sampled(9, |s| {
            let (sine, cosine) = (0.1 * s).sin_cos();
            [8.0 * s - 4.0, 1.0, 0.0, sine, 0.0, cosine]
        });
        (Obstacle::new(plane), ToolBody { pieces }, block)
    }

    #[test]
    fn a_pin_over_a_plane_is_as_far_as_its_edge() {
        // the edge is lowest at the end of the block
        let lowest = -2.0 * 0.1f64.sin();
        let (obstacle, body, block) = case(-1.0);
        let proof = ClearProof::new(&obstacle, &body);
        let exact = 1.0 + lowest;
        assert_eq!(proof.along(&block, exact - 0.02, 2_000_000), Clear::Proven);
        assert_eq!(proof.along(&block, exact - 0.02, 20), Clear::Open);
        match proof.along(&block, exact + 0.02, 2_000_000) {
            Clear::Missed { distance, along, .. } => {
                assert!(distance < exact + 0.02 && along > 0.8, "{distance} {along}")
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_plane_above_the_end_of_a_pin_is_as_far_as_that() {
        let (obstacle, body, _) = case(43.0);
        let still = PoseSeries::sampled(3, |_| [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        let proof = ClearProof::new(&obstacle, &body);
        assert_eq!(proof.along(&still, 2.99, 2_000_000), Clear::Proven);
        assert!(matches!(proof.along(&still, 3.01, 2_000_000), Clear::Missed { .. }));
    }
}

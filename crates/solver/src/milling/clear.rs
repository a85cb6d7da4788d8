//! A proof that a body stays away from a surface while its cutter moves along a block.
//!
//! The body is cut into [slices](Slice) that are convex. The distance from such a slice lies above its tangents: with the direction g from its
//! nearest point, d(q) ≥ d(p) + g · (q − p). So over a box of both shares of the surface and the share of the block it is no less than in the
//! middle, less what the first derivatives of q along g change, less what second derivatives can add. Where surface and body run side by side,
//! as they do where they are nearest, g is square to the first ones, and boxes are as large as the square root of what is to spare. A box that this
//! does not settle is halved, that with the least bound first. Derivatives are bounded by the coefficients of the polynomials.
//!
//! A body that is not cut so, and a limit below zero, within the body, have the bound that a distance changes by no more than its point moves.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::Vector3;

use crate::milling::distance::{Obstacle, Shape, ToolBody};
use crate::milling::outline::{OutlinePiece, meridian};
use crate::milling::series::PoseSeries;
use crate::milling::slice::Slice;
use crate::milling::smooth::{MotionBounds, SmoothField};

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
    Open {
        /// It is nowhere below this, mm.
        proven: f64,
    },
}

/// A surface and a body, between which distances are proven.
#[derive(Clone, Debug)]
pub struct ClearProof {
    surface: SmoothField,
    body: Shape,
    /// All of the body; none where a part of it is not convex.
    slices: Option<Vec<Slice>>,
}

/// A box: the middle and the half width of both shares of the surface and of that of the block, for one slice.
#[derive(Clone, Copy, Debug)]
struct Cell {
    middle: [f64; 3],
    half: [f64; 3],
    slice: Option<Slice>,
    /// No distance in it is less.
    bound: f64,
    /// How far each of the shares brings it below the distance in its middle.
    parts: [f64; 3],
}

impl PartialEq for Cell {
    fn eq(&self, other: &Cell) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Cell) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// That with the least bound is the greatest: it comes first out of a heap.
impl Ord for Cell {
    fn cmp(&self, other: &Cell) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

impl ClearProof {
    /// The body ends at the height where its outline does.
    pub fn new(obstacle: &Obstacle, body: &ToolBody) -> ClearProof {
        let slices = body.pieces.iter().map(Slice::of_piece).collect();
        let mut body = body.clone();
        let end = body.pieces.last().map(|piece| match *piece {
            OutlinePiece::Line { to, .. } => to,
            OutlinePiece::Arc { center, radius, between: [_, angle] } => {
                [center[0] + radius * angle.sin(), center[1] - radius * angle.cos()]
            }
        });
        let top = end.filter(|end| end[0] > 0.0).map(|end| OutlinePiece::Line { from: end, to: [0.0, end[1]] });
        body.pieces.extend(top);
        ClearProof { surface: SmoothField::new(&obstacle.surface), body: body.shape(), slices }
    }

    /// Whether the body is nowhere nearer than `limit` on a block, after `most` boxes at the most.
    pub fn along(&self, block: &PoseSeries, limit: f64, most: usize) -> Clear {
        let motion = MotionBounds::new(block);
        let slices: Vec<Option<Slice>> = match &self.slices {
            Some(slices) if limit >= 0.0 => slices.iter().copied().map(Some).collect(),
            _ => vec![None],
        };
        let mut open = BinaryHeap::new();
        let mut next: Vec<([f64; 3], [f64; 3], Option<Slice>)> =
            slices.into_iter().map(|slice| ([0.5; 3], [0.5; 3], slice)).collect();
        let mut looked_at = 0;
        loop {
            for (middle, half, slice) in next.drain(..) {
                looked_at += 1;
                match self.cell((block, &motion), (middle, half, slice), limit) {
                    Ok(cell) if cell.bound >= limit => {}
                    Ok(cell) => open.push(cell),
                    Err(missed) => return missed,
                }
            }
            let Some(cell) = open.pop() else { return Clear::Proven };
            if looked_at >= most {
                return Clear::Open { proven: cell.bound };
            }
            let widest =
                (0..3).max_by(|a, b| cell.parts[*a].total_cmp(&cell.parts[*b])).expect("there are three shares");
            let mut half = cell.half;
            half[widest] *= 0.5;
            for side in [-1.0, 1.0] {
                let mut middle = cell.middle;
                middle[widest] += side * half[widest];
                next.push((middle, half, cell.slice));
            }
        }
    }

    /// A box with its bound.
    ///
    /// # Errors
    /// If the body is nearer than `limit` in its middle.
    fn cell(
        &self,
        (block, motion): (&PoseSeries, &MotionBounds),
        (middle, half, slice): ([f64; 3], [f64; 3], Option<Slice>),
        limit: f64,
    ) -> Result<Cell, Clear> {
        let shares = [middle[0], middle[1]];
        let [place, first, second] = self.surface.at(shares);
        let moving = block.moving(middle[2]);
        let whole = self.body.distance(&moving[0], place);
        if whole < limit {
            return Err(Clear::Missed { distance: whole, along: middle[2], shares });
        }
        let part = |row: &[f64; 6], from: usize| Vector3::new(row[from], row[from + 1], row[from + 2]);
        let [y, axis] = [Vector3::from(place) - part(&moving[0], 0), part(&moving[0], 3)];
        let [first, second] = [first, second].map(Vector3::from);
        // the tool without its turn about its own axis turns so
        let turning = axis.cross(&part(&moving[1], 3));
        let backwards = -part(&moving[1], 0) - turning.cross(&y);
        let fast = self.fastest(motion, &half, y.norm());
        // with the moves as they are, and with the part of them along the direction from the nearest point
        let lipschitz = [0, 1, 2].map(|k| fast.slopes[k] * half[k]);
        let loose = Cell { middle, half, slice, bound: whole - lipschitz.iter().sum::<f64>(), parts: lipschitz };
        let Some(of) = slice else { return Ok(loose) };
        let found = of.from(meridian(&moving[0], place));
        let up = axis * axis.dot(&y);
        let out = (y - up).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let direction = out * found.direction[0] + axis * found.direction[1];
        let slopes = [first, second, backwards].map(|slope| direction.dot(&slope).abs());
        let parts = [0, 1, 2].map(|k| {
            let bends: f64 = (0..3).map(|l| 0.5 * fast.bends[k][l] * half[k] * half[l]).sum();
            slopes[k] * half[k] + bends
        });
        let bound = found.distance - parts.iter().sum::<f64>();
        let by_moves = found.distance - lipschitz.iter().sum::<f64>();
        Ok(if bound > by_moves { Cell { bound, parts, ..loose } } else { Cell { bound: by_moves, ..loose } })
    }

    /// How fast a point of the surface moves as the tool sees it, in a box in whose middle it is so far from the tip.
    fn fastest(&self, motion: &MotionBounds, half: &[f64; 3], from_tip: f64) -> Fastest {
        let field = &self.surface.bounds;
        let [tip, tip_bent] = motion.tip;
        let [turn, turn_bent] = motion.axis;
        let far = from_tip + field.slopes[0] * half[0] + field.slopes[1] * half[1] + tip * half[2];
        let [first, second] = field.slopes;
        let along = tip_bent + (turn_bent + turn * turn) * far + 2.0 * turn * tip;
        Fastest {
            slopes: [first, second, tip + turn * far],
            bends: [
                [field.bends[0], field.mixed, turn * first],
                [field.mixed, field.bends[1], turn * second],
                [turn * first, turn * second, along],
            ],
        }
    }
}

/// Bounds of first and second derivatives by both shares of the surface and that of the block, mm.
struct Fastest {
    slopes: [f64; 3],
    bends: [[f64; 3]; 3],
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
        match proof.along(&block, exact - 0.02, 6) {
            Clear::Open { proven } => assert!(proven < exact - 0.02, "{proven}"),
            other => panic!("{other:?}"),
        }
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

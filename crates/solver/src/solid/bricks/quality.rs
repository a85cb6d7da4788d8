//! What bricks are like: volume, and how far they are from folding.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::solid::bricks::element::{BESIDE, GaussPoint, gauss_points, jacobian};
use crate::solid::bricks::{BrickMesh, BrickOrder};

/// Bricks that a thread takes at once.
const TOGETHER: usize = 1024;

/// What the bricks of a mesh are like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrickQuality {
    /// mm³
    pub volume: f64,
    /// The least Jacobian at three Gauss points in each direction, of the brick's mean: 1 in a parallelepiped, not above 0 where a brick is folded.
    pub least_jacobian: f64,
    /// The least determinant of the unit vectors along three edges, of all corners and the middle (Knupp 2000; Verdict's scaled Jacobian): 1 in
    /// a box, not above 0 where a brick is folded.
    pub least_scaled_jacobian: f64,
}

impl BrickMesh {
    /// Volume and least Jacobians.
    pub fn quality(&self) -> BrickQuality {
        let points = gauss_points(self.order);
        let parts = self.bricks.par_chunks(TOGETHER * self.order.nodes()).map(|part| self.of_part(part, &points));
        // the sum has one order, whatever the threads do
        let parts: Vec<BrickQuality> = parts.collect();
        parts.into_iter().fold(NOTHING, together)
    }

    fn of_part(&self, bricks: &[u32], points: &[GaussPoint]) -> BrickQuality {
        let mut nodes = Vec::with_capacity(BrickOrder::Second.nodes());
        let mut brick = |own: &[u32]| {
            nodes.clear();
            nodes.extend(own.iter().map(|node| self.nodes[*node as usize]));
            of_brick(&nodes, points)
        };
        bricks.chunks(self.order.nodes()).map(&mut brick).fold(NOTHING, together)
    }
}

const NOTHING: BrickQuality =
    BrickQuality { volume: 0.0, least_jacobian: f64::INFINITY, least_scaled_jacobian: f64::INFINITY };

fn together(a: BrickQuality, b: BrickQuality) -> BrickQuality {
    BrickQuality {
        volume: a.volume + b.volume,
        least_jacobian: a.least_jacobian.min(b.least_jacobian),
        least_scaled_jacobian: a.least_scaled_jacobian.min(b.least_scaled_jacobian),
    }
}

fn of_brick(nodes: &[[f64; 3]], points: &[GaussPoint]) -> BrickQuality {
    let (mut volume, mut least) = (0.0, f64::INFINITY);
    for point in points {
        let jacobian = jacobian(&point.slopes, nodes);
        volume += point.weight * jacobian;
        least = least.min(jacobian);
    }
    // the brick of the shape functions has a volume of 8
    let mean = volume.abs() / 8.0;
    BrickQuality { volume, least_jacobian: least / mean, least_scaled_jacobian: scaled_jacobian(nodes) }
}

fn scaled_jacobian(nodes: &[[f64; 3]]) -> f64 {
    let point = |node: usize| Vector3::from(nodes[node]);
    let scaled = |[a, b, c]: [Vector3<f64>; 3]| {
        let sizes = a.norm() * b.norm() * c.norm();
        // an edge without length, or one that is not a number
        if sizes > 0.0 { a.cross(&b).dot(&c) / sizes } else { 0.0 }
    };
    let corner = |k: usize| scaled(BESIDE[k].map(|other| point(other) - point(k)));
    let axis =
        |plus: [usize; 4], minus: [usize; 4]| (0..4).map(|k| point(plus[k]) - point(minus[k])).sum::<Vector3<f64>>();
    let middle =
        scaled([axis([1, 2, 5, 6], [0, 3, 4, 7]), axis([2, 3, 6, 7], [0, 1, 4, 5]), axis([4, 5, 6, 7], [0, 1, 2, 3])]);
    (0..8).map(corner).fold(middle, f64::min)
}

//! One pass with the straight side of a cutter: the motion of its axis whose envelope comes nearest to a surface.
//!
//! At each share of the way the cutter lies at the middle of a strip of the surface, turned about the normal, leaning away from the tangent
//! plane, and raised off it. These three are polynomials of the share, and they are what is looked for: how far the envelope is off follows
//! from the height of the moving side over points of the strip, along their normals. Its derivatives are exact, the second ones, too.

mod bend;
mod directions;
mod left;
mod search;

use nalgebra::Vector3;

use crate::milling::outline::StraightSide;
use crate::milling::series::PoseSeries;
use crate::solid::chart::Chart;

pub use directions::side_directions;
pub use left::{LeftOnWay, left_on_way};

/// Functions of the way that are looked for: the turn about the normal, the lean away from the surface, the height above it.
const FREE: usize = 3;
/// Points of the polynomials of the whole motion, until their tail is below [`NEAR`].
const NODES: [usize; 4] = [25, 49, 97, 193];
/// How near these are, mm and parts of a unit vector.
const NEAR: f64 = 1e-12;

/// A strip of a surface that one pass covers, and the side that lies on it.
#[derive(Clone, Debug)]
pub struct SideStrip {
    /// Points and normals of the middle of the strip over the share of the way.
    pub middle: PoseSeries,
    /// Whether the end of the strip beside the spindle lies to the side of normal × direction of the pass.
    pub spindle_left: bool,
    /// The side.
    pub side: StraightSide,
    /// Above the origin of the cutter at the height at which it lies on the middle of the strip, mm, at [`Chart::shares`] of the way;
    /// one number if it is the same everywhere.
    pub heights: Vec<f64>,
    /// What is to be left, mm.
    pub stock: f64,
}

/// A motion of a side over a strip.
#[derive(Clone, Debug)]
pub struct SideMotion {
    /// Turns, leans and heights, each at [`Chart::shares`] of the way.
    pub free: Vec<f64>,
    /// What is left over each of the points, beside the stock, mm.
    pub left: Vec<f64>,
}

impl SideMotion {
    /// The largest amount of what is left, mm.
    pub fn largest(&self) -> f64 {
        self.left.iter().fold(0.0, |most: f64, left| most.max(left.abs()))
    }

    /// The root of the mean of the squares of what is left, mm: the largest is never less.
    pub fn root_mean_square(&self) -> f64 {
        (self.left.iter().map(|left| left * left).sum::<f64>() / self.left.len() as f64).sqrt()
    }
}

/// A pass with a side.
#[derive(Clone, Debug)]
pub struct SidePass {
    /// Origin and axis of the cutter over the share of the way.
    pub way: PoseSeries,
    /// The same by what is free, with what it leaves.
    pub motion: SideMotion,
    /// How high above its origin the cutter touches, lowest and highest, mm; the side taken longer than it is.
    pub touches: [f64; 2],
    /// By how much the best change of the motion promises to lower the largest amount of what is left, mm.
    pub gap: f64,
    /// Whether that is next to nothing.
    pub is_settled: bool,
}

/// Three orthonormal vectors on the middle of a strip.
struct Base {
    point: Vector3<f64>,
    normal: Vector3<f64>,
    /// Towards the end beside the spindle.
    across: Vector3<f64>,
    along: Vector3<f64>,
}

impl Base {
    fn new(point: [f64; 3], normal: [f64; 3], way: [f64; 3], spindle_left: bool) -> Base {
        let (normal, way) = (Vector3::from(normal).normalize(), Vector3::from(way));
        let along = (way - normal * way.dot(&normal)).normalize();
        let across = normal.cross(&along) * if spindle_left { 1.0 } else { -1.0 };
        Base { point: point.into(), normal, across, along }
    }
}

/// A cutter that touches the middle of a strip, but for what turns, leans and raises it.
struct Lying {
    base: Base,
    /// From the contact to the axis along the side's normal, and from the origin up to there, mm.
    to_axis: f64,
    up: f64,
    free: [f64; FREE],
    /// The half angle.
    opens: f64,
    stock: f64,
}

impl Lying {
    /// Towards the spindle along the surface, and beside that.
    fn lines(&self) -> [Vector3<f64>; 2] {
        let (sine, cosine) = self.free[0].sin_cos();
        let Base { across, along, .. } = self.base;
        [across * cosine + along * sine, along * cosine - across * sine]
    }

    fn pose(&self) -> [f64; 6] {
        let ([line, _], [_, lean, raised]) = (self.lines(), self.free);
        let ((sl, cl), (sa, ca)) = (lean.sin_cos(), (lean + self.opens).sin_cos());
        let Base { point, normal, .. } = self.base;
        let axis = line * ca + normal * sa;
        let away = normal * cl - line * sl;
        row(point + normal * (self.stock + raised) + away * self.to_axis - axis * self.up, axis)
    }

    /// How the pose changes with turn, lean and height.
    fn slopes(&self) -> [[f64; 6]; FREE] {
        let ([line, beside], lean) = (self.lines(), self.free[1]);
        let ((sl, cl), (sa, ca)) = (lean.sin_cos(), (lean + self.opens).sin_cos());
        let normal = self.base.normal;
        let by_turn = row(beside * (-sl * self.to_axis - ca * self.up), beside * ca);
        let axis = normal * ca - line * sa;
        let by_lean = row((line * cl + normal * sl) * -self.to_axis - axis * self.up, axis);
        [by_turn, by_lean, row(normal, Vector3::zeros())]
    }

    /// How these change with turn and lean: by the turn twice, by both, by the lean twice.
    fn bends(&self) -> [[f64; 6]; 3] {
        let ([line, beside], lean) = (self.lines(), self.free[1]);
        let ((sl, cl), (sa, ca)) = (lean.sin_cos(), (lean + self.opens).sin_cos());
        let normal = self.base.normal;
        let [axis, away] = [line * ca + normal * sa, normal * cl - line * sl];
        [
            row(line * (sl * self.to_axis + ca * self.up), line * -ca),
            row(beside * (sa * self.up - cl * self.to_axis), beside * -sa),
            row(axis * self.up - away * self.to_axis, -axis),
        ]
    }
}

fn row(tip: Vector3<f64>, axis: Vector3<f64>) -> [f64; 6] {
    [tip.x, tip.y, tip.z, axis.x, axis.y, axis.z]
}

/// The polynomial through values at [`Chart::shares`]; of one value that value.
fn weights(count: usize, share: f64) -> Vec<f64> {
    if count == 1 { vec![1.0] } else { Chart::weights(count, share) }
}

fn weighted(values: &[f64], weights: &[f64]) -> f64 {
    values.iter().zip(weights).map(|(value, weight)| value * weight).sum()
}

impl SideStrip {
    fn base(&self, share: f64) -> Base {
        let [[x, y, z, nx, ny, nz], [dx, dy, dz, ..], _] = self.middle.moving(share);
        Base::new([x, y, z], [nx, ny, nz], [dx, dy, dz], self.spindle_left)
    }

    /// How the cutter lies at a share.
    fn lying(&self, share: f64, free: [f64; FREE]) -> Lying {
        let touches = weighted(&self.heights, &weights(self.heights.len(), share));
        let opens = self.side.half_angle;
        // along the normal of the side from the contact to the axis
        let to_axis = self.side.radius_at(touches) / opens.cos();
        let up = touches + to_axis * opens.sin();
        Lying { base: self.base(share), to_axis, up, free, opens, stock: self.stock }
    }

    /// The pose at a share.
    fn pose(&self, share: f64, free: [f64; FREE]) -> [f64; 6] {
        self.lying(share, free).pose()
    }

    /// Turn, lean and height at a share, of their values at so many places.
    fn free(values: &[f64], share: f64) -> [f64; FREE] {
        let count = values.len() / FREE;
        let weights = weights(count, share);
        [0, 1, 2].map(|k| weighted(&values[k * count..][..count], &weights))
    }

    /// The motion with turns, leans and heights, as polynomials that are near enough to rounding, or as near as they come.
    pub fn way(&self, values: &[f64]) -> PoseSeries {
        let through = |count: usize| PoseSeries::sampled(count, |share| self.pose(share, Self::free(values, share)));
        let found = NODES.iter().map(|count| through(*count));
        found.reduce(|best, next| if best.tail() <= NEAR { best } else { next }).expect("there are several")
    }
}

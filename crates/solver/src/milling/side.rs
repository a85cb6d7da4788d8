//! One pass with the straight side of a cutter: the motion of its axis whose envelope comes nearest to a surface.
//!
//! At each share of the way the cutter lies at the middle of a strip of the surface, turned about the normal, leaning away from the tangent
//! plane, and raised off it. These three are polynomials of the share, and they are what is looked for: how far the envelope is off follows
//! from the height of the moving side over points of the strip, along their normals, and its derivatives are exact.

use std::f64::consts::FRAC_PI_2;

use faer::Mat;
use nalgebra::Vector3;

use crate::equations::solution::Range;
use crate::milling::frame::SurfaceFrame;
use crate::milling::height::{NormalLine, lowest, slopes_of_side};
use crate::milling::outline::{Cutter, StraightSide, meridian};
use crate::milling::pose::surface_form;
use crate::milling::series::PoseSeries;
use crate::newton::least_squares::{LeastSquares, Linearized, ScaledUnknown, SearchEnd};
use crate::solid::chart::Chart;

/// Functions of the way that are looked for: the turn about the normal, the lean away from the surface, the height above it.
const FREE: usize = 3;
/// The axis is no farther than this from across the pass: it would run along itself.
const FARTHEST_TURN: f64 = 1.4;
/// A lean up to this to both sides, radians.
const FARTHEST_LEAN: f64 = 0.7;
/// Steps that change no height by more than this end the search, mm.
const SETTLED: f64 = 1e-11;
/// What counts as much as a radian of turn or lean, mm of height: a cutter's side is some 10 mm long.
const SCALE: f64 = 10.0;
/// Points of the polynomials of the whole motion, until their tail is below [`NEAR`].
const NODES: [usize; 4] = [25, 49, 97, 193];
/// How near these are, mm and parts of a unit vector.
const NEAR: f64 = 1e-12;
/// Places of the way that are looked at before the lowest one is solved.
const LOOKED_AT: usize = 97;
/// Directions that differ by less than this are one, radians.
const SAME: f64 = 1e-6;

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

/// A pass with a side.
#[derive(Clone, Debug)]
pub struct SidePass {
    /// Origin and axis of the cutter over the share of the way.
    pub way: PoseSeries,
    /// What is left over each of the points, beside the stock, mm.
    pub left: Vec<f64>,
    /// Whether no change of the motion leaves less, as the mean of squares counts it.
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

/// The angles from across the pass towards its direction at which the axis of a cylinder of a radius may lie on a surface: along the
/// asymptotic directions of the surface parallel to it in that distance, so that a ruled surface touches that one; where it has none, in
/// the direction in which it bends least.
///
/// `frame` has the direction of the pass as its second step.
pub fn side_directions(frame: &SurfaceFrame, spindle_left: bool, radius: f64) -> Vec<f64> {
    let base = Base::new(frame.position, frame.normal, frame.steps[1], spindle_left);
    let Some([[a, b], [_, c]]) = surface_form(frame, [base.across, base.along]) else { return Vec::new() };
    // S (1 + R S)⁻¹
    let whole = (1.0 + radius * a) * (1.0 + radius * c) - radius * radius * b * b;
    let determinant = a * c - b * b;
    let [a, b, c] = [(a + radius * determinant) / whole, b / whole, (c + radius * determinant) / whole];
    let discriminant = b * b - a * c;
    // a cos² + 2 b cos sin + c sin² = 0
    let mut found = if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        [root, -root].map(|root| {
            // of two quotients the one that does not cancel
            let q = b + if b >= 0.0 { root.abs() } else { -root.abs() };
            if (root >= 0.0) == (b >= 0.0) && q != 0.0 { (-q).atan2(c) } else { (-a).atan2(q) }
        })
    } else {
        [0.5 * (2.0 * b).atan2(a - c); 2].map(|most| if (a + c) > 0.0 { most + FRAC_PI_2 } else { most })
    };
    found.iter_mut().for_each(|angle| *angle = folded(*angle));
    found.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let mut kept: Vec<f64> = found.into_iter().filter(|angle| angle.abs() < FARTHEST_TURN).collect();
    kept.dedup_by(|a, b| (*a - *b).abs() < SAME);
    kept
}

/// The angle of the same line within a quarter turn to both sides.
fn folded(angle: f64) -> f64 {
    angle - 2.0 * FRAC_PI_2 * (angle / (2.0 * FRAC_PI_2)).round()
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

    /// The pose at a share, and how it changes with turn, lean and height there.
    fn pose(&self, share: f64, [turn, lean, raised]: [f64; FREE]) -> ([f64; 6], [[f64; 6]; FREE]) {
        let base = self.base(share);
        let touches = weighted(&self.heights, &weights(self.heights.len(), share));
        let opens = self.side.half_angle;
        // along the normal of the side from the contact to the axis
        let to_axis = self.side.radius_at(touches) / opens.cos();
        let up = touches + to_axis * opens.sin();
        let (st, ct) = turn.sin_cos();
        let [line, beside] = [base.across * ct + base.along * st, base.along * ct - base.across * st];
        let ((sl, cl), (sa, ca)) = (lean.sin_cos(), (lean + opens).sin_cos());
        let axis = line * ca + base.normal * sa;
        let away = base.normal * cl - line * sl;
        let tip = base.point + base.normal * (self.stock + raised) + away * to_axis - axis * up;
        let row = |tip: Vector3<f64>, axis: Vector3<f64>| [tip.x, tip.y, tip.z, axis.x, axis.y, axis.z];
        let by_turn = (beside * (-sl * to_axis - ca * up), beside * ca);
        let axis_by_lean = base.normal * ca - line * sa;
        let by_lean = ((line * cl + base.normal * sl) * -to_axis - axis_by_lean * up, axis_by_lean);
        let slopes = [row(by_turn.0, by_turn.1), row(by_lean.0, by_lean.1), row(base.normal, Vector3::zeros())];
        (row(tip, axis), slopes)
    }

    /// Turn, lean and height at a share, of their values at so many places.
    fn free(values: &[f64], share: f64) -> [f64; FREE] {
        let count = values.len() / FREE;
        let weights = weights(count, share);
        [0, 1, 2].map(|k| weighted(&values[k * count..][..count], &weights))
    }

    /// The motion as polynomials that are as near as [`NEAR`], or as near as they come.
    fn way(&self, values: &[f64]) -> PoseSeries {
        let through = |count: usize| PoseSeries::sampled(count, |share| self.pose(share, Self::free(values, share)).0);
        let found = NODES.iter().map(|count| through(*count));
        found.reduce(|best, next| if best.tail() <= NEAR { best } else { next }).expect("there are several")
    }

    /// The motion of which the sum of the squares of what it leaves over points is least, from turns at so many places of the way.
    /// `None` if the cutter does not pass over one of the points at the start.
    pub fn nearest_pass(&self, turns: &[f64], points: &[NormalLine]) -> Option<SidePass> {
        let count = turns.len();
        let cutter = Cutter { pieces: vec![self.side.lengthened().piece()] };
        let angle = |start: f64, most: f64| ScaledUnknown {
            start,
            scale: 1.0 / SCALE,
            range: Range { low: -most, high: most },
        };
        let endless = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let unknowns = (turns.iter().map(|turn| angle(*turn, FRAC_PI_2)))
            .chain((0..count).map(|_| angle(0.0, FARTHEST_LEAN)))
            .chain((0..count).map(|_| ScaledUnknown { start: 0.0, scale: 1.0, range: endless }));
        let problem = LeastSquares {
            unknowns: unknowns.collect(),
            exact: 0,
            resolution: 0.0,
            uses_weak: false,
            settled: SETTLED,
            given_up: None,
        };
        let start: Vec<f64> = problem.unknowns.iter().map(|unknown| unknown.start).collect();
        let way = self.way(&start);
        let mut near = nearest_shares(&way, &cutter, points);
        let fit = problem.solve(|values| {
            let (found, linearized) = self.linearized(values, &cutter, points, &near)?;
            near = found;
            Some(linearized)
        })?;
        let left = fit.residuals.clone();
        Some(SidePass { way: self.way(&fit.values), left, is_settled: fit.end == SearchEnd::Settled })
    }

    /// What is left over points, with its derivatives, and where on the way.
    fn linearized(
        &self,
        values: &[f64],
        cutter: &Cutter,
        points: &[NormalLine],
        near: &[f64],
    ) -> Option<(Vec<f64>, Linearized)> {
        let (way, count) = (self.way(values), values.len() / FREE);
        let mut jacobian = Mat::zeros(points.len(), values.len());
        let (mut shares, mut residuals) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for (row, (line, near)) in points.iter().zip(near).enumerate() {
            let found = lowest(&way, cutter, line, *near)?;
            // the place changes the height by nothing where it is lowest, and not at all at the end of the way
            let share = found.share.clamp(0.0, 1.0);
            let (pose, slopes) = self.pose(share, Self::free(values, share));
            let by_pose = slopes_of_side(&self.side, &pose, line, found.height);
            let weights = weights(count, share);
            for (k, slope) in slopes.iter().enumerate() {
                let by_free: f64 = by_pose.iter().zip(slope).map(|(a, b)| a * b).sum();
                weights.iter().enumerate().for_each(|(at, weight)| jacobian[(row, k * count + at)] = by_free * weight);
            }
            shares.push(share);
            residuals.push(found.height - self.stock);
        }
        Some((shares, Linearized { residuals, jacobian }))
    }
}

/// Where on a way a cutter comes nearest to points, among places that are evenly spread.
fn nearest_shares(way: &PoseSeries, cutter: &Cutter, points: &[NormalLine]) -> Vec<f64> {
    let shares: Vec<f64> = (0..LOOKED_AT).map(|k| k as f64 / (LOOKED_AT - 1) as f64).collect();
    let poses: Vec<[f64; 6]> = shares.iter().map(|share| way.at(*share)).collect();
    let nearest = |line: &NormalLine| {
        let gaps = poses.iter().map(|pose| cutter.gap(pose, [line[0], line[1], line[2]]));
        let least = gaps.zip(&shares).min_by(|a, b| a.0.total_cmp(&b.0));
        *least.expect("there are shares").1
    };
    points.iter().map(nearest).collect()
}

/// What a cutter leaves over points of a surface on its whole way, mm, and at which height above its origin and share it was lowest; `None`
/// where it does not pass.
pub fn left_on_way(way: &PoseSeries, cutter: &Cutter, points: &[NormalLine]) -> Vec<Option<LeftOnWay>> {
    let near = nearest_shares(way, cutter, points);
    let at = |(line, near): (&NormalLine, &f64)| {
        let found = lowest(way, cutter, line, *near)?;
        let place = [0, 1, 2].map(|k| line[k] + found.height * line[3 + k]);
        let [_, above] = meridian(&way.at(found.share), place);
        Some(LeftOnWay { height: found.height, share: found.share, above })
    };
    points.iter().zip(&near).map(at).collect()
}

/// What a way leaves over a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOnWay {
    /// mm along the normal.
    pub height: f64,
    /// Of the way, where the cutter is lowest.
    pub share: f64,
    /// How high above its origin the cutter passes there, mm.
    pub above: f64,
}

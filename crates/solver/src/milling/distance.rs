//! How near a part of a cutter, with neck and holder, comes to a surface.

use crate::milling::outline::{OutlinePiece, meridian};
use crate::milling::series::PoseField;

/// Points of a surface that are looked at before the nearest one is solved.
const COARSE: [usize; 2] = [13, 25];
/// Shares by which a surface is left and right of a point to tell how the distance changes.
const APART: f64 = 1e-3;
/// Newton's steps at the most.
const MOST_STEPS: u32 = 20;
/// A step up to this ends them: the distance is then as near as its square, times some 100 mm.
const CLOSE: f64 = 1e-8;

/// A body of revolution in the frame of a cutter: what lies between its outline and the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolBody {
    /// From the tip upwards, each where the one before ends.
    pub pieces: Vec<OutlinePiece>,
}

/// The place of a surface that is nearest to a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// mm; negative where the surface lies in the body.
    pub distance: f64,
    /// Where on the surface.
    pub shares: [f64; 2],
}

/// A surface between four lines that a body keeps clear of.
#[derive(Clone, Debug)]
pub struct Obstacle {
    pub(super) surface: PoseField,
    coarse: Vec<([f64; 2], [f64; 3])>,
    /// No point of the surface is farther from the nearest of those than this, mm.
    reach: f64,
}

impl ToolBody {
    /// The distance of a point where the cutter stands so, mm; negative inside.
    pub fn distance(&self, pose: &[f64; 6], point: [f64; 3]) -> f64 {
        let [rho, z] = meridian(pose, point);
        let away = self.pieces.iter().map(|piece| away(piece, [rho, z])).fold(f64::INFINITY, f64::min);
        let crossed: u32 = self.pieces.iter().map(|piece| crossings(piece, [rho, z])).sum();
        if crossed % 2 == 1 { -away } else { away }
    }
}

/// The distance of a point from a piece.
fn away(piece: &OutlinePiece, [rho, z]: [f64; 2]) -> f64 {
    match *piece {
        OutlinePiece::Line { from, to } => {
            let along = [to[0] - from[0], to[1] - from[1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let share = ((rho - from[0]) * along[0] + (z - from[1]) * along[1]) / square;
            let share = share.clamp(0.0, 1.0);
            (rho - from[0] - share * along[0]).hypot(z - from[1] - share * along[1])
        }
        OutlinePiece::Arc { center, radius, between } => {
            let [out, up] = [rho - center[0], z - center[1]];
            let angle = out.atan2(-up);
            if angle >= between[0] && angle <= between[1] {
                return (out.hypot(up) - radius).abs();
            }
            let end = |angle: f64| (out - radius * angle.sin()).hypot(up + radius * angle.cos());
            end(between[0]).min(end(between[1]))
        }
    }
}

/// How often the ray from a point away from the axis meets a piece; a lower end belongs to it, an upper one does not.
fn crossings(piece: &OutlinePiece, [rho, z]: [f64; 2]) -> u32 {
    match *piece {
        OutlinePiece::Line { from, to } => {
            let is_between = (from[1] <= z) != (to[1] <= z);
            let at = || from[0] + (z - from[1]) / (to[1] - from[1]) * (to[0] - from[0]);
            u32::from(is_between && at() > rho)
        }
        OutlinePiece::Arc { center, radius, between } => {
            // an angle is lowest at zero: an arc rises all the way
            let height = |angle: f64| center[1] - radius * angle.cos();
            let [low, high] = between.map(height);
            if !((low <= z) && (z < high)) {
                return 0;
            }
            let up = z - center[1];
            let out = (radius * radius - up * up).max(0.0).sqrt();
            u32::from(center[0] + out > rho)
        }
    }
}

impl Obstacle {
    /// Of a surface as polynomials of two shares.
    pub fn new(surface: PoseField) -> Obstacle {
        let share = |k: usize, at: usize| at as f64 / (COARSE[k] - 1) as f64;
        let places = (0..COARSE[0]).flat_map(|i| (0..COARSE[1]).map(move |j| [share(0, i), share(1, j)]));
        let point = |shares: [f64; 2]| {
            let [x, y, z, ..] = surface.at(shares);
            (shares, [x, y, z])
        };
        let coarse: Vec<([f64; 2], [f64; 3])> = places.map(point).collect();
        let apart = |a: usize, b: usize| (0..3).map(|k| (coarse[a].1[k] - coarse[b].1[k]).powi(2)).sum::<f64>().sqrt();
        let [rows, columns] = COARSE;
        let steps = (0..rows - 1).flat_map(|i| (0..columns - 1).map(move |j| i * columns + j));
        let diagonal = steps.map(|at| apart(at, at + columns + 1).max(apart(at + 1, at + columns)));
        // half a diagonal, and half of that again for what lies beside the chord
        let reach = 0.75 * diagonal.fold(0.0, f64::max);
        Obstacle { surface, coarse, reach }
    }

    /// The place that is nearest to a body at a pose; `None` if none can be nearer than `limit`.
    pub fn nearest(&self, body: &ToolBody, pose: &[f64; 6], limit: f64) -> Option<Nearest> {
        let distances = self.coarse.iter().map(|(shares, point)| (body.distance(pose, *point), *shares));
        let (coarse, start) = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
        if coarse - self.reach > limit {
            return None;
        }
        let found = self.solved(&|point| body.distance(pose, point), start);
        Some(if found.distance <= coarse { found } else { Nearest { distance: coarse, shares: start } })
    }

    /// The radius of the largest ball that touches a point from the side of its unit `normal` and stays away from the surface by `by`, and
    /// the place of the surface that stops it; `None` where nothing does. mm.
    ///
    /// A ball that touches p leaves the distance `by` to q = p + d where its radius is (d² − by²) / (2 (n · d + by)).
    pub fn largest_ball(&self, point: [f64; 3], normal: [f64; 3], by: f64) -> Option<Nearest> {
        let radius = |place: [f64; 3]| {
            let d = [0, 1, 2].map(|k| place[k] - point[k]);
            let [square, ahead] = [d, normal].map(|with| (0..3).map(|k| d[k] * with[k]).sum::<f64>());
            let room = ahead + by;
            if room > 0.0 { 0.5 * (square - by * by) / room } else { f64::INFINITY }
        };
        let radii = self.coarse.iter().map(|(shares, place)| (radius(*place), *shares));
        let (coarse, start) = radii.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(radius, _)| radius.is_finite())?;
        let found = self.solved(&radius, start);
        Some(if found.distance <= coarse { found } else { Nearest { distance: coarse, shares: start } })
    }

    /// Newton's method for the least value over the surface from a start, within the surface's ends.
    fn solved(&self, value: &dyn Fn([f64; 3]) -> f64, mut at: [f64; 2]) -> Nearest {
        let distance = |shares: [f64; 2]| {
            let [x, y, z, ..] = self.surface.at(shares);
            value([x, y, z])
        };
        let mut here = distance(at);
        for _ in 0..MOST_STEPS {
            let beside = |i: f64, j: f64| distance([at[0] + i * APART, at[1] + j * APART]);
            let [w, e, s, n] = [beside(-1.0, 0.0), beside(1.0, 0.0), beside(0.0, -1.0), beside(0.0, 1.0)];
            let (g, h) = ([0.5 * (e - w), 0.5 * (n - s)], [e - 2.0 * here + w, n - 2.0 * here + s]);
            let mixed = 0.25 * (beside(1.0, 1.0) - beside(1.0, -1.0) - beside(-1.0, 1.0) + beside(-1.0, -1.0));
            let next = stepped(at, g, h, mixed);
            let mut share = 1.0;
            let mut taken = None;
            // shorter until it is lower
            for _ in 0..30 {
                let tried = [0, 1].map(|k| (at[k] + share * (next[k] - at[k])).clamp(0.0, 1.0));
                let there = distance(tried);
                if there <= here {
                    taken = Some((tried, there));
                    break;
                }
                share *= 0.5;
            }
            let Some((tried, there)) = taken else { break };
            let moved = (tried[0] - at[0]).abs().max((tried[1] - at[1]).abs());
            (at, here) = (tried, there);
            if moved < CLOSE {
                break;
            }
        }
        Nearest { distance: here, shares: at }
    }
}

/// One step of Newton's method on a square, in units of shares; slopes and bends are by [`APART`].
fn stepped(at: [f64; 2], g: [f64; 2], h: [f64; 2], mixed: f64) -> [f64; 2] {
    let is_at_end = |k: usize| at[k] <= 0.0 && g[k] > 0.0 || at[k] >= 1.0 && g[k] < 0.0;
    let alone = |k: usize| {
        let step = if h[k] > 0.0 { -g[k] / h[k] } else { -g[k].signum() * 0.05 / APART };
        (at[k] + step * APART).clamp(0.0, 1.0)
    };
    match [is_at_end(0), is_at_end(1)] {
        [true, true] => at,
        [true, false] => [at[0], alone(1)],
        [false, true] => [alone(0), at[1]],
        [false, false] => {
            let whole = h[0] * h[1] - mixed * mixed;
            if !(h[0] > 0.0 && whole > 0.0) {
                return [alone(0), alone(1)];
            }
            let step = [(-g[0] * h[1] + g[1] * mixed) / whole, (-g[1] * h[0] + g[0] * mixed) / whole];
            [0, 1].map(|k| (at[k] + step[k] * APART).clamp(0.0, 1.0))
        }
    }
}

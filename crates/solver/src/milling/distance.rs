//! How near a part of a cutter, with neck and holder, comes to a surface.

use crate::milling::outline::{OutlinePiece, meridian};
use crate::milling::series::PoseField;

/// Rows and columns of points of a surface that are looked at before the nearest one is solved ...
const POINTS: [usize; 2] = [49, 97];
/// ... of which every so many are enough for what has no bound.
const COARSE: usize = 4;
/// Points of a part of a surface that are looked at one by one, in each direction.
const FEW: usize = 4;
/// Shares by which a surface is left and right of a point to tell how the distance changes.
pub(super) const APART: f64 = 1e-3;
/// Newton's steps at the most.
const MOST_STEPS: u32 = 20;
/// A step up to this ends them: the distance is then as near as its square, times some 100 mm.
const CLOSE: f64 = 1e-8;
/// A shorter step is not tried.
const SHORTEST: f64 = 1e-10;

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
    points: Vec<[f64; 3]>,
    /// Parts of the surface, each before those that it is cut into; the first is all of it.
    parts: Vec<Part>,
    /// No point of the surface is farther from the nearest of those than this, mm.
    reach: f64,
}

/// Points of a surface between rows and columns.
#[derive(Clone, Debug)]
struct Part {
    /// One of them, and no other is farther from it, mm.
    middle: usize,
    radius: f64,
    rows: [usize; 2],
    columns: [usize; 2],
    /// The two parts that it is cut into; none of few points.
    halves: Option<[usize; 2]>,
}

impl ToolBody {
    /// The distance of a point where the cutter stands so, mm; negative inside.
    pub fn distance(&self, pose: &[f64; 6], point: [f64; 3]) -> f64 {
        self.shape().distance(pose, point)
    }

    /// The same for many points.
    pub(crate) fn shape(&self) -> Shape {
        Shape { pieces: self.pieces.iter().map(ShapePiece::new).collect() }
    }
}

/// A body with what its pieces have in common for all points.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pieces: Vec<ShapePiece>,
}

#[derive(Clone, Copy, Debug)]
enum ShapePiece {
    Line {
        from: [f64; 2],
        to: [f64; 2],
        /// From one end to the other, over the square of the length.
        along: [f64; 2],
    },
    Arc {
        center: [f64; 2],
        radius: f64,
        /// Sines and cosines of the angles of its ends.
        ends: [[f64; 2]; 2],
        /// The heights of its ends: an angle is lowest at zero, and an arc rises all the way.
        heights: [f64; 2],
    },
}

impl Shape {
    /// The distance of a point where the cutter stands so, mm; negative inside.
    pub(crate) fn distance(&self, pose: &[f64; 6], point: [f64; 3]) -> f64 {
        let [rho, z] = meridian(pose, point);
        let (mut square, mut crossed) = (f64::INFINITY, false);
        for piece in &self.pieces {
            square = square.min(piece.square_away([rho, z]));
            crossed ^= piece.is_crossed([rho, z]);
        }
        if crossed { -square.sqrt() } else { square.sqrt() }
    }
}

impl ShapePiece {
    fn new(piece: &OutlinePiece) -> ShapePiece {
        match *piece {
            OutlinePiece::Line { from, to } => {
                let along = [to[0] - from[0], to[1] - from[1]];
                let square = along[0] * along[0] + along[1] * along[1];
                ShapePiece::Line { from, to, along: along.map(|part| part / square) }
            }
            OutlinePiece::Arc { center, radius, between } => {
                let ends = between.map(|angle| [angle.sin(), angle.cos()]);
                ShapePiece::Arc { center, radius, ends, heights: ends.map(|[_, cosine]| center[1] - radius * cosine) }
            }
        }
    }

    /// The square of the distance of a point.
    fn square_away(&self, [rho, z]: [f64; 2]) -> f64 {
        let squared = |[out, up]: [f64; 2]| out * out + up * up;
        match *self {
            ShapePiece::Line { from, to, along } => {
                let share = ((rho - from[0]) * along[0] + (z - from[1]) * along[1]).clamp(0.0, 1.0);
                let foot = [0, 1].map(|k| from[k] + share * (to[k] - from[k]));
                squared([rho - foot[0], z - foot[1]])
            }
            ShapePiece::Arc { center, radius, ends, .. } => {
                let [out, up] = [rho - center[0], z - center[1]];
                // from the first end on, and up to the last: sines of the differences of angles
                let [[s0, c0], [s1, c1]] = ends;
                if out * c0 + up * s0 >= 0.0 && -up * s1 - out * c1 >= 0.0 {
                    return (squared([out, up]).sqrt() - radius).powi(2);
                }
                let end = |[sine, cosine]: [f64; 2]| squared([out - radius * sine, up + radius * cosine]);
                end(ends[0]).min(end(ends[1]))
            }
        }
    }

    /// Whether the ray from a point away from the axis meets it; a lower end belongs to it, an upper one does not.
    fn is_crossed(&self, [rho, z]: [f64; 2]) -> bool {
        match *self {
            ShapePiece::Line { from, to, .. } => {
                let is_between = (from[1] <= z) != (to[1] <= z);
                is_between && from[0] + (z - from[1]) / (to[1] - from[1]) * (to[0] - from[0]) > rho
            }
            ShapePiece::Arc { center, radius, heights: [low, high], .. } => {
                let up = z - center[1];
                let out = || (radius * radius - up * up).max(0.0).sqrt();
                low <= z && z < high && center[0] + out() > rho
            }
        }
    }
}

impl Obstacle {
    /// Of a surface as polynomials of two shares.
    pub fn new(surface: PoseField) -> Obstacle {
        let [rows, columns] = POINTS;
        let row = |i: usize| {
            let row = surface.pass(i as f64 / (rows - 1) as f64);
            (0..columns).map(move |j| row.at(j as f64 / (columns - 1) as f64)).map(|[x, y, z, ..]| [x, y, z])
        };
        let points: Vec<[f64; 3]> = (0..rows).flat_map(row).collect();
        let apart = |a: usize, b: usize| apart(points[a], points[b]);
        let steps = (0..rows - 1).flat_map(|i| (0..columns - 1).map(move |j| i * columns + j));
        let diagonal = steps.map(|at| apart(at, at + columns + 1).max(apart(at + 1, at + columns)));
        // half a diagonal, and half of that again for what lies beside the chord
        let reach = 0.75 * diagonal.fold(0.0, f64::max);
        let mut parts = Vec::new();
        cut(&points, [0, rows], [0, columns], &mut parts);
        Obstacle { surface, points, parts, reach }
    }

    /// The shares of one of the points.
    fn shares(&self, point: usize) -> [f64; 2] {
        let [rows, columns] = POINTS;
        [(point / columns) as f64 / (rows - 1) as f64, (point % columns) as f64 / (columns - 1) as f64]
    }

    /// The point of a part that is nearest to a body, if it is nearer than the best one so far.
    fn nearest_in(&self, part: &Part, distance: &dyn Fn(usize) -> f64, best: &mut (f64, usize)) {
        let Some(halves) = part.halves else {
            for row in part.rows[0]..part.rows[1] {
                for point in row * POINTS[1] + part.columns[0]..row * POINTS[1] + part.columns[1] {
                    let here = distance(point);
                    if here < best.0 {
                        *best = (here, point);
                    }
                }
            }
            return;
        };
        // a distance changes by no more than the point moves
        let mut halves = halves.map(|half| {
            let half = &self.parts[half];
            (distance(half.middle) - half.radius, half)
        });
        if halves[1].0 < halves[0].0 {
            halves.swap(0, 1);
        }
        for (least, half) in halves {
            if least < best.0 {
                self.nearest_in(half, distance, best);
            }
        }
    }

    /// The points that are looked at first.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// What no place is nearer than; of what is farther than `limit`, any bound above that.
    pub(crate) fn bound(&self, shape: &Shape, pose: &[f64; 6], limit: f64) -> f64 {
        let distance = |point: usize| shape.distance(pose, self.points[point]);
        let whole = &self.parts[0];
        let far = distance(whole.middle) - whole.radius - self.reach;
        if far >= limit {
            return far;
        }
        let mut best = (limit + self.reach, 0);
        self.nearest_in(whole, &distance, &mut best);
        best.0 - self.reach
    }

    /// The place that is nearest to a body at a pose; `None` if none can be nearer than `limit`.
    pub fn nearest(&self, body: &ToolBody, pose: &[f64; 6], limit: f64) -> Option<Nearest> {
        let shape = body.shape();
        let Nearest { distance: coarse, shares: start } = self.nearest_point(&shape, pose, limit)?;
        let found = self.solved(&|point| shape.distance(pose, point), start);
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
        let coarse = |k: usize| (0..POINTS[k]).step_by(COARSE);
        let some = coarse(0).flat_map(|i| coarse(1).map(move |j| i * POINTS[1] + j));
        let radii = some.map(|point| (radius(self.points[point]), self.shares(point)));
        let (coarse, start) = radii.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(radius, _)| radius.is_finite())?;
        let found = self.solved(&radius, start);
        Some(if found.distance <= coarse { found } else { Nearest { distance: coarse, shares: start } })
    }

    /// The least value over the surface from a start.
    fn solved(&self, value: &dyn Fn([f64; 3]) -> f64, at: [f64; 2]) -> Nearest {
        least_value(&self.surface, value, at)
    }

    /// The nearest of the points that are looked at first, mm and shares; `None` if no place can be nearer than `limit`.
    pub(super) fn nearest_point(&self, shape: &Shape, pose: &[f64; 6], limit: f64) -> Option<Nearest> {
        let distance = |point: usize| shape.distance(pose, self.points[point]);
        let mut best = (limit + self.reach, usize::MAX);
        self.nearest_in(&self.parts[0], &distance, &mut best);
        (best.1 != usize::MAX).then(|| Nearest { distance: best.0, shares: self.shares(best.1) })
    }

    /// The nearest place to a body, from a start.
    pub(super) fn nearest_from(&self, shape: &Shape, pose: &[f64; 6], start: [f64; 2]) -> Nearest {
        self.solved(&|point| shape.distance(pose, point), start)
    }

    /// What no place of the surface is nearer than, at a glance.
    pub(super) fn far(&self, shape: &Shape, pose: &[f64; 6]) -> f64 {
        let whole = &self.parts[0];
        shape.distance(pose, self.points[whole.middle]) - whole.radius - self.reach
    }
}

/// A surface over two shares.
pub(super) trait Positions {
    /// The position at shares, mm.
    fn position(&self, shares: [f64; 2]) -> [f64; 3];

    /// The positions so far before shares, at them, and so far behind, across the passes and along them.
    fn around(&self, shares: [f64; 2], apart: f64) -> [[[f64; 3]; 3]; 3];
}

impl Positions for PoseField {
    fn position(&self, shares: [f64; 2]) -> [f64; 3] {
        PoseField::position(self, shares)
    }

    fn around(&self, shares: [f64; 2], apart: f64) -> [[[f64; 3]; 3]; 3] {
        PoseField::around(self, shares, apart)
    }
}

/// Newton's method for the least value over a surface from a start, within the surface's ends.
pub(super) fn least_value(surface: &impl Positions, value: &dyn Fn([f64; 3]) -> f64, mut at: [f64; 2]) -> Nearest {
    let distance = |shares: [f64; 2]| value(surface.position(shares));
    let mut here = distance(at);
    for _ in 0..MOST_STEPS {
        let [[a, w, b], [s, _, n], [c, e, d]] = surface.around(at, APART).map(|row| row.map(value));
        let (g, h) = ([0.5 * (e - w), 0.5 * (n - s)], [e - 2.0 * here + w, n - 2.0 * here + s]);
        let mixed = 0.25 * (d - c - b + a);
        let next = stepped(at, g, h, mixed);
        let mut share = 1.0;
        let mut taken = None;
        let whole = (next[0] - at[0]).abs().max((next[1] - at[1]).abs());
        // shorter until it is lower
        while share * whole >= SHORTEST {
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

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Adds a part with all parts of it, and says where it stands.
fn cut(points: &[[f64; 3]], rows: [usize; 2], columns: [usize; 2], parts: &mut Vec<Part>) -> usize {
    let middle = (rows[0] + rows[1]) / 2 * POINTS[1] + (columns[0] + columns[1]) / 2;
    let all = (rows[0]..rows[1]).flat_map(|i| (columns[0]..columns[1]).map(move |j| i * POINTS[1] + j));
    let radius = all.map(|point| apart(points[point], points[middle])).fold(0.0, f64::max);
    let number = parts.len();
    parts.push(Part { middle, radius, rows, columns, halves: None });
    let [high, wide] = [rows[1] - rows[0], columns[1] - columns[0]];
    if high > FEW || wide > FEW {
        let between = |[from, to]: [usize; 2]| (from + to) / 2;
        let halves = if wide > high {
            let at = between(columns);
            [[columns[0], at], [at, columns[1]]].map(|columns| cut(points, rows, columns, parts))
        } else {
            let at = between(rows);
            [[rows[0], at], [at, rows[1]]].map(|rows| cut(points, rows, columns, parts))
        };
        parts[number].halves = Some(halves);
    }
    number
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

//! How high over a point of a surface a moving cutter passes.

use nalgebra::Vector3;

use crate::milling::outline::{Cutter, CutterArc, OutlinePiece, StraightSide};
use crate::milling::series::{Moving, PoseSeries};

/// Newton's steps at the most.
const MOST_STEPS: u32 = 60;
/// Two steps in a row below this, mm and shares, end them.
const CLOSE: f64 = 1e-14;
/// A residual up to this counts as met, mm² or mm² per share.
const MET: f64 = 1e-9;

/// A point of a surface and the unit vector out of its body there.
pub type NormalLine = [f64; 6];

/// Where a cutter on its way is lowest over a point of a surface, on the normal there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lowest {
    /// How high, mm; negative where it cuts into the surface.
    pub height: f64,
    /// At which share of the way.
    pub share: f64,
    /// Whether it is lowest there, and not only where the way ends.
    pub is_within: bool,
}

/// The lowest of a cutter on a way over a point, near a share; `None` if it does not pass there.
pub fn lowest(way: &PoseSeries, cutter: &Cutter, line: &NormalLine, near: f64) -> Option<Lowest> {
    let each = cutter.pieces.iter().filter_map(|piece| of_piece(way, piece, line, near));
    each.min_by(|a, b| a.height.total_cmp(&b.height))
}

/// A function of the share u and the height h, with its derivatives.
#[derive(Clone, Copy)]
struct Jet {
    v: f64,
    u: f64,
    h: f64,
    uu: f64,
    uh: f64,
}

impl Jet {
    fn plus(self, other: Jet, by: f64) -> Jet {
        Jet {
            v: self.v + by * other.v,
            u: self.u + by * other.u,
            h: self.h + by * other.h,
            uu: self.uu + by * other.uu,
            uh: self.uh + by * other.uh,
        }
    }

    fn less(self, constant: f64) -> Jet {
        Jet { v: self.v - constant, ..self }
    }

    fn square(self) -> Jet {
        Jet {
            v: self.v * self.v,
            u: 2.0 * self.v * self.u,
            h: 2.0 * self.v * self.h,
            uu: 2.0 * (self.u * self.u + self.v * self.uu),
            uh: 2.0 * (self.h * self.u + self.v * self.uh),
        }
    }

    fn sqrt(self) -> Jet {
        let root = self.v.max(0.0).sqrt();
        let cube = 4.0 * root * root * root;
        Jet {
            v: root,
            u: self.u / (2.0 * root),
            h: self.h / (2.0 * root),
            uu: self.uu / (2.0 * root) - self.u * self.u / cube,
            uh: self.uh / (2.0 * root) - self.u * self.h / cube,
        }
    }
}

/// The point at a height on the normal, as the moving cutter sees it: its height above the tool's origin, and the square of its distance from
/// the axis.
fn seen(moving: &Moving, line: &NormalLine, h: f64) -> [Jet; 2] {
    let part = |row: &[f64; 6], from: usize| Vector3::new(row[from], row[from + 1], row[from + 2]);
    let normal = part(line, 3);
    let [y, y1, y2] = [part(line, 0) + normal * h - part(&moving[0], 0), -part(&moving[1], 0), -part(&moving[2], 0)];
    let [a, a1, a2] = [0, 1, 2].map(|k| part(&moving[k], 3));
    let z = Jet {
        v: y.dot(&a),
        u: y1.dot(&a) + y.dot(&a1),
        h: normal.dot(&a),
        uu: y2.dot(&a) + 2.0 * y1.dot(&a1) + y.dot(&a2),
        uh: normal.dot(&a1),
    };
    let away = Jet {
        v: y.dot(&y),
        u: 2.0 * y.dot(&y1),
        h: 2.0 * y.dot(&normal),
        uu: 2.0 * (y1.dot(&y1) + y.dot(&y2)),
        uh: 2.0 * y1.dot(&normal),
    };
    [z, away.plus(z.square(), -1.0)]
}

/// The square of the distance from the circle about which an arc turns.
fn from_circle([z, q]: [Jet; 2], arc: CutterArc) -> Jet {
    let round = q.plus(z.less(arc.z).square(), 1.0);
    if arc.rho == 0.0 { round } else { round.plus(q.sqrt(), -2.0 * arc.rho).less(-arc.rho * arc.rho) }
}

/// A straight piece: the normal out of the body, and both ends.
#[derive(Clone, Copy)]
struct Side {
    normal: [f64; 2],
    from: [f64; 2],
    along: [f64; 2],
}

impl Side {
    /// The body lies on the left of the way from `from` to `to`.
    fn new(from: [f64; 2], to: [f64; 2]) -> Side {
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        Side { normal: [along[1] / length, -along[0] / length], from, along }
    }

    /// The distance from the line, turned about the axis.
    fn distance(self, [z, q]: [Jet; 2]) -> Jet {
        let [out, up] = self.normal;
        let height = Jet { v: 0.0, u: 0.0, h: 0.0, uu: 0.0, uh: 0.0 }.plus(z, up);
        let both = if out == 0.0 { height } else { height.plus(q.sqrt(), out) };
        both.less(out * self.from[0] + up * self.from[1])
    }

    fn has(self, [z, q]: [Jet; 2]) -> bool {
        let [out, up] = [q.v.max(0.0).sqrt() - self.from[0], z.v - self.from[1]];
        let square = self.along[0] * self.along[0] + self.along[1] * self.along[1];
        let share = (out * self.along[0] + up * self.along[1]) / square;
        (-1e-9..=1.0 + 1e-9).contains(&share)
    }
}

/// How the height at which a side is met on a line changes with each part of the pose, the place on the way being what it is.
pub(crate) fn slopes_of_side(side: &StraightSide, pose: &[f64; 6], line: &NormalLine, height: f64) -> [f64; 6] {
    let part = |row: &[f64; 6], from: usize| Vector3::new(row[from], row[from + 1], row[from + 2]);
    let (normal, axis) = (part(line, 3), part(pose, 3));
    let y = part(line, 0) + normal * height - part(pose, 0);
    let z = y.dot(&axis);
    let (sine, cosine) = side.half_angle.sin_cos();
    let out = cosine / (y.norm_squared() - z * z).max(0.0).sqrt();
    let by_tip = (y - axis * z) * -out + axis * sine;
    let by_axis = y * (-out * z - sine);
    let by_height = -by_tip.dot(&normal);
    let slope = |k: usize| if k < 3 { by_tip[k] } else { by_axis[k - 3] };
    [0, 1, 2, 3, 4, 5].map(|k| -slope(k) / by_height)
}

/// The lowest of one piece, if it has that point and the normal enters the body there.
fn of_piece(way: &PoseSeries, piece: &OutlinePiece, line: &NormalLine, near: f64) -> Option<Lowest> {
    match CutterArc::of_piece(piece) {
        Ok(arc) if arc.radius == 0.0 => of_edge(way, arc, line, near),
        Ok(arc) => {
            let square = arc.radius * arc.radius;
            let has = |seen: [Jet; 2]| arc.has((seen[1].v.max(0.0).sqrt() - arc.rho).atan2(arc.z - seen[0].v));
            of_surface(way, line, near, |seen| from_circle(seen, arc).less(square), has)
        }
        Err([from, to]) => {
            let side = Side::new(from, to);
            of_surface(way, line, near, |seen| side.distance(seen), |seen| side.has(seen))
        }
    }
}

/// A surface is met, and at a height that is least as a function of the share.
fn of_surface(
    way: &PoseSeries,
    line: &NormalLine,
    near: f64,
    off: impl Fn([Jet; 2]) -> Jet,
    has: impl Fn([Jet; 2]) -> bool,
) -> Option<Lowest> {
    let at = |u: f64, h: f64| seen(&way.moving(u), line, h);
    let within = newton(near, |u, h| {
        let jet = off(at(u, h));
        ([jet.v, jet.u], [[jet.u, jet.h], [jet.uu, jet.uh]])
    });
    let found = within.filter(|found| (0.0..=1.0).contains(&found.share)).or_else(|| {
        // the way ends before
        let end = if within.map_or(near, |found| found.share) < 0.5 { 0.0 } else { 1.0 };
        at_end(way, line, end, &off)
    });
    found.filter(|found| {
        let seen = at(found.share, found.height);
        off(seen).h < 0.0 && has(seen)
    })
}

/// The line meets the edge's circle: its distance from the axis and its height are those of the edge.
fn of_edge(way: &PoseSeries, arc: CutterArc, line: &NormalLine, near: f64) -> Option<Lowest> {
    let found = newton(near, |u, h| {
        let [z, q] = seen(&way.moving(u), line, h);
        ([q.v - arc.rho * arc.rho, z.v - arc.z], [[q.u, q.h], [z.u, z.h]])
    });
    found.filter(|found| (0.0..=1.0).contains(&found.share))
}

/// A cutter that stands still at an end of its way.
fn at_end(way: &PoseSeries, line: &NormalLine, end: f64, off: &impl Fn([Jet; 2]) -> Jet) -> Option<Lowest> {
    let moving = way.moving(end);
    let mut h = 0.0;
    for _ in 0..MOST_STEPS {
        let jet = off(seen(&moving, line, h));
        let step = jet.v / jet.h;
        h -= step;
        if !h.is_finite() {
            return None;
        }
        if step.abs() < CLOSE * (1.0 + h.abs()) {
            break;
        }
    }
    let missed = off(seen(&moving, line, h)).v.abs();
    (missed < MET).then_some(Lowest { height: h, share: end, is_within: false })
}

/// Newton's method for share and height, the height being zero at first. Shares go a little beyond both ends at the most.
fn newton(near: f64, equations: impl Fn(f64, f64) -> ([f64; 2], [[f64; 2]; 2])) -> Option<Lowest> {
    const FARTHEST: f64 = 0.5;
    let (mut u, mut h, mut close) = (near, 0.0, 0);
    for _ in 0..MOST_STEPS {
        let ([f, g], [[a, b], [c, d]]) = equations(u, h);
        let whole = a * d - b * c;
        let (du, dh) = ((f * d - b * g) / whole, (a * g - f * c) / whole);
        let shorter = (0.25 / du.abs()).min(1.0);
        u -= shorter * du;
        h -= shorter * dh;
        if !(u.is_finite() && h.is_finite()) {
            return None;
        }
        if !(-FARTHEST..=1.0 + FARTHEST).contains(&u) {
            return Some(Lowest { height: h, share: u, is_within: false });
        }
        close = if du.abs() < CLOSE.sqrt() && dh.abs() < CLOSE * (1.0 + h.abs()) { close + 1 } else { 0 };
        if close == 2 {
            break;
        }
    }
    let ([f, g], _) = equations(u, h);
    (f.abs() < MET && g.abs() < MET * 1e3).then_some(Lowest { height: h, share: u, is_within: true })
}

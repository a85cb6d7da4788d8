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
/// Places of a way that are looked at for a start.
const STARTS: u32 = 9;
/// How far beyond the ends of a way a share counts as on it: rounding.
const ON_END: f64 = 1e-9;

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

/// The same where it is above `enough`, mm, else the height at which one of its pieces passes that is not.
pub(crate) fn lowest_until(
    way: &PoseSeries,
    cutter: &Cutter,
    line: &NormalLine,
    near: f64,
    enough: f64,
) -> Option<Lowest> {
    let mut best: Option<Lowest> = None;
    for piece in &cutter.pieces {
        let found = of_piece(way, piece, line, near);
        best = best.into_iter().chain(found).min_by(|a, b| a.height.total_cmp(&b.height));
        if best.is_some_and(|best| best.height <= enough) {
            break;
        }
    }
    best
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
    let is_entered = |found: &Lowest| {
        let seen = at(found.share, found.height);
        off(seen).h < 0.0 && has(seen)
    };
    let end = |end: f64| at_end(way, line, end, &off).filter(is_entered);
    let from = |near: f64| {
        let found = newton([near, 0.0], |u, h| {
            let jet = off(at(u, h));
            ([jet.v, jet.u], [[jet.u, jet.h], [jet.uu, jet.uh]])
        })?;
        match (0.0..=1.0).contains(&found.share) {
            true => Some(found).filter(is_entered),
            // the way ends before
            false => end(if found.share < 0.5 { 0.0 } else { 1.0 }),
        }
    };
    // within the way it may also be highest, and beside an end it may be lower
    let is_low = |found: &Lowest| {
        let jet = off(at(found.share, found.height));
        if found.is_within { jet.uu > 0.0 } else { jet.u * (1.0 - 2.0 * found.share) >= 0.0 }
    };
    let first = from(near);
    first.filter(is_low).or_else(|| {
        // on a way that is long against the cutter, where it comes nearest to the point
        let off = |share: &f64| off(at(*share, 0.0)).v;
        let places = (0..STARTS).map(|k| f64::from(k) / f64::from(STARTS - 1));
        let again = places.min_by(|a, b| off(a).total_cmp(&off(b))).and_then(from);
        let all = [first, again, end(0.0), end(1.0)];
        all.into_iter().flatten().min_by(|a, b| a.height.total_cmp(&b.height))
    })
}

/// An edge, and the plane bottom within it: the line enters the cutter where it meets the edge's circle, or through the bottom.
///
/// A moving circle meets a line twice, with the front and with the heel. Over the point in question the bottom is lowest where the line comes
/// under it: of both that is the one from which on the bottom rises while the line stays under it.
fn of_edge(way: &PoseSeries, arc: CutterArc, line: &NormalLine, near: f64) -> Option<Lowest> {
    let circle = |u: f64, h: f64| {
        let [z, q] = seen(&way.moving(u), line, h);
        ([q.v - arc.rho * arc.rho, z.v - arc.z], [[q.u, q.h], [z.u, z.h]])
    };
    let is_entered = |found: &Lowest| {
        let (_, [[qu, qh], [zu, zh]]) = circle(found.share, found.height);
        // the bottom keeps its height on the way (z_h, -z_u) of share and height
        (qu * zh - qh * zu) * zu > 0.0
    };
    let bottom = |u: f64| Bottom::at(way, arc, line, u);
    let first = newton([near, 0.0], circle);
    let from = first.map_or(near, |found| found.share.clamp(0.0, 1.0));
    // the other place lies as far from where the line is nearest to the axis
    let opposite = bottom(from).and_then(|at| bottom(from + at.to_other())).and_then(|at| newton([at.u, at.h], circle));
    let on_edge = [first, opposite].into_iter().flatten().filter(|found| is_on_way(found.share) && is_entered(found));
    let ends = [0.0, 1.0].map(bottom);
    let under = ends.into_iter().flatten().filter(|at| at.off < 0.0);
    let under = under.map(|at| Lowest { height: at.h, share: at.u, is_within: false });
    let touched = match ends {
        [Some(a), Some(b)] if a.rises < 0.0 && b.rises > 0.0 => lowest_bottom(bottom).filter(|at| at.off < 0.0),
        _ => None,
    };
    let touched = touched.map(|at| Lowest { height: at.h, share: at.u, is_within: true });
    on_edge.chain(under).chain(touched).min_by(|a, b| a.height.total_cmp(&b.height))
}

/// The plane of an edge where a line meets it, at a share of the way.
#[derive(Clone, Copy)]
struct Bottom {
    u: f64,
    /// The height on the line, and how it changes with the share.
    h: f64,
    rises: f64,
    /// The square of the distance from the axis less that of the edge, with its derivatives by the share.
    off: f64,
    off_1: f64,
    off_2: f64,
}

impl Bottom {
    /// `None` where the bottom does not face the surface.
    fn at(way: &PoseSeries, arc: CutterArc, line: &NormalLine, u: f64) -> Option<Bottom> {
        let part = |row: &[f64; 6], from: usize| Vector3::new(row[from], row[from + 1], row[from + 2]);
        let (moving, normal) = (way.moving(u), part(line, 3));
        let [w, w1, w2] = [part(&moving[0], 0) - part(line, 0), part(&moving[1], 0), part(&moving[2], 0)];
        let [a, a1, a2] = [0, 1, 2].map(|k| part(&moving[k], 3));
        let [faces, faces_1, faces_2] = [a, a1, a2].map(|a| normal.dot(&a));
        let h = (w.dot(&a) + arc.z) / faces;
        let h1 = (w1.dot(&a) + w.dot(&a1) - h * faces_1) / faces;
        let h2 = (w2.dot(&a) + 2.0 * w1.dot(&a1) + w.dot(&a2) - 2.0 * h1 * faces_1 - h * faces_2) / faces;
        let [y, y1, y2] = [normal * h - w, normal * h1 - w1, normal * h2 - w2];
        let found = Bottom {
            u,
            h,
            rises: h1,
            off: y.norm_squared() - arc.z * arc.z - arc.rho * arc.rho,
            off_1: 2.0 * y.dot(&y1),
            off_2: 2.0 * (y1.norm_squared() + y.dot(&y2)),
        };
        (faces > 0.0 && h.is_finite() && h1.is_finite() && h2.is_finite()).then_some(found)
    }

    /// How far on the way the line meets the circle the other time, if it meets it here.
    fn to_other(self) -> f64 {
        (-2.0 * self.off_1 / self.off_2).clamp(-2.0, 2.0)
    }
}

/// Where the bottom falls before and rises behind.
fn lowest_bottom(bottom: impl Fn(f64) -> Option<Bottom>) -> Option<Bottom> {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..MOST_STEPS {
        let middle = bottom(0.5 * (low + high))?;
        if middle.rises < 0.0 {
            low = middle.u;
        } else {
            high = middle.u;
        }
    }
    bottom(0.5 * (low + high))
}

/// Whether a share is one of the way: rounding does not end it.
fn is_on_way(share: f64) -> bool {
    (-ON_END..=1.0 + ON_END).contains(&share)
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

/// Newton's method for share and height from a start. Shares go a little beyond both ends at the most.
fn newton([near, height]: [f64; 2], equations: impl Fn(f64, f64) -> ([f64; 2], [[f64; 2]; 2])) -> Option<Lowest> {
    const FARTHEST: f64 = 0.5;
    let (mut u, mut h, mut close) = (near, height, 0);
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

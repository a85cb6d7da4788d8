//! The outline of a cutter of revolution: arcs and lines in the half plane of its axis.

use std::f64::consts::FRAC_PI_2;

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};

use crate::equations::solution::Range;

/// How far a point may be off a line or circle that it lies on, or an outline off its turned one, mm: rounding of a chain of transforms.
const SAME: f64 = 1e-9;
/// How far the direction of a normal may lie beyond the ends of an arc, radians: rounding.
const ON_END: f64 = 1e-9;
/// A line that opens farther than this to its height is a face and no side: the tangent of some 80 degrees.
const STEEP: f64 = 6.0;
/// A side is thought to go on beyond each end by this many of its lengths ...
const LENGTHENED: f64 = 4.0;
/// ... or by this share of the way to the axis.
const NEAR_AXIS: f64 = 0.8;
/// Two pieces that meet under a smaller angle than this, radians, have no corner: rounding.
const CORNER: f64 = 1e-6;
/// Points of a piece that are looked at.
const LOOKED_AT: usize = 9;

/// A piece of an outline: distance from the axis and height above the tool's origin towards the spindle, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutlinePiece {
    /// An arc with the body on the side of its centre; an edge is one of radius zero.
    Arc {
        /// Its centre; left of the axis for a barrel.
        center: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Between which angles its normal out of the body lies, from the direction away from the spindle to the outside.
        between: [f64; 2],
    },
    /// A straight piece, with the body on the left of the way from one end to the other.
    Line {
        /// One end.
        from: [f64; 2],
        /// The other end.
        to: [f64; 2],
    },
}

/// Why a surface of a tool is no piece of an outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoOutline {
    /// It is not turned about the axis.
    #[error("it is no surface of revolution about the z axis of its frame")]
    NotTurned,
    /// It is neither a line nor an arc.
    #[error("its outline is neither a line nor an arc")]
    NotAnArc,
    /// The body lies outside the arc.
    #[error("it is hollow: its body lies outside the arc")]
    Hollow,
}

impl OutlinePiece {
    /// Its ends from below upwards, each with the angle of its normal from the direction away from the spindle.
    fn ends(&self) -> [([f64; 2], f64); 2] {
        match *self {
            OutlinePiece::Arc { center, radius, between } => {
                between.map(|angle| ([center[0] + radius * angle.sin(), center[1] - radius * angle.cos()], angle))
            }
            OutlinePiece::Line { from, to } => {
                // the body lies on the left
                let angle = (to[1] - from[1]).atan2(to[0] - from[0]);
                [(from, angle), (to, angle)]
            }
        }
    }

    /// Of a surface of a tool, whose frame has z out of the spindle: its position in one parameter (an edge) or two, with their ranges;
    /// `normal` out of the body, of a surface.
    ///
    /// # Errors
    /// If something in it has no value.
    pub fn of_tool<'g>(
        position: Vector3<'g>,
        normal: Option<Vector3<'g>>,
        parameters: &[Expr<'g>],
        ranges: &[Range],
    ) -> Result<Result<OutlinePiece, NoOutline>, TapeError> {
        let outputs: Vec<Expr<'g>> = position.0.into_iter().chain(normal.into_iter().flat_map(|n| n.0)).collect();
        let tape = Tape::new(&outputs, parameters)?;
        let at = |shares: &[f64]| {
            let inputs: Vec<f64> =
                ranges.iter().zip(shares).map(|(range, s)| range.low + s * (range.high - range.low)).collect();
            let mut out = vec![0.0; outputs.len()];
            ScalarEvaluator::new(&tape).run(&inputs, &mut out);
            out
        };
        let meridian = |out: &[f64]| [out[0].hypot(out[1]), -out[2]];
        if parameters.len() == 1 {
            return Ok(edge([0.0, 0.37, 0.71, 1.0].map(|s| meridian(&at(&[s])))));
        }
        let differs = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) > SAME;
        let runs_along = |turn: usize| {
            [0.1, 0.5, 0.9].iter().all(|run| {
                let place = |s: f64| if turn == 1 { [*run, s] } else { [s, *run] };
                let first = meridian(&at(&place(0.0)));
                [0.3, 0.6, 1.0].iter().all(|s| !differs(first, meridian(&at(&place(*s)))))
            })
        };
        let Some(turn) = [1, 0].into_iter().find(|turn| runs_along(*turn)) else {
            return Ok(Err(NoOutline::NotTurned));
        };
        let points: Vec<Vec<f64>> = (0..LOOKED_AT)
            .map(|k| {
                let s = k as f64 / (LOOKED_AT - 1) as f64;
                at(&if turn == 1 { [s, 0.5] } else { [0.5, s] })
            })
            .collect();
        let places: Vec<[f64; 2]> = points.iter().map(|out| meridian(out)).collect();
        let middle = &points[LOOKED_AT / 2];
        let rho = middle[0].hypot(middle[1]);
        let outside = [(middle[3] * middle[0] + middle[4] * middle[1]) / rho, -middle[5]];
        Ok(piece(&places, outside))
    }
}

fn edge(points: [[f64; 2]; 4]) -> Result<OutlinePiece, NoOutline> {
    let [center, others @ ..] = points;
    let is_one = others.iter().all(|other| (other[0] - center[0]).abs().max((other[1] - center[1]).abs()) <= SAME);
    if !is_one {
        return Err(NoOutline::NotTurned);
    }
    // a sharp edge touches with whatever normal its body leaves room for
    Ok(OutlinePiece::Arc { center, radius: 0.0, between: [0.0, FRAC_PI_2] })
}

/// The line or arc through points, `outside` the normal out of the body in the middle.
fn piece(points: &[[f64; 2]], outside: [f64; 2]) -> Result<OutlinePiece, NoOutline> {
    let (from, middle, to) = (points[0], points[points.len() / 2], points[points.len() - 1]);
    let chord = [to[0] - from[0], to[1] - from[1]];
    let length = chord[0].hypot(chord[1]);
    let off = |p: &[f64; 2]| ((p[0] - from[0]) * chord[1] - (p[1] - from[1]) * chord[0]) / length;
    if points.iter().all(|point| off(point).abs() <= SAME) {
        let is_left = off(&[middle[0] + outside[0], middle[1] + outside[1]]) > 0.0;
        return Ok(if is_left { OutlinePiece::Line { from, to } } else { OutlinePiece::Line { from: to, to: from } });
    }
    let center = on_axis(center_of([from, middle, to]));
    let radius = (middle[0] - center[0]).hypot(middle[1] - center[1]);
    let is_off = |p: &[f64; 2]| ((p[0] - center[0]).hypot(p[1] - center[1]) - radius).abs() > SAME;
    if points.iter().any(is_off) {
        return Err(NoOutline::NotAnArc);
    }
    if outside[0] * (middle[0] - center[0]) + outside[1] * (middle[1] - center[1]) < 0.0 {
        return Err(NoOutline::Hollow);
    }
    let angle = |p: [f64; 2]| (p[0] - center[0]).atan2(center[1] - p[1]);
    let [a, b] = [angle(from), angle(to)];
    Ok(OutlinePiece::Arc { center, radius, between: [a.min(b), a.max(b)] })
}

/// A centre that rounding alone keeps off the axis lies on it: the arc is that of a ball, which has no bottom and touches with its tip.
fn on_axis([rho, z]: [f64; 2]) -> [f64; 2] {
    [if rho.abs() <= SAME { 0.0 } else { rho }, z]
}

fn center_of([a, b, c]: [[f64; 2]; 3]) -> [f64; 2] {
    let [p, q] = [b, c].map(|other| [other[0] - a[0], other[1] - a[1]]);
    let [pp, qq] = [p, q].map(|v| v[0] * v[0] + v[1] * v[1]);
    let twice = 2.0 * (p[0] * q[1] - p[1] * q[0]);
    [a[0] + (q[1] * pp - p[1] * qq) / twice, a[1] + (p[0] * qq - q[0] * pp) / twice]
}

/// The cutting part of a cutter.
#[derive(Clone, Debug, PartialEq)]
pub struct Cutter {
    /// Its pieces.
    pub pieces: Vec<OutlinePiece>,
}

/// An arc of a cutter, with the rest of the tool left away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CutterArc {
    /// The distance of its centre from the axis.
    pub(crate) rho: f64,
    /// The height of its centre.
    pub(crate) z: f64,
    /// Its radius.
    pub(crate) radius: f64,
    between: [f64; 2],
}

/// A straight side of a cutter, which may lie along a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightSide {
    /// The angle between its lines and the axis, radians: positive where it opens towards the spindle.
    pub half_angle: f64,
    /// The height of its lower and its upper end above the tool's origin, mm.
    pub heights: [f64; 2],
    /// The distance of its lower end from the axis, mm.
    pub radius: f64,
}

impl StraightSide {
    /// Of a piece that is one: a line that faces away from the axis.
    fn of_piece(piece: &OutlinePiece) -> Option<StraightSide> {
        let OutlinePiece::Line { from, to } = *piece else { return None };
        let [out, up] = [to[0] - from[0], to[1] - from[1]];
        // the body lies on the left: a side runs upwards
        (up > 0.0 && out.abs() < STEEP * up).then(|| StraightSide {
            half_angle: out.atan2(up),
            heights: [from[1], to[1]],
            radius: from[0],
        })
    }

    /// The distance from the axis at a height, mm.
    pub fn radius_at(&self, height: f64) -> f64 {
        self.radius + (height - self.heights[0]) * self.half_angle.tan()
    }

    /// How long its lines are, mm.
    pub fn length(&self) -> f64 {
        (self.heights[1] - self.heights[0]) / self.half_angle.cos()
    }

    /// As a piece of an outline.
    pub fn piece(&self) -> OutlinePiece {
        let end = |k: usize| [self.radius_at(self.heights[k]), self.heights[k]];
        OutlinePiece::Line { from: end(0), to: end(1) }
    }

    /// The same lines beyond both ends, by some of their length, as far as they keep away from the axis.
    pub(crate) fn lengthened(&self) -> StraightSide {
        let (slope, by) = (self.half_angle.tan(), LENGTHENED * self.length());
        let to_axis = |from: f64, radius: f64| if from * slope > 0.0 { NEAR_AXIS * radius / slope.abs() } else { by };
        let [low, high] = self.heights;
        let low = low - by.min(to_axis(1.0, self.radius));
        let high = high + by.min(to_axis(-1.0, self.radius_at(high)));
        StraightSide { heights: [low, high], radius: self.radius_at(low), ..*self }
    }

    /// The angle of its normal from the direction away from the spindle, radians.
    fn angle(&self) -> f64 {
        FRAC_PI_2 - self.half_angle
    }

    /// Its middle, as what touches there.
    fn middle(&self) -> CutterArc {
        let height = 0.5 * (self.heights[0] + self.heights[1]);
        CutterArc { rho: self.radius_at(height), z: height, radius: 0.0, between: [self.angle(); 2] }
    }
}

impl CutterArc {
    /// Of a piece that is one; of a line its ends.
    pub(crate) fn of_piece(piece: &OutlinePiece) -> Result<CutterArc, [[f64; 2]; 2]> {
        match *piece {
            OutlinePiece::Arc { center, radius, between } => {
                Ok(CutterArc { rho: center[0], z: center[1], radius, between })
            }
            OutlinePiece::Line { from, to } => Err([from, to]),
        }
    }

    /// Whether its normal may have this angle.
    pub(crate) fn has(&self, angle: f64) -> bool {
        angle >= self.between[0] - ON_END && angle <= self.between[1] + ON_END
    }
}

impl Cutter {
    /// The same with an edge in each corner in which two of its pieces meet.
    pub fn with_edges(mut self) -> Cutter {
        let ends: Vec<[([f64; 2], f64); 2]> = self.pieces.iter().map(OutlinePiece::ends).collect();
        let corner = |[_, (end, before)]: &[([f64; 2], f64); 2], [(start, after), _]: &[([f64; 2], f64); 2]| {
            let is_one = (end[0] - start[0]).abs().max((end[1] - start[1]).abs()) <= SAME;
            (is_one && after - before > CORNER).then_some(OutlinePiece::Arc {
                center: *end,
                radius: 0.0,
                between: [*before, *after],
            })
        };
        let edges = ends.iter().flat_map(|one| ends.iter().filter_map(move |other| corner(one, other)));
        self.pieces.extend(edges.collect::<Vec<_>>());
        self
    }

    /// Its arcs and edges: what can touch a surface in a point.
    fn arcs(&self) -> impl Iterator<Item = CutterArc> + '_ {
        self.pieces.iter().filter_map(|piece| CutterArc::of_piece(piece).ok())
    }

    fn sides(&self) -> impl Iterator<Item = StraightSide> + '_ {
        self.pieces.iter().filter_map(StraightSide::of_piece)
    }

    /// Its longest straight side.
    pub fn side(&self) -> Option<StraightSide> {
        self.sides().max_by(|a, b| a.length().total_cmp(&b.length()))
    }

    /// What touches a surface whose normal has an angle from the direction away from the spindle: a side in its middle, else an arc.
    pub(crate) fn touching(&self, angle: f64) -> Option<Touching> {
        let side = self.sides().find(|side| (side.angle() - angle).abs() <= ON_END);
        let of_side = side.map(|side| Touching { arc: side.middle(), bend_radius: f64::INFINITY });
        of_side.or_else(|| {
            let arc = self.arcs().find(|arc| arc.has(angle))?;
            Some(Touching { arc, bend_radius: arc.radius })
        })
    }

    /// Between which angles the normals of its arcs and sides lie, radians from the direction away from the spindle; `None` without any.
    pub fn angles(&self) -> Option<[f64; 2]> {
        let sides = self.sides().map(|side| [side.angle(); 2]);
        let all = self.arcs().map(|arc| arc.between).chain(sides);
        all.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// How far its arcs and sides reach from the origin, at the most, mm.
    pub fn reach(&self) -> f64 {
        let arcs = self.arcs().map(|arc| arc.rho.abs() + arc.radius + arc.z.abs());
        let sides = self.sides().flat_map(|side| side.heights.map(|height| side.radius_at(height) + height.abs()));
        arcs.chain(sides).fold(0.0, f64::max)
    }

    /// The distance of a point from the nearest of its arcs, each taken for a whole torus, and sides, where the cutter stands so, mm;
    /// negative inside.
    pub fn gap(&self, pose: &[f64; 6], point: [f64; 3]) -> f64 {
        let [rho, z] = meridian(pose, point);
        let arcs = self.arcs().map(|arc| (rho - arc.rho).hypot(z - arc.z) - arc.radius);
        let sides = self.sides().map(|side| {
            let (sine, cosine) = side.half_angle.sin_cos();
            let [out, up] = [rho - side.radius, z - side.heights[0]];
            let beside = out * cosine - up * sine;
            let along = out * sine + up * cosine;
            let beyond = (along - side.length()).max(-along);
            if beyond > 0.0 { beside.hypot(beyond) } else { beside }
        });
        arcs.chain(sides).fold(f64::INFINITY, f64::min)
    }
}

/// What of a cutter touches a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touching {
    pub(crate) arc: CutterArc,
    /// The radius of the outline there: zero at an edge, infinite on a straight side.
    pub(crate) bend_radius: f64,
}

/// A point as a cutter sees it: its distance from the axis and its height above the tool's origin, mm.
pub(crate) fn meridian(pose: &[f64; 6], point: [f64; 3]) -> [f64; 2] {
    let y = [0, 1, 2].map(|k| point[k] - pose[k]);
    let z = y[0] * pose[3] + y[1] * pose[4] + y[2] * pose[5];
    [(y[0] * y[0] + y[1] * y[1] + y[2] * y[2] - z * z).max(0.0).sqrt(), z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_line_or_an_arc_are_told_apart() {
        let arc: Vec<[f64; 2]> =
            (0..9).map(|k| f64::from(k) * 0.19).map(|a| [2.0 + 0.5 * a.sin(), 0.5 - 0.5 * a.cos()]).collect();
        let Ok(OutlinePiece::Arc { center, radius, between }) = piece(&arc, [0.6, -0.8]) else { panic!("an arc") };
        assert!((center[0] - 2.0).abs() < 1e-12 && (center[1] - 0.5).abs() < 1e-12 && (radius - 0.5).abs() < 1e-12);
        assert!(between[0].abs() < 1e-9 && (between[1] - 1.52).abs() < 1e-9, "{between:?}");
        assert_eq!(piece(&arc, [-0.6, 0.8]), Err(NoOutline::Hollow));
        let line: Vec<[f64; 2]> = (0..9).map(f64::from).map(|k| [3.0, k]).collect();
        let side = piece(&line, [1.0, 0.0]);
        assert_eq!(side, Ok(OutlinePiece::Line { from: [3.0, 0.0], to: [3.0, 8.0] }));
        let bow: Vec<[f64; 2]> = (0..9).map(f64::from).map(|k| [k * k * k * 0.01, k]).collect();
        assert_eq!(piece(&bow, [1.0, 0.0]), Err(NoOutline::NotAnArc));
    }

    #[test]
    fn a_corner_of_an_outline_is_an_edge() {
        let [bottom, side] =
            [[[0.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [2.0, 9.0]]].map(|[from, to]| OutlinePiece::Line { from, to });
        let edge = OutlinePiece::Arc { center: [2.0, 0.0], radius: 0.0, between: [0.0, FRAC_PI_2] };
        assert_eq!(Cutter { pieces: vec![bottom, side] }.with_edges().pieces, [bottom, side, edge]);
        // a rounded corner has none
        let round = OutlinePiece::Arc { center: [1.5, 0.5], radius: 0.5, between: [0.0, FRAC_PI_2] };
        let [bottom, side] =
            [[[0.0, 0.0], [1.5, 0.0]], [[2.0, 0.5], [2.0, 9.0]]].map(|[from, to]| OutlinePiece::Line { from, to });
        assert_eq!(Cutter { pieces: vec![bottom, round, side] }.with_edges().pieces, [bottom, round, side]);
    }

    #[test]
    fn the_arc_of_a_ball_has_its_centre_on_the_axis() {
        for radius in [0.3, 1.0, 2.7] {
            let arc: Vec<[f64; 2]> =
                (0..9).map(|k| f64::from(k) * 0.19).map(|a| [radius * a.sin(), radius - radius * a.cos()]).collect();
            let Ok(OutlinePiece::Arc { center, .. }) = piece(&arc, [0.6, -0.8]) else { panic!("an arc") };
            assert_eq!(center[0], 0.0, "{radius}");
        }
    }
}

//! How a body that lies anywhere on its machine is laid onto its place: by the motion that brings one of its spaces onto the next.

use flank_expr::Expr;
use flank_expr::geometry::Vector3;

use crate::equations::solution::{Outcome, Range};
use crate::surface::points::SurfacePoint;

/// The motion in which the place of a body is unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alignment {
    /// About the z axis, radians.
    #[default]
    Turn,
    /// Along y, mm: the spaces of a rack lie beside each other.
    Shift,
}

impl Alignment {
    /// A point that is moved by so much.
    #[must_use]
    pub fn moved(self, [x, y, z]: [f64; 3], by: f64) -> [f64; 3] {
        match self {
            Alignment::Turn => {
                let (sine, cosine) = by.sin_cos();
                [x * cosine - y * sine, x * sine + y * cosine, z]
            }
            Alignment::Shift => [x, y + by, z],
        }
    }

    /// A direction that is moved by so much.
    #[must_use]
    pub fn turned(self, direction: [f64; 3], by: f64) -> [f64; 3] {
        match self {
            Alignment::Turn => self.moved(direction, by),
            Alignment::Shift => direction,
        }
    }

    /// How far a point of a surface moves along its normal per unit of the motion, mm.
    #[must_use]
    pub fn lever(self, [x, y, _]: [f64; 3], [nx, ny, _]: [f64; 3]) -> f64 {
        match self {
            Alignment::Turn => x * ny - y * nx,
            Alignment::Shift => ny,
        }
    }

    /// How far a point moves per unit of the motion, mm.
    #[must_use]
    pub fn arc(self, [x, y, _]: [f64; 3]) -> f64 {
        match self {
            Alignment::Turn => x.hypot(y),
            Alignment::Shift => 1.0,
        }
    }

    /// The motion that brings one point beside another one, the shorter way round.
    #[must_use]
    pub fn apart(self, from: [f64; 3], to: [f64; 3]) -> f64 {
        match self {
            Alignment::Turn => {
                let apart = to[1].atan2(to[0]) - from[1].atan2(from[0]);
                apart - std::f64::consts::TAU * (apart / std::f64::consts::TAU).round()
            }
            Alignment::Shift => to[1] - from[1],
        }
    }

    /// The motion on average from measured points to nominal ones; `None` where no place has both.
    #[must_use]
    pub fn mean(self, measured: &[Option<[f64; 3]>], nominal: &[SurfacePoint]) -> Option<f64> {
        let pairs = measured.iter().zip(nominal).filter(|(_, point)| point.outcome == Outcome::Solved);
        let known = pairs.filter_map(|(measured, point)| Some(((*measured)?, point.position)));
        match self {
            Alignment::Turn => {
                let [sine, cosine] = known.fold([0.0; 2], |[sine, cosine], ([x, y, _], [to_x, to_y, _])| {
                    [sine + x * to_y - y * to_x, cosine + x * to_x + y * to_y]
                });
                (sine != 0.0 || cosine != 0.0).then(|| sine.atan2(cosine))
            }
            Alignment::Shift => {
                let [sum, count] =
                    known.fold([0.0; 2], |[sum, count], (from, to)| [sum + to[1] - from[1], count + 1.0]);
                (count > 0.0).then(|| sum / count)
            }
        }
    }

    /// Within which motions are looked for.
    pub(crate) fn range(self) -> Range {
        let most = match self {
            Alignment::Turn => std::f64::consts::TAU,
            Alignment::Shift => 1e5,
        };
        Range { low: -most, high: most }
    }

    /// A point that is moved by so much, in symbols.
    pub(crate) fn moved_by<'g>(self, Vector3([x, y, z]): Vector3<'g>, by: Expr<'g>) -> Vector3<'g> {
        match self {
            Alignment::Turn => Vector3([x * by.cos() - y * by.sin(), x * by.sin() + y * by.cos(), z]),
            Alignment::Shift => Vector3([x, y + by, z]),
        }
    }
}

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
            Alignment::Turn => self.shorter(to[1].atan2(to[0]) - from[1].atan2(from[0])),
            Alignment::Shift => to[1] - from[1],
        }
    }

    /// The motion from measured points to nominal ones that half of them exceed: one that lies far off does not take the others along.
    /// `None` where no place has both.
    #[must_use]
    pub fn median(self, measured: &[Option<[f64; 3]>], nominal: &[SurfacePoint]) -> Option<f64> {
        let pairs = measured.iter().zip(nominal).filter(|(_, point)| point.outcome == Outcome::Solved);
        let ways = pairs.filter_map(|(measured, point)| Some(self.apart((*measured)?, point.position)));
        let ways: Vec<f64> = ways.filter(|way| way.is_finite()).collect();
        let near = self.amid(&ways)?;
        let mut ways: Vec<f64> = ways.into_iter().map(|way| near + self.shorter(way - near)).collect();
        ways.sort_by(f64::total_cmp);
        let [low, high] = [(ways.len() - 1) / 2, ways.len() / 2].map(|k| ways[k]);
        Some(self.shorter(0.5 * (low + high)))
    }

    /// A motion that lies amid others, so that none of them is half a turn away unless they are all around.
    fn amid(self, ways: &[f64]) -> Option<f64> {
        let [sine, cosine] = match self {
            Alignment::Turn => ways.iter().fold([0.0; 2], |[s, c], way| [s + way.sin(), c + way.cos()]),
            Alignment::Shift => [0.0; 2],
        };
        (!ways.is_empty()).then(|| sine.atan2(cosine))
    }

    /// The same motion, the shorter way round.
    fn shorter(self, by: f64) -> f64 {
        match self {
            Alignment::Turn => by - std::f64::consts::TAU * (by / std::f64::consts::TAU).round(),
            Alignment::Shift => by,
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

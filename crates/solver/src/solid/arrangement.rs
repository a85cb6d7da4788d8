//! How tooth spaces follow each other: about an axis, or along a line.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::analysis::alignment::Alignment;

/// How the spaces of a body follow each other. Places of a body are `[z, rho, angle]` about the z axis, or `[z, x, y]` along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrangement {
    /// All around the z axis.
    Round,
    /// Beside each other along y.
    Straight {
        /// From one space to the next, mm.
        pitch: f64,
    },
}

/// A place of a body: along it, from the axis (or by x), and the angle (or y), which does not jump.
pub(crate) type Polar = [f64; 3];

impl Arrangement {
    /// Whether the last space is the neighbour of the first one.
    pub fn is_closed(self) -> bool {
        self == Arrangement::Round
    }

    /// From a space to the next if all are alike, of so many: an angle, or a length.
    pub fn pitch(self, teeth: u32) -> f64 {
        match self {
            Arrangement::Round => TAU / f64::from(teeth),
            Arrangement::Straight { pitch } => pitch,
        }
    }

    /// A point at a place.
    pub fn position(self, [z, rho, way]: Polar) -> [f64; 3] {
        match self {
            Arrangement::Round => [rho * way.cos(), rho * way.sin(), z],
            Arrangement::Straight { .. } => [rho, way, z],
        }
    }

    /// The place of a point, an angle between half turns.
    pub fn place(self, [x, y, z]: [f64; 3]) -> Polar {
        match self {
            Arrangement::Round => [z, x.hypot(y), y.atan2(x)],
            Arrangement::Straight { .. } => [z, x, y],
        }
    }

    /// Where a point lies in the section of the outline: `[z, rho]`, or `[z, x]`.
    pub fn section(self, point: [f64; 3]) -> [f64; 2] {
        let [z, rho, _] = self.place(point);
        [z, rho]
    }

    /// The motion that brings one space onto the next.
    pub fn alignment(self) -> Alignment {
        match self {
            Arrangement::Round => Alignment::Turn,
            Arrangement::Straight { .. } => Alignment::Shift,
        }
    }

    /// A point moved on along the spaces.
    pub fn moved(self, point: [f64; 3], by: f64) -> [f64; 3] {
        self.alignment().moved(point, by)
    }

    /// A direction moved on along the spaces.
    pub fn turned(self, direction: [f64; 3], by: f64) -> [f64; 3] {
        self.alignment().turned(direction, by)
    }

    /// The angle that differs from one by whole turns and is the nearest to another.
    pub(crate) fn near(self, way: f64, reference: f64) -> f64 {
        match self {
            Arrangement::Round => reference + (way - reference + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU,
            Arrangement::Straight { .. } => way,
        }
    }

    /// How long a unit of the way along the spaces is at a distance from the axis, mm.
    pub fn arc(self, rho: f64) -> f64 {
        match self {
            Arrangement::Round => rho,
            Arrangement::Straight { .. } => 1.0,
        }
    }

    /// The distance of two places that are near to each other, mm.
    pub(crate) fn distance(self, a: Polar, b: Polar) -> f64 {
        (a[0] - b[0]).hypot(a[1] - b[1]).hypot(self.arc(0.5 * (a[1] + b[1])) * (a[2] - b[2]))
    }

    /// The component along the spaces of a vector at a point.
    pub(crate) fn along(self, [x, y, _]: [f64; 3], vector: Vector3<f64>) -> f64 {
        match self {
            Arrangement::Round => (vector.y * x - vector.x * y) / x.hypot(y),
            Arrangement::Straight { .. } => vector.y,
        }
    }
}

//! Numbers that are wanted of a contact at its vertex.

use crate::contact::corners::FlankCorners;
use crate::contact::{ContactChange, ContactPoint};

/// Numbers are differenced over a change of the contact by this share: its square, and rounding over it, are below 1e-10.
const STEP: f64 = 1e-5;
/// An angle of a path that is worth 1 mm, radians.
const ANGLE: f64 = 0.1;
/// Of the derivatives of the lag, where it is almost even, a curvature that counts.
pub(super) const EVEN: f64 = 1e-9;

/// A number of a contact at its vertex, on the second flank. Lengths are mm, angles radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactNumber {
    /// Along the axis of the member.
    Z,
    /// Distance from that axis.
    Rho,
    /// Share of the way from toe to heel.
    Lengthwise(FlankCorners),
    /// Share of the way from root to tip.
    Profilewise(FlankCorners),
    /// Angle of the path against the rows.
    Path(FlankCorners),
    /// Length of the ellipse within a film: its longer axis.
    Ellipse {
        /// How thick the film is.
        film: f64,
    },
    /// Second derivative of the lag by the roll.
    Curvature,
}

/// What a number of a contact shall be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactWish {
    /// The number.
    pub of: ContactNumber,
    /// Its value.
    pub wanted: f64,
    /// How far it may be off: then it counts as least squares weigh it, beside those that hold exactly.
    pub within: Option<f64>,
}

/// What is read of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    point: [f64; 3],
    normal: [f64; 3],
    path: [f64; 3],
    /// The smaller curvature of the gap.
    gap: Option<f64>,
    curvature: f64,
}

impl Reading {
    pub(super) fn of(at: &ContactPoint) -> Reading {
        Reading {
            point: at.in_members[1],
            normal: at.normals[1],
            path: at.path[1],
            gap: at.gap.as_ref().map(|gap| gap.k2),
            curvature: at.lag_slopes[1],
        }
    }

    /// After a step of a change.
    pub(super) fn after(&self, step: f64, by: &ContactChange) -> Reading {
        let add = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k] + step * b[k]);
        Reading {
            point: add(self.point, by.moved[1]),
            normal: add(self.normal, by.normals[1]),
            path: add(self.path, by.path[1]),
            gap: self.gap.zip(by.gap).map(|(gap, by)| gap + step * by[1]),
            curvature: self.curvature + step * by.lag_curvature,
        }
    }

    /// The step by which a change makes a small share of what is there.
    pub(super) fn step(&self, by: &ContactChange) -> f64 {
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let gap = self.gap.zip(by.gap).map_or(0.0, |(gap, by)| by[1] / gap);
        let shares = [
            size(by.moved[1]) / size(self.point),
            size(by.normals[1]),
            size(by.path[1]) / size(self.path),
            gap,
            by.lag_curvature / self.curvature,
        ];
        let fastest = shares.into_iter().filter(|share| share.is_finite()).fold(0.0, |most: f64, x| most.max(x.abs()));
        if fastest > 0.0 { STEP / fastest } else { STEP }
    }
}

impl ContactNumber {
    /// Of a contact of flanks; `None` where it has no such number.
    #[must_use]
    pub fn of(&self, at: &ContactPoint) -> Option<f64> {
        self.read(&Reading::of(at))
    }

    fn read(&self, of: &Reading) -> Option<f64> {
        let [x, y, z] = of.point;
        let rho = x.hypot(y);
        match self {
            ContactNumber::Z => Some(z),
            ContactNumber::Rho => Some(rho),
            ContactNumber::Lengthwise(corners) => Some(corners.shares([z, rho])?[1]),
            ContactNumber::Profilewise(corners) => Some(corners.shares([z, rho])?[0]),
            ContactNumber::Path(corners) => Some(corners.directions(of.point, of.normal)?.angle(of.path)),
            ContactNumber::Ellipse { film } => Some(2.0 * (2.0 * film / of.gap.filter(|gap| *gap > 0.0)?).sqrt()),
            ContactNumber::Curvature => Some(of.curvature),
        }
    }
}

impl ContactWish {
    /// How far a contact is from it, in what is worth 1 mm.
    fn off(&self, of: &Reading) -> Option<f64> {
        let (value, wanted) = (self.of.read(of)?, self.wanted);
        let apart = value - wanted;
        Some(match self.of {
            ContactNumber::Z | ContactNumber::Rho => apart,
            ContactNumber::Lengthwise(corners) => apart * span(&corners, [[0.5, 0.0], [0.5, 1.0]]),
            ContactNumber::Profilewise(corners) => apart * span(&corners, [[0.0, 0.5], [1.0, 0.5]]),
            // a path has no sense
            ContactNumber::Path(_) => {
                let half = std::f64::consts::PI;
                (apart - half * (apart / half).round()) / ANGLE
            }
            // the gap's curvature goes through zero where the ellipse has no end: its logarithm is less bent
            ContactNumber::Ellipse { .. } => wanted * (value / wanted).ln(),
            ContactNumber::Curvature => apart / wanted.abs().max(EVEN),
        })
    }

    /// From a value to what is wanted; of a path the shorter way round.
    pub(super) fn way(&self, from: f64) -> f64 {
        let way = self.wanted - from;
        match self.of {
            ContactNumber::Path(_) => way - std::f64::consts::PI * (way / std::f64::consts::PI).round(),
            _ => way,
        }
    }

    /// The same as least squares have it: of what need not hold exactly in shares of how far it may be off.
    pub(super) fn residual(&self, of: &Reading) -> Option<f64> {
        let Some(within) = self.within else { return self.off(of) };
        let apart = match self.of {
            ContactNumber::Path(_) => self.off(of)? * ANGLE,
            _ => self.of.read(of)? - self.wanted,
        };
        Some(apart / within)
    }
}

fn span(corners: &FlankCorners, ends: [[f64; 2]; 2]) -> f64 {
    let [a, b] = ends.map(|shares| corners.at(shares));
    (b[0] - a[0]).hypot(b[1] - a[1])
}

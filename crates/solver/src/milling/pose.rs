//! Where a cutter stands that touches a surface at a point, and how it bends there against the surface.

use nalgebra::Vector3;

use crate::milling::frame::SurfaceFrame;
use crate::milling::outline::{Cutter, Touching};

/// The bottom of a cutter touches as a plane where the angle between normal and axis is below this, radians.
const FLAT: f64 = 1e-9;

/// A cutter that touches a surface, in the frame of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutterPose {
    /// The origin of the tool, mm.
    pub tip: [f64; 3],
    /// Unit vector along its axis towards the spindle.
    pub axis: [f64; 3],
    /// Unit vector along the surface in the direction of the feed.
    pub feed: [f64; 3],
}

/// Why a cutter cannot touch a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoPose {
    /// The bottom lies on the surface as a plane: nothing says which point of the edge touches.
    #[error("the bottom of the cutter lies flat on the surface")]
    Flat,
    /// Neither an arc nor a straight side of the cutter has the normal of the surface.
    #[error(
        "the cutter would touch with its outline at {angle} rad from its tip, which is no arc and no side of the cutting surface"
    )]
    OffCutter {
        /// The angle of the normal from the direction away from the spindle, radians.
        angle: f64,
    },
    /// The surface has no tangent along the pass.
    #[error("the surface has no direction along the pass")]
    NoFeed,
}

/// How a cutter leans and what it leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lean {
    /// Forward in the feed, radians.
    pub lead: f64,
    /// About the direction of the second of the frame's steps, radians: to the same side whichever way the cutter feeds.
    pub tilt: f64,
    /// What is left on the surface, mm.
    pub stock: f64,
}

/// How cutter and surface part about their contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bending {
    /// The least curvature of the gap between both, 1/mm: negative where the cutter cuts too deep beside its contact.
    pub gap: f64,
    /// The radius across the feed of what the cutter sweeps, mm.
    pub effective_radius: f64,
    /// The least principal curvature of the surface, 1/mm: where negative, a ball above its inverse does not fit.
    pub hollow: f64,
}

impl CutterPose {
    /// The pose in which a cutter touches a surface at a point, feeding in the direction of the second of the frame's steps, or against
    /// it (`forward` −1).
    ///
    /// # Errors
    /// If the cutter cannot touch there.
    pub fn touching(frame: &SurfaceFrame, cutter: &Cutter, lean: Lean, forward: f64) -> Result<CutterPose, NoPose> {
        let normal = Vector3::from(frame.normal);
        let along = Vector3::from(frame.steps[1]).try_normalize(0.0);
        let along = along.filter(|along| along.iter().all(|x| x.is_finite())).ok_or(NoPose::NoFeed)?;
        let feed = forward * along;
        // to the same side both ways
        let upright = normal * lean.tilt.cos() + along.cross(&normal) * lean.tilt.sin();
        let axis = (upright * lean.lead.cos() + feed * lean.lead.sin()).normalize();
        let arc = touching(cutter, &normal, &axis)?.arc;
        let towards = towards(&normal, &axis).unwrap_or_default();
        let point = Vector3::from(frame.position);
        let tip = point + normal * (arc.radius + lean.stock) - towards * arc.rho - axis * arc.z;
        Ok(CutterPose { tip: tip.into(), axis: axis.into(), feed: feed.into() })
    }

    /// Origin and axis in one row.
    pub fn row(&self) -> [f64; 6] {
        let ([x, y, z], [i, j, k]) = (self.tip, self.axis);
        [x, y, z, i, j, k]
    }

    /// How the cutter parts from the surface about their contact; `None` where that is not known.
    pub fn bending(&self, frame: &SurfaceFrame, cutter: &Cutter) -> Option<Bending> {
        let (normal, axis) = (Vector3::from(frame.normal), Vector3::from(self.axis));
        let Touching { arc, bend_radius } = touching(cutter, &normal, &axis).ok()?;
        let turning = towards(&normal, &axis).unwrap_or_else(|| Vector3::from(self.feed));
        let about = axis.cross(&turning).normalize();
        let over = about.cross(&normal);
        let angle = angle_between(&normal, &axis);
        let (sine, from_axis) = (angle.sin(), arc.rho + arc.radius * angle.sin());
        // a ball bends alike in all directions
        let around = if arc.rho == 0.0 { 1.0 / arc.radius } else { sine / from_axis };
        let own = surface_form(frame, [over, about])?;
        let [a, b, c] = [own[0][0], own[0][1], own[1][1]];
        let gap = if bend_radius > 0.0 {
            let (a, c) = (a + 1.0 / bend_radius, c + around);
            0.5 * (a + c) - (0.5 * (a - c)).hypot(b)
        } else {
            c + around
        };
        let feed = Vector3::from(self.feed);
        let [m, t] = [over.dot(&feed), about.dot(&feed)];
        // along the feed the cutter wraps itself; what is left across it
        let beside = if t == 0.0 { 0.0 } else { around * bend_radius * t * t };
        let swept = around / (m * m + beside);
        let hollow = 0.5 * (a + c) - (0.5 * (a - c)).hypot(b);
        Some(Bending { gap, effective_radius: 1.0 / swept, hollow })
    }
}

/// What of a cutter touches.
fn touching(cutter: &Cutter, normal: &Vector3<f64>, axis: &Vector3<f64>) -> Result<Touching, NoPose> {
    let angle = angle_between(normal, axis);
    let found = cutter.touching(angle).ok_or(NoPose::OffCutter { angle })?;
    if found.arc.rho != 0.0 && angle < FLAT { Err(NoPose::Flat) } else { Ok(found) }
}

fn angle_between(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// The unit vector square to the axis from it towards the contact; `None` where normal and axis are one line.
fn towards(normal: &Vector3<f64>, axis: &Vector3<f64>) -> Option<Vector3<f64>> {
    (axis * normal.dot(axis) - normal).try_normalize(FLAT)
}

/// The normal curvatures of a surface in two orthonormal tangents, positive where its body is convex.
pub(crate) fn surface_form(frame: &SurfaceFrame, tangents: [Vector3<f64>; 2]) -> Option<[[f64; 2]; 2]> {
    let steps = frame.steps.map(Vector3::from);
    let turns = frame.turns.map(Vector3::from);
    let s = [0, 1].map(|i| [0, 1].map(|j| tangents[i].dot(&steps[j])));
    let t = [0, 1].map(|i| [0, 1].map(|j| tangents[i].dot(&turns[j])));
    let whole = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    let inverse = [[s[1][1] / whole, -s[0][1] / whole], [-s[1][0] / whole, s[0][0] / whole]];
    let form = [0, 1].map(|i| [0, 1].map(|j| t[i][0] * inverse[0][j] + t[i][1] * inverse[1][j]));
    let mixed = 0.5 * (form[0][1] + form[1][0]);
    let form = [[form[0][0], mixed], [mixed, form[1][1]]];
    form.iter().flatten().all(|x| x.is_finite()).then_some(form)
}

//! In which directions a surface may take the axis of a cylinder.

use std::f64::consts::FRAC_PI_2;

use super::Base;
use crate::milling::frame::SurfaceFrame;
use crate::milling::pose::surface_form;

/// The axis is no farther than this from across the pass: it would run along itself.
const FARTHEST_TURN: f64 = 1.4;
/// Directions that differ by less than this are one, radians.
const SAME: f64 = 1e-6;

/// The angles from across the pass towards its direction at which the axis of a cylinder of a radius may lie on a surface: along the
/// asymptotic directions of the surface parallel to it in that distance, so that a ruled surface touches that one; where it has none, in
/// the direction in which it bends least.
///
/// `frame` has the direction of the pass as its second step.
pub fn side_directions(frame: &SurfaceFrame, spindle_left: bool, radius: f64) -> Vec<f64> {
    let base = Base::new(frame.position, frame.normal, frame.steps[1], spindle_left);
    let Some([[a, b], [_, c]]) = surface_form(frame, [base.across, base.along]) else { return Vec::new() };
    // S (1 + R S)⁻¹
    let whole = (1.0 + radius * a) * (1.0 + radius * c) - radius * radius * b * b;
    let determinant = a * c - b * b;
    let [a, b, c] = [(a + radius * determinant) / whole, b / whole, (c + radius * determinant) / whole];
    let discriminant = b * b - a * c;
    // a cos² + 2 b cos sin + c sin² = 0
    let mut found = if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        [root, -root].map(|root| {
            // of two quotients the one that does not cancel
            let q = b + if b >= 0.0 { root.abs() } else { -root.abs() };
            if (root >= 0.0) == (b >= 0.0) && q != 0.0 { (-q).atan2(c) } else { (-a).atan2(q) }
        })
    } else {
        [0.5 * (2.0 * b).atan2(a - c); 2].map(|most| if (a + c) > 0.0 { most + FRAC_PI_2 } else { most })
    };
    found.iter_mut().for_each(|angle| *angle = folded(*angle));
    found.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let mut kept: Vec<f64> = found.into_iter().filter(|angle| angle.abs() < FARTHEST_TURN).collect();
    kept.dedup_by(|a, b| (*a - *b).abs() < SAME);
    kept
}

/// The angle of the same line within a quarter turn to both sides.
fn folded(angle: f64) -> f64 {
    angle - 2.0 * FRAC_PI_2 * (angle / (2.0 * FRAC_PI_2)).round()
}

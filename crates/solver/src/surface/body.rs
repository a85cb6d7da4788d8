//! On which side of a surface the body lies that owns it, as far as its points tell.

use flank_expr::{ScalarEvaluator, Tape, TapeError};

use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// Whether some points would all stay on the work if the body of the tool lay on the other side of the tool's surface: the Hessian
/// of the clearance is negative definite at each of them. Of a surface that is cut away whole this tells a body on the wrong side
/// from undercut, where the Hessian is indefinite somewhere. `false` without points, or without motions.
///
/// # Errors
/// If something depends on a variable that is neither an unknown nor has a value.
pub fn is_inside_out(surface: &BoundSurface<'_>, points: &[SurfacePoint]) -> Result<bool, TapeError> {
    let bound = surface.surface();
    let minors = Tape::new(&bound.clearance_minors(), &bound.unknowns)?;
    let mut evaluator = ScalarEvaluator::new(&minors);
    let mut values = vec![0.0; minors.output_count()];
    // with the other side as the body's the k-th minor has (−1)^k times its value
    let mut is_turned = |point: &SurfacePoint| {
        evaluator.run(&point.unknowns, &mut values);
        values.iter().enumerate().all(|(k, minor)| if k % 2 == 0 { *minor < 0.0 } else { *minor > 0.0 })
    };
    Ok(!points.is_empty() && minors.output_count() > 0 && points.iter().all(&mut is_turned))
}

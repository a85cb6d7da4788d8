//! What a surface has taken of another that it meets nowhere: all that it lies deeper than.

use flank_expr::{Expr, TapeError};

use crate::analysis::alignment::Alignment;
use crate::analysis::deviation::Deviation;
use crate::equations::solution::{CutBy, Outcome};
use crate::surface::SurfaceProblem;
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// Nearer than this, mm, two surfaces lie on each other.
const ON_EACH_OTHER: f64 = 1e-9;
/// Points of gears are told by radius and height unless other places tell them this much better: near a root cylinder, say.
const CLEARLY: f64 = 2.0;

/// Marks the solved points below which, along their normals into the material, `by` lies and faces the same way, with the number of the
/// trim. Where `by` has several branches beside them, it is not known which counts.
pub(super) fn mark_deeper<'g>(
    by: &BoundSurface<'g>,
    points: &mut [SurfacePoint],
    counts: [usize; 2],
    number: usize,
    points_of_by: &dyn Fn([Expr<'g>; 2]) -> SurfaceProblem,
) -> Result<(), TapeError> {
    let Some(places) = Places::telling(points) else { return Ok(()) };
    let coordinates = places.values(by.surface().position.0, |x, y| (x * x + y * y).sqrt());
    let (near, _) = points_of_by(coordinates).points_alone().solve(&places.targets(points), counts);
    let off = Deviation::new(by, Alignment::default())?.map(points, &near, 0.0);
    for ((point, near), off) in points.iter_mut().zip(&near).zip(off) {
        let is_deeper = off.is_some_and(|off| off < -ON_EACH_OTHER) && turned_normal(near, point) > 0.0;
        if is_deeper {
            point.outcome = Outcome::CutAway(CutBy::Other(number));
        } else if point.outcome == Outcome::Solved && near.outcome == Outcome::Ambiguous {
            point.outcome = Outcome::Undecided;
        }
    }
    Ok(())
}

/// Two functions of a place that tell the points of a surface: two of x, y, z, or the distance from the z axis and z.
#[derive(Clone, Copy)]
enum Places {
    RadiusAndHeight,
    /// Without the one of this number.
    Without(usize),
}

impl Places {
    /// Those across which some points' surface lies least, whatever its own coordinates are; `None` if no point is solved.
    fn telling(points: &[SurfacePoint]) -> Option<Places> {
        let solved = || points.iter().filter(|point| point.outcome == Outcome::Solved);
        solved().next()?;
        let sum = |part: &dyn Fn(&SurfacePoint) -> f64| solved().map(|point| part(point).abs()).sum::<f64>();
        let tangential = |point: &SurfacePoint| {
            let ([x, y, _], [nx, ny, _]) = (point.position, point.normal);
            (x * ny - y * nx) / x.hypot(y).max(f64::MIN_POSITIVE)
        };
        let mut best = (Places::RadiusAndHeight, sum(&tangential));
        for k in 0..3 {
            let own = sum(&|point| point.normal[k]);
            if own > CLEARLY * best.1 {
                best = (Places::Without(k), own);
            }
        }
        Some(best.0)
    }

    fn values<T: Copy>(self, [x, y, z]: [T; 3], radius: impl Fn(T, T) -> T) -> [T; 2] {
        match self {
            Places::RadiusAndHeight => [radius(x, y), z],
            Places::Without(0) => [y, z],
            Places::Without(1) => [x, z],
            Places::Without(_) => [x, y],
        }
    }

    /// Their values at points; where one is not solved, those of the solved one before it, or of the first.
    fn targets(self, points: &[SurfacePoint]) -> Vec<[f64; 2]> {
        let target =
            |point: &SurfacePoint| (point.outcome == Outcome::Solved).then(|| self.values(point.position, f64::hypot));
        let mut last = points.iter().find_map(target).unwrap_or_default();
        let targets = points.iter().map(|point| {
            last = target(point).unwrap_or(last);
            last
        });
        targets.collect()
    }
}

/// The normal of a point, turned about z with it to the polar angle of another one, times the normal of that.
fn turned_normal(point: &SurfacePoint, to: &SurfacePoint) -> f64 {
    let angle = |[x, y, _]: [f64; 3]| y.atan2(x);
    let (sine, cosine) = (angle(to.position) - angle(point.position)).sin_cos();
    let [x, y, z] = point.normal;
    let turned = [x * cosine - y * sine, x * sine + y * cosine, z];
    turned.iter().zip(to.normal).map(|(a, b)| a * b).sum()
}

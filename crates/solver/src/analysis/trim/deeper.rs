//! What a surface has taken of another that it meets nowhere: all that it lies deeper than.

use flank_expr::{Expr, TapeError};

use crate::analysis::alignment::Alignment;
use crate::analysis::deviation::Deviation;
use crate::analysis::trim::TrimmedBy;
use crate::equations::solution::{CutBy, Outcome};
use crate::surface::SurfaceProblem;
use crate::surface::points::SurfacePoint;

/// Nearer than this, mm, two surfaces lie on each other.
const ON_EACH_OTHER: f64 = 1e-9;
/// Points of gears are told by radius and height unless other places tell them this much better: near a root cylinder, say.
const CLEARLY: f64 = 2.0;

/// Marks the solved points below which, along their normals into the material, `by` lies and faces the same way, with the number of the
/// trim. Where `by` has several branches beside them, it is not known which counts, unless points are clear of
/// the tool, of which it `is_swept_known` what it sweeps.
pub(super) fn mark_deeper<'g>(
    by: &TrimmedBy<'_, 'g>,
    points: &mut [SurfacePoint],
    counts: [usize; 2],
    is_swept_known: bool,
    points_of_by: &dyn Fn([Expr<'g>; 2]) -> SurfaceProblem,
) -> Result<(), TapeError> {
    let Some(places) = Places::telling(points) else { return Ok(()) };
    let coordinates = places.of_surface(by.surface.surface().position.0);
    let (near, _) = points_of_by(coordinates).points_alone().solve(&places.targets(points), counts);
    let near = with_neighbours(&near, counts);
    let off = Deviation::new(by.surface, Alignment::default())?.map(points, &near, 0.0);
    let positions = by.positions.as_ref().filter(|_| is_swept_known);
    for ((point, near), off) in points.iter_mut().zip(&near).zip(off) {
        let is_deeper = off.is_some_and(|off| off < -ON_EACH_OTHER) && turned_normal(near, point) > 0.0;
        if is_deeper {
            point.outcome = Outcome::CutAway(CutBy::Other(by.number));
        } else if point.outcome == Outcome::Solved
            && near.outcome == Outcome::Ambiguous
            && !positions.is_some_and(|positions| positions.is_clear_of(point))
        {
            point.outcome = Outcome::Undecided;
        }
    }
    Ok(())
}

/// The points of a grid; where none was found, one beside it. The angle comes round at a place, where a point is not found.
fn with_neighbours(points: &[SurfacePoint], [rows, columns]: [usize; 2]) -> Vec<SurfacePoint> {
    let beside = |at: usize| {
        let (i, j) = (at / columns, at % columns);
        let down = [i.checked_sub(1), Some(i + 1).filter(|i| *i < rows)].into_iter().flatten();
        let across = [j.checked_sub(1), Some(j + 1).filter(|j| *j < columns)].into_iter().flatten();
        let others = down.map(move |i| i * columns + j).chain(across.map(move |j| i * columns + j));
        others.map(|other| &points[other]).find(|other| other.outcome == Outcome::Solved)
    };
    let is_open = |point: &SurfacePoint| !point.outcome.is_root() && point.outcome != Outcome::Ambiguous;
    let filled = points.iter().enumerate().map(|(at, point)| match is_open(point) {
        true => beside(at).unwrap_or(point),
        false => point,
    });
    filled.cloned().collect()
}

/// Two functions of a place that tell the points of a surface: two of x, y, z, or z and one of the polar coordinates about it.
#[derive(Clone, Copy)]
enum Places {
    RadiusAndHeight,
    /// The angle from a direction in the plane of x and y.
    AngleAndHeight([f64; 2]),
    /// Without the one of this number.
    Without(usize),
}

impl Places {
    /// Those across which some points' surface lies least, whatever its own coordinates are; `None` if no point is solved.
    fn telling(points: &[SurfacePoint]) -> Option<Places> {
        let solved: Vec<&SurfacePoint> = points.iter().filter(|point| point.outcome == Outcome::Solved).collect();
        let middle = solved.get(solved.len() / 2)?.position;
        let sum = |part: &dyn Fn(&SurfacePoint) -> f64| solved.iter().map(|point| part(point).abs()).sum::<f64>();
        let over_radius = |part: f64, [x, y, _]: [f64; 3]| part / x.hypot(y).max(f64::MIN_POSITIVE);
        let tangential = |point: &SurfacePoint| {
            let ([x, y, _], [nx, ny, _]) = (point.position, point.normal);
            over_radius(x * ny - y * nx, point.position)
        };
        let radial = |point: &SurfacePoint| {
            let ([x, y, _], [nx, ny, _]) = (point.position, point.normal);
            over_radius(x * nx + y * ny, point.position)
        };
        let others = [(Places::AngleAndHeight([middle[0], middle[1]]), sum(&radial))];
        let others = others.into_iter().chain((0..3).map(|k| (Places::Without(k), sum(&|point| point.normal[k]))));
        let mut best = (Places::RadiusAndHeight, sum(&tangential));
        for (places, own) in others {
            if own > CLEARLY * best.1 {
                best = (places, own);
            }
        }
        Some(best.0)
    }

    fn of_surface<'g>(self, [x, y, z]: [Expr<'g>; 3]) -> [Expr<'g>; 2] {
        match self {
            Places::RadiusAndHeight => [(x * x + y * y).sqrt(), z],
            Places::AngleAndHeight([a, b]) => [(y * a - x * b).atan2(x * a + y * b), z],
            Places::Without(k) => without(k, [x, y, z]),
        }
    }

    fn of_point(self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        match self {
            Places::RadiusAndHeight => [x.hypot(y), z],
            Places::AngleAndHeight([a, b]) => [(y * a - x * b).atan2(x * a + y * b), z],
            Places::Without(k) => without(k, [x, y, z]),
        }
    }

    /// Their values at points; where one is not solved, those of the solved one before it, or of the first.
    fn targets(self, points: &[SurfacePoint]) -> Vec<[f64; 2]> {
        let target = |point: &SurfacePoint| (point.outcome == Outcome::Solved).then(|| self.of_point(point.position));
        let mut last = points.iter().find_map(target).unwrap_or_default();
        let targets = points.iter().map(|point| {
            last = target(point).unwrap_or(last);
            last
        });
        targets.collect()
    }
}

fn without<T: Copy>(k: usize, [x, y, z]: [T; 3]) -> [T; 2] {
    match k {
        0 => [y, z],
        1 => [x, z],
        _ => [x, y],
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

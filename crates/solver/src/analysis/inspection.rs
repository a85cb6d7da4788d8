//! How far measured points lie off a surface, along its normals.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, TapeError};
use rayon::prelude::*;

use crate::analysis::alignment::Alignment;
use crate::analysis::deviation::FARTHEST;
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::scalar::solve;
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// A motion that changes by less, in radians or mm, or by a smaller share of it, has settled: 1e-9 um on a radius of a metre.
const SETTLED: f64 = 1e-15;
/// Where a motion moves points along their normals by a smaller share of their ways (root of the mean of the squares), it moves none:
/// rounding is left of a surface of revolution.
const UNMOVED: f64 = 1e-9;
/// The motion settles in a few steps: what it does to a deviation is known but for what the normal changes on the way to the foot.
const MOST_STEPS: usize = 20;

/// A surface that measured points are compared with: each has its foot on it, where the surface's normal goes through the point.
#[derive(Clone, Debug)]
pub struct Inspection {
    /// Unknowns of the surface and a distance along its normal; the point is a parameter.
    foot: System,
    ranges: Vec<Range>,
    alignment: Alignment,
}

impl Inspection {
    /// Of a surface, for points that lie anywhere on the way of this motion.
    ///
    /// # Errors
    /// If something depends on a variable that is neither an unknown nor has a value.
    ///
    /// # Panics
    /// If the surface does not have two unknowns more than constraints.
    pub fn new(surface: &BoundSurface<'_>, alignment: Alignment) -> Result<Inspection, TapeError> {
        let bound = surface.surface();
        let graph = bound.position.0[0].graph();
        let point = ["point x", "point y", "point z"].map(|name| graph.variable(name));
        let distance = graph.variable("distance");
        let reached = bound.position + bound.normal.map(|part| part * distance);
        let apart = (reached - Vector3(point)).0;
        let residuals = surface.constrained(apart);
        let unknowns: Vec<Expr<'_>> = bound.unknowns.iter().copied().chain([distance]).collect();
        let foot = System::one_by_one(&residuals, &unknowns, &point)?;
        Ok(Inspection { foot, ranges: surface.ranges().to_vec(), alignment })
    }

    /// How far each measured point, mm, moved by so much, lies off the surface, mm: positive on the side to which the surface's normal
    /// points, where there is more material than there should be. `nominal` are points of the surface near them. `None` where there is
    /// no measured point, no solved nominal one, or no foot within the ranges.
    ///
    /// # Panics
    /// If there are not as many points of the one as of the other.
    #[must_use]
    pub fn deviations(&self, measured: &[Option<[f64; 3]>], nominal: &[SurfacePoint], by: f64) -> Vec<Option<f64>> {
        assert_eq!(measured.len(), nominal.len(), "one nominal point for each place");
        let pairs = measured.par_iter().zip(nominal);
        pairs.map(|(measured, nominal)| self.deviation(self.alignment.moved((*measured)?, by), nominal)).collect()
    }

    /// The motion after which the measured points lie as near to the surface as it brings them: the sum of the squares of their
    /// deviations is least. `None` if no point has a deviation, or the motion moves none along its normal.
    ///
    /// # Panics
    /// If there are not as many points of the one as of the other.
    #[must_use]
    pub fn best_motion(&self, measured: &[Option<[f64; 3]>], nominal: &[SurfacePoint]) -> Option<f64> {
        let mut by = self.alignment.median(measured, nominal)?;
        for number in 0..MOST_STEPS {
            let deviations = self.deviations(measured, nominal, by);
            let known = deviations.iter().zip(nominal).filter_map(|(off, point)| Some(((*off)?, point)));
            let [off, levers, arcs] = known.fold([0.0; 3], |[off, levers, arcs], (one, point)| {
                let lever = self.alignment.lever(point.position, point.normal);
                [off + one * lever, levers + lever * lever, arcs + self.alignment.arc(point.position).powi(2)]
            });
            // points that are far off took all along to where none has a foot
            if number > 0 && arcs == 0.0 {
                return self.alignment.median(measured, nominal);
            }
            if levers <= UNMOVED.powi(2) * arcs {
                return None;
            }
            let step = off / levers;
            by -= step;
            if step.abs() < SETTLED * by.abs().max(1.0) {
                break;
            }
        }
        Some(by)
    }

    fn deviation(&self, measured: [f64; 3], nominal: &SurfacePoint) -> Option<f64> {
        if nominal.outcome != Outcome::Solved {
            return None;
        }
        let start: f64 = (0..3).map(|k| (measured[k] - nominal.position[k]) * nominal.normal[k]).sum();
        let ranges = [&self.ranges[..], &[FARTHEST]].concat();
        let start = [&nominal.unknowns[..], &[start]].concat();
        let solution = solve(&self.foot, &ranges, &measured, &start);
        (solution.outcome == Outcome::Solved).then(|| solution.unknowns[self.ranges.len()])
    }
}

/// How far each measured point, moved by so much, lies beside its nominal one, mm: square to the normal there. `None` where there is no
/// measured point or no solved nominal one.
///
/// # Panics
/// If there are not as many points of the one as of the other.
#[must_use]
pub fn beside(
    measured: &[Option<[f64; 3]>],
    nominal: &[SurfacePoint],
    (alignment, by): (Alignment, f64),
) -> Vec<Option<f64>> {
    assert_eq!(measured.len(), nominal.len(), "one nominal point for each place");
    let of = |(measured, nominal): (&Option<[f64; 3]>, &SurfacePoint)| {
        let measured = alignment.moved((*measured)?, by);
        let way: [f64; 3] = std::array::from_fn(|k| measured[k] - nominal.position[k]);
        let along: f64 = way.iter().zip(&nominal.normal).map(|(way, normal)| way * normal).sum();
        let aside = way.iter().zip(&nominal.normal).map(|(way, normal)| (way - along * normal).powi(2)).sum::<f64>();
        (nominal.outcome == Outcome::Solved).then(|| aside.sqrt())
    };
    measured.iter().zip(nominal).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flank_expr::Graph;
    use flank_expr::geometry::Surface;

    fn solved(unknowns: Vec<f64>, position: [f64; 3], normal: [f64; 3]) -> SurfacePoint {
        SurfacePoint { outcome: Outcome::Solved, unknowns, position, normal, residual: 0.0 }
    }

    /// A sphere knows the distance of any point from it, wherever the nominal point lies.
    #[test]
    fn points_about_a_sphere() {
        let graph = Graph::new();
        let (u, v) = (graph.variable("u"), graph.variable("v"));
        let sphere = Surface::parametric(
            [u, v],
            Vector3([20.0 * u.cos() * v.cos(), 20.0 * u.sin() * v.cos(), 20.0 * v.sin()]),
            false,
        );
        let inspection = Inspection::new(
            &BoundSurface::new(&sphere, vec![Range { low: -3.0, high: 3.0 }, Range { low: -1.5, high: 1.5 }], &[]),
            Alignment::Turn,
        )
        .expect("bound");
        let on = |u: f64, v: f64| [u.cos() * v.cos(), u.sin() * v.cos(), v.sin()];
        let nominal = [solved(vec![0.4, 0.3], on(0.4, 0.3).map(|x| 20.0 * x), on(0.4, 0.3))];
        for (radius, du, dv) in [(20.25, 0.0, 0.0), (19.5, 0.2, -0.1), (20.0, 0.0, 0.4), (21.0, -0.3, 0.3)] {
            let measured = [Some(on(0.4 + du, 0.3 + dv).map(|x| radius * x))];
            let off = inspection.deviations(&measured, &nominal, 0.0)[0].expect("a foot");
            assert!((off - (radius - 20.0)).abs() < 1e-12, "{off}");
        }
        assert_eq!(
            inspection.best_motion(&[Some([20.0, 0.0, 0.0])], &nominal),
            None,
            "turning moves no point along its normal"
        );
        assert_eq!(inspection.deviations(&[None], &nominal, 0.0), [None]);
    }

    /// Of a surface of revolution a turn moves nothing but roundings: at these radii and angles they do not cancel.
    #[test]
    fn a_surface_of_revolution_is_not_turned() {
        let graph = Graph::new();
        let (angle, height) = (graph.variable("angle"), graph.variable("height"));
        let radius = 17.3 + 0.1 * height;
        let cone =
            Surface::parametric([angle, height], Vector3([radius * angle.cos(), radius * angle.sin(), height]), false);
        let ranges = vec![Range { low: -4.0, high: 4.0 }, Range { low: -20.0, high: 20.0 }];
        let inspection = Inspection::new(&BoundSurface::new(&cone, ranges, &[]), Alignment::Turn).expect("bound");
        let slope = 1.01f64.sqrt();
        let places: Vec<[f64; 2]> = (0..24).map(|k| [0.137 * f64::from(k), 0.731 * f64::from(k % 7) - 1.9]).collect();
        let nominal: Vec<SurfacePoint> = places
            .iter()
            .map(|&[angle, height]| {
                let ((sine, cosine), radius) = (angle.sin_cos(), 17.3 + 0.1 * height);
                let normal = [cosine / slope, sine / slope, -0.1 / slope];
                solved(vec![angle, height], [radius * cosine, radius * sine, height], normal)
            })
            .collect();
        assert!(
            nominal.iter().any(|point| Alignment::Turn.lever(point.position, point.normal) != 0.0),
            "roundings are there"
        );
        let off = |k: usize| 0.01 + 0.002 * (k % 5) as f64;
        let measured: Vec<Option<[f64; 3]>> = nominal
            .iter()
            .enumerate()
            .map(|(k, point)| Some(std::array::from_fn(|i| point.position[i] + off(k) * point.normal[i])))
            .collect();
        assert_eq!(inspection.best_motion(&measured, &nominal), None);
        for (k, found) in inspection.deviations(&measured, &nominal, 0.0).into_iter().enumerate() {
            assert!((found.expect("a foot") - off(k)).abs() < 1e-12, "{found:?}");
        }
    }

    /// A plane through the axis at 0.3 rad, measured at 0.2 rad with an error that no turn takes away.
    #[test]
    fn a_turn_takes_away_what_a_turn_can() {
        let graph = Graph::new();
        let (radius, height) = (graph.variable("radius"), graph.variable("height"));
        let (sine, cosine) = 0.3f64.sin_cos();
        let plane = Surface::parametric([radius, height], Vector3([radius * cosine, radius * sine, height]), true);
        let ranges = vec![Range { low: 1.0, high: 50.0 }, Range { low: -50.0, high: 50.0 }];
        let inspection = Inspection::new(&BoundSurface::new(&plane, ranges, &[]), Alignment::Turn).expect("bound");
        let places: Vec<[f64; 2]> = [10.0, 20.0, 30.0].iter().flat_map(|&r| [[r, -5.0], [r, 5.0]]).collect();
        let nominal: Vec<SurfacePoint> =
            places.iter().map(|&[r, z]| solved(vec![r, z], [r * cosine, r * sine, z], [-sine, cosine, 0.0])).collect();
        let measured: Vec<Option<[f64; 3]>> = places
            .iter()
            .map(|&[r, z]| {
                let off = if z > 0.0 { 0.01 } else { -0.01 };
                Some(Alignment::Turn.moved([r, off, z], 0.2))
            })
            .collect();
        let turn = inspection.best_motion(&measured, &nominal).expect("a turn");
        assert!((turn - 0.1).abs() < 1e-14, "{turn}");
        for (off, [_, z]) in inspection.deviations(&measured, &nominal, turn).into_iter().zip(places) {
            assert!((off.expect("a foot") - 0.002 * z).abs() < 1e-12, "{off:?}");
        }
    }

    /// A plane under 20 degrees to the way of a rack, measured 0.05 mm further along with an error that no shift takes away.
    #[test]
    fn a_shift_takes_away_what_a_shift_can() {
        let graph = Graph::new();
        let (depth, height) = (graph.variable("depth"), graph.variable("height"));
        let (sine, cosine) = 20f64.to_radians().sin_cos();
        let plane = Surface::parametric([depth, height], Vector3([cosine * depth, sine * depth, height]), true);
        let ranges = vec![Range { low: -50.0, high: 50.0 }, Range { low: -50.0, high: 50.0 }];
        let inspection = Inspection::new(&BoundSurface::new(&plane, ranges, &[]), Alignment::Shift).expect("bound");
        let places: Vec<[f64; 2]> = [-3.0, 0.0, 3.0].iter().flat_map(|&x| [[x, -5.0], [x, 5.0]]).collect();
        let on = |[depth, z]: [f64; 2]| [cosine * depth, sine * depth, z];
        let nominal: Vec<SurfacePoint> =
            places.iter().map(|&at| solved(at.to_vec(), on(at), [-sine, cosine, 0.0])).collect();
        let measured: Vec<Option<[f64; 3]>> = places
            .iter()
            .map(|&at| {
                let ([x, y, z], off) = (on(at), 0.002 * at[1]);
                Some([x - off * sine, y + off * cosine + 0.05, z])
            })
            .collect();
        let shift = inspection.best_motion(&measured, &nominal).expect("a shift");
        assert!((shift + 0.05).abs() < 1e-12, "{shift}");
        for (off, [_, z]) in inspection.deviations(&measured, &nominal, shift).into_iter().zip(places) {
            assert!((off.expect("a foot") - 0.002 * z).abs() < 1e-12, "{off:?}");
        }
    }
}

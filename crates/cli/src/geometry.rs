//! `flank solve --geometry`: what a surface is like at its points.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Process, Sample};
use flank_export::{Field, Values};
use flank_solver::{Metric, Outcome, PointGeometry, Principal, SurfaceGeometry, SurfacePoint};

use crate::units;

type Vector = [f64; 3];

/// Curvatures with their directions, contact, and the metric of the sample's coordinates, at each of the points.
pub(crate) fn fields<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
    points: &[SurfacePoint],
) -> Vec<Field> {
    let coordinates = [sample.coordinates[0].value, sample.coordinates[1].value];
    let motions = &surface.generation.motions;
    let geometry = SurfaceGeometry::new(&surface.surface, motions, coordinates, &job.bindings())
        .expect("a job without errors leaves nothing unbound");
    let at = |point: &SurfacePoint| (point.outcome == Outcome::Solved).then(|| geometry.at(&point.unknowns));
    let all = Points(points.iter().map(at).collect());
    let mut fields = bending(&all);
    fields.extend(contact(&all, surface));
    fields.extend(metric(&all, sample));
    fields
}

/// What is known of each point; `None` for those that are not solved.
struct Points(Vec<Option<PointGeometry>>);

impl Points {
    fn scalar(&self, name: &str, unit: &str, meaning: &str, of: impl Fn(&PointGeometry) -> Option<f64>) -> Field {
        let values = self.0.iter().map(|point| point.as_ref().and_then(&of)).collect();
        Field { name: name.into(), unit: unit.into(), meaning: meaning.into(), values: Values::Scalars(values) }
    }

    fn vector(&self, name: &str, unit: &str, meaning: &str, of: impl Fn(&PointGeometry) -> Option<Vector>) -> Field {
        let values = self.0.iter().map(|point| point.as_ref().and_then(&of)).collect();
        Field { name: name.into(), unit: unit.into(), meaning: meaning.into(), values: Values::Vectors(values) }
    }
}

fn bending(points: &Points) -> Vec<Field> {
    let principal = |point: &PointGeometry| point.curvature.map(|curvature| curvature.principal());
    let direction = |k: usize| move |point: &PointGeometry| principal(point)?.directions.map(|both| both[k]);
    vec![
        points.scalar("k1", "1/mm", "larger principal curvature, positive where the body is convex", |point| {
            principal(point).map(|principal| principal.k1)
        }),
        points.scalar("k2", "1/mm", "smaller principal curvature, positive where the body is convex", |point| {
            principal(point).map(|principal| principal.k2)
        }),
        points.vector("d1", "1", "unit direction of k1; d1, d2 and the normal are right-handed", direction(0)),
        points.vector("d2", "1", "unit direction of k2", direction(1)),
    ]
}

/// How tool and work touch, as far as there is something to say: with no motion they are the same surface.
fn contact(points: &Points, surface: &GeneratedSurface<'_>) -> Vec<Field> {
    let motions = &surface.unknowns[surface.unknowns.len() - surface.generation.motions.len()..];
    let mut fields: Vec<Field> = Vec::new();
    for (k, motion) in motions.iter().enumerate() {
        let name = format!("sliding_{}", motion.name);
        let meaning = format!("velocity of the tool's point against the work along the motion `{}`", motion.name);
        let unit = if motion.dimension == Dimension::ANGLE { "mm/rad" } else { "mm/mm" };
        fields.push(points.vector(&name, unit, &meaning, |point| point.contact.sliding[k]));
    }
    if motions.len() == 1 {
        let meaning = "unit direction of the line along which tool and work touch at the instant";
        fields.push(points.vector("contact_line", "1", meaning, |point| point.contact.line));
        let meaning = "angle between the contact line and the sliding velocity, 0 to 90";
        let degrees = |point: &PointGeometry| point.contact.sliding_angle().map(f64::to_degrees);
        fields.push(points.scalar("sliding_angle", "deg", meaning, degrees));
    }
    if !motions.is_empty() && surface.generation.process != Process::Sweep {
        fields.extend(induced(points));
    }
    fields
}

fn induced(points: &Points) -> Vec<Field> {
    let principal =
        |point: &PointGeometry| -> Option<Principal> { point.contact.induced.map(|induced| induced.principal()) };
    let meaning = "normal curvature of the gap between tool and work; negative where the tool cuts into the surface";
    vec![
        points.scalar("induced_k1", "1/mm", &format!("largest {meaning}"), |point| principal(point).map(|p| p.k1)),
        points.scalar("induced_k2", "1/mm", &format!("smallest {meaning}"), |point| principal(point).map(|p| p.k2)),
        points.vector("induced_d1", "1", "unit direction of induced_k1", |point| {
            principal(point)?.directions.map(|both| both[0])
        }),
    ]
}

fn metric(points: &Points, sample: &Sample<'_>) -> Vec<Field> {
    let [a, b] = &sample.coordinates;
    let field = |name: &str, pair: [Dimension; 2], meaning: &str, of: fn(Metric) -> f64| {
        points.scalar(name, &unit_of_metric(pair), meaning, |point| point.metric.map(of))
    };
    let (one, two) = (&a.name, &b.name);
    let along = |name: &str| format!("square of the arc length along the surface for a step of `{name}` alone");
    let mixed = format!("product of the arc lengths for steps of `{one}` and `{two}`, times the cosine of their angle");
    vec![
        field("metric_e", [a.dimension; 2], &along(one), |metric| metric.e),
        field("metric_f", [a.dimension, b.dimension], &mixed, |metric| metric.f),
        field("metric_g", [b.dimension; 2], &along(two), |metric| metric.g),
    ]
}

/// mm² per unit of each of two coordinates, which are mm or radians inside.
fn unit_of_metric(coordinates: [Dimension; 2]) -> String {
    units::inside(Dimension::LENGTH.power(2).over(coordinates[0].times(coordinates[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_a_metric() {
        let unit = |a, b| unit_of_metric([a, b]);
        assert_eq!(unit(Dimension::LENGTH, Dimension::LENGTH), "1");
        assert_eq!(unit(Dimension::ANGLE, Dimension::ANGLE), "mm^2/rad^2");
        assert_eq!(unit(Dimension::ANGLE, Dimension::LENGTH), "mm/rad");
        assert_eq!(unit(Dimension::NUMBER, Dimension::NUMBER), "mm^2");
        assert_eq!(unit(Dimension::LENGTH.power(2), Dimension::LENGTH.power(2)), "1/mm^2");
    }
}

//! `flank solve --geometry`: what a surface is like at its points.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job, Process, Sample};
use flank_export::{Field, Known, Values};
use flank_solver::{Metric, Outcome, PointGeometry, Principal, SurfaceGeometry, SurfacePoint};
use rayon::prelude::*;

use crate::project::units;
use crate::solve::surface::bound;

/// Points that threads share out at once: of no more all that is known is held.
pub(crate) const TOGETHER: usize = 4096;

type Vector = [f64; 3];

/// Curvatures with their directions, contact, and the metric of the sample's coordinates, at each of the points.
pub(crate) fn fields<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
    points: &[SurfacePoint],
) -> Vec<Field> {
    let mut described = Described::new(job, surface, sample, points.len());
    points.chunks(TOGETHER).for_each(|points| described.add(points));
    described.fields()
}

/// The same, of points that are handed over in order.
pub(crate) struct Described<'s> {
    geometry: SurfaceGeometry,
    columns: Vec<Column<'s>>,
}

impl<'s> Described<'s> {
    /// Of so many points.
    pub(crate) fn new<'g>(
        job: &Job<'g>,
        surface: &'s GeneratedSurface<'g>,
        sample: &'s Sample<'g>,
        points: usize,
    ) -> Described<'s> {
        let coordinates = sample.functions();
        let motions = &surface.generation.motions;
        let geometry = SurfaceGeometry::new(&bound(job, surface), motions, coordinates)
            .expect("a job without errors leaves nothing unbound");
        Described { geometry, columns: columns(surface, sample, points) }
    }

    /// The next points, on all threads at once: a few thousand are enough.
    pub(crate) fn add(&mut self, points: &[SurfacePoint]) {
        let geometry = &self.geometry;
        let at = |point: &SurfacePoint| (point.outcome == Outcome::Solved).then(|| geometry.at(&point.unknowns));
        let found: Vec<Option<PointGeometry>> = points.par_iter().map(at).collect();
        found.iter().for_each(|known| self.columns.iter_mut().for_each(|column| column.take(known.as_ref())));
    }

    pub(crate) fn fields(self) -> Vec<Field> {
        self.columns.into_iter().map(Column::field).collect()
    }
}

/// How many numbers a point has in these fields.
pub(crate) fn numbers(surface: &GeneratedSurface<'_>, sample: &Sample<'_>) -> usize {
    columns(surface, sample, 0)
        .iter()
        .map(|column| if matches!(column.taken, Taken::Scalars(..)) { 1 } else { 3 })
        .sum()
}

/// A field that is being filled, point by point.
struct Column<'s> {
    name: String,
    unit: String,
    meaning: String,
    taken: Taken<'s>,
}

type Of<'s, T> = Box<dyn Fn(&PointGeometry) -> Option<T> + 's>;

/// What it takes from a point that is solved, and its values so far.
enum Taken<'s> {
    Scalars(Of<'s, f64>, Known<f64>),
    Vectors(Of<'s, Vector>, Known<Vector>),
}

impl Taken<'_> {
    fn reserve(&mut self, points: usize) {
        match self {
            Taken::Scalars(_, values) => *values = Known::with_capacity(points),
            Taken::Vectors(_, values) => *values = Known::with_capacity(points),
        }
    }
}

impl<'s> Column<'s> {
    fn scalar(name: &str, unit: &str, meaning: &str, of: impl Fn(&PointGeometry) -> Option<f64> + 's) -> Column<'s> {
        let taken = Taken::Scalars(Box::new(of), Known::with_capacity(0));
        Column { name: name.into(), unit: unit.into(), meaning: meaning.into(), taken }
    }

    fn vector(name: &str, unit: &str, meaning: &str, of: impl Fn(&PointGeometry) -> Option<Vector> + 's) -> Column<'s> {
        let taken = Taken::Vectors(Box::new(of), Known::with_capacity(0));
        Column { name: name.into(), unit: unit.into(), meaning: meaning.into(), taken }
    }

    fn take(&mut self, point: Option<&PointGeometry>) {
        match &mut self.taken {
            Taken::Scalars(of, values) => values.push(point.and_then(of)),
            Taken::Vectors(of, values) => values.push(point.and_then(of)),
        }
    }

    fn field(self) -> Field {
        let values = match self.taken {
            Taken::Scalars(_, values) => Values::Scalars(values),
            Taken::Vectors(_, values) => Values::Vectors(values),
        };
        Field { name: self.name, unit: self.unit, meaning: self.meaning, values }
    }
}

/// With room for so many points.
fn columns<'s>(surface: &'s GeneratedSurface<'_>, sample: &'s Sample<'_>, points: usize) -> Vec<Column<'s>> {
    let mut columns = bending();
    columns.extend(contact(surface));
    columns.extend(metric(sample));
    columns.iter_mut().for_each(|column| column.taken.reserve(points));
    columns
}

fn bending<'s>() -> Vec<Column<'s>> {
    let principal = |point: &PointGeometry| point.curvature.map(|curvature| curvature.principal());
    let direction = |k: usize| move |point: &PointGeometry| principal(point)?.directions.map(|both| both[k]);
    vec![
        Column::scalar("k1", "1/mm", "larger principal curvature, positive where the body is convex", move |point| {
            principal(point).map(|principal| principal.k1)
        }),
        Column::scalar("k2", "1/mm", "smaller principal curvature, positive where the body is convex", move |point| {
            principal(point).map(|principal| principal.k2)
        }),
        Column::vector("d1", "1", "unit direction of k1; d1, d2 and the normal are right-handed", direction(0)),
        Column::vector("d2", "1", "unit direction of k2", direction(1)),
    ]
}

/// How tool and work touch, as far as there is something to say: with no motion they are the same surface.
fn contact<'s>(surface: &'s GeneratedSurface<'_>) -> Vec<Column<'s>> {
    let motions = &surface.unknowns[surface.unknowns.len() - surface.generation.motions.len()..];
    let mut columns: Vec<Column<'s>> = Vec::new();
    for (k, motion) in motions.iter().enumerate() {
        let name = format!("sliding_{}", motion.name);
        let meaning = format!("velocity of the tool's point against the work along the motion `{}`", motion.name);
        let unit = if motion.dimension == Dimension::ANGLE { "mm/rad" } else { "mm/mm" };
        columns.push(Column::vector(&name, unit, &meaning, move |point| point.contact.sliding[k]));
    }
    if motions.len() == 1 {
        let meaning = "unit direction of the line along which tool and work touch at the instant";
        columns.push(Column::vector("contact_line", "1", meaning, |point| point.contact.line));
        let meaning = "angle between the contact line and the sliding velocity, 0 to 90";
        let degrees = |point: &PointGeometry| point.contact.sliding_angle().map(f64::to_degrees);
        columns.push(Column::scalar("sliding_angle", "deg", meaning, degrees));
    }
    if !motions.is_empty() && surface.generation.process != Process::Sweep {
        columns.extend(induced());
    }
    columns
}

fn induced<'s>() -> Vec<Column<'s>> {
    let principal =
        |point: &PointGeometry| -> Option<Principal> { point.contact.induced.map(|induced| induced.principal()) };
    let meaning = "normal curvature of the gap between tool and work; negative where the tool cuts into the surface";
    vec![
        Column::scalar("induced_k1", "1/mm", &format!("largest {meaning}"), move |point| {
            principal(point).map(|p| p.k1)
        }),
        Column::scalar("induced_k2", "1/mm", &format!("smallest {meaning}"), move |point| {
            principal(point).map(|p| p.k2)
        }),
        Column::vector("induced_d1", "1", "unit direction of induced_k1", move |point| {
            principal(point)?.directions.map(|both| both[0])
        }),
    ]
}

fn metric<'s>(sample: &'s Sample<'_>) -> Vec<Column<'s>> {
    let [a, b] = &sample.coordinates;
    let column = |name: &str, pair: [Dimension; 2], meaning: &str, of: fn(Metric) -> f64| {
        Column::scalar(name, &unit_of_metric(pair), meaning, move |point| point.metric.map(of))
    };
    let (one, two) = (&a.name, &b.name);
    let along = |name: &str| format!("square of the arc length along the surface for a step of `{name}` alone");
    let mixed = format!("product of the arc lengths for steps of `{one}` and `{two}`, times the cosine of their angle");
    vec![
        column("metric_e", [a.dimension; 2], &along(one), |metric| metric.e),
        column("metric_f", [a.dimension, b.dimension], &mixed, |metric| metric.f),
        column("metric_g", [b.dimension; 2], &along(two), |metric| metric.g),
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

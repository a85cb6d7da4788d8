//! `flank solve --certify`: proofs that points lie where they are reported.

use flank_export::{Field, Values};
use flank_solver::{Outcome, SurfacePoint, SurfaceProblem};

use crate::project::remark::{NotDone, NotDoneKind};
use crate::solve::result::Certified;
use crate::solve::solved::Solved;

/// The radius of each solved point of a surface, in mm; `None` where nothing could be proven.
pub(crate) fn radii(problem: &SurfaceProblem, targets: &[[f64; 2]], points: &[SurfacePoint]) -> Vec<Option<f64>> {
    let mut certifier = problem.certifier();
    let certify = |(point, target): (&SurfacePoint, &[f64; 2])| match point.outcome {
        Outcome::Solved => certifier.radius(*target, point),
        _ => None,
    };
    points.iter().zip(targets).map(certify).collect()
}

/// The radii as files show them.
pub(crate) fn field(radii: &[Option<f64>]) -> Field {
    Field {
        name: "certified_radius".into(),
        unit: "mm".into(),
        meaning: "exactly one point of the surface with these coordinates is proven to lie this near".into(),
        values: Values::Scalars(radii.iter().copied().collect()),
    }
}

/// How many points of a surface are certified, and the largest radius, mm; `None` if that was not asked for.
pub(crate) fn proven(solved: &Solved<'_, '_>) -> Option<Certified> {
    let radii = solved.radii.as_ref()?.iter().copied().flatten();
    Some(Certified { points: radii.clone().count(), radius: radii.reduce(f64::max) })
}

/// The solved points that could not be certified, by row and column, from 0.
pub(crate) fn failed(solved: &[Solved<'_, '_>]) -> Vec<NotDone> {
    let mut all = Vec::new();
    for (solved, radii) in solved.iter().filter_map(|solved| Some((solved, solved.radii.as_ref()?))) {
        let columns = solved.sample.counts[1];
        let open = |(index, (point, radius)): (usize, (&SurfacePoint, &Option<f64>))| {
            let is_open = point.outcome == Outcome::Solved && radius.is_none();
            is_open.then(|| format!("({}, {})", index / columns, index % columns))
        };
        let open: Vec<String> = solved.points.iter().zip(radii).enumerate().filter_map(open).collect();
        if !open.is_empty() {
            let (name, count) = (&solved.surface.name, open.len());
            let message = format!("not certified: {count} points of {name} (row, column): {}", open.join(" "));
            all.push(NotDone::new(NotDoneKind::NotCertified, name, message));
        }
    }
    all
}

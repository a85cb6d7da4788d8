//! Where the normals of points meet another surface, and points all over that from which this is looked for.

use flank_expr::geometry::Vector3;
use flank_expr::{Expr, ScalarEvaluator, Tape, TapeError};

use crate::analysis::deviation::FARTHEST;
use crate::equations::solution::{Outcome, Range};
use crate::equations::system::System;
use crate::newton::multistart::probe;
use crate::newton::scalar::{solve, solve_with};
use crate::surface::bound::BoundSurface;
use crate::surface::points::SurfacePoint;

/// Places in the ranges of a surface from which its points are looked for: sixteen in each of two directions.
const PROBES: u32 = 256;
/// A point from which others are looked for need not solve the surface's equations better.
const NEARLY: f64 = 1e-6;
/// Points from which a foot is looked for: the nearest ones. Where a motion comes round, two lie at one place.
const NEAREST: usize = 2;

/// A surface that the normals of other surfaces' points may meet.
#[derive(Clone, Debug)]
pub(crate) struct Feet {
    /// Unknowns of the surface and a distance; a point and its normal are parameters.
    system: System,
    ranges: Vec<Range>,
    /// Points all over the surface.
    pub(crate) seeds: Vec<SurfacePoint>,
}

/// Where the normal of a point meets the surface.
#[derive(Clone, Debug)]
pub(crate) struct Foot {
    pub(crate) unknowns: Vec<f64>,
    /// How far that is along the normal, mm.
    pub(crate) distance: f64,
}

impl Feet {
    pub(crate) fn new(surface: &BoundSurface<'_>) -> Result<Feet, TapeError> {
        let bound = surface.surface();
        let graph = bound.position.0[0].graph();
        let vector = |names: [&str; 3]| Vector3(names.map(|name| graph.variable(name)));
        let (point, normal) = (vector(["point x", "point y", "point z"]), vector(["normal x", "normal y", "normal z"]));
        let distance = graph.variable("distance");
        let apart = bound.position - point - normal.map(|part| part * distance);
        let unknowns: Vec<Expr<'_>> = bound.unknowns.iter().copied().chain([distance]).collect();
        let parameters: Vec<Expr<'_>> = point.0.into_iter().chain(normal.0).collect();
        Ok(Feet {
            system: System::one_by_one(&surface.constrained(apart.0), &unknowns, &parameters)?,
            ranges: [surface.ranges(), &[FARTHEST]].concat(),
            seeds: seeds(surface)?,
        })
    }

    /// The feet of points along a line: of each the nearest one that is found from the one before and from the nearest points of the
    /// surface.
    pub(crate) fn along(&self, points: &[&SurfacePoint]) -> Vec<Option<Foot>> {
        let mut last: Option<Foot> = None;
        let mut feet = Vec::with_capacity(points.len());
        for point in points {
            let starts = last.iter().cloned().chain(self.nearest(point));
            let found = starts.filter_map(|start| self.from(point, &start));
            let foot = found.min_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()));
            last = foot.clone().or(last);
            feet.push(foot);
        }
        feet
    }

    fn from(&self, point: &SurfacePoint, start: &Foot) -> Option<Foot> {
        let parameters = [point.position, point.normal].concat();
        let start = [&start.unknowns[..], &[start.distance]].concat();
        let solution = solve(&self.system, &self.ranges, &parameters, &start);
        let (distance, unknowns) = solution.unknowns.split_last()?;
        (solution.outcome == Outcome::Solved).then(|| Foot { unknowns: unknowns.to_vec(), distance: *distance })
    }

    /// The nearest points of the surface, which are feet almost.
    fn nearest(&self, point: &SurfacePoint) -> impl Iterator<Item = Foot> {
        let mut seeds: Vec<(f64, &SurfacePoint)> =
            self.seeds.iter().map(|seed| (squared_distance(point, seed), seed)).collect();
        if NEAREST < seeds.len() {
            seeds.select_nth_unstable_by(NEAREST, |a, b| a.0.total_cmp(&b.0));
        }
        seeds.into_iter().take(NEAREST).map(|(_, seed)| Foot {
            unknowns: seed.unknowns.clone(),
            distance: (0..3).map(|k| (seed.position[k] - point.position[k]) * point.normal[k]).sum(),
        })
    }
}

/// Points all over a surface that its tool leaves, whatever branches it has: places that fill its ranges, each brought onto it by the
/// shortest steps. They are near it rather than on it.
fn seeds(surface: &BoundSurface<'_>) -> Result<Vec<SurfacePoint>, TapeError> {
    let (bound, ranges) = (surface.surface(), surface.ranges());
    let zero = bound.position.0[0].graph().constant(0.0);
    // two equations that say nothing make the system square, and leave Newton the shortest step
    let residuals = surface.constrained([zero; 2]);
    let conditions = bound.clearance_minors();
    let system = System::one_by_one(&residuals, &bound.unknowns, &[])?.with_conditions(
        &residuals,
        &conditions,
        &[],
        &bound.unknowns,
    )?;
    let point: Vec<Expr<'_>> = bound.position.0.into_iter().chain(bound.normal.0).collect();
    let point = Tape::new(&point, &bound.unknowns)?;
    let (mut evaluation, mut evaluator) = (system.evaluation(&[]), ScalarEvaluator::new(&point));
    let seeds = (1..=PROBES).filter_map(|k| {
        let solution = solve_with(&mut evaluation, ranges, &probe(ranges, k));
        let is_inside = !matches!(solution.outcome, Outcome::Outside { .. }) && solution.residual <= NEARLY;
        let is_left = is_inside && evaluation.conditions.side(&solution.unknowns) == Outcome::Solved;
        let mut placed = [0.0; 6];
        evaluator.run(&solution.unknowns, &mut placed);
        let [x, y, z, nx, ny, nz] = placed;
        (is_left && Outcome::Solved.of_placed(&placed) == Outcome::Solved).then_some(SurfacePoint {
            outcome: Outcome::Solved,
            unknowns: solution.unknowns,
            position: [x, y, z],
            normal: [nx, ny, nz],
            residual: solution.residual,
        })
    });
    Ok(seeds.collect())
}

pub(crate) fn squared_distance(a: &SurfacePoint, b: &SurfacePoint) -> f64 {
    a.position.iter().zip(b.position).map(|(a, b)| (a - b) * (a - b)).sum()
}

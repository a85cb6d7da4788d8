//! Places along the edges of a tooth, on its flank.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_solver::{Outcome, OutlineSegment, SurfacePoint};

use crate::contact::pair::Members;
use crate::project::session::Session;
use crate::solve::{self, blank};

/// Places along each edge.
const PLACES: usize = 9;
/// An edge is one of a flank whose points come so near to it, as a share of the way across them.
const BESIDE: f64 = 0.3;

/// Points of a flank along the segments of its outline at which it ends.
pub(super) fn edges(job: &Job<'_>, members: &Members<'_, '_>, flank: usize, session: Session) -> Vec<SurfacePoint> {
    let (surface, Some(solid)) = (members.surfaces[flank], members.solids[flank]) else { return Vec::new() };
    let solved: Vec<&SurfacePoint> =
        members.points[flank].iter().filter(|point| point.outcome == Outcome::Solved).collect();
    let outline = blank::outline(solid);
    let along = |segment: &OutlineSegment| along(job, surface, segment, (&solved, session));
    outline.segments().iter().flat_map(along).collect()
}

fn along<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    segment: &OutlineSegment,
    (solved, session): (&[&SurfacePoint], Session),
) -> Vec<SurfacePoint> {
    let section = |point: &SurfacePoint| [point.position[2], point.position[0].hypot(point.position[1])];
    let off = |point: &SurfacePoint| {
        let [z, rho] = section(point);
        let [near_z, near_rho] = segment.nearest([z, rho]);
        (z - near_z).hypot(rho - near_rho)
    };
    let ends = |k: usize| {
        let values = solved.iter().map(|point| section(point)[k]);
        values.fold([f64::MAX, f64::MIN], |[low, high], x| [low.min(x), high.max(x)])
    };
    let [[z0, z1], [rho0, rho1]] = [ends(0), ends(1)];
    let Some(near) = solved.iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { return Vec::new() };
    if off(near) > BESIDE * (z1 - z0).min(rho1 - rho0) {
        return Vec::new();
    }
    let [x, y, z] = surface.surface.position.0;
    let problem = solve::problem(job, surface, [z, (x * x + y * y).sqrt()], session);
    let places = segment.places(PLACES);
    let (points, _) = problem.solve_points(&places, [1, PLACES], Some(&near.unknowns), None);
    (0..points.len()).map(|k| points.point(k)).filter(|point| point.outcome == Outcome::Solved).collect()
}

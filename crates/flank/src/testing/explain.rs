//! Which setting explains best how surfaces moved.

use flank_chain_dsl::Dimension;
use flank_solver::{NormalSensitivity, SurfacePoint};

use crate::testing::points::Tested;

/// A surface that moved.
pub(super) struct Moved {
    pub(super) surface: usize,
    /// As it is now.
    pub(super) points: Vec<SurfacePoint>,
    /// How far each point moved along its normal, mm.
    pub(super) by: Vec<Option<f64>>,
}

/// A setting, and how much of it explains what moved.
pub(super) struct Explanation {
    pub(super) name: String,
    pub(super) dimension: Dimension,
    /// The change of the setting, mm or radians.
    pub(super) by: f64,
    /// How much of the squares of what moved it explains.
    pub(super) share: f64,
}

/// Settings that explain less are none of the reasons.
const LEAST: f64 = 0.05;

/// The settings of a job by how much of what moved they explain to first order, each by itself.
pub(super) fn explained(tested: &Tested<'_, '_>, moved: &[Moved]) -> Vec<Explanation> {
    let squares: f64 = moved.iter().flat_map(|of| of.by.iter().flatten()).map(|by| by * by).sum();
    if squares == 0.0 {
        return Vec::new();
    }
    let job = tested.job;
    let places: Vec<usize> = (0..job.parameters.len()).filter(|k| !job.parameters[*k].is_count).collect();
    // the sums of products with what moved, and with itself, of each setting
    let mut sums = vec![[0.0; 2]; places.len()];
    for of in moved {
        let surface = tested.surface(of.surface);
        let parameters = job.parameters.iter();
        let parameters: Vec<flank_solver::Parameter<'_>> = parameters
            .map(|of| flank_solver::Parameter { variable: of.variable, definition: of.definition, value: of.value })
            .collect();
        let exact =
            NormalSensitivity::new(&surface.surface, &parameters).expect("a job without errors leaves nothing unbound");
        let (displacements, _) = exact.over(&of.points, &places);
        for (sum, displacement) in sums.iter_mut().zip(displacements) {
            for (by, moves) in of.by.iter().zip(displacement.at_points) {
                let Some(by) = by.filter(|_| moves.is_finite()) else { continue };
                sum[0] += by * moves;
                sum[1] += moves * moves;
            }
        }
    }
    let found = places.iter().zip(sums).filter(|(_, [_, own])| *own > 0.0).map(|(k, [both, own])| {
        let parameter = &job.parameters[*k];
        Explanation {
            name: parameter.name.clone(),
            dimension: parameter.dimension,
            by: both / own,
            share: both * both / (own * squares),
        }
    });
    let mut found: Vec<Explanation> = found.filter(|one| one.share > LEAST).collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found
}

//! What `flank solve` reports of its work.

use flank_chain_dsl::{Dimension, GeneratedSurface, Job};

use crate::project::quantity::Extent;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::spec::Origin;
use crate::solve::arrays::PointGrid;
use crate::solve::branches;
use crate::solve::certify;
use crate::solve::cut::Cut;
use crate::solve::fields;
use crate::solve::limits::Line;
use crate::solve::reasons;
use crate::solve::required;
use crate::solve::result::{LineResult, PointSummary, SurfaceResult};
use crate::solve::sensitivity::Sensitivity;
use crate::solve::solved::Solved;
use crate::solve::summary::{Ends, Summary};
use crate::solve::unsolved;

impl Solved<'_, '_> {
    /// Its points, counted.
    pub(crate) fn told(&self) -> PointSummary {
        summary(&self.surface.name, self.surface, &self.summary)
    }

    /// Its result, without its points.
    pub(crate) fn result(&self) -> SurfaceResult {
        SurfaceResult {
            summary: self.told(),
            evaluations: self.effort.evaluations,
            fields: fields::extents(self),
            cut: self.cut.as_ref().map(Cut::heights),
            sensitivity: self.sensitivity.as_ref().map(Sensitivity::table),
            branches: branches::search(self),
            tool_positions: self.positions.told(),
            not_as_required: required::told(self),
            certified: certify::proven(self),
            points: PointGrid::default(),
        }
    }

    /// The same with all points, unless there are too many to keep.
    pub(crate) fn into_result(mut self) -> SurfaceResult {
        let moved: Vec<_> = self.sensitivity.iter().flat_map(Sensitivity::fields).collect();
        let points = match (&self.streamed, self.arrays.take()) {
            (Some(streamed), Some(grid)) => grid.with_fields(streamed.fields()),
            (Some(_), None) => {
                PointGrid::of_surface(self.surface, &self.surface.name, ([0; 2], self.sample.labels.clone()))
            }
            (None, _) => {
                PointGrid::of_surface(self.surface, &self.surface.name, (self.counts(), self.sample.labels.clone()))
                    .with_points(&self.points)
                    .with_fields(self.fields.iter().chain(&moved))
            }
        };
        SurfaceResult { points, ..self.result() }
    }
}

impl Line<'_, '_> {
    /// Its points, counted, and its points.
    pub(crate) fn result(&self) -> LineResult {
        let labels = [String::new(), "along the line".to_string()];
        let points =
            PointGrid::of_surface(self.surface, &self.name, ([1, self.points.len()], labels)).with_points(&self.points);
        LineResult { summary: self.told(), points }
    }

    /// Its points, counted.
    pub(crate) fn told(&self) -> PointSummary {
        summary(&self.name, self.surface, &self.summary)
    }
}

/// Radius and z in the work's frame, then the unknowns.
fn summary(name: &str, surface: &GeneratedSurface<'_>, of: &Summary) -> PointSummary {
    let length = |name: &str, ends: Ends| Extent::new(name, Dimension::LENGTH, ends.0);
    let unknowns = surface.unknowns.iter().zip(&of.unknowns);
    let unknowns = unknowns.map(|(unknown, ends)| Extent::new(&unknown.name, unknown.dimension, ends.0));
    PointSummary {
        name: name.to_string(),
        frame: surface.frame.clone(),
        asked: of.asked,
        solved: of.solved(),
        outcomes: of.outcomes.clone(),
        worst_residual: of.worst_residual,
        ranges_reached: [length("rho", of.rho), length("z", of.z)].into_iter().chain(unknowns).collect(),
        outside: reasons::outside(surface, of),
    }
}

/// What was not done of points: branches that nothing chooses between, requirements that do not hold, points that are not solved.
pub(crate) fn failures(of: (&Job<'_>, Option<&Origin>), solved: &[Solved<'_, '_>]) -> Vec<NotDone> {
    let unsolved = solved.iter().filter_map(|one| unsolved(of, one, solved));
    branches::ambiguous(solved).into_iter().chain(required::missed(solved)).chain(unsolved).collect()
}

/// How many points of a surface were asked for and not solved, and why.
fn unsolved(of: (&Job<'_>, Option<&Origin>), solved: &Solved<'_, '_>, all: &[Solved<'_, '_>]) -> Option<NotDone> {
    let (asked, name) = (solved.summary.asked, &solved.surface.name);
    let missing = asked - solved.summary.solved();
    (missing > 0).then(|| {
        let message = format!("not solved: {missing} of {asked} points of {name}");
        NotDone::new(NotDoneKind::NotSolved, name, message).with(unsolved::reasons(of, solved, all))
    })
}

//! `trim flank by fillet`: what one surface of a job cuts away of another.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_solver::{Intersection, SurfacePoint, trim};

use crate::limits::Line;
use crate::solve::ranges;

/// Marks the points of the first surface that the second cuts away, with the number of this trim, and gives back the line
/// where the two meet.
pub(crate) fn cut<'j, 'g>(
    job: &Job<'g>,
    [surface, by]: [&'j GeneratedSurface<'g>; 2],
    sample: &Sample<'g>,
    points: &mut [SurfacePoint],
    number: usize,
) -> Line<'j, 'g> {
    let coordinates = [sample.coordinates[0].value, sample.coordinates[1].value];
    let both = [ranges(surface), ranges(by)];
    let intersection = Intersection::new([&surface.surface, &by.surface], coordinates, both, &job.bindings())
        .expect("a job without errors leaves nothing unbound");
    let meetings = trim(points, &sample.targets, sample.counts, &intersection, number);
    Line {
        surface,
        name: format!("{}.trimmed_by_{}", surface.name, by.name),
        kind: "intersection",
        along: sample.labels.join(", then "),
        points: meetings.into_iter().map(|meeting| meeting.first).collect(),
    }
}

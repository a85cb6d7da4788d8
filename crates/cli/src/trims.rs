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
    let [on_columns, on_rows] = trim(points, &sample.targets, sample.counts, &intersection, number);
    // whichever cross the line oftener show more of it; on the columns it runs along the rows
    let (meetings, along) =
        if on_columns.len() < on_rows.len() { (on_rows, &sample.labels[0]) } else { (on_columns, &sample.labels[1]) };
    Line {
        surface,
        name: format!("{}.trimmed_by_{}", surface.name, by.name),
        kind: "intersection",
        along: along.clone(),
        points: meetings.into_iter().map(|meeting| meeting.first).collect(),
        several: 1,
    }
}

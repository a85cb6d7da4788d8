//! `trim flank by fillet`: what one surface of a job cuts away of another.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_solver::{SurfacePoint, Trim};

use crate::project::session::Session;
use crate::solve::limits::Line;
use crate::solve::summary::Summary;
use crate::solve::surface::{bound, problem};

/// Marks the points of the first surface that the second cuts away, with the number of this trim, and gives back the line
/// where the two meet.
pub(crate) fn cut<'j, 'g>(
    job: &Job<'g>,
    [surface, by]: [&'j GeneratedSurface<'g>; 2],
    sample: &Sample<'g>,
    points: &mut [SurfacePoint],
    (number, session): (usize, Session),
) -> Line<'j, 'g> {
    let coordinates = sample.functions();
    let both = [surface, by].map(|surface| bound(job, surface));
    let trim = Trim { surfaces: both.each_ref(), coordinates, number };
    let points_of_by = |coordinates| problem(job, by, coordinates, session);
    let [on_columns, on_rows] = trim
        .apply(points, (&sample.targets(), sample.counts), &points_of_by)
        .expect("a job without errors leaves nothing unbound");
    // whichever cross the line oftener show more of it; on the columns it runs along the rows
    let (meetings, along) =
        if on_columns.len() < on_rows.len() { (on_rows, &sample.labels[0]) } else { (on_columns, &sample.labels[1]) };
    let points: Vec<SurfacePoint> = meetings.into_iter().map(|meeting| meeting.first).collect();
    Line {
        surface,
        name: format!("{}.trimmed_by_{}", surface.name, by.name),
        kind: "intersection",
        trimmed_by: Some(by.name.clone()),
        along: along.clone(),
        summary: Summary::of_points(surface.unknowns.len(), [1, points.len()], &points),
        points,
        several: 1,
        is_open: false,
    }
}

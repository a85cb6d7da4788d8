//! `trim flank by fillet`: what one surface of a job cuts away of another.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_solver::{Meeting, SurfacePoint, Trim, TrimmedBy};

use crate::project::session::Session;
use crate::solve::limits::Line;
use crate::solve::secondary::{is_of_same_tool, positions_of_other, tool_positions};
use crate::solve::summary::Summary;
use crate::solve::surface::{bound, problem};

/// Marks the points of a surface that those which trim it cut away, with the number of each trim, and gives back the line where it meets
/// each of them, in their order. What one tool makes along the same motions bounds one body, which is looked at as one.
pub(crate) fn cut<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &Sample<'g>,
    points: &mut [SurfacePoint],
    session: Session,
) -> Vec<Line<'j, 'g>> {
    let own = bound(job, surface);
    let all: Vec<&GeneratedSurface<'g>> = surface.trimmed_by.iter().map(|&by| &job.surfaces[by]).collect();
    let mut lines: Vec<Option<Line<'j, 'g>>> = all.iter().map(|_| None).collect();
    for first in 0..all.len() {
        if lines[first].is_some() {
            continue;
        }
        let together: Vec<usize> =
            (first..all.len()).filter(|&k| k == first || is_of_same_tool(all[first], all[k])).collect();
        let bounds: Vec<_> = together.iter().map(|&k| bound(job, all[k])).collect();
        let by = |(bound, &number)| {
            let positions = positions_of_other(job, surface, (all[number], number));
            TrimmedBy { surface: bound, number, positions }
        };
        let by = bounds.iter().zip(&together).map(by).collect();
        let tool = (together.len() > 1).then(|| tool_positions(job, all[first], &job.bindings()).ok()).flatten();
        let trim = Trim { surface: &own, by, tool, coordinates: sample.functions() };
        let points_of_by = |place: usize, coordinates| problem(job, all[together[place]], coordinates, session);
        let met = trim
            .apply(points, (&sample.targets(), sample.counts), &points_of_by)
            .expect("a job without errors leaves nothing unbound");
        for (&k, met) in together.iter().zip(met) {
            lines[k] = Some(line([surface, all[k]], sample, met));
        }
    }
    lines.into_iter().flatten().collect()
}

/// The line in which the first surface meets the second.
fn line<'j, 'g>(
    [surface, by]: [&'j GeneratedSurface<'g>; 2],
    sample: &Sample<'g>,
    [on_columns, on_rows]: [Vec<Meeting>; 2],
) -> Line<'j, 'g> {
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

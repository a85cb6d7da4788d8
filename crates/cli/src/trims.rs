//! `trim flank by fillet`: what one surface of a job cuts away of another.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_solver::{CutBy, Deviation, Intersection, Outcome, SurfacePoint, trim};

use crate::arguments::Means;
use crate::limits::Line;
use crate::solve::{problem, ranges};
use crate::summary::Summary;

/// Marks the points of the first surface that the second cuts away, with the number of this trim, and gives back the line
/// where the two meet. Where they meet nowhere, the one that lies deeper in the steel has taken all of the other.
pub(crate) fn cut<'j, 'g>(
    job: &Job<'g>,
    [surface, by]: [&'j GeneratedSurface<'g>; 2],
    sample: &Sample<'g>,
    points: &mut [SurfacePoint],
    (number, means): (usize, Means),
) -> Line<'j, 'g> {
    let coordinates = [sample.coordinates[0].value, sample.coordinates[1].value];
    let both = [ranges(surface), ranges(by)];
    let intersection = Intersection::new([&surface.surface, &by.surface], coordinates, both, &job.bindings())
        .expect("a job without errors leaves nothing unbound");
    let [on_columns, on_rows] = trim(points, &sample.targets(), sample.counts, &intersection, number);
    if on_columns.is_empty() && on_rows.is_empty() {
        for at in deeper(job, [surface, by], sample, points, means) {
            points[at].outcome = Outcome::CutAway(CutBy::Other(number));
        }
    }
    // whichever cross the line oftener show more of it; on the columns it runs along the rows
    let (meetings, along) =
        if on_columns.len() < on_rows.len() { (on_rows, &sample.labels[0]) } else { (on_columns, &sample.labels[1]) };
    let points: Vec<SurfacePoint> = meetings.into_iter().map(|meeting| meeting.first).collect();
    Line {
        surface,
        name: format!("{}.trimmed_by_{}", surface.name, by.name),
        kind: "intersection",
        along: along.clone(),
        summary: Summary::of(surface.unknowns.len(), [1, points.len()], &points),
        points,
        several: 1,
    }
}

/// Nearer than this, mm, two surfaces lie on each other.
const ON_EACH_OTHER: f64 = 1e-9;

/// The solved points of the first surface below which, along their normals into the steel, the second one lies and faces the same
/// way. It is looked for where the sample asks for points by their place.
fn deeper<'g>(
    job: &Job<'g>,
    [surface, by]: [&GeneratedSurface<'g>; 2],
    sample: &Sample<'g>,
    points: &[SurfacePoint],
    means: Means,
) -> Vec<usize> {
    let place = |k: usize| {
        let name = sample.coordinates[k].name.as_str();
        let is_of_place =
            ["x", "y", "z", "rho"].contains(&name) && surface.unknowns.iter().all(|unknown| unknown.name != name);
        by.coordinates().into_iter().find(|coordinate| is_of_place && coordinate.name == name)
    };
    let (Some(first), Some(second)) = (place(0), place(1)) else { return Vec::new() };
    let (near, _) = problem(job, by, [first.value, second.value], means).solve(&sample.targets(), sample.counts);
    let deviation =
        Deviation::new(&by.surface, ranges(by), &job.bindings()).expect("a job without errors leaves nothing unbound");
    let off = deviation.map(points, &near, 0.0);
    let is_deeper =
        |at: &usize| off[*at].is_some_and(|off| off < -ON_EACH_OTHER) && turned_normal(&near[*at], &points[*at]) > 0.0;
    (0..points.len()).filter(is_deeper).collect()
}

/// The normal of a point, turned about z with it to the polar angle of another one, times the normal of that.
fn turned_normal(point: &SurfacePoint, to: &SurfacePoint) -> f64 {
    let angle = |[x, y, _]: [f64; 3]| y.atan2(x);
    let (sine, cosine) = (angle(to.position) - angle(point.position)).sin_cos();
    let [x, y, z] = point.normal;
    let turned = [x * cosine - y * sine, x * sine + y * cosine, z];
    turned.iter().zip(to.normal).map(|(a, b)| a * b).sum()
}

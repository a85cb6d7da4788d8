//! Surfaces of more points than are kept: solved band after band, as often as they are needed.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_export::{Axis, Banded, Patch, Point, Taker, WriteError};
use flank_solver::{Band, Effort, MOST_AT_ONCE, SurfacePoint, SurfaceProblem};

use crate::arguments::Means;
use crate::progress::Working;
use crate::solve::{Wanted, patch, point, problem};
use crate::summary::Summary;

/// Surfaces of more points are streamed if nothing needs all of them together: kept, each takes about a kilobyte.
const KEPT: usize = 1 << 16;
/// Points that are handed over at once, if rows are not longer than that.
const HANDED_OVER: usize = 8192;
/// Rows, and columns, of a picture.
const DRAWN: usize = 250;

/// A surface that is solved whenever its points are asked for; the points are the same each time.
pub(crate) struct Streamed<'j, 'g> {
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    sample: &'j Sample<'g>,
    problem: SurfaceProblem,
    outline: Patch,
}

/// What is kept of its points.
pub(crate) struct Kept {
    pub(crate) summary: Summary,
    pub(crate) effort: Effort,
    /// Some rows and columns for a picture, and how many of each.
    pub(crate) drawn: Vec<SurfacePoint>,
    pub(crate) counts: [usize; 2],
}

/// Whether the points of a surface are too many to keep.
///
/// # Errors
/// If they are more than can be kept at all and something needs them together: in words, with a way out.
pub(crate) fn is_streamed(
    job: &Job<'_>,
    surface: &GeneratedSurface<'_>,
    sample: &Sample<'_>,
    wanted: Wanted,
) -> Result<bool, String> {
    let count = sample.counts[0] * sample.counts[1];
    match needs_all(job, surface, sample, wanted) {
        Some(what) if count > MOST_AT_ONCE => Err(format!(
            "{} has {count} points, and {what} needs all of them together: ask for {MOST_AT_ONCE} points or fewer, or do \
             without it",
            surface.name,
        )),
        Some(_) => Ok(false),
        None => Ok(count > KEPT),
    }
}

/// What needs all points of a surface together, if something does.
fn needs_all(job: &Job<'_>, surface: &GeneratedSurface<'_>, sample: &Sample<'_>, wanted: Wanted) -> Option<String> {
    let trim = surface.trimmed_by.first().map(|by| ("trim", *by));
    let between = trim.or(surface.cut_by.map(|by| ("cut", by)));
    let between = between.map(|(word, by)| format!("`{word} {} by {}`", surface.name, job.surfaces[by].name));
    let required = sample.limits.first().map(|limit| format!("what its sample requires of `{}`", limit.of.name));
    let flags =
        [(wanted.geometry, "--geometry"), (wanted.sensitivity, "--sensitivity"), (wanted.certificates, "--certify")];
    let flag = flags.into_iter().find_map(|(is_given, name)| is_given.then_some(name));
    between.or(required).or(wanted.together.or(flag).map(str::to_string))
}

impl<'j, 'g> Streamed<'j, 'g> {
    pub(crate) fn new(
        job: &'j Job<'g>,
        surface: &'j GeneratedSurface<'g>,
        sample: &'j Sample<'g>,
        means: Means,
    ) -> Streamed<'j, 'g> {
        let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
        let axis = |k: usize| Axis { label: sample.labels[k].clone(), count: sample.counts[k] };
        Streamed {
            job,
            surface,
            sample,
            problem: problem(job, surface, coordinates, means),
            outline: patch(job, &surface.name, surface, [axis(0), axis(1)], &[]),
        }
    }

    /// Looks at all points.
    pub(crate) fn look(&self) -> Kept {
        let counts = self.sample.counts;
        let step = counts.map(|count| count.div_ceil(DRAWN).max(1));
        let mut summary = Summary::new(self.surface.unknowns.len(), counts);
        let mut drawn = Vec::new();
        let looked = self.solve(|band| {
            for (number, point) in band.points().enumerate() {
                let place = [band.rows().start + number / counts[1], number % counts[1]];
                summary.add(&point);
                if place[0].is_multiple_of(step[0]) && place[1].is_multiple_of(step[1]) {
                    drawn.push(point);
                }
            }
            Ok::<_, std::convert::Infallible>(())
        });
        let Ok(effort) = looked;
        Kept { summary, effort, drawn, counts: [0, 1].map(|k| counts[k].div_ceil(step[k])) }
    }

    pub(crate) fn problem(&self) -> &SurfaceProblem {
        &self.problem
    }

    fn solve<E>(&self, mut each: impl FnMut(&Band<'_>) -> Result<(), E>) -> Result<Effort, E> {
        let working = Working::on(format!("solving {}", self.surface.name));
        let target = |row: usize, column: usize| self.sample.grid.at(row, column);
        self.problem.in_bands(target, self.sample.counts, None, |band| {
            each(band)?;
            working.reached(|| format!("{} of {} rows", band.rows().end, self.sample.counts[0]));
            Ok(())
        })
    }
}

impl Banded for Streamed<'_, '_> {
    fn outline(&self) -> &Patch {
        &self.outline
    }

    fn bands(&self, take: Taker<'_>) -> Result<(), WriteError> {
        let columns = self.sample.counts[1];
        let at_once = (HANDED_OVER / columns.max(1)).max(1) * columns;
        let taken = self.solve(|band| {
            for first in (0..band.len()).step_by(at_once.max(1)) {
                let numbers = first..band.len().min(first + at_once);
                let points: Vec<Point> =
                    numbers.map(|number| point(self.job, self.surface, &band.point(number))).collect();
                take(&points)?;
            }
            Ok(())
        });
        taken.map(|_| ())
    }
}

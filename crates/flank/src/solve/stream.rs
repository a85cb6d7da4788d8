//! Surfaces of more points than are kept: solved band after band, as often as they are needed.
//!
//! What needs all points of a surface together is refused before anything is solved if it would take too much.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_export::{Axis, Banded, Field, Patch, Point, Taker, WriteError};
use flank_solver::{Band, GridReport, MOST_AT_ONCE, SurfacePoint, SurfaceProblem};

use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve::arrays::PointGrid;
use crate::solve::blank;
use crate::solve::geometry::{self, Described, TOGETHER};
use crate::solve::options::SolveOptions;
use crate::solve::points::{patch, point};
use crate::solve::summary::Summary;
use crate::solve::surface::problem;

/// Surfaces of more points are streamed if nothing needs all of them together.
const KEPT: usize = 1 << 16;
/// Bytes that the points of a job may take together where they are kept: what machines of today can spare.
const MOST_BYTES: usize = 1 << 30;
/// Bytes of a point that is kept: verdict, place, normal and residual, as the solver gives them and as they are written, with what the
/// system's memory takes for two lists of unknowns; and of each unknown, and each number of a field.
const OF_POINT: usize = size_of::<SurfacePoint>() + size_of::<Point>() + 2 * 16;
const OF_UNKNOWN: usize = 2 * size_of::<f64>();
const OF_NUMBER: usize = size_of::<f64>();
/// Numbers of a point in arrays beside its unknowns: place, normal, residual and status.
const IN_ARRAYS: usize = 8;
/// Points that are solved at once where numbers are kept of all of them: beside these the bands are small.
const BESIDE_NUMBERS: usize = 1 << 17;
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
    session: Session<'j>,
}

/// Whoever follows the work has cancelled it.
#[derive(Debug, thiserror::Error)]
#[error("cancelled")]
struct Cancelled;

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Failure {
        Failure::Cancelled
    }
}

impl From<Cancelled> for WriteError {
    fn from(cancelled: Cancelled) -> WriteError {
        WriteError::Refused(Box::new(cancelled))
    }
}

/// What is kept of its points.
pub(crate) struct Kept {
    pub(crate) summary: Summary,
    pub(crate) effort: GridReport,
    /// Those in some rows and columns, for pictures.
    pub(crate) drawn: Vec<SurfacePoint>,
    /// All of them in arrays, if these are wanted.
    pub(crate) arrays: Option<PointGrid>,
}

/// What the points of a job take where they are kept.
///
/// # Errors
/// If that is more than they may: in words, with a way out.
pub(crate) fn check_kept<'s, 'g: 's>(
    job: &Job<'g>,
    surfaces: impl IntoIterator<Item = &'s GeneratedSurface<'g>>,
    wanted: SolveOptions,
) -> Result<(), String> {
    let (mut points, mut bytes, mut needed) = (0_usize, 0_usize, None);
    for (surface, sample) in surfaces.into_iter().filter_map(|surface| Some((surface, surface.sample.as_ref()?))) {
        let count = sample.counts[0] * sample.counts[1];
        let all_needed = needs_all(job, surface, sample, wanted);
        points += count;
        bytes += if count <= KEPT || all_needed.is_some() {
            count * bytes_of_point(job, surface, sample, wanted)
        } else {
            let shown = SolveOptions { geometry: wanted.geometry && wanted.of_shown, ..wanted };
            let of_shown = bytes_of_point(job, surface, sample, shown);
            let in_arrays = if wanted.arrays { IN_ARRAYS + surface.unknowns.len() } else { 0 };
            count * OF_NUMBER * (numbers_of_all(surface, sample, wanted) + in_arrays) + DRAWN * DRAWN * of_shown
        };
        let flag = || {
            let flags =
                [(wanted.geometry && !wanted.of_shown, "option `geometry`"), (wanted.arrays, "option `arrays`")];
            flags.into_iter().find_map(|(is_given, name)| is_given.then(|| name.to_string()))
        };
        needed = needed.or(all_needed.or_else(flag).filter(|_| count > KEPT));
    }
    if bytes <= MOST_BYTES {
        return Ok(());
    }
    let (asked, without) = match needed {
        Some(what) => {
            (format!("{points} points, and {what} needs something of all of them at once"), ", or do without it")
        }
        None => (format!("{points} points in many surfaces"), ""),
    };
    Err(format!(
        "job {} asks for {asked}: that would take about {:.1} GB, and {:.1} GB is the most; ask for fewer points, or for fewer \
         surfaces at a time{without}",
        job.name,
        bytes as f64 / 1e9,
        MOST_BYTES as f64 / 1e9
    ))
}

/// Numbers that are kept of each point of a surface whose points are not.
fn numbers_of_all(surface: &GeneratedSurface<'_>, sample: &Sample<'_>, wanted: SolveOptions) -> usize {
    if wanted.geometry && !wanted.of_shown { geometry::numbers(surface, sample) } else { 0 }
}

fn bytes_of_point(job: &Job<'_>, surface: &GeneratedSurface<'_>, sample: &Sample<'_>, wanted: SolveOptions) -> usize {
    let parameters = job.parameters.iter().filter(|parameter| !parameter.is_count).count();
    let geometry = if wanted.geometry { geometry::numbers(surface, sample) } else { 0 };
    let sensitivity = if wanted.sensitivity { parameters } else { 0 };
    let numbers = geometry + sensitivity + 2 * usize::from(wanted.certificates);
    OF_POINT + OF_UNKNOWN * surface.unknowns.len() + OF_NUMBER * numbers
}

/// Whether the points of a surface are too many to keep.
///
/// # Errors
/// If they are more than can be kept at all and something needs them together: in words, with a way out.
pub(crate) fn is_streamed(
    job: &Job<'_>,
    surface: &GeneratedSurface<'_>,
    sample: &Sample<'_>,
    wanted: SolveOptions,
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
fn needs_all(
    job: &Job<'_>,
    surface: &GeneratedSurface<'_>,
    sample: &Sample<'_>,
    wanted: SolveOptions,
) -> Option<String> {
    let trim = surface.trimmed_by.first().map(|by| ("trim", *by));
    let between = trim.or(surface.cut_by.map(|by| ("cut", by)));
    let between = between.map(|(word, by)| format!("`{word} {} by {}`", surface.name, job.surfaces[by].name));
    let solid = blank::of(job, surface).map(|solid| format!("the outline of solid {}", solid.name));
    let required = sample.limits.first().map(|limit| format!("what its sample requires of `{}`", limit.of.name));
    let of_each = |is_given: bool| is_given && !wanted.of_shown;
    let flags = [(of_each(wanted.sensitivity), "option `sensitivity`"), (wanted.certificates, "option `certify`")];
    let flag = flags.into_iter().find_map(|(is_given, name)| is_given.then_some(name));
    between.or(solid).or(required).or(wanted.together.or(flag).map(str::to_string))
}

impl<'j, 'g> Streamed<'j, 'g> {
    pub(crate) fn new(
        job: &'j Job<'g>,
        surface: &'j GeneratedSurface<'g>,
        sample: &'j Sample<'g>,
        wanted: SolveOptions<'j>,
    ) -> Streamed<'j, 'g> {
        let session = wanted.session;
        let coordinates = sample.functions();
        let axis = |k: usize| Axis { label: sample.labels[k].clone(), count: sample.counts[k] };
        let problem = problem(job, surface, coordinates, session);
        let has_numbers = numbers_of_all(surface, sample, wanted) > 0;
        Streamed {
            job,
            surface,
            sample,
            problem: if has_numbers { problem.at_once(BESIDE_NUMBERS) } else { problem },
            outline: patch(job, &surface.name, surface, [axis(0), axis(1)], &[]),
            session,
        }
    }

    /// The rows and the columns that are kept for pictures.
    pub(crate) fn drawn(&self) -> [Vec<usize>; 2] {
        self.sample.counts.map(|count| (0..count).step_by(count.div_ceil(DRAWN).max(1)).collect())
    }

    /// Looks at all points; where they are `described`, files show what each is like, and in arrays they are kept if these are wanted.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn look(&mut self, described: bool, in_arrays: bool) -> Result<Kept, Failure> {
        let counts = self.sample.counts;
        let step = counts.map(|count| count.div_ceil(DRAWN).max(1));
        let mut summary = Summary::new(self.surface.unknowns.len(), counts);
        let mut drawn = Vec::new();
        let mut arrays = in_arrays
            .then(|| PointGrid::of_surface(self.surface, &self.surface.name, (counts, self.sample.labels.clone())));
        let all = counts[0] * counts[1];
        let mut described = described.then(|| Described::new(self.job, self.surface, self.sample, all));
        let effort = self.solve(|band| -> Result<(), Failure> {
            for first in (0..band.len()).step_by(TOGETHER) {
                let numbers = first..band.len().min(first + TOGETHER);
                let points: Vec<SurfacePoint> = numbers.clone().map(|number| band.point(number)).collect();
                described.iter_mut().for_each(|described| described.add(&points));
                for (number, point) in numbers.zip(points) {
                    let place = [band.rows().start + number / counts[1], number % counts[1]];
                    summary.add(&point);
                    arrays.iter_mut().for_each(|arrays| arrays.push(&point));
                    if place[0].is_multiple_of(step[0]) && place[1].is_multiple_of(step[1]) {
                        drawn.push(point);
                    }
                }
            }
            Ok(())
        })?;
        self.outline.fields = described.map_or(Vec::new(), Described::fields);
        Ok(Kept { summary, effort, drawn, arrays })
    }

    /// What is known of each of its points.
    pub(crate) fn fields(&self) -> &[Field] {
        &self.outline.fields
    }

    pub(crate) fn problem(&self) -> &SurfaceProblem {
        &self.problem
    }

    fn solve<E: From<Cancelled>>(&self, mut each: impl FnMut(&Band<'_>) -> Result<(), E>) -> Result<GridReport, E> {
        let begun = self.session.begin(format!("solving {}", self.surface.name));
        let working = begun.map_err(|_| Cancelled)?;
        let target = |row: usize, column: usize| self.sample.grid.at(row, column);
        self.problem.in_bands(target, self.sample.counts, None, |band| {
            each(band)?;
            self.session.check().map_err(|_| Cancelled)?;
            working.reached(&|| format!("{} of {} rows", band.rows().end, self.sample.counts[0]));
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
        let taken = self.solve(|band| -> Result<(), WriteError> {
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

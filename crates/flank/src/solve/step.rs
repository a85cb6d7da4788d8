//! Surfaces as smooth faces of a STEP file, through as many points as it takes.

use flank_chain_dsl::{GeneratedSurface, Job, Sample};
use flank_export::{Axis, Face, Patch};

use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::solve::options::SolveOptions;
use crate::solve::points;
use crate::solve::result::SmoothFace;
use crate::solve::sampled;
use crate::solve::solved::Solved;

/// A finer grid than this is not solved to make a face better.
const MOST_POINTS: usize = 250_000;

/// Rows, and columns, that the face of a larger grid begins with.
const MOST_LINES: usize = 101;

/// A surface's face, if it has one.
pub(crate) struct Smooth {
    pub(crate) face: Option<Face>,
    pub(crate) name: String,
    pub(crate) is_exact_enough: bool,
}

/// The face of a surface, through its sampled points (some of very many) or, where that leaves it off by more than `tolerance` (mm),
/// through grids with twice the rows and columns.
pub(crate) fn smooth<'g>(
    job: &Job<'g>,
    solved: &Solved<'_, 'g>,
    tolerance: f64,
    wanted: SolveOptions,
) -> Result<Smooth, Failure> {
    let surface = solved.surface;
    let working = wanted.session.begin(format!("making a smooth face of {}", surface.name))?;
    let (mut sample, mut coarse) = match thinned(solved.sample) {
        Some(thin) => {
            let points = sampled::points(job, surface, &thin, wanted).points;
            let coarse = patch(job, surface, &thin, &points);
            (thin, coarse)
        }
        None => (solved.sample.clone(), patch(job, surface, solved.sample, &solved.points)),
    };
    let mut best = Smooth { face: None, name: surface.name.clone(), is_exact_enough: false };
    while let Some(face) = Face::through(&coarse) {
        let Some(finer) = finer(&sample) else { break };
        wanted.session.check()?;
        sample = finer;
        working.reached(&|| format!("{} x {} points", sample.counts[0], sample.counts[1]));
        let fine = patch(job, surface, &sample, &sampled::points(job, surface, &sample, wanted).points);
        let face = face.measured(&fine);
        let off = |face: &Face| {
            face.deviation.map_or(f64::INFINITY, |off| if off.missing == 0 { off.largest } else { f64::INFINITY })
        };
        let is_exact_enough = off(&face) <= tolerance;
        // a smooth surface's face comes nearer by sixteen; at a kink, and where only rounding is left, more points do not help
        let is_of_no_use = best.face.as_ref().is_some_and(|before| off(&face) > 0.5 * off(before));
        coarse = fine;
        best = Smooth { face: Some(face), is_exact_enough, ..best };
        if is_exact_enough || is_of_no_use {
            break;
        }
    }
    Ok(best)
}

fn patch<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
    points: &[flank_solver::SurfacePoint],
) -> Patch {
    let axes = [0, 1].map(|k| Axis { label: sample.labels[k].clone(), count: sample.counts[k] });
    points::patch(job, &surface.name, surface, axes, points)
}

/// Rows and columns spread over the sample, the outermost among them, where it is too large to be made finer.
fn thinned<'g>(sample: &Sample<'g>) -> Option<Sample<'g>> {
    if finer(sample).is_some() {
        return None;
    }
    let lines = sample.counts.map(|count| {
        let parts = MOST_LINES.min(count) - 1;
        (0..=parts).map(|part| part * (count - 1) / parts.max(1)).collect::<Vec<usize>>()
    });
    let counts = lines.each_ref().map(Vec::len);
    Some(Sample { counts, grid: sample.grid.picked(&lines), ..sample.clone() })
}

/// The sample with one more row between any two and one more column between any two, half-way; `None` if it would be too large.
fn finer<'g>(sample: &Sample<'g>) -> Option<Sample<'g>> {
    let [rows, columns] = sample.counts.map(|count| 2 * count - 1);
    if rows.checked_mul(columns)? > MOST_POINTS {
        return None;
    }
    Some(Sample { counts: [rows, columns], grid: sample.grid.halved(), ..sample.clone() })
}

/// What the faces are like.
pub(crate) fn told(faces: &[Smooth]) -> Vec<Remark> {
    let told = |smooth: &Smooth| {
        let message = format!("STEP: {}", smooth.face.as_ref()?.told());
        Some(Remark::new(RemarkKind::SmoothFace, &smooth.name, message))
    };
    faces.iter().filter_map(told).collect()
}

/// The same as data.
pub(crate) fn results(faces: &[Smooth]) -> Vec<SmoothFace> {
    let entry = |smooth: &Smooth| {
        let face = smooth.face.as_ref();
        let off = face.and_then(|face| face.deviation);
        SmoothFace {
            surface: smooth.name.clone(),
            counts: face.map(Face::counts),
            left_out: face.map(|face| face.left_out),
            deviation: off.map(|off| off.largest),
            measured: off.map(|off| off.points),
            not_measured: off.map(|off| off.missing),
            is_exact_enough: smooth.is_exact_enough,
        }
    };
    faces.iter().map(entry).collect()
}

/// Which faces are not there, or not as exact as asked for.
pub(crate) fn missed(faces: &[Smooth], tolerance: f64) -> Vec<NotDone> {
    let missed = |smooth: &Smooth| {
        let name = &smooth.name;
        let message = match smooth.face {
            Some(_) => format!("the STEP file's face of `{name}` is not shown to be within {} um", 1e3 * tolerance),
            None => format!("`{name}` has no face for a STEP file: no two rows and columns of it are solved"),
        };
        NotDone::new(NotDoneKind::FaceInexact, name, message)
    };
    faces.iter().filter(|smooth| !smooth.is_exact_enough).map(missed).collect()
}

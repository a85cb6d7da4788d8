//! `flank deviation`

use std::path::Path;
use std::time::Instant;

use flank_chain_dsl::Coordinate;
use flank_expr::Graph;
use flank_solver::{Alignment, CutBy, Outcome, SurfacePoint};

use crate::compare::deviation_result::DeviationResult;
use crate::compare::inspect;
use crate::compare::map::{ComparedWith, DeviationMap, Middle, Named, find, is_solved, no_deviation};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, Remark, RemarkKind};
use crate::project::requests::DeviationRequest;
use crate::project::session::Session;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::branches;
use crate::solve::starts::{Asked, Starts};
use crate::solve::{self, SolveOptions, bound, problem};

/// What a surface is compared with.
enum Second<'a> {
    DeviationMap(&'a Path),
    Surface(&'a str),
}

/// Compares one surface with another, or measured points with a surface, and writes how far they lie apart.
///
/// # Errors
/// What is wrong with the spec or the measured points; what does not go together; that a file cannot be written.
pub fn deviation(request: &DeviationRequest, monitor: &dyn Monitor) -> Result<DeviationResult, Failure> {
    let start = Instant::now();
    if request.measured.is_none() && request.margin.is_some() {
        let message = "option `margin` says where the points of option `measured` lie; with option `reference` they are those of its sample"
            .to_string();
        return Err(Failure::Request(message));
    }
    if request.measured.is_none() && (request.rows.is_some() || request.columns.is_some()) {
        let message =
            "option `rows` and option `columns` are those of option `measured`; with option `reference` the points are those of its sample"
                .to_string();
        return Err(Failure::Request(message));
    }
    let second = match (&request.measured, &request.reference) {
        (Some(file), _) => Second::DeviationMap(file),
        (None, Some(name)) => Second::Surface(name),
        (None, None) => {
            let message = format!(
                "say what `{}` is compared with: option `reference SURFACE` or option `measured FILE`",
                request.surface
            );
            return Err(Failure::Request(message));
        }
    };
    let graph = Graph::new();
    let among = request.reference.as_ref().filter(|_| request.reference_jobs.is_none());
    let surfaces: Vec<&str> = [&request.surface].into_iter().chain(among).map(String::as_str).collect();
    let (compilation, jobs) = spec::jobs_of_surfaces(&graph, &request.jobs, &surfaces, monitor)?;
    let mut origin = Origin::of_compilation(&compilation);
    let other_graph = Graph::new();
    let others = request.reference_jobs.as_ref().map(|others| spec::jobs(&other_graph, others, monitor)).transpose()?;
    let surface = find(&jobs, &request.surface)?;
    let session = Session::new(request.evaluator, monitor);
    let measured = match second {
        Second::DeviationMap(file) => inspect::inspect(surface, file, (request, session), &mut origin)?,
        Second::Surface(from) => {
            let among = others.as_ref().map_or(&jobs, |(_, others)| others);
            measure([surface, find(among, from)?], request.no_align, session)?
        }
    };
    let written = measured.write(request, &origin, monitor)?;
    let result = measured.result(written, &origin);
    let remarks = measured.opposite().into_iter().chain(trimmed(&measured, session)).collect();
    Ok(DeviationResult {
        remarks: origin.located(&measured.jobs(), remarks),
        timing: Timing { points: measured.points.len(), elapsed: start.elapsed(), ..Timing::default() },
        ..result
    })
}

/// Surfaces of which the job trims points away, which have deviations all the same.
fn trimmed(measured: &DeviationMap<'_, '_>, session: Session) -> Vec<Remark> {
    let held = match &measured.held {
        ComparedWith::Surface(of) => Some(of),
        ComparedWith::File { .. } => None,
    };
    let wanted = SolveOptions {
        geometry: false,
        sensitivity: false,
        certificates: false,
        together: None,
        arrays: false,
        of_shown: false,
        session,
    };
    let told = held.into_iter().chain([&measured.from]).filter_map(|Named { job, surface }| {
        let sample = surface.sample.as_ref().filter(|_| !surface.trimmed_by.is_empty())?;
        let points = solve::points(job, surface, sample, wanted).points;
        let is_trimmed = |point: &&SurfacePoint| matches!(point.outcome, Outcome::CutAway(CutBy::Other(_)));
        let count = points.iter().filter(is_trimmed).count();
        let name = &surface.name;
        (count > 0).then(|| {
            let message = format!(
                "`trim` takes away {count} of {} of the sample of {name}: its deviations are those of the surface as its tool makes it",
                units::counted(points.len(), "point")
            );
            Remark::new(RemarkKind::TrimmedAway, name, message)
        })
    });
    let mut told: Vec<Remark> = told.collect();
    // a surface may be compared with itself
    told.dedup();
    told
}

pub(crate) fn measure<'j, 'g>(
    [surface, from]: [Named<'j, 'g>; 2],
    no_align: bool,
    session: Session,
) -> Result<DeviationMap<'j, 'g>, Failure> {
    let of = &from.surface.name;
    let sample = from.surface.sample.as_ref().ok_or(format!(
        "`{of}` is not sampled: its sample says at which points the deviation is wanted; add `sample {of} {{ … }}`"
    ))?;
    let _working = session.begin(format!("solving {} and {}", surface.surface.name, from.surface.name))?;
    let asked = Asked::with_centre(sample);
    let (points, lost) = solved(from, (&sample.coordinates, &asked.targets, asked.counts), session);
    session.check()?;
    let alignment = from.alignment();
    let starts = Starts::beside(surface.surface, (&asked, &points), alignment);
    let (near, lost_near) = solved(surface, (&starts.coordinates, &starts.targets, asked.counts), session);
    let deviation = flank_solver::Deviation::new(&bound(surface.job, surface.surface), alignment)
        .expect("a job without errors leaves nothing unbound");
    let middle = asked.centre.middle();
    let both = points.get(middle).zip(near.get(middle)).filter(|(point, near)| is_solved(point) && is_solved(near));
    let motion = both.and_then(|(point, near)| deviation.motion_to(point.position, near));
    let done = if no_align { Some(0.0) } else { motion };
    let is_opposite = both.zip(done).is_some_and(|((point, near), motion)| {
        alignment.turned(near.normal, motion).iter().zip(point.normal).map(|(a, b)| a * b).sum::<f64>() < 0.0
    });
    let deviations: Vec<Option<f64>> = match done {
        Some(motion) => deviation.map(&points, &near, motion).into_iter().map(|off| Some(1e3 * off?)).collect(),
        None => vec![None; points.len()],
    };
    let ends = [points.get(middle), near.get(middle)].map(|point| point.map(|point| point.outcome));
    let apart = done.is_none().then(|| apart([surface, from], ends));
    let ambiguous: Vec<NotDone> = lost.into_iter().chain(lost_near).collect();
    let at_middle = Middle::new(&asked.centre, &points, &deviations);
    let [points, near] = [points, near].map(|points| asked.centre.own(&points));
    let is_cut = |(point, near): &(&SurfacePoint, &SurfacePoint)| is_solved(point) && is_cut_away(near.outcome);
    let is_not_found = |(point, near): &(&SurfacePoint, &SurfacePoint)| {
        is_solved(point) && matches!(near.outcome, Outcome::NotConverged { .. } | Outcome::Singular)
    };
    Ok(DeviationMap {
        held: ComparedWith::Surface(surface),
        from,
        labels: sample.labels.clone(),
        counts: sample.counts,
        middle: at_middle,
        deviations: asked.centre.own(&deviations),
        lines: asked.centre.lines,
        cut_away: points.iter().zip(&near).filter(is_cut).count(),
        not_found: (
            points.iter().zip(&near).filter(is_not_found).count(),
            starts.coordinates.each_ref().map(|coordinate| coordinate.name.clone()),
        ),
        points,
        motion,
        is_moved: !no_align,
        is_opposite,
        refused: if ambiguous.is_empty() { apart.into_iter().collect() } else { ambiguous },
    })
}

/// The points of a surface at values of two coordinates, and its branches where several qualify.
pub(crate) fn solved<'g>(
    of: Named<'_, 'g>,
    (coordinates, targets, counts): (&[Coordinate<'g>; 2], &[[f64; 2]], [usize; 2]),
    session: Session,
) -> (Vec<SurfacePoint>, Option<NotDone>) {
    let problem =
        problem(of.job, of.surface, coordinates.each_ref().map(|coordinate| coordinate.value), session).points_alone();
    let (points, effort) = problem.solve(targets, counts);
    let is_ambiguous = points.iter().any(|point| point.outcome == Outcome::Ambiguous);
    let told = is_ambiguous.then(|| {
        let at = branches::place(coordinates, effort.anchor);
        branches::listed(of.surface, problem.periodic(), (&problem.points(&effort.branches), &effort.courses), &at)
    });
    (points, told)
}

/// Why two surfaces do not meet in the middle of the grid, where the points of both have come to an end each.
fn apart(of: [Named<'_, '_>; 2], ends: [Option<Outcome>; 2]) -> NotDone {
    let [surface, from] = if of[0].job.name == of[1].job.name {
        of.map(|of| of.surface.name.clone())
    } else {
        of.map(|of| of.whole_name())
    };
    let [point, near] = ends;
    let (moved, motion) = match of[1].alignment() {
        Alignment::Turn => ("turned about z", "turn"),
        Alignment::Shift => ("shifted along y", "shift"),
    };
    let way_out = format!("the option `no_align` does without the {motion} that brings both to meet there");
    let message = match (point, near) {
        (Some(point), _) if point != Outcome::Solved => {
            format!("no deviation: `{from}` has no point in the middle of its grid ({}); {way_out}", point.word())
        }
        (_, Some(near)) if is_cut_away(near) => {
            format!("no deviation: `{surface}` is cut away where the middle of the grid of `{from}` is; {way_out}")
        }
        _ => format!(
            "no deviation: `{surface}` and `{from}` have no point in common in the middle of the grid, however `{surface}` is {moved}"
        ),
    };
    no_deviation(&surface, message)
}

fn is_cut_away(outcome: Outcome) -> bool {
    matches!(outcome, Outcome::CutAway(_) | Outcome::Undecided)
}

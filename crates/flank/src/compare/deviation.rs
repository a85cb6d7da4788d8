//! `flank deviation`

use std::path::Path;
use std::time::Instant;

use flank_chain_dsl::{Coordinate, GeneratedSurface, Job};
use flank_draw::{PictureOptions, field_maps};
use flank_export::{Axis, Dataset, Field, Patch, Values, fixed};
use flank_expr::Graph;
use flank_solver::{CutBy, EaseOff, Outcome, SurfacePoint};

use crate::compare::deviation_result::{DeviationResult, EaseOffDirection};
use crate::compare::inspect;
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::{DeviationRequest, JobSelection, Session};
use crate::project::spec;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::branches;
use crate::solve::starts::{self, Starts};
use crate::solve::{self, SolveOptions, bound, header, patch, problem};

const NOTE: &str = "along the normal, plus is material";

/// A surface of a job.
#[derive(Clone, Copy)]
pub(crate) struct Named<'j, 'g> {
    pub(crate) job: &'j Job<'g>,
    pub(crate) surface: &'j GeneratedSurface<'g>,
}

impl Named<'_, '_> {
    pub(crate) fn whole_name(&self) -> String {
        format!("{}.{}", self.job.name, self.surface.name)
    }
}

/// What is held against a surface.
pub(crate) enum ComparedWith<'j, 'g> {
    Surface(Named<'j, 'g>),
    /// So many measured points of a file.
    File {
        name: String,
        points: usize,
    },
}

impl ComparedWith<'_, '_> {
    fn name(&self) -> &str {
        match self {
            ComparedWith::Surface(of) => &of.surface.name,
            ComparedWith::File { name, .. } => name,
        }
    }

    fn whole_name(&self) -> String {
        match self {
            ComparedWith::Surface(of) => of.whole_name(),
            ComparedWith::File { name, .. } => name.clone(),
        }
    }

    fn frame(&self) -> Option<&str> {
        match self {
            ComparedWith::Surface(of) => Some(&of.surface.frame),
            ComparedWith::File { .. } => None,
        }
    }
}

/// One surface, or what was measured of it, held against a surface.
pub(crate) struct DeviationMap<'j, 'g> {
    pub(crate) held: ComparedWith<'j, 'g>,
    pub(crate) from: Named<'j, 'g>,
    pub(crate) labels: [String; 2],
    pub(crate) counts: [usize; 2],
    pub(crate) points: Vec<SurfacePoint>,
    /// About z, radians: until both meet in the middle of the grid, or measured points lie nearest.
    pub(crate) turn: Option<f64>,
    /// Whether it was turned.
    pub(crate) is_turned: bool,
    /// um
    pub(crate) deviations: Vec<Option<f64>>,
    /// Whether the normals of two surfaces face apart where they meet in the middle: one is the other's opposite flank.
    pub(crate) is_opposite: bool,
    /// Why nothing could be held against the other, with a way out; empty if it could.
    pub(crate) refused: Vec<NotDone>,
    /// Points at whose places the surface is cut away.
    pub(crate) cut_away: usize,
}

/// What a surface is held against.
enum Second<'a> {
    DeviationMap(&'a Path),
    Surface(&'a str),
}

/// Holds one surface against another, or measured points against a surface, and writes how far they lie apart.
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
                "say what `{}` is held against: option `reference SURFACE` or option `measured FILE`",
                request.surface
            );
            return Err(Failure::Request(message));
        }
    };
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let mut origin = Origin::of(&compilation);
    let surface = find(&jobs, &request.surface)?;
    let session = Session::new(request.evaluator, monitor);
    let measured = match second {
        Second::DeviationMap(file) => inspect::inspect(surface, file, (request, session), &mut origin)?,
        Second::Surface(from) => measure([surface, find(&jobs, from)?], request.no_align, session)?,
    };
    let written = measured.write(request, &origin, monitor)?;
    let result = measured.result(written, &origin);
    let remarks = measured.opposite().into_iter().chain(trimmed(&measured, session)).collect();
    Ok(DeviationResult {
        remarks: origin.located(&measured.jobs(), remarks),
        timing: Timing { points: measured.points.len(), elapsed: start.elapsed() },
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
    // a surface may be held against itself
    told.dedup();
    told
}

/// A surface by its name, with that of its job where several have it.
pub(crate) fn find<'j, 'g>(jobs: &'j [Job<'g>], name: &str) -> Result<Named<'j, 'g>, String> {
    let all = || jobs.iter().flat_map(|job| job.surfaces.iter().map(move |surface| Named { job, surface }));
    let found: Vec<Named<'j, 'g>> = all().filter(|of| of.surface.name == name || of.whole_name() == name).collect();
    match found[..] {
        [one] => Ok(one),
        [] => {
            let known: Vec<String> = all().map(|of| format!("`{}`", of.whole_name())).collect();
            Err(format!("there is no surface `{name}`; there is: {}", known.join(", ")))
        }
        _ => {
            let known: Vec<String> = found.iter().map(|of| format!("`{}`", of.whole_name())).collect();
            Err(format!("several jobs have a surface `{name}`; say which: {}", known.join(", ")))
        }
    }
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
    let counts = sample.counts;
    let (points, lost) = solved(from, (&sample.coordinates, &sample.targets(), counts), session);
    session.check()?;
    let starts = Starts::beside(surface.surface, (sample, &points));
    let (near, lost_near) = solved(surface, (&starts.coordinates, &starts.targets, counts), session);
    let deviation = flank_solver::Deviation::new(&bound(surface.job, surface.surface))
        .expect("a job without errors leaves nothing unbound");
    let middle = starts::middle(counts);
    let both = points.get(middle).zip(near.get(middle)).filter(|(point, near)| is_solved(point) && is_solved(near));
    let turn = both.and_then(|(point, near)| deviation.turn_to(point.position, near));
    let done = if no_align { Some(0.0) } else { turn };
    let is_opposite = both.zip(done).is_some_and(|((point, near), turn)| {
        let [x, y, z] = near.normal;
        let (sin, cos) = turn.sin_cos();
        let turned = [cos * x - sin * y, sin * x + cos * y, z];
        turned.iter().zip(point.normal).map(|(a, b)| a * b).sum::<f64>() < 0.0
    });
    let deviations = match done {
        Some(turn) => deviation.map(&points, &near, turn).into_iter().map(|off| Some(1e3 * off?)).collect(),
        None => vec![None; points.len()],
    };
    let ends = [points.get(middle), near.get(middle)].map(|point| point.map(|point| point.outcome));
    let apart = done.is_none().then(|| apart([surface, from], ends));
    let ambiguous: Vec<NotDone> = lost.into_iter().chain(lost_near).collect();
    let is_cut = |(point, near): &(&SurfacePoint, &SurfacePoint)| is_solved(point) && is_cut_away(near.outcome);
    Ok(DeviationMap {
        held: ComparedWith::Surface(surface),
        from,
        labels: sample.labels.clone(),
        counts,
        cut_away: points.iter().zip(&near).filter(is_cut).count(),
        points,
        turn,
        is_turned: !no_align,
        deviations,
        is_opposite,
        refused: if ambiguous.is_empty() { apart.into_iter().collect() } else { ambiguous },
    })
}

/// The points of a surface at values of two coordinates, and what is told of its branches where several qualify.
fn solved<'g>(
    of: Named<'_, 'g>,
    (coordinates, targets, counts): (&[Coordinate<'g>; 2], &[[f64; 2]], [usize; 2]),
    session: Session,
) -> (Vec<SurfacePoint>, Option<NotDone>) {
    let problem = problem(of.job, of.surface, coordinates.each_ref().map(|coordinate| coordinate.value), session);
    let (points, effort) = problem.solve(targets, counts);
    let is_ambiguous = points.iter().any(|point| point.outcome == Outcome::Ambiguous);
    let told = is_ambiguous.then(|| {
        let at = branches::place(coordinates, effort.anchor);
        branches::listed(of.surface, &problem.points(&effort.branches), &at)
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
    let way_out = "the option `no_align` does without the turn that brings both to meet there";
    let message = match (point, near) {
        (Some(point), _) if point != Outcome::Solved => {
            format!("no deviation: `{from}` has no point in the middle of its grid ({}); {way_out}", point.word())
        }
        (_, Some(near)) if is_cut_away(near) => {
            format!("no deviation: `{surface}` is cut away where the middle of the grid of `{from}` is; {way_out}")
        }
        _ => format!(
            "no deviation: `{surface}` and `{from}` have no point in common in the middle of the grid, however `{surface}` is turned \
             about z"
        ),
    };
    no_deviation(&surface, message)
}

fn is_cut_away(outcome: Outcome) -> bool {
    matches!(outcome, Outcome::CutAway(_) | Outcome::Undecided)
}

fn is_solved(point: &SurfacePoint) -> bool {
    point.outcome == Outcome::Solved
}

/// Nearer than this, um, the middle lies on the surface that it was turned onto: points are solved to 1e-9 mm.
const ON_IT: f64 = 1e-6;

impl DeviationMap<'_, '_> {
    fn middle(&self) -> usize {
        starts::middle(self.counts)
    }

    /// Distance of the middle of the grid from the z axis, mm.
    fn middle_radius(&self) -> f64 {
        self.points.get(self.middle()).map_or(f64::NAN, |point| point.position[0].hypot(point.position[1]))
    }

    /// The middle of the grid, um.
    fn in_the_middle(&self) -> Option<f64> {
        let middle = *self.deviations.get(self.middle())?;
        middle.map(|off| if off.abs() < ON_IT { 0.0 } else { off })
    }

    /// Normals that face apart.
    fn opposite(&self) -> Option<Remark> {
        self.is_opposite.then(|| {
            let (held, from) = (self.held.name(), &self.from.surface.name);
            let message = format!(
                "{held} and {from} have their steel on opposite sides in the middle of the grid, as the two flanks of a tooth have: \
                 these deviations compare no flank with its like"
            );
            Remark::new(RemarkKind::OppositeSides, from, message)
        })
    }

    /// The jobs of its surfaces.
    fn jobs(&self) -> Vec<&Job<'_>> {
        let held = match &self.held {
            ComparedWith::Surface(of) => Some(of.job),
            ComparedWith::File { .. } => None,
        };
        [self.from.job].into_iter().chain(held).collect()
    }

    fn known(&self) -> impl Iterator<Item = f64> {
        self.deviations.iter().flatten().copied()
    }

    /// The smallest, the largest, and the root of the mean square, um.
    fn spread(&self) -> Option<[f64; 3]> {
        let count = self.known().count();
        let ends = self.known().map(|x| (x, x)).reduce(|(low, high), (x, _)| (low.min(x), high.max(x)));
        let square = self.known().map(|x| x * x).sum::<f64>() / count as f64;
        ends.map(|(low, high)| [low, high, square.sqrt()])
    }

    fn ease_off(&self) -> Option<EaseOff> {
        EaseOff::of(&self.deviations, self.counts)
    }

    /// Way from the first to the last point of the middle column, and of the middle row, mm.
    fn lengths(&self) -> [Option<f64>; 2] {
        let [rows, columns] = self.counts;
        let apart = |a: usize, b: usize| {
            let ends = [self.points.get(a)?, self.points.get(b)?];
            let [one, other] = ends.map(|point| is_solved(point).then_some(point.position));
            let squares = one?.into_iter().zip(other?).map(|(a, b)| (a - b) * (a - b));
            Some(squares.sum::<f64>().sqrt())
        };
        [
            apart(columns / 2, (rows - 1) * columns + columns / 2),
            apart(rows / 2 * columns, rows / 2 * columns + columns - 1),
        ]
    }

    fn name(&self) -> String {
        match &self.held {
            ComparedWith::Surface(of) => format!("{}.deviation", of.whole_name()),
            ComparedWith::File { .. } => format!("{}.measured.deviation", self.from.whole_name()),
        }
    }

    /// What is said of it, with the files that were written.
    fn result(&self, files: Vec<String>, origin: &Origin) -> DeviationResult {
        let (ease_off, spread, lengths) = (self.ease_off(), self.spread(), self.lengths());
        let direction = |k: usize| {
            ease_off.map(|of| EaseOffDirection {
                direction: self.labels[k].clone(),
                slope_um: of.slopes[k],
                slope_arcmin: lengths[k].map(|length| arcmin(of.slopes[k], length)),
                crowning_um: of.crownings[k],
            })
        };
        let (surface, measured, job) = match &self.held {
            ComparedWith::Surface(of) => (Some(of.surface.name.clone()), None, Some(of.job.name.clone())),
            ComparedWith::File { name, .. } => (None, Some(name.clone()), None),
        };
        DeviationResult {
            surface,
            job,
            frame: self.held.frame().map(str::to_string),
            measured,
            from: self.from.surface.name.clone(),
            from_job: self.from.job.name.clone(),
            from_frame: self.from.surface.frame.clone(),
            asked: self.points.len(),
            known: self.known().count(),
            turn_deg: self.turn.map(f64::to_degrees),
            turned: self.is_turned,
            turn_mm: self.turn.map(|turn| self.middle_radius() * turn),
            lowest_um: spread.map(|of| of[0]),
            highest_um: spread.map(|of| of[1]),
            rms_um: spread.map(|of| of[2]),
            middle_um: self.in_the_middle(),
            directions: [direction(0), direction(1)],
            bias_um: ease_off.map(|of| of.bias),
            files,
            not_done: self.missing(origin),
            remarks: Vec::new(),
            timing: Timing::default(),
            counts: self.counts,
            positions: self.points.iter().map(|point| point.position).collect(),
            deviations: self.deviations.iter().map(|off| off.unwrap_or(f64::NAN)).collect(),
        }
    }

    /// Why numbers are missing, if some are.
    pub(crate) fn missing(&self, origin: &Origin) -> Vec<NotDone> {
        origin.located(&self.jobs(), self.not_done())
    }

    fn not_done(&self) -> Vec<NotDone> {
        let (all, known) = (self.points.len(), self.known().count());
        let [surface, from] = match &self.held {
            ComparedWith::Surface(of) if of.job.name != self.from.job.name => [of.whole_name(), self.from.whole_name()],
            held => [held.name().to_string(), self.from.surface.name.clone()],
        };
        let unsolved = self.points.iter().filter(|point| !is_solved(point)).count();
        if let ComparedWith::File { points, .. } = self.held {
            return missing_of_file(self, [points, known, unsolved]);
        }
        if !self.refused.is_empty() {
            return self.refused.clone();
        }
        let unmet = all - known - unsolved;
        let cut_away = self.cut_away.min(unmet);
        let unmet = unmet - cut_away;
        counted([
            (unsolved, not_solved(&from, format!("not solved: {unsolved} of {all} points of {from}"))),
            (
                cut_away,
                no_deviation(
                    &surface,
                    format!("no deviation at {cut_away} of {all} points: {surface} is cut away there"),
                ),
            ),
            (
                unmet,
                no_deviation(
                    &from,
                    format!(
                        "no deviation at {unmet} of {all} points: the normal of {from} does not meet {surface} within its ranges"
                    ),
                ),
            ),
        ])
    }

    /// The points with their deviations as their one field.
    pub(crate) fn dataset(&self, which: &JobSelection, origin: &Origin) -> Dataset {
        let axis = |k: usize| Axis { label: self.labels[k].clone(), count: self.counts[k] };
        let patch = patch(self.from.job, &self.from.surface.name, self.from.surface, [axis(0), axis(1)], &self.points);
        let field = Field {
            name: format!("deviation of {}", self.held.name()),
            unit: "um".to_string(),
            meaning: NOTE.to_string(),
            values: Values::Scalars(self.deviations.iter().copied().collect()),
        };
        let mut header = header(&self.jobs(), which, origin);
        let turn = self.turn.filter(|_| self.is_turned).map_or(0.0, f64::to_degrees);
        header.conventions.push(format!("{} turned about z by {turn:?} deg", self.held.name()));
        Dataset { header, patches: vec![Patch { fields: vec![field], ..patch }] }
    }

    /// How a picture is to be read.
    pub(crate) fn note(&self) -> String {
        let turn = self.turn.filter(|_| self.is_turned);
        let turn = turn.map(|turn| {
            format!(
                "; {} is turned by {} deg about z, {} mm on the circle through the middle",
                self.held.name(),
                fixed(turn.to_degrees(), 6),
                fixed(self.middle_radius() * turn, 6)
            )
        });
        format!("{NOTE}{}", turn.unwrap_or_default())
    }

    pub(crate) fn title(&self) -> String {
        format!("{} from {}", self.held.whole_name(), self.from.whole_name())
    }

    fn write(
        &self,
        request: &DeviationRequest,
        origin: &Origin,
        monitor: &dyn Monitor,
    ) -> Result<Vec<String>, Failure> {
        let dataset = self.dataset(&request.jobs, origin);
        let mut folder = Folder::at(&request.out, origin, monitor)?;
        let map = || field_maps(&dataset, &self.title(), &[(0, 0)], &self.note(), &PictureOptions::default());
        let map = (!request.no_picture).then(map);
        folder.picture_after(&self.name(), map.as_ref(), |folder| {
            folder.data(&self.name(), &dataset.surfaces(), &request.format)
        })?;
        folder.finish()
    }
}

/// Why numbers are missing of a grid with so many measured points, known deviations and nominal points that are not solved.
fn missing_of_file(of: &DeviationMap<'_, '_>, [measured, known, unsolved]: [usize; 3]) -> Vec<NotDone> {
    let (all, from) = (of.points.len(), &of.from.surface.name);
    let (left_out, unmet) = (all.saturating_sub(measured), measured.saturating_sub(known));
    counted([
        (unsolved, not_solved(from, format!("not solved: {unsolved} of {all} nominal points of {from}"))),
        (left_out, NotDone::new(NotDoneKind::NotMeasured, from, format!("not measured: {left_out} of {all} points"))),
        (
            unmet,
            no_deviation(
                from,
                format!(
                    "no deviation at {unmet} of {measured} measured points: no normal of {from} within its ranges goes through them"
                ),
            ),
        ),
    ])
}

fn not_solved(of: &str, message: String) -> NotDone {
    NotDone::new(NotDoneKind::NotSolved, of, message)
}

fn no_deviation(of: &str, message: String) -> NotDone {
    NotDone::new(NotDoneKind::NoDeviation, of, message)
}

/// Those of which there are some.
fn counted<const N: usize>(all: [(usize, NotDone); N]) -> Vec<NotDone> {
    all.into_iter().filter(|(count, _)| *count > 0).map(|(_, one)| one).collect()
}

/// The angle of a rise in um over a length in mm.
fn arcmin(rise: f64, length: f64) -> f64 {
    (1e-3 * rise).atan2(length).to_degrees() * 60.0
}

//! A surface, or what was measured of it, compared with a surface: what is known of it, and how it is written.

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_draw::{Picture, PictureOptions, deviation_map};
use flank_export::{Axis, Dataset, Field, Patch, Values, fixed};
use flank_solver::{Alignment, EaseOff, Outcome, SurfacePoint};

use crate::compare::deviation_result::{self, DeviationResult, EaseOffDirection, GridPlace};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::{DeviationRequest, JobSelection};
use crate::project::spec::Origin;
use crate::solve::blank;
use crate::solve::centre::Centre;
use crate::solve::{header, patch};

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

    pub(crate) fn alignment(&self) -> Alignment {
        blank::alignment(self.job, self.surface)
    }
}

/// What is compared with a surface.
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

/// One surface, or what was measured of it, compared with a surface.
pub(crate) struct DeviationMap<'j, 'g> {
    pub(crate) held: ComparedWith<'j, 'g>,
    pub(crate) from: Named<'j, 'g>,
    pub(crate) labels: [String; 2],
    pub(crate) counts: [usize; 2],
    /// Where its rows and its columns lie: the values that they were sampled at.
    pub(crate) lines: [Vec<f64>; 2],
    pub(crate) points: Vec<SurfacePoint>,
    pub(crate) middle: Middle,
    /// Until both meet in the middle of the grid, or measured points lie nearest.
    pub(crate) motion: Option<f64>,
    /// Whether it was moved.
    pub(crate) is_moved: bool,
    /// um
    pub(crate) deviations: Vec<Option<f64>>,
    /// Whether the normals of two surfaces face apart where they meet in the middle: one is the other's opposite flank.
    pub(crate) is_opposite: bool,
    /// Why nothing could be compared with the other, with a way out; empty if it could.
    pub(crate) refused: Vec<NotDone>,
    /// Points at whose places the surface is cut away.
    pub(crate) cut_away: usize,
    /// Points at whose places the surface was not found, and the two coordinates by which it was looked for there.
    pub(crate) not_found: (usize, [String; 2]),
}

/// The middle of a grid.
pub(crate) struct Middle {
    /// From the z axis, mm.
    radius: f64,
    /// um
    off: Option<f64>,
    /// Way from the first to the last point of the column through it, and of the row, mm.
    lengths: [Option<f64>; 2],
    /// Row and column of the point that stands for the mean point.
    stand_in: Option<[usize; 2]>,
}

impl Middle {
    /// Of the points of a grid and their deviations, um.
    pub(crate) fn new(centre: &Centre, points: &[SurfacePoint], deviations: &[Option<f64>]) -> Middle {
        let off = deviations.get(centre.middle()).copied().flatten();
        let apart = |ends: [usize; 2]| {
            let [one, other] = ends.map(|at| points.get(at).filter(|point| is_solved(point)));
            let squares = one?.position.into_iter().zip(other?.position).map(|(a, b)| (a - b) * (a - b));
            Some(squares.sum::<f64>().sqrt())
        };
        Middle {
            radius: points.get(centre.middle()).map_or(f64::NAN, |point| point.position[0].hypot(point.position[1])),
            off: off.map(|off| if off.abs() < ON_IT { 0.0 } else { off }),
            lengths: centre.ends().map(apart),
            stand_in: centre.stand_in(),
        }
    }

    fn stand_in(&self) -> Option<GridPlace> {
        self.stand_in.map(GridPlace::of)
    }
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

pub(super) fn is_solved(point: &SurfacePoint) -> bool {
    point.outcome == Outcome::Solved
}

/// Nearer than this, um, the middle lies on the surface that it was turned onto: points are solved to 1e-9 mm.
const ON_IT: f64 = 1e-6;

impl DeviationMap<'_, '_> {
    /// Normals that face apart.
    pub(super) fn opposite(&self) -> Option<Remark> {
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
    pub(super) fn jobs(&self) -> Vec<&Job<'_>> {
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
        EaseOff::over_lines(&self.deviations, self.lines.each_ref().map(Vec::as_slice))
    }

    fn name(&self) -> String {
        match &self.held {
            ComparedWith::Surface(of) => format!("{}.deviation", of.whole_name()),
            ComparedWith::File { .. } => format!("{}.measured.deviation", self.from.whole_name()),
        }
    }

    /// The result, with the files that were written.
    pub(crate) fn result(&self, files: Vec<String>, origin: &Origin) -> DeviationResult {
        let (ease_off, spread, lengths) = (self.ease_off(), self.spread(), self.middle.lengths);
        let direction = |k: usize| {
            ease_off.map(|of| EaseOffDirection {
                direction: self.labels[k].clone(),
                slope_um: of.slopes[k],
                slope_arcmin: lengths[k].map(|length| arcmin(of.slopes[k], length)),
                crowning_um: of.crownings[k],
            })
        };
        let (turn, shift) = match self.from.alignment() {
            Alignment::Turn => (self.motion, None),
            Alignment::Shift => (None, self.motion),
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
            turn_deg: turn.map(f64::to_degrees),
            turned: self.is_moved,
            turn_mm: turn.map(|turn| self.middle.radius * turn),
            shift_mm: shift,
            lowest_um: spread.map(|of| of[0]),
            highest_um: spread.map(|of| of[1]),
            rms_um: spread.map(|of| of[2]),
            middle_um: self.middle.off,
            middle_at: self.middle.stand_in(),
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
        let (not_found, [first, second]) = &self.not_found;
        let not_found = (*not_found).min(unmet);
        let unmet = unmet - not_found;
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
                not_found,
                no_deviation(
                    &from,
                    format!(
                        "no deviation at {not_found} of {all} points: {surface}, looked for by {first} and {second}, was not found there; \
                         sample {from} by two of x, y, z, rho and polar_angle that tell its points apart"
                    ),
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
        let (name, motion) = (self.held.name(), self.motion.filter(|_| self.is_moved).unwrap_or_default());
        header.conventions.push(match self.from.alignment() {
            Alignment::Turn => format!("{name} turned about z by {:?} deg", motion.to_degrees()),
            Alignment::Shift => format!("{name} shifted along y by {motion:?} mm"),
        });
        Dataset { header, patches: vec![Patch { fields: vec![field], ..patch }] }
    }

    /// How a picture is to be read.
    pub(crate) fn note(&self) -> String {
        let name = self.held.name();
        let told = self.motion.filter(|_| self.is_moved).map(|motion| match self.from.alignment() {
            Alignment::Turn => format!(
                "; {name} is turned by {} deg about z, {} mm on the circle through {}",
                fixed(motion.to_degrees(), 6),
                fixed(self.middle.radius * motion, 6),
                deviation_result::middle(self.middle.stand_in())
            ),
            Alignment::Shift => format!("; {name} is shifted by {} mm along y", fixed(motion, 6)),
        });
        format!("{NOTE}{}", told.unwrap_or_default())
    }

    pub(crate) fn title(&self) -> String {
        format!("{} from {}", self.held.whole_name(), self.from.whole_name())
    }

    /// The map of its dataset, with what sums it up.
    pub(crate) fn picture(&self, dataset: &Dataset, options: &PictureOptions) -> Picture {
        let um = |value: f64| fixed(value, 2);
        let line = |of: &EaseOff, k: usize| {
            let way = self.labels[k].replace("->", "to");
            format!("{way}: slope {} \u{b5}m, crowning {} \u{b5}m", um(of.slopes[k]), um(of.crownings[k]))
        };
        let numbers = self
            .ease_off()
            .map_or(Vec::new(), |of| vec![line(&of, 0), line(&of, 1), format!("bias {} \u{b5}m", um(of.bias))]);
        deviation_map(dataset, &self.title(), (0, 0), (&self.note(), &numbers), options)
    }

    pub(super) fn write(
        &self,
        request: &DeviationRequest,
        origin: &Origin,
        monitor: &dyn Monitor,
    ) -> Result<Vec<String>, Failure> {
        let dataset = self.dataset(&request.jobs, origin);
        let mut folder = Folder::at(&request.out, origin, monitor);
        let map = || self.picture(&dataset, &PictureOptions::default());
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

pub(super) fn no_deviation(of: &str, message: String) -> NotDone {
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

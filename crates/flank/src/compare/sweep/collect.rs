//! What of a case becomes a row.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use flank_chain_dsl::{Job, Sample, compile_request};
use flank_export::Values;
use flank_expr::Graph;
use flank_solver::{EaseOff, SurfacePoint};

use super::compiled::Compiled;
use super::inputs::StudyInput;
use crate::compare::deviation;
use crate::compare::map::{Named, find, is_solved};
use crate::contact::family::ContactNumbers;
use crate::contact::rolled;
use crate::project::failure::Failure;
use crate::project::findings::{Findings, Severity};
use crate::project::requests::{ContactRequest, JobSelection, MountingError};
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::solve::starts::{self, Asked, Starts};
use crate::solve::{self, SolveOptions, bound, geometry, solve_surface};

/// Positions of a pitch at which contacts are looked at.
const POSITIONS: u32 = 24;
/// The words for points, in the order of their columns.
const STATUSES: [&str; 8] =
    ["solved", "out_of_range", "undercut", "trimmed", "ambiguous", "undecided", "singular", "not_converged"];
const EASE_OFF: [&str; 9] = [
    "slope_rows [um]",
    "slope_columns [um]",
    "crowning_rows [um]",
    "crowning_columns [um]",
    "bias [um]",
    "rms [um]",
    "lowest [um]",
    "highest [um]",
    "turn [deg]",
];
const CURVATURE: [&str; 4] = ["k1_lowest [1/mm]", "k1_highest [1/mm]", "k2_lowest [1/mm]", "k2_highest [1/mm]"];
const WIDTH: [&str; 2] = ["turn [deg]", "width [mm]"];
const LIMITS: [&str; 2] = ["singular_line", "contact_limit"];
const PLACE: [&str; 6] = ["x [mm]", "y [mm]", "z [mm]", "nx", "ny", "nz"];

/// One thing that is collected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Collected {
    /// How many points of all samples have which status, and the worst residual.
    Points,
    /// How many points of all samples miss what these require.
    Requirements,
    /// How many points the lines have in the ranges where surfaces turn back, and where the tool's contact ends.
    Limits,
    /// How far a surface lies off that of the job itself.
    EaseOff(String),
    /// How far one surface is turned from another in the middle of the grid.
    Width([String; 2]),
    /// The ends of the principal curvatures.
    Curvature(String),
    /// A point of a sample.
    At(String, [usize; 2]),
    /// The numbers of a contact.
    Contact(String),
}

impl Collected {
    /// All that is named in some texts, of which each may hold several parted by commas.
    ///
    /// # Errors
    /// As for [`Collected::read`].
    pub(super) fn read_all(texts: &[String]) -> Result<Vec<Collected>, Failure> {
        let mut parts: Vec<String> = Vec::new();
        for word in texts.iter().flat_map(|text| text.split(',')) {
            match parts.last_mut() {
                // `width:a,b` and `at:a[1,2]` have commas of their own
                Some(last) if last.starts_with("width:") && !last.contains(',') => {
                    *last += &format!(",{}", word.trim())
                }
                Some(last) if last.contains('[') && !last.contains(']') => *last += &format!(",{}", word.trim()),
                _ => parts.push(word.trim().to_string()),
            }
        }
        parts.iter().map(|text| Collected::read(text)).collect()
    }

    /// # Errors
    /// What can be written, if it is none of that.
    fn read(text: &str) -> Result<Collected, Failure> {
        let name = |text: &str| (!text.trim().is_empty()).then(|| text.trim().to_string());
        let found = match text.split_once(':') {
            None if text == "points" => Some(Collected::Points),
            None if text == "requirements" => Some(Collected::Requirements),
            None if text == "limits" => Some(Collected::Limits),
            Some(("ease_off", of)) => name(of).map(Collected::EaseOff),
            Some(("curvature", of)) => name(of).map(Collected::Curvature),
            Some(("contact", of)) => name(of).map(Collected::Contact),
            Some(("width", of)) => of.split_once(',').and_then(|(a, b)| Some(Collected::Width([name(a)?, name(b)?]))),
            Some(("at", of)) => place(of).map(|(of, at)| Collected::At(of, at)),
            _ => None,
        };
        found.ok_or_else(|| {
            Failure::Request(format!(
                "option `collect {text}`: write points, requirements, limits, ease_off:SURFACE, width:SURFACE,SURFACE, curvature:SURFACE, \
                 at:SURFACE[row,column] or contact:CONTACT"
            ))
        })
    }

    /// The heads of its columns, with units.
    pub(super) fn heads(&self, job: &Job<'_>) -> Vec<String> {
        let of = |prefix: String, names: &[&str]| names.iter().map(|name| format!("{prefix}.{name}")).collect();
        match self {
            Collected::Points => STATUSES
                .iter()
                .map(|word| format!("points.{word}"))
                .chain(["points.worst_residual".to_string()])
                .collect(),
            Collected::Requirements => vec!["requirements.missed".to_string()],
            Collected::Limits => of("limits".to_string(), &LIMITS),
            Collected::EaseOff(surface) => of(format!("ease_off:{surface}"), &EASE_OFF),
            Collected::Width([a, b]) => of(format!("width:{a},{b}"), &WIDTH),
            Collected::Curvature(surface) => of(format!("curvature:{surface}"), &CURVATURE),
            Collected::At(surface, [row, column]) => of(format!("at:{surface}[{row},{column}]"), &PLACE),
            Collected::Contact(contact) => {
                let known = job.contacts.iter().find(|known| known.name == *contact);
                let unit =
                    |is_fine: bool| match known.is_some_and(|of| crate::project::units::is_angle(of.lag.dimension)) {
                        true if is_fine => "urad",
                        true => "deg",
                        false if is_fine => "um",
                        false => "mm",
                    };
                let names = [
                    format!("peak_to_peak [{}]", unit(true)),
                    format!("lag [{}]", unit(false)),
                    "ratio".to_string(),
                    "lengthwise".to_string(),
                    "profilewise".to_string(),
                    "z [mm]".to_string(),
                    "rho [mm]".to_string(),
                    "half_length [mm]".to_string(),
                    "half_width [mm]".to_string(),
                ];
                names.iter().map(|name| format!("contact:{contact}.{name}")).collect()
            }
        }
    }

    /// # Errors
    /// If something named is not there, or has no sample.
    pub(super) fn check(&self, job: &Job<'_>) -> Result<(), Failure> {
        let sampled = |name: &String| sample_of(job, name).map(drop);
        match self {
            Collected::Points | Collected::Requirements | Collected::Limits => Ok(()),
            Collected::EaseOff(of) | Collected::Curvature(of) => sampled(of),
            Collected::Width([a, b]) => sampled(a).and_then(|()| sampled(b)),
            Collected::At(of, [row, column]) => {
                let [rows, columns] = sample_of(job, of)?.counts;
                if *row < rows && *column < columns {
                    return Ok(());
                }
                Err(Failure::Input(format!(
                    "option `collect at:{of}[{row},{column}]`: the sample of {of} has rows 0 to {} and columns 0 to {}",
                    rows - 1,
                    columns - 1
                )))
            }
            Collected::Contact(name) => match job.contacts.iter().any(|known| known.name == *name) {
                true => Ok(()),
                false => {
                    let known: Vec<&str> = job.contacts.iter().map(|known| known.name.as_str()).collect();
                    let there = if known.is_empty() { "none".to_string() } else { known.join(", ") };
                    Err(Failure::Input(format!("job `{}` has no contact `{name}`; there is: {there}", job.name)))
                }
            },
        }
    }
}

/// As it is written.
impl fmt::Display for Collected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Collected::Points => write!(f, "points"),
            Collected::Requirements => write!(f, "requirements"),
            Collected::Limits => write!(f, "limits"),
            Collected::EaseOff(of) => write!(f, "ease_off:{of}"),
            Collected::Width([a, b]) => write!(f, "width:{a},{b}"),
            Collected::Curvature(of) => write!(f, "curvature:{of}"),
            Collected::At(of, [row, column]) => write!(f, "at:{of}[{row},{column}]"),
            Collected::Contact(of) => write!(f, "contact:{of}"),
        }
    }
}

/// `concave[7,15]`
fn place(text: &str) -> Option<(String, [usize; 2])> {
    let (name, at) = text.strip_suffix(']')?.split_once('[')?;
    let (row, column) = at.split_once(',')?;
    Some((name.trim().to_string(), [row.trim().parse().ok()?, column.trim().parse().ok()?]))
}

pub(super) fn sample_of<'j, 'g>(job: &'j Job<'g>, name: &str) -> Result<&'j Sample<'g>, Failure> {
    let of = find(std::slice::from_ref(job), name)?;
    of.surface.sample.as_ref().ok_or_else(|| {
        Failure::Input(format!("`{name}` is not sampled: its sample says at which points; add `sample {name} {{ … }}`"))
    })
}

/// What became of a case.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) verdict: &'static str,
    /// A code: of the first error of the spec, of the first thing that was not done.
    pub(super) why: String,
    /// `searched` among all branches, or `followed` from the job itself.
    pub(super) branch: &'static str,
    pub(super) numbers: Vec<Option<f64>>,
}

impl Found {
    pub(super) fn of_numbers(numbers: Vec<Option<f64>>, why: Option<String>, is_followed: bool) -> Found {
        let verdict = if why.is_none() { "done" } else { "not all solved" };
        let branch = if is_followed { "followed" } else { "searched" };
        Found { verdict, why: why.unwrap_or_default(), branch, numbers }
    }
}

/// The points of a surface as the job itself has them.
pub(super) struct NominalPoints {
    pub(super) asked: Asked,
    pub(super) points: Vec<SurfacePoint>,
}

/// What all cases of a study have in common.
pub(super) struct Cases {
    which: JobSelection,
    inputs: Vec<StudyInput>,
    collect: Vec<Collected>,
    /// How many numbers each gives.
    widths: Vec<usize>,
    /// Of those that are compared with the job itself.
    nominal: Vec<Option<NominalPoints>>,
    /// Where cases differ by numbers in the equations alone.
    compiled: Option<Compiled>,
}

impl Cases {
    /// # Errors
    /// If something is not there, or the job is wrong.
    pub(super) fn new(
        which: JobSelection,
        inputs: Vec<StudyInput>,
        collect: &[String],
        session: Session<'_>,
    ) -> Result<Cases, Failure> {
        let collect = Collected::read_all(collect)?;
        let graph = Graph::new();
        let (_, jobs) = crate::project::spec::jobs(&graph, &which, session.monitor())?;
        let job = &jobs[0];
        let nominal = collect.iter().map(|of| {
            let Collected::EaseOff(name) = of else { return Ok(None) };
            let named = find(&jobs, name)?;
            let sample = sample_of(job, name)?;
            let asked = Asked::of_sample(sample);
            let (points, lost) = deviation::solved(named, (&sample.coordinates, &asked.targets, asked.counts), session);
            match lost {
                Some(lost) => Err(Failure::NotDone(vec![lost])),
                None => Ok(Some(NominalPoints { asked, points })),
            }
        });
        let nominal: Vec<Option<NominalPoints>> = nominal.collect::<Result<_, _>>()?;
        collect.iter().try_for_each(|of| of.check(job))?;
        let widths = collect.iter().map(|of| of.heads(job).len()).collect();
        let compiled = Compiled::new((&which, job), &inputs, (&collect, &nominal), session)?;
        Ok(Cases { which, inputs, collect, widths, nominal, compiled })
    }

    /// A case with these values of the inputs; whatever happens becomes a verdict.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn solved(&self, case: (u64, &[f64]), session: Session<'_>) -> Result<Found, Failure> {
        match catch_unwind(AssertUnwindSafe(|| self.found(case, session))) {
            Ok(Ok(found)) => Ok(found),
            Ok(Err(Failure::Cancelled)) => Err(Failure::Cancelled),
            Ok(Err(Failure::Findings(findings))) => {
                let list = findings.list();
                let first = list.iter().find(|finding| finding.severity == Severity::Error);
                Ok(self.nothing("spec wrong", first.map_or("", |finding| finding.code)))
            }
            Ok(Err(other)) => Ok(self.nothing("not all solved", &told(&other))),
            Err(_) => Ok(self.nothing("crashed", "panic")),
        }
    }

    /// A case of which nothing is known.
    pub(super) fn nothing(&self, verdict: &'static str, why: &str) -> Found {
        Found { verdict, why: why.to_string(), branch: "", numbers: vec![None; self.widths.iter().sum()] }
    }

    fn found(&self, case: (u64, &[f64]), session: Session<'_>) -> Result<Found, Failure> {
        session.check()?;
        let compiled = self.compiled.as_ref();
        let nothing = |verdict, why: &str| self.nothing(verdict, why);
        if let Some(found) = compiled.and_then(|compiled| compiled.found(case, &self.nominal, nothing)) {
            return Ok(found);
        }
        let values = case.1;
        let given = || self.inputs.iter().zip(values);
        let set = given().filter(|(input, _)| !input.is_axis).map(|(input, value)| input.as_setting(*value));
        let errors: Vec<(String, MountingError)> =
            given().filter(|(input, _)| input.is_axis).map(|(input, value)| input.as_error(*value)).collect();
        let mut which = self.which.clone();
        for (name, value) in set {
            which.set.retain(|(known, _)| *known != name);
            which.set.push((name, value));
        }
        let graph = Graph::new();
        let mut compilation = compile_request(&graph, which.file(), &which.request());
        if compilation.has_errors() {
            return Err(Failure::Findings(Findings::new(&compilation.diagnostics, &compilation.sources)));
        }
        let jobs = compilation.take_jobs(which.job.as_deref());
        let jobs = jobs.map_err(|finding| Failure::Findings(Findings::new(&[finding], &compilation.sources)))?;
        let origin = Origin::of_compilation(&compilation);
        let case = Case { job: &jobs[0], jobs: &jobs, which: &which, origin, errors, session };
        let (mut numbers, mut why) = (Vec::new(), None);
        for (of, nominal) in self.collect.iter().zip(&self.nominal) {
            session.check()?;
            let (found, lost) = case.collected(of, nominal.as_ref())?;
            numbers.extend(found);
            why = why.or(lost);
        }
        Ok(Found::of_numbers(numbers, why, false))
    }
}

/// The kind of a failure as data.
fn told(failure: &Failure) -> String {
    let kind = match failure {
        Failure::NotDone(all) => all.first().map(kind_of),
        _ => None,
    };
    kind.unwrap_or_else(|| "not_solved".to_string())
}

fn kind_of(of: &crate::project::remark::NotDone) -> String {
    let kind = serde_json::to_value(of.kind).ok();
    kind.and_then(|kind| kind.as_str().map(str::to_string)).unwrap_or_default()
}

struct Case<'c, 'g> {
    job: &'c Job<'g>,
    jobs: &'c [Job<'g>],
    which: &'c JobSelection,
    origin: Origin,
    errors: Vec<(String, MountingError)>,
    session: Session<'c>,
}

/// Numbers, and why some are missing.
pub(super) type Numbers = (Vec<Option<f64>>, Option<String>);

/// How many points have which status, and the worst residual of those that are solved.
pub(super) fn point_counts<'p>(points: impl Iterator<Item = &'p SurfacePoint>) -> Numbers {
    let (mut counts, mut worst) = ([0_u32; STATUSES.len()], None::<f64>);
    for point in points {
        let word = point.outcome.word();
        counts.iter_mut().zip(STATUSES).filter(|(_, known)| *known == word).for_each(|(count, _)| *count += 1);
        if is_solved(point) {
            worst = Some(worst.map_or(point.residual, |worst| worst.max(point.residual)));
        }
    }
    let lost = (1..STATUSES.len()).find(|k| counts[*k] > 0).map(|k| STATUSES[k].to_string());
    (counts.iter().map(|count| Some(f64::from(*count))).chain([worst]).collect(), lost)
}

/// How far a surface lies off that of the job itself, of which `near` are points at the same places.
pub(super) fn ease_off_numbers(
    compared: &flank_solver::Deviation,
    NominalPoints { asked, points }: &NominalPoints,
    near: &[SurfacePoint],
) -> Numbers {
    let middle = starts::middle(asked.counts);
    let both = points.get(middle).zip(near.get(middle)).filter(|(point, near)| is_solved(point) && is_solved(near));
    let Some(turn) = both.and_then(|(point, near)| compared.turn_to(point.position, near)) else {
        return (vec![None; EASE_OFF.len()], Some("no_deviation".to_string()));
    };
    let off: Vec<Option<f64>> =
        compared.map(points, near, turn).into_iter().map(|off| off.map(|mm| 1e3 * mm)).collect();
    let known: Vec<f64> = off.iter().flatten().copied().collect();
    let ease_off = EaseOff::of_deviations(&off, asked.counts);
    let square = known.iter().map(|um| um * um).sum::<f64>() / known.len() as f64;
    let end = |of: fn(f64, f64) -> f64| known.iter().copied().reduce(of);
    let numbers = vec![
        ease_off.map(|of| of.slopes[0]),
        ease_off.map(|of| of.slopes[1]),
        ease_off.map(|of| of.crownings[0]),
        ease_off.map(|of| of.crownings[1]),
        ease_off.map(|of| of.bias),
        (!known.is_empty()).then(|| square.sqrt()),
        end(f64::min),
        end(f64::max),
        Some(turn.to_degrees()),
    ];
    let is_whole = known.len() == points.iter().filter(|point| is_solved(point)).count();
    (numbers, (!is_whole).then(|| "no_deviation".to_string()))
}

/// How far one surface is turned from another, of which `point` is the middle of the grid.
pub(super) fn width_numbers(turn: f64, point: &SurfacePoint) -> Numbers {
    let [x, y, _] = point.position;
    (vec![Some(turn.to_degrees()), Some(x.hypot(y) * turn)], None)
}

/// The ends of both principal curvatures of points.
pub(super) fn curvature_numbers(points: &[SurfacePoint], principal: impl Iterator<Item = [f64; 2]>) -> Numbers {
    let mut ends = [[None; 2]; 2];
    for both in principal {
        for ([low, high], k) in ends.iter_mut().zip(both).filter(|(_, k)| k.is_finite()) {
            *low = Some(low.map_or(k, |low: f64| low.min(k)));
            *high = Some(high.map_or(k, |high: f64| high.max(k)));
        }
    }
    let lost = points.iter().find(|point| !is_solved(point)).map(|point| point.outcome.word().to_string());
    (ends.concat(), lost)
}

/// Of one point of a sample.
pub(super) fn place_numbers(point: Option<&SurfacePoint>) -> Numbers {
    match point {
        Some(point) if is_solved(point) => (point.position.into_iter().chain(point.normal).map(Some).collect(), None),
        other => {
            let why = other.map_or("not_solved", |point| point.outcome.word());
            (vec![None; PLACE.len()], Some(why.to_string()))
        }
    }
}

/// How contacts are looked at, mounted with errors.
pub(super) fn contact_request(which: &JobSelection, errors: Vec<(String, MountingError)>) -> ContactRequest {
    ContactRequest { positions: POSITIONS, errors, ..ContactRequest::new(which.clone()) }
}

/// Of a contact that is whole.
pub(super) fn contact_numbers(of: &ContactNumbers) -> Numbers {
    let [lengthwise, profilewise] = [0, 1].map(|k| of.shares.map(|shares| shares[k]));
    let [half_length, half_width] = [0, 1].map(|k| of.ellipse.map(|ellipse| ellipse[k]));
    let [z, rho] = of.place.map(Some);
    let numbers = [of.peak_to_peak, Some(of.lag), of.ratio, lengthwise, profilewise, z, rho, half_length, half_width];
    (numbers.to_vec(), None)
}

impl Case<'_, '_> {
    fn options(&self) -> SolveOptions<'_> {
        SolveOptions {
            geometry: false,
            arrays: false,
            sensitivity: false,
            certificates: false,
            together: None,
            of_shown: false,
            session: self.session,
        }
    }

    fn collected(&self, of: &Collected, nominal: Option<&NominalPoints>) -> Result<Numbers, Failure> {
        match (of, nominal) {
            (Collected::EaseOff(name), Some(nominal)) => self.ease_off(name, nominal),
            (Collected::EaseOff(name), None) => Err(Failure::Input(format!("`{name}` has no nominal points"))),
            (Collected::Points, _) => self.points(),
            (Collected::Requirements, _) => self.requirements(),
            (Collected::Limits, _) => self.limits(),
            (Collected::Width([a, b]), _) => self.width([a.as_str(), b.as_str()]),
            (Collected::Curvature(name), _) => self.curvature(name),
            (Collected::At(name, at), _) => self.at(name, *at),
            (Collected::Contact(name), _) => self.contact(name),
        }
    }

    fn points(&self) -> Result<Numbers, Failure> {
        let mut all = Vec::new();
        for surface in &self.job.surfaces {
            let Some(sample) = &surface.sample else { continue };
            self.session.check()?;
            all.extend(solve::points(self.job, surface, sample, self.options()).points);
        }
        Ok(point_counts(all.iter()))
    }

    fn requirements(&self) -> Result<Numbers, Failure> {
        let solved = self.job.surfaces.iter().filter_map(|surface| solve_surface(self.job, surface, self.options()));
        let solved = solved.collect::<Result<Vec<_>, _>>()?;
        let missed = solve::required::missed_points(&solved);
        Ok((vec![Some(missed as f64)], (missed > 0).then(|| "not_as_required".to_string())))
    }

    fn limits(&self) -> Result<Numbers, Failure> {
        let lines = solve::limits::lines(self.job, &self.job.surfaces, self.session)?;
        let count = |kind: &str| {
            let of_kind = lines.iter().filter(|line| line.kind == kind);
            of_kind.map(|line| line.points.iter().filter(|point| is_solved(point)).count() as f64).sum()
        };
        Ok((["singular line", "contact limit"].map(|kind| Some(count(kind))).to_vec(), None))
    }

    fn named(&self, name: &str) -> Result<Named<'_, '_>, Failure> {
        Ok(find(self.jobs, name)?)
    }

    fn ease_off(&self, name: &str, nominal: &NominalPoints) -> Result<Numbers, Failure> {
        let NominalPoints { asked, points } = nominal;
        let of = self.named(name)?;
        let starts = Starts::beside(of.surface, (asked, points));
        let (near, lost) = deviation::solved(of, (&starts.coordinates, &starts.targets, asked.counts), self.session);
        let compared = flank_solver::Deviation::new(&bound(of.job, of.surface))
            .expect("a job without errors leaves nothing unbound");
        let (numbers, why) = ease_off_numbers(&compared, nominal, &near);
        Ok((numbers, lost.map(|lost| kind_of(&lost)).or(why)))
    }

    fn width(&self, [a, b]: [&str; 2]) -> Result<Numbers, Failure> {
        let found = deviation::measure([self.named(a)?, self.named(b)?], false, self.session)?;
        let found = found.result(Vec::new(), &self.origin);
        let lost = found.turn_deg.is_none().then(|| found.not_done.first().map(kind_of).unwrap_or_default());
        Ok((vec![found.turn_deg, found.turn_mm], lost))
    }

    fn curvature(&self, name: &str) -> Result<Numbers, Failure> {
        let of = self.named(name)?;
        let sample = sample_of(self.job, name)?;
        let points = solve::points(self.job, of.surface, sample, self.options()).points;
        let fields = geometry::fields(self.job, of.surface, sample, &points);
        let values = ["k1", "k2"].map(|wanted| {
            let values = fields.iter().find(|field| field.name == wanted).map(|field| &field.values);
            move |k: usize| match values {
                Some(Values::Scalars(values)) => values.at(k).unwrap_or(f64::NAN),
                _ => f64::NAN,
            }
        });
        Ok(curvature_numbers(&points, (0..points.len()).map(|k| values.each_ref().map(|of| of(k)))))
    }

    fn at(&self, name: &str, [row, column]: [usize; 2]) -> Result<Numbers, Failure> {
        let of = self.named(name)?;
        let sample = sample_of(self.job, name)?;
        let points = solve::points(self.job, of.surface, sample, self.options()).points;
        Ok(place_numbers(points.get(row * sample.counts[1] + column)))
    }

    fn contact(&self, name: &str) -> Result<Numbers, Failure> {
        let contact = self.job.contacts.iter().find(|known| known.name == name);
        let contact = contact.ok_or_else(|| Failure::Input(format!("there is no contact `{name}`")))?;
        let is_own = |(axis, _): &&(String, MountingError)| contact.errors.iter().any(|known| known.name == *axis);
        let errors = self.errors.iter().filter(is_own).cloned().collect();
        let request = contact_request(self.which, errors);
        let found = rolled(self.job, contact, &request, self.session)?.result;
        let middle = found.middle.as_ref();
        let on = middle.map(|middle| &middle.on[1]);
        let share = |k: usize| on.and_then(|on| on.shares).map(|shares| shares[k]);
        let half = |k: usize| middle.and_then(|middle| middle.ellipse).map(|ellipse| ellipse[k]);
        let numbers = vec![
            found.error.as_ref().map(|error| error.peak_to_peak),
            middle.map(|middle| middle.error),
            found.ratio,
            share(0),
            share(1),
            on.map(|on| on.z),
            on.map(|on| on.rho),
            half(0),
            half(1),
        ];
        Ok((numbers, found.not_done.first().map(kind_of)))
    }
}

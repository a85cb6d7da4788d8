//! What is compiled of a job while settings are open.

use std::sync::{Mutex, MutexGuard, PoisonError};

use flank_chain_dsl::{Coordinate, GeneratedSurface, Job, Parameter, Solid};
use flank_expr::{Expr, Graph};
use flank_solver::{
    BoundSurface, Deviation, Outcome, SecondaryCutting, SurfaceFamily, SurfaceGeometry, SurfacePoint, SurfacePoints,
};

use super::super::inputs::StudyInput;
use super::collected::{Collected, sample_of};
use super::compiled::CompiledNumbers;
use super::numbers::{NominalPoints, contact_request};
use crate::compare::map::{find, is_solved};
use crate::contact::family::ContactFamily;
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::solve::limits::{self, Sought};
use crate::solve::required::RequiredNumber;
use crate::solve::starts::{self, Asked, Starts};
use crate::solve::{self, blank, followed, kept, ranges, secondary};

/// A job whose settings are open.
pub(super) struct Opened<'o, 'g> {
    which: &'o JobSelection,
    job: &'o Job<'g>,
    inputs: &'o [StudyInput],
    open: &'o [&'o Parameter<'g>],
    settings: Vec<(Expr<'g>, f64)>,
    bindings: &'o [(Expr<'g>, Expr<'g>)],
    session: Session<'o>,
    /// Those that were asked for, with the names of their surfaces.
    samples: Vec<(&'o str, Sampled)>,
}

/// A surface at the points of a grid.
pub(super) struct Sampled {
    family: SurfaceFamily,
    targets: Vec<[f64; 2]>,
    counts: [usize; 2],
    /// Unknowns of the job itself in the middle of the grid, and what becomes of all its points.
    start: Option<Vec<f64>>,
    nominal: Vec<Outcome>,
    tool: Option<SecondaryCutting>,
    blank: Option<Solid>,
    /// The points that the tool's other positions are looked at for, where they are not all.
    judged: Option<Vec<usize>>,
    /// Of cases that are done: the next ones take it.
    memory: Mutex<Memory>,
}

/// What nobody needs any more, as many of each as there were cases at the same time.
#[derive(Default)]
struct Memory {
    solved: Vec<SurfacePoints>,
    points: Vec<Vec<SurfacePoint>>,
}

impl<'o, 'g> Opened<'o, 'g> {
    /// With those of the inputs `open` that are settings; `bindings` are the values of all others.
    pub(super) fn new(
        (which, job): (&'o JobSelection, &'o Job<'g>),
        (inputs, open): (&'o [StudyInput], &'o [&'o Parameter<'g>]),
        bindings: &'o [(Expr<'g>, Expr<'g>)],
        session: Session<'o>,
    ) -> Opened<'o, 'g> {
        let settings = open.iter().map(|of| (of.variable, of.value)).collect();
        Opened { which, job, inputs, open, settings, bindings, session, samples: Vec::new() }
    }

    fn bound(&self, surface: &GeneratedSurface<'g>) -> BoundSurface<'g> {
        BoundSurface::new(&surface.surface, ranges(surface), self.bindings)
    }

    /// The samples that were asked for.
    pub(super) fn into_samples(self) -> Vec<Sampled> {
        let nominal = self.nominal();
        self.samples.into_iter().map(|(_, sampled)| sampled.begun(&nominal)).collect()
    }

    /// What gives the numbers of something that is collected. `None` where each case needs its text: where the numbers need more than what
    /// settings change in equations.
    pub(super) fn collected(
        &mut self,
        of: &Collected,
        nominal: Option<&NominalPoints>,
    ) -> Result<Option<CompiledNumbers>, Failure> {
        match (of, nominal) {
            (Collected::Points, _) => Ok(self.all_samples().map(CompiledNumbers::Points)),
            (Collected::Requirements, _) => Ok(self.requirements()),
            (Collected::Limits, _) => Ok(Some(self.limits())),
            (Collected::EaseOff(name), Some(nominal)) => self.ease_off(name, nominal).map(Some),
            (Collected::EaseOff(_), None) => Ok(None),
            (Collected::At(name, at), _) => self.at(name, *at),
            (Collected::Curvature(name), _) => self.curvature(name),
            (Collected::Width([a, b]), _) => self.width([a, b]),
            (Collected::Contact(name), _) => self.contact(name),
        }
    }

    /// The numbers of all samples. `None` where other surfaces cut points away.
    pub(super) fn all_samples(&mut self) -> Option<Vec<usize>> {
        let sampled = self.job.surfaces.iter().filter(|surface| surface.sample.is_some());
        sampled.map(|surface| self.sample(surface, None)).collect()
    }

    /// The number of a surface's sample, of which one point is wanted or all. `None` where other surfaces cut some of its points away.
    fn sample(&mut self, surface: &'o GeneratedSurface<'g>, wanted: Option<usize>) -> Option<usize> {
        let known = self.samples.iter().position(|(name, _)| *name == surface.name);
        if known.is_none() {
            let sampled = self.sampled(surface)?;
            self.samples.push((&surface.name, Sampled { judged: Some(Vec::new()), ..sampled }));
        }
        let number = known.unwrap_or(self.samples.len() - 1);
        let judged = &mut self.samples[number].1.judged;
        match (wanted, judged.as_mut()) {
            (Some(point), Some(points)) => points.push(point),
            (Some(_), None) => {}
            (None, _) => *judged = None,
        }
        Some(number)
    }

    /// The points that the sample of a surface asks for.
    fn sampled(&self, surface: &GeneratedSurface<'g>) -> Option<Sampled> {
        let sample = surface.sample.as_ref().filter(|_| surface.trimmed_by.is_empty() && surface.cut_by.is_none())?;
        let graph = surface.surface.position.0[0].graph();
        let tool = graph.with_settings(&self.settings, || secondary::tool_positions(self.job, surface, self.bindings));
        let tool = tool.ok().inspect(SecondaryCutting::translate);
        let blank = blank::of(self.job, surface).cloned();
        let alone = self.alone(surface, &sample.coordinates, (sample.targets(), sample.counts));
        Some(Sampled { tool, blank, ..alone })
    }

    fn requirements(&mut self) -> Option<CompiledNumbers> {
        let sampled = self.job.surfaces.iter().filter(|surface| surface.sample.is_some());
        let required = sampled.map(|surface| {
            let graph = surface.surface.position.0[0].graph();
            let required = graph.with_settings(&self.settings, || RequiredNumber::all(surface, self.bindings));
            Some((self.sample(surface, None)?, required))
        });
        required.collect::<Option<Vec<_>>>().map(CompiledNumbers::Requirements)
    }

    fn limits(&self) -> CompiledNumbers {
        let sought = self.job.surfaces.iter().flat_map(limits::sought);
        CompiledNumbers::Limits(sought.map(|sought| (sought.kind, [0, 1].map(|k| self.line(&sought, k)))).collect())
    }

    /// The points of a line at values of one of the coordinates of its sample.
    fn line(&self, sought: &Sought<'_, 'g>, k: usize) -> Sampled {
        let (surface, targets) = (sought.surface, sought.targets(k));
        let of = [sought.quantity, sought.sample.coordinates[k].value];
        let bound = self.bound(surface);
        let family = SurfaceFamily::line(&bound, of, &self.settings, |problem| {
            problem
                .following_beyond(followed(surface))
                .with_instruction_set(self.session.instructions())
                .keeping(&bound, &kept(surface))
        });
        let family = family.expect("a job without errors leaves nothing unbound");
        let counts = [1, targets.len()];
        Sampled::new(family, targets, counts).begun(&self.nominal())
    }

    /// Points at values of two coordinates, whatever else cuts some of them away.
    fn alone(
        &self,
        surface: &GeneratedSurface<'g>,
        coordinates: &[Coordinate<'g>; 2],
        (targets, counts): (Vec<[f64; 2]>, [usize; 2]),
    ) -> Sampled {
        let coordinates = coordinates.each_ref().map(|coordinate| coordinate.value);
        let family = solve::family(surface, coordinates, (&self.settings, self.bindings), self.session);
        Sampled::new(family, targets, counts)
    }

    /// The points of a surface beside those of another one.
    fn beside(&self, surface: &GeneratedSurface<'g>, (asked, points): (&Asked, &[SurfacePoint])) -> Sampled {
        let starts = Starts::beside(surface, (asked, points), blank::alignment(self.job, surface));
        self.alone(surface, &starts.coordinates, (starts.targets, asked.counts)).begun(&self.nominal())
    }

    fn deviation(&self, surface: &GeneratedSurface<'g>) -> Deviation {
        let graph: &'g Graph = surface.surface.position.0[0].graph();
        let alignment = blank::alignment(self.job, surface);
        let compared = graph.with_settings(&self.settings, || Deviation::new(&self.bound(surface), alignment));
        let compared = compared.expect("a job without errors leaves nothing unbound");
        compared.translate();
        compared
    }

    fn surface(&self, name: &str) -> Result<&'o GeneratedSurface<'g>, Failure> {
        Ok(find(std::slice::from_ref(self.job), name)?.surface)
    }

    fn ease_off(&self, name: &str, nominal: &NominalPoints) -> Result<CompiledNumbers, Failure> {
        let surface = self.surface(name)?;
        let near = self.beside(surface, (&nominal.asked, &nominal.points));
        Ok(CompiledNumbers::EaseOff(Box::new((near, self.deviation(surface)))))
    }

    fn at(&mut self, name: &str, [row, column]: [usize; 2]) -> Result<Option<CompiledNumbers>, Failure> {
        let columns = sample_of(self.job, name)?.counts[1];
        let point = row * columns + column;
        let sample = self.sample(self.surface(name)?, Some(point));
        Ok(sample.map(|sample| CompiledNumbers::At(sample, point)))
    }

    fn curvature(&mut self, name: &str) -> Result<Option<CompiledNumbers>, Failure> {
        let (surface, sample) = (self.surface(name)?, sample_of(self.job, name)?);
        let Some(number) = self.sample(surface, None) else { return Ok(None) };
        let coordinates = sample.functions();
        let graph = surface.surface.position.0[0].graph();
        let geometry = graph.with_settings(&self.settings, || {
            SurfaceGeometry::new(&self.bound(surface), &surface.generation.motions, coordinates)
        });
        let geometry = geometry.expect("a job without errors leaves nothing unbound");
        Ok(Some(CompiledNumbers::Curvature(number, Box::new(geometry))))
    }

    /// `None` where the places that the sample of the second surface asks for depend on the case.
    fn width(&self, [a, b]: [&str; 2]) -> Result<Option<CompiledNumbers>, Failure> {
        let (near, from, sample) = (self.surface(a)?, self.surface(b)?, sample_of(self.job, b)?);
        let asked = Asked::with_centre(sample);
        if !asked.is_of_places() {
            return Ok(None);
        }
        let points =
            self.alone(from, &sample.coordinates, (asked.targets.clone(), asked.counts)).begun(&self.nominal());
        let both = [self.beside(near, (&asked, &[])), points];
        let middle = asked.centre.middle();
        Ok(Some(CompiledNumbers::Width(Box::new((both, self.deviation(near), middle)))))
    }

    /// `None` where the inputs change how the members turn, or the flanks of the job itself do not touch.
    fn contact(&self, name: &str) -> Result<Option<CompiledNumbers>, Failure> {
        let Some(contact) = self.job.contacts.iter().find(|known| known.name == name) else { return Ok(None) };
        let own = |input: &StudyInput| contact.errors.iter().position(|axis| axis.name == input.name);
        let inputs = self.inputs.iter().enumerate().filter(|(_, input)| input.is_axis);
        let (mut given, axes): (Vec<usize>, Vec<usize>) =
            inputs.filter_map(|(k, input)| Some((k, own(input)?))).unzip();
        given.extend((0..self.inputs.len()).filter(|k| !self.inputs[*k].is_axis));
        let request = contact_request(self.which, Vec::new());
        let family = ContactFamily::new(self.job, contact, (&axes, self.open), &request, self.session)?;
        Ok(family.map(|family| CompiledNumbers::Contact(Box::new((family, given)))))
    }

    fn nominal(&self) -> Vec<f64> {
        self.settings.iter().map(|(_, value)| *value).collect()
    }
}

impl Sampled {
    fn new(family: SurfaceFamily, targets: Vec<[f64; 2]>, counts: [usize; 2]) -> Sampled {
        let (nominal, memory) = (Vec::new(), Mutex::default());
        Sampled { family, targets, counts, start: None, nominal, tool: None, blank: None, judged: None, memory }
    }

    /// With what the job itself has, whose settings have these values.
    fn begun(self, values: &[f64]) -> Sampled {
        let points = self.searched(values);
        let middle = points.get(starts::middle(self.counts)).filter(|point| is_solved(point));
        let start = middle.map(|point| point.unknowns.clone());
        Sampled { start, nominal: points.iter().map(|point| kind(point.outcome)).collect(), ..self }
    }

    pub(super) fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// With values of the settings: on the branch of the job itself while `is_followed`, as long as its points are like those of the job;
    /// on the one that is found among all otherwise.
    pub(super) fn at(&self, values: &[f64], is_followed: &mut bool) -> Vec<SurfacePoint> {
        if *is_followed && let Some(start) = &self.start {
            let points = self.solved(values, Some(start));
            if points.iter().map(|point| kind(point.outcome)).eq(self.nominal.iter().copied()) {
                return points;
            }
        }
        *is_followed = false;
        self.searched(values)
    }

    fn searched(&self, values: &[f64]) -> Vec<SurfacePoint> {
        self.solved(values, None)
    }

    /// Takes the memory of points that are not needed any more.
    pub(super) fn take_back(&self, points: Vec<SurfacePoint>) {
        self.memory().points.push(points);
    }

    fn memory(&self) -> MutexGuard<'_, Memory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn solved(&self, values: &[f64], start: Option<&[f64]>) -> Vec<SurfacePoint> {
        let memory = self.memory().solved.pop();
        let (solved, _) = self.family.at(values).solve_points(&self.targets, self.counts, start, memory);
        let mut points = self.memory().points.pop().unwrap_or_default();
        solved.write_to(&mut points);
        self.memory().solved.push(solved);
        if let Some(tool) = &self.tool {
            let tool = tool.with_settings(values);
            match &self.judged {
                Some(only) => tool.judge_some(&mut points, self.counts, only),
                None => tool.judge(&mut points, self.counts),
            };
        }
        if let Some(solid) = &self.blank {
            blank::cut_by(solid, &mut points);
        }
        points
    }
}

/// An outcome without its numbers.
fn kind(outcome: Outcome) -> Outcome {
    match outcome {
        Outcome::Outside { unknown, .. } => Outcome::Outside { unknown, by: 0.0 },
        Outcome::NotConverged { .. } => Outcome::NotConverged { iterations: 0 },
        other => other,
    }
}

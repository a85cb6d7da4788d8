//! What is compiled of a job while settings are open.

use flank_chain_dsl::{Coordinate, GeneratedSurface, Job, Parameter, Solid};
use flank_expr::{Expr, Graph};
use flank_solver::{
    BoundSurface, Deviation, Outcome, Range, SecondaryCutting, SurfaceFamily, SurfaceGeometry, SurfacePoint,
};

use super::collect::{NominalPoints, contact_request, sample_of};
use super::compiled::CompiledNumbers;
use super::inputs::StudyInput;
use crate::compare::map::{find, is_solved};
use crate::contact::family::ContactFamily;
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::solve::starts::{self, Asked, Starts};
use crate::solve::{blank, followed, ranges, secondary};

/// A job whose settings are open.
pub(super) struct Opened<'o, 'g> {
    which: &'o JobSelection,
    job: &'o Job<'g>,
    inputs: &'o [StudyInput],
    open: &'o [&'o Parameter<'g>],
    settings: Vec<(Expr<'g>, f64)>,
    bindings: &'o [(Expr<'g>, Expr<'g>)],
    session: Session<'o>,
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
        Opened { which, job, inputs, open, settings, bindings, session }
    }

    fn bound(&self, surface: &GeneratedSurface<'g>) -> BoundSurface<'g> {
        BoundSurface::new(&surface.surface, ranges(surface), self.bindings)
    }

    fn family(&self, surface: &GeneratedSurface<'g>, coordinates: [Expr<'g>; 2]) -> SurfaceFamily {
        let bound = self.bound(surface);
        let kept = surface.sample.iter().flat_map(|sample| &sample.keep);
        let keep: Vec<_> = kept.map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect();
        let made = SurfaceFamily::new(&bound, coordinates, &self.settings, |problem| {
            problem
                .following_beyond(followed(surface))
                .with_instruction_set(self.session.instructions())
                .boxes(self.session.boxes())
                .keeping(&bound, &keep)
        });
        made.expect("a job without errors leaves nothing unbound")
    }

    /// All samples. `None` where other surfaces cut points away.
    pub(super) fn points(&self) -> Option<CompiledNumbers> {
        let sampled = self.job.surfaces.iter().filter(|surface| surface.sample.is_some());
        let all = sampled.map(|surface| self.sampled(surface));
        all.collect::<Option<Vec<Sampled>>>().map(CompiledNumbers::Points)
    }

    /// The points that the sample of a surface asks for. `None` where other surfaces cut some of them away.
    fn sampled(&self, surface: &GeneratedSurface<'g>) -> Option<Sampled> {
        let sample = surface.sample.as_ref().filter(|_| surface.trimmed_by.is_empty() && surface.cut_by.is_none())?;
        let graph = surface.surface.position.0[0].graph();
        let tool = graph.with_settings(&self.settings, || secondary::tool_positions(self.job, surface, self.bindings));
        let tool = tool.ok().inspect(SecondaryCutting::translate);
        let blank = blank::of(self.job, surface).cloned();
        let alone = self.alone(surface, &sample.coordinates, (sample.targets(), sample.counts));
        Some(Sampled { tool, blank, ..alone }.begun(&self.nominal()))
    }

    /// Points at values of two coordinates, whatever else cuts some of them away.
    fn alone(
        &self,
        surface: &GeneratedSurface<'g>,
        coordinates: &[Coordinate<'g>; 2],
        (targets, counts): (Vec<[f64; 2]>, [usize; 2]),
    ) -> Sampled {
        let family = self.family(surface, coordinates.each_ref().map(|coordinate| coordinate.value));
        Sampled { family, targets, counts, start: None, nominal: Vec::new(), tool: None, blank: None }
    }

    /// The points of a surface beside those of another one.
    fn beside(&self, surface: &GeneratedSurface<'g>, (asked, points): (&Asked, &[SurfacePoint])) -> Sampled {
        let starts = Starts::beside(surface, (asked, points));
        self.alone(surface, &starts.coordinates, (starts.targets, asked.counts)).begun(&self.nominal())
    }

    fn deviation(&self, surface: &GeneratedSurface<'g>) -> Deviation {
        let graph: &'g Graph = surface.surface.position.0[0].graph();
        let compared = graph.with_settings(&self.settings, || Deviation::new(&self.bound(surface)));
        let compared = compared.expect("a job without errors leaves nothing unbound");
        compared.translate();
        compared
    }

    fn surface(&self, name: &str) -> Result<&'o GeneratedSurface<'g>, Failure> {
        Ok(find(std::slice::from_ref(self.job), name)?.surface)
    }

    pub(super) fn ease_off(&self, name: &str, nominal: &NominalPoints) -> Result<CompiledNumbers, Failure> {
        let surface = self.surface(name)?;
        let near = self.beside(surface, (&nominal.asked, &nominal.points));
        Ok(CompiledNumbers::EaseOff(Box::new((near, self.deviation(surface)))))
    }

    pub(super) fn at(&self, name: &str, [row, column]: [usize; 2]) -> Result<Option<CompiledNumbers>, Failure> {
        let columns = sample_of(self.job, name)?.counts[1];
        let sampled = self.sampled(self.surface(name)?);
        Ok(sampled.map(|sampled| CompiledNumbers::At(Box::new(sampled), row * columns + column)))
    }

    pub(super) fn curvature(&self, name: &str) -> Result<Option<CompiledNumbers>, Failure> {
        let (surface, sample) = (self.surface(name)?, sample_of(self.job, name)?);
        let Some(sampled) = self.sampled(surface) else { return Ok(None) };
        let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
        let graph = surface.surface.position.0[0].graph();
        let geometry = graph.with_settings(&self.settings, || {
            SurfaceGeometry::new(&self.bound(surface), &surface.generation.motions, coordinates)
        });
        let geometry = geometry.expect("a job without errors leaves nothing unbound");
        Ok(Some(CompiledNumbers::Curvature(Box::new((sampled, geometry)))))
    }

    /// `None` where the places that the sample of the second surface asks for depend on the case.
    pub(super) fn width(&self, [a, b]: [&str; 2]) -> Result<Option<CompiledNumbers>, Failure> {
        let (near, from, sample) = (self.surface(a)?, self.surface(b)?, sample_of(self.job, b)?);
        let asked = Asked::of_sample(sample);
        if !asked.is_of_places() {
            return Ok(None);
        }
        let points = self.alone(from, &sample.coordinates, (sample.targets(), sample.counts)).begun(&self.nominal());
        let both = [self.beside(near, (&asked, &[])), points];
        Ok(Some(CompiledNumbers::Width(Box::new((both, self.deviation(near))))))
    }

    /// `None` where the inputs change how the members turn, or the flanks of the job itself do not touch.
    pub(super) fn contact(&self, name: &str) -> Result<Option<CompiledNumbers>, Failure> {
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

    fn solved(&self, values: &[f64], start: Option<&[f64]>) -> Vec<SurfacePoint> {
        let (points, _) = self.family.at(values).solve_points(&self.targets, self.counts, start, None);
        let mut points: Vec<SurfacePoint> = (0..points.len()).map(|k| points.point(k)).collect();
        if let Some(tool) = &self.tool {
            tool.with_settings(values).judge(&mut points, self.counts);
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

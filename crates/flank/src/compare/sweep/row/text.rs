//! A case that is computed from its text.

use flank_chain_dsl::{Job, compile_request};
use flank_export::Values;
use flank_expr::Graph;
use flank_solver::Deviation;

use super::super::inputs::StudyInput;
use super::collected::{Collected, sample_of};
use super::numbers::{
    NominalPoints, Numbers, contact_request, curvature_numbers, ease_off_numbers, line_counts, missed_count,
    place_numbers, point_counts,
};
use super::{Found, SolvedSample, kind_of};
use crate::compare::deviation;
use crate::compare::map::{Named, find};
use crate::contact::result::TransmissionError;
use crate::contact::rolled;
use crate::project::failure::Failure;
use crate::project::findings::Findings;
use crate::project::once::KnownSamples;
use crate::project::requests::{JobSelection, MountingError};
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::solve::required::RequiredNumber;
use crate::solve::starts::Starts;
use crate::solve::{self, SolveOptions, bound, geometry};

/// What becomes of the job with these values of the inputs.
///
/// # Errors
/// What is wrong with it, that something is not there, or that the work is cancelled.
pub(super) fn found<'i>(
    which: &JobSelection,
    given: impl Iterator<Item = (&'i StudyInput, &'i f64)> + Clone,
    (collect, nominal): (&[Collected], &[Option<NominalPoints>]),
    keeps: bool,
    session: Session<'_>,
) -> Result<Found, Failure> {
    let errors = given.clone().filter(|(input, _)| input.is_axis).map(|(input, value)| input.as_error(*value));
    let errors: Vec<(String, MountingError)> = errors.collect();
    let mut which = which.clone();
    for (input, value) in given.filter(|(input, _)| !input.is_axis) {
        let (name, value) = input.as_setting(*value);
        which.set.retain(|(known, _)| *known != name);
        which.set.push((name, value));
    }
    let graph = Graph::new();
    let mut compilation = compile_request(&graph, which.file(), &which.request());
    if compilation.has_errors() {
        return Err(Failure::Findings(Findings::new(&compilation.diagnostics, &compilation.sources)));
    }
    let jobs = compilation.take_jobs(which.job.as_slice());
    let jobs = jobs.map_err(|findings| Failure::Findings(Findings::new(&findings, &compilation.sources)))?;
    let origin = Origin::of_compilation(&compilation);
    // several of what is collected ask for the same samples
    let known = KnownSamples::default();
    let session = session.with_known(&known);
    let case = Case { job: &jobs[0], jobs: &jobs, which: &which, origin, errors, session };
    let (mut numbers, mut why) = (Vec::new(), None);
    for (of, nominal) in collect.iter().zip(nominal) {
        session.check()?;
        let (found, lost) = case.collected(of, nominal.as_ref())?;
        numbers.extend(found);
        why = why.or(lost);
    }
    let points = keeps.then(|| case.samples()).transpose()?;
    Ok(Found::of_numbers(numbers, why, false).with_points(points))
}

struct Case<'c, 'g> {
    job: &'c Job<'g>,
    jobs: &'c [Job<'g>],
    which: &'c JobSelection,
    origin: Origin,
    errors: Vec<(String, MountingError)>,
    session: Session<'c>,
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
            (Collected::Points, _) => Ok(point_counts(self.samples()?.iter().flat_map(|(_, points)| points))),
            (Collected::Requirements, _) => self.requirements(),
            (Collected::Limits, _) => self.limits(),
            (Collected::Width([a, b]), _) => self.width([a.as_str(), b.as_str()]),
            (Collected::Curvature(name), _) => self.curvature(name),
            (Collected::At(name, at), _) => self.at(name, *at),
            (Collected::Contact(name), _) => self.contact(name),
        }
    }

    /// The points of all samples, by their surfaces.
    fn samples(&self) -> Result<Vec<SolvedSample>, Failure> {
        let sampled = self.job.surfaces.iter().filter_map(|surface| Some((surface, surface.sample.as_ref()?)));
        let solved = sampled.map(|(surface, sample)| {
            self.session.check()?;
            Ok((sample.counts, solve::points(self.job, surface, sample, self.options()).points))
        });
        solved.collect()
    }

    fn requirements(&self) -> Result<Numbers, Failure> {
        let bindings = self.job.bindings();
        let sampled = self.job.surfaces.iter().filter(|surface| surface.sample.is_some());
        let samples = self.samples()?;
        let missed = sampled.zip(&samples).map(|(surface, (_, points))| {
            let required = RequiredNumber::all(surface, &bindings);
            required.iter().map(|number| number.missed(points).count()).sum::<usize>()
        });
        Ok(missed_count(missed.sum()))
    }

    fn limits(&self) -> Result<Numbers, Failure> {
        let lines = solve::limits::lines(self.job, &self.job.surfaces, self.session)?;
        Ok(line_counts(lines.iter().map(|line| (line.kind, line.points.as_slice()))))
    }

    fn named(&self, name: &str) -> Result<Named<'_, '_>, Failure> {
        Ok(find(self.jobs, name)?)
    }

    fn ease_off(&self, name: &str, nominal: &NominalPoints) -> Result<Numbers, Failure> {
        let NominalPoints { asked, points } = nominal;
        let of = self.named(name)?;
        let starts = Starts::beside(of.surface, (asked, points), of.alignment());
        let (near, lost) = deviation::solved(of, (&starts.coordinates, &starts.targets, asked.counts), self.session);
        let compared = Deviation::new(&bound(of.job, of.surface), of.alignment())
            .expect("a job without errors leaves nothing unbound");
        let (numbers, why) = ease_off_numbers(&compared, nominal, &near);
        Ok((numbers, lost.map(|lost| kind_of(&lost)).or(why)))
    }

    fn width(&self, [a, b]: [&str; 2]) -> Result<Numbers, Failure> {
        let found = deviation::measure([self.named(a)?, self.named(b)?], false, self.session)?;
        let found = found.result(Vec::new(), &self.origin);
        let lost = found.moved_mm().is_none().then(|| found.not_done.first().map(kind_of).unwrap_or_default());
        // what is shifted is not turned
        Ok((vec![found.turn_deg.or(found.shift_mm.map(|_| 0.0)), found.moved_mm()], lost))
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
            found.error.as_ref().and_then(TransmissionError::whole),
            middle.map(|middle| middle.error),
            found.ratio,
            share(0),
            share(1),
            on.map(|on| on.z),
            on.map(|on| on.rho),
            half(0),
            half(1),
        ];
        let is_short = found.error.as_ref().is_some_and(|error| error.whole().is_none());
        let short = is_short.then(|| "roll_too_short".to_string());
        Ok((numbers, found.not_done.first().map(kind_of).or(short)))
    }
}

//! Cases that differ by settings and mounting errors alone, compiled once: settings stay open in all tapes, and each case gives them numbers.

use flank_chain_dsl::{GeneratedSurface, Job, OpenSide, Parameter};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Deviation, Outcome, SurfaceGeometry, SurfacePoint};

use super::super::inputs::{StudyInput, size_of_unit};
use super::collected::Collected;
use super::numbers::{
    NominalPoints, Numbers, contact_numbers, curvature_numbers, ease_off_numbers, line_counts, missed_count,
    place_numbers, point_counts, width_numbers,
};
use super::opened::{Opened, Sampled};
use super::{Found, SolvedSample};
use crate::contact::family::ContactFamily;
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::solve::limits;
use crate::solve::required::RequiredNumber;

/// The branch is looked for anew in each case whose number is a multiple of this, and in each whose points are not all as in the
/// nominal one.
const SEARCHED: u64 = 100;
/// A range may be missed by so much of its ends: a conversion of units rounds.
const ROUNDING: f64 = 1e-12;

/// All that is collected, for any values of the inputs.
pub(super) struct Compiled {
    /// Of the units of the inputs.
    sizes: Vec<f64>,
    /// Which inputs are settings.
    settings: Vec<usize>,
    /// All parameters as they follow from the settings, with the ranges that they must lie in.
    following: Tape,
    allowed: Vec<Option<(f64, f64)>>,
    /// Where the steel has to stay.
    sides: Vec<OpenSide>,
    /// The samples that something is collected of, each once.
    samples: Vec<Sampled>,
    collected: Vec<CompiledNumbers>,
    /// The samples whose points are kept.
    kept: Option<Vec<usize>>,
}

/// What gives the numbers of something that is collected. Samples are told by their number.
pub(super) enum CompiledNumbers {
    Points(Vec<usize>),
    Requirements(Vec<(usize, Vec<RequiredNumber>)>),
    /// Lines by their kind, looked for at values of either coordinate of their sample.
    Limits(Vec<(&'static str, [Sampled; 2])>),
    EaseOff(Box<(Sampled, Deviation)>),
    /// A point of a sample by its number.
    At(usize, usize),
    Curvature(usize, Box<SurfaceGeometry>),
    /// A surface, another one that it is turned to, what turns, and the number of the point in the middle.
    Width(Box<([Sampled; 2], Deviation, usize)>),
    /// With the inputs that change it.
    Contact(Box<(ContactFamily, Vec<usize>)>),
}

/// The values of a case, inside, and its points as far as they were asked for.
struct CaseNumbers<'c> {
    all: &'c [f64],
    settings: &'c [f64],
    is_followed: bool,
    samples: &'c [Sampled],
    points: Vec<Option<Vec<SurfacePoint>>>,
    session: Session<'c>,
}

impl Compiled {
    /// For a job; or why cases differ by more than numbers in its equations: the inputs decide ranges or samples or are counts, or
    /// something is collected that needs more.
    pub(super) fn new<'g>(
        (which, job): (&JobSelection, &Job<'g>),
        inputs: &[StudyInput],
        (collect, nominal): (&[Collected], &[Option<NominalPoints>]),
        keeps: bool,
        session: Session<'_>,
    ) -> Result<Result<Compiled, String>, Failure> {
        let settings: Vec<usize> = (0..inputs.len()).filter(|k| !inputs[*k].is_axis).collect();
        let parameter = |k: &usize| job.parameters.iter().find(|of| of.name == inputs[*k].name);
        let open: Vec<&Parameter<'g>> = settings.iter().filter_map(parameter).collect();
        if let Some(of) = open.iter().find(|of| of.is_count || job.decisive.contains(&of.variable)) {
            return Ok(Err(decides(of)));
        }
        let variables: Vec<Expr<'g>> = open.iter().map(|of| of.variable).collect();
        let bindings = job.bindings_beside(&variables);
        let all: Vec<Expr<'g>> = job.parameters.iter().map(|of| of.variable).collect();
        let following = match all.first() {
            Some(first) => Tape::new(&first.graph().substitute(&all, &bindings), &variables),
            None => Tape::new(&[], &[]),
        };
        let mut opened = Opened::new((which, job), (inputs, &open), &bindings, session);
        let mut collected = Vec::new();
        for (of, nominal) in collect.iter().zip(nominal) {
            let Some(compiled) = opened.collected(of, nominal.as_ref())? else { return Ok(Err(needs_texts(job, of))) };
            collected.push(compiled);
        }
        let kept = if keeps { opened.all_samples() } else { Some(Vec::new()) };
        let Some(kept) = kept else { return Ok(Err(needs_texts(job, &Collected::Points))) };
        Ok(Ok(Compiled {
            sizes: inputs.iter().map(|input| size_of_unit(&input.unit).map_or(1.0, |(size, _)| size)).collect(),
            settings,
            following: following.expect("a job without errors leaves nothing unbound"),
            allowed: job.parameters.iter().map(|of| of.range).collect(),
            sides: job.steel_sides.iter().filter_map(|side| side.opened(&variables, &bindings)).collect(),
            samples: opened.into_samples(),
            collected,
            kept: keeps.then_some(kept),
        }))
    }

    /// A case with these values of the inputs, in their units. `None` where it has to be computed from its text: where the contact is
    /// looked for anew, and where something is lost or of another kind than in the job itself.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn found(
        &self,
        (number, values): (u64, &[f64]),
        nominal: &[Option<NominalPoints>],
        nothing: impl Fn(&'static str, &str) -> Found,
        session: Session<'_>,
    ) -> Result<Option<Found>, Failure> {
        let all: Vec<f64> = values.iter().zip(&self.sizes).map(|(value, size)| value * size).collect();
        let settings: Vec<f64> = self.settings.iter().map(|k| all[*k]).collect();
        let mut following = vec![0.0; self.following.output_count()];
        ScalarEvaluator::new(&self.following).run(&settings, &mut following);
        let is_beyond = |(value, range): (&f64, &Option<(f64, f64)>)| {
            range.is_some_and(|(low, high)| {
                let slack = ROUNDING * low.abs().max(high.abs());
                !(*value >= low - slack && *value <= high + slack)
            })
        };
        if following.iter().zip(&self.allowed).any(is_beyond) {
            return Ok(Some(nothing("spec wrong", flank_chain_dsl::Code::OutOfRange.as_str())));
        }
        if !self.sides.iter().all(|side| side.is_kept(&settings)) {
            return Ok(None);
        }
        let mut case = CaseNumbers {
            all: &all,
            settings: &settings,
            is_followed: !number.is_multiple_of(SEARCHED),
            samples: &self.samples,
            points: vec![None; self.samples.len()],
            session,
        };
        let (mut numbers, mut why) = (Vec::new(), None);
        for (of, nominal) in self.collected.iter().zip(nominal) {
            let Some((found, lost)) = of.numbers(&mut case, nominal.as_ref())? else { return Ok(None) };
            numbers.extend(found);
            why = why.or(lost);
        }
        let kept = self.kept.iter().flatten().map(|k| Ok((self.samples[*k].counts(), case.points(*k)?.to_vec())));
        let kept: Vec<SolvedSample> = kept.collect::<Result<_, Failure>>()?;
        let found = Found::of_numbers(numbers, why, case.is_followed);
        let CaseNumbers { points, .. } = case;
        self.samples.iter().zip(points).for_each(|(of, points)| points.into_iter().for_each(|own| of.take_back(own)));
        Ok(Some(found.with_points(self.kept.is_some().then_some(kept))))
    }
}

/// Why a setting cannot stay open.
fn decides(of: &Parameter<'_>) -> String {
    match of.is_count {
        true => format!("`{}` is a count", of.name),
        false => format!(
            "`{}` decides more than numbers in equations, as a range, a sample or a joint of a profile",
            of.name
        ),
    }
}

/// Why something cannot be collected where settings are open.
fn needs_texts(job: &Job<'_>, of: &Collected) -> String {
    match of {
        Collected::Contact(name) => {
            format!(
                "the inputs change how the pair of contact `{name}` turns, or its flanks do not touch in the job itself"
            )
        }
        Collected::Width([_, name]) => format!("where the sample of `{name}` asks for points depends on the case"),
        Collected::At(name, _) | Collected::Curvature(name) | Collected::EaseOff(name) => {
            format!("`{name}` is trimmed or cut by others")
        }
        Collected::Points | Collected::Requirements | Collected::Limits => {
            let is_cut = |of: &&GeneratedSurface<'_>| !of.trimmed_by.is_empty() || of.cut_by.is_some();
            let cut = job.surfaces.iter().filter(|of| of.sample.is_some()).find(is_cut);
            format!("`{}` is trimmed or cut by others", cut.map_or("", |of| &of.name))
        }
    }
}

impl CaseNumbers<'_> {
    /// Of one of the samples.
    fn points(&mut self, sample: usize) -> Result<&[SurfacePoint], Failure> {
        if self.points[sample].is_none() {
            self.points[sample] = Some(self.solved(&self.samples[sample])?);
        }
        Ok(self.points[sample].as_deref().expect("it was solved"))
    }

    /// # Errors
    /// If the work is cancelled.
    fn solved(&mut self, of: &Sampled) -> Result<Vec<SurfacePoint>, Failure> {
        self.session.check()?;
        Ok(of.at(self.settings, &mut self.is_followed))
    }

    /// The points of a line, looked for along the coordinate that follows it farther. Whether it is found anew says nothing of the
    /// branch of its surface.
    fn line(&self, along: &[Sampled; 2]) -> Result<Vec<SurfacePoint>, Failure> {
        let look = |k: usize| {
            self.session.check()?;
            Ok::<_, Failure>(along[k].at(self.settings, &mut { self.is_followed }))
        };
        let first = look(0)?;
        if first.iter().all(|point| point.outcome == Outcome::Solved) {
            return Ok(first);
        }
        let second = look(1)?;
        Ok(if limits::reach(&second) > limits::reach(&first) { second } else { first })
    }
}

impl CompiledNumbers {
    /// `None` where the case has to be computed from its text.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn numbers(&self, case: &mut CaseNumbers<'_>, nominal: Option<&NominalPoints>) -> Result<Option<Numbers>, Failure> {
        let settings = case.settings;
        Ok(Some(match self {
            CompiledNumbers::Points(samples) => {
                samples.iter().try_for_each(|k| case.points(*k).map(drop))?;
                point_counts(samples.iter().flat_map(|k| case.points[*k].iter().flatten()))
            }
            CompiledNumbers::Requirements(samples) => {
                let mut missed = 0;
                for (k, required) in samples {
                    let points = case.points(*k)?;
                    missed +=
                        required.iter().map(|of| of.with_settings(settings).missed(points).count()).sum::<usize>();
                }
                missed_count(missed)
            }
            CompiledNumbers::Limits(lines) => {
                let found = lines.iter().map(|(kind, along)| Ok((*kind, case.line(along)?)));
                let found: Vec<(&str, Vec<SurfacePoint>)> = found.collect::<Result<_, Failure>>()?;
                line_counts(found.iter().map(|(kind, points)| (*kind, points.as_slice())))
            }
            CompiledNumbers::EaseOff(of) => {
                let (near, compared) = &**of;
                let near = case.solved(near)?;
                let Some(nominal) = nominal else { return Ok(None) };
                ease_off_numbers(&compared.with_settings(settings), nominal, &near)
            }
            CompiledNumbers::At(k, at) => place_numbers(case.points(*k)?.get(*at)),
            CompiledNumbers::Curvature(k, geometry) => {
                let (points, geometry) = (case.points(*k)?, geometry.with_settings(settings));
                let principal = |point: &SurfacePoint| {
                    let is_solved = point.outcome == Outcome::Solved;
                    let curvature = is_solved.then(|| geometry.at(&point.unknowns).curvature).flatten()?.principal();
                    Some([curvature.k1, curvature.k2])
                };
                curvature_numbers(points, points.iter().filter_map(principal))
            }
            CompiledNumbers::Width(of) => {
                let ([near, from], compared, middle) = &**of;
                let [near, points] = [case.solved(near)?, case.solved(from)?];
                let both = points.get(*middle).zip(near.get(*middle));
                let both = both.filter(|(a, b)| [a, b].iter().all(|point| point.outcome == Outcome::Solved));
                let moved = both.and_then(|(point, near)| {
                    Some((compared.with_settings(settings).motion_to(point.position, near)?, point))
                });
                let Some((motion, point)) = moved else { return Ok(None) };
                width_numbers((compared.alignment(), motion), point)
            }
            CompiledNumbers::Contact(of) => {
                let (family, given) = &**of;
                let values: Vec<f64> = given.iter().map(|k| case.all[*k]).collect();
                // looked for among all places: from the text
                let numbers = if case.is_followed { family.at(&values, case.session)? } else { None };
                let Some(numbers) = numbers else { return Ok(None) };
                contact_numbers(&numbers)
            }
        }))
    }
}

//! Cases that differ by settings and mounting errors alone, compiled once: settings stay open in all tapes, and each case gives them numbers.

use flank_chain_dsl::{Job, Parameter};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Deviation, Outcome, SurfaceGeometry, SurfacePoint};

use super::collect::{
    Collected, Found, NominalPoints, Numbers, contact_numbers, curvature_numbers, ease_off_numbers, place_numbers,
    point_counts, width_numbers,
};
use super::inputs::{StudyInput, size_of_unit};
use super::opened::{Opened, Sampled};
use crate::contact::family::ContactFamily;
use crate::project::failure::Failure;
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::solve::starts;

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
    collected: Vec<CompiledNumbers>,
}

/// What gives the numbers of something that is collected.
pub(super) enum CompiledNumbers {
    Points(Vec<Sampled>),
    EaseOff(Box<(Sampled, Deviation)>),
    /// A point of a sample by its number.
    At(Box<Sampled>, usize),
    Curvature(Box<(Sampled, SurfaceGeometry)>),
    /// A surface, another one that it is turned to, and what turns.
    Width(Box<([Sampled; 2], Deviation)>),
    /// With the inputs that change it.
    Contact(Box<(ContactFamily, Vec<usize>)>),
}

/// The values of a case, inside.
struct CaseNumbers<'c> {
    all: &'c [f64],
    settings: &'c [f64],
    is_followed: bool,
}

impl Compiled {
    /// For a job; `None` where cases differ by more than numbers in its equations: the inputs decide ranges or samples or are counts, or
    /// something is collected that needs more.
    pub(super) fn new<'g>(
        (which, job): (&JobSelection, &Job<'g>),
        inputs: &[StudyInput],
        (collect, nominal): (&[Collected], &[Option<NominalPoints>]),
        session: Session<'_>,
    ) -> Result<Option<Compiled>, Failure> {
        let settings: Vec<usize> = (0..inputs.len()).filter(|k| !inputs[*k].is_axis).collect();
        let parameter = |k: &usize| job.parameters.iter().find(|of| of.name == inputs[*k].name);
        let Some(open) = settings.iter().map(parameter).collect::<Option<Vec<&Parameter<'g>>>>() else {
            return Ok(None);
        };
        if open.iter().any(|of| of.is_count || job.decisive.contains(&of.variable)) {
            return Ok(None);
        }
        let variables: Vec<Expr<'g>> = open.iter().map(|of| of.variable).collect();
        let bindings = job.bindings_beside(&variables);
        let all: Vec<Expr<'g>> = job.parameters.iter().map(|of| of.variable).collect();
        let following = match all.first() {
            Some(first) => Tape::new(&first.graph().substitute(&all, &bindings), &variables),
            None => Tape::new(&[], &[]),
        };
        let opened = Opened::new((which, job), (inputs, &open), &bindings, session);
        let mut collected = Vec::new();
        for (of, nominal) in collect.iter().zip(nominal) {
            let compiled = match (of, nominal) {
                (Collected::Points, _) => opened.points(),
                (Collected::EaseOff(name), Some(nominal)) => Some(opened.ease_off(name, nominal)?),
                (Collected::At(name, at), _) => opened.at(name, *at)?,
                (Collected::Curvature(name), _) => opened.curvature(name)?,
                (Collected::Width([a, b]), _) => opened.width([a, b])?,
                (Collected::Contact(name), _) => opened.contact(name)?,
                _ => None,
            };
            let Some(compiled) = compiled else { return Ok(None) };
            collected.push(compiled);
        }
        Ok(Some(Compiled {
            sizes: inputs.iter().map(|input| size_of_unit(&input.unit).map_or(1.0, |(size, _)| size)).collect(),
            settings,
            following: following.expect("a job without errors leaves nothing unbound"),
            allowed: job.parameters.iter().map(|of| of.range).collect(),
            collected,
        }))
    }

    /// A case with these values of the inputs, in their units. `None` where it has to be computed from its text: where the contact is
    /// looked for anew, and where something is lost or of another kind than in the job itself.
    pub(super) fn found(
        &self,
        (number, values): (u64, &[f64]),
        nominal: &[Option<NominalPoints>],
        nothing: impl Fn(&'static str, &str) -> Found,
    ) -> Option<Found> {
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
            return Some(nothing("spec wrong", flank_chain_dsl::Code::OutOfRange.as_str()));
        }
        let is_followed = !number.is_multiple_of(SEARCHED);
        let mut case = CaseNumbers { all: &all, settings: &settings, is_followed };
        let (mut numbers, mut why) = (Vec::new(), None);
        for (of, nominal) in self.collected.iter().zip(nominal) {
            let (found, lost) = of.numbers(&mut case, nominal.as_ref())?;
            numbers.extend(found);
            why = why.or(lost);
        }
        Some(Found::of_numbers(numbers, why, case.is_followed))
    }
}

impl CompiledNumbers {
    fn numbers(&self, case: &mut CaseNumbers<'_>, nominal: Option<&NominalPoints>) -> Option<Numbers> {
        Some(match self {
            CompiledNumbers::Points(surfaces) => {
                let points = surfaces.iter().map(|surface| surface.at(case.settings, &mut case.is_followed));
                point_counts(points.collect::<Vec<_>>().iter().flatten())
            }
            CompiledNumbers::EaseOff(of) => {
                let (near, compared) = &**of;
                let near = near.at(case.settings, &mut case.is_followed);
                ease_off_numbers(&compared.with_settings(case.settings), nominal?, &near)
            }
            CompiledNumbers::At(of, at) => place_numbers(of.at(case.settings, &mut case.is_followed).get(*at)),
            CompiledNumbers::Curvature(of) => {
                let (sampled, geometry) = &**of;
                let (points, geometry) =
                    (sampled.at(case.settings, &mut case.is_followed), geometry.with_settings(case.settings));
                let principal = |point: &SurfacePoint| {
                    let is_solved = point.outcome == Outcome::Solved;
                    let curvature = is_solved.then(|| geometry.at(&point.unknowns).curvature).flatten()?.principal();
                    Some([curvature.k1, curvature.k2])
                };
                curvature_numbers(&points, points.iter().filter_map(principal))
            }
            CompiledNumbers::Width(of) => {
                let ([near, from], compared) = &**of;
                let [near, points] = [near, from].map(|of| of.at(case.settings, &mut case.is_followed));
                let middle = starts::middle(from.counts());
                let both = points.get(middle).zip(near.get(middle));
                let (point, near) =
                    both.filter(|(a, b)| [a, b].iter().all(|point| point.outcome == Outcome::Solved))?;
                let turn = compared.with_settings(case.settings).turn_to(point.position, near)?;
                width_numbers(turn, point)
            }
            CompiledNumbers::Contact(of) => {
                let (family, given) = &**of;
                let values: Vec<f64> = given.iter().map(|k| case.all[*k]).collect();
                // looked for among all places: from the text
                let numbers = if case.is_followed { family.at(&values) } else { None };
                contact_numbers(&numbers?)
            }
        })
    }
}

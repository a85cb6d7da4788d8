//! Cases that differ by settings alone, compiled once: settings stay open in all tapes, and each case gives them numbers.

use flank_chain_dsl::{GeneratedSurface, Job, Solid};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{BoundSurface, Deviation, Outcome, Range, SecondaryCutting, SurfaceFamily, SurfacePoint};

use super::collect::{Collected, Found, NominalPoints, ease_off_numbers, point_counts};
use super::inputs::{StudyInput, size_of_unit};
use crate::compare::map::{find, is_solved};
use crate::project::failure::Failure;
use crate::project::requests::Session;
use crate::solve::starts::{self, Starts};
use crate::solve::{self, blank, followed, ranges, secondary};

/// The branch is looked for anew in each case whose number is a multiple of this, and in each whose points are not all as in the
/// nominal one.
const SEARCHED: u64 = 100;
/// A range may be missed by so much of its ends: a conversion of units rounds.
const ROUNDING: f64 = 1e-12;

/// All that is collected, for any values of the inputs.
pub(super) struct Compiled {
    /// Of the units of the inputs.
    sizes: Vec<f64>,
    /// All parameters as they follow from the inputs, with the ranges that they must lie in.
    following: Tape,
    allowed: Vec<Option<(f64, f64)>>,
    collected: Vec<CompiledNumbers>,
}

enum CompiledNumbers {
    Points(Vec<Sampled>),
    EaseOff(Box<(Sampled, Deviation)>),
}

/// A surface at the points of a grid.
struct Sampled {
    family: SurfaceFamily,
    targets: Vec<[f64; 2]>,
    counts: [usize; 2],
    /// Unknowns of the job itself in the middle of the grid, and what becomes of all its points.
    start: Option<Vec<f64>>,
    nominal: Vec<Outcome>,
    tool: Option<SecondaryCutting>,
    blank: Option<Solid>,
}

impl Compiled {
    /// For a job; `None` where cases differ by more than numbers in its equations: the inputs decide ranges or samples, are counts or axes
    /// of contacts, or something is collected that needs more.
    pub(super) fn new<'g>(
        job: &Job<'g>,
        inputs: &[StudyInput],
        (collect, nominal): (&[Collected], &[Option<NominalPoints>]),
        session: Session<'_>,
    ) -> Result<Option<Compiled>, Failure> {
        let parameter = |input: &StudyInput| job.parameters.iter().find(|of| of.name == input.name && !input.is_axis);
        let Some(open) = inputs.iter().map(parameter).collect::<Option<Vec<_>>>() else { return Ok(None) };
        if open.iter().any(|of| of.is_count || job.decisive.contains(&of.variable)) {
            return Ok(None);
        }
        let settings: Vec<(Expr<'g>, f64)> = open.iter().map(|of| (of.variable, of.value)).collect();
        let variables: Vec<Expr<'g>> = settings.iter().map(|(variable, _)| *variable).collect();
        let bindings = job.bindings_beside(&variables);
        let graph = variables[0].graph();
        let all: Vec<Expr<'g>> = job.parameters.iter().map(|of| of.variable).collect();
        let following = Tape::new(&graph.substitute(&all, &bindings), &variables);
        let opened = Opened { job, settings: &settings, bindings: &bindings, session };
        let mut collected = Vec::new();
        for (of, nominal) in collect.iter().zip(nominal) {
            let compiled = match (of, nominal) {
                (Collected::Points, _) => opened.points(),
                (Collected::EaseOff(name), Some(nominal)) => Some(opened.ease_off(name, nominal)?),
                _ => None,
            };
            let Some(compiled) = compiled else { return Ok(None) };
            collected.push(compiled);
        }
        Ok(Some(Compiled {
            sizes: inputs.iter().map(|input| size_of_unit(&input.unit).map_or(1.0, |(size, _)| size)).collect(),
            following: following.expect("a job without errors leaves nothing unbound"),
            allowed: job.parameters.iter().map(|of| of.range).collect(),
            collected,
        }))
    }

    /// A case with these values of the inputs, in their units.
    pub(super) fn found(
        &self,
        (number, values): (u64, &[f64]),
        nominal: &[Option<NominalPoints>],
        nothing: impl Fn(&'static str, &str) -> Found,
    ) -> Found {
        let values: Vec<f64> = values.iter().zip(&self.sizes).map(|(value, size)| value * size).collect();
        let mut all = vec![0.0; self.following.output_count()];
        ScalarEvaluator::new(&self.following).run(&values, &mut all);
        let is_beyond = |(value, range): (&f64, &Option<(f64, f64)>)| {
            range.is_some_and(|(low, high)| {
                let slack = ROUNDING * low.abs().max(high.abs());
                !(*value >= low - slack && *value <= high + slack)
            })
        };
        if all.iter().zip(&self.allowed).any(is_beyond) {
            return nothing("spec wrong", flank_chain_dsl::Code::OutOfRange.as_str());
        }
        let mut is_followed = !number.is_multiple_of(SEARCHED);
        let (mut numbers, mut why) = (Vec::new(), None);
        for (of, nominal) in self.collected.iter().zip(nominal) {
            let (found, lost) = match (of, nominal) {
                (CompiledNumbers::EaseOff(of), Some(nominal)) => {
                    let (near, compared) = &**of;
                    let near = near.at(&values, &mut is_followed);
                    ease_off_numbers(&compared.with_settings(&values), nominal, &near)
                }
                (CompiledNumbers::EaseOff(_), None) => (Vec::new(), None),
                (CompiledNumbers::Points(surfaces), _) => {
                    let points = surfaces.iter().map(|surface| surface.at(&values, &mut is_followed));
                    point_counts(points.collect::<Vec<_>>().iter().flatten())
                }
            };
            numbers.extend(found);
            why = why.or(lost);
        }
        Found::of_numbers(numbers, why, is_followed)
    }
}

/// What is compiled while settings are open.
struct Opened<'o, 'g> {
    job: &'o Job<'g>,
    settings: &'o [(Expr<'g>, f64)],
    bindings: &'o [(Expr<'g>, Expr<'g>)],
    session: Session<'o>,
}

impl<'g> Opened<'_, 'g> {
    fn family(&self, surface: &GeneratedSurface<'g>, coordinates: [Expr<'g>; 2]) -> SurfaceFamily {
        let bound = BoundSurface::new(&surface.surface, ranges(surface), self.bindings);
        let kept = surface.sample.iter().flat_map(|sample| &sample.keep);
        let keep: Vec<_> = kept.map(|(of, (low, high))| (of.value, Range { low: *low, high: *high })).collect();
        let made = SurfaceFamily::new(&bound, coordinates, self.settings, |problem| {
            problem
                .following_beyond(followed(surface))
                .with_instruction_set(self.session.instructions())
                .boxes(self.session.boxes())
                .keeping(&bound, &keep)
        });
        made.expect("a job without errors leaves nothing unbound")
    }

    /// `None` where other surfaces cut points away.
    fn points(&self) -> Option<CompiledNumbers> {
        let sampled = self.job.surfaces.iter().filter(|surface| surface.sample.is_some());
        let all = sampled.map(|surface| {
            let sample =
                surface.sample.as_ref().filter(|_| surface.trimmed_by.is_empty() && surface.cut_by.is_none())?;
            let (targets, counts) = (sample.targets(), sample.counts);
            let family = self.family(surface, sample.coordinates.each_ref().map(|coordinate| coordinate.value));
            let graph = self.settings[0].0.graph();
            let tool =
                graph.with_settings(self.settings, || secondary::tool_positions(self.job, surface, self.bindings));
            let tool = tool.ok().inspect(SecondaryCutting::translate);
            let blank = blank::of(self.job, surface).cloned();
            let mut own = Sampled { family, targets, counts, start: None, nominal: Vec::new(), tool, blank };
            own.begin(&self.nominal());
            Some(own)
        });
        all.collect::<Option<Vec<Sampled>>>().map(CompiledNumbers::Points)
    }

    fn ease_off(&self, name: &str, nominal: &NominalPoints) -> Result<CompiledNumbers, Failure> {
        let surface = find(std::slice::from_ref(self.job), name)?.surface;
        let starts = Starts::beside(surface, (&nominal.asked, &nominal.points));
        let family = self.family(surface, starts.coordinates.each_ref().map(|coordinate| coordinate.value));
        let bound = BoundSurface::new(&surface.surface, solve::ranges(surface), self.bindings);
        let graph = self.settings[0].0.graph();
        let compared = graph.with_settings(self.settings, || Deviation::new(&bound));
        let compared = compared.expect("a job without errors leaves nothing unbound");
        compared.translate();
        let counts = nominal.asked.counts;
        let mut near = Sampled {
            family,
            targets: starts.targets,
            counts,
            start: None,
            nominal: Vec::new(),
            tool: None,
            blank: None,
        };
        near.begin(&self.nominal());
        Ok(CompiledNumbers::EaseOff(Box::new((near, compared))))
    }

    fn nominal(&self) -> Vec<f64> {
        self.settings.iter().map(|(_, value)| *value).collect()
    }
}

impl Sampled {
    /// The job itself.
    fn begin(&mut self, values: &[f64]) {
        let points = self.searched(values);
        let middle = points.get(starts::middle(self.counts)).filter(|point| is_solved(point));
        self.start = middle.map(|point| point.unknowns.clone());
        self.nominal = points.iter().map(|point| kind(point.outcome)).collect();
    }

    /// With values of the settings: on the branch of the job itself while `is_followed`, as long as its points are like those of the job;
    /// on the one that is found among all otherwise.
    fn at(&self, values: &[f64], is_followed: &mut bool) -> Vec<SurfacePoint> {
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

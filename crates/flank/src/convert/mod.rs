//! `flank convert`: a job carried over to another machine.

mod blocks;
mod failures;
mod files;
pub(crate) mod milling;
mod rates;
pub(crate) mod result;
mod series;
mod settings;
mod source;
mod table;
mod text;

use std::path::Path;

use flank_chain_dsl::{Axis, Job, Machine, RangedVariable, Request, compile_request};
use flank_expr::geometry::{Chain, Step};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{
    Explicit, ExplicitProblem, Outcome, PoseError, PoseProblem, Posture, Range, Screw, TargetAxis, unseen_motion,
};

use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::{ConvertRequest, JobSelection, Onto};
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::project::units;
use rates::Rates;
use result::{AxisMotion, CarriedJob, ConvertResult, FoundSettings};
use series::Series;
use source::{Chosen, Source};
use table::Table;

/// Points of each flank that are followed from one machine to the other.
const POINTS_FOLLOWED: usize = 16;
/// No linear axis without travel goes farther, mm.
const REACH: f64 = 10_000.0;

/// Carries a job over to another machine: the positions of its axes, or the settings with which it does the same.
///
/// # Errors
/// What is wrong with the specs; what does not go together; that the machine has not what it takes; that a file cannot be written.
pub fn convert(request: &ConvertRequest, monitor: &dyn Monitor) -> Result<ConvertResult, Failure> {
    check_positions(request)?;
    check_fit_alone(request)?;
    let graph = Graph::new();
    let (origin, job, target) = compiled(&graph, &request.jobs, &request.to, monitor)?;
    let plan = Plan::of_job(&graph, &job, &target, &request.onto, &request.fit)?;
    check_settings_alone(&plan, request)?;
    let session = Session::new(request.onto.evaluator, monitor);
    let target = plan.solved(session)?;
    Ok(if target.settings.is_empty() {
        ConvertResult::Motion(Box::new(carry(&job, target, &origin, (request, session))?))
    } else {
        let found = settings::find(&job, &target, (request, session))?;
        let not_done = origin.located(&[&job], found.not_done);
        ConvertResult::Settings(Box::new(FoundSettings { not_done, ..found }))
    })
}

/// # Errors
/// If a program is asked for that would go nowhere, before any file is written.
fn check_positions(request: &ConvertRequest) -> Result<(), Failure> {
    if request.nc.is_empty() || request.positions > 1 {
        return Ok(());
    }
    let message = "an NC program moves from position to position: option `nc` needs option `positions 2` or more";
    Err(Failure::Request(message.to_string()))
}

/// # Errors
/// If something is asked for that there is only of a motion, beside settings that are to be looked for.
fn check_fit_alone(request: &ConvertRequest) -> Result<(), Failure> {
    let dropped = request.of_a_motion();
    if request.fit.is_empty() || dropped.is_empty() {
        return Ok(());
    }
    Err(Failure::Request(format!(
        "option `fit` looks for settings, and of them there are no files: leave out {}, and ask for it when the settings have their values",
        dropped.join(", ")
    )))
}

/// # Errors
/// If something is asked for that there is only of a motion, while settings are looked for that have no values.
fn check_settings_alone(plan: &Plan<'_, '_>, request: &ConvertRequest) -> Result<(), Failure> {
    let [first, ..] = plan.settings[..] else { return Ok(()) };
    let dropped = request.of_a_motion();
    if dropped.is_empty() {
        return Ok(());
    }
    Err(Failure::from(format!(
        "settings of {} are looked for, because {} has no value, and of them there are no files: leave out {}, and ask for it when \
         the settings have their values: option `set {}=…`",
        plan.machine.name,
        first.name,
        dropped.join(", "),
        first.name
    )))
}

/// What was read, the one job and the machine as a job without tool.
///
/// # Errors
/// What is wrong with the texts, or that it is not clear which job is meant.
pub(crate) fn compiled<'g>(
    graph: &'g Graph,
    which: &JobSelection,
    to: &Path,
    monitor: &dyn Monitor,
) -> Result<(Origin, Job<'g>, Job<'g>), Failure> {
    which.check()?;
    let request = Request { machine: Some(to), ..which.request() };
    let mut compilation = spec::sound(compile_request(graph, which.file(), &request), monitor)?;
    let mut jobs = spec::asked_for(&mut compilation, (which, which.job.as_slice()), monitor)?;
    let target = compilation.machine.take().expect("a compilation without errors has the machine");
    let origin = Origin::of_compilation(&compilation);
    match jobs.len() {
        1 => Ok((origin, jobs.remove(0), target)),
        _ => {
            let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
            let names = names.join(" or ");
            Err(format!("the file holds several jobs, and one is carried over at a time: option `job` {names}").into())
        }
    }
}

/// The axes over the motion, their series, what is written, and what the target cannot do.
fn carry<'g>(
    job: &Job<'g>,
    target: Target<'_, 'g>,
    origin: &Origin,
    (request, session): (&ConvertRequest, Session<'_>),
) -> Result<AxisMotion, Failure> {
    let jobs = [job, target.job];
    let carried = Conversion::on(target, request.positions, session)?;
    let mut told = carried.failures();
    let is_followed = carried.source.motions.len() == 1 && told.is_empty();
    let working = session.begin(format!("polynomials and their proof on {}", carried.machine.name))?;
    let series = is_followed.then(|| Series::of_conversion(&carried, request)).flatten();
    drop(working);
    match &series {
        Some(series) => told.extend(series.unmet(request.tolerance, (&carried.machine.name, &carried.source))),
        None if told.is_empty() => told.extend(without_series(&carried, request)),
        None => {}
    }
    let is_series = is_followed && told.is_empty();
    let rates = request
        .time
        .filter(|_| is_series)
        .map(|seconds| Rates::of_conversion(&carried, seconds))
        .transpose()?
        .flatten();
    let mut table = Table::new(job, &carried, (series, rates), request);
    let tube = table.series.as_ref().and_then(|series| series.tube.as_ref().ok());
    table.nc_deviation = (is_series && !request.nc.is_empty()).then(|| blocks::nc_deviation(&carried, tube));
    let not_done = carried.source.unsolved.iter().cloned().chain(told).collect();
    let mut found = table.result(origin.located(&[job], not_done));
    // a table of one motion; what the target cannot do is no program
    if is_series {
        let header = crate::solve::header(&jobs, &request.jobs, origin);
        found.files = files::write((&table, &found), &carried, header, (request, origin, session))?;
    }
    Ok(found)
}

/// What is carried over, and whereto.
fn carried_job(
    job: &Job<'_>,
    (machine, source): (&Machine<'_>, &Source<'_, '_>),
    request: &ConvertRequest,
) -> CarriedJob {
    CarriedJob {
        job: job.name.clone(),
        spec: shown_path(request.jobs.file()),
        machine: machine.name.clone(),
        machine_spec: shown_path(&request.to),
        tool: source.tool.clone(),
        work: source.work.clone(),
    }
}

/// Which of the things that are asked for there are not without power series of the axes; nothing if none is.
fn without_series(carried: &Conversion<'_, '_>, request: &ConvertRequest) -> Option<NotDone> {
    let motions: Vec<&str> = carried.source.motions.iter().map(|motion| motion.name.as_str()).collect();
    let (asked, why) = match motions[..] {
        [one] => (
            request.tolerance.iter().map(|_| "option `tolerance`").collect(),
            format!("the axes have no power series in the middle of {one}, where they are singular"),
        ),
        _ => (
            request.of_a_motion(),
            format!(
                "the job runs over {}, each by itself, and files, polynomials, programs and rates go along one motion; without these \
                 options the axes are printed, and the document has all positions",
                motions.join(" and ")
            ),
        ),
    };
    (!asked.is_empty()).then(|| {
        let message = format!("not reached: nothing is done for {}: {why}", asked.join(", "));
        NotDone::new(NotDoneKind::NotReached, &carried.machine.name, message)
    })
}

/// The machine that a job is carried over to.
struct Target<'t, 'g> {
    job: &'t Job<'g>,
    machine: &'t Machine<'g>,
    source: Source<'t, 'g>,
    /// From work to tool, in free axes and parameters.
    chain: Chain<'g>,
    /// The axes that move the tool against the work.
    free: Vec<&'t Axis<'g>>,
    axes: Vec<TargetAxis<'g>>,
    /// Settings that are looked for: those without a value, and those asked for.
    settings: Vec<&'t RangedVariable<'g>>,
    /// Numbers for the parameters of both machines.
    bindings: Vec<(Expr<'g>, Expr<'g>)>,
}

/// What is to be carried over to which machine: all names are known, nothing is solved yet.
struct Plan<'t, 'g> {
    job: &'t Job<'g>,
    machine: &'t Machine<'g>,
    chosen: Chosen<'t, 'g>,
    chain: Chain<'g>,
    free: Vec<&'t Axis<'g>>,
    settings: Vec<&'t RangedVariable<'g>>,
    bindings: Vec<(Expr<'g>, Expr<'g>)>,
}

impl<'t, 'g> Plan<'t, 'g> {
    /// # Errors
    /// In words, if a name is not known, it is not clear what is meant, or the machine has not the axes for it.
    fn of_job(
        graph: &'g Graph,
        job: &'t Job<'g>,
        target: &'t Job<'g>,
        onto: &Onto,
        fit: &[String],
    ) -> Result<Plan<'t, 'g>, String> {
        let chosen = Chosen::of_job(job, onto.surface.as_deref())?;
        let machine = &target.machines[0];
        let [work, tool] = [
            frame(machine, &chosen.work, onto.work_frame.as_deref(), "option `work_frame`")?,
            frame(machine, &chosen.tool, onto.tool_frame.as_deref(), "option `tool_frame`")?,
        ];
        let chain = machine.chain(graph, &work, &tool).expect("both frames are the machine's");
        let followers = machine.axes.iter().filter(|axis| axis.law != axis.variable);
        let laws: Vec<(Expr<'g>, Expr<'g>)> = followers.map(|axis| (axis.variable, axis.law)).collect();
        let chain = chain.substituted(&laws);
        if is_mirrored(&chain) != is_mirrored(chosen.driven()) {
            return Err(format!(
                "{} is of the other hand: from {work} to {tool} it makes a mirror image of what leads from {} to {} in {}, and no motion is its \
                 own mirror image; `mirror` one of these frames in a variant of the machine, or carry the job over to a machine of its own hand",
                machine.name, chosen.work, chosen.tool, job.name
            ));
        }
        let settings = settings::wanted(target, &chain, fit)?;
        let open: Vec<Expr<'g>> = settings.iter().map(|setting| setting.variable).collect();
        let bindings = job.bindings().into_iter().chain(target.bindings_beside(&open)).collect::<Vec<_>>();
        let settled = chain.substituted(&bindings);
        let moves = |axis: &&Axis<'g>| axis.law == axis.variable && !settled.twist(axis.variable).is_zero();
        let free: Vec<&Axis<'g>> = machine.axes.iter().filter(moves).collect();
        failures::check_count(machine, &chosen.motions, &free)?;
        Ok(Plan { job: target, machine, chosen, chain, free, settings, bindings })
    }

    /// With the points that the tool makes.
    ///
    /// # Errors
    /// In words, if there are too many of them.
    fn solved(self, session: Session<'_>) -> Result<Target<'t, 'g>, Failure> {
        let Plan { job, machine, chosen, chain, free, settings, bindings } = self;
        let source = Source::of_chosen(chosen, session)?;
        let axes = free.iter().map(|axis| target_axis(axis)).collect();
        Ok(Target { job, machine, source, chain, free, axes, settings, bindings })
    }
}

/// Postures at all positions, and an axis that stands still for them.
struct Resting<'t, 'g> {
    problem: PoseProblem<'g>,
    line: Vec<Posture>,
    axis: Option<(&'t Axis<'g>, f64)>,
}

impl<'t, 'g> Target<'t, 'g> {
    fn motions(&self) -> Vec<Expr<'g>> {
        self.source.motions.iter().map(|motion| motion.variable).collect()
    }

    fn problem(
        &self,
        (chain, axes): (&Chain<'g>, &[TargetAxis<'g>]),
        unseen: &[Screw],
    ) -> Result<PoseProblem<'g>, String> {
        let [chain, source] = [chain, self.source.driven].map(|chain| chain.substituted(&self.bindings));
        PoseProblem::new(&chain, axes, &source, &self.motions(), unseen, REACH)
            .map_err(|error| refused(&error, self.machine, &self.free))
    }

    /// Postures at all positions. Where an axis that leaves the tool unchanged would go beyond its travel, the tool is turned about itself
    /// so that it need not.
    fn postures(&mut self, positions: &[Vec<f64>]) -> Result<(PoseProblem<'g>, Vec<Posture>), String> {
        let found = self.postures_of(&self.chain, &self.axes, positions)?;
        if !found.1.iter().all(is_met) || found.1.iter().all(is_good) {
            return Ok(found);
        }
        let unseen = self.unseen_motions(|axis| axis.travel.is_some());
        if unseen.iter().all(Option::is_none) {
            return Ok(found);
        }
        let endless = self.axes.iter().zip(&unseen);
        let endless: Vec<TargetAxis<'g>> = endless
            .map(|(axis, unseen)| TargetAxis { travel: axis.travel.filter(|_| unseen.is_none()), ..*axis })
            .collect();
        let (_, line) = self.postures_of(&self.chain, &endless, positions)?;
        let turned = self.turned(&unseen, &line);
        let other = self.postures_of(&turned, &self.axes, positions)?;
        if other.1.iter().all(is_met) {
            self.chain = turned;
            return Ok(other);
        }
        Ok(found)
    }

    /// Postures at all positions, with the axes that stand still for them: where none are found because an axis that only moves the tool
    /// along itself can do what another one does, as a spindle that is parallel to the axis of the work, it stands still.
    fn resting_postures(&mut self, positions: &[Vec<f64>]) -> Result<Resting<'t, 'g>, String> {
        let (problem, line) = self.postures(positions)?;
        if line.iter().all(is_met) || self.axes.len() < 2 {
            return Ok(Resting { problem, line, axis: None });
        }
        let unseen = self.unseen_motions(|_| true);
        for k in (0..unseen.len()).filter(|k| unseen[*k].is_some()) {
            let chain = self.chain.clone();
            let (axis, own) = (self.axes.remove(k), self.free.remove(k));
            let rests = axis.travel.map_or(0.0, |travel| 0f64.clamp(travel.low, travel.high));
            self.chain = chain.substituted(&[(axis.variable, axis.variable.graph().constant(rests))]);
            let (problem, line) = self.postures(positions)?;
            if line.iter().all(is_met) {
                return Ok(Resting { problem, line, axis: Some((own, rests)) });
            }
            self.chain = chain;
            self.axes.insert(k, axis);
            self.free.insert(k, own);
        }
        Ok(Resting { problem, line, axis: None })
    }

    /// Of each axis that counts what it does to the tool, if that leaves the tool unchanged, and how much of it per mm or radian.
    fn unseen_motions(&self, counts: impl Fn(&TargetAxis<'g>) -> bool) -> Vec<Option<(Screw, f64)>> {
        let settled = self.chain.substituted(&self.bindings);
        let axes: Vec<Expr<'g>> = self.axes.iter().map(|axis| axis.variable).collect();
        let of = |axis: &TargetAxis<'g>| {
            let is_asked = counts(axis).then_some(axis.variable);
            is_asked.and_then(|axis| unseen_motion(&settled, axis, &axes, &self.source.symmetries).ok()?)
        };
        self.axes.iter().map(of).collect()
    }

    /// The chain with the tool moved along itself by as much as brings axes that leave it unchanged to the middle of their travels.
    fn turned(&self, unseen: &[Option<(Screw, f64)>], line: &[Posture]) -> Chain<'g> {
        let graph = self.free[0].variable.graph();
        let steps = self.axes.iter().zip(unseen).enumerate().flat_map(|(k, (axis, unseen))| {
            let (Some((screw, pace)), Some(travel)) = (unseen, axis.travel) else { return Vec::new() };
            let values = line.iter().map(|posture| posture.axes[k]);
            let (low, high) = (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
            let by = 0.5 * (low + high - travel.low - travel.high);
            screw.steps(graph, graph.constant(by * pace))
        });
        self.chain.then(&Chain::new(graph, steps.collect::<Vec<Step<'g>>>()))
    }

    fn postures_of(
        &self,
        chain: &Chain<'g>,
        axes: &[TargetAxis<'g>],
        positions: &[Vec<f64>],
    ) -> Result<(PoseProblem<'g>, Vec<Posture>), String> {
        let unseen = &self.source.symmetries;
        let problem = self.problem((chain, axes), unseen)?;
        let ranges = &self.source.ranges;
        let line = follow(&problem, positions, ranges);
        if line.iter().all(is_met) {
            return Ok((problem, line));
        }
        // an axis that only happens to move the tool along itself there does not know how far: as far as on the source
        let exact = if unseen.is_empty() { None } else { Some(self.problem((chain, axes), &[])?) };
        let mixed = [Some(&problem), exact.as_ref()].map(|problem| problem.and_then(PoseProblem::mixed));
        for other in [exact].into_iter().chain(mixed).flatten() {
            let line = follow(&other, positions, ranges);
            if line.iter().all(is_met) {
                return Ok((other, line));
            }
        }
        Ok((problem, line))
    }
}

/// Whether the tool stands as it should and the axes can.
fn is_good(posture: &Posture) -> bool {
    posture.outcome == Outcome::Solved && is_met(posture)
}

/// Whether the tool stands as it should, within the travels or beyond.
fn is_met(posture: &Posture) -> bool {
    matches!(posture.outcome, Outcome::Solved | Outcome::Outside { .. }) && posture.missing.is_none()
}

/// A job on another machine.
pub(crate) struct Conversion<'j, 'g> {
    pub(crate) source: Source<'j, 'g>,
    pub(crate) machine: &'j Machine<'g>,
    /// The axes that move the tool against the work.
    pub(crate) free: Vec<&'j Axis<'g>>,
    /// One that only moves the tool along itself and is not needed, and where it stands, mm or radians.
    pub(crate) resting: Option<(&'j Axis<'g>, f64)>,
    /// From work to tool on the machine, with its parameters as symbols.
    chain: Chain<'g>,
    bindings: Vec<(Expr<'g>, Expr<'g>)>,
    pub(crate) problem: PoseProblem<'g>,
    pub(crate) positions: Vec<Vec<f64>>,
    pub(crate) line: Vec<Posture>,
}

impl<'j, 'g> Conversion<'j, 'g> {
    /// # Errors
    /// In words, if it is not clear what is meant, or the machine has not the axes or the settings for it.
    pub(crate) fn new(
        graph: &'g Graph,
        job: &'j Job<'g>,
        target: &'j Job<'g>,
        (onto, session): (&Onto, Session<'j>),
        positions: u32,
    ) -> Result<Conversion<'j, 'g>, Failure> {
        Conversion::at_positions(graph, (job, target), (onto, session), |source| source.positions(positions as usize))
    }

    /// The same at positions of the motions that `choose` makes of those that are spread over them.
    ///
    /// # Errors
    /// As [`Conversion::new`].
    pub(crate) fn at_positions(
        graph: &'g Graph,
        (job, target): (&'j Job<'g>, &'j Job<'g>),
        (onto, session): (&Onto, Session<'j>),
        choose: impl FnOnce(&Source<'j, 'g>) -> Vec<Vec<f64>>,
    ) -> Result<Conversion<'j, 'g>, Failure> {
        let plan = Plan::of_job(graph, job, target, onto, &[])?;
        match plan.settings.first() {
            Some(open) => Err(format!("{} has no value: option `set {}=…`", open.name, open.name).into()),
            None => {
                let target = plan.solved(session)?;
                let positions = choose(&target.source);
                Conversion::over(target, positions, session)
            }
        }
    }

    fn on(target: Target<'j, 'g>, positions: u32, session: Session<'_>) -> Result<Conversion<'j, 'g>, Failure> {
        let positions = target.source.positions(positions as usize);
        Conversion::over(target, positions, session)
    }

    fn over(
        mut target: Target<'j, 'g>,
        positions: Vec<Vec<f64>>,
        session: Session<'_>,
    ) -> Result<Conversion<'j, 'g>, Failure> {
        let _working = session.begin(format!("following the tool on {}", target.machine.name))?;
        let Resting { problem, line, axis: resting } = target.resting_postures(&positions)?;
        let Target { source, machine, free, chain, bindings, .. } = target;
        Ok(Conversion { source, machine, free, resting, chain, bindings, problem, positions, line })
    }

    /// The axes in closed form; with the parameters as symbols, or as numbers.
    ///
    /// # Errors
    /// In words, if there is no closed form.
    pub(crate) fn explicit(&self, symbolic: bool) -> Result<Explicit<'g>, String> {
        let motions: Vec<Expr<'g>> = self.source.motions.iter().map(|motion| motion.variable).collect();
        let source = self.source.driven;
        let [target, source] = if symbolic {
            [self.problem.slipped(&self.chain), source.clone()]
        } else {
            [self.problem.chain().clone(), source.substituted(&self.bindings)]
        };
        let problem = ExplicitProblem {
            target: &target,
            unknowns: self.problem.unknowns(),
            source: &source,
            motions: &motions,
            bindings: &self.bindings,
            line: (&self.positions, &self.line),
        };
        problem
            .solve()
            .map_err(|reason| format!("no explicit form; {} is solved numerically: {reason}", self.machine.name))
    }

    /// Whether the tool touches anywhere, as far as solved points tell.
    pub(crate) fn touches(&self) -> bool {
        self.source.flanks.iter().any(|flank| flank.solved().next().is_some())
    }

    /// How far the points of the tool that touch the flanks are off at most, over all positions, mm: the tool stands against the work as on
    /// the job's machine, but for motions that leave it unchanged.
    pub(crate) fn off(&self) -> f64 {
        let (target, source) = (self.problem.chain(), self.source.driven.substituted(&self.bindings));
        let motions: Vec<Expr<'g>> = self.source.motions.iter().map(|motion| motion.variable).collect();
        let mut most: f64 = 0.0;
        for flank in &self.source.flanks {
            let apart = target.point(flank.tool.position) - source.point(flank.tool.position);
            let inputs = [self.problem.unknowns(), &motions[..], &flank.tool.unknowns[..]].concat();
            let tape = Tape::new(&apart.0, &inputs).expect("a job without errors leaves nothing unbound");
            let (mut evaluator, mut out) = (ScalarEvaluator::new(&tape), [0.0; 3]);
            let every = flank.points.len().div_ceil(POINTS_FOLLOWED).max(1);
            for point in flank.solved().step_by(every) {
                for (position, posture) in self.positions.iter().zip(&self.line) {
                    let own = &point.unknowns[..flank.tool.unknowns.len()];
                    evaluator.run(&[posture.unknowns(), position, own].concat(), &mut out);
                    most = most.max(out.iter().map(|x| x * x).sum::<f64>().sqrt());
                }
            }
        }
        most
    }

    /// What the target cannot do, each kind once with its first place.
    pub(crate) fn failures(&self) -> Vec<NotDone> {
        failures::told(self)
    }
}

/// Whether what a chain leads to is a mirror image, wherever its axes stand: the determinant of its rotation is -1.
pub(crate) fn is_mirrored(chain: &Chain<'_>) -> bool {
    chain.steps().iter().filter(|step| matches!(step, Step::Mirror(_))).count() % 2 == 1
}

fn target_axis<'g>(axis: &Axis<'g>) -> TargetAxis<'g> {
    TargetAxis {
        variable: axis.variable,
        is_rotary: units::is_angle(axis.dimension),
        travel: axis.travel.map(|(low, high)| Range { low, high }),
    }
}

fn refused(error: &PoseError, machine: &Machine<'_>, free: &[&Axis<'_>]) -> String {
    match error {
        PoseError::Redundant(more) => format!(
            "{} has {more} free axes more than the pose of a tool needs, so it does not tell where they stand: `fix` or \
             `couple` {more} of {} in a variant of the machine",
            machine.name,
            free.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ")
        ),
        PoseError::Unbound(error) => error.to_string(),
    }
}

/// The frame of the target that stands for one of the source: by the same name, or as asked for.
fn frame(machine: &Machine<'_>, source: &str, asked: Option<&str>, option: &str) -> Result<String, String> {
    let wanted = asked.unwrap_or_else(|| source.rsplit('.').next().unwrap_or(source));
    if machine.frames.iter().any(|frame| frame.name == wanted) {
        return Ok(wanted.to_string());
    }
    let names: Vec<&str> = machine.frames.iter().map(|frame| frame.name.as_str()).collect();
    Err(format!(
        "{} has no frame `{wanted}` that stands for {source}: say which one does, {option} {}",
        machine.name,
        names.join(" or ")
    ))
}

/// Postures at all positions: of one motion from the middle to both ends, or from a quarter, if the middle has none; else row by row.
fn follow(problem: &PoseProblem<'_>, positions: &[Vec<f64>], ranges: &[Range]) -> Vec<Posture> {
    let [range] = ranges else {
        return problem.walks(&positions[0], &[positions.to_vec()]).pop().unwrap_or_default();
    };
    let has_posture = |at: &f64| problem.postures(&[*at]).first().is_some_and(is_good);
    let [middle, others @ ..] = [0.5, 0.25, 0.75, 0.0, 1.0].map(|share| at(*range, share));
    let start = [middle].into_iter().chain(others).find(has_posture).unwrap_or(middle);
    let from_start = |walk: Vec<Vec<f64>>| [vec![start]].into_iter().chain(walk).collect();
    let (below, above): (Vec<Vec<f64>>, Vec<Vec<f64>>) = positions.iter().cloned().partition(|at| at[0] < start);
    let walks = [below.into_iter().rev().collect(), above].map(from_start);
    let mut lines = problem.walks(&[start], &walks).into_iter();
    // each walk begins at the start, which need not be a position
    let mut line = || lines.next().into_iter().flat_map(|line| line.into_iter().skip(1));
    let below: Vec<Posture> = line().collect();
    below.into_iter().rev().chain(line()).collect()
}

/// The value at a share of the way through a motion.
pub(super) fn at(range: Range, share: f64) -> f64 {
    range.low + share * (range.high - range.low)
}

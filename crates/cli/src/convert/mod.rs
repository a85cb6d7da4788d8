//! `flank convert`: a job carried over to another machine.

mod files;
mod rates;
mod series;
mod source;
mod table;

use std::path::Path;

use flank_chain_dsl::{Axis, Job, Machine, compile_with_machine};
use flank_expr::geometry::Chain;
use flank_expr::{Expr, Graph};
use flank_solver::{Explicit, ExplicitProblem, Outcome, PoseError, PoseProblem, Posture, Range, TargetAxis};

use crate::arguments::{Convert, Onto, Which};
use crate::{Ending, print, spec, units};
use rates::Rates;
use series::Series;
use source::Source;
use table::Table;

/// No linear axis without travel goes farther, mm.
const REACH: f64 = 10_000.0;

pub(crate) fn run(arguments: &Convert) -> Ending {
    let graph = Graph::new();
    let (hash, job, target) = match compiled(&graph, &arguments.which, &arguments.to) {
        Ok(compiled) => compiled,
        Err(ending) => return ending,
    };
    match carry(&graph, (&job, &target), &hash, arguments) {
        Ok((table, told)) => {
            print(&if arguments.json { table.json() } else { table.text() });
            anstream::eprint!("{told}");
            if told.is_empty() { Ending::Done } else { Ending::Unsolved }
        }
        Err(reason) => {
            anstream::eprintln!("error: {reason}");
            Ending::Wrong
        }
    }
}

/// The hash of the text, the one job and the machine as a job without tool; what is wrong has been told.
pub(crate) fn compiled<'g>(graph: &'g Graph, which: &Which, to: &Path) -> Result<(String, Job<'g>, Job<'g>), Ending> {
    let mut compilation = compile_with_machine(graph, &which.file, to, &which.set);
    spec::tell(&compilation.diagnostics, &compilation.sources);
    if compilation.has_errors() {
        return Err(Ending::Wrong);
    }
    let target = compilation.machine.take().expect("a compilation without errors has the machine");
    let mut jobs = compilation.take_jobs(which.job.as_deref()).map_err(|finding| {
        spec::tell(&[finding], &compilation.sources);
        Ending::Wrong
    })?;
    let hash = spec::hash(&compilation);
    match jobs.len() {
        1 => Ok((hash, jobs.remove(0), target)),
        _ => {
            let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
            let names = names.join(" or ");
            anstream::eprintln!("error: the file holds several jobs, and one is carried over at a time: --job {names}");
            Err(Ending::Wrong)
        }
    }
}

/// The axes over the motion, their series, what is written, and in words what the target cannot do.
fn carry<'g>(
    graph: &'g Graph,
    (job, target): (&Job<'g>, &Job<'g>),
    hash: &str,
    arguments: &Convert,
) -> Result<(Table, String), String> {
    let carried = Carried::new(graph, job, target, &arguments.onto, arguments.positions)?;
    let mut told = carried.failures();
    let is_followed = carried.source.motions.len() == 1 && told.is_empty();
    let series = is_followed.then(|| Series::of(&carried, arguments)).flatten();
    told.extend(series.as_ref().and_then(|series| series.unmet(arguments.tolerance)));
    let is_series = is_followed && told.is_empty();
    let rates = arguments.time.filter(|_| is_series).and_then(|seconds| Rates::of(&carried, seconds));
    let mut table = Table::new(job, &carried, (series, rates), arguments);
    // a table of one motion; what the target cannot do is no program
    if is_series {
        let header = crate::solve::header(&job.name, &arguments.which, hash);
        table.written = files::write(&table, &carried, header, arguments)?;
    }
    Ok((table, told))
}

/// A job on another machine.
pub(crate) struct Carried<'j, 'g> {
    pub(crate) source: Source<'j, 'g>,
    pub(crate) machine: &'j Machine<'g>,
    /// The axes that may stand anywhere.
    pub(crate) free: Vec<&'j Axis<'g>>,
    /// From work to tool on the machine, with its parameters as symbols.
    chain: Chain<'g>,
    bindings: Vec<(Expr<'g>, Expr<'g>)>,
    pub(crate) problem: PoseProblem<'g>,
    pub(crate) positions: Vec<Vec<f64>>,
    pub(crate) line: Vec<Posture>,
}

impl<'j, 'g> Carried<'j, 'g> {
    /// # Errors
    /// In words, if it is not clear what is meant, or the machine has not the axes for it.
    pub(crate) fn new(
        graph: &'g Graph,
        job: &'j Job<'g>,
        target: &'j Job<'g>,
        onto: &Onto,
        positions: u32,
    ) -> Result<Carried<'j, 'g>, String> {
        let source = Source::of(job, onto.surface.as_deref())?;
        let machine = &target.machines[0];
        let [work, tool] = [
            frame(machine, &source.work, onto.work_frame.as_deref(), "--work-frame")?,
            frame(machine, &source.tool, onto.tool_frame.as_deref(), "--tool-frame")?,
        ];
        let chain = machine.chain(graph, &work, &tool).expect("both frames are the machine's");
        let axes = machine.axes.iter();
        let laws: Vec<(Expr<'g>, Expr<'g>)> =
            axes.filter(|axis| axis.law != axis.variable).map(|axis| (axis.variable, axis.law)).collect();
        let chain = chain.substituted(&laws);
        let free: Vec<&Axis<'g>> = machine.axes.iter().filter(|axis| axis.law == axis.variable).collect();
        let axes: Vec<TargetAxis<'g>> = free.iter().map(|axis| target_axis(axis)).collect();
        let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
        let motions: Vec<Expr<'g>> = source.motions.iter().map(|motion| motion.variable).collect();
        let problem = PoseProblem::new(&chain, &axes, source.driven, &motions, &source.symmetries, REACH, &bindings)
            .map_err(|error| refused(&error, machine, &free))?;
        let positions = source.positions(positions as usize);
        let line = follow(&problem, &positions, source.motions.len());
        Ok(Carried { source, machine, free, chain, bindings, problem, positions, line })
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

    /// What the target cannot do, each kind once with its first place; empty if nothing.
    pub(crate) fn failures(&self) -> String {
        failures(&self.source, self.machine, &self.free, &self.positions, &self.line)
    }
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

/// Postures at all positions, from the middle to both ends if there is one motion, else row by row.
fn follow(problem: &PoseProblem<'_>, positions: &[Vec<f64>], motions: usize) -> Vec<Posture> {
    let start = if motions == 1 { positions.len() / 2 } else { 0 };
    let Some(first) = problem.postures(&positions[start]).into_iter().next() else { return Vec::new() };
    let down: Vec<Vec<f64>> = positions[..=start].iter().rev().cloned().collect();
    let mut line: Vec<Posture> = problem.follow(&first, &down).into_iter().rev().collect();
    line.pop();
    line.extend(problem.follow(&first, &positions[start..]));
    line
}

/// What the target cannot do, each kind once with its first place; empty if nothing.
fn failures(
    source: &Source<'_, '_>,
    machine: &Machine<'_>,
    free: &[&Axis<'_>],
    positions: &[Vec<f64>],
    line: &[Posture],
) -> String {
    let name = &machine.name;
    let mut kinds: Vec<(String, String, usize)> = Vec::new();
    for (position, posture) in positions.iter().zip(line) {
        let (kind, told) = match (posture.outcome, posture.missing) {
            (Outcome::Outside { unknown, by }, _) => {
                let axis = free[unknown];
                let [at, by] = [posture.axes[unknown], by].map(|x| units::text(axis.dimension, x, 4));
                let told = format!("axis {}.{} has to stand at {at}, {by} beyond its travel", name, axis.name);
                (format!("beyond {}", axis.name), told)
            }
            (Outcome::Solved, None) => continue,
            (Outcome::Solved, Some(missing)) => {
                let line = ["x", "y", "z"][missing.direction % 3];
                let what = if missing.direction < 3 {
                    format!("along {line} by {:.6} mm", missing.by)
                } else {
                    format!("about {line} by {:.6} deg", missing.by.to_degrees())
                };
                let told = format!("{name} has no axis that moves the tool {what}, along its own axes");
                (format!("missing {}", missing.direction), told)
            }
            (Outcome::Singular, _) => (
                "singular".to_string(),
                format!("{name} stands in a singular pose: two of its axes move the tool alike"),
            ),
            _ => ("lost".to_string(), format!("no posture of {name} was found")),
        };
        match kinds.iter_mut().find(|(known, ..)| *known == kind) {
            Some((.., count)) => *count += 1,
            None => kinds.push((kind, format!("{told}, at {}", source.place(position)), 1)),
        }
    }
    kinds.iter().map(|(_, told, count)| format!("not reached: {count} of {} positions: {told}\n", line.len())).collect()
}

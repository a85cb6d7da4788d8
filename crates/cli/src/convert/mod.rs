//! `flank convert`: a job carried over to another machine.

mod files;
mod series;
mod source;
mod table;

use flank_chain_dsl::{Job, Machine, compile_with_machine};
use flank_expr::{Expr, Graph};
use flank_solver::{Outcome, PoseError, PoseProblem, Posture, Range, TargetAxis};

use crate::arguments::Convert;
use crate::{Ending, print, spec, units};
use series::Series;
use source::Source;
use table::Table;

/// No linear axis without travel goes farther, mm.
const REACH: f64 = 10_000.0;

pub(crate) fn run(arguments: &Convert) -> Ending {
    let graph = Graph::new();
    let which = &arguments.which;
    let mut compilation = compile_with_machine(&graph, &which.file, &arguments.to, &which.set);
    spec::tell(&compilation.diagnostics, &compilation.sources);
    if compilation.has_errors() {
        return Ending::Wrong;
    }
    let target = compilation.machine.take();
    let jobs = match compilation.take_jobs(which.job.as_deref()) {
        Ok(jobs) => jobs,
        Err(finding) => {
            spec::tell(&[finding], &compilation.sources);
            return Ending::Wrong;
        }
    };
    let target = target.expect("a compilation without errors has the machine");
    let hash = spec::hash(&compilation);
    let carried = one(&jobs).and_then(|job| {
        let (mut table, told) = carry(&graph, job, &target, arguments)?;
        // a table of one motion; what the target cannot do is no program
        if table.motions.len() == 1 && told.is_empty() {
            table.written = files::write(&table, crate::solve::header(&job.name, which, &hash), arguments)?;
        }
        Ok((table, told))
    });
    match carried {
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

fn one<'j, 'g>(jobs: &'j [Job<'g>]) -> Result<&'j Job<'g>, String> {
    match jobs {
        [job] => Ok(job),
        _ => {
            let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
            Err(format!("the file holds several jobs, and one is carried over at a time: --job {}", names.join(" or ")))
        }
    }
}

/// The axes over the motion, their series, and in words what the target cannot do.
fn carry<'g>(
    graph: &'g Graph,
    job: &Job<'g>,
    target: &Job<'g>,
    arguments: &Convert,
) -> Result<(Table, String), String> {
    let source = Source::of(job, arguments)?;
    let machine = &target.machines[0];
    let [work, tool] = [
        frame(machine, &source.work, arguments.work_frame.as_deref(), "--work-frame")?,
        frame(machine, &source.tool, arguments.tool_frame.as_deref(), "--tool-frame")?,
    ];
    let chain = machine.chain(graph, &work, &tool).expect("both frames are the machine's");
    let laws: Vec<(Expr<'g>, Expr<'g>)> =
        machine.axes.iter().filter(|axis| axis.law != axis.variable).map(|axis| (axis.variable, axis.law)).collect();
    let chain = chain.substituted(&laws);
    let free: Vec<_> = machine.axes.iter().filter(|axis| axis.law == axis.variable).collect();
    let axes: Vec<TargetAxis<'g>> = free
        .iter()
        .map(|axis| TargetAxis {
            variable: axis.variable,
            is_rotary: units::is_angle(axis.dimension),
            travel: axis.travel.map(|(low, high)| Range { low, high }),
        })
        .collect();
    let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
    let motions: Vec<Expr<'g>> = source.motions.iter().map(|motion| motion.variable).collect();
    let problem =
        PoseProblem::new(&chain, &axes, source.driven, &motions, &source.symmetries, REACH, &bindings).map_err(|error| {
            match error {
                PoseError::Redundant(more) => format!(
                    "{} has {more} free axes more than the pose of a tool needs, so it does not tell where they stand: `fix` \
                     or `couple` {more} of {} in a variant of the machine",
                    machine.name,
                    free.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>().join(", ")
                ),
                PoseError::Unbound(error) => error.to_string(),
            }
        })?;
    let positions = source.positions(arguments.positions as usize);
    let line = follow(&problem, &positions, source.motions.len());
    let told = failures(&source, machine, &free, &positions, &line);
    let series = (source.motions.len() == 1 && told.is_empty())
        .then(|| Series::of(&problem, &source, &positions, &line, arguments))
        .flatten();
    let table = Table::new((job, machine), &source, &free, (positions, line), series, arguments);
    Ok((table, told))
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
    free: &[&flank_chain_dsl::Axis<'_>],
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

//! `flank derive`

use std::path::Path;

use flank_chain_dsl::{Job, derivation, equations};
use flank_expr::geometry::Vector3;
use flank_expr::{Graph, Style};
use flank_solver::Explicit;
use serde_json::{Value, json};

use crate::arguments::Derive;
use crate::convert::{self, Carried};
use crate::cost::SurfaceCost;
use crate::failure::{Failure, not_done};
use crate::{Ending, eprint, print, spec};

pub(crate) fn run(arguments: &Derive) -> Result<Ending, Failure> {
    let graph = Graph::new();
    if let Some(to) = &arguments.to {
        return carried(&graph, to, arguments);
    }
    let (_, jobs) = spec::jobs(&graph, &arguments.which)?;
    if arguments.cost {
        return cost(&jobs, arguments.json);
    }
    let pages = jobs.iter().map(|job| (job.name.as_str(), derivation(job, style(arguments))));
    Ok(show(&pages.collect::<Vec<_>>(), "", arguments))
}

fn style(arguments: &Derive) -> Style {
    if arguments.latex { Style::Latex } else { Style::Text }
}

/// Prints the page of each job, and tells what was not solved on the way.
fn show(pages: &[(&str, String)], told: &str, arguments: &Derive) -> Ending {
    if arguments.json {
        let style = if arguments.latex { "latex" } else { "text" };
        let jobs: Vec<Value> = pages.iter().map(|(job, page)| json!({ "job": job, "page": page })).collect();
        let document =
            json!({ "schema": "flank.derivation/2", "style": style, "jobs": jobs, "not_done": not_done(told) });
        print(&format!("{document:#}\n"));
    } else {
        pages.iter().for_each(|(_, page)| print(page));
    }
    eprint(told);
    if told.is_empty() { Ending::Done } else { Ending::Unsolved }
}

/// Postures from which the elbow of a closed form is taken.
const POSITIONS: u32 = 101;

/// Prints the axes of another machine in closed form.
fn carried(graph: &Graph, to: &Path, arguments: &Derive) -> Result<Ending, Failure> {
    let carry = |job: &Job<'_>, target: &Job<'_>| {
        let carried = Carried::new(graph, job, target, &arguments.onto, POSITIONS)?;
        // the postures that tell which elbow is meant lie as far as points are solved
        let unsolved = carried.source.unsolved.clone();
        let axes = match carried.failures() {
            told if told.is_empty() => carried.explicit(true),
            told => Err(told.trim_end().to_string()),
        };
        let axes = axes.map_err(|reason| format!("{unsolved}{reason}"))?;
        Ok((explicit_page(job, &carried, &axes, style(arguments)), unsolved))
    };
    let (_, job, target) = convert::compiled(graph, &arguments.which, to)?;
    let (page, unsolved) = carry(&job, &target).map_err(|reason: String| Failure::from(reason).unsolved())?;
    Ok(show(&[(&job.name, page)], &unsolved, arguments))
}

/// The given vectors, then the axes from them.
fn explicit_page<'g>(job: &Job<'g>, carried: &Carried<'_, 'g>, explicit: &Explicit<'g>, style: Style) -> String {
    let (work, tool) = (&carried.source.work, &carried.source.tool);
    let name = |unknown: usize| match carried.free.get(unknown) {
        Some(axis) => axis.name.clone(),
        None => carried.problem.unknowns()[unknown].to_string(),
    };
    let [first, second, third] = explicit.turns.map(name);
    let vector = |[names, values]: [Vector3<'g>; 2]| names.0.into_iter().zip(values.0).collect::<Vec<_>>();
    let given = explicit.given;
    let groups = [
        (
            format!("f: the line about which {third} turns {tool}, seen from {work}, as it is on the job's machine"),
            vector(given.f),
        ),
        (format!("g: a line square to it that turns with {tool}"), vector(given.g)),
        (format!("o: the origin of {tool}, mm"), vector(given.o)),
        (
            format!(
                "{first} and {second} bring that line where {third} has it, {third} turns the tool about it, and the slides \
                 bring it into place; angles continued without jumps"
            ),
            carried.problem.unknowns().iter().copied().zip(explicit.formulas.iter().copied()).collect(),
        ),
    ];
    equations(&format!("job {} on {}", job.name, carried.machine.name), &groups, style)
}

/// Prints how many operations the points of each sampled surface take.
fn cost(jobs: &[Job<'_>], as_json: bool) -> Result<Ending, Failure> {
    let mut told: Vec<Value> = Vec::new();
    for job in jobs {
        let costs: Vec<SurfaceCost<'_>> =
            job.surfaces.iter().filter_map(|surface| SurfaceCost::of(job, surface)).collect();
        if costs.is_empty() {
            return Err(format!("job `{}` asks for no points: add a `sample` for one of its surfaces", job.name).into());
        }
        if as_json {
            let surfaces: Vec<Value> = costs.iter().map(SurfaceCost::json).collect();
            told.push(json!({ "job": job.name, "surfaces": surfaces }));
        } else {
            print(&format!("job {}\n", job.name));
            costs.iter().for_each(|cost| print(&format!("\n{}", cost.text())));
        }
    }
    if as_json {
        print(&format!("{:#}\n", json!({ "schema": "flank.cost/2", "jobs": told })));
    }
    Ok(Ending::Done)
}

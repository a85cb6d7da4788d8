//! `flank derive`

mod cost;
pub(crate) mod result;

use std::path::Path;

use flank_chain_dsl::{Job, derivation, equations};
use flank_expr::geometry::Vector3;
use flank_expr::{Graph, Style};
use flank_solver::Explicit;

use crate::convert::{self, Conversion};
use crate::language::derive::result::{
    CostTable, Derivation, DerivationPage, DeriveResult, FormulaStyle, JobCost, SurfaceCost,
};
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::DeriveRequest;
use crate::project::session::Session;
use crate::project::spec::{self, Origin};

/// What the compiler built, stage by stage; or the axes of another machine in closed form; or how many operations a point takes.
///
/// # Errors
/// What is wrong with the specs, or why there is no closed form.
pub fn derive(request: &DeriveRequest, monitor: &dyn Monitor) -> Result<DeriveResult, Failure> {
    let graph = Graph::new();
    if let Some(to) = &request.to {
        return carried(&graph, to, (request, monitor));
    }
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    if request.cost {
        return cost((&jobs, &Origin::of_compilation(&compilation)));
    }
    let page = |job: &Job<'_>| DerivationPage { job: job.name.clone(), page: derivation(job, style(request)) };
    Ok(shown(jobs.iter().map(page).collect(), Vec::new(), request))
}

fn style(request: &DeriveRequest) -> Style {
    if request.latex { Style::Latex } else { Style::Text }
}

/// The page of each job, with what was not solved on the way.
fn shown(jobs: Vec<DerivationPage>, not_done: Vec<NotDone>, request: &DeriveRequest) -> DeriveResult {
    let style = if request.latex { FormulaStyle::Latex } else { FormulaStyle::Text };
    DeriveResult::Derivation(Derivation { style, jobs, not_done })
}

/// Postures from which the elbow of a closed form is taken.
const POSITIONS: u32 = 101;

/// The axes of another machine in closed form.
fn carried(
    graph: &Graph,
    to: &Path,
    (request, monitor): (&DeriveRequest, &dyn Monitor),
) -> Result<DeriveResult, Failure> {
    let session = Session::new(request.onto.evaluator, monitor);
    let carry = |job: &Job<'_>, target: &Job<'_>| -> Result<_, Failure> {
        let carried = Conversion::new(graph, job, target, (&request.onto, session), POSITIONS)?;
        // the postures that tell which elbow is meant lie as far as points are solved
        let unsolved = carried.source.unsolved.clone();
        let axes = match carried.failures() {
            missed if missed.is_empty() => carried
                .explicit(true)
                .map_err(|reason| vec![NotDone::new(NotDoneKind::NoClosedForm, &carried.machine.name, reason)]),
            missed => Err(missed),
        };
        let axes = axes.map_err(|missed| Failure::NotDone(unsolved.iter().cloned().chain(missed).collect()))?;
        Ok((explicit_page(job, &carried, &axes, style(request)), unsolved))
    };
    let (origin, job, target) = convert::compiled(graph, &request.jobs, to, monitor)?;
    let (page, unsolved) = carry(&job, &target).map_err(Failure::unsolved)?;
    let not_done = origin.located(&[&job], unsolved);
    Ok(shown(vec![DerivationPage { job: job.name.clone(), page }], not_done, request))
}

/// The given vectors, then the axes from them.
fn explicit_page<'g>(job: &Job<'g>, carried: &Conversion<'_, 'g>, explicit: &Explicit<'g>, style: Style) -> String {
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

/// How many operations the points of each sampled surface take.
fn cost((jobs, origin): (&[Job<'_>], &Origin)) -> Result<DeriveResult, Failure> {
    let of = |job: &Job<'_>| {
        let surfaces: Vec<SurfaceCost> =
            job.surfaces.iter().filter_map(|surface| SurfaceCost::of_surface(job, surface)).collect();
        match surfaces.is_empty() {
            true => Err(origin.findings(&[job.asks_for_nothing()])),
            false => Ok(JobCost { job: job.name.clone(), surfaces }),
        }
    };
    let jobs = jobs.iter().map(of).collect::<Result<_, Failure>>()?;
    Ok(DeriveResult::Cost(CostTable { jobs }))
}

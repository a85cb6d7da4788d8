//! One spec, tested.

use std::cmp::Reverse;

use flank_chain_dsl::limits::FILE_BYTES;
use flank_chain_dsl::{Compilation, Expectation, ExpectedError, Job, Request, Span, closest, compile_request};
use flank_expr::Graph;
use rayon::prelude::*;

use crate::project::failure::Failure;
use crate::project::findings::{Findings, Place};
use crate::project::monitor::{Monitor, Unwatched};
use crate::project::once::KnownSamples;
use crate::project::requests::JobSelection;
use crate::project::session::{Session, check};
use crate::project::shown_path;
use crate::project::spec::Origin;
use crate::testing::judge::{Verdict, judged, of_pose, of_requirement, precise};
use crate::testing::points::{Tested, thinned};
use crate::testing::quantities::Known;
use crate::testing::request::TestRequest;
use crate::testing::result::{TestResult, TestedExpectation, TestedItem, TestedSpec};
use crate::testing::snapshot;

/// Tests specs, as many at a time as there are threads, those first that are likely to take longest. The result does not depend on how many
/// threads there are.
///
/// # Errors
/// If a filter takes none of their jobs and machines, or the work is cancelled.
pub fn test(requests: &[TestRequest], monitor: &dyn Monitor) -> Result<TestResult, Failure> {
    let mut order: Vec<usize> = (0..requests.len()).collect();
    order.sort_by_cached_key(|number| Reverse(size(&requests[*number])));
    // one after the other in this order, whichever thread has time
    let tested = order.into_iter().par_bridge().map(|number| {
        check(monitor)?;
        Ok((number, test_spec(&requests[number], &Unwatched)?))
    });
    let mut tested = tested.collect::<Result<Vec<(usize, TestedSpec)>, Failure>>()?;
    tested.sort_by_key(|(number, _)| *number);
    let result = TestResult::of_specs(tested.into_iter().map(|(_, spec)| spec).collect());
    match requests.iter().find_map(|request| request.filter.as_ref()) {
        Some(filter) if !result.specs.iter().any(TestedSpec::says_something) => {
            let names =
                result.specs.iter().flat_map(|spec| spec.names.iter().map(|name| format!("{}:{name}", spec.file)));
            let names: Vec<String> = names.collect();
            let known = match closest(filter, names.iter().map(String::as_str)).or(names.first().map(String::as_str)) {
                Some(near) => format!("it is a part of `FILE:NAME`, as in `{near}`"),
                None => "there is none that is tested".to_string(),
            };
            Err(Failure::Input(format!("option `filter {filter}` takes no job and no machine: {known}")))
        }
        _ => Ok(result),
    }
}

/// How much there is to do for a spec, as far as its text tells: bodies and contacts take longer than anything else.
fn size(request: &TestRequest) -> [usize; 2] {
    let (files, file) = (request.project.files(), request.project.file());
    let text = files.real_path(file).and_then(|file| files.read(&file, FILE_BYTES.most)).unwrap_or_default();
    let starts = |line: &&str| ["solid ", "contact "].iter().any(|word| line.trim_start().starts_with(word));
    [text.lines().filter(starts).count(), text.len()]
}

/// Checks all that a spec expects, at few points of each sample.
///
/// # Errors
/// If the work is cancelled.
pub fn test_spec(request: &TestRequest, monitor: &dyn Monitor) -> Result<TestedSpec, Failure> {
    let graph = Graph::new();
    let project = &request.project;
    let compile = Request { files: project.shared_files(), ..Request::default() };
    let compilation = compile_request(&graph, project.file(), &compile);
    let findings = Findings::new(&compilation.diagnostics, &compilation.sources);
    let of_machines = compilation.machines.iter().filter(|machine| !machine.expectations.is_empty());
    let names = of_machines.map(|machine| &machine.name).chain(compilation.jobs.iter().map(|job| &job.name));
    let nothing = TestedSpec {
        names: names.cloned().collect(),
        file: shown_path(project.file()),
        items: Vec::new(),
        findings,
        failure: None,
        snapshot: None,
        read: compilation.sources.files().filter_map(|(_, source)| source.file.clone()).collect(),
    };
    if !compilation.expected_errors.is_empty() {
        return Ok(wrong_as_expected(&compilation, request, nothing));
    }
    if compilation.has_errors() {
        return Ok(nothing);
    }
    // contacts, bodies and expectations ask for the same samples
    let known = KnownSamples::default();
    let session = Session::new(request.evaluator, monitor).with_known(&known);
    // a snapshot says what the search for other branches took, too
    let session = if snapshot::is_compared(request) { session } else { session.with_points_alone() };
    let which = JobSelection::all(project.clone());
    match tested(&graph, &compilation, (request, &which, session)) {
        Ok((items, snapshot)) => Ok(TestedSpec { items, snapshot, ..nothing }),
        Err(Failure::Cancelled) => Err(Failure::Cancelled),
        Err(other) => Ok(TestedSpec { failure: Some(other.to_string()), ..nothing }),
    }
}

type Found = (Vec<TestedItem>, Option<crate::testing::result::TestedSnapshot>);

fn tested<'g>(
    graph: &'g Graph,
    compilation: &Compilation<'g>,
    (request, which, session): (&TestRequest, &JobSelection, Session<'_>),
) -> Result<Found, Failure> {
    let jobs: Vec<Job<'g>> = compilation.jobs.iter().map(thinned).collect();
    let origin = Origin::of_compilation(compilation);
    let mut items = Vec::new();
    for machine in compilation.machines.iter().filter(|machine| request.takes(&machine.name)) {
        let expectations = machine.expectations.iter().filter_map(|expectation| match expectation.what {
            flank_chain_dsl::Expected::Pose { off, within } => {
                Some(verdict(compilation, expectation, of_pose(off, within)))
            }
            _ => None,
        });
        items.push(TestedItem { name: machine.name.clone(), expectations: expectations.collect() });
    }
    let mut snapshots = Vec::new();
    for job in jobs.iter().filter(|job| request.takes(&job.name)) {
        session.check()?;
        let of_job = Tested::new(job, &origin, session);
        of_job.solve_looked_at();
        let known = Known::new(&of_job, graph, (&jobs, which, &origin));
        let mut expectations = required(compilation, &of_job);
        for expectation in &job.expectations {
            expectations.push(verdict(compilation, expectation, judged(&known, &expectation.what)?));
        }
        items.push(TestedItem { name: job.name.clone(), expectations });
        if snapshot::is_compared(request) {
            snapshots.push(of_job);
        }
    }
    let snapshot = snapshot::compared(request, &snapshots)?;
    Ok((items, snapshot))
}

/// What the samples of a job require of their points.
fn required(compilation: &Compilation<'_>, job: &Tested<'_, '_>) -> Vec<TestedExpectation> {
    let of_surface = |index: usize| {
        let limits = job.surface(index).sample.iter().flat_map(|sample| &sample.limits);
        limits.enumerate().map(move |(number, limit)| {
            let place = Place::of_span(&compilation.sources, limit.place);
            let Verdict { holds, found, details } = of_requirement(job, index, number);
            let [low, high] = [limit.ends.0, limit.ends.1].map(|end| precise(limit.of.dimension, end));
            let expected = format!("require {}: {low} .. {high}", limit.of.name);
            TestedExpectation { expected, place, holds, found, details }
        })
    };
    (0..job.job.surfaces.len()).flat_map(of_surface).collect()
}

fn verdict(compilation: &Compilation<'_>, expectation: &Expectation<'_>, found: Verdict) -> TestedExpectation {
    let (expected, place) = written(compilation, expectation.written);
    TestedExpectation { expected, place, holds: found.holds, found: found.found, details: found.details }
}

/// An expectation on one line, without its first word, and its place.
fn written(compilation: &Compilation<'_>, span: Span) -> (String, Place) {
    let place = Place::of_span(&compilation.sources, span);
    let lines = place.text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let words: Vec<&str> = lines.flat_map(str::split_whitespace).collect();
    let text = words.join(" ");
    (text.strip_prefix("expect ").map_or(text.clone(), str::to_string), place)
}

/// A spec that must be wrong.
fn wrong_as_expected(compilation: &Compilation<'_>, request: &TestRequest, nothing: TestedSpec) -> TestedSpec {
    let codes: Vec<&str> = nothing
        .findings
        .list()
        .iter()
        .filter(|finding| finding.severity == crate::project::findings::Severity::Error)
        .map(|finding| finding.code)
        .collect();
    // every error is one that is expected
    let is_other = |code: &&str| !compilation.expected_errors.iter().any(|known| known.code == *code);
    let others: Vec<&str> = codes.iter().copied().filter(is_other).collect();
    let mut items: Vec<TestedItem> = Vec::new();
    for (number, ExpectedError { job, code, place }) in compilation.expected_errors.iter().enumerate() {
        let told = number == 0 && !others.is_empty();
        let expectation = TestedExpectation {
            expected: format!("error {code}"),
            place: written(compilation, *place).1,
            holds: codes.contains(&code.as_str()) && !told,
            found: if codes.is_empty() { "no error".to_string() } else { codes.join(", ") },
            details: if told { vec![format!("not expected: {}", others.join(", "))] } else { Vec::new() },
        };
        match items.last_mut().filter(|item| item.name == *job) {
            Some(item) => item.expectations.push(expectation),
            None => items.push(TestedItem { name: job.clone(), expectations: vec![expectation] }),
        }
    }
    items.extend(compilation.untested_jobs.iter().map(|job| TestedItem {
        name: job.node.clone(),
        expectations: vec![TestedExpectation {
            expected: "no error".to_string(),
            place: Place::of_span(&compilation.sources, job.span),
            holds: false,
            found: "nothing is tested of it, since another job of this file expects an error".to_string(),
            details: vec!["the job that is to be wrong needs a file of its own".to_string()],
        }],
    }));
    items.retain(|item| request.takes(&item.name));
    TestedSpec { items, ..nothing }
}

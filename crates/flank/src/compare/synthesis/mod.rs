//! `flank fit`: the settings that bring a contact where it is wanted.

mod conditions;
mod problem;
pub(crate) mod result;
mod text;
mod verdict;

use std::time::Instant;

use flank_chain_dsl::{Contact, Job, WantedContact};
use flank_expr::Graph;
use flank_solver::{ContactPoint, ContactState, RangeEnd, SearchEnd, SynthesizedContact};

use self::conditions::{Condition, conditions};
use self::problem::Problem;
use self::result::{CheckedContact, SynthesisResult, SynthesizedSetting};
use crate::compare::fit::corrected;
use crate::compare::fit::result::RangeBound;
use crate::contact::pair::Members;
use crate::contact::result::{Backlash, ContactResult, TransmissionError};
use crate::contact::rolling::Rolling;
use crate::contact::{Rolled, backlash, rolled};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::NotDoneKind;
use crate::project::requests::{ContactRequest, JobSelection, SynthesisRequest};
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec::{self, Origin};
use crate::project::units;

/// Positions over a pitch among which the vertex is looked for.
const POSITIONS: usize = 12;
/// Derivatives of an error by the roll below this are rounding.
const EVEN: f64 = 1e-11;
/// Groups of settings that are tried one after the other where none are named and the first does not do, each of as many as there are conditions at
/// the most.
const OTHER_GROUPS: [std::ops::Range<usize>; 5] = [0..2, 1..2, 0..3, 2..3, 3..4];

/// Looks for the settings with which a contact is at its vertex what its job wants, and checks them by the whole contact.
///
/// # Errors
/// What is wrong with the spec; that it wants no such contact; that the flanks have no vertex as they are; that a file cannot be written.
pub fn synthesis(request: &SynthesisRequest, monitor: &dyn Monitor) -> Result<SynthesisResult, Failure> {
    let start = Instant::now();
    if request.dry && request.write.is_none() {
        return Err(Failure::Request("option `dry` tells the spec of option `write`: name its file".to_string()));
    }
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor);
    let (job, want) = find(&jobs, &request.want)?;
    let contact = &job.contacts[want.contact];
    let mut members = Members::solved(job, contact, session)?;
    members.check_range(job)?;
    let vertex = vertex(job, &mut members)?;
    let conditions = conditions(job, &members, want, &vertex)?;
    let _working = session.begin(format!("looking for the settings of {}", want.name))?;
    let (problem, found) = searched(job, (&members, &conditions), &vertex, request, session)?;
    let values: Vec<(String, String)> = problem.values(&found);
    let checked = if values.is_empty() { None } else { Some(Checked::of(request, (job, contact), &values, session)?) };
    let reached = checked.as_ref().and_then(|checked| checked.vertex.as_ref());
    let mut result = SynthesisResult {
        job: job.name.clone(),
        spec: shown_path(request.jobs.file()),
        want: want.name.clone(),
        contact: contact.name.clone(),
        surface: members.surfaces[1].name.clone(),
        film_um: 1e3 * want.film,
        conditions: conditions.iter().map(|of| of.told([Some(&vertex), Some(&found.vertex), reached])).collect(),
        settings: settings(&problem, &found),
        chosen_of: problem.chosen_of,
        steps: found.fit.steps,
        is_settled: found.fit.end == SearchEnd::Settled,
        checked: checked.as_ref().and_then(|checked| checked.result.middle.as_ref().map(|_| told(&checked.result))),
        corrected: None,
        files: Vec::new(),
        not_done: Vec::new(),
        remarks: problem.idle(request),
        timing: Timing { points: 1, elapsed: start.elapsed(), ..Timing::default() },
    };
    verdict::judge(&mut result, (&members, &conditions), (&problem, &found), checked.as_ref());
    result.remarks.extend(problem.of_both(job, &members));
    if let Some(checked) = &checked {
        let now = backlash_now(job, &mut members, request, session)?;
        result.remarks.extend(verdict::other_backlash(want, (now.as_ref(), checked.result.backlash.as_ref())));
    }
    if let Some(file) = request.write.as_ref().filter(|_| !values.is_empty()) {
        let text = corrected::text(&request.jobs, (job, &values), file, &origin)?;
        match (request.dry, result.not_done.first_mut()) {
            (true, _) => result.corrected = Some(text),
            (false, Some(unmet)) => unmet.details.push(verdict::unwritten(file)),
            (false, None) => result.files.push(corrected::write(file, &text, &origin)?),
        }
    }
    result.not_done = origin.located(&[job], result.not_done);
    result.remarks = origin.located(&[job], result.remarks);
    result.timing.elapsed = start.elapsed();
    Ok(result)
}

/// The settings that come nearest to what is wanted. Where they are chosen, and those that do most do not bring it, others are tried beside them and
/// instead of them.
///
/// # Errors
/// If a setting is not there or cannot be set, the contact is lost, or the work is cancelled.
fn searched<'p, 'g>(
    job: &'p Job<'g>,
    (members, conditions): (&Members<'_, 'g>, &[Condition]),
    vertex: &'p ContactPoint,
    request: &SynthesisRequest,
    session: Session<'_>,
) -> Result<(Problem<'p, 'g>, SynthesizedContact), Failure> {
    let mut problem = Problem::new(job, members, conditions, vertex, (request, 0..1))?;
    let found = problem.solve()?;
    session.check()?;
    let is_met = |at: &ContactPoint| verdict::is_met(members, conditions, at);
    if is_met(&found.vertex) || verdict::is_hopeless(members, conditions) || problem.chosen_of.is_none() {
        return Ok((problem, found));
    }
    for groups in OTHER_GROUPS {
        let others = Problem::new(job, members, conditions, vertex, (request, groups))?;
        if others.settings.is_empty() {
            break;
        }
        let is_there = others.is_met_somewhere();
        session.check()?;
        if is_there
            && let Ok(found) = others.solve()
            && is_met(&found.vertex)
        {
            return Ok((others, found));
        }
        problem.left.retain(|name| others.settings.iter().all(|of| of.name != *name));
    }
    Ok((problem, found))
}

/// # Errors
/// If no job wants that, or several do.
fn find<'j, 'g>(jobs: &'j [Job<'g>], name: &str) -> Result<(&'j Job<'g>, &'j WantedContact), Failure> {
    let all = || jobs.iter().flat_map(|job| job.wants.iter().map(move |want| (job, want)));
    let is_meant =
        |job: &Job<'_>, want: &WantedContact| want.name == name || format!("{}.{}", job.name, want.name) == name;
    let found: Vec<_> = all().filter(|(job, want)| is_meant(job, want)).collect();
    match found[..] {
        [one] => Ok(one),
        [] if all().next().is_none() => {
            let message = "no job says what it wants of a contact: add `want centred in CONTACT = vertex(lengthwise: 0.5, profilewise: 0.5)`";
            Err(Failure::Input(message.to_string()))
        }
        [] => {
            let known: Vec<String> = all().map(|(_, want)| format!("`{}`", want.name)).collect();
            Err(Failure::Input(format!("no job wants `{name}` of a contact; there is: {}", known.join(", "))))
        }
        _ => {
            let known: Vec<String> = found.iter().map(|(job, want)| format!("`{}.{}`", job.name, want.name)).collect();
            Err(Failure::Input(format!("several jobs want `{name}`; say which: {}", known.join(", "))))
        }
    }
}

/// The backlash of the pair as it is, where opposite flanks tell it.
///
/// # Errors
/// If the work is cancelled.
fn backlash_now<'j, 'g>(
    job: &'j Job<'g>,
    members: &mut Members<'j, 'g>,
    request: &SynthesisRequest,
    session: Session<'_>,
) -> Result<Option<Backlash>, Failure> {
    let (errors, whole) = (vec![0.0; members.contact.errors.len()], ContactRequest::new(request.jobs.clone()));
    let Ok(rolling) = Rolling::of_members(job, members, &errors, whole.positions as usize) else { return Ok(None) };
    let rolling = rolling.closely(members);
    let (found, _) = backlash::of(job, members, &whole, &errors, &rolling, session)?;
    Ok(found.map(|(backlash, _)| backlash))
}

/// The vertex of the contact as it is.
///
/// # Errors
/// If it has none.
fn vertex<'g>(job: &Job<'g>, members: &mut Members<'_, 'g>) -> Result<ContactPoint, Failure> {
    let errors = vec![0.0; members.contact.errors.len()];
    let name = &members.contact.name.clone();
    let rolling = Rolling::of_members(job, members, &errors, POSITIONS).map_err(|_| {
        Failure::Unsolved(format!("the flanks of contact `{name}` do not touch as they are, so that nothing is near what is wanted: `flank contact` says why"))
    })?;
    let is_line = rolling.state() == Some(ContactState::Line);
    let flanks = || rolling.engagement.points.iter().filter(|point| point.is_of_flanks());
    let is_even = flanks().all(|point| point.lag_slopes.iter().all(|slope| slope.abs() < EVEN));
    rolling.vertex.ok_or_else(|| {
        Failure::Unsolved(match (is_line, is_even) {
            (true, _) => format!(
                "the flanks of contact `{name}` touch along a line as they are, and a line has no vertex: crown a flank along the tooth and along \
                 its profile first, so that they touch in a point"
            ),
            (false, true) => format!(
                "the error of contact `{name}` is even as it is, so that it has no extreme, and the contact no vertex: crown a flank along the \
                 path of contact first, by its profile or by the roll"
            ),
            (false, false) => format!(
                "the error of contact `{name}` rises or falls all along the flanks as it is, so that the contact has no vertex: begin with settings at \
                 which the error is extreme where the flanks touch, or roll the pair farther"
            ),
        })
    })
}

/// The whole contact with other settings.
struct Checked {
    result: ContactResult,
    vertex: Option<ContactPoint>,
}

impl Checked {
    fn of(
        request: &SynthesisRequest,
        (job, contact): (&Job<'_>, &Contact<'_>),
        values: &[(String, String)],
        session: Session<'_>,
    ) -> Result<Checked, Failure> {
        let whole = |name: &str| format!("{}.{name}", job.name);
        let is_new = |name: &str| values.iter().any(|(known, _)| known == name || whole(known) == name);
        let kept = request.jobs.set.iter().filter(|(name, _)| !is_new(name)).cloned();
        let set = kept.chain(values.iter().map(|(name, value)| (whole(name), value.clone()))).collect();
        let selection = JobSelection { set, job: Some(job.name.clone()), ..request.jobs.clone() };
        let graph = Graph::new();
        let (_, jobs) = spec::jobs(&graph, &selection, &crate::project::monitor::Unwatched)?;
        let job = jobs.iter().find(|of| of.name == job.name);
        let found = job.and_then(|job| Some((job, job.contacts.iter().find(|of| of.name == contact.name)?)));
        let (job, contact) = found.expect("other values make no other job");
        let whole = ContactRequest::new(selection);
        let Rolled { mut result, members, found } = rolled(job, contact, &whole, session)?;
        if let Some((rolling, _)) = &found {
            let none = vec![0.0; contact.errors.len()];
            let (room, missed) = backlash::of(job, &members, &whole, &none, rolling, session)?;
            result.backlash = room.map(|(backlash, _)| backlash);
            // that opposite flanks are not found all the way says nothing of these
            result.not_done.extend(missed.into_iter().filter(|of| of.kind == NotDoneKind::Penetration));
        }
        let vertex = found.and_then(|(rolling, _)| rolling.vertex);
        Ok(Checked { result, vertex })
    }
}

fn told(of: &ContactResult) -> CheckedContact {
    let touches: Vec<String> = of
        .pattern
        .iter()
        .flat_map(|pattern| pattern.touches.iter().map(move |side| format!("{side} of {}", pattern.surface)))
        .collect();
    let least = of.pattern.iter().filter_map(|pattern| pattern.least_um).reduce(f64::min);
    CheckedContact {
        kind: of.kind,
        is_free: touches.is_empty() && of.edges.is_empty(),
        touches,
        edges: of.edges.clone(),
        peak_to_peak: of.error.as_ref().and_then(TransmissionError::whole),
        least_um: least,
    }
}

fn settings(problem: &Problem<'_, '_>, found: &SynthesizedContact) -> Vec<SynthesizedSetting> {
    let told = |(k, of): (usize, &&flank_chain_dsl::Parameter<'_>)| {
        let new = found.fit.values[k];
        let shown = |value: f64| units::shown(of.dimension, value);
        let is_held = problem.is_rounded(k);
        let bound = found.fit.held[k].filter(|_| !is_held).map(|end| match end {
            RangeEnd::Low => RangeBound::Low,
            RangeEnd::High => RangeBound::High,
        });
        SynthesizedSetting {
            name: of.name.clone(),
            unit: units::whole_symbol(of.dimension),
            now: shown(of.value),
            change: shown(new) - shown(of.value),
            new: shown(new),
            at_bound: bound,
            step: problem.steps[k].map(shown),
        }
    };
    problem.settings.iter().enumerate().map(told).collect()
}

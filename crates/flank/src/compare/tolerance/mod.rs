//! `flank tolerance`: how the ease-off of a surface and its contacts scatter with settings and mounting errors.

mod causes;
mod ease_off;
mod mating;
mod quantity;
pub(crate) mod result;
mod sweep;
mod text;

use std::time::Instant;

use flank_chain_dsl::{Dimension, Job, Parameter};
use flank_expr::Graph;
use flank_solver::Scatter;

use self::causes::{Cause, CausePlace, causes};
use self::ease_off::Flank;
use self::mating::Mating;
use self::quantity::Quantity;
use self::result::{CauseKind, ScatteringCause, SweptCases, ToleranceResult, ToleratedResult};
use self::sweep::Swept;
use crate::compare::map::{Named, find};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::ToleranceRequest;
use crate::project::session::Session;
use crate::project::spec::{self, Origin};
use crate::project::{shown_path, units};

/// Random cases and linear numbers differ if they lie farther apart than so many standard errors.
const DIFFERENT: f64 = 3.0;
/// Random cases that change a number by less are not told: four decimals show zeros.
const SHOWN: f64 = 5e-5;
/// What has less than this share of the largest change of a result is rounding.
const NOTHING: f64 = 1e-9;

/// Propagates how settings and mounting errors scatter to the ease-off of a surface, and to the contacts that it takes part in.
///
/// # Errors
/// What is wrong with the spec; that something named is not there or has another unit; that correlations contradict each other.
pub fn tolerance(request: &ToleranceRequest, monitor: &dyn Monitor) -> Result<ToleranceResult, Failure> {
    let start = Instant::now();
    if !(request.limits > 0.0 && request.limits.is_finite()) {
        return Err(Failure::Request("option `limits` is above 0: so many standard deviations".to_string()));
    }
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor);
    let of = find(&jobs, &request.surface)?;
    let takes_part = |at: &usize| {
        of.job.contacts[*at].surfaces.iter().any(|surface| of.job.surfaces[*surface].name == of.surface.name)
    };
    let contacts: Vec<usize> = (0..of.job.contacts.len()).filter(takes_part).collect();
    let causes = causes(of.job, &contacts, request)?;
    let scatter = scatter(&causes, of.job, request)?;
    let _working = session.begin(format!("tolerances of {}", of.surface.name))?;
    let settings: Vec<&Parameter<'_>> = causes.iter().filter_map(|cause| cause.setting(of.job)).collect();
    let flank = Flank::new(of, &settings, (!request.no_align, session))?;
    let mut not_done = Vec::new();
    let mut matings = Vec::new();
    for contact in contacts.iter().map(|at| &of.job.contacts[*at]) {
        match Mating::new(of.job, contact, &causes, session)? {
            Some(mating) => matings.push(mating),
            None => not_done.push(no_contact(&contact.name)),
        }
    }
    let quantities = quantities(&flank, &mut matings, (of, &causes), &mut not_done)?;
    let wanted = wanted(&quantities, request)?;
    let cases = match request.sweep {
        Some(count) => {
            let swept = Swept::new(of.job, &causes, (&flank, &matings));
            let drawn = sweep::drawn(&scatter, count);
            Some((swept.cases(&drawn, session)?, drawn.iter().filter(|off| swept.is_beyond(off)).count()))
        }
        None => None,
    };
    let (cases, beyond) = cases.unzip();
    let result = |(at, of): (usize, &Quantity)| ToleratedResult {
        name: of.name.clone(),
        unit: of.unit.to_string(),
        standard_deviation: scatter.deviation(&of.gradient) / of.size,
        worst_case: request.limits * scatter.worst(&of.gradient) / of.size,
        wanted: wanted[at].map(|wanted| wanted / of.size),
        changes: causes.iter().zip(&of.gradient).map(|(cause, by)| cause.scatter * by / of.size).collect(),
        shares: scatter.shares(&of.gradient),
        swept: cases.as_ref().and_then(|cases| sweep::shown(cases, at)),
    };
    let results: Vec<ToleratedResult> = quantities.iter().enumerate().map(result).collect();
    let sweep = cases.map(|cases| SweptCases {
        drawn: cases.len(),
        solved: cases.iter().flatten().count(),
        beyond: beyond.unwrap_or(0),
    });
    not_done.extend(sweep.and_then(|sweep| unsolved(sweep, &of.surface.name)));
    not_done.extend(results.iter().filter(|_| !request.scatter.is_empty()).filter_map(too_much));
    let remarks: Vec<Remark> =
        results.iter().filter_map(|of| not_linear(of, sweep?.solved)).chain(idle(&results, &causes, request)).collect();
    let may = may_scatter(&quantities, &wanted, &scatter);
    Ok(ToleranceResult {
        job: of.job.name.clone(),
        spec: shown_path(request.jobs.file()),
        surface: of.surface.name.clone(),
        frame: of.surface.frame.clone(),
        counts: flank.counts,
        known: flank.known(),
        contacts: matings.iter().map(|mating| mating.name().to_string()).collect(),
        limits: request.limits,
        causes: causes.iter().zip(may).map(|(cause, may)| told(cause, may, of.job)).collect(),
        results,
        sweep,
        not_done: origin.located(&[of.job], not_done),
        remarks: origin.located(&[of.job], remarks),
        timing: Timing { points: flank.known(), elapsed: start.elapsed(), ..Timing::default() },
    })
}

/// # Errors
/// If a correlation names no cause, is no correlation, or contradicts others.
fn scatter(causes: &[Cause], job: &Job<'_>, request: &ToleranceRequest) -> Result<Scatter, Failure> {
    let place = |name: &String| {
        let own = name.strip_prefix(&format!("{}.", job.name)).unwrap_or(name);
        let is_named = |cause: &Cause| cause.name == own || cause.name.rsplit('.').next() == Some(own);
        let exact = causes.iter().position(|cause| cause.name == own);
        exact.or_else(|| causes.iter().position(is_named)).ok_or_else(|| {
            Failure::Input(format!(
                "option `correlation` names `{name}`, which does not scatter: name it with option `scatter`"
            ))
        })
    };
    let pair = |(names, by): &([String; 2], f64)| {
        let [a, b] = names;
        let (at, other) = (place(a)?, place(b)?);
        let is_one = at != other && by.abs() < 1.0;
        is_one.then_some((at, other, *by)).ok_or_else(|| {
            Failure::Request(format!(
                "option `correlation {a},{b}`: two different settings have one, above -1 and below 1"
            ))
        })
    };
    let pairs = request.correlations.iter().map(pair).collect::<Result<Vec<_>, Failure>>()?;
    let is_same = |a: &(usize, usize, f64), b: &(usize, usize, f64)| [(a.0, a.1), (a.1, a.0)].contains(&(b.0, b.1));
    let again = (1..pairs.len()).find(|k| pairs[..*k].iter().any(|of| is_same(of, &pairs[*k])));
    if let Some((a, b, _)) = again.map(|k| pairs[k]) {
        let [a, b] = [a, b].map(|at| &causes[at].name);
        return Err(Failure::Request(format!(
            "option `correlation` names `{a}` and `{b}` twice: leave one of them out"
        )));
    }
    let deviations: Vec<f64> = causes.iter().map(|cause| cause.scatter).collect();
    Scatter::new(&deviations, &pairs).ok_or_else(|| {
        Failure::Request(
            "option `correlation`: no settings scatter like that, for these correlations contradict each other"
                .to_string(),
        )
    })
}

/// All numbers, with their changes by all causes.
///
/// # Errors
/// If the surface has too few points.
fn quantities(
    flank: &Flank,
    matings: &mut Vec<Mating>,
    (of, causes): (Named<'_, '_>, &[Cause]),
    not_done: &mut Vec<NotDone>,
) -> Result<Vec<Quantity>, Failure> {
    let settings = causes.iter().filter(|cause| matches!(cause.at, CausePlace::Setting(_))).count();
    let own = flank.quantities(settings).ok_or_else(|| {
        let name = &of.surface.name;
        Failure::Unsolved(format!(
            "the points of `{name}` are too few for slopes and crownings: sample it in more rows and columns"
        ))
    })?;
    // axes of contacts do not move the flank, and stand behind the settings
    let mut all: Vec<Quantity> = own
        .into_iter()
        .map(|quantity| {
            let mut gradient = quantity.gradient;
            gradient.resize(causes.len(), 0.0);
            Quantity { gradient, ..quantity }
        })
        .collect();
    matings.retain(|mating| match mating.quantities() {
        Some(own) => {
            all.extend(own);
            true
        }
        None => {
            not_done.push(no_contact(mating.name()));
            false
        }
    });
    Ok(all.into_iter().map(|quantity| quantity.without_rounding(causes)).collect())
}

fn no_contact(name: &str) -> NotDone {
    let message =
        format!("contact {name}: the flanks do not touch in a point that could move; `flank contact` says more");
    NotDone::new(NotDoneKind::NoContact, name, message)
}

/// What each number may scatter by, in mm and radians.
///
/// # Errors
/// If a name is none of them, is there twice, or has another unit.
fn wanted(quantities: &[Quantity], request: &ToleranceRequest) -> Result<Vec<Option<f64>>, Failure> {
    let mut all = vec![None; quantities.len()];
    for (name, amount) in &request.budget {
        let Some(at) = quantities.iter().position(|of| of.name == *name) else {
            let known: Vec<String> = quantities.iter().map(|of| format!("`{}`", of.name)).collect();
            return Err(Failure::Input(format!("there is no result `{name}`; there is: {}", known.join(", "))));
        };
        let dimension = if quantities[at].unit == "urad" { Dimension::ANGLE } else { Dimension::LENGTH };
        let value = amount
            .inside(dimension, 0.0)
            .ok_or_else(|| Failure::Input(amount.refused("budget", name, (dimension, 1.0))))?;
        if all[at].replace(value).is_some() {
            return Err(Failure::Request(format!("option `budget` names `{name}` twice: leave one of them out")));
        }
    }
    Ok(all)
}

/// How far each cause may scatter so that all that is wanted is met, correlated as they are: each of those that change a number changes it by
/// itself by the same amount. Where several numbers are wanted the smallest counts, and all are made smaller together by what one still
/// scatters too much, for of causes against each other less of one may be more.
fn may_scatter(quantities: &[Quantity], wanted: &[Option<f64>], scatter: &Scatter) -> Vec<Option<f64>> {
    let wanted: Vec<(&Quantity, f64)> =
        quantities.iter().zip(wanted).filter_map(|(of, wanted)| Some((of, (*wanted)?))).collect();
    let mut may = vec![None; quantities.first().map_or(0, |of| of.gradient.len())];
    for (of, wanted) in &wanted {
        let most = of.gradient.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
        let by_one = |by: &f64| if by.abs() > NOTHING * most { by.abs().recip() } else { 0.0 };
        let by_one: Vec<f64> = of.gradient.iter().map(by_one).collect();
        let all = scatter.with_deviations(by_one.clone()).deviation(&of.gradient);
        for (may, one) in may.iter_mut().zip(&by_one).filter(|(_, one)| **one > 0.0) {
            let own: f64 = wanted / all * one;
            *may = Some(may.map_or(own, |known: f64| known.min(own)));
        }
    }
    let together = scatter.with_deviations(may.iter().map(|may| may.unwrap_or(0.0)).collect());
    let too_much = wanted.iter().map(|(of, wanted)| together.deviation(&of.gradient) / wanted).fold(1.0, f64::max);
    may.into_iter().map(|may| may.map(|may| may / too_much)).collect()
}

fn told(cause: &Cause, may: Option<f64>, job: &Job<'_>) -> ScatteringCause {
    let shown = |value: f64| units::shown(cause.dimension, value);
    ScatteringCause {
        name: cause.name.clone(),
        kind: match cause.at {
            CausePlace::Setting(at) if job.parameters[at].is_error => CauseKind::Error,
            CausePlace::Setting(_) => CauseKind::Setting,
            CausePlace::Axis(..) => CauseKind::Mounting,
        },
        unit: units::whole_symbol(cause.dimension),
        now: shown(cause.value),
        scatter: shown(cause.scatter),
        may_scatter: may.map(shown),
    }
}

fn too_much(of: &ToleratedResult) -> Option<NotDone> {
    let wanted = of.wanted.filter(|wanted| of.standard_deviation > *wanted)?;
    let ToleratedResult { name, unit, standard_deviation: by, .. } = of;
    let message = format!("not met: {name} scatters by {by:.3} {unit}, more than {wanted} {unit}");
    let way_out = "the column `may scatter` says how far each setting may, if all have the same share".to_string();
    Some(NotDone::new(NotDoneKind::NotMet, name, message).with(vec![way_out]))
}

fn unsolved(sweep: SweptCases, surface: &str) -> Option<NotDone> {
    let lost = sweep.drawn - sweep.solved;
    (lost > 0).then(|| {
        let message = format!(
            "not solved: {lost} of {} random cases, in which a point of {surface} has no foot or a contact is lost; they are left out",
            sweep.drawn
        );
        NotDone::new(NotDoneKind::NotSolved, surface, message)
    })
}

/// A number of which random cases show something else.
fn not_linear(of: &ToleratedResult, cases: usize) -> Option<Remark> {
    let (swept, linear, count) = (of.swept?, of.standard_deviation, cases as f64);
    let mean = swept.mean.abs() > DIFFERENT * linear / count.sqrt();
    let spread = (swept.standard_deviation - linear).abs() > DIFFERENT * linear / (2.0 * (count - 1.0)).sqrt();
    let is_shown = swept.mean.abs().max(swept.standard_deviation) >= SHOWN;
    (is_shown && (mean || spread)).then(|| {
        let message = format!(
            "{}: over {cases} random cases the mean is {:.4} and the standard deviation {:.4} {}, the linear numbers are 0 and {linear:.4}: \
             over these tolerances it is not proportional to them",
            of.name, swept.mean, swept.standard_deviation, of.unit
        );
        Remark::new(RemarkKind::NotLinear, &of.name, message)
    })
}

/// Causes that were named and change nothing.
fn idle(results: &[ToleratedResult], causes: &[Cause], request: &ToleranceRequest) -> Vec<Remark> {
    let most = |of: &ToleratedResult| of.changes.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
    let is_idle = |k: &usize| results.iter().all(|of| of.changes[*k].abs() <= NOTHING * most(of));
    let idle = (0..causes.len()).filter(|k| !request.scatter.is_empty() && is_idle(k));
    let remark = |k: usize| {
        let name = &causes[k].name;
        Remark::new(RemarkKind::MovesNothing, name, format!("`{name}` changes none of the results"))
    };
    idle.map(remark).collect()
}

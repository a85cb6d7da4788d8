//! The settings that a fit may change.

use flank_chain_dsl::{Dimension, Job, Parameter, ValueSource};
use flank_solver::{Range, ScaledUnknown};

use crate::project::failure::Failure;
use crate::project::requests::ToleratedAmount;
use crate::project::units;
use crate::solve::sensitivity::usual_change;

/// The scale of a setting in changes that are usual: 0.1 mm, 10 arcminutes, a hundredth of the value.
const USUAL_CHANGES: f64 = 10.0;
/// The share of the value ...
const SHARE: f64 = 0.01;
/// ... of what moves the flank by less than this with usual changes, mm.
const HARDLY: f64 = 1e-4;
/// What a change by the scale of a number that is almost zero moves the flank by, mm.
const SHOWS: f64 = 1e-2;

/// The settings that are named, or all that the job gives a value; in the order of the job.
///
/// # Errors
/// If there is none of a name, it is a count, or named twice.
pub(in crate::compare) fn open<'j, 'g>(job: &'j Job<'g>, vary: &[String]) -> Result<Vec<&'j Parameter<'g>>, Failure> {
    if vary.is_empty() {
        let is_given = |of: &&Parameter<'_>| !of.is_count && !matches!(of.given_by, ValueSource::Definition(_));
        return Ok(job.parameters.iter().filter(is_given).collect());
    }
    let named = vary.iter().map(|name| find(job, name)).collect::<Result<Vec<usize>, Failure>>()?;
    if let Some(k) = (1..named.len()).find(|k| named[..*k].contains(&named[*k])) {
        let name = &vary[k];
        return Err(Failure::Request(format!("option `vary` names `{name}` twice: leave one of them out")));
    }
    Ok(job.parameters.iter().enumerate().filter(|(k, _)| named.contains(k)).map(|(_, of)| of).collect())
}

/// By its whole name, or by its last part where no other setting has that.
///
/// # Errors
/// If there is none of that name, several end with it, or it is a count.
pub(in crate::compare) fn find(job: &Job<'_>, name: &str) -> Result<usize, Failure> {
    let own = name.strip_prefix(&format!("{}.", job.name)).unwrap_or(name);
    let all = || job.parameters.iter().enumerate();
    let whole = all().find(|(_, of)| of.name == own);
    let is_last = |of: &Parameter<'_>| of.name.rsplit('.').next() == Some(own);
    let found: Vec<(usize, &Parameter<'_>)> = match whole {
        Some(one) => vec![one],
        None => all().filter(|(_, of)| is_last(of)).collect(),
    };
    match found[..] {
        [(_, of)] if of.is_count => {
            Err(Failure::Input(format!("`{}` is a whole number: it does not change by a little", of.name)))
        }
        [(k, _)] => Ok(k),
        [] => {
            let known: Vec<String> =
                all().filter(|(_, of)| !of.is_count).map(|(_, of)| format!("`{}`", of.name)).collect();
            Err(Failure::Input(format!("job `{}` has no setting `{name}`; there is: {}", job.name, known.join(", "))))
        }
        _ => {
            let known: Vec<String> = found.iter().map(|(_, of)| format!("`{}`", of.name)).collect();
            Err(Failure::Input(format!("several settings end with `{name}`; say which: {}", known.join(", "))))
        }
    }
}

/// Of each setting the step that it is set in, in mm and radians: the one that is asked for, else that of the spec.
///
/// # Errors
/// If a step is named for a setting that does not vary, twice, or has another unit.
pub(in crate::compare) fn steps(
    settings: &[&Parameter<'_>],
    round: &[(String, ToleratedAmount)],
) -> Result<Vec<Option<f64>>, Failure> {
    let mut asked = vec![None; settings.len()];
    for (name, amount) in round {
        let is_named = |of: &&Parameter<'_>| of.name == *name || of.name.rsplit('.').next() == Some(name);
        let exact = settings.iter().position(|of| of.name == *name);
        let Some(at) = exact.or_else(|| settings.iter().position(is_named)) else {
            return Err(Failure::Input(format!("option `round` names `{name}`, which does not vary")));
        };
        let dimension = settings[at].dimension;
        let step = Some(*amount).filter(|of| !matches!(of, ToleratedAmount::Share(_)));
        let step = step.and_then(|of| of.inside(dimension, settings[at].value)).ok_or_else(|| {
            let unit = units::whole_symbol(dimension);
            let wanted = if unit.is_empty() { "a plain number".to_string() } else { format!("one in {unit}") };
            Failure::Input(format!("option `round {name}`: this step is {wanted}"))
        })?;
        if asked[at].replace(step).is_some() {
            return Err(Failure::Request(format!("option `round` names `{name}` twice: leave one of them out")));
        }
    }
    Ok(asked.into_iter().zip(settings).map(|(asked, of)| asked.or(of.step)).collect())
}

/// A setting as an unknown, within the range that it is said to have. `moved` is what one mm, radian or 1 of it moves the flank by, mm.
/// What hardly moves the flank, as the radius of a blade that is almost straight, has a share of its value as scale; a number, as the curvature
/// of that blade, what shows, if its range is wide enough for that.
pub(in crate::compare) fn unknown(of: &Parameter<'_>, moved: f64) -> ScaledUnknown {
    let (low, high) = of.range.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let (usual, share) = (USUAL_CHANGES * usual_change(of), SHARE * of.value.abs());
    // of what is neither a length nor an angle, such as a curvature that is almost zero, the range says more than the value, and what it does to
    // the flank says most
    let is_number = of.dimension != Dimension::LENGTH && !units::is_angle(of.dimension);
    let of_range = if is_number && moved > 0.0 { (SHARE * (high - low)).min(SHOWS / moved) } else { 0.0 };
    let scale = if usual * moved < HARDLY { usual.max(share).max(of_range) } else { usual };
    ScaledUnknown { start: of.value, scale, range: Range { low, high } }
}

/// Why a setting does nothing, where others of those that vary follow it: they change by themselves then. Empty where none does.
pub(in crate::compare) fn beside(job: &Job<'_>, varied: &[&Parameter<'_>], of: &Parameter<'_>) -> String {
    let known = job.parameters.iter().map(|of| flank_solver::Parameter {
        variable: of.variable,
        definition: of.definition,
        value: of.value,
    });
    let followers = flank_solver::total_derivatives(&known.collect::<Vec<_>>()).unwrap_or_default();
    let at = job.parameters.iter().position(|known| known.name == of.name);
    let followers = at.and_then(|at| followers.into_iter().nth(at)).unwrap_or_default().into_iter();
    let names: Vec<String> = followers
        .map(|(at, _)| &job.parameters[at].name)
        .filter(|name| **name != of.name && varied.iter().any(|varied| varied.name == **name))
        .map(|name| format!("`{name}`"))
        .collect();
    match names.len() {
        0 => String::new(),
        1 => format!(" beside {}, which follows it and varies by itself", names[0]),
        _ => format!(" beside {}, which follow it and vary by themselves", names.join(", ")),
    }
}

/// A setting that stays as it is.
pub(in crate::compare) fn held(of: ScaledUnknown) -> ScaledUnknown {
    ScaledUnknown { range: Range { low: of.start, high: of.start }, ..of }
}

/// A change with its unit, to three digits: `0.1 mm`.
pub(super) fn change(dimension: Dimension, value: f64) -> String {
    let shown = units::shown(dimension, value);
    let rounded: f64 = format!("{shown:.2e}").parse().unwrap_or(shown);
    format!("{rounded} {}", units::whole_symbol(dimension)).trim_end().to_string()
}

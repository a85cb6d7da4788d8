//! Whether a contact is what was wanted, and what speaks against it.

use std::path::Path;

use flank_chain_dsl::WantedContact;
use flank_export::fixed;
use flank_solver::{ContactPoint, ContactState, Outcome, SearchEnd, SynthesizedContact, opposed};

use super::conditions::{beyond, off_the_tooth};
use super::result::SynthesisResult;
use super::{Checked, Condition, Problem};
use crate::contact::pair::Members;
use crate::contact::result::Backlash;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::shown_path;

/// A combination of conditions that settings change by less than this share of what they change others by, they do not change.
const UNMOVED: f64 = 1e-9;
/// Shares of a combination that count.
const SHARE: f64 = 1e-6;

/// Says what is not as it was wanted, and why.
pub(super) fn judge(
    result: &mut SynthesisResult,
    (members, conditions): (&Members<'_, '_>, &[Condition]),
    (problem, found): (&Problem<'_, '_>, &SynthesizedContact),
    checked: Option<&Checked>,
) {
    let name = result.want.clone();
    let mut told = |kind: NotDoneKind, message: String, reasons: Vec<String>| {
        result.not_done.push(NotDone::new(kind, &name, message).with(reasons));
    };
    let unmet: Vec<&str> =
        conditions.iter().filter(|of| !of.is_met_at(&found.vertex)).map(|of| of.of.of.name()).collect();
    let mut reasons = Vec::from_iter(off_the_tooth(members, conditions));
    if !unmet.is_empty() {
        let message = format!("{name} is not met: {}", unmet.join(", "));
        if reasons.is_empty() {
            reasons = why(members, conditions, problem, found);
            reasons.push(others(problem));
        }
        told(NotDoneKind::NotMet, message, reasons);
        return;
    }
    reasons.extend(none_of_flanks(members, &found.vertex));
    if !reasons.is_empty() {
        told(NotDoneKind::NotMet, format!("{name} is met where the flanks do not touch"), reasons);
        return;
    }
    let Some(checked) = checked else { return };
    result.remarks.extend(checked.result.remarks.iter().cloned());
    result.not_done.extend(checked.result.not_done.iter().cloned());
    let is_there =
        |of: &&Condition| checked.vertex.as_ref().and_then(|at| of.value(at)).is_some_and(|value| of.is_met(value));
    let elsewhere: Vec<&str> = conditions.iter().filter(|of| !is_there(of)).map(|of| of.of.of.name()).collect();
    if checked.result.not_done.is_empty() && !elsewhere.is_empty() {
        let message = format!(
            "{name}: the whole contact has its middle elsewhere: {} is not what was found",
            elsewhere.join(", ")
        );
        result.not_done.push(NotDone::new(NotDoneKind::NotMet, &name, message));
    }
}

/// The backlash with the settings that were found, where that is another one: nobody asked for it.
pub(super) fn other_backlash(want: &WantedContact, ends: (Option<&Backlash>, Option<&Backlash>)) -> Option<Remark> {
    let other = match ends {
        (None, None) => return None,
        (Some(now), Some(new)) if (now.normal - new.normal).abs() < SAME_BACKLASH => return None,
        (Some(of), _) | (None, Some(of)) => &of.other,
    };
    let [now, new] = [ends.0, ends.1].map(|of| match of {
        Some(of) => format!("{} mm along the normal", fixed(of.normal, 4)),
        None => "not known".to_string(),
    });
    let message = format!(
        "the backlash to {other}, which {} does not ask for, is {new} with these settings; as the pair is, {now}",
        want.name
    );
    Some(Remark::new(RemarkKind::OtherBacklash, &want.name, message))
}

/// A change of backlash by less, mm, is none.
const SAME_BACKLASH: f64 = 1e-4;

/// Whether a vertex is one of the pair at which all conditions hold.
pub(super) fn is_met(members: &Members<'_, '_>, conditions: &[Condition], at: &ContactPoint) -> bool {
    conditions.iter().all(|of| of.is_met_at(at)) && none_of_flanks(members, at).is_empty()
}

/// Whether no settings can make it, however many.
pub(super) fn is_hopeless(members: &Members<'_, '_>, conditions: &[Condition]) -> bool {
    off_the_tooth(members, conditions).is_some()
}

/// Why a spec is not written: its settings do not make what is wanted.
pub(super) fn unwritten(file: &Path) -> String {
    format!(
        "spec: `{}` is not written, since these settings do not make it; option `dry` prints it all the same",
        shown_path(file)
    )
}

/// Which settings were not tried.
fn others(problem: &Problem<'_, '_>) -> String {
    match (&problem.left[..], problem.chosen_of) {
        ([], Some(_)) => {
            "settings: all of the first flank that change it were tried; those of the second flank and of the mounting were not: option `vary` names them"
                .to_string()
        }
        ([], None) => "settings: others than these may bring it: option `vary` names them".to_string(),
        (left, _) => format!("settings: not tried, and it may be met with them by option `vary`: {}", left.join(", ")),
    }
}

/// Why a vertex is no contact of the pair.
fn none_of_flanks(members: &Members<'_, '_>, at: &ContactPoint) -> Vec<String> {
    let mut reasons = Vec::new();
    if at.state == Some(ContactState::Crossing) {
        reasons.push(
            "flanks: they run into each other beside the point: their gap is bent the wrong way along one direction"
                .to_string(),
        );
    }
    let section = |member: usize| {
        let [x, y, z] = at.in_members[member];
        [z, x.hypot(y)]
    };
    for member in [0, 1] {
        if let Some((edge, off)) = beyond(members, member, section(member)) {
            let name = &members.surfaces[member].name;
            reasons.push(format!("place: the tooth ends before it: it lies {off:.3} mm beyond the {edge} of {name}"));
        }
    }
    if let Outcome::Outside { unknown, .. } = at.outcome {
        let own = members.surfaces.iter().flat_map(|surface| surface.unknowns.iter().map(|of| &of.name));
        let name = own.chain([&members.contact.lag.name]).nth(unknown);
        let told = |name: &String| {
            format!(
                "range: `{name}` would have to leave its range: widen it where the tool or the mounting allows that"
            )
        };
        reasons.extend(name.map(told));
    }
    reasons
}

/// Why conditions are not met.
fn why(
    members: &Members<'_, '_>,
    conditions: &[Condition],
    problem: &Problem<'_, '_>,
    found: &SynthesizedContact,
) -> Vec<String> {
    let mut reasons = unmoved(conditions, problem);
    let bound = problem.settings.iter().zip(&found.fit.held).enumerate();
    let bound = bound.filter(|(k, (_, held))| held.is_some() && !problem.is_rounded(*k)).map(|(_, (of, _))| of);
    let bound: Vec<&str> = bound.map(|of| of.name.as_str()).collect();
    if !bound.is_empty() {
        reasons.push(format!("bounds: {} stands at the end of its range", bound.join(", ")));
    }
    if (0..problem.settings.len()).any(|k| problem.is_rounded(k)) {
        reasons.push("steps: settings that are multiples of their steps come no nearer".to_string());
    }
    let is_told = !reasons.is_empty();
    // steps stand in the way of what is possible without
    if !(0..problem.settings.len()).any(|k| problem.is_rounded(k)) {
        reasons.extend(against(conditions, problem));
    }
    reasons.extend(compromise(conditions, found));
    if !is_told {
        reasons.extend((0..conditions.len()).filter_map(|k| yielding(conditions, problem, found, k)));
        if let Some((share, at)) = &found.way {
            let share = 100.0 * share;
            reasons.push(format!(
                "way: from what the contact is, all of it together is met up to {share:.1} % of the way to what is wanted; there the search ended"
            ));
            reasons.extend(none_of_flanks(members, at));
        }
    }
    if found.fit.end != SearchEnd::Settled {
        reasons.push(
            "search: it came to no end, and ended at what is told as reached: whether more of it can be met is not known".to_string(),
        );
    }
    if reasons.is_empty() {
        reasons.push("settings: these come no nearer to all of it together".to_string());
    }
    reasons
}

/// Which conditions stand against each other; where flanks end is told by itself.
fn against(conditions: &[Condition], problem: &Problem<'_, '_>) -> Option<String> {
    if conditions.len() < 2 {
        return None;
    }
    let are_met = |of: &[usize], at: &ContactPoint| of.iter().all(|k| conditions[*k].is_met_at(at));
    let names: Vec<&str> = problem.against(are_met).into_iter().map(|k| conditions[k].of.of.name()).collect();
    Some(match names[..] {
        [one] => format!("against: no search meets {one} with these settings, even where nothing else is wanted"),
        [one, other] => format!("against: {one} and {other}: each is met without the other, and no search meets both"),
        _ => format!(
            "against: {}: without any one of them the others are met, and no search meets all of them",
            names.join(", ")
        ),
    })
}

/// How far off each condition is with the settings that come nearest to all.
fn compromise(conditions: &[Condition], found: &SynthesizedContact) -> Option<String> {
    if conditions.len() < 2 || found.fit.end != SearchEnd::Settled {
        return None;
    }
    let off = |of: &Condition| {
        let value = of.value(&found.vertex)?;
        let apart = of.shown(of.apart(value));
        let shown = format!("{} {apart:+.6} {}", of.of.of.name(), of.unit());
        (!of.is_met(value)).then(|| shown.trim_end().to_string())
    };
    let off: Vec<String> = conditions.iter().filter_map(off).collect();
    Some(format!("least squares: nearest to all of it these settings leave {}", off.join(", ")))
}

/// Conditions that the settings do not change, one by one or together.
fn unmoved(conditions: &[Condition], problem: &Problem<'_, '_>) -> Vec<String> {
    let told = opposed(&problem.effects(), UNMOVED).into_iter().map(|shares| {
        let most = shares.iter().fold(0.0, |most: f64, share| most.max(share.abs()));
        // residuals are of one size, so that a small part in a combination is one all the same
        let takes_part = |k: &usize| shares[*k].abs() > SHARE * most;
        let names: Vec<&str> = (0..conditions.len()).filter(takes_part).map(|k| conditions[k].of.of.name()).collect();
        match names[..] {
            [one] => format!("rank: none of these settings changes {one}"),
            _ => format!(
                "rank: these settings change {} together only: more of them with option `vary` may",
                names.join(" and ")
            ),
        }
    });
    told.collect()
}

/// What one condition could be if all others hold: where the search for that came to an end of it which is no farther off than what was
/// reached.
fn yielding(
    conditions: &[Condition],
    problem: &Problem<'_, '_>,
    found: &SynthesizedContact,
    k: usize,
) -> Option<String> {
    let of = &conditions[k];
    let nearest = problem.nearest(k, found)?;
    let others: Vec<&Condition> = (0..conditions.len()).filter(|other| *other != k).map(|k| &conditions[k]).collect();
    let hold = |at: &ContactPoint| others.iter().all(|of| of.is_met_at(at));
    let value = of.value(&nearest).filter(|value| hold(&nearest) && !of.is_met(*value))?;
    let reached = of.value(&found.vertex).filter(|_| hold(&found.vertex));
    let is_farther = |reached: f64| of.off(value) > of.off(reached) * (1.0 + SHARE);
    if reached.is_some_and(is_farther) {
        return None;
    }
    let shown = |value: f64| format!("{:.4} {}", of.shown(value), of.unit()).trim_end().to_string();
    let with = if others.is_empty() { "" } else { "with all else as it is wanted " };
    Some(format!("{}: {with}it comes to {}, not to {}", of.of.of.name(), shown(value), shown(of.of.value)))
}

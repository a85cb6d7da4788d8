//! What the target cannot do, in words.

use flank_chain_dsl::{Axis, Machine, RangedVariable};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Missing, Outcome, Posture};

use super::Conversion;
use super::source::Source;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::units;

/// Of what all axes can do together: below it they turn fast.
const NEARLY_SINGULAR: f64 = 1e-3;

/// An orientation that is missed by less (rad) is met: the angle comes from the cosine, with the root of its rounding.
const TURNED: f64 = 1e-6;

/// Of a pose: three displacements, three turns.
const FREEDOMS: usize = 6;

/// Whether there are as many axes as things that move by themselves.
///
/// # Errors
/// In words, if there are fewer.
pub(super) fn check_count(
    machine: &Machine<'_>,
    motions: &[&RangedVariable<'_>],
    free: &[&Axis<'_>],
) -> Result<(), String> {
    let names = |names: Vec<&str>, join: &str| names.join(join);
    let moving = names(motions.iter().map(|motion| motion.name.as_str()).collect(), " and ");
    let axes = names(free.iter().map(|axis| axis.name.as_str()).collect(), ", ");
    match (free.len(), motions.len()) {
        (0, _) => Err(format!(
            "no axis of {} moves the tool against the work: all are fixed, coupled, or elsewhere; {moving} cannot be followed",
            machine.name
        )),
        (few, many) if few < many => Err(format!(
            "the job runs over {moving}, each by itself, and {} has only {axes} to follow: it needs at least {many} free axes",
            machine.name
        )),
        _ => Ok(()),
    }
}

/// What the target cannot do, each kind once with its first place.
pub(super) fn told(carried: &Conversion<'_, '_>) -> Vec<NotDone> {
    let Conversion { positions, line, source, .. } = carried;
    let mut kinds: Vec<(String, String, usize)> = Vec::new();
    for (k, (position, posture)) in positions.iter().zip(line).enumerate() {
        let (kind, told) = match (posture.outcome, posture.missing) {
            (Outcome::Solved, None) => continue,
            (Outcome::Outside { .. }, _) => beyond(carried, posture),
            (Outcome::Solved, Some(missing)) => lacking(carried, missing),
            (outcome, _) => {
                let before = k.checked_sub(1).map(|k| (&positions[k], &line[k]));
                let near = before.filter(|(_, posture)| posture.outcome == Outcome::Solved);
                let (at, near) = near.unwrap_or((position, posture));
                undefined(carried, position)
                    .or_else(|| misdirected(carried, position))
                    .unwrap_or_else(|| lost(carried, outcome == Outcome::Singular, near, at))
            }
        };
        match kinds.iter_mut().find(|(known, ..)| *known == kind) {
            Some((.., count)) => *count += 1,
            None => kinds.push((kind, format!("{told}, at {}", source.place(position)), 1)),
        }
    }
    let message = |told: &str, count: usize| format!("not reached: {count} of {} positions: {told}", line.len());
    let name = &carried.machine.name;
    let each = kinds.iter();
    each.map(|(_, told, count)| NotDone::new(NotDoneKind::NotReached, name, message(told, *count))).collect()
}

/// All axes that have to stand beyond their travels, the farthest beyond, as a share of its travel, first.
fn beyond(carried: &Conversion<'_, '_>, posture: &Posture) -> (String, String) {
    let farthest = carried.problem.beyond(&posture.axes);
    let mut kind: Vec<&str> = farthest.iter().map(|(k, _)| carried.free[*k].name.as_str()).collect();
    kind.sort_unstable();
    let kind = format!("beyond {}", kind.join(", "));
    let told = farthest.iter().map(|&(k, by)| {
        let axis = carried.free[k];
        let [at, by] = [posture.axes[k], by].map(|x| units::text(axis.dimension, x, 4));
        let radius = tool_radius(&carried.source).filter(|_| !units::is_angle(axis.dimension));
        let radius =
            radius.map_or(String::new(), |radius| format!(" (the tool cuts at a radius of up to {radius:.3} mm)"));
        format!("axis {}.{} has to stand at {at}, {by} beyond its travel{radius}", carried.machine.name, axis.name)
    });
    let told: Vec<String> = told.collect();
    (kind, told.join("; "))
}

/// The job itself does not say where its tool stands.
fn undefined(carried: &Conversion<'_, '_>, position: &[f64]) -> Option<(String, String)> {
    let Source { driven, motions, work, tool, .. } = &carried.source;
    let pose = driven.substituted(&carried.bindings).pose();
    let rows = pose.rotation.0.into_iter().chain([pose.translation]);
    let numbers: Vec<Expr<'_>> = rows.flat_map(|row| row.0).collect();
    let inputs: Vec<Expr<'_>> = motions.iter().map(|motion| motion.variable).collect();
    let tape = Tape::new(&numbers, &inputs).ok()?;
    let mut values = vec![0.0; numbers.len()];
    ScalarEvaluator::new(&tape).run(position, &mut values);
    let told = format!(
        "where {tool} stands against {work} is no number: an axis of the job is driven by what is not defined there; let the motion \
         run, or sample the flank, where it is"
    );
    (!values.iter().all(|x| x.is_finite())).then(|| ("undefined".to_string(), told))
}

/// The orientation of the tool is one that the rotary axes do not reach.
fn misdirected(carried: &Conversion<'_, '_>, position: &[f64]) -> Option<(String, String)> {
    let (missed, turning) = carried.problem.turn_missed(position).ok().filter(|(missed, _)| *missed > TURNED)?;
    let is_round = carried.source.symmetries.iter().any(|screw| screw.angular != [0.0; 3]);
    let what = if is_round { "axis" } else { "frame" };
    let name = &carried.machine.name;
    let missed = format!("{:.4} deg", missed.to_degrees());
    let told = match turning.iter().map(|&k| carried.free[k].name.as_str()).collect::<Vec<_>>().join(", ") {
        axes if axes.is_empty() => format!("{name} does not turn the tool, and its {what} lies {missed} off"),
        axes => format!("the tool's {what} cannot point there: {missed} are missing, wherever {axes} of {name} stand"),
    };
    Some(("misdirected".to_string(), told))
}

fn lacking(carried: &Conversion<'_, '_>, missing: Missing) -> (String, String) {
    let line = ["x", "y", "z"][missing.direction % 3];
    let what = if missing.direction < 3 {
        format!("along the tool's own {line} axis, {:.6} mm are missing", missing.by.abs())
    } else {
        format!("about the tool's own {line} axis, {:.6} deg are missing", missing.by.to_degrees().abs())
    };
    (
        format!("missing {}", missing.direction),
        format!("{} has no axis that moves the tool {what}", carried.machine.name),
    )
}

fn lost(carried: &Conversion<'_, '_>, is_singular: bool, near: &Posture, at: &[f64]) -> (String, String) {
    let name = &carried.machine.name;
    let freedoms = carried.problem.unknowns().len();
    if freedoms < FREEDOMS {
        let unseen = match freedoms - carried.free.len() {
            0 => String::new(),
            slips => format!(" and {slips} of motions that leave the tool unchanged"),
        };
        let told = format!(
            "a pose has {FREEDOMS} freedoms, and {name} has {} of axes{unseen}: no posture was found",
            carried.free.len()
        );
        return ("few".to_string(), told);
    }
    let (size, axes) = carried.problem.weakest(near, at);
    let alike: Vec<&str> = axes.iter().map(|&k| carried.free[k].name.as_str()).collect();
    let alike = match alike[..] {
        [one] => format!("{one} can move without moving the tool"),
        _ => format!("{} can move together without moving the tool", alike.join(", ")),
    };
    if is_singular {
        ("singular".to_string(), format!("{name} stands in a singular pose: {alike}"))
    } else if size < NEARLY_SINGULAR {
        (
            "nearly singular".to_string(),
            format!("{name} passes near a singular pose, where {alike}, and its axes do not follow"),
        )
    } else {
        ("lost".to_string(), format!("no posture of {name} was found"))
    }
}

/// The largest distance of the tool's points that touch the flank from its axis of symmetry, mm.
fn tool_radius(source: &Source<'_, '_>) -> Option<f64> {
    let turn = source.symmetries.iter().find(|screw| screw.angular != [0.0; 3])?;
    source.flanks.iter().filter_map(|flank| flank.tool_radius(turn)).reduce(f64::max)
}

//! V, H and J: the mounting on a rolling tester that brings a contact elsewhere.

use flank_chain_dsl::Job;
use flank_solver::{ContactPoint, ContactProblem};
use nalgebra::{DMatrix, DVector};

use crate::contact::pair::Members;
use crate::contact::place::{dot, shares};
use crate::contact::result::VhjRow;
use crate::contact::rolling::Rolling;
use crate::project::remark::{Remark, RemarkKind};
use crate::project::units;

/// Where the contact is brought to, as a share of the flank from toe to heel.
const PLACES: [(&str, f64); 3] = [("toe", 0.2), ("middle", 0.5), ("heel", 0.8)];
/// Axes of a rolling tester: the offset V, the pinion's and the gear's cone distances H and J.
const AXES: [&str; 3] = ["E", "P", "G"];
/// Steps from the contact as mounted to each place, and Newton's steps at each of them.
const STEPS: u32 = 10;
const MOST_STEPS: usize = 20;
/// A place is reached within this share of the flank, and the unknown within so much of what it was.
const REACHED: f64 = 1e-9;
/// The unknown is followed at least so far beyond its range, rad or mm.
const FREE: f64 = 0.5;
/// A value that is beyond its range by less than this share of it is not: rounding.
const ROUNDING: f64 = 1e-9;

/// A contact at the vertex of its error, with the mounting at which it is there.
type Mounted = (ContactPoint, Vec<f64>);

/// Mountings that bring the middle to toe, middle and heel of the second flank without moving it between root and tip: with the offset and
/// the pinion alone, and with the gear too so that the unknown stays what it is. None where the pair's machine has no axes of these
/// names, or the flank's sample is not one of shares.
pub(crate) fn vhj<'g>(job: &Job<'g>, members: &Members<'_, 'g>, errors: &[f64], rolling: &Rolling) -> Vec<VhjRow> {
    let [v_and_h, with_j] = [2, 3].map(|count| rows(job, members, errors, rolling, &AXES[..count]));
    v_and_h.into_iter().chain(with_j).collect()
}

/// Why a contact has no such mountings, if they were asked for and it has none.
pub(crate) fn nothing(members: &Members<'_, '_>, rolling: &Rolling) -> Remark {
    let contact = members.contact;
    let has = |name: &&str| contact.errors.iter().any(|axis| axis.name.rsplit('.').next() == Some(name));
    let missing: Vec<&str> = AXES[..2].iter().copied().filter(|name| !has(name)).collect();
    let why = match (&missing[..], &rolling.vertex) {
        ([], None) => "its error is extreme nowhere".to_string(),
        ([], Some(_)) => format!(
            "the sample of {} is not one of the shares `profilewise` and `lengthwise` between the corners of its blank",
            members.surfaces[1].name
        ),
        (missing, _) => {
            let missing: Vec<String> = missing.iter().map(|name| format!("`{name}`")).collect();
            format!("its machine has no mounting error {}", missing.join(" and no "))
        }
    };
    let message = format!("contact {}: no offsets of a rolling tester are told: {why}", contact.name);
    Remark::new(RemarkKind::NotLookedAt, &contact.name, message)
}

fn rows<'g>(
    job: &Job<'g>,
    members: &Members<'_, 'g>,
    errors: &[f64],
    rolling: &Rolling,
    names: &[&str],
) -> Vec<VhjRow> {
    let axes = &members.contact.errors;
    let place = |name: &&str| axes.iter().position(|axis| axis.name.rsplit('.').next() == Some(name));
    let Some(open) = names.iter().map(place).collect::<Option<Vec<usize>>>() else { return Vec::new() };
    let Some(vertex) = rolling.vertex.clone() else { return Vec::new() };
    let Some([profilewise, lengthwise]) = share_of(members, &vertex) else { return Vec::new() };
    let mut pair = members.pair(job, errors, &open);
    // the pair of teeth is known: it is followed wherever the mounting takes it
    let free = (pair.lag.1.high - pair.lag.1.low).max(FREE);
    (pair.lag.1.low, pair.lag.1.high) = (pair.lag.1.low - free, pair.lag.1.high + free);
    let problem = ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound");
    let mounting = |share: f64| {
        let mut mounted = (vertex.clone(), open.iter().map(|at| errors[*at]).collect::<Vec<f64>>());
        for step in 1..=STEPS {
            let lengthwise = lengthwise + (share - lengthwise) * f64::from(step) / f64::from(STEPS);
            mounted = brought(members, &problem, mounted, [profilewise, lengthwise, vertex.lag])?;
        }
        Some(mounted)
    };
    let row = |(name, share): (&str, f64)| {
        let (at, errors) = mounting(share).unzip();
        VhjRow {
            to: name.to_string(),
            lengthwise: share,
            profilewise,
            axes: open.iter().map(|at| axes[*at].name.clone()).collect(),
            errors,
            beyond: at.map_or(Vec::new(), |at| beyond(members, &at)),
        }
    };
    PLACES.into_iter().map(row).collect()
}

/// What a contact would have beyond its range: the unknown that it determines, with its value, and those of the flanks.
fn beyond(members: &Members<'_, '_>, at: &ContactPoint) -> Vec<String> {
    let lag = &members.contact.lag;
    let is_beyond =
        |at: f64, low: f64, high: f64| at < low - ROUNDING * (high - low) || at > high + ROUNDING * (high - low);
    let of_lag = is_beyond(at.lag, lag.low, lag.high)
        .then(|| format!("{} at {}", lag.name, units::text(lag.dimension, at.lag, 4)));
    let of_flank = |k: usize| {
        let (surface, ranges) = (members.surfaces[k], members.bound[k].ranges());
        let outside = (0..ranges.len()).filter(move |i| is_beyond(at.unknowns[k][*i], ranges[*i].low, ranges[*i].high));
        outside.map(move |i| {
            let of = &surface.unknowns[i];
            format!("{} of {} at {}", of.name, surface.name, units::text(of.dimension, at.unknowns[k][i], 4))
        })
    };
    of_lag.into_iter().chain((0..2).flat_map(of_flank)).collect()
}

fn share_of(members: &Members<'_, '_>, point: &ContactPoint) -> Option<[f64; 2]> {
    let [x, y, z] = point.in_members[1];
    shares(members.surfaces[1], [z, x.hypot(y)])
}

/// The vertex at shares of the second flank and, where there are three axes, at an unknown.
fn brought(
    members: &Members<'_, '_>,
    problem: &ContactProblem,
    (mut at, mut values): Mounted,
    target: [f64; 3],
) -> Option<Mounted> {
    let count = values.len();
    for _ in 0..MOST_STEPS {
        let [profilewise, lengthwise] = share_of(members, &at)?;
        let here = [profilewise, lengthwise, at.lag];
        let off = DVector::from_fn(count, |k, _| target[k] - here[k]);
        if off.iter().all(|off| off.abs() < REACHED) {
            return Some((at, values));
        }
        let mounted = problem.with_values(&values);
        let mut by = DMatrix::zeros(count, count);
        for axis in 0..count {
            let change = mounted.change(&at, &[(axis, 1.0)], true)?;
            // over a small step: shares are a smooth function of the place
            let size = 1e-6 / dot(&change.moved[1], &change.moved[1]).sqrt().max(f64::MIN_POSITIVE);
            let mut moved = at.clone();
            (0..3).for_each(|k| moved.in_members[1][k] += size * change.moved[1][k]);
            let there = share_of(members, &moved)?;
            let slopes = [(there[0] - here[0]) / size, (there[1] - here[1]) / size, change.lag];
            (0..count).for_each(|row| by[(row, axis)] = slopes[row]);
        }
        let step = by.full_piv_lu().solve(&off)?;
        values.iter_mut().zip(step.iter()).for_each(|(value, step)| *value += step);
        let mounted = problem.with_values(&values);
        let near = mounted.again(&at, at.roll)?;
        at = mounted.vertex_near(&near)?;
    }
    None
}

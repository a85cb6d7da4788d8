//! What mounting errors do to a contact, and which of them bring it elsewhere.

use flank_chain_dsl::{Contact, Dimension, Job, closest};
use flank_solver::{ContactPoint, ContactProblem};

use crate::contact::pair::Members;
use crate::contact::place::{dot, fine, rows_at, shares};
use crate::contact::result::{MountingInfluence, VhjRow};
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::requests::MountingError;
use crate::project::units;

/// The mounting errors that influences are told for.
const A_LENGTH: f64 = 0.01;
const AN_ANGLE: f64 = std::f64::consts::PI / 180.0 / 60.0;

/// The errors of all axes of the pair's machine: those that are asked for, and none of the others.
///
/// # Errors
/// If one names no axis, or has the unit of another kind of axis.
pub(crate) fn mounting(
    job: &Job<'_>,
    contact: &Contact<'_>,
    asked: &[(String, MountingError)],
) -> Result<Vec<f64>, Failure> {
    let mut errors = vec![0.0; contact.errors.len()];
    for (name, error) in asked {
        let names = || contact.errors.iter().map(|axis| axis.name.as_str());
        let Some(at) = names().position(|axis| axis == name) else {
            let near = closest(name, names()).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            let known = names().collect::<Vec<&str>>().join(", ");
            let (job, contact) = (&job.name, &contact.name);
            return Err(Failure::from(format!(
                "option `error {name}`: the pair of contact `{contact}` of job `{job}` has no such axis; it has {known}{near}"
            )));
        };
        let dimension = contact.errors[at].dimension;
        errors[at] = match error {
            MountingError::Length(mm) if dimension == Dimension::LENGTH => *mm,
            MountingError::Angle(radians) if units::is_angle(dimension) => *radians,
            _ => {
                let wanted = if units::is_angle(dimension) {
                    "an angle, for example 2arcmin"
                } else {
                    "a length, for example 0.1mm"
                };
                return Err(Failure::from(format!("option `error {name}`: this axis takes {wanted}")));
            }
        };
    }
    Ok(errors)
}

/// What each axis of the pair's machine does to the middle, but for those that turn it.
pub(crate) fn of_all<'g>(
    job: &Job<'g>,
    members: &Members<'_, 'g>,
    errors: &[f64],
    rolling: &Rolling,
    compound: f64,
) -> Vec<MountingInfluence> {
    let Some(middle) = rolling.middle() else { return Vec::new() };
    let axes = &members.contact.errors;
    let open: Vec<usize> = (0..axes.len()).collect();
    let pair = members.pair(job, errors, &open);
    let problem = ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound");
    let unknown = members.contact.lag.dimension;
    let influence = |(number, axis): (usize, &flank_chain_dsl::MountingAxis<'_>)| {
        let (unit, per) = match units::is_angle(axis.dimension) {
            true => (AN_ANGLE, "1 arcmin".to_string()),
            false => (A_LENGTH, "0.01 mm".to_string()),
        };
        let change = problem.change(middle, number, rolling.vertex.is_some())?;
        let way = |k: usize| unit * dot(&change.moved[k], &change.moved[k]).sqrt();
        let along = rows_at(members, 1, middle);
        let ellipse = change.gap.zip(middle.gap.as_ref()).map(|([_, by], gap)| -0.5 * unit * by / gap.k2);
        let parabola = middle.lag_slopes[1];
        Some(MountingInfluence {
            axis: axis.name.clone(),
            per,
            moved_mm: [way(0), way(1)],
            along_rows_mm: along.map(|on| [on.lengthwise, on.profilewise].map(|to| unit * dot(&change.moved[1], &to))),
            error: fine(unknown, unit * change.lag),
            parabola: (parabola != 0.0).then(|| unit * change.lag_curvature / parabola),
            ellipse: ellipse.filter(|_| middle.ellipse(compound).is_some()),
            turn: units::shown(members.contact.roll.dimension, unit * change.roll),
        })
    };
    axes.iter().enumerate().filter(|(_, axis)| !axis.is_driven).filter_map(influence).collect()
}

/// Where the contact is brought to, as a share of the flank from toe to heel.
const PLACES: [(&str, f64); 3] = [("toe", 0.2), ("middle", 0.5), ("heel", 0.8)];
/// Axes of a rolling tester: the offset V, the pinion's and the gear's cone distances H and J.
const AXES: [&str; 2] = ["E", "P"];
/// Steps from the contact as mounted to each place, and Newton's steps at each of them.
const STEPS: u32 = 10;
const MOST_STEPS: usize = 20;
/// A place is reached within this share of the flank.
const REACHED: f64 = 1e-9;

/// Mountings along the two axes of a rolling tester that bring the middle to toe, middle and heel of the second flank without moving it
/// between root and tip: none where the pair's machine has no axes E and P, or the flank's sample is not one of shares.
pub(crate) fn vhj<'g>(job: &Job<'g>, members: &Members<'_, 'g>, errors: &[f64], rolling: &Rolling) -> Vec<VhjRow> {
    let axes = &members.contact.errors;
    let place = |name: &str| axes.iter().position(|axis| axis.name.rsplit('.').next() == Some(name));
    let (Some(offset), Some(pinion)) = (place(AXES[0]), place(AXES[1])) else { return Vec::new() };
    let Some(vertex) = rolling.vertex.clone() else { return Vec::new() };
    let open = [offset, pinion];
    let pair = members.pair(job, errors, &open);
    let problem = ContactProblem::new(&pair).expect("a job without errors leaves nothing unbound");
    let Some([profilewise, lengthwise]) = share_of(members, &vertex) else { return Vec::new() };
    let mounting = |share: f64| {
        let (mut at, mut values) = (vertex.clone(), [errors[offset], errors[pinion]]);
        for step in 1..=STEPS {
            let target = [profilewise, lengthwise + (share - lengthwise) * f64::from(step) / f64::from(STEPS)];
            (at, values) = brought(members, &problem, (at, values), target)?;
        }
        Some(values)
    };
    let row = |(name, share): (&str, f64)| VhjRow {
        to: name.to_string(),
        lengthwise: share,
        profilewise,
        axes: open.map(|at| axes[at].name.clone()).to_vec(),
        errors: mounting(share).map(|values| values.to_vec()),
    };
    PLACES.into_iter().map(row).collect()
}

fn share_of(members: &Members<'_, '_>, point: &ContactPoint) -> Option<[f64; 2]> {
    let [x, y, z] = point.in_members[1];
    shares(members.surfaces[1], [z, x.hypot(y)])
}

/// The vertex at shares of the second flank, and the mounting with which it is there.
fn brought(
    members: &Members<'_, '_>,
    problem: &ContactProblem,
    (mut at, mut values): (ContactPoint, [f64; 2]),
    target: [f64; 2],
) -> Option<(ContactPoint, [f64; 2])> {
    for _ in 0..MOST_STEPS {
        let here = share_of(members, &at)?;
        let off = [0, 1].map(|k| target[k] - here[k]);
        if off.iter().all(|off| off.abs() < REACHED) {
            return Some((at, values));
        }
        let mounted = problem.with_values(&values);
        let mut by = [[0.0; 2]; 2];
        for (number, by) in by.iter_mut().enumerate() {
            let change = mounted.change(&at, number, true)?;
            // over a small step: shares are a smooth function of the place
            let size = 1e-6 / dot(&change.moved[1], &change.moved[1]).sqrt().max(f64::MIN_POSITIVE);
            let mut moved = at.clone();
            (0..3).for_each(|k| moved.in_members[1][k] += size * change.moved[1][k]);
            let there = share_of(members, &moved)?;
            *by = [0, 1].map(|k| (there[k] - here[k]) / size);
        }
        let determinant = by[0][0] * by[1][1] - by[1][0] * by[0][1];
        values = [
            values[0] + (off[0] * by[1][1] - off[1] * by[1][0]) / determinant,
            values[1] + (off[1] * by[0][0] - off[0] * by[0][1]) / determinant,
        ];
        let mounted = problem.with_values(&values);
        let near = mounted.again(&at, at.roll)?;
        at = mounted.vertex_near(&near)?;
    }
    None
}

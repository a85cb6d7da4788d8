//! How much a pair can move between the flanks of a tooth.

use flank_chain_dsl::Job;

use crate::contact::law;
use crate::contact::pair::Members;
use crate::contact::result::Backlash;
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::ContactRequest;
use crate::project::session::Session;
use crate::project::units;

/// How much the pair can move between this contact and one of the opposite flanks, which moves the same unknown the other way; what that is not
/// told for, where the opposite contact is not sound.
///
/// # Errors
/// If a flank is not sampled, or the work is cancelled.
pub(crate) fn of(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    request: &ContactRequest,
    errors: &[f64],
    rolling: &Rolling,
    session: Session,
) -> Result<(Option<Backlash>, Vec<NotDone>), Failure> {
    let own = members.contact;
    let nothing = (None, Vec::new());
    let Some(middle) = rolling.middle().filter(|_| rolling.has_pitch) else { return Ok(nothing) };
    let others = job.contacts.iter().filter(|other| {
        other.name != own.name && other.roll.variable == own.roll.variable && other.lag.variable == own.lag.variable
    });
    for other in others {
        let mut of_other = Members::solved(job, other, session)?;
        let Ok(opposite) = Rolling::of_members(job, &mut of_other, errors, request.positions as usize) else {
            continue;
        };
        let is_opposite = opposite.middle().is_some_and(|point| point.opening * middle.opening < 0.0);
        if !is_opposite || !opposite.has_pitch {
            continue;
        }
        let opposite = opposite.closely(&of_other);
        if !is_sound(job, &of_other, &opposite) {
            let (name, other) = (&own.name, &other.name);
            let message =
                format!("contact {name}: the backlash to {other} is not told: that contact is not found all the way");
            let way = format!("contact {other} by itself says what it lacks");
            return Ok((
                None,
                vec![NotDone::new(NotDoneKind::NotSolved, &members.surfaces[0].name, message).with(vec![way])],
            ));
        }
        let room = |roll: f64| {
            let [here, there] = [rolling.lag_at(roll)?, opposite.lag_at(roll)?];
            Some(((there - here) * middle.opening.signum(), roll))
        };
        let looked_at = rolling.looked_at();
        let rolls = rolling.steps_of(looked_at).map(|step| rolling.roll_of(looked_at, step));
        let least = rolls.filter_map(room).min_by(|a, b| a.0.total_cmp(&b.0));
        let told = least.map(|(room, roll)| Backlash {
            other: other.name.clone(),
            least: units::shown(own.lag.dimension, room),
            turn: units::shown(own.roll.dimension, roll),
            normal: room * middle.opening.abs(),
        });
        return Ok((told, Vec::new()));
    }
    Ok(nothing)
}

/// Whether a contact is known at all of its positions: on its flanks, with nothing that comes together before, and by the right law.
fn is_sound(job: &Job<'_>, members: &Members<'_, '_>, rolling: &Rolling) -> bool {
    rolling.outside() == 0 && rolling.looked_at().missed.is_empty() && law::broken(job, members, rolling).is_none()
}

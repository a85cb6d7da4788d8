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

/// Less than this along the normal, mm, is no rounding: both sides of a tooth reach into the mate.
const JAMS: f64 = -1e-7;

/// The opposite contact, against which the pair can move.
pub(crate) struct Opposite {
    name: String,
    rolling: Rolling,
    /// Of the contact itself, in which direction of the unknown it opens, and by how much along the normal, mm per its unit.
    opening: f64,
}

/// The backlash with the contact that it is told to, if there is one, and what is not told or not sound.
type Found = (Option<(Backlash, Opposite)>, Vec<NotDone>);

impl Opposite {
    /// How far the unknown can move at a roll position from where the contact has it.
    fn room(&self, rolling: &Rolling, roll: f64) -> Option<f64> {
        let [here, there] = [rolling.lag_at(roll)?, self.rolling.lag_at(roll)?];
        Some((there - here) * self.opening.signum())
    }

    fn told(&self, members: &Members<'_, '_>, (room, roll): (f64, f64)) -> Backlash {
        let own = members.contact;
        Backlash {
            other: self.name.clone(),
            least: units::shown(own.lag.dimension, room),
            turn: units::shown(own.roll.dimension, roll),
            normal: room * self.opening.abs(),
        }
    }

    /// The least backlash over the pitch, where one flank is higher: by so much of the unknown the pair is ahead at roll positions.
    pub(crate) fn least_ahead(
        &self,
        members: &Members<'_, '_>,
        rolling: &Rolling,
        ahead: impl Iterator<Item = (f64, f64)>,
    ) -> Option<Backlash> {
        let rooms = ahead.filter_map(|(roll, ahead)| Some((self.room(rolling, roll)? - ahead, roll)));
        rooms.min_by(|a, b| a.0.total_cmp(&b.0)).map(|least| self.told(members, least))
    }
}

impl Backlash {
    /// That the pair does not go together.
    pub(crate) fn missed(&self, members: &Members<'_, '_>, how: &str) -> Option<NotDone> {
        let (name, other) = (&members.contact.name, &self.other);
        let normal = units::length(self.normal);
        let message = format!(
            "contact {name}{how}: the backlash to {other} is negative, {normal} along the normal: both sides of a tooth reach into the mate"
        );
        let way = "make teeth thinner, or mount the pair farther apart".to_string();
        (self.normal < JAMS)
            .then(|| NotDone::new(NotDoneKind::Penetration, &members.surfaces[0].name, message).with(vec![way]))
    }
}

/// How much the pair can move between this contact and one of the opposite flanks, which moves the same unknown the other way, with that; what that
/// is not told for, where the opposite contact is not sound, or that there is none.
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
) -> Result<Found, Failure> {
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
        let opposite = Opposite { name: other.name.clone(), rolling: opposite, opening: middle.opening };
        let looked_at = rolling.looked_at();
        let rolls = rolling.steps_of(looked_at).map(|step| rolling.roll_of(looked_at, step));
        let rooms = rolls.filter_map(|roll| Some((opposite.room(rolling, roll)?, roll)));
        let least = rooms.min_by(|a, b| a.0.total_cmp(&b.0));
        let told = least.map(|least| opposite.told(members, least));
        let missed = told.iter().filter_map(|told| told.missed(members, "")).collect();
        return Ok((told.map(|told| (told, opposite)), missed));
    }
    Ok(nothing)
}

/// Whether a contact is known at all of its positions: on its flanks, with nothing that comes together before, and by the right law.
fn is_sound(job: &Job<'_>, members: &Members<'_, '_>, rolling: &Rolling) -> bool {
    rolling.outside() == 0 && rolling.looked_at().missed.is_empty() && law::broken(job, members, rolling).is_none()
}

//! Whether the law of a pair is one with which its teeth pass each other.

use flank_chain_dsl::Job;
use flank_export::fixed;
use flank_solver::ContactPoint;

use crate::contact::pair::Members;
use crate::contact::rolling::Rolling;
use crate::project::remark::{NotDone, NotDoneKind};

/// A slope of the lag that changes by less than this share is that of a ratio.
const EVEN: f64 = 0.1;

/// How the flanks turn the members where they touch, against the law and the numbers of teeth: `None` where all of them belong together, as
/// far as they are known. A ratio is another one where a tooth more or less of the larger member would suit it better.
pub(crate) fn broken(job: &Job<'_>, members: &Members<'_, '_>, rolling: &Rolling) -> Option<NotDone> {
    let [Some(first), Some(second)] = members.solids else { return None };
    let teeth = [first, second].map(|solid| f64::from(solid.teeth));
    let one_tooth = 0.5 / teeth[0].max(teeth[1]);
    let slope = slope(rolling)?;
    let [of_roll, of_lag] = members.turns(job, 0.5);
    let ratio = |slope: f64| {
        let [a, b] = [0, 1].map(|k| of_roll[k] + slope * of_lag[k]);
        b / a
    };
    let (law, found) = (ratio(0.0), ratio(slope));
    let is_alike = |a: f64, b: f64| (a / b - 1.0).abs() < one_tooth;
    if is_alike(law, found) || !law.is_finite() || !found.is_finite() {
        return None;
    }
    let [surface, _] = members.surfaces.map(|surface| &surface.name);
    let name = &members.contact.name;
    let ratios =
        format!("as they touch, the flanks turn {} by {} for a turn of {}", second.name, fixed(found, 6), first.name);
    let message = if is_alike(found.abs(), teeth[0] / teeth[1]) {
        format!(
            "contact {name}: the law of {} does not carry a tooth of {} ({}) on while one of {} ({}) passes: {ratios}, the law turns it by {}",
            second.name,
            second.name,
            second.teeth,
            first.name,
            first.teeth,
            fixed(law, 6)
        )
    } else {
        format!(
            "contact {name}: the flanks are not those of {} teeth of {} and {} of {}: {ratios}",
            first.teeth, first.name, second.teeth, second.name
        )
    };
    let way = if is_alike(found, -law) {
        "give the ratio of the law the other sign".to_string()
    } else if is_alike(found.abs(), teeth[0] / teeth[1]) {
        format!("its ratio is {} / {}; what is told of the error goes with a wrong one", first.teeth, second.teeth)
    } else {
        "the `spaces` of a solid are the teeth with which its flank was cut, and the ratio of the law follows them"
            .to_string()
    };
    Some(NotDone::new(NotDoneKind::NotMet, surface, message).with(vec![way]))
}

/// How the lag changes with the roll where the flanks touch, if it does so evenly from a begin to an end within the roll: an error that has an
/// extreme, or bends, is one of flanks that are not conjugate.
fn slope(rolling: &Rolling) -> Option<f64> {
    let engagement = &rolling.engagement;
    if rolling.vertex.is_some() || engagement.is_whole != [true; 2] {
        return None;
    }
    let flank = || engagement.points.iter().filter(|point: &&ContactPoint| point.is_of_flanks());
    let (begin, end) = (flank().next()?, flank().next_back()?);
    let slope = (end.lag - begin.lag) / (end.roll - begin.roll);
    let bend = (end.lag_slopes[0] - begin.lag_slopes[0]).abs();
    (end.roll > begin.roll && bend < EVEN * slope.abs()).then_some(slope)
}

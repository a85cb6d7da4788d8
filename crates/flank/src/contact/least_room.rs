//! The least of what is known of a place at some roll positions, also between them.

/// Golden sections of the way from one roll position to the next but one: to 1e-6 of it, where also a kink is as exact as room is told.
const SECTIONS: usize = 28;

/// The least of a place over the roll, and where: of its rooms at roll positions, and between those that are next to the least ones where it may be
/// less than what is known.
pub(super) fn least_between(
    rolls: &[f64],
    rooms: &[Option<f64>],
    known: Option<(f64, f64)>,
    at: impl Fn(f64) -> Option<f64>,
) -> Option<(f64, f64)> {
    let room = |k: usize| rooms.get(k).copied().flatten();
    let beside = |k: usize| [k.wrapping_sub(1), k + 1].map(room);
    let is_least = |k: &usize| room(*k).is_some_and(|own| beside(*k).into_iter().flatten().all(|other| own <= other));
    let mut least = known;
    for k in (0..rooms.len()).filter(is_least) {
        let Some(own) = room(k) else { continue };
        if least.is_none_or(|(least, _)| own < least) {
            least = Some((own, rolls[k]));
        }
        // between two positions it falls by no more than to the one that is next
        let fall = beside(k).into_iter().flatten().map(|other| other - own).fold(0.0, f64::max);
        if least.is_some_and(|(least, _)| own - fall > least) {
            continue;
        }
        let ends = [k.saturating_sub(1), (k + 1).min(rolls.len() - 1)].map(|k| rolls[k]);
        let found = lowest(ends, |roll| at(roll).unwrap_or(f64::INFINITY));
        if least.is_none_or(|(least, _)| found.0 < least) {
            least = Some(found);
        }
    }
    least
}

/// The least value between two ends and where it is, by golden section.
fn lowest([mut low, mut high]: [f64; 2], at: impl Fn(f64) -> f64) -> (f64, f64) {
    let share = 0.5 * (5f64.sqrt() - 1.0);
    let inner = |low: f64, high: f64| [high - share * (high - low), low + share * (high - low)];
    let mut places = inner(low, high);
    let mut values = places.map(&at);
    for _ in 0..SECTIONS {
        if values[0] <= values[1] {
            high = places[1];
            let next = inner(low, high)[0];
            (places, values) = ([next, places[0]], [at(next), values[0]]);
        } else {
            low = places[0];
            let next = inner(low, high)[1];
            (places, values) = ([places[1], next], [values[1], at(next)]);
        }
    }
    if values[0] <= values[1] { (values[0], places[0]) } else { (values[1], places[1]) }
}

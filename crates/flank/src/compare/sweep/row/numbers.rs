//! The numbers of what is collected, from solved points.

use flank_solver::{Alignment, EaseOff, SurfacePoint};

use super::collected::{EASE_OFF, PLACE, STATUSES};
use crate::compare::map::is_solved;
use crate::contact::family::ContactNumbers;
use crate::project::requests::{ContactRequest, JobSelection, MountingError};
use crate::solve::starts::Asked;

/// Positions of a pitch at which contacts are looked at.
const POSITIONS: u32 = 60;

/// Kinds of lines, in the order of their columns.
const LINES: [&str; 2] = ["singular line", "contact limit"];

/// The points of a surface as the job itself has them, its mean point among them.
pub(super) struct NominalPoints {
    pub(super) asked: Asked,
    pub(super) points: Vec<SurfacePoint>,
}

/// Numbers, and why some are missing.
pub(super) type Numbers = (Vec<Option<f64>>, Option<String>);

/// How many points have which status, and the worst residual of those that are solved.
pub(super) fn point_counts<'p>(points: impl Iterator<Item = &'p SurfacePoint>) -> Numbers {
    let (mut counts, mut worst) = ([0_u32; STATUSES.len()], None::<f64>);
    for point in points {
        let word = point.outcome.word();
        counts.iter_mut().zip(STATUSES).filter(|(_, known)| *known == word).for_each(|(count, _)| *count += 1);
        if is_solved(point) {
            worst = Some(worst.map_or(point.residual, |worst| worst.max(point.residual)));
        }
    }
    let lost = (1..STATUSES.len()).find(|k| counts[*k] > 0).map(|k| STATUSES[k].to_string());
    (counts.iter().map(|count| Some(f64::from(*count))).chain([worst]).collect(), lost)
}

/// How many solved points miss what their samples require.
pub(super) fn missed_count(missed: usize) -> Numbers {
    (vec![Some(missed as f64)], (missed > 0).then(|| "not_as_required".to_string()))
}

/// How many points the lines of each kind have within the ranges.
pub(super) fn line_counts<'p>(lines: impl Iterator<Item = (&'static str, &'p [SurfacePoint])>) -> Numbers {
    let mut counts = [0; LINES.len()];
    for (kind, points) in lines {
        let of_kind = counts.iter_mut().zip(LINES).filter(|(_, known)| *known == kind);
        of_kind.for_each(|(count, _)| *count += points.iter().filter(|point| is_solved(point)).count());
    }
    (counts.iter().map(|count| Some(*count as f64)).collect(), None)
}

/// How far a surface lies off that of the job itself, of which `near` are points at the same places.
pub(super) fn ease_off_numbers(
    compared: &flank_solver::Deviation,
    NominalPoints { asked, points }: &NominalPoints,
    near: &[SurfacePoint],
) -> Numbers {
    let middle = asked.centre.middle();
    let both = points.get(middle).zip(near.get(middle)).filter(|(point, near)| is_solved(point) && is_solved(near));
    let Some(motion) = both.and_then(|(point, near)| compared.motion_to(point.position, near)) else {
        return (vec![None; EASE_OFF.len()], Some("no_deviation".to_string()));
    };
    let off = asked.centre.own(&compared.map(points, near, motion));
    let off: Vec<Option<f64>> = off.into_iter().map(|off| off.map(|mm| 1e3 * mm)).collect();
    let known: Vec<f64> = off.iter().flatten().copied().collect();
    let ease_off = EaseOff::over_lines(&off, asked.centre.lines.each_ref().map(Vec::as_slice));
    let square = known.iter().map(|um| um * um).sum::<f64>() / known.len() as f64;
    let end = |of: fn(f64, f64) -> f64| known.iter().copied().reduce(of);
    let numbers = vec![
        ease_off.map(|of| of.slopes[0]),
        ease_off.map(|of| of.slopes[1]),
        ease_off.map(|of| of.crownings[0]),
        ease_off.map(|of| of.crownings[1]),
        ease_off.map(|of| of.bias),
        (!known.is_empty()).then(|| square.sqrt()),
        end(f64::min),
        end(f64::max),
        Some(turn_deg(compared.alignment(), motion)),
    ];
    let is_whole = known.len() == asked.centre.own(points).iter().filter(|point| is_solved(point)).count();
    (numbers, (!is_whole).then(|| "no_deviation".to_string()))
}

/// What is shifted is not turned.
fn turn_deg(alignment: Alignment, motion: f64) -> f64 {
    match alignment {
        Alignment::Turn => motion.to_degrees(),
        Alignment::Shift => 0.0,
    }
}

/// How far one surface is moved from another, of which `point` is the middle of the grid.
pub(super) fn width_numbers((alignment, motion): (Alignment, f64), point: &SurfacePoint) -> Numbers {
    (vec![Some(turn_deg(alignment, motion)), Some(alignment.arc(point.position) * motion)], None)
}

/// The ends of both principal curvatures of points.
pub(super) fn curvature_numbers(points: &[SurfacePoint], principal: impl Iterator<Item = [f64; 2]>) -> Numbers {
    let mut ends = [[None; 2]; 2];
    for both in principal {
        for ([low, high], k) in ends.iter_mut().zip(both).filter(|(_, k)| k.is_finite()) {
            *low = Some(low.map_or(k, |low: f64| low.min(k)));
            *high = Some(high.map_or(k, |high: f64| high.max(k)));
        }
    }
    let lost = points.iter().find(|point| !is_solved(point)).map(|point| point.outcome.word().to_string());
    (ends.concat(), lost)
}

/// Of one point of a sample.
pub(super) fn place_numbers(point: Option<&SurfacePoint>) -> Numbers {
    match point {
        Some(point) if is_solved(point) => (point.position.into_iter().chain(point.normal).map(Some).collect(), None),
        other => {
            let why = other.map_or("not_solved", |point| point.outcome.word());
            (vec![None; PLACE.len()], Some(why.to_string()))
        }
    }
}

/// How contacts are looked at, mounted with errors.
pub(super) fn contact_request(which: &JobSelection, errors: Vec<(String, MountingError)>) -> ContactRequest {
    ContactRequest { positions: POSITIONS, errors, ..ContactRequest::new(which.clone()) }
}

/// Of a contact that is whole.
pub(super) fn contact_numbers(of: &ContactNumbers) -> Numbers {
    let [lengthwise, profilewise] = [0, 1].map(|k| of.shares.map(|shares| shares[k]));
    let [half_length, half_width] = [0, 1].map(|k| of.ellipse.map(|ellipse| ellipse[k]));
    let [z, rho] = of.place.map(Some);
    let numbers = [of.peak_to_peak, Some(of.lag), of.ratio, lengthwise, profilewise, z, rho, half_length, half_width];
    (numbers.to_vec(), None)
}

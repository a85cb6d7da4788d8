//! How near the cutter comes to what it keeps clear of.

use flank_chain_dsl::{Job, MilledArea, Milling, MillingClearance, SampleGrid};
use flank_solver::{Obstacle, ToolBody};
use rayon::prelude::*;

use super::Milled;
use super::cutter::outline;
use super::patch::Patch;
use super::result::ClearanceKept;
use super::target::Target;
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::session::Session;

/// The least distance of each pair over all positions, with what is missed.
///
/// # Errors
/// If a surface is not sampled or a body is no outline.
pub(super) fn kept(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    session: Session<'_>,
) -> Result<(Vec<ClearanceKept>, Vec<NotDone>), Failure> {
    let (mut kept, mut missed) = (Vec::new(), Vec::new());
    for clearance in &target.milling.clearances {
        let body = ToolBody { pieces: outline(job, &clearance.body)?.pieces };
        let area = sampled(job, target.milling, clearance)?;
        let patch = Patch::new(job, &job.surfaces[clearance.surface], area, session);
        match patch.field() {
            Err(missing) => missed.push(missing),
            Ok(field) => {
                let (found, not_clear) = least(target, milled, clearance, (&patch, &Obstacle::new(field), &body));
                kept.push(found);
                missed.extend(not_clear);
            }
        }
        session.check()?;
    }
    Ok((kept, missed))
}

/// The part of a surface that its sample asks for.
pub(super) fn sampled<'g>(
    job: &Job<'g>,
    milling: &Milling<'g>,
    clearance: &MillingClearance<'g>,
) -> Result<MilledArea<'g>, Failure> {
    let surface = &job.surfaces[clearance.surface];
    let name = &surface.name;
    let unsampled = || {
        Failure::from(format!(
            "milling `{}` keeps clear of `{name}`, which has no grid of points: add `sample {name} {{ … }}`",
            milling.name
        ))
    };
    let sample = surface.sample.as_ref().ok_or_else(unsampled)?;
    let ends = |values: &[f64]| match values {
        [first, .., last] => Ok((first.min(*last), first.max(*last))),
        _ => Err(unsampled()),
    };
    let (ranges, shares) = match &sample.grid {
        SampleGrid::Values([rows, columns]) => ([ends(rows)?, ends(columns)?], None),
        SampleGrid::Shares { shares: [rows, columns], corners } => {
            ([ends(rows)?, ends(columns)?], Some((*corners, false)))
        }
        SampleGrid::Points(_) => return Err(unsampled()),
    };
    let dimensions = match shares {
        Some(_) => [flank_chain_dsl::Dimension::NUMBER; 2],
        None => sample.coordinates.each_ref().map(|coordinate| coordinate.dimension),
    };
    Ok(MilledArea {
        coordinates: sample.coordinates.clone(),
        names: match shares {
            Some(_) => ["profilewise", "lengthwise"].map(str::to_string),
            None => sample.labels.clone(),
        },
        dimensions,
        ranges,
        shares,
        variables: milling.area.variables,
    })
}

/// How large a ball may be that touches the milled surface everywhere and stays clear.
fn largest_ball(
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    clearance: &MillingClearance<'_>,
    (surface, obstacle): (&str, &Obstacle),
) -> Option<String> {
    if clearance.surface == target.milling.surface {
        return None;
    }
    let stock = target.milling.stock;
    let balls = milled.lattice.each().filter_map(|(shares, frame)| {
        let touched = [0, 1, 2].map(|k| frame.position[k] + stock * frame.normal[k]);
        Some((obstacle.largest_ball(touched, frame.normal, clearance.distance)?.distance, shares))
    });
    let (radius, shares) = balls.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(radius, _)| *radius > 0.0)?;
    let place = target.place(shares);
    Some(format!("a ball that stays clear of {surface} has R {radius:.3} mm at the most, at {place}"))
}

/// A position, and what is nearest there.
type Found = ([usize; 2], flank_solver::Nearest);

fn least(
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    clearance: &MillingClearance<'_>,
    (patch, obstacle, body): (&Patch<'_, '_>, &Obstacle, &ToolBody),
) -> (ClearanceKept, Option<NotDone>) {
    let of_pass = |(pass, poses): (usize, &Vec<[f64; 6]>)| -> Option<Found> {
        let mut best: Option<Found> = None;
        for (position, pose) in poses.iter().enumerate() {
            let limit = best.map_or(f64::INFINITY, |(_, nearest)| nearest.distance);
            let found = obstacle.nearest(body, pose, limit);
            if let Some(found) = found.filter(|found| found.distance < limit) {
                best = Some(([pass, position], found));
            }
        }
        best
    };
    let found = milled.poses.par_iter().enumerate().filter_map(of_pass).collect::<Vec<Found>>();
    let ([pass, position], nearest) =
        found.into_iter().reduce(|a, b| if b.1.distance < a.1.distance { b } else { a }).expect("a milling has passes");
    let place = target.place(milled.shares(target, pass, position));
    let foot = patch.place(nearest.shares);
    let kept = ClearanceKept {
        surface: patch.name().to_string(),
        body: clearance.body_name.clone(),
        wanted: clearance.distance,
        least: nearest.distance,
        place: place.clone(),
        foot: foot.clone(),
    };
    let not_clear = (nearest.distance < clearance.distance).then(|| {
        let ClearanceKept { surface, body, wanted, least, .. } = &kept;
        let message = if *least < 0.0 {
            format!("{body} cuts {:.4} mm into {surface} while the cutter is at {place}", -least)
        } else {
            format!("{body} comes as near as {least:.4} mm to {surface} while the cutter is at {place}, {wanted} mm are wanted")
        };
        let details = [
            Some(format!("the nearest place of {surface} is at {foot}")),
            largest_ball(target, milled, clearance, (surface, obstacle)),
            Some(if clearance.surface == target.milling.surface {
                "take a smaller cutter, or lean it more with `lead`".to_string()
            } else {
                "take a smaller or longer cutter, or lean it with `tilt`".to_string()
            }),
        ];
        NotDone::new(NotDoneKind::NotClear, surface, message).with(details.into_iter().flatten().collect())
    });
    (kept, not_clear)
}

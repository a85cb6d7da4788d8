//! How near the cutter comes to what it keeps clear of.

use flank_chain_dsl::{
    CutterPiece, Job, MilledArea, Milling, MillingClearance, MillingObstacle, SampleGrid, ToolShape,
};
use flank_export::fixed;
use flank_expr::geometry::Chain;
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{Chart, Cutter, Obstacle, PoseField, ToolBody};
use rayon::prelude::*;

use super::Milled;
use super::cutter::{outline, put};
use super::patch::{GRIDS, NEAR, Patch, rough};
use super::proof::proven;
use super::result::ClearanceKept;
use super::target::Target;
use crate::project::failure::Failure;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::MillRequest;
use crate::project::session::Session;
use crate::project::units;

/// What the cutter keeps clear of: a surface as polynomials, with words for its places.
pub(super) struct Kept<'k> {
    pub(super) name: String,
    pub(super) obstacle: Obstacle,
    /// How far the polynomials may be off, mm.
    pub(super) off: f64,
    pub(super) place: Box<dyn Fn([f64; 2]) -> String + 'k>,
}

/// The same with the part of the cutter that does.
pub(super) struct Guarded<'k> {
    pub(super) kept: Kept<'k>,
    pub(super) body_name: String,
    pub(super) body: ToolBody,
    /// Whether it is no surface of the work.
    pub(super) is_fixture: bool,
}

/// What is kept clear of, with what that came to, and what is missed or not proven.
#[derive(Default)]
pub(super) struct KeptClear<'k> {
    pub(super) guarded: Vec<Guarded<'k>>,
    pub(super) clearances: Vec<ClearanceKept>,
    pub(super) missed: Vec<NotDone>,
}

/// What cuts as a body.
pub(super) fn body_of(cutting: &Cutter) -> ToolBody {
    ToolBody { pieces: cutting.pieces.clone() }
}

/// The least distance of each pair over all positions, with what is missed or not proven.
///
/// # Errors
/// If a surface is not sampled or a body is no outline.
pub(super) fn kept<'j, 'g>(
    job: &'j Job<'g>,
    target: &Target<'j, 'g>,
    milled: &Milled<'_, '_>,
    (request, session): (&MillRequest, Session<'_>),
) -> Result<KeptClear<'j>, Failure> {
    let mut all = KeptClear::default();
    for clearance in &target.milling.clearances {
        let body = ToolBody { pieces: outline(job, &clearance.body)?.pieces };
        let found = match &clearance.obstacle {
            MillingObstacle::Surface(surface) => {
                let area = sampled(job, target.milling, *surface)?;
                vec![of_surface(Patch::new(job, &job.surfaces[*surface], area, session))]
            }
            MillingObstacle::Fixture { pieces, t_work_fixture } => {
                let t_work_fixture = t_work_fixture.substituted(&job.bindings());
                pieces.iter().map(|piece| of_fixture(job, piece, &t_work_fixture)).collect()
            }
        };
        let is_fixture = matches!(clearance.obstacle, MillingObstacle::Fixture { .. });
        for found in found {
            match found {
                Err(missing) => all.missed.push(missing),
                Ok(of) => {
                    let (mut found, not_clear) = least(target, milled, clearance, (&of, &body));
                    all.missed.extend(not_clear);
                    if let Some(tolerance) = request.certify {
                        let proof = (&of, (clearance.body_name.as_str(), &body), clearance.distance - tolerance);
                        let (proven, open) = proven(target, milled, request.tool_centre_control, proof);
                        found.proven = Some(proven);
                        all.missed.extend(open);
                    }
                    all.clearances.push(found);
                    let (body_name, body) = (clearance.body_name.clone(), body.clone());
                    all.guarded.push(Guarded { kept: of, body_name, body, is_fixture });
                }
            }
            session.check()?;
        }
    }
    Ok(all)
}

fn of_surface<'k, 'g: 'k>(patch: Patch<'k, 'g>) -> Result<Kept<'k>, NotDone> {
    let (field, off) = patch.field()?;
    let obstacle = Obstacle::new(field);
    Ok(Kept { name: patch.name().to_string(), obstacle, off, place: Box::new(move |shares| patch.place(shares)) })
}

/// A piece of a tool that stands still against the work.
fn of_fixture<'k, 'g>(
    job: &Job<'g>,
    piece: &'k CutterPiece<'g>,
    t_work_fixture: &Chain<'g>,
) -> Result<Kept<'k>, NotDone> {
    let ToolShape::Surface(surface) = &piece.shape else { unreachable!("an edge is an error of the spec") };
    let bindings = job.bindings();
    let (position, normal) = (
        t_work_fixture.point(put(surface.position, &bindings)),
        t_work_fixture.direction(put(surface.normal, &bindings)),
    );
    let outputs: Vec<_> = position.0.into_iter().chain(normal.0).collect();
    let unknowns: Vec<_> = piece.unknowns.iter().map(|unknown| unknown.variable).collect();
    let tape = Tape::new(&outputs, &unknowns).expect("a job without errors leaves nothing unbound");
    let value = |k: usize, share: f64| {
        let unknown = &piece.unknowns[k];
        unknown.low + share * (unknown.high - unknown.low)
    };
    let field = |counts: [usize; 2]| {
        let mut evaluator = ScalarEvaluator::new(&tape);
        let [rows, columns] = counts.map(Chart::shares);
        let places = rows.iter().flat_map(|u| columns.iter().map(move |w| [*u, *w]));
        let at = places.map(|[u, w]| {
            let mut out = [0.0; 6];
            evaluator.run(&[value(0, u), value(1, w)], &mut out);
            out
        });
        PoseField::through(at.collect(), counts)
    };
    let place = move |shares: [f64; 2]| {
        let text = |k: usize| {
            let unknown = &piece.unknowns[k];
            format!("{} {}", unknown.name, units::text(unknown.dimension, value(k, shares[k]), 4))
        };
        format!("{}, {}", text(0), text(1))
    };
    let mut off = f64::INFINITY;
    for counts in GRIDS {
        let found = field(counts);
        off = found.tail();
        if off <= NEAR {
            let obstacle = Obstacle::new(found);
            return Ok(Kept { name: piece.name.clone(), obstacle, off: NEAR, place: Box::new(place) });
        }
    }
    Err(rough(&piece.name, off))
}

/// The part of a surface that its sample asks for.
pub(super) fn sampled<'g>(job: &Job<'g>, milling: &Milling<'g>, surface: usize) -> Result<MilledArea<'g>, Failure> {
    let surface = &job.surfaces[surface];
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

fn is_milled(target: &Target<'_, '_>, clearance: &MillingClearance<'_>) -> bool {
    matches!(clearance.obstacle, MillingObstacle::Surface(surface) if surface == target.milling.surface)
}

/// How large a ball may be that touches the milled surface everywhere and stays clear.
fn largest_ball(
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    clearance: &MillingClearance<'_>,
    (surface, obstacle): (&str, &Obstacle),
) -> Option<String> {
    if is_milled(target, clearance) {
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

/// The least distance over all positions, and what is missed. A polynomial stands for the surface that is as near to it as [`NEAR`]: what
/// is missed by less is not known to be missed, as by a ball that touches the surface that it mills.
fn least(
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    clearance: &MillingClearance<'_>,
    (of, body): (&Kept<'_>, &ToolBody),
) -> (ClearanceKept, Option<NotDone>) {
    let obstacle = &of.obstacle;
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
    let foot = (of.place)(nearest.shares);
    let kept = ClearanceKept {
        surface: of.name.clone(),
        body: clearance.body_name.clone(),
        wanted: clearance.distance,
        least: nearest.distance,
        place: place.clone(),
        foot: foot.clone(),
        proven: None,
    };
    let not_clear = (nearest.distance < clearance.distance - of.off).then(|| {
        let ClearanceKept { surface, body, wanted, least, .. } = &kept;
        let message = if *least < -of.off {
            format!("{body} cuts {:.4} mm into {surface} while the cutter is at {place}", -least)
        } else {
            format!(
                "{body} comes as near as {} mm to {surface} while the cutter is at {place}, {wanted} mm are wanted",
                fixed(*least, 4)
            )
        };
        let details = [
            Some(format!("the nearest place of {surface} is at {foot}")),
            largest_ball(target, milled, clearance, (surface, obstacle)),
            Some(if is_milled(target, clearance) {
                "take a smaller cutter, or lean it more with `lead`".to_string()
            } else {
                "take a smaller or longer cutter, or lean it with `tilt`".to_string()
            }),
        ];
        NotDone::new(NotDoneKind::NotClear, surface, message).with(details.into_iter().flatten().collect())
    });
    (kept, not_clear)
}

//! What pictures show of a milling.

use flank_chain_dsl::{Job, Milling, MillingObstacle};
use flank_draw::{MillingDrawing, PassChart, RidgeSection};
use flank_export::{Axis, Field, Header, Layout, Outcome, Patch, Point, Values, fixed};
use flank_solver::{Obstacle, ToolBody, lowest};
use rayon::prelude::*;

use super::cutter::outline;
use super::obstacles::sampled;
use super::patch::Patch as Milled;
use super::plan::{Planner, evenly};
use super::result::MillResult;
use super::straight::Straight;
use super::target::Target;
use super::text::MEANT;
use super::{Found, Worked, worked};
use crate::project::failure::Failure;
use crate::project::requests::MillRequest;
use crate::project::session::Session;
use crate::project::units;

/// Columns of the map of ridges, and places of each pass.
const COLUMNS: usize = 41;
/// Rows of what one pass leaves.
const ROWS_OF_ONE: usize = 15;
/// Places of a section across the passes, and how many steps it reaches to both sides of the ridge.
const PLACES: usize = 321;
const STEPS: f64 = 2.0;

/// A milling for what writes no files of its own: what is known of it, and what pictures show of it if there is a plan.
///
/// # Errors
/// See [`worked`].
pub(crate) fn shown(
    job: &Job<'_>,
    milling: &Milling<'_>,
    request: &MillRequest,
    (header, session): (Header, Session<'_>),
) -> Result<(MillResult, Option<MillingDrawing>), Failure> {
    let Worked { target, result, found } = worked(job, milling, request, session)?;
    let Some(found) = &found else { return Ok((result, None)) };
    let Some(highest) = found.milled.plan.cusp.or_else(|| found.map.highest()) else { return Ok((result, None)) };
    let gap = Gap::of_highest(found, highest);
    let mut charts: Vec<PassChart> = clearances(job, &target, (found, gap.pass), session)?.into_iter().collect();
    charts.extend(rotary_axes(&target, found, gap.pass));
    let MillResult { job: name, milling, surface, cutter, .. } = &result;
    let mark = |height: f64| (position(&found.fields.surface.at(gap.shares)), format!("{} \u{b5}m", fixed(height, 3)));
    let drawing = MillingDrawing {
        header,
        title: format!("{name}: {milling} of {surface} with {cutter}"),
        note: format!(
            "{}, along the normal of the flank beside the stock. The section is straightened \
             along the flank; what lies below the cutter on all passes is left. {}",
            match result.side {
                None => "Heights of the ridges between neighbouring passes",
                Some(_) => "Heights that one pass with the side of the cutter leaves",
            },
            text(&result)
        ),
        ridges: ridges(&target, found),
        passes: found.milled.plan.shares[0].iter().map(|pass| contacts(found, *pass)).collect(),
        highest: gap.height.map(mark),
        section: gap.section(&target, found),
        charts,
    };
    Ok((result, Some(drawing)))
}

/// Passes and blocks in a sentence.
fn text(result: &MillResult) -> String {
    let step = result.pass_step.unwrap_or_default();
    if result.side.is_some() {
        return format!("One pass of {} positions.", result.positions.unwrap_or_default());
    }
    let (passes, positions) = (result.passes.unwrap_or_default(), result.positions.unwrap_or_default());
    format!("{passes} passes, at most {} mm apart, of {positions} positions each.", fixed(step, 4))
}

fn position(line: &[f64; 6]) -> [f64; 3] {
    [line[0], line[1], line[2]]
}

fn contacts(found: &Found<'_, '_>, pass: f64) -> Vec<[f64; 3]> {
    let pass = found.fields.surface.pass(pass);
    evenly(COLUMNS).into_iter().map(|along| position(&pass.at(along))).collect()
}

/// The ridges as a grid: a row for each, and the border passes with the heights of the ridges beside them.
fn ridges(target: &Target<'_, '_>, found: &Found<'_, '_>) -> Patch {
    let Found { cutter, fields, milled, .. } = found;
    let columns = evenly(COLUMNS);
    let planner = Planner { target, fields, cutter, straight: Straight::Cutter };
    if milled.plan.cusp.is_none() {
        return left_by_one(target, found);
    }
    // a plan has ridges between all passes
    let cusps = planner.cusps(&milled.plan.shares[0], &columns, None).unwrap_or_default();
    let border = |row: &[super::LeftAt], share: f64| -> Vec<super::LeftAt> {
        row.iter().map(|at| super::LeftAt { shares: [share, at.shares[1]], ..*at }).collect()
    };
    let rows: Vec<&[super::LeftAt]> = cusps.chunks(COLUMNS).collect();
    let first = rows.first().map_or(Vec::new(), |row| border(row, 0.0));
    let last = rows.last().map_or(Vec::new(), |row| border(row, 1.0));
    let all: Vec<super::LeftAt> = first.into_iter().chain(cusps.iter().copied()).chain(last).collect();
    patch(target, found, &all, "height of the ridge between two passes, along the normal")
}

/// What one pass leaves, as a grid.
fn left_by_one(target: &Target<'_, '_>, found: &Found<'_, '_>) -> Patch {
    let columns = evenly(COLUMNS);
    let places = evenly(ROWS_OF_ONE).into_iter().flat_map(|across| columns.iter().map(move |along| [across, *along]));
    let at = |shares: [f64; 2]| super::LeftAt {
        shares,
        height: found.swept.left(&found.fields.surface.at(shares)).map_or(f64::NAN, |left| left.height),
    };
    let all: Vec<super::LeftAt> = places.map(at).collect();
    patch(target, found, &all, "height that the pass leaves, along the normal")
}

/// Heights at places of columns, row by row; not a number where none is known.
fn patch(target: &Target<'_, '_>, found: &Found<'_, '_>, all: &[super::LeftAt], meaning: &str) -> Patch {
    let (fields, stock) = (&found.fields, target.milling.stock);
    let point = |at: &super::LeftAt| {
        let [x, y, z, nx, ny, nz] = fields.surface.at(at.shares);
        Point {
            outcome: Outcome::Solved,
            position: [x, y, z],
            normal: [nx, ny, nz],
            unknowns: Vec::new(),
            residual: 0.0,
            reason: String::new(),
        }
    };
    let [rows, columns] = target.labels();
    Patch {
        name: target.name().to_string(),
        frame: target.frame().to_string(),
        layout: Layout::Round,
        rows: Axis { label: rows, count: all.len() / COLUMNS },
        columns: Axis { label: columns, count: COLUMNS },
        unknowns: Vec::new(),
        points: all.iter().map(point).collect(),
        fields: vec![Field {
            name: "ridge".to_string(),
            unit: "um".to_string(),
            meaning: meaning.to_string(),
            values: Values::Scalars(
                all.iter().map(|at| at.height.is_finite().then_some(1e3 * (at.height - stock))).collect(),
            ),
        }],
    }
}

/// The passes beside the highest ridge, or in the middle where heights are rounding.
struct Gap {
    /// The pass before it.
    pass: usize,
    /// Where the ridge is, or the highest place of a pass alone.
    shares: [f64; 2],
    /// How high it is, um, unless that is rounding.
    height: Option<f64>,
}

impl Gap {
    fn of_highest(found: &Found<'_, '_>, highest: super::LeftAt) -> Gap {
        let passes = &found.milled.plan.shares[0];
        let height = Some(1e3 * highest.height).filter(|height| height.abs() >= MEANT);
        let shares = if height.is_some() { highest.shares } else { [0.5; 2] };
        let after = passes.partition_point(|share| *share <= shares[0]);
        Gap { pass: after.saturating_sub(1).min(passes.len().saturating_sub(2)), shares, height }
    }

    /// What the passes about it leave across the feed.
    fn section(&self, target: &Target<'_, '_>, found: &Found<'_, '_>) -> RidgeSection {
        let Found { cutter, fields, milled, swept, .. } = found;
        let (passes, [across, along]) = (&milled.plan.shares[0], self.shares);
        // a pass alone covers all
        let step = passes.get(self.pass + 1).map_or(1.0, |next| next - passes[self.pass]);
        let [low, high] = [-STEPS, STEPS].map(|steps| (across + steps * step).clamp(0.0, 1.0));
        let line = fields.surface.across(along);
        let shares: Vec<f64> = evenly(PLACES).into_iter().map(|share| low + share * (high - low)).collect();
        let lines: Vec<[f64; 6]> = shares.iter().map(|share| line.at(*share)).collect();
        let mut ways = vec![0.0];
        for pair in lines.windows(2) {
            ways.push(ways[ways.len() - 1] + super::distance(&pair[0], &pair[1]));
        }
        let at_ridge = |share: f64| {
            let after = shares.partition_point(|other| *other < share).clamp(1, shares.len() - 1);
            let part = (share - shares[after - 1]) / (shares[after] - shares[after - 1]);
            ways[after - 1] + part * (ways[after] - ways[after - 1])
        };
        let zero = at_ridge(across);
        let stock = target.milling.stock;
        let point = |k: usize, height: f64| [ways[k] - zero, 1e3 * (height - stock)];
        let near =
            (0..passes.len()).filter(|k| passes.len() > 1 && (passes[*k] - across).abs() <= (STEPS + 2.0) * step);
        let cutter_on = |number: usize| {
            let pass = &milled.ways[number];
            let height = |k: usize| lowest(pass, &cutter.cutting, &lines[k], along).map(|found| point(k, found.height));
            (0..PLACES).filter_map(height).collect()
        };
        let left = (0..PLACES).into_par_iter().filter_map(|k| swept.left(&lines[k]).map(|left| point(k, left.height)));
        RidgeSection {
            about: match passes.len() {
                1 => target.place(self.shares),
                _ => format!("{}; passes {} and {}", target.place(self.shares), self.pass + 1, self.pass + 2),
            },
            passes: near.map(cutter_on).collect(),
            left: left.collect(),
            ridge: self.height,
        }
    }
}

/// The value of the coordinate along a pass at each of its positions, in their order.
fn along(target: &Target<'_, '_>, found: &Found<'_, '_>, pass: usize) -> Vec<f64> {
    let dimension = target.milling.area.dimensions[1];
    let count = found.milled.poses[pass].len();
    (0..count).map(|k| units::shown(dimension, target.values(found.milled.shares(target, pass, k))[1])).collect()
}

fn over(target: &Target<'_, '_>) -> String {
    let area = &target.milling.area;
    match units::symbol(area.dimensions[1]) {
        "" => area.names[1].clone(),
        unit => format!("{}, {unit}", area.names[1]),
    }
}

/// How far the cutter stays away from each of the surfaces that it keeps clear of, along a pass.
fn clearances(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    (found, pass): (&Found<'_, '_>, usize),
    session: Session<'_>,
) -> Result<Option<PassChart>, Failure> {
    let along = along(target, found, pass);
    let (mut curves, mut limits) = (Vec::new(), Vec::new());
    for clearance in &target.milling.clearances {
        let MillingObstacle::Surface(surface) = clearance.obstacle else { continue };
        let body = ToolBody { pieces: outline(job, &clearance.body)?.pieces };
        let area = sampled(job, target.milling, surface)?;
        let patch = Milled::new(job, &job.surfaces[surface], area, session);
        let Ok((field, _)) = patch.field() else { continue };
        let obstacle = Obstacle::new(field);
        let distance = |pose: &[f64; 6]| obstacle.nearest(&body, pose, f64::INFINITY).map(|nearest| nearest.distance);
        let distances: Vec<Option<f64>> = found.milled.poses[pass].par_iter().map(distance).collect();
        let points = along.iter().zip(distances).filter_map(|(at, distance)| Some([*at, distance?]));
        curves.push((format!("{} to {}", clearance.body_name, patch.name()), points.collect()));
        limits.push((clearance.distance, format!("wanted of {}", patch.name())));
        session.check()?;
    }
    Ok((!curves.is_empty()).then(|| PassChart {
        title: "clearance along the pass".to_string(),
        about: match found.milled.poses.len() {
            1 => "red: what is wanted".to_string(),
            _ => format!("pass {}, beside the highest ridge; red: what is wanted", pass + 1),
        },
        over: over(target),
        unit: "mm".to_string(),
        curves,
        limits,
    }))
}

/// The rotary axes along a pass, and how far the cutter's axis is from the pole.
fn rotary_axes(target: &Target<'_, '_>, found: &Found<'_, '_>, pass: usize) -> Option<PassChart> {
    let machine = found.milled.machine.as_ref()?;
    let along = along(target, found, pass);
    let curve = |values: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        along.iter().enumerate().map(|(k, at)| [*at, values(k).to_degrees()]).collect()
    };
    let rows = &found.milled.axes[pass];
    let rotary = (0..machine.free.len()).filter(|axis| machine.axes.is_rotary(*axis));
    let mut curves: Vec<(String, Vec<[f64; 2]>)> =
        rotary.map(|axis| (machine.free[axis].name.clone(), curve(&|k| rows[k][axis]))).collect();
    let from_pole = |k: usize| machine.axes.angle_from_pole(&found.milled.poses[pass][k]);
    curves.push(("from the pole".to_string(), curve(&from_pole)));
    Some(PassChart {
        title: "rotary axes along the pass".to_string(),
        about: format!(
            "pass {}, on {}; the cutter's axis from where a rotary axis is free",
            pass + 1,
            machine.machine.name
        ),
        over: over(target),
        unit: "deg".to_string(),
        curves,
        limits: Vec::new(),
    })
}

//! `flank mill`

mod block;
pub(crate) mod clamp;
mod control;
mod cutter;
pub(crate) mod drawn;
mod files;
pub(crate) mod flank;
mod guard;
mod iso;
mod klartext;
mod left;
mod machine;
mod measured;
mod obstacles;
mod on_page;
mod patch;
mod plan;
mod program;
mod proof;
pub(crate) mod result;
mod retract;
mod ridge;
pub(crate) mod setup;
pub(crate) mod side;
mod spaces;
mod straight;
mod target;
mod text;
mod verify;

use std::time::Instant;

use flank_chain_dsl::{Job, Milling, PassSpacing};
use flank_export::fixed;
use flank_expr::Graph;
use flank_solver::{Bending, PoseSeries, SweptCutter};
use rayon::prelude::*;

use self::cutter::MillingCutter;
use self::left::LeftMap;
use self::machine::Machine;
use self::obstacles::{Guarded, KeptClear};
use self::patch::Lattice;
use self::plan::{LeftAt, Plan, Planner};
use self::result::{BallAt, CurvatureAt, HeightLeft, MillResult, MilledAxis};
use self::spaces::Spaces;
use self::straight::Straight;
use self::target::{Fields, Target};
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::quantity::Travel;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::MillRequest;
use crate::project::session::Session;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::project::units;

/// Passes of cutters over surfaces, what these leave, and the axes of the machines. `each` is given the result of each milling.
///
/// # Errors
/// What is wrong with the spec, that it mills nothing, that a cutter is none, or that a file cannot be read or written.
pub fn mill(request: &MillRequest, monitor: &dyn Monitor, each: &mut dyn FnMut(MillResult)) -> Result<(), Failure> {
    let start = Instant::now();
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor);
    for (job, milling) in asked(&jobs, request)? {
        let result = of_milling(job, milling, request, &origin, session)?;
        each(MillResult { timing: Timing { elapsed: start.elapsed(), ..result.timing }, ..result });
    }
    Ok(())
}

/// The millings that are asked for, each with its job.
fn asked<'j, 'g>(jobs: &'j [Job<'g>], request: &MillRequest) -> Result<Vec<(&'j Job<'g>, &'j Milling<'g>)>, Failure> {
    let all: Vec<(&Job<'g>, &Milling<'g>)> =
        jobs.iter().flat_map(|job| job.millings.iter().map(move |milling| (job, milling))).collect();
    if all.is_empty() {
        let message = "no job mills a surface: add `mill finish of SURFACE with CUTTER.cutting in MACHINE.work { … }`";
        return Err(Failure::from(message.to_string()));
    }
    let Some(name) = &request.milling else { return Ok(all) };
    let known: Vec<String> = all.iter().map(|(_, milling)| format!("`{}`", milling.name)).collect();
    let found: Vec<_> = all.into_iter().filter(|(_, milling)| milling.name == *name).collect();
    if found.is_empty() {
        return Err(Failure::from(format!("there is no milling `{name}`; there is: {}", known.join(", "))));
    }
    Ok(found)
}

/// A radius above this, mm, is straight: over 100 mm it bends by a thousandth of a um.
const STRAIGHT: f64 = 1e9;

/// What is milled, with what is worked out of it.
struct Milled<'p, 'g> {
    plan: Plan,
    /// The exact points of all positions.
    lattice: Lattice,
    /// The cutter on each pass, as smooth as it is meant.
    ways: Vec<PoseSeries>,
    /// Of each pass its poses, in the order in which they are passed.
    poses: Vec<Vec<[f64; 6]>>,
    /// Of each pass the positions of the axes; none without a machine.
    axes: Vec<Vec<Vec<f64>>>,
    machine: Option<Machine<'p, 'g>>,
}

impl Milled<'_, '_> {
    /// The shares of a position in the order in which a pass is passed.
    fn shares(&self, target: &Target<'_, '_>, pass: usize, position: usize) -> [f64; 2] {
        [self.plan.shares[0][pass], self.plan.shares[1][self.column(target, pass, position)]]
    }

    /// Its column in the lattice.
    fn column(&self, target: &Target<'_, '_>, pass: usize, position: usize) -> usize {
        let backwards = target.milling.both_ways && pass % 2 == 1;
        if backwards { self.plan.shares[1].len() - 1 - position } else { position }
    }
}

/// A milling with all that was worked out of it.
pub(crate) struct Worked<'j, 'g> {
    target: Target<'j, 'g>,
    result: MillResult,
    /// Nothing where there is no plan, and the result says why.
    found: Option<Found<'j, 'g>>,
}

/// A planned milling.
struct Found<'j, 'g> {
    cutter: MillingCutter,
    fields: Fields,
    milled: Milled<'j, 'g>,
    swept: SweptCutter,
    map: LeftMap,
    /// What the cutter keeps clear of.
    guarded: Vec<Guarded<'j>>,
    spaces: Spaces,
}

/// Plans a milling and measures what it leaves; nothing is written or read back.
///
/// # Errors
/// If the cutter is none, something that it keeps clear of is not sampled, or the work is cancelled.
pub(crate) fn worked<'j, 'g>(
    job: &'j Job<'g>,
    milling: &'j Milling<'g>,
    request: &MillRequest,
    session: Session<'_>,
) -> Result<Worked<'j, 'g>, Failure> {
    let cutter = MillingCutter::of_milling(job, milling)?;
    Spaces::check(job, milling, request.spaces)?;
    clamp::check(job, milling, request)?;
    files::check(request)?;
    let _working = session.begin(format!("milling {}", milling.name))?;
    let target = Target::new(job, milling, session);
    let mut result = nothing(job, &target, request);
    let (machine, remark) = machine_of(job, milling);
    result.remarks.extend(remark);
    if machine.is_none() && (!request.nc.is_empty() || request.verify.is_some() || !request.clamp.is_empty()) {
        let message =
            format!("{} has no axes in closed form, and programs are made of them", job.machines[milling.machine].name);
        result.not_done.push(NotDone::new(NotDoneKind::NoClosedForm, &milling.name, message));
    }
    let found =
        target.has_room(&cutter).and_then(|()| target.fields(&cutter)).and_then(|fields| match milling.spacing {
            PassSpacing::Side(free) => {
                let (milled, left) = side::milled(&target, &cutter, machine, &fields, (request, free))?;
                result.side = Some(left);
                Ok((fields, milled))
            }
            _ => milled(&target, &cutter, machine, &fields, request).map(|milled| (fields, milled)),
        });
    let (fields, milled) = match found {
        Ok(found) => found,
        Err(missing) => {
            result.not_done.push(missing);
            return Ok(Worked { target, result, found: None });
        }
    };
    session.check()?;
    describe(&mut result, &target, &cutter, &fields, &milled);
    if !request.clamp.is_empty() && milled.machine.is_some() {
        let (clamping, missed) = clamp::found(job, milling, &milled.poses, request)?;
        result.clamping = clamping;
        result.not_done.extend(missed);
        session.check()?;
    }
    let KeptClear { guarded, clearances, missed } = obstacles::kept(job, &target, &milled, (request, session))?;
    result.clearances = clearances;
    result.not_done.extend(missed);
    let swept = SweptCutter::of_passes(&milled.ways, &cutter.cutting);
    let map = LeftMap::of_cutter(&target, &fields, &swept, [request.rows as usize, request.columns as usize]);
    session.check()?;
    result.map = Some(map.result(&target));
    // a pass with the side is as near as it comes; what cuts too deep beside its contact is told of that
    let is_told = result.side.is_some() || result.not_done.iter().any(|known| known.kind == NotDoneKind::TooDeep);
    result.not_done.extend(map.too_deep(&target).filter(|_| !is_told));
    let spaces = Spaces::of_job(job, milling);
    Ok(Worked { target, result, found: Some(Found { cutter, fields, milled, swept, map, guarded, spaces }) })
}

fn of_milling(
    job: &Job<'_>,
    milling: &Milling<'_>,
    request: &MillRequest,
    origin: &Origin,
    session: Session<'_>,
) -> Result<MillResult, Failure> {
    let Worked { target, mut result, found } = worked(job, milling, request, session)?;
    if let Some(found @ Found { milled, map, .. }) = &found {
        let read = match (&request.verify, &milled.machine) {
            (Some(path), Some(machine)) => Some(verify::program((path, request.spaces), &target, found, machine)?),
            _ => None,
        };
        result.verified = read.as_ref().map(|read| read.result(&target));
        // what is not passed over is told, and hinders no program; nor does what ails one that was read back
        let is_whole = result.not_done.is_empty();
        result.not_done.extend(map.missing(&target));
        result.not_done.extend(read.iter().flat_map(|read| read.missed(&target)));
        let asked = (request, origin, session);
        let (programs, refused) =
            if is_whole { files::programs(job, &target, found, asked)? } else { (Vec::new(), None) };
        result.not_done.extend(refused);
        let maps = (map, read.as_ref().map(|read| &read.map));
        result.files = files::write(job, &target, (milled, maps), asked, &programs)?;
        result.remarks.extend(files::unsaid(&target, request, &programs));
        result.remarks.extend(read.iter().flat_map(|read| read.assumed(&target)));
    }
    Ok(MillResult {
        not_done: origin.located(&[job], result.not_done),
        remarks: origin.located(&[job], result.remarks),
        ..result
    })
}

/// The machine, or why its axes are not known.
fn machine_of<'p, 'g>(job: &'p Job<'g>, milling: &Milling<'g>) -> (Option<Machine<'p, 'g>>, Option<Remark>) {
    match Machine::of_milling(job, milling) {
        Ok(machine) => (Some(machine), None),
        Err(none) => (None, none.told(&job.machines[milling.machine])),
    }
}

/// Plans passes and blocks, and takes the machine along them.
fn milled<'p, 'g>(
    target: &Target<'_, 'g>,
    cutter: &MillingCutter,
    machine: Option<Machine<'p, 'g>>,
    fields: &Fields,
    request: &MillRequest,
) -> Result<Milled<'p, 'g>, NotDone> {
    let few: Vec<Vec<[f64; 6]>> = [0.0, 0.5, 1.0]
        .iter()
        .map(|pass| {
            let pass = fields.of_pass(0).pass(*pass);
            (0..=8).map(|k| pass.at(f64::from(k) / 8.0)).collect()
        })
        .collect();
    let machine = machine.map(|machine| machine.on_best_elbow(&few));
    if let Some(machine) = &machine {
        let places: Vec<[f64; 2]> = fields.lattice.each().map(|(shares, _)| shares).collect();
        // every other pass may lean the other way
        let ways = if target.milling.both_ways { 2 } else { 1 };
        let of_way = |way: usize| places.iter().map(move |shares| fields.of_pass(way).at(*shares));
        let poses: Vec<[f64; 6]> = (0..ways).flat_map(of_way).collect();
        if let Some(missed) = machine.unreached(&poses, |k| target.place(places[k % places.len()])) {
            return Err(missed);
        }
    }
    let straight = Straight::of_machine(machine.as_ref(), request.tool_centre_control);
    let plan = Planner { target, fields, cutter, straight }.plan()?;
    let lattice = target.lattice(plan.shares.clone())?;
    let columns = plan.shares[1].len();
    let of_pass = |pass: usize| -> Result<Vec<[f64; 6]>, NotDone> {
        let backwards = target.milling.both_ways && pass % 2 == 1;
        let forward = if backwards { -1.0 } else { 1.0 };
        let place = |k: usize| if backwards { columns - 1 - k } else { k };
        let at = |k: usize| {
            let shares = [plan.shares[0][pass], plan.shares[1][place(k)]];
            Ok(target.pose(shares, lattice.at(pass, place(k)), cutter, forward)?.row())
        };
        (0..columns).map(at).collect()
    };
    let poses = (0..plan.shares[0].len()).map(of_pass).collect::<Result<Vec<_>, NotDone>>()?;
    let axes = machine.iter().flat_map(|machine| poses.iter().map(|pass| machine.axes.along(pass))).collect();
    let ways =
        plan.shares[0].par_iter().enumerate().map(|(number, share)| fields.of_pass(number).pass(*share)).collect();
    Ok(Milled { plan, lattice, ways, poses, axes, machine })
}

fn nothing(job: &Job<'_>, target: &Target<'_, '_>, request: &MillRequest) -> MillResult {
    MillResult {
        job: job.name.clone(),
        milling: target.milling.name.clone(),
        surface: target.name().to_string(),
        frame: target.frame().to_string(),
        cutter: target.milling.cutter_name.clone(),
        coordinates: target.milling.area.names.clone(),
        setup: setup::MillSetup::new(job, target, request),
        passes: None,
        positions: None,
        pass_step: None,
        block_length: None,
        path_length: None,
        cusp: None,
        map: None,
        side: None,
        blocks: None,
        tool_centre_control: request.tool_centre_control,
        effective_radius: None,
        least_gap_curvature: None,
        largest_ball: None,
        clearances: Vec::new(),
        axes: Vec::new(),
        least_from_pole: None,
        polynomials_off: None,
        clamping: None,
        verified: None,
        files: Vec::new(),
        not_done: Vec::new(),
        remarks: Vec::new(),
        timing: Timing::default(),
    }
}

fn left_at(target: &Target<'_, '_>, left: LeftAt) -> HeightLeft {
    let values = target.values(left.shares);
    let dimensions = target.milling.area.dimensions;
    HeightLeft {
        height_um: left.height * 1e3,
        at: [0, 1].map(|k| units::shown(dimensions[k], values[k])),
        place: target.place(left.shares),
    }
}

fn describe(
    result: &mut MillResult,
    target: &Target<'_, '_>,
    cutter: &MillingCutter,
    fields: &Fields,
    milled: &Milled<'_, '_>,
) {
    let plan = &milled.plan;
    let way = |pass: &Vec<[f64; 6]>| pass.windows(2).map(|pair| distance(&pair[0], &pair[1])).sum::<f64>();
    result.passes = Some(plan.shares[0].len());
    result.positions = Some(plan.shares[1].len());
    result.pass_step = plan.step;
    result.block_length = Some(plan.block);
    result.path_length = Some(milled.poses.iter().map(way).sum());
    result.cusp = plan.cusp.map(|cusp| left_at(target, cusp));
    result.blocks = Some(plan.blocks.map(|ends| left_at(target, ends)));
    result.polynomials_off = Some(fields.off);
    result.timing.points = milled.lattice.frames.len();
    result.remarks.extend(plan.short.map(|short| {
        let (place, by) = (target.place(short.shares), fixed(short.height, 4));
        let message = format!(
            "the cut beside the passes ends at {place}, {by} mm before these: the edge of {} is round",
            target.milling.cutter_name
        );
        let way = "let `along` run so much farther than what is to be milled".to_string();
        Remark::new(RemarkKind::ShortCut, target.name(), message).with(vec![way])
    }));
    if let Some((unknown, by)) = milled.lattice.beyond {
        let message = target.beyond(unknown, by);
        result.remarks.push(Remark::new(RemarkKind::Continued, target.name(), message));
    }
    match &result.side {
        Some(side) => result.not_done.extend(side.missed(target)),
        None => bending(result, target, cutter, milled),
    }
    let Some(machine) = &milled.machine else { return };
    let poles = milled.poses.iter().flatten().map(|row| machine.axes.angle_from_pole(row).to_degrees());
    result.least_from_pole = poles.reduce(f64::min);
    result.axes = axes(machine, &milled.poses, &milled.axes);
    for (pass, (poses, rows)) in milled.poses.iter().zip(&milled.axes).enumerate() {
        let place = |k: usize| target.place(milled.shares(target, pass, k));
        for fault in machine.faults(poses, rows, place) {
            // what ails many passes is told of the first
            let is_known = |known: &NotDone| known.kind == fault.kind && known.of == fault.of;
            if !result.not_done.iter().any(is_known) {
                result.not_done.push(fault);
            }
        }
    }
}

/// How cutter and surface part beside their contact.
fn bending(result: &mut MillResult, target: &Target<'_, '_>, cutter: &MillingCutter, milled: &Milled<'_, '_>) {
    let columns = milled.plan.shares[1].len();
    let known = milled.lattice.each().enumerate().filter_map(|(k, (shares, frame))| {
        let backwards = target.milling.both_ways && (k / columns) % 2 == 1;
        let forward = if backwards { -1.0 } else { 1.0 };
        let pose = target.pose(shares, frame, cutter, forward).ok()?;
        Some((shares, pose.bending(frame, &cutter.cutting)?))
    });
    let known: Vec<([f64; 2], Bending)> = known.collect();
    let radii = known.iter().map(|(_, bending)| bending.effective_radius);
    result.effective_radius = radii
        .clone()
        .reduce(f64::min)
        .zip(radii.reduce(f64::max))
        .map(|(least, most)| [least, most])
        .filter(|[_, most]| *most < STRAIGHT);
    let least = known.iter().min_by(|a, b| a.1.gap.total_cmp(&b.1.gap));
    result.least_gap_curvature =
        least.map(|(shares, bending)| CurvatureAt { curvature: bending.gap, place: target.place(*shares) });
    let hollow = known
        .iter()
        .min_by(|a, b| a.1.hollow.total_cmp(&b.1.hollow))
        .filter(|(_, bending)| bending.hollow < -1.0 / STRAIGHT);
    result.largest_ball =
        hollow.map(|(shares, bending)| BallAt { radius: -1.0 / bending.hollow, place: target.place(*shares) });
    if let Some((shares, _)) = least.filter(|(_, bending)| bending.gap < 0.0) {
        let deep = known.iter().filter(|(_, bending)| bending.gap < 0.0).count();
        let message = format!(
            "{} cuts too deep beside its contact at {} of {}, most at {}",
            target.milling.cutter_name,
            units::counted(deep, "position"),
            known.len(),
            target.place(*shares)
        );
        let ball = result
            .largest_ball
            .as_ref()
            .map(|ball| format!("the hollow takes a ball of R {:.3} mm there at the most", ball.radius));
        let details =
            ball.into_iter().chain(["take a smaller cutter, or lean it more with `lead`".to_string()]).collect();
        result.not_done.push(NotDone::new(NotDoneKind::TooDeep, target.name(), message).with(details));
    }
}

fn distance(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn axes(machine: &Machine<'_, '_>, poses: &[Vec<[f64; 6]>], rows: &[Vec<Vec<f64>>]) -> Vec<MilledAxis> {
    let of_axis = |axis: usize| {
        let own = machine.free[axis];
        let shown = |value: f64| units::shown(own.dimension, value);
        let values = rows.iter().flatten().map(|row| row[axis]);
        let extent = [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)];
        let rate = rows.iter().zip(poses).flat_map(|(rows, poses)| {
            rows.windows(2).zip(poses.windows(2)).map(move |(rows, poses)| {
                let way = distance(&poses[0], &poses[1]);
                if way > 0.0 { (rows[1][axis] - rows[0][axis]).abs() / way } else { 0.0 }
            })
        });
        MilledAxis {
            name: own.name.clone(),
            unit: units::symbol(own.dimension).to_string(),
            extent: extent.map(shown),
            travel: own.travel.map(|(low, high)| Travel { low: shown(low), high: shown(high) }),
            rate_per_mm: shown(rate.fold(0.0, f64::max)),
        }
    };
    (0..machine.free.len()).map(of_axis).collect()
}

//! What `flank mill` leaves in its folder: cutter locations, a table, NC programs.

use std::f64::consts::TAU;
use std::fmt::Write;

use flank_chain_dsl::{Dimension, Job};
use flank_export::{Dialect, MachineAxis, PassProgram, ProgramPass, WordsOf, write_passes};

use super::Milled;
use super::left::LeftMap;
use super::machine::Machine;
use super::target::Target;
use crate::convert::files::decimals;
use crate::project::choices::{CutterFormat, NcDialect};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::requests::MillRequest;
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve;

/// Beyond the ends of its travel an axis without one goes away by this, mm.
const AWAY: f64 = 100.0;

/// Writes what is asked for and names it; programs only of what is `whole`.
///
/// # Errors
/// If a file cannot be written, or a control cannot do what a program needs.
pub(super) fn write(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    (milled, (map, read)): (&Milled<'_, '_>, (&LeftMap, Option<&LeftMap>)),
    (request, origin, session): (&MillRequest, &Origin, Session<'_>),
    is_whole: bool,
) -> Result<Vec<String>, Failure> {
    let name = format!("{}.{}", job.name, target.milling.name);
    let programs = match &milled.machine {
        Some(machine) if is_whole && !request.nc.is_empty() => {
            let program = program(job, target, milled, machine, (request, origin))?;
            let text = |dialect: &NcDialect| program_text(&program, *dialect, request);
            request.nc.iter().map(text).collect::<Result<Vec<_>, Failure>>()?
        }
        _ => Vec::new(),
    };
    let mut folder = Folder::at(&request.out, origin, session.monitor());
    for format in &request.format {
        match format {
            CutterFormat::Csv => folder.text(&format!("{name}.csv"), &table(target, milled))?,
            CutterFormat::Apt => folder.text(&format!("{name}.cl"), &apt(job, target, milled, request))?,
        }
    }
    let header = || solve::header(&[job], &request.jobs, origin);
    if !request.map.is_empty() {
        let dataset = map.dataset(job, target, header(), read);
        folder.data(&format!("{name}.left"), &dataset.surfaces(), &request.map)?;
    }
    for (extension, text) in &programs {
        folder.text(&format!("{name}.{extension}"), text)?;
    }
    folder.finish()
}

fn table(target: &Target<'_, '_>, milled: &Milled<'_, '_>) -> String {
    let area = &target.milling.area;
    let coordinate = |k: usize| match units::symbol(area.dimensions[k]) {
        "" => area.names[k].clone(),
        unit => format!("{}_{unit}", area.names[k]),
    };
    let axes: Vec<String> = milled
        .machine
        .iter()
        .flat_map(|machine| &machine.free)
        .map(|axis| format!("{}_{}", axis.name, units::symbol(axis.dimension)))
        .collect();
    let mut out = format!(
        "pass,position,{},{},x,y,z,nx,ny,nz,tip_x,tip_y,tip_z,axis_x,axis_y,axis_z",
        coordinate(0),
        coordinate(1)
    );
    axes.iter().for_each(|axis| out += &format!(",{axis}"));
    out.push('\n');
    for (pass, poses) in milled.poses.iter().enumerate() {
        for (position, pose) in poses.iter().enumerate() {
            let values = target.values(milled.shares(target, pass, position));
            let frame = milled.lattice.at(pass, milled.column(target, pass, position));
            let _ = write!(out, "{},{}", pass + 1, position + 1);
            let values = [0, 1].map(|k| units::shown(area.dimensions[k], values[k]));
            let numbers = values.iter().chain(&frame.position).chain(&frame.normal).chain(pose);
            numbers.for_each(|number| out += &format!(",{}", plain(*number)));
            let rows = milled.axes.get(pass).map_or(&[][..], |rows| &rows[position]);
            let free = milled.machine.iter().flat_map(|machine| &machine.free);
            free.zip(rows).for_each(|(axis, at)| out += &format!(",{}", plain(units::shown(axis.dimension, *at))));
            out.push('\n');
        }
    }
    out
}

/// Without a negative zero.
fn plain(number: f64) -> f64 {
    if number == 0.0 { 0.0 } else { number }
}

/// Cutter locations in the words of APT: the origin of the tool and its axis, in the frame of the work.
fn apt(job: &Job<'_>, target: &Target<'_, '_>, milled: &Milled<'_, '_>, request: &MillRequest) -> String {
    let milling = target.milling;
    let mut out = format!(
        "PARTNO/{}\n$$ MILLING {} OF {} WITH {}\n$$ POINTS ARE THE ORIGIN OF THE TOOL IN {}, MM; AXES POINT TOWARDS THE SPINDLE\n",
        job.name,
        milling.name,
        target.name(),
        milling.cutter_name,
        target.frame()
    );
    out += "UNITS/MM\nMULTAX/ON\n";
    for (pass, poses) in milled.poses.iter().enumerate() {
        let _ = writeln!(out, "$$ PASS {}", pass + 1);
        let away = |row: &[f64; 6]| lifted(row, request.approach);
        let (first, last) = (&poses[0], &poses[poses.len() - 1]);
        let _ = writeln!(out, "RAPID\n{}", goto(&away(first)));
        let _ = writeln!(out, "FEDRAT/{},MMPM", plain(request.feed));
        poses.iter().for_each(|pose| out += &format!("{}\n", goto(pose)));
        let _ = writeln!(out, "RAPID\n{}", goto(&away(last)));
    }
    out + "FINI\n"
}

fn goto(row: &[f64; 6]) -> String {
    let text = |k: usize| if k < 3 { format!("{:.6}", row[k]) } else { format!("{:.9}", row[k]) };
    format!("GOTO/{}", (0..6).map(text).collect::<Vec<_>>().join(","))
}

/// The same pose, moved along its axis.
fn lifted(row: &[f64; 6], by: f64) -> [f64; 6] {
    let [x, y, z, i, j, k] = *row;
    [x + by * i, y + by * j, z + by * k, i, j, k]
}

/// The same pose, turned about z.
fn indexed(row: &[f64; 6], angle: f64) -> [f64; 6] {
    let (s, c) = angle.sin_cos();
    let [x, y, z, i, j, k] = *row;
    [c * x - s * y, s * x + c * y, z, c * i - s * j, s * i + c * j, k]
}

fn program(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    milled: &Milled<'_, '_>,
    machine: &Machine<'_, '_>,
    (request, origin): (&MillRequest, &Origin),
) -> Result<PassProgram, Failure> {
    let milling = target.milling;
    let solid = job.solids.iter().find(|solid| solid.space.contains(&milling.surface));
    if request.spaces > 1 && solid.is_none() {
        let message = format!(
            "option `spaces {}`: nothing says how many spaces the work has: name {} in a `solid` of the job",
            request.spaces,
            target.name()
        );
        return Err(Failure::Request(message));
    }
    let teeth = solid.map_or(1, |solid| solid.teeth);
    if request.spaces > teeth {
        let message = format!("option `spaces {}`: the work has {teeth}", request.spaces);
        return Err(Failure::Request(message));
    }
    let mut passes = Vec::new();
    for space in 0..request.spaces {
        let turn = TAU * f64::from(space) / f64::from(teeth);
        for (pass, poses) in milled.poses.iter().enumerate() {
            let mut row: Vec<[f64; 6]> = poses.iter().map(|pose| indexed(pose, turn)).collect();
            let ends = [lifted(&row[0], request.approach), lifted(&row[row.len() - 1], request.approach)];
            row.insert(0, ends[0]);
            row.push(ends[1]);
            let name = if request.spaces > 1 {
                format!("space {} pass {}", space + 1, pass + 1)
            } else {
                format!("pass {}", pass + 1)
            };
            passes.push(ProgramPass {
                name,
                rows: machine.axes.along(&row),
                tips: row.iter().map(|[x, y, z, ..]| [*x, *y, *z]).collect(),
                ways: row.windows(2).map(|pair| super::distance(&pair[0], &pair[1]).max(1e-9)).collect(),
            });
        }
    }
    let axes: Vec<MachineAxis> = machine
        .free
        .iter()
        .map(|axis| MachineAxis {
            name: axis.name.clone(),
            address: axis.word.address.clone(),
            reversed: axis.word.reversed,
            offset: axis.word.offset,
            is_rotary: axis.dimension == Dimension::ANGLE,
            decimals: decimals(axis.dimension, &axis.word),
            travel: axis.travel.map(|(low, high)| [low, high]),
        })
        .collect();
    let title = format!("milling {}: {} with {}", milling.name, target.name(), milling.cutter_name);
    Ok(PassProgram {
        header: solve::header(&[job], &request.jobs, origin),
        title,
        retract: retract(machine, &passes),
        axes,
        passes,
        feed: request.feed,
        spindle: request.spindle,
        words: if request.tool_centre_control { WordsOf::Tip } else { WordsOf::Axes },
    })
}

/// The linear axis that moves the cutter most along its own axis, and its end away from the work.
fn retract(machine: &Machine<'_, '_>, passes: &[ProgramPass]) -> (usize, f64) {
    let row = &passes[0].rows[0];
    let here = machine.axes.pose(row);
    let along = |axis: usize| {
        let mut moved = row.clone();
        moved[axis] += 1.0;
        let there = machine.axes.pose(&moved);
        (0..3).map(|k| (there[k] - here[k]) * here[3 + k]).sum::<f64>()
    };
    let linear = (0..machine.free.len()).filter(|axis| !machine.axes.is_rotary(*axis));
    let (axis, rate) = linear
        .map(|axis| (axis, along(axis)))
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .expect("a machine with axes in closed form has linear ones");
    let positions = passes.iter().flat_map(|pass| &pass.rows).map(|row| row[axis]);
    let position = match (machine.free[axis].travel, rate > 0.0) {
        (Some((_, high)), true) => high,
        (Some((low, _)), false) => low,
        (None, true) => positions.fold(f64::NEG_INFINITY, f64::max) + AWAY,
        (None, false) => positions.fold(f64::INFINITY, f64::min) - AWAY,
    };
    (axis, position)
}

/// A program's extension and text.
fn program_text(
    program: &PassProgram,
    dialect: NcDialect,
    request: &MillRequest,
) -> Result<(&'static str, String), Failure> {
    if request.tool_centre_control && dialect == NcDialect::LinuxCnc {
        let message =
            "LinuxCNC keeps no tool on its way by itself: leave option `tool_centre_control` out for its programs";
        return Err(Failure::Request(message.to_string()));
    }
    let dialect = Dialect::from(dialect);
    let mut text = Vec::new();
    write_passes(program, dialect, &mut text).map_err(|error| error.to_string())?;
    Ok((dialect.extension(), String::from_utf8(text).expect("programs are ASCII")))
}

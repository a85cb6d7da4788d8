//! What `flank mill` leaves in its folder: cutter locations, a table, NC programs.

use std::fmt::Write;

use flank_chain_dsl::{Dimension, Job, PassSpacing};
use flank_export::{Dialect, MachineAxis, PassProgram, ProgramPass, ProgramRapid, WordsOf, write_passes};

use super::control::Control;
use super::left::LeftMap;
use super::machine::Machine;
use super::retract::{Retracts, retracts};
use super::target::Target;
use super::{Found, Milled, verify};
use crate::convert::files::decimals;
use crate::project::choices::{CutterFormat, NcDialect};
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::remark::{NotDone, Remark, RemarkKind};
use crate::project::requests::MillRequest;
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve;

/// How many times faster than its contact the tip of a cutter may go.
const SWING: f64 = 10.0;

/// A program: the extension of its file, and its text.
pub(super) type ProgramText = (&'static str, String);

/// That the controls can do what is asked for.
///
/// # Errors
/// If one cannot.
pub(super) fn check(request: &MillRequest) -> Result<(), Failure> {
    if request.tool_centre_control && request.nc.contains(&NcDialect::LinuxCnc) {
        let message =
            "LinuxCNC keeps no tool on its way by itself: leave option `tool_centre_control` out for its programs";
        return Err(Failure::Request(message.to_string()));
    }
    Ok(())
}

/// What programs do not say, or what was asked for of them while there are none.
pub(super) fn unsaid(target: &Target<'_, '_>, request: &MillRequest, programs: &[ProgramText]) -> Vec<Remark> {
    let remark = |message: &str, way: &str| {
        Remark::new(RemarkKind::Unsaid, &target.milling.name, message).with(vec![way.to_string()])
    };
    let still = !programs.is_empty() && request.spindle.is_none();
    let still = still.then(|| {
        remark(
            "the program does not start the spindle: no speed is said",
            "option `spindle` says how fast the cutter turns",
        )
    });
    let unwritten = request.tool_centre_control && request.nc.is_empty() && request.verify.is_none();
    let unwritten = unwritten.then(|| {
        remark(
            "option `tool_centre_control` lets the tip go straight in the work, and no program is asked for",
            "option `nc` names the controls that programs are for",
        )
    });
    still.into_iter().chain(unwritten).collect()
}

/// The programs that are asked for; none where a rapid of them would cut into the work, and that.
///
/// # Errors
/// If a control cannot do what a program needs.
pub(super) fn programs(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    found: &Found<'_, '_>,
    (request, origin, session): (&MillRequest, &Origin, Session<'_>),
) -> Result<(Vec<ProgramText>, Option<NotDone>), Failure> {
    let Some(machine) = found.milled.machine.as_ref().filter(|_| !request.nc.is_empty()) else {
        return Ok((Vec::new(), None));
    };
    let control = match request.tool_centre_control.then(|| Control::of_machine(machine)).transpose() {
        Ok(control) => control,
        Err(unknown) => return Ok((Vec::new(), Some(unknown.told(machine)))),
    };
    let passes = program(job, target, found, (machine, control.as_ref()), (request, origin));
    let text = |dialect: &NcDialect| program_text(&passes, *dialect);
    let texts = request.nc.iter().map(text).collect::<Result<Vec<ProgramText>, Failure>>()?;
    session.check()?;
    // the controls differ by their words only
    let refused = texts.first().map(|(_, text)| verify::rapids(text, target, found, machine)).transpose()?.flatten();
    Ok(if refused.is_some() { (Vec::new(), refused) } else { (texts, None) })
}

/// Writes what is asked for and names it.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn write(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    (milled, (map, read)): (&Milled<'_, '_>, (&LeftMap, Option<&LeftMap>)),
    (request, origin, session): (&MillRequest, &Origin, Session<'_>),
    programs: &[ProgramText],
) -> Result<Vec<String>, Failure> {
    let name = format!("{}.{}", job.name, target.milling.name);
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
    for (extension, text) in programs {
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
        let _ = writeln!(out, "FEDRAT/{},MMPM\n{}", plain(request.feed), goto(first));
        let mut feed = plain(request.feed);
        for (pair, way) in poses.windows(2).zip(ways(target, milled, pass)) {
            // FEDRAT is the tip's
            let tip = (10.0 * request.feed * super::distance(&pair[0], &pair[1]) / way).round() / 10.0;
            if tip != feed && tip > 0.0 {
                let _ = writeln!(out, "FEDRAT/{},MMPM", plain(tip));
                feed = tip;
            }
            let _ = writeln!(out, "{}", goto(&pair[1]));
        }
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

fn program(
    job: &Job<'_>,
    target: &Target<'_, '_>,
    found: &Found<'_, '_>,
    (machine, control): (&Machine<'_, '_>, Option<&Control>),
    (request, origin): (&MillRequest, &Origin),
) -> PassProgram {
    let milling = target.milling;
    let mut poses = Vec::new();
    for space in 0..request.spaces {
        let place = found.spaces.place(space);
        for (pass, along) in found.milled.poses.iter().enumerate() {
            let mut row: Vec<[f64; 6]> = along.iter().map(|pose| place.placed(pose)).collect();
            let ways = ways(target, &found.milled, pass);
            let ends = [lifted(&row[0], request.approach), lifted(&row[row.len() - 1], request.approach)];
            row.insert(0, ends[0]);
            row.push(ends[1]);
            let name = if request.spaces > 1 {
                format!("space {} pass {}", space + 1, pass + 1)
            } else {
                format!("pass {}", pass + 1)
            };
            poses.push((name, machine.axes.along(&row), row, ways));
        }
    }
    let rows: Vec<&[Vec<f64>]> = poses.iter().map(|(_, rows, ..)| rows.as_slice()).collect();
    let hull = found.spaces.hull(&found.milled.lattice, &found.guarded);
    let Retracts { home, end, is_upright, of_passes } = retracts(machine, &rows, (hull, request.tool_centre_control));
    let words = |tip: [f64; 3]| control.map_or(tip, |control| control.words(tip));
    let framed = |rapids: Vec<ProgramRapid>| {
        let framed = |rapid: ProgramRapid| ProgramRapid { tip: words(rapid.tip), ..rapid };
        rapids.into_iter().map(framed).collect()
    };
    let passes = poses.into_iter().zip(of_passes).map(|((name, rows, poses, ways), [approach, away])| ProgramPass {
        name,
        approach: framed(approach),
        rows,
        tips: poses.iter().map(|[x, y, z, ..]| words([*x, *y, *z])).collect(),
        ways: [&[request.approach], &ways[..], &[request.approach]].concat(),
        away: framed(away),
    });
    let passes = passes.collect();
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
    PassProgram {
        header: solve::header(&[job], &request.jobs, origin),
        title,
        home,
        end,
        is_upright,
        axes,
        passes,
        feed: request.feed,
        spindle: request.spindle,
        words: control.map_or(WordsOf::Axes, |control| WordsOf::Tip(control.frame(target.frame()))),
    }
}

/// The ways of the contact between the positions of a pass, mm. Where the cutter turns about a contact that hardly moves, its tip goes no faster than
/// [`SWING`] times the feed; a side touches along a line, and its way is that of the tip.
fn ways(target: &Target<'_, '_>, milled: &Milled<'_, '_>, pass: usize) -> Vec<f64> {
    let is_side = matches!(target.milling.spacing, PassSpacing::Side(_));
    let contact = |position: usize| milled.lattice.at(pass, milled.column(target, pass, position)).position;
    let way = |(position, pair): (usize, &[[f64; 6]])| {
        let tip = super::distance(&pair[0], &pair[1]).max(1e-9);
        let [a, b] = [contact(position), contact(position + 1)];
        let along = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        if is_side { tip } else { along.max(tip / SWING) }
    };
    milled.poses[pass].windows(2).enumerate().map(way).collect()
}

/// A program's extension and text.
fn program_text(program: &PassProgram, dialect: NcDialect) -> Result<ProgramText, Failure> {
    let dialect = Dialect::from(dialect);
    let mut text = Vec::new();
    write_passes(program, dialect, &mut text).map_err(|error| error.to_string())?;
    Ok((dialect.extension(), String::from_utf8(text).expect("programs are ASCII")))
}

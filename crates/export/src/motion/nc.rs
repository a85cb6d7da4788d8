//! A motion table as an NC program (ISO 6983).

use std::io::Write;

use super::dialect::Dialect;
use super::table::{MachineAxis, MotionTable};
use crate::files::error::WriteError;
use crate::text::number::{plain, shortest};

/// Why a motion table makes no NC program.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NcError {
    /// A program moves from a position to others.
    #[error("an NC program needs at least two positions, the table has {rows}")]
    TooFewRows {
        /// Positions it has.
        rows: usize,
    },
    /// A position that the axis cannot take.
    #[error("axis `{axis}` would have to go to {position} at {motion}, its travel is {travel}")]
    BeyondTravel {
        /// Name of the axis.
        axis: String,
        /// The position as it would be written, with its unit.
        position: String,
        /// Name, value and unit of the motion there.
        motion: String,
        /// Its ends with their unit.
        travel: String,
    },
    /// The control has no such axis.
    #[error("{dialect} has no axis address `{address}`, which axis `{axis}` has: {known}")]
    Address {
        /// Name of the axis.
        axis: String,
        /// Its address.
        address: String,
        /// Name of the control.
        dialect: &'static str,
        /// What it knows.
        known: &'static str,
    },
    /// One word cannot move two axes.
    #[error("axes `{first}` and `{second}` have the same address `{address}`")]
    SameAddress {
        /// Name of one.
        first: String,
        /// Name of the other.
        second: String,
        /// Their address.
        address: String,
    },
    /// The times of blocks follow from the motion, which therefore must go on.
    #[error("the motion stands still or turns back at {motion}: the cutting time cannot be shared out")]
    TurnsBack {
        /// Name, value and unit of the motion there.
        motion: String,
    },
    /// No time to cut in.
    #[error("a cutting time of {seconds} s is not a time to cut in")]
    Time {
        /// Seconds asked for.
        seconds: f64,
    },
    /// A block is too short or too long for the control.
    #[error(
        "the block to {motion} would take {seconds:.3e} s, {kind}: {feed:.3e}; {dialect} takes {low} .. {high}: \
         change the cutting time or the number of positions"
    )]
    Feed {
        /// Name, value and unit of the motion at its end.
        motion: String,
        /// Its time.
        seconds: f64,
        /// What its feed is.
        kind: &'static str,
        /// Its feed.
        feed: f64,
        /// Name of the control.
        dialect: &'static str,
        /// Least feed that it takes.
        low: f64,
        /// Largest feed that it takes.
        high: f64,
    },
}

impl From<NcError> for WriteError {
    fn from(error: NcError) -> WriteError {
        WriteError::Refused(Box::new(error))
    }
}

/// Writes an NC program that passes the rows in order, in straight lines of all axes at once with inverse-time feed (`G93`).
///
/// Heidenhain's language has no inverse-time feed: there `F` is the block's length over mm and degrees alike, per minute.
///
/// The approach to the first row is a rapid. `cutting_time` in seconds is shared out over the blocks as the motion goes on in
/// them. The head states conventions, spec and hash, and a table of the axes; positions have the decimals of their axis, in mm
/// and degrees, absolute, and angles go on beyond a turn.
///
/// ```
/// # use flank_export::{Dialect, Header, MachineAxis, MotionRow, MotionTable, Unit, Unknown, write_nc};
/// # let header = Header {
/// #     program: "flank 0.1.0".into(),
/// #     spec: "table.chain".into(),
/// #     spec_hash: "5e1f".into(),
/// #     job: "swing".into(),
/// #     conventions: Vec::new(),
/// # };
/// let slide = MachineAxis {
///     name: "slide".into(),
///     address: "X".into(),
///     reversed: false,
///     offset: 0.0,
///     is_rotary: false,
///     decimals: 3,
///     travel: Some([-50.0, 50.0]),
/// };
/// let row = |motion, x| MotionRow { motion, axes: vec![x] };
/// let table = MotionTable {
///     header,
///     motion: Unknown { name: "roll".into(), unit: Unit::Degree },
///     axes: vec![slide],
///     rows: vec![row(0.0, 12.5), row(0.1, -12.0), row(0.4, 7.0)],
///     series: None,
///     rates: None,
/// };
/// let mut file = Vec::new();
/// write_nc(&table, Dialect::Fanuc, 6.0, &mut file)?;
/// let text = String::from_utf8(file)?;
/// assert!(text.contains("N20 G00 X12.500\nN30 G93\nN40 G01 X-12.000 F40.000\nN50 X7.000 F13.333\n"), "{text}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the table is malformed or makes no program ([`NcError`]: a position beyond its axis's travel names axis and motion), or
/// the stream refuses.
pub fn write_nc(
    table: &MotionTable,
    dialect: Dialect,
    cutting_time: f64,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    table.check()?;
    check_axes(&table.axes, dialect)?;
    let blocks = blocks(table, dialect, cutting_time)?;
    let step = dialect.numbering(blocks.len());
    for line in dialect.opening() {
        writeln!(out, "{line}")?;
    }
    for line in head(table, dialect, cutting_time).iter().flat_map(|remark| dialect.remark(remark)) {
        writeln!(out, "{line}")?;
    }
    for (index, block) in blocks.iter().enumerate() {
        match step {
            Some(step) => writeln!(out, "N{} {block}", (index + 1) * step)?,
            None => writeln!(out, "{block}")?,
        }
    }
    for line in dialect.closing() {
        writeln!(out, "{line}")?;
    }
    Ok(())
}

pub(super) fn check_axes(axes: &[MachineAxis], dialect: Dialect) -> Result<(), NcError> {
    for (index, axis) in axes.iter().enumerate() {
        if !dialect.has_axis(&axis.address) {
            return Err(NcError::Address {
                axis: axis.name.clone(),
                address: axis.address.clone(),
                dialect: dialect.name(),
                known: match dialect {
                    Dialect::Siemens840D => "it has A B C Q U V W X Y Z, alone or with a number behind",
                    Dialect::Fanuc | Dialect::LinuxCnc | Dialect::Heidenhain => "it has A B C U V W X Y Z",
                },
            });
        }
        if let Some(other) = axes[..index].iter().find(|other| other.address == axis.address) {
            return Err(NcError::SameAddress {
                first: other.name.clone(),
                second: axis.name.clone(),
                address: axis.address.clone(),
            });
        }
    }
    Ok(())
}

/// What the program says of itself.
fn head(table: &MotionTable, dialect: Dialect, cutting_time: f64) -> Vec<String> {
    let header = &table.header;
    let mut head = vec![
        format!("job {}, for {}", header.job, dialect.name()),
        format!("by {}, spec {}, hash {}", header.program, header.spec, header.spec_hash),
    ];
    head.extend(
        table
            .sentences("axes are counted as the control does, see their lines below")
            .into_iter()
            .map(|sentence| format!("- {sentence}")),
    );
    head.push("- no rotary axis may roll over, positions are absolute".to_owned());
    head.push(dialect.zero_of_axes());
    head.push("- the first block is a rapid of all axes to the first position".to_owned());
    head.push(format!("- cutting time {} s, {}", shortest(cutting_time), dialect.feed_kind()));
    let ends = [table.rows.first(), table.rows.last()].map(|row| row.map_or(0.0, |row| row.motion));
    let [first, last] = ends.map(|value| motion_text(table, value));
    head.push(format!("motion from {first} to {last}, {} positions", table.rows.len()));
    head.extend(table.axes.iter().enumerate().map(|(index, axis)| axis_line(table, index, axis)));
    head
}

fn axis_line(table: &MotionTable, index: usize, axis: &MachineAxis) -> String {
    extent_line(axis, table.extent(index).unwrap_or_default())
}

/// What is said of an axis in the head.
pub(super) fn extent_line(axis: &MachineAxis, mut ends: [f64; 2]) -> String {
    let unit = axis.unit().symbol();
    if axis.reversed {
        ends.reverse();
    }
    let [low, high] = ends.map(|position| axis.printed(position));
    let travel = axis.travel.map(|ends| axis.written(axis.programmed_ends(ends)));
    let travel = match travel.map(|ends| ends.map(shortest)) {
        Some([low, high]) => format!("travel {low} .. {high} {unit}"),
        None => "travel not limited".to_owned(),
    };
    let sign = if axis.reversed { "-" } else { "" };
    let [offset, _] = axis.written([axis.offset; 2]);
    let offset = match offset {
        0.0 => String::new(),
        offset => format!(" {} {} {unit}", if offset < 0.0 { '-' } else { '+' }, shortest(plain(offset.abs()))),
    };
    format!("axis {}: {sign}{}{offset}, from {low} to {high} {unit}, {travel}", axis.address, axis.name)
}

/// All blocks between the opening and the closing, without numbers.
fn blocks(table: &MotionTable, dialect: Dialect, cutting_time: f64) -> Result<Vec<String>, NcError> {
    let feeds = feeds(table, dialect, cutting_time)?;
    let decimals = table.axes.iter().filter(|axis| !axis.is_rotary).map(|axis| axis.decimals).max().unwrap_or(3);
    let least_increment = format!("{:.*}", usize::from(decimals), 10f64.powi(-i32::from(decimals)));
    let mut blocks = Vec::from_iter(dialect.settling(&least_increment));
    let (straight, holds) = dialect.straight();
    for (index, feed) in [None].into_iter().chain(feeds.into_iter().map(Some)).enumerate() {
        let words = positions(table, dialect, index)?.join(" ");
        let Some(feed) = feed else {
            blocks.push(dialect.rapid(&words));
            blocks.extend(dialect.inverse_time().map(|[on, _]| on.to_owned()));
            continue;
        };
        let before = if index == 1 || !holds { format!("{straight} ") } else { String::new() };
        blocks.push(format!("{before}{words} F{feed:.*}", dialect.feed_decimals()));
    }
    blocks.extend(dialect.inverse_time().map(|[_, off]| off.to_owned()));
    blocks.push("M30".to_owned());
    Ok(blocks)
}

/// The axis words of a row.
fn positions(table: &MotionTable, dialect: Dialect, row: usize) -> Result<Vec<String>, NcError> {
    let row = &table.rows[row];
    let word = |(axis, position): (&MachineAxis, &f64)| {
        axis_word(axis, *position, dialect, &|| motion_text(table, row.motion))
    };
    table.axes.iter().zip(&row.axes).map(word).collect()
}

/// Puts the word of an axis behind a text, if it is within the travel, as programs count it; `place` says where it would not be.
pub(super) fn push_axis_word(
    (axis, [low, high]): (&MachineAxis, [f64; 2]),
    position: f64,
    dialect: Dialect,
    place: &dyn Fn() -> String,
    text: &mut String,
) -> Result<(), NcError> {
    /// What conversion to degrees may add to an end of the travel.
    const ROUNDING: f64 = 1e-9;
    dialect.address(&axis.address, text);
    let from = text.len();
    let printed = axis.print(position, text);
    if !(printed >= low - ROUNDING && printed <= high + ROUNDING) {
        let unit = axis.unit().symbol();
        return Err(NcError::BeyondTravel {
            axis: axis.name.clone(),
            position: format!("{} {unit}", &text[from..]),
            motion: place(),
            travel: format!("{} .. {} {unit}", shortest(low), shortest(high)),
        });
    }
    dialect.sign(from, text);
    Ok(())
}

/// The same alone.
pub(super) fn axis_word(
    axis: &MachineAxis,
    position: f64,
    dialect: Dialect,
    place: &dyn Fn() -> String,
) -> Result<String, NcError> {
    let mut text = String::new();
    push_axis_word((axis, axis.printed_travel()), position, dialect, place, &mut text)?;
    Ok(text)
}

/// The length of a block over mm and degrees alike.
pub(super) fn block_length(axes: &[MachineAxis], from: &[f64], to: &[f64]) -> f64 {
    let of_axis = |((axis, from), to): ((&MachineAxis, &f64), &f64)| axis.unit().written(to - from).powi(2);
    axes.iter().zip(from).zip(to).map(of_axis).sum::<f64>().sqrt()
}

/// The feed of each block but the first.
fn feeds(table: &MotionTable, dialect: Dialect, cutting_time: f64) -> Result<Vec<f64>, NcError> {
    let (Some(first), Some(last)) = (table.rows.first(), table.rows.last().filter(|_| table.rows.len() > 1)) else {
        return Err(NcError::TooFewRows { rows: table.rows.len() });
    };
    if !(cutting_time > 0.0 && cutting_time.is_finite()) {
        return Err(NcError::Time { seconds: cutting_time });
    }
    let whole = last.motion - first.motion;
    let feed = |pair: &[super::MotionRow]| {
        let share = (pair[1].motion - pair[0].motion) / whole;
        if !(share > 0.0 && share.is_finite()) {
            return Err(NcError::TurnsBack { motion: motion_text(table, pair[1].motion) });
        }
        let seconds = share * cutting_time;
        let feed = dialect.feed(seconds, block_length(&table.axes, &pair[0].axes, &pair[1].axes));
        let range = dialect.feeds();
        if !range.contains(&feed) {
            return Err(NcError::Feed {
                motion: motion_text(table, pair[1].motion),
                seconds,
                kind: dialect.feed_kind(),
                feed,
                dialect: dialect.name(),
                low: *range.start(),
                high: *range.end(),
            });
        }
        Ok(feed)
    };
    table.rows.windows(2).map(feed).collect()
}

/// A value of the motion for people: to a millionth, without trailing zeros.
fn motion_text(table: &MotionTable, value: f64) -> String {
    let unit = table.motion.unit;
    let rounded = (unit.written(value) * 1e6).round() / 1e6;
    let behind = if unit == crate::points::dataset::Unit::One { "" } else { unit.symbol() };
    format!("{} = {} {behind}", table.motion.name, shortest(plain(rounded))).trim_end().to_owned()
}

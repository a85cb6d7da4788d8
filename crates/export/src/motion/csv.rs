//! A motion table as comma-separated values, under a head of `# ` lines.

use std::io::{self, Write};

use super::table::{AS_IN_THE_SPEC, MotionTable};
use crate::files::error::WriteError;
use crate::text::number::shortest;
use crate::text::one_line;

/// Behind the names of axes.
const RATES: [&str; 3] = ["velocity", "acceleration", "jerk"];

/// Writes one line for each row: the value of the motion, then the position of each axis, then, where they are known, velocity,
/// acceleration and jerk of each.
///
/// `# ` lines state the conventions, the axes with unit, address and range, and the polynomials. Lengths are mm, angles degrees,
/// numbers the shortest text that reads back as the same bits.
///
/// ```
/// # use flank_export::{Header, MachineAxis, MotionRow, MotionTable, Unit, Unknown, write_motion_csv};
/// let axis = |name: &str, is_rotary| MachineAxis {
///     name: name.into(),
///     address: name.into(),
///     reversed: false,
///     offset: 0.0,
///     is_rotary,
///     decimals: 4,
///     travel: None,
/// };
/// let table = MotionTable {
///     header: Header {
///         program: "flank 0.1.0".into(),
///         spec: "table.chain".into(),
///         spec_hash: "5e1f".into(),
///         job: "swing".into(),
///         conventions: Vec::new(),
///     },
///     motion: Unknown { name: "roll".into(), unit: Unit::Degree },
///     axes: vec![axis("X", false), axis("B", true)],
///     rows: vec![MotionRow { motion: 0.0, axes: vec![12.5, std::f64::consts::PI] }],
///     series: None,
///     rates: None,
/// };
/// let mut file = Vec::new();
/// write_motion_csv(&table, &mut file)?;
/// assert!(String::from_utf8(file)?.ends_with("\nroll,X,B\n0,12.5,180\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the table is malformed, or the stream refuses.
pub fn write_motion_csv(table: &MotionTable, out: &mut dyn Write) -> Result<(), WriteError> {
    table.check()?;
    write_head(table, out)?;
    let mut lines = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(out);
    let titles = [&table.motion.name].into_iter().chain(table.axes.iter().map(|axis| &axis.name)).cloned();
    let of_rates = table.axes.iter().flat_map(|axis| RATES.map(|rate| format!("{} {rate}", axis.name)));
    let of_rates = of_rates.filter(|_| table.rates.is_some());
    lines.write_record(titles.chain(of_rates)).map_err(io::Error::from)?;
    for (index, row) in table.rows.iter().enumerate() {
        let motion = table.motion.unit.written(row.motion);
        let axes = table.axes.iter().zip(&row.axes).map(|(axis, position)| axis.unit().written(*position));
        let rates = table.written_rates(index).into_iter().flatten().flatten();
        lines.write_record([motion].into_iter().chain(axes).chain(rates).map(shortest)).map_err(io::Error::from)?;
    }
    lines.flush()?;
    Ok(())
}

fn write_head(table: &MotionTable, out: &mut dyn Write) -> io::Result<()> {
    let header = &table.header;
    writeln!(out, "# {}", one_line(&header.program))?;
    writeln!(out, "# spec: {}, hash {}", one_line(&header.spec), one_line(&header.spec_hash))?;
    writeln!(out, "# job: {}", one_line(&header.job))?;
    for sentence in table.sentences(AS_IN_THE_SPEC) {
        writeln!(out, "# {sentence}")?;
    }
    let motion = one_line(&table.motion.name);
    writeln!(out, "# motion `{motion}` in {}", table.motion.unit.symbol())?;
    for (index, axis) in table.axes.iter().enumerate() {
        let (name, unit) = (one_line(&axis.name), axis.unit().symbol());
        write!(out, "# axis `{name}` in {unit}, address {}", one_line(&axis.address))?;
        if let Some([low, high]) = table.extent(index).map(|ends| axis.written(ends).map(shortest)) {
            write!(out, ", from {low} to {high}")?;
        }
        if let Some([low, high]) = axis.travel.map(|ends| axis.written(ends).map(shortest)) {
            write!(out, ", travel {low} to {high}")?;
        }
        writeln!(out)?;
    }
    if let Some(rates) = &table.rates {
        let seconds = shortest(rates.seconds);
        writeln!(
            out,
            "# velocity, acceleration and jerk: per s, s^2 and s^3, while the motion takes {seconds} s evenly"
        )?;
    }
    let Some(series) = table.written_series() else { return Ok(()) };
    let sign = if series.reference < 0.0 { '+' } else { '-' };
    let reference = shortest(series.reference.abs());
    writeln!(
        out,
        "# polynomials: factors of the powers of ({motion} {sign} {reference}), constant first, in these units"
    )?;
    for (axis, of_axis) in table.axes.iter().zip(&series.axes) {
        let factors: Vec<String> = of_axis.coefficients.iter().copied().map(shortest).collect();
        write!(out, "# polynomial of `{}`: {}", one_line(&axis.name), factors.join(" "))?;
        match of_axis.remainder {
            Some(bound) => writeln!(out, "; remainder within {} {}", shortest(bound), axis.unit().symbol())?,
            None => writeln!(out)?,
        }
    }
    Ok(())
}

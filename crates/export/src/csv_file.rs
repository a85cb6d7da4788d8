//! Points as comma-separated values, under a head of `# ` lines.

use std::io::{self, Write};

use crate::conventions::{one_line, sentences};
use crate::dataset::{Dataset, Patch, Point, Unit, Unknown};
use crate::error::WriteError;
use crate::number::shortest;
use crate::tally::Tally;

const FIRST: [&str; 9] = ["surface", "i", "j", "x", "y", "z", "nx", "ny", "nz"];
const LAST: [&str; 2] = ["residual", "status"];

/// Writes all points as CSV.
///
/// `# ` lines state the conventions. The columns are `surface, i, j, x, y, z, nx, ny, nz`, then the unknowns of all
/// patches in order of first appearance, then `residual, status`. Positions are mm, angles degrees, numbers the shortest
/// text that reads back as the same bits. Cells are empty where a patch has no such unknown and where a point is not
/// solved. An unknown whose name is taken by another column is written as `name [unit]`.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_csv(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    write_head(dataset, out)?;
    let unknowns = union_of_unknowns(&dataset.patches);
    let mut table = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(out);
    let names = unknowns.iter().map(|unknown| column_name(unknown, &unknowns));
    let titles = FIRST.iter().map(|&name| name.to_owned()).chain(names).chain(LAST.iter().map(|&name| name.to_owned()));
    table.write_record(titles).map_err(io::Error::from)?;
    for patch in &dataset.patches {
        let places: Vec<Option<usize>> =
            unknowns.iter().map(|wanted| patch.unknowns.iter().position(|unknown| unknown == *wanted)).collect();
        for (i, j, point) in patch.indexed_points() {
            table.write_record(record(patch, i, j, point, &places)).map_err(io::Error::from)?;
        }
    }
    table.flush()?;
    Ok(())
}

fn write_head(dataset: &Dataset, out: &mut dyn Write) -> io::Result<()> {
    let header = &dataset.header;
    writeln!(out, "# {}", one_line(&header.program))?;
    writeln!(out, "# spec: {}, hash {}", one_line(&header.spec), one_line(&header.spec_hash))?;
    writeln!(out, "# job: {}", one_line(&header.job))?;
    for sentence in sentences(dataset) {
        writeln!(out, "# {sentence}")?;
    }
    for unknown in union_of_unknowns(&dataset.patches) {
        writeln!(out, "# unknown `{}` in {}", one_line(&unknown.name), unknown.unit.symbol())?;
    }
    for patch in &dataset.patches {
        writeln!(
            out,
            "# surface `{}`: frame {}; {} rows i: {}; {} columns j: {}; {}",
            one_line(&patch.name),
            one_line(&patch.frame),
            patch.rows.count,
            one_line(&patch.rows.label),
            patch.columns.count,
            one_line(&patch.columns.label),
            verdict(&Tally::of([patch])),
        )?;
    }
    writeln!(out, "# all surfaces: {}", verdict(&Tally::of(&dataset.patches)))
}

fn verdict(tally: &Tally) -> String {
    let mut text = format!("solved {} of {} asked", tally.solved, tally.asked);
    if !tally.unsolved.is_empty() {
        text += &format!(" ({})", one_line(&tally.reasons()));
    }
    match tally.worst_residual {
        Some(worst) => text + ", worst residual " + &shortest(worst),
        None => text,
    }
}

fn union_of_unknowns(patches: &[Patch]) -> Vec<&Unknown> {
    let mut union: Vec<&Unknown> = Vec::new();
    for unknown in patches.iter().flat_map(|patch| &patch.unknowns) {
        if !union.contains(&unknown) {
            union.push(unknown);
        }
    }
    union
}

fn column_name(unknown: &Unknown, all: &[&Unknown]) -> String {
    let taken = FIRST.iter().chain(&LAST).any(|&fixed| fixed == unknown.name);
    let shared = all.iter().filter(|other| other.name == unknown.name).count() > 1;
    if taken || shared { format!("{} [{}]", unknown.name, unknown.unit.symbol()) } else { unknown.name.clone() }
}

fn record(patch: &Patch, i: usize, j: usize, point: &Point, places: &[Option<usize>]) -> Vec<String> {
    let mut cells = vec![patch.name.clone(), i.to_string(), j.to_string()];
    let number = |unit: Unit, value: Option<&f64>| match value {
        Some(&value) if point.is_solved() => shortest(unit.written(value)),
        _ => String::new(),
    };
    cells.extend(point.position.iter().map(|x| number(Unit::Millimetre, Some(x))));
    cells.extend(point.normal.iter().map(|x| number(Unit::One, Some(x))));
    cells.extend(places.iter().map(|place| match *place {
        Some(k) => number(patch.unknowns[k].unit, point.unknowns.get(k)),
        None => String::new(),
    }));
    cells.push(point.known_residual().map_or_else(String::new, shortest));
    cells.push(point.outcome.word().to_owned());
    cells
}

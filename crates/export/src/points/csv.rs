//! Points as comma-separated values, under a head of `# ` lines.

use std::io::{self, Write};

use crate::files::error::WriteError;
use crate::points::bands::{Seen, Surfaces};
use crate::points::columns::{titles, union_of_fields, union_of_unknowns};
use crate::points::conventions::sentences;
use crate::points::dataset::{Field, Patch, Point};
use crate::text::number::push_shortest;
use crate::text::one_line;

/// Writes all points as CSV.
///
/// `# ` lines state the conventions. The columns are `surface, i, j, x, y, z, nx, ny, nz`, then the unknowns of all
/// patches in order of first appearance, then `residual, status`, `reason` if a point has one, then the fields of all patches (three columns for a
/// vector). Positions are mm, angles degrees, numbers the shortest
/// text that reads back as the same bits. Cells are empty where a patch has no such unknown or field, where a field is
/// not defined and where a point has no numbers: only points that are solved, undercut, trimmed or undecided have a position, a normal and
/// unknowns, and only solved ones have fields. An unknown or a field whose title is taken by another column is written as
/// `name [unit]`.
///
/// The points are asked for twice.
///
/// # Errors
/// When a surface is malformed or cannot hand over its points, or the stream refuses.
pub fn write_csv(surfaces: &Surfaces<'_>, out: &mut dyn Write) -> Result<(), WriteError> {
    let seen = Seen::of_surfaces(surfaces)?;
    write_head(surfaces, &seen, out)?;
    let unknowns = union_of_unknowns(surfaces.outlines());
    let fields = union_of_fields(surfaces.outlines());
    let titles: Vec<String> = titles(&unknowns, seen.told, &fields).iter().map(|title| quoted(title)).collect();
    writeln!(out, "{}", titles.join(","))?;
    let mut line = Vec::new();
    for surface in &surfaces.list {
        let patch = surface.outline();
        let name = quoted(&patch.name);
        let places: Vec<Option<usize>> =
            unknowns.iter().map(|wanted| patch.unknowns.iter().position(|unknown| unknown == *wanted)).collect();
        let own: Vec<Option<&Field>> =
            fields.iter().map(|wanted| patch.fields.iter().find(|field| field.shares_columns(wanted))).collect();
        let mut first = 0;
        surface.bands(&mut |points| {
            for (at, (i, j, point)) in (first..).zip(patch.numbered(first, points)) {
                line.clear();
                write!(line, "{name},{i},{j}")?;
                push_point(&mut line, patch, point, &places);
                write!(line, ",{}", point.outcome.word())?;
                if seen.told {
                    write!(line, ",{}", quoted(&one_line(&point.reason)))?;
                }
                fields.iter().zip(&own).for_each(|(wanted, own)| push_field(&mut line, wanted, *own, at, point));
                line.push(b'\n');
                out.write_all(&line)?;
            }
            first += points.len();
            Ok(())
        })?;
    }
    Ok(())
}

/// A text as a cell.
fn quoted(text: &str) -> String {
    if text.is_empty() {
        return String::new();
    }
    let mut table = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(Vec::new());
    table.write_record([text]).expect("memory takes a text");
    let mut cell = String::from_utf8(table.into_inner().expect("memory takes a text")).expect("it was a text before");
    cell.truncate(cell.len() - 1); // the end of the line
    cell
}

fn write_head(surfaces: &Surfaces<'_>, seen: &Seen, out: &mut dyn Write) -> io::Result<()> {
    let header = surfaces.header;
    writeln!(out, "# {}", one_line(&header.program))?;
    writeln!(out, "# spec: {}, hash {}", one_line(&header.spec), one_line(&header.spec_hash))?;
    writeln!(out, "# job: {}", one_line(&header.job))?;
    for sentence in sentences(header) {
        writeln!(out, "# {sentence}")?;
    }
    for unknown in union_of_unknowns(surfaces.outlines()) {
        writeln!(out, "# unknown `{}` in {}", one_line(&unknown.name), unknown.unit.symbol())?;
    }
    for field in union_of_fields(surfaces.outlines()) {
        let [name, unit, meaning] = [&field.name, &field.unit, &field.meaning].map(|text| one_line(text));
        writeln!(out, "# field `{name}` in {unit}: {meaning}")?;
    }
    for (patch, tally) in surfaces.outlines().zip(&seen.tallies) {
        writeln!(out, "# surface `{}`: {}", one_line(&patch.name), patch.told(tally))?;
    }
    writeln!(out, "# all surfaces: {}", seen.all.verdict())
}

/// What a point has in the columns of a field; empty cells if the point's patch has no such field.
fn push_field(line: &mut Vec<u8>, wanted: &Field, own: Option<&Field>, at: usize, point: &Point) {
    match own.map(|field| field.values.at(at)) {
        Some(numbers) if point.is_solved() && !numbers.is_empty() => {
            numbers.iter().for_each(|number| push_cell(line, Some(*number)));
        }
        _ => wanted.columns().iter().for_each(|_| push_cell(line, None)),
    }
}

/// Position, normal, the unknowns at their `places` among those of all patches, and the residual.
fn push_point(line: &mut Vec<u8>, patch: &Patch, point: &Point, places: &[Option<usize>]) {
    let is_placed = point.is_placed();
    let of_point = point.position.iter().chain(&point.normal);
    of_point.for_each(|number| push_cell(line, Some(*number).filter(|_| is_placed)));
    for place in places {
        let value = place.and_then(|k| Some(patch.unknowns[k].unit.written(*point.unknowns.get(k)?)));
        push_cell(line, value.filter(|_| is_placed));
    }
    push_cell(line, point.known_residual());
}

fn push_cell(line: &mut Vec<u8>, number: Option<f64>) {
    line.push(b',');
    if let Some(number) = number {
        push_shortest(number, line);
    }
}

//! Points as comma-separated values, under a head of `# ` lines.

use std::io::{self, Write};

use crate::columns::{titles, union_of_fields, union_of_unknowns};
use crate::conventions::{one_line, sentences};
use crate::dataset::{Dataset, Field, Patch, Point, Unit};
use crate::error::WriteError;
use crate::number::shortest;
use crate::tally::Tally;

/// Writes all points as CSV.
///
/// `# ` lines state the conventions. The columns are `surface, i, j, x, y, z, nx, ny, nz`, then the unknowns of all
/// patches in order of first appearance, then `residual, status`, `reason` if a point has one, then the fields of all patches (three columns for a
/// vector). Positions are mm, angles degrees, numbers the shortest
/// text that reads back as the same bits. Cells are empty where a patch has no such unknown or field, where a field is
/// not defined and where a point is not solved. An unknown or a field whose title is taken by another column is written as
/// `name [unit]`.
///
/// # Errors
/// When the dataset is malformed, or the stream refuses.
pub fn write_csv(dataset: &Dataset, out: &mut dyn Write) -> Result<(), WriteError> {
    dataset.check()?;
    write_head(dataset, out)?;
    let unknowns = union_of_unknowns(&dataset.patches);
    let fields = union_of_fields(&dataset.patches);
    let mut table = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(out);
    let told = dataset.has_reasons();
    table.write_record(titles(&unknowns, told, &fields)).map_err(io::Error::from)?;
    for patch in &dataset.patches {
        let places: Vec<Option<usize>> =
            unknowns.iter().map(|wanted| patch.unknowns.iter().position(|unknown| unknown == *wanted)).collect();
        let own: Vec<Option<&Field>> =
            fields.iter().map(|wanted| patch.fields.iter().find(|field| field.shares_columns(wanted))).collect();
        for (i, j, point) in patch.indexed_points() {
            let mut cells = record(patch, i, j, point, &places);
            let at = i * patch.columns.count + j;
            cells.extend(told.then(|| one_line(&point.reason)));
            cells.extend(fields.iter().zip(&own).flat_map(|(wanted, own)| field_cells(wanted, *own, at, point)));
            table.write_record(cells).map_err(io::Error::from)?;
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
    for field in union_of_fields(&dataset.patches) {
        let [name, unit, meaning] = [&field.name, &field.unit, &field.meaning].map(|text| one_line(text));
        writeln!(out, "# field `{name}` in {unit}: {meaning}")?;
    }
    for patch in &dataset.patches {
        writeln!(out, "# surface `{}`: {}", one_line(&patch.name), patch.told())?;
    }
    writeln!(out, "# all surfaces: {}", Tally::of(&dataset.patches).verdict())
}

/// What a point has in the columns of a field; empty cells if the point's patch has no such field.
fn field_cells(wanted: &Field, own: Option<&Field>, at: usize, point: &Point) -> Vec<String> {
    match own.map(|field| field.values.at(at)) {
        Some(numbers) if point.is_solved() && !numbers.is_empty() => numbers.iter().copied().map(shortest).collect(),
        _ => vec![String::new(); wanted.columns().len()],
    }
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

//! A measuring grid as comma-separated values, under a head of `# ` lines.

use std::io::{self, Write};

use super::{Hand, MeasuringGrid, NominalFlank, places, sentences};
use crate::files::error::WriteError;
use crate::text::number::shortest;
use crate::text::one_line;

/// Writes a measuring grid as CSV: `# ` lines state order, frame, units and signs; the columns are
/// `surface, flank, part, row, column, x, y, z, nx, ny, nz, status`. Cells of a point that is not solved are empty.
///
/// # Errors
/// When a part has not as many points as it says, or the stream refuses.
pub fn write_grid_csv(grid: &MeasuringGrid, out: &mut dyn Write) -> Result<(), WriteError> {
    let header = &grid.header;
    writeln!(out, "# nominal points of tooth flanks for measuring")?;
    writeln!(out, "# {}", one_line(&header.program))?;
    writeln!(out, "# spec: {}, hash {}", one_line(&header.spec), one_line(&header.spec_hash))?;
    writeln!(out, "# job: {}", one_line(&header.job))?;
    for sentence in sentences(grid) {
        writeln!(out, "# {sentence}")?;
    }
    for flank in &grid.flanks {
        writeln!(out, "# {}", told(flank))?;
    }
    let mut table = csv::WriterBuilder::new().comment(Some(b'#')).from_writer(out);
    let titles = ["surface", "flank", "part", "row", "column", "x", "y", "z", "nx", "ny", "nz", "status"];
    table.write_record(titles).map_err(io::Error::from)?;
    for flank in &grid.flanks {
        for (part, patch) in &flank.parts {
            patch.check()?;
            for (place, point) in places(patch) {
                let hand = flank.hand.map_or("", Hand::word);
                let mut cells: Vec<String> = [patch.name.as_str(), hand, part.word()].map(str::to_string).into();
                cells.extend(place.map(|index| index.to_string()));
                let numbers = point.position.iter().chain(&point.normal);
                cells.extend(numbers.map(|x| if point.is_solved() { shortest(*x) } else { String::new() }));
                cells.push(point.outcome.word().to_string());
                table.write_record(cells).map_err(io::Error::from)?;
            }
        }
    }
    table.flush()?;
    Ok(())
}

/// `surface `concave` in m.work: left flank; rows root to tip, columns toe to heel`
fn told(flank: &NominalFlank) -> String {
    let (name, frame) = flank.parts.first().map_or(("", ""), |(_, patch)| (patch.name.as_str(), patch.frame.as_str()));
    let hand =
        flank.hand.map_or("which flank of a tooth is not known".to_string(), |hand| format!("{} flank", hand.word()));
    let [rows, columns] = [&flank.ends.profile, &flank.ends.length].map(|[from, to]| format!("{from} to {to}"));
    one_line(&format!("surface `{name}` in {frame}: {hand}; rows from {rows}, columns from {columns}"))
}

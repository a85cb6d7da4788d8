//! Measured points of a grid, laid onto the nominal points of their surface.

use std::path::Path;

use flank_chain_dsl::Files;
use flank_export::{Measured as Reading, MeasuredGrid, read_measured};
use flank_solver::{Alignment, Outcome, SurfacePoint, beside};

use crate::compare::map::Named;
use crate::compare::measure::Placed;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::project::shown_path;
use crate::project::spec::Origin;

/// A larger grid is not compared.
const MOST_PLACES: usize = 1_000_000;
/// Enough for so many points with all their digits.
const MOST_BYTES: usize = 256 << 20;

/// Where on a surface a grid was measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaugedArea {
    /// Rows; the largest that the file names otherwise.
    pub(crate) rows: Option<u32>,
    /// Columns, the same way.
    pub(crate) columns: Option<u32>,
    /// What the grid leaves out at each end of the sampled area.
    pub(crate) margins: [f64; 2],
}

/// A measured grid.
pub(crate) struct Gauged {
    /// The file.
    pub(crate) shown: String,
    /// Rows and columns.
    pub(crate) counts: [usize; 2],
    /// What a row and a column are.
    pub(crate) labels: [String; 2],
    /// The nominal points, row by row.
    pub(crate) nominal: Vec<SurfacePoint>,
    /// Where the surface was found, mm; `None` where it was not measured.
    pub(crate) positions: Vec<Option<[f64; 3]>>,
}

impl Gauged {
    /// The grid of a surface in a file.
    ///
    /// # Errors
    /// In words: what is wrong with the file, or why the surface has no grid.
    pub(crate) fn read(
        of: Named<'_, '_>,
        (files, file): (&dyn Files, &Path),
        area: GaugedArea,
        session: Session<'_>,
        origin: &mut Origin,
    ) -> Result<Gauged, Failure> {
        let shown = shown_path(file);
        let text = origin.other_text(files, file, MOST_BYTES)?;
        let read = read_measured(&text, &of.surface.name).map_err(|fault| format!("{shown}: {fault}"))?;
        let MeasuredGrid { counts: named, points: readings } = read;
        let counts = counts(named, area).map_err(|reason| format!("{shown}: {reason}"))?;
        if counts[0] * counts[1] > MOST_PLACES {
            let [rows, columns] = counts;
            return Err(format!(
                "{shown}: {rows} rows of {columns} columns are more than the {MOST_PLACES} points that are compared"
            )
            .into());
        }
        let placed = Placed::new(of.job, of.surface, area.margins, session)?;
        let [profile, length] = placed.shares(counts);
        let sample = placed.sample(&profile, &length);
        let nominal = placed.solved(&sample)?;
        let mut positions = vec![None; nominal.len()];
        for reading in &readings {
            let at = reading.row * counts[1] + reading.column;
            positions[at] = position(reading.measured, &nominal[at]);
        }
        Ok(Gauged { shown, counts, labels: sample.labels, nominal, positions })
    }

    /// # Errors
    /// If a point, moved by so much, does not belong to its place.
    pub(crate) fn check_places(&self, of: Named<'_, '_>, motion: f64) -> Result<(), Failure> {
        let Gauged { shown, counts: [rows, columns], .. } = self;
        let alignment = of.alignment();
        let misplaced = |motion: f64| self.misplaced((alignment, motion));
        let Some(mut found) = misplaced(motion) else { return Ok(()) };
        let place = |at: usize| format!("row {}, column {}", at / columns + 1, at % columns + 1);
        // by what most points say, others may lie where they belong
        if let Some(median) = alignment.median(&self.positions, &self.nominal) {
            match (misplaced(median), self.farthest(alignment, median)) {
                (Some(other), _) => found = other,
                (None, Some((at, off))) if off > self.half_gap(at).unwrap_or(f64::INFINITY) => {
                    return Err(format!(
                        "{shown}: {} lies {off:.4} mm off its nominal point, and takes all others along by its {}: leave its numbers empty if \
                         it was measured wrong",
                        place(at),
                        match alignment {
                            Alignment::Turn => "turn",
                            Alignment::Shift => "shift",
                        }
                    )
                    .into());
                }
                (None, _) => {}
            }
        }
        let (at, off, half) = found;
        let (frame, place) = (&of.surface.frame, place(at));
        Err(format!(
            "{shown}: {place} lies {off:.4} mm beside its nominal point, and half the way to the next one is {half:.4} mm: \
             is this a grid of {rows} rows and {columns} columns (option `rows`, option `columns`) with this option `margin`, and are x, y, z in the frame {frame}?"
        )
        .into())
    }
}

impl Gauged {
    /// The first point that is nearer to where a neighbour should be than to its own nominal point: its place, how far beside it lies, and
    /// half the way to the nearest neighbour, mm.
    fn misplaced(&self, motion: (Alignment, f64)) -> Option<(usize, f64, f64)> {
        let each = beside(&self.positions, &self.nominal, motion).into_iter().enumerate();
        each.filter_map(|(at, off)| Some((at, off?, self.half_gap(at)?))).find(|(_, off, half)| off > half)
    }

    /// Half the way from a nominal point to the nearest neighbour, mm.
    fn half_gap(&self, at: usize) -> Option<f64> {
        let (nominal, [rows, columns]) = (&self.nominal, self.counts);
        let (row, column) = (at / columns, at % columns);
        let along = [(row > 0).then(|| at - columns), (row + 1 < rows).then_some(at + columns)];
        let across = [(column > 0).then(|| at - 1), (column + 1 < columns).then_some(at + 1)];
        let gap = |next: usize| {
            let [from, to] = [at, next].map(|k| nominal[k].position);
            (0..3).map(|k| (to[k] - from[k]).powi(2)).sum::<f64>().sqrt()
        };
        let solved = |next: &usize| nominal[*next].outcome == Outcome::Solved;
        let next = along.into_iter().chain(across).flatten().filter(solved);
        next.map(|next| 0.5 * gap(next)).reduce(f64::min)
    }

    /// The point that lies farthest off its nominal one, moved by so much: its place, and how far, mm.
    fn farthest(&self, alignment: Alignment, motion: f64) -> Option<(usize, f64)> {
        let pairs = self.positions.iter().zip(&self.nominal).enumerate();
        let known =
            pairs.filter(|(_, (_, point))| point.outcome == Outcome::Solved).filter_map(|(at, (found, point))| {
                let found = alignment.moved((*found)?, motion);
                Some((at, (0..3).map(|k| (found[k] - point.position[k]).powi(2)).sum::<f64>().sqrt()))
            });
        known.reduce(|a, b| if b.1 > a.1 { b } else { a })
    }
}

/// Rows and columns of the grid: those that the file names, or the larger numbers that were said.
fn counts(named: [usize; 2], area: GaugedArea) -> Result<[usize; 2], String> {
    let [rows, columns] =
        [(area.rows, named[0], "rows"), (area.columns, named[1], "columns")].map(|(said, named, what)| {
            let said = said.map_or(named, |said| said as usize);
            if said < named {
                Err(format!("{named} {what} are named, more than option `{what} {said}`"))
            } else {
                Ok(said)
            }
        });
    Ok([rows?, columns?])
}

/// Where a machine found the surface.
fn position(reading: Reading, nominal: &SurfacePoint) -> Option<[f64; 3]> {
    match reading {
        Reading::Position(position) => Some(position),
        Reading::Deviation(off) => (nominal.outcome == Outcome::Solved)
            .then(|| std::array::from_fn(|k| nominal.position[k] + off * nominal.normal[k])),
    }
}

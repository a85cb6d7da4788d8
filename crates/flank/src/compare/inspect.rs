//! `flank deviation --measured`: measured points compared with the nominal surface.

use flank_export::{Measured as Reading, MeasuredGrid, read_measured};
use flank_solver::{Inspection, Outcome, SurfacePoint, beside};

use crate::compare::map::{ComparedWith, DeviationMap, Named};
use crate::compare::measure::Placed;
use crate::project::failure::Failure;
use crate::project::requests::{DeviationRequest, Session};
use crate::project::shown_path;
use crate::project::spec::Origin;
use crate::solve;

/// A larger grid is not compared.
const MOST_PLACES: usize = 1_000_000;
/// Enough for so many points with all their digits.
const MOST_BYTES: usize = 256 << 20;

/// # Errors
/// In words: what is wrong with the file, or why the surface has no grid.
pub(crate) fn inspect<'j, 'g>(
    of: Named<'j, 'g>,
    file: &std::path::Path,
    (request, session): (&DeviationRequest, Session<'j>),
    origin: &mut Origin,
) -> Result<DeviationMap<'j, 'g>, Failure> {
    let shown = shown_path(file);
    let text = origin.other_text(request.jobs.project.files(), file, MOST_BYTES)?;
    let read = read_measured(&text, &of.surface.name).map_err(|fault| format!("{shown}: {fault}"))?;
    let MeasuredGrid { counts: named, points: readings } = read;
    let counts = counts(named, request).map_err(|reason| format!("{shown}: {reason}"))?;
    if counts[0] * counts[1] > MOST_PLACES {
        let [rows, columns] = counts;
        return Err(format!(
            "{shown}: {rows} rows of {columns} columns are more than the {MOST_PLACES} points that are compared"
        )
        .into());
    }
    let placed = Placed::new(of.job, of.surface, request.margins(), session)?;
    let [profile, length] = placed.shares(counts);
    let sample = placed.sample(&profile, &length);
    let nominal = placed.solved(&sample)?;
    let mut positions = vec![None; nominal.len()];
    for reading in &readings {
        let at = reading.row * counts[1] + reading.column;
        positions[at] = position(reading.measured, &nominal[at]);
    }
    let inspection =
        Inspection::new(&solve::bound(of.job, of.surface)).expect("a job without errors leaves nothing unbound");
    let _working = session.begin(format!("holding {shown} against {}", of.surface.name))?;
    let turn = inspection.best_turn(&positions, &nominal);
    if let Some((at, off, half)) = misplaced(&positions, &nominal, counts, turn.unwrap_or(0.0)) {
        let [row, column] = [at / counts[1] + 1, at % counts[1] + 1];
        let [rows, columns] = counts;
        return Err(format!(
            "{shown}: row {row}, column {column} lies {off:.4} mm beside its nominal point, and half the way to the next one is {half:.4} mm: \
             is this a grid of {rows} rows and {columns} columns (option `rows`, option `columns`) with this option `margin`, and are x, y, z in the frame {}?",
            of.surface.frame
        )
        .into());
    }
    let done = if request.no_align { 0.0 } else { turn.unwrap_or(0.0) };
    let deviations = inspection.deviations(&positions, &nominal, done);
    Ok(DeviationMap {
        held: ComparedWith::File { name: shown, points: positions.iter().flatten().count() },
        from: of,
        labels: sample.labels.clone(),
        counts,
        points: nominal,
        turn,
        is_turned: !request.no_align,
        deviations: deviations.into_iter().map(|off| Some(1e3 * off?)).collect(),
        is_opposite: false,
        refused: Vec::new(),
        cut_away: 0,
    })
}

/// Rows and columns of the grid: those that the file names, or the larger numbers of the request.
fn counts(named: [usize; 2], request: &DeviationRequest) -> Result<[usize; 2], String> {
    let [rows, columns] =
        [(request.rows, named[0], "rows"), (request.columns, named[1], "columns")].map(|(said, named, what)| {
            let said = said.map_or(named, |said| said as usize);
            if said < named {
                Err(format!("{named} {what} are named, more than option `{what} {said}`"))
            } else {
                Ok(said)
            }
        });
    Ok([rows?, columns?])
}

/// The first point that is nearer to where a neighbour should be than to its own nominal point: its place, how far beside it lies, and half
/// the way to the nearest neighbour, mm.
fn misplaced(
    measured: &[Option<[f64; 3]>],
    nominal: &[SurfacePoint],
    [rows, columns]: [usize; 2],
    turn: f64,
) -> Option<(usize, f64, f64)> {
    let half_gap = |at: usize| {
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
    };
    let each = beside(measured, nominal, turn).into_iter().enumerate();
    each.filter_map(|(at, off)| Some((at, off?, half_gap(at)?))).find(|(_, off, half)| off > half)
}

/// Where a machine found the surface.
fn position(reading: Reading, nominal: &SurfacePoint) -> Option<[f64; 3]> {
    match reading {
        Reading::Position(position) => Some(position),
        Reading::Deviation(off) => (nominal.outcome == Outcome::Solved)
            .then(|| std::array::from_fn(|k| nominal.position[k] + off * nominal.normal[k])),
    }
}

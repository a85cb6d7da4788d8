//! `flank deviation --measured`: measured points held against the nominal surface.

use flank_export::{Measured as Reading, MeasuredGrid, read_measured};
use flank_solver::{Inspection, SurfacePoint};

use crate::arguments::Deviation;
use crate::deviation::{Held, Measured, Named};
use crate::failure::Failure;
use crate::measure::Placed;
use crate::progress::Working;
use crate::solve;
use crate::spec::{self, Origin};

/// A larger grid is not compared.
const MOST_PLACES: usize = 1_000_000;
/// Enough for so many points with all their digits.
const MOST_BYTES: usize = 256 << 20;

/// # Errors
/// In words: what is wrong with the file, or why the surface has no grid.
pub(crate) fn inspect<'j, 'g>(
    of: Named<'j, 'g>,
    file: &std::path::Path,
    arguments: &Deviation,
    origin: &mut Origin,
) -> Result<Measured<'j, 'g>, Failure> {
    let shown = spec::shown(file);
    let text = origin.other_text(file, MOST_BYTES)?;
    let read = read_measured(&text, &of.surface.name).map_err(|fault| format!("{shown}: {fault}"))?;
    let MeasuredGrid { counts, points: readings } = read;
    if counts[0] * counts[1] > MOST_PLACES {
        let [rows, columns] = counts;
        return Err(format!(
            "{shown}: {rows} rows of {columns} columns are more than the {MOST_PLACES} points that are compared"
        )
        .into());
    }
    let placed = Placed::new(of.job, of.surface, arguments.margin.shares(), arguments.means)?;
    let [profile, length] = placed.shares(counts);
    let sample = placed.sample(&profile, &length);
    let nominal = placed.solved(&sample);
    let mut positions = vec![None; nominal.len()];
    for reading in &readings {
        let at = reading.row * counts[1] + reading.column;
        positions[at] = position(reading.measured, &nominal[at]);
    }
    let inspection = Inspection::new(&of.surface.surface, solve::ranges(of.surface), &of.job.bindings())
        .expect("a job without errors leaves nothing unbound");
    let _working = Working::on(format!("holding {shown} against {}", of.surface.name));
    let turn = inspection.best_turn(&positions, &nominal);
    let done = if arguments.as_it_lies { 0.0 } else { turn.unwrap_or(0.0) };
    let deviations = inspection.deviations(&positions, &nominal, done);
    Ok(Measured {
        held: Held::File { name: shown, points: positions.iter().flatten().count() },
        from: of,
        labels: sample.labels.clone(),
        counts,
        points: nominal,
        turn,
        is_turned: !arguments.as_it_lies,
        deviations: deviations.into_iter().map(|off| Some(1e3 * off?)).collect(),
    })
}

/// Where a machine found the surface.
fn position(reading: Reading, nominal: &SurfacePoint) -> Option<[f64; 3]> {
    match reading {
        Reading::Position(position) => Some(position),
        Reading::Deviation(off) => (nominal.outcome == flank_solver::Outcome::Solved)
            .then(|| std::array::from_fn(|k| nominal.position[k] + off * nominal.normal[k])),
    }
}

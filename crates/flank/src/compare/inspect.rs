//! `flank deviation --measured`: measured points compared with the nominal surface.

use flank_solver::Inspection;

use crate::compare::gauged::{Gauged, GaugedArea};
use crate::compare::map::{ComparedWith, DeviationMap, Middle, Named};
use crate::project::failure::Failure;
use crate::project::requests::DeviationRequest;
use crate::project::session::Session;
use crate::project::spec::Origin;
use crate::solve;
use crate::solve::centre::Centre;

/// # Errors
/// In words: what is wrong with the file, or why the surface has no grid.
pub(crate) fn inspect<'j, 'g>(
    of: Named<'j, 'g>,
    file: &std::path::Path,
    (request, session): (&DeviationRequest, Session<'j>),
    origin: &mut Origin,
) -> Result<DeviationMap<'j, 'g>, Failure> {
    let area = GaugedArea { rows: request.rows, columns: request.columns, margins: request.margins() };
    let gauged = Gauged::read(of, (request.jobs.project.files(), file), area, session, origin)?;
    let Gauged { shown, counts, nominal, positions, .. } = &gauged;
    let inspection = Inspection::new(&solve::bound(of.job, of.surface), of.alignment())
        .expect("a job without errors leaves nothing unbound");
    let _working = session.begin(format!("holding {shown} against {}", of.surface.name))?;
    let motion = inspection.best_motion(positions, nominal);
    gauged.check_places(of, motion.unwrap_or(0.0))?;
    let done = if request.no_align { 0.0 } else { motion.unwrap_or(0.0) };
    let deviations = inspection.deviations(positions, nominal, done);
    let deviations: Vec<Option<f64>> = deviations.into_iter().map(|off| Some(1e3 * off?)).collect();
    let centre = Centre::of_nodes(*counts);
    Ok(DeviationMap {
        held: ComparedWith::File { name: shown.clone(), points: positions.iter().flatten().count() },
        from: of,
        labels: gauged.labels.clone(),
        counts: *counts,
        middle: Middle::new(&centre, nominal, &deviations),
        lines: centre.lines,
        points: gauged.nominal,
        motion,
        is_moved: !request.no_align,
        deviations,
        is_opposite: false,
        refused: Vec::new(),
        cut_away: 0,
        not_found: Default::default(),
    })
}

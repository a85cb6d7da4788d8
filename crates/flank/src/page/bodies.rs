//! The gears of a page.

use flank_chain_dsl::{Job, Solid};
use flank_draw::{PageBody, PageFace};
use flank_solver::{BodySheet, SheetFace};

use super::surfaces::frame;
use crate::project::failure::Failure;
use crate::project::session::Session;
use crate::solve::body::shape::Shape;
use crate::solve::solved::Solved;

/// Those of all solids of which some surface is shown.
///
/// # Errors
/// If the work is cancelled.
pub(super) fn page_bodies<'j, 'g>(
    job: &'j Job<'g>,
    solved: &[Solved<'j, 'g>],
    session: Session<'j>,
) -> Result<Vec<PageBody>, Failure> {
    let mut bodies = Vec::new();
    for solid in &job.solids {
        match Shape::of_solid(job, solid, solved, session) {
            Ok(shape) => bodies.push(page_body(job, (solid, &shape), solved)),
            Err(Failure::Input(_)) => {}
            Err(other) => return Err(other),
        }
    }
    Ok(bodies)
}

fn page_body(job: &Job<'_>, (solid, shape): (&Solid, &Shape), solved: &[Solved<'_, '_>]) -> PageBody {
    let place = |name: &str| solved.iter().position(|solved| solved.surface.name == name);
    let (machine, frame_index) = frame(job, &solid.frame);
    let (tooth, teeth) = shape.repeated();
    let face = |sheet: &BodySheet| PageFace {
        surface: match sheet.face {
            SheetFace::Surface(number) => place(&shape.surfaces[number]),
            SheetFace::Blank | SheetFace::Cut => None,
        },
        counts: sheet.counts,
        ends: sheet.ends,
        positions: sheet.points.clone(),
        normals: sheet.normals.clone(),
    };
    PageBody {
        name: shape.name.clone(),
        machine,
        frame_index,
        teeth,
        surfaces: shape.surfaces.iter().filter_map(|name| place(name)).collect(),
        directions: shape.directions(&shape.some()),
        faces: tooth.iter().map(face).collect(),
    }
}

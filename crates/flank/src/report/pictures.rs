//! The pictures of a report.

use flank_chain_dsl::Solid;
use flank_draw::{Block, Figure, PictureOptions, ReportSection};

use super::Findings;
use crate::draw::{self, Drawing};
use crate::project::choices::{Choice, PlotKind};

/// The pictures that matter for the job, without those that stand elsewhere on the page.
pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let blocks: Vec<Block> =
        findings.drawings.iter().skip(1).map(|(what, drawing)| block_of_drawing(findings, *what, drawing)).collect();
    (!blocks.is_empty()).then(|| ReportSection { title: "Pictures".to_string(), blocks })
}

/// The first of them, for the opening.
pub(super) fn first(findings: &Findings<'_, '_>) -> Option<Block> {
    findings.drawings.first().map(|(what, drawing)| block_of_drawing(findings, *what, drawing))
}

/// Another one, if it fits the job and is not among those that matter anyway.
pub(super) fn figure(findings: &Findings<'_, '_>, what: PlotKind) -> Option<Block> {
    if findings.drawings.iter().any(|(other, _)| *other == what) {
        return None;
    }
    let drawing = draw::draw(&findings.subject, what, &[], PictureOptions::default()).ok()?;
    Some(block_of_drawing(findings, what, &drawing))
}

/// One of the gears of the job.
pub(super) fn gear(findings: &Findings<'_, '_>, solid: &Solid) -> Option<Block> {
    let drawing = draw::gear::of_solid(&findings.subject, solid, &PictureOptions::default()).ok()?;
    let name = format!("{}.report.gear.{}", findings.job.name, solid.name);
    let caption = format!("gear: {}", drawing.shows);
    Some(Block::Figure(Figure { name, picture: drawing.picture, caption }))
}

fn block_of_drawing(findings: &Findings<'_, '_>, what: PlotKind, drawing: &Drawing) -> Block {
    let name = format!("{}.report.{}", findings.job.name, what.name());
    let caption = format!("{}: {}", what.name(), drawing.shows);
    Block::Figure(Figure { name, picture: drawing.picture.clone(), caption })
}

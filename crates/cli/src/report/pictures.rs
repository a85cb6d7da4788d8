//! The pictures of a report.

use flank_draw::{Block, Figure, PictureOptions, ReportSection};

use super::Findings;
use crate::arguments::What;
use crate::plot::{self, Drawing};

/// The pictures that matter for the job, without those that stand elsewhere on the page.
pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let blocks: Vec<Block> =
        findings.drawings.iter().skip(1).map(|(what, drawing)| of(findings, *what, drawing)).collect();
    (!blocks.is_empty()).then(|| ReportSection { title: "Pictures".to_string(), blocks })
}

/// The first of them, for the opening.
pub(super) fn first(findings: &Findings<'_, '_>) -> Option<Block> {
    findings.drawings.first().map(|(what, drawing)| of(findings, *what, drawing))
}

/// Another one, if it fits the job and is not among those that matter anyway.
pub(super) fn figure(findings: &Findings<'_, '_>, what: What) -> Option<Block> {
    if findings.drawings.iter().any(|(other, _)| *other == what) {
        return None;
    }
    let drawing = plot::draw(&findings.subject, what, &[], PictureOptions::default()).ok()?;
    Some(of(findings, what, &drawing))
}

fn of(findings: &Findings<'_, '_>, what: What, drawing: &Drawing) -> Block {
    let name = format!("{}.report.{}", findings.job.name, plot::name(what));
    let caption = format!("{}: {}", plot::name(what), drawing.shows);
    Block::Figure(Figure { name, picture: drawing.picture.clone(), caption })
}

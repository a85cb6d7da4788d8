//! What moves the surfaces.

use flank_export::{Block, Column, ReportSection};

use super::Findings;
use crate::table::Solved;

/// Parameters of each surface that are listed.
const SHOWN: usize = 5;

/// The parameters that move each surface most; nothing if no parameter moves any.
pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let rows: Vec<Vec<String>> = findings.solved().iter().flat_map(rows).collect();
    if rows.is_empty() {
        return None;
    }
    let columns = vec![
        Column::words("surface"),
        Column::code("parameter"),
        Column::numbers("root mean square"),
        Column::numbers("largest"),
        Column::words("in"),
    ];
    let caption =
        format!("Normal displacement of the surface by a small change of one parameter; the first {SHOWN} of each");
    let text = "Exact derivatives at the solved points. Parameters that are defined by the one that changes follow it.";
    let blocks = vec![Block::Table(caption, columns, rows), Block::Paragraph(text.to_string())];
    Some(ReportSection { title: "What moves the surfaces".to_string(), blocks })
}

fn rows(solved: &Solved<'_, '_>) -> Vec<Vec<String>> {
    let ranked = solved.sensitivity.as_ref().map_or(Vec::new(), |sensitivity| sensitivity.rows());
    let mut name = solved.surface.name.clone();
    let row = |[parameter, rms, largest, unit]: [String; 4]| {
        let unit = unit.replacen("um", "\u{b5}m", 1);
        vec![std::mem::take(&mut name), parameter, rms, largest, unit]
    };
    ranked.into_iter().take(SHOWN).map(row).collect()
}

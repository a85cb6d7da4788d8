//! What moves the surfaces.

use flank_draw::{Block, Column, ReportSection};

use super::Findings;
use crate::solve::result::ParameterInfluence;
use crate::solve::solved::Solved;

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
        Column::words("changed by"),
        Column::numbers("root mean square, \u{b5}m"),
        Column::numbers("largest, \u{b5}m"),
    ];
    let caption =
        format!("Normal displacement of the surface by a usual change of one parameter; the first {SHOWN} of each");
    let text = "Exact derivatives at the solved points. A usual change is 0.01 mm of a length and an arcminute of an angle; of all others a \
                thousandth of the value, of its range where it is zero. Parameters that are defined by the one that changes follow it.";
    let blocks = vec![Block::Table(caption, columns, rows), Block::Paragraph(text.to_string())];
    Some(ReportSection { title: "What moves the surfaces".to_string(), blocks })
}

fn rows(solved: &Solved<'_, '_>) -> Vec<Vec<String>> {
    let ranked = solved.sensitivity.as_ref().map_or(Vec::new(), |sensitivity| sensitivity.table().parameters);
    let mut name = solved.surface.name.clone();
    let row = |influence: &ParameterInfluence| {
        let [parameter, _, _, _, change, rms, largest] = influence.cells();
        vec![std::mem::take(&mut name), parameter, change, rms, largest]
    };
    ranked.iter().take(SHOWN).map(row).collect()
}

//! The bodies whose outlines say where teeth end.

use flank_chain_dsl::{OutlineCurve, Solid};
use flank_draw::{Block, Column, ReportSection};
use flank_export::fixed;

use super::Findings;
use super::gear::Gear;
use super::result::{BuiltSolid, SolidEdge};

pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let blocks: Vec<Block> = findings.job.solids.iter().flat_map(|solid| of_solid(findings, solid)).collect();
    (!blocks.is_empty()).then(|| ReportSection { title: "Solids".to_string(), blocks })
}

fn of_solid(findings: &Findings<'_, '_>, solid: &Solid) -> [Block; 3] {
    let BuiltSolid { name, frame, teeth, space, outline, .. } = built(findings, solid, None);
    let columns = ["z, mm", "rho, mm", "to z, mm", "to rho, mm", "radius, mm"].map(Column::numbers);
    let columns: Vec<Column> = [Column::words("edge")].into_iter().chain(columns).collect();
    let row = |edge: SolidEdge| {
        let numbers = edge.from.into_iter().chain(edge.to).map(|x| fixed(x, 4));
        let radius = edge.radius.map_or("\u{2013}".to_string(), |radius| fixed(radius, 4));
        [edge.name].into_iter().chain(numbers).chain([radius]).collect()
    };
    let facts = [
        ("turned about z of".to_string(), frame),
        ("tooth spaces".to_string(), teeth.to_string()),
        ("surfaces of a space".to_string(), space.join(", ")),
    ];
    let rows = outline.into_iter().map(row).collect();
    [
        Block::Heading(name.clone()),
        Block::Facts(facts.to_vec()),
        Block::Table(format!("Outline of {name} in its axial section, the material on the left"), columns, rows),
    ]
}

pub(super) fn all(findings: &Findings<'_, '_>) -> Vec<BuiltSolid> {
    findings.job.solids.iter().zip(&findings.gears).map(|(solid, gear)| built(findings, solid, Some(gear))).collect()
}

fn built(findings: &Findings<'_, '_>, solid: &Solid, gear: Option<&Gear<'_>>) -> BuiltSolid {
    let measured = gear.map(|gear| &gear.measured);
    let edge = |segment: &flank_chain_dsl::OutlineSegment| SolidEdge {
        name: segment.name.clone(),
        from: segment.from,
        to: segment.to,
        radius: match segment.curve {
            OutlineCurve::Line => None,
            OutlineCurve::Arc { center } => Some((segment.from[0] - center[0]).hypot(segment.from[1] - center[1])),
        },
    };
    BuiltSolid {
        name: solid.name.clone(),
        frame: solid.frame.clone(),
        teeth: solid.teeth,
        space: solid.space.iter().map(|at| findings.job.surfaces[*at].name.clone()).collect(),
        outline: solid.outline.iter().map(edge).collect(),
        volume_mm3: measured.and_then(|of| of.as_ref().ok()).map(|(volume, _)| *volume),
        gauges: measured.and_then(|of| of.as_ref().ok()).map(|(_, gauges)| gauges.clone()),
        no_body: measured.and_then(|of| of.as_ref().err()).cloned(),
    }
}

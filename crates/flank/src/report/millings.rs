//! What is milled, on the report of a job.

use flank_draw::{Block, Column, Figure, PictureOptions, ReportSection, Tone};
use flank_export::fixed;

use super::Findings;
use crate::convert::milling::result::MillResult;
use crate::draw::Drawing;
use crate::draw::millings::draw;

/// What is known of each milling, with its picture.
pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let blocks: Vec<Block> = findings.millings.iter().flat_map(|milling| of_milling(findings, milling)).collect();
    (!blocks.is_empty()).then(|| ReportSection { title: "Milling".to_string(), blocks })
}

fn of_milling(findings: &Findings<'_, '_>, (result, drawn): &super::ShownMilling) -> Vec<Block> {
    let mut blocks = vec![Block::Heading(result.milling.clone()), Block::Paragraph(result.heading())];
    for missing in &result.not_done {
        let details = missing.details.iter().map(|detail| findings.spelled(detail)).collect();
        blocks.push(Block::Notice(Tone::Bad, findings.spelled(&missing.message), details));
    }
    for remark in &result.remarks {
        blocks.push(Block::Notice(Tone::Open, findings.spelled(&remark.message), Vec::new()));
    }
    blocks.push(Block::Facts(result.facts()));
    blocks.push(setup(findings, result));
    blocks.extend(left(result));
    blocks.extend(axes(result));
    if let Some(drawn) = drawn {
        let Drawing { picture, shows } = draw(drawn, &PictureOptions::default());
        let name = format!("{}.report.{}.milling", findings.job.name, result.milling);
        blocks.push(Block::Figure(Figure { name, picture, caption: format!("milling: {shows}") }));
    }
    blocks
}

/// Cutter and program, beside what they leave.
fn setup(findings: &Findings<'_, '_>, result: &MillResult) -> Block {
    let columns = vec![Column::words("of"), Column::sentences("as it is")];
    let rows = result.setup.facts().into_iter().map(|(name, text)| vec![name, findings.spelled(&text)]);
    Block::Table("Cutter and program".to_string(), columns, rows.collect())
}

/// What is left at some of the points: those of a report fit a page.
fn left(result: &MillResult) -> Option<Block> {
    const MOST: [usize; 2] = [9, 9];
    let map = result.map.as_ref()?;
    let spread = |count: usize, most: usize| -> Vec<usize> {
        let shown = count.min(most);
        (0..shown).map(|k| if shown > 1 { k * (count - 1) / (shown - 1) } else { 0 }).collect()
    };
    let (rows, columns) = (spread(map.rows, MOST[0]), spread(map.columns, MOST[1]));
    let share = |at: usize, count: usize| fixed((at as f64 + 0.5) / count as f64, 3);
    let [across, along] = &result.coordinates;
    let titles = std::iter::once(Column::words(&format!("{across} \\ {along}")))
        .chain(columns.iter().map(|at| Column::numbers(&share(*at, map.columns))));
    let row = |i: &usize| {
        let height = |j: &usize| {
            map.heights_um[i * map.columns + j].map_or("not passed over".to_string(), |height| fixed(height, 3))
        };
        std::iter::once(share(*i, map.rows)).chain(columns.iter().map(height)).collect()
    };
    let title = "What is left, \u{b5}m, by shares of the milled part".to_string();
    Some(Block::Table(title, titles.collect(), rows.iter().map(row).collect()))
}

/// What the axes of the machine do.
fn axes(result: &MillResult) -> Option<Block> {
    let columns = [
        Column::code("axis"),
        Column::numbers("from"),
        Column::numbers("to"),
        Column::numbers("travel from"),
        Column::numbers("to"),
        Column::numbers("at the most per mm of way"),
        Column::words("unit"),
    ];
    let row = |axis: &crate::convert::milling::result::MilledAxis| {
        let [low, high] = axis.extent.map(|end| fixed(end, 3));
        let travel = axis.travel.as_ref().map(|travel| [travel.low, travel.high].map(|end| fixed(end, 3)));
        let [from, to] = travel.unwrap_or_default();
        vec![axis.name.clone(), low, high, from, to, fixed(axis.rate_per_mm, 3), axis.unit.clone()]
    };
    let rows: Vec<Vec<String>> = result.axes.iter().map(row).collect();
    (!rows.is_empty()).then(|| Block::Table("What the axes do".to_string(), columns.to_vec(), rows))
}

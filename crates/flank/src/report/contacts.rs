//! The contacts of a job on its report.

use flank_draw::{Block, Column, DrawnContact, Figure, PictureOptions, ReportSection, Tone};
use flank_export::fixed;

use super::Findings;
use crate::contact::result::ContactResult;
use crate::draw::Drawing;
use crate::draw::contacts::draw;
use crate::project::choices::{Choice, PlotKind};

/// What is known of each contact, with its pictures.
pub(super) fn section(findings: &Findings<'_, '_>) -> Option<ReportSection> {
    let blocks: Vec<Block> = findings.contacts.iter().flat_map(|contact| of_contact(findings, contact)).collect();
    (!blocks.is_empty()).then(|| ReportSection { title: "Contact".to_string(), blocks })
}

fn of_contact(findings: &Findings<'_, '_>, (result, drawn): &super::ShownContact) -> Vec<Block> {
    let mut blocks = vec![Block::Heading(result.contact.clone()), Block::Paragraph(result.heading())];
    for missing in &result.not_done {
        let details = missing.details.iter().map(|detail| findings.spelled(detail)).collect();
        blocks.push(Block::Notice(Tone::Bad, findings.spelled(&missing.message), details));
    }
    for remark in &result.remarks {
        blocks.push(Block::Notice(Tone::Open, findings.spelled(&remark.message), Vec::new()));
    }
    blocks.push(Block::Facts(result.facts()));
    blocks.extend(influences(result));
    let figure = |what: PlotKind, contact: &DrawnContact| {
        let from = (findings.subject.dataset.header.clone(), &PictureOptions::default());
        let Drawing { picture, shows } = draw(&findings.job.name, std::slice::from_ref(contact), what, from);
        let name = format!("{}.report.{}.{}", findings.job.name, result.contact, what.name());
        Block::Figure(Figure { name, picture, caption: format!("{}: {shows}", what.name()) })
    };
    let kinds = [PlotKind::Pattern, PlotKind::Error];
    blocks.extend(drawn.iter().flat_map(|contact| kinds.map(|what| figure(what, contact))));
    blocks
}

/// What mounting errors and settings do.
fn influences(result: &ContactResult) -> Option<Block> {
    let unit = result.error.as_ref().map_or("", |error| error.unit.as_str());
    let columns = [
        Column::code("axis or setting"),
        Column::words("change"),
        Column::numbers("middle moves on the first flank, mm"),
        Column::numbers("on the second, mm"),
        Column::numbers(&format!("error of the middle, {unit}")),
        Column::numbers("parabola, %"),
        Column::numbers("ellipse, %"),
    ];
    let percent = |share: Option<f64>| share.map_or(String::new(), |share| fixed(100.0 * share, 2));
    let rows: Vec<Vec<String>> = result
        .influences
        .iter()
        .filter(|of| of.is_shown())
        .map(|of| {
            let [first, second] = of.moved_mm.map(|way| fixed(way, 4));
            let (parabola, ellipse) = (percent(of.parabola), percent(of.ellipse));
            vec![of.name.clone(), of.per.clone(), first, second, fixed(of.error, 3), parabola, ellipse]
        })
        .collect();
    (!rows.is_empty()).then(|| Block::Table("What mounting errors and settings do".to_string(), columns.to_vec(), rows))
}

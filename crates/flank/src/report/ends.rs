//! Undercut, and the lines at which surfaces and contact end.

use flank_chain_dsl::Dimension;
use flank_draw::{Block, Column, ReportSection, Tone};

use super::Findings;
use super::result::ReportedLine;
use crate::project::units;
use crate::solve::limits::Line;
use crate::solve::secondary;
use crate::solve::solved::Solved;

pub(super) fn section(findings: &Findings<'_, '_>) -> ReportSection {
    let mut blocks = vec![undercut(findings)];
    let (found, missing): (Vec<&Line<'_, '_>>, Vec<&Line<'_, '_>>) =
        findings.lines.iter().partition(|line| line.summary.solved() > 0);
    if !found.is_empty() {
        blocks.push(lines(&found));
    }
    if !missing.is_empty() {
        blocks.push(Block::Facts(not_found(&missing)));
    }
    if !findings.lines.is_empty() {
        let meaning = "A singular line is where the envelope turns back: beyond it the tool cuts away what it generates. A contact \
            limit is where the lines of contact end on the tool. An intersection is where \u{201c}trim\u{201d} ends a surface.";
        blocks.push(Block::Paragraph(meaning.to_string()));
    }
    ReportSection { title: "Undercut and limits".to_string(), blocks }
}

fn undercut(findings: &Findings<'_, '_>) -> Block {
    let cut: Vec<String> = findings
        .solved()
        .iter()
        .filter(|solved| solved.summary.cut_by_its_tool() > 0)
        .map(|solved| {
            let count = solved.summary.cut_by_its_tool();
            format!("{}: {count} of {} points", solved.surface.name, solved.summary.asked)
        })
        .collect();
    if !cut.is_empty() {
        return Block::Notice(
            Tone::Bad,
            "Undercut: the tool itself cuts away points that it generates".to_string(),
            cut,
        );
    }
    let unseen = secondary::unseen(findings.solved().iter().map(Solved::positions_tried));
    if unseen.is_empty() {
        let text = "No point that was asked for is cut away by the tool that generates it.";
        return Block::Notice(Tone::Good, text.to_string(), Vec::new());
    }
    let text = "No point that was asked for is cut away by the tool that generates it, in the positions that were looked at: just \
        before and after it generates the point, and all others but these.";
    Block::Notice(Tone::Open, text.to_string(), unseen)
}

fn lines(found: &[&Line<'_, '_>]) -> Block {
    let columns = vec![
        Column::words("surface"),
        Column::words("line"),
        Column::words("found"),
        Column::numbers("rho, mm"),
        Column::numbers("z, mm"),
    ];
    let mut before = "";
    let mut rows = Vec::new();
    for line in found {
        let name = if before == line.surface.name { String::new() } else { line.surface.name.clone() };
        before = &line.surface.name;
        let several = if line.several > 1 { format!("; the longest of {}", line.several) } else { String::new() };
        let points = format!("{} points along {}{several}", line.summary.solved(), line.along);
        let reached = line.told().ranges_reached;
        let ends = |k: usize| {
            let ends = reached[k].ends().map(|(low, high)| [low, high].map(|x| units::digits(Dimension::LENGTH, x, 4)));
            ends.map_or(String::new(), |[low, high]| if low == high { low } else { format!("{low} .. {high}") })
        };
        rows.push(vec![name, kind(line), points, ends(0), ends(1)]);
    }
    let caption = "Lines at which surfaces or contact end; rho is the distance from the axis";
    Block::Table(caption.to_string(), columns, rows)
}

/// What was looked for in vain: by its kind, the surfaces.
fn not_found(missing: &[&Line<'_, '_>]) -> Vec<(String, String)> {
    let mut kinds: Vec<(String, bool)> = Vec::new();
    for line in missing {
        let of = (kind(line), line.is_open);
        if !kinds.contains(&of) {
            kinds.push(of);
        }
    }
    let of_kind = |(of, is_open): (String, bool)| {
        let alike = missing.iter().filter(|line| kind(line) == of && line.is_open == is_open);
        let names = alike.map(|line| line.surface.name.as_str()).collect::<Vec<_>>().join(", ");
        if is_open {
            (format!("no {of} found, none excluded"), format!("not all ranges could be looked at: {names}"))
        } else {
            (format!("no {of}"), format!("within the ranges of {names}"))
        }
    };
    kinds.into_iter().map(of_kind).collect()
}

/// `singular line`, `intersection with fillet`.
fn kind(line: &Line<'_, '_>) -> String {
    match &line.trimmed_by {
        Some(other) => format!("{} with {other}", line.kind),
        None => line.kind.to_string(),
    }
}

pub(super) fn told(findings: &Findings<'_, '_>) -> Vec<ReportedLine> {
    let entry = |line: &Line<'_, '_>| ReportedLine {
        summary: line.told(),
        surface: line.surface.name.clone(),
        kind: line.kind,
        along: line.along.clone(),
        several: line.several,
    };
    findings.lines.iter().map(entry).collect()
}

/// Points that their own tool cuts away, of all surfaces.
pub(super) fn undercut_count(findings: &Findings<'_, '_>) -> usize {
    findings.solved().iter().map(|solved| solved.summary.cut_by_its_tool()).sum()
}

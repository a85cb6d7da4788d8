//! What was solved, and how well.

use flank_chain_dsl::{GeneratedSurface, Process};
use flank_draw::{Block, Column, ReportSection, Tone};
use flank_export::Face;

use super::Findings;
use super::result::{GeneratingProcess, ReportedSurface, SampledGrid};
use crate::project::quantity::NamedValue;
use crate::project::remark::NotDone;
use crate::solve::branches;
use crate::solve::certify;
use crate::solve::required;
use crate::solve::result::Certified;
use crate::solve::solved::Solved;
use crate::solve::step::Smooth;
use crate::solve::unsolved;

pub(super) fn section(findings: &Findings<'_, '_>) -> ReportSection {
    let mut blocks = vec![surfaces(findings)];
    blocks.extend(findings.solved().iter().filter_map(|solved| missing(findings, solved)));
    blocks.push(roots(findings));
    blocks.extend(certificates(findings));
    blocks.extend(faces(findings));
    blocks.extend(requirements(findings));
    ReportSection { title: "What was solved".to_string(), blocks }
}

fn surfaces(findings: &Findings<'_, '_>) -> Block {
    let columns = vec![
        Column::words("surface"),
        Column::sentences("made as"),
        Column::words("rows \u{d7} columns"),
        Column::numbers("asked"),
        Column::numbers("solved"),
        Column::numbers("worst residual, mm"),
        Column::numbers("evaluations"),
    ];
    let row = |solved: &Solved<'_, '_>| {
        let [rows, columns] = solved.sample.counts;
        let along = solved.sample.labels.each_ref().map(|label| label.replace("->", "\u{2192}"));
        vec![
            solved.surface.name.clone(),
            made(findings, solved.surface),
            format!("{rows} ({}) \u{d7} {columns} ({})", along[0], along[1]),
            solved.summary.asked.to_string(),
            solved.summary.solved().to_string(),
            solved.summary.worst_residual.map_or("\u{2013}".to_string(), |worst| format!("{worst:.1e}")),
            solved.effort.evaluations.to_string(),
        ]
    };
    let caption = "Surfaces; evaluations are those of the equations with their Jacobian by Newton's method";
    Block::Table(caption.to_string(), columns, findings.solved().iter().map(row).collect())
}

/// `envelope of c.flank over roll, in m.work`
fn made(findings: &Findings<'_, '_>, surface: &GeneratedSurface<'_>) -> String {
    let generation = &surface.generation;
    let motions = findings.job.motions.iter().filter(|motion| generation.motions.contains(&motion.variable));
    let motions: Vec<&str> = motions.map(|motion| motion.name.as_str()).collect();
    let over = if motions.is_empty() { String::new() } else { format!(" over {}", motions.join(", ")) };
    format!("{} of {}{over}, in {}", process(generation.process), generation.tool_name, surface.frame)
}

fn process(process: Process) -> &'static str {
    match process {
        Process::Envelope => "envelope",
        Process::Sweep => "sweep",
        Process::Move => "copy",
    }
}

/// The points of a surface that were not solved, and why; nothing if all were.
fn missing(findings: &Findings<'_, '_>, solved: &Solved<'_, '_>) -> Option<Block> {
    let (asked, missing) = (solved.summary.asked, solved.summary.asked - solved.summary.solved());
    let text = format!("{missing} of {asked} points of {} are not solved", solved.surface.name);
    (missing > 0).then(|| Block::Notice(Tone::Bad, text, why_missing(findings, solved)))
}

fn why_missing(findings: &Findings<'_, '_>, solved: &Solved<'_, '_>) -> Vec<String> {
    let told = reasons_told(findings, solved);
    let branches = branches::ambiguous(std::slice::from_ref(solved));
    told.into_iter().chain(branches.iter().flat_map(NotDone::lines)).collect()
}

fn reasons_told(findings: &Findings<'_, '_>, solved: &Solved<'_, '_>) -> Vec<String> {
    unsolved::reasons((findings.job, Some(findings.origin)), solved, &findings.subject.solved)
        .iter()
        .map(|reason| findings.spelled(reason))
        .collect()
}

/// Which roots there are where each surface was begun.
fn roots(findings: &Findings<'_, '_>) -> Block {
    let columns = vec![
        Column::words("surface"),
        Column::words("begun at"),
        Column::numbers("roots that qualify"),
        Column::words("others that qualify"),
        Column::numbers("boxes searched"),
    ];
    let row = |solved: &Solved<'_, '_>| {
        let others = match solved.effort.undecided.len() {
            0 => "none: proven on intervals".to_string(),
            1 => "not excluded in one part".to_string(),
            parts => format!("not excluded in {parts} parts"),
        };
        let kept = if solved.sample.keep.is_empty() { "" } else { "; by \u{201c}keep\u{201d}" };
        vec![
            solved.surface.name.clone(),
            branches::anchor(solved),
            solved.effort.branches.len().to_string(),
            format!("{others}{kept}"),
            solved.effort.boxes.to_string(),
        ]
    };
    let caption = "Which root: all were looked for at one point of each grid, the others follow from it";
    Block::Table(caption.to_string(), columns, findings.solved().iter().map(row).collect())
}

fn certificates(findings: &Findings<'_, '_>) -> Option<Block> {
    let row = |solved: &Solved<'_, '_>| {
        let Certified { points: count, radius } = certify::proven(solved)?;
        let largest = radius.map_or("\u{2013}".to_string(), |radius| format!("{radius:.1e}"));
        let open = solved.summary.solved() - count;
        Some(vec![solved.surface.name.clone(), count.to_string(), open.to_string(), largest])
    };
    let rows: Vec<Vec<String>> = findings.solved().iter().filter_map(row).collect();
    let columns = vec![
        Column::words("surface"),
        Column::numbers("certified points"),
        Column::numbers("not certified"),
        Column::numbers("exactly one root within, mm"),
    ];
    (!rows.is_empty()).then(|| Block::Table("Certificates: proofs on intervals".to_string(), columns, rows))
}

/// How far the smooth faces of the STEP file are off.
fn faces(findings: &Findings<'_, '_>) -> Option<Block> {
    let columns = vec![
        Column::words("surface"),
        Column::words("through points"),
        Column::numbers("points beyond it"),
        Column::numbers("off by at most, um"),
        Column::numbers("at exact points"),
        Column::numbers("not measured at"),
    ];
    let row = |smooth: &Smooth| {
        let none = || "\u{2013}".to_string();
        let face = smooth.face.as_ref();
        let off = face.and_then(|face| face.deviation);
        vec![
            smooth.name.clone(),
            face.map(Face::counts).map_or_else(none, |[rows, columns]| format!("{rows} \u{d7} {columns}")),
            face.map_or_else(none, |face| face.left_out.to_string()),
            off.map_or_else(none, |off| format!("{:.2e}", 1e3 * off.largest)),
            off.map_or_else(none, |off| off.points.to_string()),
            off.map_or_else(none, |off| off.missing.to_string()),
        ]
    };
    let rows: Vec<Vec<String>> = findings.faces.iter().map(row).collect();
    let caption = "Faces of the STEP file: distances from exact points between those that they go through";
    (!rows.is_empty()).then(|| Block::Table(caption.to_string(), columns, rows))
}

/// What the samples require of their points, and where it does not hold.
fn requirements(findings: &Findings<'_, '_>) -> Option<Block> {
    let limits = findings.solved().iter().flat_map(|solved| &solved.sample.limits).count();
    let broken = required::missed(findings.solved());
    match (limits, broken.is_empty()) {
        (0, _) => None,
        (count, true) => {
            let text =
                format!("All {count} requirements that samples make of their points hold at every solved point.");
            Some(Block::Paragraph(text))
        }
        (_, false) => {
            let lines = broken.iter().flat_map(NotDone::lines).collect();
            Some(Block::Notice(Tone::Bad, "Requirements of samples do not hold".to_string(), lines))
        }
    }
}

/// What `flank solve` reports of each surface, and how it was made.
pub(super) fn told(findings: &Findings<'_, '_>) -> Vec<ReportedSurface> {
    let entry = |solved: &Solved<'_, '_>| {
        let generation = &solved.surface.generation;
        ReportedSurface {
            solved: solved.result(),
            process: match generation.process {
                Process::Envelope => GeneratingProcess::Envelope,
                Process::Sweep => GeneratingProcess::Sweep,
                Process::Move => GeneratingProcess::Copy,
            },
            tool: generation.tool_name.clone(),
            chain: generation.path.iter().map(|(frame, _)| frame.clone()).collect(),
            grid: SampledGrid { counts: solved.sample.counts, labels: solved.sample.labels.clone() },
            anchor: anchor(solved),
            reasons: reasons_told(findings, solved),
            certified: certify::proven(solved),
            curvature: super::extremes::told(solved),
        }
    };
    findings.solved().iter().map(entry).collect()
}

fn anchor(solved: &Solved<'_, '_>) -> Vec<NamedValue> {
    let coordinates = solved.sample.coordinates.iter().zip(solved.effort.anchor);
    coordinates.map(|(of, value)| NamedValue::new(&of.name, of.dimension, value)).collect()
}

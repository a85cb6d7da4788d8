//! Where a report comes from, and how its numbers and files are meant.

use flank_draw::{Block, ReportSection};
use flank_solver::TOLERANCE;

use super::Findings;
use crate::project::shown_path;

pub(super) fn section(findings: &Findings<'_, '_>) -> ReportSection {
    let facts: Vec<(String, String)> = facts(findings).map(|(name, value)| (name.to_string(), value)).into();
    let blocks = vec![Block::Facts(facts), Block::List(sentences(findings))];
    ReportSection { title: "Conventions and origin".to_string(), blocks }
}

fn facts(findings: &Findings<'_, '_>) -> [(&'static str, String); 5] {
    let header = &findings.header;
    let files: Vec<String> = findings
        .sources
        .files()
        .filter(|(_, source)| source.file.is_some())
        .map(|(_, source)| shown_path(&source.path))
        .collect();
    [
        ("command", command(findings)),
        ("program", header.program.clone()),
        ("files read", files.join(", ")),
        ("hash", header.spec_hash.clone()),
        ("tolerance", format!("{TOLERANCE:.0e} mm, or mm per radian of a motion, for each equation of a solved point")),
    ]
}

/// How numbers and files are meant.
pub(super) fn sentences(findings: &Findings<'_, '_>) -> Vec<String> {
    let own = [
        "deviations and normal displacements are along the normal; plus is material",
        "a curvature is positive where the body is convex",
        "\u{201c}radius from the axis\u{201d} is the distance from the z axis of the frame that a surface is in",
    ];
    let of_files = flank_export::conventions(&findings.header);
    of_files.into_iter().chain(own.map(str::to_string)).collect()
}

/// What makes this page again, as words of a shell, without where to.
pub(super) fn command(findings: &Findings<'_, '_>) -> String {
    let which = &findings.request.jobs;
    let mut words = vec!["flank".to_string(), "report".to_string(), shown_path(which.file())];
    let option = |name: &str| findings.spelled(&format!("option `{name}`"));
    words.extend([option("job"), findings.job.name.clone()]);
    for (name, value) in which.set_in(&[findings.job]) {
        words.extend([option("set"), format!("{name}={value}")]);
    }
    words.extend(findings.is_certified.then(|| option("certify")));
    words.extend(findings.request.step.map(|tolerance| option(&format!("step={tolerance}mm"))));
    if let Some(date) = &findings.request.date {
        words.extend([option("date"), date.clone()]);
    }
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./=:,+%@".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_string()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

//! What was not checked: each sentence is there because of what was, or was not, done for this job.

use flank_chain_dsl::LawSource;

use super::Findings;
use crate::solve::certify;
use crate::solve::secondary;
use crate::solve::solved::Solved;

/// What of this job was not looked at, then what no report looks at.
pub(super) struct Unchecked {
    pub(super) of_job: Vec<String>,
    pub(super) always: Vec<String>,
}

pub(super) fn unchecked(findings: &Findings<'_, '_>) -> Unchecked {
    let of_job = [
        not_sampled(findings),
        not_certified(findings),
        not_kept(findings),
        not_excluded(findings),
        one_place(findings),
        not_trimmed(findings),
        other_positions(findings),
        steps_of_the_tool(findings),
        counts(findings),
        without_travel(findings),
        without_place(findings),
        without_range(findings),
        without_requirement(findings),
    ];
    let pair = match findings.job.contacts.is_empty() {
        true => {
            "Meshing with a mating gear, contact pattern, backlash, strength: flank deviation compares two surfaces."
        }
        false => {
            "Contact under load: strength, deflection, load distribution; the members are rigid, and no oil lies between them."
        }
    };
    let always = [
        "Between the points of the grids nothing is solved; a finer grid in \u{201c}sample\u{201d} shows more.",
        "Collisions of tool, holder, machine, work and fixture, and what the tool cuts on its way in and out.",
        "Speeds, accelerations, order and duration of the motions; forces, deflection, heat, wear.",
        "Manufacturing tolerances, and errors of machine, tool and clamping.",
        pair,
        "Whether the numbers in the spec are those of the real tool and machine.",
    ];
    Unchecked { of_job: of_job.into_iter().flatten().collect(), always: always.map(str::to_string).to_vec() }
}

fn named<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    names.into_iter().collect::<Vec<_>>().join(", ")
}

/// The names of the solved surfaces that something is true of.
fn those(findings: &Findings<'_, '_>, is_meant: impl Fn(&Solved<'_, '_>) -> bool) -> Option<String> {
    let meant = findings.solved().iter().filter(|solved| is_meant(solved));
    let names = named(meant.map(|solved| solved.surface.name.as_str()));
    (!names.is_empty()).then_some(names)
}

fn not_sampled(findings: &Findings<'_, '_>) -> Option<String> {
    let idle = findings.job.surfaces.iter().filter(|surface| surface.sample.is_none());
    let names = named(idle.map(|surface| surface.name.as_str()));
    (!names.is_empty())
        .then(|| format!("Surfaces without a \u{201c}sample\u{201d}, of which no point was solved: {names}."))
}

fn not_certified(findings: &Findings<'_, '_>) -> Option<String> {
    if !findings.is_certified {
        return Some(findings.spelled("The points are not certified: option `certify` proves each of them."));
    }
    let is_open = |solved: &Solved<'_, '_>| {
        certify::proven(solved).is_some_and(|certified| certified.points < solved.summary.solved())
    };
    those(findings, is_open).map(|names| format!("Some solved points could not be certified, on {names}."))
}

fn not_kept(findings: &Findings<'_, '_>) -> Option<String> {
    let parts = findings.solved().iter().filter(|solved| solved.streamed.is_some());
    let parts: Vec<String> = parts
        .map(|solved| format!("{} of {} of {}", solved.points.len(), solved.summary.asked, solved.surface.name))
        .collect();
    (!parts.is_empty()).then(|| {
        format!(
            "All points were solved; curvatures, what moves the surfaces, how far axes go and pictures are those of some rows and \
             columns: {} points.",
            parts.join(", ")
        )
    })
}

fn not_excluded(findings: &Findings<'_, '_>) -> Option<String> {
    let names = those(findings, |solved| !solved.effort.undecided.is_empty())?;
    Some(format!(
        "Whether the ranges hold further branches where the search began, for {names}; narrower ranges would show it."
    ))
}

fn one_place(findings: &Findings<'_, '_>) -> Option<String> {
    let names = those(findings, |solved| solved.summary.asked > 1)?;
    Some(format!(
        "Other branches than the one followed, away from the point at which all roots were looked for: {names}."
    ))
}

fn not_trimmed(findings: &Findings<'_, '_>) -> Option<String> {
    let is_alone = |solved: &Solved<'_, '_>| solved.surface.trimmed_by.is_empty();
    let names = those(findings, is_alone)?;
    Some(format!(
        "What surfaces of the tool that the job does not generate along the same motions, or other tools, cut away of {names}: no \u{201c}trim\u{201d} asks for it."
    ))
}

fn other_positions(findings: &Findings<'_, '_>) -> Option<String> {
    let unseen = secondary::unseen(findings.solved().iter().map(Solved::positions_tried));
    (!unseen.is_empty())
        .then(|| format!("Whether the tool, in another of its positions, cuts away points of {}.", unseen.join("; ")))
}

fn has_count(solved: &Solved<'_, '_>) -> bool {
    solved.surface.unknowns.iter().any(|unknown| unknown.is_count)
}

fn steps_of_the_tool(findings: &Findings<'_, '_>) -> Option<String> {
    let names = those(findings, |solved| solved.cut.is_none() && !has_count(solved))?;
    Some(format!(
        "Roughness, feed marks and facets of single edges on {names}: ideal surfaces, of tools without gaps. \u{201c}cut \u{2026} by \u{2026}\u{201d} says what edges leave."
    ))
}

fn counts(findings: &Findings<'_, '_>) -> Option<String> {
    let names = those(findings, has_count)?;
    Some(format!("Whether what is counted comes out whole: on {names} it runs on without steps."))
}

fn without_travel(findings: &Findings<'_, '_>) -> Option<String> {
    let open = findings.runs.iter().filter(|run| run.axis.travel.is_none() && run.axis.source != LawSource::Fixed);
    let names: Vec<String> = open.map(|run| run.name()).collect();
    (!names.is_empty())
        .then(|| format!("Whether the axes {} stay within their travel: the machine states none.", names.join(", ")))
}

fn without_place(findings: &Findings<'_, '_>) -> Option<String> {
    let open = findings.runs.iter().filter(|run| run.over.is_none());
    let names: Vec<String> = open.map(|run| run.name()).collect();
    (!names.is_empty()).then(|| format!("How far the axes {} go: no solved point says so.", names.join(", ")))
}

fn without_range(findings: &Findings<'_, '_>) -> Option<String> {
    let parameters = &findings.job.parameters;
    let open = parameters.iter().filter(|parameter| parameter.range.is_none()).count();
    (open > 0).then(|| {
        format!(
            "Whether {open} of {} inputs have values that can be meant: no range is stated for them.",
            parameters.len()
        )
    })
}

fn without_requirement(findings: &Findings<'_, '_>) -> Option<String> {
    let names = those(findings, |solved| solved.sample.limits.is_empty())?;
    Some(format!(
        "Whether {names} are the surfaces that are meant: no \u{201c}require\u{201d} in their samples says what those are like."
    ))
}

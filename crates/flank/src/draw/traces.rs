//! Profile and helix traces of the flanks of a cylindrical gear.

use flank_draw::{PictureOptions, TraceChart, TraceDrawing, traces as picture};
use flank_export::fixed;

use super::subject::Subject;
use super::{Drawing, Unfit, counted};
use crate::compare::trace_result::{FlankTraces, InvoluteNumbers, InvoluteSource, TraceNumbers};
use crate::compare::traces::traces;
use crate::project::failure::Failure;

/// Flanks on one sheet.
const MOST: usize = 4;

pub(super) fn draw(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let found = of_subject(subject)?;
    let drawing = TraceDrawing {
        header: subject.dataset.header.clone(),
        title: format!("{}: profile and helix traces", subject.job.name),
        note: note(&found),
        flanks: found.iter().take(MOST).map(charts).collect(),
    };
    let shows = format!("profile and helix traces of {}", counted(drawing.flanks.len(), "flank"));
    Ok(Drawing { picture: picture(&drawing, options), shows })
}

/// The traces of those of its surfaces that are flanks of a cylindrical gear: the chosen ones, or all.
///
/// # Errors
/// Why there are none.
pub(crate) fn of_subject(subject: &Subject<'_, '_>) -> Result<Vec<FlankTraces>, Unfit> {
    let of = |at: &usize| traces(subject.job, &subject.solved[*at], subject.session);
    let all: Vec<Result<FlankTraces, Failure>> = subject.in_space.iter().map(of).collect();
    let first = all.iter().find_map(|one| one.as_ref().err().map(ToString::to_string));
    let found: Vec<FlankTraces> = all.into_iter().filter_map(Result::ok).collect();
    match first {
        Some(why) if found.is_empty() => Err(why),
        _ => Ok(found),
    }
}

/// What flanks are held against, in words.
pub(crate) fn involute(of: &InvoluteNumbers) -> String {
    let by = match of.source {
        InvoluteSource::Job => "by the parameters of the job",
        InvoluteSource::Tool => {
            "by the parameters of the job and what its text says of the tool; parameters `module` and `pressure_angle` of the job say which is meant"
        }
        InvoluteSource::Flank => {
            "read off the normal in the middle of the flank, where slopes therefore vanish; parameters `module`, `teeth`, `pressure_angle` and \
             `helix_angle` of the job that are nearly the flank's say which is meant"
        }
    };
    format!(
        "the involute of base diameter {} mm and base helix angle {} deg, {by}",
        fixed(of.base_diameter_mm, 4),
        fixed(of.base_helix_angle_deg, 4)
    )
}

fn note(found: &[FlankTraces]) -> String {
    let Some(first) = found.first() else { return String::new() };
    format!(
        "Transverse, along the tangent to the base circle, from {}; zero in the middle, plus is material. Shaded: what is evaluated, with its \
         mean line dashed (ISO 1328-1:2013).",
        involute(&first.involute)
    )
}

fn charts(of: &FlankTraces) -> Vec<TraceChart> {
    let chart = |name: &str, across: &str, letter: char, of: &TraceNumbers| TraceChart {
        name: name.to_string(),
        across: across.to_string(),
        lengths: of.lengths_mm.clone(),
        deviations: of.deviations_um.clone(),
        range: [of.evaluated_from_mm, of.evaluated_to_mm],
        mean: of.mean,
        numbers: of.named(letter).map(|(name, um)| format!("{name} {} \u{b5}m", fixed(um, 2))).to_vec(),
    };
    vec![
        chart(&format!("{}, profile", of.surface), "length of roll, mm", '\u{3b1}', &of.profile),
        chart(&format!("{}, helix", of.surface), "z, mm", '\u{3b2}', &of.helix),
    ]
}

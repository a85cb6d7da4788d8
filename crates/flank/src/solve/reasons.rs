//! Why a point was not solved, in words.

use flank_chain_dsl::{GeneratedSurface, Job, RangedVariable};
use flank_solver::{CutBy, Outcome};

use crate::project::units;
use crate::solve::blank;
use crate::solve::summary::Summary;

/// By how much points are outside the ranges: `u by up to 0.168672 mm`; nothing if none is.
pub(crate) fn outside(surface: &GeneratedSurface<'_>, summary: &Summary) -> Option<String> {
    let each = surface.unknowns.iter().zip(&summary.outside).filter(|(_, outside)| outside.places.count > 0);
    let each: Vec<String> =
        each.map(|(of, outside)| format!("{} by up to {}", of.name, amount(of, outside.most))).collect();
    (!each.is_empty()).then(|| each.join(", "))
}

/// What an outcome's word does not tell of one point; may be empty.
pub(crate) fn of_point(job: &Job<'_>, surface: &GeneratedSurface<'_>, outcome: Outcome) -> String {
    match outcome {
        Outcome::Outside { unknown, by } => {
            let unknown = &surface.unknowns[unknown];
            format!("{} by {}", unknown.name, amount(unknown, by))
        }
        Outcome::NotKept { condition } => outside_keep(surface, condition),
        Outcome::CutAway(cutter) => by_what(job, surface, cutter),
        Outcome::NotConverged { iterations: 0 } => "no start leads there".to_string(),
        Outcome::NotConverged { iterations } => units::counted(iterations as usize, "iteration"),
        Outcome::Solved | Outcome::Undecided | Outcome::Singular | Outcome::Ambiguous => String::new(),
    }
}

/// Which condition of the sample a point does not meet.
pub(super) fn outside_keep(surface: &GeneratedSurface<'_>, condition: usize) -> String {
    let kept = surface.sample.as_ref().and_then(|sample| sample.keep.get(condition));
    kept.map_or_else(String::new, |(of, (low, high))| {
        let text = |x: f64| units::text(of.dimension, x, 4);
        format!("outside of `keep {}: {} .. {}`", of.name, text(*low), text(*high))
    })
}

pub(crate) fn by_what(job: &Job<'_>, surface: &GeneratedSurface<'_>, cutter: CutBy) -> String {
    match cutter {
        CutBy::ItsTool => "by the tool itself, beyond the singular line of the envelope (undercut)".to_string(),
        CutBy::ItsToolElsewhere(by) => {
            format!("by {} in another position of the tool", job.surfaces[by].generation.tool_name)
        }
        CutBy::Other(number) => {
            format!("by what makes {}, as `trim` asks for", job.surfaces[surface.trimmed_by[number]].name)
        }
        CutBy::Blank(segment) => blank::of(job, surface).map_or_else(String::new, |solid| {
            format!("beyond {} of solid {}, where its blank ends", solid.outline[segment].name, solid.name)
        }),
    }
}

pub(super) fn amount(of: &RangedVariable<'_>, by: f64) -> String {
    units::text(of.dimension, by, 6)
}

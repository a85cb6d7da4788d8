//! Points that the ranges do not reach: where they would lie if the ranges went on.

use flank_chain_dsl::GeneratedSurface;
use flank_solver::{Outcome, Range, SurfacePoint};

use crate::solve::ranges;
use crate::units;

/// What an unknown would have to run through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needed {
    unknown: usize,
    range: Range,
    /// Whether nothing else is missing.
    is_all: bool,
}

/// Where a surface is followed beyond its ranges: farther on, through a whole turn at least. What is counted goes no farther.
pub(crate) fn followed(surface: &GeneratedSurface<'_>) -> Vec<Range> {
    let wider = surface.unknowns.iter().zip(ranges(surface)).map(|(unknown, range)| match unknown.is_count {
        true => range,
        false => range.beyond(if units::is_angle(unknown.dimension) { std::f64::consts::TAU } else { 0.0 }),
    });
    wider.collect()
}

/// The ranges that would have reached the points that are outside.
pub(crate) fn needed(surface: &GeneratedSurface<'_>, points: &[SurfacePoint]) -> Vec<Needed> {
    let narrow = ranges(surface);
    let mut reached = vec![Range { low: f64::INFINITY, high: f64::NEG_INFINITY }; narrow.len()];
    for point in points.iter().filter(|point| matches!(point.outcome, Outcome::Solved | Outcome::Outside { .. })) {
        for (range, value) in reached.iter_mut().zip(&point.unknowns) {
            *range = Range { low: range.low.min(*value), high: range.high.max(*value) };
        }
    }
    let is_beyond = |(range, own): &(&Range, &Range)| range.low < own.low || range.high > own.high;
    let is_any = points.iter().any(|point| matches!(point.outcome, Outcome::Outside { .. }));
    let ends: Vec<Option<Range>> =
        reached.iter().zip(&narrow).map(|both| (is_any && is_beyond(&both)).then_some(*both.0)).collect();
    let is_all = ends.iter().flatten().count() == 1
        && points.iter().all(|point| !matches!(point.outcome, Outcome::NotConverged { .. }));
    let needed =
        ends.iter().enumerate().filter_map(|(unknown, end)| end.map(|range| Needed { unknown, range, is_all }));
    needed.collect()
}

impl Needed {
    /// `roll from -13.9439 to 4.1832 deg would reach them all; its range is -4.0000 .. 4.0000 deg`
    pub(crate) fn text(self, surface: &GeneratedSurface<'_>) -> String {
        let of = &surface.unknowns[self.unknown];
        let shown = |value: f64| units::digits(of.dimension, value, 4);
        let generation = &surface.generation;
        let is_motion = generation.motions.contains(&of.variable);
        let owner = if is_motion { String::new() } else { format!(" of {}", generation.tool_name) };
        let (low, high) = (shown(self.range.low), units::text(of.dimension, self.range.high, 4));
        let values = match high.strip_prefix(&low) {
            Some("" | " deg" | " mm") => format!("at {high}"),
            _ => format!("from {low} to {high}"),
        };
        format!(
            "{}{owner} {values} would reach {}; its range is {} .. {}",
            of.name,
            if self.is_all { "them all" } else { "more of them" },
            shown(of.low),
            units::text(of.dimension, of.high, 4),
        )
    }
}

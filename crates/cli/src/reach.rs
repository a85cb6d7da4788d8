//! Points that the ranges do not reach: where they would lie if the ranges went on.

use flank_chain_dsl::{Bounded, GeneratedSurface, Job, Sample};
use flank_solver::{Outcome, Range, SurfacePoint, SurfaceProblem};

use crate::arguments::Means;
use crate::solve::ranges;
use crate::units;

/// Lengths are looked for this many ranges beyond the ends of their own.
const FARTHER: f64 = 2.0;

/// What an unknown would have to run through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needed {
    unknown: usize,
    range: Range,
    /// Whether nothing else is missing.
    is_all: bool,
}

/// Follows the surface beyond its ranges to the points that they do not reach: angles over a whole turn, lengths farther out. What
/// is found there is [`Outcome::Outside`], and the ranges that would have been needed are given back.
pub(crate) fn beyond(
    job: &Job<'_>,
    surface: &GeneratedSurface<'_>,
    sample: &Sample<'_>,
    points: &mut [SurfacePoint],
    means: Means,
) -> Vec<Needed> {
    let is_open =
        |point: &SurfacePoint| matches!(point.outcome, Outcome::Outside { .. } | Outcome::NotConverged { .. });
    if !points.iter().any(is_open) {
        return Vec::new();
    }
    let narrow = ranges(surface);
    let wide: Vec<Range> =
        surface.unknowns.iter().zip(&narrow).map(|(unknown, range)| wider(unknown, *range)).collect();
    let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
    let problem = SurfaceProblem::new(&surface.surface, coordinates, wide, &job.bindings())
        .expect("a job without errors leaves nothing unbound")
        .on(means.instructions());
    let middle = (sample.counts[0] / 2) * sample.counts[1] + sample.counts[1] / 2;
    let targets = sample.targets();
    let Some(start) = start(&problem, targets[middle], &points[middle], points, &narrow) else {
        return Vec::new();
    };
    let (found, _) = problem.solve_points(&targets, sample.counts, Some(&start), None);
    let mut reached = vec![Range { low: f64::INFINITY, high: f64::NEG_INFINITY }; narrow.len()];
    for (k, point) in points.iter_mut().enumerate() {
        let mut unknowns = point.unknowns.clone();
        if is_open(point) {
            unknowns = found.unknowns(k);
            match farthest(&unknowns, &narrow) {
                Some((unknown, by)) if found.outcome(k) == Outcome::Solved => {
                    point.outcome = Outcome::Outside { unknown, by };
                }
                _ => continue,
            }
        } else if point.outcome != Outcome::Solved {
            continue;
        }
        for (range, value) in reached.iter_mut().zip(unknowns) {
            *range = Range { low: range.low.min(value), high: range.high.max(value) };
        }
    }
    let is_beyond = |(range, own): &(&Range, &Range)| range.low < own.low || range.high > own.high;
    let ends: Vec<Option<Range>> =
        reached.iter().zip(&narrow).map(|both| is_beyond(&both).then_some(*both.0)).collect();
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
        let shown = |value: f64| format!("{:.4}", units::shown(of.dimension, value));
        let generation = &surface.generation;
        let is_motion = generation.motions.contains(&of.variable);
        let owner = if is_motion { String::new() } else { format!(" of {}", generation.tool_name) };
        format!(
            "{}{owner} from {} to {} would reach {}; its range is {} .. {}",
            of.name,
            shown(self.range.low),
            units::text(of.dimension, self.range.high, 4),
            if self.is_all { "them all" } else { "more of them" },
            shown(of.low),
            units::text(of.dimension, of.high, 4),
        )
    }
}

fn wider(unknown: &Bounded<'_>, range: Range) -> Range {
    let Range { low, high } = range;
    if unknown.is_count {
        range
    } else if units::is_angle(unknown.dimension) {
        let middle = 0.5 * (low + high);
        Range { low: low.min(middle - std::f64::consts::PI), high: high.max(middle + std::f64::consts::PI) }
    } else {
        let by = FARTHER * (high - low);
        Range { low: low - by, high: high + by }
    }
}

/// Unknowns at the middle of the grid: what was found there, else the root nearest to points that were found, or to the ranges.
fn start(
    problem: &SurfaceProblem,
    target: [f64; 2],
    middle: &SurfacePoint,
    points: &[SurfacePoint],
    narrow: &[Range],
) -> Option<Vec<f64>> {
    if middle.outcome == Outcome::Solved {
        return Some(middle.unknowns.clone());
    }
    let known = points.iter().find(|point| point.outcome == Outcome::Solved);
    let away = |unknowns: &[f64]| {
        let shares = unknowns.iter().zip(narrow).enumerate().map(|(k, (value, range))| {
            known.map_or_else(|| excess(*range, *value), |point| (point.unknowns[k] - value).abs())
                / (range.high - range.low)
        });
        shares.fold(0.0, f64::max)
    };
    let roots = problem.all_points(target);
    let all = roots.isolated.into_iter().map(|root| root.solution).chain(roots.unproven);
    all.map(|root| root.unknowns).min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// The unknown that is farthest outside its range, relative to it, and by how much.
fn farthest(unknowns: &[f64], ranges: &[Range]) -> Option<(usize, f64)> {
    let outside = unknowns.iter().zip(ranges).map(|(value, range)| excess(*range, *value)).enumerate();
    let share = |(k, by): (usize, f64)| by / (ranges[k].high - ranges[k].low);
    outside.filter(|(_, by)| *by > 0.0).max_by(|a, b| share(*a).total_cmp(&share(*b)))
}

fn excess(range: Range, value: f64) -> f64 {
    (range.low - value).max(value - range.high).max(0.0)
}

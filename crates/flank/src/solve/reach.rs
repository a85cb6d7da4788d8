//! Points that the ranges do not reach: where they would lie if the ranges went on.

use flank_chain_dsl::{GeneratedSurface, Job, PieceEnds, RangedVariable};
use flank_solver::{Outcome, Range, SurfacePoint};

use crate::project::units;
use crate::solve::surface::ranges;

/// Of the ends that are told.
const DECIMALS: usize = 4;

/// What an unknown would have to run through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needed {
    unknown: usize,
    range: Range,
    /// Whether nothing else is missing.
    is_all: bool,
}

/// The ranges that would have reached the points that are outside.
pub(crate) fn needed(surface: &GeneratedSurface<'_>, points: &[SurfacePoint]) -> Vec<Needed> {
    let narrow = ranges(surface);
    let mut reached = vec![Range { low: f64::INFINITY, high: f64::NEG_INFINITY }; narrow.len()];
    // of a point that is only asked for outside, and was not found, nothing else is known
    let is_root = |point: &&SurfacePoint| {
        matches!(point.outcome, Outcome::Solved | Outcome::Outside { .. }) && point.residual.is_finite()
    };
    for point in points.iter().filter(is_root) {
        for (range, value) in reached.iter_mut().zip(&point.unknowns) {
            *range = Range { low: range.low.min(*value), high: range.high.max(*value) };
        }
    }
    let is_beyond = |(range, own): &(&Range, &Range)| range.low < own.low || range.high > own.high;
    let is_any = points.iter().any(|point| matches!(point.outcome, Outcome::Outside { .. }));
    let ends: Vec<Option<Range>> =
        reached.iter().zip(&narrow).map(|both| (is_any && is_beyond(&both)).then_some(*both.0)).collect();
    let is_all = ends.iter().flatten().count() == 1
        && points
            .iter()
            .all(|point| !matches!(point.outcome, Outcome::NotConverged { .. }) && point.residual.is_finite());
    let needed =
        ends.iter().enumerate().filter_map(|(unknown, end)| end.map(|range| Needed { unknown, range, is_all }));
    needed.collect()
}

impl Needed {
    /// `roll from -13.9439 to 4.1832 deg would reach them all; its range is -4.0000 .. 4.0000 deg`; of the run over a piece of a
    /// profile, what the profile goes on with.
    pub(crate) fn text(self, job: &Job<'_>, surface: &GeneratedSurface<'_>) -> String {
        let of = &surface.unknowns[self.unknown];
        if let Some(piece) = &of.piece {
            let beyond = [self.range.low < of.low, self.range.high > of.high];
            let ends = (0..2).filter(|k| beyond[*k]).map(|k| next_piece(job, surface, (of, piece), k));
            return ends.collect::<Vec<_>>().join("; ");
        }
        let shown = |value: f64| units::digits(of.dimension, value, DECIMALS);
        let generation = &surface.generation;
        let is_motion = generation.motions.contains(&of.variable);
        let owner = if is_motion { String::new() } else { format!(" of {}", generation.tool_name) };
        let values = match [self.range.low, self.range.high].map(shown) {
            [low, high] if low == high => format!("at {}", units::text(of.dimension, self.range.high, DECIMALS)),
            _ => {
                let [low, high] = [(self.range.low, false), (self.range.high, true)]
                    .map(|(end, is_upper)| units::end_digits(of.dimension, end, DECIMALS, is_upper));
                format!("from {low} to {high} {}", units::symbol(of.dimension)).trim_end().to_string()
            }
        };
        format!(
            "{}{owner} {values} would reach {}; its range is {} .. {}",
            of.name,
            if self.is_all { "them all" } else { "more of them" },
            shown(of.low),
            units::text(of.dimension, of.high, DECIMALS),
        )
    }
}

/// What a profile goes on with beyond the ends of the piece that a surface is made of, if the surface is made of a piece among others.
pub(crate) fn beside_piece(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Vec<String> {
    let pieces = surface.unknowns.iter().filter_map(|of| Some((of, of.piece.as_ref()?)));
    let ends = pieces.flat_map(|(of, piece)| {
        let followed = (0..2).filter(|k| piece.beside[*k].is_some());
        followed.map(move |k| next_piece(job, surface, (of, piece), k))
    });
    ends.collect()
}

/// What a profile goes on with at the lower (0) or upper (1) end of a piece, and which surface of the job is made of that.
fn next_piece(
    job: &Job<'_>,
    surface: &GeneratedSurface<'_>,
    (of, piece): (&RangedVariable<'_>, &PieceEnds),
    k: usize,
) -> String {
    let end = units::text(of.dimension, [of.low, of.high][k], 4);
    let ends_there = format!("`{}` {} at {} {end}", piece.name, ["begins", "ends"][k], of.name);
    let Some(next) = &piece.beside[k] else {
        return format!("{ends_there}, and with it the profile: there is no tool beyond");
    };
    let renamed = |name: &str| Some(format!("{}.{next}", name.strip_suffix(&piece.name)?.strip_suffix('.')?));
    let [own, tool] = [&surface.name, &surface.generation.tool_name].map(|name| renamed(name));
    let is_of_next = |other: &&GeneratedSurface<'_>| {
        other.frame == surface.frame
            && (own.as_ref() == Some(&other.name) || tool.as_ref() == Some(&other.generation.tool_name))
    };
    let way_out = match (job.surfaces.iter().find(is_of_next), tool) {
        (Some(other), _) => format!("sample `{}` for the points beyond", other.name),
        (None, Some(tool)) => format!("make a surface of `{tool}` for the points beyond"),
        (None, None) => "make a surface of it for the points beyond".to_string(),
    };
    let beside = ["before it lies", "behind it follows"][k];
    format!("{ends_there}, {beside} `{next}` of the same profile: {way_out}")
}

//! What is carried over: a tool that moves against a work.

use flank_chain_dsl::{Bounded, GeneratedSurface, Job, ToolShape, spaced};
use flank_expr::geometry::{Chain, Surface, Vector3};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Outcome, Range, Screw, SurfacePoint, symmetries};

use crate::arguments::Means;
use crate::solve::{self, Wanted};
use crate::{table, units};

/// Points that lie no farther apart than this share of a motion's range have it at one value: what differs is rounding.
const STILL: f64 = 1e-9;

/// Surfaces of a job that one tool makes in one work.
pub(crate) struct Source<'j, 'g> {
    /// Frames of the work and of the tool, as `m.work`.
    pub(crate) work: String,
    pub(crate) tool: String,
    /// From work to tool, in motions.
    pub(crate) driven: &'j Chain<'g>,
    pub(crate) motions: Vec<&'j Bounded<'g>>,
    /// Over which the motions are carried over: as far as the sampled points need them; all of them, where the points need none to move.
    pub(crate) ranges: Vec<Range>,
    /// Where all sampled points have the motions, if that is at one value of each.
    pub(crate) still: Option<Vec<f64>>,
    /// What the tool does not see of its own motion.
    pub(crate) symmetries: Vec<Screw>,
    /// The sampled points of each surface, with the tool's surface that made them.
    pub(crate) flanks: Vec<Flank<'j, 'g>>,
}

/// Points of one surface.
pub(crate) struct Flank<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    /// The tool's surface with numbers for its parameters.
    pub(crate) tool: Surface<'g>,
    pub(crate) points: Vec<SurfacePoint>,
    /// What `flank solve` tells of them beside numbers: which are not solved, and why; empty if all is well.
    told: String,
}

impl<'j, 'g> Source<'j, 'g> {
    /// # Errors
    /// In words, if it is not clear which tool is meant, or nothing moves.
    pub(crate) fn of(job: &'j Job<'g>, asked: Option<&str>, means: Means) -> Result<Source<'j, 'g>, String> {
        let path =
            |surface: &GeneratedSurface<'g>| (surface.frame.clone(), surface.generation.tool_frame().to_string());
        let named = |surface: &&&GeneratedSurface<'g>| match asked {
            Some(name) => surface.name == name,
            None => true,
        };
        let all: Vec<&GeneratedSurface<'g>> = job.surfaces.iter().collect();
        let Some(first) = all.iter().find(named) else {
            let names: Vec<&str> = all.iter().map(|surface| surface.name.as_str()).collect();
            return Err(format!("{} has no such surface: --surface {}", job.name, names.join(" or ")));
        };
        if asked.is_none()
            && let Some(other) = all.iter().find(|surface| path(surface) != path(first))
        {
            return Err(format!(
                "{} has several tools: {} is made in {} and {} in {}; say which is carried over: --surface {}",
                job.name, first.name, first.frame, other.name, other.frame, first.name
            ));
        }
        let generation = &first.generation;
        let motions: Vec<&Bounded<'g>> =
            job.motions.iter().filter(|motion| generation.motions.contains(&motion.variable)).collect();
        if motions.is_empty() {
            return Err(format!(
                "{} stands still while it makes {}: there is no motion to carry over",
                generation.tool_name, first.name
            ));
        }
        let mates = all
            .iter()
            .filter(|surface| path(surface) == path(first) && surface.generation.motions == generation.motions);
        let flanks = mates.filter_map(|&surface| flank(job, surface, means));
        let flanks: Vec<Flank<'j, 'g>> = flanks.collect::<Result<_, String>>()?;
        let tools: Vec<(&Surface<'g>, Vec<Range>)> = flanks
            .iter()
            .filter(|flank| flank.tool.unknowns.len() == 2)
            .map(|flank| (&flank.tool, solve::ranges(flank.surface)[..2].to_vec()))
            .collect();
        // an edge, or a tool that is an envelope itself, is carried over as it stands
        let is_plain = tools.len() == flanks.len() && !tools.is_empty();
        let unseen = if is_plain {
            symmetries(&tools).expect("a job without errors leaves nothing unbound")
        } else {
            Vec::new()
        };
        let (work, tool) = path(first);
        let needed: Vec<Range> = motions.iter().map(|motion| reached(motion, &flanks)).collect();
        let whole: Vec<Range> = motions.iter().map(|motion| Range { low: motion.low, high: motion.high }).collect();
        let stands = |(needed, whole): (&Range, &Range)| needed.high - needed.low <= STILL * (whole.high - whole.low);
        let (ranges, still) = if needed.iter().zip(&whole).all(stands) {
            (whole, Some(needed.iter().map(|needed| needed.low).collect()))
        } else {
            (needed, None)
        };
        Ok(Source { work, tool, driven: &generation.driven, motions, ranges, still, symmetries: unseen, flanks })
    }

    /// Positions evenly over the motions: one after the other for one motion; for two, row by row, there and back.
    pub(crate) fn positions(&self, count: usize) -> Vec<Vec<f64>> {
        let each = (count as f64).powf(1.0 / self.ranges.len() as f64).ceil() as usize;
        let mut positions: Vec<Vec<f64>> = vec![Vec::new()];
        for range in &self.ranges {
            let values = spaced((range.low, range.high), each.max(1));
            let extended = positions.iter().enumerate().flat_map(|(k, row)| {
                let values: Vec<f64> = if k % 2 == 0 { values.clone() } else { values.iter().rev().copied().collect() };
                values.into_iter().map(move |value| row.iter().copied().chain([value]).collect())
            });
            positions = extended.collect();
        }
        positions
    }

    /// The points that were not solved, in the words of `flank solve`; empty if all were.
    pub(crate) fn unsolved(&self) -> String {
        self.flanks.iter().map(|flank| flank.told.as_str()).collect()
    }

    /// `roll = 3.2000 deg`.
    pub(crate) fn place(&self, position: &[f64]) -> String {
        let each = self.motions.iter().zip(position);
        let each: Vec<String> =
            each.map(|(motion, at)| format!("{} = {}", motion.name, units::text(motion.dimension, *at, 4))).collect();
        each.join(", ")
    }
}

impl Flank<'_, '_> {
    pub(crate) fn solved(&self) -> impl Iterator<Item = &SurfacePoint> {
        self.points.iter().filter(|point| point.outcome == Outcome::Solved)
    }

    /// The largest distance of the tool's points that touch from the axis of a turn, mm.
    pub(crate) fn tool_radius(&self, turn: &Screw) -> Option<f64> {
        let graph = self.tool.position.0[0].graph();
        let [axis, linear] = [turn.angular, turn.linear].map(|v| Vector3::constant(graph, v));
        let arm = (self.tool.position - axis.cross(linear)).cross(axis);
        let tape =
            Tape::new(&[arm.dot(arm)], &self.tool.unknowns).expect("a job without errors leaves nothing unbound");
        let mut evaluator = ScalarEvaluator::new(&tape);
        let mut out = [0.0];
        let radii = self.solved().map(|point| {
            evaluator.run(&point.unknowns[..self.tool.unknowns.len()], &mut out);
            out[0].sqrt()
        });
        radii.reduce(f64::max)
    }
}

/// The points of a surface that the tool makes with a face of its own; nothing for an edge.
fn flank<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    means: Means,
) -> Option<Result<Flank<'j, 'g>, String>> {
    let tool = match &surface.generation.tool {
        ToolShape::Surface(tool) => tool.bound(&job.bindings()),
        ToolShape::Edge(_) => return None,
    };
    let wanted = Wanted {
        geometry: false,
        sensitivity: false,
        certificates: false,
        together: Some("carrying its tool over"),
        means,
    };
    Some(match solve::solve_surface(job, surface, wanted) {
        None => Ok(Flank { surface, tool, points: Vec::new(), told: String::new() }),
        Some(Ok(solved)) => {
            let told = table::failures(job, std::slice::from_ref(&solved));
            Ok(Flank { surface, tool, points: solved.points, told })
        }
        Some(Err(reason)) => Err(reason),
    })
}

/// As far as the solved points need a motion; all of it where there are none.
fn reached(motion: &Bounded<'_>, flanks: &[Flank<'_, '_>]) -> Range {
    let place = |surface: &GeneratedSurface<'_>, variable: Expr<'_>| {
        surface.unknowns.iter().position(|unknown| unknown.variable.as_variable() == variable.as_variable())
    };
    let values = flanks.iter().flat_map(|flank| {
        let at = place(flank.surface, motion.variable);
        flank.solved().filter_map(move |point| at.map(|at| point.unknowns[at]))
    });
    let ends = values.fold(None, |ends: Option<Range>, x| {
        Some(ends.map_or(Range { low: x, high: x }, |ends| Range { low: ends.low.min(x), high: ends.high.max(x) }))
    });
    ends.unwrap_or(Range { low: motion.low, high: motion.high })
}

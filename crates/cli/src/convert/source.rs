//! What is carried over: a tool that moves against a work.

use flank_chain_dsl::{Bounded, GeneratedSurface, Job, ToolShape};
use flank_expr::geometry::{Chain, Surface, Vector3};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Outcome, Range, Screw, SurfacePoint, symmetries};

use crate::arguments::Means;
use crate::{solve, units};

/// Surfaces of a job that one tool makes in one work.
pub(crate) struct Source<'j, 'g> {
    /// Frames of the work and of the tool, as `m.work`.
    pub(crate) work: String,
    pub(crate) tool: String,
    /// From work to tool, in motions.
    pub(crate) driven: &'j Chain<'g>,
    pub(crate) motions: Vec<&'j Bounded<'g>>,
    /// Over which the motions are carried over: as far as the sampled points need them.
    pub(crate) ranges: Vec<Range>,
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
        let flanks: Vec<Flank<'j, 'g>> = mates.filter_map(|&surface| flank(job, surface, means)).collect();
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
        let ranges = motions.iter().map(|motion| reached(motion, &flanks)).collect();
        Ok(Source { work, tool, driven: &generation.driven, motions, ranges, symmetries: unseen, flanks })
    }

    /// Positions evenly over the motions: one after the other for one motion; for two, row by row, there and back.
    pub(crate) fn positions(&self, count: usize) -> Vec<Vec<f64>> {
        let even = |range: &Range, count: usize| -> Vec<f64> {
            let share = |k: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
            (0..count).map(|k| (1.0 - share(k)) * range.low + share(k) * range.high).collect()
        };
        let each = (count as f64).powf(1.0 / self.ranges.len() as f64).ceil() as usize;
        let mut positions: Vec<Vec<f64>> = vec![Vec::new()];
        for range in &self.ranges {
            let values = even(range, each.max(1));
            let extended = positions.iter().enumerate().flat_map(|(k, row)| {
                let values: Vec<f64> = if k % 2 == 0 { values.clone() } else { values.iter().rev().copied().collect() };
                values.into_iter().map(move |value| row.iter().copied().chain([value]).collect())
            });
            positions = extended.collect();
        }
        positions
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
    /// The largest distance of the tool's points that touch from the axis of a turn, mm.
    pub(crate) fn tool_radius(&self, turn: &Screw) -> Option<f64> {
        let graph = self.tool.position.0[0].graph();
        let [axis, linear] = [turn.angular, turn.linear].map(|v| Vector3::constant(graph, v));
        let arm = (self.tool.position - axis.cross(linear)).cross(axis);
        let tape =
            Tape::new(&[arm.dot(arm)], &self.tool.unknowns).expect("a job without errors leaves nothing unbound");
        let mut evaluator = ScalarEvaluator::new(&tape);
        let mut out = [0.0];
        let solved = self.points.iter().filter(|point| point.outcome == Outcome::Solved);
        let radii = solved.map(|point| {
            evaluator.run(&point.unknowns[..self.tool.unknowns.len()], &mut out);
            out[0].sqrt()
        });
        radii.reduce(f64::max)
    }
}

fn flank<'j, 'g>(job: &'j Job<'g>, surface: &'j GeneratedSurface<'g>, means: Means) -> Option<Flank<'j, 'g>> {
    let tool = match &surface.generation.tool {
        ToolShape::Surface(tool) => tool.bound(&job.bindings()),
        ToolShape::Edge(_) => return None,
    };
    let points = surface.sample.as_ref().map_or(Vec::new(), |sample| {
        let coordinates = sample.coordinates.each_ref().map(|coordinate| coordinate.value);
        solve::problem(job, surface, coordinates, means).solve(&sample.targets(), sample.counts).0
    });
    Some(Flank { surface, tool, points })
}

/// As far as the solved points need a motion; all of it where there are none.
fn reached(motion: &Bounded<'_>, flanks: &[Flank<'_, '_>]) -> Range {
    let place = |surface: &GeneratedSurface<'_>, variable: Expr<'_>| {
        surface.unknowns.iter().position(|unknown| unknown.variable.as_variable() == variable.as_variable())
    };
    let values = flanks.iter().flat_map(|flank| {
        let at = place(flank.surface, motion.variable);
        let solved = flank.points.iter().filter(|point| point.outcome == Outcome::Solved);
        solved.filter_map(move |point| at.map(|at| point.unknowns[at]))
    });
    let ends = values.fold(None, |ends: Option<Range>, x| {
        Some(ends.map_or(Range { low: x, high: x }, |ends| Range { low: ends.low.min(x), high: ends.high.max(x) }))
    });
    ends.unwrap_or(Range { low: motion.low, high: motion.high })
}

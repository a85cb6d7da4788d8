//! What is carried over: a tool that moves against a work.

use flank_chain_dsl::{GeneratedSurface, Job, RangedVariable, ToolShape, spaced};
use flank_expr::geometry::{Chain, Surface, Vector3};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Outcome, Range, Screw, SurfacePoint, symmetries};

use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::session::Session;
use crate::project::units;
use crate::solve::stream;
use crate::solve::table;
use crate::solve::{self, SolveOptions};

/// Points that lie no farther apart than this share of a motion's range have it at one value: what differs is rounding.
const STILL: f64 = 1e-9;

/// Surfaces of a job that one tool makes in one work.
pub(crate) struct Source<'j, 'g> {
    /// Frames of the work and of the tool, as `m.work`.
    pub(crate) work: String,
    pub(crate) tool: String,
    /// The surfaces that this tool makes there over these motions.
    pub(crate) surfaces: Vec<&'j str>,
    /// Whether the job has other tools, or makes other works.
    pub(crate) is_one_of_several: bool,
    /// From work to tool, in motions.
    pub(crate) driven: &'j Chain<'g>,
    pub(crate) motions: Vec<&'j RangedVariable<'g>>,
    /// Over which the motions are carried over: as far as the sampled points need them; all of them, where the points need none to move.
    pub(crate) ranges: Vec<Range>,
    /// Where all sampled points have the motions, if that is at one value of each.
    pub(crate) still: Option<Vec<f64>>,
    /// Motions that leave the tool unchanged.
    pub(crate) symmetries: Vec<Screw>,
    /// The sampled points of each surface that a surface of the tool made, with that.
    pub(crate) flanks: Vec<Flank<'j, 'g>>,
    /// Which points are not solved, and why.
    pub(crate) unsolved: Vec<NotDone>,
}

/// Points of one surface that the tool makes with a face of its own.
pub(crate) struct Flank<'j, 'g> {
    pub(crate) surface: &'j GeneratedSurface<'g>,
    /// The tool's surface with numbers for its parameters.
    pub(crate) tool: Surface<'g>,
    pub(crate) points: Vec<SurfacePoint>,
}

/// The sampled points of a surface, and why some are not solved.
struct Made<'j, 'g> {
    surface: &'j GeneratedSurface<'g>,
    points: Vec<SurfacePoint>,
    told: Vec<NotDone>,
}

/// Which of a job's tools is carried over: what is known of it before any point is solved.
pub(super) struct Chosen<'j, 'g> {
    job: &'j Job<'g>,
    pub(super) work: String,
    pub(super) tool: String,
    /// The surfaces that the tool makes there over the motions.
    mates: Vec<&'j GeneratedSurface<'g>>,
    is_one_of_several: bool,
    pub(super) motions: Vec<&'j RangedVariable<'g>>,
}

impl<'j, 'g> Chosen<'j, 'g> {
    /// From work to tool, in motions.
    pub(super) fn driven(&self) -> &'j Chain<'g> {
        &self.mates[0].generation.driven
    }

    /// # Errors
    /// In words, if it is not clear which tool is meant, or nothing moves.
    pub(super) fn of_job(job: &'j Job<'g>, asked: Option<&str>) -> Result<Chosen<'j, 'g>, String> {
        let path =
            |surface: &GeneratedSurface<'g>| (surface.frame.clone(), surface.generation.tool_frame().to_string());
        let named = |surface: &&&GeneratedSurface<'g>| match asked {
            Some(name) => surface.name == name,
            None => true,
        };
        let all: Vec<&GeneratedSurface<'g>> = job.surfaces.iter().collect();
        let Some(first) = all.iter().find(named) else {
            let names: Vec<&str> = all.iter().map(|surface| surface.name.as_str()).collect();
            return Err(format!("{} has no such surface: option `surface` {}", job.name, names.join(" or ")));
        };
        let is_one_of_several = all.iter().any(|surface| path(surface) != path(first));
        if asked.is_none()
            && let Some(other) = all.iter().find(|surface| path(surface) != path(first))
        {
            return Err(format!(
                "{} has several tools: {} is made in {} and {} in {}; say which is carried over: option `surface {}`",
                job.name, first.name, first.frame, other.name, other.frame, first.name
            ));
        }
        let generation = &first.generation;
        let motions: Vec<&RangedVariable<'g>> =
            job.motions.iter().filter(|motion| generation.motions.contains(&motion.variable)).collect();
        if motions.is_empty() {
            return Err(format!(
                "{} stands still while it makes {}: there is no motion to carry over",
                generation.tool_name, first.name
            ));
        }
        let is_mate = |surface: &&&GeneratedSurface<'g>| {
            path(surface) == path(first) && surface.generation.motions == generation.motions
        };
        let mates = all.iter().filter(is_mate).copied().collect();
        let (work, tool) = path(first);
        Ok(Chosen { job, work, tool, mates, is_one_of_several, motions })
    }
}

impl<'j, 'g> Source<'j, 'g> {
    /// With its sampled points.
    ///
    /// # Errors
    /// In words, if a surface has more points than can be carried over.
    pub(super) fn of_chosen(chosen: Chosen<'j, 'g>, session: Session) -> Result<Source<'j, 'g>, Failure> {
        let Chosen { job, work, tool, mates, is_one_of_several, motions } = chosen;
        let wanted = SolveOptions {
            geometry: false,
            sensitivity: false,
            certificates: false,
            together: Some("carrying its tool over"),
            arrays: false,
            of_shown: false,
            session,
        };
        stream::check_kept(job, mates.iter().copied(), wanted)?;
        let made: Vec<Made<'j, 'g>> =
            mates.iter().map(|&surface| made(job, surface, wanted)).collect::<Result<_, Failure>>()?;
        let needed: Vec<Range> = motions.iter().map(|motion| reached(motion, &made)).collect();
        let unsolved = made.iter().flat_map(|made| made.told.iter().cloned()).collect();
        let count = made.len();
        let flanks: Vec<Flank<'j, 'g>> = made.into_iter().filter_map(|made| made.by_a_face(job)).collect();
        let tools: Vec<(&Surface<'g>, Vec<Range>)> = flanks
            .iter()
            .filter(|flank| flank.tool.unknowns.len() == 2)
            .map(|flank| (&flank.tool, solve::ranges(flank.surface)[..2].to_vec()))
            .collect();
        // an edge, or a tool that is an envelope itself, is carried over as it stands
        let is_plain = tools.len() == count && !tools.is_empty();
        let symmetries = if is_plain {
            symmetries(&tools).expect("a job without errors leaves nothing unbound")
        } else {
            Vec::new()
        };
        let whole: Vec<Range> = motions.iter().map(|motion| Range { low: motion.low, high: motion.high }).collect();
        let stands = |(needed, whole): (&Range, &Range)| needed.high - needed.low <= STILL * (whole.high - whole.low);
        let (ranges, still) = if needed.iter().zip(&whole).all(stands) {
            (whole, Some(needed.iter().map(|needed| needed.low).collect()))
        } else {
            (needed, None)
        };
        Ok(Source {
            work,
            tool,
            surfaces: mates.iter().map(|surface| surface.name.as_str()).collect(),
            is_one_of_several,
            driven: &mates[0].generation.driven,
            motions,
            ranges,
            still,
            symmetries,
            flanks,
            unsolved,
        })
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

/// The points of a surface; none where no sample asks for any.
fn made<'j, 'g>(
    job: &'j Job<'g>,
    surface: &'j GeneratedSurface<'g>,
    wanted: SolveOptions,
) -> Result<Made<'j, 'g>, Failure> {
    let Some(solved) = solve::solve_surface(job, surface, wanted).transpose()? else {
        return Ok(Made { surface, points: Vec::new(), told: Vec::new() });
    };
    let told = table::failures((job, None), std::slice::from_ref(&solved));
    Ok(Made { surface, points: solved.points, told })
}

impl<'j, 'g> Made<'j, 'g> {
    /// With the tool's surface; nothing for an edge.
    fn by_a_face(self, job: &Job<'g>) -> Option<Flank<'j, 'g>> {
        let Made { surface, points, .. } = self;
        match &surface.generation.tool {
            ToolShape::Surface(tool) => Some(Flank { surface, tool: tool.bound(&job.bindings()), points }),
            ToolShape::Edge(_) => None,
        }
    }
}

/// As far as the solved points need a motion; all of it where there are none.
fn reached(motion: &RangedVariable<'_>, made: &[Made<'_, '_>]) -> Range {
    let place = |surface: &GeneratedSurface<'_>, variable: Expr<'_>| {
        surface.unknowns.iter().position(|unknown| unknown.variable.as_variable() == variable.as_variable())
    };
    let values = made.iter().flat_map(|made| {
        let at = place(made.surface, motion.variable);
        let solved = made.points.iter().filter(|point| point.outcome == Outcome::Solved);
        solved.filter_map(move |point| at.map(|at| point.unknowns[at]))
    });
    let ends = values.fold(None, |ends: Option<Range>, x| {
        Some(ends.map_or(Range { low: x, high: x }, |ends| Range { low: ends.low.min(x), high: ends.high.max(x) }))
    });
    ends.unwrap_or(Range { low: motion.low, high: motion.high })
}

//! Jobs carried over to other machines.

use flank_chain_dsl::{Axis, Compilation, Dimension, Job, ToolShape, compile_with_machine};
use flank_expr::{Expr, Graph};
use flank_solver::{PoseProblem, Range, Screw, TargetAxis, symmetries};

use crate::repository;

/// Beyond this no slide without travel goes, mm.
const REACH: f64 = 1000.0;

/// The first surface of a job on another machine.
pub struct Conversion<'g> {
    /// What is solved.
    pub problem: PoseProblem<'g>,
    /// Names of the axes.
    pub axes: Vec<String>,
}

/// The first job of a file of the repository, and the machine of another one.
///
/// # Panics
/// If one of them is wrong.
pub fn compiled<'g>(graph: &'g Graph, [job, machine]: [&str; 2]) -> (Job<'g>, Job<'g>) {
    let Compilation { mut jobs, machine, diagnostics, .. } =
        compile_with_machine(graph, &repository(job), &repository(machine), &[]);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    (jobs.swap_remove(0), machine.expect("no error"))
}

/// What the tool of a surface does not see of its own motion.
///
/// # Panics
/// If the surface depends on something that is not bound.
pub fn tool_symmetries(job: &Job<'_>, surface: usize) -> Vec<Screw> {
    let surface = &job.surfaces[surface];
    let ToolShape::Surface(tool) = &surface.generation.tool else { return Vec::new() };
    let ranges = surface.unknowns[..2].iter().map(|u| Range { low: u.low, high: u.high }).collect();
    symmetries(&[(&tool.bound(&job.bindings()), ranges)]).expect("all bound")
}

/// All axes of a machine.
pub fn target_axes<'g>(target: &Job<'g>) -> Vec<TargetAxis<'g>> {
    let axis = |axis: &Axis<'g>| TargetAxis {
        variable: axis.variable,
        is_rotary: axis.dimension == Dimension::ANGLE,
        travel: axis.travel.map(|(low, high)| Range { low, high }),
    };
    target.machines[0].axes.iter().map(axis).collect()
}

impl<'g> Conversion<'g> {
    /// The frames are those of the machine's work and tool.
    ///
    /// # Panics
    /// If there are no such frames, or too many axes.
    pub fn new(graph: &'g Graph, job: &Job<'g>, target: &Job<'g>, frames: [&str; 2]) -> Conversion<'g> {
        let generation = &job.surfaces[0].generation;
        let machine = &target.machines[0];
        let chain = machine.chain(graph, frames[0], frames[1]).expect("both frames");
        let axes = target_axes(target);
        let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
        let (driven, motions) = (&generation.driven, &generation.motions);
        let slips = tool_symmetries(job, 0);
        let problem = PoseProblem::new(&chain, &axes, driven, motions, &slips, REACH, &bindings).expect("six axes");
        Conversion { problem, axes: machine.axes.iter().map(|axis| axis.name.clone()).collect() }
    }
}

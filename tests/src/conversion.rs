//! Jobs carried over to other machines.

use flank_chain_dsl::Job;
use flank_expr::{Expr, Graph};
use flank_solver::{PoseProblem, TargetAxis};

use crate::machines::{beside, target_axis, unseen};

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
pub fn compiled<'g>(graph: &'g Graph, files: [&str; 2]) -> (Job<'g>, Job<'g>) {
    let (mut jobs, machine) = beside(graph, files, &[]);
    (jobs.swap_remove(0), machine)
}

/// All axes of a machine.
pub fn target_axes<'g>(target: &Job<'g>) -> Vec<TargetAxis<'g>> {
    target.machines[0].axes.iter().map(target_axis).collect()
}

impl<'g> Conversion<'g> {
    /// The frames are those of the machine's work and tool.
    ///
    /// # Panics
    /// If there are no such frames, or too many axes.
    pub fn new(graph: &'g Graph, job: &Job<'g>, target: &Job<'g>, frames: [&str; 2]) -> Conversion<'g> {
        let surface = &job.surfaces[0];
        let machine = &target.machines[0];
        let chain = machine.chain(graph, frames[0], frames[1]).expect("both frames");
        let axes = target_axes(target);
        let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
        let [chain, driven] = [&chain, &surface.generation.driven].map(|chain| chain.substituted(&bindings));
        let motions = &surface.generation.motions;
        let slips = unseen(job, surface);
        let problem = PoseProblem::new(&chain, &axes, &driven, motions, &slips, REACH).expect("six axes");
        Conversion { problem, axes: machine.axes.iter().map(|axis| axis.name.clone()).collect() }
    }
}

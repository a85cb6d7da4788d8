//! Jobs beside machines that they are carried over to.

use flank_chain_dsl::{Axis, Dimension, GeneratedSurface, Job, ToolShape, compile_with_machine, render};
use flank_expr::Graph;
use flank_solver::{Range, Screw, TargetAxis, symmetries};

use crate::repository;

/// The jobs of a spec, and the last machine of another one by itself, with values for its settings.
///
/// # Panics
/// With the diagnostics, if there are errors.
pub fn beside<'g>(graph: &'g Graph, [job, machine]: [&str; 2], set: &[(String, String)]) -> (Vec<Job<'g>>, Job<'g>) {
    let compilation = compile_with_machine(graph, &repository(job), &repository(machine), set);
    let told = render(&compilation.diagnostics, &compilation.sources, false);
    assert!(!compilation.has_errors(), "{job} beside {machine}:\n{told}");
    (compilation.jobs, compilation.machine.expect("there is no error"))
}

/// An axis as poses are asked for.
pub fn target_axis<'g>(axis: &Axis<'g>) -> TargetAxis<'g> {
    TargetAxis {
        variable: axis.variable,
        is_rotary: axis.dimension == Dimension::ANGLE,
        travel: axis.travel.map(|(low, high)| Range { low, high }),
    }
}

/// What the tool of a surface does not see of its own motion: of a plain surface, which is neither an edge nor generated itself.
///
/// # Panics
/// If a variable is not bound.
pub fn unseen(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Vec<Screw> {
    let ToolShape::Surface(tool) = &surface.generation.tool else { return Vec::new() };
    if tool.unknowns.len() != 2 {
        return Vec::new();
    }
    let ranges = surface.unknowns[..2].iter().map(|u| Range { low: u.low, high: u.high }).collect();
    symmetries(&[(&tool.bound(&job.bindings()), ranges)]).expect("nothing is unbound")
}

//! What the page knows of a surface beside its points: frames, and the equations that it solves anew.

use flank_chain_dsl::{Job, Machine};
use flank_draw::PageSurface;
use flank_expr::{Expr, Graph};

use super::functions::Functions;
use crate::solve::solved::Solved;

pub(super) fn page_surface<'g>(
    graph: &'g Graph,
    job: &Job<'g>,
    solved: &Solved<'_, 'g>,
    functions: &mut Functions<'g>,
) -> PageSurface {
    let (surface, sample) = (solved.surface, solved.sample);
    let (machine, frame_index) = frame(job, &surface.frame);
    let (_, tool_frame) = frame(job, surface.generation.tool_frame());
    let made = &surface.surface;
    let coordinates = sample.functions();
    let conditions = made.clearance_minors();
    let curvatures = made.principal_curvatures(coordinates);
    let targets = ["target 1", "target 2"].map(|name| graph.variable(name));
    let asked = coordinates.into_iter().zip(targets).map(|(coordinate, target)| coordinate - target);
    let residuals: Vec<Expr<'g>> = made.constraints.iter().copied().chain(asked).collect();
    let jacobian = residuals.iter().flat_map(|residual| made.unknowns.iter().map(|p| residual.derivative(*p)));
    let equations: Vec<Expr<'g>> = residuals.iter().copied().chain(jacobian).collect();
    let point: Vec<Expr<'g>> = made.position.0.into_iter().chain(made.normal.0).chain(conditions.clone()).collect();
    let point: Vec<Expr<'g>> = point.into_iter().chain(curvatures.into_iter().flatten()).collect();
    let motion = |unknown: &Expr<'g>| job.motions.iter().position(|motion| motion.variable == *unknown);
    PageSurface {
        machine,
        frame_index,
        tool_frame,
        contact: (0..made.unknowns.len()).filter(|k| surface.generation.motions.contains(&made.unknowns[*k])).collect(),
        coordinates: sample.coordinates.each_ref().map(|coordinate| coordinate.name.clone()),
        targets: (0..solved.points.len()).map(|at| solved.place(at)).map(|[i, j]| sample.grid.at(i, j)).collect(),
        shares: [0, 1].map(|k| {
            let last = sample.counts[k].max(2) - 1;
            solved.lines[k].iter().map(|line| *line as f64 / last as f64).collect()
        }),
        corners: functions.add("corners", &[], &titled(sample.ends.corners().as_flattened(), "coordinates")),
        ranges: surface.unknowns.iter().map(|unknown| [unknown.low, unknown.high]).collect(),
        motions: made.unknowns.iter().map(motion).collect(),
        equations: functions.add(
            "equations",
            &[&made.unknowns[..], &targets].concat(),
            &titled(&equations, "residuals, Jacobian"),
        ),
        point: functions.add("point", &made.unknowns, &titled(&point, "position, normal, conditions, curvatures")),
        conditions: conditions.len(),
        curvatures: curvatures.is_some(),
        trimmed_by: surface.trimmed_by.iter().map(|&by| job.surfaces[by].name.clone()).collect(),
    }
}

/// One title for all outputs together.
fn titled<'g, 't>(outputs: &[Expr<'g>], title: &'t str) -> Vec<(&'t str, Expr<'g>)> {
    outputs.iter().map(|output| (title, *output)).collect()
}

/// Machine and frame of a name such as `m.table`, by their places.
pub(super) fn frame(job: &Job<'_>, name: &str) -> (usize, usize) {
    let of = |(k, machine): (usize, &Machine<'_>)| {
        let frame = name.strip_prefix(&machine.name)?.strip_prefix('.')?;
        Some((k, machine.frames.iter().position(|one| one.name == frame)?))
    };
    job.machines.iter().enumerate().find_map(of).expect("frames of a job without errors are those of its machines")
}

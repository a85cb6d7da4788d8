//! What the tools of a job look like.

use std::collections::HashMap;

use flank_chain_dsl::{GeneratedSurface, Job, ToolShape};
use flank_draw::{PageTool, Revolution, ToolForm};
use flank_expr::geometry::{Surface, Vector3};
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Range, Screw, symmetries};

use super::functions::Functions;
use super::surfaces::frame;
use crate::solve::solved::Solved;

/// Numbers of steps that a parameter of a tool is divided into.
const STEPS: [usize; 10] = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512];
/// The finest division is taken whose chords stay this near, as a share of the tool's size.
const CHORD: f64 = 1e-3;
/// A turn that rises by less, mm per radian, is one about an axis and no screw.
const NO_RISE: f64 = 1e-9;

/// Each tool once, however many surfaces it makes.
pub(super) fn page_tools<'g>(job: &Job<'g>, all: &[Solved<'_, 'g>], functions: &mut Functions<'g>) -> Vec<PageTool> {
    let mut tools: Vec<PageTool> = Vec::new();
    let mut turns: HashMap<&str, Option<Screw>> = HashMap::new();
    for (number, solved) in all.iter().enumerate() {
        let generation = &solved.surface.generation;
        let (machine, frame) = frame(job, generation.tool_frame());
        let name = &generation.tool_name;
        if tools.iter().any(|tool| (&tool.name, tool.machine, tool.frame) == (name, machine, frame)) {
            continue;
        }
        let tool_frame = generation.tool_frame();
        let turn = *turns.entry(tool_frame).or_insert_with(|| turn(job, tool_frame, all));
        let form = form(job, (number, solved.surface), turn, functions);
        tools.push(PageTool { name: name.clone(), machine, frame, form });
    }
    tools
}

/// What the tool of a surface looks like, whose number counts among those that are solved; `turn` is the turn that leaves it unchanged.
fn form<'g>(
    job: &Job<'g>,
    (number, generated): (usize, &GeneratedSurface<'g>),
    turn: Option<Screw>,
    functions: &mut Functions<'g>,
) -> ToolForm {
    let generation = &generated.generation;
    let range = |unknown: Expr<'g>| range(generated, unknown);
    let titled = |position: Vector3<'g>| position.0.map(|component| ("position in the tool's frame", component));
    match &generation.tool {
        ToolShape::Surface(surface) if !surface.constraints.is_empty() => ToolForm::Contact { surface: number },
        ToolShape::Surface(surface) => {
            let (unknowns, position) = ([surface.unknowns[0], surface.unknowns[1]], surface.position);
            let [u, v] = grid(job, position, unknowns, unknowns.map(range));
            let axis = turn.map(|turn| revolution(job, surface, unknowns.map(range), turn));
            ToolForm::Surface { position: functions.add("tool", &unknowns, &titled(position)), u, v, axis }
        }
        ToolShape::Edge(edge) => {
            let [u, _] = grid(job, edge.position, [edge.parameter; 2], [range(edge.parameter); 2]);
            ToolForm::Edge { position: functions.add("edge", &[edge.parameter], &titled(edge.position)), u }
        }
    }
}

/// The range of one of a tool's parameters.
fn range<'g>(generated: &GeneratedSurface<'g>, unknown: Expr<'g>) -> [f64; 2] {
    let of = generated.unknowns.iter().find(|known| known.variable == unknown);
    of.map_or([0.0, 1.0], |known| [known.low, known.high])
}

/// The rotation that leaves all surfaces of a tool unchanged: all that stand in its frame together, since a plane or a cylinder by
/// itself may turn about more than the tool.
fn turn<'g>(job: &Job<'g>, tool_frame: &str, all: &[Solved<'_, 'g>]) -> Option<Screw> {
    let parts = all.iter().map(|solved| solved.surface).filter(|made| made.generation.tool_frame() == tool_frame);
    let parts = parts.map(|made| match &made.generation.tool {
        ToolShape::Surface(surface) if surface.constraints.is_empty() => {
            let ranges = surface.unknowns.iter().map(|unknown| range(made, *unknown));
            Some((surface.bound(&job.bindings()), ranges.map(|[low, high]| Range { low, high }).collect()))
        }
        ToolShape::Surface(_) | ToolShape::Edge(_) => None,
    });
    let parts: Vec<(Surface<'g>, Vec<Range>)> = parts.collect::<Option<_>>()?;
    let borrowed: Vec<(&Surface<'g>, Vec<Range>)> = parts.iter().map(|(part, ranges)| (part, ranges.clone())).collect();
    let screws = symmetries(&borrowed).expect("a job without errors leaves nothing unbound");
    let [only] = screws.as_slice() else { return None };
    let rise: f64 = (0..3).map(|k| only.angular[k] * only.linear[k]).sum();
    (only.angular != [0.0; 3] && rise.abs() < NO_RISE).then_some(*only)
}

/// The axis of a turn, and which parameter of a surface runs around it.
fn revolution<'g>(job: &Job<'g>, surface: &Surface<'g>, ranges: [[f64; 2]; 2], turn: Screw) -> Revolution {
    let through = cross(turn.angular, turn.linear);
    let slopes = surface.unknowns.iter().flat_map(|unknown| surface.position.derivative(*unknown).0);
    let outputs: Vec<Expr<'g>> = surface.position.0.into_iter().chain(slopes).collect();
    let bound = outputs[0].graph().substitute(&outputs, &job.bindings());
    let tape = Tape::new(&bound, &surface.unknowns).expect("a job without errors leaves nothing unbound");
    let mut out = [0.0; 9];
    ScalarEvaluator::new(&tape).run(&ranges.map(|range| between(range, 0.5)), &mut out);
    let way = cross(turn.angular, [0, 1, 2].map(|k| out[k] - through[k]));
    let share = |at: usize| {
        let slope = [out[at], out[at + 1], out[at + 2]];
        let along: f64 = (0..3).map(|k| slope[k] * way[k]).sum();
        along.abs() / slope.into_iter().fold(0.0, f64::hypot)
    };
    Revolution { through, direction: turn.angular, around: usize::from(share(6) > share(3)) }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Values of both parameters, as many as its form needs.
fn grid<'g>(job: &Job<'g>, position: Vector3<'g>, unknowns: [Expr<'g>; 2], ranges: [[f64; 2]; 2]) -> [Vec<f64>; 2] {
    let bound = position.0[0].graph().substitute(&position.0, &job.bindings());
    let inputs = if unknowns[0] == unknowns[1] { &unknowns[..1] } else { &unknowns[..] };
    let tape = Tape::new(&bound, inputs).expect("a job without errors leaves nothing unbound");
    let at = |shares: [f64; 2]| {
        let values: Vec<f64> = (0..inputs.len()).map(|k| between(ranges[k], shares[k])).collect();
        let mut out = [0.0; 3];
        ScalarEvaluator::new(&tape).run(&values, &mut out);
        out
    };
    let steps = [0, 1].map(|k| steps(|along, across| at(if k == 0 { [along, across] } else { [across, along] })));
    [0, 1].map(|k| (0..=steps[k]).map(|step| between(ranges[k], step as f64 / steps[k] as f64)).collect())
}

fn between([low, high]: [f64; 2], share: f64) -> f64 {
    low * (1.0 - share) + high * share
}

/// The fewest steps along three lines of a surface that keep the middle of each chord near it.
fn steps(at: impl Fn(f64, f64) -> [f64; 3]) -> usize {
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] - b[k]).fold(0.0, f64::hypot);
    let lines = [0.0, 0.5, 1.0];
    let ends = lines.map(|across| apart(at(0.0, across), at(0.5, across)) + apart(at(0.5, across), at(1.0, across)));
    let size = ends.into_iter().chain([apart(at(0.5, 0.0), at(0.5, 1.0))]).fold(0.0, f64::max);
    let is_near = |steps: &usize| {
        let places = (0..*steps).map(|step| [step as f64, step as f64 + 0.5, step as f64 + 1.0]);
        places.map(|places| places.map(|place| place / *steps as f64)).all(|[from, middle, to]| {
            lines.iter().all(|&across| {
                let [a, b, c] = [from, middle, to].map(|along| at(along, across));
                let chord = [0, 1, 2].map(|k| 0.5 * (a[k] + c[k]));
                let off = apart(b, chord);
                // outside the surface's domain nothing is drawn
                off.is_nan() || off <= CHORD * size
            })
        })
    };
    STEPS.into_iter().find(is_near).unwrap_or(STEPS[STEPS.len() - 1])
}

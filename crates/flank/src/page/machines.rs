//! The machines of a job as functions of its motions and parameters.

use flank_chain_dsl::{Axis, Job, LawSource, Machine};
use flank_draw::{PageAxis, PageFrame, PageJoint, PageMachine};
use flank_expr::geometry::{Chain, Step, Vector3};
use flank_expr::{Expr, Graph};

use super::functions::Functions;
use crate::solve::unit;

pub(super) fn page_machine<'g>(
    graph: &'g Graph,
    job: &Job<'g>,
    (number, machine): (usize, &Machine<'g>),
    functions: &mut Functions<'g>,
) -> PageMachine {
    let root = &machine.frames[0].name;
    let chain = |frame: &str| machine.chain(graph, root, frame).expect("all frames hang on the root");
    let joints = joints(graph, job, machine);
    let mut outputs: Vec<Expr<'g>> = Vec::new();
    for frame in &machine.frames {
        outputs.extend(chain(&frame.name).pose().matrix4()[..3].concat());
    }
    outputs.extend(joints.iter().flat_map(|joint| joint.point.0.into_iter().chain(joint.direction.0)));
    outputs.extend(machine.axes.iter().map(|axis| axis.variable));
    // what cutter paths move stands at zero while the job generates
    let law = |axis: &Axis<'g>| if axis.source == LawSource::Free { graph.constant(0.0) } else { axis.law };
    let laws: Vec<(Expr<'g>, Expr<'g>)> = machine.axes.iter().map(|axis| (axis.variable, law(axis))).collect();
    let driven = graph.substitute(&outputs, &laws);
    let titled: Vec<_> = driven.into_iter().map(|output| ("poses of frames, joints, axes", output)).collect();
    let motions: Vec<Expr<'g>> = job.motions.iter().map(|motion| motion.variable).collect();
    let frame = |frame: &flank_chain_dsl::Frame<'g>| PageFrame { name: frame.name.clone(), parent: frame.parent };
    PageMachine {
        name: machine.name.clone(),
        definition: machine.definition.clone(),
        frames: machine.frames.iter().map(frame).collect(),
        joints: joints.into_iter().map(|joint| joint.page).collect(),
        axes: machine.axes.iter().map(axis).collect(),
        poses: functions.add(&format!("machine_{number}"), &motions, &titled),
    }
}

fn axis(axis: &Axis<'_>) -> PageAxis {
    PageAxis {
        name: axis.name.clone(),
        unit: unit(axis.dimension),
        law: match axis.source {
            LawSource::Driven => "driven",
            LawSource::Fixed => "fixed",
            LawSource::Coupled => "coupled",
            LawSource::Closed => "closed",
            LawSource::Free => "free",
        }
        .to_string(),
        travel: axis.travel.map(|(low, high)| [low, high]),
    }
}

/// Where a moving axis acts, in the root frame.
struct Joint<'g> {
    page: PageJoint,
    point: Vector3<'g>,
    direction: Vector3<'g>,
}

/// Of all axes that move, in the order of the frames.
fn joints<'g>(graph: &'g Graph, job: &Job<'g>, machine: &Machine<'g>) -> Vec<Joint<'g>> {
    let moves = |axis: &Axis<'g>| {
        let rates: Vec<Expr<'g>> = job.motions.iter().map(|motion| axis.law.derivative(motion.variable)).collect();
        graph.substitute(&rates, &job.bindings()).iter().any(|rate| !rate.is_zero())
    };
    let moving: Vec<(usize, &Axis<'g>)> = machine.axes.iter().enumerate().filter(|(_, axis)| moves(axis)).collect();
    let mut joints = Vec::new();
    for frame in &machine.frames {
        let root = &machine.frames[0].name;
        let parent = frame.parent.map_or(root, |parent| &machine.frames[parent].name);
        let t_root_parent = machine.chain(graph, root, parent).expect("all frames hang on the root");
        for (k, step) in frame.steps.iter().enumerate() {
            let t_root_step = t_root_parent.then(&Chain::new(graph, frame.steps[..k].to_vec()));
            joints.extend(moving.iter().filter_map(|&(axis, of)| joint(graph, &t_root_step, *step, (axis, of))));
        }
    }
    joints
}

/// Nothing if the axis does not move along or about the step.
fn joint<'g>(
    graph: &'g Graph,
    t_root_step: &Chain<'g>,
    step: Step<'g>,
    (axis, of): (usize, &Axis<'g>),
) -> Option<Joint<'g>> {
    let (way, is_rotary) = match step {
        Step::Translate(by) => (by.derivative(of.variable), false),
        Step::Rotate(about, angle) => (about.direction(graph).scaled(angle.derivative(of.variable)), true),
        Step::Rigid(_) | Step::Mirror(_) => return None,
    };
    (!way.is_zero()).then(|| Joint {
        page: PageJoint { axis, is_rotary },
        point: t_root_step.point(Vector3::zero(graph)),
        direction: t_root_step.direction(way.normalized()),
    })
}

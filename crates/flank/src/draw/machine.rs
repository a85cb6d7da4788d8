//! The machine of a job as a kinematic diagram, in the posture in which the middle of the first surface is made.

use flank_chain_dsl::{Axis, Dimension, Frame, Machine, Parameter};
use flank_draw::{DrawnFrame, LinkKind, MachineDrawing, MachineLink, PictureOptions, machine as diagram};
use flank_export::{Outcome, Patch, Point, fixed};
use flank_expr::Expr;
use flank_expr::geometry::{Chain, Pose, Step, Vector3};

use super::maps::{dot, unit};
use super::subject::{Subject, bound, number};
use super::tool::Tool;
use super::{Drawing, Unfit, counted};
use crate::project::units;

/// Points of the tool's surfaces in the diagram, in both directions.
const GRID: [usize; 2] = [9, 121];
/// A length in mm, or an angle in radians, that is none.
const ROUNDING: f64 = 1e-12;

/// What the numbers are taken from.
type Bindings<'g> = [(Expr<'g>, Expr<'g>)];

pub(super) fn draw(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let machine = subject.machine().ok_or("the surface stands in no machine")?;
    let (_, point) = subject.middle()?;
    let posture = subject.posture(point);
    let reader = Reader { subject, machine, posture: &posture };
    let mut frames: Vec<DrawnFrame> = Vec::new();
    let mut poses: Vec<Numbers> = Vec::new();
    for frame in &machine.frames {
        let start = frame.parent.map_or(Numbers::identity(), |at| poses[at]);
        let (drawn, pose) = reader.frame(frame, start);
        frames.push(drawn);
        poses.push(pose);
    }
    let surface = subject.first().surface;
    let work = surface.frame.split_once('.').map_or("", |(_, frame)| frame);
    let work = machine.frames.iter().position(|frame| frame.name == work).map_or(Numbers::identity(), |at| poses[at]);
    let motions: Vec<String> = surface.unknowns[surface.unknowns.len() - surface.generation.motions.len()..]
        .iter()
        .map(|motion| {
            format!("{} {}", motion.name, units::text(motion.dimension, number(motion.variable, &posture), 3))
        })
        .collect();
    let moment = if motions.is_empty() { String::new() } else { format!(" ({})", motions.join(", ")) };
    let (tool, work) = bodies(subject, point, &work);
    let drawing = MachineDrawing {
        header: subject.dataset.header.clone(),
        name: format!("{} = {}", machine.name, machine.definition),
        note: format!(
            "Seen askew, in true proportion, where the middle of {} is made{moment}. Grey the tool's surfaces, orange the work's.",
            surface.name
        ),
        frames,
        tool,
        work,
    };
    let shows = format!(
        "{} and {} of {}",
        counted(machine.frames.len(), "frame"),
        counted(machine.axes.len(), "axis"),
        machine.name
    );
    Ok(Drawing { picture: diagram(&drawing, options), shows })
}

/// The tool's surfaces, where it has any at one moment, and the work's, in the root frame.
fn bodies(subject: &Subject<'_, '_>, point: &flank_solver::SurfacePoint, work: &Numbers) -> (Vec<Patch>, Vec<Patch>) {
    let (mut tools, mut flanks) = (Vec::new(), Vec::new());
    for at in subject.mates() {
        let patch = &subject.dataset.patches[at];
        let points = patch.points.iter().map(|point| Point {
            position: work.point(point.position),
            normal: work.direction(point.normal),
            ..point.clone()
        });
        flanks.push(Patch { points: points.collect(), fields: Vec::new(), ..patch.clone() });
        let Ok(tool) = Tool::of_surface(subject.job, subject.solved[at].surface) else { continue };
        let on_tool = |[position, normal]: [[f64; 3]; 2]| Point {
            outcome: Outcome::Solved,
            position: work.point(position),
            normal: work.direction(normal),
            unknowns: Vec::new(),
            residual: 0.0,
            reason: String::new(),
        };
        let [rows, columns] = GRID;
        tools.push(Patch {
            name: subject.solved[at].surface.generation.tool_name.clone(),
            rows: flank_export::Axis { label: String::new(), count: rows },
            columns: flank_export::Axis { label: String::new(), count: columns },
            points: tool.grid(&point.unknowns[2..], GRID).into_iter().map(on_tool).collect(),
            unknowns: Vec::new(),
            fields: Vec::new(),
            ..patch.clone()
        });
    }
    (tools, flanks)
}

/// A pose as numbers: columns of the rotation, and the translation.
#[derive(Clone, Copy)]
struct Numbers {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Numbers {
    fn identity() -> Numbers {
        Numbers { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] }
    }

    fn of_pose<'g>(pose: Pose<'g>, bindings: &Bindings<'g>) -> Numbers {
        let entries = pose.rotation.entries().map(|entry| number(entry, bindings));
        let axes = [0, 1, 2].map(|column| [0, 1, 2].map(|row| entries[3 * row + column]));
        Numbers { axes, origin: pose.translation.0.map(|x| number(x, bindings)) }
    }

    fn direction(&self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.axes[0][k] * v[0] + self.axes[1][k] * v[1] + self.axes[2][k] * v[2])
    }

    fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let turned = self.direction(p);
        [0, 1, 2].map(|k| self.origin[k] + turned[k])
    }

    fn then(&self, next: &Numbers) -> Numbers {
        Numbers { axes: next.axes.map(|axis| self.direction(axis)), origin: self.point(next.origin) }
    }
}

/// Reads links from steps.
struct Reader<'a, 'j, 'g> {
    subject: &'a Subject<'j, 'g>,
    machine: &'j Machine<'g>,
    posture: &'a Bindings<'g>,
}

impl<'g> Reader<'_, '_, 'g> {
    /// A frame with what leads to it from where its parent is, and its pose in the root.
    fn frame(&self, frame: &Frame<'g>, start: Numbers) -> (DrawnFrame, Numbers) {
        let mut links = Vec::new();
        let mut pose = start;
        for step in &frame.steps {
            let next = pose.then(&Numbers::of_pose(self.pose(*step), self.posture));
            match *step {
                Step::Translate(by) => self.shifts(by, &pose, &mut links),
                Step::Rotate(axis, angle) => {
                    let graph = angle.graph();
                    let direction = axis.direction(graph).0.map(|x| number(x, self.posture));
                    self.turns(angle, direction, &pose, &mut links);
                }
                Step::Rigid(_) => {
                    let step = [0, 1, 2].map(|k| next.origin[k] - pose.origin[k]);
                    let direction = unit(step).unwrap_or([0.0, 0.0, 1.0]);
                    let value = units::text(Dimension::LENGTH, dot(step, step).sqrt(), 3);
                    let link = (LinkKind::Shift, "given as a matrix".to_string(), String::new(), value);
                    links.push(placed(link, pose.origin, direction, step));
                }
                Step::Mirror(axis) => {
                    let graph = self.machine_graph();
                    let across = axis.direction(graph).0.map(|x| number(x, self.posture));
                    let link =
                        (LinkKind::Mirror, "mirrored".to_string(), format!("across {}", letter(across)), String::new());
                    links.push(placed(link, pose.origin, pose.direction(across), [0.0; 3]));
                }
            }
            pose = next;
        }
        let drawn =
            DrawnFrame { name: frame.name.clone(), parent: frame.parent, origin: pose.origin, axes: pose.axes, links };
        (drawn, pose)
    }

    fn pose(&self, step: Step<'g>) -> Pose<'g> {
        Chain::new(self.machine_graph(), vec![step]).pose()
    }

    fn machine_graph(&self) -> &'g flank_expr::Graph {
        self.subject
            .job
            .parameters
            .first()
            .map(|parameter| parameter.variable.graph())
            .unwrap_or_else(|| self.machine.axes[0].variable.graph())
    }

    /// The axes that an expression follows.
    fn axes_in(&self, of: Expr<'g>) -> Vec<&Axis<'g>> {
        let used = of.graph().variables_of(&[of]);
        let is_used = |axis: &&Axis<'g>| axis.variable.as_variable().is_some_and(|variable| used.contains(&variable));
        self.machine.axes.iter().filter(is_used).collect()
    }

    /// Whether an axis follows one of the motions that make the first surface.
    fn moves(&self, axis: &Axis<'g>) -> bool {
        let law = bound(axis.law, &self.subject.job.bindings());
        let used = law.graph().variables_of(&[law]);
        let motions = &self.subject.first().surface.generation.motions;
        motions.iter().any(|motion| motion.as_variable().is_some_and(|variable| used.contains(&variable)))
    }

    /// The settings that an expression contains.
    fn settings_in(&self, of: Expr<'g>) -> Vec<&Parameter<'g>> {
        let used = of.graph().variables_of(&[of]);
        let parameters = self.subject.job.parameters.iter();
        parameters.filter(|parameter| parameter.variable.as_variable().is_some_and(|v| used.contains(&v))).collect()
    }

    /// What an expression is where its axes stand at zero: what stands still of it, with its name, if there is anything.
    fn resting(&self, of: Expr<'g>) -> (f64, Option<String>) {
        let zero = of.graph().constant(0.0);
        let resting: Vec<(Expr<'g>, Expr<'g>)> =
            self.axes_in(of).into_iter().map(|axis| (axis.variable, zero)).collect();
        let rest = bound(of, &resting);
        let (value, settings) = (number(rest, self.posture), self.settings_in(rest));
        let is_there = value.abs() > ROUNDING || !settings.is_empty();
        (value, is_there.then(|| named_after(&settings)))
    }

    /// Components one after the other: first what stands still, then what slides.
    fn shifts(&self, by: Vector3<'g>, pose: &Numbers, links: &mut Vec<MachineLink>) {
        let mut origin = pose.origin;
        for (k, component) in by.0.into_iter().enumerate() {
            let along = pose.axes[k];
            let name = ["x", "y", "z"][k];
            let mut push = |kind, of: String, (value, sign): (f64, f64), shown: String, moves: bool| {
                let step = along.map(|x| value * x);
                let minus = if sign < 0.0 { "\u{2212}" } else { "" };
                let link = (kind, of, format!("along {minus}{name}"), shown);
                links.push(MachineLink { moves, ..placed(link, origin, along.map(|x| sign * x), step) });
                origin = [0, 1, 2].map(|k| origin[k] + step[k]);
            };
            let (rest, name) = self.resting(component);
            if let Some(name) = name {
                push(LinkKind::Shift, name, (rest, 1.0), units::text(Dimension::LENGTH, rest, 3), false);
            }
            let axes = self.axes_in(component);
            let moved = number(component, self.posture) - rest;
            for (number_of, axis) in axes.iter().enumerate() {
                let at = number(axis.variable, self.posture);
                // several axes in one component share what it moves
                let share = if number_of == 0 { moved } else { 0.0 };
                let sign = number(component.derivative(axis.variable), self.posture).signum();
                push(
                    LinkKind::Linear,
                    axis.name.clone(),
                    (share, sign),
                    units::text(Dimension::LENGTH, at, 3),
                    self.moves(axis),
                );
            }
        }
    }

    fn turns(&self, angle: Expr<'g>, direction: [f64; 3], pose: &Numbers, links: &mut Vec<MachineLink>) {
        let about = format!("about {}", letter(direction));
        let (rest, name) = self.resting(angle);
        if let Some(name) = name {
            let link = (LinkKind::Turn, name, about.clone(), degrees(rest));
            links.push(placed(link, pose.origin, pose.direction(direction), [0.0; 3]));
        }
        for axis in self.axes_in(angle) {
            let slope = number(angle.derivative(axis.variable), self.posture);
            let turned = if slope < 0.0 { direction.map(|x| -x) } else { direction };
            let sign = if slope < 0.0 { format!("about {}", letter(turned)) } else { about.clone() };
            let value = degrees(number(axis.variable, self.posture));
            let link = (LinkKind::Rotary, axis.name.clone(), sign, value);
            let moves = self.moves(axis);
            links.push(MachineLink { moves, ..placed(link, pose.origin, pose.direction(turned), [0.0; 3]) });
        }
    }
}

fn placed(
    (kind, name, direction_name, value): (LinkKind, String, String, String),
    origin: [f64; 3],
    direction: [f64; 3],
    step: [f64; 3],
) -> MachineLink {
    MachineLink { kind, name, moves: false, direction_name, value, origin, direction, step }
}

/// A distance or an angle by the settings that make it, as they are named in the machine; numbers alone (teeth, starts) are no angle
/// themselves.
fn named_after(settings: &[&Parameter<'_>]) -> String {
    let names = |settings: &[&&Parameter<'_>]| {
        let own = settings.iter().map(|setting| setting.name.rsplit('.').next().unwrap_or(&setting.name));
        own.collect::<Vec<&str>>().join(", ")
    };
    let (numbers, sizes): (Vec<_>, Vec<_>) =
        settings.iter().partition(|setting| setting.dimension == Dimension::NUMBER);
    match (sizes.is_empty(), numbers.is_empty()) {
        (false, _) => names(&sizes),
        (true, false) => format!("follows from {}", names(&numbers)),
        (true, true) => String::new(),
    }
}

fn degrees(radians: f64) -> String {
    units::text(Dimension::ANGLE, radians, 3)
}

/// `x`, `-z`, or the components.
fn letter(direction: [f64; 3]) -> String {
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        if (direction[k].abs() - 1.0).abs() < 1e-9 {
            return if direction[k] < 0.0 { format!("\u{2212}{name}") } else { name.to_string() };
        }
    }
    let [x, y, z] = direction.map(|x| fixed(x, 3));
    format!("({x}, {y}, {z})")
}

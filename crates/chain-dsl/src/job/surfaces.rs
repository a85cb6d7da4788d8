//! The surfaces that tools leave, and the points of them that are asked for.

use flank_expr::Expr;
use flank_expr::geometry::{Chain, Step, Surface};

use crate::codes::Code;
use crate::context::{Context, Value, quoted};
use crate::diagnostic::Diagnostic;
use crate::limits;
use crate::machine;
use crate::model::{Bounded, GeneratedSurface, Generation, Process, ToolShape};
use crate::sample;
use crate::source::{Name, Span};
use crate::steel;
use crate::syntax::ast::{self, Expression, ExpressionKind, JobStatement};

use super::{Builder, FrameRef};

/// What a surface may be made from.
struct Available<'g> {
    shape: ToolShape<'g>,
    unknowns: Vec<Bounded<'g>>,
    frame: FrameRef,
    /// Where the side of its steel is stated, for an edge.
    named: Span,
}

/// The ways to make a surface, by the names of their functions.
const PROCESSES: [(&str, Process); 3] =
    [("envelope", Process::Envelope), ("sweep", Process::Sweep), ("move", Process::Move)];

impl<'g> Builder<'_, 'g> {
    pub(super) fn surface(&mut self, context: &mut Context<'g>, written: &ast::GeneratedSurface) {
        if !context.step(written.name.span) {
            return;
        }
        let frame = self.frame(context, &written.frame);
        let call = match &written.value.kind {
            ExpressionKind::Call(call) => call,
            ExpressionKind::Error => return,
            _ => {
                let message = "a surface is made by `envelope(tool.surface, over: motion)`, `sweep` or `move`";
                return context.report(Diagnostic::new(Code::WrongKind, written.value.span, message));
            }
        };
        let Some((_, process)) = PROCESSES.iter().find(|(name, _)| *name == call.function.node) else {
            return context.unknown(&call.function, "way to make a surface", PROCESSES.iter().map(|(name, _)| *name));
        };
        let Some((tool, motions)) = self.process_arguments(context, call) else { return };
        let (Some(frame), Some(available)) = (frame, self.available(context, tool)) else { return };
        let unknowns: Vec<Bounded<'g>> =
            available.unknowns.iter().chain(motions.iter().map(|(motion, _)| motion)).cloned().collect();
        if unknowns.len() > limits::SURFACE_UNKNOWNS.most {
            return context.report(limits::SURFACE_UNKNOWNS.exceeded(written.value.span));
        }
        let Some(path) = self.path_between(context, frame, available.frame, written.value.span) else { return };
        let t_work_tool = Chain::new(context.graph, path.iter().flat_map(|(_, steps)| steps.iter().copied()).collect());
        let driven = t_work_tool.substituted(&self.laws).merged();
        if !self.check_motions(context, &driven, &motions, written, &available) {
            return;
        }
        let over: Vec<Expr<'g>> = motions.iter().map(|(motion, _)| motion.variable).collect();
        let Some(surface) = made(context, *process, call, &available, &driven, &over, &unknowns) else { return };
        let generation = Generation {
            tool_name: tool.segments.iter().map(|segment| segment.node.as_str()).collect::<Vec<_>>().join("."),
            process: *process,
            tool: available.shape,
            path,
            t_work_tool,
            driven,
            motions: over,
        };
        self.surfaces.push((
            GeneratedSurface {
                name: written.name.node.clone(),
                doc: written.doc.clone(),
                frame: self.frame_name(frame),
                generation,
                surface,
                unknowns,
                trimmed_by: Vec::new(),
                sample: None,
            },
            frame,
        ));
    }

    /// The tool's surface and the motions of `envelope(tool.surface, over: [motion, …])`, `sweep`, `move`.
    fn process_arguments<'p>(
        &self,
        context: &mut Context<'g>,
        call: &'p ast::Call,
    ) -> Option<(&'p ast::Path, Vec<(Bounded<'g>, Span)>)> {
        let process = call.function.node.as_str();
        let mut tool = None;
        let mut motions = Vec::new();
        for argument in &call.arguments {
            match (&argument.name, &argument.value.kind) {
                (_, ExpressionKind::Error) => return None,
                (None, ExpressionKind::Path(path)) if tool.is_none() => tool = Some(path),
                (Some(name), _) if name.node == "over" => {
                    let each: Vec<&Expression> = match &argument.value.kind {
                        ExpressionKind::Vector(parts) => parts.iter().collect(),
                        _ => vec![&argument.value],
                    };
                    for written in each {
                        motions.push((self.motion(context, written)?, written.span));
                    }
                }
                (Some(name), _) => {
                    context.unknown(name, &format!("argument of `{process}`"), ["over"].into_iter());
                    return None;
                }
                (None, _) => {
                    let message = format!("`{process}` takes a surface of a tool and `over:` its motions");
                    context.report(Diagnostic::new(Code::WrongArguments, argument.value.span, message));
                    return None;
                }
            }
        }
        if tool.is_none() {
            let message = format!("`{process}` takes a surface of a tool: `{process}(c.flank, over: roll)`");
            context.report(Diagnostic::new(Code::WrongArguments, call.span, message));
        }
        tool.map(|tool| (tool, motions))
    }

    fn motion(&self, context: &mut Context<'g>, written: &Expression) -> Option<Bounded<'g>> {
        let ExpressionKind::Path(path) = &written.kind else {
            context.report(Diagnostic::new(Code::WrongKind, written.span, "`over:` takes the names of motions"));
            return None;
        };
        let [name] = path.segments.as_slice() else {
            context.report(Diagnostic::new(Code::WrongKind, written.span, "`over:` takes the names of motions"));
            return None;
        };
        let found = self.motions.iter().find(|motion| motion.name == name.node).cloned();
        if found.is_none() && !matches!(self.scope.get(&name.node), Some(Value::Poison)) {
            if self.names.contains_key(&name.node) {
                let message = format!("`{}` is not a motion", name.node);
                let help = "declare it as one: `motion name : angle in … .. …`";
                context.report(Diagnostic::new(Code::WrongKind, name.span, message).help(help));
            } else {
                context.unknown(name, "motion", self.motions.iter().map(|motion| motion.name.as_str()));
            }
        }
        found
    }

    /// A surface of a tool, or an earlier surface of the job, and the frame it is fixed to.
    fn available(&mut self, context: &mut Context<'g>, path: &ast::Path) -> Option<Available<'g>> {
        let owner = &path.segments[0];
        let mounted = self.mounts.get(&owner.node).copied();
        if let [name] = path.segments.as_slice() {
            let Some((earlier, frame)) = self.surfaces.iter().find(|(surface, _)| surface.name == name.node) else {
                if !self.names.contains_key(&name.node) || self.scope.contains_key(&name.node) {
                    let known = self.surfaces.iter().map(|(surface, _)| surface.name.as_str());
                    context.unknown(
                        name,
                        "surface",
                        known.chain(self.tools.iter().map(|(tool, _)| tool.node.as_str())),
                    );
                } else if let Some((_, built)) = self.tools.iter().find(|(tool, _)| tool.node == name.node) {
                    let surfaces: Vec<String> =
                        built.surfaces.iter().map(|surface| format!("{}.{}", name.node, surface.name)).collect();
                    let message = format!("`{}` is a tool; say which of its surfaces", name.node);
                    let list: Vec<&str> = surfaces.iter().map(String::as_str).collect();
                    let help = format!("there is: {}", quoted(&list));
                    context.report(Diagnostic::new(Code::WrongKind, name.span, message).help(help));
                }
                return None;
            };
            let frame = mounted.map_or(Some(*frame), |(frame, _)| frame)?;
            let shape = ToolShape::Surface(earlier.surface.clone());
            return Some(Available { shape, unknowns: earlier.unknowns.clone(), frame, named: path.span });
        }
        let Some((_, built)) = self.tools.iter().find(|(tool, _)| tool.node == owner.node) else {
            if !self.names.contains_key(&owner.node) {
                context.unknown(owner, "tool", self.tools.iter().map(|(tool, _)| tool.node.as_str()));
            } else if !self.is_broken_machine(owner) {
                let message = format!("`{}` is not a tool", owner.node);
                context.report(Diagnostic::new(Code::WrongKind, owner.span, message));
            }
            return None;
        };
        let member = &path.segments[1];
        let Some(surface) = built.surfaces.iter().find(|surface| surface.name == member.node) else {
            context.unknown(member, "surface", built.surfaces.iter().map(|surface| surface.name.as_str()));
            return None;
        };
        let surface = surface.surface.clone();
        let Some((frame, _)) = mounted else {
            self.not_mounted(context, owner);
            return None;
        };
        let (shape, unknowns) = surface?;
        Some(Available { shape, unknowns, frame: frame?, named: path.span })
    }

    /// Reports a tool without a frame, once for all its surfaces, unless a misspelt `mount` was meant for it.
    fn not_mounted(&mut self, context: &mut Context<'g>, tool: &Name) {
        self.mounts.insert(tool.node.clone(), (None, tool.span));
        if self.lost_mounts > 0 {
            return;
        }
        let message = format!("`{}` is not mounted on any frame", tool.node);
        let frames = self.frames_to_choose_from().unwrap_or_default();
        let help = format!("say on which frame it sits: `mount {} on …`{frames}", tool.node);
        context.report(Diagnostic::new(Code::NotMounted, tool.span, message).help(help));
    }

    /// The frames that a tool may sit on, unless they are too many to read.
    fn frames_to_choose_from(&self) -> Option<String> {
        const READABLE: usize = 12;
        let all = (0..self.machines.len()).flat_map(|m| (0..self.machines[m].2.frames.len()).map(move |k| (m, k)));
        let names: Vec<String> = all.map(|frame| self.frame_name(frame)).take(READABLE + 1).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        (1..=READABLE).contains(&names.len()).then(|| format!("; there is: {}", quoted(&names)))
    }

    fn frame_name(&self, (machine, frame): FrameRef) -> String {
        let (name, _, built) = &self.machines[machine];
        format!("{}.{}", name.node, built.frames[frame].name)
    }

    fn path_between(
        &self,
        context: &mut Context<'g>,
        from: FrameRef,
        to: FrameRef,
        span: Span,
    ) -> Option<Vec<(String, Vec<Step<'g>>)>> {
        if from.0 != to.0 {
            let message = format!(
                "`{}` and `{}` belong to two machines: nothing says how they stand to each other",
                self.frame_name(from),
                self.frame_name(to)
            );
            let help = "describe both as frames of one machine";
            context.report(Diagnostic::new(Code::UnrelatedFrames, span, message).help(help));
            return None;
        }
        let hops = machine::path(&self.machines[from.0].2.frames, from.1, to.1);
        Some(hops.into_iter().map(|(frame, steps)| (self.frame_name((from.0, frame)), steps)).collect())
    }

    /// The envelope is over exactly the motions that move the tool against the work.
    fn check_motions(
        &self,
        context: &mut Context<'g>,
        driven: &Chain<'g>,
        motions: &[(Bounded<'g>, Span)],
        written: &ast::GeneratedSurface,
        available: &Available<'g>,
    ) -> bool {
        let mut fine = true;
        for (k, (motion, span)) in motions.iter().enumerate() {
            if available.unknowns.iter().any(|unknown| unknown.variable == motion.variable) {
                let message = format!("`{}` has made the tool's own surface already", motion.name);
                let help = "declare a second motion for this envelope";
                context.report(Diagnostic::new(Code::IdleMotion, *span, message).help(help));
                fine = false;
                continue;
            }
            if motions[..k].iter().any(|(earlier, _)| earlier.variable == motion.variable) {
                let message = format!("`{}` is named twice", motion.name);
                context.report(Diagnostic::new(Code::DuplicateName, *span, message));
                fine = false;
            } else if driven.twist(motion.variable).is_zero() {
                // an axis whose law is missing or broken has been reported, and the motion was perhaps meant for it
                if self.unsettled.contains(&available.frame.0) {
                    fine = false;
                    continue;
                }
                let message =
                    format!("`{}` does not move `{}` against the work", motion.name, self.frame_name(available.frame));
                let help = "drive an axis with it, or leave it out of `over:`";
                context.report(Diagnostic::new(Code::IdleMotion, *span, message).help(help));
                fine = false;
            }
        }
        for motion in &self.motions {
            let taken = motions.iter().any(|(over, _)| over.variable == motion.variable)
                || available.unknowns.iter().any(|unknown| unknown.variable == motion.variable);
            if !taken && !driven.twist(motion.variable).is_zero() {
                let message = format!("the tool also moves with `{}`, but the envelope is not over it", motion.name);
                let help = format!("add it: `over: [{}]`", {
                    let mut names: Vec<&str> = motions.iter().map(|(over, _)| over.name.as_str()).collect();
                    names.push(&motion.name);
                    names.join(", ")
                });
                context.report(Diagnostic::new(Code::FreeMotion, written.value.span, message).help(help));
                fine = false;
            }
        }
        fine
    }

    /// A surface of the job that came out right.
    fn finished(&self, context: &mut Context<'g>, name: &Name, job: &ast::Job) -> Option<usize> {
        let index = self.surfaces.iter().position(|(surface, _)| surface.name == name.node);
        let declared = job.statements.iter().filter_map(|statement| match statement {
            JobStatement::Surface(surface) => Some(surface.name.node.as_str()),
            _ => None,
        });
        // a name that is not there has been reported
        if index.is_none() && !name.node.is_empty() && !declared.clone().any(|known| known == name.node) {
            context.unknown(name, "surface", declared);
        }
        index
    }

    pub(super) fn trim(&mut self, context: &mut Context<'g>, surface: &Name, by: &Name, job: &ast::Job) {
        let found = [surface, by].map(|name| self.finished(context, name, job));
        let [Some(index), Some(other)] = found else { return };
        let wrong = |message: String, help: &str| Diagnostic::new(Code::Trim, by.span, message).help(help);
        if index == other {
            let help = "name the surface that cuts into it: `trim flank by fillet`";
            return context.report(wrong(format!("`{}` cannot trim itself", by.node), help));
        }
        let [own, its] = [index, other].map(|k| self.surfaces[k].0.frame.clone());
        if own != its {
            let message = format!("`{}` is given in `{own}`, `{}` in `{its}`", surface.node, by.node);
            return context.report(wrong(message, "give both in the frame of the work"));
        }
        if self.surfaces[index].0.trimmed_by.contains(&other) {
            let message = format!("`{}` is trimmed by `{}` twice", surface.node, by.node);
            return context.report(wrong(message, "take one of them away"));
        }
        self.surfaces[index].0.trimmed_by.push(other);
    }

    pub(super) fn sample(&mut self, context: &mut Context<'g>, written: &ast::Sample, job: &ast::Job) {
        let Some(index) = self.finished(context, &written.surface, job) else { return };
        if self.surfaces[index].0.sample.is_some() {
            let message = format!("`{}` is sampled twice", written.surface.node);
            context.report(Diagnostic::new(Code::DuplicateName, written.surface.span, message));
            return;
        }
        let sample = sample::build(context, written, &self.surfaces[index].0, &self.scope);
        self.surfaces[index].0.sample = sample;
    }
}

/// The surface that a process makes of what is available.
fn made<'g>(
    context: &mut Context<'g>,
    process: Process,
    call: &ast::Call,
    available: &Available<'g>,
    driven: &Chain<'g>,
    over: &[Expr<'g>],
    unknowns: &[Bounded<'g>],
) -> Option<Surface<'g>> {
    let wrong = |context: &mut Context<'g>, span, message: &str, help: &str| {
        context.report(Diagnostic::new(Code::WrongKind, span, message).help(help));
        None
    };
    match (process, &available.shape) {
        (Process::Envelope, ToolShape::Surface(surface)) => Some(surface.envelope(driven, over)),
        (Process::Move, ToolShape::Surface(surface)) if over.is_empty() => Some(surface.moved(driven)),
        (Process::Move, ToolShape::Surface(_)) => {
            let help = "for what a moving tool leaves, say `envelope`";
            wrong(
                context,
                call.span,
                "`move` shows a surface from a frame that stands still to it: it takes no motion",
                help,
            )
        }
        (Process::Sweep, ToolShape::Edge(_)) if over.is_empty() => {
            wrong(context, call.span, "`sweep` takes at least one motion", "say `over: motion`")
        }
        (Process::Sweep, ToolShape::Edge(edge)) => {
            let raw = edge.raw_normal(driven, over[0]);
            let flipped = steel::is_flipped(context, [available.named; 2], unknowns, raw, edge.steel)?;
            Some(edge.sweep(driven, over, flipped))
        }
        (Process::Sweep, ToolShape::Surface(_)) => {
            let help = "for a surface, say `envelope`; an edge is a tool's surface with one parameter";
            wrong(context, available.named, "`sweep` takes a cutting edge, this is a surface", help)
        }
        (Process::Envelope | Process::Move, ToolShape::Edge(_)) => {
            wrong(context, available.named, "this is a cutting edge, not a surface", "for an edge, say `sweep`")
        }
    }
}

//! The surfaces that tools leave, and the points of them that are asked for.

use flank_expr::Expr;
use flank_expr::geometry::{Chain, Step, Surface};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::job::sample;
use crate::limits;
use crate::model::{GeneratedSurface, Generation, Parameter, Process, RangedVariable, ToolShape, path};
use crate::syntax::ast::{self, Expression, ExpressionKind};
use crate::values::context::{Context, quoted};
use crate::values::dimension::shown;
use crate::values::value::Value;

use super::available::{Available, which_piece};
use super::choices::choosing;
use super::independence::check_independence;
use super::{Builder, FrameRef, are_even, declared, sweep};

/// The ways to make a surface, by the names of their functions.
const PROCESSES: [(&str, Process); 3] =
    [("envelope", Process::Envelope), ("sweep", Process::Sweep), ("move", Process::Move)];

/// The tools' surfaces, and the motions with their places.
type ProcessArguments<'p, 'g> = (Vec<&'p ast::Path>, Vec<(RangedVariable<'g>, Span)>);

impl<'g> Builder<'_, 'g> {
    pub(super) fn surface(&mut self, context: &mut Context<'g>, written: &ast::GeneratedSurface) {
        if !context.spend(written.names.len(), written.value.span) {
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
        let Some((tools, motions)) = self.process_arguments(context, call) else { return };
        let names = (["name", "names"], written.names.iter().map(|name| name.span).collect());
        let made_from = (["surface", "surfaces"], tools.iter().map(|tool| tool.span).collect());
        let help =
            "write as many names as surfaces: `surface left, right in m.work = envelope(c.left, c.right, over: roll)`";
        let (Some(frame), true) = (frame, are_even(context, names, made_from, help)) else { return };
        for (name, tool) in written.names.iter().zip(tools) {
            for piece in self.available(context, tool).into_iter().flatten() {
                let _ = self.piece(context, (name, written), (call, *process), frame, piece, &motions);
            }
        }
    }

    /// What one piece of a tool's surface leaves; nothing if something is wrong (and reported).
    fn piece(
        &mut self,
        context: &mut Context<'g>,
        (name, written): (&Name, &ast::GeneratedSurface),
        (call, process): (&ast::Call, Process),
        frame: FrameRef,
        available: Available<'g>,
        motions: &[(RangedVariable<'g>, Span)],
    ) -> Option<()> {
        if available.unknowns.len() + motions.len() > limits::SURFACE_UNKNOWNS.most {
            context.report(limits::SURFACE_UNKNOWNS.exceeded(written.value.span));
            return None;
        }
        let path = self.path_between(context, frame, available.frame, written.value.span)?;
        if !self.has_places(context, &path, (frame, written.frame.span)) {
            return None;
        }
        let t_work_tool = Chain::new(context.graph, path.iter().flat_map(|(_, steps)| steps.iter().copied()).collect());
        let driven = t_work_tool.substituted(&self.laws).merged();
        if self.stands_still(context, (&written.frame, frame), &driven, motions, &available) {
            return None;
        }
        // what follows from a machine that is not whole is no mistake of its own
        if !self.check_motions(context, &driven, motions, written, &available) || self.unsettled.contains(&frame.0) {
            return None;
        }
        let mut motions = motions.to_vec();
        let mut flipped = false;
        if let (Process::Sweep, ToolShape::Edge(edge), false) = (process, &available.shape, motions.is_empty()) {
            let (first, turned) = sweep::side(context, &available, edge, &driven, &motions)?;
            motions[..=first].rotate_right(1);
            flipped = turned;
        }
        let unknowns: Vec<RangedVariable<'g>> =
            available.unknowns.iter().chain(motions.iter().map(|(motion, _)| motion)).cloned().collect();
        let over: Vec<Expr<'g>> = motions.iter().map(|(motion, _)| motion.variable).collect();
        let surface = made(context, process, call, &available, &driven, &over, flipped)?;
        let what = match process {
            Process::Sweep => format!("what `{}` sweeps", available.name),
            Process::Envelope | Process::Move => format!("`{}`", available.name),
        };
        if !self.check_sliding(context, &surface, &unknowns, &motions, &what) {
            return None;
        }
        let generation = Generation {
            tool_name: available.name,
            process,
            tool: available.shape,
            body: available.body,
            path,
            t_work_tool,
            driven,
            motions: over,
        };
        let surface = GeneratedSurface {
            name: available.piece.map_or_else(|| name.node.clone(), |piece| format!("{}.{piece}", name.node)),
            doc: written.doc.clone(),
            frame: self.frame_name(frame),
            generation,
            surface,
            unknowns,
            trimmed_by: Vec::new(),
            cut_by: None,
            sample_of: None,
            sample: None,
            written: name.span,
        };
        self.surfaces.push((surface, frame));
        Some(())
    }

    /// The tools' surfaces and the motions of `envelope(tool.surface, …, over: [motion, …])`, `sweep`, `move`.
    fn process_arguments<'p>(
        &self,
        context: &mut Context<'g>,
        call: &'p ast::Call,
    ) -> Option<ProcessArguments<'p, 'g>> {
        let process = call.function.node.as_str();
        let mut tools = Vec::new();
        let mut motions = Vec::new();
        for argument in &call.arguments {
            match (&argument.name, &argument.value.kind) {
                (_, ExpressionKind::Error) => return None,
                (None, ExpressionKind::Path(path)) if self.is_motion(path) => {
                    let named = format!("over: {}", path.joined());
                    let message = format!("`{}` is a motion, which a surface is made over", path.joined());
                    let wrong = Diagnostic::new(Code::WrongArguments, path.span, message);
                    let wrong = wrong.help(format!("say `{named}`"));
                    context.report(wrong.cure(format!("write `{named}`"), path.span, named));
                    return None;
                }
                (None, ExpressionKind::Path(path)) => tools.push(path),
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
        if tools.is_empty() {
            let message = format!("`{process}` takes a surface of a tool: `{process}(c.flank, over: roll)`");
            context.report(Diagnostic::new(Code::WrongArguments, call.span, message));
            return None;
        }
        Some((tools, motions))
    }

    fn is_motion(&self, path: &ast::Path) -> bool {
        matches!(path.segments.as_slice(), [name] if self.motions.iter().any(|motion| motion.name == name.node))
    }

    fn motion(&self, context: &mut Context<'g>, written: &Expression) -> Option<RangedVariable<'g>> {
        let ExpressionKind::Path(path) = &written.kind else {
            context.report(Diagnostic::new(Code::WrongKind, written.span, "`over:` takes the names of motions"));
            return None;
        };
        let [name] = path.segments.as_slice() else {
            context.report(Diagnostic::new(Code::WrongKind, written.span, "`over:` takes the names of motions"));
            return None;
        };
        let found = self.motions.iter().find(|motion| motion.name == name.node).cloned();
        if found.as_ref().is_some_and(|found| self.unknowns.contains(&found.variable)) {
            let message =
                format!("`{}` is an unknown: a contact determines it, and nothing generates by it", name.node);
            let help = format!("declare a motion: `motion {} : angle in … .. …`", name.node);
            context.report(Diagnostic::new(Code::WrongKind, name.span, message).help(help));
            return None;
        }
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

    pub(super) fn frame_name(&self, (machine, frame): FrameRef) -> String {
        let (name, _, built) = &self.machines[machine];
        format!("{}.{}", name.node, built.frames[frame].name)
    }

    pub(super) fn path_between(
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
        let hops = path(&self.machines[from.0].2.frames, from.1, to.1);
        Some(hops.into_iter().map(|(frame, steps)| (self.frame_name((from.0, frame)), steps)).collect())
    }

    /// Whether a surface is asked for over motions in a frame that the tool never leaves; reports it.
    fn stands_still(
        &self,
        context: &mut Context<'g>,
        (written, frame): (&ast::Path, FrameRef),
        driven: &Chain<'g>,
        motions: &[(RangedVariable<'g>, Span)],
        available: &Available<'g>,
    ) -> bool {
        let moves = |chain: &Chain<'g>, motion: &RangedVariable<'g>| !chain.twist(motion.variable).is_zero();
        let over = motions.iter().map(|(motion, _)| motion);
        // an axis without a law has been reported
        let is_unsettled = self.unsettled.contains(&frame.0);
        if motions.is_empty() || is_unsettled || over.chain(&self.motions).any(|motion| moves(driven, motion)) {
            return false;
        }
        let is_own = frame == available.frame;
        let others = (0..self.machines[frame.0].2.frames.len()).map(|other| (frame.0, other)).filter(|other| {
            let hops = path(&self.machines[frame.0].2.frames, other.1, available.frame.1);
            let steps = hops.into_iter().flat_map(|(_, steps)| steps).collect();
            let chain = Chain::new(context.graph, steps).substituted(&self.laws).merged();
            motions.iter().all(|(motion, _)| moves(&chain, motion))
        });
        let others: Vec<String> = others.map(|other| self.frame_name(other)).collect();
        if others.is_empty() && !is_own {
            return false;
        }
        let stands = if is_own { "is the tool's own frame" } else { "moves with the tool" };
        let message = format!("`{}` {stands}: `{}` leaves nothing in it", written.joined(), available.name);
        let mut still = Diagnostic::new(Code::IdleMotion, written.span, message);
        if others.is_empty() {
            still = still.help("name the frame of the work, and drive an axis between it and the tool by the motion");
        } else {
            let choices: Vec<&str> = others.iter().map(String::as_str).collect();
            let help = format!("name the frame of the work; the tool moves in {}", quoted(&choices));
            still = choosing(still.help(help), written.span, &choices);
        }
        context.report(still);
        true
    }

    /// The envelope is over exactly the motions that move the tool against the work.
    fn check_motions(
        &self,
        context: &mut Context<'g>,
        driven: &Chain<'g>,
        motions: &[(RangedVariable<'g>, Span)],
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
                let idle = Diagnostic::new(Code::IdleMotion, *span, message).help(help);
                context.report(idle.rewriting(Rewriting::Entry(*span)));
                fine = false;
            }
        }
        let is_free = |motion: &&RangedVariable<'g>| {
            let taken = motions.iter().any(|(over, _)| over.variable == motion.variable)
                || available.unknowns.iter().any(|unknown| unknown.variable == motion.variable);
            !taken && !driven.twist(motion.variable).is_zero()
        };
        let free: Vec<&RangedVariable<'g>> = self.motions.iter().filter(is_free).collect();
        if let Some(unknown) = free.iter().find(|free| self.unknowns.contains(&free.variable)) {
            let message = format!("the tool also moves with `{}`, an unknown that a contact determines", unknown.name);
            let help = "generate on a machine of its own, and mount the flanks on the machine of the pair";
            context.report(Diagnostic::new(Code::FreeMotion, written.value.span, message).help(help));
            return false;
        }
        let free: Vec<&str> = free.into_iter().map(|motion| motion.name.as_str()).collect();
        let is_moved = matches!(&written.value.kind, ast::ExpressionKind::Call(call) if call.function.node == "move");
        if is_moved && !free.is_empty() {
            let message = format!("the tool moves with {}, but what `move` takes stands still", quoted(&free));
            let help = format!(
                "what the tool leaves while it moves is an `envelope` over {}; or drive its axes with what stands still",
                quoted(&free)
            );
            context.report(Diagnostic::new(Code::FreeMotion, written.value.span, message).help(help));
            fine = false;
        } else if !free.is_empty() {
            let (them, all) = (if free.len() == 1 { "it" } else { "them" }, quoted(&free));
            let message = format!("the tool also moves with {all}, but the envelope is not over {them}");
            let over: Vec<&str> = motions.iter().map(|(over, _)| over.name.as_str()).chain(free).collect();
            let help = format!("add {them}: `over: [{}]`", over.join(", "));
            let free = Diagnostic::new(Code::FreeMotion, written.value.span, message).help(help);
            let free = match (motions.first(), motions.last()) {
                (Some((_, first)), Some((_, last))) => {
                    free.rewriting(Rewriting::Entries(first.to(*last), over.join(", ")))
                }
                _ => {
                    let Span { end, .. } = written.value.span;
                    let inside = Span { start: end - 1, end: end - 1, ..written.value.span };
                    let list = format!("over: [{}]", over.join(", "));
                    free.cure(format!("add `{list}`"), inside, format!(", {list}"))
                }
            };
            context.report(free);
            fine = false;
        }
        fine
    }

    pub(super) fn trim(&mut self, context: &mut Context<'g>, surface: &ast::Path, by: &ast::Path, job: &ast::Job) {
        let found = [surface, by].map(|path| self.finished(context, path, job));
        let [Some(index), Some(other)] = found else { return };
        let wrong = |message: String, help: &str| Diagnostic::new(Code::Trim, by.span, message).help(help);
        if index == other {
            let help = "name the surface that cuts into it, as in `trim flank by fillet`";
            return context.report(wrong(format!("`{}` cannot trim itself", by.joined()), help));
        }
        if let Some(message) = self.two_frames([surface, by], [index, other]) {
            return context.report(wrong(message, "give both in the frame of the work"));
        }
        if self.surfaces[index].0.trimmed_by.contains(&other) {
            let message = format!("`{}` is trimmed by `{}` twice", surface.joined(), by.joined());
            let statement = Rewriting::Without("trim", surface.span.to(by.span));
            return context.report(wrong(message, "take one of them away").rewriting(statement));
        }
        self.surfaces[index].0.trimmed_by.push(other);
    }

    /// In which frames two surfaces are given that cannot be compared: two of one machine. Frames of two machines are
    /// both the work.
    pub(super) fn two_frames(&self, paths: [&ast::Path; 2], surfaces: [usize; 2]) -> Option<String> {
        let [(one, own), (other, its)] = surfaces.map(|k| &self.surfaces[k]);
        let [named, by] = paths.map(ast::Path::joined);
        (own.0 == its.0 && own.1 != its.1)
            .then(|| format!("`{named}` is given in `{}`, `{by}` in `{}`", one.frame, other.frame))
    }

    pub(super) fn sample(&mut self, context: &mut Context<'g>, written: &ast::Sample, job: &ast::Job) {
        let Some(each) = &written.each else {
            return written.surfaces.iter().for_each(|of| self.sample_surface(context, of, written, job));
        };
        let names = written.surfaces.iter().map(|of| of.surface.span).collect();
        let values = each.values.iter().map(|value| value.span).collect();
        let help = "say what is different for each surface: `sample left, right for side in [1, -1] { … }`";
        if !are_even(context, (["surface", "surfaces"], names), (["value", "values"], values), help) {
            return;
        }
        for (of, value) in written.surfaces.iter().zip(&each.values) {
            let value = context.evaluate(value, &self.scope);
            let hidden = self.scope.insert(each.name.node.clone(), value);
            self.sample_surface(context, of, written, job);
            match hidden {
                Some(hidden) => self.scope.insert(each.name.node.clone(), hidden),
                None => self.scope.remove(&each.name.node),
            };
        }
    }

    /// Those of the job, its machines and its tools, each after those that its value depends on: these were made first.
    fn all_parameters(&self) -> Vec<&Parameter<'g>> {
        let of_machines = self.machines.iter().flat_map(|(_, _, built)| &built.parameters);
        let of_tools = self.tools.iter().flat_map(|(_, _, built)| &built.parameters);
        let mut all: Vec<&Parameter<'g>> = self.parameters.iter().chain(of_machines).chain(of_tools).collect();
        all.sort_by_key(|parameter| parameter.variable.as_variable());
        all
    }

    fn sample_surface(&mut self, context: &mut Context<'g>, of: &ast::Sampled, written: &ast::Sample, job: &ast::Job) {
        let path = &of.surface;
        if let [name] = path.segments.as_slice()
            && !self.pieces_of(&name.node).is_empty()
        {
            return self.sample_profile(context, of, name, (written, job));
        }
        let Some(index) = self.finished(context, path, job) else { return };
        if of.name.is_none() && self.surfaces[index].0.sample.is_some() {
            let message = format!("`{}` is sampled twice", self.surfaces[index].0.name);
            let help = format!("give one of the samples a name of its own: `sample {} as name {{ … }}`", path.joined());
            context.report(Diagnostic::new(Code::DuplicateName, path.span, message).help(help));
            return;
        }
        let surface = &self.surfaces[index].0;
        let sample = sample::build(context, (path, written), surface, &self.scope);
        let sample =
            sample.filter(|sample| check_independence(context, surface, sample, (path.span, &self.all_parameters())));
        match (&of.name, sample) {
            (Some(name), Some(sample)) => self.named_samples.push((name.clone(), index, sample)),
            (None, sample) => self.surfaces[index].0.sample = sample,
            (Some(_), None) => {}
        }
    }

    /// All pieces of a surface by the run along the profile that they come from: each has the values that lie on it. One with a sample of its
    /// own takes no part.
    fn sample_profile(
        &mut self,
        context: &mut Context<'g>,
        of: &ast::Sampled,
        name: &Name,
        (written, job): (&ast::Sample, &ast::Job),
    ) {
        let is_piece =
            |surface: &GeneratedSurface<'g>| surface.name.split_once('.').is_some_and(|(whole, _)| whole == name.node);
        let pieces: Vec<usize> = (0..self.surfaces.len()).filter(|k| is_piece(&self.surfaces[*k].0)).collect();
        let run = |at: usize| self.surfaces[at].0.unknowns.iter().find(|unknown| unknown.piece.is_some());
        let runs: Vec<RangedVariable<'g>> = pieces.iter().filter_map(|at| run(*at).cloned()).collect();
        let Some(along) = runs.first().map(|run| run.name.clone()).filter(|_| runs.len() == pieces.len()) else {
            let pieces = self.pieces_of(&name.node);
            return which_piece(context, name, &pieces);
        };
        // the parser has reported an entry without a key
        if written.entries.iter().any(|entry| entry.key.node.is_empty()) {
            return;
        }
        let Some(axis) = written.entries.iter().position(|entry| entry.key.node == along) else {
            let pieces = self.pieces_of(&name.node);
            let message = format!("`{}` is in pieces: {}", name.node, quoted(&pieces));
            let help = format!(
                "name one of them, as in `{}.{}`; or ask all of them for points by `{along}`, the run along the profile",
                name.node, pieces[0]
            );
            return context.report(Diagnostic::new(Code::WrongKind, name.span, message).help(help));
        };
        let ends = runs.iter().fold((f64::MAX, f64::MIN), |(low, high), run| (low.min(run.low), high.max(run.high)));
        for (at, run) in pieces.into_iter().zip(&runs) {
            let surface = &self.surfaces[at].0;
            if of.name.is_none() && job.samples(&surface.name) {
                continue;
            }
            if of.name.is_none() && surface.sample.is_some() {
                let message = format!("`{}` is sampled twice", surface.name);
                context.report(Diagnostic::new(Code::DuplicateName, name.span, message));
                continue;
            }
            let Some(sample) = sample::build(context, (&of.surface, written), surface, &self.scope) else { return };
            if let Some(beyond) = sample.beyond(axis, ends) {
                let [beyond, low, high] = [beyond, ends.0, ends.1].map(|value| shown(value, run.dimension));
                let message = format!("`{along}` is {beyond}, beyond the profile, which runs from {low} to {high}");
                let place = written.entries[axis].key.span;
                return context.report(Diagnostic::new(Code::SampleShape, place, message));
            }
            let sample = sample.within(context.graph, axis, (run.low, run.high));
            let sample = sample
                .filter(|sample| check_independence(context, surface, sample, (name.span, &self.all_parameters())));
            match (&of.name, sample) {
                (_, None) => {}
                (None, sample) => self.surfaces[at].0.sample = sample,
                (Some(own), Some(sample)) => {
                    let piece = surface.name.split_once('.').map_or("", |(_, piece)| piece);
                    let own = Name { node: format!("{}.{piece}", own.node), span: own.span };
                    self.named_samples.push((own, at, sample));
                }
            }
        }
    }

    /// A sample with a name of its own is the surface once more, trimmed and cut alike.
    pub(super) fn add_named_samples(&mut self, context: &mut Context<'g>) {
        for (name, index, sample) in std::mem::take(&mut self.named_samples) {
            let (surface, frame) = &self.surfaces[index];
            let steps: usize = surface.generation.path.iter().map(|(_, steps)| steps.len() + 1).sum();
            if !context.spend(steps, name.span) {
                return;
            }
            let again = GeneratedSurface {
                name: name.node,
                sample: Some(sample),
                sample_of: Some(index),
                written: name.span,
                ..surface.clone()
            };
            self.surfaces.push((again, *frame));
        }
    }
}

impl<'g> Builder<'_, 'g> {
    /// A surface of the job that came out right, or a piece of one.
    pub(super) fn finished(&self, context: &mut Context<'g>, path: &ast::Path, job: &ast::Job) -> Option<usize> {
        let (name, rest) = path.segments.split_first()?;
        let wanted = path.joined();
        let found = self.surfaces.iter().position(|(surface, _)| surface.name == wanted);
        if found.is_some() {
            return found;
        }
        let declared: Vec<&str> = declared(job).collect();
        let pieces = self.pieces_of(&name.node);
        match rest {
            _ if !declared.contains(&name.node.as_str()) => context.unknown(name, "surface", declared.into_iter()),
            [] if !pieces.is_empty() => which_piece(context, name, &pieces),
            // the parser has reported a missing name
            [piece, ..] if piece.node.is_empty() => {}
            [piece, ..] if self.surfaces.iter().any(|(surface, _)| surface.name == name.node) => {
                let message = format!("`{}` has no pieces", name.node);
                context.report(Diagnostic::new(Code::WrongKind, piece.span, message));
            }
            [piece, ..] if !pieces.is_empty() => context.unknown(piece, "piece", pieces.iter().copied()),
            _ => {}
        }
        None
    }
}

/// The surface that a process makes of what is available; a sweep with its normal turned round if `flipped`.
fn made<'g>(
    context: &mut Context<'g>,
    process: Process,
    call: &ast::Call,
    available: &Available<'g>,
    driven: &Chain<'g>,
    over: &[Expr<'g>],
    flipped: bool,
) -> Option<Surface<'g>> {
    let wrong = |context: &mut Context<'g>, span, message: &str, help: &str| {
        context.report(Diagnostic::new(Code::WrongKind, span, message).help(help));
        None
    };
    let other = |context: &mut Context<'g>, span, message: &str, (help, process): (&str, &str)| {
        let wrong = Diagnostic::new(Code::WrongKind, span, message).help(help);
        context.report(wrong.cure(format!("write `{process}`"), call.function.span, process));
        None
    };
    match (process, &available.shape) {
        (Process::Envelope, ToolShape::Surface(surface)) => Some(surface.envelope(driven, over)),
        (Process::Move, ToolShape::Surface(surface)) if over.is_empty() => Some(surface.moved(driven)),
        (Process::Move, ToolShape::Surface(_)) => {
            let help = "for what a moving tool leaves, say `envelope`";
            let message = "`move` shows a surface from a frame that stands still to it: it takes no motion";
            other(context, call.span, message, (help, "envelope"))
        }
        (Process::Sweep, ToolShape::Edge(_)) if over.is_empty() => {
            wrong(context, call.span, "`sweep` takes at least one motion", "say `over: motion`")
        }
        (Process::Sweep, ToolShape::Edge(edge)) => Some(edge.sweep(driven, over, flipped)),
        (Process::Sweep, ToolShape::Surface(_)) => {
            let help = "for a surface, say `envelope`; an edge is a tool's surface with one parameter";
            other(context, available.named, "`sweep` takes a cutting edge, this is a surface", (help, "envelope"))
        }
        (Process::Envelope | Process::Move, ToolShape::Edge(_)) => {
            let help = ("for an edge, say `sweep`", "sweep");
            other(context, available.named, "this is a cutting edge, not a surface", help)
        }
    }
}

//! What a surface may be made from: surfaces of tools and earlier surfaces of the job, whole or piece by piece.

use std::collections::HashMap;

use crate::definitions::tool::BuiltTool;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::model::{RangedVariable, ToolShape};
use crate::syntax::ast::{self, JobStatement};
use crate::values::context::{Context, quoted};

use super::choices::choosing;
use super::{Builder, FrameRef};

/// A smooth surface of a tool, or an earlier one of the job, and the frame it is fixed to.
pub(super) struct Available<'g> {
    /// As `c.flank`, with its piece if it is one.
    pub(super) name: String,
    /// The piece that it is of what was asked for.
    pub(super) piece: Option<String>,
    pub(super) shape: ToolShape<'g>,
    pub(super) unknowns: Vec<RangedVariable<'g>>,
    pub(super) frame: FrameRef,
    /// Where it is said of a tool's surface on which side the steel lies.
    pub(super) body: Option<Span>,
    /// Where it is asked for.
    pub(super) named: Span,
}

/// The name of what has a value, or values of its own, for the statements below it.
pub(super) fn name_of_value(statement: &JobStatement) -> Option<&Name> {
    match statement {
        JobStatement::Param(param) => Some(&param.name),
        JobStatement::Let(binding) => Some(&binding.name),
        JobStatement::Machine(instance) | JobStatement::Tool(instance) => Some(&instance.name),
        JobStatement::Motion(motion) | JobStatement::Unknown(motion) => Some(&motion.name),
        _ => None,
    }
}

/// All of them in a job, and where they stand.
pub(super) fn valued(job: &ast::Job) -> HashMap<String, Span> {
    let names = job.statements.iter().filter_map(name_of_value);
    names.map(|name| (name.node.clone(), name.span)).collect()
}

/// Whether a surface is the one with a name, or a piece of it.
pub(super) fn is_of(surface: &str, name: &str) -> bool {
    surface.split_once('.').map_or(surface, |(whole, _)| whole) == name
}

/// Reports the name of a surface that consists of pieces where one of them must be named.
pub(super) fn which_piece(context: &mut Context<'_>, name: &Name, pieces: &[&str]) {
    let message = match pieces {
        [_] => format!("`{}` consists of pieces, of one here; name it", name.node),
        _ => format!("`{}` has several pieces; say which", name.node),
    };
    let whole: Vec<String> = pieces.iter().map(|piece| format!("{}.{piece}", name.node)).collect();
    let whole: Vec<&str> = whole.iter().map(String::as_str).collect();
    let help = format!("there is: {}", quoted(&whole));
    let diagnostic = Diagnostic::new(Code::WrongKind, name.span, message).help(help);
    context.report(choosing(diagnostic, name.span, &whole));
}

impl<'g> Builder<'_, 'g> {
    /// True for a name that stands for something that could not be built (which has been reported).
    pub(super) fn is_broken_machine(&self, name: &Name) -> bool {
        !self.scope.contains_key(&name.node)
            && !self.tools.iter().any(|(tool, ..)| tool.node == name.node)
            && !self.surfaces.iter().any(|(surface, _)| is_of(&surface.name, &name.node))
    }

    /// The names of the pieces of a surface of the job; none if it is one piece.
    pub(super) fn pieces_of(&self, name: &str) -> Vec<&str> {
        let split = self.surfaces.iter().filter_map(|(surface, _)| surface.name.split_once('.'));
        split.filter(|(whole, _)| *whole == name).map(|(_, piece)| piece).collect()
    }

    /// The pieces of a surface of a tool, or of an earlier surface of the job.
    pub(super) fn available(&mut self, context: &mut Context<'g>, path: &ast::Path) -> Option<Vec<Available<'g>>> {
        let owner = &path.segments[0];
        if self.unmade.contains(&owner.node) {
            self.not_made_yet(context, owner);
            return None;
        }
        if self.surfaces.iter().any(|(surface, _)| is_of(&surface.name, &owner.node)) {
            return self.earlier(context, path);
        }
        if let Some(index) = self.tools.iter().position(|(tool, ..)| tool.node == owner.node) {
            return self.of_tool(context, path, index);
        }
        let is_known = self.names.contains_key(&owner.node);
        match path.segments.len() {
            1 if !is_known || self.scope.contains_key(&owner.node) => {
                let known = self.surfaces.iter().map(|(surface, _)| surface.name.as_str());
                let known = known.chain(self.tools.iter().map(|(tool, ..)| tool.node.as_str()));
                context.unknown(owner, "surface", known);
            }
            1 => {}
            _ if !is_known => {
                context.unknown(owner, "tool", self.tools.iter().map(|(tool, ..)| tool.node.as_str()));
            }
            _ if !self.is_broken_machine(owner) && !context.is_unmade(&owner.node) => {
                let message = format!("`{}` is not a tool", owner.node);
                context.report(Diagnostic::new(Code::WrongKind, owner.span, message));
            }
            _ => {}
        }
        None
    }

    /// Reports a surface that is made by this very statement or by a later one.
    fn not_made_yet(&self, context: &mut Context<'g>, name: &Name) {
        let message = format!("`{}` is not made yet", name.node);
        let has_one = |(_, _, tool): &&(Name, String, BuiltTool<'g>)| {
            tool.surfaces.iter().any(|surface| surface.name == name.node)
        };
        let first = self.names.get(&name.node).copied().unwrap_or(name.span);
        let diagnostic = Diagnostic::new(Code::UnknownName, name.span, message).note(first, "it is made here");
        context.report(match self.tools.iter().find(has_one) {
            Some((tool, ..)) => {
                let own = format!("{}.{}", tool.node, name.node);
                let diagnostic = diagnostic.help(format!("that of the tool is `{own}`"));
                diagnostic.cure(format!("write `{own}`"), name.span, own)
            }
            None => diagnostic.help("a surface is made from one of a tool, or from one that is made further up"),
        });
    }

    /// A surface that the job made before, with all its pieces or one of them.
    fn earlier(&self, context: &mut Context<'g>, path: &ast::Path) -> Option<Vec<Available<'g>>> {
        let (owner, wanted) = (&path.segments[0], path.joined());
        let mounted = self.mounts.get(&owner.node).copied();
        let mut found = Vec::new();
        for (surface, frame) in &self.surfaces {
            let piece = surface.name.strip_prefix(&owner.node).and_then(|rest| rest.strip_prefix('.'));
            let is_whole = path.segments.len() == 1 && is_of(&surface.name, &owner.node);
            if is_whole || surface.name == wanted {
                found.push(Available {
                    name: surface.name.clone(),
                    piece: piece.filter(|_| is_whole).map(str::to_string),
                    shape: ToolShape::Surface(surface.surface.clone()),
                    unknowns: surface.unknowns.clone(),
                    frame: mounted.map_or(Some(*frame), |(frame, _)| frame)?,
                    body: None,
                    named: path.span,
                });
            }
        }
        if found.is_empty() {
            context.unknown(&path.segments[1], "piece", self.pieces_of(&owner.node).into_iter());
            return None;
        }
        Some(found)
    }

    /// A surface of a tool: `t.side` with all its pieces, or `t.side.flank`.
    fn of_tool(&mut self, context: &mut Context<'g>, path: &ast::Path, index: usize) -> Option<Vec<Available<'g>>> {
        let (owner, built) = (&path.segments[0], &self.tools[index].2);
        let Some(member) = path.segments.get(1) else {
            let surfaces: Vec<String> =
                built.surfaces.iter().map(|surface| format!("{}.{}", owner.node, surface.name)).collect();
            let message = format!("`{}` is a tool; say which of its surfaces", owner.node);
            let list: Vec<&str> = surfaces.iter().map(String::as_str).collect();
            let help = format!("there is: {}", quoted(&list));
            let diagnostic = Diagnostic::new(Code::WrongKind, owner.span, message).help(help);
            context.report(choosing(diagnostic, owner.span, &list));
            return None;
        };
        let Some(surface) = built.surfaces.iter().find(|surface| surface.name == member.node) else {
            context.unknown(member, "surface", built.surfaces.iter().map(|surface| surface.name.as_str()));
            return None;
        };
        let mut pieces = surface.pieces.clone()?;
        let body = Some(surface.body);
        if let Some(wanted) = path.segments.get(2) {
            let names: Vec<&str> = pieces.iter().filter_map(|piece| piece.name.as_deref()).collect();
            if path.segments.len() > 3 || !names.contains(&wanted.node.as_str()) {
                context.unknown(wanted, &format!("piece of `{}.{}`", owner.node, member.node), names.into_iter());
                return None;
            }
            pieces.retain(|piece| piece.name.as_ref() == Some(&wanted.node));
        }
        let Some((frame, _)) = self.mounts.get(&owner.node).copied() else {
            self.not_mounted(context, owner);
            return None;
        };
        let frame = frame?;
        let is_single = path.segments.len() > 2;
        let made = pieces.into_iter().filter_map(|piece| {
            let (shape, unknowns) = piece.surface?;
            let of_piece = piece.name.iter().filter(|_| !is_single).map(|name| format!(".{name}"));
            Some(Available {
                name: path.joined() + &of_piece.collect::<String>(),
                piece: piece.name.filter(|_| !is_single),
                shape,
                unknowns,
                frame,
                body,
                named: path.span,
            })
        });
        Some(made.collect())
    }

    /// Reports a tool without a frame, once for all its surfaces, unless a misspelt `mount` was meant for it.
    fn not_mounted(&mut self, context: &mut Context<'g>, tool: &Name) {
        self.mounts.insert(tool.node.clone(), (None, tool.span));
        if self.lost_mounts > 0 {
            return;
        }
        let message = format!("`{}` is not mounted on any frame", tool.node);
        let frames = self.frames_to_choose_from();
        let listed: Vec<&str> = frames.iter().map(String::as_str).collect();
        let choice = if frames.is_empty() { String::new() } else { format!("; there is: {}", quoted(&listed)) };
        let help = format!("say on which frame it sits: `mount {} on …`{choice}", tool.node);
        let mut diagnostic = Diagnostic::new(Code::NotMounted, tool.span, message).help(help);
        for (frame, end) in frames.iter().filter_map(|frame| Some((frame, self.end?))) {
            let mount = format!("mount {} on {frame}", tool.node);
            diagnostic = diagnostic.cure(format!("add `{mount}`"), end, format!("    {mount}\n"));
        }
        context.report(diagnostic);
    }
}

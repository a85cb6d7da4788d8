//! A job that makes no surface, and the surfaces that it could make.

use crate::definitions::instance::settings_to_choose_from;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Name;
use crate::syntax::ast::{self, ToolStatement};
use crate::values::context::{Context, READABLE};

use super::Builder;

/// What a tool that is not there yet is called.
const NEW_TOOL: &str = "cutter";

/// A surface of a tool that a job could make something of.
struct Source {
    /// `c.flank`
    path: String,
    surface: String,
    /// Where it is mounted; nothing of one that sits nowhere yet.
    frame: Option<String>,
    /// What has to be said before: `tool c = rack`, and of one that sits nowhere `mount c`.
    first: Vec<String>,
}

impl<'g> Builder<'_, 'g> {
    /// Reports a job that makes no surface, with those that it could make of a tool over all its motions.
    pub(super) fn no_surface(&self, context: &mut Context<'g>, job: &Name) {
        let message = format!("`{}` makes no surface", job.node);
        let choices = self.surfaces_to_choose_from();
        let help = match choices.first().and_then(|lines| lines.last()) {
            Some(surface) => format!("add one, such as `{surface}`"),
            None => self.lacking(),
        };
        let mut diagnostic = Diagnostic::new(Code::NoSurface, job.span, message).help(help);
        for (lines, end) in choices.iter().filter_map(|lines| Some((lines, self.end?))) {
            let title = lines.iter().map(|line| format!("`{line}`")).collect::<Vec<_>>().join(", ");
            let text: String = lines.iter().map(|line| format!("    {line}\n")).collect();
            diagnostic = diagnostic.cure(format!("add {title}"), end, text);
        }
        context.report(diagnostic);
    }

    /// What has to be there first.
    fn lacking(&self) -> String {
        let mount = if self.mounts.is_empty() { "mount a tool, " } else { "" };
        let motion = if self.motions.is_empty() { "declare a motion, " } else { "" };
        format!("{mount}{motion}then add one: `surface … in … = envelope(…, over: …)`")
    }

    /// The lines that make each of them.
    fn surfaces_to_choose_from(&self) -> Vec<Vec<String>> {
        let motions = self.motions.iter().filter(|motion| !self.unknowns.contains(&motion.variable));
        let motions: Vec<&str> = motions.map(|motion| motion.name.as_str()).collect();
        let over = match motions[..] {
            [] => return Vec::new(),
            [motion] => motion.to_string(),
            _ => format!("[{}]", motions.join(", ")),
        };
        let frames = self.frames_to_choose_from();
        let mut found = Vec::new();
        for source in self.sources() {
            let seats = source.frame.clone().map_or_else(|| frames.clone(), |frame| vec![frame]);
            for (seat, work) in seats.iter().flat_map(|seat| frames.iter().map(move |work| (seat, work))) {
                if seat == work {
                    continue;
                }
                let mount = source.first.iter().map(|line| match line.starts_with("mount ") {
                    true => format!("{line} on {seat}"),
                    false => line.clone(),
                });
                let made = format!("surface {} in {work} = envelope({}, over: {over})", source.surface, source.path);
                found.push(mount.chain([made]).collect());
            }
        }
        found.truncate(READABLE);
        found
    }

    /// The first tool that is mounted, or else that is there, or else those that are defined.
    fn sources(&self) -> Vec<Source> {
        let of_tool = |(name, _, built): &(Name, String, super::BuiltTool<'g>)| {
            let surface = built.surfaces.first()?.name.clone();
            let frame = self.mounts.get(&name.node).and_then(|(frame, _)| *frame).map(|frame| self.frame_name(frame));
            let first = if frame.is_some() { Vec::new() } else { vec![format!("mount {}", name.node)] };
            Some(Source { path: format!("{}.{surface}", name.node), surface, frame, first })
        };
        let mut sources: Vec<Source> = self.tools.iter().filter_map(of_tool).collect();
        sources.sort_by_key(|source| source.frame.is_none());
        sources.truncate(1);
        if self.tools.is_empty() && !self.names.contains_key(NEW_TOOL) {
            let mut tools: Vec<&ast::Tool> = self.definitions.tools.values().collect();
            tools.sort_by_key(|tool| &tool.name.node);
            sources.extend(tools.into_iter().take(READABLE).filter_map(|tool| self.new_tool(tool)));
        }
        sources.retain(|source| !self.names.contains_key(&source.surface));
        sources
    }

    /// A tool of its definition, with values to start from.
    fn new_tool(&self, tool: &ast::Tool) -> Option<Source> {
        let missing = tool.statements.iter().filter_map(|statement| match statement {
            ToolStatement::Param(param) if param.default.is_none() => Some(param),
            _ => None,
        });
        let missing: Vec<&ast::Param> = missing.collect();
        let surface = tool.statements.iter().find_map(|statement| match statement {
            ToolStatement::Surface(surface) => Some(surface.names[0].node.clone()),
            _ => None,
        })?;
        let definition = &tool.name.node;
        let tool = match &settings_to_choose_from(&missing, &self.scope).first()?[..] {
            "" => format!("tool {NEW_TOOL} = {definition}"),
            settings => format!("tool {NEW_TOOL} = {definition}({settings})"),
        };
        let first = vec![tool, format!("mount {NEW_TOOL}")];
        Some(Source { path: format!("{NEW_TOOL}.{surface}"), surface, frame: None, first })
    }
}

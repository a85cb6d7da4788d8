//! What the texts define.

use std::sync::Arc;

use super::members::{Members, Names, Wanted};
use super::{NameKind, SymbolId};
use crate::diagnostics::source::{FileId, Name, Span};
use crate::syntax::ast::{
    self, ExpressionKind, Item, JobStatement, MachineStatement, Param, Profile, SurfaceParameter, ToolStatement,
    ToolSurface,
};

impl<'a> Names<'a> {
    /// Enters all definitions, so that names may be used before they are defined.
    pub(super) fn declare(&mut self, files: &'a [(FileId, Arc<ast::File>)]) {
        let items = || files.iter().flat_map(|(_, file)| &file.items);
        for item in items() {
            self.item(item);
        }
        for item in items() {
            self.extend(item);
        }
        // what machines and tools are made of is known now
        for item in items() {
            if let Item::Job(job) = item
                && let Some(id) = self.own(&job.name)
            {
                self.link(id, job);
            }
        }
        self.restate();
    }

    /// The definition that stands at a name.
    pub(super) fn own(&self, name: &Name) -> Option<SymbolId> {
        let id = self.globals.get(name.node.as_str()).copied()?;
        if self.index.symbol(id).name == name.span {
            return Some(id);
        }
        // defined twice: the second one is not known by its name
        let found = self.index.symbols.iter().position(|symbol| symbol.name == name.span && symbol.owner.is_none());
        found.map(|at| SymbolId(at as u32))
    }

    fn item(&mut self, item: &'a Item) {
        let (kind, name, extent) = match item {
            Item::Use(_) => return,
            Item::Function(function) => (NameKind::Function, &function.name, function.body.span),
            Item::Machine(machine) => (NameKind::Machine, &machine.name, machine.span),
            Item::Tool(tool) => (NameKind::Tool, &tool.name, tool_end(tool)),
            Item::Job(job) => (NameKind::Job, &job.name, job.span),
            Item::Variant(variant) => {
                let last = variant.changes.last().map_or(variant.parent.span, |change| change.value.span);
                (NameKind::Job, &variant.name, last)
            }
        };
        let id = self.define(kind, name, extent, None);
        self.globals.entry(&name.node).or_insert(id);
        let mut members = Members::default();
        match item {
            Item::Machine(machine) => self.machine_members(id, machine, &mut members),
            Item::Tool(tool) => self.tool_members(id, tool, &mut members),
            Item::Job(job) => self.job_members(id, job, &mut members),
            Item::Use(_) | Item::Function(_) | Item::Variant(_) => {}
        }
        self.members.insert(id, members);
    }

    /// Links variants with what they are made from.
    fn extend(&mut self, item: &'a Item) {
        let (own, kind, parent) = match item {
            Item::Machine(ast::Machine { name, extends: Some(parent), .. }) => (name, NameKind::Machine, parent),
            Item::Job(ast::Job { name, extends: Some(parent), .. }) => (name, NameKind::Job, parent),
            Item::Variant(variant) => (&variant.name, NameKind::Job, &variant.parent),
            _ => return,
        };
        let found = self.global(&parent.node, kind);
        let found = self.refer(parent, found, kind);
        let Some(id) = self.own(own) else { return };
        let found = found.filter(|found| *found != id);
        self.symbol_mut(id).definition = found;
        self.members.entry(id).or_default().parent = found;
    }

    fn machine_members(&mut self, id: SymbolId, machine: &'a ast::Machine, members: &mut Members<'a>) {
        let owner = Some(id);
        for statement in &machine.statements {
            match statement {
                MachineStatement::Param(param) => {
                    let found = self.param(param, owner);
                    members.names.entry(&param.name.node).or_insert(found);
                }
                MachineStatement::Let(binding) => {
                    let found = self.binding(binding, owner);
                    members.names.entry(&binding.name.node).or_insert(found);
                }
                MachineStatement::Axis(axis) => {
                    let extent = axis.range.as_ref().map_or(axis.kind_span, |range| range.span);
                    let found = self.define(NameKind::Axis, &axis.name, extent, owner);
                    self.symbol_mut(found).range = axis.range.as_ref().map(|range| range.span);
                    members.names.entry(&axis.name.node).or_insert(found);
                }
                MachineStatement::Frame(frame) | MachineStatement::Insert(frame) => {
                    let last = frame.transforms.last().map(|call| call.span);
                    let extent = last.or(frame.parent.as_ref().map(|parent| parent.span)).unwrap_or(frame.name.span);
                    let found = self.define(NameKind::Frame, &frame.name, extent, owner);
                    let first = frame.transforms.first().map(|call| call.span);
                    self.symbol_mut(found).value = first.zip(last).map(|(first, last)| first.to(last));
                    members.others.entry(&frame.name.node).or_insert(found);
                }
                MachineStatement::Nc(word) => {
                    let found = self.define(NameKind::NcWord, &word.address, word.value.span, owner);
                    self.symbol_mut(found).value = Some(word.value.span);
                }
                MachineStatement::Close(_)
                | MachineStatement::Fix(_)
                | MachineStatement::Couple(_)
                | MachineStatement::Require(_)
                | MachineStatement::Expect(_) => {}
            }
        }
    }

    pub(super) fn param(&mut self, param: &'a Param, owner: Option<SymbolId>) -> SymbolId {
        let kind = if param.is_error { NameKind::MachineError } else { NameKind::Parameter };
        let parts = [param.range.as_ref().map(|range| range.span), param.step.as_ref().map(|step| step.span)];
        let value = param.default.as_ref().map(|value| value.span);
        let extent = parts.into_iter().chain([value]).flatten().fold(param.dimension.span, Span::to);
        let found = self.define(kind, &param.name, extent, owner);
        let symbol = self.symbol_mut(found);
        symbol.dimension = Some(param.dimension.span);
        symbol.range = param.range.as_ref().map(|range| range.span);
        symbol.value = value;
        found
    }

    pub(super) fn binding(&mut self, binding: &'a ast::Let, owner: Option<SymbolId>) -> SymbolId {
        let found = self.define(NameKind::Value, &binding.name, binding.value.span, owner);
        self.symbol_mut(found).value = Some(binding.value.span);
        found
    }

    fn parameter(&mut self, kind: NameKind, parameter: &'a ast::Parameter, owner: Option<SymbolId>) -> SymbolId {
        let found = self.define(kind, &parameter.name, parameter.range.span, owner);
        let symbol = self.symbol_mut(found);
        (symbol.dimension, symbol.range) = (Some(parameter.dimension.span), Some(parameter.range.span));
        found
    }

    fn profile(&mut self, profile: &'a Profile, owner: Option<SymbolId>) -> SymbolId {
        let extent = profile.segments.last().map_or(profile.name.span, |segment| segment.value.span);
        let id = self.define(NameKind::Profile, &profile.name, extent, owner);
        let mut members = Members::default();
        for segment in &profile.segments {
            let found = self.define(NameKind::Segment, &segment.name, segment.value.span, Some(id));
            self.symbol_mut(found).value = Some(segment.value.span);
            members.names.entry(&segment.name.node).or_insert(found);
        }
        self.members.insert(id, members);
        id
    }

    fn tool_members(&mut self, id: SymbolId, tool: &'a ast::Tool, members: &mut Members<'a>) {
        let owner = Some(id);
        for statement in &tool.statements {
            let (name, found) = match statement {
                ToolStatement::Param(param) => (&param.name, self.param(param, owner)),
                ToolStatement::Let(binding) => (&binding.name, self.binding(binding, owner)),
                ToolStatement::Profile(profile) => (&profile.name, self.profile(profile, owner)),
                ToolStatement::Surface(_) | ToolStatement::Require(_) => continue,
            };
            members.names.entry(&name.node).or_insert(found);
        }
        for statement in &tool.statements {
            if let ToolStatement::Surface(surface) = statement {
                self.tool_surface(owner, surface, members);
            }
        }
    }

    /// A surface of a tool, which may have several names for its sides: the parameters belong to the first one.
    fn tool_surface(&mut self, owner: Option<SymbolId>, surface: &'a ToolSurface, tool: &mut Members<'a>) {
        let mut parameters: Vec<(&'a str, SymbolId)> = Vec::new();
        for name in &surface.names {
            let id = self.define(NameKind::ToolSurface, name, surface.body.span, owner);
            let mut members = Members::default();
            if parameters.is_empty() {
                for parameter in &surface.parameters {
                    let found = match parameter {
                        SurfaceParameter::Within(written) => {
                            self.parameter(NameKind::SurfaceParameter, written, Some(id))
                        }
                        SurfaceParameter::Along(name, profile) => {
                            let found = self.define(NameKind::SurfaceParameter, name, profile.span, Some(id));
                            self.symbol_mut(found).dimension = Some(profile.span);
                            found
                        }
                    };
                    parameters.push((&parameter.name().node, found));
                }
            }
            members.names.extend(parameters.iter().copied());
            members.along = surface.parameters.iter().find_map(|parameter| match parameter {
                SurfaceParameter::Along(_, profile) => tool.names.get(profile.node.as_str()).copied(),
                SurfaceParameter::Within(_) => None,
            });
            self.members.insert(id, members);
            tool.others.entry(&name.node).or_insert(id);
        }
    }

    fn job_members(&mut self, id: SymbolId, job: &'a ast::Job, members: &mut Members<'a>) {
        for statement in &job.statements {
            for (name, found) in self.job_names(Some(id), statement) {
                members.names.entry(name).or_insert(found);
            }
        }
    }

    fn job_names(&mut self, owner: Option<SymbolId>, statement: &'a JobStatement) -> Vec<(&'a str, SymbolId)> {
        let mut simple =
            |kind, name: &'a Name, extent| vec![(name.node.as_str(), self.define(kind, name, extent, owner))];
        match statement {
            JobStatement::Param(param) => vec![(&param.name.node, self.param(param, owner))],
            JobStatement::Let(binding) => vec![(&binding.name.node, self.binding(binding, owner))],
            JobStatement::Motion(motion) => {
                vec![(&motion.name.node, self.parameter(NameKind::Motion, motion, owner))]
            }
            JobStatement::Unknown(unknown) => {
                vec![(&unknown.name.node, self.parameter(NameKind::Unknown, unknown, owner))]
            }
            JobStatement::Profile(profile) => vec![(&profile.name.node, self.profile(profile, owner))],
            JobStatement::Machine(instance) | JobStatement::Tool(instance) => {
                let is_machine = matches!(statement, JobStatement::Machine(_));
                let kind = if is_machine { NameKind::MachineInstance } else { NameKind::ToolInstance };
                let last = instance.settings.last().map_or(instance.definition.span, |setting| setting.value.span);
                let found = self.define(kind, &instance.name, last, owner);
                self.members.insert(found, Members { settings: &instance.settings, ..Members::default() });
                vec![(&instance.name.node, found)]
            }
            JobStatement::Surface(surface) => {
                let names = surface.names.iter();
                let defined = |name: &'a Name| {
                    (name.node.as_str(), self.define(NameKind::Surface, name, surface.value.span, owner))
                };
                names.map(defined).collect()
            }
            JobStatement::Solid(solid) => simple(NameKind::Solid, &solid.name, solid.value.span),
            JobStatement::Contact(contact) => {
                let last = contact.arguments.last().map_or(contact.surfaces[1].span, |argument| argument.value.span);
                simple(NameKind::Contact, &contact.name, last)
            }
            JobStatement::Want(want) => simple(NameKind::Want, &want.name, want.value.span),
            JobStatement::Mill(mill) => simple(NameKind::Milling, &mill.name, mill.frame.span),
            JobStatement::Sample(sample) => {
                let named = sample.surfaces.iter().filter_map(|sampled| sampled.name.as_ref());
                let defined =
                    |name: &'a Name| (name.node.as_str(), self.define(NameKind::Sample, name, sample.span, owner));
                named.map(defined).collect()
            }
            JobStatement::Mount { .. }
            | JobStatement::Drive(_)
            | JobStatement::Trim { .. }
            | JobStatement::Cut { .. }
            | JobStatement::Require(_)
            | JobStatement::Expect(_) => Vec::new(),
        }
    }

    /// Links the machines, tools and surfaces of a job with what they are made from.
    fn link(&mut self, id: SymbolId, job: &'a ast::Job) {
        for statement in &job.statements {
            match statement {
                JobStatement::Machine(instance) | JobStatement::Tool(instance) => {
                    let is_machine = matches!(statement, JobStatement::Machine(_));
                    let kind = if is_machine { NameKind::Machine } else { NameKind::Tool };
                    self.link_instance(id, instance, kind);
                }
                JobStatement::Surface(surface) => self.link_surface(id, surface),
                JobStatement::Sample(sample) => {
                    for sampled in &sample.surfaces {
                        let own = sampled.name.as_ref().and_then(|name| self.inside(id, &name.node, Wanted::Value));
                        let of = sampled.surface.segments.first();
                        let of = of.and_then(|name| self.inside(id, &name.node, Wanted::Value));
                        if let (Some(own), Some(of)) = (own, of.filter(|of| Some(*of) != own)) {
                            self.members.entry(own).or_default().made_from = vec![of];
                        }
                    }
                }
                _ => {}
            }
        }
        for change in &job.changes {
            self.replace(id, change);
        }
    }

    fn link_instance(&mut self, job: SymbolId, instance: &'a ast::Instance, kind: NameKind) {
        let Some(own) = self.inside(job, &instance.name.node, Wanted::Value) else { return };
        let definition = match self.global(&instance.definition.node, kind) {
            Some(found) => Some(found),
            // the second machine of a job that is as the first
            None => {
                let other = self.inside(job, &instance.definition.node, Wanted::Value).filter(|other| *other != own);
                other.and_then(|other| self.index.symbol(other).definition)
            }
        };
        if self.index.symbol(own).name == instance.name.span {
            self.symbol_mut(own).definition = definition;
        }
    }

    /// What a variant puts in the place of a machine or tool.
    pub(super) fn replace(&mut self, job: SymbolId, change: &'a ast::Change) {
        let [name] = change.target.segments.as_slice() else { return };
        let (definition, settings) = match &change.value.kind {
            ExpressionKind::Call(call) => (call.function.node.as_str(), call.arguments.as_slice()),
            ExpressionKind::Path(path) if path.segments.len() == 1 => (path.segments[0].node.as_str(), &[][..]),
            _ => return,
        };
        let found = self.global(definition, NameKind::Machine).or_else(|| self.global(definition, NameKind::Tool));
        if let Some(found) = found {
            self.members.entry(job).or_default().replaced.push((&name.node, found, settings));
        }
    }

    fn link_surface(&mut self, job: SymbolId, surface: &'a ast::GeneratedSurface) {
        let ExpressionKind::Call(call) = &surface.value.kind else { return };
        let paths = call.arguments.iter().filter(|argument| argument.name.is_none());
        for (name, argument) in surface.names.iter().zip(paths) {
            let ExpressionKind::Path(path) = &argument.value.kind else { continue };
            let Some(own) = self.inside(job, &name.node, Wanted::Value) else { continue };
            let Some(owner) = self.inside(job, &path.segments[0].node, Wanted::Value) else { continue };
            let from = match path.segments.get(1) {
                Some(member) if self.kind(owner) == NameKind::ToolInstance => {
                    let tool = self.instance(Some(job), owner, &path.segments[0].node).0;
                    tool.and_then(|tool| self.inside(tool, &member.node, Wanted::Other))
                }
                _ => Some(owner),
            };
            let Some(from) = from.filter(|from| *from != own) else { continue };
            let along = self.members.get(&from).and_then(|members| members.along);
            let through = (self.kind(owner) == NameKind::ToolInstance).then_some(owner);
            let members = self.members.entry(own).or_default();
            members.made_from.push(from);
            if through.is_some() {
                (members.along, members.through) = (along, through);
            }
        }
    }

    /// Links what a variant states again with what its parents state.
    fn restate(&mut self) {
        let mut found = Vec::new();
        for members in self.members.values() {
            let Some(parent) = members.parent else { continue };
            let own = members.names.iter().map(|of| (of, Wanted::Value));
            for ((name, id), wanted) in own.chain(members.others.iter().map(|of| (of, Wanted::Other))) {
                let earlier = self.stated(parent, name, wanted);
                found.extend(earlier.filter(|earlier| earlier != id).map(|earlier| (*id, earlier)));
            }
        }
        for (id, earlier) in found {
            self.symbol_mut(id).restates = Some(earlier);
        }
    }

    /// What parents call by a name of the same kind.
    fn stated(&self, parent: SymbolId, name: &str, wanted: Wanted) -> Option<SymbolId> {
        let is_job = self.kind(parent) == NameKind::Job;
        let found = self.inside(parent, name, wanted)?;
        let is_other = matches!(self.kind(found), NameKind::Frame | NameKind::ToolSurface);
        (is_job || is_other == (wanted == Wanted::Other)).then_some(found)
    }
}

/// The last place in a tool.
fn tool_end(tool: &ast::Tool) -> Span {
    match tool.statements.last() {
        Some(ToolStatement::Param(param)) => param.default.as_ref().map_or(param.dimension.span, |value| value.span),
        Some(ToolStatement::Let(binding)) => binding.value.span,
        Some(ToolStatement::Profile(profile)) => {
            profile.segments.last().map_or(profile.name.span, |segment| segment.value.span)
        }
        Some(ToolStatement::Surface(surface)) => surface.body.span,
        Some(ToolStatement::Require(required)) => required.condition.span,
        None => tool.name.span,
    }
}

//! The names in machines, tools and functions.

use std::sync::Arc;

use super::expression::Place;
use super::members::{Names, Wanted};
use super::{NameKind, SymbolId, WordKind};
use crate::diagnostics::source::FileId;
use crate::syntax::ast::{
    self, Argument, Body, EachSide, Expected, Item, MachineStatement, Param, Profile, Side, SurfaceParameter,
    ToolStatement, ToolSurface,
};

impl<'a> Names<'a> {
    /// Looks all names up.
    pub(super) fn resolve(&mut self, files: &'a [(FileId, Arc<ast::File>)]) {
        for item in files.iter().flat_map(|(_, file)| &file.items) {
            let Some(id) = item.name().and_then(|name| self.own(name)) else { continue };
            match item {
                Item::Use(_) => {}
                Item::Function(function) => self.function(id, function),
                Item::Machine(machine) => {
                    machine.statements.iter().for_each(|statement| self.machine_statement(id, statement));
                }
                Item::Tool(tool) => tool.statements.iter().for_each(|statement| self.tool_statement(id, statement)),
                Item::Job(job) => self.job(id, job),
                Item::Variant(variant) => {
                    variant.changes.iter().for_each(|change| self.replace(id, change));
                    variant.changes.iter().for_each(|change| self.change(id, change));
                }
            }
        }
    }

    fn function(&mut self, id: SymbolId, function: &'a ast::Function) {
        let mut place = Place::default();
        for (name, written) in &function.arguments {
            self.dimension(&written.dimension);
            let argument = self.define(NameKind::Argument, name, written.span, Some(id));
            self.symbol_mut(argument).dimension = Some(written.span);
            place.locals.push((&name.node, argument));
        }
        if let Some(result) = &function.result {
            self.dimension(&result.dimension);
        }
        self.lets(&function.lets, Some(id), &mut place);
        self.expression(&function.body, &mut place);
        self.symbol_mut(id).value = Some(function.body.span);
    }

    /// `let`s, each known to those after it.
    fn lets(&mut self, lets: &'a [ast::Let], owner: Option<SymbolId>, place: &mut Place<'a>) {
        for binding in lets {
            self.expression(&binding.value, place);
            let id = self.binding(binding, owner);
            place.locals.push((&binding.name.node, id));
        }
    }

    pub(super) fn param_parts(&mut self, param: &'a Param, place: &mut Place<'a>) {
        self.dimension(&param.dimension);
        param.range.iter().for_each(|range| self.range(range, place));
        param.step.iter().chain(&param.default).for_each(|value| self.expression(value, place));
    }

    fn machine_statement(&mut self, id: SymbolId, statement: &'a MachineStatement) {
        let mut place = Place::of(id);
        match statement {
            MachineStatement::Param(param) => self.param_parts(param, &mut place),
            MachineStatement::Let(binding) => self.expression(&binding.value, &mut place),
            MachineStatement::Axis(axis) => axis.range.iter().for_each(|range| self.range(range, &mut place)),
            MachineStatement::Frame(frame) | MachineStatement::Insert(frame) => {
                frame.parent.iter().for_each(|parent| self.frame(parent, id));
                frame.transforms.iter().for_each(|call| self.call(call, &mut place));
            }
            MachineStatement::Close(close) => {
                [&close.first, &close.second].into_iter().for_each(|frame| self.frame(frame, id));
                close.along.iter().chain(&close.about).for_each(|axis| self.word(axis.span, WordKind::Coordinate));
                for kept in &close.keeps {
                    let found = self.inside(id, &kept.name.node, Wanted::Value);
                    self.refer(&kept.name, found, NameKind::Axis);
                    self.range(&kept.range, &mut place);
                }
            }
            MachineStatement::Fix(law) | MachineStatement::Couple(law) => {
                self.path(&law.target, &place, Wanted::Value, NameKind::Axis);
                self.expression(&law.value, &mut place);
            }
            MachineStatement::Nc(word) => {
                self.expression(&word.value, &mut place);
                word.increment.iter().for_each(|increment| self.expression(increment, &mut place));
            }
            MachineStatement::Require(required) => self.expression(&required.condition, &mut place),
            MachineStatement::Expect(expected) => match &expected.what {
                Expected::Pose { frames, transforms, at, within } => {
                    frames.iter().for_each(|frame| self.frame(frame, id));
                    transforms.iter().for_each(|call| self.call(call, &mut place));
                    self.settings(at, Some(id), &mut place);
                    within.iter().for_each(|part| self.expression(part, &mut place));
                }
                Expected::On { machine, within } => {
                    self.on(machine, &mut place);
                    self.expression(within, &mut place);
                }
                _ => {}
            },
        }
    }

    /// `definition(setting: value)` where it is no instance.
    pub(super) fn on(&mut self, machine: &'a ast::Instance, place: &mut Place<'a>) {
        let found = self.global(&machine.definition.node, NameKind::Machine);
        self.refer(&machine.definition, found, NameKind::Machine);
        self.settings(&machine.settings, found, place);
    }

    /// `name: value`, where the names are those of a machine or a tool.
    pub(super) fn settings(&mut self, settings: &'a [Argument], of: Option<SymbolId>, place: &mut Place<'a>) {
        for setting in settings {
            if let Some(name) = &setting.name {
                let found = of.and_then(|of| self.inside(of, &name.node, Wanted::Value));
                self.refer(name, found, NameKind::Parameter);
            }
            self.expression(&setting.value, place);
        }
    }

    fn tool_statement(&mut self, id: SymbolId, statement: &'a ToolStatement) {
        let mut place = Place::of(id);
        match statement {
            ToolStatement::Param(param) => self.param_parts(param, &mut place),
            ToolStatement::Let(binding) => self.expression(&binding.value, &mut place),
            ToolStatement::Require(required) => self.expression(&required.condition, &mut place),
            ToolStatement::Profile(profile) => self.profile_parts(profile, &mut place),
            ToolStatement::Surface(surface) => self.tool_surface_parts(id, surface, place),
        }
    }

    pub(super) fn profile_parts(&mut self, profile: &'a Profile, place: &mut Place<'a>) {
        profile.segments.iter().for_each(|segment| self.expression(&segment.value, place));
    }

    fn tool_surface_parts(&mut self, tool: SymbolId, surface: &'a ToolSurface, mut place: Place<'a>) {
        let Some(first) = surface.names.first() else { return };
        let own = self.inside(tool, &first.node, Wanted::Other);
        for parameter in &surface.parameters {
            match parameter {
                SurfaceParameter::Within(parameter) => {
                    self.dimension(&parameter.dimension);
                    self.range(&parameter.range, &mut place);
                }
                SurfaceParameter::Along(_, profile) => {
                    let found = self.inside(tool, &profile.node, Wanted::Value);
                    self.refer(profile, found, NameKind::Profile);
                }
            }
        }
        if let Some(each) = &surface.each {
            self.each_side(each, own, &mut place);
        }
        let names = own.and_then(|own| self.members.get(&own)).map(|members| &members.names);
        let parameters: Vec<(&'a str, SymbolId)> = names.into_iter().flatten().map(|(name, id)| (*name, *id)).collect();
        place.locals.extend(parameters);
        self.lets(&surface.lets, own, &mut place);
        self.expression(&surface.at, &mut place);
        let Body { side, .. } = &surface.body;
        if let Side::Towards(side) | Side::Where(side) = side {
            // `where` names the three parameters, which are coordinates of the tool
            place.is_at_points = true;
            self.expression(side, &mut place);
        }
    }

    /// `for side in [1, -1]`
    pub(super) fn each_side(&mut self, each: &'a EachSide, owner: Option<SymbolId>, place: &mut Place<'a>) {
        each.values.iter().for_each(|value| self.expression(value, place));
        let id = self.define(NameKind::Argument, &each.name, each.span, owner);
        self.symbol_mut(id).value = Some(each.span);
        place.locals.push((&each.name.node, id));
    }
}

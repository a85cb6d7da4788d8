//! Statements.

use pest::iterators::Pair;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};

use super::super::ast::{
    Argument, Assignment, Axis, AxisKind, Close, Contact, Drive, Expression, Frame, GeneratedSurface, Instance,
    JobStatement, Keep, KeptAxis, Let, MachineStatement, Mill, MillClearance, MillRun, NcWord, Param, Parameter, Path,
    PointRequirement, Range, Requirement, Sample, SampleEntry, SampleValues, Sampled, Solid, ToolStatement, Want,
};
use super::super::grammar::Rule;
use super::{Build, Parts};

impl Build<'_> {
    /// A statement in a machine; nothing for its closing brace and the end of a piece.
    pub(in super::super) fn machine_statement(&mut self, pair: Pair<'_, Rule>) -> Option<MachineStatement> {
        Some(match pair.as_rule() {
            Rule::param | Rule::error_term => MachineStatement::Param(self.param(pair)),
            Rule::let_statement => MachineStatement::Let(self.let_statement(pair)),
            Rule::axis | Rule::unknown_axis => MachineStatement::Axis(self.axis(pair)),
            Rule::close => MachineStatement::Close(self.close(pair)),
            Rule::frame => MachineStatement::Frame(self.frame(pair)),
            Rule::insert => MachineStatement::Insert(self.frame(pair)),
            Rule::fix => MachineStatement::Fix(self.assignment(pair)),
            Rule::couple => MachineStatement::Couple(self.assignment(pair)),
            Rule::nc_word => MachineStatement::Nc(self.nc_word(pair)),
            Rule::requirement => MachineStatement::Require(self.requirement(pair)),
            Rule::machine_expectation => MachineStatement::Expect(self.expectation(pair)),
            _ => return None,
        })
    }

    /// A statement in a tool; nothing for its closing brace and the end of a piece.
    pub(in super::super) fn tool_statement(&mut self, pair: Pair<'_, Rule>) -> Option<ToolStatement> {
        Some(match pair.as_rule() {
            Rule::param => ToolStatement::Param(self.param(pair)),
            Rule::let_statement => ToolStatement::Let(self.let_statement(pair)),
            Rule::profile => ToolStatement::Profile(self.profile(pair)),
            Rule::tool_surface => ToolStatement::Surface(self.tool_surface(pair)),
            Rule::requirement => ToolStatement::Require(self.requirement(pair)),
            _ => return None,
        })
    }

    /// A statement in a job; nothing for its closing brace and the end of a piece.
    pub(in super::super) fn job_statement(&mut self, pair: Pair<'_, Rule>) -> Option<JobStatement> {
        Some(match pair.as_rule() {
            Rule::param => JobStatement::Param(self.param(pair)),
            Rule::let_statement => JobStatement::Let(self.let_statement(pair)),
            Rule::machine_instance => JobStatement::Machine(self.instance(pair)),
            Rule::tool_instance => JobStatement::Tool(self.instance(pair)),
            Rule::mount => self.mount(pair),
            Rule::motion => JobStatement::Motion(self.motion(pair)),
            Rule::unknown => JobStatement::Unknown(self.motion(pair)),
            Rule::drive => JobStatement::Drive(self.drive(pair)),
            Rule::profile => JobStatement::Profile(self.profile(pair)),
            Rule::solid => JobStatement::Solid(self.solid(pair)),
            Rule::contact => JobStatement::Contact(self.contact(pair)),
            Rule::want => JobStatement::Want(self.want(pair)),
            Rule::mill => JobStatement::Mill(self.mill(pair)),
            Rule::surface => JobStatement::Surface(self.generated_surface(pair)),
            Rule::trim => {
                let [surface, by] = self.two_surfaces(pair);
                JobStatement::Trim { surface, by }
            }
            Rule::cut => {
                let [surface, by] = self.two_surfaces(pair);
                JobStatement::Cut { surface, by }
            }
            Rule::sample => JobStatement::Sample(self.sample(pair)),
            Rule::requirement => JobStatement::Require(self.requirement(pair)),
            Rule::expectation => JobStatement::Expect(self.expectation(pair)),
            _ => return None,
        })
    }

    fn param(&mut self, pair: Pair<'_, Rule>) -> Param {
        let doc = self.doc(&pair);
        let is_error = pair.as_rule() == Rule::error_term;
        let mut parts = Parts::of(pair);
        Param {
            doc,
            name: self.name(parts.required(Rule::name)),
            dimension: self.dimension(parts.required(Rule::dimension)),
            range: parts.optional(Rule::range).map(|range| self.range(range)),
            step: parts.optional(Rule::step).map(|step| self.expression(Parts::of(step).required(Rule::expression))),
            default: parts.optional(Rule::expression).map(|value| self.expression(value)),
            is_error,
        }
    }

    pub(super) fn let_statement(&mut self, pair: Pair<'_, Rule>) -> Let {
        let mut parts = Parts::of(pair);
        Let { name: self.name(parts.required(Rule::name)), value: self.expression(parts.required(Rule::expression)) }
    }

    fn requirement(&mut self, pair: Pair<'_, Rule>) -> Requirement {
        let mut parts = Parts::of(pair);
        let condition = self.expression(parts.required(Rule::expression));
        Requirement { condition, message: self.text(parts.required(Rule::string)).node }
    }

    fn close(&mut self, pair: Pair<'_, Rule>) -> Close {
        let mut parts = Parts::of(pair);
        let (first, second) = (self.name(parts.required(Rule::name)), self.name(parts.required(Rule::name)));
        let mut listed = |rule: Rule| -> Vec<Name> {
            let list = parts.optional(rule).map(Parts::of);
            let names = list.map_or_else(Vec::new, |mut list| list.all(Rule::name));
            names.into_iter().map(|name| self.name(name)).collect()
        };
        let (along, about) = (listed(Rule::closed_along), listed(Rule::closed_about));
        let keeps = parts.all(Rule::kept_axis).into_iter().map(|pair| {
            let mut parts = Parts::of(pair);
            KeptAxis { name: self.name(parts.required(Rule::name)), range: self.range(parts.required(Rule::range)) }
        });
        Close { first, second, along, about, keeps: keeps.collect() }
    }

    fn axis(&mut self, pair: Pair<'_, Rule>) -> Axis {
        let doc = self.doc(&pair);
        let is_unknown = pair.as_rule() == Rule::unknown_axis;
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        let kind = parts.required(Rule::axis_kind);
        let kind_span = self.span(&kind);
        let kind = match kind.as_str() {
            "rotary" => AxisKind::Rotary,
            _ => AxisKind::Linear,
        };
        let range = parts.optional(Rule::range).map(|range| self.range(range));
        Axis { doc, name, kind, kind_span, range, is_unknown }
    }

    fn nc_word(&mut self, pair: Pair<'_, Rule>) -> NcWord {
        let mut parts = Parts::of(pair);
        NcWord {
            address: self.name(parts.required(Rule::name)),
            value: self.expression(parts.required(Rule::expression)),
            increment: parts.optional(Rule::expression).map(|increment| self.expression(increment)),
        }
    }

    fn frame(&mut self, pair: Pair<'_, Rule>) -> Frame {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        Frame {
            doc,
            name: self.name(parts.required(Rule::name)),
            parent: parts.optional(Rule::name).map(|name| self.name(name)),
            transforms: parts.all(Rule::call).into_iter().map(|call| self.call(call)).collect(),
        }
    }

    fn assignment(&mut self, pair: Pair<'_, Rule>) -> Assignment {
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        let target = Path { span: name.span, segments: vec![name] };
        Assignment { target, value: self.expression(parts.required(Rule::expression)) }
    }

    fn solid(&mut self, pair: Pair<'_, Rule>) -> Solid {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        Solid {
            doc,
            name: self.name(parts.required(Rule::name)),
            frame: self.path(parts.required(Rule::path)),
            value: self.expression(parts.required(Rule::expression)),
        }
    }

    fn contact(&mut self, pair: Pair<'_, Rule>) -> Contact {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        Contact {
            doc,
            name: self.name(parts.required(Rule::name)),
            surfaces: [self.path(parts.required(Rule::path)), self.path(parts.required(Rule::path))],
            arguments: parts.all(Rule::setting).into_iter().map(|setting| self.setting(setting)).collect(),
        }
    }

    fn want(&mut self, pair: Pair<'_, Rule>) -> Want {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        Want {
            doc,
            name: self.name(parts.required(Rule::name)),
            contact: self.path(parts.required(Rule::path)),
            value: self.expression(parts.required(Rule::expression)),
        }
    }

    fn mill(&mut self, pair: Pair<'_, Rule>) -> Mill {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        let mut mill = Mill {
            doc,
            name: self.name(parts.required(Rule::name)),
            surface: self.path(parts.required(Rule::path)),
            cutter: self.path(parts.required(Rule::path)),
            frame: self.path(parts.required(Rule::path)),
            passes: Vec::new(),
            sides: Vec::new(),
            along: Vec::new(),
            attitudes: Vec::new(),
            both_ways: Vec::new(),
            clearances: Vec::new(),
            broken: false,
        };
        let said =
            [Rule::passes, Rule::side_pass, Rule::along_passes, Rule::attitude, Rule::both_ways, Rule::clearance];
        while let Some(pair) = said.into_iter().find_map(|rule| parts.optional(rule)) {
            match pair.as_rule() {
                Rule::passes => mill.passes.push(self.mill_run(pair)),
                Rule::side_pass => mill.sides.push(self.mill_run(pair)),
                Rule::along_passes => mill.along.push(self.mill_run(pair)),
                Rule::attitude => {
                    let mut parts = Parts::of(pair);
                    let word = self.name(parts.required(Rule::attitude_word));
                    mill.attitudes.push((word, self.expression(parts.required(Rule::expression))));
                }
                Rule::both_ways => mill.both_ways.push(self.span(&pair)),
                _ => mill.clearances.push(self.mill_clearance(pair)),
            }
        }
        mill
    }

    fn mill_run(&mut self, pair: Pair<'_, Rule>) -> MillRun {
        let mut parts = Parts::of(pair);
        let (key, definition) = self.coordinate(&mut parts);
        let range = self.range(parts.required(Rule::range));
        let mut parts = Parts::of(parts.required(Rule::spacing));
        let word = self.name(parts.required(Rule::spacing_word));
        MillRun { key, definition, range, word, value: self.expression(parts.required(Rule::expression)) }
    }

    fn mill_clearance(&mut self, pair: Pair<'_, Rule>) -> MillClearance {
        let mut parts = Parts::of(pair);
        MillClearance {
            surface: self.path(parts.required(Rule::path)),
            distance: self.expression(parts.required(Rule::expression)),
            body: self.path(parts.required(Rule::path)),
        }
    }

    fn drive(&mut self, pair: Pair<'_, Rule>) -> Drive {
        let mut parts = Parts::of(pair);
        Drive {
            targets: parts.all(Rule::path).into_iter().map(|path| self.path(path)).collect(),
            values: parts.all(Rule::expression).into_iter().map(|value| self.expression(value)).collect(),
        }
    }

    fn instance(&mut self, pair: Pair<'_, Rule>) -> Instance {
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        let (definition, settings) = self.definition(parts.required(Rule::definition));
        Instance { name, definition, settings }
    }

    /// A definition, and the settings that it is given.
    pub(super) fn definition(&mut self, pair: Pair<'_, Rule>) -> (Name, Vec<Argument>) {
        let mut parts = Parts::of(pair);
        let definition = self.name(parts.required(Rule::name));
        let settings = parts.optional(Rule::settings).map_or_else(Vec::new, |settings| self.settings(settings));
        (definition, settings)
    }

    pub(super) fn settings(&mut self, pair: Pair<'_, Rule>) -> Vec<Argument> {
        Parts::of(pair).all(Rule::setting).into_iter().map(|setting| self.setting(setting)).collect()
    }

    fn setting(&mut self, pair: Pair<'_, Rule>) -> Argument {
        let mut parts = Parts::of(pair);
        let name = Some(self.name(parts.required(Rule::name)));
        Argument { name, value: self.expression(parts.required(Rule::expression)) }
    }

    fn mount(&mut self, pair: Pair<'_, Rule>) -> JobStatement {
        let mut parts = Parts::of(pair);
        JobStatement::Mount {
            names: parts.all(Rule::name).into_iter().map(|name| self.name(name)).collect(),
            frame: self.path(parts.required(Rule::path)),
        }
    }

    /// The surfaces on both sides of a `by`.
    fn two_surfaces(&mut self, pair: Pair<'_, Rule>) -> [Path; 2] {
        let mut parts = Parts::of(pair);
        [self.path(parts.required(Rule::path)), self.path(parts.required(Rule::path))]
    }

    fn motion(&mut self, pair: Pair<'_, Rule>) -> Parameter {
        let doc = self.doc(&pair);
        Parameter { doc, ..self.parameter(Parts::of(pair).required(Rule::parameter)) }
    }

    pub(super) fn parameter(&mut self, pair: Pair<'_, Rule>) -> Parameter {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        Parameter {
            doc,
            name: self.name(parts.required(Rule::name)),
            dimension: self.dimension(parts.required(Rule::dimension)),
            range: self.range(parts.required(Rule::range)),
        }
    }

    fn generated_surface(&mut self, pair: Pair<'_, Rule>) -> GeneratedSurface {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        GeneratedSurface {
            doc,
            names: parts.all(Rule::name).into_iter().map(|name| self.name(name)).collect(),
            frame: self.path(parts.required(Rule::path)),
            value: self.expression(parts.required(Rule::expression)),
        }
    }

    fn sample(&mut self, pair: Pair<'_, Rule>) -> Sample {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let surfaces = parts.all(Rule::sampled).into_iter().map(|pair| self.sampled(pair)).collect();
        let each = parts.optional(Rule::each_side).map(|each| self.each_side(each));
        let (mut entries, mut keeps, mut limits) = (Vec::new(), Vec::new(), Vec::new());
        let mut end = None;
        let asked = [Rule::entry, Rule::keep, Rule::limit];
        while let Some(pair) = asked.into_iter().find_map(|rule| parts.optional(rule)) {
            let place = self.span(&pair);
            self.separated(end, place);
            end = Some(place.end);
            match pair.as_rule() {
                Rule::keep => keeps.push(self.keep(&mut Parts::of(pair))),
                Rule::limit => limits.push(self.limit(pair)),
                _ => entries.push(self.entry(pair)),
            }
        }
        Sample { surfaces, each, entries, keeps, limits, span }
    }

    fn sampled(&mut self, pair: Pair<'_, Rule>) -> Sampled {
        let mut parts = Parts::of(pair);
        let surface = self.path(parts.required(Rule::path));
        Sampled { surface, name: parts.optional(Rule::name).map(|name| self.name(name)) }
    }

    /// Asks for a comma or a new line between two entries of a sample.
    fn separated(&mut self, end: Option<u32>, next: Span) {
        let Some(end) = end else { return };
        if !self.scan.text[end as usize..next.start as usize].contains([',', '\n', '\r']) {
            let word = self.scan.token_at(next.start as usize);
            let place = self.scan.place(word);
            let message = format!("expected `,` or a new line before {}", self.scan.quote(word));
            self.diagnostics.push(Diagnostic::new(Code::Syntax, place, message));
        }
    }

    fn keep(&mut self, parts: &mut Parts<'_>) -> Keep {
        let (key, definition) = self.coordinate(parts);
        Keep { key, definition, range: self.range(parts.required(Rule::range)) }
    }

    fn limit(&mut self, pair: Pair<'_, Rule>) -> PointRequirement {
        let mut parts = Parts::of(pair);
        let within = self.keep(&mut parts);
        PointRequirement { within, message: self.text(parts.required(Rule::string)).node }
    }

    /// The name of a coordinate, and what it is if that is said.
    fn coordinate(&mut self, parts: &mut Parts<'_>) -> (Name, Option<Expression>) {
        let key = self.name(parts.required(Rule::name));
        let definition = parts.optional(Rule::coordinate);
        (key, definition.map(|pair| self.expression(Parts::of(pair).required(Rule::expression))))
    }

    fn entry(&mut self, pair: Pair<'_, Rule>) -> SampleEntry {
        let mut parts = Parts::of(pair);
        let (key, definition) = self.coordinate(&mut parts);
        let low = self.expression(parts.required(Rule::expression));
        let values = match parts.optional(Rule::expression) {
            None => SampleValues::Value(low),
            Some(high) => {
                let high = self.expression(high);
                let span = low.span.to(high.span);
                SampleValues::Range(Range { low, high, span }, self.expression(parts.required(Rule::expression)))
            }
        };
        SampleEntry { key, definition, values }
    }
}

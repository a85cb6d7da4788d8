//! The names in jobs.

use super::expression::{At, OUTLINE, Place, is_of_points};
use super::members::{Names, Wanted};
use super::{NameKind, SymbolId, Target, WordKind};
use crate::diagnostics::source::Name;
use crate::syntax::ast::{
    Change, Expected, Expression, ExpressionKind, Instance, Job, JobStatement, Mill, MillRun, Path, Sample,
    SampleValues,
};

impl<'a> Names<'a> {
    pub(super) fn job(&mut self, id: SymbolId, job: &'a Job) {
        self.coordinates.clear();
        job.changes.iter().for_each(|change| self.change(id, change));
        // expectations and milling passes may name what a sample defines
        let is_sample = |statement: &&JobStatement| matches!(statement, JobStatement::Sample(_));
        for statement in job.statements.iter().filter(is_sample) {
            self.job_statement(id, statement);
        }
        for statement in job.statements.iter().filter(|statement| !is_sample(statement)) {
            self.job_statement(id, statement);
        }
    }

    /// `ratio: value`, `m.swivel: value`, `c: definition(setting: value)` of a job that is made from another one.
    pub(super) fn change(&mut self, id: SymbolId, change: &'a Change) {
        let parent = self.index.symbol(id).definition;
        let place = parent.map_or(Place::default(), Place::of);
        let target = self.path(&change.target, &place, Wanted::Value, NameKind::Parameter);
        let kind = target.map(|target| self.kind(target));
        let kind = match kind {
            Some(NameKind::MachineInstance) => NameKind::Machine,
            Some(NameKind::ToolInstance) => NameKind::Tool,
            // values are those of the job that the parent is
            _ => return self.expression(&change.value, &mut place.clone()),
        };
        let (name, settings) = match &change.value.kind {
            ExpressionKind::Call(call) => (&call.function, call.arguments.as_slice()),
            ExpressionKind::Path(path) if path.segments.len() == 1 => (&path.segments[0], &[][..]),
            _ => return,
        };
        let definition = self.global(&name.node, kind);
        self.refer(name, definition, kind);
        self.settings(settings, definition, &mut place.clone());
    }

    fn job_statement(&mut self, id: SymbolId, statement: &'a JobStatement) {
        let place = &mut Place::of(id);
        match statement {
            JobStatement::Param(param) => self.param_parts(param, place),
            JobStatement::Let(binding) => self.expression(&binding.value, place),
            JobStatement::Machine(instance) => self.instance_parts(instance, NameKind::Machine, place),
            JobStatement::Tool(instance) => self.instance_parts(instance, NameKind::Tool, place),
            JobStatement::Mount { names, frame } => {
                for name in names {
                    let found = self.inside(id, &name.node, Wanted::Value);
                    self.refer(name, found, NameKind::ToolInstance);
                }
                self.path(frame, place, Wanted::Other, NameKind::Frame);
            }
            JobStatement::Motion(parameter) | JobStatement::Unknown(parameter) => {
                self.dimension(&parameter.dimension);
                self.range(&parameter.range, place);
            }
            JobStatement::Drive(drive) => {
                for target in &drive.targets {
                    self.path(target, place, Wanted::Value, NameKind::Axis);
                }
                drive.values.iter().for_each(|value| self.expression(value, place));
            }
            JobStatement::Surface(surface) => {
                self.path(&surface.frame, place, Wanted::Other, NameKind::Frame);
                self.surfaces(&surface.value, place);
            }
            JobStatement::Trim { surface, by } | JobStatement::Cut { surface, by } => {
                [surface, by].into_iter().for_each(|path| {
                    self.surface(path, place);
                });
            }
            JobStatement::Profile(profile) => {
                place.is_at_points = true;
                self.profile_parts(profile, place);
            }
            JobStatement::Solid(solid) => {
                self.path(&solid.frame, place, Wanted::Other, NameKind::Frame);
                self.surfaces(&solid.value, place);
            }
            JobStatement::Contact(contact) => {
                contact.surfaces.iter().for_each(|path| {
                    self.surface(path, place);
                });
                for argument in &contact.arguments {
                    argument.name.iter().for_each(|name| self.word(name.span, WordKind::Argument));
                    self.expression(&argument.value, place);
                }
            }
            JobStatement::Want(want) => {
                self.path(&want.contact, place, Wanted::Value, NameKind::Contact);
                self.expression(&want.value, place);
            }
            JobStatement::Mill(mill) => self.mill(mill, place),
            JobStatement::Sample(sample) => self.sample(id, sample, place),
            JobStatement::Require(required) => self.expression(&required.condition, place),
            JobStatement::Expect(expected) => self.expected(&expected.what, place),
        }
    }

    fn instance_parts(&mut self, instance: &'a Instance, kind: NameKind, place: &mut Place<'a>) {
        let own = place.item.and_then(|job| self.inside(job, &instance.name.node, Wanted::Value));
        let found = self.global(&instance.definition.node, kind);
        let other = |names: &Self| {
            let job = place.item?;
            names.inside(job, &instance.definition.node, Wanted::Value).filter(|other| Some(*other) != own)
        };
        let found = found.or_else(|| other(self));
        self.refer(&instance.definition, found, kind);
        let definition = own.and_then(|own| self.index.symbol(own).definition);
        self.settings(&instance.settings, definition, place);
    }

    fn surface(&mut self, path: &'a Path, place: &Place<'a>) -> Option<SymbolId> {
        self.path(path, place, Wanted::Other, NameKind::Surface)
    }

    /// `envelope(c.flank, over: roll)`, `turned(blank, spaces: 19, of: [left, right])`
    fn surfaces(&mut self, value: &'a Expression, place: &mut Place<'a>) {
        let ExpressionKind::Call(call) = &value.kind else { return self.expression(value, place) };
        self.word(call.function.span, WordKind::Function);
        for argument in &call.arguments {
            argument.name.iter().for_each(|name| self.word(name.span, WordKind::Argument));
            let is_parameter = argument.name.as_ref().is_some_and(|name| name.node == "each");
            match &argument.value.kind {
                ExpressionKind::Path(path) if !is_parameter => {
                    self.surface(path, place);
                }
                _ => self.expression(&argument.value, place),
            }
        }
    }

    fn sample(&mut self, id: SymbolId, sample: &'a Sample, place: &mut Place<'a>) {
        for sampled in &sample.surfaces {
            let found = self.path(&sampled.surface, place, Wanted::Other, NameKind::Surface);
            // a piece is one of the surface before the dot
            let first = sampled.surface.segments.first();
            let whole = first.and_then(|first| self.inside(id, &first.node, Wanted::Value));
            place.surfaces.extend(whole.or(found));
        }
        if let Some(each) = &sample.each {
            self.each_side(each, Some(id), place);
        }
        place.is_at_points = true;
        for entry in &sample.entries {
            self.coordinate(id, &entry.key, entry.definition.as_ref(), place);
            match &entry.values {
                SampleValues::Value(value) => self.expression(value, place),
                SampleValues::Range(range, by) => {
                    self.range(range, place);
                    self.expression(by, place);
                }
            }
        }
        for keep in sample.keeps.iter().chain(sample.limits.iter().map(|limit| &limit.within)) {
            self.coordinate(id, &keep.key, keep.definition.as_ref(), place);
            self.range(&keep.range, place);
        }
    }

    /// A coordinate that points are asked for by, perhaps defined here.
    fn coordinate(&mut self, job: SymbolId, key: &'a Name, definition: Option<&'a Expression>, place: &mut Place<'a>) {
        let Some(definition) = definition else {
            let found = self.value(&key.node, &Place { evaluated: At::Points, ..place.clone() });
            let is_coordinate = matches!(found, Target::Symbol(id) if is_of_points(self.kind(id)));
            // what asks for an outline is no value of the same name
            let is_word = !is_coordinate && OUTLINE.contains(&key.node.as_str());
            return self.enter(key.span, if is_word { Target::Word(WordKind::Coordinate) } else { found }, false);
        };
        self.expression(definition, &mut Place { evaluated: At::Points, ..place.clone() });
        let id = self.define(NameKind::Coordinate, key, definition.span, Some(job));
        self.symbol_mut(id).value = Some(definition.span);
        self.coordinates.push((&key.node, id));
    }

    fn mill(&mut self, mill: &'a Mill, place: &mut Place<'a>) {
        let Some(job) = place.item else { return };
        let surface = self.surface(&mill.surface, place);
        self.surface(&mill.cutter, place);
        self.path(&mill.frame, place, Wanted::Other, NameKind::Frame);
        place.surfaces.extend(surface);
        place.is_at_points = true;
        for MillRun { key, definition, range, word: _, value } in
            mill.passes.iter().chain(&mill.sides).chain(&mill.along)
        {
            self.coordinate(job, key, definition.as_ref(), place);
            self.range(range, place);
            self.expression(value, place);
        }
        mill.attitudes.iter().for_each(|(_, value)| self.expression(value, place));
        for clear in &mill.clearances {
            [&clear.surface, &clear.body].into_iter().for_each(|path| {
                self.surface(path, place);
            });
            self.expression(&clear.distance, place);
        }
    }

    fn expected(&mut self, expected: &'a Expected, place: &mut Place<'a>) {
        place.is_at_points = true;
        match expected {
            Expected::Error(code) => self.word(code.span, WordKind::ErrorCode),
            Expected::Nothing | Expected::Travel => {}
            Expected::On { machine, within } => {
                self.on(machine, place);
                self.expression(within, place);
            }
            Expected::Status { surface, status, at } => {
                if surface.joined() == "all" && self.value("all", place) == Target::Missing(NameKind::Value) {
                    self.word(surface.span, WordKind::Argument);
                } else {
                    self.surface(surface, place);
                }
                self.word(status.span, WordKind::Status);
                at.iter().for_each(|at| self.expression(at, place));
            }
            Expected::Near { surface, value, target, within } => {
                self.expected_of(surface.as_ref(), (&[value, target], &[within]), place);
            }
            Expected::InRange { surface, value, range } => {
                self.expected_of(surface.as_ref(), (&[value], &[&range.low, &range.high]), place);
            }
            // of machines only
            Expected::Pose { .. } => {}
        }
    }

    /// Values at the points of a surface, or of surfaces that the values name themselves.
    fn expected_of(
        &mut self,
        surface: Option<&'a Path>,
        (at_points, once): (&[&'a Expression], &[&'a Expression]),
        place: &mut Place<'a>,
    ) {
        let named =
            |names: &Self, path: &Path, place: &Place<'a>| match names.value(&path.segments.first()?.node, place) {
                Target::Symbol(id) if [NameKind::Surface, NameKind::Sample].contains(&names.kind(id)) => Some(id),
                _ => None,
            };
        if let Some(path) = surface {
            self.surface(path, place);
            place.surfaces.extend(named(self, path, place));
        }
        for value in at_points.iter().chain(once) {
            value.each(&mut |part| {
                if let ExpressionKind::Path(path) = &part.kind {
                    let found = named(self, path, place);
                    place.surfaces.extend(found);
                }
            });
        }
        // `flank near [x, 0 mm, z]` names the surface as a value
        let is_named = |value: &&Expression| matches!(&value.kind, ExpressionKind::Path(path) if named(self, path, place).is_some());
        let is_of_surface = surface.is_some() || at_points.first().is_some_and(is_named);
        let evaluated = if is_of_surface { At::SolvedPoints } else { At::Once };
        let values = at_points.iter().map(|value| (value, evaluated)).chain(once.iter().map(|value| (value, At::Once)));
        for (value, evaluated) in values {
            place.evaluated = evaluated;
            // a surface, or a value
            match &value.kind {
                ExpressionKind::Path(path) => {
                    self.surface(path, place);
                }
                _ => self.expression(value, place),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;

    use super::super::Target;
    use crate::compile_text;

    fn leads_to(text: &str, name: &str) -> Vec<String> {
        let graph = Graph::new();
        let compilation = compile_text(&graph, "test.chain", text, &[]);
        let (index, sources) = (&compilation.index, &compilation.sources);
        let named = index.entries.iter().filter(|entry| sources.text(entry.span) == name && !entry.is_definition);
        let line = |entry: &super::super::Entry| match entry.target {
            Target::Symbol(id) => sources.place(index.symbol(id).name).1.to_string(),
            other => format!("{other:?}"),
        };
        named.map(line).collect()
    }

    #[test]
    fn a_name_of_a_frame_and_an_axis_leads_to_what_its_place_wants() {
        let text = "machine m {
            axis slide : linear
            frame bed
            frame slide in bed = translate_x(slide)
            frame tip in slide = translate_y(1 mm)
        }";
        assert_eq!(leads_to(text, "slide"), ["2", "4"]);
    }

    #[test]
    fn names_of_a_wrong_text_are_found() {
        let text = "machine m {
            param depth : length = 2 mm
            frame bed
            frame slide in bed = translate_x(depth
            frame tip in slide = translate_y(depth)
        }";
        assert!(leads_to(text, "depth").contains(&"2".to_string()));
    }

    #[test]
    fn a_variant_leads_to_the_statement_that_counts() {
        let text = "machine parent {
            param depth : length = 2 mm
            frame bed
        }
        machine child extends parent {
            param depth : length = 3 mm
            frame slide in bed = translate_x(depth)
        }";
        assert_eq!(leads_to(text, "depth"), ["6"]);
        assert_eq!(leads_to(text, "bed"), ["3"]);
    }

    #[test]
    fn a_corner_is_no_value_of_the_same_name() {
        let text = "job j {
            let toe_root = [1 mm, 2 mm]
            let lengthwise = 3
            sample flank { toe_root: toe_root, lengthwise: 0.1 .. lengthwise by 9 }
        }";
        assert_eq!(leads_to(text, "toe_root"), ["Word(Coordinate)", "2"]);
        assert_eq!(leads_to(text, "lengthwise"), ["Word(Coordinate)", "3"]);
    }

    #[test]
    fn a_column_of_a_table_leads_to_the_coordinate_of_its_name() {
        let text = "job j {
            motion roll : angle in 0 deg .. 9 deg
            let x = 3 mm
            surface flank in m.work = envelope(c.face, over: roll)
            expect flank near table(\"a.csv\", roll, x, y) within 1 um
            let f = curve(\"b.csv\", roll: angle, x: length)
        }";
        assert_eq!(leads_to(text, "roll"), ["2", "2", "2"]);
        assert_eq!(leads_to(text, "x"), ["Word(Column)", "Word(Column)"]);
    }
}

//! Warnings about what a file declares and nobody uses.

use std::collections::HashSet;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::syntax::ast::{
    self, Call, Expected, Expression, ExpressionKind, File, Item, JobStatement, MachineStatement, Param, Side,
    SurfaceParameter, ToolStatement,
};
use crate::values::context::Context;

/// Words that occur in expressions and paths; of a path every segment.
#[derive(Default)]
struct Used {
    words: HashSet<String>,
    /// Those behind a dot: what belongs to a machine or a tool.
    members: HashSet<String>,
}

/// Looks at the items of one file; `all` are the items of every file of the compilation, which may use them.
pub(crate) fn warn(context: &mut Context<'_>, file: &File, all: &[&Item]) {
    let machines =
        || all.iter().filter_map(|item| if let Item::Machine(machine) = item { Some(machine) } else { None });
    let jobs = || all.iter().filter_map(|item| if let Item::Job(job) = item { Some(job) } else { None });
    let mut by_jobs = Used::default();
    jobs().for_each(|job| by_jobs.job(job));
    all.iter().for_each(|item| by_jobs.variant(item));
    // machines extend each other and jobs read their parameters: whoever mentions the name may mean it
    let mut by_machines = Used::default();
    machines().for_each(|machine| by_machines.machine(machine));
    // a machine that others extend may hang frames on one that a variant has replaced; at others a loop closes
    let closed = machines().flat_map(|machine| &machine.statements).filter_map(|statement| match statement {
        MachineStatement::Close(close) => Some([close.first.node.as_str(), close.second.node.as_str()]),
        _ => None,
    });
    let parents = machines().flat_map(written_frames).filter_map(parent).chain(closed.flatten());
    let parents: HashSet<&str> = parents.collect();
    for item in &file.items {
        match item {
            Item::Machine(machine) => {
                let params = machine.statements.iter().filter_map(|statement| match statement {
                    MachineStatement::Param(param) => Some(param),
                    _ => None,
                });
                let unused = params.filter(|param| !by_machines.has(&param.name) && !by_jobs.has_member(&param.name));
                unused.for_each(|param| parameter(context, param));
                frames(context, machine, &parents, &by_jobs, jobs().next().is_some());
            }
            Item::Tool(tool) => {
                let mut used = Used::default();
                used.tool(tool);
                for statement in &tool.statements {
                    if let ToolStatement::Param(param) = statement
                        && !used.has(&param.name)
                        && !by_jobs.has_member(&param.name)
                    {
                        parameter(context, param);
                    }
                }
            }
            Item::Job(job) => {
                let mut used = Used::default();
                used.job(job);
                used.inherited(job, all);
                for statement in &job.statements {
                    match statement {
                        JobStatement::Param(param) if !used.has(&param.name) => parameter(context, param),
                        JobStatement::Motion(motion) if !used.has(&motion.name) => {
                            moves_nothing(context, job, motion);
                        }
                        JobStatement::Unknown(unknown) if !used.has(&unknown.name) => {
                            let message = format!("`{}` is determined by no contact", unknown.name.node);
                            let help = format!(
                                "name it in one: `contact drive_side = a with b, over: turn, for: {}`",
                                unknown.name.node
                            );
                            context.report(Diagnostic::new(Code::UnusedMotion, unknown.name.span, message).help(help));
                        }
                        _ => {}
                    }
                }
            }
            Item::Use(_) | Item::Function(_) | Item::Variant(_) => {}
        }
    }
}

fn parameter(context: &mut Context<'_>, param: &Param) {
    let name = &param.name;
    if !name.node.is_empty() {
        let message = format!("nothing uses `{}`", name.node);
        let parts = [param.range.as_ref().map(|range| range.span), param.step.as_ref().map(|step| step.span)];
        let parts = parts.into_iter().chain([param.default.as_ref().map(|value| value.span)]).flatten();
        let whole = Rewriting::Statement(name.span, parts.fold(name.span.to(param.dimension.span), Span::to));
        let diagnostic = Diagnostic::new(Code::UnusedParameter, name.span, message);
        context.report(diagnostic.help("use it or leave it out").rewriting(whole));
    }
}

/// Reports a motion without use: it may drive an axis that stands still, or go.
fn moves_nothing(context: &mut Context<'_>, job: &ast::Job, motion: &ast::Parameter) {
    let name = &motion.name;
    let message = format!("`{}` moves nothing", name.node);
    let help = format!("drive an axis with it: `drive m.X = {}`", name.node);
    let mut diagnostic = Diagnostic::new(Code::UnusedMotion, name.span, message).help(help);
    for (axis, law) in job.statements.iter().flat_map(|statement| standing(statement, &motion.dimension)) {
        diagnostic = diagnostic.cure(format!("write `drive {axis} = {}`", name.node), law, name.node.clone());
    }
    context.report(diagnostic.rewriting(Rewriting::Statement(name.span, name.span.to(motion.range.span))));
}

/// The axes that a statement lets stand still, with the places of their laws: those of a dimension.
fn standing(statement: &JobStatement, dimension: &ast::Dimension) -> Vec<(String, Span)> {
    let JobStatement::Drive(drive) = statement else { return Vec::new() };
    let [(wanted, 1)] = dimension.factors.as_slice() else { return Vec::new() };
    let is_of_dimension = |value: &&ast::Expression| match &value.kind {
        ast::ExpressionKind::Number(_, units) => match units.as_slice() {
            [(unit, 1)] => crate::unit_size(&unit.node).is_some_and(|(_, of)| of.to_string() == wanted.node),
            _ => false,
        },
        _ => false,
    };
    let laws = drive.targets.iter().zip(&drive.values).filter(|(_, value)| is_of_dimension(value));
    laws.map(|(axis, value)| (axis.joined(), value.span)).collect()
}

fn written_frames(machine: &ast::Machine) -> impl Iterator<Item = &ast::Frame> {
    machine.statements.iter().filter_map(|statement| match statement {
        MachineStatement::Frame(frame) | MachineStatement::Insert(frame) => Some(frame),
        _ => None,
    })
}

fn parent(frame: &ast::Frame) -> Option<&str> {
    Some(frame.parent.as_ref()?.node.as_str())
}

/// Frames at the ends of the tree that carry nothing, where jobs say what is carried.
fn frames(context: &mut Context<'_>, machine: &ast::Machine, parents: &HashSet<&str>, by_jobs: &Used, has_jobs: bool) {
    if !has_jobs || !by_jobs.words.contains(&machine.name.node) {
        return;
    }
    let carries = |frame: &&ast::Frame| parents.contains(frame.name.node.as_str()) || by_jobs.has(&frame.name);
    let written = machine.statements.iter().filter_map(|statement| match statement {
        MachineStatement::Frame(frame) => Some(frame),
        _ => None,
    });
    for frame in written.filter(|frame| !carries(frame)) {
        let message =
            format!("no job reaches frame `{}`: no tool sits on it and no surface is given in it", frame.name.node);
        context.report(Diagnostic::new(Code::UnreachedFrame, frame.name.span, message));
    }
}

impl Used {
    fn has(&self, name: &Name) -> bool {
        self.words.contains(&name.node)
    }

    fn has_member(&self, name: &Name) -> bool {
        self.members.contains(&name.node)
    }

    fn path(&mut self, path: &ast::Path) {
        self.words.extend(path.segments.iter().map(|segment| segment.node.clone()));
        self.members.extend(path.segments.iter().skip(1).map(|segment| segment.node.clone()));
    }

    fn call(&mut self, call: &Call) {
        self.words.insert(call.function.node.clone());
        call.arguments.iter().for_each(|argument| self.expression(&argument.value));
    }

    fn expression(&mut self, expression: &Expression) {
        expression.each(&mut |part| self.part(part));
    }

    /// An expression without what it is made of.
    fn part(&mut self, part: &Expression) {
        match &part.kind {
            ExpressionKind::Path(path) => self.path(path),
            ExpressionKind::Call(call) => drop(self.words.insert(call.function.node.clone())),
            _ => {}
        }
    }

    fn range(&mut self, range: &ast::Range) {
        self.expression(&range.low);
        self.expression(&range.high);
    }

    fn param(&mut self, param: &ast::Param) {
        param.range.iter().for_each(|range| self.range(range));
        param.step.iter().chain(&param.default).for_each(|value| self.expression(value));
    }

    fn machine(&mut self, machine: &ast::Machine) {
        for statement in &machine.statements {
            match statement {
                MachineStatement::Param(param) => self.param(param),
                MachineStatement::Let(binding) => self.expression(&binding.value),
                MachineStatement::Axis(axis) => axis.range.iter().for_each(|range| self.range(range)),
                MachineStatement::Frame(frame) | MachineStatement::Insert(frame) => {
                    frame.transforms.iter().for_each(|call| self.call(call))
                }
                MachineStatement::Close(close) => {
                    self.words.extend([close.first.node.clone(), close.second.node.clone()]);
                    close.keeps.iter().for_each(|kept| self.range(&kept.range));
                }
                MachineStatement::Fix(law) | MachineStatement::Couple(law) => self.expression(&law.value),
                MachineStatement::Nc(word) => {
                    self.expression(&word.value);
                    word.increment.iter().for_each(|increment| self.expression(increment));
                }
                MachineStatement::Require(required) => self.expression(&required.condition),
                MachineStatement::Expect(expected) => {
                    expected.each(&mut |part| self.part(part));
                    // without it the expectation would give a value to nothing
                    if let Expected::Pose { at, .. } = &expected.what {
                        self.words.extend(at.iter().filter_map(|value| Some(value.name.as_ref()?.node.clone())));
                    }
                }
            }
        }
    }

    fn tool(&mut self, tool: &ast::Tool) {
        for statement in &tool.statements {
            match statement {
                ToolStatement::Param(param) => self.param(param),
                ToolStatement::Let(binding) => self.expression(&binding.value),
                ToolStatement::Require(required) => self.expression(&required.condition),
                ToolStatement::Profile(profile) => {
                    profile.segments.iter().for_each(|segment| self.expression(&segment.value));
                }
                ToolStatement::Surface(surface) => {
                    surface.each.iter().flat_map(|each| &each.values).for_each(|value| self.expression(value));
                    for parameter in &surface.parameters {
                        match parameter {
                            SurfaceParameter::Within(parameter) => self.range(&parameter.range),
                            SurfaceParameter::Along(_, profile) => drop(self.words.insert(profile.node.clone())),
                        }
                    }
                    surface.lets.iter().for_each(|binding| self.expression(&binding.value));
                    self.expression(&surface.at);
                    if let Side::Towards(side) | Side::Where(side) = &surface.body.side {
                        self.expression(side);
                    }
                }
            }
        }
    }

    /// What a variant of a job puts in the place of something.
    fn variant(&mut self, item: &Item) {
        let changes = match item {
            Item::Variant(variant) => &variant.changes,
            Item::Job(job) => &job.changes,
            _ => return,
        };
        for change in changes {
            self.expression(&change.value);
        }
    }

    /// What the jobs use that a job is made from. Of a text without mistakes each stands above it.
    fn inherited(&mut self, job: &ast::Job, all: &[&Item]) {
        let mut parent = job.extends.as_ref();
        while let Some(name) = parent {
            let found = all.iter().find_map(|item| match item {
                Item::Job(above) if above.name.node == name.node => {
                    self.job(above);
                    self.variant(item);
                    Some(above.extends.as_ref())
                }
                Item::Variant(above) if above.name.node == name.node => {
                    self.variant(item);
                    Some(Some(&above.parent))
                }
                _ => None,
            });
            let Some(above) = found else { return };
            parent = above;
        }
    }

    fn job(&mut self, job: &ast::Job) {
        job.each(&mut |part| self.part(part));
        for statement in &job.statements {
            match statement {
                JobStatement::Expect(expected) => expected.each(&mut |part| self.part(part)),
                JobStatement::Machine(instance) | JobStatement::Tool(instance) => {
                    self.words.insert(instance.definition.node.clone());
                }
                JobStatement::Mount { frame, .. } => self.path(frame),
                JobStatement::Solid(solid) => self.path(&solid.frame),
                JobStatement::Surface(surface) => self.path(&surface.frame),
                JobStatement::Mill(mill) => self.path(&mill.frame),
                _ => {}
            }
        }
    }
}

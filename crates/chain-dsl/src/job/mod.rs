//! Jobs: machines and tools get values, axes their laws, tools leave surfaces.

pub(crate) mod sample;
pub(crate) mod sampled;

mod available;
mod axes;
mod choices;
mod close;
mod contact;
mod cut;
mod decisive;
pub(crate) mod expect;
mod independence;
mod mill;
mod no_surface;
mod places;
mod sliding;
mod solid;
mod surfaces;
mod sweep;
mod want;

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;

use flank_expr::Expr;

use crate::definitions::instance::{Binder, Overrides, Source};
use crate::definitions::machine::{self, Built, Machines};
use crate::definitions::profile;
use crate::definitions::requirement;
use crate::definitions::tool::{self, BuiltTool, Tools};
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::job::axes::Driven;
use crate::job::decisive::Decisive;
use crate::job::sampled::SampledPoints;
use crate::limits;
use crate::model::{
    Contact, GeneratedSurface, Job, Machine, Milling, Parameter, RangedVariable, Sample, Solid, ValueSource,
    WantedContact, within,
};
use crate::syntax::ast::{self, ExpressionKind, JobStatement};
use crate::values::context::{Context, Role};
use crate::values::value::{Scope, Value};

/// The definitions that jobs draw on.
pub(crate) struct Definitions<'a> {
    pub(crate) machines: &'a Machines,
    pub(crate) tools: &'a Tools,
    pub(crate) overrides: &'a Overrides,
}

/// An earlier machine or tool of the job.
struct Original<'b, 'g> {
    name: &'b Name,
    definition: &'b String,
    parameters: &'b [Parameter<'g>],
    /// Those of its parameters that are profiles.
    profiles: Vec<String>,
}

/// A frame of a machine of the job.
type FrameRef = (usize, usize);

struct Builder<'a, 'g> {
    definitions: &'a Definitions<'a>,
    scope: Scope<'g>,
    names: HashMap<String, Span>,
    /// The job's own.
    parameters: Vec<Parameter<'g>>,
    machines: Vec<(Name, String, Built<'g>)>,
    tools: Vec<(Name, String, BuiltTool<'g>)>,
    motions: Vec<RangedVariable<'g>>,
    /// Those of the motions that a contact determines.
    unknowns: Vec<Expr<'g>>,
    solids: Vec<Solid>,
    contacts: Vec<Contact<'g>>,
    wants: Vec<WantedContact>,
    millings: Vec<Milling<'g>>,
    /// Machines that mill and generate nothing: cutter paths give the motions of their axes.
    mills: HashSet<String>,
    mounts: HashMap<String, (Option<FrameRef>, Span)>,
    /// `mount` statements that mount nothing (and have been reported).
    lost_mounts: usize,
    drives: HashMap<(usize, String), Driven<'g>>,
    /// Laws of each machine that belong to no axis, or to one that has a law already (and have been reported).
    lost_laws: HashMap<usize, usize>,
    laws: Vec<(Expr<'g>, Expr<'g>)>,
    /// Machines with an axis that has no law, or a frame without a transform of its own (which has been reported).
    unsettled: HashSet<usize>,
    surfaces: Vec<(GeneratedSurface<'g>, FrameRef)>,
    /// The names of those whose statements are still to come.
    unmade: HashSet<String>,
    /// Samples with a name of their own, with the surface that each is of.
    named_samples: Vec<(Name, usize, Sample<'g>)>,
    /// What the surfaces of the job are made from and over: `c.outside.blade`, `roll`.
    named: Vec<Vec<String>>,
    /// Of a job that is a variant of another one: its name, where its values come from.
    user: Option<Span>,
    /// Where its text ends, before the closing brace; none where it has no statements of its own.
    end: Option<Span>,
    /// Whether axes without a law are free.
    stands_alone: bool,
    /// What splines of the job go through.
    sampled: SampledPoints,
}

impl<'a, 'g> Builder<'a, 'g> {
    fn new(definitions: &'a Definitions<'a>, stands_alone: bool) -> Builder<'a, 'g> {
        Builder {
            definitions,
            scope: Scope::new(),
            names: HashMap::new(),
            parameters: Vec::new(),
            machines: Vec::new(),
            tools: Vec::new(),
            motions: Vec::new(),
            unknowns: Vec::new(),
            solids: Vec::new(),
            contacts: Vec::new(),
            wants: Vec::new(),
            millings: Vec::new(),
            mills: HashSet::new(),
            mounts: HashMap::new(),
            lost_mounts: 0,
            drives: HashMap::new(),
            lost_laws: HashMap::new(),
            laws: Vec::new(),
            unsettled: HashSet::new(),
            surfaces: Vec::new(),
            unmade: HashSet::new(),
            named_samples: Vec::new(),
            named: Vec::new(),
            user: None,
            end: None,
            stands_alone,
            sampled: SampledPoints::default(),
        }
    }

    /// Takes a machine under its own name.
    fn sole_machine(&mut self, context: &mut Context<'g>, machine: &ast::Machine) {
        let (name, definition) = (machine.name.clone(), machine.name.clone());
        self.machine(context, &ast::Instance { name, definition, settings: Vec::new() });
    }
}

/// A machine by itself, under its own name, with free axes.
pub(crate) fn standing<'g>(
    context: &mut Context<'g>,
    machine: &ast::Machine,
    definitions: &Definitions<'_>,
    file: &Path,
) -> Job<'g> {
    let mut builder = Builder::new(definitions, true);
    builder.sole_machine(context, machine);
    let machines = builder.settle_axes(context);
    builder.into_job(&machine.name, machine.doc.clone(), machines, file)
}

/// A machine by itself whose axes stand at these values, in its loops too; these stay open without.
fn posed<'g>(
    context: &mut Context<'g>,
    machine: &ast::Machine,
    definitions: &Definitions<'_>,
    values: Option<&[(&str, f64)]>,
) -> Job<'g> {
    let mut builder = Builder::new(definitions, true);
    builder.sole_machine(context, machine);
    match values {
        Some(values) => builder.place_axes(context, values),
        None => builder.unsettled.extend(0..builder.machines.len()),
    }
    let machines = builder.settle_axes(context);
    builder.into_job(&machine.name, Vec::new(), machines, Path::new(""))
}

/// A job with all its names resolved; what is wrong in it is reported and left out.
///
/// Where splines go through points of samples, it is built without these splines first, then again with their points: what hangs on a
/// profile that is not known yet is silently left out.
pub(crate) fn build<'g>(
    context: &mut Context<'g>,
    job: &ast::Job,
    is_variant: bool,
    definitions: &Definitions<'_>,
    file: &Path,
) -> Job<'g> {
    let points_before = context.sample_points;
    let mut sampled = SampledPoints::default();
    let mut decisive = Decisive::default();
    loop {
        context.steel_sides.clear();
        let (built, mut asked) = with_points(context, job, is_variant, definitions, file, sampled);
        let is_new = asked.find(context, &built, job);
        decisive.add(context, &built);
        if !is_new {
            let decisive = decisive.of(&built);
            solid::check_each(context, &built, &decisive);
            return Job { decisive, steel_sides: std::mem::take(&mut context.steel_sides), ..built };
        }
        sampled = asked;
        context.sample_points = points_before;
    }
}

/// A job whose splines go through these points of samples, and for which points they ask.
fn with_points<'g>(
    context: &mut Context<'g>,
    job: &ast::Job,
    is_variant: bool,
    definitions: &Definitions<'_>,
    file: &Path,
    sampled: SampledPoints,
) -> (Job<'g>, SampledPoints) {
    let mut builder = Builder::new(definitions, false);
    builder.sampled = sampled;
    builder.user = is_variant.then_some(job.name.span);
    let end = job.span.end.saturating_sub(1);
    let has_end = job.is_closed && (!is_variant || job.extends.is_some());
    builder.end = has_end.then_some(Span { start: end, end, ..job.span });
    context.owner = job.name.node.as_str().into();
    for statement in &job.statements {
        if let JobStatement::Surface(surface) = statement {
            surface.value.each(&mut |part| {
                if let ExpressionKind::Path(path) = &part.kind {
                    builder.named.push(path.segments.iter().map(|segment| segment.node.clone()).collect());
                }
            });
        }
    }
    builder.name_mills(job);
    let mut binder = Binder::new(Source::Job, definitions.overrides);
    context.later = available::valued(job);
    context.unmade.clear();
    context.unsampled.clear();
    for statement in &job.statements {
        if let Some(name) = available::name_of_value(statement) {
            context.later.remove(&name.node);
        }
        builder.declare(context, statement, &mut binder);
    }
    context.later.clear();
    binder.finish(context, &job.params());
    builder.parameters = binder.parameters;
    for statement in &job.statements {
        match statement {
            JobStatement::Mount { names, frame } => {
                names.iter().for_each(|name| builder.mount(context, name, frame, job));
            }
            JobStatement::Drive(drive) => builder.drive(context, drive),
            _ => {}
        }
    }
    let machines = builder.settle_axes(context);
    builder.unmade = declared(job).map(str::to_string).collect();
    for statement in &job.statements {
        if let JobStatement::Surface(surface) = statement {
            builder.surface(context, surface);
            surface.names.iter().for_each(|name| {
                builder.unmade.remove(&name.node);
            });
        }
    }
    for statement in &job.statements {
        match statement {
            JobStatement::Trim { surface, by } => builder.trim(context, surface, by, job),
            JobStatement::Cut { surface, by } => builder.cut(context, surface, by, job),
            JobStatement::Solid(solid) => builder.solid(context, solid, job),
            JobStatement::Contact(contact) => builder.contact(context, contact, job),
            JobStatement::Want(want) => builder.want(context, want, job),
            JobStatement::Sample(sample) => builder.sample(context, sample, job),
            _ => {}
        }
    }
    // coordinates may be those of a sample
    for statement in &job.statements {
        if let JobStatement::Mill(mill) = statement {
            builder.mill(context, mill, job);
        }
    }
    builder.add_named_samples(context);
    // a job whose name could not be read has been reported
    let is_whole = !job.name.node.is_empty();
    if is_whole && !job.statements.iter().any(|statement| matches!(statement, JobStatement::Surface(_))) {
        builder.no_surface(context, &job.name);
    }
    let is_settled = context.is_whole && builder.sampled.are_known() && context.unmade.is_empty();
    let expectations = if is_settled { builder.expectations(context, job) } else { Vec::new() };
    let sampled = std::mem::take(&mut builder.sampled);
    let built = builder.into_job(&job.name, job.doc.clone(), machines, file);
    (Job { expectations, ..built }, sampled)
}

impl<'g> Builder<'_, 'g> {
    fn into_job(self, name: &Name, doc: Vec<String>, machines: Vec<Machine<'g>>, file: &Path) -> Job<'g> {
        let mut parameters = self.parameters;
        let mut settings = Vec::new();
        for (_, _, built) in self.machines {
            parameters.extend(built.parameters);
            settings.extend(built.settings);
        }
        for (_, _, built) in self.tools {
            parameters.extend(built.parameters);
        }
        // a setting comes after the job parameters that it is made of, and those were made first
        parameters.sort_by_key(|parameter| parameter.variable.as_variable());
        let surfaces = self.surfaces.into_iter().map(|(surface, _)| surface).collect();
        Job {
            name: name.node.clone(),
            doc,
            file: file.to_path_buf(),
            written: name.span,
            parameters,
            settings,
            motions: self.motions,
            machines,
            surfaces,
            unknowns: self.unknowns,
            solids: self.solids,
            contacts: self.contacts,
            wants: self.wants,
            millings: self.millings,
            expectations: Vec::new(),
            decisive: Vec::new(),
            steel_sides: Vec::new(),
        }
    }

    fn define(&mut self, context: &mut Context<'g>, name: &Name) {
        self.is_first(context, name);
    }

    /// Defines a name, of which a second definition is reported and makes nothing.
    fn is_first(&mut self, context: &mut Context<'g>, name: &Name) -> bool {
        let first = *self.names.entry(name.node.clone()).or_insert(name.span);
        if first != name.span {
            context.duplicate(name, first);
        }
        first == name.span
    }

    fn declare(&mut self, context: &mut Context<'g>, statement: &JobStatement, binder: &mut Binder<'_, 'g>) {
        match statement {
            JobStatement::Param(param) => {
                self.define(context, &param.name);
                binder.bind(context, param, &mut self.scope);
            }
            // a statement that is nothing else, which is reported: what it was to define is not known
            JobStatement::Let(ast::Let { name, value }) if value.kind == ExpressionKind::Error => {
                context.unmade.insert(name.node.clone());
                self.names.entry(name.node.clone()).or_insert(name.span);
                self.scope.entry(name.node.clone()).or_insert(Value::Poison);
            }
            JobStatement::Let(binding) => {
                self.define(context, &binding.name);
                let value = context.evaluate(&binding.value, &self.scope);
                context.note_value(binding.name.span, binding.value.span, &value);
                self.scope.insert(binding.name.node.clone(), value);
            }
            JobStatement::Motion(motion) | JobStatement::Unknown(motion) => {
                let is_unknown = matches!(statement, JobStatement::Unknown(_));
                if !self.is_first(context, &motion.name) {
                    return;
                }
                sample::check_unknown(context, &motion.name, if is_unknown { "unknown" } else { "motion" });
                let bounded = tool::bounded(context, motion, &self.scope, Role::Motion);
                self.unknowns.extend(bounded.iter().filter(|_| is_unknown).map(|bounded| bounded.variable));
                let value = match &bounded {
                    Some(bounded) => Value::Scalar(bounded.variable, bounded.dimension),
                    None => Value::Poison,
                };
                self.scope.insert(motion.name.node.clone(), value);
                if self.motions.len() == limits::MOTIONS.most {
                    context.report(limits::MOTIONS.exceeded(motion.name.span));
                } else {
                    self.motions.extend(bounded);
                }
            }
            JobStatement::Machine(instance) => self.machine(context, instance),
            JobStatement::Tool(instance) => self.tool(context, instance),
            JobStatement::Surface(surface) => surface.names.iter().for_each(|name| self.define(context, name)),
            JobStatement::Require(required) => requirement::check(context, required, &self.scope, self.user),
            JobStatement::Profile(written) => {
                self.define(context, &written.name);
                profile::build(context, written, &mut self.scope, Some(&mut self.sampled));
            }
            JobStatement::Solid(solid) => self.define(context, &solid.name),
            JobStatement::Contact(contact) => self.define(context, &contact.name),
            JobStatement::Want(want) => self.define(context, &want.name),
            JobStatement::Mill(mill) => self.define(context, &mill.name),
            JobStatement::Mount { .. }
            | JobStatement::Drive(_)
            | JobStatement::Trim { .. }
            | JobStatement::Cut { .. }
            | JobStatement::Expect(_) => {}
            JobStatement::Sample(sample) => {
                sample
                    .surfaces
                    .iter()
                    .filter_map(|sampled| sampled.name.as_ref())
                    .for_each(|name| self.define(context, name));
            }
        }
    }

    fn machine(&mut self, context: &mut Context<'g>, instance: &ast::Instance) {
        if !self.is_first(context, &instance.name) {
            return;
        }
        let machines = self.definitions.machines;
        let own = self.machines.iter().find(|(name, ..)| name.node == instance.definition.node);
        let own = own.map(|(name, definition, built)| Original {
            name,
            definition,
            parameters: &built.parameters,
            profiles: Vec::new(),
        });
        let first = own.as_ref().map(|own| own.name.node.as_str());
        let Some(resolved) = self.resolved(context, instance, own) else { return self.lose(instance) };
        let instance = resolved.as_ref();
        let Some(definition) = machines.get(&instance.definition.node) else {
            let known = machines.keys().chain(self.machines.iter().map(|(name, ..)| &name.node));
            context.unknown_item(&instance.definition, "machine", known.map(String::as_str));
            context.unmade.insert(instance.name.node.clone());
            return;
        };
        let Some(flat) = machine::flatten(context, machines, definition) else {
            context.unmade.insert(instance.name.node.clone());
            return;
        };
        let source = self.source(instance, first);
        let job = instance_owner(context, &instance.name);
        let built = flat.build(context, &definition.name, source, self.definitions.overrides);
        context.owner = job;
        let axes = self.machines.iter().map(|(_, _, built)| built.axes.len()).sum::<usize>() + built.axes.len();
        if axes > limits::AXES.most {
            return context.report(limits::AXES.exceeded(instance.name.span));
        }
        self.expose(&instance.name, &built.scope);
        if built.lacks_transforms {
            self.unsettled.insert(self.machines.len());
        }
        self.lost_laws.insert(self.machines.len(), built.lost_laws);
        self.machines.push((instance.name.clone(), definition.name.node.clone(), built));
    }

    fn tool(&mut self, context: &mut Context<'g>, instance: &ast::Instance) {
        if !self.is_first(context, &instance.name) {
            return;
        }
        let tools = self.definitions.tools;
        let own = self.tools.iter().find(|(name, ..)| name.node == instance.definition.node);
        let own = own.map(|(name, definition, built)| {
            let profiles = tools.get(definition).map(|tool| tool::profiles(tool, &name.node)).unwrap_or_default();
            Original { name, definition, parameters: &built.parameters, profiles }
        });
        let first = own.as_ref().map(|own| own.name.node.as_str());
        let Some(resolved) = self.resolved(context, instance, own) else { return self.lose(instance) };
        let instance = resolved.as_ref();
        let Some(definition) = tools.get(&instance.definition.node) else {
            let known = tools.keys().chain(self.tools.iter().map(|(name, ..)| &name.node));
            context.unknown_item(&instance.definition, "tool", known.map(String::as_str));
            context.unmade.insert(instance.name.node.clone());
            return;
        };
        let source = self.source(instance, first);
        // of most tools, a job needs few surfaces
        let name = instance.name.node.as_str();
        let is_named =
            |path: &&Vec<String>, surface: &str| path[0] == name && path.get(1).is_some_and(|it| it == surface);
        let wanted = |surface: &str, piece: Option<&str>| {
            let mut paths = self.named.iter().filter(|path| is_named(path, surface));
            paths.any(|path| piece.is_none() || path.get(2).is_none_or(|it| Some(it.as_str()) == piece))
        };
        let job = instance_owner(context, &instance.name);
        let built = tool::build(context, definition, source, self.definitions.overrides, &wanted);
        context.owner = job;
        self.expose(&instance.name, &built.scope);
        self.tools.push((instance.name.clone(), definition.name.node.clone(), built));
    }

    /// The names in a machine or tool that is an earlier one again which could not be built: there are such values, and they are not known.
    fn lose(&mut self, instance: &ast::Instance) {
        let ast::Instance { name, definition, .. } = instance;
        let inner = self.scope.keys().filter_map(|known| within(known, &definition.node));
        let lost: Vec<String> = inner.map(|inner| format!("{}.{inner}", name.node)).collect();
        self.scope.extend(lost.into_iter().map(|name| (name, Value::Poison)));
    }

    /// What a machine or tool is one of; one that is an earlier one of the job again (`tool d = c(radius: 3 mm)`) has that one's
    /// values where it has none of its own. Nothing if the earlier one could not be built, which has been reported.
    fn resolved<'i>(
        &self,
        context: &mut Context<'g>,
        instance: &'i ast::Instance,
        original: Option<Original<'_, 'g>>,
    ) -> Option<Cow<'i, ast::Instance>> {
        let Some(original) = original else {
            let earlier = &instance.definition;
            let is_definition = self.definitions.machines.contains_key(&earlier.node)
                || self.definitions.tools.contains_key(&earlier.node);
            let is_lost = !is_definition
                && earlier.node != instance.name.node
                && self.names.contains_key(&earlier.node)
                && self.is_broken_machine(earlier);
            return (!is_lost).then_some(Cow::Borrowed(instance));
        };
        let mut settings = instance.settings.clone();
        let own: HashSet<&str> =
            instance.settings.iter().filter_map(|it| Some(it.name.as_ref()?.node.as_str())).collect();
        let place = instance.definition.span;
        let is_broken = |(name, value): (&String, &Value<'g>)| {
            matches!(value, Value::Poison) && within(name, &original.name.node).is_some()
        };
        if !context.spend(self.scope.len(), place) || self.scope.iter().any(is_broken) {
            return None;
        }
        let is_given = |parameter: &&Parameter<'g>| !matches!(parameter.given_by, ValueSource::Definition(_));
        let given = original.parameters.iter().filter(is_given).map(|parameter| parameter.name.as_str());
        for name in given.chain(original.profiles.iter().map(String::as_str)) {
            let Some(inner) = within(name, &original.name.node).filter(|inner| !own.contains(inner)) else {
                continue;
            };
            let named = |node: &str| Name { node: node.to_string(), span: place };
            let path = ast::Path { segments: vec![named(&original.name.node), named(inner)], span: place };
            let value = ast::Expression { kind: ExpressionKind::Path(path), span: place };
            settings.push(ast::Argument { name: Some(named(inner)), value });
        }
        let definition = Name { node: original.definition.clone(), span: place };
        Some(Cow::Owned(ast::Instance { name: instance.name.clone(), definition, settings }))
    }

    fn source<'s>(&'s self, instance: &'s ast::Instance, first: Option<&'s str>) -> Source<'s, 'g> {
        if self.stands_alone {
            return Source::Standing { name: &instance.name };
        }
        let definition = &instance.definition.node;
        Source::Instance { name: &instance.name, definition, settings: &instance.settings, job: &self.scope, first }
    }

    /// Settings, constants and axes of a machine or tool can be read in the job as `m.name`.
    fn expose(&mut self, name: &Name, scope: &Scope<'g>) {
        for (inner, value) in scope {
            self.scope.insert(format!("{}.{inner}", name.node), value.clone());
        }
    }

    fn frame(&self, context: &mut Context<'g>, path: &ast::Path) -> Option<FrameRef> {
        let (machine, member) = self.machine_member(context, path, "a frame")?;
        let built = &self.machines[machine].2;
        let found = built.frames.iter().position(|frame| frame.name == member.node);
        if found.is_none() && !built.declared_frames.contains(&member.node) {
            context.unknown(member, "frame", built.declared_frames.iter().map(String::as_str));
        }
        found.map(|frame| (machine, frame))
    }

    fn mount(&mut self, context: &mut Context<'g>, name: &Name, frame: &ast::Path, job: &ast::Job) {
        let tools = job.statements.iter().filter_map(|statement| match statement {
            JobStatement::Tool(tool) => Some(tool.name.node.as_str()),
            _ => None,
        });
        let mountable: Vec<&str> = tools.chain(declared(job)).collect();
        if !mountable.contains(&name.node.as_str()) {
            context.unknown(name, "tool", mountable.into_iter());
            self.lost_mounts += 1;
            return;
        }
        let place = self.frame(context, frame);
        if let Some((_, first)) = self.mounts.get(&name.node) {
            let message = format!("`{}` is mounted twice", name.node);
            let first = *first;
            let help = format!("a tool on a second frame has a second name, such as `tool other = {}`", name.node);
            context
                .report(Diagnostic::new(Code::DuplicateName, name.span, message).note(first, "first here").help(help));
            self.lost_mounts += 1;
            return;
        }
        self.mounts.insert(name.node.clone(), (place, name.span));
    }
}

/// Says that the values to come are those of a machine or tool of the job; gives back what the job is called.
fn instance_owner(context: &mut Context<'_>, name: &Name) -> Rc<str> {
    let own = format!("{}.{}", context.owner, name.node);
    std::mem::replace(&mut context.owner, own.into())
}

/// The names of the surfaces of a job.
fn declared(job: &ast::Job) -> impl Iterator<Item = &str> {
    let surfaces = job.statements.iter().filter_map(|statement| match statement {
        JobStatement::Surface(surface) => Some(&surface.names),
        _ => None,
    });
    surfaces.flatten().map(|name| name.node.as_str())
}

/// What one element and several of a list are called, and where they stand.
type Listed = ([&'static str; 2], Vec<Span>);

/// Whether two lists have an element for each of the other; the first that has none is reported.
fn are_even(context: &mut Context<'_>, first: Listed, second: Listed, help: &str) -> bool {
    let (longer, shorter) = if first.1.len() > second.1.len() { (first, second) } else { (second, first) };
    let Some(lonely) = longer.1.get(shorter.1.len()) else { return true };
    let counted = |([one, several], places): &Listed| match places.len() {
        1 => format!("1 {one}"),
        count => format!("{count} {several}"),
    };
    let message = format!("{} for {}", counted(&longer), counted(&shorter));
    let left_out = Rewriting::Entry(*lonely);
    context.report(Diagnostic::new(Code::UnevenLists, *lonely, message).help(help).rewriting(left_out));
    false
}

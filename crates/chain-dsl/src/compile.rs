//! From files to a model.

use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use flank_expr::Graph;

use crate::definitions::index::Index;
use crate::definitions::instance::{Overrides, Source};
use crate::definitions::items::{Items, JobItem};
use crate::definitions::machine;
use crate::definitions::tool;
use crate::definitions::unused;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{FileId, Name, Sources, Span};
use crate::diagnostics::{Diagnostic, Note, Severity};
use crate::job::expect;
use crate::job::expect::model::{Expectation, ExpectedError};
use crate::job::{self, Definitions};
use crate::limits;
use crate::load::files::{Disk, Files};
use crate::load::{self, Loaded};
use crate::model::{Job, within};
use crate::syntax::ast::{self, Item};
use crate::syntax::parse_expression;
use crate::values::context::{Context, Role, did_you_mean, quoted};
use crate::values::dimension::Dimension;
use crate::values::table_files::Tables;
use crate::values::value::{Scope, Value};

/// What became of a text.
#[derive(Clone, Debug)]
pub struct Compilation<'g> {
    /// All texts that were read, for showing places in them: specs, values from outside, then tables.
    pub sources: Sources,
    /// Findings in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
    /// The jobs of the file itself (not those of the files it uses), as far as they were asked for; none if there is an error.
    pub jobs: Vec<Job<'g>>,
    /// The machine of [`compile_with_machine`] as a job without surfaces, which its axes drive themselves; none if there is an
    /// error.
    pub machine: Option<Job<'g>>,
    /// What the machines of the file itself are to be like, by themselves; none if there is an error.
    pub machines: Vec<MachineExpectations<'g>>,
    /// The errors that the file is to have.
    pub expected_errors: Vec<ExpectedError>,
    /// The jobs of a file that is to have errors which are to have none of their own: nothing is tested of them. Where their names stand.
    pub untested_jobs: Vec<Name>,
    /// All names of the texts, also of wrong ones.
    pub index: Index,
    main: Option<FileId>,
    /// The names of all jobs of the file itself.
    known_jobs: Vec<String>,
    /// The names of the values from outside.
    set: Vec<Name>,
}

/// What a machine is to be like.
#[derive(Clone, Debug)]
pub struct MachineExpectations<'g> {
    /// Its name.
    pub name: String,
    /// What is expected of it.
    pub expectations: Vec<Expectation<'g>>,
}

/// What is compiled beside the text of a file itself.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// What all texts are read from.
    pub files: Arc<dyn Files>,
    /// A file whose last machine stands by itself: with the values that its settings have by default, or by `set` such as
    /// `free_form.root=10 deg`, and free axes.
    pub machine: Option<&'a Path>,
    /// The jobs that `set` is meant for; all of the file where none is named, or one that the file does not have.
    pub jobs: Vec<&'a str>,
    /// Pairs of a name (`ratio`, `m.swivel`, in one job only `gear.m.swivel`) and a value as text (`2 mm`) that win over what the
    /// text says.
    pub set: &'a [(String, String)],
    /// Whether all is looked at: jobs that are not asked for, those of files that are used, what specs are tested by, and what names
    /// stand for. Otherwise what is wrong there may stay unsaid.
    pub whole: bool,
}

impl Default for Request<'_> {
    fn default() -> Self {
        Request { files: Arc::new(Disk), machine: None, jobs: Vec::new(), set: &[], whole: true }
    }
}

impl<'g> Compilation<'g> {
    /// True if the text means nothing.
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.severity() == Severity::Error)
    }

    /// Takes the jobs of these names out, or all jobs if none is asked for.
    ///
    /// # Errors
    /// What is found if there is none of these, or no job at all, or values are given from outside that only jobs have which are not
    /// asked for.
    pub fn take_jobs(&mut self, wanted: &[impl AsRef<str>]) -> Result<Vec<Job<'g>>, Vec<Diagnostic>> {
        let all = std::mem::take(&mut self.jobs);
        let is_wanted = |job: &Job<'g>| wanted.is_empty() || wanted.iter().any(|name| name.as_ref() == job.name);
        let (jobs, others): (Vec<Job<'g>>, Vec<Job<'g>>) = all.into_iter().partition(is_wanted);
        match &jobs[..] {
            [] => Err(vec![self.no_job(wanted.first().map(AsRef::as_ref))]),
            _ => match self.set_elsewhere(&jobs, &others) {
                findings if findings.is_empty() => Ok(jobs),
                findings => Err(findings),
            },
        }
    }

    /// What is said of values from outside that only jobs have which nobody asks for.
    fn set_elsewhere(&self, jobs: &[Job<'g>], others: &[Job<'g>]) -> Vec<Diagnostic> {
        let findings = self.set.iter().filter_map(|name| {
            let is_there = jobs.iter().chain(&self.machine).any(|job| job.has_parameter(&name.node));
            let owner = others.iter().find(|other| other.has_parameter(&name.node)).filter(|_| !is_there)?;
            let names: Vec<String> = jobs.iter().map(|job| format!("`{}`", job.name)).collect();
            let message = match &names[..] {
                [one] => format!("job {one} has no parameter `{}`", name.node),
                _ => format!("none of the jobs {} has a parameter `{}`", names.join(", "), name.node),
            };
            let help = format!("job `{}` has one, and is not asked for", owner.name);
            Some(Diagnostic::new(Code::UnknownName, name.span, message).help(help))
        });
        findings.collect()
    }

    fn no_job(&mut self, wanted: Option<&str>) -> Diagnostic {
        let main = self.main.unwrap_or(FileId(0));
        let file = self.sources.file(main).path.display().to_string().replace('\\', "/");
        match wanted {
            Some(wanted) if !self.known_jobs.is_empty() => {
                let asked = self.sources.add("option `job`", wanted);
                let span = Span { file: asked, start: 0, end: wanted.len() as u32 };
                let message = format!("there is no job `{wanted}` in {file}");
                let mut diagnostic = Diagnostic::new(Code::NoJob, span, message);
                diagnostic.help = did_you_mean(wanted, self.known_jobs.iter().map(String::as_str));
                diagnostic
            }
            _ => {
                let span = Span { file: main, start: 0, end: 0 };
                let help = "a machine or a tool by itself makes no surface; ask for a file with a `job`";
                Diagnostic::new(Code::NoJob, span, format!("there is no job in {file}")).help(help)
            }
        }
    }
}

/// Reads a file, everything it uses, and builds its jobs in an empty graph.
///
/// `overrides` are values from outside for all its jobs ([`Request::set`]).
pub fn compile_file<'g>(graph: &'g Graph, path: &Path, overrides: &[(String, String)]) -> Compilation<'g> {
    compile_request(graph, path, &Request { set: overrides, ..Request::default() })
}

/// The same beside the last machine of another file ([`Request::machine`]).
pub fn compile_with_machine<'g>(
    graph: &'g Graph,
    path: &Path,
    machine: &Path,
    overrides: &[(String, String)],
) -> Compilation<'g> {
    compile_request(graph, path, &Request { machine: Some(machine), set: overrides, ..Request::default() })
}

/// The same of a file, as it is asked for.
pub fn compile_request<'g>(graph: &'g Graph, path: &Path, request: &Request<'_>) -> Compilation<'g> {
    compile(graph, load::load(Arc::clone(&request.files), path, request.machine), request)
}

/// The same for a text in memory, which can use no other file.
pub fn compile_text<'g>(graph: &'g Graph, name: &str, text: &str, overrides: &[(String, String)]) -> Compilation<'g> {
    compile(graph, load::load_text(name, text), &Request { set: overrides, ..Request::default() })
}

fn compile<'g>(graph: &'g Graph, loaded: Loaded, request: &Request<'_>) -> Compilation<'g> {
    let Loaded { from, mut sources, files, diagnostics, lacks_files, used, projects, main, beside } = loaded;
    graph.set_room(Some(limits::GRAPH_OPERATIONS.most));
    let mut context = Context::new(graph, Tables::new(from, projects, &sources));
    context.lacks_files = lacks_files;
    context.is_whole = request.whole;
    diagnostics.into_iter().for_each(|diagnostic| context.report(diagnostic));
    let overrides = read_overrides(&mut context, &mut sources, request.set);
    let items = Items::collect(&mut context, &files, beside.is_some());
    check_definitions(&mut context, &items);
    let jobs = build_jobs(&mut context, &items, (main, request, &overrides), &sources);
    let own_jobs = items.jobs.iter().filter(|item| Some(item.file) == main);
    let (mut expected_errors, mut untested_jobs) = (Vec::new(), Vec::new());
    for item in own_jobs {
        let own = expect::errors(&mut context, &item.job);
        untested_jobs.extend(own.is_empty().then(|| item.job.name.clone()));
        expected_errors.extend(own);
    }
    if expected_errors.is_empty() {
        untested_jobs.clear();
    }
    let own = files.iter().find(|(id, _)| Some(*id) == main);
    let machines = if request.whole { items.expected(&mut context, own, &jobs) } else { Vec::new() };
    let beside = files.iter().find(|(id, _)| Some(*id) == beside);
    let definitions = Definitions { machines: &items.machines, tools: &items.tools, overrides: &overrides.values };
    let machine = beside.and_then(|(id, file)| standing(&mut context, file, *id, &definitions, &sources));
    check_overrides(&mut context, &overrides, jobs.iter().chain(&machine));
    // a wrong text is not finished: what it does not use yet is no finding
    if let Some((id, file)) = own.filter(|_| !context.has_errors()) {
        let all: Vec<&Item> = files.iter().flat_map(|(_, file)| &file.items).collect();
        unused::warn(&mut context, file, &all);
        if file.items.is_empty() {
            let (start, message) = (Span { file: *id, start: 0, end: 0 }, "the file declares nothing");
            let help = "a spec has at least one machine, tool, job or function";
            context.report(Diagnostic::new(Code::EmptyFile, start, message).help(help));
        }
    }
    graph.set_room(None);
    let mut index = Index::default();
    if request.whole {
        index = Index::of_files(&files, &used);
        (index.values, index.dimensions) = context.known_values();
    }
    context.tables.tell(&mut sources);
    let failed = context.has_errors();
    let mut diagnostics: Vec<Diagnostic> =
        context.finish().into_iter().map(|diagnostic| diagnostic.written_out(&sources)).collect();
    diagnostics.sort_by_key(|diagnostic| (diagnostic.span.file, diagnostic.span.start));
    let (jobs, machine, machines) = if failed { Default::default() } else { (jobs, machine, machines) };
    let known_jobs = items.jobs.into_iter().filter(|item| Some(item.file) == main).map(|item| item.job.name.node);
    Compilation {
        sources,
        diagnostics,
        jobs,
        machine,
        machines,
        expected_errors,
        untested_jobs,
        index,
        main,
        known_jobs: known_jobs.collect(),
        set: overrides.names,
    }
}

/// The jobs of the main file that are asked for; of a whole compilation all of them, and those of other files are looked at, too.
fn build_jobs<'g>(
    context: &mut Context<'g>,
    items: &Items,
    (main, request, overrides): (Option<FileId>, &Request<'_>, &OuterValues),
    sources: &Sources,
) -> Vec<Job<'g>> {
    let is_own = |item: &JobItem| Some(item.file) == main;
    let is_there = |wanted: &&str| items.jobs.iter().any(|item| is_own(item) && item.job.name.node == *wanted);
    let are_named = !request.jobs.is_empty() && request.jobs.iter().all(is_there);
    let is_asked = |item: &JobItem| is_own(item) && (!are_named || request.jobs.contains(&item.job.name.node.as_str()));
    let mut built: Vec<Option<Job<'g>>> = items.jobs.iter().map(|_| None).collect();
    for (place, item) in items.jobs.iter().enumerate() {
        if request.whole || is_asked(item) {
            built[place] = build_job(context, items, (item, is_asked(item)), overrides, sources);
        } else {
            item.job.each(&mut |part| context.read_table(part));
        }
    }
    // a value from outside may be one of a job that is not asked for, which has to be said
    let is_had = |name: &Name| built.iter().flatten().any(|job| job.has_parameter(&name.node));
    if !overrides.names.iter().all(is_had) {
        for (place, item) in items.jobs.iter().enumerate().filter(|(_, item)| is_own(item)) {
            if built[place].is_none() {
                built[place] = build_job(context, items, (item, is_asked(item)), overrides, sources);
            }
        }
    }
    let of_main = items.jobs.iter().zip(built).filter(|(item, _)| is_own(item));
    of_main.filter_map(|(_, job)| job).collect()
}

fn build_job<'g>(
    context: &mut Context<'g>,
    items: &Items,
    (JobItem { file, job: written, made_from }, is_asked): (&JobItem, bool),
    overrides: &OuterValues,
    sources: &Sources,
) -> Option<Job<'g>> {
    context.begin_item();
    let found = context.findings();
    if written.statements.iter().map(ast::JobStatement::size).sum::<usize>() > limits::JOB_STATEMENTS.most {
        context.report(limits::JOB_STATEMENTS.exceeded(written.name.span));
        return None;
    }
    // jobs that are not asked for are as they are written
    let own = if is_asked { overrides.of_job(&written.name.node) } else { Overrides::new() };
    let definitions = Definitions { machines: &items.machines, tools: &items.tools, overrides: &own };
    let job = job::build(context, written, !made_from.is_empty(), &definitions, &sources.file(*file).path);
    context.step(written.name.span);
    let note = Note { span: written.name.span, text: "with the changes of this job".to_string() };
    made_from.iter().for_each(|parent| context.note_since(found, *parent, &note));
    Some(job)
}

/// The last machine of a file by itself.
fn standing<'g>(
    context: &mut Context<'g>,
    file: &ast::File,
    id: FileId,
    definitions: &Definitions<'_>,
    sources: &Sources,
) -> Option<Job<'g>> {
    let mut machines = file.items.iter().filter_map(|item| match item {
        Item::Machine(machine) => Some(machine),
        _ => None,
    });
    context.begin_item();
    let path = &sources.file(id).path;
    match machines.next_back() {
        Some(machine) => Some(job::standing(context, machine, definitions, path)),
        None => {
            let span = Span { file: id, start: 0, end: 0 };
            let message = format!("there is no machine in {}", path.display().to_string().replace('\\', "/"));
            let help = "name a file that defines the machine itself, as `machine free_form { … }`";
            context.report(Diagnostic::new(Code::UnknownName, span, message).help(help));
            None
        }
    }
}

impl Items {
    /// What the machines of a file expect by themselves. Its jobs may name each other's surfaces: these are looked for now.
    fn expected<'g>(
        &self,
        context: &mut Context<'g>,
        file: Option<&(FileId, Arc<ast::File>)>,
        jobs: &[Job<'g>],
    ) -> Vec<MachineExpectations<'g>> {
        let all = jobs.iter().flat_map(|job| job.surfaces.iter().map(|of| format!("{}.{}", job.name, of.name)));
        let all: Vec<String> = all.collect();
        if !context.has_errors() {
            expect::check_others(context, jobs.iter().flat_map(|job| &job.expectations), &all);
        }
        let nothing = Overrides::new();
        let definitions = Definitions { machines: &self.machines, tools: &self.tools, overrides: &nothing };
        let machines = file.into_iter().flat_map(|(_, file)| &file.items).filter_map(|item| match item {
            Item::Machine(machine) => Some(machine),
            _ => None,
        });
        let found = machines.map(|machine| {
            context.begin_item();
            let expectations = expect::of_machine(context, machine, &definitions);
            MachineExpectations { name: machine.name.node.clone(), expectations }
        });
        found.filter(|of| !of.expectations.is_empty()).collect()
    }
}

/// Definitions are looked at by themselves, with parameters that have no values, so that a mistake shows without a use.
fn check_definitions(context: &mut Context<'_>, items: &Items) {
    let nothing = Overrides::new();
    let mut functions: Vec<Rc<ast::Function>> = context.functions.values().cloned().collect();
    functions.sort_by_key(|function| function.name.span);
    for function in functions {
        context.begin_item();
        let names = function.arguments.iter().map(|(name, _)| name);
        context.are_distinct(names.chain(function.lets.iter().map(|binding| &binding.name)));
        let mut scope = Scope::new();
        for (name, written) in &function.arguments {
            let value = match (context.dimension(&written.dimension), written.size) {
                (Some(_), Some(size)) if !context.spend(size, written.dimension.span) => Value::Poison,
                (Some(dimension), Some(size)) => {
                    Value::Vector((0..size).map(|_| argument(context, name, dimension)).collect())
                }
                (Some(dimension), None) => argument(context, name, dimension),
                (None, _) => Value::Poison,
            };
            scope.insert(name.node.clone(), value);
        }
        context.function_body(&function, scope);
    }
    let mut machines: Vec<&ast::Machine> = items.machines.values().collect();
    machines.sort_by_key(|machine| machine.name.span);
    for machine in machines {
        context.begin_item();
        context.owner = machine.name.node.as_str().into();
        if let Some(flat) = machine::flatten(context, &items.machines, machine) {
            flat.build(context, &machine.name, Source::Definition, &nothing);
        }
    }
    let mut tools: Vec<&ast::Tool> = items.tools.values().collect();
    tools.sort_by_key(|tool| tool.name.span);
    for tool in tools {
        context.begin_item();
        context.owner = tool.name.node.as_str().into();
        tool::build(context, tool, Source::Definition, &nothing, &|_, _| true);
        context.step(tool.name.span);
    }
}

/// An argument of a function that is looked at by itself.
fn argument<'g>(context: &mut Context<'g>, name: &Name, dimension: Dimension) -> Value<'g> {
    Value::Scalar(context.variable(name.node.clone(), Role::StandingArgument, f64::NAN), dimension)
}

/// Values from outside, as expressions of a text of their own.
struct OuterValues {
    values: Overrides,
    names: Vec<Name>,
}

impl OuterValues {
    /// The values by the names that a job knows: one that is given with the job's name before it wins.
    fn of_job(&self, job: &str) -> Overrides {
        let mut own = self.values.clone();
        let named = self.values.iter().filter_map(|(name, value)| Some((within(name, job)?, value)));
        own.extend(named.map(|(name, value)| (name.to_string(), value.clone())));
        own
    }

    /// A name that means one thing in each job that has it, and changes one of them at least.
    fn check_owners<'j, 'g: 'j>(
        &self,
        context: &mut Context<'_>,
        name: &Name,
        owners: impl Iterator<Item = &'j Job<'g>>,
    ) {
        let given = &name.node;
        let mut hidden_by = Vec::new();
        for job in owners {
            let is_own = |name: &str| job.parameters.iter().any(|parameter| parameter.name == name);
            match within(given, &job.name).filter(|inner| is_own(inner)) {
                Some(inner) if is_own(given) => {
                    let message =
                        format!("`{given}` is `{inner}` of job `{0}`, and `{inner}` of what it calls `{0}`", job.name);
                    let help = format!(
                        "the second is `{}.{given}`, the first is `{inner}` with the option `job {0}`",
                        job.name
                    );
                    return context.report(Diagnostic::new(Code::DuplicateName, name.span, message).help(help));
                }
                Some(_) => return,
                None => match format!("{}.{given}", job.name) {
                    own if self.values.contains_key(&own) => hidden_by.push(own),
                    _ => return,
                },
            }
        }
        let hidden_by: Vec<&str> = hidden_by.iter().map(String::as_str).collect();
        let message = format!("`{given}` changes nothing beside {}", quoted(&hidden_by));
        let help = "leave it out: the name of a job goes before one that is for all jobs";
        context.report(Diagnostic::new(Code::DuplicateName, name.span, message).help(help));
    }
}

fn read_overrides(context: &mut Context<'_>, sources: &mut Sources, given: &[(String, String)]) -> OuterValues {
    let mut outer = OuterValues { values: Overrides::new(), names: Vec::new() };
    for (name, value) in given {
        let text = format!("{name}={value}");
        let start = name.len() as u32 + 1;
        let file = sources.add("option `set`", text);
        let (expression, diagnostics) = parse_expression(&sources.file(file).text, file, start);
        diagnostics.into_iter().for_each(|diagnostic| context.report(diagnostic));
        outer.values.insert(name.clone(), expression);
        outer.names.push(Name { node: name.clone(), span: Span { file, start: 0, end: start - 1 } });
    }
    outer
}

/// What is wrong with the names of values from outside, all of it. Where a text is wrong by itself, parameters may be missing that the right text
/// has, and nothing is said.
fn check_overrides<'j, 'g: 'j>(
    context: &mut Context<'_>,
    outer: &OuterValues,
    jobs: impl Iterator<Item = &'j Job<'g>> + Clone,
) {
    let is_outer = |span: Span| outer.names.iter().any(|name| name.span.file == span.file);
    if context.lacks_parameters(is_outer) {
        return;
    }
    for name in &outer.names {
        check_override(context, outer, name, jobs.clone());
    }
}

fn check_override<'j, 'g: 'j>(
    context: &mut Context<'_>,
    outer: &OuterValues,
    name: &Name,
    jobs: impl Iterator<Item = &'j Job<'g>> + Clone,
) {
    let mut owners = jobs.clone().filter(|job| job.has_parameter(&name.node)).peekable();
    if owners.peek().is_some() {
        return outer.check_owners(context, name, owners);
    }
    // a parameter whose value is wrong is not among those of its job
    if context.taken.contains(&name.span.file) {
        return;
    }
    let mut axes = jobs.clone().flat_map(|job| job.machines.iter().map(move |machine| (job, machine)));
    let is_axis = axes.any(|(job, machine)| {
        let is_one = |name: &str| machine.axes.iter().any(|axis| name == format!("{}.{}", machine.name, axis.name));
        is_one(&name.node) || within(&name.node, &job.name).is_some_and(is_one)
    });
    if is_axis {
        let message = format!("`{}` is an axis, not a parameter: it follows its law", name.node);
        let help = "set a parameter that its law is made of, or write the law into the spec";
        return context.report(Diagnostic::new(Code::WrongKind, name.span, message).help(help));
    }
    // with a job's name before it where the name begins so
    let known = jobs.flat_map(|job| {
        let of_job = within(&name.node, &job.name).map_or(String::new(), |_| format!("{}.", job.name));
        job.parameters.iter().map(move |parameter| format!("{of_job}{}", parameter.name))
    });
    let known: Vec<String> = known.collect();
    context.unknown(name, "parameter", known.iter().map(String::as_str));
}

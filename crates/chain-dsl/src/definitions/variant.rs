//! A job that is another one with values or parts changed, `job plain = crowned(infeed: 0 mm, m.swivel: 3 deg, h: worn_hob)`, or with
//! statements of its own, `job pair extends gear { … }`.

use std::collections::{HashMap, HashSet};

use crate::definitions::machine::{Machines, axes_with_laws};
use crate::definitions::tool::Tools;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::syntax::ast::{
    Argument, Change, Expected, ExpressionKind, Instance, Job, JobStatement, MachineStatement, Subject, ToolStatement,
    Variant,
};
use crate::values::context::{Context, suggesting};

/// The job that a variant of an earlier one stands for.
pub(crate) fn expanded(
    context: &mut Context<'_>,
    definitions: (&Machines, &Tools),
    variant: &Variant,
    parent: &Job,
) -> Job {
    let mut job = changed(context, definitions, &variant.changes, parent);
    job.name = variant.name.clone();
    if !variant.doc.is_empty() {
        job.doc = variant.doc.clone();
    }
    job
}

fn changed(context: &mut Context<'_>, (machines, tools): (&Machines, &Tools), changes: &[Change], parent: &Job) -> Job {
    let mut job = parent.clone();
    for (k, change) in changes.iter().enumerate() {
        let same = |earlier: &&Change| names(earlier).eq(names(change));
        match changes[..k].iter().find(same) {
            Some(first) => {
                let message = format!("`{}` is changed twice", names(change).collect::<Vec<_>>().join("."));
                let twice = Diagnostic::new(Code::DuplicateName, change.target.span, message);
                context.report(twice.note(first.target.span, "first here"));
            }
            None => drop(made(context, (machines, tools), &mut job, (change, &parent.name.node))),
        }
    }
    let is_another =
        |instance: &&Instance| changes.iter().any(|change| names(change).eq([instance.name.node.as_str()]));
    let others: Vec<Instance> = machines_of(&job).filter(is_another).cloned().collect();
    without_laws(context, machines, job, &others.iter().collect::<Vec<_>>())
}

/// A job with the statements of the earlier one that it extends, in which values and parts may be changed: one of its own that is about the
/// same takes the place of one of those. Others come before the next one that does, or at the end.
pub(crate) fn extended(
    context: &mut Context<'_>,
    (machines, tools): (&Machines, &Tools),
    job: &Job,
    parent: &Job,
) -> Job {
    let parent = without_replaced(changed(context, (machines, tools), &job.changes, parent), job);
    let parent = without_laws(context, machines, parent, &machines_of(job).collect::<Vec<_>>());
    let mut places: HashMap<(Subject, String), usize> = HashMap::new();
    for (place, statement) in parent.statements.iter().enumerate() {
        places.extend(statement.about().into_iter().map(|about| (about, place)));
    }
    // what stands in the place of each of the parent's statements
    let mut inherited: Vec<Vec<JobStatement>> =
        parent.statements.into_iter().map(|statement| vec![statement]).collect();
    let mut added = Vec::new();
    for own in &job.statements {
        let about = own.about();
        // what the job itself says twice is reported where it is built
        let replaced: Vec<usize> = about.iter().filter_map(|about| places.remove(about)).collect();
        added.push(own.clone());
        for place in &replaced {
            inherited[*place] =
                inherited[*place].drain(..).filter_map(|there| there.without(|it| about.contains(it))).collect();
        }
        if let Some(first) = replaced.iter().min() {
            inherited[*first].append(&mut added);
        }
    }
    let doc = if job.doc.is_empty() { parent.doc } else { job.doc.clone() };
    Job { doc, statements: inherited.into_iter().flatten().chain(added).collect(), ..job.clone() }
}

fn machines_of(job: &Job) -> impl Iterator<Item = &Instance> {
    job.statements.iter().filter_map(|statement| match statement {
        JobStatement::Machine(instance) => Some(instance),
        _ => None,
    })
}

/// Without laws of axes whose motion the machines that take the place of others of the job give themselves; so does one that is such a
/// machine under a second name.
fn without_laws(context: &mut Context<'_>, machines: &Machines, mut job: Job, others: &[&Instance]) -> Job {
    let names: HashSet<&str> = machines_of(&job).map(|known| known.name.node.as_str()).collect();
    let added = others.iter().copied().filter(|other| !names.contains(other.name.node.as_str()));
    let other: HashMap<&str, &Instance> = others.iter().map(|other| (other.name.node.as_str(), *other)).collect();
    let inherited = machines_of(&job).map(|known| other.get(known.name.node.as_str()).copied().unwrap_or(known));
    // what each is one of, and whether that is another machine than it was
    let mut known: HashMap<&str, (&str, bool)> = HashMap::new();
    let mut fallen = HashSet::new();
    for Instance { name, definition, .. } in added.chain(inherited) {
        let (of, follows) = known.get(definition.node.as_str()).copied().unwrap_or((&definition.node, false));
        let is_another = follows || other.contains_key(name.node.as_str());
        known.insert(&name.node, (of, is_another));
        if is_another {
            let axes = axes_with_laws(context, machines, of);
            fallen.extend(axes.into_iter().map(|axis| (Subject::Axis, format!("{}.{axis}", name.node))));
        }
    }
    job.statements =
        job.statements.into_iter().filter_map(|statement| statement.without(|it| fallen.contains(it))).collect();
    job
}

/// Without expectations that a job which extends it replaces by its own about the same, or drops.
fn without_replaced(mut parent: Job, job: &Job) -> Job {
    let own = |statement: &JobStatement| match statement {
        JobStatement::Expect(expected) => Some(expected.clone()),
        _ => None,
    };
    let own: Vec<_> = job.statements.iter().filter_map(own).collect();
    let drops = own.iter().any(|expected| expected.what == Expected::Nothing);
    parent.statements.retain(|statement| match statement {
        JobStatement::Expect(earlier) => !drops && own.iter().all(|expected| expected.about != earlier.about),
        _ => true,
    });
    parent
}

fn names(change: &Change) -> impl Iterator<Item = &str> {
    change.target.segments.iter().map(|segment| segment.node.as_str())
}

/// Makes one change; nothing if there is nothing to change, which is reported.
fn made(
    context: &mut Context<'_>,
    definitions: (&Machines, &Tools),
    job: &mut Job,
    (change, parent): (&Change, &str),
) -> Option<()> {
    let (name, rest) = change.target.segments.split_first()?;
    let known: Vec<String> = job.statements.iter().filter_map(changeable).map(str::to_string).collect();
    let of_parts = settings_called(&name.node, job, definitions);
    let statement = job.statements.iter_mut().find(|statement| changeable(statement) == Some(&name.node));
    match (statement, rest) {
        (Some(JobStatement::Param(param)), []) => param.default = Some(change.value.clone()),
        (Some(JobStatement::Machine(instance) | JobStatement::Tool(instance)), [setting]) => {
            instance.settings.retain(|given| given.name.as_ref().is_none_or(|name| name.node != setting.node));
            instance.settings.push(Argument { name: Some(setting.clone()), value: change.value.clone() });
        }
        (Some(JobStatement::Machine(instance) | JobStatement::Tool(instance)), []) => {
            replace(context, instance, change)?;
        }
        (None, _) => {
            let message = format!("job `{parent}` has no parameter, machine or tool `{}`", name.node);
            let diagnostic = Diagnostic::new(Code::UnknownName, name.span, message);
            let written: Vec<String> = of_parts.iter().map(|setting| format!("`{setting}`")).collect();
            context.report(if written.is_empty() || !rest.is_empty() {
                suggesting(diagnostic, name, known.iter().map(String::as_str))
            } else {
                let meant = diagnostic.help(format!("did you mean {}?", written.join(" or ")));
                of_parts
                    .iter()
                    .fold(meant, |meant, setting| meant.cure(format!("write `{setting}`"), name.span, setting))
            });
        }
        _ => {
            let message = format!("`{}` has no settings of its own", name.node);
            let help = "change a parameter by its name, a setting as `m.swivel`";
            context.report(Diagnostic::new(Code::WrongKind, change.target.span, message).help(help));
        }
    }
    Some(())
}

/// The settings of a job's machines and tools that are called so: `b.radius`.
fn settings_called(name: &str, job: &Job, (machines, tools): (&Machines, &Tools)) -> Vec<String> {
    let of_machine = |definition: &str| {
        let mut next = machines.get(definition);
        // machines may extend each other in a circle
        for _ in 0..machines.len() {
            let Some(machine) = next else { return false };
            let is_called = |statement: &MachineStatement| matches!(statement, MachineStatement::Param(param) if param.name.node == name);
            if machine.statements.iter().any(is_called) {
                return true;
            }
            next = machine.extends.as_ref().and_then(|parent| machines.get(&parent.node));
        }
        false
    };
    let of_tool = |definition: &str| {
        let is_called =
            |statement: &ToolStatement| matches!(statement, ToolStatement::Param(param) if param.name.node == name);
        tools.get(definition).is_some_and(|tool| tool.statements.iter().any(is_called))
    };
    let has_it = |statement: &JobStatement| match statement {
        JobStatement::Machine(instance) if of_machine(&instance.definition.node) => {
            Some(format!("{}.{name}", instance.name.node))
        }
        JobStatement::Tool(instance) if of_tool(&instance.definition.node) => {
            Some(format!("{}.{name}", instance.name.node))
        }
        _ => None,
    };
    job.statements.iter().filter_map(has_it).collect()
}

/// The name of what a variant can change.
fn changeable(statement: &JobStatement) -> Option<&str> {
    match statement {
        JobStatement::Param(param) => Some(&param.name.node),
        JobStatement::Machine(instance) | JobStatement::Tool(instance) => Some(&instance.name.node),
        _ => None,
    }
}

/// Another machine or tool in the place of one.
fn replace(context: &mut Context<'_>, instance: &mut Instance, change: &Change) -> Option<()> {
    let (definition, settings) = match &change.value.kind {
        ExpressionKind::Path(path) if path.segments.len() == 1 => (path.segments[0].clone(), Vec::new()),
        ExpressionKind::Call(call) => (call.function.clone(), call.arguments.clone()),
        ExpressionKind::Error => return None,
        _ => {
            let message = format!("`{}` is a machine or a tool", instance.name.node);
            let help = format!("name another one: `{}: definition(setting: …)`", instance.name.node);
            context.report(Diagnostic::new(Code::WrongKind, change.value.span, message).help(help));
            return None;
        }
    };
    (instance.definition, instance.settings) = (definition, settings);
    Some(())
}

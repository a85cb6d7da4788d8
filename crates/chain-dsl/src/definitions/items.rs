//! What the texts define, by name: machines, tools, and the jobs, those that are made from others made.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use crate::definitions::machine::Machines;
use crate::definitions::tool::Tools;
use crate::definitions::variant;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{FileId, Name, Span};
use crate::syntax::ast::{self, Item};
use crate::values::context::{Context, suggesting};
use crate::values::functions;

/// The items of all files by name.
#[derive(Default)]
pub(crate) struct Items {
    pub(crate) machines: Machines,
    pub(crate) tools: Tools,
    pub(crate) jobs: Vec<JobItem>,
}

/// A job, and the file that it stands in.
pub(crate) struct JobItem {
    pub(crate) file: FileId,
    pub(crate) job: ast::Job,
    /// The jobs above it that it is made from.
    pub(crate) made_from: Vec<Span>,
}

impl Items {
    pub(crate) fn collect(context: &mut Context<'_>, files: &[(FileId, Arc<ast::File>)], is_beside: bool) -> Items {
        /// Of a machine that is an edited copy of one that the job uses.
        const APART: &str = "a job and the machine that it is carried over to are read together, and a name means one thing in both: give \
                             it another name in one of the files";
        let mut items = Items::default();
        let mut seen: HashMap<String, Span> = HashMap::new();
        for (_, parsed) in files {
            for item in &parsed.items {
                let Some(name) = item.name() else { continue };
                if let Some(first) = seen.insert(name.node.clone(), name.span) {
                    let is_apart = is_beside && first.file != name.span.file;
                    context.duplicate_with(name, first, is_apart.then_some(APART));
                }
                items.define(context, item);
            }
        }
        // jobs that are made from others may name machines that are defined below them
        for (file, item) in files.iter().flat_map(|(file, parsed)| parsed.items.iter().map(|item| (*file, item))) {
            items.add_job(context, file, item);
        }
        items
    }

    /// Of two with one name, which is reported, the first is meant.
    fn define(&mut self, context: &mut Context<'_>, item: &Item) {
        match item {
            Item::Use(_) | Item::Job(_) | Item::Variant(_) => {}
            Item::Function(function) => {
                if functions::names().any(|known| known == function.name.node) {
                    let message = format!("`{}` is a function of the language", function.name.node);
                    context.report(Diagnostic::new(Code::DuplicateName, function.name.span, message));
                } else {
                    let first = context.functions.entry(function.name.node.clone());
                    first.or_insert_with(|| Rc::new(function.clone()));
                }
            }
            Item::Machine(machine) => {
                self.machines.entry(machine.name.node.clone()).or_insert_with(|| machine.clone());
            }
            Item::Tool(tool) => {
                self.tools.entry(tool.name.node.clone()).or_insert_with(|| tool.clone());
            }
        }
    }

    fn add_job(&mut self, context: &mut Context<'_>, file: FileId, item: &Item) {
        match item {
            Item::Use(_) | Item::Function(_) | Item::Machine(_) | Item::Tool(_) => {}
            Item::Job(job) => {
                let Some(parent) = &job.extends else {
                    return self.jobs.push(JobItem { file, job: job.clone(), made_from: Vec::new() });
                };
                self.add_made(context, file, (&job.name, parent), |context, definitions, parent| {
                    variant::extended(context, definitions, job, parent)
                });
            }
            Item::Variant(variant) => {
                self.add_made(context, file, (&variant.name, &variant.parent), |context, definitions, parent| {
                    variant::expanded(context, definitions, variant, parent)
                });
            }
        }
    }

    /// Adds a job that is made from one above it.
    fn add_made<'g>(
        &mut self,
        context: &mut Context<'g>,
        file: FileId,
        (name, parent): (&Name, &Name),
        make: impl FnOnce(&mut Context<'g>, (&Machines, &Tools), &ast::Job) -> ast::Job,
    ) {
        /// Bytes of a job that cost as much as a step of evaluation: what is made of it is a copy.
        const BYTES_A_STEP: usize = 2;
        context.begin_item();
        let Some(JobItem { job: found, made_from, .. }) =
            self.jobs.iter().find(|item| item.job.name.node == parent.node)
        else {
            // the parser has reported a missing name, and a file that is not there may hold the job
            if !parent.node.is_empty() && !context.lacks_files && context.tells_more() {
                let above = self.jobs.iter().map(|item| item.job.name.node.as_str());
                let message = format!("there is no job `{}` above this one", parent.node);
                context.report(suggesting(Diagnostic::new(Code::UnknownName, parent.span, message), parent, above));
            }
            return;
        };
        let made_from: Vec<Span> = made_from.iter().copied().chain([found.span]).collect();
        let bytes: usize = made_from.iter().map(|span| (span.end - span.start) as usize).sum();
        if context.spend(bytes / BYTES_A_STEP, name.span) {
            let job = make(context, (&self.machines, &self.tools), found);
            self.jobs.push(JobItem { file, job, made_from });
        }
    }
}

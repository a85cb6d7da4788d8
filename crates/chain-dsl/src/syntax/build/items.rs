//! Items.

use pest::iterators::Pair;

use crate::diagnostics::source::{Name, Spanned};

use super::super::ast::{Change, Function, Item, Job, Let, Machine, Tool, Type, Variant};
use super::super::grammar::Rule;
use super::{Build, Parts};

/// What stands before the opening brace of a machine, tool or job.
pub(in super::super) struct Head {
    pub(in super::super) doc: Vec<String>,
    pub(in super::super) name: Name,
    pub(in super::super) extends: Option<Name>,
    /// Of a job that extends another one, what it changes of that.
    pub(in super::super) changes: Vec<Change>,
}

impl Build<'_> {
    /// An item; nothing for the end of the file.
    pub(in super::super) fn item(&mut self, pair: Pair<'_, Rule>) -> Option<Item> {
        Some(match pair.as_rule() {
            Rule::use_item => Item::Use(self.text(Parts::of(pair).required(Rule::string))),
            Rule::function => Item::Function(self.function(pair)),
            Rule::machine => Item::Machine(self.machine(pair)),
            Rule::tool => Item::Tool(self.tool(pair)),
            Rule::job => Item::Job(self.job(pair)),
            Rule::variant => Item::Variant(self.variant(pair)),
            _ => return None,
        })
    }

    /// The text between quotes.
    pub(super) fn text(&self, pair: Pair<'_, Rule>) -> Spanned<String> {
        let text = pair.as_str();
        Spanned { node: text[1..text.len() - 1].to_owned(), span: self.span(&pair) }
    }

    fn function(&mut self, pair: Pair<'_, Rule>) -> Function {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        Function {
            doc,
            name: self.name(parts.required(Rule::name)),
            arguments: parts.all(Rule::formal).into_iter().map(|formal| self.formal(formal)).collect(),
            result: parts.optional(Rule::value_type).map(|written| self.value_type(written)),
            lets: self.lets(parts.all(Rule::let_statement)),
            body: self.expression(parts.required(Rule::expression)),
        }
    }

    fn formal(&mut self, pair: Pair<'_, Rule>) -> (Name, Type) {
        let mut parts = Parts::of(pair);
        (self.name(parts.required(Rule::name)), self.value_type(parts.required(Rule::value_type)))
    }

    fn value_type(&mut self, pair: Pair<'_, Rule>) -> Type {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let dimension = self.dimension(parts.required(Rule::dimension));
        let size = parts.optional(Rule::size).map(|pair| self.size(Parts::of(pair).required(Rule::integer)));
        Type { dimension, size, span }
    }

    fn size(&mut self, pair: Pair<'_, Rule>) -> usize {
        // what is too long for a number is too long for any vector
        let size = pair.as_str().parse().unwrap_or(usize::MAX);
        if size == 0 {
            self.report(
                self.span(&pair),
                "a vector has at least one element",
                "say how many, such as `length[3]` for three lengths",
            );
        }
        size
    }

    fn lets(&mut self, pairs: Vec<Pair<'_, Rule>>) -> Vec<Let> {
        pairs.into_iter().map(|pair| self.let_statement(pair)).collect()
    }

    pub(in super::super) fn head(&mut self, pair: Pair<'_, Rule>) -> Head {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        let (extends, changes) = match parts.optional(Rule::variant_of) {
            Some(parent) => {
                let (parent, changes) = self.variant_of(parent);
                (Some(parent), changes)
            }
            None => (parts.optional(Rule::name).map(|name| self.name(name)), Vec::new()),
        };
        Head { doc, name, extends, changes }
    }

    fn machine(&mut self, pair: Pair<'_, Rule>) -> Machine {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let Head { doc, name, extends, .. } = self.first_head(&mut parts);
        Machine {
            doc,
            name,
            extends,
            statements: parts.filter_map(|part| self.machine_statement(part)).collect(),
            span,
        }
    }

    fn tool(&mut self, pair: Pair<'_, Rule>) -> Tool {
        let mut parts = pair.into_inner();
        let Head { doc, name, .. } = self.first_head(&mut parts);
        Tool { doc, name, statements: parts.filter_map(|part| self.tool_statement(part)).collect() }
    }

    fn job(&mut self, pair: Pair<'_, Rule>) -> Job {
        let span = self.span(&pair);
        let mut parts = pair.into_inner();
        let Head { doc, name, extends, changes } = self.first_head(&mut parts);
        let statements = parts.filter_map(|part| self.job_statement(part)).collect();
        Job { doc, name, extends, changes, statements, span, is_closed: true }
    }

    fn variant(&mut self, pair: Pair<'_, Rule>) -> Variant {
        let doc = self.doc(&pair);
        let mut parts = Parts::of(pair);
        let name = self.name(parts.required(Rule::name));
        let (parent, changes) = self.variant_of(parts.required(Rule::variant_of));
        Variant { doc, name, parent, changes }
    }

    fn variant_of(&mut self, pair: Pair<'_, Rule>) -> (Name, Vec<Change>) {
        let mut parts = Parts::of(pair);
        let parent = self.name(parts.required(Rule::name));
        let changes = parts.optional(Rule::changes).map_or_else(Vec::new, |changes| {
            Parts::of(changes).all(Rule::change).into_iter().map(|change| self.change(change)).collect()
        });
        (parent, changes)
    }

    fn change(&mut self, pair: Pair<'_, Rule>) -> Change {
        let mut parts = Parts::of(pair);
        let target = self.path(parts.required(Rule::path));
        Change { target, value: self.expression(parts.required(Rule::expression)) }
    }

    fn first_head(&mut self, parts: &mut pest::iterators::Pairs<'_, Rule>) -> Head {
        let head = parts.next().unwrap_or_else(|| unreachable!("the grammar has a head here"));
        self.head(head)
    }
}

//! What belongs to what: the names of machines, tools, jobs, profiles and surfaces.

use std::collections::HashMap;

use super::{Entry, Index, NameKind, Symbol, SymbolId, Target, WordKind};
use crate::diagnostics::source::{Name, Span};
use crate::limits;
use crate::syntax::ast::{Argument, ExpressionKind};

/// Lines on surfaces that have no name of their own.
const LINES: [&str; 3] = ["singular_line", "contact_limit", "trim_line"];

/// What a definition holds.
#[derive(Default)]
pub(super) struct Members<'a> {
    /// Values, or all names of a job.
    pub(super) names: HashMap<&'a str, SymbolId>,
    /// Frames of a machine, surfaces of a tool.
    pub(super) others: HashMap<&'a str, SymbolId>,
    /// What it extends.
    pub(super) parent: Option<SymbolId>,
    /// Settings of an instance.
    pub(super) settings: &'a [Argument],
    /// The machines and tools that a variant puts in the place of those of its parent, with their settings.
    pub(super) replaced: Vec<(&'a str, SymbolId, &'a [Argument])>,
    /// The surfaces that a surface is made from.
    pub(super) made_from: Vec<SymbolId>,
    /// The profile that a surface of a tool runs along.
    pub(super) along: Option<SymbolId>,
    /// The instance through which a surface of a tool was named.
    pub(super) through: Option<SymbolId>,
}

/// Which of the names of a machine or tool come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Value,
    /// A frame, or a surface.
    Other,
}

/// The index while it is made.
#[derive(Default)]
pub(super) struct Names<'a> {
    pub(super) index: Index,
    pub(super) globals: HashMap<&'a str, SymbolId>,
    pub(super) members: HashMap<SymbolId, Members<'a>>,
    /// Coordinates that the samples of a job define.
    pub(super) coordinates: Vec<(&'a str, SymbolId)>,
    /// Functions of the language, sorted; empty until one is looked for.
    pub(super) functions: Vec<&'static str>,
}

impl<'a> Names<'a> {
    /// A definition without further parts.
    pub(super) fn define(&mut self, kind: NameKind, name: &'a Name, extent: Span, owner: Option<SymbolId>) -> SymbolId {
        let id = SymbolId(self.index.symbols.len() as u32);
        let none = None;
        self.index.symbols.push(Symbol {
            kind,
            name: name.span,
            extent: name.span.to(extent),
            owner,
            restates: none,
            dimension: None,
            range: None,
            value: None,
            definition: none,
        });
        self.enter(name.span, Target::Symbol(id), true);
        id
    }

    pub(super) fn enter(&mut self, span: Span, target: Target, is_definition: bool) {
        // the parser has reported a missing name
        if span.start < span.end {
            self.index.entries.push(Entry { span, target, is_definition });
        }
    }

    pub(super) fn word(&mut self, span: Span, kind: WordKind) {
        self.enter(span, Target::Word(kind), false);
    }

    /// A use of a name, which may lead nowhere.
    pub(super) fn refer(&mut self, name: &Name, found: Option<SymbolId>, wanted: NameKind) -> Option<SymbolId> {
        self.enter(name.span, found.map_or(Target::Missing(wanted), Target::Symbol), false);
        found
    }

    pub(super) fn symbol_mut(&mut self, id: SymbolId) -> &mut Symbol {
        &mut self.index.symbols[id.0 as usize]
    }

    pub(super) fn kind(&self, id: SymbolId) -> NameKind {
        self.index.symbol(id).kind
    }

    /// A machine, tool, job or function.
    pub(super) fn global(&self, name: &str, kind: NameKind) -> Option<SymbolId> {
        self.globals.get(name).copied().filter(|id| self.kind(*id) == kind)
    }

    /// A definition and all that it extends.
    fn line(&self, id: SymbolId) -> impl Iterator<Item = &Members<'a>> {
        let first = self.members.get(&id);
        let next = |members: &&Members<'a>| members.parent.and_then(|parent| self.members.get(&parent));
        std::iter::successors(first, next).take(limits::EXTENDS_DEPTH.most)
    }

    /// A name of a machine, a tool or a job, its own or that of what it extends.
    pub(super) fn inside(&self, id: SymbolId, name: &str, wanted: Wanted) -> Option<SymbolId> {
        let value = self.line(id).find_map(|members| members.names.get(name)).copied();
        let other = || self.line(id).find_map(|members| members.others.get(name)).copied();
        match wanted {
            Wanted::Value => value.or_else(other),
            Wanted::Other => other().or(value),
        }
    }

    /// The machine or tool of an instance as a job sees it, with the settings there.
    pub(super) fn instance(
        &self,
        job: Option<SymbolId>,
        id: SymbolId,
        name: &str,
    ) -> (Option<SymbolId>, &'a [Argument]) {
        let replaced = job.into_iter().flat_map(|job| self.line(job)).find_map(|members| {
            // what a job states itself comes after what it changes of its parent
            if members.names.get(name) == Some(&id) {
                return Some(None);
            }
            let found = members.replaced.iter().find(|(replaced, ..)| *replaced == name);
            found.map(|(_, definition, settings)| Some((Some(*definition), *settings)))
        });
        let own = || (self.index.symbol(id).definition, self.members.get(&id).map_or(&[][..], |of| of.settings));
        replaced.flatten().unwrap_or_else(own)
    }

    /// What a name behind a dot leads to.
    pub(super) fn member(
        &self,
        job: Option<SymbolId>,
        of: SymbolId,
        owner: &str,
        name: &str,
        wanted: Wanted,
    ) -> Target {
        let symbol = |found: Option<SymbolId>, kind| found.map_or(Target::Missing(kind), Target::Symbol);
        match self.kind(of) {
            NameKind::MachineInstance => {
                let kind = if wanted == Wanted::Value { NameKind::Parameter } else { NameKind::Frame };
                let machine = self.instance(job, of, owner).0;
                symbol(machine.and_then(|machine| self.inside(machine, name, wanted)), kind)
            }
            NameKind::ToolInstance => {
                let tool = self.instance(job, of, owner).0;
                symbol(tool.and_then(|tool| self.inside(tool, name, wanted)), NameKind::ToolSurface)
            }
            NameKind::Job => symbol(self.inside(of, name, wanted), NameKind::Surface),
            NameKind::Profile => {
                let found = self.members.get(&of).and_then(|members| members.names.get(name)).copied();
                symbol(found, NameKind::Segment)
            }
            NameKind::Segment if ["from", "to"].contains(&name) => Target::Word(WordKind::Number),
            NameKind::Contact | NameKind::Solid => Target::Word(WordKind::Number),
            NameKind::Surface | NameKind::ToolSurface | NameKind::Sample => {
                let found = self.piece(of, name, 0);
                match found {
                    None if LINES.contains(&name) => Target::Word(WordKind::Number),
                    found => symbol(found, NameKind::Segment),
                }
            }
            _ => Target::Missing(NameKind::Value),
        }
    }

    /// The segment that a piece of a surface runs along.
    pub(super) fn piece(&self, surface: SymbolId, name: &str, depth: usize) -> Option<SymbolId> {
        let members = self.members.get(&surface).filter(|_| depth < limits::EXTENDS_DEPTH.most)?;
        if let Some(along) = members.along
            && let Some(found) = self.segment(along, members.through, name)
        {
            return Some(found);
        }
        members.made_from.iter().find_map(|from| self.piece(*from, name, depth + 1))
    }

    /// A segment of a profile, which may be a setting of an instance.
    pub(super) fn segment(&self, profile: SymbolId, through: Option<SymbolId>, name: &str) -> Option<SymbolId> {
        if self.kind(profile) == NameKind::Profile {
            return self.members.get(&profile)?.names.get(name).copied();
        }
        let instance = through?;
        let job = self.index.symbol(instance).owner?;
        let of = self.index.symbol(profile).name;
        let settings = self.members.get(&instance)?.settings;
        let setting = settings.iter().find(|setting| self.names_parameter(setting, of, instance))?;
        let ExpressionKind::Path(path) = &setting.value.kind else { return None };
        let given = self.inside(job, &path.segments.first()?.node, Wanted::Value)?;
        self.members.get(&given)?.names.get(name).copied()
    }

    /// Whether a setting is that of a parameter.
    fn names_parameter(&self, setting: &Argument, parameter: Span, instance: SymbolId) -> bool {
        let definition = self.index.symbol(instance).definition;
        let found =
            setting.name.as_ref().zip(definition).and_then(|(name, of)| self.inside(of, &name.node, Wanted::Value));
        found.is_some_and(|found| self.index.symbol(found).name == parameter)
    }

    /// A parameter of the tools' surfaces that a surface is made from.
    pub(super) fn unknown(&self, surface: SymbolId, name: &str, depth: usize) -> Option<SymbolId> {
        let members = self.members.get(&surface).filter(|_| depth < limits::EXTENDS_DEPTH.most)?;
        let own = members.names.get(name).copied();
        own.or_else(|| members.made_from.iter().find_map(|from| self.unknown(*from, name, depth + 1)))
    }
}

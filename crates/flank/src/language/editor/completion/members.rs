//! What stands behind a dot, and paths with one.

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{NameKind, Span, SymbolId, Target};

use super::{Around, CompletionKind, List};
use crate::language::editor::analysis::Analysis;
use crate::language::editor::cursor::Cursor;

/// Values of a machine or a tool.
const VALUES: [NameKind; 3] = [NameKind::Parameter, NameKind::MachineError, NameKind::Value];

impl Analysis {
    /// What stands behind a dot.
    pub(super) fn members_at(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        let path = path_before(cursor);
        let Some((first, rest)) = path.split_first() else { return };
        // `job plain = crowned(m.…`: of the job that is changed
        let called = cursor.call().and_then(|call| self.definition_named(around, call.name));
        let changed = called.filter(|id| self.kind(*id) == NameKind::Job);
        if changed.is_some() && rest.is_empty() {
            let settings = self.named(changed, first).map(|of| self.members_of(of)).unwrap_or_default();
            let is_setting = |id: &SymbolId| matches!(self.kind(*id), NameKind::Parameter | NameKind::MachineError);
            for id in settings.into_iter().filter(is_setting) {
                let name = self.name(id);
                list.add_text(name, CompletionKind::Setting, self.signature(id), format!("{name}: "), 0);
            }
            return;
        }
        // another job's names may be asked for
        let mut at = self.named(around.item, first).or_else(|| self.items().find(|id| self.name(*id) == *first));
        let mut through = None;
        for name in rest {
            let Some(of) = at else { return };
            through = (self.kind(of) == NameKind::ToolInstance).then_some(of).or(through);
            at = self.members_of(of).into_iter().find(|id| self.name(*id) == *name);
        }
        let Some(id) = at else { return };
        let members = self.members_of(id);
        let before_path = cursor.before.len().checked_sub(2 * path.len() + 1).map(|at| cursor.before[at]);
        let is_generated = cursor.call().is_some_and(|call| ["envelope", "sweep", "move"].contains(&call.name));
        let is_driven = cursor.opening() == "drive" && !cursor.statement.contains(&"=");
        match self.kind(id) {
            NameKind::MachineInstance if is_driven => {
                let free = self.free_axes(around.item, first, id, cursor.word);
                list.symbols(free, &[NameKind::Axis], 0);
            }
            NameKind::MachineInstance if matches!(before_path, Some("on" | "in")) => {
                list.symbols(members, &[NameKind::Frame], 0);
            }
            NameKind::ToolInstance if is_generated => list.symbols(members, &[NameKind::ToolSurface], 0),
            NameKind::ToolInstance => {
                list.symbols(members.iter().copied(), &[NameKind::ToolSurface], 0);
                list.symbols(members, &[NameKind::Parameter, NameKind::Value, NameKind::Profile], 1);
            }
            // points have no axes, and what is expected of them follows from points
            NameKind::MachineInstance if self.is_of_points(cursor, around) => list.symbols(members, &VALUES, 0),
            NameKind::MachineInstance => {
                list.symbols(members.iter().copied(), &VALUES, 0);
                list.symbols(members, &[NameKind::Axis, NameKind::Frame], 1);
            }
            NameKind::Segment => list.words(&["from", "to"], CompletionKind::Keyword, "end of the segment", 0),
            NameKind::Contact => list.words(&vocabulary().of_contacts, CompletionKind::Keyword, "of the contact", 0),
            NameKind::Solid => list.words(&vocabulary().of_solids, CompletionKind::Keyword, "of the body", 0),
            _ => list.symbols(members, &[NameKind::Segment, NameKind::Surface, NameKind::Parameter], 0),
        }
    }

    /// What may be named behind a name and a dot.
    fn members_of(&self, id: SymbolId) -> Vec<SymbolId> {
        match self.kind(id) {
            NameKind::MachineInstance | NameKind::ToolInstance => {
                self.index.symbol(id).definition.map(|of| self.members(of)).unwrap_or_default()
            }
            NameKind::ToolSurface | NameKind::Surface | NameKind::Sample => self.pieces(id, 0),
            NameKind::Parameter => {
                self.index.uses(id).find_map(|entry| self.given_profile(entry.span)).unwrap_or_default()
            }
            _ => self.members(id),
        }
    }

    /// The segments of the profile that a surface runs along, or those surfaces that it is made from.
    fn pieces(&self, surface: SymbolId, depth: usize) -> Vec<SymbolId> {
        if self.kind(surface) == NameKind::ToolSurface {
            let along = self.unknowns_of(surface).into_iter().find_map(|id| self.profile_along(id));
            return along.map(|profile| self.members_of(profile)).unwrap_or_default();
        }
        let from = self.made_from(surface).filter(|_| depth < 8);
        from.map(|from| self.pieces(from, depth + 1)).unwrap_or_default()
    }

    /// The profile that a parameter of a surface runs along.
    fn profile_along(&self, parameter: SymbolId) -> Option<SymbolId> {
        let symbol = self.index.symbol(parameter);
        let entry = self.index.at(symbol.dimension?.file, symbol.dimension?.start)?;
        match entry.target {
            Target::Symbol(id) if self.kind(id) != NameKind::SurfaceParameter => Some(id),
            _ => None,
        }
    }

    /// The segments of the profile that a setting gives, `section: dressed`.
    fn given_profile(&self, setting: Span) -> Option<Vec<SymbolId>> {
        let behind = &self.sources.file(setting.file).text[setting.end as usize..];
        let value = behind.trim_start().strip_prefix(':')?.trim_start();
        let start = setting.end as usize + behind.len() - value.len();
        match self.index.at(setting.file, start as u32)?.target {
            Target::Symbol(id) if self.kind(id) == NameKind::Profile => Some(self.members(id)),
            _ => None,
        }
    }

    /// The surface that a surface or a sample of a job is made from.
    fn made_from(&self, surface: SymbolId) -> Option<SymbolId> {
        let symbol = self.index.symbol(surface);
        // of several in one statement each is made from its own
        let of_statement = |other: &&flank_chain_dsl::Symbol| {
            other.kind == symbol.kind && other.extent.end == symbol.extent.end && other.name.file == symbol.name.file
        };
        let number = self.index.symbols.iter().filter(of_statement).position(|other| other.name == symbol.name)?;
        let kinds = [NameKind::ToolSurface, NameKind::Surface];
        let inside = self.index.entries.iter().filter(|entry| {
            let span = entry.span;
            span.file == symbol.extent.file && (symbol.extent.start..symbol.extent.end).contains(&span.start)
        });
        let named = inside.filter_map(|entry| match entry.target {
            Target::Symbol(id) if !entry.is_definition && kinds.contains(&self.kind(id)) => Some(id),
            _ => None,
        });
        { named }.nth(number)
    }

    /// The parameters of a tool's surface; of several that are written at once the first has them.
    fn unknowns_of(&self, surface: SymbolId) -> Vec<SymbolId> {
        let symbol = self.index.symbol(surface);
        let all = self.index.symbols.iter().zip(0u32..).map(|(symbol, id)| (symbol, SymbolId(id)));
        let alike = all.clone().filter(|(other, _)| {
            other.kind == symbol.kind && other.owner == symbol.owner && other.extent.end == symbol.extent.end
        });
        let alike: Vec<SymbolId> = alike.map(|(_, id)| id).collect();
        let is_own = |owner: Option<SymbolId>| owner.is_some_and(|owner| alike.contains(&owner));
        all.filter(|(other, _)| other.kind == NameKind::SurfaceParameter && is_own(other.owner))
            .map(|(_, id)| id)
            .collect()
    }

    /// Whether something is said of points, or expected, in a job.
    fn is_of_points(&self, cursor: &Cursor<'_>, around: &Around) -> bool {
        let is_expected = cursor.opening() == "expect" && self.stands_in_job(around);
        is_expected || ["sample", "mill"].contains(&cursor.block())
    }

    /// The unknowns of the surfaces that are sampled around a place, or named in what is expected: parameters of their tools' surfaces, and the
    /// motions that they are made over.
    pub(super) fn sampled_unknowns(&self, cursor: &Cursor<'_>, around: &Around) -> Vec<SymbolId> {
        let is_of_points = self.is_of_points(cursor, around);
        let head = match cursor.blocks.last() {
            _ if cursor.opening() == "expect" => &cursor.statement[..],
            Some(block) => &cursor.before[block.first..],
            None => &[],
        };
        let names = head.iter().take_while(|said| **said != "{");
        let (mut found, mut made): (Vec<SymbolId>, Vec<Span>) = Default::default();
        for surface in names.filter_map(|name| self.named(around.item, name)) {
            let mut at = Some(surface);
            for _ in 0..8 {
                let Some(of) = at.filter(|of| self.kind(*of) != NameKind::ToolSurface) else { break };
                made.push(self.index.symbol(of).extent);
                at = self.made_from(of);
            }
            found.extend(at.into_iter().flat_map(|of| self.unknowns_of(of)));
        }
        let is_over = |id: &SymbolId| {
            let is_within = |of: &Span, span: Span| of.file == span.file && (of.start..of.end).contains(&span.start);
            self.index.uses(*id).any(|entry| made.iter().any(|of| is_within(of, entry.span)))
        };
        let motions = around.members.iter().copied().filter(|id| self.kind(*id) == NameKind::Motion);
        found.extend(motions.filter(|id| !is_of_points || is_over(id)));
        found
    }

    /// `m.work`, `c.flank`: members of one kind of all instances of another one.
    pub(super) fn paths(&self, around: &Around, instance: NameKind, kinds: &[NameKind], rank: u8, list: &mut List<'_>) {
        for id in around.members.iter().copied().filter(|id| self.kind(*id) == instance) {
            for member in self.members_of(id).into_iter().filter(|member| kinds.contains(&self.kind(*member))) {
                self.path(id, member, rank, list);
            }
        }
    }

    fn path(&self, instance: SymbolId, member: SymbolId, rank: u8, list: &mut List<'_>) {
        let path = format!("{}.{}", self.name(instance), self.name(member));
        list.add(&path, CompletionKind::Name(self.kind(member)), self.signature(member), rank);
    }

    /// `m.C`: the axes of all machines that nothing drives yet.
    pub(super) fn free_paths(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        for id in around.members.iter().copied().filter(|id| self.kind(*id) == NameKind::MachineInstance) {
            for axis in self.free_axes(around.item, self.name(id), id, cursor.word) {
                self.path(id, axis, 0, list);
            }
        }
    }

    /// Values of all machines and tools of a job.
    pub(super) fn value_paths(&self, around: &Around, rank: u8, list: &mut List<'_>) {
        self.paths(around, NameKind::MachineInstance, &VALUES, rank, list);
        self.paths(around, NameKind::ToolInstance, &VALUES, rank, list);
    }

    /// The axes of a machine that nothing drives, fixes or couples yet.
    pub(super) fn free_axes(
        &self,
        job: Option<SymbolId>,
        instance: &str,
        machine: SymbolId,
        word: usize,
    ) -> Vec<SymbolId> {
        let axes = self.members_of(machine).into_iter().filter(|id| self.kind(*id) == NameKind::Axis);
        let job = job.map(|job| self.index.symbol(job).extent);
        let is_free = |axis: &SymbolId| {
            let symbol = self.index.symbol(*axis);
            let of_unknown = self.before(symbol.name).ends_with("unknown");
            // the one that is being written drives nothing yet, nor one whose machine is
            let is_written = |start: usize| start >= word && !self.text()[word..start].contains(char::is_whitespace);
            let written = self
                .index
                .uses(*axis)
                .filter(|entry| entry.span.file != self.main || !is_written(entry.span.start as usize));
            let is_bound = { written }.any(|entry| {
                let before = self.before(entry.span);
                let in_machine = before.ends_with("fix") || before.ends_with("couple");
                let in_job = job
                    .is_some_and(|job| entry.span.file == job.file && (job.start..job.end).contains(&entry.span.start));
                let line = before.rsplit(['\n', '\r']).next().unwrap_or_default().trim_start();
                let is_driven =
                    line.starts_with("drive") && !line.contains('=') && before.ends_with(&format!("{instance}."));
                in_machine || (in_job && is_driven)
            });
            !of_unknown && !is_bound
        };
        axes.filter(is_free).collect()
    }

    /// The text before a place, without blanks at its end.
    fn before(&self, span: Span) -> &str {
        self.sources.file(span.file).text[..span.start as usize].trim_end()
    }
}

/// The names before the dot at a place.
fn path_before<'t>(cursor: &Cursor<'t>) -> Vec<&'t str> {
    let dots = cursor.before.iter().rev().step_by(2).take_while(|sign| **sign == ".").count();
    let mut path: Vec<&str> = cursor.before.iter().rev().skip(1).step_by(2).take(dots).copied().collect();
    path.reverse();
    path
}

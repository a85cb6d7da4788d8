//! Names that a formula may use.

use flank_chain_dsl::syntax::vocabulary;
use flank_chain_dsl::{NameKind, SymbolId};

use super::locals::locals;
use super::{Around, CompletionKind, List};
use crate::language::editor::analysis::Analysis;
use crate::language::editor::cursor::Cursor;

/// Functions that mean something only where a statement takes them.
const ELSEWHERE: [(&str, &[&str]); 5] = [
    ("profile", &["line", "arc", "spline"]),
    ("surface", &["envelope", "sweep", "move"]),
    ("solid", &["turned", "extruded"]),
    ("want", &["vertex", "about"]),
    (
        "expect",
        &[
            "thickness",
            "span",
            "over_balls",
            "turn",
            "rms",
            "lowest",
            "highest",
            "position",
            "slope",
            "crowning",
            "bias",
            "table",
        ],
    ),
];

impl Analysis {
    /// All that a formula may be made of.
    pub(super) fn expression(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        for name in locals(cursor) {
            list.add(name, CompletionKind::Name(NameKind::Argument), "known here", 0);
        }
        let kinds = self.kinds_of_values(cursor, around);
        let wanted = self.wanted_dimension(cursor, around).filter(|_| cursor.calls.is_empty());
        for id in self.earlier(cursor, around) {
            if kinds.contains(&self.kind(id)) {
                list.symbol(id, u8::from(wanted.as_deref().is_some_and(|wanted| !self.is_of(id, wanted))));
            }
        }
        self.value_paths(around, 2, list);
        self.at_points(cursor, around, list);
        for id in self.items().filter(|id| {
            self.kind(*id) == NameKind::Function && Some(*id) != around.item && self.is_before(*id, cursor)
        }) {
            let name = self.name(id).to_string();
            list.add_text(&name, CompletionKind::Name(NameKind::Function), self.signature(id), format!("{name}("), 2);
        }
        list.functions(&functions_of_formulas(cursor), 3);
        list.add("pi", CompletionKind::Keyword, "number", 3);
    }

    /// What a formula of the statement at a place may name.
    fn kinds_of_values(&self, cursor: &Cursor<'_>, around: &Around) -> Vec<NameKind> {
        let mut kinds = vec![NameKind::Parameter, NameKind::MachineError, NameKind::Value];
        let word = cursor.opening();
        match around.item.map(|item| self.kind(item)) {
            Some(NameKind::Machine) if !["param", "error", "axis", "require"].contains(&word) => {
                kinds.push(NameKind::Axis)
            }
            Some(NameKind::Tool) if cursor.block() == "surface" => kinds.push(NameKind::Profile),
            Some(NameKind::Job) => match word {
                "drive" => kinds.extend([NameKind::Motion, NameKind::Unknown]),
                "let" => kinds.push(NameKind::Motion),
                "tool" => kinds.push(NameKind::Profile),
                "expect" => kinds.extend([NameKind::Contact, NameKind::Solid, NameKind::Surface, NameKind::Sample]),
                _ => {}
            },
            _ => {}
        }
        kinds
    }

    /// Members that are known where a statement stands: what parents say, and what stands before it.
    pub(super) fn earlier(&self, cursor: &Cursor<'_>, around: &Around) -> Vec<SymbolId> {
        around.members.iter().copied().filter(|id| self.is_before(*id, cursor)).collect()
    }

    fn is_before(&self, id: SymbolId, cursor: &Cursor<'_>) -> bool {
        let symbol = self.index.symbol(id);
        let start = cursor.blocks.get(1).map_or(cursor.statement_start(), |block| cursor.starts[block.first]);
        // functions and frames may be used above their definitions
        let is_free = matches!(symbol.kind, NameKind::Function | NameKind::Machine | NameKind::Tool | NameKind::Job);
        let is_own = (start..=cursor.word).contains(&(symbol.name.start as usize));
        symbol.name.file != self.main || (!is_own && (is_free || (symbol.name.start as usize) < start))
    }

    /// Whether a name has the dimension that is wanted, as far as its declaration says.
    fn is_of(&self, id: SymbolId, wanted: &str) -> bool {
        let symbol = self.index.symbol(id);
        symbol.dimension.is_none_or(|span| self.sources.text(span) == wanted)
    }

    /// Coordinates, where something is said of points.
    fn at_points(&self, cursor: &Cursor<'_>, around: &Around, list: &mut List<'_>) {
        let is_expected = cursor.opening() == "expect" && self.stands_in_job(around);
        let is_inside = ["sample", "mill"].contains(&cursor.block()) && defines_coordinate(cursor);
        let is_spline = cursor.call().is_some_and(|call| call.name == "spline") && self.stands_in_job(around);
        if !is_expected && !is_inside && !is_spline {
            return;
        }
        list.words(vocabulary().coordinates, CompletionKind::Keyword, "coordinate of a point", 1);
        if is_expected {
            list.words(&["k1", "k2", "induced_k1", "induced_k2"], CompletionKind::Keyword, "curvature", 1);
        }
        if is_spline {
            list.symbols(around.members.iter().copied(), &[NameKind::Sample, NameKind::Surface], 0);
        }
        list.symbols(self.sampled_unknowns(cursor, around), &[NameKind::SurfaceParameter, NameKind::Motion], 0);
        list.symbols(around.members.iter().copied(), &[NameKind::Coordinate], 0);
    }

    pub(super) fn stands_in_job(&self, around: &Around) -> bool {
        around.item.is_some_and(|item| self.kind(item) == NameKind::Job)
    }
}

/// `depth = 20 mm - rho`: whether what is written says what a coordinate is, and not its values.
fn defines_coordinate(cursor: &Cursor<'_>) -> bool {
    let entry = cursor.statement.rsplit(|said| *said == ",").next().unwrap_or_default();
    let is_listed = cursor.calls.is_empty() && !entry.contains(&":") && entry.contains(&"=");
    is_listed || (!cursor.calls.is_empty() && !cursor.statement.contains(&":") && cursor.statement.contains(&"="))
}

/// Functions of the language, but for those that mean something in other statements only.
fn functions_of_formulas(cursor: &Cursor<'_>) -> Vec<&'static str> {
    let word = if cursor.block() == "profile" { "profile" } else { cursor.opening() };
    let is_other = |name: &str| {
        let of = ELSEWHERE.iter().filter(|(_, names)| names.contains(&name));
        of.clone().count() > 0 && of.clone().all(|(statement, _)| *statement != word)
    };
    let is_frame = ["frame", "insert", "expect"].contains(&word);
    let is_table = |name: &str| name == "table" && cursor.block() == "sample";
    let all = vocabulary().functions.into_iter();
    all.filter(|name| is_table(name) || (!is_other(name) && (is_frame || !is_transform(name)))).collect()
}

/// Whether it moves a frame.
pub(super) fn is_transform(name: &str) -> bool {
    ["translate", "rotate", "mirror"].iter().any(|begin| name.starts_with(begin)) || ["screw", "matrix"].contains(&name)
}

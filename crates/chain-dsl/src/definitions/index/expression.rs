//! The names in expressions, paths and calls.

use super::members::{Names, Wanted};
use super::{NameKind, SymbolId, Target, WordKind};
use crate::diagnostics::source::Name;
use crate::syntax::ast::{Call, Dimension, Expression, ExpressionKind, Path, Range};

/// What every point has, and what samples and milling passes run by.
const OF_POINTS: [&str; 20] = [
    "x",
    "y",
    "z",
    "rho",
    "polar_angle",
    "nx",
    "ny",
    "nz",
    "toe_root",
    "heel_root",
    "toe_tip",
    "heel_tip",
    "lengthwise",
    "profilewise",
    "points",
    "k1",
    "k2",
    "gaussian_curvature",
    "mean_curvature",
    "left",
];

/// What a flank of a blank is asked for by.
pub(crate) const OUTLINE: [&str; 6] = ["toe_root", "heel_root", "toe_tip", "heel_tip", "lengthwise", "profilewise"];

/// Of these, what stands for a point's own before anything of that name in the job: its coordinates, and where it is known its curvatures.
const FIRST: [&str; 8] = ["x", "y", "z", "rho", "polar_angle", "nx", "ny", "nz"];
const CURVATURES: [&str; 4] = ["k1", "k2", "gaussian_curvature", "mean_curvature"];

/// Where an expression stands.
#[derive(Clone, Default)]
pub(super) struct Place<'a> {
    /// The machine, tool or job; none in a function.
    pub(super) item: Option<SymbolId>,
    /// Names that mean something only here, the innermost last.
    pub(super) locals: Vec<(&'a str, SymbolId)>,
    /// The surfaces at whose points it is evaluated.
    pub(super) surfaces: Vec<SymbolId>,
    /// Whether coordinates of points and names of columns mean something.
    pub(super) is_at_points: bool,
    /// Whether it is evaluated at points, where these come before names of the job.
    pub(super) evaluated: At,
}

/// Where an expression is evaluated.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum At {
    /// Once.
    #[default]
    Once,
    /// At points of surfaces.
    Points,
    /// At points whose curvatures are known, too.
    SolvedPoints,
}

impl<'a> Place<'a> {
    pub(super) fn of(item: SymbolId) -> Place<'a> {
        Place { item: Some(item), ..Place::default() }
    }

    /// Whether a name means a coordinate, or a curvature, of the point at which it is evaluated.
    fn is_of_point(&self, name: &str) -> bool {
        let is_known = self.evaluated == At::SolvedPoints && CURVATURES.contains(&name);
        self.evaluated != At::Once && (is_known || FIRST.contains(&name))
    }
}

impl<'a> Names<'a> {
    pub(super) fn expression(&mut self, expression: &'a Expression, place: &mut Place<'a>) {
        match &expression.kind {
            ExpressionKind::Number(_, units) => units.iter().for_each(|(unit, _)| self.word(unit.span, WordKind::Unit)),
            ExpressionKind::Text(_) | ExpressionKind::Error => {}
            ExpressionKind::Path(path) => {
                self.path(path, place, Wanted::Value, NameKind::Value);
            }
            ExpressionKind::Call(call) => self.call(call, place),
            ExpressionKind::Vector(parts) => parts.iter().for_each(|part| self.expression(part, place)),
            ExpressionKind::Unary(_, a) => self.expression(a, place),
            ExpressionKind::Index(a, b) | ExpressionKind::Binary(_, a, b) => {
                [a, b].into_iter().for_each(|part| self.expression(part, place));
            }
            ExpressionKind::If(a, b, c) => [a, b, c].into_iter().for_each(|part| self.expression(part, place)),
            ExpressionKind::Bound(bound) => {
                self.range(&bound.range, place);
                let id = self.define(NameKind::Argument, &bound.name, bound.range.span, place.item);
                self.symbol_mut(id).range = Some(bound.range.span);
                place.locals.push((&bound.name.node, id));
                self.expression(&bound.value, place);
                place.locals.pop();
            }
        }
    }

    pub(super) fn range(&mut self, range: &'a Range, place: &mut Place<'a>) {
        self.expression(&range.low, place);
        self.expression(&range.high, place);
    }

    pub(super) fn dimension(&mut self, dimension: &Dimension) {
        dimension.factors.iter().for_each(|(name, _)| self.word(name.span, WordKind::Dimension));
    }

    /// A name by itself.
    pub(super) fn value(&self, name: &str, place: &Place<'a>) -> Target {
        if let Some((_, id)) = place.locals.iter().rev().find(|(local, _)| *local == name) {
            return Target::Symbol(*id);
        }
        let unknown = || place.surfaces.iter().find_map(|surface| self.unknown(*surface, name, 0));
        if place.is_of_point(name) {
            return Target::Word(WordKind::Coordinate);
        }
        if place.evaluated != At::Once
            && let Some(id) = unknown()
        {
            return Target::Symbol(id);
        }
        let own = place.item.and_then(|item| self.inside(item, name, Wanted::Value));
        let coordinate = || {
            let known = self.coordinates.iter().rev().filter(|_| place.is_at_points);
            known.clone().find(|(known, _)| *known == name).map(|(_, id)| *id)
        };
        match own.or_else(unknown).or_else(coordinate) {
            Some(id) => Target::Symbol(id),
            None if name == "pi" => Target::Word(WordKind::Constant),
            None if place.is_at_points && OF_POINTS.contains(&name) => Target::Word(WordKind::Coordinate),
            None => self.global(name, NameKind::Job).map_or(Target::Missing(NameKind::Value), Target::Symbol),
        }
    }

    /// `a.b.c`: what the last of the names leads to.
    pub(super) fn path(
        &mut self,
        path: &'a Path,
        place: &Place<'a>,
        wanted: Wanted,
        kind: NameKind,
    ) -> Option<SymbolId> {
        let (first, rest) = path.segments.split_first()?;
        let mut found = self.value(&first.node, place);
        if found == Target::Missing(NameKind::Value) {
            found = Target::Missing(if rest.is_empty() { kind } else { NameKind::MachineInstance });
        }
        self.enter(first.span, found, false);
        let mut job = place.item.filter(|item| self.kind(*item) == NameKind::Job);
        let (mut owner, mut through) = (first, None);
        for name in rest {
            found = match found {
                Target::Symbol(of) => {
                    match self.kind(of) {
                        // another job's names
                        NameKind::Job => job = Some(of),
                        NameKind::ToolInstance => through = Some(of),
                        _ => {}
                    }
                    let found = self.member(job, of, &owner.node, &name.node, wanted);
                    let found = if found == Target::Missing(NameKind::Segment) || self.is_set_profile(of) {
                        self.through(of, through, &name.node).map_or(found, Target::Symbol)
                    } else {
                        found
                    };
                    if let Target::Missing(_) = found { Target::Missing(kind) } else { found }
                }
                Target::Word(kind) => Target::Word(kind),
                _ => Target::Missing(kind),
            };
            self.enter(name.span, found, false);
            owner = name;
        }
        if let Target::Symbol(id) = found { Some(id) } else { None }
    }

    /// Whether it is a parameter that may be set to a profile.
    fn is_set_profile(&self, id: SymbolId) -> bool {
        self.kind(id) == NameKind::Parameter
    }

    /// A segment of the profile that an instance has, or that its surface runs along.
    fn through(&self, of: SymbolId, instance: Option<SymbolId>, name: &str) -> Option<SymbolId> {
        match self.kind(of) {
            NameKind::Parameter => self.segment(of, instance, name),
            NameKind::ToolSurface => {
                let along = self.members.get(&of)?.along?;
                self.segment(along, instance, name)
            }
            _ => None,
        }
    }

    pub(super) fn call(&mut self, call: &'a Call, place: &mut Place<'a>) {
        let name = call.function.node.as_str();
        // a table, a grid or a profile that has a name
        let found = match self.value(name, place) {
            Target::Symbol(id) if !matches!(self.kind(id), NameKind::Job | NameKind::Coordinate) => Some(id),
            _ => self.global(name, NameKind::Function),
        };
        match found {
            Some(id) => self.enter(call.function.span, Target::Symbol(id), false),
            None if self.is_function(name) => self.word(call.function.span, WordKind::Function),
            None => self.enter(call.function.span, Target::Missing(NameKind::Function), false),
        }
        let is_table = ["table", "curve", "grid"].contains(&name);
        // `lowest(flank, rho)`
        let is_extreme = place.is_at_points && ["lowest", "highest"].contains(&name);
        let evaluated = place.evaluated;
        for (k, argument) in call.arguments.iter().enumerate() {
            match &argument.name {
                Some(name) if is_table => self.column(name, place),
                Some(name) => self.word(name.span, WordKind::Argument),
                None => {}
            }
            place.evaluated = if is_extreme && k == 1 { At::Points } else { evaluated };
            self.argument(&argument.value, is_table, place);
        }
        place.evaluated = evaluated;
    }

    /// Whether the language brings a function, a transform or a way to make a surface along.
    fn is_function(&mut self, name: &str) -> bool {
        if self.functions.is_empty() {
            self.functions = functions();
        }
        self.functions.binary_search(&name).is_ok()
    }

    /// Columns of tables are named by themselves, and have dimensions.
    fn argument(&mut self, value: &'a Expression, is_table: bool, place: &mut Place<'a>) {
        if let ExpressionKind::Path(path) = &value.kind
            && let [name] = path.segments.as_slice()
        {
            if crate::syntax::is_reserved(&name.node) {
                return self.word(name.span, WordKind::Dimension);
            }
            if is_table {
                return self.column(name, place);
            }
        }
        self.expression(value, place);
    }

    /// A column of a table: a motion, a parameter or a coordinate of that name, or one of the language.
    fn column(&mut self, name: &'a Name, place: &Place<'a>) {
        let found = self.value(&name.node, &Place { evaluated: At::Points, ..place.clone() });
        match found {
            Target::Symbol(id) if is_of_points(self.kind(id)) => self.enter(name.span, found, false),
            _ => self.word(name.span, WordKind::Column),
        }
    }

    /// A name that must be a frame.
    pub(super) fn frame(&mut self, name: &'a Name, machine: SymbolId) {
        let found = self.inside(machine, &name.node, Wanted::Other);
        self.refer(name, found.filter(|found| self.kind(*found) == NameKind::Frame), NameKind::Frame);
    }
}

/// Whether points of surfaces have a value of it.
pub(super) fn is_of_points(kind: NameKind) -> bool {
    [NameKind::Motion, NameKind::Unknown, NameKind::SurfaceParameter, NameKind::Coordinate].contains(&kind)
}

/// All functions, transforms and ways to make a surface.
pub(crate) fn functions() -> Vec<&'static str> {
    let transforms = super::super::transforms::names().iter().copied();
    let mut all: Vec<&'static str> = crate::values::functions::names().chain(transforms).chain(WORDS).collect();
    all.sort_unstable();
    all
}

/// Functions that mean something only where they stand.
const WORDS: [&str; 24] = [
    "table",
    "curve",
    "grid",
    "envelope",
    "sweep",
    "move",
    "turned",
    "extruded",
    "vertex",
    "about",
    "line",
    "arc",
    "spline",
    "thickness",
    "span",
    "over_balls",
    "turn",
    "rms",
    "lowest",
    "highest",
    "slope",
    "crowning",
    "bias",
    "position",
];

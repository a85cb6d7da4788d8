//! Tools: parametric surfaces and the side on which their steel lies.

use std::collections::HashMap;
use std::rc::Rc;

use flank_expr::geometry::{Edge, Surface, Vector3};
use flank_expr::{Expr, Interval};

use crate::definitions::implicit_surface;
use crate::definitions::instance::{Binder, Overrides, Source, is_profile};
use crate::definitions::material_side::{self, Places};
use crate::definitions::profile;
use crate::definitions::requirement;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::job::sample;
use crate::model::{Parameter, PieceEnds, RangedVariable, ToolShape};
use crate::syntax::ast::{self, ExpressionKind, Side, SurfaceParameter, ToolStatement};
use crate::values::context::{Context, Role};
use crate::values::dimension::Dimension;
use crate::values::segment::Segment;
use crate::values::value::{Constant, Scope, Value};

/// All tools of a compilation by name.
pub(crate) type Tools = HashMap<String, ast::Tool>;

/// A tool with values.
pub(crate) struct BuiltTool<'g> {
    pub(crate) parameters: Vec<Parameter<'g>>,
    pub(crate) scope: Scope<'g>,
    pub(crate) surfaces: Vec<ToolSurface<'g>>,
}

/// One surface of a tool in the tool's frame.
pub(crate) struct ToolSurface<'g> {
    pub(crate) name: String,
    /// Its smooth pieces; `None` if it is not known which they are (and that is reported), or nobody wants them.
    pub(crate) pieces: Option<Vec<Piece<'g>>>,
    /// Where it is said on which side the steel lies.
    pub(crate) body: Span,
}

/// All of a surface, or the piece of it along one segment of a profile.
#[derive(Clone)]
pub(crate) struct Piece<'g> {
    /// The name of the segment.
    pub(crate) name: Option<String>,
    /// `None` if something in it is wrong (and reported), or nobody wants it.
    pub(crate) surface: Option<(ToolShape<'g>, Vec<RangedVariable<'g>>)>,
}

/// A segment of a profile.
#[derive(Clone, Copy)]
struct Along<'a, 'g> {
    profile: &'a str,
    segment: &'a Rc<Segment<'g>>,
    /// The segments before and behind it.
    beside: [Option<&'a str>; 2],
}

/// Whether somebody wants a surface, or a piece of it.
pub(crate) type Wanted<'w> = &'w dyn Fn(&str, Option<&str>) -> bool;

/// Gives values to the parameters and builds the surfaces that are wanted; the others have no pieces that are known.
pub(crate) fn build<'g>(
    context: &mut Context<'g>,
    tool: &ast::Tool,
    source: Source<'_, 'g>,
    overrides: &Overrides,
    wanted: Wanted<'_>,
) -> BuiltTool<'g> {
    let user = source.user();
    let mut binder = Binder::new(source, overrides);
    let mut scope = Scope::new();
    let mut seen: HashMap<&str, crate::Span> = HashMap::new();
    for statement in &tool.statements {
        let name = match statement {
            ToolStatement::Param(param) => Some(&param.name),
            ToolStatement::Let(binding) => Some(&binding.name),
            ToolStatement::Profile(profile) => Some(&profile.name),
            ToolStatement::Surface(_) | ToolStatement::Require(_) => None,
        };
        let names = match statement {
            ToolStatement::Surface(surface) => &surface.names[..],
            _ => name.map_or(&[][..], std::slice::from_ref),
        };
        for name in names {
            if let Some(first) = seen.insert(&name.node, name.span) {
                context.duplicate(name, first);
            }
        }
        match statement {
            ToolStatement::Param(param) => binder.bind(context, param, &mut scope),
            ToolStatement::Let(binding) => {
                let value = context.evaluate(&binding.value, &scope);
                context.note_value(binding.name.span, binding.value.span, &value);
                scope.insert(binding.name.node.clone(), value);
            }
            ToolStatement::Profile(written) => profile::build(context, written, &mut scope, None),
            ToolStatement::Require(required) => requirement::check(context, required, &scope, user),
            ToolStatement::Surface(_) => {}
        }
    }
    let params: Vec<&ast::Param> = tool
        .statements
        .iter()
        .filter_map(|statement| match statement {
            ToolStatement::Param(param) => Some(param),
            _ => None,
        })
        .collect();
    binder.finish(context, &params);
    let parameters = binder.parameters;
    let mut surfaces = Vec::new();
    for statement in &tool.statements {
        let ToolStatement::Surface(written) = statement else { continue };
        for side in sides(context, written) {
            let is_wanted = wanted(&side.name.node, None);
            let pieces = if is_wanted { pieces(context, side, &scope, wanted) } else { None };
            surfaces.push(ToolSurface { name: side.name.node.clone(), pieces, body: side.written.body.span });
        }
    }
    BuiltTool { parameters, scope, surfaces }
}

/// The parameters of a tool that are profiles, as a job calls them: `w.section`.
pub(crate) fn profiles(tool: &ast::Tool, name: &str) -> Vec<String> {
    let profile = |statement: &ToolStatement| match statement {
        ToolStatement::Param(param) if is_profile(&param.dimension) => Some(format!("{name}.{}", param.name.node)),
        _ => None,
    };
    tool.statements.iter().filter_map(profile).collect()
}

/// One of the surfaces of a statement: its name, and the value that is its own.
#[derive(Clone, Copy)]
struct OneSide<'a> {
    written: &'a ast::ToolSurface,
    name: &'a Name,
    own: Option<(&'a Name, &'a ast::Expression)>,
}

/// All that a statement names; none where it has not a value for each (which is reported).
fn sides<'a>(context: &mut Context<'_>, written: &'a ast::ToolSurface) -> Vec<OneSide<'a>> {
    let values = written.each.as_ref().map_or(1, |each| each.values.len());
    if values != written.names.len() {
        let names = written.names.len();
        let counted = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
        let (message, place) = match &written.each {
            Some(each) => (format!("{} for {}", counted(values, "value"), counted(names, "surface")), each.span),
            None => (format!("{} for one surface", counted(names, "name")), written.names[1].span),
        };
        let help = "say what is different for each name: `surface left, right(u: …, v: …) for side in [1, -1] { … }`";
        context.report(Diagnostic::new(Code::UnevenLists, place, message).help(help));
        return Vec::new();
    }
    let own = |k: usize| written.each.as_ref().map(|each| (&each.name, &each.values[k]));
    written.names.iter().enumerate().map(|(k, name)| OneSide { written, name, own: own(k) }).collect()
}

/// The smooth pieces of a surface: one for each segment of the profile that it runs along.
fn pieces<'g>(
    context: &mut Context<'g>,
    side: OneSide<'_>,
    scope: &Scope<'g>,
    wanted: Wanted<'_>,
) -> Option<Vec<Piece<'g>>> {
    let mut along = side.written.parameters.iter().filter_map(|parameter| match parameter {
        SurfaceParameter::Along(name, profile) => Some((name, profile)),
        SurfaceParameter::Within(_) => None,
    });
    let Some((_, name)) = along.next() else {
        let surface = build_surface(context, side, scope, None);
        return Some(vec![Piece { name: None, surface }]);
    };
    if let Some((second, _)) = along.next() {
        let message = "a surface runs along one profile";
        context.report(Diagnostic::new(Code::WrongArguments, second.span, message).note(name.span, "along this one"));
        return None;
    }
    let profile = match scope.get(&name.node) {
        Some(Value::Profile(profile)) => profile,
        Some(Value::Poison) => return None,
        Some(other) => {
            let message = format!("`{}` is {}, not a profile", name.node, other.described());
            context.report(Diagnostic::new(Code::WrongKind, name.span, message));
            return None;
        }
        None => {
            let profiles = scope.iter().filter(|(_, value)| matches!(value, Value::Profile(_)));
            context.unknown(name, "profile", profiles.map(|(name, _)| name.as_str()));
            return None;
        }
    };
    let named = |place: Option<usize>| profile.segments.get(place?).map(|segment| segment.name.as_str());
    let piece = |(k, segment): (usize, &Rc<Segment<'g>>)| Piece {
        name: Some(segment.name.clone()),
        surface: if wanted(&side.name.node, Some(&segment.name)) {
            let beside = [named(k.checked_sub(1)), named(Some(k + 1))];
            build_surface(context, side, scope, Some(Along { profile: &name.node, segment, beside }))
        } else {
            None
        },
    };
    Some(profile.segments.iter().enumerate().map(piece).collect())
}

fn build_surface<'g>(
    context: &mut Context<'g>,
    side: OneSide<'_>,
    scope: &Scope<'g>,
    along: Option<Along<'_, 'g>>,
) -> Option<(ToolShape<'g>, Vec<RangedVariable<'g>>)> {
    let (scope, unknowns) = own_names(context, side, scope, along)?;
    let written = side.written;
    if let Side::Where(condition) = &written.body.side {
        let surface = implicit_surface::build(context, (&written.at, condition), &unknowns, &scope)?;
        return Some((ToolShape::Surface(surface), unknowns));
    }
    let (position, steel) = point_and_steel(context, written, &scope)?;
    let shape = match (written.parameters.len(), unknowns.as_slice()) {
        (1, [u]) => ToolShape::Edge(Edge { parameter: u.variable, position, steel }),
        (2, [u, v]) => {
            let parameters = [u.variable, v.variable];
            let raw = Surface::raw_normal(parameters, position);
            let segment = along.map(|along| along.segment.span);
            let is_alone = segment.is_none() && written.names.len() == 1;
            let places = Places { point: written.at.span, side: written.body.span, segment, is_alone };
            let flipped = material_side::is_flipped(context, places, &unknowns, raw, -steel)?;
            ToolShape::Surface(Surface::along(parameters, position, raw, flipped))
        }
        // the range of a parameter is wrong, and reported
        _ => return None,
    };
    Some((shape, unknowns))
}

/// The names that a surface has beside those of the tool, and its parameters: without those whose range is wrong (and reported).
fn own_names<'g>(
    context: &mut Context<'g>,
    OneSide { written, name, own }: OneSide<'_>,
    scope: &Scope<'g>,
    along: Option<Along<'_, 'g>>,
) -> Option<(Scope<'g>, Vec<RangedVariable<'g>>)> {
    if !context.spend(scope.len(), name.span) {
        return None;
    }
    let mut scope = scope.clone();
    let mut unknowns = Vec::new();
    if let Some(Along { profile, segment, .. }) = along {
        scope.insert(profile.to_string(), Value::Segment(Rc::clone(segment)));
    }
    if let Some((name, value)) = own {
        let value = context.evaluate(value, &scope);
        scope.insert(name.node.clone(), value);
    }
    let names = own.iter().map(|(name, _)| *name);
    let names = names.chain(written.parameters.iter().map(|parameter| parameter.name()));
    if !context.are_distinct(names.chain(written.lets.iter().map(|binding| &binding.name))) {
        return None;
    }
    for parameter in &written.parameters {
        sample::check_unknown(context, parameter.name(), "surface parameter");
        let bounded = match (parameter, along) {
            (SurfaceParameter::Within(parameter), _) => bounded(context, parameter, &scope, Role::SurfaceParameter),
            (SurfaceParameter::Along(name, _), Some(Along { segment, beside, .. })) => {
                Some(run_along(context, name, segment, beside.map(|name| name.map(str::to_string))))
            }
            (SurfaceParameter::Along(..), None) => None,
        };
        let value = match &bounded {
            Some(bounded) => Value::Scalar(bounded.variable, bounded.dimension),
            None => Value::Poison,
        };
        scope.insert(parameter.name().node.clone(), value);
        unknowns.extend(bounded);
    }
    if !has_its_parameters(context, written, name) {
        return None;
    }
    for binding in &written.lets {
        let value = context.evaluate(&binding.value, &scope);
        scope.insert(binding.name.node.clone(), value);
    }
    Some((scope, unknowns))
}

/// Whether a surface has as many parameters as its kind takes; reported if not.
fn has_its_parameters(context: &mut Context<'_>, written: &ast::ToolSurface, name: &Name) -> bool {
    let (is_implicit, count) = (matches!(written.body.side, Side::Where(_)), written.parameters.len());
    let (kind, help) = match (is_implicit, count) {
        (false, 1 | 2) | (true, 3) => return true,
        // what its side is has been asked for
        (false, 3) if matches!(&written.body.side, Side::Towards(side) if side.kind == ExpressionKind::Error) => {
            return false;
        }
        (true, _) => (
            "a surface by a condition has three parameters",
            "they move the point in space, as `at = [u, v, w]`; where the condition ceases to hold lies the surface",
        ),
        (false, 3) => (
            "a surface has two parameters (a cutting edge one)",
            "with three, a condition says where the steel lies, such as `body where u^2 + v^2 < radius^2`",
        ),
        (false, _) => ("a surface has two parameters (a cutting edge one)", ""),
    };
    let mut diagnostic =
        Diagnostic::new(Code::WrongArguments, name.span, format!("{kind}, `{}` has {count}", name.node));
    if !help.is_empty() {
        diagnostic = diagnostic.help(help);
    }
    context.report(diagnostic);
    false
}

/// The point of a surface, and a direction from it into the steel.
fn point_and_steel<'g>(
    context: &mut Context<'g>,
    written: &ast::ToolSurface,
    scope: &Scope<'g>,
) -> Option<(Vector3<'g>, Vector3<'g>)> {
    let position = context.vector(&written.at, scope, Dimension::LENGTH, "the point");
    let towards = match &written.body.side {
        Side::Towards(direction) => direction_of_steel(context, direction, scope),
        Side::Inside | Side::Outside | Side::Where(_) => position,
    };
    let (position, towards) = (Vector3(position?), Vector3(towards?));
    let radial = Vector3([position.0[0], position.0[1], context.graph.constant(0.0)]);
    let steel = match &written.body.side {
        Side::Inside => -radial,
        Side::Outside | Side::Where(_) => radial,
        Side::Towards(_) => towards,
    };
    Some((position, steel))
}

/// The run along a profile within one segment of it, which has those two beside it.
fn run_along<'g>(
    context: &mut Context<'g>,
    name: &Name,
    segment: &Segment<'g>,
    beside: [Option<String>; 2],
) -> RangedVariable<'g> {
    let [low, high] = [segment.from, segment.to].map(|end| match context.constant(end) {
        Constant::Known(value) => value,
        _ => f64::NAN,
    });
    let variable = context.variable(name.node.clone(), Role::SurfaceParameter, f64::NAN);
    context.set_range(variable, Interval::new(low, high));
    let piece = Some(PieceEnds { name: segment.name.clone(), beside });
    RangedVariable {
        name: name.node.clone(),
        variable,
        dimension: Dimension::LENGTH,
        low,
        high,
        is_count: false,
        piece,
    }
}

/// A direction: lengths or numbers alike.
fn direction_of_steel<'g>(
    context: &mut Context<'g>,
    direction: &ast::Expression,
    scope: &Scope<'g>,
) -> Option<[Expr<'g>; 3]> {
    let findings = context.findings();
    let is_length = match context.evaluate(direction, scope) {
        Value::Vector(parts) => {
            matches!(parts.first(), Some(Value::Scalar(_, dimension)) if dimension.length == 1)
        }
        _ => false,
    };
    if context.findings() > findings {
        return None;
    }
    let wanted = if is_length { Dimension::LENGTH } else { Dimension::NUMBER };
    context.vector(direction, scope, wanted, "the direction of the steel")
}

/// A variable with its range; where the range is not known yet its ends are NaN.
pub(crate) fn bounded<'g>(
    context: &mut Context<'g>,
    parameter: &ast::Parameter,
    scope: &Scope<'g>,
    role: Role,
) -> Option<RangedVariable<'g>> {
    let name = parameter.name.node.clone();
    let dimension = context.dimension(&parameter.dimension)?;
    let what = format!("`{name}`");
    let (low, high) = context.range(&parameter.range, scope, dimension, &what).unwrap_or((f64::NAN, f64::NAN));
    let is_count = parameter.dimension.is_count();
    for end in [low, high].into_iter().filter(|end| is_count && end.is_finite() && end.fract() != 0.0) {
        let message = format!("{what} is a count: it runs between whole numbers, not to {end}");
        context.report(Diagnostic::new(Code::WrongDimension, parameter.range.span, message));
    }
    let variable = context.variable(name.clone(), role, f64::NAN);
    context.set_range(variable, Interval::new(low, high));
    if is_count {
        context.set_count(variable);
    }
    Some(RangedVariable { name, variable, dimension, low, high, is_count, piece: None })
}

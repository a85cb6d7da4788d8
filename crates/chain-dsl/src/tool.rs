//! Tools: parametric surfaces and the side on which their steel lies.

use std::collections::HashMap;

use flank_expr::Expr;
use flank_expr::geometry::{Edge, Surface, Vector3};

use crate::codes::Code;
use crate::context::{Context, Role, Scope, Value};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::instance::{Binder, Overrides, Source};
use crate::model::{Bounded, Parameter, ToolShape};
use crate::steel;
use crate::syntax::ast::{self, Side, ToolStatement};

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
    /// `None` if something in it is wrong (and reported).
    pub(crate) surface: Option<(ToolShape<'g>, Vec<Bounded<'g>>)>,
}

/// Gives values to the parameters and builds the surfaces.
pub(crate) fn build<'g>(
    context: &mut Context<'g>,
    tool: &ast::Tool,
    source: Source<'_, 'g>,
    overrides: &Overrides,
) -> BuiltTool<'g> {
    let mut binder = Binder::new(source, overrides);
    let mut scope = Scope::new();
    let mut seen: HashMap<&str, crate::Span> = HashMap::new();
    for statement in &tool.statements {
        let name = match statement {
            ToolStatement::Param(param) => &param.name,
            ToolStatement::Let(binding) => &binding.name,
            ToolStatement::Surface(surface) => &surface.name,
        };
        if let Some(first) = seen.insert(&name.node, name.span) {
            context.duplicate(name, first);
        }
        match statement {
            ToolStatement::Param(param) => binder.bind(context, param, &mut scope),
            ToolStatement::Let(binding) => {
                let value = context.evaluate(&binding.value, &scope);
                scope.insert(binding.name.node.clone(), value);
            }
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
    let parameters = binder.finish(context, &params);
    let mut surfaces = Vec::new();
    for statement in &tool.statements {
        if let ToolStatement::Surface(written) = statement {
            let surface = build_surface(context, written, &scope);
            surfaces.push(ToolSurface { name: written.name.node.clone(), surface });
        }
    }
    BuiltTool { parameters, scope, surfaces }
}

fn build_surface<'g>(
    context: &mut Context<'g>,
    written: &ast::ToolSurface,
    scope: &Scope<'g>,
) -> Option<(ToolShape<'g>, Vec<Bounded<'g>>)> {
    // every surface has names of its own beside those of the tool
    if !context.spend(scope.len(), written.name.span) {
        return None;
    }
    let mut scope = scope.clone();
    let mut unknowns = Vec::new();
    for parameter in &written.parameters {
        let bounded = bounded(context, parameter, &scope, Role::SurfaceParameter);
        let value = match &bounded {
            Some(bounded) => Value::Scalar(bounded.variable, bounded.dimension),
            None => Value::Poison,
        };
        scope.insert(parameter.name.node.clone(), value);
        unknowns.extend(bounded);
    }
    if !matches!(written.parameters.len(), 1 | 2) {
        let message = format!(
            "a surface has two parameters (a cutting edge one), `{}` has {}",
            written.name.node,
            written.parameters.len()
        );
        context.report(Diagnostic::new(Code::WrongArguments, written.name.span, message));
        return None;
    }
    for binding in &written.lets {
        let value = context.evaluate(&binding.value, &scope);
        scope.insert(binding.name.node.clone(), value);
    }
    let position = context.vector3(&written.at, &scope, Dimension::LENGTH, "the point");
    let towards = match &written.body.side {
        Side::Towards(direction) => direction_of_steel(context, direction, &scope),
        Side::Inside | Side::Outside => position,
    };
    let (position, towards) = (Vector3(position?), Vector3(towards?));
    let radial = Vector3([position.0[0], position.0[1], context.graph.constant(0.0)]);
    let steel = match &written.body.side {
        Side::Inside => -radial,
        Side::Outside => radial,
        Side::Towards(_) => towards,
    };
    let shape = match (written.parameters.len(), unknowns.as_slice()) {
        (1, [u]) => ToolShape::Edge(Edge { parameter: u.variable, position, steel }),
        (2, [u, v]) => {
            let parameters = [u.variable, v.variable];
            let raw = Surface::raw_normal(parameters, position);
            let flipped = steel::is_flipped(context, [written.at.span, written.body.span], &unknowns, raw, -steel)?;
            ToolShape::Surface(Surface::parametric(parameters, position, flipped))
        }
        // the range of a parameter is wrong, and reported
        _ => return None,
    };
    Some((shape, unknowns))
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
    context.vector3(direction, scope, wanted, "the direction of the steel")
}

/// A variable with its range; where the range is not known yet its ends are NaN.
pub(crate) fn bounded<'g>(
    context: &mut Context<'g>,
    parameter: &ast::Parameter,
    scope: &Scope<'g>,
    role: Role,
) -> Option<Bounded<'g>> {
    let name = parameter.name.node.clone();
    let dimension = context.dimension(&parameter.dimension)?;
    let what = format!("`{name}`");
    let (low, high) = context.range(&parameter.range, scope, dimension, &what).unwrap_or((f64::NAN, f64::NAN));
    let variable = context.variable(name.clone(), role, f64::NAN);
    Some(Bounded { name, variable, dimension, low, high })
}

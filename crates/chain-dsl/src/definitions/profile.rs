//! Profiles of tools: lines, arcs and splines in a plane, one after the other, that one length runs over.

use std::rc::Rc;

use flank_expr::{Curve, CurveError, Expr};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::job::sampled::{self, SampledPoints};
use crate::syntax::ast::{self, Call, Expression, ExpressionKind};
use crate::values::context::{Context, Role, quoted};
use crate::values::dimension::{Dimension, shown};
use crate::values::segment::{Profile, Segment, Shape};
use crate::values::tables;
use crate::values::value::{Constant, Scope, Value};

/// The farthest that the end of a segment may lie from the beginning of the next, mm: rounding of coordinates as large as
/// those of a nearly straight arc.
const JOINT: f64 = 1e-9;

/// The ways to make a segment.
const SHAPES: [&str; 3] = ["line", "arc", "spline"];

/// Builds a profile and puts it into the scope, with the runs at its segments' ends as `profile.segment.from` and `.to`.
///
/// In a job its splines may go through points of samples.
pub(crate) fn build<'g>(
    context: &mut Context<'g>,
    written: &ast::Profile,
    scope: &mut Scope<'g>,
    sampled: Option<&mut SampledPoints>,
) {
    let findings = context.findings();
    let profile =
        segments(context, written, scope, sampled).filter(|_| context.findings() == findings && !written.broken);
    let name = &written.name.node;
    let Some(profile) = profile else {
        scope.insert(name.clone(), Value::Poison);
        return;
    };
    insert(scope, name, Rc::new(profile));
}

/// Puts a profile into a scope, with the runs at its segments' ends.
pub(crate) fn insert<'g>(scope: &mut Scope<'g>, name: &str, profile: Rc<Profile<'g>>) {
    for segment in &profile.segments {
        for (end, run) in [("from", segment.from), ("to", segment.to)] {
            scope.insert(format!("{name}.{}.{end}", segment.name), Value::Scalar(run, Dimension::LENGTH));
        }
    }
    scope.insert(name.to_string(), Value::Profile(profile));
}

/// A profile of one segment that has no values yet.
pub(crate) fn standing<'g>(context: &mut Context<'g>, name: &Name) -> Rc<Profile<'g>> {
    let shape = unknown(context, &name.node);
    let (from, to) = (context.graph.constant(0.0), context.variable(name.node.clone(), Role::Parameter, f64::NAN));
    let segment = Segment { name: name.node.clone(), span: name.span, shape, from, to };
    Rc::new(Profile { segments: vec![Rc::new(segment)] })
}

fn unknown<'g>(context: &mut Context<'g>, name: &str) -> Shape<'g> {
    Shape::Unknown([(); 2].map(|()| context.variable(name, Role::Parameter, f64::NAN)))
}

fn segments<'g>(
    context: &mut Context<'g>,
    written: &ast::Profile,
    scope: &Scope<'g>,
    mut sampled: Option<&mut SampledPoints>,
) -> Option<Profile<'g>> {
    if written.segments.is_empty() && !written.broken {
        let message = format!("`{}` has no segments", written.name.node);
        let help = "add one, such as `flank = line(from: [x, y], to: [x, y])`";
        context.report(Diagnostic::new(Code::BrokenProfile, written.name.span, message).help(help));
    }
    for (k, segment) in written.segments.iter().enumerate() {
        if let Some(first) = written.segments[..k].iter().find(|earlier| earlier.name.node == segment.name.node) {
            context.duplicate(&segment.name, first.name.span);
        }
    }
    let mut run = context.graph.constant(0.0);
    let mut built: Vec<Option<Rc<Segment<'g>>>> = Vec::new();
    for segment in &written.segments {
        let next =
            shape(context, &segment.value, &segment.name.node, scope, sampled.as_deref_mut()).map(|(shape, length)| {
                let (name, span) = (segment.name.node.clone(), segment.value.span);
                Rc::new(Segment { name, span, shape, from: run, to: run + length })
            });
        run = next.as_ref().map_or(run, |segment| segment.to);
        built.push(next);
    }
    // a segment that cannot be read leaves a gap
    for pair in built.windows(2).filter(|_| !written.broken) {
        if let [Some(one), Some(next)] = pair {
            check_joint(context, one, next);
        }
    }
    Some(Profile { segments: built.into_iter().collect::<Option<_>>()? })
}

/// The shape of a segment and its length.
fn shape<'g>(
    context: &mut Context<'g>,
    written: &Expression,
    name: &str,
    scope: &Scope<'g>,
    sampled: Option<&mut SampledPoints>,
) -> Option<(Shape<'g>, Expr<'g>)> {
    let call = match &written.kind {
        ExpressionKind::Call(call) => call,
        ExpressionKind::Error => return None,
        _ => {
            let message = "a segment of a profile is a `line`, an `arc` or a `spline`";
            let help = "for example `line(from: [x, y], to: [x, y])`";
            context.report(Diagnostic::new(Code::WrongKind, written.span, message).help(help));
            return None;
        }
    };
    match call.function.node.as_str() {
        "line" => line(context, call, scope),
        "arc" => arc(context, call, scope),
        "spline" => spline(context, call, name, scope, sampled),
        _ => {
            context.unknown(&call.function, "kind of segment", SHAPES.into_iter());
            None
        }
    }
}

fn line<'g>(context: &mut Context<'g>, call: &Call, scope: &Scope<'g>) -> Option<(Shape<'g>, Expr<'g>)> {
    let [from, to] = arguments(context, call, ["from", "to"], "line(from: [x, y], to: [x, y])")?;
    let from = context.vector(from, scope, Dimension::LENGTH, "the beginning of the line");
    let to = context.vector(to, scope, Dimension::LENGTH, "the end of the line");
    let (from, to): ([Expr<'g>; 2], [Expr<'g>; 2]) = (from?, to?);
    let way = [to[0] - from[0], to[1] - from[1]];
    let length = hypot(way);
    if value(context, length, call.span, "the length of the line")? == 0.0 {
        return no_run(context, call.span, "this line ends where it begins", "give it two different ends");
    }
    Some((Shape::Line { from, direction: way.map(|part| part / length) }, length))
}

/// By its centre, or through two points.
fn arc<'g>(context: &mut Context<'g>, call: &Call, scope: &Scope<'g>) -> Option<(Shape<'g>, Expr<'g>)> {
    let is_named =
        |label: &str| call.arguments.iter().any(|argument| matches!(&argument.name, Some(name) if name.node == label));
    if call.arguments.len() == 3 && ["from", "to", "radius"].into_iter().all(is_named) {
        return bow(context, call, scope);
    }
    let labels = ["center", "radius", "from", "to"];
    let written = arguments(context, call, labels, "arc(center: [x, y], radius: r, from: 0 deg, to: 90 deg)")?;
    let center = context.vector(written[0], scope, Dimension::LENGTH, "the centre of the arc");
    let radius = context.scalar(written[1], scope, Dimension::LENGTH, "the radius of the arc");
    let [from, to] =
        [written[2], written[3]].map(|angle| context.scalar(angle, scope, Dimension::ANGLE, "an end of the arc"));
    let (center, radius, from, to) = (center?, radius?, from?, to?);
    let size = value(context, radius, written[1].span, "the radius of the arc")?;
    if size <= 0.0 {
        let message = format!("the radius of an arc is above zero, this one is {}", shown(size, Dimension::LENGTH));
        let help = "`from` and `to` say in which sense it turns";
        return no_run(context, written[1].span, &message, help);
    }
    let turn = value(context, to - from, call.span, "the turn of the arc")?;
    if turn == 0.0 {
        return no_run(context, written[3].span, "this arc ends where it begins", "give it two different angles");
    }
    let (sense, turn) = if turn < 0.0 { (-1.0, from - to) } else { (1.0, to - from) };
    Some((Shape::Arc { center, radius, from, sense }, turn * radius))
}

fn bow<'g>(context: &mut Context<'g>, call: &Call, scope: &Scope<'g>) -> Option<(Shape<'g>, Expr<'g>)> {
    let written = arguments(context, call, ["from", "to", "radius"], "arc(from: [x, y], to: [x, y], radius: r)")?;
    let from = context.vector(written[0], scope, Dimension::LENGTH, "the beginning of the arc");
    let to = context.vector(written[1], scope, Dimension::LENGTH, "the end of the arc");
    let radius = context.scalar(written[2], scope, Dimension::LENGTH, "the radius of the arc");
    let (from, to, radius): ([Expr<'g>; 2], [Expr<'g>; 2], _) = (from?, to?, radius?);
    let way = [to[0] - from[0], to[1] - from[1]];
    let distance = hypot(way);
    let (apart, size) = (value(context, distance, call.span, "the ends of the arc")?, written[2].span);
    let size = value(context, radius, size, "the radius of the arc")?;
    if apart == 0.0 {
        return no_run(context, call.span, "this arc ends where it begins", "give it two different ends");
    }
    if 2.0 * size.abs() < apart {
        let [apart, size] = [apart, size].map(|length| shown(length, Dimension::LENGTH));
        let message = format!("no circle of radius {size} goes through two points that are {apart} apart");
        let help = "the radius is at least half of that; it is positive if the arc turns from the first coordinate to the second";
        return no_run(context, written[2].span, &message, help);
    }
    // with the sign of the radius
    let half_turn = (distance / (radius + radius)).asin();
    let direction = way[1].atan2(way[0]) - half_turn;
    Some((Shape::Bow { from, direction, radius }, (radius + radius) * half_turn))
}

fn spline<'g>(
    context: &mut Context<'g>,
    call: &Call,
    name: &str,
    scope: &Scope<'g>,
    sampled: Option<&mut SampledPoints>,
) -> Option<(Shape<'g>, Expr<'g>)> {
    let (points, places) = match call.arguments.as_slice() {
        _ if sampled::named(call).is_some() => {
            let Some(sampled) = sampled else {
                let message = "a tool by itself has no samples whose points a spline goes through";
                let help = "write the profile into the job, and give it to a parameter of the tool, such as `param section : profile`";
                context.report(Diagnostic::new(Code::WrongKind, call.span, message).help(help));
                return None;
            };
            (sampled.of(call)?.to_vec(), vec![call.span])
        }
        [ast::Argument { name: None, value: listed }] if !matches!(listed.kind, ExpressionKind::Text(_)) => {
            listed_points(context, listed, scope)?
        }
        _ => tabulated_points(context, call)?,
    };
    let mut run = 0.0;
    let mut over_run = [Vec::new(), Vec::new()];
    for (k, &(x, y)) in points.iter().enumerate() {
        if k > 0 {
            let step = f64::hypot(x - points[k - 1].0, y - points[k - 1].1);
            if step == 0.0 {
                let message = format!("points {} and {} of this spline are the same", k, k + 1);
                let place = places[k.min(places.len() - 1)];
                let same = Diagnostic::new(Code::BrokenProfile, place, message).help("leave one of them out");
                // of a table all points have one place
                context.report(if places.len() > k { same.rewriting(Rewriting::Entry(place)) } else { same });
                return None;
            }
            run += step;
        }
        over_run[0].push((run, x));
        over_run[1].push((run, y));
    }
    if points.iter().any(|(x, y)| x.is_nan() || y.is_nan()) {
        let length = context.variable(name, Role::Parameter, f64::NAN);
        return Some((unknown(context, name), length));
    }
    let [x, y] = [0, 1].map(|k| Curve::through(format!("{name}_{}", ["x", "y"][k]), &over_run[k]));
    let (x, y) = match (x, y) {
        (Ok(x), Ok(y)) => (x, y),
        (Err(CurveError::TooFew), _) | (_, Err(CurveError::TooFew)) => {
            let help = "for example `spline([[0 mm, 0 mm], [1 mm, 0.1 mm], [2 mm, 0.4 mm]])`";
            return no_run(context, places[0], "a spline goes through at least two points", help);
        }
        (Err(error), _) | (_, Err(error)) => {
            let message = format!("over the run of this spline, {error}");
            let help = "its points lie too close together, or too far apart, for the digits of a number";
            return no_run(context, places[0], &message, help);
        }
    };
    let ids = [context.graph.curve(x), context.graph.curve(y)];
    Some((Shape::Spline(ids), context.graph.constant(run)))
}

/// Points of a spline and the places at which they are written: one for each, or one for all.
type Points = (Vec<(f64, f64)>, Vec<Span>);

/// `[[x, y], …]`; NaN where a coordinate has no value yet.
fn listed_points<'g>(context: &mut Context<'g>, listed: &Expression, scope: &Scope<'g>) -> Option<Points> {
    let ExpressionKind::Vector(written) = &listed.kind else {
        let message = "the points of a spline are a list `[[x, y], …]`";
        context.report(Diagnostic::new(Code::WrongArguments, listed.span, message));
        return None;
    };
    let mut points = Vec::new();
    for point in written {
        let [x, y] = context.vector(point, scope, Dimension::LENGTH, "a point of the spline")?;
        let [x, y] = [x, y].map(|part| value(context, part, point.span, "a point of the spline"));
        points.push((x?, y?));
    }
    let places = if written.is_empty() { vec![listed.span] } else { written.iter().map(|point| point.span).collect() };
    Some((points, places))
}

/// `"file.csv", x: length, y: length`
fn tabulated_points(context: &mut Context<'_>, call: &Call) -> Option<Points> {
    let table = tables::columns(context, call)?;
    for (name, dimension) in table.columns {
        if dimension != Dimension::LENGTH {
            let message = format!("the points of a spline are lengths, `{}` is {dimension}", name.node);
            context.report(Diagnostic::new(Code::WrongDimension, name.span, message));
            return None;
        }
    }
    Some((table.rows(context)?.to_vec(), vec![table.span]))
}

/// The arguments of a call that takes them by these names.
fn arguments<'a, const N: usize>(
    context: &mut Context<'_>,
    call: &'a Call,
    labels: [&str; N],
    example: &str,
) -> Option<[&'a Expression; N]> {
    let function = &call.function.node;
    let mut found: [Option<&Expression>; N] = [None; N];
    for argument in &call.arguments {
        let Some(name) = &argument.name else {
            let message = format!("`{function}` takes its arguments by their names");
            let help = format!("for example `{example}`");
            context.report(Diagnostic::new(Code::WrongArguments, argument.value.span, message).help(help));
            return None;
        };
        let Some(place) = labels.iter().position(|label| *label == name.node) else {
            context.unknown(name, &format!("argument of `{function}`"), labels.into_iter());
            return None;
        };
        if let Some(first) = found[place].replace(&argument.value) {
            context.duplicate(name, first.span);
            return None;
        }
    }
    let missing: Vec<&str> =
        labels.into_iter().zip(&found).filter(|(_, found)| found.is_none()).map(|of| of.0).collect();
    if !missing.is_empty() {
        let message = format!("`{function}` needs {}", quoted(&missing));
        let help = format!("for example `{example}`");
        context.report(Diagnostic::new(Code::WrongArguments, call.span, message).help(help));
        return None;
    }
    found.into_iter().collect::<Option<Vec<_>>>()?.try_into().ok()
}

/// The number behind an expression of parameters; NaN where it has none yet.
fn value<'g>(context: &mut Context<'g>, expr: Expr<'g>, span: Span, what: &str) -> Option<f64> {
    match context.constant(expr) {
        Constant::Unknown => Some(f64::NAN),
        _ => context.require_constant(expr, span, what),
    }
}

fn no_run<T>(context: &mut Context<'_>, span: Span, message: &str, help: &str) -> Option<T> {
    context.report(Diagnostic::new(Code::BrokenProfile, span, message).help(help));
    None
}

/// Reports a gap between a segment and the next.
fn check_joint<'g>(context: &mut Context<'g>, one: &Segment<'g>, next: &Segment<'g>) {
    let (end, beginning) = (one.point(one.to), next.point(next.from));
    let values = [end[0], end[1], beginning[0], beginning[1]].map(|part| match context.constant(part) {
        Constant::Known(value) => value,
        _ => f64::NAN,
    });
    let [x0, y0, x1, y1] = values;
    let gap = f64::hypot(x1 - x0, y1 - y0);
    if gap > JOINT {
        let point = |x, y| format!("[{}, {}]", shown(x, Dimension::LENGTH), shown(y, Dimension::LENGTH));
        let message = format!("`{}` begins {} from the end of `{}`", next.name, rounded(gap), one.name);
        let help = format!("let it begin at {} instead of {}", point(x0, y0), point(x1, y1));
        let beginning = Rewriting::Vector("from:", next.span, point(x0, y0));
        let mut diagnostic = Diagnostic::new(Code::BrokenProfile, next.span, message).help(help).rewriting(beginning);
        if let Some([x, y]) = known_center(context, next) {
            let center = point(x + x0 - x1, y + y0 - y1);
            diagnostic = diagnostic.rewriting(Rewriting::Vector("center:", next.span, center));
        }
        context.report(diagnostic.note(one.span, "the segment before it"));
    }
}

/// The centre of an arc.
fn known_center<'g>(context: &mut Context<'g>, segment: &Segment<'g>) -> Option<[f64; 2]> {
    let Shape::Arc { center, .. } = &segment.shape else { return None };
    let [x, y] = center.map(|part| match context.constant(part) {
        Constant::Known(value) => Some(value),
        _ => None,
    });
    Some([x?, y?])
}

/// A length to three digits.
fn rounded(length: f64) -> String {
    let rounded = format!("{length:.2e}").parse().unwrap_or(length);
    shown(rounded, Dimension::LENGTH)
}

fn hypot<'g>([x, y]: [Expr<'g>; 2]) -> Expr<'g> {
    (x * x + y * y).sqrt()
}

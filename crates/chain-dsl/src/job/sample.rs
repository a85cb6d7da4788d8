//! Which points of a surface are asked for.

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::{Name, Span};
use crate::diagnostics::spelling::closest;
use crate::limits;
use crate::model::{Coordinate, GeneratedSurface, PointRequirement, Sample, SampleEnds, SampleGrid};
use crate::syntax::ast::{self, Expression, ExpressionKind, SampleEntry, SampleValues};
use crate::values::context::{Context, Role, quoted};
use crate::values::dimension::{Dimension, shown};
use crate::values::tables;
use crate::values::value::{Scope, Value};

/// Corners of a flank in the axial section.
const CORNERS: [&str; 4] = ["toe_root", "heel_root", "toe_tip", "heel_tip"];

/// The one coordinate that comes round to itself.
const POLAR_ANGLE: &str = "polar_angle";
/// What every point has.
pub(crate) const OF_POINTS: [&str; 8] = ["x", "y", "z", "rho", POLAR_ANGLE, "nx", "ny", "nz"];

/// Reports an unknown of surfaces that is called as a coordinate of their points: a sample could mean either.
pub(crate) fn check_unknown(context: &mut Context<'_>, name: &Name, what: &str) {
    if OF_POINTS.contains(&name.node.as_str()) {
        let message = format!("`{}` is a coordinate of points: a {what} cannot be called so", name.node);
        let help = "give it a name of its own, which samples can ask for beside the coordinates";
        context.report(Diagnostic::new(Code::DuplicateName, name.span, message).help(help));
    }
}

/// The grid that a `sample` statement asks for, the branch that it keeps to, and what it requires of the points.
pub(crate) fn build<'g>(
    context: &mut Context<'g>,
    (path, written): (&ast::Path, &ast::Sample),
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<Sample<'g>> {
    let keep: Vec<_> = written.keeps.iter().map(|keep| kept(context, keep, surface, scope)).collect();
    let limits: Vec<_> = written.limits.iter().map(|limit| limited(context, limit, surface, scope)).collect();
    let grid = grid(context, (path, written), surface, scope)?;
    let (keep, limits) = (keep.into_iter().collect::<Option<_>>()?, limits.into_iter().collect::<Option<_>>()?);
    Some(Sample { keep, limits, ..grid })
}

fn kept<'g>(
    context: &mut Context<'g>,
    written: &ast::Keep,
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<(Coordinate<'g>, (f64, f64))> {
    let coordinate = coordinate(context, (&written.key, written.definition.as_ref()), surface, scope)?;
    let (low, high) = context.range(&written.range, scope, coordinate.dimension, &format!("`{}`", written.key.node))?;
    Some((surface.about(coordinate, 0.5 * (low + high)), (low, high)))
}

fn limited<'g>(
    context: &mut Context<'g>,
    written: &ast::PointRequirement,
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<PointRequirement<'g>> {
    let (of, ends) = kept(context, &written.within, surface, scope)?;
    Some(PointRequirement { of, ends, message: written.message.clone(), place: written.within.key.span })
}

fn grid<'g>(
    context: &mut Context<'g>,
    (path, written): (&ast::Path, &ast::Sample),
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<Sample<'g>> {
    // the parser has reported an entry without a key
    if written.entries.iter().any(|entry| entry.key.node.is_empty()) {
        return None;
    }
    for (k, entry) in written.entries.iter().enumerate() {
        if let Some(first) = written.entries[..k].iter().find(|earlier| earlier.key.node == entry.key.node) {
            let message = format!("`{}` is given twice", entry.key.node);
            let diagnostic =
                Diagnostic::new(Code::DuplicateName, entry.key.span, message).note(first.key.span, "first here");
            context.report(diagnostic);
            return None;
        }
    }
    let is_outline = |entry: &SampleEntry| {
        CORNERS.contains(&entry.key.node.as_str()) || ["lengthwise", "profilewise"].contains(&entry.key.node.as_str())
    };
    if written.entries.iter().any(is_outline) {
        return outline(context, (path, written), surface, scope);
    }
    if let Some((entry, call)) = written.entries.iter().find_map(|entry| Some((entry, table(entry)?))) {
        return tabulated(context, (path, written), (entry, call), surface, scope);
    }
    let [rows, columns] = written.entries.as_slice() else {
        let message = format!("a sample takes two coordinates, this one has {}", written.entries.len());
        let help = "for example `sample flank { z: -5 mm .. 5 mm by 11, rho: 48 mm .. 52 mm by 9 }`";
        context.report(Diagnostic::new(Code::SampleShape, path.span, message).help(help));
        return None;
    };
    let row_coordinate = asked(context, (rows, columns), surface, scope);
    let column_coordinate = asked(context, (columns, rows), surface, scope);
    let (row_coordinate, column_coordinate) = (row_coordinate?, column_coordinate?);
    let row_values = values(context, rows, scope, row_coordinate.dimension);
    let column_values = values(context, columns, scope, column_coordinate.dimension);
    let ((row_values, row_ends), (column_values, column_ends)) = (row_values?, column_values?);
    check_size(context, path, row_values.len(), column_values.len())?;
    let counts = [row_values.len(), column_values.len()];
    let grid = SampleGrid::Values([row_values, column_values]);
    let [row_middle, column_middle] = grid.middle(counts);
    Some(Sample {
        labels: [row_coordinate.name.clone(), column_coordinate.name.clone()],
        coordinates: [surface.about(row_coordinate, row_middle), surface.about(column_coordinate, column_middle)],
        counts,
        grid,
        ends: SampleEnds { values: [row_ends, column_ends], corners: None },
        keep: Vec::new(),
        limits: Vec::new(),
    })
}

/// `points: table("gauge.csv", z: length, rho: length)`
fn table(entry: &SampleEntry) -> Option<&ast::Call> {
    match &entry.values {
        SampleValues::Value(Expression { kind: ExpressionKind::Call(call), .. }) if call.function.node == "table" => {
            Some(call)
        }
        _ => None,
    }
}

/// Points one by one, from two columns of a table that are called as the coordinates.
fn tabulated<'g>(
    context: &mut Context<'g>,
    (path, written): (&ast::Path, &ast::Sample),
    (entry, call): (&SampleEntry, &ast::Call),
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<Sample<'g>> {
    let example = "`sample flank { points: table(\"gauge.csv\", z: length, rho: length) }`";
    if entry.key.node != "points" || entry.definition.is_some() {
        let message = format!("a table gives `points`, not `{}`", entry.key.node);
        let help = format!("both coordinates come from it: {example}");
        context.report(Diagnostic::new(Code::SampleShape, entry.key.span, message).help(help));
        return None;
    }
    if let Some(other) = written.entries.iter().find(|other| other.key.node != entry.key.node) {
        let message = format!("`{}` stands beside points from a table", other.key.node);
        let help = format!("the table has both coordinates: {example}; a second sample has a name of its own");
        context.report(Diagnostic::new(Code::SampleShape, other.key.span, message).help(help));
        return None;
    }
    let table = tables::columns(context, call)?;
    let [first, second] = table.columns.map(|(name, dimension)| {
        let found = coordinate(context, (name, None), surface, scope)?;
        if found.dimension == dimension {
            return Some(found);
        }
        let message = format!("coordinate `{}` is {}, not {dimension}", name.node, found.dimension);
        context.report(Diagnostic::new(Code::WrongDimension, name.span, message));
        None
    });
    let coordinates = [first?, second?];
    let rows = table.rows(context)?;
    let points: Vec<[f64; 2]> = rows.iter().map(|(first, second)| [*first, *second]).collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        let message = "the table has no points";
        context.report(Diagnostic::new(Code::SampleShape, table.span, message));
        return None;
    };
    let ends = [0, 1].map(|k| [first, last].map(|point| context.graph.constant(point[k])));
    check_size(context, path, 1, points.len())?;
    let counts = [1, points.len()];
    let grid = SampleGrid::Points(points);
    let middle = grid.middle(counts);
    let [rows, columns] = coordinates;
    Some(Sample {
        labels: ["list".to_string(), "point".to_string()],
        coordinates: [surface.about(rows, middle[0]), surface.about(columns, middle[1])],
        counts,
        grid,
        ends: SampleEnds { values: ends, corners: None },
        keep: Vec::new(),
        limits: Vec::new(),
    })
}

impl<'g> GeneratedSurface<'g> {
    /// The functions of its unknowns that points can be asked for by: `x`, `y`, `z`, `rho` (distance from the z axis),
    /// `polar_angle` (about it, in (−π, π]; see [`GeneratedSurface::about`]), `nx`, `ny`, `nz` (the unit normal out
    /// of the body), then its unknowns by their names.
    pub fn coordinates(&self) -> Vec<Coordinate<'g>> {
        let [x, y, z] = self.surface.position.0;
        let [nx, ny, nz] = self.surface.normal.0;
        let of_point = [
            (x, Dimension::LENGTH),
            (y, Dimension::LENGTH),
            (z, Dimension::LENGTH),
            ((x * x + y * y).sqrt(), Dimension::LENGTH),
            (y.atan2(x), Dimension::ANGLE),
            (nx, Dimension::NUMBER),
            (ny, Dimension::NUMBER),
            (nz, Dimension::NUMBER),
        ];
        let of_point = OF_POINTS.into_iter().zip(of_point).map(|(name, (value, dimension))| (name, value, dimension));
        let unknowns = self.unknowns.iter().map(|u| (u.name.as_str(), u.variable, u.dimension));
        let coordinate =
            |(name, value, dimension): (&str, _, _)| Coordinate { name: name.to_string(), value, dimension };
        of_point.chain(unknowns).map(coordinate).collect()
    }

    /// One of [`GeneratedSurface::coordinates`] by its name, or one that the surface's own sample defines.
    pub fn coordinate(&self, name: &str) -> Option<Coordinate<'g>> {
        let sampled = self.sample.iter().flat_map(|sample| sample.coordinates.iter().cloned());
        self.coordinates().into_iter().chain(sampled).find(|coordinate| coordinate.name == name)
    }

    /// The coordinate itself; a polar angle measured so that it does not jump within half a turn of the middle of the values that it
    /// is asked for at, radians.
    pub fn about(&self, coordinate: Coordinate<'g>, middle: f64) -> Coordinate<'g> {
        if coordinate.name != POLAR_ANGLE || middle == 0.0 {
            return coordinate;
        }
        let [x, y, _] = self.surface.position.0;
        let [sine, cosine, middle] = [middle.sin(), middle.cos(), middle].map(|value| x.graph().constant(value));
        let turned_back = (cosine * y - sine * x).atan2(cosine * x + sine * y);
        Coordinate { value: middle + turned_back, ..coordinate }
    }
}

/// What an expression at the points of a surface may name beside the names of the job.
pub(super) fn scope_at_points<'g>(
    context: &mut Context<'g>,
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
    span: Span,
) -> Option<Scope<'g>> {
    if !context.spend(scope.len(), span) {
        return None;
    }
    let mut scope = scope.clone();
    for known in surface.coordinates() {
        scope.insert(known.name, Value::Scalar(known.value, known.dimension));
    }
    Some(scope)
}

/// Reports an expression at the points of a surface in which something moves that no point of it has: an axis, or a motion that the surface
/// is not made over.
pub(super) fn follows_from_points<'g>(
    context: &mut Context<'g>,
    (value, span): (Expr<'g>, Span),
    surface: &GeneratedSurface<'g>,
    what: &str,
) -> Option<()> {
    let is_of_points = |variable: &Expr<'g>| {
        let role = context.role(*variable);
        let is_known = role.is_some_and(|role| role.stands_still() || role == Role::Quantity);
        is_known || surface.surface.unknowns.contains(variable)
    };
    let variables = context.variables_of(&[value]);
    let Some(other) = variables.into_iter().find(|variable| !is_of_points(variable)) else { return Some(()) };
    let role = context.role(other).map_or("variable", Role::described);
    let message =
        format!("{what} must follow from the points of `{}`, but depends on the {role} `{other}`", surface.name);
    let unknowns: Vec<&str> = surface.unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
    let help = format!("a point has its coordinates, such as `rho` and `z`, and {} of its surface", quoted(&unknowns));
    context.report(Diagnostic::new(Code::NotConstant, span, message).help(help));
    None
}

/// The coordinate of an entry. For one that there is not, another can stand if the second entry has not named it and the values are of its
/// dimension.
fn asked<'g>(
    context: &mut Context<'g>,
    (entry, other): (&SampleEntry, &SampleEntry),
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<Coordinate<'g>> {
    let key = &entry.key;
    if entry.definition.is_some() || key.node.is_empty() || surface.coordinate(&key.node).is_some() {
        return coordinate(context, (key, entry.definition.as_ref()), surface, scope);
    }
    let mut free = surface.coordinates();
    free.retain(|known| known.name != other.key.node);
    if closest(&key.node, free.iter().map(|known| known.name.as_str())).is_none() {
        let first = match &entry.values {
            SampleValues::Range(range, _) => &range.low,
            SampleValues::Value(value) => value,
        };
        let value = context.evaluate(first, scope);
        let first = if let Value::Vector(parts) = &value { parts.first() } else { Some(&value) };
        let dimension = first.and_then(Value::as_scalar).map(|(_, dimension)| dimension);
        // a number may lack its unit
        let dimension = dimension.filter(|dimension| *dimension != Dimension::NUMBER);
        free.retain(|known| dimension.is_none_or(|dimension| known.dimension == dimension));
    }
    context.unknown(key, "coordinate", free.iter().map(|known| known.name.as_str()));
    None
}

pub(super) fn coordinate<'g>(
    context: &mut Context<'g>,
    (key, definition): (&Name, Option<&Expression>),
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<Coordinate<'g>> {
    if let Some(definition) = definition {
        if surface.coordinates().iter().any(|known| known.name == key.node) {
            let message = format!("`{}` is a coordinate of the surface", key.node);
            let help = "give your own coordinate another name";
            context.report(Diagnostic::new(Code::DuplicateName, key.span, message).help(help));
            return None;
        }
        let scope = scope_at_points(context, surface, scope, definition.span)?;
        let value = context.evaluate(definition, &scope);
        let Value::Scalar(value, dimension) = value else {
            if !matches!(value, Value::Poison) {
                let message =
                    format!("a coordinate must be a number, a length or an angle, this is {}", value.described());
                context.report(Diagnostic::new(Code::WrongDimension, definition.span, message));
            }
            return None;
        };
        follows_from_points(context, (value, definition.span), surface, &format!("`{}`", key.node))?;
        return Some(Coordinate { name: key.node.clone(), value, dimension });
    }
    let found = surface.coordinate(&key.node);
    if found.is_none() {
        let known = surface.coordinates();
        context.unknown(key, "coordinate", known.iter().map(|coordinate| coordinate.name.as_str()));
    }
    found
}

/// The values, and the first and the last one as written.
fn values<'g>(
    context: &mut Context<'g>,
    entry: &SampleEntry,
    scope: &Scope<'g>,
    dimension: Dimension,
) -> Option<(Vec<f64>, [Expr<'g>; 2])> {
    let what = format!("`{}`", entry.key.node);
    match &entry.values {
        SampleValues::Value(written) => listed(context, written, scope, dimension, &what),
        SampleValues::Range(range, by) => {
            let ends = context.ends(range, scope, dimension, &what);
            let count = context.scalar(by, scope, Dimension::NUMBER, "the number of points");
            let count = context.require_constant(count?, by.span, "the number of points")?;
            if count.fract() != 0.0 || count < 1.0 {
                let message = format!("the number of points must be a whole number from 1, not {count}");
                let help = "it counts the points, both ends among them, as in `by 5`";
                context.report(Diagnostic::new(Code::SampleShape, by.span, message).help(help));
                return None;
            }
            if count > limits::SAMPLE_POINTS.most as f64 {
                context.report(limits::SAMPLE_POINTS.exceeded(by.span));
                return None;
            }
            let (ends, [low, high]) = ends?;
            let written = if count > 1.0 { [low, high] } else { [0.5 * (low + high); 2] };
            Some((spaced(ends, count as usize), written))
        }
    }
}

/// One value, or those of a vector, which run one way.
fn listed<'g>(
    context: &mut Context<'g>,
    written: &Expression,
    scope: &Scope<'g>,
    dimension: Dimension,
    what: &str,
) -> Option<(Vec<f64>, [Expr<'g>; 2])> {
    let found = match context.evaluate(written, scope) {
        Value::Vector(parts) => parts,
        one => vec![one],
    };
    let mut exprs = Vec::new();
    let mut values: Vec<f64> = Vec::new();
    for (value, place) in found.iter().zip(written.parts(found.len())) {
        let expr = context.require(value, dimension, place.span, what)?;
        let value = context.require_constant(expr, place.span, what)?;
        let runs_on = match values[..] {
            [] => true,
            [first] => value != first,
            [first, second, ..] => {
                (value > values[values.len() - 1]) == (second > first) && value != values[values.len() - 1]
            }
        };
        if !runs_on {
            let [value, last] = [value, values[values.len() - 1]].map(|value| shown(value, dimension));
            let message = format!("the values of {what} run one way, and {value} stands behind {last}");
            let mut unordered =
                Diagnostic::new(Code::SampleShape, place.span, message).help("put them in order, each once");
            unordered.rewritings.extend(ordered(&found, &written.parts(found.len())));
            context.report(unordered);
            return None;
        }
        exprs.push(expr);
        values.push(value);
    }
    let (Some(first), Some(last)) = (exprs.first(), exprs.last()) else {
        let message = format!("{what} has no values");
        let help = "list them, or give a range such as `z: -5 mm .. 5 mm by 11`";
        context.report(Diagnostic::new(Code::SampleShape, written.span, message).help(help));
        return None;
    };
    Some((values, [*first, *last]))
}

/// `count` values evenly from end to end, both included, none beyond them; a single one is the middle.
pub fn spaced((low, high): (f64, f64), count: usize) -> Vec<f64> {
    let share = |k: usize| if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
    let between = |share: f64| low * (1.0 - share) + high * share;
    (0..count).map(|k| between(share(k)).max(low.min(high)).min(low.max(high))).collect()
}

/// The values of a list as they run, each once; nothing where they are not written one by one.
fn ordered(found: &[Value<'_>], written: &[&Expression]) -> Option<Rewriting> {
    let [first, second, ..] = written else { return None };
    let number = |value: &Value<'_>| if let Value::Scalar(expr, _) = value { expr.as_constant() } else { None };
    let entries = found.iter().zip(written).map(|(value, place)| Some((number(value)?, place.span)));
    let mut entries: Vec<(f64, Span)> = entries.collect::<Option<_>>()?;
    let is_falling = entries[1].0 < entries[0].0;
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    entries.dedup_by(|a, b| a.0 == b.0);
    if is_falling {
        entries.reverse();
    }
    let all = first.span.to(written[written.len() - 1].span);
    let spans = entries.into_iter().map(|(_, span)| span).collect();
    (first.span != second.span).then_some(Rewriting::Ordered(all, spans))
}

fn check_size(context: &mut Context<'_>, path: &ast::Path, rows: usize, columns: usize) -> Option<()> {
    context.sample_points = context.sample_points.saturating_add(rows.saturating_mul(columns));
    if context.sample_points <= limits::SAMPLE_POINTS.most {
        return Some(());
    }
    context.report(limits::SAMPLE_POINTS.exceeded(path.span));
    None
}

/// The flank of a blank between four corners `[z, rho]`, divided evenly from root to tip and from toe to heel.
fn outline<'g>(
    context: &mut Context<'g>,
    (path, written): (&ast::Path, &ast::Sample),
    surface: &GeneratedSurface<'g>,
    scope: &Scope<'g>,
) -> Option<Sample<'g>> {
    let mut corners: [Option<Corner<'g>>; 4] = [None; 4];
    let (mut profile, mut length) = (None, None);
    for entry in &written.entries {
        let name = entry.key.node.as_str();
        if let Some(corner) = CORNERS.iter().position(|known| *known == name) {
            corners[corner] = Some(corner_point(context, entry, scope)?);
        } else if name == "profilewise" {
            profile = values(context, entry, scope, Dimension::NUMBER);
            profile.as_ref()?;
        } else if name == "lengthwise" {
            length = values(context, entry, scope, Dimension::NUMBER);
            length.as_ref()?;
        } else {
            context.unknown(
                &entry.key,
                "corner or direction",
                CORNERS.into_iter().chain(["lengthwise", "profilewise"]),
            );
            return None;
        }
    }
    let missing: Vec<&str> = (0..4).filter(|&k| corners[k].is_none()).map(|k| CORNERS[k]).collect();
    if !missing.is_empty() {
        let verb = if missing.len() == 1 { "is" } else { "are" };
        let message = format!("an outline has four corners: {} {verb} missing", quoted(&missing));
        let help = "a corner has its `z` and `rho`, as in `toe_root: [92 mm, 25.7 mm]`";
        context.report(Diagnostic::new(Code::SampleShape, path.span, message).help(help));
        return None;
    }
    let (Some((profile, profile_ends)), Some((length, length_ends))) = (profile, length) else {
        let message = "an outline is divided twice: `profilewise` from root to tip, `lengthwise` from toe to heel";
        let help = "give both as shares, such as `profilewise: 0.05 .. 0.95 by 9`, `lengthwise: 0.05 .. 0.95 by 15`";
        context.report(Diagnostic::new(Code::SampleShape, path.span, message).help(help));
        return None;
    };
    check_size(context, path, profile.len(), length.len())?;
    let [toe_root, heel_root, toe_tip, heel_tip] = corners;
    let corners = [toe_root?, heel_root?, toe_tip?, heel_tip?];
    Some(Sample {
        coordinates: [surface.coordinate("z")?, surface.coordinate("rho")?],
        labels: ["root -> tip".to_string(), "toe -> heel".to_string()],
        counts: [profile.len(), length.len()],
        grid: SampleGrid::Shares { shares: [profile, length], corners: corners.map(|corner| corner.values) },
        ends: SampleEnds { values: [profile_ends, length_ends], corners: Some(corners.map(|corner| corner.written)) },
        keep: Vec::new(),
        limits: Vec::new(),
    })
}

/// z and rho of a corner, as numbers and as written.
#[derive(Clone, Copy)]
struct Corner<'g> {
    values: [f64; 2],
    written: [Expr<'g>; 2],
}

fn corner_point<'g>(context: &mut Context<'g>, entry: &SampleEntry, scope: &Scope<'g>) -> Option<Corner<'g>> {
    let what = format!("`{}`", entry.key.node);
    let SampleValues::Value(written) = &entry.values else {
        let message = format!("{what} is one point `[z, rho]`, not a range");
        context.report(Diagnostic::new(Code::SampleShape, entry.key.span, message));
        return None;
    };
    let parts = match context.evaluate(written, scope) {
        Value::Vector(parts) => parts,
        Value::Poison => return None,
        other => {
            let message = format!("{what} must be a point `[z, rho]`, this is {}", other.described());
            context.report(Diagnostic::new(Code::SampleShape, written.span, message));
            return None;
        }
    };
    let [z, rho] = parts.as_slice() else {
        let message = format!("{what} must be a point `[z, rho]`, this is a vector of {}", parts.len());
        context.report(Diagnostic::new(Code::SampleShape, written.span, message));
        return None;
    };
    let z = context.require(z, Dimension::LENGTH, written.span, format_args!("z of {what}"));
    let rho = context.require(rho, Dimension::LENGTH, written.span, format_args!("rho of {what}"));
    let both = [z?, rho?];
    let values = [
        context.require_constant(both[0], written.span, format_args!("z of {what}"))?,
        context.require_constant(both[1], written.span, format_args!("rho of {what}"))?,
    ];
    Some(Corner { values, written: both })
}

//! What a job is tested by.

mod machine;
pub(crate) mod model;
mod pose;
mod quantities;
mod table;

use std::collections::HashSet;

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::job::sample;
use crate::model::{GeneratedSurface, RangedVariable};
use crate::syntax::ast::{self, ExpressionKind, JobStatement};
use crate::values::context::{Context, Role, suggesting_word};
use crate::values::dimension::{Dimension, shown};
use crate::values::value::{Scope, Value};

use super::Builder;
use model::{Expectation, Expected, ExpectedError};
use quantities::Named;

pub(crate) use machine::of_machine;
pub(crate) use quantities::{numbers_of_contacts, numbers_of_solids};

/// What becomes of points, in the words of tables.
pub(crate) const STATUSES: [&str; 8] =
    ["solved", "undercut", "trimmed", "out_of_range", "ambiguous", "undecided", "singular", "not_converged"];

/// What stands for all sampled surfaces.
const ALL: &str = "all";

/// The target of an expectation, in reports.
const COMPARED: &str = "what the value is compared with";

/// Why expectations never fail.
const SAME: &str = "both sides are the same";
const ITSELF: &str = "it compares a surface with itself";

/// Curvatures of points, by their names in tables.
const CURVATURES: [&str; 4] = ["k1", "k2", "induced_k1", "induced_k2"];
/// What single edges leave over a point of a surface that they cut, by its name in tables.
const LEFT: &str = "left";

/// What is known of the points of a surface beside its unknowns.
fn known_of_points(surface: &GeneratedSurface<'_>) -> Vec<(&'static str, Dimension)> {
    let curvatures = CURVATURES.map(|name| (name, Dimension::LENGTH.power(-1)));
    let left = surface.cut_by.map(|_| (LEFT, Dimension::LENGTH));
    curvatures.into_iter().chain(left).collect()
}

/// Reports something wrong with an expectation.
fn wrong(context: &mut Context<'_>, span: Span, message: String, help: impl Into<String>) {
    context.report(Diagnostic::new(Code::Expectation, span, message).help(help));
}

/// A tolerance, unless nothing is within it.
fn above_zero(context: &mut Context<'_>, within: f64, dimension: Dimension, span: Span) -> Option<f64> {
    if within > 0.0 {
        return Some(within);
    }
    let message = format!("a tolerance is above zero, this is {}", shown(within, dimension));
    wrong(context, span, message, "say by how much the value may differ, such as `within 1 um`");
    None
}

/// An expectation that holds whatever the surface is like; after an error, what it compares may only be missing.
fn never_fails(context: &mut Context<'_>, span: Span, why: &str) {
    if context.has_errors() {
        return;
    }
    let message = format!("this expectation can never fail: {why}");
    let help = "name something that is derived: points of a surface, a number of a contact or a solid, a parameter";
    context.report(Diagnostic::new(Code::NeverFails, span, message).help(help));
}

/// Whether a job has a sample of a surface, or of all pieces of it, under no name of its own.
fn has_sample(job: &ast::Job, path: &ast::Path) -> bool {
    let wanted = path.joined();
    let is_of = |of: &ast::Sampled| {
        let piece = wanted.strip_prefix(&of.surface.joined());
        of.name.is_none() && piece.is_some_and(|piece| piece.is_empty() || piece.starts_with('.'))
    };
    let mut samples = job.statements.iter().filter_map(|statement| match statement {
        JobStatement::Sample(sample) => Some(sample),
        _ => None,
    });
    samples.any(|sample| sample.surfaces.iter().any(is_of))
}

/// The errors that a job is to have; reports codes that there are not.
pub(crate) fn errors(context: &mut Context<'_>, job: &ast::Job) -> Vec<ExpectedError> {
    let mut found = Vec::new();
    for statement in &job.statements {
        let JobStatement::Expect(ast::Expectation { what: ast::Expected::Error(code), .. }) = statement else {
            continue;
        };
        if Code::ALL.iter().any(|known| known.as_str() == code.node) {
            found.push(ExpectedError { job: job.name.node.clone(), code: code.node.clone(), place: code.span });
        } else {
            context.unknown(code, "error", Code::ALL.iter().map(|known| known.as_str()));
        }
    }
    found
}

impl<'g> Builder<'_, 'g> {
    /// All that a job and its machines expect.
    pub(super) fn expectations(&self, context: &mut Context<'g>, job: &ast::Job) -> Vec<Expectation<'g>> {
        let mut found = self.of_machines(context);
        context.unmade.extend(self.lost(job));
        for statement in &job.statements {
            let JobStatement::Expect(written) = statement else { continue };
            let what = self.expected(context, written, job);
            found.extend(what.map(|what| Expectation { what, written: written.span }));
        }
        found
    }

    /// The names that the job declares and that stand for nothing, since something is wrong with them (which has been reported).
    fn lost<'j>(&self, job: &'j ast::Job) -> impl Iterator<Item = String> + 'j {
        let surfaces = self.surfaces.iter().map(|(surface, _)| surface.name.split('.').next().unwrap_or_default());
        let contacts = self.contacts.iter().map(|contact| contact.name.as_str());
        let solids = self.solids.iter().map(|solid| solid.name.as_str());
        let made: HashSet<String> = surfaces.chain(contacts).chain(solids).map(str::to_string).collect();
        let names = job.statements.iter().flat_map(|statement| match statement {
            JobStatement::Surface(surface) => surface.names.iter().collect(),
            JobStatement::Sample(sample) => sample.surfaces.iter().filter_map(|of| of.name.as_ref()).collect(),
            JobStatement::Contact(contact) => vec![&contact.name],
            JobStatement::Solid(solid) => vec![&solid.name],
            _ => Vec::new(),
        });
        names.map(|name| name.node.clone()).filter(move |name| !made.contains(name))
    }

    fn expected(&self, context: &mut Context<'g>, written: &ast::Expectation, job: &ast::Job) -> Option<Expected<'g>> {
        match &written.what {
            ast::Expected::Error(_) | ast::Expected::Nothing | ast::Expected::Pose { .. } => None,
            ast::Expected::Travel => {
                let mut axes = self.machines.iter().flat_map(|(_, _, built)| &built.axes);
                if axes.all(|axis| axis.travel.is_none()) {
                    never_fails(context, written.span, "no axis has a travel");
                }
                Some(Expected::Travel { machine: None })
            }
            ast::Expected::On { machine, within } => {
                let onto = self.standing(context, &machine.definition, &machine.settings);
                let within = self.tolerance(context, within, Dimension::LENGTH);
                Some(Expected::On { onto: Box::new(onto?), machine: None, within: within? })
            }
            ast::Expected::Status { surface, status, at } => self.status(context, (surface, status, at.as_ref()), job),
            ast::Expected::InRange { surface, value, range } => {
                self.in_range(context, (surface.as_ref(), value, range), written.span, job)
            }
            ast::Expected::Near { surface, value, target, within } => {
                self.near(context, (surface.as_ref(), value, target, within), written.span, job)
            }
        }
    }

    fn tolerance(&self, context: &mut Context<'g>, written: &ast::Expression, dimension: Dimension) -> Option<f64> {
        let within = context.scalar(written, &self.scope, dimension, "the tolerance")?;
        let within = context.require_constant(within, written.span, "the tolerance")?;
        above_zero(context, within, dimension, written.span)
    }

    /// A surface with a sample.
    fn sampled_surface(&self, context: &mut Context<'g>, path: &ast::Path, job: &ast::Job) -> Option<usize> {
        let index = self.finished(context, path, job)?;
        if self.surfaces[index].0.sample.is_some() {
            return Some(index);
        }
        let is_reported = context.has_errors() && has_sample(job, path);
        if is_reported || !context.unsampled.insert(path.joined()) {
            return None;
        }
        let message = format!("`{}` is not sampled: nothing says at which points it is expected", path.joined());
        let help = format!("add `sample {} {{ … }}`", path.joined());
        let mut diagnostic = Diagnostic::new(Code::Expectation, path.span, message).help(help);
        if let (Some(sample), Some(end)) = (self.whole_sample(index), self.end) {
            diagnostic = diagnostic.cure(format!("add `{sample}`"), end, format!("    {sample}\n"));
        }
        context.report(diagnostic);
        None
    }

    /// A sample of a surface over the ranges of two unknowns: the last ones, as an envelope binds the first to the others.
    fn whole_sample(&self, index: usize) -> Option<String> {
        let surface = &self.surfaces[index].0;
        let [.., first, second] = surface.unknowns.as_slice() else { return None };
        let entry = |unknown: &RangedVariable<'_>| {
            let [low, high] = [unknown.low, unknown.high].map(|end| shown(end, unknown.dimension));
            (unknown.low < unknown.high).then(|| format!("{}: {low} .. {high} by 9", unknown.name))
        };
        Some(format!("sample {} {{ {}, {} }}", surface.name, entry(first)?, entry(second)?))
    }

    fn status(
        &self,
        context: &mut Context<'g>,
        (surface, status, at): (&ast::Path, &Name, Option<&ast::Expression>),
        job: &ast::Job,
    ) -> Option<Expected<'g>> {
        if !STATUSES.contains(&status.node.as_str()) {
            context.unknown(status, "status of points", STATUSES.into_iter());
            return None;
        }
        let is_all = surface.joined() == ALL && self.surfaces.iter().all(|(of, _)| of.name != ALL);
        let surfaces: Vec<usize> = if is_all {
            (0..self.surfaces.len()).filter(|k| self.surfaces[*k].0.sample.is_some()).collect()
        } else {
            vec![self.sampled_surface(context, surface, job)?]
        };
        if surfaces.is_empty() {
            never_fails(context, surface.span, "no surface of the job is sampled");
        }
        let at = match at {
            None => Vec::new(),
            Some(at) if is_all => {
                let help = "name the surface, as in `expect flank undercut at [46 mm, 0 mm]`";
                wrong(context, at.span, "points are those of one surface".to_string(), help);
                return None;
            }
            Some(at) => self.places(context, at, surfaces[0])?,
        };
        Some(Expected::Status { surfaces, status: status.node.clone(), at })
    }

    /// `[46 mm, 0 mm]`, or a list of such: values of the two coordinates of a sample.
    fn places(&self, context: &mut Context<'g>, written: &ast::Expression, surface: usize) -> Option<Vec<[f64; 2]>> {
        let sample = self.surfaces[surface].0.sample.as_ref()?;
        let dimensions = sample.coordinates.each_ref().map(|coordinate| coordinate.dimension);
        let names = sample.coordinates.each_ref().map(|coordinate| coordinate.name.clone());
        let list = match &written.kind {
            ExpressionKind::Vector(parts)
                if parts.iter().any(|part| matches!(part.kind, ExpressionKind::Vector(_))) =>
            {
                parts.iter().collect()
            }
            _ => vec![written],
        };
        let mut found = Vec::new();
        for place in list {
            let ExpressionKind::Vector(parts) = &place.kind else { return self.no_place(context, place, &names) };
            let [first, second] = parts.as_slice() else { return self.no_place(context, place, &names) };
            let mut at = [0.0; 2];
            for (k, part) in [first, second].into_iter().enumerate() {
                let what = format!("`{}`", names[k]);
                let value = context.scalar(part, &self.scope, dimensions[k], &what)?;
                at[k] = context.require_constant(value, part.span, &what)?;
            }
            found.push(at);
        }
        Some(found)
    }

    fn no_place<T>(&self, context: &mut Context<'g>, at: &ast::Expression, [one, other]: &[String; 2]) -> Option<T> {
        if !matches!(at.kind, ExpressionKind::Error) {
            let message = "a place is given by the two coordinates of the sample".to_string();
            wrong(context, at.span, message, format!("give the values of both, as in `at [{one}, {other}]`"));
        }
        None
    }

    fn in_range(
        &self,
        context: &mut Context<'g>,
        (surface, value, range): (Option<&ast::Path>, &ast::Expression, &ast::Range),
        span: Span,
        job: &ast::Job,
    ) -> Option<Expected<'g>> {
        if let Some(surface) = surface {
            let surface = self.sampled_surface(context, surface, job)?;
            let (scope, known) = self.scope_at_points(context, surface, value.span)?;
            let (value, dimension) = self.scalar_at_points(context, surface, value, &scope)?;
            let (low, high) = context.range(range, &self.scope, dimension, "what is expected")?;
            let ends = [low, high];
            return Some(Expected::AtPoints { surface, value, known, dimension, ends, is_difference: false });
        }
        let mut named = Named { scope: self.scope.clone(), list: Vec::new() };
        let places = [value.span, range.low.span, range.high.span];
        let [value, low, high] =
            [value, &range.low, &range.high].map(|part| self.with_quantities(context, part, job, &mut named));
        let (value, dimension) = scalar(context, &value, &named.scope)?;
        let low = context.scalar(&low, &named.scope, dimension, "the lower end")?;
        let high = context.scalar(&high, &named.scope, dimension, "the upper end")?;
        self.known_once(context, [value, low, high].into_iter().zip(places))?;
        if let Some((low, high)) = low.as_constant().zip(high.as_constant()).filter(|(low, high)| low > high) {
            context.report_empty(range, [low, high], dimension, "what is expected");
            return None;
        }
        self.value(context, (value, [low, high]), dimension, named, span)
    }

    /// Reports parts of an expectation of the whole job in which something moves: they have no one value.
    fn known_once(&self, context: &mut Context<'g>, parts: impl IntoIterator<Item = (Expr<'g>, Span)>) -> Option<()> {
        for (part, span) in parts {
            let moves = |variable: &Expr<'g>| {
                context.role(*variable).is_some_and(|role| !role.stands_still() && role != Role::Quantity)
            };
            let Some(moving) = context.variables_of(&[part]).into_iter().find(moves) else { continue };
            let role = context.role(moving).map_or("variable", Role::described);
            let message = format!("what is expected must stand still, but depends on the {role} `{moving}`");
            let mut diagnostic = Diagnostic::new(Code::NotConstant, span, message);
            let has_it = |surface: &GeneratedSurface<'g>| surface.surface.unknowns.contains(&moving);
            if let Some((surface, _)) = self.surfaces.iter().find(|(surface, _)| has_it(surface)) {
                diagnostic =
                    diagnostic.help(format!("of points it is told with their surface: `expect {}: …`", surface.name));
            }
            context.report(diagnostic);
            return None;
        }
        Some(())
    }

    fn value(
        &self,
        context: &mut Context<'g>,
        (value, ends): (Expr<'g>, [Expr<'g>; 2]),
        dimension: Dimension,
        named: Named<'g>,
        span: Span,
    ) -> Option<Expected<'g>> {
        let all = [value, ends[0], ends[1]];
        let zero = value.graph().constant(0.0);
        // what a job inherits may compare it with itself
        let of_itself = named.list.iter().filter(|(_, quantity)| self.user.is_none() && quantity.is_of_itself());
        let of_itself: Vec<(Expr<'g>, Expr<'g>)> = of_itself.map(|(variable, _)| (*variable, zero)).collect();
        let known = value.graph().substitute(&all, &of_itself);
        if context.variables_of(&known).is_empty() {
            let numbers: Vec<f64> = known.iter().map(|expr| expr.as_constant().unwrap_or(f64::NAN)).collect();
            if numbers[1] <= numbers[0] && numbers[0] <= numbers[2] {
                never_fails(context, span, if of_itself.is_empty() { "it compares constants" } else { ITSELF });
            }
        }
        Some(Expected::Value { value, ends, quantities: named.list, dimension })
    }

    fn near(
        &self,
        context: &mut Context<'g>,
        (surface, value, target, within): (Option<&ast::Path>, &ast::Expression, &ast::Expression, &ast::Expression),
        span: Span,
        job: &ast::Job,
    ) -> Option<Expected<'g>> {
        if let Some(surface) = surface {
            let surface = self.sampled_surface(context, surface, job)?;
            let (scope, known) = self.scope_at_points(context, surface, span)?;
            let (value, dimension) = self.scalar_at_points(context, surface, value, &scope)?;
            let place = target.span;
            let target = context.scalar(target, &scope, dimension, COMPARED)?;
            self.follows_from_points(context, surface, (target, place), COMPARED)?;
            let within = self.tolerance(context, within, dimension)?;
            let (value, ends) = (value - target, [-within, within]);
            if value.as_constant() == Some(0.0) {
                never_fails(context, span, SAME);
            }
            return Some(Expected::AtPoints { surface, value, known, dimension, ends, is_difference: true });
        }
        if let Some(surface) = self.as_surface(value, job) {
            return self.surface_near(context, (surface, target, within), span, job);
        }
        let mut named = Named { scope: self.scope.clone(), list: Vec::new() };
        let places = [value.span, target.span];
        let [value, target] = [value, target].map(|part| self.with_quantities(context, part, job, &mut named));
        let (value, dimension) = scalar(context, &value, &named.scope)?;
        let target = context.scalar(&target, &named.scope, dimension, COMPARED)?;
        self.known_once(context, [value, target].into_iter().zip(places))?;
        let within = self.tolerance(context, within, dimension)?;
        if value.as_constant().is_none() && (value - target).as_constant() == Some(0.0) {
            never_fails(context, span, SAME);
        }
        self.value(context, (value, [target - within, target + within]), dimension, named, span)
    }

    /// The path of a surface of the job, built, or declared and wrong.
    fn as_surface<'e>(&self, value: &'e ast::Expression, job: &ast::Job) -> Option<&'e ast::Path> {
        let ExpressionKind::Path(path) = &value.kind else { return None };
        let owner = &path.segments[0].node;
        let is_one = self.surfaces.iter().any(|(surface, _)| super::available::is_of(&surface.name, owner))
            || super::declared(job).any(|name| name == owner);
        (is_one && !self.scope.contains_key(&path.joined())).then_some(path)
    }

    fn surface_near(
        &self,
        context: &mut Context<'g>,
        (path, target, within): (&ast::Path, &ast::Expression, &ast::Expression),
        span: Span,
        job: &ast::Job,
    ) -> Option<Expected<'g>> {
        let surface = self.finished(context, path, job)?;
        match &target.kind {
            ExpressionKind::Call(call) if call.function.node == "table" => {
                let (columns, rows, dimension) = table::read(context, call, &self.surfaces[surface].0)?;
                let within = self.tolerance(context, within, dimension)?;
                Some(Expected::Table { surface, columns, rows, within })
            }
            ExpressionKind::Path(other) if self.surface_named(other, job).is_some() => {
                let other = self.surface_named(other, job)?;
                let within = self.tolerance(context, within, Dimension::LENGTH)?;
                // what a job inherits may compare it with itself
                let is_own = other == format!("{}.{}", job.name.node, path.joined());
                if is_own && self.user.is_none() {
                    never_fails(context, span, ITSELF);
                }
                Some(Expected::Surface { surface, other, within })
            }
            _ => {
                let surface = self.sampled_surface(context, path, job)?;
                let (scope, known) = self.scope_at_points(context, surface, span)?;
                let wanted: [Expr<'g>; 3] = context.vector(target, &scope, Dimension::LENGTH, "a position")?;
                for part in wanted {
                    self.follows_from_points(context, surface, (part, target.span), COMPARED)?;
                }
                let within = self.tolerance(context, within, Dimension::LENGTH)?;
                let position = self.surfaces[surface].0.surface.position.0;
                let apart = [0, 1, 2].map(|k| position[k] - wanted[k]);
                let value = (apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]).sqrt();
                if apart.iter().all(|part| part.as_constant() == Some(0.0)) {
                    never_fails(context, span, "it compares a surface with its own coordinates");
                }
                let (dimension, ends) = (Dimension::LENGTH, [0.0, within]);
                Some(Expected::AtPoints { surface, value, known, dimension, ends, is_difference: true })
            }
        }
    }

    /// What an expression at the points of a surface may name: all that a sample's coordinates may, curvatures, and what edges leave.
    fn scope_at_points(
        &self,
        context: &mut Context<'g>,
        surface: usize,
        span: Span,
    ) -> Option<(Scope<'g>, Vec<(&'static str, Expr<'g>)>)> {
        let mut scope = sample::scope_at_points(context, &self.surfaces[surface].0, &self.scope, span)?;
        let mut known = Vec::new();
        for (name, dimension) in known_of_points(&self.surfaces[surface].0) {
            // `left` is also a word for one of two sides, and what a job calls so is meant
            if name == LEFT && scope.contains_key(name) {
                continue;
            }
            let variable = context.variable(name, Role::Quantity, f64::NAN);
            scope.insert(name.to_string(), Value::Scalar(variable, dimension));
            known.push((name, variable));
        }
        Some((scope, known))
    }

    fn scalar_at_points(
        &self,
        context: &mut Context<'g>,
        surface: usize,
        written: &ast::Expression,
        scope: &Scope<'g>,
    ) -> Option<(Expr<'g>, Dimension)> {
        let (value, dimension) = scalar(context, written, scope)?;
        self.follows_from_points(context, surface, (value, written.span), "what is expected")?;
        Some((value, dimension))
    }

    fn follows_from_points(
        &self,
        context: &mut Context<'g>,
        surface: usize,
        value: (Expr<'g>, Span),
        what: &str,
    ) -> Option<()> {
        sample::follows_from_points(context, value, &self.surfaces[surface].0, what)
    }
}

/// A scalar of any dimension.
fn scalar<'g>(
    context: &mut Context<'g>,
    written: &ast::Expression,
    scope: &Scope<'g>,
) -> Option<(Expr<'g>, Dimension)> {
    match context.evaluate(written, scope) {
        Value::Scalar(value, dimension) => Some((value, dimension)),
        Value::Poison => None,
        other => {
            let message = format!("what is expected is a number, a length or an angle, this is {}", other.described());
            context.report(Diagnostic::new(Code::WrongDimension, written.span, message));
            None
        }
    }
}

/// Whether surfaces of other jobs that expectations name are there; `known` has all of the file with their jobs.
pub(crate) fn check_others<'e, 'g: 'e>(
    context: &mut Context<'_>,
    expectations: impl Iterator<Item = &'e Expectation<'g>>,
    known: &[String],
) {
    for expectation in expectations {
        let named: Vec<&String> = match &expectation.what {
            Expected::Surface { other, .. } => vec![other],
            Expected::Value { quantities, .. } => quantities
                .iter()
                .filter_map(|(_, quantity)| match quantity {
                    model::Quantity::Deviation { surfaces, .. } => Some(&surfaces[1]),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        };
        for name in named.into_iter().filter(|name| !known.contains(name)) {
            let message = format!("there is no surface `{name}` in this file");
            let diagnostic = Diagnostic::new(Code::UnknownName, expectation.written, message);
            context.report(suggesting_word(diagnostic, name, known.iter().map(String::as_str)));
        }
    }
}

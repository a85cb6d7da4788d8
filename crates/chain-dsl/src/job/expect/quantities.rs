//! What expectations name that is known once a job is solved: `drive_side.ratio`, `rms(concave, plain.concave)`.

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Name;
use crate::model::Contact;
use crate::syntax::ast::{self, Argument, Call, Expression, ExpressionKind};
use crate::values::context::{Context, Role};
use crate::values::dimension::Dimension;
use crate::values::value::{Scope, Value};

use super::super::Builder;
use super::model::{ContactNumber, DeviationNumber, PointSet, Quantity, SolidNumber};

/// Of contacts, as `drive_side.ratio`.
const CONTACT_NUMBERS: [(&str, ContactNumber); 17] = [
    ("ratio", ContactNumber::Ratio),
    ("peak_to_peak", ContactNumber::PeakToPeak),
    ("turn", ContactNumber::Turn),
    ("lag", ContactNumber::Lag),
    ("parabola", ContactNumber::Parabola),
    ("backlash", ContactNumber::Backlash),
    ("normal_backlash", ContactNumber::NormalBacklash),
    ("clearance", ContactNumber::Clearance),
    ("half_length", ContactNumber::HalfLength),
    ("half_width", ContactNumber::HalfWidth),
    ("gap_high", ContactNumber::GapHigh),
    ("gap_low", ContactNumber::GapLow),
    ("pairs", ContactNumber::Pairs),
    ("z1", ContactNumber::Z(0)),
    ("rho1", ContactNumber::Rho(0)),
    ("z2", ContactNumber::Z(1)),
    ("rho2", ContactNumber::Rho(1)),
];

/// Of bodies, as `gear.volume`.
const SOLID_NUMBERS: [(&str, SolidNumber, Dimension); 5] = [
    ("volume", SolidNumber::Volume, Dimension { length: 3, angle: 0 }),
    ("area", SolidNumber::Area, Dimension { length: 2, angle: 0 }),
    ("tip_diameter", SolidNumber::TipDiameter, Dimension::LENGTH),
    ("root_diameter", SolidNumber::RootDiameter, Dimension::LENGTH),
    ("form_diameter", SolidNumber::FormDiameter, Dimension::LENGTH),
];

/// Of contacts, by their names.
pub(crate) fn numbers_of_contacts() -> impl Iterator<Item = &'static str> {
    CONTACT_NUMBERS.iter().map(|(name, _)| *name)
}

/// Of bodies, by their names.
pub(crate) fn numbers_of_solids() -> impl Iterator<Item = &'static str> {
    SOLID_NUMBERS.iter().map(|(name, ..)| *name)
}

/// Of bodies with a number, as `thickness(gear, 93 mm)`.
const SOLID_FUNCTIONS: [&str; 3] = ["thickness", "span", "over_balls"];
/// Of two surfaces, as `rms(concave, plain.concave)`.
const DEVIATION_FUNCTIONS: [&str; 7] = ["turn", "rms", "lowest", "highest", "slope", "crowning", "bias"];
/// Of points, as `lowest(flank, rho)`.
const EXTREMES: [&str; 2] = ["lowest", "highest"];
const POSITION: &str = "position";

/// Lines on surfaces, as `lowest(flank.singular_line, rho)`.
const LINES: [(&str, PointSet); 3] = [
    ("singular_line", PointSet::SingularLine),
    ("contact_limit", PointSet::ContactLimit),
    ("trim_line", PointSet::Trim),
];

fn number(of: ContactNumber, contact: &Contact<'_>) -> Dimension {
    let (roll, lag) = (contact.roll.dimension, contact.lag.dimension);
    match of {
        ContactNumber::Ratio | ContactNumber::Pairs => Dimension::NUMBER,
        ContactNumber::PeakToPeak | ContactNumber::Lag | ContactNumber::Backlash => lag,
        ContactNumber::Turn => roll,
        ContactNumber::Parabola => lag.over(roll.power(2)),
        ContactNumber::GapHigh | ContactNumber::GapLow => Dimension::LENGTH.power(-1),
        ContactNumber::NormalBacklash
        | ContactNumber::Clearance
        | ContactNumber::HalfLength
        | ContactNumber::HalfWidth
        | ContactNumber::Z(_)
        | ContactNumber::Rho(_) => Dimension::LENGTH,
    }
}

/// Quantities of one expectation: each stands in the expression as a name that no text can write.
pub(super) struct Named<'g> {
    pub(super) scope: Scope<'g>,
    pub(super) list: Vec<(Expr<'g>, Quantity<'g>)>,
}

impl<'g> Named<'g> {
    fn name(
        &mut self,
        context: &mut Context<'g>,
        at: &Expression,
        quantity: Quantity<'g>,
        dimension: Dimension,
    ) -> Expression {
        let name = format!("#{}", self.list.len());
        let variable = context.variable(name.clone(), Role::Quantity, f64::NAN);
        self.scope.insert(name.clone(), Value::Scalar(variable, dimension));
        self.list.push((variable, quantity));
        let segments = vec![Name { node: name, span: at.span }];
        Expression { kind: ExpressionKind::Path(ast::Path { segments, span: at.span }), span: at.span }
    }
}

impl<'g> Builder<'_, 'g> {
    /// An expression in which quantities have names.
    pub(super) fn with_quantities(
        &self,
        context: &mut Context<'g>,
        written: &Expression,
        job: &ast::Job,
        named: &mut Named<'g>,
    ) -> Expression {
        let found = match &written.kind {
            ExpressionKind::Path(path) => self.number_of(context, path),
            ExpressionKind::Call(call) => self.function_of(context, call, job),
            _ => Found::Other,
        };
        match found {
            Found::Quantity(quantity, dimension) => return named.name(context, written, *quantity, dimension),
            Found::Wrong => return Expression { kind: ExpressionKind::Error, span: written.span },
            Found::Other => {}
        }
        let mut inner = |part: &Expression| self.with_quantities(context, part, job, named);
        let kind = match &written.kind {
            ExpressionKind::Call(call) => {
                let arguments = call.arguments.iter();
                let arguments =
                    arguments.map(|of| Argument { name: of.name.clone(), value: inner(&of.value) }).collect();
                ExpressionKind::Call(Call { arguments, ..call.clone() })
            }
            ExpressionKind::Vector(parts) => ExpressionKind::Vector(parts.iter().map(inner).collect()),
            ExpressionKind::Index(a, b) => ExpressionKind::Index(Box::new(inner(a)), b.clone()),
            ExpressionKind::Unary(sign, a) => ExpressionKind::Unary(sign.clone(), Box::new(inner(a))),
            ExpressionKind::Binary(sign, a, b) => {
                ExpressionKind::Binary(sign.clone(), Box::new(inner(a)), Box::new(inner(b)))
            }
            ExpressionKind::If(a, b, c) => {
                ExpressionKind::If(Box::new(inner(a)), Box::new(inner(b)), Box::new(inner(c)))
            }
            other => other.clone(),
        };
        Expression { kind, span: written.span }
    }

    /// `drive_side.ratio`, `gear.volume`
    fn number_of(&self, context: &mut Context<'g>, path: &ast::Path) -> Found<'g> {
        let [of, member] = path.segments.as_slice() else { return Found::Other };
        if let Some(contact) = self.contacts.iter().position(|contact| contact.name == of.node) {
            let Some((_, found)) = CONTACT_NUMBERS.iter().find(|(name, _)| *name == member.node) else {
                context.unknown(member, "number of a contact", CONTACT_NUMBERS.iter().map(|(name, _)| *name));
                return Found::Wrong;
            };
            let dimension = number(*found, &self.contacts[contact]);
            return Found::quantity(Quantity::Contact { contact, number: *found }, dimension);
        }
        if let Some(solid) = self.solids.iter().position(|solid| solid.name == of.node) {
            let Some((_, number, dimension)) = SOLID_NUMBERS.iter().find(|(name, ..)| *name == member.node) else {
                context.unknown(member, "number of a solid", SOLID_NUMBERS.iter().map(|(name, ..)| *name));
                return Found::Wrong;
            };
            return Found::quantity(Quantity::Solid { solid, number: *number }, *dimension);
        }
        Found::Other
    }

    fn function_of(&self, context: &mut Context<'g>, call: &Call, job: &ast::Job) -> Found<'g> {
        let name = call.function.node.as_str();
        let is_one = SOLID_FUNCTIONS.contains(&name) || DEVIATION_FUNCTIONS.contains(&name) || name == POSITION;
        // a function of the spec has the name first
        if !is_one || context.functions.contains_key(name) {
            return Found::Other;
        }
        let found = if name == POSITION {
            self.position(context, call)
        } else if SOLID_FUNCTIONS.contains(&name) {
            self.of_solid(context, call)
        } else {
            self.of_surfaces(context, call, job)
        };
        found.unwrap_or(Found::Wrong)
    }

    /// `thickness(gear, 93 mm)`
    fn of_solid(&self, context: &mut Context<'g>, call: &Call) -> Option<Found<'g>> {
        let name = call.function.node.as_str();
        let [of, at] = call.arguments.as_slice() else {
            return wrong_call(context, call, "a solid and a size", "`thickness(gear, 93 mm)`");
        };
        let ExpressionKind::Path(path) = &of.value.kind else {
            return wrong_call(context, call, "a solid and a size", "`thickness(gear, 93 mm)`");
        };
        let Some(solid) = self.solids.iter().position(|solid| solid.name == path.joined()) else {
            let own = Name { node: path.joined(), span: path.span };
            context.unknown(&own, "solid", self.solids.iter().map(|solid| solid.name.as_str()));
            return None;
        };
        let wanted = if name == "span" { Dimension::NUMBER } else { Dimension::LENGTH };
        let size = context.scalar(&at.value, &self.scope, wanted, "the size")?;
        let size = context.require_constant(size, at.value.span, "the size")?;
        let number = match name {
            "span" => SolidNumber::Span(size as u32),
            "thickness" => SolidNumber::Thickness(size),
            _ => SolidNumber::OverBalls(size),
        };
        Some(Found::quantity(Quantity::Solid { solid, number }, Dimension::LENGTH))
    }

    /// `rms(concave, plain.concave)`, `lowest(flank, rho)`
    fn of_surfaces(&self, context: &mut Context<'g>, call: &Call, job: &ast::Job) -> Option<Found<'g>> {
        let name = call.function.node.as_str();
        let example =
            "`rms(concave, plain.concave)`, `slope(concave, plain.concave, lengthwise)`, `lowest(flank, rho)`";
        let what = "two surfaces, or a surface and a function of its points";
        let (Some(first), Some(second)) = (call.arguments.first(), call.arguments.get(1)) else {
            return wrong_call(context, call, what, example);
        };
        let ExpressionKind::Path(of) = &first.value.kind else { return wrong_call(context, call, what, example) };
        let other = match &second.value.kind {
            ExpressionKind::Path(path) if context.is_unmade(&path.segments[0].node) => return None,
            ExpressionKind::Path(path) => self.surface_named(path, job),
            _ => None,
        };
        let Some(other) = other else {
            if !EXTREMES.contains(&name) {
                return wrong_call(context, call, what, example);
            }
            let (surface, over) = self.point_set(context, of, job)?;
            let (scope, known) = self.scope_at_points(context, surface, second.value.span)?;
            let (value, dimension) = self.scalar_at_points(context, surface, &second.value, &scope)?;
            let is_highest = name == "highest";
            return Some(Found::quantity(Quantity::Extreme { surface, over, value, known, is_highest }, dimension));
        };
        let surface = self.finished(context, of, job)?;
        let own = format!("{}.{}", job.name.node, self.surfaces[surface].0.name);
        let third = call.arguments.get(2).map(|direction| self.direction(context, direction, surface));
        let number = match (name, third) {
            ("turn", None) => DeviationNumber::Turn,
            ("rms", None) => DeviationNumber::Rms,
            ("lowest", None) => DeviationNumber::Lowest,
            ("highest", None) => DeviationNumber::Highest,
            ("bias", None) => DeviationNumber::Bias,
            ("slope", Some(direction)) => DeviationNumber::Slope(direction?),
            ("crowning", Some(direction)) => DeviationNumber::Crowning(direction?),
            _ => return wrong_call(context, call, what, example),
        };
        let dimension = if name == "turn" { Dimension::ANGLE } else { Dimension::LENGTH };
        Some(Found::quantity(Quantity::Deviation { surfaces: [own, other], number }, dimension))
    }

    /// The rows (0) or columns (1) of the sample of a surface.
    fn direction(&self, context: &mut Context<'g>, written: &Argument, surface: usize) -> Option<usize> {
        let labels = self.surfaces[surface].0.sample.as_ref().map(|sample| sample.labels.clone());
        let labels = labels.unwrap_or_default();
        let ExpressionKind::Path(path) = &written.value.kind else { return None };
        let word = match path.joined().as_str() {
            "profilewise" => "root -> tip".to_string(),
            "lengthwise" => "toe -> heel".to_string(),
            other => other.to_string(),
        };
        let found = labels.iter().position(|label| *label == word);
        if found.is_none() {
            let name = Name { node: path.joined(), span: path.span };
            let known = labels.iter().map(|label| match label.as_str() {
                "root -> tip" => "profilewise",
                "toe -> heel" => "lengthwise",
                other => other,
            });
            context.unknown(&name, "direction of the sample", known);
        }
        found
    }

    /// `flank`, or a line on it, `flank.singular_line`.
    fn point_set(&self, context: &mut Context<'g>, path: &ast::Path, job: &ast::Job) -> Option<(usize, PointSet)> {
        let line = path.segments.split_last().filter(|(_, rest)| !rest.is_empty());
        if let Some((last, rest)) = line
            && let Some((_, set)) = LINES.iter().find(|(name, _)| *name == last.node)
        {
            let of = ast::Path { segments: rest.to_vec(), span: path.span };
            return Some((self.finished(context, &of, job)?, *set));
        }
        Some((self.finished(context, path, job)?, PointSet::Sample))
    }

    /// The whole name of a surface of this job or of another one, if it can be one.
    pub(super) fn surface_named(&self, path: &ast::Path, job: &ast::Job) -> Option<String> {
        let wanted = path.joined();
        let is_own = self.surfaces.iter().any(|(surface, _)| surface.name == wanted);
        if is_own {
            return Some(format!("{}.{wanted}", job.name.node));
        }
        let is_elsewhere = path.segments.len() > 1 && !self.names.contains_key(&path.segments[0].node);
        (is_elsewhere && !self.scope.contains_key(&wanted)).then_some(wanted)
    }

    /// `position(free_form, X, roll: 5 deg)`
    fn position(&self, context: &mut Context<'g>, call: &Call) -> Option<Found<'g>> {
        let example = "`position(free_form, X, roll: 5 deg)`";
        let what = "a machine, an axis of it, and where the job's motions are";
        let [machine, axis, at @ ..] = call.arguments.as_slice() else {
            return wrong_call(context, call, what, example);
        };
        let (definition, settings) = match &machine.value.kind {
            ExpressionKind::Path(path) if path.segments.len() == 1 => (path.segments[0].clone(), Vec::new()),
            ExpressionKind::Call(call) => (call.function.clone(), call.arguments.clone()),
            _ => return wrong_call(context, call, what, example),
        };
        let ExpressionKind::Path(axis) = &axis.value.kind else { return wrong_call(context, call, what, example) };
        let onto = self.standing(context, &definition, &settings)?;
        let found = onto.machines.first().and_then(|machine| machine.axes.iter().find(|of| of.name == axis.joined()));
        let Some(found) = found else {
            let name = Name { node: axis.joined(), span: axis.span };
            let known = onto.machines.iter().flat_map(|machine| machine.axes.iter().map(|axis| axis.name.as_str()));
            context.unknown(&name, "axis", known);
            return None;
        };
        let dimension = found.dimension;
        let mut values = vec![None; self.motions.len()];
        for argument in at {
            let Some(name) = &argument.name else { return wrong_call(context, call, what, example) };
            let Some(motion) = self.motions.iter().position(|motion| motion.name == name.node) else {
                context.unknown(name, "motion", self.motions.iter().map(|motion| motion.name.as_str()));
                return None;
            };
            let value = context.scalar(
                &argument.value,
                &self.scope,
                self.motions[motion].dimension,
                "the position of a motion",
            )?;
            values[motion] = Some(context.require_constant(value, argument.value.span, "the position of a motion")?);
        }
        let quantity = Quantity::Position { onto: Box::new(onto), axis: axis.joined(), at: values };
        Some(Found::quantity(quantity, dimension))
    }
}

/// What a part of an expression is.
enum Found<'g> {
    Quantity(Box<Quantity<'g>>, Dimension),
    /// Wrong, which has been reported.
    Wrong,
    Other,
}

impl<'g> Found<'g> {
    fn quantity(quantity: Quantity<'g>, dimension: Dimension) -> Found<'g> {
        Found::Quantity(Box::new(quantity), dimension)
    }
}

fn wrong_call<T>(context: &mut Context<'_>, call: &Call, takes: &str, example: &str) -> Option<T> {
    let message = format!("`{}` takes {takes}", call.function.node);
    context.report(Diagnostic::new(Code::WrongArguments, call.span, message).help(format!("for example {example}")));
    None
}

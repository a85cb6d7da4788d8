//! What machines expect: in each job that uses them, and by themselves.

use std::collections::HashMap;
use std::path::Path;

use flank_expr::Expr;
use flank_expr::geometry::{Chain, Vector3};

use crate::definitions::instance::Overrides;
use crate::definitions::transforms;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::Name;
use crate::job::{Builder, Definitions, posed, standing};
use crate::model::{Axis, Job, LawSource, Machine};
use crate::syntax::ast::{self, Argument, MachineStatement};
use crate::values::context::Context;
use crate::values::dimension::{Dimension, shown};
use crate::values::value::{Scope, Value};

use super::model::{Expectation, Expected};
use super::{never_fails, wrong};

impl<'g> Builder<'_, 'g> {
    /// Another machine by itself, with constants for its settings.
    pub(super) fn standing(
        &self,
        context: &mut Context<'g>,
        definition: &Name,
        settings: &[Argument],
    ) -> Option<Job<'g>> {
        let machines = self.definitions.machines;
        let Some(machine) = machines.get(&definition.node) else {
            context.unknown_item(definition, "machine", machines.keys().map(String::as_str));
            return None;
        };
        let own = overrides(machine, settings);
        let definitions = Definitions { overrides: &own, ..*self.definitions };
        Some(standing(context, machine, &definitions, Path::new("")))
    }

    /// What the machines of the job expect of all that use them.
    pub(super) fn of_machines(&self, context: &mut Context<'g>) -> Vec<Expectation<'g>> {
        let mut found = Vec::new();
        for (name, _, built) in &self.machines {
            for written in &built.expectations {
                let machine = Some(name.node.clone());
                let what = match &written.what {
                    ast::Expected::Travel => Some(Expected::Travel { machine }),
                    ast::Expected::On { machine: onto, within } => {
                        let onto = self.standing(context, &onto.definition, &onto.settings);
                        let within = constant(context, within, Dimension::LENGTH, "the tolerance");
                        onto.zip(within).map(|(onto, within)| Expected::On { onto: Box::new(onto), machine, within })
                    }
                    _ => None,
                };
                found.extend(what.map(|what| Expectation { what, written: written.span }));
            }
        }
        found
    }
}

/// What settings of a machine override, by their whole names.
fn overrides(machine: &ast::Machine, settings: &[Argument]) -> Overrides {
    let given = settings.iter().filter_map(|setting| Some((setting.name.as_ref()?, setting.value.clone())));
    given.map(|(name, value)| (format!("{}.{}", machine.name.node, name.node), value)).collect()
}

/// The poses that a machine expects, by itself.
pub(crate) fn of_machine<'g>(
    context: &mut Context<'g>,
    machine: &ast::Machine,
    definitions: &Definitions<'_>,
) -> Vec<Expectation<'g>> {
    let mut found = Vec::new();
    let mut plain = None;
    for statement in &machine.statements {
        let MachineStatement::Expect(written) = statement else { continue };
        match &written.what {
            ast::Expected::Pose { frames, transforms, at, within } => {
                let pose = Pose { machine, frames, transforms, at };
                let plain = plain.get_or_insert_with(|| posed(context, machine, definitions, None));
                let what = pose.expected(context, within, (definitions, plain));
                found.extend(what.map(|what| Expectation { what, written: written.span }));
            }
            ast::Expected::Travel => {
                let ends = machine
                    .statements
                    .iter()
                    .any(|statement| matches!(statement, MachineStatement::Axis(axis) if axis.range.is_some()));
                if !ends && machine.extends.is_none() {
                    never_fails(context, written.span, "no axis has a travel");
                }
            }
            _ => {}
        }
    }
    found
}

/// Where a frame of a machine is to stand.
struct Pose<'a> {
    machine: &'a ast::Machine,
    frames: &'a [Name; 2],
    transforms: &'a [ast::Call],
    at: &'a [Argument],
}

impl Pose<'_> {
    /// `plain` is the machine as it stands, with open loops.
    fn expected<'g>(
        &self,
        context: &mut Context<'g>,
        within: &ast::Expression,
        (definitions, plain): (&Definitions<'_>, &Job<'g>),
    ) -> Option<Expected<'g>> {
        let within = constant(context, within, Dimension::LENGTH, "the tolerance")?;
        let plain_machine = plain.machines.first()?;
        let is_axis = |name: &Name| plain_machine.axes.iter().any(|axis| axis.name == name.node);
        let own = |argument: &&Argument| argument.name.as_ref().is_some_and(is_axis);
        let (axes, settings): (Vec<&Argument>, Vec<&Argument>) = self.at.iter().partition(own);
        for setting in &settings {
            let Some(name) = &setting.name else { continue };
            let whole = format!("{}.{}", self.machine.name.node, name.node);
            if !plain.settings.iter().any(|known| known.name == whole) {
                let axes = plain_machine.axes.iter().map(|axis| axis.name.as_str());
                context.unknown(name, "axis or setting", axes);
                return None;
            }
        }
        let mut values = Vec::new();
        for argument in axes {
            let name = argument.name.as_ref()?;
            let axis = plain_machine.axes.iter().find(|axis| axis.name == name.node)?;
            values.push((name, self.axis_value(context, axis, name, argument)?));
        }
        let settings: Vec<Argument> = settings.into_iter().cloned().collect();
        let own = overrides(self.machine, &settings);
        let definitions = Definitions { overrides: &own, ..*definitions };
        let places: Vec<(&str, f64)> = values.iter().map(|(name, value)| (name.node.as_str(), *value)).collect();
        // where neither settings nor loops ask for it, it is not built again
        let is_plain = own.is_empty() && plain_machine.axes.iter().all(|axis| axis.source != LawSource::Closed);
        let findings = context.findings();
        let again = (!is_plain).then(|| posed(context, self.machine, &definitions, Some(&places)));
        // a loop that does not close has been reported
        if context.findings() > findings {
            return None;
        }
        let job = again.as_ref().unwrap_or(plain);
        let machine = job.machines.first()?;
        let [frame, reference] = self.frames;
        let frames: Vec<&str> = machine.frames.iter().map(|frame| frame.name.as_str()).collect();
        for name in [frame, reference] {
            if !frames.contains(&name.node.as_str()) {
                context.unknown(name, "frame", frames.iter().copied());
                return None;
            }
        }
        let chain = machine.chain(context.graph, &reference.node, &frame.node)?;
        let values = self.replacements(context, machine, &places, &chain)?;
        let scope = names(job, machine);
        let wanted = Chain::new(context.graph, transforms::steps(context, self.transforms, &scope)?);
        let [is, wanted] =
            [chain, wanted].map(|chain| values.iter().fold(chain, |chain, with| chain.substituted(with)));
        let off = context.graph.evaluate(&apart(&is, &wanted, context), context.values()).into_iter().fold(0.0, worst);
        if off.is_finite() {
            return Some(Expected::Pose { off, within });
        }
        let open = job.settings.iter().find(|setting| !job.has_parameter(&setting.name));
        let open = open.map_or("a setting", |setting| setting.name.as_str());
        let message = format!("the pose of `{}` is not a number: {open} has no value", frame.node);
        let place = self.at.first().map_or(frame.span, |argument| argument.value.span);
        wrong(context, place, message, "give axes and settings their values, as in `at (X: 10 mm, tilt: 3 deg)`");
        None
    }

    /// Where a free axis stands.
    fn axis_value<'g>(
        &self,
        context: &mut Context<'g>,
        axis: &Axis<'g>,
        name: &Name,
        argument: &Argument,
    ) -> Option<f64> {
        let entry = Rewriting::Entry(name.span.to(argument.value.span));
        let lawful = |context: &mut Context<'g>, message: String| {
            let help = "leave it out: a pose is that of the axes that are free";
            context.report(Diagnostic::new(Code::Expectation, name.span, message).help(help).rewriting(entry));
            None
        };
        match axis.source {
            LawSource::Free => {}
            LawSource::Closed => {
                return lawful(
                    context,
                    format!("axis `{}` is unknown: a loop of its machine says where it stands", axis.name),
                );
            }
            LawSource::Fixed | LawSource::Coupled | LawSource::Driven => {
                return lawful(
                    context,
                    format!("axis `{}` has a law of its machine: it stands where that says", axis.name),
                );
            }
        }
        let what = format!("axis `{}`", axis.name);
        let value = constant(context, &argument.value, axis.dimension, &what)?;
        if let Some((low, high)) = axis.travel.filter(|(low, high)| value < *low || value > *high) {
            let [value, low, high] = [value, low, high].map(|value| shown(value, axis.dimension));
            let message = format!("{what} stands at {value}, its travel is {low} .. {high}");
            context.report(Diagnostic::new(Code::OutOfRange, argument.value.span, message));
            return None;
        }
        Some(value)
    }

    /// Laws of the axes, then the values of those that are free.
    fn replacements<'g>(
        &self,
        context: &mut Context<'g>,
        machine: &Machine<'g>,
        places: &[(&str, f64)],
        chain: &Chain<'g>,
    ) -> Option<[Vec<(Expr<'g>, Expr<'g>)>; 2]> {
        let (free, driven): (Vec<&Axis<'g>>, Vec<&Axis<'g>>) =
            machine.axes.iter().partition(|axis| axis.law == axis.variable);
        let laws: Vec<(Expr<'g>, Expr<'g>)> = driven.into_iter().map(|axis| (axis.variable, axis.law)).collect();
        let by_laws = chain.substituted(&laws);
        let mut values = Vec::new();
        for axis in free {
            match places.iter().find(|(name, _)| *name == axis.name) {
                Some((_, value)) => values.push((axis.variable, context.graph.constant(*value))),
                None if by_laws.twist(axis.variable).is_zero() => {}
                None => {
                    let [frame, reference] = self.frames;
                    let message = format!("nothing says where axis `{}` stands", axis.name);
                    let help = format!(
                        "it moves `{}` against `{}`: give its value in `at ({}: …)`",
                        frame.node, reference.node, axis.name
                    );
                    let zero = shown(0.0, axis.dimension);
                    let stands = Rewriting::Pose(frame.span, format!("{}: {zero}", axis.name));
                    context
                        .report(Diagnostic::new(Code::Expectation, frame.span, message).help(help).rewriting(stands));
                    return None;
                }
            }
        }
        Some([laws, values])
    }
}

/// Settings and axes of a machine by their own names.
fn names<'g>(job: &Job<'g>, machine: &Machine<'g>) -> Scope<'g> {
    let settings = job.settings.iter().filter_map(|setting| {
        let own = setting.name.strip_prefix(&machine.name)?.strip_prefix('.')?;
        Some((own.to_string(), Value::Scalar(setting.variable, setting.dimension)))
    });
    let axes = machine.axes.iter().map(|axis| (axis.name.clone(), Value::Scalar(axis.variable, axis.dimension)));
    settings.chain(axes).collect::<HashMap<_, _>>()
}

/// How far the origin, and the points 1 mm from it along the axes, lie apart under two poses.
fn apart<'g>(first: &Chain<'g>, second: &Chain<'g>, context: &Context<'g>) -> Vec<Expr<'g>> {
    let number = |value: f64| context.graph.constant(value);
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let distance = |corner: [f64; 3]| {
        let [a, b] = [first, second].map(|chain| chain.point(Vector3(corner.map(number))).0);
        let squares = [0, 1, 2].map(|k| (a[k] - b[k]) * (a[k] - b[k]));
        (squares[0] + squares[1] + squares[2]).sqrt()
    };
    corners.map(distance).to_vec()
}

/// The larger one; what is no number is worse than all.
fn worst(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// A number that stands still, of expressions without names.
fn constant(context: &mut Context<'_>, written: &ast::Expression, dimension: Dimension, what: &str) -> Option<f64> {
    let value = context.scalar(written, &Scope::new(), dimension, what)?;
    context.require_constant(value, written.span, what)
}

//! Where machines expect their frames to stand.

use std::collections::HashMap;

use flank_expr::Expr;
use flank_expr::geometry::Chain;

use crate::definitions::transforms;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::Name;
use crate::job::{Definitions, posed};
use crate::model::{Axis, Job, LawSource, Machine};
use crate::syntax::ast::{self, Argument};
use crate::values::context::Context;
use crate::values::dimension::{Dimension, shown, shown_in, shown_like};
use crate::values::value::{Scope, Value};

use super::machine::{constant, overrides};
use super::model::{Expected, PoseDifference, PoseTolerance};
use super::{above_zero, wrong};

/// Where a frame of a machine is to stand.
pub(super) struct Pose<'a> {
    pub(super) machine: &'a ast::Machine,
    pub(super) frames: &'a [Name; 2],
    pub(super) transforms: &'a [ast::Call],
    pub(super) at: &'a [Argument],
    pub(super) within: &'a [ast::Expression],
}

impl Pose<'_> {
    /// `plain` is the machine as it stands, with open loops.
    pub(super) fn expected<'g>(
        &self,
        context: &mut Context<'g>,
        (definitions, plain): (&Definitions<'_>, &Job<'g>),
    ) -> Option<Expected<'g>> {
        let within = tolerance(context, self.within)?;
        for (k, argument) in self.at.iter().enumerate() {
            let Some(name) = &argument.name else { continue };
            let mut earlier = self.at[..k].iter().filter_map(|earlier| earlier.name.as_ref());
            if let Some(first) = earlier.find(|first| first.node == name.node) {
                let twice = format!("`{}` is given twice", name.node);
                context.report(Diagnostic::new(Code::DuplicateName, name.span, twice).note(first.span, "first here"));
                return None;
            }
        }
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
        if let Some(off) = difference(&is, &wanted, context) {
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
            let [low, high] = [low, high].map(|end| shown_in(end, axis.dimension, axis.travel_unit.as_ref()));
            let value = shown_like(value, axis.dimension, &argument.value);
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

/// A length for the origin, an angle for the turn; one of them alone leaves the other exact.
fn tolerance(context: &mut Context<'_>, written: &[ast::Expression]) -> Option<PoseTolerance> {
    let mut found = PoseTolerance::default();
    for (part, usual) in written.iter().zip([Dimension::LENGTH, Dimension::ANGLE]) {
        let value = context.evaluate(part, &Scope::new());
        let of = |wanted: &Dimension| matches!(value, Value::Scalar(_, dimension) if wanted.accepts(dimension));
        let dimension = [Dimension::LENGTH, Dimension::ANGLE].into_iter().find(of).unwrap_or(usual);
        let value = context.require(&value, dimension, part.span, "the tolerance")?;
        let value = context.require_constant(value, part.span, "the tolerance")?;
        let value = above_zero(context, value, dimension, part.span)?;
        let place = if dimension == Dimension::LENGTH { &mut found.distance } else { &mut found.angle };
        if place.replace(value).is_some() {
            let help = "give a length for its origin and an angle for its turn, as in `within 1 um, 1 arcsec`";
            wrong(context, part.span, format!("the tolerance of a pose has two of {dimension}"), help);
            return None;
        }
    }
    Some(found)
}

/// How far a frame lies from where it should; nothing where a number of one of them is not finite.
fn difference<'g>(is: &Chain<'g>, wanted: &Chain<'g>, context: &Context<'g>) -> Option<PoseDifference> {
    let numbers = |chain: &Chain<'g>| {
        let (origin, rotation) = chain.origin_and_turn();
        let all: Vec<Expr<'g>> = origin.0.into_iter().chain(rotation.entries()).collect();
        let numbers = context.graph.evaluate(&all, context.values());
        numbers.iter().all(|number| number.is_finite()).then_some(numbers)
    };
    let (is, wanted) = (numbers(is)?, numbers(wanted)?);
    let distance = (0..3).map(|k| is[k] - wanted[k]).fold(0.0, f64::hypot);
    // of the rotation between both, wantedᵀ · is; its rows stand behind the origin
    let entry = |i: usize, j: usize| (0..3).map(|k| wanted[3 + 3 * k + i] * is[3 + 3 * k + j]).sum::<f64>();
    // the axis times twice the sine of the angle: the cosine does not tell small angles
    let axis = [entry(2, 1) - entry(1, 2), entry(0, 2) - entry(2, 0), entry(1, 0) - entry(0, 1)];
    let twice_cosine = entry(0, 0) + entry(1, 1) + entry(2, 2) - 1.0;
    let angle = axis.into_iter().fold(0.0, f64::hypot).atan2(twice_cosine);
    let is_mirrored = handedness(&is) * handedness(&wanted) < 0.0;
    Some(PoseDifference { distance, angle: (!is_mirrored).then_some(angle) })
}

/// The determinant of a rotation behind an origin: negative of a mirror image.
fn handedness(pose: &[f64]) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|k| [pose[3 + 3 * k], pose[4 + 3 * k], pose[5 + 3 * k]]);
    let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    (0..3).map(|k| a[k] * cross[k]).sum()
}

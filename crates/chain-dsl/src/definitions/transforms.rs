//! The elementary transforms between a frame and its parent.

use flank_expr::Expr;
use flank_expr::geometry::{Axis, Matrix3, Pose, Step, Vector3};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::Span;
use crate::syntax::ast::{Call, Expression, ExpressionKind};
use crate::values::context::Context;
use crate::values::dimension::Dimension;
use crate::values::functions;
use crate::values::value::{Constant, Scope, Value};

const NAMES: [&str; 14] = [
    "translate",
    "translate_x",
    "translate_y",
    "translate_z",
    "rotate",
    "rotate_x",
    "rotate_y",
    "rotate_z",
    "screw",
    "matrix",
    "mirror",
    "mirror_x",
    "mirror_y",
    "mirror_z",
];

/// Names of the transforms.
pub(crate) fn names() -> &'static [&'static str] {
    &NAMES
}

/// What a transform takes, in words.
fn taken(name: &str) -> &'static str {
    match name {
        "translate" => "three lengths, or one vector of them",
        "translate_x" | "translate_y" | "translate_z" => "a length",
        "rotate_x" | "rotate_y" | "rotate_z" => "an angle",
        "rotate" => "an axis [x, y, z] and an angle",
        "screw" => "an axis [x, y, z], an angle, and a length per angle",
        "matrix" => "three rows [r, r, r, t]",
        _ => "an axis [x, y, z]",
    }
}

const AXES: [Axis<'static>; 3] = [Axis::X, Axis::Y, Axis::Z];

/// An explicit matrix may deviate this much from a rotation: it is written with finitely many digits.
const RIGID_WITHIN: f64 = 1e-9;

/// A matrix that is off by less than this was meant as a rigid motion and written with too few digits.
const NEARLY: f64 = 1e-2;

/// The steps that calls in a row amount to; nothing if one of them is wrong. All that is wrong is reported.
pub(crate) fn steps<'g>(context: &mut Context<'g>, calls: &[Call], scope: &Scope<'g>) -> Option<Vec<Step<'g>>> {
    let each: Vec<Option<Vec<Step<'g>>>> = calls.iter().map(|call| step(context, call, scope)).collect();
    each.into_iter().collect::<Option<Vec<_>>>().map(|steps| steps.concat())
}

fn step<'g>(context: &mut Context<'g>, call: &Call, scope: &Scope<'g>) -> Option<Vec<Step<'g>>> {
    let name = call.function.node.as_str();
    let count = match name {
        "translate" if call.arguments.len() == 1 => 1,
        "translate" => 3,
        "rotate" => 2,
        "screw" => 3,
        "mirror_x" | "mirror_y" | "mirror_z" => 0,
        _ if NAMES.contains(&name) => 1,
        _ => {
            context.unknown(&call.function, "transform", NAMES.into_iter());
            return None;
        }
    };
    let written: Vec<&Expression> = call.arguments.iter().map(|argument| &argument.value).collect();
    if call.arguments.len() != count || call.arguments.iter().any(|argument| argument.name.is_some()) {
        // the same words as for any other function
        functions::arguments(context, call, count, scope, |_| format!("it takes {}", taken(name)));
        return None;
    }
    let along = |axis: usize, by: Expr<'g>| {
        let mut components = [by.graph().constant(0.0); 3];
        components[axis] = by;
        Step::Translate(Vector3(components))
    };
    let what = format!("the argument of `{name}`");
    Some(match name {
        "translate" if count == 1 => {
            vec![Step::Translate(Vector3(context.vector(written[0], scope, Dimension::LENGTH, "`translate`")?))]
        }
        "translate" => {
            let names = ["x of `translate`", "y of `translate`", "z of `translate`"];
            let parts: Vec<Option<Expr<'g>>> = written
                .iter()
                .zip(names)
                .map(|(part, name)| context.scalar(part, scope, Dimension::LENGTH, name))
                .collect();
            vec![Step::Translate(Vector3([parts[0]?, parts[1]?, parts[2]?]))]
        }
        "translate_x" | "translate_y" | "translate_z" => {
            let by = context.scalar(written[0], scope, Dimension::LENGTH, &what)?;
            vec![along(axis_index(name), by)]
        }
        "rotate_x" | "rotate_y" | "rotate_z" => {
            let angle = context.scalar(written[0], scope, Dimension::ANGLE, &what)?;
            vec![Step::Rotate(AXES[axis_index(name)], angle)]
        }
        "rotate" => {
            let axis = unit_axis(context, written[0], scope)?;
            let angle = context.scalar(written[1], scope, Dimension::ANGLE, &what)?;
            vec![Step::Rotate(Axis::Along(axis), angle)]
        }
        // screw(axis, angle, lead): turns by the angle and advances by lead · angle
        "screw" => {
            let axis = unit_axis(context, written[0], scope)?;
            let angle = context.scalar(written[1], scope, Dimension::ANGLE, &what)?;
            let lead = Dimension { length: 1, angle: -1 };
            let lead = context.scalar(written[2], scope, lead, "the lead of `screw` (such as `12 mm/rev`)")?;
            vec![Step::Rotate(Axis::Along(axis), angle), Step::Translate(axis.scaled(lead * angle))]
        }
        "mirror_x" | "mirror_y" | "mirror_z" => vec![Step::Mirror(AXES[axis_index(name)])],
        "mirror" => vec![Step::Mirror(Axis::Along(unit_axis(context, written[0], scope)?))],
        _ => vec![Step::Rigid(matrix(context, written[0], scope)?)],
    })
}

fn axis_index(name: &str) -> usize {
    match name.as_bytes()[name.len() - 1] {
        b'x' => 0,
        b'y' => 1,
        _ => 2,
    }
}

/// A direction, made a unit vector.
fn unit_axis<'g>(context: &mut Context<'g>, written: &Expression, scope: &Scope<'g>) -> Option<Vector3<'g>> {
    let axis = Vector3(context.vector(written, scope, Dimension::NUMBER, "an axis")?);
    let squares = axis.0.map(|component| match context.constant(component) {
        Constant::Known(value) => value * value,
        Constant::Unknown | Constant::Moves(_) => f64::NAN,
    });
    if squares.iter().sum::<f64>() == 0.0 {
        let message = "an axis needs a direction: this vector is zero";
        context.report(Diagnostic::new(Code::NotANumber, written.span, message));
        return None;
    }
    Some(axis.normalized())
}

/// Three rows of four (rotation and translation), perhaps with a last row `[0, 0, 0, 1]`.
fn matrix<'g>(context: &mut Context<'g>, written: &Expression, scope: &Scope<'g>) -> Option<Pose<'g>> {
    let shape = "`matrix` takes three rows `[r, r, r, t]` of three numbers and a length";
    let rows = match context.evaluate(written, scope) {
        Value::Vector(rows) => rows,
        Value::Poison => return None,
        _ => {
            context.report(Diagnostic::new(Code::WrongArguments, written.span, shape));
            return None;
        }
    };
    let mut turned = Vec::new();
    let mut moved = Vec::new();
    for (k, row) in rows.iter().take(3).enumerate() {
        let entries = match row {
            Value::Vector(entries) if entries.len() == 4 => entries,
            Value::Poison => return None,
            _ => break,
        };
        let place = |column| entry_place(written, k, column);
        let mut numbers = Vec::new();
        for (column, entry) in entries[..3].iter().enumerate() {
            let what = "a rotation entry of `matrix`";
            numbers.push(context.require(entry, Dimension::NUMBER, place(column), what)?);
        }
        turned.push(Vector3([numbers[0], numbers[1], numbers[2]]));
        let what = "the last entry of a row of `matrix`";
        moved.push(context.require(&entries[3], Dimension::LENGTH, place(3), what)?);
    }
    if turned.len() != 3 || rows.len() > 4 {
        context.report(Diagnostic::new(Code::WrongArguments, written.span, shape));
        return None;
    }
    let rotation = Matrix3([turned[0], turned[1], turned[2]]);
    check_rigid(context, rotation, written.span)?;
    Some(Pose { rotation, translation: Vector3([moved[0], moved[1], moved[2]]) })
}

/// Where an entry of a matrix stands: its own place if rows are written out, else the whole matrix.
fn entry_place(written: &Expression, row: usize, column: usize) -> Span {
    part(written, row).and_then(|row| part(row, column)).map_or(written.span, |entry| entry.span)
}

fn part(vector: &Expression, index: usize) -> Option<&Expression> {
    match &vector.kind {
        ExpressionKind::Vector(parts) => parts.get(index),
        _ => None,
    }
}

/// Rows of unit length, at right angles, right-handed: looked at for a few values of whatever it depends on.
fn check_rigid<'g>(context: &mut Context<'g>, rotation: Matrix3<'g>, span: Span) -> Option<()> {
    let [a, b, c] = rotation.0;
    let one = [a.dot(a), b.dot(b), c.dot(c), a.cross(b).dot(c)];
    let zero = [a.dot(b), b.dot(c), c.dot(a)];
    let all: Vec<Expr<'g>> = one.into_iter().chain(zero).collect();
    let depends = context.graph.variables_of(&all);
    let open: Vec<usize> =
        depends.iter().map(|variable| variable.index()).filter(|&index| context.values()[index].is_nan()).collect();
    for probe in [0.3, -0.7, 1.1] {
        let mut values = context.values().to_vec();
        for &index in &open {
            values[index] = probe + 0.1 * index as f64;
        }
        let found = context.graph.evaluate(&all, &values);
        let off = found[..4].iter().map(|x| (x - 1.0).abs()).chain(found[4..].iter().map(|x| x.abs()));
        let worst = off.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a });
        // a number that nobody gave may be one that the machine is not made for
        if worst.is_nan() && !open.is_empty() {
            continue;
        }
        if worst.is_nan() || worst > RIGID_WITHIN {
            let (reason, help) = if (found[3] + 1.0).abs() < NEARLY {
                (
                    "it turns a right hand into a left one".to_string(),
                    "for the other hand, mirror it by one such as `mirror_x()`",
                )
            } else {
                let reason = format!("its rows are not unit vectors at right angles (off by {worst:.1e})");
                let rounded = "give at least 10 digits, or say it with `rotate` and `translate`";
                (reason, if worst < NEARLY { rounded } else { "say it with `rotate` and `translate`" })
            };
            let message = format!("this matrix is not a rigid motion: {reason}");
            context.report(Diagnostic::new(Code::NotRigid, span, message).help(help));
            return None;
        }
    }
    Some(())
}

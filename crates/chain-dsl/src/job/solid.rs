//! Bodies: a blank turned about the z axis of its frame, or drawn along y, and the surfaces that bound its tooth spaces.

use std::rc::Rc;

use flank_expr::Expr;

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::rewriting::Rewriting;
use crate::diagnostics::source::Span;
use crate::model::{Job, OutlineCurve, OutlineSegment, Solid, SolidForm};
use crate::syntax::ast::{self, Expression, ExpressionKind};
use crate::values::context::{Context, quoted};
use crate::values::dimension::{Dimension, shown};
use crate::values::segment::{Profile, Segment, Shape};
use crate::values::value::{Constant, Value};

use super::{Builder, FrameRef};

/// How far the ends of an outline may lie apart, mm: rounding.
const CLOSED: f64 = 1e-9;
/// Chords that an arc is taken for where an outline may cross itself.
const CHORDS: usize = 32;
/// More tooth spaces than any gear has.
const MOST_SPACES: f64 = 1e6;

const EXAMPLE: &str = "for example `solid pinion in m.work = turned(blank, spaces: 19, of: [left, fillet, right])`";
const EXAMPLE_OF_RACK: &str =
    "for example `solid rack in m.table = extruded(bar, spaces: 10, pitch: pi * module, of: [left, root, right])`";

/// What may stand in the brackets of a solid.
#[derive(Default)]
struct Arguments<'a> {
    profile: Option<&'a Expression>,
    spaces: Option<&'a Expression>,
    of: Option<&'a Expression>,
    each: Option<&'a Expression>,
    pitch: Option<&'a Expression>,
}

impl<'g> Builder<'_, 'g> {
    pub(super) fn solid(&mut self, context: &mut Context<'g>, written: &ast::Solid, job: &ast::Job) {
        let Some(solid) = self.built_solid(context, written, job) else { return };
        self.solids.push(solid);
    }

    fn built_solid(&mut self, context: &mut Context<'g>, written: &ast::Solid, job: &ast::Job) -> Option<Solid> {
        let frame = self.frame(context, &written.frame);
        let call = match &written.value.kind {
            ExpressionKind::Call(call) if ["turned", "extruded"].contains(&call.function.node.as_str()) => call,
            ExpressionKind::Call(call) => {
                context.unknown(&call.function, "way to make a solid", ["turned", "extruded"].into_iter());
                return None;
            }
            ExpressionKind::Error => return None,
            _ => {
                let message = "a solid is a turned or an extruded blank with tooth spaces";
                context.report(Diagnostic::new(Code::WrongKind, written.value.span, message).help(EXAMPLE));
                return None;
            }
        };
        let is_turned = call.function.node == "turned";
        let given = arguments(context, call)?;
        let (Some(blank), Some(spaces), Some(of)) = (given.profile, given.spaces, given.of) else {
            return missing(context, call, is_turned);
        };
        if is_turned != given.pitch.is_none() {
            return missing(context, call, is_turned);
        }
        let outline = self.outline(context, blank, is_turned);
        let teeth = self.teeth(context, spaces);
        let surfaces = self.space(context, of, frame, job);
        let form = match given.pitch {
            None => Some(SolidForm::Turned),
            Some(pitch) => self.spacing(context, pitch).map(|pitch| SolidForm::Extruded { pitch }),
        };
        let each = match given.each {
            None => Some(None),
            Some(each) => self.each(context, each, teeth).map(Some),
        };
        Some(Solid {
            name: written.name.node.clone(),
            doc: written.doc.clone(),
            frame: self.frame_name(frame?),
            form: form?,
            outline: outline?,
            teeth: teeth?,
            space: surfaces?,
            each: each?,
            written: written.name.span,
        })
    }

    /// From one space to the next along a line, mm.
    fn spacing(&self, context: &mut Context<'g>, written: &Expression) -> Option<f64> {
        let value = context.scalar(written, &self.scope, Dimension::LENGTH, "the pitch")?;
        let pitch = context.require_constant(value, written.span, "the pitch")?;
        if pitch > 0.0 {
            return Some(pitch);
        }
        let message = format!("the pitch is {}: spaces follow each other along +y", shown(pitch, Dimension::LENGTH));
        context.report(Diagnostic::new(Code::Solid, written.span, message).help(EXAMPLE_OF_RACK));
        None
    }

    /// The parameter that says of which space the surfaces are.
    fn each(&self, context: &mut Context<'g>, written: &Expression, teeth: Option<u32>) -> Option<String> {
        let wrong = |message: String, help: &str| Diagnostic::new(Code::Solid, written.span, message).help(help);
        let help = "for example `param space : count in 0 .. 100 = 0`, and `each: space`";
        let ExpressionKind::Path(path) = &written.kind else {
            let message = "`each:` takes the parameter that says of which space the surfaces are".to_string();
            context.report(wrong(message, help));
            return None;
        };
        let name = path.joined();
        let found = self.parameters.iter().find(|parameter| parameter.name == name && parameter.is_count);
        let Some(parameter) = found else {
            if !matches!(self.scope.get(&name), Some(Value::Poison)) {
                context.report(wrong(format!("`{name}` is no count among the parameters of the job"), help));
            }
            return None;
        };
        let (last, range) = (f64::from(teeth?) - 1.0, parameter.range);
        if let Some((low, high)) = range.filter(|(low, high)| *low > 0.0 || *high < last) {
            let message = format!("`{name}` counts the spaces from 0 to {last}, and its range is {low} .. {high}");
            context.report(wrong(message, "let its range hold all of them"));
            return None;
        }
        Some(name)
    }

    fn teeth(&self, context: &mut Context<'g>, written: &Expression) -> Option<u32> {
        let value = context.scalar(written, &self.scope, Dimension::NUMBER, "the number of tooth spaces")?;
        match context.constant(value) {
            Constant::Known(number) if number >= 1.0 && number.fract() == 0.0 && number <= MOST_SPACES => {
                Some(number as u32)
            }
            Constant::Unknown => None,
            Constant::Known(number) => {
                let message = format!("a gear has a whole number of tooth spaces, at least 1, and not {number}");
                context.report(Diagnostic::new(Code::Solid, written.span, message));
                None
            }
            Constant::Moves(_) => {
                let message = "the number of tooth spaces does not move";
                context.report(Diagnostic::new(Code::Solid, written.span, message));
                None
            }
        }
    }

    /// The surfaces of one space, from one side to the other.
    fn space(
        &self,
        context: &mut Context<'g>,
        written: &Expression,
        frame: Option<FrameRef>,
        job: &ast::Job,
    ) -> Option<Vec<usize>> {
        let ExpressionKind::Vector(listed) = &written.kind else {
            let message = "`of:` takes the surfaces of one tooth space, from one side to the other";
            context.report(
                Diagnostic::new(Code::WrongKind, written.span, message).help("for example `of: [left, fillet, right]`"),
            );
            return None;
        };
        let frame = frame?;
        let mut found: Vec<usize> = Vec::new();
        for surface in listed {
            let ExpressionKind::Path(path) = &surface.kind else {
                let message = "this is no surface of the job";
                context.report(Diagnostic::new(Code::WrongKind, surface.span, message));
                return None;
            };
            let index = self.finished(context, path, job)?;
            let (its, own) = &self.surfaces[index];
            let wrong = |message: String, help: &str| Diagnostic::new(Code::Solid, path.span, message).help(help);
            if found.contains(&index) {
                let twice = wrong(format!("`{}` is in the space twice", path.joined()), "take one of them away");
                context.report(twice.rewriting(Rewriting::Entry(path.span)));
                return None;
            }
            if own.0 == frame.0 && own.1 != frame.1 {
                let message = format!(
                    "`{}` is given in `{}`, the solid in `{}`",
                    path.joined(),
                    its.frame,
                    self.frame_name(frame)
                );
                context.report(wrong(message, "give both in the frame of the work"));
                return None;
            }
            if let Some(other) = self.solids.iter().find(|solid| solid.space.contains(&index)) {
                let message = format!("`{}` bounds the spaces of `{}` already", path.joined(), other.name);
                context.report(wrong(message, "a surface is one of one body"));
                return None;
            }
            found.push(index);
        }
        if found.is_empty() {
            let message = "a tooth space has surfaces";
            context.report(
                Diagnostic::new(Code::Solid, written.span, message).help("for example `of: [left, fillet, right]`"),
            );
            return None;
        }
        Some(found)
    }

    /// The outline of a blank: a closed profile of the axial section, the material on its left.
    fn outline(&self, context: &mut Context<'g>, written: &Expression, is_turned: bool) -> Option<Vec<OutlineSegment>> {
        let ExpressionKind::Path(path) = &written.kind else {
            let message =
                "a blank is a profile of the job: points `[z, rho]` of its section, or `[z, x]` of that of a bar";
            context.report(Diagnostic::new(Code::WrongKind, written.span, message).help(EXAMPLE));
            return None;
        };
        let profile: Rc<Profile<'g>> = match self.scope.get(&path.joined()) {
            Some(Value::Profile(profile)) => Rc::clone(profile),
            Some(Value::Poison) => return None,
            Some(_) => {
                let message = format!("`{}` is no profile", path.joined());
                context.report(Diagnostic::new(Code::WrongKind, path.span, message).help(EXAMPLE));
                return None;
            }
            None => {
                let profiles = self.scope.iter().filter(|(_, value)| matches!(value, Value::Profile(_)));
                let known: Vec<String> = profiles.map(|(name, _)| name.clone()).collect();
                context.unknown(path.segments.last()?, "profile", known.iter().map(String::as_str));
                return None;
            }
        };
        let segments: Option<Vec<OutlineSegment>> =
            profile.segments.iter().map(|segment| outline_segment(context, segment, is_turned)).collect();
        closed(context, segments?, &profile, path.span)
    }
}

/// Reports solids whose spaces differ by a parameter from which numbers of the job follow that are the same for all spaces.
pub(super) fn check_each(context: &mut Context<'_>, job: &Job<'_>, decisive: &[Expr<'_>]) {
    for solid in &job.solids {
        let Some(each) = &solid.each else { continue };
        let parameter = job.parameters.iter().find(|parameter| parameter.name == *each);
        if parameter.is_some_and(|parameter| decisive.contains(&parameter.variable)) {
            let message = format!(
                "`{each}` counts the spaces of `{}`, and ranges or points of the job follow from its value",
                solid.name
            );
            context.report(
                Diagnostic::new(Code::Solid, solid.written, message)
                    .help("let laws alone depend on it, and give motions a range that holds all spaces"),
            );
        }
    }
}

/// What stands in the brackets.
fn arguments<'a>(context: &mut Context<'_>, call: &'a ast::Call) -> Option<Arguments<'a>> {
    let mut given = Arguments::default();
    let is_turned = call.function.node == "turned";
    for argument in &call.arguments {
        let slot = match argument.name.as_ref().map(|name| name.node.as_str()) {
            None => &mut given.profile,
            Some("spaces") => &mut given.spaces,
            Some("of") => &mut given.of,
            Some("each") => &mut given.each,
            Some("pitch") if !is_turned => &mut given.pitch,
            Some(_) => {
                let name = argument.name.as_ref()?;
                let (what, known): (_, &[&str]) = match is_turned {
                    true => ("argument of `turned`", &["spaces", "of", "each"]),
                    false => ("argument of `extruded`", &["spaces", "pitch", "of", "each"]),
                };
                context.unknown(name, what, known.iter().copied());
                return None;
            }
        };
        if let Some(first) = slot.replace(&argument.value) {
            let message = "this is said twice";
            let twice = Diagnostic::new(Code::WrongArguments, argument.value.span, message);
            context.report(twice.note(first.span, "first here"));
            return None;
        }
    }
    Some(given)
}

fn missing<T>(context: &mut Context<'_>, call: &ast::Call, is_turned: bool) -> Option<T> {
    let (message, help) = if is_turned {
        ("`turned` takes a profile, `spaces:` their number and `of:` the surfaces of one space", EXAMPLE)
    } else {
        (
            "`extruded` takes a profile, `spaces:` their number, `pitch:` from one to the next, and `of:` the surfaces of one space",
            EXAMPLE_OF_RACK,
        )
    };
    context.report(Diagnostic::new(Code::WrongArguments, call.span, message).help(help));
    None
}

/// A segment with numbers; nothing where one has no value yet, or what cannot be an edge of a blank has been reported.
fn outline_segment<'g>(context: &mut Context<'g>, segment: &Segment<'g>, is_turned: bool) -> Option<OutlineSegment> {
    let half = (segment.from + segment.to) * 0.5;
    let points = [segment.from, half, segment.to].map(|run| numbers(context, segment.point(run)));
    let [from, middle, to] = [points[0]?, points[1]?, points[2]?];
    let wrong = |message: String, help: &str| Diagnostic::new(Code::Solid, segment.span, message).help(help);
    let curve = match &segment.shape {
        Shape::Line { .. } => OutlineCurve::Line,
        Shape::Arc { .. } | Shape::Bow { .. } => {
            let chord = [to[0] - from[0], to[1] - from[1]];
            let rise = [middle[0] - 0.5 * (from[0] + to[0]), middle[1] - 0.5 * (from[1] + to[1])];
            let (half_chord, height) = (0.5 * chord[0].hypot(chord[1]), rise[0].hypot(rise[1]));
            if height >= half_chord {
                let message = format!("`{}` turns by half a turn or more", segment.name);
                context.report(wrong(message, "make two arcs of it"));
                return None;
            }
            let radius = 0.5 * (half_chord * half_chord + height * height) / height;
            OutlineCurve::Arc { center: [0, 1].map(|k| middle[k] - rise[k] / height * radius) }
        }
        Shape::Spline(_) | Shape::Unknown(_) => {
            let message = format!("`{}` is a spline: an outline is made of lines and arcs", segment.name);
            context.report(wrong(message, "a few arcs follow a turned shape as closely as a lathe does"));
            return None;
        }
    };
    if let Some(inside) = [from, middle, to].into_iter().find(|[_, rho]| is_turned && *rho < 0.0) {
        let message = format!("`{}` lies {} beyond the axis", segment.name, shown(-inside[1], Dimension::LENGTH));
        context.report(wrong(message, "the second coordinate is the distance from the axis"));
        return None;
    }
    Some(OutlineSegment { name: segment.name.clone(), from, to, curve })
}

fn numbers<'g>(context: &Context<'g>, point: [Expr<'g>; 2]) -> Option<[f64; 2]> {
    let [z, rho] = point.map(|part| match context.constant(part) {
        Constant::Known(value) if value.is_finite() => Some(value),
        _ => None,
    });
    Some([z?, rho?])
}

/// The same with the material on the left, if it is closed and does not cross itself.
fn closed(
    context: &mut Context<'_>,
    mut segments: Vec<OutlineSegment>,
    profile: &Profile<'_>,
    span: Span,
) -> Option<Vec<OutlineSegment>> {
    let (Some(first), Some(last)) = (segments.first(), segments.last()) else { return None };
    let gap = f64::hypot(first.from[0] - last.to[0], first.from[1] - last.to[1]);
    let place = profile.segments.last().map_or(span, |segment| segment.span);
    if gap > CLOSED {
        let point =
            |[z, rho]: [f64; 2]| format!("[{}, {}]", shown(z, Dimension::LENGTH), shown(rho, Dimension::LENGTH));
        let message = format!(
            "the outline is open: `{}` ends at {}, `{}` begins at {}",
            last.name,
            point(last.to),
            first.name,
            point(first.from)
        );
        context.report(
            Diagnostic::new(Code::Solid, place, message).help("let the last segment end where the first begins"),
        );
        return None;
    }
    let polylines: Vec<Vec<[f64; 2]>> = segments.iter().map(polyline).collect();
    if let Some([a, b]) = crossing(&polylines) {
        let message = format!("the outline crosses itself: {}", quoted(&[&segments[a].name, &segments[b].name]));
        context.report(
            Diagnostic::new(Code::Solid, span, message)
                .help("its segments follow each other around the section of the blank"),
        );
        return None;
    }
    let around = polylines.concat();
    let area: f64 = (0..around.len())
        .map(|k| (around[k], around[(k + 1) % around.len()]))
        .map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0]))
        .sum();
    if area < 0.0 {
        segments.reverse();
        segments.iter_mut().for_each(|segment| std::mem::swap(&mut segment.from, &mut segment.to));
    }
    Some(segments)
}

/// Points along a segment, its end left out.
fn polyline(segment: &OutlineSegment) -> Vec<[f64; 2]> {
    let OutlineCurve::Arc { center } = segment.curve else { return vec![segment.from] };
    let angle = |point: [f64; 2]| (point[1] - center[1]).atan2(point[0] - center[0]);
    let (from, to) = (angle(segment.from), angle(segment.to));
    let turn = (to - from + 3.0 * std::f64::consts::PI).rem_euclid(2.0 * std::f64::consts::PI) - std::f64::consts::PI;
    let radius = f64::hypot(segment.from[0] - center[0], segment.from[1] - center[1]);
    let at = |k: usize| {
        let angle = from + turn * k as f64 / CHORDS as f64;
        [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()]
    };
    (0..CHORDS).map(at).collect()
}

/// Two segments of which a chord crosses one of the other.
fn crossing(polylines: &[Vec<[f64; 2]>]) -> Option<[usize; 2]> {
    let chords: Vec<(usize, [f64; 2])> =
        polylines.iter().enumerate().flat_map(|(of, points)| points.iter().map(move |point| (of, *point))).collect();
    let count = chords.len();
    let side = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    for i in 0..count {
        // the next chord and the one before share a point with this one
        for j in (i + 2)..count {
            let [a, b, c, d] = [i, i + 1, j, j + 1].map(|k| chords[k % count].1);
            let crosses = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            if crosses {
                return Some([chords[i].0, chords[j].0]);
            }
        }
    }
    None
}

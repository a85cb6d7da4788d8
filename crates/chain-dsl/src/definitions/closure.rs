//! Closed loops of a machine: frames that are one, however they are reached.

use flank_expr::geometry::Chain;
use flank_expr::{Expr, Graph, Interval};

use crate::definitions::machine::BuiltAxis;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::limits;
use crate::model::{Frame, path};
use crate::syntax::ast::{Close, KeptAxis};
use crate::values::context::{Context, quoted};
use crate::values::dimension::{Dimension, shown_in};
use crate::values::value::Scope;

/// The axes of a frame.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Equations that share unknown axes: as many as these.
pub(crate) struct Linkage<'g> {
    /// What is zero where it closes, in axes, with the place where the frames are named.
    pub(crate) residuals: Vec<(Expr<'g>, Span)>,
    /// Places of the unknown axes in their machine.
    pub(crate) axes: Vec<usize>,
    /// Where each of these is in the branch that is meant.
    pub(crate) ranges: Vec<Interval>,
}

/// Two frames that coincide in some components, with their places in the machine's list.
struct Loop {
    first: usize,
    second: usize,
    /// The frame that both hang on.
    common: usize,
    components: Vec<Component>,
    /// Unknown axes by their places, with where they are in the branch that is meant.
    keeps: Vec<(usize, Interval)>,
    span: Span,
}

/// A component of how far two frames are apart, by the number of an axis of the frame that both hang on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    Along(usize),
    About(usize),
}

impl Loop {
    /// What is zero where it closes: distances in mm, and sines of angles, as large as the skew part of the turn from the first frame to the
    /// second. Both are told in the frame that both hang on.
    fn residuals<'g>(&self, graph: &'g Graph, frames: &[Frame<'g>]) -> Vec<Expr<'g>> {
        let steps =
            |to: usize| path(frames, self.common, to).into_iter().flat_map(|(_, steps)| steps).collect::<Vec<_>>();
        let [first, second] = [self.first, self.second].map(steps);
        let apart = Chain::new(graph, second.clone()).origin_and_turn().0
            - Chain::new(graph, first.clone()).origin_and_turn().0;
        let back = first.iter().rev().map(|step| step.inverse());
        let (_, turn) = Chain::new(graph, second.into_iter().chain(back).collect()).origin_and_turn();
        let residual = |component: &Component| match *component {
            Component::Along(axis) => apart.0[axis],
            Component::About(axis) => {
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                0.5 * (turn.0[last].0[next] - turn.0[next].0[last])
            }
        };
        self.components.iter().map(residual).collect()
    }
}

impl<'g> Linkage<'g> {
    /// The names of the unknown axes.
    pub(crate) fn names<'b>(&self, axes: &'b [BuiltAxis<'_>]) -> Vec<&'b str> {
        self.axes.iter().map(|axis| axes[*axis].name.node.as_str()).collect()
    }

    /// Takes in all that a part shares an unknown axis with.
    fn with(mut self, part: Linkage<'g>) -> Linkage<'g> {
        self.residuals.extend(part.residuals);
        self.axes.extend(part.axes);
        self.ranges.extend(part.ranges);
        self
    }

    /// Whether there are as many equations as axes, and not too many; reported if not.
    fn is_even(&self, context: &mut Context<'_>, axes: &[BuiltAxis<'g>]) -> bool {
        let names = quoted(&self.names(axes));
        let help = "each component in which a loop closes gives one axis; two are given by words such as `along x, y`";
        let (equations, unknown) = (self.residuals.len(), self.axes.len());
        let (place, message) = match self.residuals.first() {
            None => (axes[self.axes[0]].name.span, format!("no loop closes over the unknown axis {names}")),
            Some((_, span)) if equations != unknown => {
                let [equations, unknown] = [(equations, "equation"), (unknown, "unknown axis")].map(counted);
                (*span, format!("the loop gives {equations} for {unknown}: {names}"))
            }
            Some((_, span)) if equations > limits::LOOP.most => {
                context.report(limits::LOOP.exceeded(*span));
                return false;
            }
            Some(_) => return true,
        };
        context.report(Diagnostic::new(Code::OpenLoop, place, message).help(help));
        false
    }
}

fn counted((count, noun): (usize, &str)) -> String {
    match (count, noun.strip_suffix("is")) {
        (1, _) => format!("1 {noun}"),
        (_, Some(stem)) => format!("{count} {stem}es"),
        (_, None) => format!("{count} {noun}s"),
    }
}

/// The loops of a machine by the unknown axes that they share; nothing of what is wrong in them, which is reported.
pub(crate) fn linkages<'g>(
    context: &mut Context<'g>,
    closes: &[&Close],
    frames: &[Frame<'g>],
    axes: &[BuiltAxis<'g>],
    scope: &Scope<'g>,
) -> Vec<Linkage<'g>> {
    let travel = |axis: usize| axes[axis].travel.map_or(Interval::WHOLE, |(low, high)| Interval::new(low, high));
    let alone = |axis: usize| Linkage { residuals: Vec::new(), axes: vec![axis], ranges: vec![travel(axis)] };
    let mut linkages: Vec<Linkage<'g>> = (0..axes.len()).filter(|axis| axes[*axis].is_unknown).map(alone).collect();
    let law = |axis: &BuiltAxis<'g>| Some((axis.variable, axis.law?.0?));
    let laws: Vec<(Expr<'g>, Expr<'g>)> = axes.iter().filter_map(law).collect();
    let mut is_whole = true;
    let mut keeps = Vec::new();
    for closed in loops(context, closes, (frames, axes, scope), &mut is_whole) {
        keeps.extend(closed.keeps.iter().copied());
        let residuals = (0..=laws.len())
            .fold(closed.residuals(context.graph, frames), |residuals, _| context.graph.substitute(&residuals, &laws));
        for residual in residuals {
            let inside = context.variables_of(&[residual]);
            let shares = |part: &Linkage<'g>| part.axes.iter().any(|axis| inside.contains(&axes[*axis].variable));
            let (sharing, others): (Vec<_>, Vec<_>) = linkages.into_iter().partition(shares);
            linkages = others;
            match sharing.into_iter().reduce(Linkage::with) {
                Some(mut whole) => {
                    whole.residuals.push((residual, closed.span));
                    linkages.push(whole);
                }
                None => {
                    let message = "no unknown axis moves these frames against each other in all components".to_owned();
                    let help =
                        "a loop gives unknown axes their motion, such as `unknown rod : rotary in -40 deg .. 40 deg`";
                    context.report(Diagnostic::new(Code::OpenLoop, closed.span, message).help(help));
                    return Vec::new();
                }
            }
        }
    }
    // a loop that is wrong leaves others without their equations
    for linkage in &mut linkages {
        linkage.axes.sort_unstable();
        let kept = |axis: &usize| {
            let own = keeps.iter().filter(|(kept, _)| kept == axis);
            own.fold(travel(*axis), |range, (_, kept)| range.intersection(*kept))
        };
        linkage.ranges = linkage.axes.iter().map(kept).collect();
    }
    linkages.sort_unstable_by_key(|linkage| linkage.axes[0]);
    let is_even = is_whole && linkages.iter().all(|linkage| linkage.is_even(context, axes));
    if is_even { linkages } else { Vec::new() }
}

/// The nearest frame that two hang on; nothing where frames are not one tree.
fn common_frame(frames: &[Frame<'_>], first: usize, second: usize) -> Option<usize> {
    let line = |start: usize| std::iter::successors(Some(start), |&k| frames[k].parent);
    line(first).find(|frame| line(second).any(|above| above == *frame))
}

/// The loops that a text declares; what is wrong in them is reported and left out.
fn loops<'g>(
    context: &mut Context<'g>,
    closes: &[&Close],
    (frames, built, scope): (&[Frame<'g>], &[BuiltAxis<'g>], &Scope<'g>),
    is_whole: &mut bool,
) -> Vec<Loop> {
    let place = |context: &mut Context<'g>, name: &Name| {
        let found = frames.iter().position(|frame| frame.name == name.node);
        if found.is_none() {
            context.unknown(name, "frame", frames.iter().map(|frame| frame.name.as_str()));
        }
        found
    };
    let mut loops = Vec::new();
    for close in closes {
        let ends = (place(context, &close.first), place(context, &close.second));
        let along = axes(context, &close.along);
        let about = axes(context, &close.about);
        let keeps: Option<Vec<(usize, Interval)>> =
            close.keeps.iter().map(|kept| keep(context, kept, built, scope)).collect();
        let (Some(along), Some(about), Some(keeps), (Some(first), Some(second))) = (along, about, keeps, ends) else {
            *is_whole = false;
            continue;
        };
        if first == second {
            let message = format!("`{}` is closed with itself", close.first.node);
            let help = "a loop closes where two frames at the ends of two chains are one";
            context.report(Diagnostic::new(Code::OpenLoop, close.second.span, message).help(help));
            *is_whole = false;
            continue;
        }
        // a second root is reported with the frames
        let Some(common) = common_frame(frames, first, second) else {
            *is_whole = false;
            continue;
        };
        let mut components: Vec<Component> =
            along.into_iter().map(Component::Along).chain(about.into_iter().map(Component::About)).collect();
        if components.is_empty() {
            components = (0..3).map(Component::Along).chain((0..3).map(Component::About)).collect();
        }
        let span = Span { end: close.second.span.end, ..close.first.span };
        loops.push(Loop { first, second, common, components, keeps, span });
    }
    loops
}

/// Where an unknown axis is in the branch that is meant; anywhere, as long as its ends have no values.
fn keep<'g>(
    context: &mut Context<'g>,
    kept: &KeptAxis,
    axes: &[BuiltAxis<'g>],
    scope: &Scope<'g>,
) -> Option<(usize, Interval)> {
    let Some(place) = axes.iter().position(|axis| axis.is_unknown && axis.name.node == kept.name.node) else {
        let known = axes.iter().filter(|axis| axis.is_unknown).map(|axis| axis.name.node.as_str());
        context.unknown(&kept.name, "unknown axis", known);
        return None;
    };
    let axis = &axes[place];
    let (findings, what) = (context.findings(), format!("axis `{}`", kept.name.node));
    let Some((low, high)) = context.range(&kept.range, scope, axis.dimension?, &what) else {
        return (context.findings() == findings).then_some((place, Interval::WHOLE));
    };
    if let Some((from, to)) = axis.travel.filter(|(from, to)| high < *from || *to < low) {
        let dimension = axis.dimension.unwrap_or(Dimension::LENGTH);
        let [from, to] = [from, to].map(|end| shown_in(end, dimension, axis.travel_unit.as_ref()));
        let message = format!("{what} is never there: it travels from {from} to {to}");
        context.report(Diagnostic::new(Code::EmptyRange, kept.range.span, message));
        return None;
    }
    Some((place, Interval::new(low, high)))
}

/// The numbers of axes by their names, each once.
fn axes(context: &mut Context<'_>, names: &[Name]) -> Option<Vec<usize>> {
    let mut found = Vec::new();
    for name in names {
        let axis = AXES.iter().position(|axis| *axis == name.node);
        match axis {
            Some(axis) if !found.contains(&axis) => found.push(axis),
            Some(_) => {
                let message = format!("`{}` stands twice", name.node);
                context.report(Diagnostic::new(Code::DuplicateName, name.span, message));
                return None;
            }
            None => {
                context.unknown(name, "axis of a frame", AXES.into_iter());
                return None;
            }
        }
    }
    Some(found)
}

//! Points of a sample that a spline of the same job goes through: `spline(dressing, rho, z)`.

use std::rc::Rc;

use flank_expr::{Expr, Interval, NoRoot, OnlyRoots, Unknown};

use crate::diagnostics::Diagnostic;
use crate::diagnostics::codes::Code;
use crate::diagnostics::source::{Name, Span};
use crate::limits;
use crate::model::{GeneratedSurface, Job, Sample};
use crate::syntax::ast::{self, ExpressionKind, JobStatement};
use crate::values::context::{Context, Role, quoted};
use crate::values::dimension::{Dimension, shown};

/// What the splines of a job go through, as far as it is known.
#[derive(Default)]
pub(crate) struct SampledPoints {
    asked: Vec<Asked>,
}

/// A spline through the points of a sample.
struct Asked {
    sample: ast::Path,
    /// The coordinates that it runs in.
    coordinates: [Name; 2],
    span: Span,
    found: Found,
}

enum Found {
    /// Not looked for yet.
    Not,
    Points(Rc<Vec<(f64, f64)>>),
    /// There are none, which has been reported.
    Lost,
}

impl SampledPoints {
    /// The points that a call asks for, `spline(dressing, rho, z)`; nothing while they are not known.
    pub(crate) fn of(&mut self, call: &ast::Call) -> Option<Rc<Vec<(f64, f64)>>> {
        let [sample, first, second] = named(call)?;
        match self.asked.iter().find(|asked| asked.span == call.span) {
            Some(Asked { found: Found::Points(points), .. }) => Some(Rc::clone(points)),
            Some(_) => None,
            None => {
                let coordinates = [first, second].map(last);
                let (sample, span) = (sample.clone(), call.span);
                self.asked.push(Asked { sample, coordinates, span, found: Found::Not });
                None
            }
        }
    }

    /// Whether nothing is left to be looked for.
    pub(super) fn are_known(&self) -> bool {
        self.asked.iter().all(|asked| !matches!(asked.found, Found::Not))
    }

    /// Looks for points on what a job has so far; whether some were found that were not known before.
    pub(super) fn find<'g>(&mut self, context: &mut Context<'g>, built: &Job<'g>, written: &ast::Job) -> bool {
        let mut is_new = false;
        for asked in self.asked.iter_mut().filter(|asked| matches!(asked.found, Found::Not)) {
            let wanted = asked.sample.joined();
            let there = built.surfaces.iter().find(|surface| surface.name == wanted);
            let Some((surface, sample)) = there.and_then(|it| Some((it, it.sample.as_ref()?))) else {
                continue;
            };
            asked.found = match points(context, asked, surface, sample) {
                Some(points) => Found::Points(Rc::new(points)),
                None => Found::Lost,
            };
            is_new |= matches!(asked.found, Found::Points(_));
        }
        if !is_new {
            self.asked.iter().filter(|asked| matches!(asked.found, Found::Not)).for_each(|asked| {
                missing(context, asked, built, written);
            });
        }
        is_new
    }
}

/// The three names of a call that takes points of a sample.
pub(crate) fn named(call: &ast::Call) -> Option<[&ast::Path; 3]> {
    let names = call.arguments.iter().map(|argument| match (&argument.name, &argument.value.kind) {
        (None, ExpressionKind::Path(path)) => Some(path),
        _ => None,
    });
    names.collect::<Option<Vec<_>>>()?.try_into().ok()
}

fn last(path: &ast::Path) -> Name {
    Name { node: path.joined(), span: path.span }
}

/// Reports that there is no such sample, or that it hangs on what it is to make.
fn missing(context: &mut Context<'_>, asked: &Asked, built: &Job<'_>, written: &ast::Job) {
    let wanted = asked.sample.joined();
    let sampled = |statement: &JobStatement| match statement {
        JobStatement::Sample(sample) => sample
            .surfaces
            .iter()
            .map(|of| of.name.as_ref().map_or_else(|| of.surface.joined(), |name| name.node.clone()))
            .collect(),
        _ => Vec::new(),
    };
    let known: Vec<String> = written.statements.iter().flat_map(sampled).collect();
    let name = Name { node: wanted.clone(), span: asked.sample.span };
    if !known.contains(&wanted) {
        let pieces: Vec<&str> = built.surfaces.iter().map(|surface| surface.name.as_str()).collect();
        context.unknown(&name, "sample", known.iter().map(String::as_str).chain(pieces));
    } else if !context.has_errors() {
        let message = format!("the points of `{wanted}` depend on this spline, which goes through them");
        let help = "sample a surface that is made without this profile";
        context.report(Diagnostic::new(Code::BrokenProfile, asked.span, message).help(help));
    }
}

/// The points of one row or column of a sample, in the coordinates that are asked for.
fn points<'g>(
    context: &mut Context<'g>,
    asked: &Asked,
    surface: &GeneratedSurface<'g>,
    sample: &Sample<'g>,
) -> Option<Vec<(f64, f64)>> {
    let [rows, columns] = sample.counts;
    if rows > 1 && columns > 1 {
        let message = format!("`{}` has {rows} rows of {columns} points: a spline goes through one", surface.name);
        let [one, other] = &sample.labels;
        let help = format!("give `{one}` or `{other}` one value, in a sample of its own: `sample … as NAME {{ … }}`");
        context.report(Diagnostic::new(Code::SampleShape, asked.span, message).help(help));
        return None;
    }
    if rows * columns > limits::SPLINE_POINTS.most {
        context.report(limits::SPLINE_POINTS.exceeded(asked.span));
        return None;
    }
    let wanted = asked.coordinates.iter().map(|name| {
        let Some(found) = surface.coordinate(&name.node) else {
            let known = surface.coordinates();
            context.unknown(name, "coordinate", known.iter().map(|coordinate| coordinate.name.as_str()));
            return None;
        };
        if found.dimension != Dimension::LENGTH {
            let message = format!("the points of a spline are lengths, `{}` is {}", found.name, found.dimension);
            context.report(Diagnostic::new(Code::WrongDimension, name.span, message));
            return None;
        }
        Some(found.value)
    });
    let wanted: Vec<Expr<'g>> = wanted.collect::<Option<_>>()?;
    // the points that a spline goes through are numbers
    context.variables_of(&wanted).into_iter().for_each(|of| _ = context.constant(of));
    let mut system = System::new(context, surface, sample)?;
    let mut values = context.values().to_vec();
    let mut found = Vec::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        if !context.spend(system.operations, asked.span) {
            return None;
        }
        let at = sample.grid.at(row, column);
        match system.at(at, &mut values) {
            Ok(()) => {
                let point = context.graph.evaluate(&wanted, &values);
                found.push((point[0], point[1]));
            }
            Err(why) => {
                lost(context, asked, (surface, sample), at, &why);
                return None;
            }
        }
    }
    Some(found)
}

fn lost(
    context: &mut Context<'_>,
    asked: &Asked,
    (surface, sample): (&GeneratedSurface<'_>, &Sample<'_>),
    at: [f64; 2],
    why: &NoRoot,
) {
    let place = [0, 1].map(|k| {
        let coordinate = &sample.coordinates[k];
        format!("{} = {}", coordinate.name, shown(at[k], coordinate.dimension))
    });
    let place = place.join(", ");
    let unknowns: Vec<&str> = surface.unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
    let unknowns = quoted(&unknowns);
    let (why, help) = match why {
        NoRoot::None(_) => (
            format!("at {place} there is none in the ranges of {unknowns}"),
            "widen the ranges, or ask for points that the surface has",
        ),
        NoRoot::Several(_) => (
            format!("at {place} there is more than one in the ranges of {unknowns}"),
            "narrow the ranges, or say with `keep` in the sample which one is meant",
        ),
        NoRoot::Unproven(_) | NoRoot::TooFast => (
            format!("whether there is one in the ranges of {unknowns} is not decided at {place}"),
            "keep places where the surface folds out of the sample, and narrow the ranges",
        ),
    };
    let message = format!("the points of `{}` cannot be proven: {why}", surface.name);
    context.report(Diagnostic::new(Code::Unproven, asked.span, message).help(help));
}

/// The equations of a point of a sample.
struct System<'g> {
    roots: OnlyRoots,
    /// What the roots are the values of.
    unknowns: Vec<Expr<'g>>,
    /// The values of the parameters in the equations.
    parameters: Vec<f64>,
    /// Unknowns of the surface that the sample itself gives, by the number of the coordinate.
    given: Vec<(Expr<'g>, usize)>,
    /// Numbers of the operations in the equations.
    operations: usize,
}

impl<'g> System<'g> {
    /// `None` where a parameter has no value, which has been reported.
    fn new(context: &mut Context<'g>, surface: &GeneratedSurface<'g>, sample: &Sample<'g>) -> Option<System<'g>> {
        let mut unknowns: Vec<Unknown<'g>> = surface
            .unknowns
            .iter()
            .map(|unknown| Unknown { variable: unknown.variable, range: Interval::new(unknown.low, unknown.high) })
            .collect();
        let mut residuals = surface.surface.constraints.clone();
        let (mut given, mut targets) = (Vec::new(), Vec::new());
        for (k, coordinate) in sample.coordinates.iter().enumerate() {
            // the range of an unknown that is given is no matter of proof
            if let Some(own) = unknowns.iter().position(|unknown| unknown.variable == coordinate.value) {
                unknowns.remove(own);
                given.push((coordinate.value, k));
                targets.push(coordinate.value);
            } else {
                let target = context.variable(coordinate.name.clone(), Role::Unknown, f64::NAN);
                residuals.push(coordinate.value - target);
                targets.push(target);
            }
        }
        for (coordinate, (low, high)) in &sample.keep {
            let range = Interval::new(*low, *high);
            match unknowns.iter_mut().find(|unknown| unknown.variable == coordinate.value) {
                Some(own) => own.range = own.range.intersection(range),
                None if targets.contains(&coordinate.value) => {}
                None => {
                    let variable = context.variable(coordinate.name.clone(), Role::Unknown, f64::NAN);
                    residuals.push(coordinate.value - variable);
                    unknowns.push(Unknown { variable, range });
                }
            }
        }
        let variables: Vec<Expr<'g>> = unknowns.iter().map(|unknown| unknown.variable).collect();
        let mut others = targets.clone();
        others.extend(
            context.variables_of(&residuals).into_iter().filter(|it| !variables.contains(it) && !targets.contains(it)),
        );
        others[targets.len()..].iter().for_each(|other| _ = context.constant(*other));
        let parameters: Vec<f64> = others[targets.len()..].iter().map(|other| context.value_of(*other)).collect();
        if parameters.iter().any(|value| value.is_nan()) || unknowns.iter().any(|unknown| !unknown.range.continuous) {
            return None;
        }
        let operations = context.graph.size(&residuals);
        let roots = OnlyRoots::new(&residuals, &unknowns, &others);
        Some(System { roots, unknowns: variables, parameters, given, operations })
    }

    /// Puts the values of the unknowns among those of all variables.
    fn at(&mut self, targets: [f64; 2], values: &mut Vec<f64>) -> Result<(), NoRoot> {
        let others: Vec<f64> = targets.into_iter().chain(self.parameters.iter().copied()).collect();
        let roots = self.roots.at(&others)?;
        let given = self.given.iter().map(|(variable, k)| (*variable, targets[*k]));
        for (variable, value) in self.unknowns.iter().copied().zip(roots).chain(given) {
            let index = variable.as_variable().expect("an unknown is a variable").index();
            if values.len() <= index {
                values.resize(index + 1, f64::NAN);
            }
            values[index] = value;
        }
        Ok(())
    }
}

//! What mounting errors and settings do to a contact.

use flank_chain_dsl::{Contact, Dimension, Job, Parameter, closest};
use flank_expr::Expr;
use flank_solver::ContactState;

use crate::contact::pair::Members;
use crate::contact::place::{dot, fine, rows_at};
use crate::contact::result::{ContactInfluence, InfluenceKind};
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::requests::MountingError;
use crate::project::units;
use crate::solve::sensitivity::usual_change;

/// The mounting errors that influences are told for.
const A_LENGTH: f64 = 0.01;
const AN_ANGLE: f64 = std::f64::consts::PI / 180.0 / 60.0;
/// A setting that moves the middle by less, mm, and changes the error by less, urad or um, its parabola and the ellipse by a lesser share,
/// changes nothing: rounding.
const NOTHING: f64 = 1e-9;
/// A second derivative of the error below this is that of an even one: rounding. No share of it is told.
const EVEN: f64 = 1e-12;

/// The errors of all axes of the pair's machine: those that are asked for, and none of the others.
///
/// # Errors
/// If one names no axis, or has the unit of another kind of axis.
pub(crate) fn mounting(
    job: &Job<'_>,
    contact: &Contact<'_>,
    asked: &[(String, MountingError)],
) -> Result<Vec<f64>, Failure> {
    let mut errors = vec![0.0; contact.errors.len()];
    for (name, error) in asked {
        let names = || contact.errors.iter().map(|axis| axis.name.as_str());
        let Some(at) = names().position(|axis| axis == name) else {
            let near = closest(name, names()).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            let known = names().collect::<Vec<&str>>().join(", ");
            let (job, contact) = (&job.name, &contact.name);
            return Err(Failure::from(format!(
                "option `error {name}`: the pair of contact `{contact}` of job `{job}` has no such axis; it has {known}{near}"
            )));
        };
        if asked.iter().filter(|(other, _)| other == name).count() > 1 {
            return Err(Failure::Request(format!("option `error` names `{name}` twice: leave one of them out")));
        }
        let dimension = contact.errors[at].dimension;
        errors[at] = match error {
            MountingError::Length(mm) if dimension == Dimension::LENGTH => *mm,
            MountingError::Angle(radians) if units::is_angle(dimension) => *radians,
            _ => {
                let wanted = if units::is_angle(dimension) {
                    "an angle, for example 2arcmin"
                } else {
                    "a length, for example 0.1mm"
                };
                return Err(Failure::from(format!("option `error {name}`: this axis takes {wanted}")));
            }
        };
    }
    Ok(errors)
}

/// What changes a contact: its name, what it is, the numbers of the symbols that change with their shares, and the change that is told.
struct Cause {
    name: String,
    kind: InfluenceKind,
    of: Vec<(usize, f64)>,
    step: f64,
    per: String,
}

/// What each axis of the pair's machine does to the middle, but for those that turn it, and then each setting of machines and tools, the one
/// that moves it most first. None where the flanks touch along a line: any change brings them to an end of it, one or the other by its sign.
pub(crate) fn of_all<'g>(
    job: &Job<'g>,
    members: &Members<'_, 'g>,
    errors: &[f64],
    rolling: &Rolling,
    compound: f64,
) -> Vec<ContactInfluence> {
    let Some(middle) = rolling.middle().filter(|middle| middle.state != Some(ContactState::Line)) else {
        return Vec::new();
    };
    let problem = members.open_problem(job, errors);
    let unknown = members.contact.lag.dimension;
    let along = rows_at(members, 1, middle);
    let influence = |cause: Cause| {
        let change = problem.change(middle, &cause.of, rolling.vertex.is_some())?;
        let unit = cause.step;
        let way = |k: usize| unit * dot(&change.moved[k], &change.moved[k]).sqrt();
        let ellipse = change.gap.zip(middle.gap.as_ref()).map(|([_, by], gap)| -0.5 * unit * by / gap.k2);
        let parabola = middle.lag_slopes[1];
        let on = along.as_ref().map(|on| [on.lengthwise, on.profilewise]);
        Some(ContactInfluence {
            name: cause.name,
            kind: cause.kind,
            per: cause.per,
            moved_mm: [way(0), way(1)],
            along_rows_mm: on.map(|on| on.map(|to| unit * dot(&change.moved[1], &to))),
            error: fine(unknown, unit * change.lag),
            parabola: (parabola.abs() > EVEN).then(|| unit * change.lag_curvature / parabola),
            ellipse: ellipse.filter(|_| middle.ellipse(compound).is_some()),
            turn: units::shown(members.contact.roll.dimension, unit * change.roll),
        })
    };
    let mut all: Vec<ContactInfluence> = axes(members.contact).into_iter().filter_map(influence).collect();
    let changes = |influence: &ContactInfluence| {
        let shares = influence.ellipse.into_iter().chain(influence.parabola);
        shares.chain([influence.moved_mm[1], influence.error]).any(|change| change.abs() > NOTHING)
    };
    let mut settings: Vec<ContactInfluence> =
        settings(job, errors.len()).into_iter().filter_map(influence).filter(changes).collect();
    settings.sort_by(|a, b| b.moved_mm[1].total_cmp(&a.moved_mm[1]));
    all.extend(settings);
    all
}

fn axes(contact: &Contact<'_>) -> Vec<Cause> {
    let cause = |(number, axis): (usize, &flank_chain_dsl::MountingAxis<'_>)| {
        let (step, per) = match units::is_angle(axis.dimension) {
            true => (AN_ANGLE, "1 arcmin".to_string()),
            false => (A_LENGTH, "0.01 mm".to_string()),
        };
        Cause { name: axis.name.clone(), kind: InfluenceKind::Mounting, of: vec![(number, 1.0)], step, per }
    };
    contact.errors.iter().enumerate().filter(|(_, axis)| !axis.is_driven).map(cause).collect()
}

/// Of machines, tools and the job: what is defined by one that changes follows it.
fn settings(job: &Job<'_>, first: usize) -> Vec<Cause> {
    let cause = |(parameter, of): (&Parameter<'_>, Vec<(usize, f64)>)| {
        let step = usual_change(parameter);
        let per = match parameter.dimension {
            Dimension::LENGTH => "0.01 mm".to_string(),
            Dimension::ANGLE => "1 arcmin".to_string(),
            _ if parameter.value != 0.0 => "0.1 %".to_string(),
            other => units::as_given(other, step),
        };
        Cause { name: parameter.name.clone(), kind: InfluenceKind::Setting, of, step, per }
    };
    let all = job.parameters.iter().zip(following(job, &[], first));
    all.filter(|(parameter, _)| !parameter.is_count).map(cause).collect()
}

/// For each parameter of a job the symbols of [`Members::open_problem`] that change with it, each with its share: itself, and what is
/// defined by it, but for those that are `open`, which change by themselves. Its settings begin at the symbol `first`, behind the axes.
pub(crate) fn following<'g>(job: &Job<'g>, open: &[Expr<'g>], first: usize) -> Vec<Vec<(usize, f64)>> {
    let known = |p: &Parameter<'g>| {
        let is_open = open.contains(&p.variable);
        let definition = if is_open { p.variable.graph().constant(p.value) } else { p.definition };
        flank_solver::Parameter { variable: p.variable, definition, value: p.value }
    };
    let known: Vec<flank_solver::Parameter<'g>> = job.parameters.iter().map(known).collect();
    let following = flank_solver::total_derivatives(&known).expect("a job without errors leaves nothing unbound");
    // symbols are those that are no counts
    let number = |at: usize| first + job.parameters[..at].iter().filter(|parameter| !parameter.is_count).count();
    let symbols = |of: Vec<(usize, f64)>| {
        let continuous = of.into_iter().filter(|(at, _)| !job.parameters[*at].is_count);
        continuous.map(|(at, share)| (number(at), share)).collect()
    };
    following.into_iter().map(symbols).collect()
}

//! Whether expectations hold.

use flank_chain_dsl::{
    Dimension, Expected, Job, PointColumn, PoseDifference, PoseTolerance, Process, Quantity, Sample,
};
use flank_expr::Expr;
use flank_solver::{Outcome, SurfacePoint};

use crate::compare::deviation;
use crate::compare::map::Named;
use crate::convert::Conversion;
use crate::project::failure::Failure;
use crate::project::requests::Onto;
use crate::project::units;
use crate::solve::required::RequiredNumber;
use crate::solve::{self, SolveOptions, cut, travel};
use crate::testing::points::{Tested, place};
use crate::testing::quantities::{FOLLOWED, Known};
use crate::testing::values::{LEFT, values};

/// What was found where a formula has no value.
const NO_NUMBER: &str = "no number: the formula has no value there";
/// Places that are named one by one.
const NAMED: usize = 3;

/// What became of an expectation.
pub(super) struct Verdict {
    pub(super) holds: bool,
    pub(super) found: String,
    pub(super) details: Vec<String>,
}

impl Verdict {
    fn lost(found: impl Into<String>) -> Verdict {
        Verdict { holds: false, found: found.into(), details: Vec::new() }
    }
}

/// # Errors
/// If the work is cancelled, or the memory does not suffice.
pub(super) fn judged<'g>(known: &Known<'_, '_, 'g>, expected: &Expected<'g>) -> Result<Verdict, Failure> {
    let tested = known.tested;
    match expected {
        Expected::Status { surfaces, status, at } => Ok(of_status(tested, surfaces, (status, at))),
        Expected::Table { surface, columns, rows, within } => Ok(of_table(tested, *surface, (columns, rows, *within))),
        Expected::Surface { surface, other, within } => of_surface(known, *surface, (other, *within)),
        Expected::AtPoints { surface, value, known, dimension, ends, is_difference } => {
            let wanted = Wanted { ends: *ends, is_difference: *is_difference };
            Ok(at_points(tested, *surface, (*value, known), *dimension, wanted))
        }
        Expected::Value { value, ends, quantities, dimension } => {
            of_value(known, [*value, ends[0], ends[1]], quantities, *dimension)
        }
        Expected::Travel { machine } => of_travel(tested, machine.as_deref()),
        Expected::On { onto, machine, within } => on(known, onto, (machine.as_deref(), *within)),
        Expected::Pose { off, within } => Ok(of_pose(*off, *within)),
    }
}

/// How far a frame of a machine may be off, and is.
pub(super) fn of_pose(off: PoseDifference, within: PoseTolerance) -> Verdict {
    let distance = precise(Dimension::LENGTH, off.distance);
    let found = match off.angle {
        Some(angle) => format!("off by {distance}, turned by {}", precise(Dimension::ANGLE, angle)),
        None => format!("off by {distance}, and of the other hand: one of both poses is mirrored"),
    };
    let exact = |what: &str, most: String, other: &str| {
        format!("no tolerance is written for the {what}, so only rounding is allowed, {most}: add {other}")
    };
    let mut details = Vec::new();
    if within.distance.is_none() && off.distance > PoseTolerance::EXACT_DISTANCE {
        let most = precise(Dimension::LENGTH, PoseTolerance::EXACT_DISTANCE);
        details.push(exact("origin", most, "a length, as in `within 1 um, 1 arcsec`"));
    }
    if within.angle.is_none() && off.angle.is_some_and(|angle| angle > PoseTolerance::EXACT_ANGLE) {
        let most = precise(Dimension::ANGLE, PoseTolerance::EXACT_ANGLE);
        details.push(exact("turn", most, "an angle, as in `within 1 um, 1 arcsec`"));
    }
    Verdict { holds: within.allows(off), found, details }
}

/// A value with its unit, small ones in small units.
pub(super) fn precise(dimension: Dimension, value: f64) -> String {
    const ARCSEC: f64 = std::f64::consts::PI / 648_000.0;
    let size = value.abs();
    let (number, unit) = match dimension {
        Dimension::LENGTH if size < 0.1 => (1e3 * value, "um"),
        Dimension::LENGTH => (value, "mm"),
        Dimension::ANGLE if size < 60.0 * ARCSEC => (value / ARCSEC, "arcsec"),
        Dimension::ANGLE => (value.to_degrees(), "deg"),
        _ => (value, ""),
    };
    let unit = if unit.is_empty() { units::whole_symbol(dimension) } else { unit.to_string() };
    format!("{} {unit}", significant(number)).trim_end().to_string()
}

/// Six digits, without zeros at the end.
pub(super) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{}", if value == 0.0 { 0.0 } else { value });
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..9).contains(&exponent) {
        return format!("{value:.3e}");
    }
    let text = format!("{value:.*}", usize::try_from(5 - exponent).unwrap_or(0));
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

fn of_status(tested: &Tested<'_, '_>, surfaces: &[usize], (status, at): (&str, &[[f64; 2]])) -> Verdict {
    let (mut asked, mut wrong, mut details) = (0, 0, Vec::new());
    for index in surfaces {
        let surface = tested.surface(*index);
        let listed = (!at.is_empty()).then(|| tested.listed(*index, at.to_vec()));
        let (sample, points): (&Sample<'_>, &[SurfacePoint]) = match &listed {
            Some((sample, points)) => (sample, points),
            None => match &surface.sample {
                Some(sample) => (sample, tested.points(*index)),
                None => continue,
            },
        };
        let others: Vec<usize> = (0..points.len()).filter(|k| points[*k].outcome.word() != status).collect();
        asked += points.len();
        wrong += others.len();
        details.extend(
            others
                .iter()
                .take(NAMED)
                .map(|k| format!("{} is {} at {}", surface.name, points[*k].outcome.word(), place(sample, *k))),
        );
        if others.len() > NAMED {
            details.push(format!(
                "and {} of {} elsewhere",
                units::counted(others.len() - NAMED, "point"),
                surface.name
            ));
        }
        if !others.is_empty() && status == Outcome::Solved.word() {
            details.extend(tested.hints(*index));
        }
    }
    let found = format!("{} of {} {status}", asked - wrong, units::counted(asked, "point"));
    Verdict { holds: wrong == 0 && asked > 0, found, details }
}

/// What a sample requires of its solved points, by its number.
pub(super) fn of_requirement(tested: &Tested<'_, '_>, index: usize, number: usize) -> Verdict {
    let surface = tested.surface(index);
    let Some(sample) = &surface.sample else { return Verdict::lost("no sample") };
    let (points, limit) = (tested.points(index), &sample.limits[number]);
    let required = RequiredNumber::all(surface, &tested.job.bindings());
    let missed: Vec<(usize, f64)> = required[number].missed(points).collect();
    let all = units::counted(points.len(), "point");
    if points.iter().all(|point| point.outcome != Outcome::Solved) {
        return Verdict {
            details: tested.hints(index),
            ..Verdict::lost(format!("no point of {} is solved", surface.name))
        };
    }
    if missed.is_empty() {
        return Verdict { holds: true, found: format!("at {all} of {}", surface.name), details: Vec::new() };
    }
    let found = format!("not at {} of {all} of {}: {}", missed.len(), surface.name, limit.message);
    let told = |(at, value): &(usize, f64)| {
        format!("{} is {} at {}", limit.of.name, precise(limit.of.dimension, *value), place(sample, *at))
    };
    Verdict { holds: false, found, details: missed.iter().take(NAMED).map(told).collect() }
}

/// What is wanted of a value at points.
#[derive(Clone, Copy)]
struct Wanted {
    ends: [f64; 2],
    /// Whether it is how far another value is off.
    is_difference: bool,
}

impl Wanted {
    fn within(most: f64) -> Wanted {
        Wanted { ends: [-most, most], is_difference: true }
    }
}

/// Where a value at points lies that is to be between two ends: the worst place, and how many are wrong.
fn worst(
    (sample, points): (&Sample<'_>, &[SurfacePoint]),
    values: &[Option<f64>],
    (name, dimension): (&str, Dimension),
    Wanted { ends: [low, high], is_difference }: Wanted,
) -> Verdict {
    let excess = |value: f64| if value.is_nan() { f64::INFINITY } else { (low - value).max(value - high) };
    let known = values.iter().enumerate().filter_map(|(k, value)| value.map(|value| (k, value)));
    // what is cut away is no point of the finished work
    let is_lost = |k: &usize| values[*k].is_none() && !matches!(points[*k].outcome, Outcome::CutAway(_));
    let unknown: Vec<usize> = (0..values.len()).filter(is_lost).collect();
    let farthest = known.clone().reduce(|a, b| if excess(b.1) > excess(a.1) { b } else { a });
    let Some((at, value)) = farthest else {
        let details = unknown.iter().take(NAMED).map(|k| told(points, sample, *k)).collect();
        let is_solved = points.iter().any(|point| point.outcome == Outcome::Solved);
        let found = if is_solved {
            format!("no point of {name} has this value")
        } else {
            format!("no point of {name} is solved")
        };
        return Verdict { holds: false, found, details };
    };
    let wrong = known.filter(|(_, value)| excess(*value) > 0.0).count();
    let what = if is_difference { "off by up to" } else { "reaches" };
    let found = match if is_difference { value.abs() } else { value } {
        shown if shown.is_nan() => NO_NUMBER.to_string(),
        shown => format!("{what} {}", precise(dimension, shown)),
    };
    let mut details: Vec<String> = unknown.iter().take(NAMED).map(|k| told(points, sample, *k)).collect();
    if wrong > 0 {
        let all = units::counted(values.len(), "point");
        details.insert(0, format!("at {wrong} of {all}, most at {}", place(sample, at)));
    }
    Verdict { holds: wrong == 0 && unknown.is_empty(), found, details }
}

fn told(points: &[SurfacePoint], sample: &Sample<'_>, at: usize) -> String {
    match points[at].outcome {
        Outcome::Solved => format!("nothing is known at {}", place(sample, at)),
        other => format!("{} at {}", other.word(), place(sample, at)),
    }
}

fn at_points<'g>(
    tested: &Tested<'_, 'g>,
    index: usize,
    (value, known): (Expr<'g>, &[(&'static str, Expr<'g>)]),
    dimension: Dimension,
    wanted: Wanted,
) -> Verdict {
    let surface = tested.surface(index);
    let Some(sample) = &surface.sample else { return Verdict::lost("no sample") };
    let points = tested.points(index);
    let values = values(tested, index, (Some(sample), points), (value, known));
    let mut verdict = worst((sample, points), &values, (&surface.name, dimension), wanted);
    let used = value.graph().variables_of(&[value]);
    let is_named = |start: &str| {
        let is_used = |variable: &Expr<'g>| variable.as_variable().is_some_and(|id| used.contains(&id));
        known.iter().any(|(name, variable)| name.starts_with(start) && is_used(variable))
    };
    if is_named("induced_") && surface.generation.process != Process::Envelope {
        let of_tool = "induced curvatures are of an envelope and the tool that touches it: this surface is none";
        verdict.details = vec![of_tool.to_string()];
    } else if !verdict.holds {
        verdict.details.extend(tested.hints(index));
        if is_named(LEFT) {
            verdict.details.extend(cut::unknown_of(tested.job, surface, points, tested.session));
        }
    }
    verdict
}

fn of_table<'g>(
    tested: &Tested<'_, 'g>,
    index: usize,
    (columns, rows, within): (&[PointColumn<'g>], &[Vec<f64>], f64),
) -> Verdict {
    let surface = tested.surface(index);
    let [PointColumn::Coordinate(first), PointColumn::Coordinate(second), compared @ ..] = columns else {
        return Verdict::lost("points are found by coordinates, not by what is known of them");
    };
    let at = rows.iter().map(|row| [row[0], row[1]]).collect();
    let (sample, points) = tested.generated(index, [first.clone(), second.clone()], at);
    let graph = surface.surface.position.0[0].graph();
    let mut verdicts = Vec::new();
    for (k, column) in compared.iter().enumerate() {
        let (name, dimension, found) = match column {
            PointColumn::Coordinate(of) => {
                (of.name.as_str(), of.dimension, values(tested, index, (Some(&sample), &points), (of.value, &[])))
            }
            PointColumn::Known(name, dimension) => {
                let variable = graph.variable(*name);
                let found = values(tested, index, (Some(&sample), &points), (variable, &[(*name, variable)]));
                (*name, *dimension, found)
            }
        };
        let apart: Vec<Option<f64>> = found.iter().zip(rows).map(|(value, row)| Some((*value)? - row[2 + k])).collect();
        verdicts.push((name, worst((&sample, &points), &apart, (&surface.name, dimension), Wanted::within(within))));
    }
    let holds = verdicts.iter().all(|(_, verdict)| verdict.holds);
    let found: Vec<String> = verdicts.iter().map(|(name, verdict)| format!("{name} {}", verdict.found)).collect();
    let mut details: Vec<String> = verdicts
        .iter()
        .filter(|(_, verdict)| !verdict.holds)
        .flat_map(|(name, verdict)| verdict.details.iter().map(move |line| format!("{name}: {line}")))
        .collect();
    let lost = points.iter().filter(|point| point.outcome != Outcome::Solved).count();
    if lost > 0 {
        details.push(format!(
            "{lost} of {} of the table are no points of {}: is it a table of another grid, or of another surface?",
            units::counted(rows.len(), "row"),
            surface.name
        ));
    }
    Verdict { holds, found: found.join(", "), details }
}

fn of_surface(known: &Known<'_, '_, '_>, index: usize, (other, within): (&str, f64)) -> Result<Verdict, Failure> {
    let tested = known.tested;
    let own = Named { job: tested.job, surface: tested.surface(index) };
    let other = known.named(other)?;
    // normals are those of the surface that is sampled
    let pair = if other.surface.sample.is_some() { [own, other] } else { [other, own] };
    if pair[1].surface.sample.is_none() {
        return Ok(Verdict::lost("neither surface is sampled"));
    }
    let map = deviation::measure(pair, true, tested.session)?;
    // where a surface is not solved at all, that no point lies beside the other one follows from it
    if let [why, others @ ..] = &map.refused[..]
        && map.deviations.iter().all(Option::is_none)
    {
        let details = others.iter().map(|why| why.message.clone()).collect();
        return Ok(Verdict { holds: false, found: why.message.clone(), details });
    }
    let Some(sample) = &pair[1].surface.sample else { return Ok(Verdict::lost("no sample")) };
    let deviations: Vec<Option<f64>> = map.deviations.iter().map(|um| um.map(|um| 1e-3 * um)).collect();
    let name = pair[1].whole_name();
    let mut verdict = worst((sample, &map.points), &deviations, (&name, Dimension::LENGTH), Wanted::within(within));
    verdict.details.extend(map.refused.iter().map(|why| why.message.clone()));
    if !verdict.holds && pair[0].surface.frame != pair[1].surface.frame {
        let [one, other] = pair.map(|of| format!("{} in {}", of.whole_name(), of.surface.frame));
        verdict
            .details
            .push(format!("they lie in different frames, {one} and {other}, and are compared in coordinates of these"));
    }
    Ok(verdict)
}

fn of_value<'g>(
    known: &Known<'_, '_, 'g>,
    all: [Expr<'g>; 3],
    quantities: &[(Expr<'g>, Quantity<'g>)],
    dimension: Dimension,
) -> Result<Verdict, Failure> {
    let graph = known.graph;
    let mut values = known.tested.job.bindings();
    for (variable, quantity) in quantities {
        match known.number(quantity)? {
            Ok(number) => values.push((*variable, graph.constant(number))),
            Err(why) => return Ok(Verdict::lost(why)),
        }
    }
    let numbers = graph.substitute(&all, &values);
    let mut numbers = numbers.iter().map(|number| number.as_constant().unwrap_or(f64::NAN));
    let [value, low, high] = std::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN));
    let holds = low <= value && value <= high;
    let found = if value.is_nan() { NO_NUMBER.to_string() } else { precise(dimension, value) };
    let off = if value < low { value - low } else { value - high };
    let beyond = format!(
        "{} {} {}",
        precise(dimension, off.abs()),
        if off < 0.0 { "below" } else { "above" },
        precise(dimension, if off < 0.0 { low } else { high })
    );
    Ok(Verdict { holds, found, details: if holds || value.is_nan() { Vec::new() } else { vec![beyond] } })
}

/// The surfaces of the job with their points.
fn of_travel(tested: &Tested<'_, '_>, machine: Option<&str>) -> Result<Verdict, Failure> {
    let options: SolveOptions<'_> = tested.options();
    let solved = tested.job.surfaces.iter().filter_map(|surface| solve::solve_surface(tested.job, surface, options));
    let solved: Vec<_> = solved.collect::<Result<_, Failure>>()?;
    let runs = travel::runs(tested.job, &solved);
    let of = |name: &str| machine.is_none_or(|machine| machine == name);
    let ended: Vec<_> = runs.iter().filter(|run| of(run.machine()) && run.is_beyond().is_some()).collect();
    let has_travel = runs.iter().any(|run| of(run.machine()) && run.axis.travel.is_some());
    if ended.is_empty() && has_travel && !solved.is_empty() {
        return Ok(Verdict::lost("no point of the job is solved: nothing says how far its axes move"));
    }
    let beyond = travel::beyond(tested.job, &solved);
    let prefix = machine.map(|machine| format!("{machine}."));
    let beyond = beyond.into_iter().filter(|one| {
        prefix.as_ref().is_none_or(|prefix| one.of.as_ref().is_some_and(|of| of.starts_with(prefix.as_str())))
    });
    let details: Vec<String> = beyond.map(|one| one.message).collect();
    let found = format!("{} of {} within travel", ended.len() - details.len(), units::counted(ended.len(), "axis"));
    Ok(Verdict { holds: details.is_empty(), found: found.replace("axiss", "axes"), details })
}

fn on<'g>(
    known: &Known<'_, '_, 'g>,
    onto: &Job<'g>,
    (machine, within): (Option<&str>, f64),
) -> Result<Verdict, Failure> {
    let tested = known.tested;
    let is_made = |frame: &str| machine.is_none_or(|name| frame.split('.').next() == Some(name));
    let surface =
        tested.job.surfaces.iter().find(|surface| {
            is_made(&surface.frame) && !surface.generation.motions.is_empty() && surface.sample.is_some()
        });
    let Some(surface) = surface else { return Ok(Verdict::lost("no sampled surface is made by a motion")) };
    let asked = Onto { surface: Some(surface.name.clone()), ..Onto::default() };
    let conversion = Conversion::new(known.graph, tested.job, onto, (&asked, tested.session), FOLLOWED);
    let conversion = match conversion {
        Ok(conversion) => conversion,
        Err(Failure::Input(reason)) => return Ok(Verdict::lost(reason)),
        Err(other) => return Err(other),
    };
    let told = conversion.failures();
    if !told.is_empty() {
        let details = told.into_iter().map(|why| why.message).collect();
        let found = format!("{} does not do the same", conversion.machine.name);
        return Ok(Verdict { holds: false, found, details });
    }
    if !conversion.touches() {
        let found = format!("no point of {} is solved: nothing says where its tool touches", surface.name);
        return Ok(Verdict { holds: false, found, details: Vec::new() });
    }
    let off = conversion.off();
    let found = format!("off by up to {}", precise(Dimension::LENGTH, off));
    Ok(Verdict { holds: off <= within, found, details: Vec::new() })
}

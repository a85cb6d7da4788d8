//! Where nothing of a surface was found: where it lies within its ranges, or, where the tool touches nowhere, how fast an axis would have to
//! move for it to touch.

use flank_chain_dsl::{Axis, Coordinate, GeneratedSurface, Job, Process, RangedVariable, ToolShape};
use flank_expr::geometry::Surface;
use flank_expr::{Expr, ScalarEvaluator, Tape};
use flank_solver::{Outcome, SurfacePoint, SurfaceProblem};

use crate::project::units;
use crate::solve::surface::bound;

/// Places within the ranges that are looked at.
const PLACES: usize = 4096;
/// Points of a surface that its extents are told from.
const MOST_POINTS: usize = 512;
/// Values of each parameter of the tool at which it is asked how fast an axis would have to move.
const ON_TOOL: usize = 9;
/// The speeds that are tried: so many times that of the law, either way, in steps of a fraction.
const FASTEST: i32 = 4;
const STEPS: i32 = 8;
/// How near to the opposite of its law an axis would have to move for its sense to be doubted.
const OPPOSITE: f64 = 0.1;
/// Boxes that the search for points with an axis that moves the other way looks at.
const MOST_BOXES: u64 = 500;
/// Halvings of a gap between places.
const HALVINGS: usize = 40;

/// Why no point of a sample was found, as far as the surface without the sample tells; nothing where a point was found. Where other ranges
/// would reach the points, they are the reason, unless an axis may move the wrong way.
pub(crate) fn told(job: &Job<'_>, surface: &GeneratedSurface<'_>, points: &[SurfacePoint]) -> Vec<String> {
    let is_missing = |point: &SurfacePoint| matches!(point.outcome, Outcome::NotConverged { .. });
    let is_beyond = |point: &SurfacePoint| matches!(point.outcome, Outcome::Outside { .. });
    if points.is_empty() || !points.iter().all(|point| is_missing(point) || is_beyond(point)) {
        return Vec::new();
    }
    let is_reached = !points.iter().any(is_missing);
    let nowhere = |unknowns: &[RangedVariable<'_>], place: &str| {
        let speeds = all_speeds(job, surface, unknowns);
        let is_told = !is_reached || speeds.iter().any(|(_, speeds)| is_opposite(*speeds));
        if is_told { no_contact(surface, unknowns, place, &speeds) } else { Vec::new() }
    };
    let elsewhere = match extents(job, surface, &surface.unknowns) {
        Extents::Unknown if is_reached => return Vec::new(),
        Extents::Unknown => return opposite(job, surface),
        Extents::Nowhere => return nowhere(&surface.unknowns, ""),
        Extents::Between(ends) => elsewhere(surface, ends).filter(|_| !is_reached),
    };
    let sampled = within_sample(surface);
    match extents(job, surface, &sampled) {
        _ if elsewhere.is_some() => elsewhere.into_iter().collect(),
        Extents::Nowhere => nowhere(&sampled, " at the places of the sample"),
        Extents::Unknown | Extents::Between(_) => Vec::new(),
    }
}

/// The unknowns of a surface, in the ranges of its sample where that asks for points by them.
fn within_sample<'g>(surface: &GeneratedSurface<'g>) -> Vec<RangedVariable<'g>> {
    let mut unknowns = surface.unknowns.clone();
    for (k, of) in surface.sample.iter().flat_map(|sample| sample.coordinates.iter().enumerate()) {
        let Some(unknown) = unknowns.iter_mut().find(|unknown| unknown.variable == of.value) else { continue };
        let [low, high] = asked(surface, k);
        if low <= unknown.high && high >= unknown.low {
            (unknown.low, unknown.high) = (unknown.low.max(low), unknown.high.min(high));
        }
    }
    unknowns
}

/// Between which values of one of its coordinates the sample of a surface asks for points.
fn asked(surface: &GeneratedSurface<'_>, coordinate: usize) -> [f64; 2] {
    let targets = surface.sample.iter().flat_map(|sample| sample.each_target());
    targets.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], target| {
        [low.min(target[coordinate]), high.max(target[coordinate])]
    })
}

/// Between which values the coordinates of a sample lie at points of a surface.
enum Extents {
    /// It is not looked at.
    Unknown,
    /// No points were found.
    Nowhere,
    Between([[f64; 2]; 2]),
}

/// Where a surface has points whose unknowns are in some ranges.
fn extents(job: &Job<'_>, surface: &GeneratedSurface<'_>, unknowns: &[RangedVariable<'_>]) -> Extents {
    let bound = bound(job, surface);
    let constraint = sole_constraint(bound.surface(), unknowns);
    let (Some(sample), Some(constraint)) = (&surface.sample, constraint) else { return Extents::Unknown };
    let coordinates = bound.with_values(&sample.functions());
    let values = [constraint, coordinates[0], coordinates[1]];
    let tape = Tape::new(&values, &bound.surface().unknowns).expect("a job without errors leaves nothing unbound");
    let (mut evaluator, mut out) = (ScalarEvaluator::new(&tape), [0.0; 3]);
    let mut at = |place: &[f64]| {
        evaluator.run(place, &mut out);
        out
    };
    let points = zeros(unknowns, |place| at(place)[0]);
    let found = points.iter().map(|point| at(point)).map(|[_, first, second]| [[first; 2], [second; 2]]);
    let wider = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    match found.reduce(|a, b| [wider(a[0], b[0]), wider(a[1], b[1])]) {
        Some(ends) => Extents::Between(ends),
        None => Extents::Nowhere,
    }
}

/// The one constraint of a surface with unknowns of few values each.
fn sole_constraint<'g>(surface: &Surface<'g>, unknowns: &[RangedVariable<'_>]) -> Option<Expr<'g>> {
    let is_ranged = |unknown: &RangedVariable<'_>| !unknown.is_count && (unknown.high - unknown.low).is_finite();
    match surface.constraints[..] {
        [constraint] if unknowns.iter().all(is_ranged) => Some(constraint),
        _ => None,
    }
}

/// Places within ranges at which a function is zero, between neighbours of a lattice.
fn zeros(unknowns: &[RangedVariable<'_>], mut function: impl FnMut(&[f64]) -> f64) -> Vec<Vec<f64>> {
    let count = (1..).take_while(|count: &usize| count.pow(unknowns.len() as u32) <= PLACES).last().unwrap_or(1);
    let lattice = lattice(&vec![count; unknowns.len()]);
    let place = |at: &[usize]| -> Vec<f64> { at.iter().zip(unknowns).map(|(k, of)| spread(of, *k, count)).collect() };
    let values: Vec<f64> = lattice.iter().map(|at| function(&place(at))).collect();
    let next = |number: usize, along: usize| number + count.pow((unknowns.len() - 1 - along) as u32);
    let gaps = lattice.iter().enumerate().flat_map(|(number, at)| {
        let along = (0..at.len()).filter(|along| at[*along] + 1 < count);
        along.map(move |along| [number, next(number, along)])
    });
    let gaps = gaps.filter(|[a, b]| values[*a] == 0.0 || values[*a] * values[*b] < 0.0);
    let gaps: Vec<[usize; 2]> = gaps.collect();
    let few = gaps.iter().step_by(gaps.len().div_ceil(MOST_POINTS).max(1));
    let ends = |gap: &[usize; 2]| gap.map(|number| (place(&lattice[number]), values[number]));
    few.filter_map(|gap| zero_between(ends(gap), &mut function)).collect()
}

/// All combinations of so many values each, the last one fastest.
fn lattice(counts: &[usize]) -> Vec<Vec<usize>> {
    let longer = |all: Vec<Vec<usize>>, count: &usize| -> Vec<Vec<usize>> {
        all.iter().flat_map(|at| (0..*count).map(move |k| [&at[..], &[k]].concat())).collect()
    };
    counts.iter().fold(vec![Vec::new()], longer)
}

/// One of so many values in a range, both ends among them.
fn spread(of: &RangedVariable<'_>, k: usize, count: usize) -> f64 {
    if count == 1 {
        return 0.5 * (of.low + of.high);
    }
    of.low + (of.high - of.low) * k as f64 / (count - 1) as f64
}

/// Where a function is zero between two places with its values there, unless it jumps.
fn zero_between(ends: [(Vec<f64>, f64); 2], function: &mut impl FnMut(&[f64]) -> f64) -> Option<Vec<f64>> {
    let [(mut low, first), (mut high, last)] = ends;
    if first == 0.0 {
        return Some(low);
    }
    if first * last >= 0.0 {
        return None;
    }
    let mut value = first;
    for _ in 0..HALVINGS {
        let middle: Vec<f64> = low.iter().zip(&high).map(|(a, b)| 0.5 * (a + b)).collect();
        value = function(&middle);
        if value * first > 0.0 { low = middle } else { high = middle }
    }
    (value.abs() < first.abs().min(last.abs())).then_some(low)
}

/// The coordinates that the surface does not have within its ranges where points are asked for.
fn elsewhere(surface: &GeneratedSurface<'_>, ends: [[f64; 2]; 2]) -> Option<String> {
    let sample = surface.sample.as_ref()?;
    let missed = [0, 1].into_iter().filter_map(|k| {
        let (of, asked) = (&sample.coordinates[k], asked(surface, k));
        let [has, wants] = [ends[k], asked].map(|[low, high]| {
            format!("{} .. {}", units::digits(of.dimension, low, 4), units::text(of.dimension, high, 4))
        });
        let is_missed = asked[0] < ends[k][0] || asked[1] > ends[k][1];
        is_missed.then(|| format!("{} {has}, the sample asks for {wants}", of.name))
    });
    let missed: Vec<String> = missed.collect();
    (!missed.is_empty()).then(|| format!("within its ranges the surface has points at {}", missed.join("; and at ")))
}

/// That no contact of the tool was found in some ranges, and how fast single axes would have to move for one.
fn no_contact(
    surface: &GeneratedSurface<'_>,
    unknowns: &[RangedVariable<'_>],
    place: &str,
    speeds: &[(String, [f64; 2])],
) -> Vec<String> {
    let tool = &surface.generation.tool_name;
    let mut told = vec![format!("no contact of {tool} with the work was found within its ranges{place}")];
    if speeds.is_empty() {
        return told;
    }
    let doubt = match speeds.iter().any(|(_, speeds)| is_opposite(*speeds)) {
        true => "an axis may move the wrong way",
        false => "the ratio of the motions, or the place of the tool, may be wrong",
    };
    let each = speeds.iter().map(|(name, [low, high])| format!("{name} moved {low:.2} .. {high:.2} times"));
    let motions = unknowns.iter().filter(|of| surface.generation.motions.contains(&of.variable));
    let at = motions.map(|of| format!("{} = {}", of.name, units::told(of.dimension, reference(of))));
    let (at, each) = (at.collect::<Vec<_>>().join(", "), each.collect::<Vec<_>>().join(", or "));
    told.push(format!("at {at} there would be one if {each} as fast as by its law: {doubt}"));
    told
}

/// Whether an axis would do that moves by the opposite of its law.
fn is_opposite([low, high]: [f64; 2]) -> bool {
    low < -1.0 + OPPOSITE && high > -1.0 - OPPOSITE
}

/// The axes of a surface's machine, each by how many times as fast as by its law it would have to move for the tool to touch.
fn all_speeds(
    job: &Job<'_>,
    surface: &GeneratedSurface<'_>,
    unknowns: &[RangedVariable<'_>],
) -> Vec<(String, [f64; 2])> {
    let machine = surface.frame.split('.').next().unwrap_or_default();
    let axes = job.machines.iter().filter(|of| of.name == machine).flat_map(|of| &of.axes);
    let named = |axis: &Axis<'_>| format!("{machine}.{}", axis.name);
    axes.filter_map(|axis| Some((named(axis), speeds(job, surface, unknowns, axis)?))).collect()
}

/// Where a motion is looked at: at zero if its range holds that, in its middle otherwise.
fn reference(of: &RangedVariable<'_>) -> f64 {
    if of.low <= 0.0 && of.high >= 0.0 { 0.0 } else { 0.5 * (of.low + of.high) }
}

/// How many times as fast as by its law an axis would have to move for the tool to touch somewhere on its surface, where the motions
/// are at their references; none where it would not, or where the axis does not move by them.
fn speeds<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    unknowns: &[RangedVariable<'_>],
    axis: &Axis<'g>,
) -> Option<[f64; 2]> {
    let generation = &surface.generation;
    let graph = axis.variable.graph();
    let factor = graph.variable("speed");
    let made = with_speed(job, surface, unknowns, (axis, factor))?;
    let constraint = sole_constraint(&made, unknowns)?;
    let constraint = graph.substitute(&[constraint], &job.bindings())[0];
    let inputs: Vec<Expr<'g>> = made.unknowns.iter().copied().chain([factor]).collect();
    let tape = Tape::new(&[constraint], &inputs).ok()?;
    let mut evaluator = ScalarEvaluator::new(&tape);
    let counts: Vec<usize> =
        unknowns.iter().map(|of| if generation.motions.contains(&of.variable) { 1 } else { ON_TOOL }).collect();
    let mut found: Option<[f64; 2]> = None;
    for at in lattice(&counts) {
        let place = |k: usize| match counts[k] {
            1 => reference(&unknowns[k]),
            count => spread(&unknowns[k], at[k], count),
        };
        let mut place: Vec<f64> = (0..at.len()).map(place).chain([0.0]).collect();
        if let Some(speed) = speed_at(&mut place, |at| {
            let mut out = [0.0];
            evaluator.run(at, &mut out);
            out[0]
        }) {
            found = Some(found.map_or([speed; 2], |[low, high]| [low.min(speed), high.max(speed)]));
        }
    }
    // where both slower and faster would do, so would the law somewhere between the places
    found.filter(|[low, high]| *low > 1.0 || *high < 1.0)
}

/// The surface with an axis that moves a factor times as fast as by its law, where the motions are away from their references; none where it
/// does not move by them.
fn with_speed<'g>(
    job: &Job<'g>,
    surface: &GeneratedSurface<'g>,
    unknowns: &[RangedVariable<'_>],
    (axis, factor): (&Axis<'g>, Expr<'g>),
) -> Option<Surface<'g>> {
    let generation = &surface.generation;
    let graph = axis.variable.graph();
    let over = surface.unknowns.iter().zip(unknowns).filter(|(own, _)| generation.motions.contains(&own.variable));
    let at: Vec<(Expr<'g>, Expr<'g>)> = over.map(|(own, of)| (own.variable, graph.constant(reference(of)))).collect();
    let still = graph.substitute(&[axis.law], &at)[0];
    if still == axis.law {
        return None;
    }
    let law = |of: &Axis<'g>| if of.variable == axis.variable { still + factor * (of.law - still) } else { of.law };
    let axes = job.machines.iter().flat_map(|machine| &machine.axes);
    let laws: Vec<(Expr<'g>, Expr<'g>)> = axes.map(|of| (of.variable, law(of))).collect();
    let driven = generation.t_work_tool.substituted(&laws).merged();
    match (generation.process, &generation.tool) {
        (Process::Envelope, ToolShape::Surface(tool)) => Some(tool.envelope(&driven, &generation.motions)),
        (Process::Sweep, ToolShape::Edge(edge)) => Some(edge.sweep(&driven, &generation.motions, false)),
        _ => None,
    }
}

/// The axes that would lead to most of a few points of the sample if they moved by the opposite of their laws: of surfaces with several equations.
fn opposite(job: &Job<'_>, surface: &GeneratedSurface<'_>) -> Vec<String> {
    let machine = surface.frame.split('.').next().unwrap_or_default();
    let axes = job.machines.iter().filter(|of| of.name == machine).flat_map(|of| &of.axes);
    let told = axes.filter_map(|axis| {
        let [found, asked] = found_opposite(job, surface, axis)?;
        (2 * found > asked).then(|| {
            format!(
                "if {machine}.{} moved by the opposite of its law, {found} of {asked} points of the sample would be found: an axis may move \
                 the wrong way",
                axis.name
            )
        })
    });
    told.collect()
}

/// How many of a few points of the sample are found where an axis moves by the opposite of its law, and how many were asked for.
fn found_opposite<'g>(job: &Job<'g>, surface: &GeneratedSurface<'g>, axis: &Axis<'g>) -> Option<[usize; 2]> {
    let sample = surface.sample.as_ref()?;
    let back = axis.variable.graph().constant(-1.0);
    let made = with_speed(job, surface, &surface.unknowns, (axis, back))?;
    let turned = GeneratedSurface { surface: made, ..surface.clone() };
    let own = |of: &Coordinate<'g>| turned.coordinates().into_iter().find(|own| own.name == of.name);
    let [first, second] = sample.coordinates.each_ref().map(|of| own(of).map(|own| own.value));
    let problem = SurfaceProblem::new(&bound(job, &turned), [first?, second?]).ok()?;
    let [rows, columns] = sample.counts;
    let places = [(rows / 2, columns / 2), (0, 0), (0, columns - 1), (rows - 1, 0), (rows - 1, columns - 1)];
    let targets = places.map(|(row, column)| sample.grid.at(row, column));
    let (points, _) = problem.points_alone().boxes(MOST_BOXES).solve(&targets, [1, targets.len()]);
    // several branches are points, too
    let is_found =
        |point: &&SurfacePoint| matches!(point.outcome, Outcome::Solved | Outcome::CutAway(_) | Outcome::Ambiguous);
    Some([points.iter().filter(is_found).count(), targets.len()])
}

/// The zero of a function of the last value of a place that is nearest to 1, among the speeds that are tried.
fn speed_at(place: &mut [f64], mut function: impl FnMut(&[f64]) -> f64) -> Option<f64> {
    let last = place.len() - 1;
    let mut with = |speed: f64| {
        place[last] = speed;
        (place.to_vec(), function(place))
    };
    let tried = (-FASTEST * STEPS..=FASTEST * STEPS).map(|k| f64::from(k) / f64::from(STEPS));
    let values: Vec<(Vec<f64>, f64)> = tried.map(&mut with).collect();
    let mut function = |at: &[f64]| with(at[last]).1;
    let found = values
        .windows(2)
        .filter_map(|pair| zero_between([pair[0].clone(), pair[1].clone()], &mut function).map(|place| place[last]));
    found.min_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs()))
}

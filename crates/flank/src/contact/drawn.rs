//! What pictures show of a contact: both flanks with gaps, path, ellipses and transfer points, and the error over the roll.

use std::f64::consts::{PI, TAU};

use flank_chain_dsl::{Job, OutlineCurve, OutlineSegment, Solid};
use flank_draw::{ContactMark, DrawnContact, DrawnFlank, ErrorCurves, Station, StationShape, round_step};
use flank_export::text::shown_unit;
use flank_export::{Field, Patch, Values, fixed};
use flank_expr::{ScalarEvaluator, Tape};
use flank_solver::{ContactPoint, ContactState, RollingPair};

use crate::contact::pair::Members;
use crate::contact::patches;
use crate::contact::pattern::GapMap;
use crate::contact::place::{fine, fine_unit};
use crate::contact::rolling::Rolling;
use crate::project::units;

/// Pictures show no gap as wider than so many films: the pattern is to be seen.
pub(crate) const FILMS: f64 = 5.0;
/// About so many roll positions have their ellipse.
const STATIONS: f64 = 9.0;
/// Straight parts of an ellipse, and of an arc of an outline.
const PARTS: usize = 72;
const ARC_PARTS: usize = 24;
/// Pairs of teeth are drawn as far as they stay behind the one that carries by no more than so many times its own error.
const BEHIND: f64 = 4.0;
/// Pairs of teeth whose lags differ by less hand over there, rad or mm.
const ALIKE: f64 = 1e-9;

/// A contact as pictures show it.
pub(crate) fn drawn<'g>(
    job: &Job<'g>,
    members: &Members<'_, 'g>,
    (pair, rolling): (&RollingPair<'_, 'g>, &Rolling),
    maps: &[GapMap],
    compound: f64,
) -> DrawnContact {
    let stations = stations(members, rolling);
    // flanks that touch along lines have no path of a point
    let is_line = rolling.state() == Some(ContactState::Line);
    let transfers = rolling.transfers();
    let flank = |member: usize| DrawnFlank {
        patch: near(patches::flank(job, members, member, &maps[member]), compound),
        outline: members.solids[member].map_or(Vec::new(), outline),
        path: if is_line { Vec::new() } else { path(rolling, member, compound) },
        stations: match is_line {
            true => stations.iter().map(|point| line_at(members, point)).collect(),
            false => ellipses(members, (pair, member), &stations, compound),
        },
        marks: if is_line { Vec::new() } else { marks(members, rolling, member, &transfers) },
    };
    DrawnContact {
        name: members.contact.name.clone(),
        film: compound * 1e3,
        flanks: [flank(0), flank(1)],
        error: curves(members, rolling, compound, &transfers),
    }
}

/// Where the teeth of a solid end, in the axial plane `y = 0` of its frame.
fn outline(solid: &Solid) -> Vec<Vec<[f64; 3]>> {
    let line = |segment: &OutlineSegment| {
        let places = match segment.curve {
            OutlineCurve::Line => vec![segment.from, segment.to],
            OutlineCurve::Arc { center } => arc(segment, center),
        };
        places.into_iter().map(|[z, rho]| [rho, 0.0, z]).collect()
    };
    solid.outline.iter().map(line).collect()
}

/// The shorter way round.
fn arc(segment: &OutlineSegment, [z, rho]: [f64; 2]) -> Vec<[f64; 2]> {
    let polar = |[a, b]: [f64; 2]| ((a - z).hypot(b - rho), (b - rho).atan2(a - z));
    let ((radius, from), (_, to)) = (polar(segment.from), polar(segment.to));
    let turn = (to - from + PI).rem_euclid(TAU) - PI;
    let at = |part: usize| {
        let (sin, cos) = (from + turn * part as f64 / ARC_PARTS as f64).sin_cos();
        [z + radius * cos, rho + radius * sin]
    };
    (0..=ARC_PARTS).map(at).collect()
}

/// The same points, no gap wider than so many films.
fn near(patch: Patch, compound: f64) -> Patch {
    let near = |field: Field| match field.values {
        Values::Scalars(gaps) if field.name == patches::GAP => {
            let gaps = gaps.iter().map(|gap| gap.map(|gap| gap.min(FILMS * 1e3 * compound))).collect();
            Field { values: Values::Scalars(gaps), ..field }
        }
        _ => field,
    };
    Patch { fields: patch.fields.into_iter().map(near).collect(), ..patch }
}

/// Where a pair of teeth touches on one of its flanks, in pieces of flank on flank and of edges; an edge as long as it is within the film
/// of the pair that carries. Pieces share the point between them.
fn path(rolling: &Rolling, member: usize, compound: f64) -> Vec<(bool, Vec<[f64; 3]>)> {
    let is_seen = |step: isize, point: &ContactPoint| {
        let carried =
            rolling.engagement.carried(step).filter(|_| rolling.has_pitch).map_or(point.lag, |carried| carried.lag);
        point.is_of_flanks() || ((point.lag - carried) * point.opening).abs() <= compound
    };
    let points: Vec<(isize, &ContactPoint)> = rolling.all_steps().zip(&rolling.engagement.points).collect();
    let runs = points.split(|(step, point)| !is_seen(*step, point));
    let of_run = |run: &[(isize, &ContactPoint)]| {
        pieces(run.iter().map(|(_, point)| (!point.is_of_flanks(), point.in_members[member])))
    };
    runs.flat_map(of_run).collect()
}

/// Runs of the same kind, each begun at the last point of the one before.
fn pieces<T: Copy>(points: impl Iterator<Item = (bool, T)>) -> Vec<(bool, Vec<T>)> {
    let mut pieces: Vec<(bool, Vec<T>)> = Vec::new();
    for (is_edge, at) in points {
        match pieces.last_mut() {
            Some((kind, points)) if *kind == is_edge => points.push(at),
            last => {
                let before = last.and_then(|(_, points)| points.last().copied());
                pieces.push((is_edge, before.into_iter().chain([at]).collect()));
            }
        }
    }
    pieces
}

/// Contacts of the flanks at round roll positions.
fn stations(members: &Members<'_, '_>, rolling: &Rolling) -> Vec<ContactPoint> {
    let dimension = members.contact.roll.dimension;
    let unit = units::shown(dimension, 1.0);
    let flank = || rolling.engagement.points.iter().filter(|point| point.is_of_flanks()).map(|point| point.roll * unit);
    let (low, high) = (flank().fold(f64::MAX, f64::min), flank().fold(f64::MIN, f64::max));
    let step = round_step((high - low) / STATIONS);
    if !(step.is_finite() && step > 0.0) {
        return Vec::new();
    }
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let rolls = (first..=last).map(|k| k as f64 * step / unit);
    let points = rolls.filter_map(|roll| rolling.problem.pair_at(&rolling.engagement, 0, roll));
    points.filter(ContactPoint::is_of_flanks).collect()
}

fn label(members: &Members<'_, '_>, roll: f64, decimals: usize) -> String {
    let roll = units::shown(members.contact.roll.dimension, roll);
    let text = fixed(roll, decimals);
    // round positions without their zeros
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    let (short, unit) = (short.replace('-', "\u{2212}"), units::symbol(members.contact.roll.dimension));
    if unit == "deg" { format!("{short}\u{b0}") } else { format!("{short} {unit}").trim().to_string() }
}

fn line_at(members: &Members<'_, '_>, point: &ContactPoint) -> Station {
    let roll = units::shown(members.contact.roll.dimension, point.roll);
    Station { label: label(members, point.roll, 6), shape: StationShape::Line(roll) }
}

/// Points of contact with the ellipse within the film about each, in the tangent plane, in the frame of a flank.
fn ellipses<'g>(
    members: &Members<'_, 'g>,
    (pair, member): (&RollingPair<'_, 'g>, usize),
    stations: &[ContactPoint],
    compound: f64,
) -> Vec<Station> {
    let rotation = pair.placements[member].pose().rotation.entries();
    let tape = Tape::new(&rotation, &[pair.roll, pair.lag.0]).expect("a job without errors leaves nothing unbound");
    let mut evaluator = ScalarEvaluator::new(&tape);
    let ellipse = |point: &ContactPoint, evaluator: &mut ScalarEvaluator<'_>| -> Option<Vec<[f64; 3]>> {
        let axes = point.ellipse(compound)?;
        let directions = point.gap.as_ref()?.directions?;
        let mut rows = [0.0; 9];
        evaluator.run(&[point.roll, point.lag], &mut rows);
        // from the frame of the contact into that of the flank: the transpose
        let own = directions.map(|d| [0, 1, 2].map(|k| (0..3).map(|row| rows[3 * row + k] * d[row]).sum::<f64>()));
        let at = |part: usize| {
            let (sin, cos) = (TAU * part as f64 / PARTS as f64).sin_cos();
            [0, 1, 2].map(|k| point.in_members[member][k] + axes[0] * cos * own[0][k] + axes[1] * sin * own[1][k])
        };
        Some((0..=PARTS).map(at).collect())
    };
    let station = |point: &ContactPoint| Station {
        label: label(members, point.roll, 6),
        shape: StationShape::Point {
            position: point.in_members[member],
            ellipse: ellipse(point, &mut evaluator).unwrap_or_default(),
        },
    };
    stations.iter().map(station).collect()
}

/// The middle, and the places at which pairs of teeth hand over.
fn marks(members: &Members<'_, '_>, rolling: &Rolling, member: usize, transfers: &[f64]) -> Vec<ContactMark> {
    let middle = rolling.middle().map(|point| ContactMark {
        is_transfer: false,
        label: "middle".to_string(),
        position: point.in_members[member],
    });
    let handing = transfers.iter().flat_map(|roll| handing(rolling, *roll));
    let transfers = handing.map(|point| ContactMark {
        is_transfer: true,
        label: label(members, point.roll, 2),
        position: point.in_members[member],
    });
    middle.into_iter().chain(transfers).collect()
}

/// The contacts of the pairs of teeth that carry together at a roll position, each where the pair of the middle is then.
fn handing(rolling: &Rolling, roll: f64) -> Vec<ContactPoint> {
    let Some(lag) = rolling.lag_at(roll) else { return Vec::new() };
    let Some(middle) = rolling.middle() else { return Vec::new() };
    let engagement = &rolling.engagement;
    let near = ((roll - middle.roll) / engagement.pitch * engagement.steps as f64).round() as isize;
    let points = [near - 1, near, near + 1].into_iter().flat_map(|step| engagement.pairs(step));
    let mut pairs: Vec<isize> = points.collect();
    pairs.sort_unstable();
    pairs.dedup();
    let points = pairs.into_iter().filter_map(|pair| rolling.problem.pair_at(engagement, pair, roll));
    points.filter(|point| (point.lag - lag).abs() < ALIKE).collect()
}

/// The error of each pair of teeth that touches within a pitch of the middle, and of the one that carries.
fn curves(members: &Members<'_, '_>, rolling: &Rolling, compound: f64, transfers: &[f64]) -> ErrorCurves {
    let (roll, lag) = (&members.contact.roll, &members.contact.lag);
    let reference = rolling.middle().map_or(0.0, |middle| middle.lag);
    let engagement = &rolling.engagement;
    let error = |at: f64| fine(lag.dimension, at - reference);
    let at_roll = |at: f64| units::shown(roll.dimension, at);
    let place = |step: isize, lag: f64| [at_roll(rolling.roll(step)), error(lag)];
    let all = shown_steps(rolling);
    let steps = || all.clone();
    let mut numbers: Vec<isize> = steps().flat_map(|step| engagement.pairs(step)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    if !rolling.has_pitch {
        numbers = vec![0];
    }
    let carried = |step: isize| match rolling.has_pitch {
        true => Some(engagement.carried(step)?.lag),
        false => Some(engagement.point(0, step)?.lag),
    };
    // the composite repeats after a pitch: a kink of it has its place between two steps
    let again = [-1.0, 0.0, 1.0].map(|by| by * engagement.pitch);
    let limits = [all.start, all.end - 1].map(|step| rolling.roll(step));
    let kinks: Vec<f64> = transfers
        .iter()
        .flat_map(|roll| again.map(|by| roll + by))
        .filter(|roll| rolling.has_pitch && (limits[0]..=limits[1]).contains(roll))
        .collect();
    let kink = |roll: f64| Some([at_roll(roll), error(rolling.lag_at(roll)?)]);
    let mut composite: Vec<[f64; 2]> = steps().filter_map(|step| Some(place(step, carried(step)?))).collect();
    composite.extend(kinks.iter().filter_map(|roll| kink(*roll)));
    composite.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let drawn =
        composite.iter().fold([f64::MAX, f64::MIN], |[low, high], [_, error]| [low.min(*error), high.max(*error)]);
    // extremes lie between the positions that are drawn
    let ends = rolling.span(transfers).map_or(drawn, |span| span.map(error));
    let is_shown = |point: &ContactPoint, step: isize| {
        let behind = carried(step).map_or(0.0, |carried| (point.lag - carried).abs());
        fine(lag.dimension, behind)
            <= (BEHIND * (ends[1] - ends[0])).max(fine(lag.dimension, compound / point.opening.abs()))
    };
    let pair = |number: isize| {
        let points = steps().filter_map(|step| {
            let point = engagement.point(number, step).filter(|point| is_shown(point, step))?;
            Some((!point.is_of_flanks(), place(step, point.lag)))
        });
        pieces(points)
    };
    let unit = fine_unit(lag.dimension);
    let over = rolling.gap().map_or(String::new(), |known| {
        format!(" over {} {}", fixed(units::shown(roll.dimension, known.width()), 3), units::symbol(roll.dimension))
    });
    let height = format!("peak to peak {} {}{over}", fixed(ends[1] - ends[0], 3), shown_unit(unit));
    let peaks = composite.first().map(|_| (ends, height));
    let transfers = kinks.iter().filter_map(|roll| Some((kink(*roll)?, label(members, *roll, 3))));
    ErrorCurves {
        over: format!("{}, {}", roll.name, units::symbol(roll.dimension)),
        unit: unit.to_string(),
        pairs: numbers.into_iter().map(pair).collect(),
        transfers: transfers.map(|(at, text)| (at, format!("transfer {text}"))).collect(),
        peaks,
        composite: if rolling.has_pitch { composite } else { Vec::new() },
    }
}

/// A pitch to both sides of the middle, or all where there is one pair alone.
fn shown_steps(rolling: &Rolling) -> std::ops::Range<isize> {
    let steps = rolling.engagement.steps as isize;
    if rolling.has_pitch { -steps..steps + 1 } else { rolling.all_steps() }
}

//! Files of a contact: how near the mate comes to the points of both flanks, the path on both, and pictures.

use flank_chain_dsl::Job;
use flank_draw::{ContactDrawing, ErrorCurves, Picture, PictureOptions, contact as picture};
use flank_export::{Axis, Dataset, Field, Header, Patch, Values};
use flank_solver::{ContactPoint, Outcome, SurfacePoint};

use crate::contact::pair::Members;
use crate::contact::pattern::GapMap;
use crate::contact::place::{fine, fine_unit};
use crate::contact::rolling::Rolling;
use crate::project::failure::Failure;
use crate::project::files::Folder;
use crate::project::requests::{ContactRequest, Session};
use crate::project::spec::Origin;
use crate::project::units;
use crate::solve::{header, patch};

/// Pictures show no gap as wider than so many films: the pattern is to be seen.
const FILMS: f64 = 5.0;

/// Writes them and names them.
///
/// # Errors
/// If one cannot be written.
pub(crate) fn write(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    rolling: &Rolling,
    maps: &[GapMap],
    (request, origin, session): (&ContactRequest, &Origin, Session),
) -> Result<Vec<String>, Failure> {
    let name = format!("{}.{}", job.name, members.contact.name);
    let mut header = header(&[job], &request.jobs, origin);
    header.conventions.push(format!(
        "gap: along the normal of the flank out of its body; film of the marking compound {} um",
        request.compound * 1e3
    ));
    let flanks: Vec<Patch> = maps.iter().enumerate().map(|(member, map)| flank(job, members, member, map)).collect();
    let drawn =
        (!request.no_picture).then(|| drawn(job, members, rolling, &flanks, (request.compound, header.clone())));
    let paths = (0..2).map(|member| path(job, members, rolling, member));
    let dataset = Dataset { header, patches: flanks.into_iter().chain(paths).collect() };
    let mut folder = Folder::at(&request.out, origin, session.monitor())?;
    folder.picture_after(&name, drawn.as_ref(), |folder| folder.data(&name, &dataset.surfaces(), &request.format))?;
    folder.finish()
}

/// The picture of a contact, with the origin that stands on it.
pub(crate) fn picture_of(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    rolling: &Rolling,
    maps: &[GapMap],
    (compound, header): (f64, Header),
) -> Picture {
    let flanks: Vec<Patch> = maps.iter().enumerate().map(|(member, map)| flank(job, members, member, map)).collect();
    drawn(job, members, rolling, &flanks, (compound, header))
}

fn drawn(
    job: &Job<'_>,
    members: &Members<'_, '_>,
    rolling: &Rolling,
    flanks: &[Patch],
    (compound, header): (f64, Header),
) -> Picture {
    let film = compound * 1e3;
    let drawing = ContactDrawing {
        dataset: Dataset { header, patches: flanks.iter().map(|patch| near(patch, compound)).collect() },
        title: format!("{}: pattern of {}", job.name, members.contact.name),
        note: format!(
            "Gap to the mate over the whole mesh of a pair of teeth, um, up to {FILMS} films of {film} um; the compound is pressed away \
             where it is thinner than one."
        ),
        film,
        paths: [0, 1].map(|member| flank_path(rolling, member)).to_vec(),
        error: curves(members, rolling, compound),
    };
    picture(&drawing, &PictureOptions::default())
}

fn field(name: &str, unit: &str, meaning: &str, values: impl Iterator<Item = Option<f64>>) -> Field {
    Field {
        name: name.to_string(),
        unit: unit.to_string(),
        meaning: meaning.to_string(),
        values: Values::Scalars(values.collect()),
    }
}

/// The points of a flank's sample with the least gap of each.
fn flank(job: &Job<'_>, members: &Members<'_, '_>, member: usize, map: &GapMap) -> Patch {
    let surface = members.surfaces[member];
    let sample = surface.sample.as_ref();
    let axis = |k: usize| Axis {
        label: sample.map_or(String::new(), |sample| sample.labels[k].clone()),
        count: sample.map_or(1, |sample| sample.counts[k]),
    };
    let patch = patch(job, &surface.name, surface, [axis(0), axis(1)], &members.points[member]);
    let roll = &members.contact.roll;
    let turn = |position: usize| units::shown(roll.dimension, map.positions[position][0]);
    let fields = vec![
        field(
            "gap",
            "um",
            "least distance to the mate along the normal, over the mesh",
            map.gaps.iter().map(|gap| Some(1e3 * (*gap)?.distance)),
        ),
        field(
            "nearest_at",
            unit_name(roll.dimension),
            "roll position of the least distance",
            map.gaps.iter().map(|gap| Some(turn((*gap)?.position))),
        ),
    ];
    Patch { fields, ..patch }
}

fn unit_name(dimension: flank_chain_dsl::Dimension) -> &'static str {
    match units::symbol(dimension) {
        "" => "1",
        symbol => symbol,
    }
}

/// The same, no gap wider than so many films.
fn near(patch: &Patch, compound: f64) -> Patch {
    let Values::Scalars(gaps) = &patch.fields[0].values else { return patch.clone() };
    let near = gaps.iter().map(|gap| gap.map(|gap| gap.min(FILMS * 1e3 * compound)));
    Patch {
        fields: vec![Field { values: Values::Scalars(near.collect()), ..patch.fields[0].clone() }],
        ..patch.clone()
    }
}

/// Where the flanks touch on one of them.
fn flank_path(rolling: &Rolling, member: usize) -> Vec<[f64; 3]> {
    let flank = rolling.engagement.points.iter().filter(|point| point.is_of_flanks());
    flank.map(|point| point.in_members[member]).collect()
}

/// Pairs of teeth are drawn as far as they stay behind the one that carries by no more than so many times its own error.
const BEHIND: f64 = 4.0;

/// The error of each pair of teeth that touches over the pitch about the middle, and of the one that carries.
fn curves(members: &Members<'_, '_>, rolling: &Rolling, compound: f64) -> ErrorCurves {
    let (roll, lag) = (&members.contact.roll, &members.contact.lag);
    let reference = rolling.middle().map_or(0.0, |middle| middle.lag);
    let engagement = &rolling.engagement;
    let place =
        |step: isize, at: f64| [units::shown(roll.dimension, rolling.roll(step)), fine(lag.dimension, at - reference)];
    let steps = || rolling.steps();
    let mut numbers: Vec<isize> = steps().flat_map(|step| engagement.pairs(step)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    if !rolling.has_pitch {
        numbers = vec![0];
    }
    let lags: Vec<f64> = steps().filter_map(|step| Some(engagement.carried(step)?.lag)).collect();
    let ends = lags.iter().fold([f64::MAX, f64::MIN], |[low, high], lag| [low.min(*lag), high.max(*lag)]);
    let is_shown = |point: &ContactPoint, step: isize| {
        let carried = engagement.carried(step).filter(|_| rolling.has_pitch);
        carried.is_none_or(|carried| {
            (point.lag - carried.lag).abs() <= (BEHIND * (ends[1] - ends[0])).max(compound / point.opening.abs())
        })
    };
    let pair = |number: isize| {
        let mut pieces: Vec<(bool, Vec<[f64; 2]>)> = Vec::new();
        for step in steps() {
            let Some(point) = engagement.point(number, step).filter(|point| is_shown(point, step)) else { continue };
            let (is_edge, at) = (!point.is_of_flanks(), place(step, point.lag));
            match pieces.last_mut() {
                Some((kind, points)) if *kind == is_edge => points.push(at),
                // pieces share the point between them
                last => {
                    let before = last.and_then(|(_, points)| points.last().copied());
                    pieces.push((is_edge, before.into_iter().chain([at]).collect()));
                }
            }
        }
        pieces
    };
    let carried = |step: isize| Some(place(step, engagement.carried(step)?.lag));
    let unit = units::symbol(roll.dimension);
    ErrorCurves {
        over: format!("{}, {unit}", roll.name),
        unit: fine_unit(lag.dimension).to_string(),
        pairs: numbers.into_iter().map(pair).collect(),
        composite: if rolling.has_pitch { steps().filter_map(carried).collect() } else { Vec::new() },
    }
}

/// The path of contact of one pair of teeth on a flank, from its first touch to its last.
fn path(job: &Job<'_>, members: &Members<'_, '_>, rolling: &Rolling, member: usize) -> Patch {
    let points = &rolling.engagement.points;
    let as_surface = |point: &ContactPoint| SurfacePoint {
        outcome: Outcome::Solved,
        unknowns: point.unknowns[member].clone(),
        position: point.in_members[member],
        normal: point.normals[member],
        residual: 0.0,
    };
    let on_surface: Vec<SurfacePoint> = points.iter().map(as_surface).collect();
    let surface = members.surfaces[member];
    let (roll, lag) = (&members.contact.roll, &members.contact.lag);
    let axes =
        [("", 1), (roll.name.as_str(), points.len())].map(|(label, count)| Axis { label: label.to_string(), count });
    let patch = patch(job, &format!("{}.path", surface.name), surface, axes, &on_surface);
    let of = |name: &str, unit: &str, meaning: &str, value: &dyn Fn(&ContactPoint) -> Option<f64>| {
        field(name, unit, meaning, points.iter().map(value))
    };
    let reference = rolling.middle().map_or(0.0, |middle| middle.lag);
    let carried = |point: &ContactPoint| {
        let step = ((point.roll - rolling.roll(0)) / rolling.engagement.pitch * rolling.engagement.steps as f64).round()
            as isize;
        rolling.engagement.carried(step).filter(|_| rolling.has_pitch)
    };
    let speed = |v: &[f64; 3]| Some(v.iter().map(|x| x * x).sum::<f64>().sqrt());
    let kind = |point: &ContactPoint| match point.edges[..] {
        [] => 0.0,
        [_] => 1.0,
        [a, b, ..] if a.member == b.member => 2.0,
        _ => 3.0,
    };
    let fields = vec![
        of("turn", unit_name(roll.dimension), "roll position", &|point| Some(units::shown(roll.dimension, point.roll))),
        of("lag", unit_name(lag.dimension), "what the contact adds to the law of the driven member", &|point| {
            Some(units::shown(lag.dimension, point.lag))
        }),
        of("error", fine_unit(lag.dimension), "the lag less that of the middle", &|point| {
            Some(fine(lag.dimension, point.lag - reference))
        }),
        of("composite", fine_unit(lag.dimension), "the same of the pair of teeth that carries", &|point| {
            Some(fine(lag.dimension, carried(point)?.lag - reference))
        }),
        of(
            "kind",
            "1",
            "0 flank on flank, 1 an edge on the other flank, 2 a corner, 3 two edges that cross",
            &|point| Some(kind(point)),
        ),
        of("gap_k1", "1/mm", "larger curvature of the gap", &|point| Some(point.gap.as_ref()?.k1)),
        of("gap_k2", "1/mm", "smaller curvature of the gap", &|point| Some(point.gap.as_ref()?.k2)),
        of("sliding", "mm/rad", "speed of the first member against the second", &|point| speed(&point.sliding)),
        of("entraining", "mm/rad", "half the sum of the velocities against the point", &|point| {
            speed(&point.entraining)
        }),
    ];
    Patch { fields, ..patch }
}

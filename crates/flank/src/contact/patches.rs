//! How near the mate comes to the points of a flank, and the path of contact on it, as patches.

use flank_chain_dsl::Job;
use flank_export::{Axis, Field, Patch, Values};
use flank_solver::{ContactPoint, Outcome, SurfacePoint};

use crate::contact::pair::Members;
use crate::contact::pattern::GapMap;
use crate::contact::place::{fine, fine_unit};
use crate::contact::rolling::Rolling;
use crate::project::units;
use crate::solve::patch;

/// The field of the least distance to the mate.
pub(crate) const GAP: &str = "gap";

fn field(name: &str, unit: &str, meaning: &str, values: impl Iterator<Item = Option<f64>>) -> Field {
    Field {
        name: name.to_string(),
        unit: unit.to_string(),
        meaning: meaning.to_string(),
        values: Values::Scalars(values.collect()),
    }
}

/// The points of a flank's sample with the least gap of each.
pub(crate) fn flank(job: &Job<'_>, members: &Members<'_, '_>, member: usize, map: &GapMap) -> Patch {
    let surface = members.surfaces[member];
    let sample = surface.sample.as_ref();
    let axis = |k: usize| Axis {
        label: sample.map_or(String::new(), |sample| sample.labels[k].clone()),
        count: sample.map_or(1, |sample| sample.counts[k]),
    };
    let patch = patch(job, &surface.name, surface, [axis(0), axis(1)], &members.points[member]);
    let roll = &members.contact.roll;
    let fields = vec![
        field(
            GAP,
            "um",
            "least distance to the mate along the normal, over the mesh",
            map.gaps.iter().map(|gap| Some(1e3 * (*gap)?.distance)),
        ),
        field(
            "nearest_at",
            unit_name(roll.dimension),
            "roll position of the least distance",
            map.gaps.iter().map(|gap| Some(units::shown(roll.dimension, (*gap)?.roll))),
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

/// The path of contact of one pair of teeth on a flank, from its first touch to its last.
pub(crate) fn path(job: &Job<'_>, members: &Members<'_, '_>, rolling: &Rolling, member: usize) -> Patch {
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

//! A body with smooth faces for a STEP file.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use flank_export::{GearBody, TurnedSegment, spline_deviation};
use flank_solver::{Body, Chart, MassProperties, OutlineSegment};

/// Rows and columns of a face that are tried: the spline through twice as many is nearer by sixteen.
const FEWEST: usize = 5;
const MOST: usize = 321;

/// A gear as its faces are written, as near as `tolerance` (mm) where `MOST` rows and columns suffice.
pub(crate) fn gear(name: &str, names: &[String], body: &Body, tolerance: f64) -> GearBody {
    let (charts, is_reversed) = body.charts();
    // neighbours have the same columns
    let land = body.land().filter(winds);
    let charts: Vec<&Chart> = charts.iter().chain(&land).collect();
    let along = charts.iter().map(|chart| fewest(chart, 1, tolerance)).max().unwrap_or(FEWEST);
    let mut deviation: f64 = 0.0;
    let mut space = Vec::new();
    for (k, chart) in charts.iter().enumerate() {
        let counts = [fewest(chart, 0, tolerance), along];
        let points = lattice(chart, counts);
        let doubled = lattice(chart, counts.map(|count| 2 * count - 1));
        deviation = deviation.max(spline_deviation(points.clone(), counts, &doubled));
        let own = if is_reversed { names.len().wrapping_sub(1 + k) } else { k };
        let name = names.get(own).unwrap_or(&body.blank().bounds()[1].name);
        space.push((name.clone(), points, counts));
    }
    let MassProperties { volume, area, centre, .. } = body.mass_properties();
    GearBody {
        name: name.to_string(),
        teeth: body.teeth() as usize,
        space,
        has_edge: body.has_edge() || land.is_some(),
        ends: body.blank().bounds().map(segment),
        rest: body.blank().rest().into_iter().map(segment).collect(),
        deviation,
        volume,
        area,
        centre,
    }
}

/// Whether a land winds about the axis so far that it is no part of a surface of revolution that readers could tell: by a quarter turn or
/// more.
fn winds(land: &Chart) -> bool {
    let angle = |[x, y, _]: [f64; 3]| y.atan2(x);
    let row = land.row(0);
    let steps = row.windows(2).map(|pair| (angle(pair[1]) - angle(pair[0]) + PI).rem_euclid(TAU) - PI);
    steps.sum::<f64>().abs() >= FRAC_PI_2
}

fn segment(of: &OutlineSegment) -> TurnedSegment {
    TurnedSegment { name: of.name.clone(), from: of.from, to: of.to, center: of.center }
}

fn lattice(chart: &Chart, counts: [usize; 2]) -> Vec<[f64; 3]> {
    let [across, along] = counts.map(|count| (0..count).map(|k| k as f64 / (count - 1) as f64).collect::<Vec<f64>>());
    chart.lattice(&across, &along)
}

/// The fewest rows (0) or columns (1) with which splines along them are near enough; both directions add up.
fn fewest(chart: &Chart, direction: usize, tolerance: f64) -> usize {
    let with = |count: usize| if direction == 0 { [count, FEWEST] } else { [FEWEST, count] };
    let mut count = FEWEST;
    while count < MOST {
        let off = off_in(chart, with(count), direction);
        if off <= 0.4 * tolerance {
            break;
        }
        // a spline of the third degree comes nearer by the fourth power
        let factor = (off / (0.3 * tolerance)).powf(0.25).clamp(1.1, 2.0);
        count = (((count - 1) as f64 * factor).ceil() as usize + 1).min(MOST);
    }
    count
}

/// How far splines along one direction are off between their points.
fn off_in(chart: &Chart, counts: [usize; 2], direction: usize) -> f64 {
    let mut doubled = counts;
    doubled[direction] = 2 * counts[direction] - 1;
    let (points, between) = (lattice(chart, counts), lattice(chart, doubled));
    let lines = |k: usize, grid: &[[f64; 3]], [_, columns]: [usize; 2]| -> Vec<[f64; 3]> {
        if direction == 0 {
            grid.iter().skip(k).step_by(columns).copied().collect()
        } else {
            grid[k * columns..][..columns].to_vec()
        }
    };
    let line_off = |k: usize| {
        let own = lines(k, &points, counts);
        // a ruled strip of the line and itself, whose own direction is exact
        let strip = |line: &[[f64; 3]]| line.iter().flat_map(|p| [*p, *p]).collect::<Vec<[f64; 3]>>();
        let fine = lines(k, &between, doubled);
        let fine: Vec<[f64; 3]> = fine.iter().flat_map(|p| [*p, *p, *p]).collect();
        spline_deviation(strip(&own), [own.len(), 2], &fine)
    };
    (0..counts[1 - direction]).map(line_off).fold(0.0, f64::max)
}

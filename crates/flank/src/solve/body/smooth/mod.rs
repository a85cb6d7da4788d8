//! A body, or one tooth or space of it, with smooth faces for a STEP file.

mod side;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use flank_export::{GearBody, GearRun, GearStrip, TurnedSegment, spline_deviation};
use flank_solver::{Arrangement, Body, BodyPart, Chart, MassProperties, OutlineSegment};

pub(crate) use side::BeyondEnds;
use side::{Cut, sides};

/// Rows and columns of a face that are tried: the spline through twice as many is nearer by sixteen.
const FEWEST: usize = 5;
const MOST: usize = 321;

/// A strip of the toothed side.
enum Strip {
    /// Part of a chart of the body, or of a land that is written as one, so many spaces on.
    Chart(Patch, i32),
    Land,
}

/// Part of a chart, between two shares across.
#[derive(Clone, PartialEq)]
struct Patch {
    chart: Chart,
    name: String,
    across: [f64; 2],
}

/// A part of a gear as its faces are written, as near as `tolerance` (mm) where `MOST` rows and columns suffice.
///
/// # Errors
/// What of the outline keeps a part from being cut off.
pub(crate) fn gear(
    name: &str,
    names: &[String],
    (body, part): (&Body, BodyPart),
    tolerance: f64,
) -> Result<GearBody, BeyondEnds> {
    let strips = strips(names, body, part);
    let mut patches: Vec<&Patch> = Vec::new();
    let mut written = Vec::new();
    for strip in &strips {
        written.push(match strip {
            Strip::Land => GearStrip::Land,
            Strip::Chart(patch, spaces) => {
                let known = patches.iter().position(|known| *known == patch);
                let surface = known.unwrap_or_else(|| {
                    patches.push(patch);
                    patches.len() - 1
                });
                GearStrip::Surface { surface, spaces: *spaces }
            }
        });
    }
    // neighbours have the same columns
    let along = patches.iter().map(|patch| fewest(patch, 1, tolerance)).max().unwrap_or(FEWEST);
    let mut deviation: f64 = 0.0;
    let mut surfaces = Vec::new();
    for patch in &patches {
        let counts = [fewest(patch, 0, tolerance), along];
        let points = patch.lattice(counts);
        let doubled = patch.lattice(counts.map(|count| 2 * count - 1));
        deviation = deviation.max(spline_deviation(points.clone(), counts, &doubled));
        surfaces.push((patch.name.clone(), points, counts));
    }
    let cut = match part {
        BodyPart::Gear if body.arrangement().is_closed() => None,
        _ => Some(cut(&strips, body)),
    };
    let sides = cut.map(|cut| sides(body, &cut, tolerance)).transpose()?;
    let (sides, off) = sides.map_or((None, 0.0), |(sides, off)| (Some(sides), off));
    let MassProperties { volume, area, centre, .. } = body.mass_properties();
    let is_whole = part == BodyPart::Gear;
    Ok(GearBody {
        name: name.to_string(),
        about: about(body, part),
        run: match body.arrangement() {
            Arrangement::Round => GearRun::Round { pitch: body.pitch() },
            Arrangement::Straight { pitch } => GearRun::Straight { pitch },
        },
        surfaces,
        strips: written,
        sides,
        ends: body.blank().bounds().map(segment),
        rest: body.blank().rest().into_iter().map(segment).collect(),
        deviation: deviation.max(off),
        // parts that are alike have equal shares of the whole
        volume: match body.distinct() {
            _ if is_whole => Some(volume),
            1 => Some(volume / f64::from(body.teeth())),
            _ => None,
        },
        area: is_whole.then_some(area),
        centre: is_whole.then_some(centre),
    })
}

fn about(body: &Body, part: BodyPart) -> String {
    let faces = body.charts().len();
    match part {
        BodyPart::Gear => format!("{} spaces of {faces} faces", body.teeth()),
        BodyPart::Tooth => format!("one tooth of {} between spaces of {faces} faces", body.teeth()),
        BodyPart::Space => format!("one space of {} with {faces} faces", body.teeth()),
    }
}

/// What follows each other, from side to side or all around.
fn strips(names: &[String], body: &Body, part: BodyPart) -> Vec<Strip> {
    let kinds = body.distinct() as i32;
    // of a space its kind, and how many spaces on it is from that
    let kind = |space: i32| (space.rem_euclid(kinds) as usize, if kinds == 1 { space } else { 0 });
    let chart = |space: i32, k: usize, across: [f64; 2]| {
        let (of, spaces) = kind(space);
        let own = if body.is_reversed() { names.len() - 1 - k } else { k };
        Strip::Chart(Patch { chart: body.spaces()[of][k].clone(), name: names[own].clone(), across }, spaces)
    };
    let land = |space: i32, across: [f64; 2]| {
        let (of, spaces) = kind(space);
        let land = body.land(of)?;
        let is_plain = across == [0.0, 1.0] && !winds(&land);
        let name = body.blank().bounds()[1].name.clone();
        Some(if is_plain { Strip::Land } else { Strip::Chart(Patch { chart: land, name, across }, spaces) })
    };
    let count = body.charts().len();
    let whole = |space: i32| (0..count).map(move |k| (space, k));
    // the halves of a space, parted in the middle of its ground
    let half = |space: i32, is_first: bool| {
        let middle = count / 2;
        let mut charts: Vec<(i32, usize, [f64; 2])> = match is_first {
            true => (0..middle).map(|k| (space, k, [0.0, 1.0])).collect(),
            false => (count - middle..count).map(|k| (space, k, [0.0, 1.0])).collect(),
        };
        if !count.is_multiple_of(2) {
            if is_first {
                charts.push((space, middle, [0.0, 0.5]))
            } else {
                charts.insert(0, (space, middle, [0.5, 1.0]))
            }
        }
        charts.into_iter().map(|(space, k, across)| chart(space, k, across)).collect::<Vec<Strip>>()
    };
    let teeth = body.teeth() as i32;
    let mut strips = Vec::new();
    match part {
        BodyPart::Gear if body.arrangement().is_closed() => {
            for space in 0..teeth {
                strips.extend(whole(space).map(|(space, k)| chart(space, k, [0.0, 1.0])));
                strips.extend(land(space, [0.0, 1.0]));
            }
        }
        BodyPart::Gear | BodyPart::Tooth => {
            let last = if part == BodyPart::Gear { teeth } else { 1 };
            strips.extend(half(0, false));
            for space in 0..last {
                strips.extend(land(space, [0.0, 1.0]));
                match space + 1 < last {
                    true => strips.extend(whole(space + 1).map(|(space, k)| chart(space, k, [0.0, 1.0]))),
                    false => strips.extend(half(space + 1, true)),
                }
            }
        }
        BodyPart::Space => {
            strips.extend(land(-1, [0.5, 1.0]));
            strips.extend(whole(0).map(|(space, k)| chart(space, k, [0.0, 1.0])));
            strips.extend(land(0, [0.0, 0.5]));
        }
    }
    strips
}

/// The lines at which a part is cut off from its neighbours.
fn cut(strips: &[Strip], body: &Body) -> [Cut; 2] {
    let line = |strip: &Strip, k: usize| match strip {
        Strip::Chart(patch, spaces) => {
            Cut { chart: patch.chart.clone(), across: patch.across[k], by: f64::from(*spaces) * body.pitch() }
        }
        Strip::Land => unreachable!("a part begins and ends with parts of charts"),
    };
    [line(&strips[0], 0), line(&strips[strips.len() - 1], 1)]
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

impl Patch {
    fn lattice(&self, counts: [usize; 2]) -> Vec<[f64; 3]> {
        let [across, along] =
            counts.map(|count| (0..count).map(|k| k as f64 / (count - 1) as f64).collect::<Vec<f64>>());
        let [from, to] = self.across;
        let share = |k: f64| if k == 1.0 { to } else { from + (to - from) * k };
        self.chart.lattice(&across.into_iter().map(share).collect::<Vec<f64>>(), &along)
    }
}

/// The fewest rows (0) or columns (1) with which splines along them are near enough; both directions add up.
fn fewest(patch: &Patch, direction: usize, tolerance: f64) -> usize {
    let with = |count: usize| if direction == 0 { [count, FEWEST] } else { [FEWEST, count] };
    let mut count = FEWEST;
    while count < MOST {
        let off = off_in(patch, with(count), direction);
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
fn off_in(patch: &Patch, counts: [usize; 2], direction: usize) -> f64 {
    let mut doubled = counts;
    doubled[direction] = 2 * counts[direction] - 1;
    let (points, between) = (patch.lattice(counts), patch.lattice(doubled));
    let lines = |k: usize, grid: &[[f64; 3]], [_, columns]: [usize; 2]| -> Vec<[f64; 3]> {
        if direction == 0 {
            grid.iter().skip(k).step_by(columns).copied().collect()
        } else {
            grid[k * columns..][..columns].to_vec()
        }
    };
    let line_off = |k: usize| curve_off(&lines(k, &points, counts), &lines(k, &between, doubled));
    (0..counts[1 - direction]).map(line_off).fold(0.0, f64::max)
}

/// How far the spline through points is off a line of which there is one point more between any two.
fn curve_off(points: &[[f64; 3]], doubled: &[[f64; 3]]) -> f64 {
    // a ruled strip of the line and itself, whose own direction is exact
    let strip: Vec<[f64; 3]> = points.iter().flat_map(|p| [*p, *p]).collect();
    let fine: Vec<[f64; 3]> = doubled.iter().flat_map(|p| [*p, *p, *p]).collect();
    spline_deviation(strip, [points.len(), 2], &fine)
}

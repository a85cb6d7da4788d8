//! The body of a bevel pinion against its cutter, which is tried in many positions: without an equation of meshing, a solver, or a face.

use std::f64::consts::PI;
use std::sync::Arc;

use flank::{Disk, EvaluatorOptions, JobSelection, MeshFormat, Project, SolidPart, SolidRequest, Unwatched, solid};
use flank_tests::repository;

/// A place `[z, rho]` of the axial section, mm.
type Place = [f64; 2];

/// What `specs/bevel/pinion_19x62.chain` sets, without tilt or motions of higher order.
const RADIAL: f64 = 97.959_402_907_805_07;
const CRADLE: f64 = -52.796_746_782_674_86;
const ROOT_ANGLE: f64 = 15.640_967_270_737_47;
const CENTRE: f64 = -0.001_306_176_586_991_889;
const RATIO: f64 = 3.339_685_914_944_047;
const POINT_RADII: [f64; 2] = [95.951_739_019_389_2, 94.548_260_980_610_8];
const BLADE_ANGLE: f64 = PI / 9.0;
const EDGE_RADIUS: f64 = 0.208_45;
const ROLL: f64 = PI / 9.0;
const TEETH: u32 = 19;

const TOE_ROOT: Place = [92.011_046_394_543_21, 25.760_512_013_838_866];
const HEEL_ROOT: Place = [127.372_075_111_784_28, 35.660_748_694_589_96];
const TOE_TIP: Place = [90.386_979_574_494_42, 30.938_254_603_043_2];
const HEEL_TIP: Place = [125.267_441_074_704_95, 43.177_945_204_562_62];

/// Rolls at which the cutter is tried first, and halvings of what lies between by the golden ratio: the deepest cut is known to the square of that.
const ROLLS: usize = 81;
const GOLDEN_STEPS: usize = 36;
/// Halvings of an angle of a quarter radian.
const HALVINGS: usize = 44;
/// How far from the middle of a space its sides lie at the most, rad: three quarters of a pitch.
const REACH: f64 = 0.75 * 2.0 * PI / TEETH as f64;

/// Where a point of the work lies for the cutter: its distance from the axis, and its height over the plane of the tips.
fn in_cutter([z, rho]: Place, way: f64, roll: f64) -> [f64; 2] {
    let (sin_root, cos_root) = ROOT_ANGLE.to_radians().sin_cos();
    let (sin_way, cos_way) = (way + RATIO * roll).sin_cos();
    let (x, y, z) = (rho * cos_way, rho * sin_way, z + CENTRE);
    let (height, z) = (cos_root * x - sin_root * z, sin_root * x + cos_root * z);
    let (sin_cradle, cos_cradle) = (CRADLE.to_radians() + roll).sin_cos();
    let (y, z) = (cos_cradle * y - sin_cradle * z, sin_cradle * y + cos_cradle * z);
    [(z - RADIAL).hypot(y), height]
}

/// How deep a point lies in the blade of one side (0 outside, 1 inside): below the line of the blade, its rounded edge, or its tip.
fn depth_in_blade(side: usize, [radius, height]: [f64; 2]) -> f64 {
    let (sine, cosine) = BLADE_ANGLE.sin_cos();
    let inset = EDGE_RADIUS * (1.0 - sine) / cosine;
    // from the middle of the rounding
    let out = [1.0, -1.0][side] * (radius - POINT_RADII[side]) + inset;
    let up = height - EDGE_RADIUS;
    let below_line = cosine * (inset + height * sine / cosine - out);
    if out <= 0.0 {
        below_line.min(height)
    } else if -up * cosine >= out * sine {
        EDGE_RADIUS - out.hypot(up)
    } else {
        below_line
    }
}

/// How deep a side of the cutter ever gets below a point, mm: less than nothing where it leaves steel.
fn deepest(side: usize, place: Place, way: f64) -> f64 {
    let depth = |roll: f64| depth_in_blade(side, in_cutter(place, way, roll));
    let step = 2.0 * ROLL / (ROLLS - 1) as f64;
    let rolls = (0..ROLLS).map(|k| k as f64 * step - ROLL);
    let at = rolls.max_by(|a, b| depth(*a).total_cmp(&depth(*b))).expect("rolls");
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (at - step, at + step);
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut depths = inner.map(depth);
    for _ in 0..GOLDEN_STEPS {
        if depths[0] > depths[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            depths = [depth(inner[0]), depths[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            depths = [depths[1], depth(inner[1])];
        }
    }
    depths[0].max(depths[1])
}

/// The angle by which a space is open at a place, about a middle where it is.
fn opening(place: Place, middle: f64) -> f64 {
    let side = |side: usize, towards: f64| {
        let (mut cut, mut steel) = (0.0, REACH);
        for _ in 0..HALVINGS {
            let half = 0.5 * (cut + steel);
            if deepest(side, place, middle + towards * half) > 0.0 { cut = half } else { steel = half }
        }
        0.5 * (cut + steel)
    };
    // of this hand the outside blades cut the side of the larger angle
    side(0, 1.0) + side(1, -1.0)
}

/// The angle at which a place is cut deepest by both sides.
fn middle(place: Place) -> f64 {
    let both = |way: f64| deepest(0, place, way).min(deepest(1, place, way));
    let ways = (0..720).map(|k| PI * f64::from(k) / 360.0 - PI);
    ways.max_by(|a, b| both(*a).total_cmp(&both(*b))).expect("ways")
}

fn between(a: Place, b: Place, share: f64) -> Place {
    [0, 1].map(|k| a[k] + share * (b[k] - a[k]))
}

/// The line from the cone that the plane of the tips rolls on to the tip, at a share of the way from toe to heel.
fn line(along: f64) -> [Place; 2] {
    let tip = between(TOE_TIP, HEEL_TIP, along);
    let below = between(TOE_ROOT, HEEL_ROOT, along);
    let slope = ROOT_ANGLE.to_radians().tan();
    let over = |[z, rho]: Place| rho - slope * (z + CENTRE);
    [between(tip, below, over(tip) / (over(tip) - over(below))), tip]
}

/// Nodes and weights of the rule of Gauss and Legendre from 0 to 1.
fn gauss(count: usize) -> Vec<[f64; 2]> {
    let node = |k: usize| {
        let mut x = (PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut before, mut value) = (1.0, x);
            for n in 2..=count {
                let n = n as f64;
                (before, value) = (value, ((2.0 * n - 1.0) * x * value - (n - 1.0) * before) / n);
            }
            slope = count as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [0.5 - 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(node).collect()
}

/// The volume of a space: its opening over the axial section between root and tip. Beside a rounded edge it grows with the root of the height,
/// so heights go with the square of the share.
fn space(along: usize, across: usize) -> f64 {
    let across = gauss(across);
    let column = |[along, weight]: [f64; 2]| {
        let place = |along: f64, share: f64| {
            let [root, tip] = line(along);
            between(root, tip, share * share)
        };
        let middle = middle(place(along, across[0][0]));
        let cell = |[share, weight]: &[f64; 2]| {
            let at = place(along, *share);
            // exact, for places are linear in both the share along and the square of the one across, but for how the root runs
            let step = 1e-6;
            let by = |from: Place, to: Place| [0, 1].map(|k| (to[k] - from[k]) / (2.0 * step));
            let a = by(place(along - step, *share), place(along + step, *share));
            let b = by(place(along, share - step), place(along, share + step));
            weight * (a[0] * b[1] - a[1] * b[0]).abs() * at[1] * opening(at, middle)
        };
        weight * across.iter().map(cell).sum::<f64>()
    };
    gauss(along).into_iter().map(column).sum()
}

/// The blank by the rule of Guldin.
fn blank() -> f64 {
    let below = |root: Place, tip: Place| [0, 1].map(|k| 2.0 * root[k] - tip[k]);
    let corners = [HEEL_TIP, TOE_TIP, below(TOE_ROOT, TOE_TIP), below(HEEL_ROOT, HEEL_TIP)];
    let frustum = |k: usize| {
        let ([z, rho], [next_z, next_rho]) = (corners[k], corners[(k + 1) % 4]);
        PI / 3.0 * (next_z - z) * (rho * rho + rho * next_rho + next_rho * next_rho)
    };
    (0..4).map(frustum).sum::<f64>().abs()
}

#[test]
fn the_bevel_pinion_has_the_volume_that_its_cutter_leaves() {
    let request = SolidRequest {
        jobs: JobSelection {
            project: Project::open(repository("specs/bevel/pinion_19x62.chain"), Arc::new(Disk)),
            job: None,
            // straight blades
            set: vec![("c.blade_radius".to_string(), "1000000000 mm".to_string())],
        },
        part: SolidPart::Gear,
        out: tempfile::tempdir().expect("a folder").path().to_path_buf(),
        format: vec![MeshFormat::Stl],
        step: None,
        deviation: 0.1,
        density: 7850.0,
        ball: None,
        evaluator: EvaluatorOptions::default(),
    };
    let mut found = Vec::new();
    solid(&request, &Unwatched, &mut |result| found.extend(result.solids)).expect("a right spec");
    let tried = blank() - f64::from(TEETH) * space(8, 48);
    // twice as many nodes in both directions move it by 2e-7 less than that of half as many; half a tenth of that is left
    let off = found[0].volume_mm3 / tried - 1.0;
    assert!(off.abs() < 1e-7, "{off:e}: {} mm³, the cutter leaves {tried}", found[0].volume_mm3);
}

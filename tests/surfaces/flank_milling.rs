//! One pass with the straight side of a cutter: nothing is left on developable surfaces, and what is left on others is the least.

use flank_solver::{
    Chart, Cutter, NormalLine, OutlinePiece, PoseSeries, SidePass, SideStrip, StraightSide, SurfaceFrame, left_on_way,
    side_directions,
};

/// Points and unit normals over a coordinate across the pass and one along it, mm or radians.
type Patch<'p> = &'p dyn Fn(f64, f64) -> [f64; 6];

/// Rows and columns of points at which it is measured.
const MAP: [usize; 2] = [9, 13];

fn evenly(count: usize, [low, high]: [f64; 2]) -> Vec<f64> {
    (0..count).map(|k| low + (high - low) * k as f64 / (count - 1) as f64).collect()
}

/// Derivatives by differences of four points: only the search begins with them.
fn frame(patch: Patch<'_>, v: f64, u: f64) -> SurfaceFrame {
    const STEP: f64 = 1e-3;
    let slope = |at: &dyn Fn(f64) -> [f64; 6]| -> [f64; 6] {
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| at(k * STEP));
        [0, 1, 2, 3, 4, 5].map(|k| (a[k] - 8.0 * b[k] + 8.0 * c[k] - d[k]) / (12.0 * STEP))
    };
    let [by_v, by_u] = [slope(&|h| patch(v + h, u)), slope(&|h| patch(v, u + h))];
    let at = patch(v, u);
    let first = |row: [f64; 6]| [row[0], row[1], row[2]];
    let last = |row: [f64; 6]| [row[3], row[4], row[5]];
    SurfaceFrame {
        position: first(at),
        normal: last(at),
        steps: [first(by_v), first(by_u)],
        turns: [last(by_v), last(by_u)],
    }
}

fn points(patch: Patch<'_>, across: [f64; 2], along: [f64; 2]) -> Vec<NormalLine> {
    let columns = evenly(MAP[1], along);
    evenly(MAP[0], across)
        .into_iter()
        .flat_map(|v| columns.iter().map(move |u| patch(v, *u)).collect::<Vec<_>>())
        .collect()
}

fn root_mean_square(left: &[f64]) -> f64 {
    (left.iter().map(|left| left * left).sum::<f64>() / left.len() as f64).sqrt()
}

/// A side of 40 mm that is as thick as asked in its middle.
fn side(radius: f64, half_angle: f64) -> StraightSide {
    StraightSide { half_angle, heights: [5.0, 45.0], radius: radius - 20.0 * half_angle.tan() }
}

/// The best pass over a patch; the way goes beyond both ends by `beyond`.
fn best(
    patch: Patch<'_>,
    [across, along]: [[f64; 2]; 2],
    side: StraightSide,
    (free, beyond): (usize, f64),
) -> SidePass {
    let middle = 0.5 * (across[0] + across[1]);
    let way = [along[0] - beyond, along[1] + beyond];
    let place = |share: f64| way[0] + share * (way[1] - way[0]);
    let at = frame(patch, middle, 0.5 * (along[0] + along[1]));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let spindle_left = dot(cross(at.normal, at.steps[1]), at.steps[0]) > 0.0;
    let strip = SideStrip {
        middle: PoseSeries::sampled(41, |share| patch(middle, place(share))),
        spindle_left,
        side,
        heights: vec![25.0],
        stock: 0.0,
    };
    let radius = side.radius_at(25.0) / side.half_angle.cos();
    let shares = if free == 1 { vec![0.5] } else { Chart::shares(free) };
    let turns: Vec<f64> = shares
        .into_iter()
        .map(|share| side_directions(&frame(patch, middle, place(share)), spindle_left, radius)[0])
        .collect();
    strip.nearest_pass(&turns, &points(patch, across, along)).expect("the cutter passes over all points")
}

/// A cylinder about z whose lines lie across the pass and slant by `slant`; `sense` −1: a hollow.
fn cylinder(rho: f64, sense: f64, slant: f64) -> impl Fn(f64, f64) -> [f64; 6] {
    move |v, u| {
        let (s, c) = (u + v * slant).sin_cos();
        [rho * c, rho * s, v, sense * c, sense * s, 0.0]
    }
}

#[test]
fn nothing_is_left_on_planes_cylinders_and_cones() {
    let plane = |v: f64, u: f64| [u, v, 0.0, 0.0, 0.0, 1.0];
    let (sine, cosine) = 0.3f64.sin_cos();
    let cone = |sense: f64| {
        move |v: f64, u: f64| {
            let ((s, c), rho) = (u.sin_cos(), 30.0 + v * sine);
            [rho * c, rho * s, v * cosine, sense * cosine * c, sense * cosine * s, -sense * sine]
        }
    };
    let (outside, inside) = (cylinder(20.0, 1.0, 0.01), cylinder(20.0, -1.0, -0.02));
    let (peak, hollow) = (cone(1.0), cone(-1.0));
    let patches: [(Patch<'_>, [f64; 2], f64); 5] = [
        (&plane, [0.0, 20.0], 0.5),
        (&outside, [0.0, 0.8], 0.12),
        (&inside, [0.0, 0.8], 0.22),
        (&peak, [0.0, 0.8], 0.02),
        (&hollow, [0.0, 0.8], 0.02),
    ];
    for (number, (patch, along, beyond)) in patches.into_iter().enumerate() {
        for half_angle in [0.0, 0.1, -0.05] {
            for free in [1, 4] {
                let pass = best(patch, [[-8.0, 8.0], along], side(6.0, half_angle), (free, beyond));
                let most = pass.left.iter().fold(0.0, |most: f64, left| most.max(left.abs()));
                // rounding of positions of some 30 mm, and of a search that ends with steps of 1e-11 mm
                assert!(most < 1e-11 && pass.is_settled, "{number} {half_angle} {free}: {most:e}");
            }
        }
    }
}

/// An involute helicoid is developable: the cutter lies along the tangents of its base helix, which are square to the transverse profile.
#[test]
fn nothing_is_left_on_an_involute_helicoid() {
    // base radius, lead over a radian, and from which roll angle to which
    let (base, lead, rolls) = (40.0, 110.0, [0.35, 0.55]);
    // the normal of the transverse involute touches the base circle at the roll angle
    let patch = |z: f64, roll: f64| {
        let (s, c) = (z / lead + roll).sin_cos();
        let rise = base / lead;
        let size = (1.0f64 + rise * rise).sqrt();
        let [x, y] = [base * (c + roll * s), base * (s - roll * c)];
        [x, y, z, s / size, -c / size, rise / size]
    };
    let strip = [[-8.0, 8.0], rolls];
    for half_angle in [0.0, 0.07] {
        for free in [1, 5] {
            let pass = best(&patch, strip, side(3.0, half_angle), (free, 0.12));
            let most = pass.left.iter().fold(0.0, |most: f64, left| most.max(left.abs()));
            assert!(most < 1e-11 && pass.is_settled, "{half_angle} {free}: {most:e}");
        }
    }
    // a profile that is none by up to some 0.01 um is seen
    let wrong = |z: f64, roll: f64| {
        let row = patch(z, roll);
        [row[0], row[1] + 1e-5 * (z / 8.0).powi(2), row[2], row[3], row[4], row[5]]
    };
    let pass = best(&wrong, strip, side(3.0, 0.0), (1, 0.12));
    assert!(root_mean_square(&pass.left) > 1e-7, "{:e}", root_mean_square(&pass.left));
}

/// A hyperboloid of one sheet about z: waist and slope.
fn hyperboloid(waist: f64, slope: f64) -> impl Fn(f64, f64) -> [f64; 6] {
    move |z: f64, u: f64| {
        let rho = waist.hypot(slope * z);
        let ((s, c), steep) = (u.sin_cos(), slope * slope * z / rho);
        let size = (1.0 + steep * steep).sqrt();
        [rho * c, rho * s, z, c / size, s / size, -steep / size]
    }
}

/// What a cylinder leaves over a point of a meridian whose axis turns about z on another hyperboloid: the envelope lies in the distance of
/// the radius from that, which is found in the meridian's plane.
fn left_beside(hyperboloid: [f64; 2], radius: f64, line: &NormalLine) -> f64 {
    let [waist, slope] = hyperboloid;
    let distance = |h: f64| {
        let [rho, z] = [line[0] + h * line[3], line[2] + h * line[5]];
        // the foot on the hyperbola, by Newton's method
        let mut at = z;
        for _ in 0..60 {
            let r = waist.hypot(slope * at);
            let (steep, bend) =
                (slope * slope * at / r, slope * slope / r - (slope * slope * at).powi(2) / (r * r * r));
            let value = (r - rho) * steep + at - z;
            at -= value / (steep * steep + (r - rho) * bend + 1.0);
        }
        (waist.hypot(slope * at) - rho).hypot(at - z)
    };
    // the distance falls by as much as the point rises towards it, but for the square of a small angle
    let mut h = 0.0;
    for _ in 0..200 {
        h += distance(h) - radius;
    }
    h
}

/// With an axis that stands on a hyperboloid of its own all the way, the best waist and slope of that are two numbers.
#[test]
fn a_hyperboloid_is_left_as_an_independent_search_leaves_it() {
    let (waist, slope, radius, width) = (30.0, 0.35, 8.0, 12.0);
    let patch = hyperboloid(waist, slope);
    let strip = [[-width, width], [0.0, 0.7]];
    let pass = best(&patch, strip, side(radius, 0.0), (1, 0.3));
    assert!(pass.is_settled);
    let meridian: Vec<NormalLine> = evenly(MAP[0], strip[0]).into_iter().map(|z| patch(z, 0.0)).collect();
    let left = |own: [f64; 2]| -> Vec<f64> { meridian.iter().map(|line| left_beside(own, radius, line)).collect() };
    // Gauss and Newton, by differences, from the parallel surface's own waist and slope
    let mut own = [waist + radius, slope * ((waist + radius) / waist).sqrt()];
    for _ in 0..20 {
        let steps = [1e-4, 1e-6];
        let here = left(own);
        let slopes = [0, 1].map(|k| {
            let at = |sign: f64| left([0, 1].map(|i| own[i] + if i == k { sign * steps[k] } else { 0.0 }));
            let (up, down) = (at(1.0), at(-1.0));
            up.iter().zip(down).map(|(a, b)| (a - b) / (2.0 * steps[k])).collect::<Vec<f64>>()
        });
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let [a, b, c] = [dot(&slopes[0], &slopes[0]), dot(&slopes[0], &slopes[1]), dot(&slopes[1], &slopes[1])];
        let [f, g] = [dot(&slopes[0], &here), dot(&slopes[1], &here)];
        own[0] -= (c * f - b * g) / (a * c - b * b);
        own[1] -= (a * g - b * f) / (a * c - b * b);
    }
    let independent = root_mean_square(&left(own));
    let found = root_mean_square(&pass.left);
    assert!(independent > 1e-6, "something is left: {independent:e}");
    // both are known to 1e-11 mm
    assert!((found - independent).abs() < 1e-10, "{found:e} {independent:e}");
    let columns = MAP[1];
    for (row, own) in left(own).into_iter().enumerate() {
        for column in 0..columns {
            let left = pass.left[row * columns + column];
            assert!((left - own).abs() < 1e-8, "{row} {column}: {left:e} {own:e}");
        }
    }
    // where the axis is free at more places it leaves no more
    let freer = best(&patch, strip, side(radius, 0.0), (4, 0.3));
    assert!(root_mean_square(&freer.left) <= found * (1.0 + 1e-9), "{:e}", root_mean_square(&freer.left));
}

/// The lowest point of a cone on a line, in very many poses of the way.
fn scanned(way: &PoseSeries, side: &StraightSide, line: &NormalLine) -> f64 {
    const POSES: usize = 20_000;
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let normal = [line[3], line[4], line[5]];
    let slope = side.half_angle.tan();
    let heights = (0..=POSES).filter_map(|k| {
        let pose = way.at(k as f64 / POSES as f64);
        let (from, axis) = ([0, 1, 2].map(|k| line[k] - pose[k]), [pose[3], pose[4], pose[5]]);
        // |y|² − z² = (r + (z − z₀) tan)² on the cone, y and z being linear in the height
        let [z, dz] = [dot(from, axis), dot(normal, axis)];
        let [r, dr] = [side.radius + (z - side.heights[0]) * slope, dz * slope];
        let a = 1.0 - dz * dz - dr * dr;
        let b = dot(from, normal) - z * dz - r * dr;
        let c = dot(from, from) - z * z - r * r;
        let root = b * b - a * c;
        if root < 0.0 {
            return None;
        }
        let height = (-b - root.sqrt()) / a;
        let above = z + height * dz;
        (side.heights[0]..=side.heights[1]).contains(&above).then_some(height)
    });
    heights.fold(f64::INFINITY, f64::min)
}

/// A patch that is no ruled surface: what is left is what brute force finds, and no small change of the motion leaves less.
#[test]
fn what_is_left_on_a_bent_patch_is_what_brute_force_finds() {
    let patch = |v: f64, u: f64| {
        let z = v * v / 200.0 - u * u / 90.0 + u * v / 300.0 + u * u * v / 5e4;
        let [zu, zv] = [-u / 45.0 + v / 300.0 + u * v / 2.5e4, v / 100.0 + u / 300.0 + u * u / 5e4];
        let size = (1.0 + zu * zu + zv * zv).sqrt();
        [u, v, z, -zu / size, -zv / size, 1.0 / size]
    };
    let strip = [[-3.0, 3.0], [-10.0, 10.0]];
    let cone = side(4.0, 0.08);
    let pass = best(&patch, strip, cone, (6, 8.0));
    assert!(pass.is_settled);
    let lines = points(&patch, strip[0], strip[1]);
    let cutter = Cutter { pieces: vec![cone.piece()] };
    let found = left_on_way(&pass.way, &cutter, &lines);
    for (k, line) in lines.iter().enumerate() {
        let exact = found[k].expect("the side reaches it").height;
        let scanned = scanned(&pass.way, &cone, line);
        // the scan stands beside the lowest pose by half a step of some 2 um at the most
        assert!((exact - pass.left[k]).abs() < 1e-11, "{exact:e} {:e}", pass.left[k]);
        assert!(scanned > exact - 1e-11 && scanned < exact + 1e-7, "{k}: {exact:e} {scanned:e}");
    }
    // freer motions leave less
    let of = |free: usize| root_mean_square(&best(&patch, strip, cone, (free, 8.0)).left);
    let [one, three, six] = [of(1), of(3), root_mean_square(&pass.left)];
    assert!(one > three && three > six, "{one:e} {three:e} {six:e}");
}

#[test]
fn sides_that_open_and_close_are_read_from_outlines() {
    let line = |from, to| Cutter { pieces: vec![OutlinePiece::Line { from, to }] };
    let opens = line([2.0, 1.0], [4.0, 11.0]).side().expect("it faces away from the axis");
    assert!((opens.half_angle - 0.2f64.atan()).abs() < 1e-15 && opens.heights == [1.0, 11.0]);
    assert!((opens.length() - 2.0f64.hypot(10.0)).abs() < 1e-14);
    // a bottom, a face below a holder and the inside of a cup are none
    for (from, to) in [([0.0, 0.0], [3.0, 0.0]), ([3.0, 9.0], [20.0, 9.0]), ([4.0, 11.0], [2.0, 1.0])] {
        assert!(line(from, to).side().is_none());
    }
}

//! One pass with the straight side of a cutter: nothing is left on developable surfaces, and what is left on others is the least.

use flank_solver::{
    Chart, Cutter, NormalLine, OutlinePiece, PoseSeries, SideMotion, SidePass, SideStrip, StraightSide, SurfaceFrame,
    left_on_way, side_directions,
};

/// Points and unit normals over a coordinate across the pass and one along it, mm or radians.
type Patch<'p> = &'p dyn Fn(f64, f64) -> [f64; 6];

/// What the largest remainder tells apart, as a share of it: the pull towards the start costs so much of it per 0.1 rad.
const ALIKE: f64 = 1e-4;
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

/// A strip with points of it, and the turns with which a search begins.
struct Case {
    strip: SideStrip,
    turns: Vec<f64>,
    lines: Vec<NormalLine>,
}

impl Case {
    fn begun(&self, turns: &[f64]) -> SideMotion {
        self.strip.begun(turns, &self.lines).expect("the cutter passes over all points")
    }

    fn best(&self) -> SidePass {
        let begun = self.begun(&self.turns);
        self.strip.nearest_pass(&begun, &self.lines).expect("it does so where the search begins")
    }
}

/// The best pass over a patch; the way goes beyond both ends by `beyond`.
fn best(patch: Patch<'_>, part: [[f64; 2]; 2], side: StraightSide, free: (usize, f64)) -> SidePass {
    case(patch, part, side, free).best()
}

fn case(patch: Patch<'_>, [across, along]: [[f64; 2]; 2], side: StraightSide, (free, beyond): (usize, f64)) -> Case {
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
    Case { strip, turns, lines: points(patch, across, along) }
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
                let most = pass.motion.left.iter().fold(0.0, |most: f64, left| most.max(left.abs()));
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
            let most = pass.motion.left.iter().fold(0.0, |most: f64, left| most.max(left.abs()));
            assert!(most < 1e-11 && pass.is_settled, "{half_angle} {free}: {most:e}");
        }
    }
    // a profile that is none by up to some 0.01 um is seen
    let wrong = |z: f64, roll: f64| {
        let row = patch(z, roll);
        [row[0], row[1] + 1e-5 * (z / 8.0).powi(2), row[2], row[3], row[4], row[5]]
    };
    let pass = best(&wrong, strip, side(3.0, 0.0), (1, 0.12));
    assert!(root_mean_square(&pass.motion.left) > 1e-7, "{:e}", root_mean_square(&pass.motion.left));
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
        let step = distance(h) - radius;
        h += step;
        if step.abs() < 1e-15 {
            break;
        }
    }
    h
}

/// Where a function of one number that falls and then rises is least, between two numbers: by the golden section.
fn least(between: [f64; 2], at: &dyn Fn(f64) -> f64) -> [f64; 2] {
    let golden = 0.5 * (5.0f64.sqrt() - 1.0);
    let [mut low, mut high] = between;
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut values = inner.map(at);
    for _ in 0..55 {
        if values[0] < values[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            values = [at(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            values = [values[1], at(inner[1])];
        }
    }
    if values[0] < values[1] { [inner[0], values[0]] } else { [inner[1], values[1]] }
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
    // one number within the other, around the parallel surface's own waist and slope
    let parallel = [waist + radius, slope * ((waist + radius) / waist).sqrt()];
    let largest = |own: [f64; 2]| left(own).into_iter().fold(0.0, |most: f64, left| most.max(left.abs()));
    let waist_at = |slope: f64| least([parallel[0] - 0.1, parallel[0] + 0.1], &|waist| largest([waist, slope]));
    let [own_slope, independent] = least([parallel[1] - 0.02, parallel[1] + 0.02], &|slope| waist_at(slope)[1]);
    let own = [waist_at(own_slope)[0], own_slope];
    let found = pass.motion.largest();
    assert!(independent > 1e-6, "something is left: {independent:e}");
    // the search ends where no step promises more than 1e-8 mm
    assert!((found - independent).abs() < 1e-8, "{found:e} {independent:e}");
    let columns = MAP[1];
    for (row, own) in left(own).into_iter().enumerate() {
        for column in 0..columns {
            let left = pass.motion.left[row * columns + column];
            assert!((left - own).abs() < 1e-8, "{row} {column}: {left:e} {own:e}");
        }
    }
    // where the axis is free at more places it leaves no more
    let freer = best(&patch, strip, side(radius, 0.0), (4, 0.3));
    assert!(freer.motion.largest() <= found * (1.0 + ALIKE), "{:e}", freer.motion.largest());
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
        assert!((exact - pass.motion.left[k]).abs() < 1e-11, "{exact:e} {:e}", pass.motion.left[k]);
        assert!(scanned > exact - 1e-11 && scanned < exact + 1e-7, "{k}: {exact:e} {scanned:e}");
    }
    // freer motions leave less
    let of = |free: usize| best(&patch, strip, cone, (free, 8.0)).motion.largest();
    let [one, three, six] = [of(1), of(3), pass.motion.largest()];
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

/// Numbers between −1 and 1 that follow from the one before (Knuth's multiplier).
struct Scattered(u64);

impl Scattered {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// The largest amount that a motion leaves; endless where it does not pass.
fn largest(case: &Case, free: &[f64]) -> f64 {
    let cutter = Cutter { pieces: vec![case.strip.side.piece()] };
    let found = left_on_way(&case.strip.way(free), &cutter, &case.lines);
    found.iter().fold(0.0, |most: f64, of| most.max(of.map_or(f64::INFINITY, |of| of.height.abs())))
}

/// Twisted flanks: a thread whose sections along the axis are straight, whose normals turn along these, a saddle, and a bevel tooth's bow.
#[test]
fn no_change_of_the_axis_lowers_the_largest_remainder_on_twisted_flanks() {
    let thread = |v: f64, u: f64| {
        let (rho, pitch, slope) = (30.0 + v, 25.0, 0.3);
        let ((s, c), size) = (u.sin_cos(), (rho * rho * (1.0 + slope * slope) + pitch * pitch).sqrt());
        let normal = [pitch * s - slope * rho * c, -pitch * c - slope * rho * s, rho];
        [rho * c, rho * s, pitch * u + slope * v, normal[0] / size, normal[1] / size, normal[2] / size]
    };
    let saddle = |v: f64, u: f64| {
        let (zu, zv) = (v / 60.0, u / 60.0);
        let size = (1.0 + zu * zu + zv * zv).sqrt();
        [u, v, u * v / 60.0, -zu / size, -zv / size, 1.0 / size]
    };
    let bow = |v: f64, u: f64| {
        let (zu, zv) = (u / 140.0 + v / 90.0, u / 90.0 - v / 160.0);
        let size = (1.0 + zu * zu + zv * zv).sqrt();
        [u, v, u * u / 280.0 + u * v / 90.0 - v * v / 320.0, -zu / size, -zv / size, 1.0 / size]
    };
    let patches: [(Patch<'_>, [[f64; 2]; 2], f64); 3] = [
        (&thread, [[-4.0, 4.0], [-0.2, 0.2]], 0.1),
        (&saddle, [[-4.0, 4.0], [-10.0, 10.0]], 2.0),
        (&bow, [[-4.0, 4.0], [-12.0, 12.0]], 3.0),
    ];
    let mut scattered = Scattered(1);
    for (number, (patch, part, beyond)) in patches.into_iter().enumerate() {
        for (radius, half_angle) in [(2.0, 0.0), (8.0, 0.0), (5.0, 0.1)] {
            for free in [1, 4, 8] {
                let case = case(patch, part, side(radius, half_angle), (free, beyond));
                let pass = case.best();
                let least = pass.motion.largest();
                let which = format!("{number} {radius} {half_angle} {free}: {least:e} {:e}", pass.gap);
                assert!(pass.is_settled && pass.gap <= f64::max(1e-7, 1e-5 * least), "{which}");
                assert!((largest(&case, &pass.motion.free) - least).abs() < 1e-11, "{which}");
                // angles of 10 mrad down to 1 µrad, heights ten times as many mm
                for size in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
                    for _ in 0..8 {
                        let mut changed = pass.motion.free.clone();
                        for (k, value) in changed.iter_mut().enumerate() {
                            *value += size * scattered.next() * if k < 2 * free { 1.0 } else { 10.0 };
                        }
                        let other = largest(&case, &changed);
                        assert!(other > least * (1.0 - ALIKE), "{which}: {other:e}");
                    }
                }
                // from elsewhere the search comes to the same
                let turns: Vec<f64> = case.turns.iter().map(|turn| turn + 0.03 * scattered.next()).collect();
                let again = case.strip.nearest_pass(&case.begun(&turns), &case.lines).expect("it passes there, too");
                let other = again.motion.largest();
                assert!((other - least).abs() < 1e-8 + 10.0 * ALIKE * least, "{which}: {other:e} from elsewhere");
            }
        }
    }
}

//! Bodies in mesh: turned through a pitch at their mounting distance, teeth and spaces touch and have no volume in common. A body whose flanks
//! are inside out, or of the other hand, does not pass.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;
use std::sync::Arc;

use flank::{
    ContactRequest, Disk, EvaluatorOptions, JobSelection, MeshFormat, PointFormat, Project, SolidPart, SolidRequest,
    Unwatched, contact, solid,
};
use flank_expr::{Graph, ScalarEvaluator, Tape};
use flank_tests::bodies::triangles;
use flank_tests::{job, repository};
use nalgebra::{Matrix4, Point3, Rotation3, Vector3};

/// How far edges of the meshes lie off the exact surfaces, mm.
const DEVIATION: f64 = 5e-4;
/// What may be between the bodies at their contact, and what they may have in common, mm: that of both meshes.
const GAP: f64 = 1e-3;
/// Points farther apart are not looked at, mm.
const NEAR: f64 = 0.04;
/// Distances no farther apart are the same, mm: rounding.
const SAME: f64 = 1e-9;
/// Of the cells in which triangles are looked up, mm.
const CELL: f64 = 0.3;
/// A triangle that spans more cells is no flank.
const MOST_CELLS: i64 = 40;

type Triangle = [Point3<f64>; 3];

/// The triangles of a space or a tooth, found by place.
struct Body {
    triangles: Vec<Triangle>,
    /// The least and the largest coordinates.
    bounds: [Point3<f64>; 2],
    cells: HashMap<[i64; 3], Vec<usize>>,
}

impl Body {
    fn new(triangles: Vec<Triangle>) -> Body {
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (k, triangle) in triangles.iter().enumerate() {
            around(triangle, NEAR).into_iter().for_each(|cell| cells.entry(cell).or_default().push(k));
        }
        let corners = || triangles.iter().flatten().copied();
        let bounds = [corners().reduce(|a, b| a.inf(&b)), corners().reduce(|a, b| a.sup(&b))];
        let bounds = bounds.map(|corner| corner.expect("triangles"));
        Body { triangles, bounds, cells }
    }

    /// The least distance of points on a triangle, so far apart; infinite where none is near.
    fn least(&self, triangle: &Triangle, spacing: f64) -> f64 {
        let [low, high] = &self.bounds;
        let is_beside = |k: usize| {
            triangle.iter().all(|corner| corner[k] < low[k]) || triangle.iter().all(|corner| corner[k] > high[k])
        };
        if (0..3).any(is_beside) || !around(triangle, 0.0).iter().any(|cell| self.cells.contains_key(cell)) {
            return f64::INFINITY;
        }
        // lines beside the longest side, each shorter than the one before
        let side = |k: &usize| (triangle[(k + 1) % 3] - triangle[*k]).norm();
        let first = (0..3).max_by(|a, b| side(a).total_cmp(&side(b))).expect("three sides");
        let [a, b, c] = [0, 1, 2].map(|k| triangle[(first + k) % 3]);
        let longest = (b - a).norm();
        let height = (b - a).cross(&(c - a)).norm() / longest;
        let [along, across] = [longest, height].map(|length| (length / spacing).ceil().max(1.0));
        let shares = |count: f64| (0..=count as usize).map(move |k| k as f64 / count);
        let bases = shares(along).map(|share| a + (b - a) * share);
        let points = bases.flat_map(|base| shares(across).map(move |share| base + (c - base) * share));
        points.filter_map(|point| self.distance(point)).fold(f64::INFINITY, f64::min)
    }

    /// How far a point lies outside, less than nothing inside; `None` where nothing is near.
    fn distance(&self, point: Point3<f64>) -> Option<f64> {
        let near = self.cells.get(&[0, 1, 2].map(|k| cell(point[k])))?;
        let beside: Vec<(f64, f64)> = near.iter().map(|k| beside(&self.triangles[*k], point)).collect();
        let off = beside.iter().map(|(off, _)| *off).fold(f64::INFINITY, f64::min);
        // an edge is as near as both its faces: that which the point is higher over, or deeper under, tells its side
        let nearest = beside.iter().filter(|(own, _)| *own <= off + SAME);
        let (_, height) = nearest.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        (off < NEAR).then_some(off.copysign(*height))
    }
}

/// The cells that a triangle may touch; none where these are too many.
fn around(triangle: &Triangle, by: f64) -> Vec<[i64; 3]> {
    let bound = |k: usize, of: fn(f64, f64) -> f64, by: f64| {
        cell(triangle.iter().map(|corner| corner[k]).reduce(of).expect("three") + by)
    };
    let [low, high] = [[0, 1, 2].map(|k| bound(k, f64::min, -by)), [0, 1, 2].map(|k| bound(k, f64::max, by))];
    if (0..3).any(|k| high[k] - low[k] > MOST_CELLS) {
        return Vec::new();
    }
    let plane = (low[0]..=high[0]).flat_map(|i| (low[1]..=high[1]).map(move |j| [i, j]));
    plane.flat_map(|[i, j]| (low[2]..=high[2]).map(move |l| [i, j, l])).collect()
}

fn cell(x: f64) -> i64 {
    (x / CELL).floor() as i64
}

/// The distance of a point from a triangle, and its height over the triangle's plane (C. Ericson, Real-Time Collision Detection, 5.1.5, by Voronoi regions).
fn beside([a, b, c]: &Triangle, p: Point3<f64>) -> (f64, f64) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let on_edge = |from: &Point3<f64>, to: &Point3<f64>| {
        let along = to - from;
        let share = ((p - from).dot(&along) / along.dot(&along)).clamp(0.0, 1.0);
        (p - (from + share * along)).norm()
    };
    let normal = ab.cross(&ac);
    let height = normal.dot(&ap) / normal.norm();
    let is_over =
        [(a, b), (b, c), (c, a)].iter().all(|(from, to)| normal.cross(&(*to - *from)).dot(&(p - *from)) >= 0.0);
    if is_over {
        return (height.abs(), height);
    }
    (on_edge(a, b).min(on_edge(b, c)).min(on_edge(c, a)), height)
}

fn read(path: &Path) -> Vec<Triangle> {
    let corner = |corner: [f32; 3]| Point3::from(corner.map(f64::from));
    triangles(path).into_iter().map(|triangle| triangle.map(corner)).collect()
}

fn selection(spec: &str) -> JobSelection {
    JobSelection { project: Project::open(repository(spec), Arc::new(Disk)), job: None, set: Vec::new() }
}

/// One part of all solids of a spec as triangles whose edges lie so far off at the most, mm, by the names of the solids.
fn parts(spec: &str, part: SolidPart, deviation: f64) -> HashMap<String, Vec<Triangle>> {
    let folder = tempfile::tempdir().expect("a folder");
    let request = SolidRequest {
        jobs: selection(spec),
        part,
        out: folder.path().to_path_buf(),
        format: vec![MeshFormat::Stl],
        step: None,
        deviation,
        density: 7850.0,
        ball: None,
        evaluator: EvaluatorOptions::default(),
    };
    let mut found = HashMap::new();
    solid(&request, &Unwatched, &mut |result| {
        let is_alone = result.solids.len() == 1;
        for body in &result.solids {
            let file = if is_alone { result.job.clone() } else { format!("{}.{}", result.job, body.name) };
            found.insert(body.name.clone(), read(&folder.path().join(format!("{file}.stl"))));
        }
    })
    .expect("a right spec");
    found
}

/// Roll and lag, rad, at which the pair of a spec's first contact stands over a pitch about its middle, of all pairs of teeth together.
fn rolled(spec: &str, teeth: u32, count: usize) -> Vec<[f64; 2]> {
    let folder = tempfile::tempdir().expect("a folder");
    let request = ContactRequest {
        out: folder.path().to_path_buf(),
        format: vec![PointFormat::Csv],
        no_picture: true,
        ..ContactRequest::new(selection(spec))
    };
    let mut middle = None;
    contact(&request, &Unwatched, &mut |result| {
        middle = middle.take().or(result.middle.map(|middle| (result.files[0].clone(), middle.turn)));
    })
    .expect("a right spec");
    let (file, turn) = middle.expect("they touch");
    let mut table = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(file).expect("written");
    let head = table.headers().expect("a head").clone();
    let at = |name: &str| head.iter().position(|column| column == name).expect("a column");
    let columns = ["turn", "composite", "lag", "error"].map(at);
    // errors are told from the least lag on
    let of_row = |row: csv::StringRecord| {
        let [turn, composite, lag, error] = columns.map(|column| row[column].parse::<f64>().ok());
        Some([turn?, lag?.to_radians() + 1e-6 * (composite? - error?)])
    };
    let rows: Vec<[f64; 2]> = table
        .records()
        .map(|row| row.expect("a row"))
        .filter(|row| row[at("surface")].ends_with(".path"))
        .filter_map(of_row)
        .collect();
    let pitch = 360.0 / f64::from(teeth);
    let nearest = |wanted: f64| {
        let off = |row: &[f64; 2]| (row[0] - wanted).abs();
        *rows.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("rows")
    };
    let wanted = (0..count).map(|k| turn + pitch * (k as f64 / (count - 1) as f64 - 0.5));
    wanted.map(nearest).map(|[turn, lag]| [turn.to_radians(), lag]).collect()
}

/// Where both members of the first contact of a spec stand.
fn places(spec: &str, [roll, lag]: [f64; 2]) -> [Matrix4<f64>; 2] {
    let graph = Graph::new();
    let job = job(&graph, spec, &[]);
    let contact = &job.contacts[0];
    let errors = contact.errors.iter().map(|axis| (axis.variable, graph.constant(0.0)));
    let given: Vec<_> = errors.chain(job.bindings()).collect();
    contact.placements.each_ref().map(|placement| {
        let entries = placement.substituted(&given).pose().matrix4().concat();
        let tape = Tape::new(&entries, &[contact.roll.variable, contact.lag.variable]).expect("all bound");
        let mut out = [0.0; 16];
        ScalarEvaluator::new(&tape).run(&[roll, lag], &mut out);
        Matrix4::from_row_slice(&out)
    })
}

struct Pair {
    spec: &'static str,
    solids: [&'static str; 2],
    teeth: [u32; 2],
    /// How far points on teeth lie apart, mm: so near that flanks part by less than half a micrometre half that way on.
    spacing: f64,
}

impl Pair {
    fn space_and_tooth(&self) -> [Vec<Triangle>; 2] {
        let mut spaces = parts(self.spec, SolidPart::Space, DEVIATION);
        let mut teeth = parts(self.spec, SolidPart::Tooth, DEVIATION);
        [spaces.remove(self.solids[0]).expect("built"), teeth.remove(self.solids[1]).expect("built")]
    }

    /// The least distance between spaces of the first member and teeth of the second one, of three pairs beside each other, at each position.
    fn gaps(&self, space: &Body, tooth: &[Triangle], count: usize) -> Vec<f64> {
        let turned = |member: usize, k: f64| {
            let angle = k * TAU / f64::from(self.teeth[member]);
            Rotation3::from_axis_angle(&Vector3::z_axis(), angle).to_homogeneous()
        };
        let at = |rolled: [f64; 2]| {
            let [first, second] = places(self.spec, rolled);
            let pairs = [-1.0, 0.0, 1.0].into_iter().flat_map(|i| [-1.0, 0.0, 1.0].map(|j| [i, j]));
            let gap = |[i, j]: [f64; 2]| {
                let placed = (first * turned(0, i)).try_inverse().expect("a pose") * second * turned(1, j);
                let moved = tooth.iter().map(|triangle| triangle.map(|corner| placed.transform_point(&corner)));
                moved.map(|triangle| space.least(&triangle, self.spacing)).fold(f64::INFINITY, f64::min)
            };
            pairs.map(gap).fold(f64::INFINITY, f64::min)
        };
        rolled(self.spec, self.teeth[0], count).into_iter().map(at).collect()
    }

    fn check(&self, count: usize) {
        let [space, tooth] = self.space_and_tooth();
        let gaps = self.gaps(&Body::new(space), &tooth, count);
        assert!(gaps.iter().all(|gap| gap.abs() < GAP), "{}: {gaps:?}", self.spec);
    }
}

#[test]
fn spur_gears() {
    Pair { spec: "specs/pairs/spur_pair.chain", solids: ["pinion", "gear"], teeth: [24, 37], spacing: 0.12 }.check(5);
}

#[test]
fn a_pinion_in_a_ring() {
    Pair { spec: "specs/bodies/internal_pair_body.chain", solids: ["pinion", "ring"], teeth: [21, 62], spacing: 0.2 }
        .check(3);
}

#[test]
fn helical_gears() {
    Pair { spec: "specs/bodies/helical_pair_body.chain", solids: ["pinion", "gear"], teeth: [27, 47], spacing: 0.12 }
        .check(3);
}

#[test]
fn a_pinion_in_a_face_gear() {
    Pair {
        spec: "specs/bodies/face_gear_pair_body.chain",
        solids: ["pinion", "gear"],
        teeth: [23, 108],
        spacing: 0.12,
    }
    .check(3);
}

/// The same with the pinion's space turned inside out by a mirror: what a kernel calls valid.
#[test]
fn spiral_bevel_gears_and_their_mirror_image() {
    let pair =
        Pair { spec: "specs/bevel/pair_from_blank.chain", solids: ["pinion", "gear"], teeth: [19, 62], spacing: 0.24 };
    let [space, tooth] = pair.space_and_tooth();
    let mirrored: Vec<Triangle> =
        space.iter().map(|[a, b, c]| [a, c, b].map(|corner| Point3::new(corner.x, -corner.y, corner.z))).collect();
    let gaps = pair.gaps(&Body::new(space), &tooth, 3);
    assert!(gaps.iter().all(|gap| gap.abs() < GAP), "{gaps:?}");
    let gaps = pair.gaps(&Body::new(mirrored), &tooth, 3);
    assert!(gaps.iter().any(|gap| *gap < -10.0 * GAP), "{gaps:?}");
}

#[test]
fn hypoid_gears() {
    Pair { spec: "specs/bodies/hypoid_pair_body.chain", solids: ["pinion", "gear"], teeth: [13, 41], spacing: 0.12 }
        .check(3);
}

/// Without backlash or error: at any turn of the pinion the rack has moved by as much on the pitch line.
#[test]
fn a_pinion_in_a_rack() {
    let spec = "specs/bodies/rack_and_pinion_body.chain";
    let (pinion_pitch, rack_pitch) = (TAU / 24.0, 3.0 * std::f64::consts::PI);
    let space = Body::new(parts(spec, SolidPart::Space, DEVIATION).remove("pinion").expect("built"));
    let tooth = parts("specs/bodies/rack_body.chain", SolidPart::Tooth, DEVIATION).remove("rack").expect("built");
    let z_turn = |angle: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), angle).to_homogeneous();
    let shift = |by: f64| Matrix4::new_translation(&Vector3::new(0.0, by, 0.0));
    // the bar's teeth point along +x, those of the pair's rack to the pinion, one of them on the x axis
    let onto = shift(0.5 * rack_pitch) * z_turn(0.5 * TAU);
    for roll in [-4.0_f64, 0.0, 3.5] {
        let [pinion, rack] = places(spec, [roll.to_radians(), 0.0]);
        let beside = (-1..=1).flat_map(|i| (-1..=1).map(move |j| [i, j].map(f64::from)));
        let gap = |[i, j]: [f64; 2]| {
            let placed = (pinion * z_turn(i * pinion_pitch)).try_inverse().expect("a pose")
                * rack
                * shift(j * rack_pitch)
                * onto;
            let moved = tooth.iter().map(|triangle| triangle.map(|corner| placed.transform_point(&corner)));
            moved.map(|triangle| space.least(&triangle, 0.12)).fold(f64::INFINITY, f64::min)
        };
        let gap = beside.map(gap).fold(f64::INFINITY, f64::min);
        assert!(gap.abs() < GAP, "{roll} deg: {gap} mm");
    }
}

/// The thread of a ZA worm in closed form: straight in the axial section, which a turn moves along by the lead.
#[derive(Clone, Copy)]
struct Thread {
    /// +1 right-hand, -1 left-hand.
    hand: f64,
    /// Where the middle of the space lies in the plane of x and z, mm.
    middle: f64,
}

impl Thread {
    const LEAD: f64 = 4.0 * std::f64::consts::PI;
    const RADIUS: f64 = 25.0;
    const TIP: f64 = 28.2;
    const ROOT: f64 = 21.0;

    fn slope() -> f64 {
        f64::to_radians(20.0).tan()
    }

    /// How far a point lies from the middle of the space along the axis.
    fn off(self, point: &Point3<f64>) -> f64 {
        let off = point.z - self.hand * Self::LEAD * point.y.atan2(point.x) / TAU - self.middle;
        off - (off / Self::LEAD).round() * Self::LEAD
    }

    /// Half the width of the space along the axis.
    fn half_space(rho: f64) -> f64 {
        0.25 * Self::LEAD + Self::slope() * (rho - Self::RADIUS)
    }

    /// How far a point lies from the steel of the thread and the ground below, less than nothing inside; far beyond the tip.
    fn gap(self, point: &Point3<f64>) -> f64 {
        let rho = point.x.hypot(point.y);
        if rho > Self::TIP {
            return f64::INFINITY;
        }
        let normal = 1.0_f64.hypot(Self::slope()).hypot(Self::LEAD / TAU / rho);
        ((Self::half_space(rho) - self.off(point).abs()) / normal).min(rho - Self::ROOT)
    }

    /// The thread that corners of a body's mesh lie on, between ground and tip.
    fn of(corners: &[Point3<f64>]) -> Thread {
        // corners are single precision, 4e-6 mm at 100 mm
        let is_on = |thread: &Thread| {
            let off =
                |corner: &Point3<f64>| (thread.off(corner).abs() - Self::half_space(corner.x.hypot(corner.y))).abs();
            corners.iter().all(|corner| off(corner) < 2e-5)
        };
        let through = |hand: f64, side: f64| {
            let middle = Thread { hand, middle: 0.0 }.off(&corners[0])
                - side * Self::half_space(corners[0].x.hypot(corners[0].y));
            Thread { hand, middle }
        };
        let tried = [1.0, -1.0].into_iter().flat_map(|hand| [1.0, -1.0].map(|side| through(hand, side)));
        tried.into_iter().find(is_on).expect("all corners of the flanks lie on one thread")
    }
}

/// Meshes of both within 0.5 um would take minutes: a worm has teeth all along. But the corners of a mesh lie on the exact surfaces however
/// coarse it is, and the worm's are those of a thread in closed form. So the corners of the wheel's teeth are held against that thread; they
/// are so near each other that flanks which touch part by less than half a micrometre half that way on.
#[test]
fn a_worm_in_its_wheel() {
    let spec = "specs/bodies/worm_and_wheel_body.chain";
    let worm = parts(spec, SolidPart::Space, 0.05).remove("worm").expect("built");
    let wheel = parts(spec, SolidPart::Tooth, 0.002).remove("wheel").expect("built");
    let inside = |corner: &Point3<f64>| {
        let rho = corner.x.hypot(corner.y);
        rho > Thread::ROOT + 1e-4 && rho < Thread::TIP - 1e-4
    };
    let ends = worm.iter().flatten().map(|corner| corner.z.abs()).fold(0.0, f64::max);
    let flanks: Vec<Point3<f64>> =
        worm.iter().flatten().filter(|corner| inside(corner) && corner.z.abs() < ends - 1e-4).copied().collect();
    assert!(flanks.len() > 10_000, "{}", flanks.len());
    let thread = Thread::of(&flanks);
    for rolled in rolled(spec, 1, 3) {
        let [first, second] = places(spec, rolled);
        let gap = |k: i32| {
            let tooth = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::from(k) * TAU / 40.0).to_homogeneous();
            let placed = first.try_inverse().expect("a pose") * second * tooth;
            let corners = wheel.iter().flatten().map(|corner| thread.gap(&placed.transform_point(corner)));
            corners.fold(f64::INFINITY, f64::min)
        };
        // all teeth of the wheel that come near the worm
        let gap = (0..40).map(gap).fold(f64::INFINITY, f64::min);
        assert!(gap.abs() < GAP, "turn {} rad: {gap} mm", rolled[0]);
    }
}

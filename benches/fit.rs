//! Settings of a measured flank, of a wanted ease-off, and of a wanted contact: compiled, and with the points known.

use divan::{Bencher, black_box};
use flank_chain_dsl::{GeneratedSurface, Job, Parameter};
use flank_expr::Graph;
use flank_solver::{
    AdjustableSurface, Alignment, BoundSurface, ContactNumber, ContactProblem, ContactSynthesis, ContactWish,
    Deviation, FlankCorners, NearFoot, Outcome, Range, ScaledUnknown, SearchEnd, SettingsAdjustment, SurfacePoint,
    WantedPoints,
};
use flank_tests::pairs::with_pair_in;
use flank_tests::{bound, job, jobs, problem, turned};

const PINION: &str = "specs/bevel/pinion_19x62.chain";
const EASE_OFF: &str = "specs/bevel/ease_off_19x62.chain";
const PAIR: &str = "specs/pairs/bevel_19x62.chain";
/// Settings of a measured grid, with the changes that it was made with.
const MEASURED: [(&str, f64, &str); 9] = [
    ("m.radial_distance", 0.0906, "mm"),
    ("m.work_offset", 0.1, "mm"),
    ("m.machine_root_angle", 0.099, "deg"),
    ("m.machine_center_to_crossing_point", 0.05, "mm"),
    ("m.ratio_of_roll", 0.001, ""),
    ("m.cutter_tilt", 0.02, "deg"),
    ("m.modified_roll_2c", 0.001, ""),
    ("m.helical_motion_1", 0.02, "mm"),
    ("c.blade_angle", 0.05, "deg"),
];
/// Settings of an ease-off.
const OF_EASE_OFF: [&str; 9] = [
    "m.radial_distance",
    "m.work_offset",
    "m.sliding_base",
    "m.machine_center_to_crossing_point",
    "m.ratio_of_roll",
    "m.modified_roll_2c",
    "m.modified_roll_6d",
    "c.outside_point_radius",
    "c.blade_angle",
];
/// Settings of a contact.
const OF_CONTACT: [&str; 6] = [
    "p.radial_distance",
    "p.work_offset",
    "p.machine_center_to_crossing_point",
    "p.ratio_of_roll",
    "p.modified_roll_2c",
    "pinion_cutter.blade_angle",
];

fn main() {
    divan::main();
}

fn named<'j, 'g>(job: &'j Job<'g>, names: &[&str]) -> Vec<&'j Parameter<'g>> {
    names.iter().map(|name| job.parameters.iter().find(|of| of.name == *name).expect("a parameter")).collect()
}

fn concave<'j, 'g>(job: &'j Job<'g>) -> &'j GeneratedSurface<'g> {
    job.surfaces.iter().find(|surface| surface.name == "concave").expect("a surface")
}

fn unknown(of: &Parameter<'_>) -> ScaledUnknown {
    let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    let scale = if of.dimension == flank_chain_dsl::Dimension::LENGTH { 0.1 } else { 3e-3 };
    ScaledUnknown { start: of.value, scale, range: everywhere }
}

fn adjustable(job: &Job<'_>, names: &[&str]) -> AdjustableSurface {
    let open: Vec<_> = named(job, names).iter().map(|of| of.variable).collect();
    let made = concave(job);
    let ranges = made.unknowns.iter().map(|of| Range { low: of.low, high: of.high }.beyond(0.0)).collect();
    AdjustableSurface::new(&BoundSurface::new(&made.surface, ranges, &job.bindings_beside(&open)), &open)
        .expect("all bound")
}

/// Rows and columns of the flank.
fn points(job: &Job<'_>, [rows, columns]: [usize; 2]) -> Vec<SurfacePoint> {
    let made = concave(job);
    let sample = made.sample.as_ref().expect("it is sampled");
    let (all, [own_rows, own]) = (sample.targets(), sample.counts);
    let spread = |k: usize, of: usize, count: usize| 1 + k * (count - 3) / (of - 1);
    let places = (0..rows).flat_map(|i| (0..columns).map(move |j| [i, j]));
    let targets: Vec<[f64; 2]> =
        places.map(|[i, j]| all[spread(i, rows, own_rows) * own + spread(j, columns, own)]).collect();
    problem(job, made, sample.coordinates.each_ref().map(|of| of.value)).solve(&targets, [rows, columns]).0
}

/// Nine settings and a turn from points, to the end of the search.
fn fitted(bencher: Bencher, counts: [usize; 2]) {
    let names = MEASURED.map(|(name, ..)| name);
    let (graph, other) = (Graph::new(), Graph::new());
    let nominal = job(&graph, PINION, &[]);
    let settings = named(&nominal, &names);
    let set: Vec<(String, String)> = settings
        .iter()
        .zip(MEASURED)
        .map(|(of, (name, by, unit))| {
            let shown = if unit == "deg" { of.value.to_degrees() } else { of.value };
            (name.to_string(), format!("{:?} {unit}", shown + by).trim_end().to_string())
        })
        .collect();
    let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    let made = points(&job(&other, PINION, &set), counts);
    let from = points(&nominal, counts);
    let known: Vec<(&SurfacePoint, &SurfacePoint)> =
        made.iter().zip(&from).filter(|pair| [pair.0, pair.1].iter().all(|of| of.outcome == Outcome::Solved)).collect();
    let surface = adjustable(&nominal, &names);
    let adjustment = SettingsAdjustment {
        wanted: vec![WantedPoints {
            surface: &surface,
            points: known.iter().map(|(made, _)| turned(made.position, 1e-3)).collect(),
            near: known.iter().map(|(_, of)| NearFoot { unknowns: of.unknowns.clone(), distance: 0.0 }).collect(),
        }],
        kept: vec![],
        settings: settings.iter().map(|of| unknown(of)).collect(),
        alignment: Alignment::Turn,
        motion: ScaledUnknown { start: 0.0, scale: 2.5e-3, range: Range { low: -7.0, high: 7.0 } },
        further: vec![],
        shapes: None,
        resolution: 1e-4,
        uses_weak: true,
    };
    bencher.bench_local(|| black_box(&adjustment).solve().expect("the points have feet"));
}

#[divan::bench]
fn grid_5x9(bencher: Bencher) {
    fitted(bencher, [5, 9]);
}

#[divan::bench]
fn map_13x29(bencher: Bencher) {
    fitted(bencher, [13, 29]);
}

/// Nine settings and the turn, with which the flank of the basic settings lies off the conjugate one by crownings of 50 and 25 um, from
/// 25 x 45 points, to the end of the search.
#[divan::bench]
fn ease_off_25x45(bencher: Bencher) {
    let graph = Graph::new();
    let all = jobs(&graph, EASE_OFF, &[]);
    let [basic, conjugate] =
        ["basic", "conjugate"].map(|name| all.iter().find(|job| job.name == name).expect("it is there"));
    let sample = concave(conjugate).sample.as_ref().expect("it is sampled");
    let (targets, counts) = (sample.targets(), sample.counts);
    let solved = |job: &Job<'_>| {
        let made = concave(job);
        let coordinates = made.sample.as_ref().expect("it is sampled").coordinates.each_ref().map(|of| of.value);
        problem(job, made, coordinates).solve(&targets, counts).0
    };
    let (from, near) = (solved(conjugate), solved(basic));
    let middle = from.len() / 2;
    let nominal = Deviation::new(&bound(basic, concave(basic)), Alignment::Turn).expect("all bound");
    let turn = -nominal.motion_to(from[middle].position, &near[middle]).expect("it comes there");
    let share = |at: usize, count: usize| 2.0 * at as f64 / (count - 1) as f64 - 1.0;
    let wished = |at: usize| {
        let [v, u] = [share(at / counts[1], counts[0]), share(at % counts[1], counts[1])];
        -0.05 * v * v - 0.025 * u * u
    };
    let known = from.iter().zip(&near).enumerate();
    let known: Vec<(usize, (&SurfacePoint, &SurfacePoint))> =
        known.filter(|(_, pair)| [pair.0, pair.1].iter().all(|of| of.outcome == Outcome::Solved)).collect();
    let point = |&(at, (from, _)): &(usize, (&SurfacePoint, &SurfacePoint))| {
        std::array::from_fn(|k| from.position[k] + wished(at) * from.normal[k])
    };
    let foot = |&(at, (_, near)): &(usize, (&SurfacePoint, &SurfacePoint))| NearFoot {
        unknowns: near.unknowns.clone(),
        distance: wished(at),
    };
    let surface = adjustable(basic, &OF_EASE_OFF);
    let adjustment = SettingsAdjustment {
        wanted: vec![WantedPoints {
            surface: &surface,
            points: known.iter().map(point).collect(),
            near: known.iter().map(foot).collect(),
        }],
        kept: vec![],
        settings: named(basic, &OF_EASE_OFF).iter().map(|of| unknown(of)).collect(),
        alignment: Alignment::Turn,
        motion: ScaledUnknown { start: turn, scale: 2.5e-3, range: Range { low: -7.0, high: 7.0 } },
        further: vec![],
        shapes: None,
        // weaker directions do next to nothing, and lead to where points have no foot
        resolution: 3e-4,
        uses_weak: false,
    };
    let found = adjustment.solve().expect("the points have feet");
    assert!(known.len() > 1100 && found.fit.end == SearchEnd::Settled, "{} steps", found.fit.steps);
    bencher.bench_local(|| black_box(&adjustment).solve().expect("the points have feet"));
}

/// The surface in nine open settings, as tapes.
#[divan::bench]
fn compiled(bencher: Bencher) {
    let graph = Graph::new();
    let nominal = job(&graph, PINION, &[]);
    let names = MEASURED.map(|(name, ..)| name);
    bencher.bench_local(|| adjustable(black_box(&nominal), &names));
}

/// Place, path, ellipse and error of a contact by six settings.
#[divan::bench]
fn contact_of_six(bencher: Bencher) {
    let graph = Graph::new();
    let of_pair = job(&graph, PAIR, &[]);
    let settings = named(&of_pair, &OF_CONTACT);
    let open: Vec<_> = settings.iter().map(|of| of.variable).collect();
    let sample = of_pair.surfaces[1].sample.as_ref().expect("it is sampled");
    let flank_chain_dsl::SampleGrid::Shares { corners, .. } = sample.grid else { panic!("a sample of shares") };
    let corners = FlankCorners(corners);
    with_pair_in(&of_pair, &open, |pair, points| {
        let problem = ContactProblem::new(pair).expect("all bound");
        let first = problem.find(-0.0357, points).expect("they touch");
        let vertex = problem.vertex_near(&first).expect("the error is extreme");
        let now = |of: ContactNumber| of.of(&vertex).expect("a number");
        let wish = |of: ContactNumber, by: f64| ContactWish { of, wanted: now(of) + by, within: None };
        let synthesis = ContactSynthesis {
            problem: &problem,
            vertex: &vertex,
            wishes: vec![
                wish(ContactNumber::Lengthwise(corners), 0.02),
                wish(ContactNumber::Profilewise(corners), -0.03),
                wish(ContactNumber::Path(corners), 0.01),
                wish(ContactNumber::Ellipse { film: 0.00635 }, 0.2),
                wish(ContactNumber::Curvature, 0.05 * now(ContactNumber::Curvature)),
            ],
            settings: settings.iter().map(|of| unknown(of)).collect(),
        };
        bencher.bench_local(|| black_box(&synthesis).solve().expect("they touch"));
    });
}

//! What passes of a cutter leave, and the axes that take it along, against closed forms and brute force (tests/reference/five_axis_*).

use std::f64::consts::{FRAC_PI_2, PI};

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::geometry::{Axis, Chain, Step, Vector3};
use flank_expr::{Expr, Graph};
use flank_solver::{
    BoundSurface, Chart, Cutter, CutterPose, Lean, MillAxes, Obstacle, OutlinePiece, PoseField, PoseSeries, Range,
    SurfaceFrame, SurfaceFrames, SurfaceProblem, SweptCutter, ToolBody, cusp, left_by_block, lowest,
};
use flank_tests::{job, number, reference_json, vector};
use serde_json::Value;

/// Rows and columns of exact points that polynomials go through.
const GRID: [usize; 2] = [17, 33];

fn mill(tool: &Value) -> Cutter {
    let [r, c] = match tool["tool"].as_str() {
        Some("ball") => [0.0, number(tool, "R")],
        Some("flat") => [number(tool, "r"), 0.0],
        _ => [number(tool, "r"), number(tool, "c")],
    };
    Cutter { pieces: vec![OutlinePiece::Arc { center: [r, c], radius: c, between: [0.0, FRAC_PI_2] }] }
}

fn ball(radius: f64) -> Cutter {
    Cutter { pieces: vec![OutlinePiece::Arc { center: [0.0, radius], radius, between: [0.0, FRAC_PI_2] }] }
}

/// Position and normal in one row.
fn point(frame: &SurfaceFrame) -> [f64; 6] {
    let ([x, y, z], [nx, ny, nz]) = (frame.position, frame.normal);
    [x, y, z, nx, ny, nz]
}

/// Surface and cutter as polynomials of two shares.
struct Fields {
    surface: PoseField,
    cutter: PoseField,
}

impl Fields {
    fn new(frames: &[SurfaceFrame], cutter: &Cutter, lean: Lean) -> Fields {
        let pose = |frame: &SurfaceFrame| CutterPose::touching(frame, cutter, lean, 1.0).expect("it touches").row();
        let fields = Fields {
            surface: PoseField::through(frames.iter().map(point).collect(), GRID),
            cutter: PoseField::through(frames.iter().map(pose).collect(), GRID),
        };
        assert!(fields.surface.tail() < 1e-11 && fields.cutter.tail() < 1e-11, "{}", fields.cutter.tail());
        fields
    }

    /// The ridge between the first and the last pass.
    fn ridge(&self, along: f64, cutter: &Cutter) -> flank_solver::Cusp {
        let passes = [0.0, 1.0].map(|share| self.cutter.pass(share));
        cusp(&self.surface.across(along), passes.each_ref(), [0.0, 1.0], along, cutter).expect("the passes meet")
    }
}

fn shares() -> impl Iterator<Item = [f64; 2]> {
    let [rows, columns] = GRID.map(Chart::shares);
    rows.into_iter().flat_map(move |p| columns.clone().into_iter().map(move |u| [p, u]))
}

/// A surface of revolution or a plane; passes a step apart.
fn frame(row: &Value, [p, u]: [f64; 2]) -> SurfaceFrame {
    let (rho, side, step) = (number(row, "rho"), number(row, "side"), number(row, "step"));
    const LENGTH: f64 = 4.0;
    let scaled = |v: [f64; 3], by: f64| v.map(|x| by * x);
    match row["surface"].as_str().expect("a name") {
        "plane" => SurfaceFrame {
            position: [step * p, LENGTH * u, 0.0],
            normal: [0.0, 0.0, 1.0],
            steps: [[step, 0.0, 0.0], [0.0, LENGTH, 0.0]],
            turns: [[0.0; 3]; 2],
        },
        "cylinder" => {
            let (s, c) = (step.to_radians() * p).sin_cos();
            let (out, turn) = ([s, 0.0, c], scaled([c, 0.0, -s], step.to_radians()));
            SurfaceFrame {
                position: [rho * s, LENGTH * u, rho * c],
                normal: scaled(out, side),
                steps: [scaled(turn, rho), [0.0, LENGTH, 0.0]],
                turns: [scaled(turn, side), [0.0; 3]],
            }
        }
        name => {
            // a torus about a ring; a sphere has none
            let ring = if name.starts_with("sphere") { 0.0 } else { 60.0 };
            let (s, c) = (0.4 + step.to_radians() * p).sin_cos();
            let (sl, cl) = (0.3 * u).sin_cos();
            let out = [c * cl, c * sl, s];
            let across = scaled([-s * cl, -s * sl, c], step.to_radians());
            let along = scaled([-c * sl, c * cl, 0.0], 0.3);
            let way = scaled([-sl, cl, 0.0], 0.3 * (ring + rho * c));
            SurfaceFrame {
                position: [(ring + rho * c) * cl, (ring + rho * c) * sl, rho * s],
                normal: scaled(out, side),
                steps: [scaled(across, rho), way],
                turns: [scaled(across, side), scaled(along, side)],
            }
        }
    }
}

#[test]
fn ridges_on_planes_cylinders_spheres_and_tori_have_their_closed_forms() {
    let table = reference_json("five_axis_scallop_a.json");
    let rows = table["scallop"].as_array().expect("rows");
    assert!(rows.len() > 10);
    for row in rows {
        let (cutter, lead) = (mill(row), number(row, "lead_deg").to_radians());
        let frames: Vec<SurfaceFrame> = shares().map(|shares| frame(row, shares)).collect();
        let fields = Fields::new(&frames, &cutter, Lean { lead, ..Lean::default() });
        let ridge = fields.ridge(0.5, &cutter);
        // rounding of positions of some 10 mm
        let off = (ridge.height - number(row, "height")).abs();
        assert!(off < 1e-12, "{off:e} {ridge:?} {row}");
    }
}

#[test]
fn a_wrong_lead_or_radius_is_seen() {
    let table = reference_json("five_axis_scallop_a.json");
    let row = &table["scallop"][4];
    let cutter = mill(row);
    let frames: Vec<SurfaceFrame> = shares().map(|shares| frame(row, shares)).collect();
    let lean = Lean { lead: number(row, "lead_deg").to_radians() + 1e-6, ..Lean::default() };
    let ridge = Fields::new(&frames, &cutter, lean).ridge(0.5, &cutter);
    assert!((ridge.height - number(row, "height")).abs() > 1e-11);
}

/// A flank of the pair of the tables between four shares, at the polynomials' points.
fn flank(job: &Job<'_>, name: &str, [t, s]: [[f64; 2]; 2]) -> Vec<SurfaceFrame> {
    let surface: &GeneratedSurface<'_> = job.surfaces.iter().find(|surface| surface.name == name).expect("a flank");
    let sample = surface.sample.as_ref().expect("it is sampled");
    let flank_chain_dsl::SampleGrid::Shares { corners, .. } = &sample.grid else { panic!("an outline") };
    let ranges = surface.unknowns.iter().map(|unknown| Range { low: unknown.low, high: unknown.high }).collect();
    let bound = BoundSurface::new(&surface.surface, ranges, &job.bindings());
    let coordinates = sample.functions();
    let problem = SurfaceProblem::new(&bound, coordinates).expect("nothing is unbound");
    let mixed = |t: f64, s: f64| {
        let [tr, hr, tt, ht] = *corners;
        [0, 1].map(|k| (1.0 - t) * ((1.0 - s) * tr[k] + s * hr[k]) + t * ((1.0 - s) * tt[k] + s * ht[k]))
    };
    let between = |[low, high]: [f64; 2], share: f64| low + share * (high - low);
    let places: Vec<[f64; 2]> = shares().map(|[p, u]| [between(t, p), between(s, u)]).collect();
    let targets: Vec<[f64; 2]> = places.iter().map(|[t, s]| mixed(*t, *s)).collect();
    let (points, _) = problem.solve(&targets, GRID);
    let frames = SurfaceFrames::new(&bound, coordinates).expect("nothing is unbound");
    let found = frames.at(points.iter().map(|point| point.unknowns.as_slice()));
    let widths = [t[1] - t[0], s[1] - s[0]];
    let pairs = found.into_iter().zip(places);
    pairs
        .map(|(frame, [t, s])| {
            let rate = |ends: [[f64; 2]; 2], width: f64| [0, 1].map(|k| (ends[1][k] - ends[0][k]) * width);
            let by = [rate([mixed(0.0, s), mixed(1.0, s)], widths[0]), rate([mixed(t, 0.0), mixed(t, 1.0)], widths[1])];
            frame.expect("a regular point").by(by)
        })
        .collect()
}

/// The least height at which a line enters a flat cutter's cylinder, in very many poses of the middle of a pass.
fn scanned(pass: &PoseSeries, radius: f64, line: &[f64; 6]) -> f64 {
    scanned_at::<100_000>(pass, [0.4, 0.6], (radius, line), |bottom, [enters, leaves]| {
        (leaves > bottom).then(|| bottom.max(enters))
    })
}

/// The least of what a line has in poses between two shares of a way, which is given the height of the bottom on it, and where the line enters and
/// leaves the cylinder.
fn scanned_at<const POSES: usize>(
    way: &PoseSeries,
    [from, to]: [f64; 2],
    (radius, line): (f64, &[f64; 6]),
    height: impl Fn(f64, [f64; 2]) -> Option<f64>,
) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [x, y, z, nx, ny, nz] = *line;
    let normal = [nx, ny, nz];
    let heights = (0..=POSES).filter_map(|k| {
        let [tx, ty, tz, i, j, k] = way.at(from + (to - from) * k as f64 / POSES as f64);
        let (from, axis) = ([x - tx, y - ty, z - tz], [i, j, k]);
        let [up, slope] = [dot(from, axis), dot(normal, axis)];
        let bottom = -up / slope;
        // the square of the distance from the axis is a h² + 2 b h + c
        let (a, b) = (1.0 - slope * slope, dot(from, normal) - up * slope);
        let c = dot(from, from) - up * up - radius * radius;
        let root = (b * b - a * c).max(-1.0);
        if root < 0.0 {
            return None;
        }
        height(bottom, [-1.0, 1.0].map(|sign| (-b + sign * root.sqrt()) / a))
    });
    heights.fold(f64::INFINITY, f64::min)
}

fn name_of(row: &Value) -> &'static str {
    if row["flank"] == "pinion concave" { "pinion_concave" } else { "gear_convex" }
}

#[test]
fn ridges_on_bevel_flanks_are_those_of_brute_force() {
    let table = reference_json("five_axis_scallop_a.json");
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    for row in table["bevel"].as_array().expect("rows") {
        let (cutter, s) = (mill(row), number(row, "s"));
        let lead = if row["tool"] == "ball" { 0.0 } else { number(row, "lead_deg").to_radians() };
        let ends = [number(row, "t0"), number(row, "t1")];
        let frames = flank(&job, name_of(row), [ends, [s - 0.1, s + 0.1]]);
        let fields = Fields::new(&frames, &cutter, Lean { lead, ..Lean::default() });
        let ridge = fields.ridge(0.5, &cutter);
        let off = (ridge.height - number(row, "height")).abs();
        // the table's search stops 1.9e-9 mm above the kink at which a flat cutter's edge meets the line; the scan below is its witness
        let near = if row["tool"] == "flat" { 3e-9 } else { 1e-9 };
        assert!(off < near, "{off:e} {row}");
        if row["tool"] == "flat" {
            let line = fields.surface.across(0.5).at(ridge.share);
            let lowest = scanned(&fields.cutter.pass(0.0), number(row, "r"), &line);
            assert!(lowest > ridge.height - 1e-12 && lowest < ridge.height + 1e-6, "{lowest} {ridge:?}");
            assert!(ridge.height < number(row, "height"));
        }
        let at = ends[0] + ridge.share * (ends[1] - ends[0]);
        assert!((at - number(row, "t_of_cusp")).abs() < 1e-7, "{at} {row}");
        let point = fields.surface.across(0.5).at(ridge.share);
        let cusp = vector(row, "cusp_on_flank");
        assert!((0..3).all(|k| (point[k] - cusp[k]).abs() < 1e-6), "{point:?} {row}");
    }
}

/// What two passes leave together: the brute force's height at its ridge, nowhere more, and everywhere the lower one of both.
#[test]
fn two_passes_leave_the_ridges_of_brute_force() {
    let table = reference_json("five_axis_scallop_a.json");
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    for row in table["bevel"].as_array().expect("rows") {
        let (cutter, s) = (mill(row), number(row, "s"));
        let lead = if row["tool"] == "ball" { 0.0 } else { number(row, "lead_deg").to_radians() };
        let frames = flank(&job, name_of(row), [[number(row, "t0"), number(row, "t1")], [s - 0.1, s + 0.1]]);
        let fields = Fields::new(&frames, &cutter, Lean { lead, ..Lean::default() });
        let passes = [0.0, 1.0].map(|share| fields.cutter.pass(share));
        let swept = SweptCutter::of_passes(&passes, &cutter);
        let ridge = fields.ridge(0.5, &cutter);
        let left = |share: f64| swept.left(&fields.surface.at([share, 0.5])).expect("it passes");
        // a flat cutter's row is a scan that ends above the kink, as for ridges
        let near = if row["tool"] == "flat" { 3e-9 } else { 1e-9 };
        let at_ridge = left(ridge.share).height;
        assert!((at_ridge - number(row, "height")).abs() < near, "{at_ridge} {row}");
        // pieces of passes are polynomials of their own, and heights have slopes of some um per mm
        assert!((at_ridge - ridge.height).abs() < 1e-11, "{at_ridge} {ridge:?}");
        for k in 0..=40 {
            let share = f64::from(k) / 40.0;
            let found = left(share);
            let line = fields.surface.at([share, 0.5]);
            let each = passes.each_ref().map(|pass| lowest(pass, &cutter, &line, 0.5).map(|found| found.height));
            let least = each.into_iter().flatten().fold(f64::INFINITY, f64::min);
            assert!((found.height - least).abs() < 1e-11, "{found:?} {each:?}");
            assert!(found.height <= ridge.height + 1e-11, "{found:?} {ridge:?}");
            assert_eq!(found.way, usize::from(share > ridge.share), "{share} {ridge:?}");
        }
        // far beyond the ends of the passes nothing passes
        assert_eq!(swept.left(&[1e3, 0.0, 0.0, 1.0, 0.0, 0.0]), None);
    }
}

/// Nine passes in pieces leave what each of them leaves by itself, the least of it.
#[test]
fn many_passes_leave_the_least_of_all() {
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    let barrel = OutlinePiece::Arc { center: [-55.0, 6.0], radius: 60.0, between: [1.47, 1.67] };
    let bull = OutlinePiece::Arc { center: [1.5, 0.5], radius: 0.5, between: [0.0, FRAC_PI_2] };
    let bottom = OutlinePiece::Line { from: [0.0, 0.0], to: [1.5, 0.0] };
    let leaning = |lead: f64, tilt: f64| Lean { lead, tilt, stock: 0.0 };
    let cutters = [
        (ball(1.0), leaning(0.1, 1.2)),
        (Cutter { pieces: vec![bottom, bull] }, leaning(0.08, -0.1)),
        (Cutter { pieces: vec![barrel] }, leaning(0.02, 1.55)),
    ];
    let frames = flank(&job, "pinion_concave", [[0.4, 0.6], [0.3, 0.6]]);
    for (cutter, lean) in &cutters {
        let fields = Fields::new(&frames, cutter, *lean);
        let passes: Vec<PoseSeries> = (0..9).map(|k| fields.cutter.pass(f64::from(k) / 8.0)).collect();
        let swept = SweptCutter::of_passes(&passes, cutter);
        for place in [[0.03, 0.0], [0.21, 0.13], [0.4375, 0.5], [0.61, 0.77], [0.97, 1.0]] {
            let line = fields.surface.at(place);
            let each: Vec<Option<f64>> =
                passes.iter().map(|pass| lowest(pass, cutter, &line, place[1]).map(|found| found.height)).collect();
            let least = each.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            let found = swept.left(&line).expect("it passes");
            assert!((found.height - least).abs() < 1e-11, "{place:?} {found:?} {each:?}");
            assert_eq!(each[found.way].map(|height| (height - least).abs() < 1e-11), Some(true), "{found:?} {each:?}");
        }
    }
}

/// The cutter's envelope over both passes and along is the flank: over each of its points it is lowest at height zero.
#[test]
fn the_envelope_of_each_cutter_over_both_is_the_flank() {
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    let barrel = OutlinePiece::Arc { center: [-55.0, 6.0], radius: 60.0, between: [1.47, 1.67] };
    let flat = OutlinePiece::Arc { center: [2.0, 0.0], radius: 0.0, between: [0.0, FRAC_PI_2] };
    let bull = OutlinePiece::Arc { center: [1.5, 0.5], radius: 0.5, between: [0.0, FRAC_PI_2] };
    let leaning = |lead: f64, tilt: f64| Lean { lead, tilt, stock: 0.0 };
    let cutters = [
        (ball(1.5), leaning(0.0, 0.0)),
        (ball(2.0), leaning(0.2, -0.4)),
        (Cutter { pieces: vec![flat] }, leaning(0.1, 0.05)),
        (Cutter { pieces: vec![bull] }, leaning(0.08, -0.1)),
        (Cutter { pieces: vec![barrel] }, leaning(0.02, 1.55)),
    ];
    for name in ["pinion_concave", "gear_convex"] {
        let frames = flank(&job, name, [[0.4, 0.6], [0.3, 0.6]]);
        for (cutter, lean) in &cutters {
            let fields = Fields::new(&frames, cutter, *lean);
            for share in [0.0, 0.21, 0.5, 0.83, 1.0] {
                let (pass, surface) = (fields.cutter.pass(share), fields.surface.pass(share));
                for along in [0.1, 0.33, 0.5, 0.9] {
                    let found = lowest(&pass, cutter, &surface.at(along), along + 0.03).expect("it passes");
                    assert!(found.is_within, "{name} {found:?}");
                    assert!(
                        found.height.abs() < 1e-9 && (found.share - along).abs() < 1e-6,
                        "{name} {found:?} {along}"
                    );
                }
            }
        }
    }
}

/// The edge of a flat cutter meets a line twice on its way, with the front and with the heel: short and long ways leave the lower of both, and
/// nothing in front of where they end.
#[test]
fn flat_cutters_leave_what_brute_force_finds_on_ways_of_any_length() {
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    let frames = flank(&job, "pinion_concave", [[0.45, 0.55], [0.3, 0.6]]);
    let flat = OutlinePiece::Arc { center: [1.0, 0.0], radius: 0.0, between: [0.0, FRAC_PI_2] };
    let cutter = Cutter { pieces: vec![flat] };
    const POSES: usize = 4000;
    let (mut passed, mut beyond, mut heels) = (0, 0, 0);
    for (lead, tilt) in [(0.087f64, 0.35), (0.2, 0.0), (-0.1, 0.2), (0.02, 0.9)] {
        let fields = Fields::new(&frames, &cutter, Lean { lead, tilt, stock: 0.0 });
        let path = fields.cutter.pass(0.5);
        // parts of the pass: one as long as the cutter is wide, one longer, one far shorter, and all of it
        for [from, to] in [[0.2, 0.26], [0.26, 0.6], [0.5, 0.505], [0.0, 1.0]] {
            let way = PoseSeries::sampled(21, |share| path.at(from + share * (to - from)));
            // the pose beside the lowest one stands by a step of at most 15 mm farther, where the bottom is higher by as much as it leans
            let step = 15.0 * (to - from) / POSES as f64;
            let near_enough = step * (lead.abs() + 0.05);
            for place in 0..55 {
                let (row, column) = (f64::from(place % 5 - 2), f64::from(place / 5 - 1) / 8.0);
                let line = fields.surface.at([0.5 + 0.1 * row, from + (to - from) * column]);
                let brute = scanned_at::<POSES>(&way, [0.0, 1.0], (1.0, &line), |bottom, [enters, leaves]| {
                    (enters <= bottom && bottom < leaves).then_some(bottom)
                });
                for near in [column, 0.5, 0.0, 1.0] {
                    match lowest(&way, &cutter, &line, near) {
                        // rounding decides of the contact at the end itself
                        None => assert!(!brute.is_finite() || row == 0.0, "{lead} {from} {place} {near}: {brute}"),
                        Some(_) if !brute.is_finite() && row == 0.0 => {}
                        Some(found) => {
                            let off = brute - found.height;
                            let is_beside = off > -1e-9 && off < near_enough + 1e-9;
                            assert!(is_beside, "{lead} {tilt} {from} {place} {near}: {found:?} {brute}");
                            passed += 1;
                            heels += u32::from(found.height > 0.05);
                        }
                    }
                    beyond += u32::from(!brute.is_finite());
                }
            }
        }
    }
    // some lines only the bottom at the start of a way is over
    assert!(passed > 1500 && beyond > 100 && heels > 10, "{passed} {beyond} {heels}");
}

#[test]
fn straight_blocks_leave_what_brute_force_finds() {
    let table = reference_json("five_axis_scallop_a.json");
    let graph = Graph::new();
    let job = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    for row in table["bevel_chord"].as_array().expect("rows") {
        let [s, ds, t, radius] = ["s", "ds", "t", "R"].map(|name| number(row, name));
        let frames = flank(&job, name_of(row), [[t - 0.05, t + 0.05], [s - ds, s + 2.0 * ds]]);
        let cutter = ball(radius);
        let fields = Fields::new(&frames, &cutter, Lean::default());
        let surface = fields.surface.pass(0.5);
        let [from, to] = [1.0 / 3.0, 2.0 / 3.0];
        // the centre goes straight, the axis stands still
        let axis = surface.at(0.5);
        let centres: Vec<[f64; 3]> = [from, to]
            .iter()
            .map(|share| {
                let point = surface.at(*share);
                [0, 1, 2].map(|k| point[k] + radius * point[3 + k])
            })
            .collect();
        let told = &row["centres"];
        for (k, centre) in centres.iter().enumerate() {
            let told = |i: usize| told[k][i].as_f64().expect("a number");
            assert!((0..3).all(|i| (centre[i] - told(i)).abs() < 1e-9), "{centre:?} {row}");
        }
        let block = PoseSeries::sampled(5, |share| {
            let tip = |k: usize| centres[0][k] + share * (centres[1][k] - centres[0][k]) - radius * axis[3 + k];
            [tip(0), tip(1), tip(2), axis[3], axis[4], axis[5]]
        });
        let left = left_by_block(&surface, &block, [from, to], &cutter, 0.0).expect("it passes");
        let off = (left.height - number(row, "extreme_left")).abs();
        assert!(off < 1e-9, "{off:e} {row}");
        let at = s - ds + left.share * 3.0 * ds;
        // the brute force is a scan
        assert!((at - number(row, "s_of_extreme")).abs() < 1e-4 * (1.0 + ds), "{at} {row}");
    }
}

#[test]
fn a_ball_larger_than_its_hollow_cuts_too_deep_beside_its_contact() {
    let table = reference_json("five_axis_scallop_a.json");
    for row in table["gouge"]["local_ball"].as_array().expect("rows") {
        let [radius, rho, phi] = ["R", "rho", "phi_deg"].map(|name| number(row, name));
        let hollow = serde_json::json!({ "surface": "cylinder", "rho": rho, "side": -1, "step": 2.0 * phi });
        let cutter = ball(radius);
        let at = frame(&hollow, [0.0, 0.5]);
        let pose = CutterPose::touching(&at, &cutter, Lean::default(), 1.0).expect("it touches");
        let bending = pose.bending(&at, &cutter).expect("a regular point");
        assert!((bending.gap - (1.0 / radius - 1.0 / rho)).abs() < 1e-14 && (bending.hollow + 1.0 / rho).abs() < 1e-14);
        assert!((bending.effective_radius - radius).abs() < 1e-12);
        // and by the height of the pass over the place at the angle, along the normal there
        let frames: Vec<SurfaceFrame> = shares().map(|shares| frame(&hollow, shares)).collect();
        let fields = Fields::new(&frames, &cutter, Lean::default());
        let found =
            lowest(&fields.cutter.pass(0.0), &cutter, &fields.surface.across(0.5).at(0.5), 0.5).expect("it passes");
        assert!((found.height + number(row, "depth")).abs() < 1e-12, "{found:?} {row}");
    }
}

#[test]
fn effective_radii_of_flat_and_bull_nose_cutters_are_the_known_ones() {
    let plane = serde_json::json!({ "surface": "plane", "rho": 0.0, "side": 1, "step": 1.0 });
    for (r, c, lead) in [(4.0, 0.0, 0.05f64), (3.0, 1.0, 0.07), (2.0, 0.5, 0.3)] {
        let cutter =
            Cutter { pieces: vec![OutlinePiece::Arc { center: [r, c], radius: c, between: [0.0, FRAC_PI_2] }] };
        let at = frame(&plane, [0.5, 0.5]);
        let pose = CutterPose::touching(&at, &cutter, Lean { lead, ..Lean::default() }, 1.0).expect("it touches");
        let found = pose.bending(&at, &cutter).expect("a regular point").effective_radius;
        assert!((found - (c + r / lead.sin())).abs() < 1e-11, "{found}");
    }
}

/// From work to cutter on the machines of the table, whose cutter's frame has z out of the spindle.
fn machine<'g>(graph: &'g Graph, case: &Value, axes: [Expr<'g>; 5]) -> Chain<'g> {
    let [x, y, z, first, c] = axes;
    let at = |name: &str| case["settings"].get(name).and_then(Value::as_f64).unwrap_or(0.0);
    let fixed = |v: [f64; 3]| Step::Translate(Vector3::constant(graph, v));
    let [px, py, pz] = ["px", "py", "pz"].map(at);
    let work = fixed(["wx", "wy", "wz"].map(at));
    let table = |offset: [f64; 3], about: Axis<'g>| {
        vec![
            fixed([px + offset[0], py + offset[1], pz + offset[2]]),
            Step::Rotate(about, first),
            fixed(offset.map(|x| -x)),
            Step::Rotate(Axis::Z, c),
            work,
        ]
    };
    let (bed_to_work, tool) = match case["machine"].as_str() {
        Some("XYZAC") => (table([0.0, at("oy"), at("oz")], Axis::X), vec![Step::Translate(Vector3([x, y, z]))]),
        Some("XYZBC") => (table([at("ox"), 0.0, at("oz")], Axis::Y), vec![Step::Translate(Vector3([x, y, z]))]),
        _ => {
            let (so, pl) = (at("so"), at("pl"));
            let head = vec![
                Step::Translate(Vector3([x, y, z])),
                fixed([-so, 0.0, pl]),
                Step::Rotate(Axis::Y, first),
                fixed([so, 0.0, -pl]),
            ];
            (vec![fixed([px, py, pz]), Step::Rotate(Axis::Z, c), work], head)
        }
    };
    let back = bed_to_work.iter().rev().map(|step| step.inverse());
    let turned = Step::Rotate(Axis::X, graph.constant(PI));
    Chain::new(graph, back.chain(tool).chain([turned]).collect())
}

#[test]
fn axes_of_three_machines_are_those_of_the_table_on_both_elbows() {
    let table = reference_json("five_axis_post_a.json");
    for case in table["cases"].as_array().expect("machines") {
        let graph = Graph::new();
        let axes = ["X", "Y", "Z", "first", "C"].map(|name| graph.variable(name));
        let machine = MillAxes::new(&graph, &machine(&graph, case, axes), &axes).expect("a five-axis machine");
        for row in case["rows"].as_array().expect("rows") {
            let three = |name: &str| vector(row, name);
            let pose = CutterPose { tip: three("p"), axis: three("a"), feed: [0.0; 3] };
            let pole = machine.from_pole(pose.axis);
            assert!((pole - pose.axis[2].abs().min(1.0).acos()).abs() < 1e-7, "{pole} {row}");
            if row["singular"] == true {
                continue;
            }
            let found = [0, 1].map(|elbow| machine.at(&pose, elbow));
            for posture in row["postures"].as_array().expect("postures") {
                let wanted = ["X", "Y", "Z", "rotary1_deg", "C_deg"].map(|name| number(posture, name));
                let off = |axes: &Vec<f64>| {
                    let each = axes.iter().zip(&wanted).enumerate().map(|(k, (found, wanted))| match k {
                        0..3 => (found - wanted).abs(),
                        _ => {
                            let turns = (found.to_degrees() - wanted) / 360.0;
                            (turns - turns.round()).abs() * 360.0
                        }
                    });
                    each.fold(0.0, f64::max)
                };
                let nearest = found.iter().map(off).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1e-10, "{nearest:e} {posture} {found:?}");
            }
            // and back
            for axes in &found {
                let back = machine.pose(axes);
                assert!(
                    (0..3).all(|k| (back[k] - pose.tip[k]).abs() < 1e-10 && (back[3 + k] - pose.axis[k]).abs() < 1e-12)
                );
            }
        }
    }
}

/// With all axes in straight lines the tip leaves its line: halfway between two poses, and by millimetres across the pole.
#[test]
fn axes_in_straight_lines_lead_the_tip_where_the_table_says() {
    let table = reference_json("five_axis_post_a.json");
    for case in table["cases"].as_array().expect("machines") {
        let graph = Graph::new();
        let axes = ["X", "Y", "Z", "first", "C"].map(|name| graph.variable(name));
        let machine = MillAxes::new(&graph, &machine(&graph, case, axes), &axes).expect("a five-axis machine");
        let mut blocks = 0;
        for block in case["linear_blocks"].as_array().expect("blocks") {
            let [from, to] = ["from_pose", "to_pose"].map(|name| {
                let row = &case["rows"][block[name].as_u64().expect("a number") as usize];
                let posture = &row["postures"][0];
                let mut at = ["X", "Y", "Z", "rotary1_deg", "C_deg"].map(|name| number(posture, name));
                at[3..].iter_mut().for_each(|angle| *angle = angle.to_radians());
                at
            });
            let turn = number(block, "C_turn_deg").to_radians();
            let halfway: Vec<f64> =
                (0..5).map(|k| if k == 4 { from[4] + 0.5 * turn } else { 0.5 * (from[k] + to[k]) }).collect();
            // the table takes the nearest turn of C between the postures that it names
            if ((to[4] - from[4] - turn) / (2.0 * PI)).fract().abs() > 1e-9 {
                continue;
            }
            blocks += 1;
            let pose = machine.pose(&halfway);
            let (tip, axis) = (vector(block, "tip_halfway"), vector(block, "axis_halfway"));
            for k in 0..3 {
                assert!((pose[k] - tip[k]).abs() < 1e-10 && (pose[3 + k] - axis[k]).abs() < 1e-12, "{pose:?} {block}");
            }
        }
        assert!(blocks > 3, "{blocks}");
    }
}

#[test]
fn a_ball_comes_as_near_to_the_opposite_flank_as_brute_force_finds() {
    let table = reference_json("five_axis_scallop_a.json");
    let (graph, other) = (Graph::new(), Graph::new());
    let pair = job(&graph, "specs/pairs/bevel_19x62.chain", &[]);
    let gear = job(&other, "specs/bevel/gear_19x62.chain", &[]);
    let opposite = flank(&gear, "concave", [[0.06, 0.97], [0.02, 0.98]]);
    let obstacle = Obstacle::new(PoseField::through(opposite.iter().map(point).collect(), GRID));
    for row in table["slot"].as_array().expect("rows") {
        let [radius, s, t] = ["R", "s", "t"].map(|name| number(row, name));
        let frames = flank(&pair, "gear_convex", [[t - 0.05, t + 0.05], [s - 0.05, s + 0.05]]);
        let cutter = ball(radius);
        let fields = Fields::new(&frames, &cutter, Lean::default());
        let pose = fields.cutter.pass(0.5).at(0.5);
        // the whole ball
        let whole = OutlinePiece::Arc { center: [0.0, radius], radius, between: [0.0, PI] };
        let nearest = obstacle.nearest(&ToolBody { pieces: vec![whole] }, &pose, f64::INFINITY).expect("it is near");
        let off = (nearest.distance - number(row, "clearance")).abs();
        assert!(off < 1e-9, "{off:e} {nearest:?} {row}");
        // of all balls that touch there it is the largest with its own clearance
        let [x, y, z, nx, ny, nz] = fields.surface.pass(0.5).at(0.5);
        let clearance = number(row, "clearance");
        let largest = obstacle.largest_ball([x, y, z], [nx, ny, nz], clearance).expect("the flank is in the way");
        // the clearance changes slower than the radius does
        assert!((largest.distance - radius).abs() < 1e-8, "{largest:?} {row}");
        let foot = [0.02 + nearest.shares[1] * 0.96, 0.06 + nearest.shares[0] * 0.91];
        // the brute force is a scan
        for k in [0, 1] {
            let told = row["foot_share"][k].as_f64().expect("a share");
            assert!((foot[k] - told).abs() < 1e-3, "{foot:?} {row}");
        }
    }
}

#[test]
fn shanks_overlap_a_ball_as_the_table_says() {
    let table = reference_json("five_axis_scallop_a.json");
    for row in table["gouge"]["shank"].as_array().expect("rows") {
        let [rs, z0, ro] = ["rs", "z0", "ro"].map(|name| number(row, name));
        let ([x, y, z], [i, j, k]) = (vector(row, "T"), vector(row, "axis"));
        // the half line's cylinder has a round end
        let end = OutlinePiece::Arc { center: [0.0, z0], radius: rs, between: [0.0, FRAC_PI_2] };
        let side = OutlinePiece::Line { from: [rs, z0], to: [rs, z0 + 500.0] };
        let shank = ToolBody { pieces: vec![end, side] };
        let distance = shank.distance(&[x, y, z, i, j, k], vector(row, "O")) - ro;
        assert!((distance + number(row, "overlap")).abs() < 1e-12, "{distance} {row}");
    }
}

//! What single edges leave: closed forms, edges sampled densely, textbook depths.

use std::f64::consts::PI;

use flank_chain_dsl::{GeneratedSurface, Job};
use flank_expr::{Graph, ScalarEvaluator, Tape};
use flank_solver::{CuttingEdges, Outcome, ScallopHeight, SurfacePoint};
use flank_tests::{assert_point, bound, difference, job, job_of_text, problem, repository};

const PLANED: &str = "tests/machines/planed.chain";
const REAL_HOB: &str = "specs/hobbing/real_hob.chain";

fn surface<'j, 'g>(job: &'j Job<'g>, name: &str) -> &'j GeneratedSurface<'g> {
    job.surfaces.iter().find(|surface| surface.name == name).expect("the surface is in the job")
}

/// What is left of points of a surface.
fn left(job: &Job<'_>, name: &str, points: &[SurfacePoint]) -> Vec<Option<ScallopHeight>> {
    let ideal = surface(job, name);
    let real = &job.surfaces[ideal.cut_by.expect("the job says by what")];
    let edges = CuttingEdges::new(&bound(job, ideal), &bound(job, real)).expect("all bound");
    edges.left(points)
}

/// The points that a sample asks for.
fn sampled(job: &Job<'_>, name: &str) -> Vec<SurfacePoint> {
    let asked = surface(job, name);
    let sample = asked.sample.as_ref().expect("it is sampled");
    let coordinates = sample.functions();
    problem(job, asked, coordinates).solve(&sample.targets(), sample.counts).0
}

/// Height and counts where every point is known.
fn known(left: &[Option<ScallopHeight>]) -> Vec<(f64, &[f64])> {
    let cut = |left: &'_ Option<ScallopHeight>| matches!(left, Some(ScallopHeight::Cut { .. }));
    assert!(left.iter().all(cut), "not known everywhere");
    let each = left.iter().filter_map(|left| match left {
        Some(ScallopHeight::Cut { height, edge }) => Some((*height, &edge[2..])),
        _ => None,
    });
    each.collect()
}

/// Points on the branch that the sample keeps.
fn points_at(job: &Job<'_>, name: &str, targets: &[[f64; 2]]) -> Vec<SurfacePoint> {
    let asked = surface(job, name);
    let by = ["z", "rho"].map(|coordinate| asked.coordinate(coordinate).expect("every surface has it").value);
    problem(job, asked, by).solve(targets, [1, targets.len()]).0
}

fn deepest(left: &[Option<ScallopHeight>]) -> f64 {
    known(left).iter().map(|(height, _)| *height).fold(f64::NEG_INFINITY, f64::max)
}

fn with<'g>(graph: &'g Graph, spec: &str, set: &[(&str, String)]) -> Job<'g> {
    let set: Vec<(&str, &str)> = set.iter().map(|(name, value)| (*name, value.as_str())).collect();
    job(graph, spec, &set)
}

/// The order of a sweep's motions does not matter, also where one of them moves the edge along its own body.
#[test]
fn strokes_may_be_named_before_the_way_along_them() {
    let text = std::fs::read_to_string(repository(PLANED)).expect("the spec is there");
    let swapped = text.replace("over: [along, stroke]", "over: [stroke, along]");
    assert_ne!(text, swapped);
    let [written, turned] = [&text, &swapped].map(|text| {
        let graph = Graph::new();
        let job = job_of_text(&graph, text);
        let points = sampled(&job, "plane");
        left(&job, "plane", &points)
    });
    let (written, turned) = (known(&written), known(&turned));
    assert_eq!(written, turned);
    // half a feed of 0.5 mm off, the nose of 8 mm stands so high
    let ridge = 8.0 - (8.0f64 * 8.0 - 0.25 * 0.25).sqrt();
    let highest = turned.iter().map(|(height, _)| *height).fold(0.0, f64::max);
    assert!((highest - ridge).abs() < 1e-11, "{highest}");
}

/// A circle of radius R at the distance d rises by R - √(R² - d²).
#[test]
fn ridges_of_a_planed_surface_are_those_of_circles() {
    for (feed, radius, high) in [(0.5, 8.0, 0.0), (1.7, 8.0, 0.0), (0.5, 11.0, 0.02), (0.1, 7.0, -0.003)] {
        let graph = Graph::new();
        let set = [("feed", feed, "mm"), ("worn_radius", radius, "mm"), ("high", high, "mm")];
        let job = with(&graph, PLANED, &set.map(|(name, value, unit)| (name, format!("{value} {unit}"))));
        let points = sampled(&job, "plane");
        assert!(points.iter().all(|point| point.outcome == Outcome::Solved));
        let left = left(&job, "plane", &points);
        for (point, (height, counts)) in points.iter().zip(known(&left)) {
            let x = point.position[0];
            let distance = (x - feed * (x / feed).round()).abs();
            let circle = high + radius - (radius * radius - distance * distance).sqrt();
            // residuals of the solver are below 1e-11 mm
            assert!((height - circle).abs() < 1e-11, "{x}: {height} against {circle}");
            assert!((feed * counts[0] - x).abs() <= distance + 1e-9, "{x}: stroke {}", counts[0]);
        }
    }
}

/// Strokes that alternate: the deeper ones reach over their neighbours. The lowest edge is not the nearest one then.
#[test]
fn a_deeper_stroke_farther_away_is_found() {
    let graph = Graph::new();
    let job = with(&graph, PLANED, &[("feed", "0.1 mm".into()), ("chatter", "0.004 mm".into())]);
    let points = sampled(&job, "plane");
    let found = left(&job, "plane", &points);
    for (point, (height, _)) in points.iter().zip(known(&found)) {
        let x = point.position[0];
        let depth = |stroke: i32| {
            let d = x - 0.1 * f64::from(stroke);
            8.0 - (64.0 - d * d).sqrt() - if stroke % 2 == 0 { 0.0 } else { 0.004 }
        };
        let lowest = (-30..=30).map(depth).fold(f64::INFINITY, f64::min);
        assert!((height - lowest).abs() < 1e-11, "{x}: {height} against {lowest}");
    }
}

/// Edges that end before they reach the next stroke leave a wall: nothing passes over it.
#[test]
fn where_no_edge_passes_is_said() {
    let graph = Graph::new();
    let job = with(&graph, PLANED, &[("reach", "1 deg".into())]);
    let points = sampled(&job, "plane");
    let reach = 8.0 * 1f64.to_radians().sin();
    let (mut walls, mut cuts) = (0, 0);
    for (point, left) in points.iter().zip(left(&job, "plane", &points)) {
        let x = point.position[0];
        let distance = (x - 0.5 * (x / 0.5).round()).abs();
        let is_wall = matches!(left, Some(ScallopHeight::Unreached));
        assert_eq!(is_wall, distance > reach, "{x}: {left:?}");
        *(if is_wall { &mut walls } else { &mut cuts }) += 1;
    }
    assert!(walls > 50 && cuts > 50);
}

/// Edges without a gap generate what the whole thread of the hob does, wherever its rake faces lie: the gear that is checked
/// in `helical_gear.rs`.
#[test]
fn the_ideal_flank_is_that_of_the_whole_hob() {
    let targets: Vec<[f64; 2]> =
        (0..24).map(|k| [-9.0 + 3.5 * f64::from(k % 6), 48.5 + 1.6 * f64::from(k / 6)]).collect();
    for (rake_offset, gash_twist) in [("0 mm", "0 deg/mm"), ("5 mm", "0 deg/mm"), ("-2 mm", "-0.12 deg/mm")] {
        let graph = [Graph::new(), Graph::new()];
        let whole = job(&graph[0], "specs/hobbing/helical_gear.chain", &[("hob_shift", "0 mm")]);
        let rake = [("h.rake_offset", rake_offset), ("h.gash_twist", gash_twist)];
        let edges = job(&graph[1], REAL_HOB, &rake);
        for name in ["lower_flank", "upper_flank"] {
            let [expected, found] = [&whole, &edges].map(|job| points_at(job, name, &targets));
            for ((found, expected), target) in found.iter().zip(&expected).zip(&targets) {
                assert_eq!(expected.outcome, Outcome::Solved);
                assert_point(found, expected.position, expected.normal, &format!("{name} at {target:?}, {rake:?}"));
            }
        }
    }
}

/// The teeth of all turns belong to one hob, and the table has turned by whole turns: in the hob's frame each lies in a gash and on a
/// thread of it.
#[test]
fn the_teeth_of_all_turns_are_those_of_one_hob() {
    for (teeth, starts, gashes, by) in [(31.0, 2.0, 9.0, 0.0), (44.0, 3.0, 10.0, -0.002), (17.0, 1.0, 12.0, 0.001)] {
        let graph = Graph::new();
        let set = [("teeth", teeth), ("hob_starts", starts), ("gashes", gashes)];
        let set = set.map(|(name, value)| (name, value.to_string()));
        let twist = ["h.gash_twist", "e.gash_twist"].map(|name| (name, format!("{by} rad/mm")));
        let job = with(&graph, REAL_HOB, &[&set[..], &twist[..]].concat());
        let machine = &job.machines[1];
        let law = |name: &str| machine.axes.iter().find(|axis| axis.name == name).expect("an axis").law;
        let laws = graph.substitute(&["B", "C", "Z", "tooth_turn", "tooth_shift"].map(law), &job.bindings());
        let motions: Vec<_> = job.motions.iter().map(|motion| motion.variable).collect();
        let tape = Tape::new(&laws, &motions).expect("all bound");
        let helix = 22f64.to_radians();
        let lead_angle = f64::asin(starts * 3.0 / (2.0 * 38.0));
        let reduced_lead = 38.0 * lead_angle.tan();
        let is_whole = |x: f64, what: &str| assert!((x - x.round()).abs() < 1e-9, "{what} {x}");
        for (spindle, gash, turn) in [(2.0, 0.0, 0.0), (3.0, 5.0, 1.0), (3.5, -7.0, 4.0), (4.0, 11.0, -9.0)] {
            let mut out = [0.0; 5];
            ScalarEvaluator::new(&tape).run(&[spindle, gash, turn], &mut out);
            let [b, c, z, tooth_turn, tooth_shift] = out;
            let hob = spindle + 2.0 * PI * teeth / starts * turn;
            is_whole((b - hob) / (2.0 * PI), "turns of the hob");
            let table = -starts / teeth * hob - 2.0 * helix.sin() / (3.0 * teeth) * z;
            is_whole((c - table) / (2.0 * PI), "turns of the table");
            let in_gash = tooth_turn - by * tooth_shift;
            is_whole(in_gash * gashes / (2.0 * PI), "gash");
            is_whole((tooth_turn - tooth_shift / reduced_lead) * starts / (2.0 * PI), "thread");
        }
    }
}

/// The edges lie on the hob, and the hob's surface stays outside the flank that it generates: so does every edge. With many
/// gashes and little feed nothing is left.
#[test]
fn what_is_left_is_material_and_vanishes() {
    let graph = Graph::new();
    let coarse = with(&graph, REAL_HOB, &[("points", "40".into())]);
    let points = sampled(&coarse, "lower_flank");
    let coarse = left(&coarse, "lower_flank", &points);
    let graph = Graph::new();
    // a tenth of the distances in both directions: a hundredth of the height
    let set = [("points", 40), ("gashes", 140), ("gashes_used", 200), ("turns", 120)];
    let set = set.map(|(name, value)| (name, value.to_string()));
    let fine = with(&graph, REAL_HOB, &[&set[..], &[("feed_per_turn", "0.3 mm".to_string())]].concat());
    let points = sampled(&fine, "lower_flank");
    let fine = left(&fine, "lower_flank", &points);
    for left in [&coarse, &fine] {
        // ten times what the solver's residuals may be
        assert!(known(left).iter().all(|(height, _)| *height > -1e-10));
    }
    let share = deepest(&fine) / deepest(&coarse);
    // both maxima are those of a grid of points, which may miss the ridges' crests by a few percent
    assert!((share - 0.01).abs() < 1e-3, "{share}");
}

/// Which edges are tried does not depend on the other points, as long as enough are.
#[test]
fn a_point_alone_has_the_same_left() {
    let graph = Graph::new();
    let set = [("points", "12"), ("run_out", "0.015 mm"), ("wobble", "0.02 deg"), ("ground_off", "8 deg")];
    let job = job(&graph, REAL_HOB, &set);
    let points = sampled(&job, "upper_flank");
    let all = left(&job, "upper_flank", &points);
    for (point, together) in points.iter().zip(&all).step_by(7) {
        let alone = left(&job, "upper_flank", std::slice::from_ref(point));
        let pair = [alone[0].clone(), together.clone()];
        let [(alone, edge), (together, same)] = known(&pair)[..] else { panic!("two") };
        // steps of Newton are scaled by how large the work is
        assert!((alone - together).abs() < 1e-12 && edge == same, "{pair:?}");
    }
}

/// The edges' positions at closely spaced values, joined by triangles: where the normal of a point passes through one, the edge
/// is at that height. No equation is solved.
#[test]
fn edges_sampled_densely_are_as_high() {
    let hobs =
        [("2", "14", "0 mm", "0 deg/mm"), ("2", "9", "0.03 mm", "0 deg/mm"), ("1", "12", "0.01 mm", "-0.06 deg/mm")];
    for (starts, gashes, run_out, twist) in hobs {
        let set = [("hob_starts", starts), ("gashes", gashes), ("run_out", run_out), ("points", "4"), ("turns", "6")];
        let set = [&set[..], &[("gashes_used", "16"), ("face_width", "8 mm"), ("run_out_at", "50 deg")]].concat();
        let set = [&set[..], &[("h.gash_twist", twist), ("e.gash_twist", twist)]].concat();
        let graph = Graph::new();
        let job = job(&graph, REAL_HOB, &set);
        let points = sampled(&job, "lower_flank");
        let solved = left(&job, "lower_flank", &points);
        let sampled = lowest_triangles(&job, "lower_flank", &points);
        for ((point, (height, _)), triangle) in points.iter().zip(known(&solved)).zip(sampled) {
            // A chord lies inside the arc, so farther from the work, by an eighth of its square over the radius, times
            // sin 20 deg: for 0.3 deg of 42 mm that is 0.05 um, for both sides of a triangle twice that.
            assert!((triangle - height).abs() < 2e-4, "{:?}: {triangle} against {height}", point.position);
        }
    }
}

/// Over each point, the lowest of all triangles of all edges.
fn lowest_triangles(job: &Job<'_>, name: &str, points: &[SurfacePoint]) -> Vec<f64> {
    const ALONG: usize = 16;
    let edges = &job.surfaces[surface(job, name).cut_by.expect("the job says by what")];
    let position = edges.surface.position.0[0].graph().substitute(&edges.surface.position.0, &job.bindings());
    let tape = Tape::new(&position, &edges.surface.unknowns).expect("all bound");
    let mut evaluator = ScalarEvaluator::new(&tape);
    let [edge, motion, gash, turn] = [0, 1, 2, 3].map(|k| (edges.unknowns[k].low, edges.unknowns[k].high));
    let steps = ((motion.1 - motion.0) / 0.3f64.to_radians()).ceil() as usize;
    let between = |(low, high): (f64, f64), k: usize, count: usize| low + (high - low) * k as f64 / count as f64;
    let mut place = |j: usize, k: usize, counts: [i32; 2]| {
        let mut out = [0.0; 3];
        let [gash, turn] = counts.map(f64::from);
        evaluator.run(&[between(edge, j, ALONG), between(motion, k, steps), gash, turn], &mut out);
        out
    };
    let ends = |pick: fn(f64, f64) -> f64| -> [f64; 3] {
        std::array::from_fn(|k| points.iter().map(|point| point.position[k]).reduce(pick).expect("there are points"))
    };
    let (low, high) = (ends(f64::min), ends(f64::max));
    let is_near = |at: &[f64; 3], by: f64| (0..3).all(|k| low[k] - by < at[k] && at[k] < high[k] + by);
    let mut lowest = vec![f64::INFINITY; points.len()];
    for counts in
        (gash.0 as i32..=gash.1 as i32).flat_map(|gash| (turn.0 as i32..=turn.1 as i32).map(move |turn| [gash, turn]))
    {
        let mut before: Option<Vec<[f64; 3]>> = None;
        for k in 0..=steps {
            // no edge is longer than 16 mm
            let row: Option<Vec<[f64; 3]>> =
                is_near(&place(ALONG / 2, k, counts), 8.0).then(|| (0..=ALONG).map(|j| place(j, k, counts)).collect());
            if let (Some(before), Some(row)) = (&before, &row) {
                for (pair, next) in before.windows(2).zip(row.windows(2)).filter(|(pair, _)| is_near(&pair[0], 1.0)) {
                    for (point, lowest) in points.iter().zip(&mut lowest) {
                        // no triangle here is larger than a millimetre
                        if difference(&pair[0], &point.position) < 1.0 {
                            for triangle in [[pair[0], pair[1], next[0]], [pair[1], next[1], next[0]]] {
                                *lowest = lowest.min(pierced(triangle, point).unwrap_or(f64::INFINITY));
                            }
                        }
                    }
                }
            }
            before = row;
        }
    }
    lowest
}

/// How high over a point its normal passes through a triangle, if it does.
fn pierced(triangle: [[f64; 3]; 3], point: &SurfacePoint) -> Option<f64> {
    let from = |corner: [f64; 3]| std::array::from_fn(|k| corner[k] - point.position[k]);
    let corners: [[f64; 3]; 3] = triangle.map(from);
    let n = point.normal;
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    // areas that the corners span with the point as the normal sees them
    let areas = [[1, 2], [2, 0], [0, 1]].map(|[a, b]| dot(cross(corners[a], corners[b]), n));
    let inside = areas.iter().all(|area| *area >= 0.0) || areas.iter().all(|area| *area <= 0.0);
    let total: f64 = areas.iter().sum();
    (inside && total != 0.0).then(|| (0..3).map(|k| areas[k] * dot(corners[k], n)).sum::<f64>() / total)
}

/// Where the tooth is straight along the lead and the hob stands almost square to it, facets and feed marks do not mix, and
/// both come to what the textbooks say of them.
struct SpurGear {
    hob_radius: f64,
}

impl SpurGear {
    const MODULE: f64 = 3.0;
    const TEETH: f64 = 40.0;
    const PRESSURE_ANGLE: f64 = PI / 9.0;

    /// The deepest of points with these radii and z.
    fn deepest(&self, gashes: u32, feed: f64, targets: &[[f64; 2]]) -> f64 {
        let graph = Graph::new();
        let set = [
            ("helix_angle", "0 deg".to_string()),
            ("hob_starts", "1".to_string()),
            ("teeth", SpurGear::TEETH.to_string()),
            ("shift", "0 mm".to_string()),
            ("hob_radius", format!("{} mm", self.hob_radius)),
            ("gashes", gashes.to_string()),
            ("gashes_used", (2 * gashes).to_string()),
            ("feed_per_turn", format!("{feed} mm")),
            ("turns", format!("{}", (20.0 / feed).ceil())),
        ];
        let job = with(&graph, REAL_HOB, &set);
        deepest(&left(&job, "lower_flank", &points_at(&job, "lower_flank", targets)))
    }

    /// The share of π² m sin α / (4 z n²) that the facets beside the pitch circle have, with so little feed that its
    /// marks are a ten-thousandth of them.
    fn facets(&self, gashes: u32) -> f64 {
        let textbook = PI * PI * SpurGear::MODULE * SpurGear::PRESSURE_ANGLE.sin()
            / (4.0 * SpurGear::TEETH * f64::from(gashes).powi(2));
        let feed = (1e-4 * textbook * 4.0 * self.tip_diameter() / SpurGear::PRESSURE_ANGLE.sin()).sqrt();
        // the roll angles from half a facet below the pitch circle to half a facet above
        let step = 2.0 * PI / (SpurGear::TEETH * f64::from(gashes));
        let base = SpurGear::MODULE * SpurGear::TEETH / 2.0 * SpurGear::PRESSURE_ANGLE.cos();
        let radius = |k: u32| base * (SpurGear::PRESSURE_ANGLE.tan() + step * (f64::from(k) / 100.0 - 0.5)).hypot(1.0);
        let targets: Vec<[f64; 2]> = (0..=100).map(|k| [0.0, radius(k)]).collect();
        self.deepest(gashes, feed, &targets) / textbook
    }

    /// The share of f² sin α / (4 d_a0) that the feed marks have where the tip of the hob cuts, with so many gashes that
    /// their facets are a thousandth of them or less.
    fn feed_marks(&self, feed: f64) -> f64 {
        let textbook = feed * feed * SpurGear::PRESSURE_ANGLE.sin() / (4.0 * self.tip_diameter());
        let facet = PI * PI * SpurGear::MODULE * SpurGear::PRESSURE_ANGLE.sin() / (4.0 * SpurGear::TEETH);
        let gashes = (facet / (1e-3 * textbook)).sqrt().ceil() as u32;
        let pitch = SpurGear::MODULE * SpurGear::TEETH / 2.0;
        let form = (pitch * SpurGear::PRESSURE_ANGLE.cos()).hypot(SpurGear::curvature_radius_at_form());
        // where between two marks their crest stands depends on the tooth space; a grid this fine misses a thousandth of it
        let targets = (0..=2000).map(|k| [feed * (f64::from(k) / 2000.0 - 0.5), form + 1e-3]);
        let targets: Vec<[f64; 2]> = targets.collect();
        self.deepest(gashes, feed, &targets) / textbook
    }

    /// The involute's, where the tip of the hob begins it.
    fn curvature_radius_at_form() -> f64 {
        SpurGear::MODULE * SpurGear::TEETH / 2.0 * SpurGear::PRESSURE_ANGLE.sin()
            - 1.25 * SpurGear::MODULE / SpurGear::PRESSURE_ANGLE.sin()
    }

    fn tip_diameter(&self) -> f64 {
        2.0 * (self.hob_radius + 1.25 * SpurGear::MODULE)
    }
}

/// What the hob's lead angle, by which facets and marks run askew, makes of a depth, and the points of the grids that
/// miss a crest.
fn askew(hob: &SpurGear) -> f64 {
    let lead_angle = (SpurGear::MODULE / (2.0 * hob.hob_radius)).asin();
    3.0 * lead_angle * lead_angle + 1e-3
}

#[test]
fn facets_come_to_the_textbook_depth() {
    for hob in [SpurGear { hob_radius: 38.0 }, SpurGear { hob_radius: 380.0 }] {
        for gashes in [6, 8, 12, 24, 48, 96] {
            let share = hob.facets(gashes);
            // a ridge lies up to half a facet off the pitch circle, where the involute's radius is another one
            let half_facet = PI / (SpurGear::TEETH * f64::from(gashes)) / SpurGear::PRESSURE_ANGLE.tan();
            assert!((share - 1.0).abs() < half_facet + askew(&hob), "{gashes} gashes of {}: {share}", hob.hob_radius);
        }
    }
}

#[test]
fn feed_marks_come_to_the_textbook_depth() {
    for hob in [SpurGear { hob_radius: 38.0 }, SpurGear { hob_radius: 380.0 }] {
        for feed in [8.0, 4.0, 2.0, 1.0, 0.5] {
            let share = hob.feed_marks(feed);
            // the textbook takes the circle of the tip for a parabola, also where the edge beside it cuts; a thousandth
            // are the facets. Over the height of the crest it takes the flank for straight.
            let circle = (feed / (0.5 * hob.tip_diameter())).powi(2);
            let bend = feed * feed / (4.0 * hob.tip_diameter()) / SpurGear::curvature_radius_at_form();
            assert!(
                (share - 1.0).abs() < circle + bend + askew(&hob) + 1e-3,
                "{feed} mm of {}: {share}",
                hob.hob_radius
            );
        }
    }
}

/// On a helical gear the hob moves by f cos β square to its own axis; what it moves along the axis is rolling, which many gashes
/// take up. Marks are those of a circle of the hob's radius against the tooth, which is bent in that direction, too.
#[test]
fn feed_marks_of_a_helical_gear_lie_across_the_hob() {
    let (radius, feed, teeth, module) = (400.0, 1.0, 31.0, 3.0);
    let (alpha, beta) = (PI / 9.0, 22f64.to_radians());
    let graph = Graph::new();
    let set = [
        ("hob_starts", "1".to_string()),
        ("shift", "0 mm".to_string()),
        ("hob_radius", format!("{radius} mm")),
        ("gashes", "1000".to_string()),
        ("gashes_used", "2000".to_string()),
        ("feed_per_turn", format!("{feed} mm")),
        ("turns", "60".to_string()),
    ];
    let job = with(&graph, REAL_HOB, &set);
    let pitch = module * teeth / (2.0 * beta.cos());
    let targets: Vec<[f64; 2]> = (0..=100).map(|k| [feed * (f64::from(k) / 100.0 - 0.5), pitch]).collect();
    let found = deepest(&left(&job, "lower_flank", &points_at(&job, "lower_flank", &targets)));
    // r sin α_t cos β_b, the radius in the section square to the tooth's generators
    let rolling = pitch * alpha.sin();
    let bent = 1.0 + alpha.sin() * (pitch * beta.sin()).powi(2) / (radius * rolling);
    let expected = (feed * beta.cos()).powi(2) * alpha.sin() / (8.0 * radius) / bent;
    // the lead angle of the hob, 0.2 deg, turns its axis; 101 points miss a crest by up to 1 % of half a mark
    assert!((found / expected - 1.0).abs() < 0.015, "{found} against {expected}");
}

//! Undercut: where the tool cuts away what it generates, by the sign of the clearance's Hessian.

use flank_chain_dsl::{GeneratedSurface, Job, ToolShape, compile_text, render};
use flank_expr::geometry::Vector3;
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{CutBy, Meeting, Outcome, Range, SurfacePoint, SurfaceProblem, System, Trim, TrimmedBy, solve};
use flank_tests::{bound, difference, job, number, points, reference_json, repository, reversed, vector};

const SPUR: &str = "specs/hobbing/spur_gear.chain";
/// z = 20, m = 1, α = 20°, x = 0, h_aP0 = 1.25, ρ_aP0 = 0.25.
const MESYS: [(&str, &str); 5] = [
    ("teeth", "20"),
    ("module", "1 mm"),
    ("profile_shift", "0"),
    ("r.tip_height", "1.25 mm"),
    ("r.tip_radius", "0.25 mm"),
];
/// The flank's sample: along the root cone from its middle, and the height over it.
const CRADLE_PINION: &str = "
machine cradle {
    axis Q : rotary
    axis R : rotary
    frame bed
    frame cradle in bed = translate_x(1 mm) rotate_y(15.9 deg) translate_z(-1 mm) translate_y(4 mm) rotate_z(Q)
    frame cutter in cradle = rotate_z(64 deg) translate_x(74.8 mm) rotate_z(30 deg) rotate_y(2 deg)
    frame work in bed = rotate_y(90 deg) rotate_z(R)
}
tool cone {
    surface blade(s: length in -3 mm .. 12 mm, theta: angle in -2.9 rad .. -2 rad) {
        let radius = 76 mm - s * sin(20 deg)
        at = [radius * cos(theta), radius * sin(theta), -s * cos(20 deg)]
        body outside
    }
}
job pinion {
    machine m = cradle
    tool c = cone
    mount c on m.cutter
    motion roll : angle in -0.6 rad .. 0.2 rad
    drive m.Q = roll
    drive m.R = 3.24 * (roll - 0.01 * roll^2 / 1 rad - 0.005 * roll^3 / 1 rad^2)
    surface flank in m.work = envelope(c.blade, over: roll)
    sample flank {
        along = z * cos(15.9 deg) + rho * sin(15.9 deg) - 85 mm: -12.5 mm .. 12.5 mm by 9
        height = rho * cos(15.9 deg) - z * sin(15.9 deg): 1 mm .. 9 mm by 5
    }
}";
const UNDERCUT: [(&str, &str); 2] = [("teeth", "10"), ("profile_shift", "0")];

fn compiled<'g>(graph: &'g Graph, text: &str) -> Job<'g> {
    let mut compilation = compile_text(graph, "text", text, &[]);
    let told = render(&compilation.diagnostics, &compilation.sources, false);
    assert!(!compilation.has_errors(), "{told}");
    compilation.jobs.swap_remove(0)
}

fn surface<'j, 'g>(job: &'j Job<'g>, name: &str) -> &'j GeneratedSurface<'g> {
    job.surfaces.iter().find(|surface| surface.name == name).expect("the surface is in the job")
}

/// How far a point that is fixed to the work is from the tool's steel, at values of the motions: the foot of the
/// perpendicular on the tool's surface, solved in the tool's frame; nothing of the envelope is used.
struct Clearance<'g> {
    graph: &'g Graph,
    system: System,
    signed: Expr<'g>,
    inputs: Vec<Expr<'g>>,
    ranges: Vec<Range>,
}

impl<'g> Clearance<'g> {
    fn new(job: &Job<'g>, generated: &GeneratedSurface<'g>) -> Clearance<'g> {
        let ToolShape::Surface(tool) = &generated.generation.tool else { panic!("a surface") };
        let graph = tool.normal.0[0].graph();
        let work = Vector3(["x", "y", "z"].map(|name| graph.variable(name)));
        let apart = generated.generation.driven.inverse().point(work) - tool.position;
        let feet = tool.unknowns.iter().map(|&u| apart.dot(tool.position.derivative(u)));
        let all: Vec<Expr<'g>> = feet.chain([apart.dot(tool.normal)]).collect();
        let all = graph.substitute(&all, &job.bindings());
        let inputs: Vec<Expr<'g>> = generated.generation.motions.iter().copied().chain(work.0).collect();
        let system = System::new(&all[..2], &tool.unknowns, &inputs).expect("nothing is unbound");
        let signed = all[2];
        let inputs = tool.unknowns.iter().copied().chain(inputs).collect();
        // the foot may lie where the tool's surface is no longer used
        let wide =
            |u: &flank_chain_dsl::RangedVariable<'_>| Range { low: 2.0 * u.low - u.high, high: 2.0 * u.high - u.low };
        Clearance { graph, system, signed, inputs, ranges: generated.unknowns[..2].iter().map(wide).collect() }
    }

    fn at(&self, point: &SurfacePoint, by: &[f64]) -> f64 {
        let motions = point.unknowns[2..].iter().zip(by).map(|(motion, by)| motion + by);
        let given: Vec<f64> = motions.chain(point.position).collect();
        let foot = solve(&self.system, &self.ranges, &given, &point.unknowns[..2]);
        assert_eq!(foot.outcome, Outcome::Solved, "a foot");
        let mut values = vec![f64::NAN; self.graph.variable_count()];
        for (input, value) in self.inputs.iter().zip(foot.unknowns.iter().chain(&given)) {
            values[input.as_variable().expect("a variable").index()] = *value;
        }
        self.graph.evaluate(&[self.signed], &values)[0]
    }

    /// ∂²/∂m_j∂m_k by differences of the distances, the error of the step's square taken out.
    fn hessian(&self, point: &SurfacePoint, steps: &[f64]) -> Vec<Vec<f64>> {
        let count = steps.len();
        let second = |j: usize, k: usize, scale: f64| {
            let at = |a: f64, b: f64| {
                let mut by = vec![0.0; count];
                by[j] += a * scale * steps[j];
                by[k] += b * scale * steps[k];
                self.at(point, &by)
            };
            (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0))
                / (4.0 * scale * scale * steps[j] * steps[k])
        };
        let refined = |j, k| (4.0 * second(j, k, 1.0) - second(j, k, 2.0)) / 3.0;
        (0..count).map(|j| (0..count).map(|k| refined(j, k)).collect()).collect()
    }
}

/// Points of a surface, with the steps of the motions for differences.
#[derive(Clone, Copy)]
struct Case {
    spec: &'static str,
    set: &'static [(&'static str, &'static str)],
    surface: &'static str,
    coordinates: [&'static str; 2],
    targets: &'static [[f64; 2]],
    steps: &'static [f64],
}

/// The leading minors against distances from the tool that know nothing of envelopes; one and two motions, on both sides of
/// the singular line.
#[test]
fn the_minors_are_those_of_the_clearance() {
    let plain = Case {
        spec: SPUR,
        set: &UNDERCUT,
        surface: "flank_plus",
        coordinates: ["u", "v"],
        targets: &[],
        steps: &[2e-3],
    };
    let cases = [
        Case { targets: &[[-2.0, 1.0], [1.5, 1.0], [2.2, 1.0], [3.0, -4.0]], ..plain },
        Case { surface: "fillet_plus", coordinates: ["theta", "v"], targets: &[[0.5, 1.0], [1.2, 1.0]], ..plain },
        Case {
            spec: "specs/hobbing/helical_gear.chain",
            set: &[],
            surface: "lower_flank",
            coordinates: ["rho", "z"],
            targets: &[[51.0, 3.0], [48.9, -6.0]],
            steps: &[2e-3, 0.05],
        },
        Case {
            spec: "specs/bevel/pinion_19x62.chain",
            set: &[],
            surface: "concave",
            coordinates: ["s", "roll"],
            targets: &[[2.0, -0.1], [6.0, 0.05]],
            ..plain
        },
    ];
    for Case { spec, set, surface: name, coordinates, targets, steps } in cases {
        let graph = Graph::new();
        let job = job(&graph, spec, set);
        let generated = surface(&job, name);
        let clearance = Clearance::new(&job, generated);
        let minors = generated.surface.clearance_minors();
        for point in points(&job, name, coordinates, targets) {
            let what = format!("{name} at {:?}", point.unknowns);
            assert!(
                matches!(point.outcome, Outcome::Solved | Outcome::CutAway(CutBy::ItsTool)),
                "{what}: {:?}",
                point.outcome
            );
            let found = values(&job, name, &minors, &point.unknowns);
            let h = clearance.hessian(&point, steps);
            let expected: Vec<f64> = match h.as_slice() {
                [one] => vec![one[0]],
                [first, second] => vec![first[0], first[0] * second[1] - first[1] * second[0]],
                _ => panic!("one or two motions"),
            };
            for (found, expected) in found.iter().zip(&expected) {
                // distances are good to 1e-14 mm of 1e-4 mm, and the differences to the fourth power of the step
                assert!((found - expected).abs() <= 1e-6 * expected.abs().max(1.0), "{what}: {found} for {expected}");
            }
            let stays = expected.iter().all(|minor| *minor > 0.0);
            assert_eq!(point.outcome == Outcome::Solved, stays, "{what}: {expected:?}");
        }
    }
}

/// A rack's straight flank: the tool cuts away what it generates beyond u = (r sin²α + x m) / cos α.
#[test]
fn beyond_the_singular_line_points_are_cut_away() {
    let graph = Graph::new();
    let job = job(&graph, SPUR, &UNDERCUT);
    let alpha = 20f64.to_radians();
    let limit = 15.0 * alpha.sin().powi(2) / alpha.cos();
    let targets: Vec<[f64; 2]> = [-2.0, 0.0, limit - 1e-6, limit + 1e-6, 2.5, 3.0].map(|u| [u, 0.0]).to_vec();
    for (target, point) in targets.iter().zip(points(&job, "flank_plus", ["u", "v"], &targets)) {
        let expected = if target[0] < limit { Outcome::Solved } else { Outcome::CutAway(CutBy::ItsTool) };
        assert_eq!(point.outcome, expected, "u {}", target[0]);
    }
    // at a radius that both branches reach, the one that stays is taken
    let radii: Vec<[f64; 2]> = (0..8).map(|k| [14.0955 + 0.02 * f64::from(k), 0.0]).collect();
    for point in points(&job, "flank_plus", ["rho", "z"], &radii) {
        assert_eq!(point.outcome, Outcome::Solved);
        assert!(point.unknowns[0] < limit);
    }
}

fn coordinate<'g>(job: &Job<'g>, name: &str, coordinate: &str) -> Expr<'g> {
    surface(job, name).coordinate(coordinate).expect("a coordinate of the surface").value
}

/// Numbers for expressions at a point of a surface.
fn values<'g>(job: &Job<'g>, name: &str, expressions: &[Expr<'g>], unknowns: &[f64]) -> Vec<f64> {
    let graph = expressions[0].graph();
    let mut values = vec![f64::NAN; graph.variable_count()];
    for (unknown, value) in surface(job, name).surface.unknowns.iter().zip(unknowns) {
        values[unknown.as_variable().expect("a variable").index()] = *value;
    }
    graph.evaluate(&graph.substitute(expressions, &job.bindings()), &values)
}

/// Points of a line on a surface at values of a coordinate.
fn line<'g>(job: &Job<'g>, name: &str, limit: &str, along: Expr<'g>, values: &[f64]) -> Vec<SurfacePoint> {
    let generated = surface(job, name);
    let quantity = match limit {
        "singular" => generated.surface.clearance_minors().pop(),
        _ => generated.surface.contact_limit(),
    };
    let problem = SurfaceProblem::line(&bound(job, generated), quantity.expect("motions"), along);
    let targets: Vec<[f64; 2]> = values.iter().map(|&value| [0.0, value]).collect();
    problem.expect("nothing is unbound").solve(&targets, [1, values.len()]).0
}

#[test]
fn the_singular_line_meets_the_table() {
    let reference = reference_json("spur_rack.json");
    let graph = Graph::new();
    let job = job(&graph, SPUR, &UNDERCUT);
    for (name, side) in [("flank_plus", 1.0), ("flank_minus", -1.0)] {
        for point in line(&job, name, "singular", coordinate(&job, name, "v"), &[-10.0, -3.0, 0.0, 7.5]) {
            assert_eq!(point.outcome, Outcome::Solved);
            let [u, _, phi] = point.unknowns[..] else { panic!("three unknowns") };
            assert!((u - number(&reference["undercut"], "limit_u")).abs() < 1e-9);
            assert!((side * phi - number(&reference["undercut"], "limit_phi")).abs() < 1e-9);
            let base_radius = 15.0 * 20f64.to_radians().cos();
            assert!((point.position[0].hypot(point.position[1]) - base_radius).abs() < 1e-9);
        }
    }
    // the tip's rounding and the gear with 24 teeth have none
    for point in line(&job, "fillet_plus", "singular", coordinate(&job, "fillet_plus", "v"), &[0.0, 5.0]) {
        assert_ne!(point.outcome, Outcome::Solved);
    }
}

/// Two motions: a hob with involute flanks leaves an involute helicoid, which turns back on its base cylinder.
#[test]
fn a_hobbed_gear_turns_back_on_its_base_cylinder() {
    let graph = Graph::new();
    let job = job(&graph, "specs/hobbing/helical_gear.chain", &[("teeth", "9"), ("shift", "0 mm")]);
    let (helix, reference) = (22f64.to_radians(), 13.5 / 22f64.to_radians().cos());
    let base_radius = reference * (20f64.to_radians().tan() / helix.cos()).atan().cos();
    for name in ["lower_flank", "upper_flank"] {
        for point in line(&job, name, "singular", coordinate(&job, name, "z"), &[-10.0, -2.0, 0.0, 6.0]) {
            assert_eq!(point.outcome, Outcome::Solved);
            assert!((point.position[0].hypot(point.position[1]) - base_radius).abs() < 1e-9, "{point:?}");
        }
    }
}

/// The least profile shift without undercut: the singular point is where the rack's straight flank ends. The machine's
/// shift is one more unknown.
fn least_shift(set: &[(&str, &str)]) -> f64 {
    let graph = Graph::new();
    let job = job(&graph, SPUR, set);
    let generated = surface(&job, "flank_plus");
    let parameter = |name: &str| job.parameters.iter().find(|p| p.name == name).expect("a parameter");
    let shift = parameter("m.shift").variable;
    let bindings: Vec<_> = job.bindings().into_iter().filter(|(variable, _)| *variable != shift).collect();
    let bound = generated.surface.bound(&bindings);
    let [u, v, _] = bound.unknowns[..] else { panic!("three unknowns") };
    let singular = bound.clearance_minors().pop().expect("a motion");
    let residuals = [bound.constraints[0], singular, u - generated.unknowns[0].high, v];
    let unknowns: Vec<Expr<'_>> = bound.unknowns.iter().copied().chain([shift]).collect();
    let system = System::new(&residuals, &unknowns, &[]).expect("nothing is unbound");
    let ranges: Vec<Range> = generated.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let ranges = [ranges, vec![Range { low: -2.0, high: 2.0 }]].concat();
    let solution = solve(&system, &ranges, &[], &[ranges[0].high, 0.0, 0.0, 0.0]);
    assert_eq!(solution.outcome, Outcome::Solved);
    solution.unknowns[3] / parameter("module").value
}

#[test]
fn the_least_profile_shift_meets_table_and_published_value() {
    let reference = reference_json("spur_rack.json");
    let found = least_shift(&UNDERCUT);
    assert!((found - number(&reference["undercut"], "x_min")).abs() < 1e-9, "{found}");
    // MESYS, online calculator, default case: xEmin printed as -0.0843
    let published = least_shift(&MESYS);
    assert_eq!(format!("{published:.4}"), "-0.0843");
}

/// MESYS, online calculator, default case: the root form diameter is printed as 18.8003. The rack's flank ends where its
/// rounding begins, and both touch there, so fillet and involute meet in the same point.
#[test]
fn the_root_form_diameter_is_the_published_one() {
    let graph = Graph::new();
    let job = job(&graph, SPUR, &MESYS);
    let end = surface(&job, "flank_plus").unknowns[0].high;
    let flank = points(&job, "flank_plus", ["u", "v"], &[[end, 1.0]]);
    let fillet = points(&job, "fillet_plus", ["theta", "v"], &[[20f64.to_radians(), 1.0]]);
    for point in [&flank[0], &fillet[0]] {
        assert_eq!(point.outcome, Outcome::Solved);
        let diameter = 2.0 * point.position[0].hypot(point.position[1]);
        assert_eq!(format!("{diameter:.4}"), "18.8003");
    }
    assert!(difference(&flank[0].position, &fillet[0].position) < 1e-12);
}

/// A plane that turns by t and is fed by a t: its equation of meshing is y = a cos t, so it has contact only where |y| ≤ a.
#[test]
fn the_contact_of_a_turning_plane_ends_at_its_feed() {
    let graph = Graph::new();
    let job = compiled(
        &graph,
        "machine mill {
            axis X : linear
            axis B : rotary
            frame bed
            frame slide in bed = translate_x(X)
            frame head in slide = rotate_z(B)
        }
        tool plate {
            surface face(u: length in -9 mm .. 9 mm, v: length in -5 mm .. 5 mm) {
                at = [0 mm, u, v]
                body towards [-1, 0, 0]
            }
        }
        job groove {
            machine m = mill
            tool p = plate
            mount p on m.head
            motion t : angle in -1 rad .. 1 rad
            drive m.X = 6 mm/rad * t
            drive m.B = t
            surface face in m.bed = envelope(p.face, over: t)
        }",
    );
    let points = line(&job, "face", "contact", coordinate(&job, "face", "z"), &[-4.0, 0.0, 3.0]);
    for point in points {
        assert_eq!(point.outcome, Outcome::Solved);
        assert!((point.unknowns[0] - 6.0).abs() < 1e-12 && point.unknowns[2].abs() < 1e-12, "{point:?}");
    }
    // the meshing of a rack is linear in its rotation: no limit
    let graph = Graph::new();
    let rack = flank_tests::job(&graph, SPUR, &UNDERCUT);
    assert!(
        line(&rack, "flank_plus", "contact", coordinate(&rack, "flank_plus", "v"), &[0.0])
            .iter()
            .all(|point| point.outcome != Outcome::Solved)
    );
}

/// A pinion on a cradle machine with tilt, offset and modified roll, whose teeth are cut under near the root: a point is cut
/// away exactly where it lies on the other side of the singular line.
#[test]
fn a_cradle_pinion_is_cut_under_along_its_root() {
    let graph = Graph::new();
    let job = compiled(&graph, CRADLE_PINION);
    let [along, height] = surface(&job, "flank")
        .sample
        .as_ref()
        .expect("a sample")
        .coordinates
        .each_ref()
        .map(|coordinate| coordinate.value);
    let lengths = [-12.5, -5.0, 0.0, 5.0, 12.5];
    let singular = line(&job, "flank", "singular", along, &lengths);
    for (length, point) in lengths.iter().zip(&singular) {
        assert_eq!(point.outcome, Outcome::Solved, "at {length}: {point:?}");
        let [s, theta, _] = point.unknowns[..] else { panic!("three unknowns") };
        let beside = points(&job, "flank", ["s", "theta"], &[[s + 1e-5, theta], [s - 1e-5, theta]]);
        let outcomes: Vec<Outcome> = beside.iter().map(|point| point.outcome).collect();
        assert_eq!(outcomes, [Outcome::Solved, Outcome::CutAway(CutBy::ItsTool)], "at {length}");
    }
    // all that the sample asks for lies above the line
    let sample = surface(&job, "flank").sample.as_ref().expect("a sample");
    for point in &singular {
        assert!(values(&job, "flank", &[height], &point.unknowns)[0] < 0.5);
    }
    let problem = SurfaceProblem::new(&bound(&job, surface(&job, "flank")), [along, height]);
    let (asked, _) = problem.expect("nothing is unbound").solve(&sample.targets(), sample.counts);
    assert!(asked.iter().all(|point| point.outcome == Outcome::Solved));
}

/// Where a surface meets another one, on lines of two coordinates, and its points at the targets without what that cuts away.
fn trimmed(
    job: &Job<'_>,
    [name, by]: [&str; 2],
    coordinates: [&str; 2],
    targets: &[[f64; 2]],
    counts: [usize; 2],
) -> (Vec<SurfacePoint>, Vec<Meeting>) {
    let [first, second] = [name, by].map(|name| surface(job, name));
    let coordinates = coordinates.map(|coordinate_name| coordinate(job, name, coordinate_name));
    let [first, second] = [first, second].map(|surface| bound(job, surface));
    let problem = SurfaceProblem::new(&first, coordinates);
    let (mut points, _) = problem.expect("nothing is unbound").solve(targets, counts);
    let by = TrimmedBy { surface: &second, number: 0, positions: None };
    let trim = Trim { surface: &first, by: vec![by], tool: None, coordinates };
    let points_of_by = |_, coordinates| SurfaceProblem::new(&second, coordinates).expect("nothing is unbound");
    let meetings = trim.apply(&mut points, (targets, counts), &points_of_by).expect("nothing is unbound");
    (points, meetings.concat().concat())
}

/// The rows of a grid of two coordinates.
fn grid(first: &[f64], second: &[f64]) -> (Vec<[f64; 2]>, [usize; 2]) {
    let targets = first.iter().flat_map(|&a| second.iter().map(move |&b| [a, b])).collect();
    (targets, [first.len(), second.len()])
}

#[test]
fn the_start_of_undercut_meets_the_table() {
    let reference = reference_json("spur_rack.json");
    let start = &reference["undercut"]["start"];
    let graph = Graph::new();
    let job = job(&graph, SPUR, &UNDERCUT);
    let rho: Vec<f64> = (0..20).map(|k| 14.1 + 0.05 * f64::from(k)).collect();
    let (targets, counts) = grid(&rho, &[-2.0, 0.0, 3.0]);
    let (points, meetings) = trimmed(&job, ["flank_plus", "fillet_plus"], ["rho", "z"], &targets, counts);
    assert_eq!(meetings.len(), 3, "one on each line of constant z");
    let meeting = meetings.iter().find(|meeting| meeting.first.position[2].abs() < 1e-12).expect("z = 0");
    assert!(difference(&meeting.first.position, &vector(start, "p")) < 1e-9);
    assert!(difference(&meeting.first.normal, &reversed(vector(start, "n_flank"))) < 1e-9);
    assert!(difference(&meeting.second.normal, &reversed(vector(start, "n_fillet"))) < 1e-9);
    let [x, y, _] = meeting.first.position;
    let found =
        [meeting.first.unknowns[0], meeting.first.unknowns[2], meeting.second.unknowns[0], meeting.second.unknowns[2]];
    let expected = ["u", "phi_flank", "theta", "phi_fillet"].map(|key| number(start, key));
    assert!(difference(&found, &expected) < 1e-9, "{found:?}");
    assert!(difference(&[x.hypot(y), y.atan2(x)], &["rho", "polar_angle"].map(|key| number(start, key))) < 1e-9);
    for (target, point) in targets.iter().zip(&points) {
        let expected =
            if target[0] < number(start, "rho") { Outcome::CutAway(CutBy::Other(0)) } else { Outcome::Solved };
        assert_eq!(point.outcome, expected, "at {target:?}");
    }
    // and the other way round: what of the fillet runs on beyond the flank
    let theta: Vec<f64> = (0..20).map(|k| 0.35 + 0.005 * f64::from(k)).collect();
    let (targets, counts) = grid(&theta, &[-2.0, 0.0, 3.0]);
    let (points, meetings) = trimmed(&job, ["fillet_plus", "flank_plus"], ["theta", "z"], &targets, counts);
    assert_eq!(meetings.len(), 3);
    for (target, point) in targets.iter().zip(&points) {
        let stays = target[0] > number(start, "theta");
        let expected = if stays { Outcome::Solved } else { Outcome::CutAway(CutBy::Other(0)) };
        assert_eq!(point.outcome, expected, "at {target:?}");
    }
}

/// Without undercut flank and fillet touch and do not cross: nothing is cut away.
#[test]
fn surfaces_that_touch_cut_nothing_away() {
    let graph = Graph::new();
    let job = job(&graph, SPUR, &[]);
    let end = surface(&job, "flank_plus").unknowns[0].high;
    let u: Vec<f64> = (0..20).map(|k| -2.0 + (end + 2.0) * f64::from(k) / 19.0).collect();
    let (targets, counts) = grid(&u, &[-2.0, 0.0, 3.0]);
    let (points, meetings) = trimmed(&job, ["flank_plus", "fillet_plus"], ["u", "v"], &targets, counts);
    assert!(meetings.is_empty(), "{meetings:?}");
    assert!(points.iter().all(|point| point.outcome == Outcome::Solved));
}

/// A rack that leans over the gear's axis: its profile shift grows along the face, so the gear is cut under at one end only.
/// Turned by a helix angle it makes an oblique gear.
const LEANING: &str = "
machine planer {
    param lean : angle
    param helix : angle
    axis X : linear
    axis Y : linear
    axis C : rotary
    frame bed
    frame slide in bed = rotate_y(lean) translate(X, Y, 0 mm) rotate_x(helix)
    frame table in bed = rotate_z(C)
}
job taper_gear {
    param module : length = 5 mm
    param shift : length = 1 mm
    param width : length = 15 mm
    let reference_radius = 25 mm
    machine m = planer(lean: LEAN, helix: HELIX)
    tool    r = rack(module: module, half_width: width)
    mount r on m.slide
    motion phi : angle in -60 deg .. 60 deg
    drive m.X = reference_radius + shift
    drive m.Y = reference_radius * phi
    drive m.C = phi
    surface flank  in m.table = envelope(r.flank_plus, over: phi)
    surface fillet in m.table = envelope(r.fillet_plus, over: phi)
}";

/// How deep a point of the work comes to lie inside the rack's tooth, over all of the rack's positions. Nothing but the
/// tooth's outline and the frames' poses: no envelope, no derivative.
fn deepest<'g>(job: &Job<'g>, generated: &GeneratedSurface<'g>, position: [f64; 3]) -> f64 {
    let [m, alpha] = [5.0, 20f64.to_radians()];
    let (height, radius) = (1.25 * m, 0.38 * m);
    let graph = generated.surface.position.0[0].graph();
    let work = Vector3::constant(graph, position);
    let in_rack = graph.substitute(&generated.generation.driven.inverse().point(work).0, &job.bindings());
    let phi = generated.generation.motions[0];
    let tape = Tape::new(&in_rack, &[phi]).expect("nothing is unbound");
    let mut evaluator = ScalarEvaluator::new(&tape);
    let mut deepest = f64::NEG_INFINITY;
    for step in -4000..=4000 {
        let mut at = [0.0; 3];
        evaluator.run(&[f64::from(step) * 2e-4], &mut at);
        let [x, y, _] = at;
        let over_tip = x + height;
        let rounding = radius * (1.0 - alpha.sin());
        let half = if over_tip >= rounding {
            std::f64::consts::PI * m / 4.0 + x * alpha.tan()
        } else {
            let centre = std::f64::consts::PI * m / 4.0 - (height - radius) * alpha.tan() - radius / alpha.cos();
            centre + (radius * radius - (radius - over_tip).powi(2)).max(0.0).sqrt()
        };
        deepest = deepest.max(over_tip.min(half - y.abs()));
    }
    deepest
}

/// A point is called cut away, by its own tool or by the other surface's, exactly if the solid tooth of the rack takes it.
#[test]
fn what_is_cut_away_is_what_the_solid_tool_takes() {
    let rack = std::fs::read_to_string(repository("specs/tools/rack.chain")).expect("the spec is there");
    let rack = rack.lines().filter(|line| !line.starts_with("//!")).collect::<Vec<_>>().join("\n");
    for (lean, helix) in
        [("0 deg", "0 deg"), ("10 deg", "0 deg"), ("-10 deg", "0 deg"), ("0 deg", "25 deg"), ("7 deg", "-15 deg")]
    {
        let graph = Graph::new();
        let job = compiled(&graph, &(rack.clone() + &LEANING.replace("LEAN", lean).replace("HELIX", helix)));
        let of = |name: &str| surface(&job, name).unknowns[0].clone();
        let steps = |low: f64, high: f64, count: u32| -> Vec<f64> {
            (0..count).map(|k| low + (high - low) * (f64::from(k) + 0.5) / f64::from(count)).collect()
        };
        let across = steps(-14.0, 14.0, 7);
        let mut outcomes = [0; 3];
        for (names, own, count) in [(["flank", "fillet"], "u", 23), (["fillet", "flank"], "theta", 31)] {
            let range = of(names[0]);
            let (targets, counts) = grid(&steps(range.low.max(-1.0), range.high, count), &across);
            let (points, _) = trimmed(&job, names, [own, "v"], &targets, counts);
            for (target, point) in targets.iter().zip(&points) {
                let depth = deepest(&job, surface(&job, names[0]), point.position);
                let what = format!(
                    "lean {lean}, helix {helix}, {} at {target:?}: {:?}, depth {depth:e}",
                    names[0], point.outcome
                );
                match point.outcome {
                    Outcome::Solved => assert!(depth < 1e-9, "{what}"),
                    Outcome::CutAway(_) => assert!(depth > 1e-9, "{what}"),
                    _ => panic!("{what}"),
                }
                outcomes[match point.outcome {
                    Outcome::Solved => 0,
                    Outcome::CutAway(CutBy::ItsTool) => 1,
                    _ => 2,
                }] += 1;
            }
        }
        assert!(outcomes.iter().all(|count| *count > 3), "lean {lean}, helix {helix}: {outcomes:?}");
    }
}

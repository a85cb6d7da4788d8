//! Bevel gear machines and tools of the library against each other, closed forms, and chains of dense matrices.

use flank_chain_dsl::{Job, compile_file, compile_text, render};
use flank_expr::Graph;
use flank_solver::{Outcome, SurfacePoint};
use flank_tests::{
    assert_point, difference, job, job_of_text, library, number, points, reference_json, repository, reversed, vector,
};
use nalgebra::{Matrix4, Vector3, Vector4};

/// The points of a surface's sample, all of which must be solved.
fn sampled(job: &Job<'_>, surface: &str) -> Vec<SurfacePoint> {
    let generated = job.surfaces.iter().find(|s| s.name == surface).expect("the surface is in the job");
    let sample = generated.sample.as_ref().expect("it is sampled");
    let names = [0, 1].map(|k| sample.coordinates[k].name.as_str());
    let solved = points(job, surface, names, &sample.targets());
    assert!(solved.iter().all(|point| point.outcome == Outcome::Solved), "{} {surface}", job.name);
    solved
}

/// The thesis's machine, frame by frame another one, leaves what the universal generator leaves with the same settings.
#[test]
fn the_machine_of_the_thesis_leaves_the_same_surface() {
    let machines = library(&["machines/cradle.chain", "machines/cradle_tilt.chain", "tools/face_mill.chain"]);
    let text = machines
        + "job both {
            let ratio = 2.8
            machine u = cradle_generator(
                radial_distance: 68 mm, cradle_angle: -50 deg, cutter_tilt: 3.5 deg, cutter_swivel: 55 deg,
                work_offset: 0.8 mm, sliding_base: 0.3 mm, machine_center_to_crossing_point: -0.4 mm,
                machine_root_angle: 19 deg, ratio_of_roll: ratio, modified_roll_2c: -0.021, helical_motion_1: -1.7 mm
            )
            machine t = cradle_tilt(
                radial_cutter_position: 68 mm, angular_cutter_position: -50 deg, cutter_tilt: 3.5 deg,
                cutter_swivel: -35 deg, vertical_offset: 0.8 mm, machine_center_to_crossing_point: -0.4 mm,
                root_angle: 19 deg
            )
            tool c = face_mill_straight(
                outside_point_radius: 64.6 mm, inside_point_radius: 62.3 mm, edge_radius: 0.9 mm,
                theta_from: 80 deg, theta_to: 200 deg
            )
            tool d = face_mill_straight(
                outside_point_radius: 64.6 mm, inside_point_radius: 62.3 mm, edge_radius: 0.9 mm,
                theta_from: 80 deg, theta_to: 200 deg
            )
            mount c on u.cutter
            mount d on t.cutter
            motion roll : angle in -30 deg .. 30 deg
            drive u.roll = roll
            drive t.roll = roll
            drive t.bed = 0.3 mm - 1.7 mm/rad * roll
            drive t.work = ratio * (roll + 0.021 * roll ^ 2 / 2)
            surface universal in u.work = envelope(c.outside.blade, over: roll)
            surface thesis in t.work = envelope(d.outside.blade, over: roll)
        }";
    let graph = Graph::new();
    let job = job_of_text(&graph, &text);
    let targets: Vec<[f64; 2]> = (0..15)
        .map(|k| [66.0 + 3.0 * f64::from(k % 5), 26.5 + 1.15 * f64::from(k % 5) + 1.5 * f64::from(k / 5)])
        .collect();
    let [universal, thesis] = ["universal", "thesis"].map(|surface| points(&job, surface, ["z", "rho"], &targets));
    for (one, other) in universal.iter().zip(&thesis) {
        assert_point(one, other.position, other.normal, "the thesis's machine");
        assert!(difference(&one.unknowns, &other.unknowns) < 1e-10, "{:?} {:?}", one.unknowns, other.unknowns);
    }
}

/// The right-hand machine shows the left-hand job in the mirror.
#[test]
fn the_mirrored_generator_cuts_the_other_hand() {
    let parts = [
        "functions/bevel.chain",
        "machines/cradle.chain",
        "tools/face_mill.chain",
        "functions/blanks_19x62.chain",
        "bevel/pinion_19x62.chain",
    ];
    let [left, right] = [Graph::new(), Graph::new()];
    let left = job_of_text(&left, &library(&parts));
    let other = library(&parts).replace("machine m = cradle_generator(", "machine m = cradle_generator_mirrored(");
    let right = job_of_text(&right, &other);
    for flank in ["concave", "convex", "root"] {
        for (one, other) in sampled(&left, flank).iter().zip(&sampled(&right, flank)) {
            let mirrored = |[x, y, z]: [f64; 3]| [x, -y, z];
            assert_point(other, mirrored(one.position), mirrored(one.normal), flank);
        }
    }
}

/// On its inclined spindle, the flared cup touches the gear along the line in which the cutter's cone would stand.
#[test]
fn a_flared_cup_grinds_the_formate_gear() {
    let parts = library(&["machines/cradle.chain", "machines/formate.chain", "tools/cup_wheel.chain"]);
    let text = parts
        + "job ground {
            machine m = flared_cup(
                radial_distance: 68.926410763489 mm, cradle_angle: 0.869132768457406 rad, sliding_base: -0.2 mm,
                machine_center_to_crossing_point: 0.5 mm, machine_root_angle: 1.150171977064263 rad,
                point_radius: 64.8 mm, wheel_radius: 40 mm, wheel_inclination: 8 deg
            )
            tool w = cup_wheel(
                outside_radius: 40 mm, inside_radius: 37 mm, outside_angle: 12 deg, inside_angle: 30 deg,
                edge_radius: 0.5 mm, theta_from: -30 deg, theta_to: 30 deg
            )
            mount w on m.wheel
            motion orbit : angle in -160 deg .. -70 deg
            drive m.orbit = orbit
            surface concave in m.work = envelope(w.outside.side, over: orbit)
        }";
    let graph = Graph::new();
    let job = job_of_text(&graph, &text);
    let reference = reference_json("formate_flank.json");
    let rows = reference["concave"].as_array().expect("a table");
    let targets: Vec<[f64; 2]> = rows.iter().map(|row| [number(row, "z"), number(row, "rho")]).collect();
    for (row, point) in rows.iter().zip(points(&job, "concave", ["z", "rho"], &targets)) {
        let half_turned = |[x, y, z]: [f64; 3]| [-x, -y, z];
        assert_point(&point, half_turned(vector(row, "p")), half_turned(reversed(vector(row, "n"))), "ground");
    }
}

/// The universal generator as a product of 4 × 4 matrices, after `universal_generator.md`, for settings that do not move.
struct Dense {
    radial: f64,
    tilt: f64,
    swivel: f64,
    offset: f64,
    base: [f64; 2],
    cradle: f64,
    root: f64,
    ratio: f64,
}

impl Dense {
    fn t_work_cutter(&self, roll: f64) -> Matrix4<f64> {
        let [along, across] = [self.base[0] + self.base[1] * roll, self.offset];
        let shift = |x, y, z| Matrix4::new_translation(&Vector3::new(x, y, z));
        let turn = |axis: Vector3<f64>, angle: f64| Matrix4::from_scaled_axis(axis * angle);
        turn(Vector3::z(), -self.ratio * roll)
            * turn(Vector3::y(), self.root)
            * shift(along, across, 0.0)
            * turn(Vector3::x(), -(self.cradle + roll))
            * shift(0.0, 0.0, self.radial)
            * turn(Vector3::x(), self.swivel)
            * turn(Vector3::z(), self.tilt)
            * turn(Vector3::y(), -std::f64::consts::FRAC_PI_2)
    }

    /// Position, normal out of the steel, and how fast the cutter leaves there: mm per radian along the normal.
    fn point(&self, cone: &Cone, [s, theta, roll]: [f64; 3]) -> ([f64; 3], [f64; 3], f64) {
        let (position, normal) = cone.point(s, theta);
        let step = 1e-5;
        let placed = |roll: f64| (self.t_work_cutter(roll) * position).xyz();
        let normal = (self.t_work_cutter(roll) * normal).xyz();
        let velocity = (placed(roll + step) - placed(roll - step)) / (2.0 * step);
        (placed(roll).into(), normal.into(), normal.dot(&velocity))
    }
}

impl Dense {
    /// How far a point of the work is from the blade's cone, mm, positive outside its steel.
    fn clearance(&self, cone: &Cone, [x, y, z]: [f64; 3], roll: f64) -> f64 {
        let turned = self.t_work_cutter(roll).try_inverse().expect("a rigid motion") * Vector4::new(x, y, z, 1.0);
        let (sine, cosine) = cone.blade_angle.sin_cos();
        let apart = cone.side * (turned.x.hypot(turned.y) - cone.point_radius);
        apart * cosine + turned.z * sine
    }
}

/// A straight blade with a rounded edge: side +1 outside, −1 inside.
struct Cone {
    side: f64,
    point_radius: f64,
    blade_angle: f64,
    edge_radius: f64,
}

impl Cone {
    /// `s` counts from the tip over the rounding.
    fn point(&self, s: f64, theta: f64) -> (Vector4<f64>, Vector4<f64>) {
        let (sine, cosine) = self.blade_angle.sin_cos();
        let rounding = self.edge_radius * (std::f64::consts::FRAC_PI_2 - self.blade_angle);
        let height = self.edge_radius * (1.0 - sine) + (s - rounding) * cosine;
        let radius = self.point_radius + self.side * height * sine / cosine;
        let around = |radius: f64, z: f64, w: f64| Vector4::new(radius * theta.cos(), radius * theta.sin(), z, w);
        (around(radius, -height, 1.0), around(self.side * cosine, sine, 0.0))
    }
}

fn meets_matrices((spec, set): (&str, &[(&str, &str)]), surface: &str, dense: &Dense, cone: &Cone) {
    let graph = Graph::new();
    let job = job(&graph, spec, set);
    for point in sampled(&job, surface) {
        let [s, theta, roll] = point.unknowns[..] else { panic!("three unknowns") };
        let (position, normal, leaving) = dense.point(cone, [s, theta, roll]);
        assert_point(&point, position, reversed(normal), &format!("{spec}, {surface}"));
        // central differences of a chain of 100 mm at a step of 1e-5 are good to 1e-8 mm
        assert!(leaving.abs() < 1e-7, "{spec}, {surface}: {leaving:e} mm per radian");
    }
}

/// A hypoid pinion with an offset of 25 mm and a tilt of 17.5 degrees.
#[test]
fn a_hypoid_pinion_meets_dense_matrices() {
    let dense = |ratio| Dense {
        radial: 86.8455,
        tilt: 17.5f64.to_radians(),
        swivel: 17.8243f64.to_radians(),
        offset: -25.0,
        base: [-3.7839, 0.0],
        cradle: 72.1418f64.to_radians(),
        root: 8f64.to_radians(),
        ratio,
    };
    let cone = |side| Cone { side, point_radius: 76.2, blade_angle: 20f64.to_radians(), edge_radius: 0.8 };
    let spec = ("specs/bevel/hypoid_pinion.chain", &[("n.index", "0 deg")][..]);
    meets_matrices(spec, "concave", &dense(3.4243721), &cone(1.0));
    meets_matrices(spec, "convex", &dense(2.7751093), &cone(-1.0));
}

/// Hypoid settings that nobody made for each other: tilts to 30 degrees and offsets to 40 mm, both signs, both flanks, both hands.
/// Points are found by blade and roll, and checked against the matrices and against the blade on its whole way: it comes to within a
/// step of each point that is solved, and never nearer; through those that are cut away it goes.
#[test]
fn hypoid_settings_of_all_kinds_meet_dense_matrices() {
    const ROLL: f64 = 0.35;
    let machines = library(&["machines/cradle.chain", "tools/face_mill.chain"]);
    let (mut solved, mut cut) = (0, 0);
    for (tilt, swivel, offset, base, root, ratio) in [
        (20.0, 17.8, -25.0, -3.8, 8.0, 3.42),
        (20.0, 40.0, -40.0, -6.0, 5.0, 2.9),
        (25.0, -30.0, -30.0, 2.0, 10.0, 3.1),
        (30.0, 100.0, -35.0, -2.0, 15.0, 2.4),
        (-20.0, 17.8, -20.0, 4.0, 20.0, 2.775),
        (16.0, 200.0, 40.0, -1.5, 12.0, 3.9),
        (22.0, -75.0, 30.0, 0.0, 0.0, 4.6),
        (17.5, 17.8, 25.0, -3.8, -8.0, 3.42),
        (0.0, 0.0, -40.0, 0.0, 18.0, 3.2),
        (28.0, 140.0, 0.0, -8.0, 25.0, 2.1),
        (18.0, 60.0, -20.0, 1.0, 70.0, 1.06),
        (21.0, -140.0, 36.0, 3.0, 45.0, 1.4),
    ] {
        let radians = |degrees: f64| degrees.to_radians();
        let dense = Dense {
            radial: 86.8,
            tilt: radians(tilt),
            swivel: radians(swivel),
            offset,
            base: [base, 1.5],
            cradle: radians(72.0),
            root: radians(root),
            ratio,
        };
        let hands = [("cradle_generator", 1.0), ("cradle_generator_mirrored", -1.0)];
        for ((machine, hand), from) in hands.into_iter().flat_map(|hand| [(hand, -180.0), (hand, 0.0)]) {
            let text = format!(
                "{machines} job hypoid {{
                    machine m = {machine}(
                        radial_distance: 86.8 mm, cradle_angle: 72 deg, cutter_tilt: {tilt} deg, cutter_swivel: {swivel} deg,
                        work_offset: {offset} mm, sliding_base: {base} mm, machine_root_angle: {root} deg,
                        ratio_of_roll: {ratio}, helical_motion_1: 1.5 mm
                    )
                    tool c = face_mill_straight(
                        outside_point_radius: 76.2 mm, inside_point_radius: 74.6 mm, edge_radius: 0.8 mm,
                        theta_from: {from} deg, theta_to: {from} deg + 180 deg
                    )
                    mount c on m.cutter
                    motion roll : angle in -{ROLL} rad .. {ROLL} rad
                    drive m.roll = roll
                    surface concave in m.work = envelope(c.outside.blade, over: roll)
                    surface convex in m.work = envelope(c.inside.blade, over: roll)
                }}"
            );
            let graph = Graph::new();
            let job = job_of_text(&graph, &text);
            for (surface, side, point_radius) in [("concave", 1.0, 76.2), ("convex", -1.0, 74.6)] {
                let cone = Cone { side, point_radius, blade_angle: radians(20.0), edge_radius: 0.8 };
                let targets: Vec<[f64; 2]> =
                    (0..15).map(|k| [1.5 + 2.0 * f64::from(k % 5), 0.1 * f64::from(k / 5 - 1)]).collect();
                let all = points(&job, surface, ["s", "roll"], &targets);
                for point in all.iter().filter(|point| matches!(point.outcome, Outcome::Solved | Outcome::CutAway(_))) {
                    let [s, theta, roll] = point.unknowns[..] else { panic!("three unknowns") };
                    let (position, normal, leaving) = dense.point(&cone, [s, theta, roll]);
                    let (mirrored, out) = (|[x, y, z]: [f64; 3]| [x, hand * y, z], reversed(normal));
                    let what = format!("{machine}, {surface}, tilt {tilt}, offset {offset} at {s}, {roll}");
                    assert!(difference(&point.position, &mirrored(position)) < 1e-9, "{what}");
                    assert!(difference(&point.normal, &mirrored(out)) < 1e-9, "{what}");
                    assert!(leaving.abs() < 1e-7, "{what}: {leaving:e} mm per radian");
                    // how near the blade comes, at rolls close by: what the second order says
                    let near = (-40..=40).map(|step| roll + 2.5e-5 * f64::from(step));
                    let least = near.map(|roll| dense.clearance(&cone, position, roll)).fold(f64::INFINITY, f64::min);
                    match point.outcome {
                        Outcome::Solved => {
                            solved += 1;
                            assert!(least > -1e-9, "{what}: {least:e} mm in the steel of the blade");
                        }
                        _ => {
                            cut += 1;
                            assert!(least < -1e-9, "{what}: nothing cuts it, {least:e} mm");
                        }
                    }
                }
            }
        }
    }
    assert!(solved > 500 && cut > 20, "{solved} solved, {cut} cut away");
}

/// Both flanks of one cut with helical motion.
#[test]
fn a_duplex_helical_pinion_meets_dense_matrices() {
    let dense = Dense {
        radial: 97.959,
        tilt: 0.0,
        swivel: 0.0,
        offset: 0.0,
        base: [-1.5, -5.5],
        cradle: (-52.797f64).to_radians(),
        root: 16.4f64.to_radians(),
        ratio: 3.3397,
    };
    let cone = |side, point_radius| Cone { side, point_radius, blade_angle: 20f64.to_radians(), edge_radius: 0.2 };
    let spec = ("specs/bevel/duplex_helical_pinion.chain", &[][..]);
    meets_matrices(spec, "concave", &dense, &cone(1.0, 95.95));
    meets_matrices(spec, "convex", &dense, &cone(-1.0, 94.55));
}

/// A cutter with a toprem and a flankrem, as a statement of a job.
const RELIEVED: &str = "
    tool r = face_mill_relieved(
        outside_point_radius: 76 mm, inside_point_radius: 74 mm, blade_angle: 20 deg, toprem_angle: 15 deg,
        toprem_height: 1.5 mm, flankrem_angle: 26 deg, flankrem_height: 6 mm, edge_radius: 0.4 mm
    )
    mount r on m.cutter
";

/// Neighbouring segments of a blade's profile share their point; edge and blade touch without a kink, also for a parabola.
#[test]
fn roundings_touch_the_blades() {
    let text = library(&["tools/face_mill.chain", "tools/face_mill_profiles.chain"])
        + "machine stand { frame bed  frame cutter in bed = translate_z(0 mm) }
        job show {
            machine m = stand
            RELIEVED
            tool p = face_mill_parabolic(
                outside_point_radius: 76 mm, inside_point_radius: 74 mm, blade_angle: 20 deg, vertex_height: 4 mm,
                parabola: 0.003 / 1 mm, edge_radius: 0.7 mm
            )
            mount p on m.cutter
            surface outside in m.bed = move(r.outside)
            surface inside in m.bed = move(r.inside)
            surface parabola_outside in m.bed = move(p.outside_blade)
            surface parabola_inside in m.bed = move(p.inside_blade)
            surface edge_outside in m.bed = move(p.outside_edge)
            surface edge_inside in m.bed = move(p.inside_edge)
        }";
    let graph = Graph::new();
    let job = job_of_text(&graph, &text.replace("RELIEVED", RELIEVED));
    let end = |surface: &str, high: bool| {
        let unknowns = &job.surfaces.iter().find(|s| s.name == surface).expect("a surface").unknowns;
        let at = if high { unknowns[0].high } else { unknowns[0].low };
        points(&job, surface, [unknowns[0].name.as_str(), "theta"], &[[at, 0.3]]).remove(0)
    };
    for side in ["outside", "inside"] {
        let [edge, toprem] = ["edge", "toprem"].map(|piece| format!("{side}.{piece}"));
        let (one, next) = (end(&edge, true), end(&toprem, false));
        assert_point(&next, one.position, one.normal, "toprem");
        let (blade, edge) = (end(&format!("parabola_{side}"), false), end(&format!("edge_{side}"), false));
        assert_point(&edge, blade.position, blade.normal, "parabola");
        let tip = end(&format!("edge_{side}"), true);
        assert!(tip.position[2].abs() < 1e-12 && (tip.normal[2] - 1.0).abs() < 1e-12, "{tip:?}");
    }
}

/// Blades of the relieved cutter: heights and radii where the pieces begin, from the angles alone.
#[test]
fn relieved_blades_have_their_angles() {
    let graph = Graph::new();
    let text = library(&["tools/face_mill.chain", "tools/face_mill_profiles.chain"])
        + "machine stand { frame bed  frame cutter in bed = translate_z(0 mm) }
            job show {
                machine m = stand
            RELIEVED
                surface outside in m.bed = move(r.outside)
                surface inside in m.bed = move(r.inside)
            }";
    let job = job_of_text(&graph, &text.replace("RELIEVED", RELIEVED));
    for (surface, side, point_radius) in [("outside", 1.0, 76.0), ("inside", -1.0, 74.0)] {
        let tangents = [("toprem", 15f64, 1.0), ("blade", 20.0, 3.0), ("flankrem", 26.0, 8.0)];
        for (piece, angle, height) in tangents {
            let name = format!("{surface}.{piece}");
            let point = points(&job, &name, ["z", "theta"], &[[-height, 0.0]]).remove(0);
            let tan = |degrees: f64| degrees.to_radians().tan();
            let radius = point_radius
                + side
                    * match piece {
                        "toprem" => 1.5 * tan(20.0) + (height - 1.5) * tan(angle),
                        "flankrem" => 6.0 * tan(20.0) + (height - 6.0) * tan(angle),
                        _ => height * tan(angle),
                    };
            let (sine, cosine) = angle.to_radians().sin_cos();
            assert_point(&point, [radius, 0.0, -height], [side * cosine, 0.0, sine], &name);
        }
    }
}

/// Basic settings of the 19 x 62 pair as its machine sheets print them, from the blank alone: those of the gear in the designed pair, those
/// of the pinion by the functions.
#[test]
fn settings_follow_from_the_blank() {
    let graph = Graph::new();
    let pair = job(&graph, "specs/bevel/pair_from_blank.chain", &[]);
    let graph = Graph::new();
    let basic = job_of_text(
        &graph,
        &(library(&["functions/bevel.chain", "machines/cradle.chain", "tools/face_mill.chain"])
            + "job basic {
                let pitch_angle = pitch_angle_of(19, 62, 95 deg)
                let outer = outer_cone_distance_of(4.169 mm, 19, pitch_angle)
                let mean = outer - 36.83 mm / 2
                let dedendum = mean_normal_module_of(4.169 mm, outer, mean, 35 deg) * 1.2
                let dedendum_angle = dedendum_angle_of(dedendum, mean)
                machine p = cradle_generator(
                    radial_distance: basic_radial_distance(mean, dedendum_angle, 35 deg, 95.25 mm),
                    cradle_angle: -basic_cradle_angle(mean, dedendum_angle, 35 deg, 95.25 mm),
                    machine_root_angle: pitch_angle - dedendum_angle,
                    ratio_of_roll: basic_ratio_of_roll(pitch_angle, dedendum_angle)
                )
                tool c = face_mill_straight(
                    outside_point_radius: 96 mm, inside_point_radius: 94 mm, edge_radius: 0.2 mm
                )
                mount c on p.cutter
                motion roll : angle in -40 deg .. 40 deg
                drive p.roll = roll
                surface concave in p.work = envelope(c.outside.blade, over: roll)
            }"),
    );
    for (of, name, printed) in [
        (&basic, "p.radial_distance", 97.95940290780507),
        (&basic, "p.cradle_angle", -52.79674678267486f64.to_radians()),
        (&basic, "p.machine_root_angle", 15.64096727073747f64.to_radians()),
        (&basic, "p.ratio_of_roll", 3.339685914944047),
        (&pair, "p.machine_root_angle", 15.64096727073747f64.to_radians()),
        (&pair, "g.radial_distance", 97.95367814746567),
        (&pair, "g.cradle_angle", 52.801158062429394f64.to_radians()),
        (&pair, "g.machine_root_angle", 75.6638280957449f64.to_radians()),
        (&pair, "g.ratio_of_roll", 1.023367028989512),
    ] {
        let value = of.parameters.iter().find(|p| p.name == name).expect("a setting").value;
        assert!((value - printed).abs() < 1e-12 * printed.abs(), "{name}: {value} {printed}");
    }
    for flank in ["pinion_concave", "pinion_convex", "gear_concave", "gear_convex"] {
        sampled(&pair, flank);
    }
}

/// Gear and pinion are cut in root planes that are tilted against each other by both dedendum angles: where the gear's blades have one
/// pressure angle, those of the pinion differ from it by the cutter-number correction, (theta_f1 + theta_f2) sin beta, to second order.
#[test]
fn blades_of_the_pinion_are_corrected_for_both_root_planes() {
    let graph = Graph::new();
    let pair = job(&graph, "specs/bevel/pair_from_blank.chain", &[]);
    let value = |name: &str| pair.parameters.iter().find(|p| p.name == name).expect("a setting").value;
    let root_angles = value("p.machine_root_angle") + value("g.machine_root_angle");
    let correction = (value("shaft_angle") - root_angles) * value("spiral_angle").sin();
    let [outside, inside] = ["c.blade_angle", "e.blade_angle"].map(|name| value(name) - value("d.blade_angle"));
    for (found, wanted) in [(outside, -correction), (inside, correction)] {
        assert!((found - wanted).abs() < 0.1_f64.to_radians(), "{found} {wanted}");
    }
}

/// A parabola on which Newton's steps towards the place of the rounding do not end is refused, not taken as it is.
#[test]
fn a_parabola_without_a_place_for_the_rounding_is_told() {
    let text = library(&["tools/face_mill.chain", "tools/face_mill_profiles.chain"])
        + "machine stand { frame bed  frame cutter in bed = translate_z(0 mm) }
        job show {
            machine m = stand
            tool p = face_mill_parabolic(
                outside_point_radius: 76 mm, inside_point_radius: 74 mm, blade_angle: 45 deg, vertex_height: 8 mm,
                parabola: PARABOLA / 1 mm, edge_radius: 0.2 mm
            )
            mount p on m.cutter
            surface outside in m.bed = move(p.outside_blade)
        }";
    for (parabola, is_right) in [("0.01", true), ("0.1", false), ("-0.02", true)] {
        let graph = Graph::new();
        let compilation = compile_text(&graph, "text", &text.replace("PARABOLA", parabola), &[]);
        let told = render(&compilation.diagnostics, &compilation.sources, false);
        assert_eq!(compilation.has_errors(), !is_right, "{parabola}: {told}");
        assert_eq!(told.contains("the rounding of the edge finds no place"), !is_right, "{parabola}: {told}");
    }
}

/// What a wrong setting is told, in the words of the trade.
#[test]
fn wrong_settings_are_told_in_the_words_of_the_trade() {
    for (spec, name, value, wanted) in [
        ("pinion_19x62", "c.blade_angle", "-20 deg", "positive for inside and outside blades"),
        ("thesis_gear", "c.blade_angle", "-20 deg", "positive for inside and outside blades"),
        ("face_hobbed_pinion", "d.blade_angle", "-20 deg", "the head's other blade"),
        ("formate_gear", "m.ratio_of_roll", "1.02", "is not generated"),
        ("helixform_gear", "m.ratio_of_roll", "1.02", "is not generated"),
        ("pair_from_blank", "face_width", "80 mm", "the teeth vanish at the toe"),
        ("pair_from_blank", "shaft_angle", "120 deg", "the gear would be an internal one"),
        ("pair_from_blank", "dedendum_factor", "2.3", "meet before its tips"),
        ("pair_from_blank", "pinion_hand", "0", "+1 (right) or -1 (left)"),
        ("pair_from_blank", "lengthwise_crowning", "3 mm", "no cutter is so flat"),
    ] {
        let set = vec![(name.to_string(), value.to_string())];
        let graph = Graph::new();
        let compilation = compile_file(&graph, &repository(&format!("specs/bevel/{spec}.chain")), &set);
        let told = render(&compilation.diagnostics, &compilation.sources, false);
        assert!(compilation.has_errors() && told.contains(wanted), "{spec} with {name}: {told}");
    }
}

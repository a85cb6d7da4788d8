//! Sweeps, moves and mirrors against closed forms and against the same surface made another way.

use flank_expr::Graph;
use flank_tests::{assert_point, job_of_text, library, number, points, reference_json, reversed, vector};

/// A radial edge that advances while the work turns leaves a helicoid: (u cos t, −u sin t, p t).
#[test]
fn a_radial_edge_cuts_a_helicoid() {
    let graph = Graph::new();
    let job = job_of_text(
        &graph,
        "machine lathe {
            axis Z : linear
            axis C : rotary
            frame bed
            frame slide in bed = translate_z(Z)
            frame work in bed = rotate_z(C)
        }
        tool bit {
            /// The steel lies above the edge.
            surface lip(u: length in 5 mm .. 20 mm) { at = [u, 0 mm, 0 mm]  body towards [0, 0, 1] }
        }
        job thread {
            machine m = lathe
            tool b = bit
            mount b on m.slide
            motion turn : angle in -400 deg .. 400 deg
            drive m.C = turn
            drive m.Z = 3 mm/rad * turn
            surface face in m.work = sweep(b.lip, over: turn)
        }",
    );
    let p = 3.0;
    let targets: Vec<[f64; 2]> = (0..20).map(|k| [6.0 + 0.6 * f64::from(k), -1.5 + 0.4 * f64::from(k % 7)]).collect();
    for (target, point) in targets.iter().zip(points(&job, "face", ["u", "turn"], &targets)) {
        let [u, t] = *target;
        let position = [u * t.cos(), -u * t.sin(), p * t];
        // square to (cos t, −sin t, 0) and (−u sin t, −u cos t, p), out of the work, which lies below
        let size = p.hypot(u);
        let normal = [p * t.sin() / size, p * t.cos() / size, u / size];
        assert_point(&point, position, normal, &format!("u {u}, turn {t}"));
    }
}

/// A half circle that spins about its diameter is a sphere; fed along a line, its envelope is a cylinder.
#[test]
fn a_spinning_edge_fed_along_a_line_leaves_a_cylinder() {
    let graph = Graph::new();
    let job = job_of_text(
        &graph,
        "machine mill {
            axis X : linear
            axis S : rotary
            frame bed
            frame slide in bed = translate_x(X)
            frame spindle in slide = rotate_z(S)
        }
        tool ball {
            param radius : length = 8 mm
            surface lip(u: angle in -60 deg .. 60 deg) {
                at = [radius * cos(u), 0 mm, radius * sin(u)]
                body towards [-cos(u), 0, -sin(u)]
            }
        }
        job slot {
            machine m = mill
            tool b = ball
            mount b on m.spindle
            motion spin : angle in -170 deg .. 170 deg
            motion feed : length in -50 mm .. 50 mm
            drive m.S = spin
            drive m.X = feed
            surface bottom in m.bed = sweep(b.lip, over: [spin, feed])
        }",
    );
    let targets: Vec<[f64; 2]> = (0..20).map(|k| [-6.0 + 0.6 * f64::from(k), -30.0 + 3.0 * f64::from(k)]).collect();
    for (target, point) in targets.iter().zip(points(&job, "bottom", ["z", "x"], &targets)) {
        let [z, x] = *target;
        let y = (64.0 - z * z).sqrt() * point.position[1].signum();
        assert_point(&point, [x, y, z], [0.0, -y / 8.0, -z / 8.0], &format!("z {z}, x {x}"));
    }
}

/// `move` shows the tool itself from another frame.
#[test]
fn a_moved_surface_is_the_tool_seen_from_elsewhere() {
    let graph = Graph::new();
    let job = job_of_text(
        &graph,
        "machine stand {
            frame bed
            frame arm in bed = translate(1 mm, 2 mm, 3 mm) rotate_x(90 deg)
        }
        tool plate {
            surface face(u: length in -5 mm .. 5 mm, v: length in -5 mm .. 5 mm) {
                at = [u, v, 0 mm]
                body towards [0, 0, -1]
            }
        }
        job show {
            machine m = stand
            tool p = plate
            mount p on m.arm
            surface face in m.bed = move(p.face)
        }",
    );
    for point in points(&job, "face", ["u", "v"], &[[1.0, 2.0], [-3.0, 4.0]]) {
        let (u, v) = (point.unknowns[0], point.unknowns[1]);
        // x stays, y of the arm is z of the bed, z of the arm is −y of the bed
        assert_point(&point, [1.0 + u, 2.0, 3.0 + v], [0.0, -1.0, 0.0], "moved");
    }
}

/// The mirror image of the right-hand gear of the reference table is the left-hand one, point by point.
#[test]
fn a_mirrored_work_is_the_other_hand() {
    let text = library(&[
        "machines/hobbing_6axis.chain",
        "tools/involute.chain",
        "tools/hob_zi.chain",
        "functions/hobbing.chain",
        "hobbing/helical_gear.chain",
    ])
    .replace("machine m = hobbing_6axis", "machine m = left")
        + "machine left extends hobbing_6axis { frame table in bed = rotate_z(C) mirror_z() }";
    let graph = Graph::new();
    let job = job_of_text(&graph, &text);
    let reference = reference_json("helical_zi_hob.json");
    let mirrored = |[x, y, z]: [f64; 3]| [x, y, -z];
    for (surface, sigma) in [("lower_flank", 1.0), ("upper_flank", -1.0)] {
        let rows = reference["rows"].as_array().expect("a table").iter().filter(|row| number(row, "sigma") == sigma);
        let rows: Vec<_> = rows.collect();
        let targets: Vec<[f64; 2]> = rows.iter().map(|row| [-number(row, "z"), number(row, "rho")]).collect();
        for (row, point) in rows.iter().zip(points(&job, surface, ["z", "rho"], &targets)) {
            assert_point(&point, mirrored(vector(row, "p")), mirrored(reversed(vector(row, "n"))), surface);
        }
    }
}

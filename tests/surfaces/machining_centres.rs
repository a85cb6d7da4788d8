//! Five-axis machining centres: a tilting rotary table against LinuxCNC's published kinematics, and postures of the others back
//! from the poses that they make.

use std::f64::consts::PI;

use flank_chain_dsl::Job;
use flank_expr::geometry::{Axis, Chain, Step, Vector3};
use flank_expr::{Expr, Graph, ScalarEvaluator, Tape};
use flank_solver::{Outcome, PoseProblem, Posture, Range, Screw, TargetAxis};
use flank_tests::conversion::target_axes;
use flank_tests::machines::beside;
use flank_tests::{Dice, reference_csv};

/// A tool turns about its own axis without the work's seeing it.
const SPINDLE: [Screw; 1] = [Screw { angular: [0.0, 0.0, 1.0], linear: [0.0; 3] }];

/// A machine by itself; some job stands beside it.
fn machine<'g>(graph: &'g Graph, name: &str, settings: &[(&str, String)]) -> Job<'g> {
    let set: Vec<(String, String)> =
        settings.iter().map(|(setting, value)| (format!("{name}.{setting}"), value.clone())).collect();
    let files = ["specs/bevel/pinion_19x62.chain", &format!("specs/machines/{name}.chain")];
    beside(graph, files, &set).1
}

/// From work to tool, with numbers for the settings.
fn chain<'g>(graph: &'g Graph, machine: &Job<'g>) -> Chain<'g> {
    machine.machines[0].chain(graph, "work", "tip").expect("both frames").substituted(&machine.bindings())
}

/// The tool's tip at a point of the work and turned as a table with these angles has it: five motions.
fn asked<'g>(graph: &'g Graph) -> (Chain<'g>, Vec<Expr<'g>>) {
    let motions: Vec<Expr<'g>> =
        ["x", "y", "z", "a", "c"].iter().map(|name| graph.variable(format!("asked {name}"))).collect();
    let steps = vec![
        Step::Translate(Vector3([motions[0], motions[1], motions[2]])),
        Step::Rotate(Axis::Z, -motions[4]),
        Step::Rotate(Axis::X, -motions[3]),
    ];
    (Chain::new(graph, steps), motions)
}

/// The same with only one of two elbows within the travel of the tilting axis, the fourth.
fn on_one_elbow<'g>(axes: &[TargetAxis<'g>], tilt: f64) -> Vec<TargetAxis<'g>> {
    let mut axes = axes.to_vec();
    axes[3].travel = Some(Range { low: tilt.min(0.0) * 1.2, high: tilt.max(0.0) * 1.2 });
    axes
}

/// Differences of two angles by whole turns do not count.
fn apart(a: f64, b: f64) -> f64 {
    let off = (a - b).rem_euclid(2.0 * PI);
    off.min(2.0 * PI - off)
}

/// A row of the table: the settings of the machine, the point of the work, A and C as the table turns, the joints.
struct Row {
    settings: Vec<(&'static str, String)>,
    at: [f64; 3],
    angles: [f64; 2],
    joints: [f64; 3],
}

/// Work coordinates of LinuxCNC are the machine's while A and C stand at zero; its conventional directions count the turns of the
/// tool.
fn rows() -> Vec<Row> {
    let row = |r: &flank_tests::Row| {
        let mm = |name: &str, sign: f64| format!("{} mm", sign * r.get(name));
        let conventional = r.get("con") > 0.0;
        let turned = if conventional { -1.0 } else { 1.0 };
        Row {
            settings: vec![
                ("rotation_point_x", mm("xr", 1.0)),
                ("rotation_point_y", mm("yr", 1.0)),
                ("rotation_point_z", mm("zr", 1.0)),
                ("offset_y", mm("dy", 1.0)),
                ("offset_z", mm("dz", 1.0)),
                ("work_x", mm("xr", -1.0)),
                ("work_y", mm("yr", -1.0)),
                ("work_z", mm("zr", -1.0)),
                ("counts_tool_turns", u8::from(conventional).to_string()),
            ],
            at: ["x", "y", "z"].map(|name| r.get(name)),
            angles: ["A_deg", "C_deg"].map(|name| turned * r.get(name).to_radians()),
            joints: ["JX", "JY", "JZ"].map(|name| r.get(name)),
        }
    };
    reference_csv("linuxcnc_xyzac_trt.csv").iter().map(row).collect()
}

#[test]
fn the_tilting_table_meets_linuxcnc_forward() {
    let rows = rows();
    assert_eq!(rows.len(), 30);
    for Row { settings, at, angles, joints } in rows {
        let graph = Graph::new();
        let machine = machine(&graph, "five_axis_table_table", &settings);
        let axes: Vec<Expr<'_>> = machine.machines[0].axes.iter().map(|axis| axis.variable).collect();
        let pose = chain(&graph, &machine).pose();
        let mut tip = [0.0; 3];
        let stands: Vec<f64> = joints.into_iter().chain(angles).collect();
        ScalarEvaluator::new(&Tape::new(&pose.translation.0, &axes).expect("all bound")).run(&stands, &mut tip);
        for (found, expected) in tip.into_iter().zip(at) {
            assert!((found - expected).abs() < 1e-9, "{tip:?} instead of {at:?}");
        }
    }
}

#[test]
fn the_tilting_table_meets_linuxcnc_backward() {
    let mut told_by_the_pose = 0;
    for Row { settings, at, angles, joints } in rows() {
        let graph = Graph::new();
        let machine = machine(&graph, "five_axis_table_table", &settings);
        let (source, motions) = asked(&graph);
        let axes = target_axes(&machine);
        let target = chain(&graph, &machine);
        let motion: Vec<f64> = at.into_iter().chain(angles).collect();
        let meets = |posture: &Posture| {
            let linear = posture.axes.iter().zip(joints).all(|(x, expected)| (x - expected).abs() < 1e-9);
            let turned = posture.axes.iter().skip(3).zip(angles).all(|(x, expected)| apart(*x, expected) < 1e-9);
            posture.outcome == Outcome::Solved && posture.missing.is_none() && linear && turned
        };
        // A and C given: what is asked for is where X, Y and Z stand
        let given = [(axes[3].variable, motions[3]), (axes[4].variable, motions[4])];
        let problem = PoseProblem::new(&target.substituted(&given), &axes[..3], &source, &motions, &SPINDLE, 1000.0)
            .expect("three axes");
        let found = problem.postures(&motion);
        assert!(found.len() == 1 && meets(&found[0]), "{found:?} instead of {joints:?}");
        // all five: where A stands at zero the tool stands along the axis of C, and the pose does not tell how far that is turned
        if angles[0] != 0.0 {
            told_by_the_pose += 1;
            let problem =
                PoseProblem::new(&target, &on_one_elbow(&axes, angles[0]), &source, &motions, &SPINDLE, 1000.0)
                    .expect("five axes");
            let found = problem.postures(&motion);
            assert!(found.iter().any(meets), "{found:?} instead of {joints:?}, {angles:?}");
        }
    }
    assert_eq!(told_by_the_pose, 18);
}

/// Poses that each of the machines makes lead back to the axes that made them: other offsets and lengths than by default.
#[test]
fn machining_centres_find_their_own_postures() {
    let mm = |x: f64| format!("{x} mm");
    let machines = [
        ("five_axis_table_table", vec![("offset_y", mm(-35.0)), ("offset_z", mm(52.0)), ("work_z", mm(80.0))]),
        ("five_axis_head_table", vec![("pivot_length", mm(310.0)), ("spindle_offset", mm(42.0))]),
        ("five_axis_head_head", vec![("fork_offset", mm(-65.0)), ("spindle_offset", mm(12.0))]),
    ];
    for (name, settings) in machines {
        let graph = Graph::new();
        let machine = machine(&graph, name, &settings);
        let axes = on_one_elbow(&target_axes(&machine), 1.8);
        let variables: Vec<Expr<'_>> = axes.iter().map(|axis| axis.variable).collect();
        // the same machine, moved: its axes under other names
        let motions: Vec<Expr<'_>> = (0..5).map(|k| graph.variable(format!("made {k}"))).collect();
        let moved: Vec<(Expr<'_>, Expr<'_>)> = variables.iter().copied().zip(motions.iter().copied()).collect();
        let target = chain(&graph, &machine);
        let problem = PoseProblem::new(&target, &axes, &target.substituted(&moved), &motions, &SPINDLE, 1000.0)
            .expect("five axes");
        let mut dice = Dice(5);
        for _ in 0..20 {
            let made: Vec<f64> = (0..5)
                .map(|k| match k {
                    0..3 => dice.roll(400) as f64 - 200.0,
                    3 => 0.2 + 0.01 * dice.roll(160) as f64,
                    _ => 0.01 * dice.roll(600) as f64 - 3.0,
                })
                .collect();
            let found = problem.postures(&made);
            let meets = |posture: &Posture| {
                let off =
                    |k: usize| if k < 3 { (posture.axes[k] - made[k]).abs() } else { apart(posture.axes[k], made[k]) };
                posture.outcome == Outcome::Solved && (0..5).all(|k| off(k) < 1e-9)
            };
            assert!(found.iter().any(meets), "{name}: {found:?} instead of {made:?}");
        }
    }
}

//! Machines that nobody designed: random chains of frames, random laws, three tools. What is solved is checked against 4 × 4
//! matrices multiplied by another library and against finite differences, which know nothing of twists or meshing.

use std::fmt::Write;

use flank_chain_dsl::{compile_text, render};
use flank_expr::Graph;
use flank_solver::Outcome;
use flank_tests::{Dice, points, problem};
use nalgebra::{Matrix4, Point3, Rotation3, Translation3, Vector3};

/// A step of the chain from work to tool: a rotation about or a translation along one of the axes x, y, z, by
/// `a + b·m + c·m²`, mm or radians.
struct Step {
    turns: bool,
    axis: usize,
    law: [f64; 3],
}

struct Machine {
    steps: Vec<Step>,
    tool: usize,
}

impl Step {
    fn random(dice: &mut Dice) -> Step {
        let turns = dice.roll(2) == 0;
        let size = if turns { 1.0 } else { 40.0 };
        let moves = if dice.roll(2) == 0 { size } else { 0.0 };
        let mut within = |reach: f64| reach * (dice.roll(2001) as f64 / 1000.0 - 1.0);
        let law = [within(size), within(moves), within(0.2 * moves)];
        Step { turns, axis: dice.roll(3), law }
    }

    fn text(&self) -> String {
        let [a, b, c] = self.law;
        let name = if self.turns { "rotate" } else { "translate" };
        let unit = if self.turns { "1 rad" } else { "1 mm" };
        format!("{name}_{}(({a} + {b} * M / 1 rad + {c} * (M / 1 rad)^2) * {unit})", ["x", "y", "z"][self.axis])
    }

    fn matrix(&self, m: f64) -> Matrix4<f64> {
        let [a, b, c] = self.law;
        let by = a + b * m + c * m * m;
        let along = Vector3::ith_axis(self.axis);
        match self.turns {
            true => Rotation3::from_axis_angle(&along, by).to_homogeneous(),
            false => Translation3::from(along.into_inner() * by).to_homogeneous(),
        }
    }
}

/// The tools: `at` and `body` as text, and their points as numbers.
const TOOLS: [(&str, &str); 3] = [
    ("[(30 mm + u) * cos(v), (30 mm + u) * sin(v), -2 * u]", "towards [-2 * cos(v), -2 * sin(v), -1]"),
    (
        "[12 mm * cos(u / 12 mm * 1 rad) * cos(v), 12 mm * cos(u / 12 mm * 1 rad) * sin(v), 12 mm * sin(u / 12 mm * 1 rad)]",
        "towards [-cos(u / 12 mm * 1 rad) * cos(v), -cos(u / 12 mm * 1 rad) * sin(v), -sin(u / 12 mm * 1 rad)]",
    ),
    ("[u, 15 mm * cos(v), 25 mm * sin(v)]", "towards [0, -cos(v), -sin(v)]"),
];

impl Machine {
    fn random(dice: &mut Dice) -> Machine {
        let count = 3 + dice.roll(6);
        let mut steps: Vec<Step> = (0..count).map(|_| Step::random(dice)).collect();
        // something must move, or the motion would be idle
        steps.push(Step { turns: true, axis: dice.roll(3), law: [0.3, 1.0, 0.0] });
        steps.push(Step { turns: false, axis: dice.roll(3), law: [50.0, 10.0, 0.0] });
        Machine { steps, tool: dice.roll(TOOLS.len()) }
    }

    fn text(&self) -> String {
        let mut frames = String::new();
        for (k, step) in self.steps.iter().enumerate() {
            let _ = writeln!(frames, "    frame f{} in f{k} = {}", k + 1, step.text());
        }
        let (at, body) = TOOLS[self.tool];
        format!(
            "machine random {{\n    axis M : rotary\n    frame f0\n{frames}}}\n\
             tool t {{\n    surface face(u: length in -5 mm .. 5 mm, v: angle in -180 deg .. 180 deg) {{\n        at = {at}\n        \
             body {body}\n    }}\n}}\n\
             job j {{\n    machine m = random\n    tool c = t\n    mount c on m.f{}\n    motion q : angle in -1 rad .. 1 rad\n    \
             drive m.M = q\n    surface s in m.f0 = envelope(c.face, over: q)\n}}\n",
            self.steps.len()
        )
    }

    /// The point (u, v) of the tool in the work.
    fn point(&self, [u, v, m]: [f64; 3]) -> Point3<f64> {
        let in_tool = match self.tool {
            0 => Point3::new((30.0 + u) * v.cos(), (30.0 + u) * v.sin(), -2.0 * u),
            1 => {
                let latitude = u / 12.0;
                Point3::new(12.0 * latitude.cos() * v.cos(), 12.0 * latitude.cos() * v.sin(), 12.0 * latitude.sin())
            }
            _ => Point3::new(u, 15.0 * v.cos(), 25.0 * v.sin()),
        };
        self.steps.iter().fold(Matrix4::identity(), |pose, step| pose * step.matrix(m)).transform_point(&in_tool)
    }

    /// The derivative of [`Machine::point`] by one of its arguments, from six points: good to 1e-11 of its size.
    fn slope(&self, at: [f64; 3], argument: usize) -> Vector3<f64> {
        const STEP: f64 = 4e-3;
        let between = |k: f64| {
            let (mut ahead, mut behind) = (at, at);
            ahead[argument] += k * STEP;
            behind[argument] -= k * STEP;
            self.point(ahead) - self.point(behind)
        };
        (between(1.0) * 45.0 - between(2.0) * 9.0 + between(3.0)) / (60.0 * STEP)
    }
}

#[test]
fn solved_points_are_where_dense_matrices_put_them() {
    let mut dice = Dice(11);
    let (mut machines, mut solved) = (0, 0);
    for _ in 0..60 {
        let machine = Machine::random(&mut dice);
        let text = machine.text();
        let graph = Graph::new();
        let compilation = compile_text(&graph, "random", &text, &[]);
        assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
        let targets: Vec<[f64; 2]> = (0..9).map(|k| [f64::from(k / 3) - 1.0, 0.1 * f64::from(k % 3) - 0.1]).collect();
        let found = points(&compilation.jobs[0], "s", ["u", "q"], &targets);
        assert_eq!(found.len(), targets.len());
        let before = solved;
        for (point, target) in found.iter().zip(&targets) {
            if point.outcome != Outcome::Solved {
                continue;
            }
            let at = [point.unknowns[0], point.unknowns[1], point.unknowns[2]];
            let what = format!("{point:?} of\n{text}");
            assert!((at[0] - target[0]).abs() < 1e-9 && (at[2] - target[1]).abs() < 1e-9, "{what}");
            let expected = machine.point(at);
            assert!(
                (expected - Point3::from(point.position)).norm() < 1e-11 * (1.0 + expected.coords.norm()),
                "{what}"
            );
            let normal = Vector3::from(point.normal);
            let velocity = machine.slope(at, 2);
            // the envelope: the surface moves along itself
            assert!(normal.dot(&velocity).abs() < 1e-9 * (1.0 + velocity.norm()), "{what}");
            for argument in 0..2 {
                let along = machine.slope(at, argument);
                assert!(normal.dot(&along).abs() < 1e-9 * along.norm(), "{what}");
            }
            assert!((normal.norm() - 1.0).abs() < 1e-12, "{what}");
            solved += 1;
        }
        machines += usize::from(solved > before);
    }
    // about a third of random motions has an envelope that the tool leaves
    assert!(machines >= 20 && solved >= 120, "{machines} machines, {solved} points");
}

/// A tool whose points have no normal at one place: that place is never called solved, its neighbours are not lost.
#[test]
fn a_point_without_a_normal_is_told() {
    let text = "
machine slide {
    frame bed
    frame head in bed = translate_x(50 mm) rotate_z(30 deg)
}
tool t {
    /// Whitney's umbrella: u = v = 0 is its pinch point.
    surface umbrella(u: length in -2 mm .. 2 mm, v: length in -2 mm .. 2 mm) {
        at = [u * v / 1 mm, u, v * v / 1 mm]
        body towards [2 * v / 1 mm, -2 * (v / 1 mm)^2, -u / 1 mm]
    }
}
job j {
    machine m = slide
    tool c = t
    mount c on m.head
    surface s in m.bed = move(c.umbrella)
}
";
    let graph = Graph::new();
    let compilation = compile_text(&graph, "umbrella", text, &[]);
    assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
    let targets = [[0.0, 0.0], [1.0, 0.5], [0.0, 1.0]];
    let job = &compilation.jobs[0];
    let alone = points(job, "s", ["u", "v"], &targets);
    let asked = ["u", "v"].map(|name| job.surfaces[0].coordinate(name).expect("an unknown").value);
    let (in_grid, _) = problem(job, &job.surfaces[0], asked).solve(&targets, [1, 3]);
    for found in [alone, in_grid] {
        assert_eq!(found[0].outcome, Outcome::Singular, "{:?}", found[0]);
        for point in &found[1..] {
            assert_eq!(point.outcome, Outcome::Solved);
            assert!(point.normal.iter().all(|x| x.is_finite()));
        }
    }
}

//! Axes of another machine in closed form, against those that are solved.

use std::f64::consts::FRAC_PI_2;

use flank_chain_dsl::Job;
use flank_expr::geometry::{Axis, Chain, Step, Vector3};
use flank_expr::{Expr, Graph, Language, ScalarEvaluator, Signature, Tape, emit_function};
use flank_solver::{Explicit, ExplicitProblem, NotExplicit, Outcome, PoseProblem, Posture};
use flank_tests::compiled::values_at;
use flank_tests::conversion::{Conversion, compiled};
use nalgebra::Vector3 as Vector;

struct Carried<'g> {
    job: Job<'g>,
    axes: Vec<String>,
    problem: PoseProblem<'g>,
    positions: Vec<Vec<f64>>,
    line: Vec<Posture>,
}

impl<'g> Carried<'g> {
    /// A job's first surface on another machine, as solved from the first position on.
    fn new(graph: &'g Graph, files: [&str; 2], frames: [&str; 2], positions: Vec<Vec<f64>>) -> Carried<'g> {
        let (job, target) = compiled(graph, files);
        let Conversion { problem, axes } = Conversion::new(graph, &job, &target, frames);
        let first = problem.postures(&positions[0]).swap_remove(0);
        let line = problem.follow(&first, &positions);
        assert!(line.iter().all(|posture| matches!(posture.outcome, Outcome::Solved | Outcome::Outside { .. })));
        Carried { job, axes, problem, positions, line }
    }

    fn explicit(&self) -> Result<Explicit<'g>, NotExplicit> {
        let generation = &self.job.surfaces[0].generation;
        ExplicitProblem {
            target: self.problem.chain(),
            unknowns: self.problem.unknowns(),
            source: &generation.driven,
            motions: &generation.motions,
            bindings: &self.job.bindings(),
            line: (&self.positions, &self.line),
        }
        .solve()
    }

    /// Values at all positions.
    fn numbers(&self, values: &[Expr<'g>]) -> Vec<Vec<f64>> {
        let motions = &self.job.surfaces[0].generation.motions;
        let bound = motions[0].graph().substitute(values, &self.job.bindings());
        let tape = Tape::new(&bound, motions).expect("all bound");
        let mut evaluator = ScalarEvaluator::new(&tape);
        let of = |at: &Vec<f64>| {
            let mut out = vec![0.0; bound.len()];
            evaluator.run(at, &mut out);
            out
        };
        self.positions.iter().map(of).collect()
    }
}

fn even(low: f64, high: f64, count: u32) -> Vec<Vec<f64>> {
    (0..count).map(|k| vec![low + (high - low) * f64::from(k) / f64::from(count - 1)]).collect()
}

/// 1e-12 mm or rad over the whole motion, of axes that stand in up to 100 mm.
fn agrees(carried: &Carried<'_>) {
    let explicit = carried.explicit().expect("three rotary axes and three slides");
    let found = carried.numbers(&explicit.continuous);
    let mut most = vec![0.0f64; carried.axes.len()];
    for (found, posture) in found.iter().zip(&carried.line) {
        for (k, (found, solved)) in found.iter().zip(posture.unknowns()).enumerate().take(most.len()) {
            most[k] = most[k].max((found - solved).abs());
        }
    }
    println!("{:?} {most:?}", carried.axes);
    assert!(most.iter().all(|by| *by < 1e-12), "{:?} {most:?}", carried.axes);
}

#[test]
fn the_path_of_the_free_form_machine_is_the_solved_one() {
    for job in ["specs/bevel/pinion_19x62.chain", "specs/bevel/tilted_pinion.chain"] {
        let graph = Graph::new();
        let files = [job, "specs/machines/free_form.chain"];
        agrees(&Carried::new(&graph, files, ["work", "cutter"], even(-0.3, 0.2, 201)));
    }
}

/// A table that tilts, a head that swivels over a table, a fork head; the tool's own turn is the third angle.
#[test]
fn the_paths_of_machining_centres_are_the_solved_ones() {
    for machine in ["table_table", "head_table", "head_head"] {
        let graph = Graph::new();
        let machine = format!("specs/machines/five_axis_{machine}.chain");
        let files = ["specs/bevel/pinion_19x62.chain", &machine];
        agrees(&Carried::new(&graph, files, ["work", "tip"], even(-0.18, 0.19, 201)));
    }
}

/// Two rotary axes without the cutter's spindle, and three of which two are parallel.
#[test]
fn what_has_no_explicit_form_is_told() {
    let graph = Graph::new();
    let files = ["specs/bevel/pinion_19x62.chain", "specs/machines/free_form.chain"];
    let carried = Carried::new(&graph, files, ["work", "cutter"], even(-0.18, 0.19, 3));
    let told = |target: &Chain<'_>, unknowns: &[usize]| {
        let unknowns: Vec<Expr<'_>> = unknowns.iter().map(|k| carried.problem.unknowns()[*k]).collect();
        let generation = &carried.job.surfaces[0].generation;
        ExplicitProblem {
            target,
            unknowns: &unknowns,
            source: &generation.driven,
            motions: &generation.motions,
            bindings: &carried.job.bindings(),
            line: (&carried.positions, &carried.line),
        }
        .solve()
        .expect_err("no form for it")
    };
    let [x, y, z, a, b, c] = carried.problem.unknowns()[..] else { panic!("six axes") };
    let still = carried.problem.chain().substituted(&[(b, graph.constant(0.3))]);
    assert_eq!(told(&still, &[0, 1, 2, 3, 5]), NotExplicit::Count { rotary: 2, linear: 3 });
    let slides = Step::Translate(Vector3([x, y, z]));
    let turn = |line, by| Step::Rotate(line, by);
    let parallel = Chain::new(&graph, vec![turn(Axis::Z, a), turn(Axis::Z, b), slides, turn(Axis::X, c)]);
    assert_eq!(told(&parallel, &[0, 1, 2, 3, 4, 5]), NotExplicit::Parallel);
    let geared = Chain::new(&graph, vec![turn(Axis::Z, a), turn(Axis::Y, a * b), slides, turn(Axis::X, c)]);
    assert_eq!(told(&geared, &[0, 1, 2, 3, 4, 5]), NotExplicit::Coupled);
    let flat = Step::Translate(Vector3([x, y + z, graph.constant(0.0)]));
    let flat = Chain::new(&graph, vec![turn(Axis::Z, a), turn(Axis::Y, b), flat, turn(Axis::X, c)]);
    assert_eq!(told(&flat, &[0, 1, 2, 3, 4, 5]), NotExplicit::Flat);
}

/// Two motions, a spindle of more than a turn.
#[test]
fn the_path_of_a_hobbing_machine_is_the_solved_one() {
    let graph = Graph::new();
    let files = ["specs/hobbing/helical_gear.chain", "specs/machines/hobbing_6axis.chain"];
    let positions = (0..40).map(|k| vec![1.0 + 0.25 * f64::from(k), -13.0 + 0.6 * f64::from(k)]).collect();
    agrees(&Carried::new(&graph, files, ["table", "hob"], positions));
}

/// What a control runs: compiled, against the solved axes and the first coefficient of their series.
#[test]
fn the_emitted_path_is_the_solved_one_at_10_000_positions() {
    let graph = Graph::new();
    let files = ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"];
    let carried = Carried::new(&graph, files, ["work", "cutter"], even(-0.3, 0.2, 10_000));
    let explicit = carried.explicit().expect("three rotary axes and three slides");
    let bound = graph.substitute(&explicit.continuous, &carried.job.bindings());
    let outputs: Vec<(&str, Expr<'_>)> = carried.axes.iter().map(String::as_str).zip(bound).collect();
    let motion = carried.job.surfaces[0].generation.motions[0];
    let points: Vec<[f64; 1]> = carried.positions.iter().map(|at| [at[0]]).collect();
    for language in [Language::C, Language::Rust] {
        let signature = Signature { name: "axes", comment: &[] };
        let text = emit_function(language, signature, &[motion], &outputs).expect("all bound");
        let Some(found) = values_at(language, ("axes", &text), outputs.len(), &points) else {
            eprintln!("skipped 1 of 2 languages: no compiler for {language:?}");
            continue;
        };
        for ((at, posture), found) in carried.positions.iter().zip(&carried.line).zip(found) {
            let series = carried.problem.series(posture, at, 0, 1).expect("no singular pose");
            for (k, name) in carried.axes.iter().enumerate() {
                let off = [found[k] - posture.axes[k], found[6 + k] - series[k][1]];
                assert!(
                    off.iter().all(|by| by.abs() < 1e-12 * series[k][1].abs().max(1.0)),
                    "{name} at {at:?}: {off:?}"
                );
            }
        }
    }
}

/// The two turns of the paper on the free-form machine, by its own equations (F2 to F5 of docs/theory.md): on the cradle machine, X
/// along z, Y along y and Z against x of its bed.
struct TwoTurns<'g> {
    /// From the work's apex to the cutter's centre.
    radius: Vector3<'g>,
    /// Y, and the work's axis.
    axes: [Vector3<'g>; 2],
    /// ΔU about Y, and ΔT before it about the work's axis.
    angles: [Expr<'g>; 2],
}

impl<'g> TwoTurns<'g> {
    fn of(graph: &'g Graph, job: &Job<'g>) -> TwoTurns<'g> {
        let machine = &job.machines[0];
        let laws: Vec<_> = machine.axes.iter().map(|axis| (axis.variable, axis.law)).collect();
        let chain = |frame: &str| {
            let chain = machine.chain(graph, "bed", frame).expect("both frames");
            chain.substituted(&laws).substituted(&job.bindings())
        };
        let (cutter, work) = (chain("cutter"), chain("work"));
        let seen = |Vector3([x, y, z]): Vector3<'g>| Vector3([z, y, -x]);
        let (origin, along) = (Vector3::zero(graph), Vector3::constant(graph, [0.0, 0.0, 1.0]));
        let [f, a] = [&cutter, &work].map(|chain| seen(chain.direction(along)));
        let j = Vector3::constant(graph, [0.0, 1.0, 0.0]);
        let about_work = f.dot(j).atan2(a.cross(j).dot(f));
        let turned = about(a, about_work, f);
        let about_y = -turned.0[0].atan2(turned.0[2]);
        TwoTurns {
            radius: seen(cutter.point(origin) - work.point(origin)),
            axes: [j, a],
            angles: [about_y, about_work],
        }
    }

    /// A vector turned twice.
    fn turned(&self, v: Vector3<'g>) -> Vector3<'g> {
        about(self.axes[0], self.angles[0], about(self.axes[1], self.angles[1], v))
    }
}

/// F2.
fn about<'g>(k: Vector3<'g>, angle: Expr<'g>, v: Vector3<'g>) -> Vector3<'g> {
    let (c, s) = (angle.cos(), angle.sin());
    v.scaled(c) + k.cross(v).scaled(s) + k.scaled(k.dot(v) * (1.0 - c))
}

/// Against the free-form machine's Y and Z, whose sense is the opposite of the paper's.
fn on_the_machine(v: Vector<f64>) -> Vector<f64> {
    Vector::new(v.x, -v.y, -v.z)
}

/// ΔT and ΔU, F6: the same axes.
#[test]
fn the_papers_two_turns_give_the_axes() {
    let graph = Graph::new();
    let files = ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"];
    let carried = Carried::new(&graph, files, ["work", "cutter"], even(-0.3, 0.2, 101));
    let turns = TwoTurns::of(&graph, &carried.job);
    let law = |name: &str| {
        let axis = carried.job.machines[0].axes.iter().find(|axis| axis.name == name).expect("an axis");
        graph.substitute(&[axis.law], &carried.job.bindings())[0]
    };
    let place = turns.turned(turns.radius);
    let values = [&place.0[..], &[law("work"), law("root"), turns.angles[0], turns.angles[1]]].concat();
    let found = carried.numbers(&values);
    // where the zero of A lies is the machine's
    let zero = carried.line[0].axes[3] - (found[0][3] + found[0][6]);
    for (posture, found) in carried.line.iter().zip(found) {
        let place = on_the_machine(Vector::new(found[0], found[1], found[2]));
        let expected = [place.x, place.y, place.z, zero + found[3] + found[6], found[4] - found[5]];
        for (axis, expected) in posture.axes.iter().zip(expected) {
            assert!((axis - expected).abs() < 1e-12, "{:?} {expected}", posture.axes);
        }
    }
    assert!((zero.abs() / FRAC_PI_2).fract() < 1e-12, "{zero}");
}

/// "Due to the implicated motion as the rotation, there is a Coriolis acceleration when the superposition is superimposed": the second
/// derivatives of X, Y and Z are those of R as the cradle machine moves it, turned, with the accelerations of the two turns and
/// twice the product of both velocities.
#[test]
fn accelerations_have_the_papers_coriolis_term() {
    let graph = Graph::new();
    let files = ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"];
    let carried = Carried::new(&graph, files, ["work", "cutter"], even(-0.3, 0.2, 21));
    let turns = TwoTurns::of(&graph, &carried.job);
    let roll = carried.job.surfaces[0].generation.motions[0];
    let speed = turns.radius.derivative(roll);
    let vectors = [turns.radius, speed, speed.derivative(roll)].map(|v| turns.turned(v));
    // the second turn carries the work's axis, about which the first one is made, in the plane
    let work_axis = about(turns.axes[0], turns.angles[0], turns.axes[1]);
    let rates = turns.angles.map(|angle| angle.derivative(roll));
    let accelerations = rates.map(|rate| rate.derivative(roll));
    let all: Vec<Expr<'_>> =
        vectors.into_iter().chain([work_axis]).flat_map(|v| v.0).chain(rates).chain(accelerations).collect();
    for (k, found) in carried.numbers(&all).iter().enumerate() {
        let vector = |k: usize| Vector::new(found[3 * k], found[3 * k + 1], found[3 * k + 2]);
        let [place, relative, relative_acceleration, work_axis] = [0, 1, 2, 3].map(vector);
        let [about_y, about_work, about_y_rate, about_work_rate] = [12, 13, 14, 15].map(|k| found[k]);
        let y = Vector::y();
        let omega = y * about_y + work_axis * about_work;
        let omega_rate = y * about_y_rate + work_axis * about_work_rate + y.cross(&work_axis) * (about_y * about_work);
        let carrying = omega_rate.cross(&place) + omega.cross(&omega.cross(&place));
        let coriolis = 2.0 * omega.cross(&relative);
        let series = carried.problem.series(&carried.line[k], &carried.positions[k], 0, 2).expect("no singular pose");
        let solved = |order: usize, factor: f64| Vector::from_fn(|axis, _| factor * series[axis][order]);
        let velocity = on_the_machine(relative + omega.cross(&place));
        assert!((velocity - solved(1, 1.0)).norm() < 1e-11, "{velocity}");
        let acceleration = on_the_machine(relative_acceleration + carrying + coriolis);
        assert!((acceleration - solved(2, 2.0)).norm() < 1e-10, "{acceleration} {}", solved(2, 2.0));
        // mm/rad²: without it the polynomials would be another motion
        assert!(coriolis.norm() > 1.0, "{coriolis}");
    }
}

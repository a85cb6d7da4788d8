//! Axes of another machine in closed form, against those that are solved.

use flank_chain_dsl::{Axis, Compilation, Dimension, Job, ToolShape, compile_with_machine};
use flank_expr::{Expr, Graph, Language, ScalarEvaluator, Signature, Tape, emit_function};
use flank_solver::{
    Explicit, ExplicitProblem, NotExplicit, Outcome, PoseProblem, Posture, Range, TargetAxis, symmetries,
};
use flank_tests::compiled::values_at;
use flank_tests::repository;

struct Carried<'g> {
    job: Job<'g>,
    axes: Vec<String>,
    problem: PoseProblem<'g>,
    positions: Vec<Vec<f64>>,
    line: Vec<Posture>,
}

impl<'g> Carried<'g> {
    /// A job's first surface on another machine, as solved from the first position on.
    fn new(graph: &'g Graph, [job, machine]: [&str; 2], frames: [&str; 2], positions: Vec<Vec<f64>>) -> Carried<'g> {
        let Compilation { mut jobs, machine, diagnostics, .. } =
            compile_with_machine(graph, &repository(job), &repository(machine), &[]);
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
        let (job, target) = (jobs.swap_remove(0), machine.expect("no error"));
        let surface = &job.surfaces[0];
        let ToolShape::Surface(tool) = &surface.generation.tool else { panic!("a tool has a surface") };
        let ranges = surface.unknowns[..2].iter().map(|u| Range { low: u.low, high: u.high }).collect();
        let slips = symmetries(&[(&tool.bound(&job.bindings()), ranges)]).expect("all bound");
        let machine = &target.machines[0];
        let axis = |axis: &Axis<'g>| TargetAxis {
            variable: axis.variable,
            is_rotary: axis.dimension == Dimension::ANGLE,
            travel: axis.travel.map(|(low, high)| Range { low, high }),
        };
        let axes: Vec<TargetAxis<'g>> = machine.axes.iter().map(axis).collect();
        let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
        let (driven, motions) = (&surface.generation.driven, &surface.generation.motions);
        let chain = machine.chain(graph, frames[0], frames[1]).expect("both frames");
        let problem = PoseProblem::new(&chain, &axes, driven, motions, &slips, 1000.0, &bindings).expect("six axes");
        let first = problem.postures(&positions[0]).swap_remove(0);
        let line = problem.follow(&first, &positions);
        assert!(line.iter().all(|posture| matches!(posture.outcome, Outcome::Solved | Outcome::Outside { .. })));
        let axes = machine.axes.iter().map(|axis| axis.name.clone()).collect();
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

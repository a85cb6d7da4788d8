//! A cradle generator's process carried over to the free-form machine, against the independent table.

use std::f64::consts::{FRAC_PI_2, PI};

use flank_chain_dsl::{Compilation, Job, compile_with_machine};
use flank_expr::geometry::Chain;
use flank_expr::{Expr, Graph};
use flank_solver::{Outcome, PoseProblem, Range, Screw, TargetAxis, symmetries};
use flank_tests::{reference_json, repository};
use serde_json::Value;

struct Conversion {
    problem: PoseProblem,
    axes: Vec<String>,
}

fn compiled<'g>(graph: &'g Graph, [job, machine]: [&str; 2]) -> (Job<'g>, Job<'g>) {
    let Compilation { mut jobs, machine, diagnostics, .. } =
        compile_with_machine(graph, &repository(job), &repository(machine), &[]);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    (jobs.swap_remove(0), machine.expect("no error"))
}

fn tool_symmetries(job: &Job<'_>, surface: usize) -> Vec<Screw> {
    let surface = &job.surfaces[surface];
    let flank_chain_dsl::ToolShape::Surface(tool) = &surface.generation.tool else { return Vec::new() };
    let ranges = surface.unknowns[..2].iter().map(|u| Range { low: u.low, high: u.high }).collect();
    symmetries(&[(&tool.bound(&job.bindings()), ranges)]).expect("all bound")
}

fn conversion<'g>(graph: &'g Graph, job: &Job<'g>, target: &Job<'g>) -> Conversion {
    let generation = &job.surfaces[0].generation;
    let machine = &target.machines[0];
    let chain: Chain<'g> = machine.chain(graph, "work", "cutter").expect("both frames");
    let axes: Vec<TargetAxis<'g>> = machine
        .axes
        .iter()
        .map(|axis| TargetAxis {
            variable: axis.variable,
            is_rotary: axis.dimension == flank_chain_dsl::Dimension::ANGLE,
            travel: axis.travel.map(|(low, high)| Range { low, high }),
        })
        .collect();
    let bindings: Vec<(Expr<'g>, Expr<'g>)> = job.bindings().into_iter().chain(target.bindings()).collect();
    let problem = PoseProblem::new(
        &chain,
        &axes,
        &generation.driven,
        &generation.motions,
        &tool_symmetries(job, 0),
        1000.0,
        &bindings,
    )
    .expect("six axes");
    Conversion { problem, axes: machine.axes.iter().map(|axis| axis.name.clone()).collect() }
}

#[test]
fn a_cutter_of_revolution_turns_freely() {
    let graph = Graph::new();
    let (job, _) = compiled(&graph, TABLES);
    let found = tool_symmetries(&job, 0);
    assert_eq!(found, [Screw { angular: [0.0, 0.0, 1.0], linear: [0.0; 3] }]);
}

/// The table's cradle turns the other way; its work's zero lies opposite, and its cutter's phase counts from another line and
/// the other way.
fn of_table(name: &str, value: f64, row: &Value) -> f64 {
    let of = |key: &str| row[key].as_f64().expect("a number");
    match name {
        "A" => value - (of("A") - PI),
        "C" => value - (of("Cc") + FRAC_PI_2),
        _ => value - of(name),
    }
}

const TABLES: [&str; 2] = ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"];

#[test]
fn axes_meet_the_table() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = conversion(&graph, &job, &target);
    let reference = reference_json("freeform.json");
    let rows = reference["axes"].as_array().expect("rows");
    let motions: Vec<Vec<f64>> = rows.iter().map(|row| vec![-row["psi"].as_f64().expect("a number")]).collect();
    let first = conversion.problem.postures(&motions[0]);
    let line = conversion.problem.follow(&first[0], &motions);
    for (posture, row) in line.iter().zip(rows) {
        assert_eq!((posture.outcome, posture.missing), (Outcome::Solved, None));
        for (name, value) in conversion.axes.iter().zip(&posture.axes) {
            let off = of_table(name, *value, row);
            assert!(off.abs() < 1e-10, "{name} is off by {off:e} at {}", row["psi"]);
        }
    }
}

#[test]
fn taylor_coefficients_meet_the_table() {
    let graph = Graph::new();
    let (job, target) = compiled(&graph, TABLES);
    let conversion = conversion(&graph, &job, &target);
    let reference = reference_json("freeform.json");
    let first = conversion.problem.postures(&[0.0]);
    let series = conversion.problem.series(&first[0], &[0.0], 0, 6).expect("no singular pose");
    for (name, found) in conversion.axes.iter().zip(series) {
        let expected = reference["taylor"][if name == "C" { "Cc" } else { name }].as_array().expect("coefficients");
        for (k, c) in expected.iter().enumerate().skip(1) {
            let c = c.as_f64().expect("a number") * if k % 2 == 0 { 1.0 } else { -1.0 };
            assert!((found[k] - c).abs() < 1e-9 * c.abs(), "{name}, order {k}: {:e} instead of {c:e}", found[k]);
        }
    }
}

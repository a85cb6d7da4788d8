//! What derivatives cost: of every shipped spec the tape of a surface's value and slope in one direction, beside that of the
//! value alone. Instructions are counted, a sine with its cosine as one; times would be another machine's tomorrow.

use flank_chain_dsl::GeneratedSurface;
use flank_expr::{Expr, Graph, Tape};
use flank_tests::{jobs, shipped};

/// What a direction may add, with the value, as a multiple of the value.
const MOST: f64 = 3.0;

struct Found {
    what: String,
    /// Instructions of the value alone.
    value: usize,
    /// The most that value and one direction take, along one unknown, and along any direction.
    along_one: usize,
    along_any: usize,
}

/// Position, normal and constraints of a surface with the parameters' numbers.
fn found<'g>(spec: &str, surface: &GeneratedSurface<'g>, bindings: &[(Expr<'g>, Expr<'g>)]) -> Found {
    let made = &surface.surface;
    let graph = made.position.0[0].graph();
    let outputs = made.position.0.into_iter().chain(made.normal.0).chain(made.constraints.iter().copied());
    let values = graph.substitute(&outputs.collect::<Vec<_>>(), bindings);
    let count = |slopes: &[Expr<'g>], inputs: &[Expr<'g>]| {
        let tape = Tape::new(&[&values, slopes].concat(), inputs).expect("parameters have numbers");
        tape.instructions().len()
    };
    let along = |variable: Expr<'g>| values.iter().map(|value| value.derivative(variable)).collect::<Vec<_>>();
    let unknowns = &made.unknowns;
    let along_one = unknowns.iter().map(|unknown| count(&along(*unknown), unknowns)).max().unwrap_or(0);

    // every unknown goes along by a share of its own
    let step = graph.variable("step");
    let shares: Vec<Expr<'g>> = (0..unknowns.len()).map(|k| graph.variable(format!("share {k}"))).collect();
    let moved: Vec<_> = unknowns.iter().zip(&shares).map(|(x, share)| (*x, *x + step * *share)).collect();
    let there = graph.substitute(&values, &moved);
    let slopes: Vec<Expr<'g>> = there.iter().map(|value| value.derivative(step)).collect();
    let slopes = graph.substitute(&slopes, &[(step, graph.constant(0.0))]);
    let along_any = count(&slopes, &[unknowns.as_slice(), &shares].concat());
    Found { what: format!("{spec} {}", surface.name), value: count(&[], unknowns), along_one, along_any }
}

#[test]
fn a_direction_takes_at_most_three_times_the_value() {
    let mut all = Vec::new();
    for spec in shipped() {
        let graph = Graph::new();
        for job in jobs(&graph, &spec, &[]) {
            let bindings = job.bindings();
            all.extend(job.surfaces.iter().map(|surface| found(&spec, surface, &bindings)));
        }
    }
    assert!(all.len() > 50, "{} surfaces", all.len());
    let share = |most: usize, found: &Found| most as f64 / found.value as f64;
    let told = |most: fn(&Found) -> usize| {
        let worst = all.iter().max_by(|a, b| share(most(a), a).total_cmp(&share(most(b), b))).expect("there are some");
        println!("{}: {} instructions, {} with a direction", worst.what, worst.value, most(worst));
        share(most(worst), worst)
    };
    let worst = told(|found| found.along_one).max(told(|found| found.along_any));
    assert!(worst <= MOST, "{worst}");
}

//! Emitted functions of a free-form machine, compiled by the compilers of their languages: time per call beside an interpolation
//! cycle. Six axes with first derivatives, of a tilted cutter on a cradle carried over by the explicit path, and as polynomials.

use flank_expr::{Expr, Graph, Language, Polynomial, Signature, emit_function, emit_polynomials};
use flank_solver::ExplicitProblem;
use flank_tests::compiled::output_of;
use flank_tests::conversion::{Conversion, compiled};

const AXES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];
/// Of the polynomials.
const ORDER: usize = 12;
const CALLS: usize = 1_000_000;
const SIGNATURE: Signature<'static> = Signature { name: "axes", comment: &[] };

fn main() {
    let graph = Graph::new();
    let (motion, axes) = free_form_axes(&graph);
    let named: Vec<(&str, Expr<'_>)> = AXES.into_iter().zip(axes).collect();
    // how long Horner's rule takes does not depend on the numbers
    let coefficients: Vec<f64> = (0..=ORDER).map(|power| 1.0 / (1.0 + power as f64)).collect();
    let polynomials = AXES.map(|name| Polynomial { name, coefficients: &coefficients });
    println!("{:<12} {:<8} {:>8}  {:>12}  {:>12}", "form", "language", "ns/call", "of 1 kHz", "of 8 kHz");
    for (language, main) in [(Language::C, C_MAIN), (Language::Rust, RUST_MAIN)] {
        let exact = emit_function(language, SIGNATURE, &[motion], &named).expect("parameters are numbers");
        let order = format!("order {ORDER}");
        let forms = [("exact", exact), (&order, emit_polynomials(language, SIGNATURE, ("roll", 0.0), &polynomials))];
        for (form, text) in forms {
            report(form, language, nanoseconds((language, main), &text));
        }
    }
}

/// The explicit path over the sampled flank's roll, as `flank convert --emit-form exact` writes it.
fn free_form_axes<'g>(graph: &'g Graph) -> (Expr<'g>, Vec<Expr<'g>>) {
    let (job, target) = compiled(graph, ["specs/bevel/tilted_pinion.chain", "specs/machines/free_form.chain"]);
    let Conversion { problem, .. } = Conversion::new(graph, &job, &target, ["work", "cutter"]);
    let positions: Vec<Vec<f64>> = (0..101).map(|k| vec![-0.3 + 0.006 * f64::from(k)]).collect();
    let first = problem.postures(&positions[0]).swap_remove(0);
    let line = problem.follow(&first, &positions);
    let generation = &job.surfaces[0].generation;
    let explicit = ExplicitProblem {
        target: problem.chain(),
        unknowns: problem.unknowns(),
        source: &generation.driven.substituted(&job.bindings()),
        motions: &generation.motions,
        bindings: &[],
        line: (&positions, &line),
    };
    (generation.motions[0], explicit.solve().expect("three rotary axes and three slides").continuous)
}

fn nanoseconds((language, main): (Language, &str), function: &str) -> Option<f64> {
    let printed = output_of(language, function, &main.replace("CALLS", &CALLS.to_string()), &[])?;
    let seconds: f64 = String::from_utf8_lossy(&printed).trim().parse().expect("seconds");
    Some(seconds * 1e9 / CALLS as f64)
}

fn report(form: &str, language: Language, nanoseconds: Option<f64>) {
    let name = format!("{language:?}");
    match nanoseconds {
        Some(time) => {
            let [slow, fast] = [1e3, 8e3].map(|rate| format!("{:.4} %", time * 1e-9 * rate * 100.0));
            println!("{form:<12} {name:<8} {time:>8.1}  {slow:>12}  {fast:>12}");
        }
        None => println!("{form:<12} {name:<8} no compiler"),
    }
}

/// Each call waits for the one before: its argument has a part, lost in rounding, of the last result.
const C_MAIN: &str = "
int main(void)
{
    struct timespec begin, end;
    double values[6] = { 0.0 }, derivatives[6];
    volatile double sink;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (int k = 0; k < CALLS; ++k) {
        axes(-0.3 + 0.6 * k / CALLS + 1e-300 * (values[0] + values[5]), values, derivatives);
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    sink = values[0] + derivatives[5];
    (void)sink;
    printf(\"%.9f\\n\", (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec));
    return 0;
}
";

const RUST_MAIN: &str = "
fn main() {
    std::io::stdin().read_exact(&mut []).unwrap();
    let (mut values, mut derivatives) = ([0.0; 6], [0.0; 6]);
    let begin = std::time::Instant::now();
    for k in 0..CALLS {
        let roll = -0.3 + 0.6 * k as f64 / CALLS as f64 + 1e-300 * (values[0] + values[5]);
        axes(roll, &mut values, &mut derivatives);
    }
    let seconds = begin.elapsed().as_secs_f64();
    std::hint::black_box((values, derivatives));
    writeln!(std::io::stdout(), \"{seconds:.9}\").unwrap();
}
";

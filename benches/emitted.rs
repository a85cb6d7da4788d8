//! Emitted functions of a free-form machine, compiled by the compilers of their languages: time per call beside an interpolation
//! cycle. Six axes with first derivatives, of a tilted cutter on a cradle carried over by the explicit path, and as polynomials.

use std::f64::consts::FRAC_PI_2;

use flank_chain_dsl::Job;
use flank_expr::geometry::{Axis, Chain, Step};
use flank_expr::{Expr, Graph, Language, Polynomial, Signature, emit_function, emit_polynomials};
use flank_tests::compiled::output_of;
use flank_tests::job;

const AXES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];
/// Of the polynomials.
const ORDER: usize = 12;
const CALLS: usize = 1_000_000;
const SIGNATURE: Signature<'static> = Signature { name: "axes", comment: &[] };

fn main() {
    let graph = Graph::new();
    let job = job(&graph, "specs/bevel/tilted_pinion.chain", &[]);
    let motion = job.surfaces[0].generation.motions[0];
    let axes = free_form_axes(&graph, &job);
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

/// The explicit path: work axis in the XZ plane through the origin, cutter axis parallel to Z.
fn free_form_axes<'g>(graph: &'g Graph, job: &Job<'g>) -> [Expr<'g>; 6] {
    let t_work_cutter = job.surfaces[0].generation.driven.substituted(&job.bindings());
    let cutter_axis = t_work_cutter.pose().matrix4().map(|row| row[2]);
    let work = cutter_axis[1].atan2(-cutter_axis[0]);
    let root = (-cutter_axis[2]).asin();
    let turned = vec![Step::Rotate(Axis::Y, root + FRAC_PI_2), Step::Rotate(Axis::Z, work)];
    let pose = Chain::new(graph, turned).then(&t_work_cutter).pose().matrix4();
    let [x, y, z, _] = pose.map(|row| row[3]);
    [x, y, z, work, root, pose[1][0].atan2(pose[0][0])]
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

//! From text to ready tape: the cradle machine with nine polynomial motions, and chains of 10 to 1,000 frames.

use std::fmt::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use divan::{Bencher, black_box};
use flank_chain_dsl::{compile_text, render};
use flank_expr::Graph;
use flank_solver::{BoundSurface, Range, SurfaceProblem};

/// Numbers of frames in a chain.
const FRAMES: [usize; 5] = [10, 30, 100, 300, 1000];

fn main() {
    // a filter asks for one bench
    if std::env::args().skip(1).all(|argument| argument.starts_with('-')) {
        print_growth();
    }
    divan::main();
}

/// Compiles a text with one job and lays out the tapes of all its surfaces; gives the number of their instructions.
fn tape_of(text: &str) -> usize {
    /// Trees of texts are kept: each text is a new one.
    static TEXTS: AtomicUsize = AtomicUsize::new(0);
    let text = format!("{text}// {}\n", TEXTS.fetch_add(1, Ordering::Relaxed));
    let graph = Graph::new();
    let compilation = compile_text(&graph, "bench", &text, &[]);
    assert!(!compilation.has_errors(), "{}", render(&compilation.diagnostics, &compilation.sources, false));
    let job = &compilation.jobs[0];
    let mut instructions = 0;
    for surface in &job.surfaces {
        let sample = surface.sample.as_ref().expect("a sample");
        let coordinates = sample.functions();
        let ranges = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
        let problem = SurfaceProblem::new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
            .expect("all bound");
        instructions += problem.system().tape().instructions().len();
    }
    instructions
}

fn spec(path: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../specs").join(path);
    let text = std::fs::read_to_string(path).expect("the spec is there");
    text.lines().filter(|line| !line.starts_with("use ")).map(|line| format!("{line}\n")).collect()
}

/// The pinion 19x62 with every joint of its machine a polynomial of the sixth degree in the roll; four surfaces.
fn nine_polynomials() -> String {
    spec("machines/cradle.chain") + &spec("tools/face_mill.chain") + include_str!("nine_polynomials.chain")
}

/// A machine with `frames` frames in a row, each turned and moved against the one before by its share of one motion.
fn chain(frames: usize) -> String {
    let mut text = String::from("machine long {\n    axis A : rotary\n    frame f0\n");
    for k in 1..frames {
        let turn = ["rotate_x", "rotate_y", "rotate_z"][k % 3];
        let _ = writeln!(text, "    frame f{k} in f{} = translate(1 mm, {k} um, 2 mm) {turn}(A / {frames})", k - 1);
    }
    let last = frames - 1;
    let _ = write!(
        text,
        "}}
tool ball {{
    surface face(u: angle in -80 deg .. 80 deg, v: angle in -60 deg .. 60 deg) {{
        at = [5 mm * cos(u) * cos(v), 5 mm * cos(u) * sin(v), 5 mm * sin(u)]
        body towards [-cos(u) * cos(v), -cos(u) * sin(v), -sin(u)]
    }}
}}
job j {{
    machine m = long
    tool b = ball
    mount b on m.f{last}
    motion turn : angle in 0 deg .. 360 deg
    drive m.A = turn
    surface s in m.f0 = envelope(b.face, over: turn)
    sample s {{ u: -50 deg .. 50 deg by 5, turn: 10 deg .. 350 deg by 9 }}
}}
"
    );
    text
}

/// Least-squares slope of log(time) over log(frames): 1 is linear. Of each the fastest run, in which nobody else disturbed.
fn print_growth() {
    const RUNS: usize = 15;
    let points: Vec<(f64, f64)> = FRAMES
        .iter()
        .map(|&frames| {
            let text = chain(frames);
            let best = (0..RUNS)
                .map(|_| {
                    let start = Instant::now();
                    black_box(tape_of(&text));
                    start.elapsed().as_secs_f64()
                })
                .fold(f64::INFINITY, f64::min);
            println!("{frames:5} frames: {:8.3} ms, {} instructions", best * 1e3, tape_of(&text));
            (frames as f64, best)
        })
        .collect();
    println!("time grows as frames^{:.2}", flank_benches::slope(&points));
}

#[divan::bench]
fn cradle_nine_polynomials(bencher: Bencher) {
    let text = nine_polynomials();
    bencher.bench(|| tape_of(black_box(&text)));
}

#[divan::bench(args = FRAMES)]
fn chain_of_frames(bencher: Bencher, frames: usize) {
    let text = chain(frames);
    bencher.bench(|| tape_of(black_box(&text)));
}

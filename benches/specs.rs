//! What a point takes of every surface of the library, resampled at 201 x 201 points, on one thread: nanoseconds, instructions of the tape
//! of residuals and Jacobian, nanoseconds an instruction, and as `ratio` that as a multiple of the common job's, which runs just before
//! each surface. Worst first. `followed` are the nanoseconds where a start gives the branch, so that nothing is searched for.
//!
//! `cargo bench -p flank-benches --bench specs -- [--side N] [--only PART-OF-A-NAME] [--json]`

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::{Duration, Instant};

use flank_solver::{Outcome, SurfacePoints};
use flank_tests::resampled::Resampled;

const SIDE: usize = 201;
/// How long a surface is solved again and again, and how often at the least.
const LONG: Duration = Duration::from_millis(60);
const LEAST: usize = 5;

struct Arguments {
    side: usize,
    only: String,
    is_json: bool,
}

/// What solving a surface takes.
struct Found {
    name: String,
    points: usize,
    solved: usize,
    instructions: usize,
    /// Nanoseconds a point.
    time: f64,
    /// The same where the branch is given by a point on it, without a search for others.
    followed: f64,
    /// Nanoseconds an instruction over those of the common job.
    share: f64,
    evaluations: f64,
    boxes: u64,
}

fn arguments() -> Arguments {
    let mut found = Arguments { side: SIDE, only: String::new(), is_json: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--side" => found.side = words.next().and_then(|word| word.parse().ok()).expect("--side takes a number"),
            "--only" => found.only = words.next().expect("--only takes a part of a name"),
            "--json" => found.is_json = true,
            // a smoke run
            "--test" => (found.side, found.only) = (9, "specs/hobbing/helical_gear.chain".into()),
            _ => {}
        }
    }
    found
}

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
    let Arguments { side, only, is_json } = arguments();
    let common = Resampled::common(side);
    let is_meant = |name: &str| name.contains(&only);
    let surfaces = Resampled::shipped(side, |_| true).filter(|surface| is_meant(&surface.name));
    let mut all: Vec<Found> = surfaces.map(|surface| measured(&surface, &common)).collect();
    assert!(!all.is_empty(), "no surface of the library has `{only}` in its name");
    all.sort_by(|a, b| b.share.total_cmp(&a.share));
    if is_json { println!("{}", json(&all)) } else { print(&all) }
}

fn measured(surface: &Resampled, common: &Resampled) -> Found {
    let per_instruction = |time: f64, of: &Resampled| time / of.instructions as f64;
    let [beside, ..] = fastest(common, None);
    let (points, report) = surface.solve(None);
    let [time, evaluations] = fastest(surface, None);
    let start = start(surface, &points);
    let followed = start.map_or(f64::NAN, |start| fastest(surface, Some(&start))[0]);
    Found {
        name: surface.name.clone(),
        points: points.len(),
        solved: points.solved(),
        instructions: surface.instructions,
        time,
        followed,
        share: per_instruction(time, surface) / per_instruction(beside, common),
        evaluations,
        boxes: report.boxes,
    }
}

/// The unknowns of the point in the middle, if it is solved.
fn start(surface: &Resampled, points: &SurfacePoints) -> Option<Vec<f64>> {
    let [rows, columns] = surface.counts;
    let middle = rows / 2 * columns + columns / 2;
    (points.outcome(middle) == Outcome::Solved).then(|| points.unknowns(middle))
}

/// Nanoseconds a point of the fastest run, and evaluations a point; memory is that of the run before.
fn fastest(surface: &Resampled, start: Option<&[f64]>) -> [f64; 2] {
    let (begin, mut best, mut memory, mut evaluations) = (Instant::now(), Duration::MAX, None, 0);
    let mut runs = 0;
    while runs < LEAST || begin.elapsed() < LONG {
        let run = Instant::now();
        let (points, report) =
            black_box(surface.problem.solve_points(&surface.targets, surface.counts, start, memory.take()));
        best = best.min(run.elapsed());
        evaluations = report.evaluations;
        memory = Some(points);
        runs += 1;
    }
    let points = surface.targets.len() as f64;
    [best.as_secs_f64() * 1e9 / points, evaluations as f64 / points]
}

fn print(all: &[Found]) {
    println!("   ratio     ns  followed  instr.  ns/instr.  evals  boxes  solved");
    for Found { name, points, solved, instructions, time, followed, share, evaluations, boxes } in all {
        let (each, part) = (time / *instructions as f64, *solved as f64 / *points as f64);
        println!(
            "{share:8.2} {time:6.1} {followed:9.1} {instructions:7} {each:10.3} {evaluations:6.2} {boxes:6} {part:7.3}  {name}"
        );
    }
}

fn json(all: &[Found]) -> String {
    let mut text = String::from("[");
    for (k, found) in all.iter().enumerate() {
        let Found { name, points, solved, instructions, time, followed, share, evaluations, boxes } = found;
        let followed = if followed.is_finite() { format!("{followed:.2}") } else { "null".into() };
        let comma = if k == 0 { "" } else { "," };
        let _ = write!(
            text,
            "{comma}\n{{\"surface\": \"{name}\", \"points\": {points}, \"solved\": {solved}, \"instructions\": {instructions}, \
             \"ns_a_point\": {time:.2}, \"ns_a_point_followed\": {followed}, \"ns_an_instruction_over_common\": {share:.3}, \
             \"evaluations_a_point\": {evaluations:.3}, \"boxes\": {boxes}}}"
        );
    }
    text + "\n]"
}

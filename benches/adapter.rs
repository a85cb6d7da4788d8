//! The common jobs for the harness that compares programs: one line of JSON on stdout; in a file nine numbers a point, ten of `helical`.
//!
//! `adapter --job flank|grid|helical --n1 501 --n2 501 --threads 1 --reps 15 --out points.bin [--lanes 4]`
//!
//! `--lanes` takes the machine code with registers of so many numbers instead of the widest: 4 is AVX2. Loops that the compiler makes
//! stay as wide as the processor's registers.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::process::ExitCode;
use std::time::Instant;

use flank_benches::peak_memory;
use flank_chain_dsl::{compile_text, render};
use flank_expr::{Graph, InstructionSet};
use flank_solver::{BoundSurface, Range, SurfaceProblem};

/// The text of a common job, and where it starts.
struct Common {
    name: &'static str,
    text: &'static str,
    start: &'static [f64],
}

/// Starts are s, theta, phi.
const SPIRAL_BEVEL: Common =
    Common { name: "spiral_bevel", text: include_str!("spiral_bevel.chain"), start: &[5.4, -2.45, -0.26] };
/// Starts are xi, tau, spindle, feed.
const HELICAL: Common =
    Common { name: "helical_zi", text: include_str!("helical_zi.chain"), start: &[4.6, -0.86, 3.2, 0.0] };

struct Arguments {
    job: String,
    counts: [usize; 2],
    repetitions: usize,
    lanes: Option<usize>,
    out: String,
}

fn arguments() -> Result<Arguments, String> {
    let mut found =
        Arguments { job: "flank".into(), counts: [31, 61], repetitions: 3, lanes: None, out: String::new() };
    let mut words = std::env::args().skip(1);
    while let Some(key) = words.next() {
        let value = words.next().ok_or_else(|| format!("`{key}` lacks its value"))?;
        let number = || value.parse::<usize>().map_err(|_| format!("`{key}` takes a whole number, not `{value}`"));
        match key.as_str() {
            "--job" => found.job = value,
            "--n1" => found.counts[0] = number()?,
            "--n2" => found.counts[1] = number()?,
            "--threads" => set_threads(number()?)?,
            "--reps" => found.repetitions = number()?.max(1),
            "--lanes" => found.lanes = Some(number()?),
            "--out" => found.out = value,
            _ => return Err(format!("unknown argument `{key}`")),
        }
    }
    Ok(found)
}

fn set_threads(count: usize) -> Result<(), String> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .use_current_thread()
        .build_global()
        .map_err(|error| error.to_string())
}

fn main() -> ExitCode {
    match arguments().and_then(|arguments| run(&arguments)) {
        Ok(report) => {
            println!("{report}");
            ExitCode::SUCCESS
        }
        Err(reason) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<String, String> {
    let start = Instant::now();
    let graph = Graph::new();
    let [rows, columns] = arguments.counts.map(|count| count.to_string());
    let sizes = [("rows".to_string(), rows), ("columns".to_string(), columns)];
    let Common { name, text, start: first } = if arguments.job == "helical" { HELICAL } else { SPIRAL_BEVEL };
    let mut compilation = compile_text(&graph, name, text, &sizes);
    if compilation.has_errors() {
        return Err(render(&compilation.diagnostics, &compilation.sources, false));
    }
    let job = compilation.take_jobs(&[&arguments.job]).map_err(|_| format!("no job `{}`", arguments.job))?.remove(0);
    let surface = &job.surfaces[0];
    let sample = surface.sample.as_ref().ok_or("the job asks for no points")?;
    let coordinates = sample.functions();
    let ranges = surface.unknowns.iter().map(|u| Range { low: u.low, high: u.high }).collect();
    let is_curved = arguments.job == "grid";
    let new = if is_curved { SurfaceProblem::with_curvatures } else { SurfaceProblem::new };
    let mut problem = new(&BoundSurface::new(&surface.surface, ranges, &job.bindings()), coordinates)
        .map_err(|error| error.to_string())?;
    if let Some(lanes) = arguments.lanes {
        let is_meant = |set: &InstructionSet| set.machine_code() == Some(lanes);
        let set = InstructionSet::available().into_iter().find(is_meant);
        problem = problem.with_instruction_set(set.ok_or_else(|| format!("no machine code with {lanes} lanes here"))?);
    }
    let setup = start.elapsed().as_secs_f64();

    let targets = sample.targets();
    let (mut times, mut evaluations, mut memory) = (Vec::new(), 0, None);
    for _ in 0..arguments.repetitions {
        let start = Instant::now();
        let (points, effort) = problem.solve_points(&targets, sample.counts, Some(first), memory.take());
        if points.solved() < points.len() {
            return Err(format!("{} of {} points are solved", points.solved(), points.len()));
        }
        times.push(format!("{:.9}", start.elapsed().as_secs_f64()));
        evaluations = effort.evaluations;
        memory = Some(points);
    }
    let points = memory.ok_or("no repetition")?;
    if !arguments.out.is_empty() {
        let failed = |error: std::io::Error| format!("{}: {error}", arguments.out);
        let mut file = BufWriter::new(File::create(&arguments.out).map_err(failed)?);
        for k in 0..points.len() {
            let (mut row, placed) = (points.unknowns(k), points.position_and_normal(k));
            if is_curved {
                row.truncate(1);
                // asked for is the second form −dr·dn, which is negative where the body is convex
                let [most, least] = points.principal_curvatures(k).ok_or("a point has no curvature")?;
                row.extend(placed.iter().chain(&[-least, -most]));
            } else {
                row.extend(placed);
            }
            row.iter().try_for_each(|value| file.write_all(&value.to_le_bytes())).map_err(failed)?;
        }
        file.flush().map_err(failed)?;
    }
    let mut report = String::new();
    let _ = write!(
        report,
        "{{\"cand\":\"flank\",\"job\":\"{}\",\"setup_s\":{setup:.6},\"evals_per_pt\":{:.3},\"peak_mb\":{:.1},\"solve_s\":[{}]}}",
        arguments.job,
        evaluations as f64 / points.len() as f64,
        peak_memory(),
        times.join(",")
    );
    Ok(report)
}

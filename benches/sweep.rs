//! Studies: cases of the common job on one thread and on two, in turns, with the memory that they take; cases of a contact that are compiled
//! once beside those that are computed from their texts; chunks of a study that stays open beside those for each of which it is opened.
//!
//! `cargo bench -p flank-benches --bench sweep`

use std::path::Path;
use std::time::Instant;

use flank::{
    CaseSource, Distribution, EvaluatorOptions, JobSelection, OpenStudy, Project, RunRequest, StudyChunks,
    SweepRequest, ToleratedAmount, Unwatched, plan_sweep, run_sweep,
};
use flank_benches::peak_memory;

const COMMON: [&str; 2] = [concat!(env!("CARGO_MANIFEST_DIR"), "/spiral_bevel.chain"), "flank"];
const PAIR: [&str; 2] = [concat!(env!("CARGO_MANIFEST_DIR"), "/../specs/pairs/bevel_19x62.chain"), "bevel_19x62"];
/// Each side of a comparison is the fastest of so many.
const ROUNDS: usize = 3;

fn main() {
    let is_test = std::env::args().any(|argument| argument == "--test");
    let [common, contacts, chunks] = if is_test { [64, 2, 2] } else { [10_000, 200, 20] };
    let rounds = if is_test { 1 } else { ROUNDS };
    let folder = tempfile::tempdir().expect("a folder");
    points(folder.path(), (common, rounds));
    println!("peak of the process so far: {:.1} MiB", peak_memory());
    contact(folder.path(), (contacts, rounds));
    opened(folder.path(), (chunks, rounds));
}

/// A study of random cases, made with all processors.
fn planned(folder: &Path, ([spec, job], scatter): ([&str; 2], &[(&str, f64)]), collect: &[&str], count: u64) {
    let settings =
        scatter.iter().map(|(name, mm)| (name.to_string(), Distribution::Normal(ToleratedAmount::Length(*mm))));
    let project = Project::open(spec, std::sync::Arc::new(flank::Disk));
    let request = SweepRequest {
        jobs: JobSelection { job: Some(job.to_string()), ..JobSelection::all(project) },
        cases: CaseSource::Scatter { settings: settings.collect(), count, seed: 7, sobol: false },
        keep_points: false,
        collect: collect.iter().map(|of| of.to_string()).collect(),
        out: folder.to_path_buf(),
        limit: None,
        evaluator: EvaluatorOptions::default(),
    };
    plan_sweep(&request, &Unwatched).expect("a plan");
}

/// Seconds of all chunks of a study, none of which is there, on so many threads.
fn run(folder: &Path, threads: usize) -> f64 {
    emptied(folder);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let request = RunRequest {
        study: folder.to_path_buf(),
        chunks: StudyChunks::All,
        again: Vec::new(),
        evaluator: EvaluatorOptions::default(),
    };
    let start = Instant::now();
    let found = pool.install(|| run_sweep(&request, &Unwatched)).expect("a run");
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(found.verdicts.get("done").copied(), Some(found.cases), "{:?}", found.verdicts);
    seconds
}

fn emptied(folder: &Path) {
    for chunk in std::fs::read_dir(folder.join("chunks")).expect("a study") {
        std::fs::remove_file(chunk.expect("a chunk").path()).expect("it is there");
    }
}

/// The fastest of some rounds of each, in turns.
fn in_turns<const N: usize>(rounds: usize, mut sides: [&mut dyn FnMut() -> f64; N]) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..rounds {
        best.iter_mut().zip(&mut sides).for_each(|(best, side)| *best = best.min(side()));
    }
    best
}

fn points(folder: &Path, (count, rounds): (u64, usize)) {
    let folder = folder.join("points");
    planned(&folder, (COMMON, &[("m.radial_distance", 0.01)]), &["points"], count);
    let mut processor = f64::INFINITY;
    let mut alone = || {
        let before = processor_time();
        let seconds = run(&folder, 1);
        processor = processor.min(processor_time() - before);
        seconds
    };
    let [one, two] = in_turns(rounds, [&mut alone, &mut || run(&folder, 2)]);
    let each = |seconds: f64| 1e3 * seconds / count as f64;
    println!(
        "{count} cases of the common job, 1,891 points each: {:.3} ms a case on one thread, {:.3} ms of a processor",
        each(one),
        each(processor)
    );
    println!("on two threads {:.3} ms a case, {:.2} times as fast", each(two), one / two);
}

/// What all threads together have used of processors, seconds; zero where the system does not tell.
fn processor_time() -> f64 {
    let status = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = status.rsplit_once(')').map_or("", |(_, rest)| rest);
    // in user and in system mode, hundredths
    let ticks = after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<f64>().ok());
    ticks.sum::<f64>() / 100.0
}

fn contact(folder: &Path, (count, rounds): (u64, usize)) {
    let scatter = [("p.radial_distance", 0.01), ("m.E", 0.01)];
    let [once, text] = ["contact", "texts"].map(|name| folder.join(name));
    planned(&once, (PAIR, &scatter), &["contact:drive_side"], count);
    // requirements need the text of each case
    let fewer = (count / 10).max(1);
    planned(&text, (PAIR, &scatter), &["contact:drive_side", "requirements"], fewer);
    let [of_once, of_text] = in_turns(rounds, [&mut || run(&once, 1), &mut || run(&text, 1)]);
    let [of_once, of_text] = [1e3 * of_once / count as f64, 1e3 * of_text / fewer as f64];
    println!(
        "a contact of 24 positions a pitch: {of_once:.2} ms a case of {count}, compiled once; {of_text:.2} ms from its text"
    );
}

fn opened(folder: &Path, (chunks, rounds): (u64, usize)) {
    let folder = folder.join("chunks");
    planned(&folder, (COMMON, &[("m.radial_distance", 0.01)]), &["points"], 200 * chunks);
    let plan = folder.join("plan.json");
    let mut document: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&plan).expect("a plan")).expect("a plan");
    document["chunk"] = 200.into();
    std::fs::write(&plan, document.to_string()).expect("a plan");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let open = || OpenStudy::open(&folder, EvaluatorOptions::default(), &Unwatched).expect("a study");
    let timed = |work: &mut (dyn FnMut() + Send)| {
        emptied(&folder);
        let start = Instant::now();
        pool.install(work);
        start.elapsed().as_secs_f64()
    };
    let one = |study: &OpenStudy, chunk: u64| {
        study.run(StudyChunks::Between(chunk as usize, chunk as usize), &[], &Unwatched).expect("a chunk");
    };
    let [whole, kept, anew] = in_turns(
        rounds,
        [
            &mut || timed(&mut || drop(open().run(StudyChunks::All, &[], &Unwatched).expect("a run"))),
            &mut || {
                timed(&mut || {
                    let study = open();
                    (0..chunks).for_each(|chunk| one(&study, chunk));
                })
            },
            &mut || timed(&mut || (0..chunks).for_each(|chunk| one(&open(), chunk))),
        ],
    );
    let over = |seconds: f64| 100.0 * (seconds / whole - 1.0);
    println!(
        "{chunks} chunks of {:.0} ms: {:+.2} % where the study stays open, {:+.2} % where it is opened for each, over one run of all",
        1e3 * whole / chunks as f64,
        over(kept),
        over(anew)
    );
}

//! `flank sweep`: many cases of a job, as a folder of chunks that any number of processes fill.

mod cases;
mod chunks;
mod drawn;
mod inputs;
mod journal;
pub(crate) mod plan;
pub(crate) mod request;
pub(crate) mod result;
mod row;
mod stored;
mod study;
mod table;

use std::path::Path;
use std::time::Instant;

use flank_export::{ParquetRows, write_atomically};
use flank_expr::Graph;

use self::chunks::Tally;
pub use self::journal::note_interruption;
use self::plan::Plan;
use self::request::{RunRequest, SweepRequest};
use self::result::SweepResult;
use self::row::{Cases, Collected};
pub use self::study::OpenStudy;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind};
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::project::spec;
use crate::project::{shown_path, units};

/// A chunk takes about so long, seconds.
const CHUNK: f64 = 1.0;
const FEWEST: u64 = 64;
const MOST: u64 = 65_536;
/// Cases that tell how long one takes.
const TRIED: u64 = 16;

/// Makes the plan of a study: a folder with the texts of the spec, what differs from case to case, and what is collected. Everything is
/// looked at before a case is computed.
///
/// # Errors
/// What is wrong with the spec, with the table of cases or with what is collected; that there is another study in the folder.
pub fn plan_sweep(request: &SweepRequest, monitor: &dyn Monitor) -> Result<SweepResult, Failure> {
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let [job] = &jobs[..] else {
        let names: Vec<&str> = jobs.iter().map(|job| job.name.as_str()).collect();
        let message = format!("a study is of one job; say which by the option `job`: {}", names.join(", "));
        return Err(Failure::Request(message));
    };
    if request.collect.is_empty() {
        let message =
            "say by the option `collect` what becomes of each case, for example `points` or `ease_off:SURFACE`";
        return Err(Failure::Request(message.to_string()));
    }
    let which = JobSelection { job: Some(job.name.clone()), ..request.jobs.clone() };
    let (inputs, values) = cases::read(job, &which, &request.cases, monitor)?;
    let collect = Collected::read_all(&request.collect)?;
    collect.iter().try_for_each(|of| of.check(job))?;
    let session = Session::new(request.evaluator, monitor);
    let chunk = {
        let tried = Cases::new(which.clone(), inputs.clone(), (&request.collect, None), session)?;
        tried.needs_texts(&job.name).iter().for_each(|remark| monitor.remark(remark));
        let start = Instant::now();
        let count = TRIED.min(values.count());
        for number in 0..count {
            tried.solved((number, &values.of_case(number, &inputs)), session)?;
        }
        let each = start.elapsed().as_secs_f64() / count as f64;
        ((CHUNK * rayon::current_num_threads() as f64 / each) as u64).clamp(FEWEST, MOST)
    };
    flank_export::make_folder(&request.out)?;
    let (main, hash) = plan::keep_texts(&compilation, &which, &request.out)?;
    let plan = Plan {
        inputs,
        cases: values,
        collect: collect.iter().map(Collected::to_string).collect(),
        heads: collect.iter().flat_map(|of| of.heads(job)).collect(),
        keep_points: request.keep_points,
        limit: request.limit.map(|limit| limit.as_secs_f64()),
        chunk,
        ..Plan::new(&which, main, hash)
    };
    let plan = kept_plan(&request.out, plan)?;
    plan.make_folders(&request.out)?;
    plan.write(&request.out)?;
    Ok(told(&request.out, &plan))
}

/// The plan that is in the folder already, if it is of the same study: its chunks keep their size.
fn kept_plan(folder: &Path, plan: Plan) -> Result<Plan, Failure> {
    if !folder.join(plan::PLAN).exists() {
        return Ok(plan);
    }
    let there = Plan::read_own(folder)?;
    if (Plan { chunk: there.chunk, ..plan }) == there {
        return Ok(there);
    }
    Err(Failure::Input(format!(
        "{} holds another study: of other texts, cases or numbers; name another folder by the option `out`",
        folder.display()
    )))
}

/// Computes the chunks of a study that are not there. The result is that of the chunks that are asked for.
///
/// # Errors
/// If there is no study, its texts are not those of its plan, something cannot be written, or the work is cancelled.
pub fn run_sweep(request: &RunRequest, monitor: &dyn Monitor) -> Result<SweepResult, Failure> {
    let study = OpenStudy::open(&request.study, request.evaluator, monitor)?;
    study.needs_texts().iter().for_each(|remark| monitor.remark(remark));
    study.run(request.chunks, &request.again, monitor)
}

/// How many chunks a study has, whether they are there or not.
///
/// # Errors
/// If there is no study.
pub fn sweep_chunks(study: &Path) -> Result<usize, Failure> {
    Ok(Plan::read(study)?.chunks())
}

/// How far a study is.
///
/// # Errors
/// If there is none.
pub fn sweep_status(study: &Path) -> Result<SweepResult, Failure> {
    Ok(told(study, &Plan::read(study)?))
}

/// Whether a file is what a study is made of, or would lie among that.
fn is_of_study(study: &Path, file: &Path) -> bool {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Some((study, folder)) = std::fs::canonicalize(study).ok().zip(std::fs::canonicalize(folder).ok()) else {
        return false;
    };
    let is_own = |name: &str| file.file_name().is_some_and(|own| own == name);
    folder.starts_with(&study) && (folder != study || is_own(plan::PLAN) || is_own(chunks::LOG))
}

/// All rows of a study in the order of its cases, with what is missing: as CSV, or in a file, whole or not at all, if one is named; then the
/// text is empty. A file whose name ends with `.parquet` is a table of Parquet, one with `.csv` or no ending CSV.
///
/// # Errors
/// If there is no study, the name of the file has another ending, or it cannot be written.
pub fn gather_sweep(study: &Path, out: Option<&Path>) -> Result<(String, SweepResult), Failure> {
    let plan = Plan::read(study)?;
    if let Some(file) = out.filter(|file| is_of_study(study, file)) {
        let message =
            format!("`{}` belongs to the study and would be written over: name another file", shown_path(file));
        return Err(Failure::Input(message));
    }
    let ending = out.and_then(Path::extension).map(|ending| ending.to_ascii_lowercase());
    let is_parquet = ending.as_ref().is_some_and(|ending| ending == "parquet");
    if let Some((file, other)) = out.zip(ending).filter(|(_, ending)| !is_parquet && ending != "csv") {
        let (file, other) = (shown_path(file), other.display());
        let message = format!("option `out {file}`: rows are not written as .{other}, only as .csv or .parquet");
        return Err(Failure::Request(message));
    }
    let (mut text, mut tally) = (String::new(), Tally::default());
    match out {
        Some(file) if is_parquet => write_atomically(file, |out| {
            let mut table = ParquetRows::new(&plan.columns(), &format!("flank {}", plan.version), out)?;
            plan.each_chunk(study, &mut tally, &mut |rows| {
                table.add(&rows.lines().skip(1).map(|row| row.split(',').collect()).collect::<Vec<_>>())
            })?;
            table.finish()
        })?,
        Some(file) => write_atomically(file, |out| {
            writeln!(out, "{}", plan.head())?;
            plan.each_chunk(study, &mut tally, &mut |rows| Ok(out.write_all(without_head(rows).as_bytes())?))
        })?,
        None => {
            text = plan.head() + "\n";
            plan.each_chunk(study, &mut tally, &mut |rows| {
                text += without_head(rows);
                Ok(())
            })
            .map_err(|reason| Failure::Input(reason.to_string()))?;
        }
    }
    let mut result = SweepResult::of(study, &plan, tally);
    result.files.extend(out.map(shown_path));
    let missing = plan.chunks() - result.done - result.damaged.len();
    if missing > 0 {
        let message = format!(
            "{missing} of {} of {} are not computed",
            units::counted(plan.chunks(), "chunk"),
            shown_path(study)
        );
        result.not_done.insert(0, NotDone::new(NotDoneKind::NotSolved, &plan.job, message));
    }
    Ok((text, result))
}

fn without_head(chunk: &str) -> &str {
    chunk.split_once('\n').map_or("", |(_, rows)| rows)
}

fn told(study: &Path, plan: &Plan) -> SweepResult {
    let mut tally = Tally::default();
    plan.each_chunk(study, &mut tally, &mut |_| Ok(())).expect("nothing is written");
    SweepResult::of(study, plan, tally)
}

#[cfg(test)]
mod tests {
    use super::request::{CaseSource, StudyChunks, VariedRange};
    use super::*;
    use crate::project::Project;
    use crate::project::monitor::Unwatched;
    use crate::project::session::EvaluatorOptions;

    fn made(out: &Path) {
        let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/bevel/pinion_19x62.chain");
        let ends = ["97.9 mm", "98.1 mm"].map(str::to_string);
        let evaluator = EvaluatorOptions::default();
        let request = SweepRequest {
            jobs: JobSelection {
                project: Project::open(spec, std::sync::Arc::new(flank_chain_dsl::Disk)),
                job: None,
                set: Vec::new(),
            },
            cases: CaseSource::Ranges(vec![VariedRange { name: "m.radial_distance".to_string(), ends, count: 2 }]),
            collect: vec!["at:concave[0,0]".to_string()],
            keep_points: false,
            out: out.to_path_buf(),
            limit: None,
            evaluator,
        };
        plan_sweep(&request, &Unwatched).expect("a plan");
        let run = RunRequest { study: out.to_path_buf(), chunks: StudyChunks::All, again: Vec::new(), evaluator };
        assert_eq!(run_sweep(&run, &Unwatched).expect("rows").done, 1);
    }

    /// A study as another version would have made it: its own hashes in its rows and names.
    #[test]
    fn a_study_of_another_version_is_read() {
        let folder = tempfile::tempdir().expect("a folder");
        made(folder.path());
        let own = Plan::read(folder.path()).expect("a plan");
        let other = Plan { version: "0.0.1".to_string(), ..own.clone() };
        let cases = [&own, &other].map(|plan| plan.hashes_of_cases(0));
        let files = [&own, &other].map(|plan| plan.stored(folder.path(), 0).file);
        let rows = std::fs::read_to_string(&files[0]).expect("rows");
        let rows = cases[0].iter().zip(&cases[1]).fold(rows, |rows, (own, other)| rows.replace(own, other));
        std::fs::write(&files[1], &rows).expect("a file");
        std::fs::remove_file(&files[0]).expect("it is there");
        other.write(folder.path()).expect("a plan");
        let (text, result) = gather_sweep(folder.path(), None).expect("it is read");
        assert_eq!((text, result.done, result.not_done.len()), (rows, 1, 0));
        let told = sweep_status(folder.path()).expect("it is read").to_string();
        assert!(told.contains("made by flank 0.0.1"), "{told}");
        let run = RunRequest {
            study: folder.path().to_path_buf(),
            chunks: StudyChunks::All,
            again: Vec::new(),
            evaluator: EvaluatorOptions::default(),
        };
        let refused = run_sweep(&run, &Unwatched).expect_err("nothing is added").to_string();
        assert!(refused.contains("rows of two programs do not go into one study"), "{refused}");
    }
}

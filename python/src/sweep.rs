//! Studies: many cases of a job in a folder of chunks.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use flank::{CaseSource, Distribution, Failure, Monitor, StudyChunks, SweepRequest, SweepResult, VariedRange};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPoolBuilder;

use crate::answer::Answer;
use crate::job::Job;
use crate::options::{Options, evaluator_of_all};
use crate::run::{STACK, run};

/// Makes the folder of a study.
#[pyfunction]
pub(crate) fn sweep_plan(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Answer> {
    let given = Options(options);
    let text: Option<String> = given.given("table")?;
    let file: Option<PathBuf> = given.given("cases")?;
    let ranges: Vec<(String, [String; 2], u32)> = given.or("vary", Vec::new())?;
    let uniform: Vec<String> = given.or("uniform", Vec::new())?;
    let amounts = given.amounts("scatter")?.into_iter().map(|(name, amount)| {
        let is_uniform = uniform.contains(&name);
        (name, if is_uniform { Distribution::Uniform(amount) } else { Distribution::Normal(amount) })
    });
    let settings: Vec<_> = amounts.collect();
    let (jobs, cases) = match (text, file, &ranges[..]) {
        (Some(text), ..) => (job.selection_with(Path::new(TABLE), text), CaseSource::Table(TABLE.into())),
        (None, Some(file), _) => (job.selection(), CaseSource::Table(file)),
        (None, None, []) => {
            let [count, seed] = [("count", 1000), ("seed", 0)].map(|(name, default)| given.or(name, default));
            let (count, seed) = (count?, seed?);
            (job.selection(), CaseSource::Scatter { settings, count, seed, sobol: given.or("sobol", false)? })
        }
        (None, None, _) => {
            let range = |(name, ends, count)| VariedRange { name, ends, count };
            (job.selection(), CaseSource::Ranges(ranges.into_iter().map(range).collect()))
        }
    };
    let request = SweepRequest {
        jobs,
        cases,
        keep_points: given.or("keep_points", false)?,
        collect: given.or("collect", Vec::new())?,
        out: given.or("out", PathBuf::new())?,
        limit: given.given("limit")?.map(Duration::from_secs_f64),
        evaluator: given.evaluator()?,
    };
    answered(py, run(py, move |monitor| flank::plan_sweep(&request, monitor))?)
}

/// What a table in memory is called.
const TABLE: &str = "cases";

/// A study whose job is compiled, for who computes its chunks one by one.
#[pyclass(frozen, module = "flank._flank")]
pub(crate) struct OpenStudy(Arc<flank::OpenStudy>);

#[pymethods]
impl OpenStudy {
    #[new]
    fn open(py: Python<'_>, study: PathBuf) -> PyResult<OpenStudy> {
        let opened = move |monitor: &dyn Monitor| flank::OpenStudy::open(&study, evaluator_of_all(), monitor);
        Ok(OpenStudy(Arc::new(run(py, opened)?)))
    }

    /// Whether the plan and the texts in the folder are still those that it was opened with.
    fn is_current(&self) -> bool {
        self.0.is_current()
    }

    /// Computes chunks that are not there, from the first to the last of two, or a part of so many, or all, on so many threads if they are
    /// named.
    #[pyo3(signature = (chunks=None, again=Vec::new(), threads=None, part=None))]
    fn run(
        &self,
        py: Python<'_>,
        chunks: Option<(usize, usize)>,
        again: Vec<String>,
        threads: Option<usize>,
        part: Option<(usize, usize)>,
    ) -> PyResult<Answer> {
        let study = Arc::clone(&self.0);
        let chunks = match (chunks, part) {
            (Some((first, last)), _) => StudyChunks::Between(first, last),
            (None, Some((part, parts))) => StudyChunks::Part(part, parts),
            (None, None) => StudyChunks::All,
        };
        let found = run(py, move |monitor| match threads {
            Some(threads) => {
                let pool = ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK).build();
                let pool = pool.map_err(|error| Failure::Request(error.to_string()))?;
                pool.install(|| study.run(chunks, &again, monitor))
            }
            None => study.run(chunks, &again, monitor),
        })?;
        answered(py, found)
    }
}

/// How many chunks a study has.
#[pyfunction]
pub(crate) fn sweep_chunks(py: Python<'_>, study: PathBuf) -> PyResult<usize> {
    run(py, move |_| flank::sweep_chunks(&study))
}

/// How far a study is.
#[pyfunction]
pub(crate) fn sweep_status(py: Python<'_>, study: PathBuf) -> PyResult<Answer> {
    answered(py, run(py, move |_| flank::sweep_status(&study))?)
}

/// Writes the rows that are there into a file.
#[pyfunction]
pub(crate) fn sweep_gather(py: Python<'_>, study: PathBuf, out: PathBuf) -> PyResult<Answer> {
    let (_, result) = run(py, move |_| flank::gather_sweep(&study, Some(&out)))?;
    answered(py, result)
}

/// The columns of the rows that are there, and how far the study is.
#[pyfunction]
pub(crate) fn sweep_columns(py: Python<'_>, study: PathBuf) -> PyResult<(Answer, Bound<'_, PyDict>)> {
    let (result, columns) = run(py, move |_| {
        let (text, result) = flank::gather_sweep(&study, None)?;
        let columns = Columns::read(&text, &result);
        Ok((result, columns))
    })?;
    let named = PyDict::new(py);
    named.set_item("case", columns.case)?;
    named.set_item("number", PyArray1::from_vec(py, columns.number))?;
    let mut numbers = columns.numbers.into_iter().map(|values| PyArray1::from_vec(py, values));
    for (head, values) in result.inputs.iter().zip(numbers.by_ref()) {
        named.set_item(head, values)?;
    }
    for (head, words) in ["verdict", "why", "branch"].into_iter().zip(columns.words) {
        named.set_item(head, words)?;
    }
    for (head, values) in result.collected.iter().zip(numbers) {
        named.set_item(head, values)?;
    }
    Ok((answered(py, result)?, named))
}

fn answered(py: Python<'_>, result: SweepResult) -> PyResult<Answer> {
    Answer::new(py, result, Vec::new())
}

/// Rows by their columns.
struct Columns {
    case: Vec<String>,
    number: Vec<u64>,
    /// Verdict, why, branch.
    words: [Vec<String>; 3],
    /// Inputs, then what is collected; NaN where a cell is empty.
    numbers: Vec<Vec<f64>>,
}

impl Columns {
    fn read(text: &str, result: &SweepResult) -> Columns {
        let inputs = result.inputs.len();
        let mut columns = Columns {
            case: Vec::new(),
            number: Vec::new(),
            words: [const { Vec::new() }; 3],
            numbers: vec![Vec::new(); inputs + result.collected.len()],
        };
        for row in text.lines().skip(1) {
            let mut cells = row.split(',');
            let mut next = || cells.next().unwrap_or_default();
            columns.case.push(next().to_string());
            columns.number.push(next().parse().unwrap_or_default());
            for k in 0..inputs {
                columns.numbers[k].push(next().parse().unwrap_or(f64::NAN));
            }
            columns.words.iter_mut().for_each(|words| words.push(next().to_string()));
            for values in &mut columns.numbers[inputs..] {
                values.push(next().parse().unwrap_or(f64::NAN));
            }
        }
        columns
    }
}

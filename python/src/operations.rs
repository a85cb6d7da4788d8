//! Operations on jobs: keyword arguments to requests, results to answers.

use std::path::PathBuf;

use flank::{
    ClampRange, ContactRequest, ConvertRequest, DeriveRequest, DeviationRequest, ElementOrder, Failure, FieldArray,
    FitRequest, KeptPlace, MeasureRequest, MeshRequest, MillRequest, Monitor, Onto, PlotRequest, PointGrid,
    ReportRequest, SolidPart, SolidRequest, SolveRequest, SynthesisRequest, ToleranceRequest, ViewRequest,
    WantedEaseOff,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answer::Answer;
use crate::failure;
use crate::job::Job;
use crate::options::Options;
use crate::run::run;

/// No files.
const NOWHERE: &str = "";

/// All results of an operation, with the points of each.
fn all<A: flank::Answer>(
    py: Python<'_>,
    operation: impl FnOnce(&dyn Monitor, &mut dyn FnMut(A)) -> Result<(), Failure> + Send + 'static,
    grids: impl Fn(&mut A) -> Vec<PointGrid>,
) -> PyResult<Vec<Answer>> {
    let answers = run(py, move |monitor| {
        let mut answers = Vec::new();
        operation(monitor, &mut |answer| answers.push(answer))?;
        Ok(answers)
    })?;
    let answer = |mut answer: A| {
        let grids = grids(&mut answer);
        Answer::new(py, answer, grids)
    };
    answers.into_iter().map(answer).collect()
}

/// The one result of an operation.
fn one<A: flank::Answer>(
    py: Python<'_>,
    operation: impl FnOnce(&dyn Monitor) -> Result<A, Failure> + Send + 'static,
    grids: impl Fn(&mut A) -> Vec<PointGrid>,
) -> PyResult<Answer> {
    let mut answer = run(py, operation)?;
    let grids = grids(&mut answer);
    Answer::new(py, answer, grids)
}

fn no_grids<A>(_: &mut A) -> Vec<PointGrid> {
    Vec::new()
}

#[pyfunction]
pub(crate) fn solve(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let request = SolveRequest {
        jobs: job.selection(),
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        step: given.given("step")?,
        limits: given.or("limits", false)?,
        no_picture: !given.or("picture", false)?,
        geometry: given.or("geometry", false)?,
        sensitivity: given.or("sensitivity", false)?,
        certify: given.or("certify", false)?,
        arrays: given.or("arrays", true)?,
        evaluator: given.evaluator()?,
    };
    all(
        py,
        move |monitor, each| flank::solve(&request, monitor, each),
        |solved: &mut flank::SolveResult| {
            let surfaces = solved.surfaces.iter_mut().map(flank::SurfaceResult::take_grid);
            let mut grids: Vec<PointGrid> = surfaces.collect();
            grids.extend(solved.lines.iter_mut().map(flank::LineResult::take_grid));
            grids
        },
    )
}

#[pyfunction]
pub(crate) fn solid(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let request = SolidRequest {
        jobs: job.selection(),
        part: given.kind("part", SolidPart::Gear)?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        step: given.given("step")?,
        deviation: given.or("deviation", 0.01)?,
        density: given.or("density", 7850.0)?,
        ball: given.given("ball")?,
        evaluator: given.evaluator()?,
    };
    all(py, move |monitor, each| flank::solid(&request, monitor, each), no_grids)
}

#[pyfunction]
pub(crate) fn mesh(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let teeth: u32 = given.or("teeth", 1)?;
    let mut request = MeshRequest {
        teeth: (teeth > 0).then_some(teeth),
        order: given.kind("order", ElementOrder::First)?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        evaluator: given.evaluator()?,
        ..MeshRequest::new(job.selection())
    };
    given.put("elements", &mut request.elements)?;
    all(py, move |monitor, each| flank::mesh(&request, monitor, each), no_grids)
}

#[pyfunction]
pub(crate) fn plot(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let request = PlotRequest {
        jobs: job.selection(),
        what: given.kinds("what")?,
        surface: given.or("surface", Vec::new())?,
        reference: given.given("reference")?,
        of: given.or("of", Vec::new())?,
        contact: given.or("contact", Vec::new())?,
        milling: given.given("milling")?,
        errors: given.mountings("errors")?,
        positions: given.given("positions")?,
        compound: given.given("compound")?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        size: given.or("size", (1200, 900))?,
        no_origin: given.or("no_origin", false)?,
        evaluator: given.evaluator()?,
    };
    all(py, move |monitor, each| flank::plot(&request, monitor, each), no_grids)
}

#[pyfunction]
pub(crate) fn report(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let request = ReportRequest {
        jobs: job.selection(),
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        certify: given.or("certify", false)?,
        step: given.given("step")?,
        date: given.given("date")?,
        evaluator: given.evaluator()?,
    };
    all(py, move |monitor, each| flank::report(&request, monitor, each), no_grids)
}

#[pyfunction]
pub(crate) fn view(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let request = ViewRequest {
        jobs: job.selection(),
        out: given.or("out", PathBuf::from(NOWHERE))?,
        evaluator: given.evaluator()?,
    };
    all(py, move |monitor, each| flank::view(&request, monitor, each), no_grids)
}

#[pyfunction]
#[pyo3(signature = (job, surface, options, other=None))]
pub(crate) fn deviation(
    py: Python<'_>,
    job: &Job,
    surface: String,
    options: &Bound<'_, PyDict>,
    other: Option<&Job>,
) -> PyResult<Answer> {
    let given = Options(options);
    let request = DeviationRequest {
        jobs: job.selection(),
        surface,
        reference: given.given("reference")?,
        reference_jobs: other.map(Job::selection),
        measured: given.given("measured")?,
        rows: given.given("rows")?,
        columns: given.given("columns")?,
        margin: given.given("margin")?,
        no_align: given.or("no_align", false)?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        no_picture: !given.or("picture", false)?,
        evaluator: given.evaluator()?,
    };
    one(
        py,
        move |monitor| flank::deviation(&request, monitor),
        |found: &mut flank::DeviationResult| {
            let labels =
                found.directions.each_ref().map(|of| of.as_ref().map_or(String::new(), |of| of.direction.clone()));
            vec![PointGrid {
                name: found.from.clone(),
                frame: found.from_frame.clone(),
                counts: found.counts(),
                labels,
                positions: found.positions().to_vec(),
                fields: vec![FieldArray {
                    name: "deviation".to_string(),
                    unit: "um".to_string(),
                    meaning: "along the normal, plus is material".to_string(),
                    width: 1,
                    values: found.deviations().to_vec(),
                }],
                ..PointGrid::default()
            }]
        },
    )
}

#[pyfunction]
#[pyo3(signature = (job, surface, options, other=None))]
pub(crate) fn fit(
    py: Python<'_>,
    job: &Job,
    surface: &str,
    options: &Bound<'_, PyDict>,
    other: Option<&Job>,
) -> PyResult<Answer> {
    let given = Options(options);
    let parabola = |[a, b, c, d, bias]: [f64; 5]| WantedEaseOff { slopes: [a, b], crownings: [c, d], bias };
    let kept = |(name, is_line): (String, bool)| (name, if is_line { KeptPlace::Line } else { KeptPlace::Middle });
    let mut request = FitRequest {
        measured: given.given("measured")?,
        and: given.given("and")?,
        rows: given.given("rows")?,
        columns: given.given("columns")?,
        margin: given.given("margin")?,
        ease_off: given.given("ease_off")?.map(parabola),
        ease_off_table: given.given("ease_off_table")?,
        from: given.given("from")?,
        from_jobs: other.map(Job::selection),
        vary: given.or("vary", Vec::new())?,
        order: given.given("order")?,
        noise: given.given("noise")?,
        round: given.amounts("round")?,
        keep: given.or::<Vec<_>>("keep", Vec::new())?.into_iter().map(kept).collect(),
        write: given.given("write")?,
        dry: given.or("dry", false)?,
        evaluator: given.evaluator()?,
        ..FitRequest::new(job.selection(), surface)
    };
    given.put("as_it_lies", &mut request.as_it_lies)?;
    given.put("is_thickness_free", &mut request.is_thickness_free)?;
    given.put("share", &mut request.share)?;
    given.put("within", &mut request.within)?;
    given.put("resolution", &mut request.resolution)?;
    let found = run(py, move |monitor| flank::fit(&request, monitor))?;
    let settings = found.identification.as_ref().unwrap_or(&found.correction);
    let covariance = settings.covariance.clone();
    Ok(Answer::new(py, found, Vec::new())?.with_covariance(covariance))
}

#[pyfunction]
pub(crate) fn synthesis(py: Python<'_>, job: &Job, want: &str, options: &Bound<'_, PyDict>) -> PyResult<Answer> {
    let given = Options(options);
    let request = SynthesisRequest {
        vary: given.or("vary", Vec::new())?,
        round: given.amounts("round")?,
        write: given.given("write")?,
        dry: given.or("dry", false)?,
        evaluator: given.evaluator()?,
        ..SynthesisRequest::new(job.selection(), want)
    };
    one(py, move |monitor| flank::synthesis(&request, monitor), no_grids)
}

#[pyfunction]
pub(crate) fn tolerance(py: Python<'_>, job: &Job, surface: &str, options: &Bound<'_, PyDict>) -> PyResult<Answer> {
    let given = Options(options);
    let mut request = ToleranceRequest {
        scatter: given.amounts("scatter")?,
        correlations: given.or("correlations", Vec::new())?,
        budget: given.amounts("budget")?,
        no_align: given.or("no_align", false)?,
        sweep: given.given("sweep")?,
        evaluator: given.evaluator()?,
        ..ToleranceRequest::new(job.selection(), surface)
    };
    given.put("limits", &mut request.limits)?;
    one(py, move |monitor| flank::tolerance(&request, monitor), no_grids)
}

#[pyfunction]
pub(crate) fn contact(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let mut request = ContactRequest {
        contact: given.given("contact")?,
        errors: given.mountings("errors")?,
        sensitivity: given.or("sensitivity", false)?,
        vhj: given.or("vhj", false)?,
        certify: given.or("certify", false)?,
        milled: given.given("milled")?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        no_picture: !given.or("picture", false)?,
        evaluator: given.evaluator()?,
        ..ContactRequest::new(job.selection())
    };
    given.put("positions", &mut request.positions)?;
    given.put("compound", &mut request.compound)?;
    all(
        py,
        move |monitor, each| flank::contact(&request, monitor, each),
        |found: &mut flank::ContactResult| std::mem::take(&mut found.grids),
    )
}

#[pyfunction]
pub(crate) fn mill(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let range = |(setting, ends): (String, [String; 2])| ClampRange { setting, ends };
    let mut request = MillRequest {
        milling: given.given("milling")?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        nc: given.kinds("nc")?,
        map: given.kinds("map")?,
        tool_centre_control: given.or("tool_centre_control", false)?,
        spindle: given.given("spindle")?,
        verify: given.given("verify")?,
        clamp: given.or::<Vec<_>>("clamp", Vec::new())?.into_iter().map(range).collect(),
        certify: given.given("certify")?,
        evaluator: given.evaluator()?,
        ..MillRequest::new(job.selection())
    };
    given.put("feed", &mut request.feed)?;
    given.put("approach", &mut request.approach)?;
    given.put("spaces", &mut request.spaces)?;
    given.put("rows", &mut request.rows)?;
    given.put("columns", &mut request.columns)?;
    all(py, move |monitor, each| flank::mill(&request, monitor, each), no_grids)
}

#[pyfunction]
pub(crate) fn measure(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Vec<Answer>> {
    let given = Options(options);
    let request = MeasureRequest {
        jobs: job.selection(),
        surface: given.or("surface", Vec::new())?,
        rows: given.or("rows", 5)?,
        columns: given.or("columns", 9)?,
        margin: given.given("margin")?,
        lines: given.given("lines")?,
        out: given.or("out", PathBuf::from(NOWHERE))?,
        format: given.kinds("format")?,
        evaluator: given.evaluator()?,
    };
    all(
        py,
        move |monitor, each| flank::measure(&request, monitor, each),
        |found: &mut flank::MeasureResult| std::mem::take(&mut found.grids),
    )
}

fn onto(given: Options<'_, '_>) -> PyResult<Onto> {
    Ok(Onto {
        surface: given.given("surface")?,
        tool_frame: given.given("tool_frame")?,
        work_frame: given.given("work_frame")?,
        evaluator: given.evaluator()?,
    })
}

#[pyfunction]
pub(crate) fn convert(py: Python<'_>, job: &Job, to: PathBuf, options: &Bound<'_, PyDict>) -> PyResult<Answer> {
    let given = Options(options);
    let request = ConvertRequest {
        jobs: job.selection(),
        to,
        onto: onto(given)?,
        fit: given.or("fit", Vec::new())?,
        starts: given.or("starts", flank::FIT_STARTS)?,
        positions: given.or("positions", 101)?,
        order: given.given("order")?,
        tolerance: given.given("tolerance")?,
        out: given.given("out")?,
        format: given.kinds("format")?,
        no_tables: given.0.get_item("format")?.is_none_or(|format| format.is_none()),
        nc: given.kinds("nc")?,
        time: given.given("time")?,
        emit: given.kinds("emit")?,
        emit_form: given.kinds("emit_form")?,
    };
    one(py, move |monitor| flank::convert(&request, monitor).map_err(unfit), no_grids)
        .map_err(|error| reclassed(py, error))
}

/// What another machine cannot do is not solved.
fn unfit(failure: Failure) -> Failure {
    match failure {
        Failure::Input(reason) => Failure::Unsolved(reason),
        other => other,
    }
}

/// What another machine cannot do, as an exception of its own.
fn reclassed(py: Python<'_>, error: PyErr) -> PyErr {
    let name = error.get_type(py).name().map_or(String::new(), |name| name.to_string());
    if name == "NotSolved" { failure::made(py, "ConversionError", (error.value(py).to_string(),)) } else { error }
}

#[pyfunction]
pub(crate) fn derive(py: Python<'_>, job: &Job, options: &Bound<'_, PyDict>) -> PyResult<Answer> {
    let given = Options(options);
    let request = DeriveRequest {
        jobs: job.selection(),
        latex: given.or("latex", false)?,
        to: given.given("to")?,
        onto: onto(given)?,
        cost: given.or("cost", false)?,
    };
    one(py, move |monitor| flank::derive(&request, monitor), no_grids)
}

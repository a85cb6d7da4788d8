//! What of a case becomes a row: from tapes that are compiled once, or from the text of the case.

mod collected;
mod compiled;
mod kept;
mod numbers;
mod opened;
mod text;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use flank_export::Header;
use flank_expr::Graph;
use flank_solver::SurfacePoint;

pub(super) use self::collected::Collected;
use self::compiled::Compiled;
use self::kept::KeptPoints;
use self::numbers::NominalPoints;
use super::inputs::StudyInput;
use crate::compare::deviation;
use crate::compare::map::find;
use crate::project::failure::Failure;
use crate::project::findings::Severity;
use crate::project::remark::{NotDone, Remark, RemarkKind};
use crate::project::requests::JobSelection;
use crate::project::session::Session;
use crate::solve::starts::Asked;

/// What may become of a case.
pub(super) const VERDICTS: [&str; 5] = ["done", "not all solved", "spec wrong", "limit", "crashed"];

/// What became of a case.
pub(super) struct Found {
    /// One of [`VERDICTS`].
    pub(super) verdict: &'static str,
    /// A code: of the first error of the spec, of the first thing that was not done.
    pub(super) why: String,
    /// `searched` among all branches, or `followed` from the job itself.
    pub(super) branch: &'static str,
    pub(super) numbers: Vec<Option<f64>>,
    /// Of each sampled surface, if they were solved.
    pub(super) points: Option<Vec<SolvedSample>>,
}

/// How many rows and columns a sample has in a case, and its points.
pub(super) type SolvedSample = ([usize; 2], Vec<SurfacePoint>);

impl Found {
    fn of_numbers(numbers: Vec<Option<f64>>, why: Option<String>, is_followed: bool) -> Found {
        let verdict = if why.is_none() { "done" } else { "not all solved" };
        let branch = if is_followed { "followed" } else { "searched" };
        Found { verdict, why: why.unwrap_or_default(), branch, numbers, points: None }
    }

    fn with_points(self, points: Option<Vec<SolvedSample>>) -> Found {
        Found { points, ..self }
    }
}

/// What all cases of a study have in common.
pub(super) struct Cases {
    which: JobSelection,
    inputs: Vec<StudyInput>,
    collect: Vec<Collected>,
    /// How many numbers each gives.
    widths: Vec<usize>,
    /// Of those that are compared with the job itself.
    nominal: Vec<Option<NominalPoints>>,
    /// Where cases differ by numbers in the equations alone; or why they do not.
    compiled: Result<Compiled, String>,
    kept: Option<KeptPoints>,
}

impl Cases {
    /// Points are kept under a header, if there is one.
    ///
    /// # Errors
    /// If something is not there, or the job is wrong.
    pub(super) fn new(
        which: JobSelection,
        inputs: Vec<StudyInput>,
        (collect, keep): (&[String], Option<Header>),
        session: Session<'_>,
    ) -> Result<Cases, Failure> {
        let collect = Collected::read_all(collect)?;
        let graph = Graph::new();
        let (_, jobs) = crate::project::spec::jobs(&graph, &which, session.monitor())?;
        let job = &jobs[0];
        let nominal = collect.iter().map(|of| {
            let Collected::EaseOff(name) = of else { return Ok(None) };
            let named = find(&jobs, name)?;
            let sample = collected::sample_of(job, name)?;
            let asked = Asked::with_centre(sample);
            let (points, lost) = deviation::solved(named, (&sample.coordinates, &asked.targets, asked.counts), session);
            match lost {
                Some(lost) => Err(Failure::NotDone(vec![lost])),
                None => Ok(Some(NominalPoints { asked, points })),
            }
        });
        let nominal: Vec<Option<NominalPoints>> = nominal.collect::<Result<_, _>>()?;
        collect.iter().try_for_each(|of| of.check(job))?;
        let widths = collect.iter().map(|of| of.heads(job).len()).collect();
        let compiled = Compiled::new((&which, job), &inputs, (&collect, &nominal), keep.is_some(), session)?;
        let kept = keep.map(|header| KeptPoints::new(job, header));
        Ok(Cases { which, inputs, collect, widths, nominal, compiled, kept })
    }

    /// Why each case is computed from its text, if so.
    pub(super) fn needs_texts(&self, job: &str) -> Option<Remark> {
        let why = self.compiled.as_ref().err()?;
        let message = format!(
            "each case of `{job}` is compiled from its text, which may take ten times as long as where the job is compiled once: {why}"
        );
        Some(Remark::new(RemarkKind::FromTexts, job, message))
    }

    /// A case with these values of the inputs; whatever happens becomes a verdict.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn solved(&self, case: (u64, &[f64]), session: Session<'_>) -> Result<Found, Failure> {
        match catch_unwind(AssertUnwindSafe(|| self.found(case, session))) {
            Ok(Ok(found)) => Ok(found),
            Ok(Err(Failure::Cancelled)) => Err(Failure::Cancelled),
            Ok(Err(Failure::Findings(findings))) => {
                let list = findings.list();
                let first = list.iter().find(|finding| finding.severity == Severity::Error);
                Ok(self.nothing("spec wrong", first.map_or("", |finding| finding.code)))
            }
            Ok(Err(other)) => Ok(self.nothing("not all solved", &told(&other))),
            Err(_) => Ok(self.nothing("crashed", "panic")),
        }
    }

    /// A case of which nothing is known.
    pub(super) fn nothing(&self, verdict: &'static str, why: &str) -> Found {
        let numbers = vec![None; self.widths.iter().sum()];
        Found { verdict, why: why.to_string(), branch: "", numbers, points: None }
    }

    /// Writes the points of a case with these values into a file, whole or not at all, if they are kept and known.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn keep(&self, file: &Path, values: &[f64], found: &Found) -> Result<(), Failure> {
        match (&self.kept, &found.points) {
            (Some(kept), Some(points)) => kept.write(file, self.inputs.iter().zip(values), points),
            _ => Ok(()),
        }
    }

    fn found(&self, case: (u64, &[f64]), session: Session<'_>) -> Result<Found, Failure> {
        session.check()?;
        if let Ok(compiled) = &self.compiled {
            let nothing = |verdict, why: &str| self.nothing(verdict, why);
            if let Some(found) = compiled.found(case, &self.nominal, nothing, session)? {
                return Ok(found);
            }
        }
        text::found(
            &self.which,
            self.inputs.iter().zip(case.1),
            (&self.collect, &self.nominal),
            self.kept.is_some(),
            session,
        )
    }
}

/// The kind of a failure as data.
fn told(failure: &Failure) -> String {
    let kind = match failure {
        Failure::NotDone(all) => all.first().map(kind_of),
        _ => None,
    };
    kind.unwrap_or_else(|| "not_solved".to_string())
}

fn kind_of(of: &NotDone) -> String {
    let kind = serde_json::to_value(of.kind).ok();
    kind.and_then(|kind| kind.as_str().map(str::to_string)).unwrap_or_default()
}

//! What takes longer than an answer may: solving, reports, the page that follows.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;

use flank::{
    EvaluatorOptions, Failure, JobSelection, Project, ReportFormat, ReportRequest, ShippedFiles, SolveRequest,
    SolveResult, analyse,
};
use gen_lsp_types::{TextDocumentContentParams, TextDocumentContentResult};
use lsp_server::Notification;
use serde_json::Value;

use super::documents::Documents;
use super::server::Event;
use super::server::progress::{Followed, Running};
use super::uri;
use crate::Spelling;
use crate::live::Live;

/// The commands that editors may ask for.
pub(super) const COMMANDS: [&str; 4] = ["flank.solve", "flank.preview", "flank.report", "flank.explain"];

/// A command with its arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    Solve { uri: String, job: String },
    Preview { uri: String, job: Option<String> },
    Report { uri: String, job: String },
    Explain { page: String },
}

impl Asked {
    /// # Errors
    /// If there is no such command, or an argument lacks.
    pub(super) fn read(params: Value) -> Result<Asked, String> {
        let command = params.get("command").and_then(Value::as_str).unwrap_or_default().to_string();
        let argument =
            |number: usize| params.pointer(&format!("/arguments/{number}")).and_then(Value::as_str).map(str::to_string);
        let needed = |number: usize, what: &str| argument(number).ok_or(format!("`{command}` takes {what}"));
        match command.as_str() {
            "flank.solve" => {
                Ok(Asked::Solve { uri: needed(0, "an address and a job")?, job: needed(1, "an address and a job")? })
            }
            "flank.report" => {
                Ok(Asked::Report { uri: needed(0, "an address and a job")?, job: needed(1, "an address and a job")? })
            }
            "flank.preview" => Ok(Asked::Preview { uri: needed(0, "an address")?, job: argument(1) }),
            "flank.explain" => {
                let page = needed(0, "a code")?;
                let is_address = page.starts_with(uri::ERRORS);
                Ok(Asked::Explain { page: if is_address { page } else { format!("{}:/{page}.md", uri::ERRORS) } })
            }
            _ => Err(format!("there is no command `{command}`: there is {}", COMMANDS.join(", "))),
        }
    }
}

/// What became of a job.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) spec: PathBuf,
    pub(super) job: String,
    /// The texts that it was solved from: their generation, and what tells them from others.
    pub(super) generation: u64,
    pub(super) texts: u64,
    /// `concave 465/465 · 0.9e-12`, or why not.
    pub(super) told: Result<String, String>,
    /// How far parameters move surfaces, by their names with the job's.
    pub(super) influences: Vec<(String, String)>,
}

/// What solves have found, by spec and job. It is about the texts that it was found from, and about no others.
#[derive(Clone, Debug, Default)]
pub(super) struct Solves {
    of: Arc<BTreeMap<(PathBuf, String), Outcome>>,
}

impl Solves {
    pub(super) fn put(&mut self, outcome: Outcome) {
        Arc::make_mut(&mut self.of).insert((outcome.spec.clone(), outcome.job.clone()), outcome);
    }

    pub(super) fn is_known_of(&self, spec: &Path) -> bool {
        self.of(spec).next().is_some()
    }

    /// What stands beside the lens of a job.
    pub(super) fn told<'s>(&'s self, spec: &'s Path, job: &str, texts: u64) -> Option<&'s str> {
        let found = self.of(spec).find(|found| found.texts == texts && found.job == job)?;
        found.told.as_deref().ok()
    }

    /// How far a parameter moves surfaces, `job.m.swivel`.
    pub(super) fn influence<'s>(&'s self, spec: &'s Path, parameter: &str, texts: u64) -> Option<&'s str> {
        let now = self.of(spec).filter(|found| found.texts == texts);
        let (_, told) = now.flat_map(|found| &found.influences).find(|(name, _)| name == parameter)?;
        Some(told)
    }

    fn of<'s>(&'s self, spec: &'s Path) -> impl Iterator<Item = &'s Outcome> {
        let from = (spec.to_path_buf(), String::new());
        self.of.range(from..).take_while(move |((of, _), _)| of == spec).map(|(_, outcome)| outcome)
    }
}

/// Work that goes on beside the conversation.
pub(super) struct Tasks {
    events: SyncSender<Event>,
    pub(super) running: Running,
    live: Option<Live>,
    /// The spec that the page shows.
    shown: Option<PathBuf>,
    job: Option<String>,
    spelled: Spelling,
}

impl Tasks {
    pub(super) fn new(events: SyncSender<Event>, spelled: Spelling) -> Tasks {
        Tasks { events, running: Running::default(), live: None, shown: None, job: None, spelled }
    }

    /// Starts a command; what it answers at once.
    ///
    /// # Errors
    /// If the text is not open, or the system lets nothing start.
    pub(super) fn start(&mut self, asked: Asked, documents: &Documents) -> Result<Value, String> {
        let opened = |address: &str| {
            let found = documents.find(address).map(|(path, _)| path);
            found.ok_or(format!("{address} is not open"))
        };
        let spelled = self.spelled;
        match asked {
            Asked::Solve { uri, job } => {
                let (spec, project) = spec(opened(&uri)?, documents);
                let (events, generation) = (self.events.clone(), documents.generation);
                let followed = self.running.begin(format!("solving {job}"), &events);
                begin(move || {
                    let outcome = solve((spec, project, generation), job, &followed, spelled);
                    let _ = events.send(Event::Solved(outcome));
                })?;
                Ok(Value::Null)
            }
            Asked::Report { uri, job } => {
                let (spec, project) = spec(opened(&uri)?, documents);
                let events = self.events.clone();
                let followed = self.running.begin(format!("the report of {job}"), &events);
                begin(move || {
                    let (kind, message) = match report((&spec, project), job, &followed, spelled) {
                        Ok(file) => (3, format!("wrote {file}")),
                        Err(reason) => (1, reason),
                    };
                    let params = serde_json::json!({ "type": kind, "message": message });
                    let _ = events.send(Event::Tell(Notification::new("window/showMessage".to_string(), params)));
                })?;
                Ok(Value::Null)
            }
            Asked::Preview { uri, job } => {
                let path = opened(&uri)?;
                if self.live.is_none() {
                    let live = Live::start(EvaluatorOptions::default(), self.spelled);
                    self.live = Some(live.map_err(|error| format!("cannot serve a page: {error}"))?);
                }
                self.job = job;
                self.show(&path, documents);
                Ok(self.live.as_ref().map_or(Value::Null, |live| serde_json::json!({ "url": live.url })))
            }
            Asked::Explain { page: address } => page(&address).map(Value::from),
        }
    }

    fn show(&mut self, path: &Path, documents: &Documents) {
        let Some(live) = &self.live else { return };
        self.shown = Some(path.to_path_buf());
        live.show(spec(path.to_path_buf(), documents).1, self.job.clone(), &[]);
    }

    /// The spec in focus is shown, where a page is open.
    pub(super) fn focus(&mut self, path: &Path, documents: &Documents) {
        let is_shipped = ShippedFiles::inside(path).is_some();
        if self.live.is_some() && !is_shipped && self.shown.as_deref() != Some(path) {
            self.job = None;
            self.show(path, documents);
        }
    }

    /// A text was saved: the page follows, if it shows it or a spec that uses it.
    pub(super) fn follow(&mut self, path: &Path, readers: &[PathBuf], documents: &Documents) {
        let Some(shown) = self.shown.clone() else { return };
        if shown == path || readers.contains(&shown) {
            self.show(&shown, documents);
        }
    }
}

/// A spec as it is in the editor now.
fn spec(path: PathBuf, documents: &Documents) -> (PathBuf, Project) {
    let project = Project::open(&path, Arc::new(documents.clone()));
    (path, project)
}

fn begin(work: impl FnOnce() + Send + 'static) -> Result<(), String> {
    /// As many as the main thread of a program has: texts are compiled.
    const STACK: usize = 16 << 20;
    let builder = std::thread::Builder::new().name("lsp task".to_string()).stack_size(STACK);
    builder.spawn(work).map(drop).map_err(|error| format!("cannot start: {error}"))
}

fn in_words(failure: &Failure, spelled: Spelling) -> String {
    match failure {
        Failure::Findings(findings) => {
            let [errors, _] = findings.counts();
            let first = findings.list().into_iter().next().map_or(String::new(), |first| first.message);
            format!("{errors} error{}: {first}", if errors == 1 { "" } else { "s" })
        }
        other => spelled(&other.to_string()),
    }
}

/// Solves a job without writing anything.
fn solve(
    (spec, project, generation): (PathBuf, Project, u64),
    job: String,
    followed: &Followed,
    spelled: Spelling,
) -> Outcome {
    let texts = analyse(&project).texts();
    let selection = JobSelection { project, job: Some(job.clone()), set: Vec::new() };
    // where nothing is written, no folder is made that was not there
    let out = spec.parent().unwrap_or(Path::new(".")).to_path_buf();
    let request = |sensitivity| SolveRequest {
        arrays: false,
        jobs: selection.clone(),
        out: out.clone(),
        format: Vec::new(),
        step: None,
        limits: false,
        no_picture: true,
        geometry: false,
        sensitivity,
        certify: false,
        evaluator: EvaluatorOptions::default(),
    };
    let (mut told, mut influences) = (Vec::new(), Vec::new());
    let mut take = |result: SolveResult| {
        for surface in &result.surfaces {
            let summary = &surface.summary;
            let worst = summary.worst_residual.map_or(String::new(), |worst| format!(" · {worst:.1e}"));
            told.push(format!("{} {}/{}{worst}", summary.name, summary.solved, summary.asked));
            for influence in surface.sensitivity.iter().flat_map(|table| &table.parameters) {
                let name = format!("{}.{}", result.job, influence.name);
                let text = format!(
                    "moves `{}` by {:.3} {} (rms), {:.3} at most",
                    summary.name, influence.rms, influence.unit, influence.largest
                );
                influences.push((name, text));
            }
        }
    };
    // of very many points there is no room for more than themselves
    let solved = match flank::solve(&request(true), followed, &mut take) {
        Err(Failure::TooLarge(_)) => flank::solve(&request(false), followed, &mut take),
        other => other,
    };
    let told = solved.map(|()| told.join(", ")).map_err(|failure| in_words(&failure, spelled));
    Outcome { spec, job, generation, texts, told, influences: joined(influences) }
}

/// What is said of one parameter for several surfaces.
fn joined(influences: Vec<(String, String)>) -> Vec<(String, String)> {
    let mut joined: Vec<(String, String)> = Vec::new();
    for (name, text) in influences {
        match joined.iter_mut().find(|(known, _)| *known == name) {
            Some((_, known)) => *known += &format!("\n\n{text}"),
            None => joined.push((name, text)),
        }
    }
    joined
}

/// Writes the report of a job into the folder `build` beside its spec, and names the file.
fn report(
    (spec, project): (&Path, Project),
    job: String,
    followed: &Followed,
    spelled: Spelling,
) -> Result<String, String> {
    let out = spec.parent().unwrap_or(Path::new(".")).join("build");
    let request = ReportRequest {
        jobs: JobSelection { project, job: Some(job), set: Vec::new() },
        out,
        format: vec![ReportFormat::Html],
        certify: false,
        step: None,
        date: None,
        evaluator: EvaluatorOptions::default(),
    };
    let mut files = Vec::new();
    flank::report(&request, followed, &mut |result| files.extend(result.files.iter().cloned()))
        .map_err(|failure| in_words(&failure, spelled))?;
    files.into_iter().next().ok_or("nothing was written".to_string())
}

/// The text of a document that is no file.
///
/// # Errors
/// If there is no such document.
pub(super) fn content(params: TextDocumentContentParams) -> Result<TextDocumentContentResult, String> {
    page(&params.uri.0).map(|text| TextDocumentContentResult { text })
}

/// A text of the shipped library, or the page about a code.
///
/// # Errors
/// If there is no such document.
pub(super) fn page(address: &str) -> Result<String, String> {
    let missing = || format!("there is no document {address}");
    if let Some(code) = address.strip_prefix(uri::ERRORS).and_then(|rest| rest.strip_prefix(":/")) {
        let code = code.trim_start_matches('/').trim_end_matches(".md");
        let known = flank::Code::ALL.iter().find(|known| known.as_str() == code).ok_or_else(missing)?;
        return Ok(flank::error_page(*known).to_string());
    }
    let path = uri::path(address);
    let text = ShippedFiles::inside(&path).and_then(ShippedFiles::text);
    text.map(str::to_string).ok_or_else(missing)
}

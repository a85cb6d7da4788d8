//! The loop: changes in their order, answers from snapshots.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use flank::Analysis;
use gen_lsp_types::{
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams, DidSaveTextDocumentParams,
    InitializeParams,
};
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::Spelling;
use super::answers::{browse, edit, look};
use super::capabilities;
use super::diagnostics::Findings;
use super::documents::{Document, Documents};
use super::snapshot::{Analyses, Options, Snapshot};
use super::tasks::{self, Tasks};

/// Findings wait until nothing has changed for so long.
const SILENCE: Duration = Duration::from_millis(80);
/// What is typed in is compiled once nothing has changed for so long: when the silence is over, its findings are there.
const HEAD_START: Duration = Duration::from_millis(40);
/// A picture that follows changes, not only saves, waits for so long.
const PICTURE_SILENCE: Duration = Duration::from_millis(300);
/// What else reads a changed text is compiled once the editor has been quiet for so long: on few processors it would be in the way of answers. Nor does it wait longer
/// than this.
const CALM: Duration = Duration::from_millis(100);
const PATIENCE: Duration = Duration::from_secs(2);
/// Bytes of stack of a thread that compiles: as many as the main thread of a program has.
const STACK: usize = 16 << 20;
/// Threads that answer, and those that compile what was changed: one spec after the other, and beside it the one that is typed in.
const ANSWERING: usize = 2;
const COMPILING: usize = 2;

/// What the loop hears of.
#[derive(Debug)]
pub(super) enum Event {
    Message(Message),
    /// Something that is no message, and why.
    Unreadable(String),
    /// Nothing more is read.
    End,
    /// An answer, and the texts that it is about: of older ones it is dropped.
    Answer {
        response: Response,
        about: Option<(PathBuf, i32)>,
    },
    /// What is found in a spec; nothing where the server has a fault.
    Analysed {
        spec: PathBuf,
        version: i32,
        analysis: Option<Arc<Analysis>>,
    },
    /// A job is solved, or not.
    Solved(tasks::Outcome),
    /// Something for the editor.
    Tell(Notification),
}

/// How far the conversation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Begun,
    Open,
    ShutDown,
}

/// Threads that work beside the loop, once there is something to do.
struct Threads {
    name: &'static str,
    count: usize,
    pool: OnceLock<Option<ThreadPool>>,
}

impl Threads {
    const fn new(name: &'static str, count: usize) -> Threads {
        Threads { name, count, pool: OnceLock::new() }
    }

    /// Does work on one of them; on this thread, where the system lets none start.
    fn spawn(&self, work: impl FnOnce() + Send + 'static) {
        let pool = self.pool.get_or_init(|| {
            let name = self.name;
            let named = move |number| format!("lsp {name} {number}");
            ThreadPoolBuilder::new().num_threads(self.count).stack_size(STACK).thread_name(named).build().ok()
        });
        match pool {
            Some(pool) => pool.spawn(work),
            None => work(),
        }
    }
}

pub(super) struct Server<W> {
    to: W,
    events: SyncSender<Event>,
    answering: Threads,
    compilers: Threads,
    phase: Phase,
    documents: Documents,
    analyses: Analyses,
    findings: Findings,
    /// Specs that are to be compiled, and when.
    due: BTreeSet<PathBuf>,
    due_at: Option<Instant>,
    /// When what is typed in is compiled ahead of its time, and what is being compiled so.
    ahead_at: Option<Instant>,
    ahead: Option<PathBuf>,
    /// Those whose time has come; how many are being compiled.
    ready: BTreeSet<PathBuf>,
    compiling: usize,
    /// When the editor was last heard of, and since when specs that nobody types in wait.
    heard_at: Instant,
    waits_since: Instant,
    /// What was changed last, and what the editor shows: their own findings come first.
    edited: Option<PathBuf>,
    focused: Option<PathBuf>,
    picture_at: Option<(Instant, PathBuf)>,
    influences: Arc<BTreeMap<String, String>>,
    outcomes: Arc<BTreeMap<(PathBuf, String), String>>,
    tasks: Tasks,
    options: Options,
    /// Whether the picture follows changes, too.
    picture_follows_changes: bool,
    refreshes_lenses: bool,
    shows_documents: bool,
    /// Of requests to the editor.
    asked: i32,
    spelled: Spelling,
}

impl<W: Write> Server<W> {
    pub(super) fn new(to: W, events: SyncSender<Event>, spelled: Spelling) -> Server<W> {
        Server {
            to,
            tasks: Tasks::new(events.clone(), spelled),
            events,
            answering: Threads::new("answer", ANSWERING),
            compilers: Threads::new("compile", COMPILING),
            phase: Phase::Begun,
            documents: Documents::default(),
            analyses: Analyses::default(),
            findings: Findings::default(),
            due: BTreeSet::new(),
            due_at: None,
            ahead_at: None,
            ahead: None,
            ready: BTreeSet::new(),
            compiling: 0,
            heard_at: Instant::now(),
            waits_since: Instant::now(),
            edited: None,
            focused: None,
            picture_at: None,
            influences: Arc::default(),
            outcomes: Arc::default(),
            options: Options::default(),
            picture_follows_changes: false,
            refreshes_lenses: false,
            shows_documents: false,
            asked: 0,
            spelled,
        }
    }

    /// Serves until the end; true if the editor has shut it down before.
    pub(super) fn run(&mut self, events: &Receiver<Event>) -> io::Result<bool> {
        loop {
            let now = Instant::now();
            let picture_at = self.picture_at.as_ref().map(|(at, _)| *at);
            let next = [self.due_at, self.ahead_at, picture_at, self.calm_at()].into_iter().flatten().min();
            let event = match next {
                Some(at) if at <= now => {
                    self.wake(now);
                    continue;
                }
                Some(at) => events.recv_timeout(at - now),
                None => events.recv().map_err(RecvTimeoutError::from),
            };
            match event {
                Ok(Event::Message(Message::Notification(message))) if message.method == "exit" => {
                    return Ok(self.phase == Phase::ShutDown);
                }
                Ok(Event::End) | Err(RecvTimeoutError::Disconnected) => return Ok(self.phase == Phase::ShutDown),
                Ok(event) => self.take(event)?,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    fn take(&mut self, event: Event) -> io::Result<()> {
        if matches!(event, Event::Message(_)) {
            self.heard_at = Instant::now();
        }
        match event {
            Event::Message(Message::Request(request)) => self.request(request),
            Event::Message(Message::Notification(notification)) => self.notification(notification),
            Event::Message(Message::Response(_)) | Event::End => Ok(()),
            Event::Unreadable(reason) => self.unreadable(&reason),
            Event::Answer { response, about } => {
                let is_old = about.is_some_and(|(path, version)| {
                    self.documents.get(&path).is_none_or(|document| document.version != version)
                });
                if is_old {
                    let message = "the text has changed meanwhile".to_string();
                    return self
                        .send(&Response::new_err(response.id, ErrorCode::ContentModified as i32, message).into());
                }
                self.send(&response.into())
            }
            Event::Analysed { spec, version, analysis } => {
                self.compiling -= 1;
                // one of an older text has no more to do with what is compiled ahead now
                let is_now = self.documents.get(&spec).is_some_and(|document| document.version == version);
                self.ahead.take_if(|ahead| is_now && *ahead == spec);
                let told = analysis.map_or(Ok(()), |analysis| self.analysed(&spec, version, &analysis));
                self.compile(Instant::now());
                told
            }
            Event::Solved(outcome) => self.solved(outcome),
            Event::Tell(notification) => self.send(&notification.into()),
        }
    }

    fn send(&mut self, message: &Message) -> io::Result<()> {
        message.write(&mut self.to)
    }

    fn tell(&mut self, method: &str, params: impl Serialize) -> io::Result<()> {
        self.send(&Notification::new(method.to_string(), params).into())
    }

    fn ask(&mut self, method: &str, params: impl Serialize) -> io::Result<()> {
        self.asked += 1;
        self.send(&Request::new(RequestId::from(format!("flank-{}", self.asked)), method.to_string(), params).into())
    }

    /// What cannot be read has no number to answer to.
    fn unreadable(&mut self, reason: &str) -> io::Result<()> {
        let error = serde_json::json!({ "code": ErrorCode::ParseError as i32, "message": reason });
        let text = serde_json::json!({ "jsonrpc": "2.0", "id": null, "error": error }).to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        self.to.flush()
    }

    fn refuse(&mut self, id: RequestId, code: ErrorCode, message: impl Into<String>) -> io::Result<()> {
        self.send(&Response::new_err(id, code as i32, message.into()).into())
    }

    fn request(&mut self, request: Request) -> io::Result<()> {
        match (self.phase, request.method.as_str()) {
            (Phase::Begun, "initialize") => self.initialize(request),
            (Phase::Begun, _) => self.refuse(request.id, ErrorCode::ServerNotInitialized, "`initialize` comes first"),
            (Phase::ShutDown, _) => self.refuse(request.id, ErrorCode::InvalidRequest, "the server is shut down"),
            (Phase::Open, "initialize") => {
                self.refuse(request.id, ErrorCode::InvalidRequest, "it is initialized already")
            }
            (Phase::Open, "shutdown") => {
                self.phase = Phase::ShutDown;
                self.send(&Response::new_ok(request.id, Value::Null).into())
            }
            (Phase::Open, _) => self.answer(request),
        }
    }

    fn initialize(&mut self, request: Request) -> io::Result<()> {
        let params: InitializeParams = match serde_json::from_value(request.params) {
            Ok(params) => params,
            Err(error) => return self.refuse(request.id, ErrorCode::InvalidParams, error.to_string()),
        };
        let workspace = params.capabilities.workspace.as_ref();
        let items = params.capabilities.text_document.as_ref().and_then(|text| text.completion.as_ref());
        let items = items.and_then(|completion| completion.completion_item.as_ref());
        self.options.snippets = items.and_then(|item| item.snippet_support) == Some(true);
        let lens = workspace.and_then(|workspace| workspace.code_lens.as_ref());
        self.refreshes_lenses = lens.and_then(|lens| lens.refresh_support).unwrap_or(false);
        let window = params.capabilities.window.as_ref().and_then(|window| window.show_document.as_ref());
        self.shows_documents = window.is_some_and(|show| show.support);
        if let Some(options) = params.initialization_options {
            self.set_options(&options);
        }
        self.phase = Phase::Open;
        self.send(&Response::new_ok(request.id, capabilities::told()).into())
    }

    /// `{"inlayHints": {"literals": true}, "preview": {"onChange": true}}`
    fn set_options(&mut self, options: &Value) {
        let is_on = |path: &str| options.pointer(path).and_then(Value::as_bool);
        if let Some(literals) = is_on("/inlayHints/literals") {
            self.options.literal_values = literals;
        }
        if let Some(follows) = is_on("/preview/onChange") {
            self.picture_follows_changes = follows;
        }
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot {
            documents: self.documents.clone(),
            analyses: self.analyses.clone(),
            influences: Arc::clone(&self.influences),
            outcomes: Arc::clone(&self.outcomes),
            options: self.options,
            spelled: self.spelled,
        }
    }

    fn answer(&mut self, request: Request) -> io::Result<()> {
        match request.method.as_str() {
            "textDocument/hover" => self.answer_from(request, |snapshot, params| Ok(browse::hover(snapshot, params))),
            "textDocument/definition" => {
                self.answer_from(request, |snapshot, params| Ok(browse::definition(snapshot, params)))
            }
            "textDocument/references" => {
                self.answer_from(request, |snapshot, params| Ok(browse::references(snapshot, params)))
            }
            "textDocument/documentSymbol" => {
                self.answer_from(request, |snapshot, params| Ok(browse::symbols(snapshot, params)))
            }
            "textDocument/foldingRange" => {
                self.answer_from(request, |snapshot, params| Ok(browse::folding(snapshot, params)))
            }
            "textDocument/completion" => {
                self.answer_from(request, |snapshot, params| Ok(edit::completion(snapshot, params)))
            }
            "textDocument/formatting" => {
                self.answer_from(request, |snapshot, params| Ok(edit::format(snapshot, params)))
            }
            "textDocument/rangeFormatting" => {
                self.answer_from(request, |snapshot, params| Ok(edit::format_range(snapshot, params)))
            }
            "textDocument/codeAction" => {
                self.answer_from(request, |snapshot, params| Ok(edit::code_actions(snapshot, params)))
            }
            "textDocument/prepareRename" => self.answer_from(request, edit::prepare_rename),
            "textDocument/rename" => self.answer_from(request, edit::rename),
            "textDocument/semanticTokens/full" => {
                self.answer_from(request, |snapshot, params| Ok(look::tokens(snapshot, params)))
            }
            "textDocument/inlayHint" => {
                self.answer_from(request, |snapshot, params| Ok(look::inlay_hints(snapshot, params)))
            }
            "textDocument/codeLens" => self.answer_from(request, |snapshot, params| Ok(look::lenses(snapshot, params))),
            "workspace/textDocumentContent" => self.answer_from(request, |_, params| tasks::content(params)),
            "workspace/executeCommand" => self.execute(request),
            method => {
                let message = format!("`{method}` is not served");
                self.refuse(request.id, ErrorCode::MethodNotFound, message)
            }
        }
    }

    /// Answers on another thread, from the texts as they are now.
    fn answer_from<P, R>(
        &mut self,
        request: Request,
        answer: impl FnOnce(&Snapshot, P) -> Result<R, String> + Send + 'static,
    ) -> io::Result<()>
    where
        P: DeserializeOwned + Send + 'static,
        R: Serialize,
    {
        let uri = request.params.pointer("/textDocument/uri").and_then(Value::as_str);
        let about = uri.and_then(|uri| self.documents.find(uri));
        let about = about.map(|(path, document)| (path, document.version));
        let params: P = match serde_json::from_value(request.params) {
            Ok(params) => params,
            Err(error) => return self.refuse(request.id, ErrorCode::InvalidParams, error.to_string()),
        };
        let (snapshot, events, id) = (self.snapshot(), self.events.clone(), request.id);
        self.answering.spawn(move || {
            let answered = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| answer(&snapshot, params)));
            let response = match answered {
                Ok(Ok(result)) => Response::new_ok(id, result),
                Ok(Err(reason)) => Response::new_err(id, ErrorCode::RequestFailed as i32, reason),
                Err(_) => Response::new_err(id, ErrorCode::InternalError as i32, "the server has a fault".to_string()),
            };
            // where nobody hears any more, nobody asks
            let _ = events.send(Event::Answer { response, about });
        });
        Ok(())
    }

    fn notification(&mut self, notification: Notification) -> io::Result<()> {
        if self.phase != Phase::Open {
            return Ok(());
        }
        let params = notification.params;
        match notification.method.as_str() {
            "textDocument/didOpen" => {
                let Ok(DidOpenTextDocumentParams { text_document: opened }) = serde_json::from_value(params) else {
                    return Ok(());
                };
                let document = Document { uri: opened.uri.0, version: opened.version, text: opened.text.into() };
                let path = self.documents.open(document);
                self.changed(Some(&path), Duration::ZERO);
            }
            "textDocument/didChange" => {
                let Ok(params) = serde_json::from_value::<DidChangeTextDocumentParams>(params) else { return Ok(()) };
                let uri = params.text_document.text_document_identifier.uri;
                let Some(path) = self.documents.find(&uri.0).map(|(path, _)| path) else { return Ok(()) };
                if self.documents.change(&path, params.text_document.version, params.content_changes) {
                    self.changed(Some(&path), SILENCE);
                    if self.picture_follows_changes {
                        self.picture_at = Some((Instant::now() + PICTURE_SILENCE, path));
                    }
                }
            }
            "textDocument/didClose" => {
                let Ok(params) = serde_json::from_value::<DidCloseTextDocumentParams>(params) else { return Ok(()) };
                let Some(path) = self.documents.find(&params.text_document.uri.0).map(|(path, _)| path) else {
                    return Ok(());
                };
                self.documents.close(&path);
                self.due.remove(&path);
                self.ready.remove(&path);
                self.changed(Some(&path), SILENCE);
                let snapshot = self.snapshot();
                for told in self.findings.remove(&path, &snapshot) {
                    self.tell("textDocument/publishDiagnostics", told)?;
                }
            }
            "textDocument/didSave" => {
                let Ok(params) = serde_json::from_value::<DidSaveTextDocumentParams>(params) else { return Ok(()) };
                if let Some((path, _)) = self.documents.find(&params.text_document.uri.0) {
                    self.show_picture(&path);
                }
            }
            // files that are not open: whatever was read may be another text now
            "workspace/didChangeWatchedFiles" => self.changed(None, SILENCE),
            "workspace/didChangeConfiguration" => {
                let settings = params.pointer("/settings/flank").or_else(|| params.get("settings"));
                if let Some(settings) = settings.cloned() {
                    self.set_options(&settings);
                }
            }
            "flank/didFocus" => {
                let uri = params.pointer("/textDocument/uri").and_then(Value::as_str);
                if let Some((path, _)) = uri.and_then(|uri| self.documents.find(uri)) {
                    self.tasks.focus(&path, &self.documents);
                    self.focused = Some(path);
                }
            }
            // others are for other servers
            _ => {}
        }
        Ok(())
    }

    /// A text has changed: what it is part of is compiled anew after a while.
    fn changed(&mut self, file: Option<&Path>, after: Duration) {
        self.analyses.forget(file, self.documents.generation);
        self.ahead = None;
        self.ahead_at = None;
        match file {
            Some(file) => {
                self.ahead_at = (after > HEAD_START).then(|| Instant::now() + HEAD_START);
                self.due.extend(self.findings.readers(file));
                self.due.insert(file.to_path_buf());
                self.edited = Some(file.to_path_buf());
            }
            None => self.due.extend(self.documents.paths().cloned()),
        }
        self.due_at = Some(Instant::now() + after);
    }

    fn wake(&mut self, now: Instant) {
        if self.ahead_at.take_if(|at| *at <= now).is_some()
            && self.compiling == 0
            && let Some(spec) = self.edited.clone()
        {
            self.begin(&spec);
            self.ahead = Some(spec);
        }
        if self.due_at.is_some_and(|at| at <= now) {
            self.due_at = None;
            if self.ready.is_empty() {
                self.waits_since = now;
            }
            self.ready.append(&mut self.due);
            self.compile(now);
        }
        if self.calm_at().is_some_and(|at| at <= now) {
            self.compile(now);
        }
        if let Some((_, path)) = self.picture_at.take_if(|(at, _)| *at <= now) {
            self.show_picture(&path);
        }
    }

    /// When specs that nobody types in may be compiled, if some wait and none is being compiled.
    fn calm_at(&self) -> Option<Instant> {
        let waits = !self.ready.is_empty() && self.compiling == 0;
        waits.then(|| (self.heard_at + CALM).min(self.waits_since + PATIENCE))
    }

    /// Compiles what is ready: whoever types does not wait for all that uses a text, nor whoever asks.
    fn compile(&mut self, now: Instant) {
        loop {
            let is_ready = |spec: &Option<PathBuf>| spec.clone().filter(|spec| self.ready.contains(spec));
            let edited = is_ready(&self.edited).filter(|_| self.compiling < COMPILING);
            let is_calm = self.calm_at().is_some_and(|at| at <= now);
            let rest = || is_ready(&self.focused).or_else(|| self.ready.first().cloned()).filter(|_| is_calm);
            let Some(spec) = edited.clone().or_else(rest) else { return };
            if edited.is_none() {
                self.waits_since = now;
            }
            self.ready.remove(&spec);
            if self.ahead.as_ref() != Some(&spec) {
                self.begin(&spec);
            }
        }
    }

    /// Compiles a spec as it is now on a thread of its own.
    fn begin(&mut self, spec: &Path) {
        let Some(version) = self.documents.get(spec).map(|document| document.version) else { return };
        let (spec, snapshot, events) = (spec.to_path_buf(), self.snapshot(), self.events.clone());
        self.compiling += 1;
        self.compilers.spawn(move || {
            let analysed = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| snapshot.analysis(&spec)));
            let _ = events.send(Event::Analysed { spec, version, analysis: analysed.ok() });
        });
    }

    fn show_picture(&mut self, path: &Path) {
        let readers = self.findings.readers(path);
        self.tasks.follow(path, &readers, &self.documents);
    }

    fn analysed(&mut self, spec: &Path, version: i32, analysis: &Analysis) -> io::Result<()> {
        // of an older text, or of one that is being compiled again, nothing is told
        let is_now = self.documents.get(spec).is_some_and(|document| document.version == version);
        if !is_now || self.due.contains(spec) || self.ready.contains(spec) {
            return Ok(());
        }
        let snapshot = self.snapshot();
        for told in self.findings.put(spec, analysis, &snapshot) {
            self.tell("textDocument/publishDiagnostics", told)?;
        }
        Ok(())
    }

    fn execute(&mut self, request: Request) -> io::Result<()> {
        let asked = match tasks::Asked::read(request.params) {
            Ok(asked) => asked,
            Err(reason) => return self.refuse(request.id, ErrorCode::InvalidParams, reason),
        };
        let started = match asked {
            tasks::Asked::Explain { page } => {
                if self.shows_documents {
                    self.ask("window/showDocument", serde_json::json!({ "uri": page, "takeFocus": true }))?;
                }
                tasks::page(&page).map(Value::from)
            }
            asked => self.tasks.start(asked, &self.documents),
        };
        match started {
            Ok(value) => self.send(&Response::new_ok(request.id, value).into()),
            Err(reason) => self.refuse(request.id, ErrorCode::RequestFailed, reason),
        }
    }

    fn solved(&mut self, outcome: tasks::Outcome) -> io::Result<()> {
        let message = match &outcome.told {
            Ok(told) => {
                Arc::make_mut(&mut self.outcomes).insert((outcome.spec.clone(), outcome.job.clone()), told.clone());
                Arc::make_mut(&mut self.influences).extend(outcome.influences);
                serde_json::json!({ "type": 3, "message": format!("{}: {told}", outcome.job) })
            }
            Err(reason) => {
                Arc::make_mut(&mut self.outcomes).remove(&(outcome.spec.clone(), outcome.job.clone()));
                serde_json::json!({ "type": 1, "message": format!("{}: {reason}", outcome.job) })
            }
        };
        self.tell("window/showMessage", message)?;
        if self.refreshes_lenses {
            self.ask("workspace/codeLens/refresh", Value::Null)?;
        }
        Ok(())
    }
}

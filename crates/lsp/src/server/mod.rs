//! The loop: changes in their order, answers from snapshots.

mod compiling;
mod editor;
mod notices;
pub(super) mod progress;
mod requests;
mod threads;

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::{Duration, Instant};

use gen_lsp_types::InitializeParams;
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Spelling;
use super::capabilities;
use super::diagnostics::{Findings, Found};
use super::documents::Documents;
use super::snapshot::{Analyses, Options, Snapshot};
use super::tasks::{self, Solves, Tasks};
use editor::{Editor, Settings};
use threads::Threads;

/// Findings wait until nothing has changed for so long.
const SILENCE: Duration = Duration::from_millis(80);
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
        found: Option<Found>,
    },
    /// A job is solved, or not.
    Solved(tasks::Outcome),
    /// How far work is that goes on, and that it is over.
    Reached {
        token: String,
        message: String,
    },
    Over {
        token: String,
    },
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
    /// A text in focus of which it is not known yet whether it has a job.
    awaited: Option<PathBuf>,
    picture_at: Option<(Instant, PathBuf)>,
    solves: Solves,
    /// The texts of specs as they were compiled last: their generation, and what tells them from others.
    texts: BTreeMap<PathBuf, (u64, u64)>,
    tasks: Tasks,
    editor: Editor,
    settings: Settings,
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
            awaited: None,
            solves: Solves::default(),
            texts: BTreeMap::new(),
            editor: Editor::default(),
            settings: Settings::default(),
            asked: 0,
            spelled,
        }
    }

    /// Serves until the end; true if the editor has shut it down before.
    pub(super) fn run(&mut self, events: &Receiver<Event>) -> io::Result<bool> {
        loop {
            let now = Instant::now();
            let picture_at = self.picture_at.as_ref().map(|(at, _)| *at);
            let shows_at = self.tasks.running.shows_at().filter(|_| self.editor.shows_progress);
            let next = [self.due_at, self.ahead_at, picture_at, self.calm_at(), shows_at].into_iter().flatten().min();
            let event = match next {
                Some(at) if at <= now => {
                    self.wake(now);
                    self.show_work(now)?;
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
            Event::Analysed { spec, version, found } => self.compiled(&spec, version, found),
            Event::Solved(outcome) => self.solved(outcome),
            Event::Reached { token, message } if self.tasks.running.is_shown(&token) => {
                self.progress(&token, serde_json::json!({ "kind": "report", "message": message }))
            }
            Event::Reached { .. } => Ok(()),
            Event::Over { token } if self.tasks.running.end(&token) => {
                self.progress(&token, serde_json::json!({ "kind": "end" }))
            }
            Event::Over { .. } => Ok(()),
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
        if let Err(error) = InitializeParams::deserialize(&request.params) {
            return self.refuse(request.id, ErrorCode::InvalidParams, error.to_string());
        }
        self.editor = Editor::of(&request.params);
        if let Some(options) = request.params.get("initializationOptions") {
            self.settings.set(options);
        }
        self.phase = Phase::Open;
        self.send(&Response::new_ok(request.id, capabilities::told()).into())
    }

    fn snapshot(&self) -> Snapshot {
        Snapshot {
            documents: self.documents.clone(),
            analyses: self.analyses.clone(),
            solves: self.solves.clone(),
            options: Options {
                literal_values: self.settings.literal_values,
                snippets: self.editor.fills_snippets,
                plain_text: self.editor.is_plain,
            },
            spelled: self.spelled,
        }
    }

    /// Shows work that takes long.
    fn show_work(&mut self, now: Instant) -> io::Result<()> {
        if !self.editor.shows_progress {
            return Ok(());
        }
        for (token, begin) in self.tasks.running.shown_from(now) {
            self.ask("window/workDoneProgress/create", serde_json::json!({ "token": token }))?;
            self.progress(&token, begin)?;
        }
        Ok(())
    }

    fn progress(&mut self, token: &str, value: Value) -> io::Result<()> {
        self.tell("$/progress", serde_json::json!({ "token": token, "value": value }))
    }

    fn solved(&mut self, outcome: tasks::Outcome) -> io::Result<()> {
        let now = self.texts.get(&outcome.spec);
        let is_older = now.is_some_and(|now| now.0 > outcome.generation && now.1 != outcome.texts);
        let of = if is_older { " (the text has changed meanwhile)" } else { "" };
        let message = match &outcome.told {
            Ok(told) => serde_json::json!({ "type": 3, "message": format!("{}: {told}{of}", outcome.job) }),
            Err(reason) => serde_json::json!({ "type": 1, "message": format!("{}: {reason}{of}", outcome.job) }),
        };
        if !is_older {
            self.solves.put(outcome);
        }
        self.tell("window/showMessage", message)?;
        if self.editor.refreshes_lenses {
            self.ask("workspace/codeLens/refresh", Value::Null)?;
        }
        Ok(())
    }
}

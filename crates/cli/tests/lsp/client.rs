//! An editor without a screen: writes to the program, and reads what it says.
#![allow(unreachable_pub)] // a test is no crate of others

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use gen_lsp_types::{PublishDiagnosticsParams, Request};
use serde_json::{Value, json};

/// What is slower than this hangs.
const PATIENCE: Duration = Duration::from_secs(60);

pub struct Client {
    pub child: Child,
    to: Option<ChildStdin>,
    from: Receiver<Value>,
    /// What it says where editors keep a log: nothing, unless it has a fault.
    complaints: Option<JoinHandle<String>>,
    number: i64,
    versions: BTreeMap<String, i64>,
    /// What was told last of each text.
    pub told: BTreeMap<String, PublishDiagnosticsParams>,
    /// Messages beside answers and findings.
    pub others: Vec<Value>,
}

impl Client {
    /// Starts the program without a word.
    pub fn silent() -> Client {
        let mut child = Command::new(env!("CARGO_BIN_EXE_flank"))
            .arg("lsp")
            .current_dir(env!("CARGO_TARGET_TMPDIR"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let (sender, from) = channel();
        let out = child.stdout.take().expect("a pipe");
        std::thread::spawn(move || {
            let mut out = BufReader::new(out);
            while let Some(message) = read(&mut out) {
                if sender.send(message).is_err() {
                    break;
                }
            }
        });
        let mut complaints = child.stderr.take().expect("a pipe");
        let complaints = std::thread::spawn(move || {
            let mut said = String::new();
            let _ = complaints.read_to_string(&mut said);
            said
        });
        let to = child.stdin.take();
        Client {
            child,
            to,
            from,
            complaints: Some(complaints),
            number: 0,
            versions: BTreeMap::new(),
            told: BTreeMap::new(),
            others: Vec::new(),
        }
    }

    pub fn start() -> Client {
        let capabilities = json!({ "window": { "showDocument": { "support": true } }, "workspace": { "codeLens": { "refreshSupport": true } } });
        Client::start_as(&capabilities, &Value::Null)
    }

    /// Starts the program for an editor that can do something, with options.
    pub fn start_as(capabilities: &Value, options: &Value) -> Client {
        let mut client = Client::silent();
        let editor = json!({ "processId": null, "rootUri": null, "capabilities": capabilities, "initializationOptions": options });
        let answer = client.ask("initialize", editor);
        let _: gen_lsp_types::InitializeResult =
            serde_json::from_value(answer.expect("it starts")).expect("the protocol's");
        client.tell("initialized", json!({}));
        client
    }

    pub fn raw(&mut self, bytes: &[u8]) {
        let to = self.to.as_mut().expect("it is open");
        to.write_all(bytes).and_then(|()| to.flush()).expect("the program reads");
    }

    pub fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    pub fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Asks without waiting.
    pub fn begin(&mut self, method: &str, params: Value) -> i64 {
        self.number += 1;
        self.send(&json!({ "jsonrpc": "2.0", "id": self.number, "method": method, "params": params }));
        self.number
    }

    /// The result, or the error.
    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, Value> {
        let number = self.begin(method, params);
        self.answer(number)
    }

    pub fn answer(&mut self, number: i64) -> Result<Value, Value> {
        let end = Instant::now() + PATIENCE;
        loop {
            let message = self.next(end).unwrap_or_else(|| panic!("no answer to request {number}"));
            if message.get("id") == Some(&json!(number)) && message.get("method").is_none() {
                return match message.get("error") {
                    Some(error) => Err(error.clone()),
                    None => Ok(message.get("result").cloned().unwrap_or(Value::Null)),
                };
            }
            self.keep(message);
        }
    }

    /// Waits until each of the requests has an answer among `others`.
    pub fn all_answered(&mut self, numbers: &[i64]) {
        let end = Instant::now() + PATIENCE;
        let mut waited: BTreeSet<i64> = numbers.iter().copied().collect();
        let number = |message: &Value| message["id"].as_i64().filter(|_| message["method"].is_null());
        for message in &self.others {
            number(message).map(|number| waited.remove(&number));
        }
        while !waited.is_empty() {
            let message = self.next(end).unwrap_or_else(|| panic!("no answer to requests {waited:?}"));
            number(&message).map(|number| waited.remove(&number));
            self.keep(message);
        }
    }

    /// The result as the protocol's own model has it.
    pub fn typed<R: Request>(&mut self, params: Value) -> R::Result {
        let method = serde_json::to_value(R::METHOD).expect("a word");
        let method = method.as_str().expect("a word").to_string();
        let answer = self.ask(&method, params).unwrap_or_else(|error| panic!("{method}: {error}"));
        let result: R::Result =
            serde_json::from_value(answer.clone()).unwrap_or_else(|error| panic!("{method}: {error}\n{answer}"));
        assert_eq!(serde_json::to_value(&result).expect("JSON"), answer, "{method}: more than the protocol knows");
        result
    }

    fn next(&mut self, end: Instant) -> Option<Value> {
        self.from.recv_timeout(end.saturating_duration_since(Instant::now())).ok()
    }

    fn keep(&mut self, message: Value) {
        if message["method"] == "textDocument/publishDiagnostics" {
            let params: PublishDiagnosticsParams =
                serde_json::from_value(message["params"].clone()).expect("the protocol's");
            self.told.insert(params.uri.0.clone(), params);
        } else {
            self.others.push(message);
        }
    }

    /// What is told of a text from now on, once it is of the version that the text has now.
    pub fn findings(&mut self, uri: &str) -> PublishDiagnosticsParams {
        let end = Instant::now() + PATIENCE;
        loop {
            let own = self.versions.get(uri).copied();
            if let Some(told) = self.told.remove(uri)
                && told.version.is_none_or(|version| Some(i64::from(version)) == own)
            {
                return told;
            }
            let message = self.next(end).unwrap_or_else(|| panic!("nothing is told of {uri}"));
            self.keep(message);
        }
    }

    /// The next message of a kind that is neither answer nor finding.
    pub fn other(&mut self, method: &str) -> Value {
        let end = Instant::now() + PATIENCE;
        loop {
            if let Some(at) = self.others.iter().position(|message| message["method"] == method) {
                return self.others.remove(at);
            }
            let message = self.next(end).unwrap_or_else(|| panic!("no {method}"));
            self.keep(message);
        }
    }

    /// What is told of a text until whatever reads it has been compiled, too, which waits for the editor to be quiet: versions and the number of
    /// findings.
    pub fn told_meanwhile(&mut self, uri: &str) -> Vec<(Option<i32>, usize)> {
        std::thread::sleep(Duration::from_millis(700));
        let mut all = Vec::new();
        while let Ok(message) = self.from.try_recv() {
            self.keep(message);
            all.extend(self.told.remove(uri).map(|told| (told.version, told.diagnostics.len())));
        }
        all
    }

    /// The next error that answers to nothing.
    pub fn other_error(&mut self) -> Value {
        let end = Instant::now() + PATIENCE;
        loop {
            let is_error = |message: &Value| message["id"].is_null() && !message["error"].is_null();
            if let Some(at) = self.others.iter().position(is_error) {
                return self.others.remove(at)["error"].clone();
            }
            let message = self.next(end).expect("an error");
            self.keep(message);
        }
    }

    pub fn open(&mut self, uri: &str, text: &str) {
        let version = self.next_version(uri);
        let document = json!({ "uri": uri, "languageId": "chain", "version": version, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn next_version(&mut self, uri: &str) -> i64 {
        let version = self.versions.entry(uri.to_string()).or_default();
        *version += 1;
        *version
    }

    /// Takes changes as the protocol writes them.
    pub fn change(&mut self, uri: &str, changes: Value) {
        let params = self.changed(uri, &changes);
        self.tell("textDocument/didChange", params);
    }

    /// What is told of a change.
    pub fn changed(&mut self, uri: &str, changes: &Value) -> Value {
        let version = self.next_version(uri);
        json!({ "textDocument": { "uri": uri, "version": version }, "contentChanges": changes })
    }

    /// Ends it as editors do; the exit code.
    pub fn end(mut self) -> Option<i32> {
        assert_eq!(self.ask("shutdown", Value::Null), Ok(Value::Null));
        self.tell("exit", Value::Null);
        let code = self.child.wait().expect("it ends").code();
        let said = self.complaints.take().map(|complaints| complaints.join().expect("it is read"));
        assert_eq!(said.as_deref(), Some(""));
        code
    }

    /// Goes away without a word; the exit code.
    pub fn vanish(mut self) -> Option<i32> {
        drop(self.to.take());
        self.child.wait().expect("it ends").code()
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read(from: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if from.read_line(&mut line).ok()? == 0 {
            return None;
        }
        let line = line.trim_end();
        if line.is_empty() {
            break;
        }
        if let Some(value) = line.strip_prefix("Content-Length: ") {
            length = value.parse().expect("a length");
        }
    }
    let mut body = vec![0; length];
    from.read_exact(&mut body).ok()?;
    Some(serde_json::from_slice(&body).expect("JSON"))
}

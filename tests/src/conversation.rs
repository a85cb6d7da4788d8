//! What is fuzzed of the server of editors: a conversation of any bytes.

use std::io::{BufRead, BufReader, PipeReader, PipeWriter, Write, pipe};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use serde_json::Value;

/// What is slower than this hangs.
const PATIENCE: Duration = Duration::from_secs(20);
/// The code of an answer that tells a fault of the server.
const FAULT: i64 = -32603;
/// Commands that open a port or write a file.
const BEYOND: [&str; 2] = ["flank.preview", "flank.report"];
/// The text that a conversation begins with.
const TEXT: &str = "machine lathe {\n    axis C : rotary\n    frame bed\n    frame work in bed = rotate_z(C)\n}\n";

/// Whatever an editor sends, the server goes on, tells no fault, and ends when it is asked to.
///
/// Each line is the body of a message; a line that begins with a backslash is written without a frame.
pub fn fuzz_lsp(data: &[u8]) {
    let (from_editor, mut to_server) = pipe().expect("a pipe");
    let (from_server, to_editor) = pipe().expect("a pipe");
    let server = std::thread::Builder::new().stack_size(16 << 20);
    let server = server.spawn(move || flank_lsp::serve(from_editor, to_editor, str::to_string)).expect("a thread");
    let answers = read(from_server);
    let open =
        serde_json::json!({ "uri": "file:///nowhere/fuzzed.chain", "languageId": "chain", "version": 1, "text": TEXT });
    for message in [
        serde_json::json!({ "jsonrpc": "2.0", "id": "first", "method": "initialize", "params": { "capabilities": {} } }),
        serde_json::json!({ "jsonrpc": "2.0", "method": "textDocument/didOpen", "params": { "textDocument": open } }),
    ] {
        say(&mut to_server, message.to_string().as_bytes());
        hear(&answers, &message);
    }
    // behind what is no frame it is not known where the next message begins
    let mut is_framed = true;
    for line in data.split(|byte| *byte == b'\n') {
        let text = String::from_utf8_lossy(line);
        if BEYOND.iter().any(|command| text.contains(command)) {
            continue;
        }
        match line.strip_prefix(b"\\") {
            // the server may have ended
            Some(raw) => {
                is_framed = false;
                let _ = to_server.write_all(&[raw, b"\r\n"].concat());
            }
            None => {
                say(&mut to_server, line);
                // of two numbers either may be answered to, or neither
                let is_one = text.matches("\"id\"").count() < 2;
                if let Some(message) = serde_json::from_slice(line).ok().filter(|_| is_framed && is_one) {
                    hear(&answers, &message);
                }
            }
        }
    }
    drop(to_server);
    let ended = server.join().expect("the loop goes on");
    assert!(ended.is_ok(), "{ended:?}");
    answers.iter().for_each(|answer| check(&answer));
}

fn say(to: &mut PipeWriter, body: &[u8]) {
    let _ = write!(to, "Content-Length: {}\r\n\r\n", body.len()).and_then(|()| to.write_all(body));
}

/// Waits for the answer to a message, if it is a request.
fn hear(answers: &Receiver<Value>, to: &Value) {
    let (Some(id), Some(_)) = (to.get("id"), to.get("method").and_then(Value::as_str)) else { return };
    if !id.is_string() && id.as_i64().is_none_or(|number| i32::try_from(number).is_err()) {
        return;
    }
    loop {
        match answers.recv_timeout(PATIENCE) {
            Ok(answer) => {
                check(&answer);
                // what is no message has an answer to nothing
                if answer.get("id") == Some(id) || answer.get("id") == Some(&Value::Null) {
                    return;
                }
            }
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => panic!("no answer to {to}"),
        }
    }
}

fn check(answer: &Value) {
    assert!(answer.pointer("/error/code").and_then(Value::as_i64) != Some(FAULT), "{answer}");
}

/// What the server says, as it comes.
fn read(from: PipeReader) -> Receiver<Value> {
    let (sender, answers) = channel();
    std::thread::spawn(move || {
        let mut from = BufReader::new(from);
        while let Some(answer) = next(&mut from) {
            if sender.send(answer).is_err() {
                break;
            }
        }
    });
    answers
}

fn next(from: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if from.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim_end().strip_prefix("Content-Length: ") {
            Some(value) => length = value.parse().expect("a length"),
            None if line.trim_end().is_empty() => break,
            None => {}
        }
    }
    let mut body = vec![0; length];
    from.read_exact(&mut body).ok()?;
    Some(serde_json::from_slice(&body).expect("the server writes JSON"))
}

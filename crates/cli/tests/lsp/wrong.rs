//! What no editor should do: the server says so, loses nothing, and goes on.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::client::Client;
use crate::support::folder;

const SPEC: &str = "machine lathe {\n    axis C : rotary\n\n    frame bed\n    frame work in bed = rotate_z(C)\n}\n";

fn is_alive(client: &mut Client) {
    client.open("file:///nowhere/alive.chain", SPEC);
    assert!(client.findings("file:///nowhere/alive.chain").diagnostics.is_empty());
}

#[test]
fn broken_framing_is_told_and_passed_over() {
    let mut client = Client::start();
    let errors = [
        "Content-Length: 5\r\n\r\n{nop}",
        "Content-Length: 3\r\n\r\n[1]",
        "Content-Length: twelve\r\n\r\n",
        "no header at all\r\n",
        "Content-Type: text\r\n\r\n",
        "Content-Length: 2\r\n\r\n\u{fffd}",
    ];
    for (number, bytes) in errors.iter().enumerate() {
        client.raw(bytes.as_bytes());
        if number < 4 {
            let said = client.other_error();
            assert_eq!(said["code"], -32700, "{bytes:?}: {said}");
        }
    }
    // the last one took a byte of the next header: it is found again
    client.raw(b"\r\n\r\n");
    is_alive(&mut client);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_message_of_gigabytes_is_not_held() {
    let mut client = Client::start();
    client.raw(b"Content-Length: 20000000\r\n\r\n");
    let piece = vec![b' '; 1_000_000];
    (0..20).for_each(|_| client.raw(&piece));
    let said = client.other_error();
    assert!(said["message"].as_str().expect("words").contains("20000000 bytes"), "{said}");
    is_alive(&mut client);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn unknown_and_malformed_requests_are_refused() {
    let mut client = Client::start();
    let code = |answer: Result<Value, Value>| answer.expect_err("an error")["code"].as_i64();
    assert_eq!(code(client.ask("textDocument/nonsense", json!({}))), Some(-32601));
    assert_eq!(code(client.ask("textDocument/hover", json!({ "position": 3 }))), Some(-32602));
    assert_eq!(code(client.ask("workspace/executeCommand", json!({ "command": "rm", "arguments": [] }))), Some(-32602));
    assert_eq!(
        code(client.ask("workspace/textDocumentContent", json!({ "uri": "flank-library:/../../etc/passwd" }))),
        Some(-32803)
    );
    assert_eq!(
        code(client.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": {} }))),
        Some(-32600)
    );
    let nowhere =
        json!({ "textDocument": { "uri": "file:///nowhere.chain" }, "position": { "line": 0, "character": 0 } });
    assert_eq!(client.ask("textDocument/hover", nowhere), Ok(Value::Null));
    client.tell(
        "textDocument/didChange",
        json!({ "textDocument": { "uri": "file:///nowhere.chain", "version": 3 }, "contentChanges": [{ "text": "" }] }),
    );
    client.tell("textDocument/didOpen", json!({ "wrong": true }));
    client.tell("$/unknown", json!([1, 2, 3]));
    is_alive(&mut client);
    let beyond = json!({ "textDocument": { "uri": "file:///nowhere/alive.chain" }, "position": { "line": 4_000_000_000_u32, "character": 4_000_000_000_u32 } });
    assert_eq!(client.ask("textDocument/hover", beyond), Ok(Value::Null));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn nothing_is_answered_before_it_is_initialized_and_after_it_is_shut_down() {
    let mut client = Client::silent();
    let error = client.ask("textDocument/hover", json!({})).expect_err("too early");
    assert_eq!(error["code"], -32002);
    client.ask("initialize", json!({ "processId": null, "rootUri": null, "capabilities": {} })).expect("it starts");
    client.ask("shutdown", Value::Null).expect("it ends");
    assert_eq!(client.ask("textDocument/hover", json!({})).expect_err("too late")["code"], -32600);
    client.tell("exit", Value::Null);
    assert_eq!(client.child.wait().expect("it ends").code(), Some(0));
}

#[test]
fn an_exit_without_shutdown_and_an_editor_that_vanishes_end_it() {
    let mut client = Client::start();
    client.tell("exit", Value::Null);
    assert_eq!(client.child.wait().expect("it ends").code(), Some(1));
    assert_eq!(Client::start().vanish(), Some(1));
    assert_eq!(Client::silent().vanish(), Some(1));
}

#[test]
fn an_editor_that_never_stops_asking_hears_of_what_uses_a_text() {
    let mut client = Client::start();
    let [machine, reader] = ["machine", "reader"].map(|name| format!("file:///nowhere/{name}.chain"));
    client.open(&machine, SPEC);
    client.open(
        &reader,
        "use \"machine.chain\"\n\nmachine longer extends lathe {\n    frame beside in work = rotate_z(10 deg)\n}\n",
    );
    assert!(client.findings(&machine).diagnostics.is_empty());
    assert!(client.findings(&reader).diagnostics.is_empty());
    client.change(&machine, json!([{ "text": SPEC.replace("frame work", "frame job") }]));
    let place = json!({ "textDocument": { "uri": machine }, "position": { "line": 1, "character": 10 } });
    let end = Instant::now() + Duration::from_secs(60);
    let told = loop {
        client.ask("textDocument/hover", place.clone()).expect("an answer");
        if let Some(told) = client.told.remove(&reader) {
            break told;
        }
        assert!(Instant::now() < end, "nothing is told of what uses the text");
    };
    assert!(!told.diagnostics.is_empty(), "the frame has another name");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn ten_thousand_changes_are_taken_in_their_order() {
    let mut client = Client::start();
    let uri = "file:///nowhere/quick.chain";
    client.open(uri, &format!("// \n{SPEC}"));
    client.findings(uri);
    let mut line = String::new();
    for number in 0..10_000_u32 {
        let digit = char::from_digit(number % 10, 10).expect("a digit");
        let end = 3 + line.len();
        let range = json!({ "start": { "line": 0, "character": end }, "end": { "line": 0, "character": end } });
        client.change(uri, json!([{ "range": range, "text": digit.to_string() }]));
        line.push(digit);
        // lines of comments may be long, names may not
        if line.len() == 500 {
            let range = json!({ "start": { "line": 0, "character": 3 }, "end": { "line": 0, "character": 503 } });
            client.change(uri, json!([{ "range": range, "text": "" }]));
            line.clear();
        }
        if number % 997 == 0 {
            client.begin(
                "textDocument/hover",
                json!({ "textDocument": { "uri": uri }, "position": { "line": 3, "character": 9 } }),
            );
        }
    }
    // a mistake at the very end is told at the right place: all changes before it were taken
    let range = json!({ "start": { "line": 0, "character": 3 + line.len() }, "end": { "line": 0, "character": 3 + line.len() } });
    client.change(uri, json!([{ "range": range, "text": "\nwrong" }]));
    let told = client.findings(uri);
    let first = &told.diagnostics[0];
    assert_eq!((first.range.start.line, first.range.start.character), (1, 0), "{told:?}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_text_of_a_mebibyte_and_one_beyond_are_read() {
    let mut client = Client::start();
    let uri = "file:///nowhere/large.chain";
    let comment = "// a comment that says nothing at all, but makes a text long\n";
    let mut body = SPEC.to_string();
    while body.len() + comment.len() <= 1 << 20 {
        body += comment;
    }
    client.open(uri, &body);
    assert!(client.findings(uri).diagnostics.is_empty());
    let at = json!({ "textDocument": { "uri": uri }, "position": { "line": 4, "character": 11 } });
    assert!(client.ask("textDocument/hover", at).expect("an answer").is_object());
    client.change(uri, json!([{ "text": body + comment + comment }]));
    let told = client.findings(uri);
    assert_eq!(told.diagnostics.len(), 1);
    assert_eq!(told.diagnostics[0].code, Some(gen_lsp_types::Code::String("E0004".to_string())));
    // nothing is known of its text
    for method in ["completion", "hover", "definition", "prepareRename"] {
        let at = json!({ "textDocument": { "uri": uri }, "position": { "line": 4, "character": 11 } });
        match client.ask(&format!("textDocument/{method}"), at) {
            Ok(found) => assert!(found.is_null() || found["items"] == json!([]), "{method}: {found}"),
            Err(error) => assert_eq!(method, "prepareRename", "{error}"),
        }
    }
    assert_eq!(client.end(), Some(0));
}

/// A text of a mebibyte with tens of thousands of findings: what it costs grows as the text does, and nobody else waits for it.
#[test]
fn a_text_of_many_findings_is_in_nobodys_way() {
    let mut client = Client::start();
    let [large, small] = ["large", "small"].map(|name| format!("file:///nowhere/{name}.chain"));
    client.open(&small, SPEC);
    client.findings(&small);
    let lines: String = (0..28_000).map(|number| format!("    param x{number} : length = {number} mm\n")).collect();
    client.open(&large, &format!("machine a {{\n{lines}    frame bed\n}}\n"));
    let place = json!({ "textDocument": { "uri": small }, "position": { "line": 1, "character": 10 } });
    let mut longest = Duration::ZERO;
    let told = loop {
        let asked = Instant::now();
        assert!(client.ask("textDocument/hover", place.clone()).expect("an answer").is_object());
        longest = longest.max(asked.elapsed());
        if let Some(told) = client.told.remove(&large) {
            break told;
        }
    };
    assert_eq!(told.diagnostics.len(), 28_000);
    assert!(longest < Duration::from_secs(15), "{longest:?}");
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 28_002, "character": 0 } });
    for method in ["documentSymbol", "completion", "codeAction", "semanticTokens/full", "rangeFormatting"] {
        let params = json!({
            "textDocument": { "uri": large },
            "position": { "line": 9, "character": 28 },
            "range": whole,
            "context": { "diagnostics": [], "triggerKind": 1 },
            "options": { "tabSize": 4, "insertSpaces": true },
        });
        client.ask(&format!("textDocument/{method}"), params).expect("an answer");
    }
    assert_eq!(client.end(), Some(0));
}

/// Editors that keep texts in units of UTF-16 may send halves of letters. What they stand in counts like any other change.
#[test]
fn half_a_letter_leaves_no_text_out_of_step() {
    let mut client = Client::start();
    let uri = "file:///nowhere/half.chain";
    client.open(uri, SPEC);
    assert!(client.findings(uri).diagnostics.is_empty());
    let start = json!({ "line": 0, "character": 0 });
    let changes = json!([{ "range": { "start": start, "end": start }, "text": "// HALF\nwrong\n" }]);
    let params = client.changed(uri, &changes);
    let message = json!({ "jsonrpc": "2.0", "method": "textDocument/didChange", "params": params });
    let text = message.to_string().replace("HALF", "\\ud83d");
    client.raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    let told = client.findings(uri);
    let first = &told.diagnostics[0];
    assert_eq!((first.range.start.line, first.range.start.character), (1, 0), "{told:?}");
    let (from, to) = (json!({ "line": 0, "character": 3 }), json!({ "line": 1, "character": 5 }));
    client.change(uri, json!([{ "range": { "start": from, "end": to }, "text": "right again" }]));
    assert!(client.findings(uri).diagnostics.is_empty());
    assert_eq!(client.end(), Some(0));
}

#[test]
fn nothing_is_written() {
    let folder = folder("lsp-nothing");
    let path = folder.join("gear.chain");
    let body = SPEC.to_string();
    std::fs::write(&path, &body).expect("a file");
    let uri = format!("file://{}", path.display());
    let mut client = Client::start();
    client.open(&uri, &format!("{body}\n\n\n"));
    client.findings(&uri);
    client
        .ask(
            "textDocument/formatting",
            json!({ "textDocument": { "uri": uri }, "options": { "tabSize": 4, "insertSpaces": true } }),
        )
        .expect("edits");
    client.tell("textDocument/didSave", json!({ "textDocument": { "uri": uri } }));
    client.ask("workspace/executeCommand", json!({ "command": "flank.preview", "arguments": [uri] })).expect("a page");
    let _ = client.ask("workspace/executeCommand", json!({ "command": "flank.solve", "arguments": [uri, "nothing"] }));
    client.other("window/showMessage");
    assert_eq!(client.end(), Some(0));
    assert_eq!(std::fs::read_to_string(&path).expect("the file"), body);
    assert_eq!(std::fs::read_dir(&folder).expect("the folder").count(), 1);
}

/// Numbers that look random, the same each time.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}

#[test]
fn mutated_conversations_end_nothing() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let uri = "file:///nowhere/mutated.chain";
    let mut client = Client::start();
    client.open(uri, SPEC);
    client.findings(uri);
    let methods = [
        "hover",
        "definition",
        "references",
        "documentSymbol",
        "foldingRange",
        "completion",
        "formatting",
        "rangeFormatting",
        "codeAction",
        "prepareRename",
        "rename",
        "semanticTokens/full",
        "inlayHint",
        "codeLens",
        "didChange",
    ];
    let mut asked = Vec::new();
    for number in 0..3000 {
        let method = methods[random.below(methods.len())];
        let place = |random: &mut Random| json!({ "line": random.below(9), "character": random.below(40) });
        let (start, end) = (place(&mut random), place(&mut random));
        let new_name = ["other", "frame", "", "Ω", "bed"][random.below(5)];
        let mut params = json!({
            "textDocument": { "uri": uri, "version": number + 2 },
            "position": start,
            "range": { "start": start, "end": end },
            "context": { "diagnostics": [], "includeDeclaration": true },
            "options": { "tabSize": 4, "insertSpaces": true },
            "newName": new_name,
        });
        if method == "didChange" {
            let text = ["}", "{", "\u{1F600}", "axis ", "\n", "m.", "", "\"", "\r", "frame b in"][random.below(10)];
            params["contentChanges"] = json!([{ "range": { "start": start, "end": end }, "text": text }]);
        }
        let mut message = json!({ "jsonrpc": "2.0", "id": 10_000 + number, "method": format!("textDocument/{method}"), "params": params });
        if method == "didChange" {
            message.as_object_mut().expect("an object").remove("id");
        }
        let mut bytes = message.to_string().into_bytes();
        // some of them are broken within their frame
        if random.below(4) == 0 {
            let at = random.below(bytes.len());
            bytes[at] = b" {}[]:,\"x0\xff"[random.below(11)];
        } else if method != "didChange" {
            asked.push(10_000 + number);
        }
        client.raw(format!("Content-Length: {}\r\n\r\n", bytes.len()).as_bytes());
        client.raw(&bytes);
    }
    is_alive(&mut client);
    // answers come from several threads: findings of another text may overtake them
    assert!(asked.len() > 1000, "{}", asked.len());
    client.all_answered(&asked);
    let faults = |message: &&Value| message["error"]["code"] == -32603;
    assert_eq!(client.others.iter().find(faults), None);
    if let Ok(status) = std::fs::read_to_string(format!("/proc/{}/status", client.child.id())) {
        let line = status.lines().find(|line| line.starts_with("VmHWM")).expect("memory");
        let kilobytes: u64 = line.split_whitespace().nth(1).expect("a number").parse().expect("a number");
        assert!(kilobytes < 200 * 1024, "{line}");
    }
    assert_eq!(client.end(), Some(0));
}

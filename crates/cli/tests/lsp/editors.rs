//! What editors can do and what they set decides what they are asked and told.

use serde_json::{Value, json};

use crate::client::Client;
use crate::support::folder;

const SPEC: &str = "machine lathe {\n    axis C : rotary\n\n    frame bed\n    frame work in bed = rotate_z(C)\n}\n";

fn command(client: &mut Client, name: &str, arguments: &Value) -> Result<Value, Value> {
    client.ask("workspace/executeCommand", json!({ "command": name, "arguments": arguments }))
}

#[test]
fn an_editor_without_markdown_gets_plain_text() {
    let uri = "file:///nowhere/gear.chain";
    let at = json!({ "textDocument": { "uri": uri }, "position": { "line": 4, "character": 34 } });
    for (formats, kind) in [(json!(["plaintext"]), "plaintext"), (json!(["plaintext", "markdown"]), "markdown")] {
        let mut client =
            Client::start_as(&json!({ "textDocument": { "hover": { "contentFormat": formats } } }), &Value::Null);
        client.open(uri, SPEC);
        let hover = client.ask("textDocument/hover", at.clone()).expect("a hover");
        assert_eq!(hover["contents"]["kind"], kind);
        let said = hover["contents"]["value"].as_str().expect("words");
        assert!(said.contains("axis C : rotary"), "{said}");
        assert_eq!(said.contains('`'), kind == "markdown", "{said}");
        assert_eq!(client.end(), Some(0));
    }
}

#[test]
fn values_beside_the_text_are_asked_for_again_once_they_are_set_otherwise() {
    let mut client =
        Client::start_as(&json!({ "workspace": { "inlayHint": { "refreshSupport": true } } }), &Value::Null);
    let set = |literals: bool| json!({ "settings": { "flank": { "inlayHints": { "literals": literals } } } });
    client.tell("workspace/didChangeConfiguration", set(true));
    client.other("workspace/inlayHint/refresh");
    // nothing else now
    client.tell("workspace/didChangeConfiguration", set(true));
    assert!(command(&mut client, "flank.explain", &json!(["E0201"])).is_ok());
    assert!(!client.others.iter().any(|message| message["method"] == "workspace/inlayHint/refresh"));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_page_that_there_is_not_is_not_shown() {
    let mut client = Client::start();
    assert!(command(&mut client, "flank.explain", &json!(["E9999"])).is_err());
    assert!(!client.others.iter().any(|message| message["method"] == "window/showDocument"));
    command(&mut client, "flank.explain", &json!(["E0201"])).expect("a page");
    assert_eq!(client.other("window/showDocument")["params"]["uri"], "flank-error:/E0201.md");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn the_page_is_opened_where_the_editor_does_not() {
    let uri = "file:///nowhere/gear.chain";
    let shows = json!({ "window": { "showDocument": { "support": true } } });
    for (capabilities, options, opens) in [
        (shows.clone(), Value::Null, true),
        (shows, json!({ "preview": { "opens": true } }), false),
        (json!({}), Value::Null, false),
    ] {
        let mut client = Client::start_as(&capabilities, &options);
        client.open(uri, SPEC);
        client.findings(uri);
        let answer = command(&mut client, "flank.preview", &json!([uri])).expect("a page");
        let shown = client.others.iter().find(|message| message["method"] == "window/showDocument");
        assert_eq!(shown.is_some(), opens);
        if let Some(shown) = shown {
            assert_eq!((&shown["params"]["uri"], &shown["params"]["external"]), (&answer["url"], &json!(true)));
        }
        assert_eq!(client.end(), Some(0));
    }
}

#[test]
fn files_on_the_disk_are_watched_where_the_editor_does_it() {
    let watches = json!({ "workspace": { "didChangeWatchedFiles": { "dynamicRegistration": true } } });
    let mut client = Client::start_as(&watches, &Value::Null);
    let asked = client.other("client/registerCapability");
    let registered = &asked["params"]["registrations"][0];
    assert_eq!(registered["method"], "workspace/didChangeWatchedFiles");
    assert_eq!(registered["registerOptions"]["watchers"][0]["globPattern"], "**/*.{chain,csv}");

    let folder = folder("lsp-watched").canonicalize().expect("a folder");
    let [used, reader] = ["used", "reader"].map(|name| folder.join(format!("{name}.chain")));
    std::fs::write(&used, SPEC).expect("a file");
    let uri = format!("file://{}", reader.display());
    client.open(
        &uri,
        "use \"used.chain\"\n\nmachine longer extends lathe {\n    frame beside in work = rotate_z(10 deg)\n}\n",
    );
    assert!(client.findings(&uri).diagnostics.is_empty());
    std::fs::write(&used, SPEC.replace("frame work", "frame job")).expect("a file");
    let address = format!("file://{}", used.display());
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [{ "uri": address, "type": 2 }] }));
    assert_eq!(client.findings(&uri).diagnostics.len(), 1);
    assert_eq!(client.end(), Some(0));
}

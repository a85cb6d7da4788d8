//! Work that takes long is shown, and may be stopped.

use serde_json::{Value, json};

use crate::client::Client;
use crate::support::top;

const SPEC: &str = "file:///nowhere/gear.chain";

/// Solves a gear at two million points, which takes longer than the half second after which work is shown.
fn solve(capabilities: &Value) -> Client {
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let text =
        text.replace("low .. high by 9, z: -10 mm .. 10 mm by 5", "low .. high by 1001, z: -10 mm .. 10 mm by 1001");
    let mut client = Client::start_as(capabilities, &Value::Null);
    client.open(SPEC, &text);
    let params = json!({ "command": "flank.solve", "arguments": [SPEC, "first_gear"] });
    client.ask("workspace/executeCommand", params).expect("it starts");
    client
}

#[test]
fn long_work_is_shown_and_stops_when_the_editor_says_so() {
    let mut client = solve(&json!({ "window": { "workDoneProgress": true } }));
    let created = client.other("window/workDoneProgress/create");
    let token = created["params"]["token"].clone();
    let _: gen_lsp_types::WorkDoneProgressCreateParams =
        serde_json::from_value(created["params"].clone()).expect("the protocol's");
    let begun = client.other("$/progress");
    assert_eq!(begun["params"]["token"], token);
    let begin: gen_lsp_types::WorkDoneProgressBegin =
        serde_json::from_value(begun["params"]["value"].clone()).expect("the protocol's");
    assert_eq!((begin.title.as_str(), begin.cancellable), ("solving first_gear", Some(true)));
    client.tell("window/workDoneProgress/cancel", json!({ "token": token }));
    loop {
        let told = client.other("$/progress");
        assert_eq!(told["params"]["token"], token);
        if told["params"]["value"]["kind"] == "end" {
            break;
        }
        assert_eq!(told["params"]["value"]["kind"], "report");
        let message = told["params"]["value"]["message"].as_str().expect("how far it is");
        assert!(message.contains("flank_plus") || message.contains("flank_minus"), "{message}");
    }
    assert_eq!(client.other("window/showMessage")["params"]["message"], "first_gear: cancelled");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn an_editor_that_shows_no_work_is_told_of_none() {
    let mut client = solve(&json!({}));
    let message = client.other("window/showMessage")["params"]["message"].clone();
    assert!(
        message.as_str().is_some_and(|message| message.starts_with("first_gear: flank_plus 1002001/1002001")),
        "{message}"
    );
    assert!(client.others.iter().all(|message| message["method"] != "$/progress"), "{:?}", client.others);
    assert_eq!(client.end(), Some(0));
}

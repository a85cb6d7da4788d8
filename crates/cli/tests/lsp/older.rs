//! What is known of an older text is not told of a newer one.

use gen_lsp_types::{CodeLensRequest, HoverRequest};
use serde_json::{Value, json};

use crate::client::Client;
use crate::support::top;

fn document(uri: &str) -> Value {
    json!({ "textDocument": { "uri": uri } })
}

/// What stands beside the first lens of a text.
fn lens(client: &mut Client, uri: &str) -> String {
    let lenses = client.typed::<CodeLensRequest>(document(uri)).expect("lenses");
    lenses[0].command.as_ref().expect("a command").title.clone()
}

/// Whether hover knows how far a setting of the first job moves its surface.
fn knows_influence(client: &mut Client, uri: &str, text: &str) -> bool {
    let at = text.find("pressure_angle : angle").expect("it is there");
    let line = text[..at].matches('\n').count();
    let params = json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": 12 } });
    let hover = client.typed::<HoverRequest>(params).expect("a hover");
    serde_json::to_string(&hover).expect("JSON").contains("moves `flank_plus`")
}

fn solve(client: &mut Client, uri: &str) {
    let params = json!({ "command": "flank.solve", "arguments": [uri, "first_gear"] });
    client.ask("workspace/executeCommand", params).expect("it starts");
}

#[test]
fn what_a_solve_found_is_told_of_its_text_alone() {
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let other = text.replace("teeth : count = 20", "teeth : count = 21");
    let [gear, beside] = ["a/gear", "b/gear"].map(|name| format!("file:///nowhere/{name}.chain"));
    let mut client = Client::start();
    for uri in [&gear, &beside] {
        client.open(uri, &text);
        assert!(client.findings(uri).diagnostics.is_empty());
    }
    solve(&mut client, &gear);
    client.other("window/showMessage");
    client.other("workspace/codeLens/refresh");
    assert!(lens(&mut client, &gear).starts_with("solve: flank_plus 45/45"));
    assert!(knows_influence(&mut client, &gear, &text));
    // another file has jobs and settings of the same names
    assert_eq!(lens(&mut client, &beside), "solve");
    assert!(!knows_influence(&mut client, &beside, &text));

    client.change(&gear, json!([{ "text": other }]));
    assert_eq!(lens(&mut client, &gear), "solve");
    assert!(!knows_influence(&mut client, &gear, &other));
    client.findings(&gear);

    // one that ends once the text has changed
    solve(&mut client, &gear);
    client.change(&gear, json!([{ "text": text.replace("teeth : count = 20", "teeth : count = 22") }]));
    client.other("window/showMessage");
    assert_eq!(lens(&mut client, &gear), "solve");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_result_is_gone_when_a_used_text_changes() {
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let (parts, job) = text.split_at(text.find("job first_gear").expect("it is there"));
    let (job, _) = job.split_at(job.find("/// The tool sits").expect("it is there"));
    let [gear, used] = ["gear", "parts"].map(|name| format!("file:///nowhere/{name}.chain"));
    let job = format!("use \"parts.chain\"\n\n{job}");
    let mut client = Client::start();
    for (uri, text) in [(&used, parts), (&gear, job.as_str())] {
        client.open(uri, text);
        assert!(client.findings(uri).diagnostics.is_empty());
    }
    solve(&mut client, &gear);
    client.other("window/showMessage");
    client.other("workspace/codeLens/refresh");
    assert!(lens(&mut client, &gear).starts_with("solve: "));
    client.change(&used, json!([{ "text": parts.replace("= 20 deg", "= 21 deg") }]));
    // the editor does not ask by itself: the text of the job is as it was
    client.other("workspace/codeLens/refresh");
    assert_eq!(lens(&mut client, &gear), "solve");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn what_users_found_in_an_older_text_is_not_told_of_a_newer_one() {
    let machine = "machine lathe {\n    axis C : rotary\n    frame bed\n    frame work in bed = rotate_z(C)\n}\n";
    let wrong = machine.replace("rotate_z(C)", "rotate_z(B)");
    let reader =
        "use \"machine.chain\"\n\nmachine longer extends lathe {\n    frame beside in work = rotate_z(10 deg)\n}\n";
    let uri = "file:///nowhere/machine.chain";
    let readers: Vec<String> = (0..3).map(|number| format!("file:///nowhere/reader_{number}.chain")).collect();
    let mut client = Client::start();
    client.open(uri, &wrong);
    assert_eq!(client.findings(uri).diagnostics.len(), 1);
    for reader_uri in &readers {
        client.open(reader_uri, reader);
        client.findings(reader_uri);
    }
    assert_eq!(client.told_meanwhile(uri), [], "each of them finds the same");
    client.change(uri, json!([{ "text": format!("// a line more\n{machine}") }]));
    assert!(client.findings(uri).diagnostics.is_empty());
    assert_eq!(client.told_meanwhile(uri), []);
    for reader_uri in &readers {
        let at = json!({ "textDocument": { "uri": reader_uri }, "position": { "line": 2, "character": 24 } });
        let defined = client.ask("textDocument/definition", at).expect("an answer");
        assert_eq!(defined["range"]["start"]["line"], json!(1), "each of them reads the text as it is now");
    }
    assert_eq!(client.end(), Some(0));
}

//! How often an editor is told what is found in a text.

use serde_json::json;

use crate::client::Client;
use crate::paths::{address, project};

#[test]
fn findings_are_told_again_for_a_new_version_alone() {
    let top = project("lsp-told-once");
    let [machine, job] = ["machines/lathe.chain", "jobs/gear.chain"].map(|path| address(&top.join(path)));
    let mut client = Client::start();
    client.open(&machine, "machine lathe { frame }");
    client.open(&job, "use \"../machines/lathe.chain\"");
    assert_eq!(client.told_meanwhile(&machine), [(Some(1), 1)]);
    // both are compiled anew, and only of one there is another version
    client.change(&job, json!([{ "text": "use \"../machines/lathe.chain\"\n" }]));
    assert_eq!(client.told_meanwhile(&machine), []);
    client.change(&machine, json!([{ "text": "machine lathe { frame } " }]));
    assert_eq!(client.told_meanwhile(&machine), [(Some(2), 1)]);
    assert_eq!(client.told_meanwhile(&job), []);
    client.tell(
        "workspace/didChangeWatchedFiles",
        json!({ "changes": [{ "uri": "file:///nowhere/a.chain", "type": 1 }] }),
    );
    assert_eq!(client.told_meanwhile(&machine), []);
    assert_eq!(client.end(), Some(0));
}

#[cfg(unix)]
#[test]
fn what_was_told_under_another_address_is_taken_back() {
    let top = project("lsp-linked");
    let link = top.join("link");
    std::os::unix::fs::symlink(top.join("machines"), &link).expect("a link");
    let uri = address(&link.join("lathe.chain"));
    let mut client = Client::start();
    client.open(&uri, "machine lathe { frame }");
    assert_eq!(client.told_meanwhile(&uri), [(Some(1), 1)]);
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    assert_eq!(client.told_meanwhile(&uri), [(None, 0)]);
    assert_eq!(client.end(), Some(0));
}

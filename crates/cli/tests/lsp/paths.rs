//! Files that a `use` may name, as an editor proposes them.

use std::path::Path;

use serde_json::json;

use crate::client::Client;
use crate::support::folder;

/// Opens a text with a mark in it as the next version, and tells what is proposed at the mark: labels, the columns that they replace, whether
/// there may be more.
fn proposed(client: &mut Client, uri: &str, marked: &str) -> (Vec<String>, [u64; 2], bool) {
    let (before, behind) = marked.split_once('|').expect("a mark");
    client.open(uri, &format!("{before}{behind}"));
    let line = before.matches('\n').count();
    let column = before.rsplit('\n').next().expect("a line").encode_utf16().count();
    let place = json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": column } });
    let list = client.ask("textDocument/completion", place).expect("proposals");
    let items = list["items"].as_array().expect("a list");
    let edge = |end: &str| {
        items.first().map_or(0, |item| item["textEdit"]["range"][end]["character"].as_u64().expect("a column"))
    };
    let labels = items.iter().map(|item| item["label"].as_str().expect("a label").to_string()).collect();
    (labels, [edge("start"), edge("end")], list["isIncomplete"] == json!(true))
}

/// A project with a space and a percent sign in its name.
pub(crate) fn project(name: &str) -> std::path::PathBuf {
    let top = folder(name).join("50% of it");
    for (path, text) in [
        ("flank.toml", ""),
        ("machines/lathe.chain", "machine lathe { frame bed }"),
        ("machines/Größe Ω.chain", "machine other { frame bed }"),
        ("machines/notes.txt", ""),
        ("machines/.hidden.chain", ""),
        ("jobs/gear.chain", ""),
    ] {
        std::fs::create_dir_all(top.join(path).parent().expect("a folder")).expect("a folder");
        std::fs::write(top.join(path), text).expect("a file");
    }
    top
}

pub(crate) fn address(path: &Path) -> String {
    format!("file://{}", path.display()).replace('%', "%25").replace(' ', "%20")
}

#[test]
fn a_use_is_offered_the_specs_and_folders_that_it_may_name() {
    let top = project("lsp-paths");
    let uri = address(&top.join("jobs/gear.chain"));
    let mut client = Client::start();
    let specs = ["Größe Ω.chain", "lathe.chain"].as_slice();
    for (marked, labels, replaced) in [
        ("use \"|", ["../"].as_slice(), [5, 5]),
        ("use \"../ma|\"", &["jobs/", "machines/"], [8, 10]),
        ("use \"../machines/|", specs, [17, 17]),
        ("use \"../machines/la|the.chain\"", specs, [17, 28]),
        // a folder in the middle of a path
        ("use \"../ma|ch/lathe.chain\"", &["jobs/", "machines/"], [8, 12]),
        ("/* 😀 */ use \"../machines/Ω|\r\nmachine a { frame bed }", specs, [26, 27]),
        // nothing of what no `use` may name
        ("use \"../../|\"", &[], [0, 0]),
        ("use \"/|\"", &[], [0, 0]),
        ("// use \"|\"", &[], [0, 0]),
    ] {
        let found = proposed(&mut client, &uri, marked);
        assert_eq!(found, (labels.iter().map(|label| label.to_string()).collect(), replaced, false), "{marked}");
    }
    // a text that is nowhere but in the editor, in a folder that is nowhere at all
    let other = address(&top.join("new/unsaved.chain"));
    client.open(&other, "machine unsaved { frame bed }");
    assert_eq!(proposed(&mut client, &uri, "use \"../|\"").0, ["jobs/", "machines/", "new/"]);
    assert_eq!(proposed(&mut client, &uri, "use \"../new/|\"").0, ["unsaved.chain"]);
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": other } }));
    assert_eq!(proposed(&mut client, &uri, "use \"../|\"").0, ["jobs/", "machines/"]);
    let shipped = "flank-library:/hobbing/spur_gear.chain";
    assert!(proposed(&mut client, shipped, "use \"../tools/|\"").0.contains(&"rack.chain".to_string()));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn signs_of_paths_ask_for_nothing_elsewhere() {
    let mut client = Client::start();
    let uri = "file:///nowhere/sum.chain";
    client.open(uri, "job j { let x = 1 /");
    for (sign, is_asked) in [("/", false), (" ", true)] {
        let place = json!({ "line": 0, "character": 19 });
        let context = json!({ "triggerKind": 2, "triggerCharacter": sign });
        let asked = json!({ "textDocument": { "uri": uri }, "position": place, "context": context });
        let list = client.ask("textDocument/completion", asked).expect("an answer");
        assert_eq!(list["items"].as_array().map(|items| !items.is_empty()), Some(is_asked), "{sign}");
    }
    assert_eq!(client.end(), Some(0));
}

#[test]
fn of_a_folder_with_very_many_files_a_part_is_offered() {
    let top = project("lsp-many-paths");
    for number in 0..3000 {
        std::fs::write(top.join(format!("machines/m{number:04}.chain")), "").expect("a file");
    }
    let uri = address(&top.join("jobs/gear.chain"));
    let mut client = Client::start();
    let (labels, _, is_part) = proposed(&mut client, &uri, "use \"../machines/|\"");
    assert!(labels.len() == 500 && is_part, "{}", labels.len());
    let (labels, ..) = proposed(&mut client, &uri, "use \"../machines/M299|\"");
    assert_eq!(labels.len(), 10);
    assert_eq!(client.end(), Some(0));
}

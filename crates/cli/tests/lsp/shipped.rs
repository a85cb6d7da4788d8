//! Shipped specs and the examples of error pages: the server finds what `flank check` finds, and knows every name.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use gen_lsp_types::{Code, Diagnostic, Range};
use serde_json::{Value, json};

use crate::client::Client;
use crate::support::{flank, folder, text, top};

/// Code and range of a finding, the range as the protocol has it.
type Found = (String, [u32; 4]);

fn of_range(range: &Range) -> [u32; 4] {
    [range.start.line, range.start.character, range.end.line, range.end.character]
}

fn of_server(found: &Diagnostic) -> Found {
    match &found.code {
        Some(Code::String(code)) => (code.clone(), of_range(&found.range)),
        other => panic!("{other:?}"),
    }
}

/// The findings of the command line in one file: lines and columns in letters, become places in units of UTF-16.
fn of_check(path: &Path) -> Vec<Found> {
    let output = flank(&["check", "--json", path.to_str().expect("UTF-8")]);
    let document: Value = serde_json::from_str(&text(&output.stdout)).expect("JSON");
    let whole = std::fs::read_to_string(path).expect("UTF-8");
    let lines: Vec<&str> = lines_of(&whole);
    let mut all = Vec::new();
    for finding in document["files"][0]["findings"].as_array().expect("findings") {
        let place = &finding["place"];
        if !Path::new(place["file"].as_str().expect("a file")).ends_with(path.file_name().expect("a name")) {
            continue;
        }
        let number = |key: &str| place[key].as_u64().expect("a number") as usize - 1;
        let (line, column) = (number("line"), number("column"));
        let before: String = lines[line].chars().take(column).collect();
        let start = before.encode_utf16().count() as u32;
        let said = place["text"].as_str().expect("a text");
        let parts = lines_of(said);
        let last = parts.last().expect("a line").encode_utf16().count() as u32;
        let end_line = line + parts.len() - 1;
        let end = if parts.len() == 1 { start + last } else { last };
        all.push((finding["code"].as_str().expect("a code").to_string(), [line as u32, start, end_line as u32, end]));
    }
    all.sort();
    all
}

/// Lines that end with a line feed, a carriage return, or both.
fn lines_of(text: &str) -> Vec<&str> {
    let mut lines = Vec::new();
    let mut rest = text;
    while let Some(end) = rest.find(['\n', '\r']) {
        lines.push(&rest[..end]);
        rest = if rest[end..].starts_with("\r\n") { &rest[end + 2..] } else { &rest[end + 1..] };
    }
    lines.push(rest);
    lines
}

fn address(path: &Path) -> String {
    format!("file://{}", path.display())
}

/// The wrong texts of the pages about codes.
fn examples() -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(top().join("docs/errors")).expect("pages") {
        let path = entry.expect("an entry").path();
        let page = std::fs::read_to_string(&path).expect("UTF-8");
        let code = path.file_stem().expect("a name").to_str().expect("UTF-8").to_string();
        for (number, block) in page.split("```chain").skip(1).enumerate() {
            let (_, rest) = block.split_once('\n').expect("a line");
            let body = rest.split("```").next().expect("a block");
            all.insert(format!("{code}_{number}"), body.to_string());
        }
    }
    all
}

#[test]
fn findings_are_those_of_check_for_every_example_of_an_error() {
    let folder = folder("lsp-examples");
    let mut client = Client::start();
    let (mut seen, mut codes) = (0, std::collections::BTreeSet::new());
    for (name, example) in examples() {
        // letters of two and of four bytes before what is wrong, and line ends of Windows
        let marked = format!("/// Ω 😀\n{}", example.trim_start());
        let inside = format!("/* */ {example}");
        for (kind, body) in [
            ("plain", example.clone()),
            ("marked", marked),
            ("windows", example.replace('\n', "\r\n")),
            ("sign", inside),
        ] {
            let path = folder.join(format!("{name}_{kind}.chain"));
            std::fs::write(&path, &body).expect("a file");
            client.open(&address(&path), &body);
            let mut told: Vec<Found> = client.findings(&address(&path)).diagnostics.iter().map(of_server).collect();
            told.sort();
            let mut expected = of_check(&path);
            expected.dedup();
            assert_eq!(told, expected, "{name}, {kind}");
            seen += told.len();
            codes.extend(told.into_iter().map(|(code, _)| code));
            client.tell("textDocument/didClose", json!({ "textDocument": { "uri": address(&path) } }));
        }
    }
    assert!(seen > 200, "{seen}");
    assert!(codes.len() > 40, "{codes:?}");
    assert_eq!(client.end(), Some(0));
}

#[test]
fn columns_count_units_of_utf_16() {
    let folder = folder("lsp-columns");
    let mut client = Client::start();
    for (number, end) in ["\n", "\r\n", "\r"].into_iter().enumerate() {
        let body = format!(
            "machine Ω {{ axis C : rotary frame bed {end}/* 😀 */ frame w in bed = rotate_z(B) }}{end}fn Ωπ(a: angle) = a + Ω😀 + b{end}"
        );
        let path = folder.join(format!("{number}.chain"));
        std::fs::write(&path, &body).expect("a file");
        client.open(&address(&path), &body);
        let mut told: Vec<Found> = client.findings(&address(&path)).diagnostics.iter().map(of_server).collect();
        told.sort();
        let expected = of_check(&path);
        assert!(!expected.is_empty());
        assert_eq!(told, expected, "{end:?}");
    }
    assert_eq!(client.end(), Some(0));
}

fn specs() -> Vec<PathBuf> {
    let mut all = Vec::new();
    let mut folders = vec![top().join("specs").canonicalize().expect("the library")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "chain") {
                all.push(path);
            }
        }
    }
    all.sort();
    all
}

#[test]
fn the_whole_library_is_open_without_a_finding() {
    let mut client = Client::start();
    let specs = specs();
    for spec in &specs {
        client.open(&address(spec), &std::fs::read_to_string(spec).expect("UTF-8"));
        let told = client.findings(&address(spec));
        assert!(told.diagnostics.is_empty(), "{}: {:?}", spec.display(), told.diagnostics);
    }
    let status = std::fs::read_to_string(format!("/proc/{}/status", client.child.id()));
    if let Ok(status) = status {
        let line = status.lines().find(|line| line.starts_with("VmRSS")).expect("memory");
        let kilobytes: u64 = line.split_whitespace().nth(1).expect("a number").parse().expect("a number");
        assert!(kilobytes < 2 * 60 * 1024, "{line}: without optimisation, twice what is promised");
    }
    assert_eq!(client.end(), Some(0));
}

/// Specs of a hobbed gear, a bevel pinion, a pair with contacts, a profile that is dressed, and a variant of another file's job.
const RENAMED: [&str; 5] = [
    "hobbing/crowned_gear",
    "bevel/pinion_19x62",
    "pairs/spur_pair",
    "grinding/dressed_wheel",
    "bodies/rack_and_pinion_body",
];

#[test]
fn names_of_specs_lead_to_their_definitions_and_are_renamed_there_and_back() {
    let folder = folder("lsp-rename");
    // its own copies of what they use, which are renamed in, too
    copy_all(&top().join("specs"), &folder);
    std::fs::write(folder.join("flank.toml"), "").expect("a file");
    let mut client = Client::start();
    let mut names = 0;
    for spec in RENAMED {
        let path = folder.join(format!("{spec}.chain"));
        let body = std::fs::read_to_string(&path).expect("UTF-8");
        let uri = address(&path);
        client.open(&uri, &body);
        assert!(client.findings(&uri).diagnostics.is_empty(), "{spec}");
        let found = renamed_there_and_back(&mut client, &uri, &body);
        assert!(found >= 5, "{spec}: {found}");
        names += found;
    }
    assert!(names > 80, "{names}");
    assert_eq!(client.end(), Some(0));
}

/// Copies a folder with all that is in it.
fn copy_all(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        let own = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_all(&path, &own);
        } else {
            std::fs::copy(&path, own).expect("a copy");
        }
    }
}

/// Renames all that a text defines and back again, one after the other; their number.
fn renamed_there_and_back(client: &mut Client, uri: &str, body: &str) -> usize {
    let symbols =
        client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": uri } })).expect("symbols");
    let mut open = symbols.as_array().expect("a list").clone();
    let mut names = 0;
    while let Some(symbol) = open.pop() {
        open.extend(symbol["children"].as_array().cloned().unwrap_or_default());
        let position = symbol["selectionRange"]["start"].clone();
        let at = json!({ "textDocument": { "uri": uri }, "position": position });
        let defined = client.ask("textDocument/definition", at.clone()).expect("an answer");
        assert_eq!(defined["range"], symbol["selectionRange"], "{symbol}");
        let renamed = |client: &mut Client, to: &str| {
            let mut params = at.clone();
            params["newName"] = json!(to);
            client.ask("textDocument/rename", params).unwrap_or_else(|error| panic!("{symbol}: {error}"))
        };
        let name = symbol["name"].as_str().expect("a name").to_string();
        let there = renamed(client, &format!("{name}_other"));
        // what another file defines and a variant states again has its name there
        if there["changes"].as_object().expect("changes").len() > 1 {
            continue;
        }
        let changed = applied(body, &there["changes"][uri]);
        assert_ne!(changed, body);
        client.change(uri, json!([{ "text": changed }]));
        let told = client.findings(uri);
        assert!(told.diagnostics.is_empty(), "{name}: {:?}", told.diagnostics);
        let back = renamed(client, &name);
        assert_eq!(applied(&changed, &back["changes"][uri]), body, "{name}");
        client.change(uri, json!([{ "text": body }]));
        client.findings(uri);
        names += 1;
    }
    names
}

/// A text after edits of ASCII lines.
fn applied(text: &str, edits: &Value) -> String {
    let mut edits: Vec<&Value> = edits.as_array().expect("edits").iter().collect();
    let at = |edit: &Value, end: &str| {
        let place = &edit["range"][end];
        (place["line"].as_u64().expect("a line") as usize, place["character"].as_u64().expect("a column") as usize)
    };
    edits.sort_by_key(|edit| std::cmp::Reverse(at(edit, "start")));
    let mut lines: Vec<String> = text.split('\n').map(str::to_string).collect();
    for edit in edits {
        let ((line, from), (_, to)) = (at(edit, "start"), at(edit, "end"));
        lines[line].replace_range(from..to, edit["newText"].as_str().expect("a text"));
    }
    lines.join("\n")
}

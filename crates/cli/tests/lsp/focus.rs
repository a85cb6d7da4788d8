//! The page of an editor with several specs open: it shows the one in focus.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::time::Duration;

use serde_json::{Value, json};

use crate::client::Client;
use crate::support::{folder, top};

/// What a page is told.
struct Events(BufReader<TcpStream>);

impl Events {
    fn of(url: &str) -> Events {
        Events(BufReader::new(get(url, "events")))
    }

    /// The next event of a spec.
    fn of_spec(&mut self, spec: &Path) -> Value {
        loop {
            let mut line = String::new();
            assert!(self.0.read_line(&mut line).expect("an event") > 0, "no more events");
            let Some(data) = line.strip_prefix("data: ") else { continue };
            let told: Value = serde_json::from_str(data).expect("JSON");
            if Path::new(told["spec"].as_str().expect("a spec")) == spec {
                return told;
            }
        }
    }
}

/// Asks for something below an address.
fn get(url: &str, inside: &str) -> TcpStream {
    let rest = url.strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{url}"));
    let (port, path) = rest.split_once('/').expect("a path");
    let mut stream = TcpStream::connect(("127.0.0.1", port.parse().expect("a port"))).expect("it listens");
    stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a limit");
    write!(stream, "GET /{path}{inside} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").expect("it reads");
    stream
}

#[test]
fn the_page_shows_the_spec_in_focus_and_follows_it_alone() {
    let folder = folder("lsp-focus");
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let specs = ["first", "second"].map(|name| folder.canonicalize().expect("a folder").join(format!("{name}.chain")));
    let uris = specs.each_ref().map(|spec| format!("file://{}", spec.display()));
    let mut client = Client::start();
    for (spec, uri) in specs.iter().zip(&uris) {
        std::fs::write(spec, &text).expect("a file");
        client.open(uri, &text);
        assert!(client.findings(uri).diagnostics.is_empty());
    }
    let of = |uri: &String| json!({ "textDocument": { "uri": uri } });
    let preview = json!({ "command": "flank.preview", "arguments": [uris[0]] });
    let answer = client.ask("workspace/executeCommand", preview).expect("a page");
    let mut events = Events::of(answer["url"].as_str().expect("an address"));
    assert_eq!(events.of_spec(&specs[0])["error"], Value::Null);

    client.tell("flank/didFocus", of(&uris[1]));
    let shown = events.of_spec(&specs[1]);
    assert_eq!((&shown["error"], &shown["job"]), (&Value::Null, &json!("first_gear")));

    // the other one is saved, and the page stays; then the one that it shows
    client.tell("textDocument/didSave", of(&uris[0]));
    client.change(&uris[1], json!([{ "text": text.replace("drive m.C = roll", "drive m.C = rol") }]));
    client.tell("textDocument/didSave", of(&uris[1]));
    let wrong = events.of_spec(&specs[1]);
    assert!(wrong["error"].as_str().is_some_and(|error| error.contains("E0201")), "{wrong}");
    assert_eq!(wrong["picture"], shown["picture"], "the last good picture stays, and nothing was shown between");
    assert_eq!(wrong["number"].as_u64(), shown["number"].as_u64().map(|number| number + 1));
    assert_eq!(client.end(), Some(0));
}

#[test]
fn the_page_stays_with_its_spec_while_a_text_without_a_job_is_edited() {
    let folder = folder("lsp-focus-parts").canonicalize().expect("a folder");
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let (parts, jobs) = text.split_at(text.find("job first_gear").expect("it is there"));
    let jobs = format!("use \"parts.chain\"\n\n{jobs}");
    let [spec, used] = ["gear", "parts"].map(|name| folder.join(format!("{name}.chain")));
    let [spec_uri, used_uri] = [&spec, &used].map(|path| format!("file://{}", path.display()));
    let mut client = Client::start();
    for (path, uri, text) in [(&used, &used_uri, parts), (&spec, &spec_uri, jobs.as_str())] {
        std::fs::write(path, text).expect("a file");
        client.open(uri, text);
        assert!(client.findings(uri).diagnostics.is_empty());
    }
    let of = |uri: &String| json!({ "textDocument": { "uri": uri } });
    let preview = json!({ "command": "flank.preview", "arguments": [spec_uri] });
    let answer = client.ask("workspace/executeCommand", preview).expect("a page");
    let mut events = Events::of(answer["url"].as_str().expect("an address"));
    let shown = events.of_spec(&spec);

    // nothing is shown of the text in focus, and what is saved of it is seen in the spec that uses it
    client.tell("flank/didFocus", of(&used_uri));
    client.change(&used_uri, json!([{ "text": parts.replace("= 20 deg", "= 21 deg") }]));
    assert!(client.findings(&used_uri).diagnostics.is_empty());
    client.tell("flank/didFocus", of(&used_uri));
    client.tell("textDocument/didSave", of(&used_uri));
    let followed = events.of_spec(&spec);
    assert_eq!(followed["error"], Value::Null);
    assert_eq!(followed["number"].as_u64(), shown["number"].as_u64().map(|number| number + 1));

    // also when the spec itself is closed
    client.tell("textDocument/didClose", of(&spec_uri));
    client.tell("textDocument/didSave", of(&used_uri));
    assert_eq!(events.of_spec(&spec)["error"], Value::Null);
    assert_eq!(client.end(), Some(0));
}

#[test]
fn a_job_with_any_name_has_a_page() {
    let text = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let text = text.replace("job first_gear", "job größe_Ω");
    let uri = "file:///nowhere/gear.chain";
    let mut client = Client::start();
    client.open(uri, &text);
    assert!(client.findings(uri).diagnostics.is_empty());
    let preview = json!({ "command": "flank.preview", "arguments": [uri, "größe_Ω"] });
    let answer = client.ask("workspace/executeCommand", preview).expect("a page");
    let url = answer["url"].as_str().expect("an address");
    assert_eq!(Events::of(url).of_spec(Path::new("/nowhere/gear.chain"))["job"], "größe_Ω");
    for (inside, status) in [
        ("data/gr%C3%B6%C3%9Fe_%CE%A9?1", "200"),
        ("functions/gr%c3%b6%c3%9fe_%ce%a9?1", "200"),
        ("data/gr%C3%B6%C3%9Fe_%CE", "404"),
        ("data/%", "404"),
        ("data/%2e%2e%2fdata", "404"),
        ("data/%FF%00%zz", "404"),
        ("%64ata/x", "404"),
    ] {
        let mut first = String::new();
        BufReader::new(get(url, inside)).read_line(&mut first).expect("an answer");
        assert!(first.contains(status), "{inside}: {first}");
    }
    assert_eq!(client.end(), Some(0));
}

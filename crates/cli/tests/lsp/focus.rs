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
        let rest = url.strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{url}"));
        let (port, path) = rest.split_once('/').expect("a path");
        let mut stream = TcpStream::connect(("127.0.0.1", port.parse().expect("a port"))).expect("it listens");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a limit");
        write!(stream, "GET /{path}events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").expect("it reads");
        Events(BufReader::new(stream))
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

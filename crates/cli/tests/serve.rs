//! `flank view --serve`: a page on this machine that follows what is saved.

mod support;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use support::{flank, folder, text, top};

struct Served {
    child: Child,
    _out: BufReader<ChildStdout>,
    port: u16,
    path: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn serve(spec: &Path) -> Served {
    serve_with(spec, &[])
}

fn serve_with(spec: &Path, arguments: &[&str]) -> Served {
    let mut child = Command::new(env!("CARGO_BIN_EXE_flank"))
        .args(["view", "--serve"])
        .arg(spec)
        .args(arguments)
        .current_dir(spec.parent().expect("a folder"))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut out = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut url = String::new();
    out.read_line(&mut url).expect("an address");
    let rest = url.trim().strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{url}"));
    let (port, path) = rest.split_once('/').expect("a path");
    let port = port.parse().expect("a port");
    assert_eq!(path.len(), 33, "{url}");
    Served { child, _out: out, port, path: format!("/{path}") }
}

impl Served {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("it listens");
        stream.set_read_timeout(Some(Duration::from_secs(60))).expect("a limit");
        stream
    }

    fn get(&self, path: &str, head: &str) -> (String, String) {
        let mut stream = self.connect();
        write!(stream, "GET {path} HTTP/1.1\r\n{head}\r\n").expect("it reads");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        (head.lines().next().unwrap_or_default().to_string(), body.to_string())
    }

    fn own(&self, path: &str) -> (String, String) {
        self.get(&format!("{}{path}", self.path), &format!("Host: 127.0.0.1:{}\r\n", self.port))
    }

    fn events(&self) -> Events {
        let mut stream = self.connect();
        write!(stream, "GET {}events HTTP/1.1\r\nHost: localhost:{}\r\n\r\n", self.path, self.port).expect("it reads");
        Events { lines: BufReader::new(stream) }
    }
}

struct Events {
    lines: BufReader<TcpStream>,
}

impl Events {
    fn next(&mut self) -> Value {
        loop {
            let mut line = String::new();
            assert!(self.lines.read_line(&mut line).expect("an event") > 0, "no more events");
            if let Some(data) = line.strip_prefix("data: ") {
                return serde_json::from_str(data).expect("JSON");
            }
        }
    }
}

/// A spec with all that it uses, in a folder of its own.
fn copied(name: &str) -> PathBuf {
    let folder = folder(name);
    for part in ["functions", "machines", "tools", "bevel"] {
        std::fs::create_dir_all(folder.join(part)).expect("a folder");
        for entry in std::fs::read_dir(top().join("specs").join(part)).expect("a folder") {
            let path = entry.expect("an entry").path();
            std::fs::copy(&path, folder.join(part).join(path.file_name().expect("a name"))).expect("a copy");
        }
    }
    folder.join("bevel/pinion_19x62.chain")
}

#[test]
fn the_page_follows_each_save_and_keeps_the_last_good_picture() {
    let spec = copied("serve");
    let before = std::fs::read_to_string(&spec).expect("the spec");
    let count = |folder: &Path| std::fs::read_dir(folder).expect("a folder").count();
    let files = count(spec.parent().expect("a folder"));
    let served = serve(&spec);
    let mut events = served.events();
    let first = events.next();
    assert_eq!((&first["job"], &first["error"], &first["picture"]), (&"pinion_19x62".into(), &Value::Null, &1.into()));
    let (status, shell) = served.own("");
    assert!(status.contains("200") && shell.contains("EventSource"), "{status}");
    let (status, waiting) = served.own("page");
    assert!(status.contains("200") && waiting.contains("window.begin"), "{status}");
    let (_, data) = served.own("data/pinion_19x62?1");
    assert!(data.contains("cradle_generator"), "{} bytes", data.len());
    let (_, functions) = served.own("functions/pinion_19x62?1");
    assert!(functions.contains("export function"), "{} bytes", functions.len());

    let saved = Instant::now();
    std::fs::write(&spec, before.replace("m.roll = roll", "m.rolle = roll")).expect("the spec");
    let wrong = events.next();
    eprintln!("an error shows {} ms after the save", saved.elapsed().as_millis());
    let error = wrong["error"].as_str().expect("an error");
    assert!(error.contains("pinion_19x62.chain:25:") && error.contains("E0201"), "{error}");
    assert_eq!(wrong["picture"], 1);
    assert_eq!(served.own("data/pinion_19x62").1, data);

    let saved = Instant::now();
    std::fs::write(&spec, before.replace("angle in -20 deg", "angle in -21 deg")).expect("the spec");
    let mended = events.next();
    eprintln!("new data are there {} ms after the save", saved.elapsed().as_millis());
    assert_eq!((&mended["error"], &mended["picture"]), (&Value::Null, &2.into()));
    assert_ne!(served.own("data/pinion_19x62").1, data);

    // what it uses, too
    let tool = spec.with_file_name("../tools/face_mill.chain");
    let text = std::fs::read_to_string(&tool).expect("the tool");
    std::fs::write(&tool, format!("// changed\n{text}")).expect("the tool");
    assert_eq!(events.next()["picture"], 3);
    assert_eq!(count(spec.parent().expect("a folder")), files, "a file was written");
}

#[test]
fn nobody_else_reads_the_page() {
    let spec = copied("serve-hosts");
    let served = serve(&spec);
    let own = format!("Host: 127.0.0.1:{}\r\n", served.port);
    for (path, head, status) in [
        (served.path.as_str(), own.as_str(), "200"),
        (served.path.as_str(), "Host: evil.example\r\n", "403"),
        (served.path.as_str(), "", "403"),
        // through a port that an editor forwards
        (served.path.as_str(), "Host: localhost:8080\r\n", "200"),
        (served.path.as_str(), "Host: localhost.evil.example\r\n", "403"),
        (served.path.as_str(), "Host: localhost:evil.example\r\n", "403"),
        (served.path.as_str(), &format!("{own}Host: evil.example\r\n"), "400"),
        ("/", own.as_str(), "404"),
        ("/0123456789abcdef0123456789abcdef/", own.as_str(), "404"),
        (&format!("{}data/../../etc/passwd", served.path), own.as_str(), "404"),
        (&format!("{}data/nothing", served.path), own.as_str(), "404"),
    ] {
        let (found, _) = served.get(path, head);
        assert!(found.contains(status), "{path} {head}: {found}");
    }
    // what is no request is answered, or given up
    for bytes in
        [&b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"[..], b"\x16\x03\x01\x00\r\n\r\n", b"GET\r\n\r\n", b"\r\n\r\n"]
    {
        let mut stream = served.connect();
        stream.write_all(bytes).expect("it reads");
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        assert!(!answer.starts_with(b"HTTP/1.1 200"));
    }
    // only the loopback address is listened on
    if let Ok(table) = std::fs::read_to_string(format!("/proc/{}/net/tcp", served.child.id())) {
        let port = format!(":{:04X}", served.port);
        let listening: Vec<&str> = table.lines().filter(|line| line.contains(&port) && line.contains(" 0A ")).collect();
        assert!(!listening.is_empty() && listening.iter().all(|line| line.contains("0100007F:")), "{listening:?}");
    }
    assert!(served.get(&served.path, &own).0.contains("200"));
}

#[test]
fn each_job_is_shown_or_told_why_not() {
    let folder = folder("serve-jobs");
    let before = std::fs::read_to_string(top().join("specs/tutorial/first_gear.chain")).expect("it is shipped");
    let second = before.rfind("sample flank_plus").expect("the second job");
    let (first, rest) = before.split_at(second);
    let spec = folder.join("gear.chain");
    std::fs::write(&spec, &before).expect("the spec");
    let refused = flank(&["view", spec.to_str().expect("a plain path"), "--serve", "--job", "nope"]);
    assert_eq!(refused.status.code(), Some(1));
    let said = text(&refused.stderr);
    assert!(said.contains("no job `nope`") && !said.contains("127.0.0.1"), "{said}");

    let served = serve_with(&spec, &["--job", "first_helical_gear"]);
    let mut events = served.events();
    let told = events.next();
    assert_eq!(told["job"], "first_helical_gear");
    assert_eq!((&told["jobs"], &told["unshown"]), (&json!(["first_gear", "first_helical_gear"]), &json!({})));
    // a range without a point, no sample, no such job
    for (text, reason) in [
        (format!("{first}{}", rest.replace("z: -10 mm .. 10 mm", "z: 500 mm .. 510 mm")), "has no point to show"),
        (format!("{first}{}", &rest[rest.find("\n}").expect("an end")..]), "asks for no points"),
        (before.replace("first_helical_gear", "other"), "no job `first_helical_gear`"),
    ] {
        std::fs::write(&spec, &text).expect("the spec");
        let told = events.next();
        assert_eq!((&told["job"], &told["error"]), (&json!("first_helical_gear"), &Value::Null), "{told}");
        let why = told["unshown"]["first_helical_gear"].as_str().unwrap_or_default();
        assert!(why.contains(reason) && told["jobs"][0] == "first_gear", "{told}");
    }
    std::fs::write(&spec, &before).expect("the spec");
    assert_eq!(events.next()["unshown"], json!({}));
}

#[test]
fn a_page_that_follows_needs_a_file() {
    let refused = flank(&["view", "-", "--serve"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(text(&refused.stderr).contains("the standard input is read once"));
}

//! As much of HTTP as one page with one reader wants.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use flank::waiting_page;

use super::pages::Pages;
use crate::uri::decoded;

const SHELL: &str = include_str!("shell.html");
/// Bytes of a request's head at the most.
const MOST_HEAD: u64 = 16_384;
/// Connections at a time at the most: browsers open a handful.
const MOST_CONNECTIONS: usize = 64;
/// A request that is not whole by then is given up.
const PATIENCE: Duration = Duration::from_secs(5);
/// As often, the page hears that it is still served.
const PULSE: Duration = Duration::from_secs(10);

/// Answers until the program ends.
pub(super) fn serve(listener: &TcpListener, secret: &str, pages: &Arc<Pages>) {
    let open = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming().flatten() {
        if open.load(Ordering::Relaxed) >= MOST_CONNECTIONS {
            continue;
        }
        open.fetch_add(1, Ordering::Relaxed);
        let (counted, pages, secret) = (Arc::clone(&open), Arc::clone(pages), secret.to_string());
        let started = std::thread::Builder::new().name("live reader".to_string()).spawn(move || {
            // a browser that goes away is no error
            let _ = answer(&stream, &secret, &pages);
            counted.fetch_sub(1, Ordering::Relaxed);
        });
        if started.is_err() {
            open.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

fn answer(stream: &TcpStream, secret: &str, pages: &Pages) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let Some(request) = Request::read(stream)? else { return plain(stream, "400 Bad Request", "no request\n") };
    if !request.host.as_deref().is_some_and(is_own) {
        return plain(stream, "403 Forbidden", "served for this machine only\n");
    }
    if request.method != "GET" {
        return plain(stream, "405 Method Not Allowed", "only GET\n");
    }
    let path = request.path.split('?').next().unwrap_or_default();
    let Some(inside) = path.strip_prefix('/').and_then(|path| path.strip_prefix(secret)) else {
        return plain(stream, "404 Not Found", "there is nothing here\n");
    };
    match inside {
        "/" => whole(stream, "200 OK", "text/html; charset=utf-8", SHELL),
        "/events" => events(stream, pages),
        "/page" => whole(stream, "200 OK", "text/html; charset=utf-8", &waiting_page()),
        _ => match part(inside, pages) {
            Some((kind, text)) => whole(stream, "200 OK", kind, &text),
            None => plain(stream, "404 Not Found", "there is nothing here\n"),
        },
    }
}

/// What a page has of its job alone, and what kind of text it is.
fn part(inside: &str, pages: &Pages) -> Option<(&'static str, String)> {
    let (part, job) = inside.strip_prefix('/')?.split_once('/')?;
    let job = decoded(job);
    match part {
        "data" => Some(("application/json", pages.parts(&job)?.data.clone())),
        "functions" => Some(("text/javascript; charset=utf-8", pages.parts(&job)?.functions.clone())),
        _ => None,
    }
}

/// Whether a host is this machine, on whatever port: editors may forward one. A name that somebody else's page made lead here is none.
fn is_own(host: &str) -> bool {
    let (name, port) = host.split_once(':').unwrap_or((host, ""));
    ["127.0.0.1", "localhost"].contains(&name) && port.bytes().all(|digit| digit.is_ascii_digit())
}

fn plain(stream: &TcpStream, status: &str, text: &str) -> io::Result<()> {
    whole(stream, status, "text/plain; charset=utf-8", text)
}

fn whole(mut stream: &TcpStream, status: &str, kind: &str, text: &str) -> io::Result<()> {
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nConnection: close\r\n\r\n",
        text.len()
    )?;
    stream.write_all(text.as_bytes())?;
    stream.flush()
}

/// Server-sent events: what is shown now, then each change.
fn events(mut stream: &TcpStream, pages: &Pages) -> io::Result<()> {
    stream.write_all(
        b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store, no-transform\r\nConnection: close\r\n\r\n",
    )?;
    let mut number = 0;
    loop {
        match pages.after(number, PULSE) {
            Some(told) => {
                number = told.number;
                let data = serde_json::to_string(&told).map_err(io::Error::from)?;
                write!(stream, "data: {data}\n\n")?;
            }
            None => stream.write_all(b": still here\n\n")?,
        }
        stream.flush()?;
    }
}

/// The head of a request.
struct Request {
    method: String,
    path: String,
    host: Option<String>,
}

impl Request {
    /// Nothing of what is no request.
    fn read(stream: &TcpStream) -> io::Result<Option<Request>> {
        let mut lines = BufReader::new(stream.take(MOST_HEAD)).lines();
        let Some(first) = lines.next().transpose()? else { return Ok(None) };
        let mut words = first.split(' ');
        let (Some(method), Some(path), Some(version)) = (words.next(), words.next(), words.next()) else {
            return Ok(None);
        };
        if !version.starts_with("HTTP/1.") {
            return Ok(None);
        }
        let mut request = Request { method: method.to_string(), path: path.to_string(), host: None };
        let mut hosts = 0;
        for line in lines {
            let line = line?;
            if line.is_empty() {
                // of two hosts it is not known which is meant
                return Ok((hosts <= 1).then_some(request));
            }
            if let Some((name, value)) = line.split_once(':')
                && name.eq_ignore_ascii_case("host")
            {
                hosts += 1;
                request.host = Some(value.trim().to_ascii_lowercase());
            }
        }
        Ok(None)
    }
}

//! `flank lsp`: the server of editors, on stdin and stdout.

mod answers;
mod capabilities;
mod diagnostics;
mod documents;
mod framing;
mod position;
mod server;
mod snapshot;
mod tasks;
mod uri;

use std::io::{BufReader, ErrorKind, Read, Write};
use std::sync::mpsc::{SyncSender, sync_channel};

use framing::Frame;
use server::{Event, Server};

use crate::Ending;
use crate::failure::Failure;

/// Messages that wait at the most: who sends more has to wait.
const MOST_WAITING: usize = 1024;

/// Serves until the editor ends it or goes away.
///
/// # Errors
/// If the system lets no thread start.
pub(crate) fn run() -> Result<Ending, Failure> {
    let is_clean = serve(std::io::stdin(), std::io::stdout());
    Ok(if is_clean.map_err(|error| format!("cannot serve: {error}"))? { Ending::Done } else { Ending::Wrong })
}

/// Serves who writes to one end and reads from the other; true if it was ended as the protocol wants.
fn serve(from: impl Read + Send + 'static, to: impl Write) -> std::io::Result<bool> {
    let (sender, events) = sync_channel(MOST_WAITING);
    let reading = sender.clone();
    std::thread::Builder::new().name("lsp reader".to_string()).spawn(move || read(from, &reading))?;
    let mut server = Server::new(to, sender);
    match server.run(&events) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        ended => ended,
    }
}

fn read(from: impl Read, events: &SyncSender<Event>) {
    let mut from = BufReader::new(from);
    loop {
        let event = match framing::read(&mut from) {
            Ok(Frame::Message(message)) => Event::Message(message),
            Ok(Frame::NoMessage(reason) | Frame::NoHeader(reason)) => Event::Unreadable(reason),
            Ok(Frame::End) | Err(_) => Event::End,
        };
        let is_end = matches!(event, Event::End);
        if events.send(event).is_err() || is_end {
            return;
        }
    }
}

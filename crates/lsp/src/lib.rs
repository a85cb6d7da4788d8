//! The server of editors, and the page that follows what is typed and saved.
//!
//! [`serve`] speaks the language server protocol with one editor: a thread reads, changes are taken in order, answers come from snapshots
//! of all texts. [`Live`] serves the page of a job on the loopback address.

mod answers;
mod capabilities;
mod diagnostics;
mod documents;
mod framing;
mod live;
mod position;
mod server;
mod snapshot;
mod tasks;
mod uri;

use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::sync::mpsc::{SyncSender, sync_channel};

use framing::Frame;
use server::{Event, Server};

pub use live::{Live, follow};

/// How a shell spells options that messages name as "option `no_align`".
pub type Spelling = fn(&str) -> String;

/// Messages that wait at the most: who sends more has to wait.
const MOST_WAITING: usize = 1024;

/// Serves the editor that writes to one end and reads from the other, until it ends the conversation or goes away; true if it was ended as
/// the protocol wants.
///
/// # Errors
/// If the system lets no thread start, or nothing can be written although the editor is there.
pub fn serve(from: impl Read + Send + 'static, to: impl Write, spelled: Spelling) -> io::Result<bool> {
    let (sender, events) = sync_channel(MOST_WAITING);
    let reading = sender.clone();
    std::thread::Builder::new().name("lsp reader".to_string()).spawn(move || read(from, &reading))?;
    let mut server = Server::new(to, sender, spelled);
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

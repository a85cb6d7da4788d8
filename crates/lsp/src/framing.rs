//! Messages of the protocol as bytes: a header with the length, then JSON.

use std::io::{self, BufRead, ErrorKind, Read};

use lsp_server::Message;

/// Bytes of one message at the most: a text has one MiB at the most, a change of it may be written with six bytes a letter.
const MOST_BYTES: usize = 16 << 20;
/// Bytes of a line of a header at the most.
const MOST_HEADER: u64 = 4096;

/// What was read.
#[derive(Debug)]
pub(super) enum Frame {
    /// A message.
    Message(Message),
    /// Something with a length that is no message; reading goes on behind it.
    NoMessage(String),
    /// Something that is no header; reading goes on with the next header.
    NoHeader(String),
    /// Nothing more comes.
    End,
}

/// Reads the next message. What is none is told, and passed over.
pub(super) fn read(from: &mut impl BufRead) -> io::Result<Frame> {
    let mut length: Option<usize> = None;
    let mut begun = false;
    loop {
        let mut line = Vec::new();
        if from.by_ref().take(MOST_HEADER).read_until(b'\n', &mut line)? == 0 {
            return Ok(Frame::End);
        }
        let text = String::from_utf8_lossy(&line);
        let text = text.trim_end_matches(['\n', '\r']);
        if text.is_empty() {
            match length {
                Some(length) => return body(from, length),
                // empty lines between messages do no harm
                None if !begun => continue,
                None => return Ok(Frame::NoHeader("a header without `Content-Length`".to_string())),
            }
        }
        begun = true;
        match text.split_once(':') {
            Some((name, value)) if name.trim().eq_ignore_ascii_case("Content-Length") => match value.trim().parse() {
                Ok(bytes) => length = Some(bytes),
                Err(_) => return Ok(Frame::NoHeader(format!("`{}` is no length", shortened(value.trim())))),
            },
            Some((name, _)) if name.trim().eq_ignore_ascii_case("Content-Type") => {}
            _ => return Ok(Frame::NoHeader(format!("`{}` is no header", shortened(text)))),
        }
    }
}

fn body(from: &mut impl BufRead, length: usize) -> io::Result<Frame> {
    if length > MOST_BYTES {
        // passed over without being held
        let passed = io::copy(&mut from.by_ref().take(length as u64), &mut io::sink())?;
        let message = format!("a message of {length} bytes: {MOST_BYTES} are the most");
        return Ok(if passed < length as u64 { Frame::End } else { Frame::NoMessage(message) });
    }
    let mut bytes = vec![0; length];
    match from.read_exact(&mut bytes) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(Frame::End),
        Err(error) => return Err(error),
    }
    let read = serde_json::from_slice(&bytes).or_else(|error| {
        let is_mended = replace_lone_surrogates(&mut bytes);
        if is_mended { serde_json::from_slice(&bytes) } else { Err(error) }
    });
    Ok(match read {
        Ok(message) => Frame::Message(message),
        Err(error) => Frame::NoMessage(format!("no message: {error}")),
    })
}

/// Writes U+FFFD for each half of a letter of two units that stands alone, as `\ud83d`: editors that keep texts in such units send them, and a change
/// that is passed over would leave a text that is not the editor's. True where there is one.
fn replace_lone_surrogates(json: &mut [u8]) -> bool {
    let (mut at, mut is_any) = (0, false);
    while at < json.len() {
        let own = unit(&json[at..]);
        let next = json.get(at + 6..).and_then(unit);
        match (own, next) {
            (Some(0xD800..=0xDBFF), Some(0xDC00..=0xDFFF)) => at += 12,
            (Some(0xD800..=0xDFFF), _) => {
                json[at + 2..at + 6].copy_from_slice(b"fffd");
                is_any = true;
                at += 6;
            }
            // whatever else stands behind a backslash is no beginning
            _ => at += if json[at] == b'\\' { 2 } else { 1 },
        }
    }
    is_any
}

/// The unit that `\ud83d` at the beginning stands for.
fn unit(json: &[u8]) -> Option<u16> {
    let digits = json.strip_prefix(b"\\u")?.get(..4)?;
    let is_plain = digits.iter().all(u8::is_ascii_hexdigit);
    let digits = std::str::from_utf8(digits).ok().filter(|_| is_plain)?;
    u16::from_str_radix(digits, 16).ok()
}

fn shortened(text: &str) -> String {
    text.chars().take(40).filter(|letter| !letter.is_control()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<String> {
        let mut from = io::BufReader::new(bytes);
        let mut found = Vec::new();
        loop {
            match read(&mut from).expect("bytes in memory") {
                Frame::End => return found,
                Frame::Message(Message::Notification(message)) => found.push(message.method),
                Frame::Message(_) => found.push("other".to_string()),
                Frame::NoMessage(_) => found.push("no message".to_string()),
                Frame::NoHeader(_) => found.push("no header".to_string()),
            }
        }
    }

    #[test]
    fn what_is_no_message_is_passed_over() {
        let exit = "Content-Length: 33\r\n\r\n{\"jsonrpc\":\"2.0\",\"method\":\"exit\"}";
        assert_eq!(all(exit.as_bytes()), ["exit"]);
        assert_eq!(all(format!("Content-Length: 3\r\n\r\n{{x}}{exit}").as_bytes())[0], "no message");
        assert_eq!(all(format!("nonsense\r\n{exit}").as_bytes()), ["no header", "exit"]);
        assert_eq!(all(format!("Content-Length: -1\r\n{exit}").as_bytes()), ["no header", "exit"]);
        assert_eq!(all(format!("Content-Length: 18446744073709551615\r\n\r\n{exit}").as_bytes()), Vec::<String>::new());
        assert_eq!(all(&exit.as_bytes()[..exit.len() - 1]), Vec::<String>::new());
    }

    #[test]
    fn halves_of_letters_that_stand_alone_are_replaced() {
        for (given, expected) in [
            (r"\ud83d", r"\ufffd"),
            (r"\ud83d\ude00", r"\ud83d\ude00"),
            (r"\ude00\ud83d\ud83d\ude00x", r"\ufffd\ufffd\ud83d\ude00x"),
            (r"\\ud83d\\\ud83d", r"\\ud83d\\\ufffd"),
            (r"\ud83", r"\ud83"),
            (r"\u00e9\", r"\u00e9\"),
        ] {
            let mut text = given.as_bytes().to_vec();
            assert_eq!(replace_lone_surrogates(&mut text), given != expected, "{given}");
            assert_eq!(text, expected.as_bytes(), "{given}");
        }
    }
}

//! How JSON documents are laid out.

use std::io::{self, Write};

use serde::Serialize;
use serde_json::ser::Formatter;

use crate::files::error::WriteError;
use crate::points::dataset::Header;

/// What all documents begin with.
#[derive(Serialize)]
pub(crate) struct Head<'a> {
    schema: &'a str,
    program: &'a str,
    spec: &'a str,
    spec_hash: &'a str,
    job: &'a str,
    conventions: Vec<String>,
    units: Units,
}

#[derive(Serialize)]
struct Units {
    length: &'static str,
    angle: &'static str,
}

impl<'a> Head<'a> {
    pub(crate) fn new(schema: &'a str, header: &'a Header, conventions: Vec<String>) -> Head<'a> {
        Head {
            schema,
            program: &header.program,
            spec: &header.spec,
            spec_hash: &header.spec_hash,
            job: &header.job,
            conventions,
            units: Units { length: "mm", angle: "deg" },
        }
    }
}

/// Writes a document whose `broken` outermost levels have a line for each of their parts.
pub(crate) fn write_document(document: &impl Serialize, broken: usize, out: &mut dyn Write) -> Result<(), WriteError> {
    let layout = LinePerItem { depth: 0, broken };
    let mut serializer = serde_json::Serializer::with_formatter(&mut *out, layout);
    document.serialize(&mut serializer).map_err(io::Error::from)?;
    writeln!(out)?;
    Ok(())
}

/// Breaks lines down to a level and keeps each item there on one line: people and `diff` read such a file.
struct LinePerItem {
    depth: usize,
    broken: usize,
}

impl LinePerItem {
    fn open<W: ?Sized + Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth += 1;
        out.write_all(bracket)
    }

    fn close<W: ?Sized + Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth -= 1;
        if self.depth < self.broken {
            self.new_line(out)?;
        }
        out.write_all(bracket)
    }

    fn next<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        if !first {
            out.write_all(b",")?;
        }
        if self.depth <= self.broken {
            self.new_line(out)
        } else if first {
            Ok(())
        } else {
            out.write_all(b" ")
        }
    }

    fn new_line<W: ?Sized + Write>(&self, out: &mut W) -> io::Result<()> {
        out.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| out.write_all(b"  "))
    }
}

impl Formatter for LinePerItem {
    fn begin_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"]")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.next(out, first)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.next(out, first)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}

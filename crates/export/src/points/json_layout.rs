//! How JSON documents are laid out.

use std::io::{self, Write};

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::ser::Formatter;

use crate::files::error::WriteError;
use crate::points::dataset::{Header, Unit};

/// What all documents begin with.
#[derive(Serialize, JsonSchema)]
pub(crate) struct Head<'a> {
    /// Program and version that wrote the file.
    program: &'a str,
    /// The spec file, as it was given.
    spec: &'a str,
    /// Hash of what the spec says.
    spec_hash: &'a str,
    /// The job of the spec that was run.
    job: &'a str,
    /// Sentences that a reader of the numbers must know.
    conventions: Vec<String>,
    /// Of all numbers, unless they have one of their own.
    units: FileUnits,
}

/// The units of a file.
#[derive(Serialize, JsonSchema)]
struct FileUnits {
    /// Of lengths.
    length: Unit,
    /// Of angles.
    angle: Unit,
}

impl<'a> Head<'a> {
    pub(crate) fn new(header: &'a Header, conventions: Vec<String>) -> Head<'a> {
        Head {
            program: &header.program,
            spec: &header.spec,
            spec_hash: &header.spec_hash,
            job: &header.job,
            conventions,
            units: FileUnits { length: Unit::Millimetre, angle: Unit::Degree },
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

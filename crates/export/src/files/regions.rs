//! Parts of a file that are filled side by side: each has its place before anything is known but its size.

use std::io::{self, Seek, SeekFrom, Write};

/// A file as some formats want it, with places to go back to.
pub trait Target: Write + Seek + Send {}

impl<T: Write + Seek + Send> Target for T {}

/// What is held of a part before it is written.
const HELD: usize = 1 << 16;

/// Parts that follow each other.
pub(crate) struct Regions {
    parts: Vec<Region>,
    end: u64,
}

struct Region {
    /// Where the held bytes belong.
    next: u64,
    held: Vec<u8>,
}

impl Regions {
    /// Parts of these sizes, in bytes, one behind the other from `start`.
    pub(crate) fn new(start: u64, sizes: impl IntoIterator<Item = u64>) -> Regions {
        let mut end = start;
        let mut part = |size: u64| {
            let next = end;
            end += size;
            Region { next, held: Vec::new() }
        };
        let parts = sizes.into_iter().map(&mut part).collect();
        Regions { parts, end }
    }

    /// Puts bytes behind those that a part has.
    ///
    /// # Errors
    /// If the target refuses.
    pub(crate) fn push(&mut self, part: usize, bytes: &[u8], out: &mut dyn Target) -> io::Result<()> {
        let part = &mut self.parts[part];
        part.held.extend_from_slice(bytes);
        if part.held.len() < HELD { Ok(()) } else { part.write(out) }
    }

    /// Writes what is held, and goes to where the last part ends.
    ///
    /// # Errors
    /// If the target refuses.
    pub(crate) fn finish(mut self, out: &mut dyn Target) -> io::Result<()> {
        self.parts.iter_mut().try_for_each(|part| part.write(out))?;
        out.seek(SeekFrom::Start(self.end)).map(|_| ())
    }
}

impl Region {
    fn write(&mut self, out: &mut dyn Target) -> io::Result<()> {
        out.seek(SeekFrom::Start(self.next))?;
        out.write_all(&self.held)?;
        self.next += self.held.len() as u64;
        self.held.clear();
        Ok(())
    }
}

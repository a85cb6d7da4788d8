//! Lines and columns as the protocol counts them, in units of UTF-16, and bytes.

use gen_lsp_types::{Position, Range};

/// Bytes between places whose units are counted ahead: of a long line only so many are looked at for one place.
const BLOCK: usize = 256;

/// Where the lines of a text begin. They end with a line feed, a carriage return, or both, as in the language.
pub(super) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
    /// The units before each block; none of a text in which every byte is one.
    units: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub(super) fn of(text: &'t str) -> Lines<'t> {
        let bytes = text.as_bytes();
        let is_end = |at: &usize| bytes[*at] == b'\n' || (bytes[*at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
        let starts = std::iter::once(0).chain((0..bytes.len()).filter(is_end).map(|at| at + 1)).collect();
        Lines { text, starts, units: if text.is_ascii() { Vec::new() } else { units_of_blocks(bytes) } }
    }

    /// The place of a byte.
    pub(super) fn position(&self, offset: usize) -> Position {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.starts.partition_point(|start| *start <= offset) - 1;
        let character = self.units_before(offset) - self.units_before(self.starts[line]);
        Position { line: line as u32, character: character as u32 }
    }

    pub(super) fn range(&self, start: usize, end: usize) -> Range {
        Range { start: self.position(start), end: self.position(end) }
    }

    /// The byte of a place; the end of the line or of the text where it lies beyond, the letter's first byte where it lies within one.
    pub(super) fn offset(&self, position: Position) -> usize {
        let Some(start) = self.starts.get(position.line as usize).copied() else { return self.text.len() };
        let end = self.starts.get(position.line as usize + 1).copied().unwrap_or(self.text.len());
        let end = start + self.text[start..end].trim_end_matches(['\n', '\r']).len();
        let wanted = self.units_before(start) + position.character as usize;
        if self.units_before(end) <= wanted {
            return end;
        }
        let block = self.units.partition_point(|before| *before <= wanted).saturating_sub(1);
        let from = start.max(block * BLOCK);
        let mut before = self.units_before(from);
        for (at, byte) in (from..end).zip(&self.text.as_bytes()[from..end]) {
            let own = units(*byte);
            if own > 0 && before + own > wanted {
                return at;
            }
            before += own;
        }
        end
    }

    fn units_before(&self, offset: usize) -> usize {
        let Some(before) = self.units.get(offset / BLOCK) else { return offset };
        let part = &self.text.as_bytes()[offset / BLOCK * BLOCK..offset];
        before + part.iter().map(|byte| units(*byte)).sum::<usize>()
    }
}

/// The units of a letter, told by its first byte; none of its other bytes.
fn units(byte: u8) -> usize {
    usize::from(byte & 0xC0 != 0x80) + usize::from(byte >= 0xF0)
}

fn units_of_blocks(bytes: &[u8]) -> Vec<usize> {
    let mut before = 0;
    let mut found = vec![0];
    for block in bytes.chunks(BLOCK) {
        before += block.iter().map(|byte| units(*byte)).sum::<usize>();
        found.push(before);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_units_of_utf_16() {
        let text = "aΩ😀b\r\nc\rd\n";
        let lines = Lines::of(text);
        for (offset, line, character) in
            [(0, 0, 0), (1, 0, 1), (3, 0, 2), (7, 0, 4), (8, 0, 5), (10, 1, 0), (12, 2, 0), (14, 3, 0)]
        {
            assert_eq!(lines.position(offset), Position { line, character }, "{offset}");
            assert_eq!(lines.offset(Position { line, character }), offset);
        }
        // within a letter of two units, beyond a line, beyond the text
        assert_eq!(lines.offset(Position { line: 0, character: 3 }), 3);
        assert_eq!(lines.offset(Position { line: 0, character: 99 }), 8);
        assert_eq!(lines.offset(Position { line: 99, character: 0 }), text.len());
        assert_eq!(lines.position(5), Position { line: 0, character: 2 });
    }

    #[test]
    fn places_in_long_lines_are_those_of_counted_letters() {
        let line: String = "aΩ😀b ".chars().cycle().take(1500).collect();
        let text = format!("x\n{line}\r\n{line}");
        let lines = Lines::of(&text);
        for start in [2, 2 + line.len() + 2] {
            let mut character = 0;
            for (at, letter) in line.char_indices() {
                let place = Position { line: if start == 2 { 1 } else { 2 }, character };
                assert_eq!((lines.position(start + at), lines.offset(place)), (place, start + at));
                character += letter.len_utf16() as u32;
            }
        }
    }
}

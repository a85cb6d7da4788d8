//! The one font of the pictures: widths and outlines of its glyphs.

use std::fmt::Write;
use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// DejaVu Sans, compiled in: a fresh machine may have no font at all, and letters must not depend on it.
static FACE: LazyLock<Face<'static>> =
    LazyLock::new(|| Face::parse(dejavu::sans::regular(), 0).expect("the font compiled in is whole"));

const ELLIPSIS: &str = "\u{2026}";

/// A glyph and where it stands on the line, in font units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Placed {
    pub(super) glyph: GlyphId,
    pub(super) at: u32,
}

/// Sheet units per font unit at a font size.
pub(super) fn scale(size: f64) -> f64 {
    size / f64::from(FACE.units_per_em())
}

/// The glyphs of a line of text. Letters the font lacks become its box.
pub(super) fn layout(text: &str) -> Vec<Placed> {
    let mut at = 0;
    let mut placed = Vec::new();
    for letter in text.chars() {
        let glyph = FACE.glyph_index(letter).unwrap_or_default();
        placed.push(Placed { glyph, at });
        at += u32::from(FACE.glyph_hor_advance(glyph).unwrap_or_default());
    }
    placed
}

/// How wide a line of text is, in sheet units.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let advance =
        |letter| f64::from(FACE.glyph_hor_advance(FACE.glyph_index(letter).unwrap_or_default()).unwrap_or_default());
    scale(size) * text.chars().map(advance).sum::<f64>()
}

/// The text, cut with an ellipsis if it is wider than `room`.
pub(super) fn fitted(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut left = room - width(ELLIPSIS, size);
    if left < 0.0 {
        return String::new();
    }
    let fits = |letter: &char| {
        left -= width(letter.encode_utf8(&mut [0; 4]), size);
        left >= 0.0
    };
    let cut: String = text.chars().take_while(fits).collect();
    format!("{}{ELLIPSIS}", cut.trim_end())
}

/// The text in lines no wider than `room`, broken at spaces.
pub(super) fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| fitted(line, size, room)).collect()
}

/// Hands a glyph's outline to `path`: font units, up is plus. Blanks have none.
pub(super) fn outline(glyph: GlyphId, path: &mut dyn OutlineBuilder) {
    let _ = FACE.outline_glyph(glyph, path);
}

/// A glyph's outline as an SVG path; empty for blanks.
pub(super) fn svg_outline(glyph: GlyphId) -> String {
    let mut path = SvgPath(String::new());
    outline(glyph, &mut path);
    path.0
}

/// Writing to a string cannot fail.
struct SvgPath(String);

impl OutlineBuilder for SvgPath {
    fn move_to(&mut self, x: f32, y: f32) {
        let _ = write!(self.0, "M{x} {y}");
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let _ = write!(self.0, "L{x} {y}");
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let _ = write!(self.0, "Q{x1} {y1} {x} {y}");
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let _ = write!(self.0, "C{x1} {y1} {x2} {y2} {x} {y}");
    }

    fn close(&mut self) {
        self.0.push('Z');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_what_the_trade_writes() {
        for letter in "azAZ09 \u{2212}\u{2026}\u{2192}\u{00d7}\u{00b7}\u{00b0}\u{00b5}αβρΣδ".chars() {
            assert!(FACE.glyph_index(letter).is_some_and(|glyph| glyph.0 != 0), "no glyph for {letter}");
        }
    }

    #[test]
    fn long_text_is_cut_to_fit() {
        let cut = fitted("a name that nobody can read at a glance", 16.0, 120.0);
        assert!(cut.ends_with('\u{2026}') && width(&cut, 16.0) <= 120.0);
        assert_eq!(fitted("short", 16.0, 120.0), "short");
        assert_eq!(fitted("anything", 16.0, 0.0), "");
    }

    #[test]
    fn text_wraps_at_spaces() {
        let lines = wrapped("one two three four five six", 16.0, 80.0);
        assert!(lines.len() > 1 && lines.iter().all(|line| width(line, 16.0) <= 80.0));
        assert_eq!(lines.join(" "), "one two three four five six");
    }
}

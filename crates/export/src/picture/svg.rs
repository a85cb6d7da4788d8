//! The display list as SVG.

use std::collections::BTreeSet;
use std::fmt::Write;

use ttf_parser::GlyphId;

use super::Picture;
use super::font;
use super::paint::{Item, Place};
use crate::xml::escaped;

/// The picture as an SVG document. Letters are outlines, so it looks the same everywhere; their text is kept in labels.
pub(super) fn document(picture: &Picture) -> String {
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = write_document(picture, &mut svg);
    svg
}

fn write_document(picture: &Picture, svg: &mut String) -> std::fmt::Result {
    let (width, height) = (picture.width, picture.height);
    let [across, down] = picture.sheet_size();
    writeln!(svg, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {} {}" role="img">"#,
        number(across),
        number(down)
    )?;
    writeln!(svg, "<title>{}</title>\n<desc>{}</desc>", escaped(&picture.title), escaped(&picture.description))?;
    write_glyphs(&picture.items, svg)?;
    writeln!(svg, r##"<rect width="100%" height="100%" fill="#ffffff"/>"##)?;
    writeln!(svg, r#"<g stroke-linejoin="round" stroke-linecap="round">"#)?;
    for item in &picture.items {
        write_item(item, svg)?;
    }
    writeln!(svg, "</g>\n</svg>")
}

/// Each glyph's outline once; texts refer to it.
fn write_glyphs(items: &[Item], svg: &mut String) -> std::fmt::Result {
    let mut used: BTreeSet<GlyphId> = BTreeSet::new();
    for item in items {
        if let Item::Text { text, .. } = item {
            used.extend(font::layout(text).iter().map(|placed| placed.glyph));
        }
    }
    writeln!(svg, "<defs>")?;
    for glyph in used {
        writeln!(svg, r#"<path id="g{}" d="{}"/>"#, glyph.0, font::svg_outline(glyph))?;
    }
    writeln!(svg, "</defs>")
}

fn write_item(item: &Item, svg: &mut String) -> std::fmt::Result {
    match item {
        Item::Polygon { points, fill, outline, width } => {
            write!(svg, r#"<polygon fill="{}" stroke="{}" "#, fill.hex(), outline.hex())?;
            write!(svg, r#"stroke-width="{}" points=""#, number(*width))?;
            write_points(points, svg)?;
        }
        Item::Line { points, colour, width } => {
            write!(svg, r#"<polyline fill="none" stroke="{}" "#, colour.hex())?;
            write!(svg, r#"stroke-width="{}" points=""#, number(*width))?;
            write_points(points, svg)?;
        }
        Item::Text { at, size, colour, text } => {
            let scale = font::scale(*size);
            write!(svg, r#"<g fill="{}" aria-label="{}" "#, colour.hex(), escaped(text))?;
            write!(svg, r#"transform="translate({} {}) "#, number(at[0]), number(at[1]))?;
            write!(svg, r#"scale({scale} {})">"#, -scale)?;
            for placed in font::layout(text) {
                write!(svg, r##"<use href="#g{}" x="{}"/>"##, placed.glyph.0, placed.at)?;
            }
            return writeln!(svg, "</g>");
        }
    }
    writeln!(svg, r#""/>"#)
}

fn write_points(points: &[Place], svg: &mut String) -> std::fmt::Result {
    for (at, point) in points.iter().enumerate() {
        let gap = if at == 0 { "" } else { " " };
        write!(svg, "{gap}{},{}", number(point[0]), number(point[1]))?;
    }
    Ok(())
}

/// A hundredth of a sheet unit is finer than anyone sees.
fn number(value: f64) -> f64 {
    let rounded = (100.0 * value).round() / 100.0;
    if rounded == 0.0 { 0.0 } else { rounded }
}

//! The display list as SVG: documents; and elements of a page, which share their letters and are short.

use std::collections::BTreeSet;
use std::fmt::Write;

use ttf_parser::GlyphId;

use super::Picture;
use super::font;
use super::paint::{Item, Place};
use flank_export::text::escaped;

/// Fewer hundredths are written digit by digit: a number of the sheet has no such size.
const MOST_HUNDREDTHS: f64 = 1e12;

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
    write_glyphs([picture.items.as_slice()], svg)?;
    writeln!(svg, r##"<rect width="100%" height="100%" fill="#ffffff"/>"##)?;
    writeln!(svg, r#"<g stroke-linejoin="round" stroke-linecap="round">"#)?;
    for item in &picture.items {
        write_item(item, svg)?;
    }
    writeln!(svg, "</g>\n</svg>")
}

/// Each glyph's outline once; texts refer to it.
fn write_glyphs<'a>(pictures: impl IntoIterator<Item = &'a [Item]>, svg: &mut String) -> std::fmt::Result {
    let mut used: BTreeSet<GlyphId> = BTreeSet::new();
    for item in pictures.into_iter().flatten() {
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

/// The letters of pictures that stand in one page.
pub(super) fn letters<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> String {
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = write_glyphs(pictures.into_iter().map(|picture| picture.items.as_slice()), &mut svg);
    svg
}

/// The picture as an element of a page that has its letters.
pub(super) fn element(picture: &Picture) -> String {
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = write_element(picture, &mut svg);
    svg
}

fn write_element(picture: &Picture, svg: &mut String) -> std::fmt::Result {
    let [across, down] = picture.sheet_size();
    let (across, down) = (number(across), number(down));
    let title = escaped(&picture.title);
    writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {across} {down}" role="img" aria-label="{title}">"#
    )?;
    writeln!(svg, r#"<g stroke-linejoin="round" stroke-linecap="round">"#)?;
    for run in picture.items.chunk_by(is_alike) {
        write_run(run, svg)?;
    }
    writeln!(svg, "</g>\n</svg>")
}

/// Whether two items can be painted by one element.
fn is_alike(a: &Item, b: &Item) -> bool {
    match (a, b) {
        (
            Item::Polygon { fill, outline, width, .. },
            Item::Polygon { fill: other_fill, outline: other_outline, width: other_width, .. },
        ) => fill == outline && other_fill == other_outline && width == other_width,
        (Item::Line { colour, width, .. }, Item::Line { colour: other_colour, width: other_width, .. }) => {
            colour == other_colour && width == other_width
        }
        _ => false,
    }
}

/// Lines become one path, polygons in the colours of their outlines a group.
fn write_run(run: &[Item], svg: &mut String) -> std::fmt::Result {
    match run {
        [Item::Line { colour, width, .. }, ..] => {
            write!(svg, r#"<path fill="none" stroke="{}" stroke-width="{}" d=""#, colour.hex(), number(*width))?;
            for item in run {
                let Item::Line { points, .. } = item else { continue };
                write_path(points, svg)?;
            }
            writeln!(svg, r#""/>"#)
        }
        [Item::Polygon { fill, outline, width, .. }, ..] if fill == outline => {
            writeln!(svg, r#"<g fill="currentColor" stroke="currentColor" stroke-width="{}">"#, number(*width))?;
            for item in run {
                let Item::Polygon { points, fill, .. } = item else { continue };
                write!(svg, r#"<path color="{}" d=""#, fill.hex())?;
                write_path(points, svg)?;
                writeln!(svg, r#"z"/>"#)?;
            }
            writeln!(svg, "</g>")
        }
        _ => run.iter().try_for_each(|item| write_item(item, svg)),
    }
}

/// A tenth of a sheet unit is finer than a page is printed; each place is seen from the one before.
fn write_path(points: &[Place], svg: &mut String) -> std::fmt::Result {
    let mut before = [0; 2];
    for (at, point) in points.iter().enumerate() {
        let place = point.map(|x| (10.0 * x).round() as i64);
        let [right, down] = [place[0] - before[0], place[1] - before[1]];
        svg.push_str(if at == 0 { "M" } else { "l" });
        write_tenths(right, svg)?;
        if down >= 0 {
            svg.push(' ');
        }
        write_tenths(down, svg)?;
        before = place;
    }
    Ok(())
}

fn write_tenths(tenths: i64, svg: &mut String) -> std::fmt::Result {
    let (sign, size) = (if tenths < 0 { "-" } else { "" }, tenths.unsigned_abs());
    match (size / 10, size % 10) {
        (whole, 0) => write!(svg, "{sign}{whole}"),
        (0, tenth) => write!(svg, "{sign}.{tenth}"),
        (whole, tenth) => write!(svg, "{sign}{whole}.{tenth}"),
    }
}

fn write_item(item: &Item, svg: &mut String) -> std::fmt::Result {
    match item {
        Item::Polygon { points, fill, outline, width } => {
            svg.extend([r#"<polygon fill=""#, &fill.hex(), r#"" stroke=""#, &outline.hex()]);
            write_points((points, *width), svg)?;
        }
        Item::Line { points, colour, width } => {
            svg.extend([r#"<polyline fill="none" stroke=""#, &colour.hex()]);
            write_points((points, *width), svg)?;
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

fn write_points((points, width): (&[Place], f64), svg: &mut String) -> std::fmt::Result {
    svg.push_str(r#"" stroke-width=""#);
    write_number(width, svg)?;
    svg.push_str(r#"" points=""#);
    for (at, [right, down]) in points.iter().enumerate() {
        if at > 0 {
            svg.push(' ');
        }
        write_number(*right, svg)?;
        svg.push(',');
        write_number(*down, svg)?;
    }
    Ok(())
}

/// What [`number`] makes of a value, as it is printed: pictures have tens of thousands of places, and general formatting takes longer.
fn write_number(value: f64, svg: &mut String) -> std::fmt::Result {
    let hundredths = (100.0 * value).round();
    if !hundredths.is_finite() || hundredths.abs() >= MOST_HUNDREDTHS {
        return write!(svg, "{}", number(value));
    }
    if hundredths < 0.0 {
        svg.push('-');
    }
    let size = hundredths.abs() as u64;
    let digit = |place: u64| char::from(b'0' + (size / place % 10) as u8);
    let mut place = 100;
    while size / place >= 10 {
        place *= 10;
    }
    while place >= 100 {
        svg.push(digit(place));
        place /= 10;
    }
    if !size.is_multiple_of(100) {
        svg.extend(['.', digit(10)]);
    }
    if !size.is_multiple_of(10) {
        svg.push(digit(1));
    }
    Ok(())
}

/// A hundredth of a sheet unit is finer than anyone sees.
fn number(value: f64) -> f64 {
    let rounded = (100.0 * value).round() / 100.0;
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests {
    use resvg::tiny_skia::{Pixmap, Transform};
    use resvg::usvg::{Options, Tree};

    use super::super::paint::{Colour, Sheet};
    use super::*;

    #[test]
    fn paths_go_on_from_where_they_are() {
        let mut path = String::new();
        write_path(&[[485.73, 617.69], [485.79, 617.72], [484.15, 623.05], [484.0, 622.0]], &mut path).unwrap();
        assert_eq!(path, "M485.7 617.7l.1 0l-1.6 5.4l-.2-1.1");
    }

    #[test]
    fn numbers_are_written_as_they_are_printed() {
        let values =
            [0.0, -0.001, 0.004, 0.005, 0.05, 0.1, -0.1, 1.0, -12.5, 9.995, 10.0, 617.69, 99.999, 1200.0, -123_456.78];
        let large = [1e9, 1e11, 1.5e17, -3e20, f64::NAN, f64::INFINITY];
        for value in values.into_iter().chain(large).chain((0..2000).map(|k| 0.37 * f64::from(k) - 300.0)) {
            let mut written = String::new();
            write_number(value, &mut written).unwrap();
            assert_eq!(written, number(value).to_string());
        }
    }

    /// An element with the letters of its page shows what the document shows.
    #[test]
    fn an_element_is_its_document() {
        let mut sheet = Sheet::default();
        let [red, blue] = [Colour([200, 40, 20]), Colour([20, 60, 160])];
        sheet.polygon(&[[10.0, 10.0], [90.0, 12.0], [50.0, 80.0]], red, red, 2.0);
        sheet.polygon(&[[60.0, 60.0], [110.0, 62.0], [80.0, 90.0]], blue, blue, 2.0);
        sheet.polygon(&[[20.0, 60.0], [40.0, 62.0], [30.0, 90.0]], blue, red, 3.0);
        sheet.line(&[[5.0, 5.0], [115.0, 85.0]], blue, 1.5);
        sheet.line(&[[5.0, 85.0], [115.0, 5.0]], blue, 1.5);
        sheet.text([10.0, 50.0], super::super::paint::Anchor::Start, 14.0, red, "12 mm");
        let picture = Picture {
            width: 120,
            height: 90,
            unit: 1.0,
            title: "a < b".to_owned(),
            description: String::new(),
            items: sheet.items,
        };
        let element = element(&picture).replacen('>', &format!(">{}", letters([&picture])), 1);
        let drawn = [element, document(&picture)].map(|svg| {
            let tree = Tree::from_str(&svg, &Options::default()).expect("an SVG that others can read");
            let mut pixels = Pixmap::new(120, 90).expect("a small size");
            pixels.fill(resvg::tiny_skia::Color::WHITE);
            resvg::render(&tree, Transform::identity(), &mut pixels.as_mut());
            pixels
        });
        let off = drawn[0].data().iter().zip(drawn[1].data()).filter(|(a, b)| a.abs_diff(**b) > 8).count();
        assert_eq!(off, 0);
        assert!(drawn[0].data().iter().any(|byte| *byte < 60));
    }
}

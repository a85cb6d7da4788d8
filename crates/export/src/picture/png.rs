//! The display list as pixels.

use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};
use ttf_parser::OutlineBuilder;

use super::Picture;
use super::font;
use super::paint::{Colour, Item, Place};
use crate::error::PictureError;

/// The picture as a PNG file: the same shapes as in the SVG.
pub(super) fn file(picture: &Picture) -> Result<Vec<u8>, PictureError> {
    let (width, height) = (picture.width, picture.height);
    let mut pixels = Pixmap::new(width, height).ok_or(PictureError::TooLarge { width, height })?;
    pixels.fill(Color::WHITE);
    let to_pixels = Transform::from_scale(picture.unit as f32, picture.unit as f32);
    for item in &picture.items {
        draw(item, to_pixels, &mut pixels);
    }
    encoded(&pixels).map_err(|error| PictureError::Encoding(error.to_string()))
}

/// Three channels, as the ground is white everywhere, and lines as they are: flat colours pack best so.
fn encoded(pixels: &Pixmap) -> Result<Vec<u8>, png::EncodingError> {
    let colours: Vec<u8> =
        pixels.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::NoFilter);
    encoder.write_header()?.write_image_data(&colours)?;
    Ok(file)
}

fn draw(item: &Item, to_pixels: Transform, pixels: &mut Pixmap) {
    match item {
        Item::Polygon { points, fill, outline, width } => {
            if let Some(path) = path_through(points, true) {
                pixels.fill_path(&path, &paint(*fill), FillRule::Winding, to_pixels, None);
                pixels.stroke_path(&path, &paint(*outline), &pen(*width), to_pixels, None);
            }
        }
        Item::Line { points, colour, width } => {
            if let Some(path) = path_through(points, false) {
                pixels.stroke_path(&path, &paint(*colour), &pen(*width), to_pixels, None);
            }
        }
        Item::Text { at, size, colour, text } => {
            let scale = font::scale(*size) as f32;
            let to_sheet = Transform::from_row(scale, 0.0, 0.0, -scale, at[0] as f32, at[1] as f32);
            let mut line = TextPath { builder: PathBuilder::new(), shift: 0.0 };
            for placed in font::layout(text) {
                line.shift = placed.at as f32;
                font::outline(placed.glyph, &mut line);
            }
            if let Some(path) = line.builder.finish() {
                let transform = to_pixels.pre_concat(to_sheet);
                pixels.fill_path(&path, &paint(*colour), FillRule::Winding, transform, None);
            }
        }
    }
}

fn path_through(points: &[Place], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    builder.move_to(first[0] as f32, first[1] as f32);
    for point in rest {
        builder.line_to(point[0] as f32, point[1] as f32);
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn paint(colour: Colour) -> Paint<'static> {
    let [red, green, blue] = colour.0;
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

fn pen(width: f64) -> Stroke {
    Stroke { width: width as f32, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() }
}

/// Collects the glyphs of a line of text into one path, font units.
struct TextPath {
    builder: PathBuilder,
    shift: f32,
}

impl OutlineBuilder for TextPath {
    fn move_to(&mut self, x: f32, y: f32) {
        self.builder.move_to(self.shift + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.builder.line_to(self.shift + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.builder.quad_to(self.shift + x1, y1, self.shift + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.builder.cubic_to(self.shift + x1, y1, self.shift + x2, y2, self.shift + x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}
